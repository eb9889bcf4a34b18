"""Motions of joints with play: a shaft that is made to turn in its bearing."""

import json

import numpy as np
import pinocchio as pin
import pytest
from hinge_shapes import antenna_hinge

from antenna_pin import ClearanceJoint, RunSettings, System, simulate
from antenna_pin.contact import Hertz, LankaraniNikravesh, NoFriction, Tanh
from antenna_pin.dynamics import assembled
from antenna_pin.elements import PrescribedMotion
from antenna_pin.joints.geometry import PlanarClearance, PrismaticClearance
from antenna_pin.mechanism import Urdf, build_mechanism

SHAFT = """<robot name="shaft"><link name="body"><inertial><origin xyz="0.1 0 0"/><mass value="8"/>
<inertia ixx="0.3" iyy="0.2" izz="0.4" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="hinge" type="{kind}"><parent link="body"/><child link="shaft"/>
<origin xyz="0 0.1 0" rpy="0.2 0.1 0"/><axis xyz="{axis}"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<link name="shaft"><inertial><origin xyz="0.004 0.001 0.01"/><mass value="1"/>
<inertia ixx="2e-3" iyy="2.5e-3" izz="1e-3" ixy="0" ixz="1e-4" iyz="0"/></inertial></link></robot>"""
SPACE = antenna_hinge(axial_clearance=0.0003)  # fmt: skip
PLANE = PlanarClearance(bearing_radius=0.01, journal_radius=0.0098)
RATE = 20.0


def spun(shape, *, on="parent", base="free", elastic=True, axis="0.3 -0.2 1", duration=0.03, **settings):
    """A run of an unbalanced shaft held to a constant spin in its bearing."""
    planar = shape is PLANE
    urdf = Urdf.from_text(SHAFT.format(kind="continuous", axis=axis), "shaft")
    free = urdf.variant(joints={"hinge": "planar" if planar else "free"})
    law = Hertz(stiffness=1e9) if elastic else LankaraniNikravesh(stiffness=1e9, restitution=0.7)
    friction = NoFriction() if elastic else Tanh(coefficient_of_friction=0.1, transition_speed=0.01)
    joint = ClearanceJoint(
        name="hinge", geometry=shape, radial=law, axial=None if planar else law, friction=friction,
        backend="closed-form", bearing_on=on, maximum_depth=1e-3,
    )  # fmt: skip
    motor = PrescribedMotion(joint="hinge", rate=RATE)
    system = System(build_mechanism(free, base), clearances=[joint], drives={"motor": motor})
    v = np.zeros(system.model.nv)
    own = system.mechanism.joint("hinge").v.start
    v[own : own + 2] = 0.05, -0.03
    if not planar:
        v[own + 2 : own + 5] = 0.1, 0.4, -0.3
    return system, started(system, duration, v=v, settings=RunSettings(rtol=1e-10, **settings))


def started(system, duration, v=None, **options):
    """A run from a state near to the given one that has the motion's rate."""
    q, v = assembled(system, pin.neutral(system.model), v)
    return simulate(system, duration=duration, q=q, v=v, **options)


@pytest.mark.parametrize("elastic", [True, False])
@pytest.mark.parametrize("on", ["parent", "child"])
@pytest.mark.parametrize("shape", [SPACE, PLANE], ids=["space", "plane"])
def test_a_shaft_keeps_its_spin_whatever_knocks_it(shape, on, elastic):
    """The angle is rate times time; its acceleration, by Pinocchio's, is zero though the shaft tilts."""
    system, run = spun(shape, on=on, elastic=elastic)
    assert run.completed, run.message
    data = run.data
    assert data.sizes["episode"] > 2
    t = data["time"].values
    assert data["motion_angle"].values[:, 0] == pytest.approx(RATE * t, abs=1e-11)
    assert data["motion_rate"].values[:, 0] == pytest.approx(RATE, abs=1e-10 * RATE)
    # Contact forces of some 100 N on inertias of 1e-3 kg m^2: 1e5 rad/s^2, to round-off of a solution.
    assert np.abs(data["motion_acceleration"].values[:, 0]).max() < 1e-6
    if shape is SPACE:
        assert data["journal_tilt"].values.max() > 1e-3
    kept = json.loads(data.attrs["conservation"])
    # The couple acts on both sides alike; its work is the motion's.
    assert kept["linear_momentum_drift_relative"] < 1e-9
    assert kept["angular_momentum_drift_relative"] < 1e-9
    assert kept["energy_error"] < 1e-7 * data["kinetic_energy"].values.max()
    assert np.abs(data["drive_torque"].values).max() > 0.0


def test_a_free_symmetric_shaft_needs_no_couple():
    """Centred, balanced and untouched it goes on by itself: the couple that holds its rate is zero."""
    text = SHAFT.replace("0.004 0.001 0.01", "0 0 0").replace('ixz="1e-4"', 'ixz="0"')
    urdf = Urdf.from_text(text.format(kind="continuous", axis="0 0 1"), "shaft")
    joint = ClearanceJoint(
        name="hinge",
        geometry=SPACE,
        radial=Hertz(stiffness=1e9),
        axial=Hertz(stiffness=1e9),
        backend="closed-form",
    )
    system = System(
        build_mechanism(urdf.variant(joints={"hinge": "free"}), "fixed"),
        clearances=[joint],
        drives={"motor": PrescribedMotion(joint="hinge", rate=RATE)},
    )
    run = started(system, 0.02)
    assert run.data.sizes["episode"] == 0
    assert np.abs(run.data["drive_torque"].values).max() < 1e-12
    # Held, however, against a spin of the whole: inertia times what the motion asks for.
    motor = PrescribedMotion(joint="hinge", rate=RATE, coefficients=(25.0,))
    system = System(
        build_mechanism(urdf.variant(joints={"hinge": "free"}), "fixed"),
        clearances=[joint],
        drives={"motor": motor},
    )
    data = started(system, 0.02).data
    assert data["drive_torque"].values == pytest.approx(1e-3 * 50.0, abs=1e-12)


def test_sliders_are_refused_by_name():
    shape = PrismaticClearance(
        guide_width=0.0402, guide_height=0.0402, slider_width=0.04, slider_height=0.04, slider_length=0.1
    )
    urdf = Urdf.from_text(SHAFT.format(kind="prismatic", axis="0 0 1"), "shaft")
    joint = ClearanceJoint(name="hinge", geometry=shape, radial=Hertz(stiffness=1e9))
    with pytest.raises(ValueError, match="only a revolute or continuous joint, with play or without"):
        System(
            build_mechanism(urdf.variant(joints={"hinge": "free"}), "fixed"),
            clearances=[joint],
            drives={"motor": PrescribedMotion(joint="hinge", rate=1.0)},
        )
