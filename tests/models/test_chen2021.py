"""The 4UPS-UPU of Chen and Cui 2021: its geometry and ranks, and the ideal mechanism by other equations.

The equations are a short formulation of these tests' own: nothing in them is taken from the package. The
platform is not turned, so that the joints' places on it are fixed; virtual power gives the forces leg by
leg.
"""

import json
import tomllib

import numpy as np
import pytest
from closure_force import force_of_closure

from antenna_pin import load_scenario, models_path, simulate
from antenna_pin.analysis import body_motion, joint_loads, quantity
from antenna_pin.mechanism import Urdf, build_mechanism

FOLDER = models_path() / "chen2021"
SCENARIO = tomllib.loads((FOLDER / "scenario.toml").read_text())
CLOSED_FORM = "clearance.s2.geometry=closed-form"

ROOT = np.sqrt(0.5)
BASE_RADIUS = np.array([0.71, 0.65, 0.65, 0.65, 0.65])
BASE_ANGLE = np.radians([180.0, 225.0, 135.0, 45.0, 315.0])
PLATFORM_RADIUS = 0.202
PLATFORM_ANGLE = np.radians([180.0, 252.0, 108.0, 36.0, 324.0])
#: First axes of the base's universal joints.
FIRST_AXES = np.array(
    [(0, 0, 1), (0, -ROOT, ROOT), (0, -ROOT, -ROOT), (0, ROOT, -ROOT), (0, ROOT, ROOT)], dtype=float
)
DOWN = np.array([1.0, 0.0, 0.0])
GRAVITY = 9.81 * DOWN
#: Mass, mass centre from its joint, moments along and across the rod.
SWING = (25.96, 0.38, 0.018, 1.25)
TELESCOPIC = (8.45, 0.45, 0.0016, 0.545)
PLATFORM_MASS = 37.48
LEGS = range(5)


def _circle(radius, angle):
    return np.stack([np.zeros_like(angle), radius * np.cos(angle), radius * np.sin(angle)], axis=-1)


BASE_JOINTS = _circle(BASE_RADIUS, BASE_ANGLE)
PLATFORM_JOINTS = _circle(PLATFORM_RADIUS, PLATFORM_ANGLE)


def path(t):
    """Return position, velocity and acceleration of the platform's centre: equation (32)."""
    s, c, w = np.sin(np.pi * t), np.cos(np.pi * t), np.pi
    return (
        np.array([1.1, 0.05 * s, 0.05 * c]),
        0.05 * w * np.array([0.0, c, -s]),
        -0.05 * w**2 * np.array([0.0, s, c]),
    )


def leg_frame(k):
    """Return the axes of a leg's joint frame in the world, as columns: X, f x X, f."""
    f = FIRST_AXES[k]
    return np.column_stack([DOWN, np.cross(f, DOWN), f])


class Leg:
    """One leg at an instant: its coordinates (turn about f, turn about y, length) and their derivatives."""

    def __init__(self, k, t):
        frame = leg_frame(k)
        position, velocity, acceleration = (frame.T @ each for each in path(t))
        to = position + frame.T @ (PLATFORM_JOINTS[k] - BASE_JOINTS[k])
        h = np.linalg.norm(to)
        swing, tilt = np.arctan2(to[1], to[0]), -np.arcsin(to[2] / h)
        cs, ss, ct, st = np.cos(swing), np.sin(swing), np.cos(tilt), np.sin(tilt)
        z, y, rod = np.array([0.0, 0.0, 1.0]), np.array([-ss, cs, 0.0]), np.array([cs * ct, ss * ct, -st])
        # Velocity of the platform's joint by the coordinates' rates.
        jacobian = np.column_stack([h * np.cross(z, rod), h * np.cross(y, rod), rod])
        rates = np.linalg.solve(jacobian, velocity)
        omega = rates[0] * z + rates[1] * y
        bias = np.cross(omega, h * np.cross(omega, rod)) + 2.0 * rates[2] * np.cross(omega, rod)
        turning = rates[0] * rates[1] * np.cross(z, y)  # of the second axis
        bias += np.cross(turning, h * rod)
        second = np.linalg.solve(jacobian, acceleration - bias)
        alpha = second[0] * z + second[1] * y + turning
        self.coordinates, self.rates = np.array([swing, tilt, h]), rates
        self.frame, self.jacobian, self.rod, self.second_axis = frame, jacobian, rod, y
        # Generalized forces that the two rods need: virtual power of their inertia and weight.
        gravity, self.needed = frame.T @ GRAVITY, np.zeros(3)
        for (mass, centre, along, across), slides in ((SWING, False), (TELESCOPIC, True)):
            way = h - centre if slides else centre
            arm = way * rod
            linear = np.cross(alpha, arm) + np.cross(omega, np.cross(omega, arm))
            if slides:
                linear += 2.0 * rates[2] * np.cross(omega, rod) + second[2] * rod
            inertia = across * np.eye(3) + (along - across) * np.outer(rod, rod)
            torque = inertia @ alpha + np.cross(omega, inertia @ omega)
            partial = np.column_stack([np.cross(z, arm), np.cross(y, arm), rod if slides else 0.0 * rod])
            self.needed += partial.T @ (mass * (linear - gravity))
            self.needed += np.array([z @ torque, y @ torque, 0.0])


def inverse_dynamics(t):
    """Return the five drive forces and the five forces of the rods on the platform [N], (5,) and (5, 3).

    A leg gives the platform the force that its coordinates do not need for themselves; the platform's six
    equations then have six unknowns, the drives and the moment of leg 1's universal joint.
    """
    legs = [Leg(k, t) for k in LEGS]
    columns, known = np.zeros((6, 6)), np.zeros(6)
    maps = []
    for k, leg in enumerate(legs):
        to_world = leg.frame @ np.linalg.inv(leg.jacobian).T
        maps.append(to_world)
        for target, force in ((columns[:, k], to_world[:, 2]), (known, -to_world @ leg.needed)):
            target[:3] += force
            target[3:] += np.cross(PLATFORM_JOINTS[k], force)
    # Square to the cross of leg 1, so to the rod's y and to the platform's z, which is f_1 too: a moment
    # about it does no work on the leg.
    columns[3:, 5] = np.cross(legs[0].frame @ legs[0].second_axis, FIRST_AXES[0])
    wanted = np.concatenate([PLATFORM_MASS * (path(t)[2] - GRAVITY), np.zeros(3)])
    solved = np.linalg.solve(columns, wanted - known)
    forces = [maps[k] @ (np.array([0.0, 0.0, solved[k]]) - legs[k].needed) for k in LEGS]
    return solved[:5], np.array(forces)


def constraint_rows(t, *, clearance, driven):
    """Return the rates of all joints' constraints by the twists of eleven bodies, (rows, 66).

    Bodies: five swing rods, five telescopic rods, the platform; each by the velocity of its point at the
    world's origin and its angular velocity.
    """
    legs = [Leg(k, t) for k in LEGS]
    position = path(t)[0]
    rows = []

    def add(plus, minus, direction, point=None):
        """One row: the relative velocity of a point, or the relative angular velocity, along a direction."""
        row = np.zeros(66)
        wrench = (
            np.concatenate([np.zeros(3), direction])
            if point is None
            else np.concatenate([direction, np.cross(point, direction)])
        )
        row[6 * plus : 6 * plus + 6] = wrench
        if minus is not None:
            row[6 * minus : 6 * minus + 6] = -wrench
        rows.append(row)

    for k, leg in enumerate(legs):
        rod, second = leg.frame @ leg.rod, leg.frame @ leg.second_axis
        third = np.cross(rod, second)
        end = position + PLATFORM_JOINTS[k]
        for axis in np.eye(3):  # universal joint at the base
            add(k, None, axis, BASE_JOINTS[k])
        add(k, None, np.cross(FIRST_AXES[k], second))
        for axis in np.eye(3):  # slide
            add(5 + k, k, axis)
        for axis in (second, third):
            add(5 + k, k, axis, end)
        if driven:
            add(5 + k, k, rod, end)
        if k == 1 and clearance:
            continue
        for axis in np.eye(3):
            add(10, 5 + k, axis, end)
        if k == 0:  # universal joint at the platform
            add(10, 5 + k, np.cross(second, FIRST_AXES[0]))
    return np.array(rows)


# --- geometry ----------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def mechanism():
    urdf = Urdf.from_text((FOLDER / "mechanism.urdf").read_text(), "mechanism.urdf")
    return build_mechanism(urdf, "fixed", GRAVITY)


# --- runs --------------------------------------------------------------------------------------------------

CASES = list(SCENARIO["cases"])


def scenario(case, *overrides):
    return load_scenario("chen2021", case=case, overrides=[CLOSED_FORM, *overrides])


@pytest.fixture(scope="module")
def ideal_run():
    return simulate(scenario("ideal"), duration=2.0)


@pytest.fixture(scope="module")
def played_run():
    """Long enough for the impacts of the start to die away, within 0.5 s."""
    return simulate(scenario("friction-010"), duration=1.0)


@pytest.mark.parametrize("case", CASES)
def test_every_case_starts_closed_with_the_ball_centred_and_ideal_velocities(case):
    run = simulate(scenario(case), duration=1e-4)
    assert run.completed, run.message
    held = run.constraints
    for name in ("position_residual", "angle_residual"):
        assert held[name] < 1e-10
    for name in ("velocity_residual", "rate_residual"):
        assert held[name] < 1e-9
    # What assembly leaves, 1e-12, times the mechanism's condition, some 50.
    start = run.data.isel(time=0)
    for k in LEGS:
        leg, joints = Leg(k, 0.0), [f"swing{k + 1}", f"tilt{k + 1}"]
        assert start["motion_angle"].sel(joint=joints).values == pytest.approx(leg.coordinates[:2], abs=1e-10)
        assert start["motion_rate"].sel(joint=joints).values == pytest.approx(leg.rates[:2], abs=1e-10)
    if "clearance_joint" in run.data.dims:
        assert np.abs(run.data["journal_position"].values[0]).max() < 1e-12


@pytest.mark.parametrize(
    ("case", "equations", "free", "left"), [("ideal", 16, 5, 0), ("friction-010", 13, 8, 3)]
)
def test_constraints_are_counted(case, equations, free, left):
    """In the tree's 21 coordinates: three of a leg and six of the platform."""
    held = simulate(scenario(case), duration=1e-5).constraints
    assert held["freedoms"] == 21
    assert held["closure_equations"] == held["closure_rank"] == equations
    assert held["motions"] == 5
    assert held["mobility"] == free
    assert held["freedoms_left"] == left


def test_the_ideal_platform_follows_its_path(ideal_run):
    """Nothing is integrated freely: what is left is how well the closures are kept, below 1e-10 m."""
    motion = body_motion(ideal_run, "platform")
    wanted = np.array([path(t) for t in ideal_run.data["time"].values])
    assert np.abs(motion["position"].values - wanted[:, 0]).max() < 1e-9
    assert np.abs(motion["velocity"].values - wanted[:, 1]).max() < 1e-8
    assert np.abs(motion["rotation"].values).max() < 1e-8


def test_the_drives_of_the_ideal_mechanism_are_its_inverse_dynamics(ideal_run):
    """And so are the forces in all joints at the platform; of the largest, 1e-8."""
    times = ideal_run.data["time"].values
    samples = np.arange(0, times.size, 40)
    drives, forces = (
        np.array(each) for each in zip(*(inverse_dynamics(times[i]) for i in samples), strict=True)
    )
    found = ideal_run.data["drive_torque"].sel(drive=[f"leg{k + 1}" for k in LEGS]).values[samples]
    assert np.abs(found - drives).max() < 1e-8 * np.abs(drives).max()
    for name, k in (("u1", 0), ("s2", 1), ("s3", 2), ("s4", 3), ("s5", 4)):
        apart = force_of_closure(ideal_run, name)[samples] - forces[:, k]
        assert np.abs(apart).max() < 1e-8 * np.abs(drives).max()
    passed = joint_loads(ideal_run, samples)["force"].sel(moving_joint="s2").values
    assert np.abs(passed - forces[:, 1]).max() < 1e-8 * np.abs(drives).max()
    # The power of the drives is what changes the energy.
    kept = json.loads(ideal_run.data.attrs["conservation"])
    assert kept["energy_error"] < 1e-9 * kept["gross_work"]


def test_forces_are_those_of_the_readme():
    """Of the ideal mechanism, over a period; the paper's are 0.46 of them and swing about as far."""
    drives, forces = (
        np.array(each) for each in zip(*map(inverse_dynamics, np.linspace(0.0, 2.0, 201)), strict=True)
    )
    size = np.linalg.norm(forces[:, 1], axis=1)
    assert (size.min(), size.max()) == pytest.approx((271.0, 342.1), abs=0.1)
    assert size.max() / size.min() == pytest.approx(1.26, abs=0.005)
    assert drives.min(axis=0) == pytest.approx([-737.9, 190.0, 190.0, -358.1, -358.1], abs=0.1)
    assert drives.max(axis=0) == pytest.approx([-638.3, 261.6, 261.6, -301.5, -301.5], abs=0.1)
    paper = {0.05: (115.4, 162.7), 0.10: (127.9, 152.8), 0.15: (122.5, 160.1)}
    ratios = [high / low for low, high in paper.values()]
    assert ratios == pytest.approx([1.41, 1.19, 1.31], abs=0.005)


def test_with_clearance_the_ball_comes_to_rest_on_its_socket(played_run):
    """After the impacts of the start it stays in contact and carries what the ideal joint does."""
    data = played_run.data
    assert played_run.completed
    assert data.sizes["episode"] > 10
    reach = np.linalg.norm(data["journal_position"].values[:, 0], axis=1)
    assert reach.max() < 0.5e-3 + data["depth"].values.max() + 1e-12
    late = data["time"].values > 0.9
    assert data["touching"].values[late].all()
    contact = np.linalg.norm(data["joint_force"].values[late, 0], axis=1)
    passed = np.linalg.norm(joint_loads(data)["force"].sel(moving_joint="s2").values[late], axis=1)
    assert contact == pytest.approx(passed, rel=1e-8)  # two ways to the same force
    # What is off falls with the clearance and with friction (below).
    assert contact == pytest.approx(ideal_force(data["time"].values[late]), rel=0.05)
    kept = json.loads(data.attrs["conservation"])
    assert kept["energy_error"] < 1e-9 * kept["gross_work"]


@pytest.mark.slow
def test_the_slip_as_printed_switches_friction_off(played_run):
    """Depth times rate of the normal stay below the law's lower speed once the ball lies on its socket."""
    law = json.loads(played_run.data.attrs["clearance_joints"])["s2"]["friction_law"]
    lower_speed, _ = law["parameters"]["lower_speed"]
    settings = ("integrator.engine=compiled", "integrator.accuracy=1e-5", "output.rate=20 kHz")
    run = simulate(scenario("printed-slip", *settings), duration=2.5)
    place, rate = (
        np.stack([quantity(run, f"journal_{name}[s2].{axis}").values for axis in "xyz"], axis=1)
        for name in ("position", "velocity")
    )
    late = run.data["time"].values > 2.0
    place, rate = place[late], rate[late]
    far = np.linalg.norm(place, axis=1)
    normal = place / far[:, None]
    turning = np.linalg.norm(rate - normal * (normal * rate).sum(axis=1)[:, None], axis=1) / far
    depth = far - 0.5e-3
    assert depth.min() > 0.0  # in contact throughout
    assert (depth * turning).max() < lower_speed
    # And the case has no friction there, though the ball slides at 2 mm/s.
    assert np.abs(run.data["friction_force"].values[late]).max() == 0.0


def ideal_force(times):
    """Force through s2 without clearance [N]."""
    return np.array([np.linalg.norm(inverse_dynamics(t)[1][1]) for t in times])


def test_the_force_tends_to_the_ideal_one_with_clearance_and_friction(played_run):
    """Ten times less of both, ten times nearer: 4 % of the force with 0.5 mm and 0.10, 0.4 % with a tenth."""
    small = ["clearance.s2.bearing_radius=15.05 mm", "clearance.s2.friction.coefficient_of_friction=0.01"]
    apart = []
    for run in (played_run, simulate(scenario("friction-010", *small), duration=1.0)):
        late = run.data["time"].values > 0.95
        force = np.linalg.norm(run.data["joint_force"].values[late, 0], axis=1)
        apart.append(np.abs(force / ideal_force(run.data["time"].values[late]) - 1.0).max())
    assert apart[0] < 0.05
    # Linear but for what is left of vibrations, a part in a thousand of the force.
    assert apart[1] == pytest.approx(0.1 * apart[0], abs=0.001)


def test_the_platform_is_off_by_what_the_ball_is_off(played_run):
    """To first order, by the ideal mechanism's Jacobian: all constraints held, the ball of s2 off by e."""
    data = played_run.data
    motion = body_motion(data, "platform")
    for i in np.searchsorted(data["time"].values, [0.5, 0.8, 1.0]):
        t = float(data["time"].values[i])
        jacobian, centre = constraint_rows(t, clearance=False, driven=True), path(t)[0]
        # The rows of s2, the platform's point over the rod's, after fourteen of leg 1 and ten of leg 2.
        first = 24
        wanted = np.zeros(66)
        wanted[first : first + 3] = -data["journal_position"].values[i, 0]
        twist = np.linalg.solve(jacobian, wanted)[60:]
        shift = twist[:3] + np.cross(twist[3:], centre)
        found = motion["position"].values[i] - centre
        # Second order: the platform's 2 mm over lengths of 0.2 m, of each other.
        assert found == pytest.approx(shift, abs=0.01 * np.linalg.norm(shift))
        assert np.linalg.norm(shift) > 1e-3
