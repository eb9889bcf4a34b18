"""Point load at a flange: central impacts whatever the axis, and where the force acts at small tilt."""

import dataclasses

import numpy as np
import pinocchio as pin
import pytest
from hinge_shapes import antenna_hinge

from antenna_pin import load_scenario, simulate
from antenna_pin.contact import Hertz, LankaraniNikravesh, NoFriction
from antenna_pin.joints import ClearanceJoint

SHAPE = antenna_hinge()


def impact(axis, geometry, *overrides):
    run = simulate(
        load_scenario(
            "impact_pair",
            case="flange",
            overrides=[
                f"clearance.bore.geometry={geometry}",
                f"mechanism.joints.bore.axis={[float(x) for x in axis]}",
                *overrides,
            ],
        )
    )
    assert run.completed, run.message
    return run


def outcome(run):
    """What five impacts in a row come to."""
    names = (
        "onset_time",
        "release_time",
        "approach_speed",
        "peak_force",
        "peak_depth",
        "impulse",
        "dissipated",
    )
    return np.concatenate([run.data[name].values for name in names])


def steps(run):
    """Trial steps of all kinds."""
    return run.counts.accepted + run.counts.rejected + run.counts.relocated


@pytest.mark.parametrize(("geometry", "count"), [("closed-form", 25), ("coal", 5)])
def test_a_central_impact_is_the_same_along_every_axis(geometry, count):
    """Whatever round-off makes of parallel axes; nor does it depend on what measures the gaps."""
    tight = "integrator.rtol=1e-12"  # what is left of the steps' own errors is below what is compared
    reference = impact([0.0, 0.0, 1.0], "closed-form", tight)
    expected, rng = outcome(reference), np.random.default_rng(5)
    for axis in [*rng.normal(size=(count, 3)), np.array([0.3, -0.8, 0.5]), np.array([1.0, 2.0, 3.0])]:
        run = impact(axis, geometry, tight)
        assert outcome(run) == pytest.approx(expected, rel=1e-9, abs=0.0), axis
        assert steps(run) <= 2 * steps(reference), axis
        # Central: the force on the journal has no lever about its centre but round-off.
        assert np.abs(run.data["joint_torque"].values).max() < 1e-12 * 2000.0


@pytest.mark.parametrize("geometry", ["closed-form", "coal"])
@pytest.mark.parametrize("tilt", [1e-15, 1e-12, 1e-9, 1e-6])
def test_nearly_parallel_axes_cost_no_more_than_parallel_ones(geometry, tilt):
    parallel = impact([0.0, 0.0, 1.0], geometry)
    run = impact([0.0, 0.0, 1.0], geometry, f"initial.joints.bore.journal_tilt=[{tilt}, {0.3 * tilt}, 0]")
    assert steps(run) <= 2 * steps(parallel)


def joint(backend="closed-form", shape=SHAPE, restitution=1.0):
    law = LankaraniNikravesh(stiffness=1e11, restitution=restitution)
    return ClearanceJoint(
        name="j",
        geometry=shape,
        radial=Hertz(stiffness=1e11),
        axial=law,
        friction=NoFriction(),
        backend=backend,
    )


def pressed(one, tilt, direction, depth):
    """State of a joint whose -z flange is pressed by a depth at its deepest point, tilted."""
    turn = pin.exp3(tilt * np.array([np.cos(direction), np.sin(direction), 0.0]))
    q = np.array([0.0, 0.0, 0.0, *pin.Quaternion(turn).coeffs()])

    def at(z):
        return one.evaluate(np.array([0.0, 0.0, z, *q[3:]]), np.zeros(6))

    low, high = at(0.0).gap[3], at(1e-4).gap[3]
    z = 1e-4 * (-depth - low) / (high - low)
    # The middle of a flange's inner face moves aside with the tilt; that of the bearing's end face stays.
    wide = one.geometry.flange_radius >= one.geometry.bearing_outer_radius
    face = np.array([0.0, 0.0, z]) - 0.5 * one.geometry.flange_distance * turn[:, 2]
    return at(z), np.array([0.0, 0.0, -0.5 * one.geometry.bearing_length]) if wide else face


@pytest.mark.parametrize("backend", ["closed-form", "coal"])
@pytest.mark.parametrize("flange", [0.014, 0.011], ids=["wide flange", "small flange"])
def test_the_force_moves_from_the_axis_to_the_rim_and_stays_there(backend, flange):
    """On the axis at zero tilt, then on to the rim, where the far edge is free; its size is the law's."""
    shape = dataclasses.replace(SHAPE, flange_radius=flange)
    one, edge, depth = joint(backend, shape), min(0.012, flange), 5e-6
    whole = np.linspace(0.0, 2.0, 81)  # the difference in depth across the annulus, over the depth
    levers = []
    for s in whole:
        state, middle = pressed(one, np.arcsin(0.5 * s * depth / edge), 0.7, depth)
        assert state.gap[3] == pytest.approx(-depth, abs=1e-16)
        assert state.normal_force[3] == pytest.approx(one.axial.force(depth, 0.0, 1e-4), rel=1e-9)
        levers.append(np.linalg.norm(state.point[3] - middle) / edge)
    levers = np.array(levers)
    assert levers[0] < 1e-12
    # The depth is a difference of lengths of 1e-2 m: s is known to 1e-11.
    assert levers[whole >= 1.0] == pytest.approx(1.0, abs=1e-10)
    inside = levers[whole <= 1.0]
    assert (np.diff(inside) > 0.0).all() and np.diff(inside).max() < 0.05 and inside.max() < 1.0 + 1e-12


def test_the_point_is_the_papers_where_the_far_edge_is_free():
    """To the last digit: no result with a tilt that frees the far edge changes."""
    rng = np.random.default_rng(2)
    for _ in range(200):
        tilt, direction = rng.uniform(1e-4, 8e-3), rng.uniform(0.0, 2.0 * np.pi)
        depth = 2.0 * 0.012 * np.sin(tilt) * rng.uniform(0.01, 0.99)
        state, _ = pressed(joint(), tilt, direction, depth)
        axis = pin.exp3(tilt * np.array([np.cos(direction), np.sin(direction), 0.0]))[:, 2]
        deepest = -0.012 * axis[:2] / np.linalg.norm(axis[:2])
        assert state.point[3] == pytest.approx([*deepest, -0.025], abs=1e-13)


def test_the_ledger_closes_while_a_flange_rocks_flat():
    """The work that moving the force's point takes is in the losses: a pair that meets with a little tilt."""
    for tilt, restitution in ((1e-5, 1.0), (5e-5, 1.0), (5e-5, 0.7), (2e-4, 0.9)):
        run = impact(
            [0.0, 0.0, 1.0],
            "closed-form",
            f"initial.joints.bore.journal_tilt=[{tilt}, 0, 0]",
            f"clearance.bore.normal.restitution={restitution}",
            "integrator.rtol=1e-11",
            "initial.joints.bore.journal_angular_velocity=[0.02, 0.01, 0]",
        )
        flat = run.data["depth"].values[:, 2:] > 2.4e-2 * np.sin(run.data["journal_tilt"].values)
        assert flat.any()
        scale = run.data["kinetic_energy"].values[0]
        assert run.summary()["conservation"]["energy_error"] < 1e-8 * scale, tilt
        assert run.summary()["conservation"]["angular_momentum_drift"] < 1e-12
