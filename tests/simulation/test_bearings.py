"""Rotors on bearings and preloaded joints in time: ledgers, halves, lift-off and frequencies."""

from __future__ import annotations

import numpy as np
import pytest

from antenna_pin import RunSettings, simulate
from antenna_pin.contact import Hertz
from antenna_pin.dynamics import System
from antenna_pin.elements import AxialPreload, BallBearing, JointFriction
from antenna_pin.errors import InvalidParameterError
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints.geometry import RevoluteClearance
from antenna_pin.mechanism import Urdf, build_mechanism

MASS, CONTACT, SPRING, FORCE, PLAY = 2.0, 1e8, 1e5, 50.0, 2e-4
LINK = (
    '<link name="{}"><inertial><origin xyz="0 0 {}"/><mass value="2"/>'
    '<inertia ixx="0.006" iyy="0.007" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
ROBOT = (
    '<robot name="rotor">{}{}<joint name="axle" type="continuous"><parent link="hull"/><child link="disc"/>'
    '<origin xyz="0 0 0.1"/><axis xyz="0 0 1"/></joint></robot>'
)
BALLS = {
    "joint": "axle",
    "count": 12,
    "ball_diameter": 6e-3,
    "pitch_diameter": 40e-3,
    "contact_angle": 0.26,
    "preload": 50.0,
}


def mechanism(base, gravity=(0.0, 0.0, 0.0), height=0.03):
    text = ROBOT.format(LINK.format("hull", 0.01), LINK.format("disc", height))
    return build_mechanism(Urdf.from_text(text, "rotor.urdf").variant(joints={"axle": "free"}), base, gravity)


def on_balls(by="balls", **more):
    """A free-floating rotor on a damped pair of rows, with friction about its axis."""
    pair = BallBearing(**BALLS, arrangement="back-to-back", spread=0.02, by=by, damping_time=1e-5)
    friction = JointFriction(joint="axle", damping=1e-3)
    return System(
        mechanism("free"), elements={"bearings": {"pair": pair}}, springs={"friction": friction}, **more
    )


def start(system):
    """Spinning, off centre by half a micrometre, and tumbling."""
    q, v = system.neutral(), np.zeros(system.model.nv)
    q[7:10] = 5e-7, -3e-7, 2e-7
    v[3:6] = 0.3, -0.2, 0.1
    v[-1] = 300.0
    return q, v


@pytest.mark.parametrize("by", ["balls", "linear"])
def test_ledgers_at_the_default_tolerance(by):
    """Deflections of micrometres are resolved, though steps know of no play."""
    system = on_balls(by)
    q, v = start(system)
    data = simulate(system, q=q, v=v, duration=0.02, settings=RunSettings(output_rate=1e3)).data
    assert np.abs(data.energy_error).max() < 1e-5 * data.total_element_loss[0]
    momentum = data.linear_momentum.values
    # Steps are good to 1e-8 of 10 mm/s and of what moves; with scales of a metre this is 1e-6.
    assert np.abs(momentum - momentum[0]).max() < 1e-7 * data.momentum_scale.max()


# --- preload ------------------------------------------------------------------------------------------------


def seated(force=FORCE, gravity=0.0, axial=PLAY, preload=True, **more):
    """A journal along z in a bearing that stands still, pushed up onto a flange; gravity pulls it down."""
    shape = RevoluteClearance.from_clearances(
        bearing_radius=0.01,
        radial_clearance=1e-4,
        bearing_length=0.02,
        axial_clearance=axial,
        bearing_outer_radius=0.015,
        flange_radius=0.014,
    )
    law = Hertz(stiffness=CONTACT, exponent=1.0)
    joint = ClearanceJoint(name="axle", geometry=shape, radial=law, axial=law, backend="closed-form")
    spring = AxialPreload(joint="axle", force=force, stiffness=SPRING, **more)
    elements = {"bearings": {"push": spring}} if preload else {}
    return System(mechanism("fixed", (0.0, 0.0, -gravity), height=0.0), clearances=[joint], elements=elements)


def let_go(system, z, duration, rate):
    q = system.neutral()
    q[2] = z
    return simulate(
        system, q=q, v=np.zeros(6), duration=duration, settings=RunSettings(rtol=1e-11, output_rate=rate)
    ).data


def test_seated_it_swings_on_contact_and_spring():
    """omega^2 = (k_contact + k_spring) / m about the rest, while the face stays pressed."""
    system = seated()
    rest = PLAY + FORCE / (CONTACT + SPRING)
    omega, off = np.sqrt((CONTACT + SPRING) / MASS), 0.5 * FORCE / CONTACT
    data = let_go(system, rest + off, 0.01, 2e4)
    found = data.journal_position.values[:, 0, 2] - rest
    # Over 11 swings; steps are good to 1e-11 of the play.
    assert np.abs(found - off * np.cos(omega * data.time.values)).max() < 1e-7 * off
    assert data.touching.values[:, 3].all()
    assert np.abs(data.energy_error).max() < 1e-8 * data.contact_energy.max()


def test_lifted_off_it_swings_on_the_spring_alone():
    """omega^2 = k_spring / m about where the spring and gravity balance, free of both faces."""
    gravity = 35.0  # 70 N against 50 N: 0.2 mm below the face
    system = seated(gravity=gravity)
    rest = PLAY + (FORCE - MASS * gravity) / SPRING
    omega, off = np.sqrt(SPRING / MASS), 1.5e-4
    data = let_go(system, rest + off, 0.1, 1e3)
    found = data.journal_position.values[:, 0, 2] - rest
    assert np.abs(found - off * np.cos(omega * data.time.values)).max() < 1e-7 * off
    assert not data.touching.values.any()


@pytest.mark.parametrize(("share", "stays"), [(1.0 - 1e-6, True), (1.0 + 1e-6, False)])
def test_the_face_lifts_off_at_the_preload(share, stays):
    """At rest under an outside force of the preload's size, whatever contact and spring are."""
    gravity = share * FORCE / MASS
    system = seated(gravity=gravity)
    spare = FORCE - MASS * gravity
    rest = PLAY + spare / (CONTACT + SPRING if stays else SPRING)
    data = let_go(system, rest, 1e-3, 1e4)
    assert bool(data.touching.values[:, 3].all()) is stays
    assert bool(data.touching.values.any()) is stays
    # It stays where forces balance: to round-off of a force of 50 N over the stiffness.
    assert np.abs(data.journal_position.values[:, 0, 2] - rest).max() < 1e-14


def test_the_other_face():
    """Pulled down by more than preload and spring the journal comes to rest on the other flange."""
    gravity = (FORCE + 2.0 * PLAY * SPRING + 20.0) / MASS
    system = seated(gravity=gravity)
    rest = -PLAY - 20.0 / (CONTACT + SPRING)
    data = let_go(system, rest, 1e-3, 1e4)
    assert data.touching.values[:, 2].all()
    assert np.abs(data.journal_position.values[:, 0, 2] - rest).max() < 1e-14


def test_hard_preload_presses_both_faces():
    """omega^2 = 2 k_contact / m, and a preload of k_contact times the interference on each face."""
    system = seated(axial=-5e-7, preload=False)
    omega, off = np.sqrt(2.0 * CONTACT / MASS), 1e-7
    data = let_go(system, off, 0.005, 2e4)
    z = data.journal_position.values[:, 0, 2]
    # 8 swings; round-off of the flanges' distance of 20 mm over the way: 3e-11.
    assert np.abs(z - off * np.cos(omega * data.time.values)).max() < 1e-7 * off
    force = data.normal_force.values[:, 2:]
    assert force[0] == pytest.approx([60.0, 40.0], rel=1e-9) or force[0] == pytest.approx(
        [40.0, 60.0], rel=1e-9
    )
    assert data.touching.values[:, 2:].all()


def test_too_hard_a_preload():
    """Beyond what contact stiffness applies to."""
    with pytest.raises(InvalidParameterError, match="flange_distance must be at least"):
        seated(axial=-1.1e-4)
