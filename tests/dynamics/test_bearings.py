"""Joints on bearings and preloads: force is the gradient of energy, and what is refused."""

import math

import numpy as np
import pinocchio as pin
import pytest

from antenna_pin import RunSettings
from antenna_pin.base.calculus import WEIGHTS
from antenna_pin.contact import Hertz
from antenna_pin.dynamics import System, Workspace, audit, bearing_loads
from antenna_pin.elements import AxialPreload, BallBearing, JointSpring, StiffnessBearing, moved
from antenna_pin.errors import InvalidParameterError, MechanismError
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints.geometry import RevoluteClearance
from antenna_pin.mechanism import Urdf, build_mechanism
from antenna_pin.run.engine import Tangents
from antenna_pin.studies.nonlinear.vector_field import VectorField

LINK = (
    '<link name="{}"><inertial><origin xyz="0.01 0.02 0.03"/><mass value="2"/>'
    '<inertia ixx="0.006" iyy="0.007" izz="0.01" ixy="0" ixz="0.001" iyz="0"/></inertial></link>'
)
ROBOT = (
    f'<robot name="rotor">{LINK.format("hull")}{LINK.format("disc")}<joint name="axle" type="continuous">'
    '<parent link="hull"/><child link="disc"/><origin xyz="0 0 0.1" rpy="0.3 0.1 -0.7"/>'
    '<axis xyz="1 0.5 0.2"/></joint></robot>'
)
DENSE = np.random.default_rng(7).normal(size=(5, 5))
STIFF = StiffnessBearing(joint="axle", radial=1e3, axial=3e3, tilt=5.0, coupling=20.0, offset=0.07)
FULL = StiffnessBearing(joint="axle", matrix=tuple((DENSE @ DENSE.T).ravel()), offset=-0.2)
BALLS = {
    "joint": "axle",
    "count": 12,
    "ball_diameter": 6e-3,
    "pitch_diameter": 40e-3,
    "contact_angle": 0.26,
    "preload": 50.0,
    "offset": 0.01,
}
PAIR = BallBearing(**BALLS, arrangement="back-to-back", spread=0.02, by="balls")
ROW = BallBearing(**BALLS, by="balls")


def mechanism(kind="free", base="free"):
    return build_mechanism(Urdf.from_text(ROBOT, "rotor.urdf").variant(joints={"axle": kind}), base)


def system(*bearings, **more):
    found = {f"b{k}": one for k, one in enumerate(bearings)}
    return System(mechanism(), elements={"bearings": found}, **more)


def play(bearing_on="parent", axial=2e-4):
    shape = RevoluteClearance.from_clearances(
        bearing_radius=0.01,
        radial_clearance=1e-4,
        bearing_length=0.02,
        axial_clearance=axial,
        bearing_outer_radius=0.015,
        flange_radius=0.014,
    )
    law = Hertz(stiffness=1e8, exponent=1.0)
    return ClearanceJoint(
        name="axle",
        geometry=shape,
        radial=law,
        axial=law,
        backend="closed-form",
        bearing_on=bearing_on,
        offset=0.05,
    )


def displaced(own, rng, size):
    """A state with the base anywhere and the journal off by a size."""
    nv = own.model.nv
    step = np.concatenate([rng.normal(size=6), size * rng.normal(size=nv - 6)])
    return own.state(pin.integrate(own.model, own.neutral(), step), rng.normal(size=nv))


def forces(own, y):
    workspace = Workspace(own)
    rates = np.zeros(own.model.nv + own.manifold.nx)
    workspace.apply_elements(0.0, y, rates)
    return np.array(workspace.tau), rates[own.model.nv :]


PRELOAD = AxialPreload(joint="axle", force=-30.0, stiffness=2e4)


@pytest.mark.parametrize(
    ("bearing", "size", "more"),
    [
        (STIFF, 0.3, {}),
        (FULL, 0.3, {}),
        (PAIR, 2e-6, {}),
        (ROW, 2e-6, {}),
        (PRELOAD, 0.3, {"clearances": [play()]}),
        (PRELOAD, 0.3, {"clearances": [play("child")]}),
        (STIFF, 0.3, {"clearances": [play("child")]}),
    ],
    ids=["isotropic", "matrix", "pair", "row", "preload", "preload-on-child", "beside-play"],
)
def test_force_is_the_gradient_of_energy(bearing, size, more):
    """Under tilts of any size, the bearing's place off the joint's; nothing acts on the base."""
    own = system(bearing, **more)
    y = displaced(own, np.random.default_rng(3), size)
    tau, _ = forces(own, y)
    step = 1e-4 * size

    def energy(way):
        q = pin.integrate(own.model, y[: own.model.nq], way)
        return audit(Workspace(own), own.state(q, np.zeros(own.model.nv))).springs

    slope = [(energy(e * step) - energy(-e * step)) / (2.0 * step) for e in np.eye(own.model.nv)]
    # Second differences: step^2 over the energy's own scale, 1e-8, and round-off over the step.
    assert tau == pytest.approx(-np.array(slope), abs=2e-8 * np.abs(tau).max())
    assert not tau[:6].any()
    about = own.mechanism.joint("axle").axis
    if bearing is not PRELOAD and not more:
        # No torque about the journal's own axis.
        assert tau[9:] @ about == pytest.approx(0.0, abs=1e-13 * np.abs(tau[9:]).max())


def test_damping_loses_what_it_takes():
    """Power into the damper is the work of its force."""
    kept = StiffnessBearing(joint="axle", matrix=FULL.matrix, offset=-0.2)
    lossy = StiffnessBearing(joint="axle", matrix=FULL.matrix, offset=-0.2, damping_time=0.01)
    own = system(lossy)
    y = displaced(own, np.random.default_rng(4), 0.3)
    tau, rates = forces(own, y)
    elastic, _ = forces(system(kept), y)
    v = y[own.model.nq :][: own.model.nv]
    lost = rates[own.element_x[0]]
    assert lost > 0.0
    assert (elastic - tau) @ v == pytest.approx(lost, rel=1e-12, abs=0.0)


def test_derivatives_of_accelerations_are_stiffness_and_damping_over_mass():
    """At rest, where neither mass nor place has a share: over all freedoms of the joint and their rates."""
    own = system(StiffnessBearing(joint="axle", matrix=FULL.matrix, offset=-0.2, damping_time=0.01))
    field, nv, nq = VectorField(own, RunSettings(engine="compiled")), own.model.nv, own.model.nq
    rest = own.state(own.neutral(), np.zeros(nv))
    ways = np.eye(field.displacement)[:, : 2 * nv]
    parts = Tangents(own, field._stepper, np.concatenate(field.units), WEIGHTS)
    found = parts.rates(0.0, rest, ways, np.full(2 * nv, 1e-4))[0, :nv]

    def force(way, rate):
        return forces(own, own.state(pin.integrate(own.model, own.neutral(), way), rate))[0]

    step, still = 1e-4, np.zeros(nv)
    slopes = [(force(step * e, still) - force(-step * e, still)) / (2.0 * step) for e in np.eye(nv)]
    slopes += [(force(still, e) - force(still, -e)) / 2.0 for e in np.eye(nv)]
    mass = pin.crba(own.model, own.model.createData(), rest[:nq])
    mass = np.triu(mass) + np.triu(mass, 1).T
    expected = np.linalg.solve(mass, np.array(slopes).T)
    assert np.linalg.matrix_rank(expected[:, 6:nv]) == 5  # the journal spins freely
    # Force over a tilt is odd: its differences are off by the step's square.
    assert found == pytest.approx(expected, abs=1e-7 * np.abs(expected).max())


def test_a_bearing_is_the_same_about_another_point():
    """A matrix moved along the axis, at small displacements: the difference is of second order."""
    own, other = (
        system(StiffnessBearing(joint="axle", matrix=tuple(matrix.ravel()), offset=offset))
        for matrix, offset in ((STIFF.stiffness, 0.07), (moved(STIFF.stiffness, 0.05), 0.12))
    )
    size = 1e-7
    y = displaced(own, np.random.default_rng(5), size)
    one, two = forces(own, y)[0], forces(other, y)[0]
    assert one == pytest.approx(two, abs=3.0 * size * np.abs(one).max())


def test_two_bearings_share_a_joint():
    """Their forces add up, each at its own place."""
    y = displaced(system(STIFF, FULL), np.random.default_rng(6), 0.3)
    both, one, two = (
        forces(system(*them), y[:-1] if len(them) == 1 else y)[0]
        for them in ((STIFF, FULL), (STIFF,), (FULL,))
    )
    assert both == pytest.approx(one + two, rel=1e-13, abs=1e-12)


def test_loads_are_about_the_reference_point():
    """Of a radial force at the reference point there is no moment; deflection is that point's."""
    own = system(StiffnessBearing(joint="axle", radial=1e6, axial=2e6, offset=0.07))
    y = displaced(own, np.random.default_rng(8), 0.2)
    found = bearing_loads(own, y[np.newaxis], [own.program])[0, 0]
    assert found["moment"] == pytest.approx(0.0, abs=1e-12 * np.abs(found["force"]).max())
    assert found["force"] == pytest.approx(-np.array([1e6, 1e6, 2e6]) * found["place"], rel=1e-13)


def test_other_elements_act_about_its_axis():
    """The joint keeps its axis, with whole turns."""
    own = system(STIFF, springs={"wind": JointSpring(joint="axle", stiffness=3.0)})
    y = own.state(own.neutral(), np.zeros(own.model.nv), {"axle": 4.0 * math.pi})
    tau, _ = forces(own, y)
    expected = -3.0 * 4.0 * math.pi * own.mechanism.joint("axle").axis
    assert tau[9:] == pytest.approx(expected, rel=1e-14)


def test_where_a_preload_is_given():
    """At the face that it presses on, pressed in at rest, or in the middle."""
    for given_at, expected in (("touching", -2e-4), ("rest", -2e-4 - 30.0 / 1e8), ("centred", 0.0)):
        preload = AxialPreload(joint="axle", force=-30.0, stiffness=2e4, given_at=given_at)
        placed = system(preload, clearances=[play()]).families["bearings"]["b0"]
        assert placed.position == pytest.approx(expected, rel=1e-13, abs=0.0)


@pytest.mark.parametrize(
    ("make", "error", "said"),
    [
        (
            lambda: System(mechanism("ideal"), elements={"bearings": {"b": STIFF}}),
            MechanismError,
            "must be free",
        ),
        (lambda: system(STIFF, held={"axle": "revolute"}), MechanismError, "held by constraint"),
        (lambda: system(PRELOAD), InvalidParameterError, "one with play"),
        (
            lambda: system(
                AxialPreload(joint="axle", force=1e6, stiffness=1.0, given_at="rest"), clearances=[play()]
            ),
            InvalidParameterError,
            "force must be below",
        ),
    ],
)
def test_joints_that_have_no_bearing(make, error, said):
    """One line that says what to do."""
    with pytest.raises(error, match=said):
        make()
