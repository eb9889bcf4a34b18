"""A joint with play: its forces do the work that its contacts do, in any frame and by any backend."""

import dataclasses
import math
import re

import numpy as np
import pinocchio as pin
import pytest
from displacements import along_one, anywhere

from antenna_pin import System, Urdf, build_mechanism
from antenna_pin.contact import (
    Ambrosio,
    CustomFriction,
    CustomNormal,
    Hertz,
    LankaraniNikravesh,
    NoFriction,
    Tanh,
    Tsuji,
    VelocityBased,
)
from antenna_pin.contact.kernels import normal_force
from antenna_pin.contact.normal import ElasticLaw
from antenna_pin.contact.records import number_of
from antenna_pin.errors import InvalidParameterError
from antenna_pin.integrate import Manifold
from antenna_pin.joints import ClearanceJoint, JointContacts
from antenna_pin.joints.geometry import PlanarClearance, RevoluteClearance
from antenna_pin.mechanism import frame_aligning_z

STATES = 60
FIELDS = JointContacts.__dataclass_fields__


def rotation_of(q):
    return pin.Quaternion(np.asarray(q[3:7])).matrix()


def moved(joint, q, v, time):
    """The pose after ``time`` of constant twist in the chart's sense: p + R v t, R exp(w t)."""
    manifold = Manifold(("plane" if joint.planar else "rigid",))
    u = np.array(v) * time
    if joint.planar:
        c, s = q[2], q[3]
        u[:2] = [c * u[0] - s * u[1], s * u[0] + c * u[1]]
    else:
        u[:3] = rotation_of(q) @ u[:3]
    return manifold.compose(q, u)


def assert_same(one, other, **tolerance):
    """Equal contacts and forces; the tolerance of each field is relative to its largest entry."""
    for name in FIELDS:
        a, b = getattr(one, name), getattr(other, name)
        scale = np.abs(a).max()
        assert a == pytest.approx(b, abs=tolerance.get(name, tolerance["default"]) * scale), name


def test_some_of_the_states_touch_and_some_do_not(joint, states):
    touching = np.array([joint.evaluate(q, v).gap <= 0.0 for q, v in states(joint, STATES, 1)])
    assert (touching.any(axis=0)).all() and not (touching.all(axis=0)).any()


def test_power_of_the_joint_is_the_power_of_its_contacts(joint, states):
    """Generalized force times velocity: closing contacts take power, friction takes power."""
    for q, v in states(joint, STATES, 2):
        c = joint.evaluate(q, v, approach_speed=0.02)
        normal, friction = -c.normal_force @ c.rate, (c.friction_force * c.slip).sum()
        assert friction <= 0.0
        scale = c.normal_force @ np.abs(c.rate) + abs(friction)
        # Round-off of a sum whose terms (forces times velocities of the centre) may exceed it a hundredfold.
        assert c.generalized_force @ v == pytest.approx(normal + friction, abs=1e-12 * scale + 1e-300)


def tilt_of(q):
    """Sine of the angle between the axes of journal and bearing."""
    return 2.0 * np.hypot(q[3], q[4]) * np.hypot(q[5], q[6]) if len(q) == 7 else 0.0


def flat(joint, q, state):
    """Which contacts are flanges whose whole annulus presses."""
    result = np.zeros(joint.contacts, dtype=bool)
    if joint.contacts == 4:
        edge = min(joint.geometry.bearing_outer_radius, joint.geometry.flange_radius)
        result[2:] = -state.gap[2:] > 2.0 * edge * tilt_of(q)
    return result


def test_depth_rate_is_the_rate_of_the_gap(joint, states):
    """d gap / dt along any twist is minus the depth rate: the contact point's own motion does not count."""
    h = 1e-5
    for q, v in states(joint, STATES, 3):
        state = joint.evaluate(q, v)
        rate = state.rate
        gap = [joint.evaluate(moved(joint, q, v, k * h), v).gap for k in (-2, -1, 1, 2)]
        numerical = (gap[0] - 8.0 * gap[1] + 8.0 * gap[2] - gap[3]) / (12.0 * h)
        # Truncation, h^4 / 30 times the fifth derivative: each brings speed over offset, 0.03 / 2e-4
        # and more; and round-off, 3e-17 m over h. A flange that presses flat has the rate of its force's
        # point, which is not the deepest.
        deepest = ~flat(joint, q, state)
        assert deepest[:2].all() and deepest.any()
        assert numerical[deepest] == pytest.approx(-rate[deepest], rel=1e-7, abs=1e-10)


def test_slip_is_tangential_and_holds_the_spin(joint, states):
    for q, v in states(joint, STATES, 4):
        c = joint.evaluate(q, v)
        assert np.abs((c.slip * c.normal).sum(axis=1)).max() < 1e-15  # round-off of velocities of 0.1 m/s
    # Spin alone, pressed: R_j w at the bore, less what the eccentricity takes off.
    q = [0.00021, 0, 1.0, 0.0] if joint.planar else [0.00021, 0, 0, 0, 0, 0, 1.0]
    v = [0, 0, 2.0] if joint.planar else [0, 0, 0, 0, 0, 2.0]
    slip = joint.evaluate(q, v).slip[0]
    assert slip == pytest.approx([0.0, 2.0 * (0.010 - 0.00021), 0.0], abs=1e-15)


def test_friction_opposes_slip_by_its_coefficient(joint, states):
    for q, v in states(joint, STATES, 5):
        c = joint.evaluate(q, v)
        for force, friction, slip in zip(c.normal_force, c.friction_force, c.slip, strict=True):
            speed = np.linalg.norm(slip)
            expected = -joint.friction.coefficient(speed) * force * slip / speed
            assert friction == pytest.approx(expected, rel=1e-12, abs=1e-300)  # round-off


def test_normal_force_is_that_of_the_law(joint, states):
    laws = joint.normal_laws
    for q, v in states(joint, STATES, 6):
        c = joint.evaluate(q, v, approach_speed=0.03)
        for k, law in enumerate(laws):
            expected = law.force(-c.gap[k], c.rate[k], 0.03)
            assert c.normal_force[k] == pytest.approx(expected, rel=1e-14, abs=0.0)  # round-off


def test_coal_gives_the_forces_of_the_closed_form(joint_maker, states):
    for geometry in ("revolute", "small flange", "planar"):
        closed, coal = (joint_maker(geometry, backend=b) for b in ("closed-form", "coal"))
        for q, v in states(closed, STATES, 7):
            one, other = closed.evaluate(q, v), coal.evaluate(q, v)
            # Gaps agree to 1e-17 m; forces of depths from 1e-7 m on, to 1e-10.
            assert_same(one, other, default=1e-10)


def test_nothing_acts_where_nothing_touches(joint):
    q = [1e-5, 0, 1.0, 0.0] if joint.planar else [1e-5, 0, 0, 0, 0, 0, 1.0]
    c = joint.evaluate(q, np.ones(3 if joint.planar else 6))
    assert (c.gap > 0.0).all()
    assert not c.normal_force.any() and not c.friction_force.any() and not c.generalized_force.any()


def test_memory_decides_what_touches(joint):
    """A contact that the memory has not opened bears no force, however deep."""
    q = [0.00021, 0, 1.0, 0.0] if joint.planar else [0.00021, 0, 0, 0, 0, 0, 1.0]
    v = np.zeros(3 if joint.planar else 6)
    assert joint.evaluate(q, v).normal_force[0] > 0.0
    c = joint.evaluate(q, v, touching=np.zeros(joint.contacts))
    assert c.gap[0] < 0.0 and not c.normal_force.any() and not c.generalized_force.any()


def test_approach_speed_is_floored(joint):
    q = [0.00021, 0, 1.0, 0.0] if joint.planar else [0.00021, 0, 0, 0, 0, 0, 1.0]
    v = np.zeros(3 if joint.planar else 6)
    v[0] = 1e-3
    slow = joint.evaluate(q, v, approach_speed=1e-9).normal_force
    assert (slow == joint.evaluate(q, v, approach_speed=joint.approach_speed_floor).normal_force).all()
    assert (joint.evaluate(q, v).normal_force == slow).all()


def test_turning_the_joint_about_the_bearing_axis_turns_its_forces(joint_maker, states):
    """Left by a rotation about the bearing's axis: the journal's own axes see no difference."""
    turn = pin.exp3(np.array([0.0, 0.0, 0.7]))
    for backend in ("closed-form", "coal"):
        joint = joint_maker(backend=backend)
        for q, v in states(joint, STATES, 8):
            turned = np.array([*(turn @ q[:3]), *pin.Quaternion(turn @ rotation_of(q)).coeffs()])
            one, other = joint.evaluate(q, v), joint.evaluate(turned, v)
            # Round-off of a pose, 1e-17 m, on depths of 1e-5 m.
            scale = np.abs(one.generalized_force).max()
            assert other.generalized_force == pytest.approx(one.generalized_force, abs=1e-10 * scale)
            assert other.gap == pytest.approx(one.gap, abs=1e-16)
            assert other.point == pytest.approx(one.point @ turn.T, abs=1e-12)
            assert other.friction_force == pytest.approx(one.friction_force @ turn.T, abs=1e-10 * scale)


def test_turning_the_journal_about_its_own_axis_changes_only_its_axes(joint_maker, states):
    """A journal is round: right by a rotation about its axis, its twist and its force turn along."""
    turn = pin.exp3(np.array([0.0, 0.0, -1.1]))
    both = np.kron(np.eye(2), turn.T)
    joint = joint_maker()
    for q, v in states(joint, STATES, 9):
        turned = np.array([*q[:3], *pin.Quaternion(rotation_of(q) @ turn).coeffs()])
        one, other = joint.evaluate(q, v), joint.evaluate(turned, both @ v)
        scale = np.abs(one.generalized_force).max()
        # As above.
        assert other.generalized_force == pytest.approx(both @ one.generalized_force, abs=1e-10 * scale)
        assert other.normal_force == pytest.approx(one.normal_force, abs=1e-10 * scale)


@pytest.mark.parametrize(
    "axis", [(0, 1, 0), (1, 0, 0), (0, 0, -1), (0, -1, 0), (1, 2, -2), (-0.3, 0.1, -0.9)], ids=str
)
def test_any_urdf_axis_is_as_good_as_z(axis, joint_maker, states):
    """The plugin carries the placement: in bearing axes a joint does not know its URDF axis."""
    axis = np.array(axis) / np.linalg.norm(axis)
    frame = frame_aligning_z(axis)
    both = np.kron(np.eye(2), frame)
    for backend, offset in (("closed-form", 0.0), ("coal", 0.0), ("closed-form", 0.013)):
        joint = joint_maker(backend=backend, offset=offset)
        for q, v in states(joint, 30, 10):
            rotation = frame @ rotation_of(q) @ frame.T
            turned = np.array([*(frame @ q[:3]), *pin.Quaternion(rotation).coeffs()])
            one = joint.evaluate(q, v)
            other = joint.evaluate(turned, both @ v, axis=axis, axes=frame)
            scale = np.abs(one.generalized_force).max()
            # Round-off of a pose, 1e-17 m, on depths of 1e-5 m.
            assert other.generalized_force == pytest.approx(both @ one.generalized_force, abs=1e-10 * scale)
            assert other.gap == pytest.approx(one.gap, abs=1e-16)
            assert other.point == pytest.approx(one.point, abs=1e-12)
            assert other.slip == pytest.approx(one.slip, abs=1e-12)
            assert other.friction_force == pytest.approx(one.friction_force, abs=1e-10 * scale)


@pytest.mark.parametrize("axis", [(0, 0, 1), (0, 1, 0), (1, 2, -2)], ids=str)
def test_offset_moves_the_bearing_along_the_axis(axis, joint_maker, states):
    """A joint whose bearing sits off the URDF origin is the joint at its bearing, seen from another point."""
    axis = np.array(axis) / np.linalg.norm(axis)
    frame, offset = frame_aligning_z(axis), -0.021
    centre = offset * axis
    away, near = joint_maker(offset=offset), joint_maker()
    for q, v in states(near, STATES, 11):
        # The pose and twist at the bearing, in joint axes; then those of the URDF origin.
        rotation = frame @ rotation_of(q) @ frame.T
        position, velocity, spin = frame @ q[:3], frame @ v[:3], frame @ v[3:]
        at_bearing = np.array([*position, *pin.Quaternion(rotation).coeffs()])
        at_origin = np.array([*(position + centre - rotation @ centre), *pin.Quaternion(rotation).coeffs()])
        one = near.evaluate(at_bearing, [*velocity, *spin], axis=axis, axes=frame)
        other = away.evaluate(at_origin, [*(velocity - np.cross(spin, centre)), *spin], axis=axis, axes=frame)
        force, torque = one.generalized_force[:3], one.generalized_force[3:]
        expected = np.array([*force, *(torque + np.cross(centre, force))])
        scale = np.abs(expected).max()
        assert other.gap == pytest.approx(one.gap, abs=1e-16)  # round-off of 2e-2 m
        assert other.generalized_force == pytest.approx(expected, abs=1e-10 * scale)  # on depths of 1e-5 m


@pytest.mark.parametrize(
    ("normal", "friction"),
    [
        (
            Hertz(stiffness=1e11),
            VelocityBased(static=0.15, dynamic=0.1, static_speed=0.01, dynamic_speed=0.1),
        ),
        (Hertz(stiffness=1e7, exponent=1.0), Ambrosio(coefficient_of_friction=0.2)),
        (
            LankaraniNikravesh(stiffness=1e11, restitution=0.6),
            Tanh(coefficient_of_friction=0.2, transition_speed=0.01),
        ),
        (LankaraniNikravesh(stiffness=1e11, restitution=0.6), NoFriction()),
    ],
    ids=["velocity-based", "linear-ambrosio", "hysteresis-tanh", "hysteresis-none"],
)
def test_a_law_in_python_gives_the_forces_of_the_compiled_law(normal, friction, joint, joint_maker, states):
    python = CustomNormal(
        force=normal.force, elastic_force=normal.elastic_force, elastic_energy=normal.elastic_energy
    )
    rub = CustomFriction(coefficient=friction.coefficient)
    compiled = joint_maker(
        joint.geometry, radial=normal, axial=normal, friction=friction, backend=joint.backend
    )
    slow = joint_maker(joint.geometry, radial=python, axial=python, friction=rub, backend=joint.backend)
    assert compiled.compiled and not slow.compiled
    for q, v in states(joint, 15, 12):
        one = compiled.evaluate(q, v, approach_speed=0.02)
        other = slow.evaluate(q, v, approach_speed=0.02)
        assert_same(
            one, other, default=1e-13
        )  # round-off; the ramp of Ambrosio's law magnifies that of a speed


def test_one_law_in_python_is_enough_for_the_slow_path(joint_maker, states):
    rub = CustomFriction(coefficient=lambda speed: 0.3 * min(1.0, speed / 1e-9))
    joint, reference = (
        joint_maker(friction=rub),
        joint_maker(friction=Ambrosio(coefficient_of_friction=0.3, lower_speed=0.0, upper_speed=1e-9)),
    )
    assert not joint.compiled
    for q, v in states(joint, 15, 13):
        assert_same(joint.evaluate(q, v), reference.evaluate(q, v), default=1e-13)  # round-off


def test_planar_joint_is_half_of_a_journal_that_keeps_its_plane(joint_maker):
    """Parallel, a journal touches at both ends: two contacts where a planar joint has one."""
    ends = joint_maker("revolute", axial=FREE)
    flat = joint_maker("planar", radial=LankaraniNikravesh(stiffness=2e11, restitution=0.9))
    rng = np.random.default_rng(14)
    for _ in range(20):
        x, y = 2.2e-4 * np.array([math.cos(a := rng.uniform(0, 6.3)), math.sin(a)])
        turn = rng.uniform(-3, 3)
        c, s = math.cos(turn), math.sin(turn)
        vx, vy, spin = rng.normal(size=3) * [0.02, 0.02, 1.0]
        one = ends.evaluate([x, y, 0, 0, 0, math.sin(turn / 2), math.cos(turn / 2)], [vx, vy, 0, 0, 0, spin])
        other = flat.evaluate([x, y, c, s], [vx, vy, spin])
        force = one.generalized_force
        # Round-off of 1e-17 m on a depth of 2e-5 m.
        scale = np.abs(force[:2]).max()
        assert force[[0, 1, 5]] == pytest.approx(other.generalized_force, abs=1e-11 * scale)
        assert force[[2, 3, 4]] == pytest.approx([0, 0, 0], abs=1e-12 * scale)
        assert one.rate[:2] == pytest.approx(other.rate[0], rel=1e-11, abs=1e-15)


FREE = Hertz(stiffness=1e-90)  # flanges that might as well not be there


def test_a_gap_of_zero_touches(joint_maker):
    joint = joint_maker(
        RevoluteClearance(
            bearing_radius=0.01,
            journal_radius=0.0098,
            bearing_length=0.05,
            flange_distance=0.05,
            bearing_outer_radius=0.012,
            flange_radius=0.014,
        )
    )
    c = joint.evaluate([0, 0, 0, 0, 0, 0, 1], [0, 0, 0.1, 0, 0, 0])
    assert c.gap[2:].tolist() == [0.0, 0.0]
    assert not c.normal_force.any()  # no depth, no force: but the memory is open


PAIR = """<robot name="pair"><link name="base"/>
  <joint name="hinge" type="continuous"><parent link="base"/><child link="arm"/>
    <origin xyz="0.2 0.3 0.4" rpy="0.5 -1.2 2.0"/><axis xyz="1 2 -2"/></joint>
  <link name="arm"><inertial><origin xyz="0.01 0.03 0.1"/><mass value="3"/>
    <inertia ixx="0.2" iyy="0.05" izz="0.21" ixy="0.01" ixz="0" iyz="-0.02"/></inertial></link></robot>"""


@pytest.mark.parametrize("side", ["parent", "child"])
@pytest.mark.parametrize("kind", ["free", "planar"])
def test_derivatives_of_accelerations_are_their_differences(kind, side, joint_maker):
    """Pressed against its bearing, sliding and turning, whichever of its two links has the bearing."""
    joint = joint_maker("revolute" if kind == "free" else "planar", bearing_on=side)
    mechanism = build_mechanism(Urdf.from_text(PAIR, "pair.urdf").variant(joints={"hinge": kind}), "fixed")
    field, y = anywhere(System(mechanism, clearances=[joint]), 3)
    for found, expected in along_one(field, y, 4):
        # Of differences of forces of depths of micrometres.
        assert found == pytest.approx(expected, abs=1e-7)


def test_names_and_sizes(joint_maker):
    joint = joint_maker()
    assert joint.contact_names == ("hinge.radial+", "hinge.radial-", "hinge.axial+", "hinge.axial-")
    assert (joint.contacts, joint.stride, joint.planar, joint.compiled) == (4, 3, False, True)
    assert joint.normal_laws == (joint.radial, joint.radial, joint.axial, joint.axial)
    assert joint.maximum_depth == pytest.approx(1e-4, rel=1e-15, abs=0.0)
    flat = joint_maker("planar")
    assert flat.contact_names == ("hinge.radial",)
    assert (flat.contacts, flat.stride, flat.planar) == (1, 3, True)
    assert flat.normal_laws == (flat.radial,)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"backend": "bullet"},
            "joint 'hinge': backend must be coal, closed-form or an object with query(), got 'bullet'",
        ),
        (
            {"approach_speed_floor": 0.0},
            "joint 'hinge': approach_speed_floor must be positive [m/s], got 0.0",
        ),
        (
            {"approach_speed_floor": math.nan},
            "joint 'hinge': approach_speed_floor must be positive [m/s], got nan",
        ),
        ({"axial": None}, "joint 'hinge': axial must be a normal law, got None"),
        ({"maximum_depth": -1.0}, "joint 'hinge': maximum_depth must be a positive length [m], got -1.0"),
        ({"maximum_depth": math.nan}, "joint 'hinge': maximum_depth must be a positive length [m], got nan"),
    ],
)
def test_refuses_what_is_no_joint(change, message, joint_maker):
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        joint_maker(**change)


def test_a_planar_joint_needs_no_axial_law():
    joint = ClearanceJoint(
        name="hinge",
        geometry=PlanarClearance(bearing_radius=0.01, journal_radius=0.0098),
        radial=Hertz(stiffness=1e10),
    )
    assert joint.backend == "coal" and isinstance(joint.friction, NoFriction)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Unknown(ElasticLaw):
    """A law whose kind no kernel knows, elastic or dissipation."""

    kernel = Hertz.kernel

    elastic: float = number_of(Hertz.kernel)
    dissipation: float = 0.0

    def code(self):
        code = Hertz(stiffness=1e9).code()
        code[:2] = self.elastic, self.dissipation
        return code


@pytest.mark.parametrize(
    ("kind", "part"), [({"elastic": 77.0}, "elastic"), ({"dissipation": 99.0}, "dissipation")]
)
def test_a_law_of_an_unknown_kind_is_refused_and_no_number(joint_maker, kind, part):
    """Neither a silent zero in the kernel nor a joint that holds nothing."""
    law = Unknown(**kind)
    assert np.isnan(normal_force(law.code(), 1e-6, 0.01, 0.01, 1.0))
    with pytest.raises(
        InvalidParameterError, match=f"Unknown: {part} kind must be that of a kernel.* got {kind[part]}"
    ):
        dataclasses.replace(joint_maker("planar"), radial=law)


def test_a_law_that_needs_the_mass_of_the_contact_asks_for_it(joint_maker):
    law = Tsuji(stiffness=1e9, restitution=0.7)
    one = dataclasses.replace(joint_maker("planar"), radial=law)
    q, v = [0.00021, 0, 1.0, 0.0], [0.01, 0.0, 0.0]
    with pytest.raises(InvalidParameterError, match="effective_mass must be given"):
        one.evaluate(q, v)
    given = dataclasses.replace(one, radial=dataclasses.replace(law, effective_mass=2.0))
    assert one.evaluate(q, v, effective_mass=2.0).normal_force == given.evaluate(q, v).normal_force
