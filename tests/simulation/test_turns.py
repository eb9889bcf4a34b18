"""Angles past half a turn: one continuous angle for springs, drives and results, whatever holds the joint."""

import math

import numpy as np
import pytest
from hinge_shapes import antenna_hinge
from wheel import wheel_urdf

from antenna_pin import RunSettings, System, build_mechanism, load_scenario, simulate
from antenna_pin.analysis import deviation
from antenna_pin.contact import Hertz
from antenna_pin.dynamics import CallableDrive, JointSpring
from antenna_pin.errors import AntennaPinError
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints.geometry import PlanarClearance
from antenna_pin.scenario.assemble import build_system, initial_angles, initial_state

KINDS = ("revolute", "continuous", "constraint", "planar", "contact")
TIGHT = RunSettings(rtol=1e-12, output_rate=200.0)


def wheel(kind, **elements):
    """A balanced wheel on a joint of each kind; in those with play it touches nothing."""
    written = kind if kind == "revolute" else "continuous"
    variant = {"constraint": "free", "contact": "free", "planar": "planar"}.get(kind, "ideal")
    urdf = wheel_urdf(written).variant(joints={"axle": variant})
    law, clearances = Hertz(stiffness=1e9), ()
    if kind == "planar":
        geometry = PlanarClearance(bearing_radius=0.01, journal_radius=0.0099)
        clearances = (ClearanceJoint(name="axle", geometry=geometry, radial=law, backend="closed-form"),)
    elif kind == "contact":
        geometry = antenna_hinge(radial_clearance=0.0001, axial_clearance=0.0001)
        clearances = (
            ClearanceJoint(name="axle", geometry=geometry, radial=law, axial=law, backend="closed-form"),
        )
    held = {"axle": "revolute"} if kind == "constraint" else {}
    return System(build_mechanism(urdf, base="fixed"), clearances=clearances, held=held, **elements)


def start(system, angle, rate=0.0):
    """Configuration, velocity and whole turns of a wheel at an angle [rad] that turns at a rate [rad/s]."""
    slot = system.mechanism.joint("axle")
    q, v = system.neutral(), np.zeros(system.model.nv)
    c, s = math.cos(angle), math.sin(angle)
    q[slot.q] = {
        "revolute": [angle],
        "continuous": [c, s],
        "planar": [0.0, 0.0, c, s],
        "floating": [0.0, 0.0, 0.0, 0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2)],
    }[slot.kind]
    v[slot.v.stop - 1] = rate
    return {"q": q, "v": v, "angles": {"axle": angle} if system.turn_x else None}


def turned(run):
    return run.data["motion_angle"].sel(joint="axle").values


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("wound", [math.radians(200.0), -7.0])
def test_a_wound_spring_unwinds(kind, wound):
    """By 200 degrees, or by a turn and more: the oscillator's cosine, through half turns and back."""
    system = wheel(kind, springs={"s": JointSpring(joint="axle", stiffness=8.0)})
    run = simulate(system, duration=2.0, settings=TIGHT, **start(system, wound))
    exact = wound * np.cos(4.0 * run.data["time"].values)
    # Round-off of 2 s at a tolerance of 1e-12, on angles up to 7 rad.
    assert turned(run) == pytest.approx(exact, abs=1e-9)
    assert run.summary()["conservation"]["energy_error"] < 1e-9


@pytest.mark.parametrize("kind", KINDS)
def test_a_drive_sees_the_turns(kind):
    """A stop at half a turn, stiff as k: the wheel, driven on with T, comes to rest T / k past it."""

    def torque(t, angle, rate):
        return 1.0 - 200.0 * max(angle - math.pi, 0.0) - 20.0 * rate * (angle > math.pi)

    system = wheel(kind, drives={"stop": CallableDrive(joint="axle", torque=torque)})
    run = simulate(system, duration=6.0, settings=RunSettings(rtol=1e-9))
    assert run.completed, run.message
    # Settled to exp(-20 / (2 * 0.5) * 2 s); never past pi + the depth of the first swing.
    assert turned(run)[-1] == pytest.approx(math.pi + 1.0 / 200.0, abs=1e-6)
    assert turned(run).max() < 3.4


@pytest.mark.parametrize("kind", KINDS)
def test_turns_are_counted_between_samples_far_apart(kind):
    """80 turns a second, ten samples a second: what is recorded does not unwrap samples."""
    system = wheel(kind)
    run = simulate(
        system,
        duration=0.5,
        settings=RunSettings(output_rate=10.0, max_step=0.1),
        **start(system, 1.0, 500.0),
    )
    assert run.completed
    t = run.data["time"].values
    assert t.size == 6
    assert turned(run) == pytest.approx(1.0 + 500.0 * t, abs=1e-8)  # default tolerance, 250 rad


@pytest.mark.parametrize("case", ["contact", "planar", "ideal", "constraint"])
def test_an_initial_angle_past_half_a_turn_is_that_angle(case):
    """In the state, in the record and against the ideal joint."""
    overrides = ["initial.joints.hinge.angle=200 deg"]
    model = "contact" if case == "constraint" else case
    if case == "constraint":
        overrides.append("clearance.hinge.model=constraint")
    asked = load_scenario("pendulum", case=model, overrides=overrides)
    system = build_system(asked)
    if "hinge" in system.turn_x:
        y = system.state(*initial_state(asked, system), initial_angles(asked, system))
        x = y[system.model.nq + system.model.nv :]
        assert x[system.turn_x["hinge"]] == pytest.approx(math.radians(200.0), abs=1e-14)
    run = simulate(asked, duration=0.02)
    assert run.data["motion_angle"].values[0, 0] == pytest.approx(math.radians(200.0), abs=1e-14)
    ideal = simulate(load_scenario("pendulum", case="ideal", overrides=overrides), duration=0.02)
    if case in ("contact", "planar"):
        found = deviation(run, ideal)
        # The journal drops by its play in the time: 20 ms of free fall turn the bar by 1e-2 rad and less.
        assert found["hinge angle"].maximum < 0.05


def test_turns_must_be_those_of_a_joint_that_turns_without_end():
    system = wheel("revolute")
    with pytest.raises(AntennaPinError, match="joint that turns without end 'axle' is unknown"):
        simulate(system, duration=1.0, angles={"axle": 1.0})
    system = wheel("continuous")
    with pytest.raises(AntennaPinError, match="angles\\['axle'\\] must be finite"):
        simulate(system, duration=1.0, angles={"axle": math.nan})
