"""What is recorded beside the state follows from it: accelerations are the derivatives of rates."""

import dataclasses

import numpy as np
import pinocchio as pin
import pytest

from antenna_pin import (
    ErrorScales,
    Outcome,
    RunSettings,
    System,
    Trajectory,
    Urdf,
    build_mechanism,
    simulate,
)
from antenna_pin.contact import Hertz
from antenna_pin.elements import ConstantDrive, SineDrive
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints.geometry import RevoluteClearance
from antenna_pin.run.simulation.steps import scale_vector

BODY = """
<robot name="tumbler">
  <link name="ground"/>
  <link name="body"><inertial><mass value="1"/>
    <inertia ixx="0.3" iyy="0.4" izz="0.5" ixy="0.02" ixz="-0.01" iyz="0.03"/></inertial></link>
  <joint name="axle" type="continuous"><parent link="ground"/><child link="body"/><axis xyz="{axis}"/></joint>
</robot>
"""
LENGTH, PLAY = 0.05, 0.3


def tumbler(axis):
    """A body whose journal has so much room that it turns freely at any tilt of half a radian."""
    law = Hertz(stiffness=1e9)
    joint = ClearanceJoint(
        name="axle",
        geometry=RevoluteClearance(
            bearing_radius=PLAY + 0.01,
            journal_radius=0.01,
            bearing_length=LENGTH,
            flange_distance=5.0,
            bearing_outer_radius=0.4,
            flange_radius=0.4,
        ),
        radial=law,
        axial=law,
        backend="closed-form",
    )
    urdf = Urdf.from_text(BODY.format(axis=" ".join(map(str, axis))), "tumbler.urdf")
    mechanism = build_mechanism(urdf.variant(joints={"axle": "free"}), base="fixed")
    return System(mechanism, clearances=[joint])


@pytest.mark.parametrize("axis", [(0, 0, 1), (1, 2, -2)], ids=str)
def test_the_acceleration_of_the_motion_angle_is_the_derivative_of_its_rate(axis):
    """And the rate that of the angle, for a journal that tumbles with tilt and tilt rates of order one."""
    system = tumbler(axis)
    q, v = system.neutral(), np.zeros(system.model.nv)
    q[3:7] = pin.Quaternion(pin.exp3(np.array([0.4, -0.3, 0.5]))).coeffs()
    v[3:6] = 0.9, 0.6, 1.5
    run = simulate(system, duration=0.3, q=q, v=v, settings=RunSettings(rtol=1e-12, output_rate=1000.0))
    assert run.data.sizes["episode"] == 0 and float(run.data["journal_tilt"].min()) > 0.3
    t, h = run.data["time"].values, 1e-3
    assert t.size == 301
    angle, rate, acceleration = (
        run.data[f"motion_{name}"].sel(joint="axle").values for name in ("angle", "rate", "acceleration")
    )
    for values, derivative in ((angle, rate), (rate, acceleration)):
        slope = (values[:-4] - 8.0 * values[1:-3] + 8.0 * values[3:-1] - values[4:]) / (12.0 * h)
        # h^4 / 30 of the fifth derivative is 1e-12; dense output at 1e-12 over h is 1e-9.
        assert slope == pytest.approx(derivative[2:-2], rel=0.0, abs=1e-8)
        assert np.ptp(derivative) > 0.01


def test_a_journal_s_tilt_is_measured_where_it_closes_the_gap():
    """A unit of tilt moves the axis at the bearing's end by a unit of position; turning counts in radians."""
    scales = ErrorScales(angle=0.7, angular_velocity=0.3, clearance=0.25, clearance_velocity=0.02)
    system = tumbler((0, 0, 1))
    nv = system.model.nv
    found = scale_vector(system, scales)
    position, velocity = found[:nv], found[nv : 2 * nv]
    half = 0.5 * LENGTH
    # Products of the numbers given, but for round-off.
    assert position == pytest.approx([0.25 * PLAY] * 3 + [0.25 * PLAY / half] * 2 + [0.7], rel=1e-14, abs=0.0)
    assert velocity == pytest.approx([0.02] * 3 + [0.02 / half] * 2 + [0.3], rel=1e-14, abs=0.0)


FLOATING = """<robot name="floating"><link name="base"><inertial><mass value="2"/>
<inertia ixx="0.3" iyy="0.4" izz="0.5" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<link name="tip"><inertial><origin xyz="0.5 0 0"/><mass value="1"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


@pytest.mark.parametrize("far", [1e4, 8e9])
def test_accelerations_do_not_hang_on_where_the_base_is(far):
    mechanism = build_mechanism(Urdf.from_text(FLOATING, "floating.urdf"), base="free")
    system = System(mechanism, drives={"m": ConstantDrive(joint="j", value=0.7)})
    q, v = system.neutral(), np.zeros(system.model.nv)
    v[3:] = 0.1, -0.2, 0.3, 0.4
    near, away = (
        simulate(system, duration=0.01, q=np.concatenate([[x, 0.0, 0.0], q[3:]]), v=v) for x in (0.0, far)
    )
    assert away.completed and np.isfinite(away.data.a).all()
    # The base's own steps are rounded to its position, and its attitude is not.
    assert away.data.a.values == pytest.approx(near.data.a.values, rel=1e-9, abs=1e-12)


def test_what_is_recorded_and_is_not_finite_is_the_end_of_no_completed_run(tmp_path):
    """The state is, and its momentum's sum is beyond all floats."""
    mechanism = build_mechanism(Urdf.from_text(FLOATING, "floating.urdf"), base="free")
    system = System(mechanism)
    v = np.zeros(system.model.nv)
    v[0] = 1e200
    start = dataclasses.replace(simulate(system, duration=1e-3).end, v=v)
    run = simulate(system, duration=1e-3, start=start)
    assert run.outcome is Outcome.NOT_FINITE and "kinetic_energy is not finite" in run.message
    assert not Trajectory.load(run.save(tmp_path / "run.nc")).completed


def test_an_error_counts_against_the_largest_of_work_and_energies():
    """Some 18 mJ at the start; a drive swings fifty times about it, with 70 N m or with next to nothing."""
    mechanism = build_mechanism(Urdf.from_text(FLOATING, "floating.urdf"), base="free")
    v = np.zeros(7)
    v[6] = 0.4
    for torque, of in ((1e-14, "largest kinetic energy"), (70.0, "gross work of the drives")):
        system = System(mechanism, drives={"m": SineDrive(joint="j", amplitude=torque, frequency=5000.0)})
        kept = simulate(system, duration=0.01, v=v).summary()["conservation"]
        assert 0.0 < kept["gross_work"] and kept["energy_scale_of"] == of
        assert kept["energy_error_relative"] == kept["energy_error"] / kept["energy_scale"] < 1e-9
