"""Springs and dampers between points: their forces against external ones of Pinocchio; what is refused."""

import math

import numpy as np
import pinocchio as pin
import pytest
from limbs import parts, random_state, robot

from antenna_pin.dynamics import PointSpring, System, Workspace, acceleration, audit
from antenna_pin.errors import InvalidParameterError, MechanismError, UnknownNameError
from antenna_pin.mechanism import Urdf, build_mechanism


def make_system(base="free", **springs):
    return System(build_mechanism(Urdf.from_text(robot(), "robot.urdf"), base), springs=springs)


def spring(first, second, **numbers):
    ends = (first, (0.3, -0.1, 0.2)), (second, (-0.2, 0.25, 0.1))
    return PointSpring(first=ends[0], second=ends[1], **{"free_length": 0.2, "stiffness": 50.0, **numbers})


def end(system, data, side):
    """Place and velocity of an end in the world, and the index of the joint that moves it."""
    link, point = side
    if link == "world":
        return np.array(point), np.zeros(3), 0
    frame = system.mechanism.frame(link)
    place = data.oMf[frame]
    twist = pin.getFrameVelocity(system.model, data, frame, pin.LOCAL_WORLD_ALIGNED)
    lever = place.rotation @ np.array(point)
    joint = system.model.frames[frame].parentJoint
    return place.translation + lever, twist.linear + np.cross(twist.angular, lever), joint


def under_external_forces(system, y):
    """The acceleration with the springs as forces on bodies, by Pinocchio alone; their energy and loss."""
    model, (q, v) = system.model, parts(system, y)
    data = model.createData()
    pin.forwardKinematics(model, data, q, v)
    pin.updateFramePlacements(model, data)
    forces = [pin.Force.Zero() for _ in range(model.njoints)]
    energy = lost = 0.0
    for one in system.springs.values():
        (a, u, i), (b, w, j) = (end(system, data, side) for side in (one.first, one.second))
        way = b - a
        length = float(np.linalg.norm(way))
        rate = float(way @ (w - u)) / length
        force = (one.stiffness * (length - one.free_length) + one.damping * rate) * way / length
        for joint, place, sign in ((i, a, 1.0), (j, b, -1.0)):
            if joint:
                forces[joint] += data.oMi[joint].actInv(
                    pin.Force(sign * force, np.cross(place, sign * force))
                )
        energy += 0.5 * one.stiffness * (length - one.free_length) ** 2
        lost += one.damping * rate**2
    return np.array(pin.aba(model, data, q, v, np.zeros(model.nv), forces)), energy, lost


ENDS = [
    ("disc", "weight"), ("world", "ball"), ("puck", "world"), ("hull", "puck"), ("ball", "hull"),
    ("arm", "tip"), ("tip", "puck"), ("weight", "ball"),
]  # fmt: skip


@pytest.mark.parametrize("base", ["free", "fixed"])
@pytest.mark.parametrize("ends", ENDS, ids="-".join)
def test_a_spring_is_two_external_forces(base, ends):
    """On bodies of every kind of joint, in both directions of the tree, on links that are part of a body."""
    if base == "fixed" and "hull" in ends:
        ends = tuple(link.replace("hull", "world") for link in ends)  # a hull that is the world
    system = make_system(base, s=spring(*ends, damping=3.0))
    rng = np.random.default_rng(1)
    for _ in range(5):
        y = random_state(system, rng)
        expected, energy, lost = under_external_forces(system, y)
        found = acceleration(system, 0.0, *parts(system, y))
        # Round-off of the mass matrix, of bodies of 1 to 6 kg.
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
        workspace, rates = Workspace(system), np.zeros(system.model.nv + system.manifold.nx)
        workspace.apply_elements(0.0, y, rates)
        assert rates[system.model.nv + system.damper_x[0]] == pytest.approx(lost, rel=1e-13, abs=0.0)
        assert audit(workspace, y).springs == pytest.approx(energy, rel=1e-13, abs=0.0)


def test_springs_between_points_stand_beside_others():
    """Losses in the order of the springs; a system knows which of them are fixed to the world."""
    from antenna_pin.dynamics import JointSpring

    turn = JointSpring(joint="turn", damping=0.3)
    system = make_system(a=spring("disc", "puck", damping=2.0), b=turn, c=spring("ball", "arm", damping=1.0))
    y = random_state(system, np.random.default_rng(2))
    rates = np.zeros(system.model.nv + system.manifold.nx)
    Workspace(system).apply_elements(0.0, y, rates)
    rate = y[system.model.nq :][system.mechanism.joint("turn").v][0]
    lost = rates[system.model.nv :][system.damper_x]
    assert lost[1] == pytest.approx(0.3 * rate**2, rel=1e-15, abs=0.0)
    for k, name in ((0, "a"), (2, "c")):
        alone = make_system(**{name: system.springs[name]})
        assert under_external_forces(alone, alone.state(*parts(system, y)))[2] == pytest.approx(
            lost[k], rel=1e-13
        )
    assert system.keeps_momentum
    assert not make_system(a=spring("world", "puck")).keeps_momentum


# --- points that coincide -----------------------------------------------------------------------------------


def ball_at(way, speed, **numbers):
    """The acceleration of a free ball of 1 kg on a spring between its mass centre and the world's origin."""
    text = (
        '<robot name="ball"><link name="ball"><inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
    )
    mechanism = build_mechanism(Urdf.from_text(text, "ball.urdf"), "free")
    o = (0.0, 0.0, 0.0)
    one = PointSpring(first=("world", o), second=("ball", o), **numbers)
    system = System(mechanism, springs={"s": one})
    q, v = [*way, 0.0, 0.0, 0.0, 1.0], [*speed, 0.0, 0.0, 0.0]
    return acceleration(system, 0.0, q, v)[:3]


V = np.array([0.6, -0.8, 0.0])


def test_without_free_length_the_force_passes_smoothly_through_zero():
    for size in (1e-3, 1e-9, 1e-150, 0.0):
        way = np.array([size, -2.0 * size, 0.0])
        assert ball_at(way, V, free_length=0.0, stiffness=7.0) == pytest.approx(
            -7.0 * way, rel=1e-14, abs=0.0
        )


def test_a_damper_passes_straight_through_zero_without_a_jump():
    """Before, at and behind the point: -c v each time, and along the line alone beside it."""
    for way in (-1e-9 * V, 0.0 * V, 1e-9 * V):
        assert ball_at(way, 2.0 * V, free_length=0.0, damping=3.0) == pytest.approx(-6.0 * V, rel=1e-14)
    beside = np.array([0.8, 0.6, 0.0])
    assert ball_at(1e-9 * beside, 2.0 * V, free_length=0.0, damping=3.0) == pytest.approx(0.0, abs=1e-14)


def test_a_compressed_spring_jumps_to_the_other_side():
    """At zero it pushes on, as just behind it; of points at rest none can say where to."""
    for way, sign in ((-1e-9 * V, -1.0), (0.0 * V, 1.0), (1e-9 * V, 1.0)):
        force = ball_at(way, V, free_length=0.1, stiffness=7.0)
        assert force == pytest.approx(
            sign * 0.7 * V, rel=1e-7
        )  # 1e-9 of 0.1 m, and the round-off of V's size
    assert ball_at(0.0 * V, 0.0 * V, free_length=0.1, stiffness=7.0, damping=1.0).tolist() == [0.0, 0.0, 0.0]


# --- what is refused ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("ends", "message"),
    [
        (
            ("disc", "tip"),
            "spring 's': its links 'disc' and 'tip' are one body, body 'disc', so it would have no effect",
        ),
        (("world", "world"), "spring 's': its links 'world' and 'world' are one body, the world"),
    ],
)
def test_both_points_on_one_body(ends, message):
    with pytest.raises(MechanismError, match=message):
        make_system(s=spring(*ends))


def test_a_link_that_there_is_not():
    with pytest.raises(UnknownNameError, match="spring 's': link 'disk' is unknown; did you mean disc"):
        make_system(s=spring("disk", "hull"))


@pytest.mark.parametrize(
    ("numbers", "message"),
    [
        ({"first": "arm"}, r"PointSpring: first must be a link and three finite numbers \[m\], got 'arm'"),
        ({"second": ("arm", (0.0, math.nan, 0.0))}, "PointSpring: second must be a link and three finite"),
        ({"second": (1, (0.0, 0.0, 0.0))}, "PointSpring: second must be a link and three finite"),
    ],
)
def test_numbers_that_are_none(numbers, message):
    o = (0.0, 0.0, 0.0)
    with pytest.raises(InvalidParameterError, match=message):
        PointSpring(**{"first": ("hull", o), "second": ("arm", o), "free_length": 0.0, **numbers})
