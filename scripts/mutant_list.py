"""What ``mutants.py`` breaks: small wrong changes of the mechanics, each with tests that must notice it."""

from __future__ import annotations

from dataclasses import dataclass

JOINTS = "antenna_pin/joints/_kernels.py"
POSE = "antenna_pin/joints/_pose_kernels.py"
ROW = "antenna_pin/joints/_row_kernels.py"
PATCH = "antenna_pin/joints/_patch_kernels.py"
DYNAMICS = "antenna_pin/dynamics/_kernels.py"
PEAKS = "antenna_pin/dynamics/_peak_kernels.py"
INSPECT = "antenna_pin/dynamics/_inspect_kernels.py"
AUDIT_KERNELS = "antenna_pin/dynamics/_audit_kernels.py"
TREE = "antenna_pin/mechanism/tree.py"
TREE_KERNELS = "antenna_pin/mechanism/_tree_kernels.py"
SAMPLE_KERNELS = "antenna_pin/dynamics/_sample_kernels.py"
CURVE = "antenna_pin/elements/curve.py"
CURVE_KERNELS = "antenna_pin/elements/_curve_kernels.py"
LEDGER_KERNELS = "antenna_pin/elements/_ledger_kernels.py"
PD_KERNELS = "antenna_pin/elements/_pd_kernels.py"
SPRING_KERNELS = "antenna_pin/elements/_spring_kernels.py"
TABLE = "antenna_pin/elements/table.py"
WORKSPACE = "antenna_pin/dynamics/workspace.py"
ROWS = "antenna_pin/constraints/_rows_kernels.py"
SOLVE = "antenna_pin/constraints/_solve_kernels.py"
FORCES = "antenna_pin/constraints/_force_kernels.py"
SOLVER = "antenna_pin/constraints/solver.py"
LOOP = "antenna_pin/simulation/loop.py"
PACE = "antenna_pin/engine/_pace_kernels.py"
WATCH = "antenna_pin/simulation/watch.py"
ACTIONS = "antenna_pin/simulation/actions.py"
EVENTS = "antenna_pin/simulation/events.py"
TRIALS = "antenna_pin/simulation/trials.py"
EPISODES = "antenna_pin/simulation/episodes.py"
EPISODE_KERNELS = "antenna_pin/engine/_episode_kernels.py"
RECORD = "antenna_pin/simulation/record.py"
SEEN = "antenna_pin/simulation/seen.py"
SETTINGS = "antenna_pin/simulation/scales.py"
REVOLUTE = "antenna_pin/geometry/_revolute_kernels.py"
INTEGRATE = "antenna_pin/integrate/_kernels.py"
MANIFOLD = "antenna_pin/integrate/_manifold_kernels.py"
STEPPER = "antenna_pin/integrate/stepper.py"
IMPLICIT = "antenna_pin/integrate/implicit.py"
RADAU = "antenna_pin/integrate/_radau_kernels.py"
NEWTON = "antenna_pin/integrate/_newton_kernels.py"

TEST_JOINT = "tests/joints/test_clearance.py"
TEST_DISTRIBUTED = "tests/joints/test_distributed.py"
TEST_ELEMENTS = "tests/dynamics/test_elements.py"
TEST_DRIVES = "tests/elements/test_drives.py"
TEST_PD = "tests/elements/test_pd.py"
WITHOUT_RUNS = (
    "-k",
    "not moves_a_joint_with_play",
)  # in Python a trial step that is rejected warns of overflow
TEST_AUDIT = "tests/dynamics/test_audit.py"
TEST_SAMPLES = "tests/dynamics/test_samples.py"
TEST_CLOSURES = "tests/constraints/test_closures.py"
TEST_GAPS = "tests/geometry/test_gaps.py"
TEST_SCENARIOS = "tests/geometry/test_scenarios.py"
TEST_MANIFOLD = "tests/integrate/test_manifold.py"
TEST_STEPPER = "tests/integrate/test_stepper.py"
TEST_IMPLICIT = "tests/integrate/test_implicit.py"
LINEARISATION = "antenna_pin/linear/linearisation.py"
TEST_MODES_OF_LOOPS = "tests/linear/test_loops.py"
TEST_ORDER = "tests/integrate/test_order.py"
TEST_GRAZES = "tests/simulation/test_grazes.py"
TEST_IMPACTS = "tests/simulation/test_impacts.py"
TEST_FLANGE = "tests/simulation/test_flange.py"
TEST_GOING_ON = "tests/simulation/test_going_on.py"
TEST_RECORD = "tests/simulation/test_record.py"
TEST_RUN = "tests/simulation/test_run.py"
TEST_ON_CHILD = "tests/simulation/test_bearing_on_child.py"
IN_STATES = ("-k", "same_contacts or power or ledger or against")
CHART = "antenna_pin/nonlinear/chart.py"
FIELD = "antenna_pin/nonlinear/field.py"
SALTATION = "antenna_pin/nonlinear/saltation.py"
TEST_PARTS = "tests/flexible/test_parts.py"
TEST_EVENTS = "tests/simulation/test_events.py"
TEST_TURNS = "tests/simulation/test_turns.py"
TEST_START = "tests/simulation/test_start_and_end.py"


@dataclass(frozen=True, slots=True)
class Mutant:
    """One wrong change.

    Attributes:
        note: What is wrong then.
        file: Where, from the root of the tree.
        old: Text that stands there exactly once.
        new: What it becomes.
        tests: What pytest is given: files, node ids, options.
        equivalent: Why nothing can notice it, if nothing can; it is not run then.
        compiled: Whether kernels are compiled, which takes up to a minute, or run as Python.
    """

    note: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]
    equivalent: str = ""
    compiled: bool = True


def _python(note: str, file: str, old: str, new: str, *tests: str) -> Mutant:
    return Mutant(note, file, old, new, tests, compiled=False)


def _compiled(note: str, file: str, old: str, new: str, *tests: str) -> Mutant:
    return Mutant(note, file, old, new, tests)


def _equivalent(note: str, file: str, old: str, new: str, reason: str) -> Mutant:
    return Mutant(note, file, old, new, (), equivalent=reason)


MUTANTS = (
    # --- simulation
    _compiled(
        "acceleration of the motion angle without the tilt's rates",
        SAMPLE_KERNELS,
        "    change = 2.0 * (z * dz + s * ds) / square\n",
        "    return 0.0, 0.0\n    change = 2.0 * (z * dz + s * ds) / square\n",
        TEST_RECORD,
    ),
    _compiled(
        "contacts that are apart at a sample are recorded as they were before",
        SAMPLE_KERNELS,
        "            _apart_in(y, program, memory, pose[0], table)\n",
        "",
        TEST_SAMPLES,
    ),
    _compiled(
        "with distributed load the rows of a bore that does not touch are old",
        JOINTS,
        "patch_geometry(p, b, pose, table, not bore, not flanges)",
        "patch_geometry(p, b, pose, table, False, not flanges)",
        TEST_SAMPLES,
    ),
    _compiled(
        "a new contact keeps the bristles of the one before",
        EPISODE_KERNELS,
        "    for k in range(place.bristle, place.bristle + place.bristles):\n        y[k] = 0.0\n",
        "",
        TEST_GRAZES,
    ),
    _compiled(
        "a graze that touches changes back without end",
        LOOP,
        "            search.ignore[c] = 2\n",
        "            search.ignore[c] = 1\n",
        TEST_GRAZES,
        *("-k", "is_marked"),
    ),
    _compiled(
        "one trial only for the step that ends at a contact",
        TRIALS,
        "_RELOCATIONS = 5\n",
        "_RELOCATIONS = 1\n",
        TEST_GRAZES,
        *("-k", "made_again"),
    ),
    _compiled(
        "steps pass over a table's points",
        PACE,
        "    end = p.end if last else breaks[p.next]\n",
        "    end = p.end\n",
        TEST_RUN,
        *("-k", "table"),
    ),
    _compiled(
        "an impulse counts what the contact had before",
        EPISODE_KERNELS,
        "    episode.impulse = -y[place.impulse]\n",
        "    episode.impulse = 0.0\n",
        TEST_IMPACTS,
        *("-k", "closed_form"),
    ),
    _compiled(
        "no floor under the approach speed",
        EPISODE_KERNELS,
        "    memory.approach_speed = max(rate, place.floor)\n",
        "    memory.approach_speed = max(rate, 1e-9)\n",
        TEST_IMPACTS,
        *("-k", "at_rest"),
    ),
    _compiled(
        "a fast wheel may turn by any angle in a step",
        PACE,
        "LARGEST_TURN = 2.0 ",
        "LARGEST_TURN = 200.0 ",
        TEST_TURNS,
        *("-k", "turns_are_counted"),
    ),
    _compiled(
        "sizes of steps are forgotten from one run to the one that goes on",
        LOOP,
        "        self.control.sizes.take_up(state.sizes)\n",
        "",
        TEST_GOING_ON,
        *("-k", "two_halves or interrupted"),
    ),
    _compiled(
        "peaks of the dense output are not sampled",
        EPISODES,
        "            self.samples.insert(float(book.moments[c]), book.states[c], book.memories[c].copy())\n",
        "            pass\n",
        TEST_RUN,
        *("-k", "samples_are_at"),
    ),
    _compiled(
        "the tilt of a journal counts in radians",
        SETTINGS,
        "np.where(about, scales.angle, play / half)",
        "np.where(about, scales.angle, scales.angle)",
        TEST_RECORD,
    ),
    _compiled(
        "the tilt's rate of a journal counts in radians a second",
        SETTINGS,
        "about, scales.angular_velocity, scales.clearance_velocity / half\n",
        "about, scales.angular_velocity, scales.angular_velocity\n",
        TEST_RECORD,
    ),
    _compiled(
        "the ledger forgets the dampers",
        SEEN,
        '    "dissipation_damper": 1.0,\n',
        "",
        TEST_RUN,
        *("-k", "damped_oscillator"),
    ),
    # --- events
    _compiled(
        "of events at one instant only the first happens",
        WATCH,
        "if crossing.theta - found[0].theta <= _SAME_INSTANT]\n",
        "][:1]\n",
        TEST_EVENTS,
        *("-k", "bounces"),
    ),
    _compiled(
        "a step that ends at an event is not corrected",
        WATCH,
        "_LARGEST_CORRECTION = 1e-2\n",
        "_LARGEST_CORRECTION = 0.0\n",
        TEST_EVENTS,
        *("-k", "converge"),
    ),
    _compiled(
        "what dips between two looks is passed over",
        WATCH,
        "            elif side * ra < 0.0 < side * rb:\n",
        "            elif False:\n",
        TEST_EVENTS,
        *("-k", "dips"),
    ),
    _compiled(
        "an event forgets from one run to the one that goes on",
        WATCH,
        "            if one is not None:\n",
        "            if False:\n",
        TEST_EVENTS,
        *("-k", "two_halves or interrupted"),
    ),
    _compiled(
        "what events have changed is forgotten by the run that goes on",
        LOOP,
        "        for place, value in state.adjusted:\n",
        "        for place, value in ():\n",
        TEST_EVENTS,
        *("-k", "two_halves or interrupted"),
    ),
    _compiled(
        "all passages count, whatever the direction",
        EVENTS,
        "        return self.direction in (0, side)\n",
        "        return True\n",
        TEST_EVENTS,
        *("-k", "turns_back"),
    ),
    _compiled(
        "the ledger does not know what an event has brought in",
        ACTIONS,
        "            energy += self._energy()\n",
        "            energy = 0.0\n",
        TEST_EVENTS,
        *("-k", "bounces or stiffens"),
    ),
    # --- dynamics
    _compiled(
        "the scale of linear momentum includes the bus",
        TREE,
        '        body["counts"] = not (free and i == 1)\n',
        '        body["counts"] = True\n',
        TEST_AUDIT,
    ),
    _compiled(
        "angular momenta about the world's origin",
        AUDIT_KERNELS,
        "dx, dy, dz = own.origin[0] + sx - cx, own.origin[1] + sy - cy, own.origin[2] + sz - cz\n",
        "dx, dy, dz = own.origin[0] + sx, own.origin[1] + sy, own.origin[2] + sz\n",
        TEST_AUDIT,
    ),
    _compiled(
        "linear tables are not stepped on",
        TABLE,
        'return self.time if self.interpolation == "linear"',
        'return () if self.interpolation == "linear"',
        TEST_RUN,
        *("-k", "table"),
    ),
    _compiled(
        "cubic tables without their slope",
        CURVE,
        "        coefficients = PchipInterpolator(t, y).c.T\n",
        "        coefficients = PchipInterpolator(t, y).c.T * (1.0, 1.0, 0.0, 1.0)\n",
        TEST_DRIVES,
        *("-k", "table"),
    ),
    _python(
        "power of a drive at a journal about the wrong axis",
        DYNAMICS,
        "rate + nx * y[nq + k] + ny * y[nq + k + 1] + nz * y[nq + k + 2])",
        "rate + y[nq + k + 2])",
        TEST_ELEMENTS,
        *("-k", "couple"),
    ),
    _python(
        "gross work counts signs",
        LEDGER_KERNELS,
        "    works.gross_work = abs(power)\n",
        "    works.gross_work = power\n",
        TEST_ELEMENTS,
        TEST_RUN,
        *("-k", "drive"),
    ),
    _python(
        "a spring at a tilted journal acts about its axis alone",
        DYNAMICS,
        "    if e.about == ABOUT_MOTION and j.slides == 0:\n",
        "    if e.about == -1 and j.slides == 0:\n",
        TEST_ELEMENTS,
        *("-k", "gradient"),
    ),
    _python(
        "a damper loses with the wrong sign",
        SPRING_KERNELS,
        ".damping * rate * rate\n",
        ".damping * -rate * rate\n",
        TEST_ELEMENTS,
        *("-k", "damper"),
    ),
    _python(
        "a controller's reference has no rate of its own",
        PD_KERNELS,
        "    rate = pd.rate + pd.amplitude * omega * math.cos(turned)\n",
        "    rate = pd.rate\n",
        TEST_PD,
        *WITHOUT_RUNS,
    ),
    _python(
        "a controller's torque has no limit below",
        PD_KERNELS,
        "min(max(demand(words, at, t, angle, rate), -limit), limit)",
        "min(demand(words, at, t, angle, rate), limit)",
        TEST_PD,
        *WITHOUT_RUNS,
    ),
    _equivalent(
        "a table's point belongs to the piece before it",
        CURVE_KERNELS,
        "        if words[at + middle] <= t:\n",
        "        if words[at + middle] < t:\n",
        "torques of linear and monotone cubic tables are continuous: both pieces say the same there",
    ),
    _python(
        "turned angles are not brought up to date",
        DYNAMICS,
        "        y[at] = unwrapped(angle, y[at])\n",
        "",
        TEST_TURNS,
        *("-k", "unwinds or counted"),
    ),
    _compiled(
        "no margin for dips whose curvature changes",
        INSPECT,
        "            if fa + 2.0 * rise_of",
        "            if fa + rise_of",
        TEST_GRAZES,
        *("-k", "dip"),
    ),
    _equivalent(
        "a larger margin for dips",
        INSPECT,
        "            if fa + 2.0 * rise_of",
        "            if fa + 3.0 * rise_of",
        "more dips are looked at, each by its own gap: it takes longer and finds the same",
    ),
    _compiled(
        "no dips are looked for",
        INSPECT,
        "        if da > 0.0 > db:\n",
        "        if False:\n",
        TEST_GRAZES,
        TEST_IMPACTS,
        *("-k", "dip or no_contact_is_lost"),
    ),
    _compiled(
        "depths are not looked at for being too deep",
        INSPECT,
        "                deep = True\n",
        "                deep = False\n",
        TEST_IMPACTS,
        *("-k", "too_deep"),
    ),
    _compiled(
        "depths at the points of a step only",
        PEAKS,
        "            if not rate",
        "            if rate",
        TEST_IMPACTS,
        *("-k", "closed_form or hertz_depth"),
    ),
    _compiled(
        "peaks at the points of a step only",
        PEAKS,
        "        if force > 0.0 and _may_pass",
        "        if force < 0.0 and _may_pass",
        TEST_IMPACTS,
        *("-k", "closed_form or hertz_depth"),
    ),
    _compiled(
        "the effective mass counts free accelerations",
        WORKSPACE,
        "(self._accelerate(0.0, at_rest, direction) - free)",
        "self._accelerate(0.0, at_rest, direction)",
        TEST_AUDIT,
        *("-k", "mass"),
    ),
    _compiled(
        "a closure forgets what a way along a turning axis makes",
        ROWS,
        "cross(a.spin, way, k) + 2.0 * seen[k]",
        "cross(a.spin, way, k) + seen[k]",
        TEST_CLOSURES,
    ),
    _compiled(
        "axes at right angles forget how they turn",
        ROWS,
        "lack -= a.slide[n] * bias_spin[n] + turning * spin[n]",
        "lack -= a.slide[n] * bias_spin[n]",
        TEST_CLOSURES,
    ),
    _compiled(
        "velocities are not corrected",
        SOLVER,
        "        y[nq : nq + nv] += self.step(of_speed=True)\n",
        "",
        TEST_CLOSURES,
    ),
    _compiled(
        "redundant rows carry nothing",
        FORCES,
        "        out[int(work[order + rank + c])] = carried[c]\n",
        "        out[int(work[order + rank + c])] = 0.0\n",
        TEST_CLOSURES,
    ),
    _compiled(
        "what corrections put in is not booked",
        WORKSPACE,
        "+= self._stored(y) - before",
        "+= 0.0 * before",
        TEST_CLOSURES,
    ),
    _compiled(
        "motions do no work",
        SOLVE,
        "power = scale * work[head.force + driven.row] * rate",
        "power = 0.0 * scale",
        TEST_CLOSURES,
    ),
    # --- joints
    _python(
        "velocity of an offset journal without its spin",
        POSE,
        "    vx = y[k] + wy * cz - wz * cy\n",
        "    vx = y[k]\n",
        TEST_JOINT,
        "tests/test_assemble.py",
        *("-k", "pose or placed or offset or frame or wherever"),
    ),
    _python(
        "the journal on the parent moves without the child's turning",
        POSE,
        "    vx = wz * dy - wy * dz - y[k]\n",
        "    vx = -y[k]\n",
        TEST_ON_CHILD,
        *IN_STATES,
    ),
    _python(
        "the reaction on the child acts at the bearing's centre",
        POSE,
        "    mx, my, mz = mx + ry * fz - rz * fy, my + rz * fx - rx * fz, mz + rx * fy - ry * fx\n",
        "",
        TEST_ON_CHILD,
        *IN_STATES,
    ),
    _python(
        "a bearing on the child slides the wrong way",
        POSE,
        "        way = ax * (cx - dx) + ay * (cy - dy) + az * (cz - dz)\n",
        "        way = ax * (dx - cx) + ay * (dy - cy) + az * (dz - cz)\n",
        TEST_ON_CHILD,
        *IN_STATES,
    ),
    _python(
        "a drive takes the journal's axis for the bearing's on the child",
        DYNAMICS,
        "    elif (e.about == ABOUT_JOURNAL) == (j.on_child != 0):\n",
        "    elif e.about != ABOUT_JOURNAL:\n",
        TEST_ON_CHILD,
        *IN_STATES,
    ),
    _python(
        "slip without the journal's spin",
        ROW,
        "    vx = pose.velocity[0] + pose.spin[1] * rz - pose.spin[2] * ry\n",
        "    vx = pose.velocity[0]\n",
        TEST_JOINT,
    ),
    _python(
        "the torque about the journal's centre has a wrong sign",
        ROW,
        "    return gx, gy, gz, ry * gz - rz * gy, rz * gx - rx * gz, rx * gy - ry * gx\n",
        "    return gx, gy, gz, ry * gz - rz * gy, rx * gz - rz * gx, rx * gy - ry * gx\n",
        TEST_JOINT,
    ),
    _compiled(
        "what friction loses counts with the wrong sign",
        ROW,
        "    return -float(power)\n",
        "    return float(power)\n",
        "tests/simulation/test_laws_in_runs.py",
        *("-k", "bristles_are"),
    ),
    _compiled(
        "what the spring does not give back is not lost",
        JOINTS,
        "        lost = (out.force - out.elastic) * out.rate\n",
        "        lost = 0.0\n",
        TEST_IMPACTS,
        *("-k", "restitution"),
    ),
    _compiled(
        "the work of moving a flange's force is forgotten",
        JOINTS,
        "            lost += arm_power(pose, out)\n",
        "            lost += 0.0\n",
        TEST_FLANGE,
        *("-k", "ledger"),
    ),
    _python(
        "the force of a flat flange stays at its rim",
        ROW,
        "    rest = 1.0 - lever(-out.gap, whole)\n",
        "    rest = 0.0\n",
        TEST_FLANGE,
        *("-k", "from_the_axis"),
    ),
    _python(
        "the lever's polynomial has a kink",
        ROW,
        "    return s * s * s * (10.0 - s * (15.0 - 6.0 * s))\n",
        "    return s * s * s * (9.0 - s * (15.0 - 6.0 * s))\n",
        TEST_FLANGE,
        *("-k", "from_the_axis"),
    ),
    _python(
        "sectors whose forces have no potential",
        PATCH,
        "            share *= 1.0 + alpha + gamma * x * x\n",
        "",
        TEST_DISTRIBUTED,
        *("-k", "derives"),
    ),
    _python(
        "whole turns are rounded down",
        TREE_KERNELS,
        "math.floor((near - angle) / (2.0 * math.pi) + 0.5)",
        "math.floor((near - angle) / (2.0 * math.pi))",
        TEST_TURNS,
        *("-k", "unwinds"),
    ),
    _python(
        "the motion angle's rate without one of the tilts",
        POSE,
        "    return angle, (hz * hx - qw * hy) / square, (qw * hx + hz * hy) / square\n",
        "    return angle, (hz * hx - qw * hy) / square, 0.0\n",
        TEST_ELEMENTS,
        *("-k", "rate_of_the_motion"),
    ),
    # --- geometry
    _python(
        "ends on opposite sides are a line where the middle is pressed, at one end",
        REVOLUTE,
        "same_plus > 0.0 and same_minus > 0.0:",
        "same_plus > 0.0:",
        TEST_SCENARIOS,
        *("-k", "opposite"),
    ),
    _python(
        "ends on opposite sides are a line where the middle is pressed, at the other end",
        REVOLUTE,
        "same_plus > 0.0 and same_minus > 0.0:",
        "same_minus > 0.0:",
        TEST_SCENARIOS,
        *("-k", "opposite"),
    ),
    _python(
        "ends on opposite sides are a line",
        REVOLUTE,
        "        if spare.gap < 0.0 and same_plus",
        "        if same_plus",
        TEST_SCENARIOS,
    ),
    _python(
        "a flange is a surface at half its edge",
        REVOLUTE,
        "    whole = 2.0 * min(shape.outer_radius, shape.flange_radius) * pose.sine\n",
        "    whole = min(shape.outer_radius, shape.flange_radius) * pose.sine\n",
        TEST_SCENARIOS,
        *("-k", "surface"),
    ),
    _compiled(
        "a journal's axis outside the bore counts as inside",
        REVOLUTE,
        "        side_of_wall = -1.0\n",
        "        side_of_wall = 1.0\n",
        TEST_START,
        *("-k", "gap_falls or cannot_have"),
    ),
    _compiled(
        "the end circle is seen as a circle",
        REVOLUTE,
        "    ea, eb = nearest_on_ellipse(radius, radius * shrink, -da, -db)\n",
        "    ea, eb = nearest_on_ellipse(radius, radius, -da, -db)\n",
        TEST_GAPS,
        *("-k", "radial"),
    ),
    _compiled(
        "Newton's steps to the ellipse end early",
        REVOLUTE,
        "            elif abs(step) <= 3e-9 * s:",
        "            elif abs(step) <= 3e-3 * s:",
        TEST_GAPS,
        *("-k", "ellipse or radial"),
    ),
    # --- integrate
    _python(
        "averaged velocities on the group",
        MANIFOLD,
        "    out[r, j] = wx + 0.5 * cx + f * (y * cz - z * cy)\n",
        "    out[r, j] = wx\n",
        TEST_MANIFOLD,
        TEST_ORDER,
        *("-k", "chart_rate or averaged"),
    ),
    _python(
        "the inverse Jacobian's last term has a wrong factor",
        MANIFOLD,
        "        f = (1.0 - 0.5 * angle / math.tan(0.5 * angle)) / square\n",
        "        f = 1.0 / 12.0\n",
        TEST_MANIFOLD,
        *("-k", "chart_rate or series"),
    ),
    _python(
        "the rotation's series is short of a term",
        MANIFOLD,
        "        f = 0.5 * (1.0 - square / 24.0 * (1.0 - square / 80.0 * (1.0 - square / 168.0)))\n",
        "        f = 0.5 * (1.0 - square / 24.0)\n",
        TEST_MANIFOLD,
        *("-k", "series or compose"),
    ),
    _python(
        "errors of the last stage do not count",
        INTEGRATE,
        "        for j in range(i + 1):\n            first += errors[0, j] * work[j, k]\n",
        "        for j in range(i):\n            first += errors[0, j] * work[j, k]\n",
        TEST_STEPPER,
        *("-k", "error or scipy"),
    ),
    _python(
        "the errors of integrals do not count",
        INTEGRATE,
        "    return motion if motion != motion or motion >= plain else plain\n",
        "    return motion\n",
        TEST_STEPPER,
        *("-k", "error or count"),
    ),
    _python(
        "a vector's error is measured by its components",
        INTEGRATE,
        "        linear = 3 if kind == RIGID else 2 if kind == PLANE else 0\n",
        "        linear = 0\n",
        TEST_STEPPER,
        *("-k", "axes_lie"),
    ),
    _python(
        "the state after dense output is the last extra stage's",
        STEPPER,
        "            self.work[method.stages + _kernels.STATE :] = end\n",
        "",
        TEST_STEPPER,
        TEST_ORDER,
        *("-k", "dense"),
    ),
    _python(
        "a restarted step keeps the dense output of the one before",
        STEPPER,
        "        self.h = h\n        self.has_dense = False\n",
        "        self.h = h\n",
        TEST_STEPPER,
        *("-k", "dense"),
    ),
    _python(
        "an implicit step's error is estimated with weights exchanged",
        IMPLICIT,
        "[-13.0 - 7.0 * root, -13.0 + 7.0 * root, -1.0]",
        "[-13.0 + 7.0 * root, -13.0 - 7.0 * root, -1.0]",
        TEST_IMPLICIT,
    ),
    _python(
        "an implicit step keeps the Jacobian of the step before",
        IMPLICIT,
        '        super().accept()\n        self.newton.progress["fresh"] = 0\n',
        "        super().accept()\n",
        TEST_IMPLICIT,
    ),
    _python(
        "an implicit step that cannot be solved passes",
        IMPLICIT,
        "            return _kernels.NOT_SOLVED\n",
        "            return 0.0\n",
        TEST_IMPLICIT,
    ),
    _python(
        "an implicit step ends where its error was looked at",
        RADAU,
        "        write_state(radau.z, END, stages, layout, work)\n        p.error = estimate(h, ERROR_ROW",
        "        p.error = estimate(h, ERROR_ROW",
        TEST_IMPLICIT,
    ),
    _python(
        "Newton's steps of an implicit step end after the second",
        RADAU,
        "(rate < 1.0 and rate / (1.0 - rate) * p.step <= wanted)",
        "p.rounds == 2",
        TEST_IMPLICIT,
    ),
    _python(
        "a Jacobian's column is that of a difference to rest",
        NEWTON,
        "(work[ERROR_ROW, k] - work[0, k]) / way",
        "work[ERROR_ROW, k] / way",
        TEST_IMPLICIT,
    ),
    # --- flexible links
    _python(
        "a mode on a slide has half of its damping",
        "antenna_pin/flexible/realised.py",
        "        damping=2.0 * ratio * omega * mass,\n",
        "        damping=ratio * omega * mass,\n",
        TEST_PARTS,
        *("-k", "every_mode"),
    ),
    _python(
        "the body of a mode on a hinge is on the wrong side",
        "antenna_pin/flexible/realised.py",
        "np.cross(along, across - lever * axis) / size",
        "np.cross(along, across + lever * axis) / size",
        TEST_PARTS,
        *("-k", "every_mode"),
    ),
    _python(
        "the hub keeps the mass of its parts",
        "antenna_pin/flexible/inertia.py",
        "MassProperties.of_moments(self.moments - sum(part.moments for part in parts))",
        "self",
        TEST_PARTS,
        *("-k", "hub_and_parts"),
    ),
    _python(
        "participations are about the far side of the root",
        "antenna_pin/flexible/modal_data.py",
        "rotation + np.cross(np.array(self.root_xyz), translation)",
        "rotation - np.cross(np.array(self.root_xyz), translation)",
        TEST_PARTS,
        *("-k", "as_pinocchio_says"),
    ),
    _python(
        "a petal's mass is all over its middle line",
        "antenna_pin/flexible/petals.py",
        "first = np.array([cos * (share @ r), 0.0, share @ z])",
        "first = np.array([share @ r, 0.0, share @ z])",
        TEST_PARTS,
        *("-k", "sector"),
    ),
    _python(
        "a petal's moment of inertia leaves out its height",
        "antenna_pin/flexible/petals.py",
        "(arm[0] ** 2 + arm[2] ** 2)",
        "(arm[0] ** 2)",
        TEST_PARTS,
        *("-k", "hub_held"),
    ),
    _compiled(
        "an elastic part's energy is twice as large in the result",
        "antenna_pin/dynamics/deflection.py",
        "energy[:, k] = 0.5 * stiffness",
        "energy[:, k] = stiffness",
        *("tests/flexible/test_runs.py", "-k", "decay"),
    ),
    _compiled(
        "of the parts that move a shape only the first is drawn",
        "antenna_pin/record/bending.py",
        'for part in (name, *one["with"])',
        "for part in (name,)",
        *("tests/record/test_bending.py", "-k", "twists"),
    ),
    _python(
        "modes of closed loops lack the geometric stiffness of what the loops carry",
        LINEARISATION,
        "by_place - derived.position - held.force",
        "by_place - derived.position",
        TEST_MODES_OF_LOOPS,
    ),
    _python(
        "small motions of a loop that turns keep their velocity where they are displaced",
        LINEARISATION,
        "+ (by_speed - derived.rate) @ shift",
        "+ 0.0 * shift",
        TEST_MODES_OF_LOOPS,
    ),
    _python(
        "bristles that stick are no springs to undamped frequencies",
        LINEARISATION,
        "self.stiffness - to_force @ by_speed",
        "self.stiffness",
        "tests/linear/test_play.py",
    ),
    _compiled(
        "a neighbour does not keep its own approach speed",
        CHART,
        "memory[self._remembered] *= np.exp(z[bristles:])",
        "pass",
        "tests/nonlinear/test_chart.py",
    ),
    _compiled(
        "neighbours of a loop are off its closures",
        CHART,
        "self._close(workspace, workspace.constraints, y, way)",
        "pass",
        "tests/nonlinear/test_chart.py",
    ),
    _compiled(
        "neighbours of a loop are beside where they are asked for",
        CHART,
        "self._close(workspace, workspace.constraints, y, way)",
        "workspace.hold(origin.time, y)",
        "tests/nonlinear/test_chart.py",
    ),
    _compiled(
        "a torus is where the product of two multipliers is -1",
        "antenna_pin/nonlinear/bifurcations.py",
        "one * other - 1.0",
        "one * other + 1.0",
        "tests/nonlinear/test_continuation.py",
    ),
    _compiled(
        "differences give up where their largest steps do",
        "antenna_pin/nonlinear/flow.py",
        "            continue\n    return slope(function, _STEPS[-1:])",
        "            raise\n    return slope(function, _STEPS[-1:])",
        "tests/nonlinear/test_variational.py",
    ),
    _compiled(
        "an event does nothing to a displacement",
        SALTATION,
        "passage.moved + np.outer(passage.going - field.flow(time, y), passage.late)",
        "passage.moved",
        "tests/nonlinear/test_variational.py",
    ),
    _compiled(
        "a neighbour remembers the state's own approach speed",
        SALTATION,
        "found.matrix[k], found.other[k] = onset.rows[column]",
        "pass",
        "tests/nonlinear/test_variational.py",
    ),
    _compiled(
        "displacements turn with the body the wrong way",
        FIELD,
        "lift.up[rate] - self.system.manifold.bracket(v, lift.up[way])",
        "lift.up[rate] + self.system.manifold.bracket(v, lift.up[way])",
        "tests/nonlinear/test_variational.py",
    ),
    _compiled(
        "the rates of a loop's neighbours are those of the loop itself",
        FIELD,
        "wanted = np.hstack([turned, rows @ up[rate, n : 2 * n]])",
        "wanted = np.hstack([0.0 * turned, rows @ up[rate, n : 2 * n]])",
        "tests/nonlinear/test_variational.py",
    ),
    _compiled(
        "a direction has the same numbers in every chart",
        CHART,
        "return np.concatenate([self.frame.free.T @ way, self.frame.free.T @ rate, z[2 * n :]])",
        "return z",
        "tests/nonlinear/test_chart.py",
    ),
    _compiled(
        "a branch over a length leaves its loops open",
        "antenna_pin/nonlinear/follower.py",
        "chart.state(np.zeros(chart.size), flow.system)",
        "chart.origin",
        "tests/nonlinear/test_continuation.py",
    ),
    _compiled(
        "small turns are none",
        "antenna_pin/nonlinear/frames.py",
        "way[j + nv - 1] = turn",
        "pass",
        "tests/nonlinear/test_chart.py",
    ),
    _compiled(
        "a fold is where the step that goes round it ends",
        "antenna_pin/nonlinear/locate.py",
        "doubt = abs(step.slope(nearest) * (high - low) * step.follower.unit)",
        "doubt = 0.0",
        "tests/nonlinear/test_continuation.py",
    ),
    _compiled(
        "growth is not over the distance begun with",
        "antenna_pin/nonlinear/lyapunov.py",
        "math.log(distance / _DISTANCE)",
        "math.log(distance)",
        "tests/nonlinear/test_lyapunov.py",
    ),
    _compiled(
        "a bearing that turns adds nothing to the velocity of a journal in it",
        "antenna_pin/analysis/_body_quantities.py",
        "seen = rates[1] - rates[0] - np.cross(spin, places[1] - places[0])",
        "seen = rates[1] - rates[0]",
        "tests/analysis/test_quantity.py",
    ),
    _python(
        "points hardly farther apart than the tolerance have a period",
        "antenna_pin/plot/attractors.py",
        "if found.period in (None, 1):",
        "if True:",
        "tests/plot/test_attractors.py",
    ),
    _python(
        "a diagram is judged by its first points, not by those that settled",
        "antenna_pin/analysis/diagrams.py",
        "if not settled or not len(points):",
        "if not len(points):",
        "tests/plot/test_attractors.py",
    ),
    _compiled(
        "a run that goes on forgets the error of its last step",
        "antenna_pin/simulation/loop.py",
        "self.control.error = state.error",
        "pass",
        TEST_GOING_ON,
    ),
)
