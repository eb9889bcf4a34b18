"""Elements on links: their generalized forces against Pinocchio's external ones, books, refusals."""

import dataclasses

import numpy as np
import pinocchio as pin
import pytest
from limbs import BODIES, parts, random_state, robot

from antenna_pin.dynamics import System, Workspace, acceleration, audit
from antenna_pin.elements import CallableElement, CallableForce, GravityGradient, OutsideForce, Thruster
from antenna_pin.elements.desk_kernels import BOOK
from antenna_pin.errors import AntennaPinError, InvalidParameterError, MechanismError, UnknownNameError
from antenna_pin.mechanism import Urdf, build_mechanism

POINT = (0.3, -0.1, 0.2)


def make_system(base="free", **forces):
    return System(build_mechanism(Urdf.from_text(robot(), "robot.urdf"), base), elements={"forces": forces})


def force_on(link, axes="link", **more):
    given = {"force": (3.0, -1.0, 2.0), "torque": (0.4, 0.5, -0.6), **more}
    return OutsideForce(at=(link, POINT), axes=axes, **given)


def frame_of(system, y, link):
    """Where a link's frame and the point are, in the world, and the model's data."""
    model, (q, v) = system.model, parts(system, y)
    data = model.createData()
    pin.forwardKinematics(model, data, q, v)
    pin.updateFramePlacements(model, data)
    frame = system.mechanism.frame(link)
    place = data.oMf[frame]
    return data, frame, place, place.act(np.array(POINT))


def under(system, y, wrenches):
    """The acceleration under forces and torques at places of links, by Pinocchio alone."""
    model, (q, v) = system.model, parts(system, y)
    outside = [pin.Force.Zero() for _ in range(model.njoints)]
    for link, place, force, torque in wrenches:
        data, frame, _, _ = frame_of(system, y, link)
        joint = model.frames[frame].parentJoint
        outside[joint] += data.oMi[joint].actInv(pin.Force(force, np.cross(place, force) + torque))
    return np.array(pin.aba(model, model.createData(), q, v, np.zeros(model.nv), outside))


@pytest.mark.parametrize("axes", ["link", "world"])
@pytest.mark.parametrize("base", ["free", "fixed"])
@pytest.mark.parametrize("link", [*BODIES, "tip"])
def test_a_force_is_an_external_one(link, base, axes):
    """On bodies moved by every kind of joint, on a link that is part of one, in both sets of axes."""
    if base == "fixed" and link == "hull":
        return
    system, rng = make_system(base, it=force_on(link, axes)), np.random.default_rng(7)
    for _ in range(5):
        y = random_state(system, rng)
        _, _, place, point = frame_of(system, y, link)
        turn = place.rotation if axes == "link" else np.eye(3)
        one = system.forces["it"]
        wanted = under(system, y, [(link, point, turn @ one.force, turn @ one.torque)])
        found = acceleration(system, 0.0, *parts(system, y))
        # Round-off of two ways to sum.
        np.testing.assert_allclose(found, wanted, rtol=1e-10, atol=1e-10)


def booked(system, y, t=0.0):
    """What is booked of each force in a state: records BOOK, by name."""
    rates = np.zeros(system.model.nv + system.manifold.nx)
    Workspace(system).derivative(t, y, rates)
    nv = system.model.nv
    return {
        name: {field: rates[nv + system.force_x[field][k]] for field in BOOK.names}
        for k, name in enumerate(system.forces)
    }


def test_power_and_impulses_are_those_of_the_force():
    system, rng = (
        make_system(it=force_on("weight"), jet=thruster("tip", throttle=0.5)),
        np.random.default_rng(11),
    )
    for _ in range(5):
        y = random_state(system, rng)
        books = booked(system, y)
        data, frame, place, point = frame_of(system, y, "weight")
        centre = pin.centerOfMass(system.model, data, parts(system, y)[0])
        twist = pin.getFrameVelocity(system.model, data, frame, pin.LOCAL_WORLD_ALIGNED)
        force, torque = place.rotation @ [3.0, -1.0, 2.0], place.rotation @ [0.4, 0.5, -0.6]
        speed = twist.linear + np.cross(twist.angular, point - place.translation)
        power = force @ speed + torque @ twist.angular
        wanted = {
            "work": power,
            "gross_work": abs(power),
            "loss": 0.0,
            "impulse": force,
            "angular_impulse": np.cross(point, force) + torque,
            "central_impulse": np.cross(point - centre, force) + torque,
        }
        for field, value in wanted.items():
            np.testing.assert_allclose(books["it"][field], value, rtol=0, atol=1e-12)
        _, _, tip, _ = frame_of(system, y, "tip")
        np.testing.assert_allclose(books["jet"]["impulse"], tip.rotation @ [0, 0, 1.25], rtol=0, atol=1e-12)


def thruster(link, **more):
    return Thruster(at=(link, POINT), direction=(0, 0, 1), thrust=2.5, **more)


def test_gravity_differs_by_particles():
    """On every body force and torque are those of the field on the particles that it is made of."""
    rate = 0.7
    field = GravityGradient(rate=rate, normal=(0.0, 1.0, 0.0), nadir=(0.0, 0.0, -1.0))
    system, rng, t = make_system(it=field), np.random.default_rng(5), 0.9
    y = random_state(system, rng)
    model, data = system.model, frame_of(system, y, "hull")[0]
    e = np.array([-np.sin(rate * t), 0.0, -np.cos(rate * t)])
    outside = [pin.Force.Zero() for _ in range(model.njoints)]
    for k in range(1, model.njoints):
        body, place = model.inertias[k], data.oMi[k]
        # Six particles with the body's mass, mass centre and inertia.
        moments, ways = np.linalg.eigh(body.inertia)
        squares = (moments.sum() / 2.0 - moments) / (2.0 * body.mass / 6.0)
        for square, way in zip(squares, ways.T, strict=True):
            for sign in (1.0, -1.0):
                point = place.act(body.lever + sign * np.sqrt(square) * way)
                force = body.mass / 6.0 * rate**2 * (3.0 * (e @ point) * e - point)
                outside[k] += place.actInv(pin.Force(force, np.cross(point, force)))
    q, v = parts(system, y)
    wanted = pin.aba(model, model.createData(), q, v, np.zeros(model.nv), outside)
    np.testing.assert_allclose(acceleration(system, t, q, v), wanted, rtol=1e-10, atol=1e-10)


def test_the_first_link_takes_the_reaction():
    """Forces and torques on two links, and their reaction on a third: momenta stay, whatever is written."""

    def act(t, p, links, joints, states, whole):
        links[0].force[:] = 99.0  # is left out
        links[1].force[:] = 1.0, 2.0, 3.0
        links[2].torque[:] = -0.5, 0.4, 0.3
        links[2].force[:] = 0.0, -1.0, 0.5

    ends = tuple((link, POINT) for link in ("weight", "arm", "tip"))
    system = make_system(it=CallableElement(act=act, links=ends, internal=True))
    y = random_state(system, np.random.default_rng(2))
    books = booked(system, y)["it"]
    for field in ("impulse", "angular_impulse", "central_impulse"):
        np.testing.assert_allclose(books[field], 0.0, rtol=0, atol=1e-14)
    assert abs(books["work"]) > 0.1
    wrenches = []
    for link, force, torque in (
        ("arm", [1.0, 2.0, 3.0], [0, 0, 0]),
        ("tip", [0.0, -1.0, 0.5], [-0.5, 0.4, 0.3]),
    ):
        wrenches.append((link, frame_of(system, y, link)[3], np.array(force), np.array(torque, dtype=float)))
    first = frame_of(system, y, "weight")[3]
    force = -sum(one[2] for one in wrenches)
    torque = -sum(one[3] + np.cross(one[1] - first, one[2]) for one in wrenches)
    wanted = under(system, y, [*wrenches, ("weight", first, force, torque)])
    np.testing.assert_allclose(acceleration(system, 0.0, *parts(system, y)), wanted, rtol=1e-10, atol=1e-10)


def test_what_is_tied_to_the_world_has_the_worlds_impulse():
    """Drawn to a point of the world: the reaction there is nobody's."""

    def act(t, p, links, joints, states, whole):
        links[1].force[:] = 1.0, 2.0, 3.0

    ends = ("world", (1.0, 0.0, 0.0)), ("arm", POINT)
    system = make_system(it=CallableElement(act=act, links=ends, internal=True))
    books = booked(system, random_state(system, np.random.default_rng(2)))["it"]
    np.testing.assert_array_equal(books["impulse"], [1.0, 2.0, 3.0])


def test_torques_at_joints_and_what_is_seen_of_them():
    """A function sees angle and rate of joints and turns them, as their coordinates of v say."""
    seen = []

    def act(t, p, links, joints, states, whole):
        seen.append([(joint.angle, joint.rate) for joint in joints])
        joints[0].torque, joints[1].torque = p[0], p[1]

    one = CallableElement(act=act, joints=("turn", "slide"), parameters={"torque": 1.5, "force": -2.0})
    system = make_system(it=one)
    y = random_state(system, np.random.default_rng(3))
    workspace = Workspace(system)
    rates = np.zeros(system.model.nv + system.manifold.nx)
    workspace.derivative(0.0, y, rates)
    turn, slide = (system.mechanism.joint(name) for name in ("turn", "slide"))
    wanted = np.zeros(system.model.nv)
    wanted[turn.v], wanted[slide.v] = 1.5, -2.0
    assert np.array_equal(workspace.tau, wanted)
    q, v = parts(system, y)
    assert seen[-1] == [(q[turn.q].item(), v[turn.v].item()), (q[slide.q].item(), v[slide.v].item())]


def test_energy_of_a_users_element_is_in_the_audit():
    def act(t, p, links, joints, states, whole):
        whole.energy = float(links[0].place @ links[0].place)
        whole.loss = 3.0

    ends = (("arm", POINT), ("tip", POINT))
    passive = CallableElement(act=act, links=ends, passive=True)
    system = make_system(it=passive)
    y = random_state(system, np.random.default_rng(4))
    point = frame_of(system, y, "arm")[3]
    assert audit(Workspace(system), y).springs == pytest.approx(point @ point, rel=1e-12)
    assert booked(system, y)["it"]["loss"] == 3.0
    active = make_system(it=dataclasses.replace(passive, passive=False))
    assert audit(Workspace(active), y).springs == 0.0
    assert booked(active, y)["it"]["loss"] == 0.0


def test_what_is_off_does_nothing():
    system = make_system(
        it=force_on("weight", on=False), jet=thruster("tip", starts=(0.0,), durations=(1.0,))
    )
    y = random_state(system, np.random.default_rng(4))
    workspace = Workspace(system)
    rates = np.zeros(system.model.nv + system.manifold.nx)
    workspace.derivative(0.0, y, rates)
    assert not workspace.tau.any()  # the jet's pulse is opened by a run


def nothing(t, p, links, joints, states, whole):
    """Do nothing."""


def test_forces_that_can_do_nothing_are_refused():
    with pytest.raises(
        MechanismError, match="force 'it': link 'hull' does not move: it is the world or fixed"
    ):
        make_system("fixed", it=force_on("hull"))
    with pytest.raises(MechanismError, match="force 'it': link 'world' does not move"):
        make_system(it=force_on("world"))
    with pytest.raises(UnknownNameError, match="force 'it': link 'disk' is unknown; did you mean disc"):
        make_system(it=force_on("disk"))
    with pytest.raises(MechanismError, match="force 'it': its links are all one body"):
        make_system(it=CallableElement(act=nothing, links=(("disc", POINT), ("tip", POINT)), internal=True))
    with pytest.raises(MechanismError, match="force 'it': joint 'loose' is floating and has no axis"):
        make_system(it=CallableElement(act=nothing, joints=("loose",)))
    with pytest.raises(InvalidParameterError, match="force 'b': orbit must be the only one"):
        make_system(a=GravityGradient(rate=1.0), b=GravityGradient(rate=2.0))


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: OutsideForce(at=("a", POINT)), "force must be other than zero, or torque, got neither"),
        (
            lambda: OutsideForce(at=("a", (0, 1)), force=(1, 0, 0)),
            "at must be a link and three finite",
        ),
        (lambda: force_on("a", time=(0.0, 1.0)), "factors must be given beside time, got none"),
        (lambda: force_on("a", phase=1.0), "frequency must be given beside a phase, got none"),
        (
            lambda: force_on("a", time=(0.0, 1.0), factors=(0.0, 1.0), frequency=2.0),
            "frequency must be omitted if time is given: a force has one course",
        ),
        (lambda: thruster("a", starts=(0.1,)), "durations must be one for each of 1 starts"),
        (
            lambda: thruster("a", starts=(0.1, 0.2), durations=(0.2,)),
            r"starts\[1\] must be at 0.3 s or later",
        ),
        (lambda: thruster("a", throttle=1.5), "throttle must be from 0 to 1, the whole thrust, got 1.5"),
        (lambda: thruster("a", rise_time=0.1), "fall_time must be above zero"),
        (lambda: thruster("a", seed=3, azimuth=1.0), "azimuth must be omitted if a seed is given"),
        (
            lambda: thruster("a", starts=(0.1,), durations=(0.01,), minimum_impulse=0.05),
            r"durations\[0\] must be 0.02 s or more by minimum_on_time and minimum_impulse; lengthen",
        ),
        (lambda: CallableElement(act=nothing), "links must be given, or joints, got neither"),
        (lambda: CallableElement(act=lambda t: 1.0, joints=("a",)), "act must be a function of 6 arguments"),
        (
            lambda: CallableElement(act=nothing, links=(("a", POINT),), internal=True),
            "links must be two or more where it is internal",
        ),
        (lambda: CallableForce(at=("a", POINT), wrench=3.0), "wrench must be a function, got 3.0"),
    ],
)
def test_bad_numbers_are_refused_in_one_line(make, said):
    with pytest.raises(AntennaPinError, match=said) as refused:
        make()
    assert "\n" not in str(refused.value)
