"""Drives, springs and dampers: what they do at each kind of joint, and at which they cannot act."""

import math
import re

import numpy as np
import pinocchio as pin
import pytest
from displacements import TIME, along_one

from antenna_pin import RunSettings
from antenna_pin.contact import Hertz
from antenna_pin.dynamics import System, Workspace, acceleration, audit, kernels
from antenna_pin.elements import CallableDrive, ConstantDrive, JointSpring, PDController, SineDrive
from antenna_pin.errors import InvalidParameterError, MechanismError, UnknownNameError
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints.geometry import PlanarClearance, RevoluteClearance
from antenna_pin.mechanism import Urdf, build_mechanism, frame_aligning_z
from antenna_pin.studies.nonlinear.perturbed_system import ParameterSlopes
from antenna_pin.studies.nonlinear.vector_field import VectorField

# A floating hull with every kind of joint on it; the axis of "turn" is oblique.
ROBOT = """<robot name="robot">
  <link name="hull"><inertial><origin xyz="0.1 -0.2 0.05"/><mass value="20"/>
    <inertia ixx="5" iyy="6" izz="7" ixy="0.1" ixz="-0.2" iyz="0.3"/></inertial></link>
  <joint name="turn" type="revolute"><parent link="hull"/><child link="arm"/>
    <origin xyz="0.2 0.3 0.4" rpy="0.5 -1.2 2.0"/><axis xyz="1 2 -2"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <link name="arm"><inertial><origin xyz="0 0.3 0.1"/><mass value="3"/>
    <inertia ixx="0.2" iyy="0.05" izz="0.21" ixy="0.01" ixz="0" iyz="-0.02"/></inertial></link>
  <joint name="wheel" type="continuous"><parent link="hull"/><child link="disc"/>
    <origin xyz="0 0.6 0" rpy="-0.7 1.1 0.4"/><axis xyz="-0.3 0.1 -0.9"/></joint>
  <link name="disc"><inertial><mass value="1.5"/>
    <inertia ixx="0.03" iyy="0.02" izz="0.04" ixy="0" ixz="0" iyz="0.001"/></inertial></link>
  <joint name="slide" type="prismatic"><parent link="hull"/><child link="weight"/>
    <origin xyz="-0.3 0 0"/><axis xyz="0 1 1"/>
    <limit lower="-1" upper="1" effort="5" velocity="2"/></joint>
  <link name="weight"><inertial><mass value="2"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>"""
AXIS = np.array([1.0, 2.0, -2.0]) / 3.0
OFFSET = 0.017


def clearance(kind):
    """A joint with play for "turn" that touches nothing near its centre."""
    if kind == "planar":
        geometry = PlanarClearance(bearing_radius=0.5, journal_radius=0.1)
    else:
        geometry = RevoluteClearance(
            bearing_radius=0.5,
            journal_radius=0.1,
            bearing_length=0.1,
            flange_distance=5.0,
            bearing_outer_radius=0.6,
            flange_radius=0.7,
        )
    law = Hertz(stiffness=1e6)
    offset = 0.0 if kind == "planar" else OFFSET
    return ClearanceJoint(
        name="turn", geometry=geometry, radial=law, axial=law, backend="closed-form", offset=offset
    )


def make_system(kind="ideal", **elements):
    urdf = Urdf.from_text(ROBOT, "robot.urdf").variant(joints={"turn": kind})
    joints = () if kind == "ideal" else (clearance(kind),)
    return System(build_mechanism(urdf, "free"), clearances=joints, **elements)


def random_state(system, rng):
    """Turned all ways; the journal tilted by up to half a radian or so and off centre."""
    q = pin.integrate(system.model, system.neutral(), rng.normal(size=system.model.nv))
    if system.clearances:
        slot = system.mechanism.joint("turn")
        if slot.kind == "floating":
            axes = frame_aligning_z(AXIS)
            tilt = axes @ np.array([*rng.uniform(-0.4, 0.4, 2), 0.0])
            turn = pin.exp3(tilt) @ pin.exp3(rng.uniform(-3, 3) * AXIS)
            q[slot.q] = [*rng.uniform(-0.01, 0.01, 3), *pin.Quaternion(turn).coeffs()]
        else:
            q[slot.q.start : slot.q.start + 2] = rng.uniform(-0.01, 0.01, 2)
    return system.state(q, rng.normal(size=system.model.nv))


def forces(system, t, y):
    """Generalized force and the rates of what the elements integrate."""
    rates = np.zeros(system.model.nv + system.manifold.nx)
    workspace = Workspace(system)
    workspace.apply_elements(t, y, rates)
    return workspace.tau.copy(), rates[system.model.nv :].copy()


def velocity(system, y, joint=None):
    v = y[system.model.nq : system.model.nq + system.model.nv]
    return v if joint is None else v[system.mechanism.joint(joint).v]


# --- drives at joints ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("joint", ["turn", "wheel", "slide"])
def test_drive_at_a_joint_without_play(joint):
    """The torque about the joint's axis; its work is torque times rate."""
    system = make_system(drives={"motor": SineDrive(joint=joint, amplitude=2.0, frequency=1.0)})
    rng, slot = np.random.default_rng(2), system.mechanism.joint(joint)
    for t in rng.uniform(0.0, 1.0, 10):
        y = random_state(system, rng)
        tau, rates = forces(system, t, y)
        torque = 2.0 * math.sin(2.0 * math.pi * t)
        expected = np.zeros(system.model.nv)
        expected[slot.v] = torque
        assert tau == pytest.approx(expected, rel=1e-14, abs=0.0)  # round-off
        power = torque * velocity(system, y, joint)[0]
        assert rates[system.work_x] == pytest.approx(power, rel=1e-14, abs=0.0)
        assert rates[system.gross_work_x] == pytest.approx(abs(power), rel=1e-14, abs=0.0)


@pytest.mark.parametrize("about", ["bearing", "journal"])
def test_drive_at_a_clearance_joint_is_a_couple(about):
    """About the bearing's axis or the journal's; no force, wherever the journal is."""
    system = make_system("free", drives={"motor": ConstantDrive(joint="turn", value=3.0, axis=about)})
    rng, slot = np.random.default_rng(3), system.mechanism.joint("turn")
    for _ in range(10):
        y = random_state(system, rng)
        tau, rates = forces(system, 0.0, y)
        rotation = pin.Quaternion(np.array(y[slot.q][3:])).matrix()
        axis = rotation.T @ AXIS if about == "bearing" else AXIS
        expected = np.zeros(system.model.nv)
        expected[slot.v.start + 3 : slot.v.stop] = 3.0 * axis
        assert tau == pytest.approx(expected, abs=1e-14)  # round-off
        assert rates[system.work_x[0]] == pytest.approx(tau @ velocity(system, y), rel=1e-13, abs=0.0)


@pytest.mark.parametrize("kind", ["ideal", "free", "planar"])
def test_drives_and_springs_are_internal(kind):
    """Reaction on the parent, equal and opposite: the total momentum does not change."""
    system = make_system(
        kind,
        drives={
            "a": ConstantDrive(joint="turn", value=3.0),
            "b": ConstantDrive(joint="wheel", value=-2.0),
            "c": ConstantDrive(joint="slide", value=4.0),
        },
        springs={
            "s": JointSpring(joint="turn", stiffness=5.0, damping=0.4, rest_angle=0.3),
            "w": JointSpring(joint="wheel", stiffness=5.0, damping=0.4),
            "p": JointSpring(joint="slide", stiffness=50.0, damping=4.0, rest_angle=0.1),
        },
    )
    rng, data = np.random.default_rng(5), system.model.createData()
    for _ in range(10):
        y = random_state(system, rng)
        q, v = y[: system.model.nq], velocity(system, y)
        pin.computeCentroidalMomentumTimeVariation(system.model, data, q, v, acceleration(system, 0.0, q, v))
        # Round-off of momenta and torques of some 100 N m.
        assert data.dhg.vector == pytest.approx(np.zeros(6), abs=1e-11)


@pytest.mark.parametrize(
    ("kind", "joint"),
    [("ideal", "turn"), ("ideal", "wheel"), ("ideal", "slide"), ("free", "turn"), ("planar", "turn")],
)
def test_callable_drive_sees_time_angle_and_rate(kind, joint):
    seen = []

    def controller(t, angle, rate):
        seen.append((t, angle, rate))
        return 7.0 - 2.0 * angle - 0.5 * rate

    system = make_system(kind, drives={"motor": CallableDrive(joint=joint, torque=controller)})
    slot, rng = system.mechanism.joint(joint), np.random.default_rng(6)
    angle, rate = 0.8, -0.6
    q, v = system.neutral(), rng.normal(size=system.model.nv)
    if slot.kind == "floating":
        q[slot.q] = [0, 0, 0, *pin.Quaternion(pin.exp3(angle * AXIS)).coeffs()]
        v[slot.v] = [*rng.normal(size=3), *(rate * AXIS)]
    elif slot.kind == "planar":
        q[slot.q], v[slot.v] = [0.01, 0.02, math.cos(angle), math.sin(angle)], [0.1, 0.2, rate]
    else:
        q[slot.q] = [math.cos(angle), math.sin(angle)] if slot.kind == "continuous" else angle
        v[slot.v] = rate
    tau, rates = forces(system, 1.5, system.state(q, v))
    assert seen == [
        (1.5, pytest.approx(angle, rel=1e-14, abs=0.0), pytest.approx(rate, rel=1e-14, abs=0.0))
    ]  # round-off
    torque = 7.0 - 2.0 * angle - 0.5 * rate
    about = AXIS if slot.kind == "floating" else np.ones(1)
    assert tau[slot.v][-len(about) :] == pytest.approx(torque * about, rel=1e-13, abs=0.0)
    assert rates[system.work_x[0]] == pytest.approx(torque * rate, rel=1e-13, abs=0.0)


@pytest.mark.parametrize(
    ("kind", "joint"),
    [("ideal", "turn"), ("ideal", "wheel"), ("ideal", "slide"), ("free", "turn"), ("planar", "turn")],
)
@pytest.mark.parametrize("axis", ["bearing", "journal"])
def test_a_controller_does_what_the_same_in_python_does(kind, joint, axis):
    """At every kind of joint, tilted and off its centre, about either axis, its work included."""
    pd = PDController(joint=joint, kp=2.0, kd=0.5, angle=0.3, rate=0.7, limit=1.5, axis=axis)

    def torque(t, angle, rate):
        return min(max(2.0 * (0.3 + 0.7 * t - angle) + 0.5 * (0.7 - rate), -1.5), 1.5)

    systems = [
        make_system(kind, drives={"motor": one})
        for one in (pd, CallableDrive(joint=joint, torque=torque, axis=axis))
    ]
    rng = np.random.default_rng(11)
    limited = 0
    for t in rng.uniform(0.0, 2.0, 20):
        y = random_state(systems[0], rng)
        (tau, rates), (expected, expected_rates) = (forces(system, t, y) for system in systems)
        assert tau == pytest.approx(expected, abs=1e-13)  # round-off
        assert rates == pytest.approx(expected_rates, abs=1e-13)
        limited += abs(np.linalg.norm(tau) - 1.5) < 1e-12
    assert 0 < limited < 20


# --- the motion angle ---------------------------------------------------------------------------------------


def motion(system, y):
    """Motion angle and its rate of the joint that the one spring sits on."""
    return kernels.joint_motion(system.program, system.spring_blocks["coil"], y, system.model.nq)[:2]


@pytest.mark.parametrize("angle", [-3.1, -1.0, 0.0, 0.4, 2.0, 3.1])
@pytest.mark.parametrize("kind", ["free", "planar"])
def test_motion_angle_of_a_pure_turn_is_its_angle(kind, angle):
    """Whichever of the two quaternions says so."""
    system = make_system(kind, springs={"coil": JointSpring(joint="turn")})
    slot, q = system.mechanism.joint("turn"), system.neutral()
    if kind == "planar":
        q[slot.q] = [0.01, 0.02, math.cos(angle), math.sin(angle)]
        signs = (1.0,)
    else:
        q[slot.q] = [0.1, 0.2, 0.3, *(math.sin(angle / 2) * AXIS), math.cos(angle / 2)]
        signs = (1.0, -1.0)
    for sign in signs:
        if kind == "free":
            q[slot.q.start + 3 : slot.q.stop] *= sign
        assert motion(system, system.state(q, np.zeros(system.model.nv)))[0] == pytest.approx(
            angle, abs=1e-15
        )


def test_motion_angle_is_the_twist_of_swing_and_twist():
    """A tilt by the shortest way leaves the angle alone, before or after the turn."""
    system = make_system("free", springs={"coil": JointSpring(joint="turn")})
    slot, rng = system.mechanism.joint("turn"), np.random.default_rng(7)
    for _ in range(20):
        angle = rng.uniform(-3.0, 3.0)
        swing = pin.exp3(frame_aligning_z(AXIS) @ np.array([*rng.uniform(-0.5, 0.5, 2), 0.0]))
        for turn in (swing @ pin.exp3(angle * AXIS), pin.exp3(angle * AXIS) @ swing):
            q = system.neutral()
            q[slot.q] = [0, 0, 0, *pin.Quaternion(turn).coeffs()]
            found = motion(system, system.state(q, np.zeros(system.model.nv)))[0]
            assert found == pytest.approx(angle, abs=3e-15)  # round-off


@pytest.mark.parametrize("kind", ["free", "planar"])
def test_rate_of_the_motion_angle_is_its_derivative(kind):
    system = make_system(kind, springs={"coil": JointSpring(joint="turn")})
    rng, h = np.random.default_rng(8), 1e-4
    for _ in range(20):
        y = random_state(system, rng)
        q, v = y[: system.model.nq], velocity(system, y)
        a, b, c, d = (
            motion(system, system.state(pin.integrate(system.model, q, k * h * v), v))[0]
            for k in (-2, -1, 1, 2)
        )
        # Truncation h^4 / 30 times a fifth derivative below 1e3; round-off 1e-15 / h.
        assert motion(system, y)[1] == pytest.approx((a - 8 * b + 8 * c - d) / (12 * h), abs=1e-10)


# --- springs and dampers ------------------------------------------------------------------------------------


@pytest.mark.parametrize("joint", ["turn", "wheel", "slide"])
def test_spring_and_damper_at_a_joint_without_play(joint):
    spring = JointSpring(joint=joint, stiffness=5.0, damping=0.7, rest_angle=0.2)
    system = make_system(springs={"coil": spring})
    slot = system.mechanism.joint(joint)
    q, v = system.neutral(), np.zeros(system.model.nv)
    q[slot.q] = [math.cos(0.9), math.sin(0.9)] if slot.kind == "continuous" else 0.9
    v[slot.v] = -0.4
    y = system.state(q, v)
    tau, rates = forces(system, 0.0, y)
    assert tau[slot.v] == pytest.approx(-5.0 * 0.7 + 0.7 * 0.4, rel=1e-14, abs=0.0)  # round-off
    assert np.count_nonzero(tau) == 1
    assert rates[system.damper_x] == pytest.approx(0.7 * 0.4**2, rel=1e-14, abs=0.0)
    assert audit(Workspace(system), y).springs == pytest.approx(0.5 * 5.0 * 0.7**2, rel=1e-14, abs=0.0)


@pytest.mark.parametrize(
    ("kind", "joint"), [("ideal", "turn"), ("ideal", "wheel"), ("free", "turn"), ("planar", "turn")]
)
def test_spring_counts_turns_unless_it_is_asked_to_go_the_shorter_way(kind, joint):
    """At 3 rad a spring that rests at -3 rad is 6 rad away, the shorter way 0.28; three turns on, 25 rad."""
    for turns, shorter, expected in (
        (0, False, 6.0),
        (3, False, 6.0 + 6.0 * math.pi),
        (0, True, 6.0 - 2.0 * math.pi),
        (3, True, 6.0 - 2.0 * math.pi),
    ):
        coil = JointSpring(joint=joint, stiffness=2.0, rest_angle=-3.0, shorter_way=shorter)
        system = make_system(kind, springs={"coil": coil})
        slot, q, angle = system.mechanism.joint(joint), system.neutral(), 3.0 + 2.0 * math.pi * turns
        if slot.kind == "floating":
            q[slot.q] = [0.0, 0.0, 0.0, *(math.sin(angle / 2) * AXIS), math.cos(angle / 2)]
        elif slot.kind == "planar":
            q[slot.q] = [0.0, 0.0, math.cos(angle), math.sin(angle)]
        else:
            q[slot.q] = [math.cos(angle), math.sin(angle)] if slot.kind == "continuous" else angle
        angles = {joint: angle} if joint in system.turn_x else {}
        y = system.state(q, np.zeros(system.model.nv), angles)
        tau, _ = forces(system, 0.0, y)
        torque = tau[slot.v][-3:] @ AXIS if slot.kind == "floating" else tau[slot.v][-1]
        assert torque == pytest.approx(-2.0 * expected, rel=1e-13, abs=0.0)  # round-off
        stored = audit(Workspace(system), y).springs
        assert stored == pytest.approx(expected**2, rel=1e-13, abs=0.0)


def test_a_sliding_joint_has_no_shorter_way():
    with pytest.raises(InvalidParameterError, match="spring 'coil': shorter_way must be false"):
        make_system(springs={"coil": JointSpring(joint="slide", stiffness=1.0, shorter_way=True)})


@pytest.mark.parametrize(
    ("kind", "joint"),
    [("free", "turn"), ("planar", "turn"), ("ideal", "turn"), ("ideal", "wheel"), ("ideal", "slide")],
)
def test_spring_force_is_the_gradient_of_its_energy(kind, joint):
    """In every direction of the tangent space, the journal tilted and off its centre: it conserves energy."""
    system = make_system(kind, springs={"coil": JointSpring(joint=joint, stiffness=5.0, rest_angle=0.3)})
    rng, h = np.random.default_rng(9), 1e-3

    def energy(q):
        return audit(Workspace(system), system.state(q, np.zeros(system.model.nv))).springs

    for _ in range(5):
        y = random_state(system, rng)
        q = y[: system.model.nq]
        tau, _ = forces(system, 0.0, y)
        for k, direction in enumerate(np.eye(system.model.nv)):
            a, b, c, d = (energy(pin.integrate(system.model, q, s * h * direction)) for s in (-2, -1, 1, 2))
            # Truncation h^4 / 30 times a fifth derivative of some 100 J; round-off 1e-15 J / h.
            assert -(a - 8 * b + 8 * c - d) / (12 * h) == pytest.approx(tau[k], abs=2e-10)


@pytest.mark.parametrize("kind", ["free", "planar"])
def test_damper_at_a_clearance_joint_takes_what_it_loses(kind):
    system = make_system(kind, springs={"coil": JointSpring(joint="turn", damping=0.8)})
    rng = np.random.default_rng(10)
    for _ in range(10):
        y = random_state(system, rng)
        tau, rates = forces(system, 0.0, y)
        assert rates[system.damper_x[0]] > 0.0
        # Round-off.
        assert -tau @ velocity(system, y) == pytest.approx(rates[system.damper_x[0]], rel=1e-12, abs=0.0)


# --- derivatives --------------------------------------------------------------------------------------------


def driven(kind, stiffness=5.0, damping=0.7, torque=2.0):
    """A system with a spring and a drive at "turn", and a controller at "slide"."""
    drives = {
        "motor": ConstantDrive(joint="turn", value=torque),
        "servo": PDController(joint="slide", kp=20.0, kd=0.5, angle=0.3, rate=0.7),
    }
    spring = JointSpring(joint="turn", stiffness=stiffness, damping=damping, rest_angle=0.2)
    return make_system(kind, springs={"coil": spring}, drives=drives)


@pytest.mark.parametrize("kind", ["ideal", "free", "planar"])
def test_derivatives_of_the_rates_are_their_differences(kind):
    """Along displacements of configuration, velocity and time; what elements integrate included."""
    system = driven(kind)
    y = random_state(system, np.random.default_rng(12))
    for found, expected in along_one(VectorField(system, RunSettings(engine="compiled")), y, 13):
        assert found == pytest.approx(expected, abs=1e-8)  # of differences of sixth order


@pytest.mark.parametrize("kind", ["ideal", "free", "planar"])
def test_derivatives_over_stiffness_damping_and_torque_are_what_a_unit_more_makes(kind):
    """All rates are linear in each of the three."""
    names, values = ("stiffness", "damping", "torque"), (5.0, 0.7, 2.0)
    base, more = driven(kind), [driven(kind, **{n: x + 1.0}) for n, x in zip(names, values, strict=True)]
    built = [lambda s, n=n, x=x: driven(kind, **{n: x + s}) for n, x in zip(names, values, strict=True)]
    field = VectorField(base, RunSettings(engine="compiled"), ParameterSlopes(base, built, names))
    y = random_state(base, np.random.default_rng(14))
    ways = np.eye(field.displacement)[:, field.parts[-3]]
    found = field._tangents.rates(TIME, y, ways, np.full(len(names), 1e-4))[0]

    def rates(system):
        out = np.zeros(system.model.nv + system.manifold.nx)
        Workspace(system).derivative(TIME, y, out)
        return out

    expected = np.column_stack([rates(one) - rates(base) for one in more])
    assert np.all(np.abs(expected).max(axis=0) > 1e-3)
    # Round-off of differences of numbers of some 100.
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-10)


# --- refusals -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("elements", ["drives", "springs"])
def test_refuses_a_joint_without_an_axis(elements):
    """A joint made free, with nothing that says what it was free of."""
    mechanism = build_mechanism(Urdf.from_text(ROBOT, "robot.urdf").variant(joints={"turn": "free"}), "free")
    element = ConstantDrive(joint="turn", value=1.0) if elements == "drives" else JointSpring(joint="turn")
    message = (
        f"{elements[:-1]} 'motor': joint 'turn' is floating and has no axis to act about; "
        "use a revolute, continuous, prismatic or clearance joint"
    )
    with pytest.raises(MechanismError, match=f"^{re.escape(message)}$"):
        System(mechanism, **{elements: {"motor": element}})


def test_refuses_a_joint_that_is_not_there():
    mechanism = build_mechanism(Urdf.from_text(ROBOT, "robot.urdf"), "free")
    with pytest.raises(UnknownNameError, match="moving joint 'whel' is unknown; did you mean wheel"):
        System(mechanism, drives={"motor": ConstantDrive(joint="whel", value=1.0)})
