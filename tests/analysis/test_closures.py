"""What loops carry, read from results, against maximal coordinates (tests/reference) and closed forms."""

import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from single_loops import bricard, four_bar, spatial_slider_crank

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import (
    body_poses,
    closure_loads,
    closures_of,
    drive_loads,
    drive_power,
    drives_of,
    effort_unit,
    joint_loads,
    said_of_constraints,
)


def run_of(loop, folder, *changes):
    (folder / "loop.urdf").write_text(loop.urdf)
    (folder / "scenario.toml").write_text(loop.scenario)
    return simulate(load_scenario(folder / "scenario.toml", overrides=changes))


@pytest.fixture(scope="module")
def spatial(tmp_path_factory):
    """A loop without redundant equations, by the package and by the reference."""
    loop = spatial_slider_crank()
    run = run_of(loop, tmp_path_factory.mktemp("spatial"), "duration=0.2")
    return loop, run, loop.system.run(run.data["time"].values, loop.start)


def test_joints_of_the_tree_carry_what_they_do_in_maximal_coordinates(spatial):
    """Of a loop as of a tree: the closure's force counts among what moves the bodies beyond a joint."""
    loop, run, reference = spatial
    loads = joint_loads(run)
    for name in ("pivot", "ball", "guide"):
        first = loop.system.joints[name].first
        turn = np.eye(3) if first.body == "world" else reference.rotation(first.body)
        expected = [(turn @ first.frame @ part[..., None])[..., 0] for part in reference.load(name)]
        if name == "guide":  # about the second side's point, which is the slider's origin as well
            assert np.array_equal(loop.system.joints[name].second.point, (0.0, 0.0, 0.0))
        for what, values in zip(("force", "torque"), expected, strict=True):
            size = max(np.abs(part).max() for part in expected)
            # Both integrate to 1e-12; reactions of a second's motion agree to 1e-8 in tests/simulation.
            np.testing.assert_allclose(loads[what].sel(moving_joint=name), values, rtol=0, atol=1e-8 * size)


def test_sizes_of_closures_are_those_of_their_series(spatial):
    _, run, _ = spatial
    loads = closure_loads(run)
    assert list(loads["closure"].values) == ["ball", "cross"]
    for name in ("ball", "cross"):
        force = np.linalg.norm(run.data["closure_force"].sel(closure=name), axis=1)
        mine = loads.sel(closure=name)
        assert float(mine["peak_force"]) == force.max() == run.data["peak_closure_force"].sel(closure=name)
        assert float(mine["time_of_peak_force"]) == run.data["time"].values[force.argmax()]
        assert 0.0 < float(mine["rms_force"]) < force.max()
    # A ball carries no moment at all.
    ball, cross = (float(loads["peak_moment"].sel(closure=name)) for name in ("ball", "cross"))
    assert ball == 0.0 < cross
    kinds = {name: one["kind"] for name, one in closures_of(run).items()}
    assert kinds == {"cross": "universal", "ball": "spherical"}


DRIVEN = "[drives.crank]\nkind = 'motion'\njoint = 'drive_pin'\nrate = 12.0\n\n[integrator]"


@pytest.fixture(scope="module")
def driven(tmp_path_factory):
    """The four-bar with its crank turned at 12 rad/s, and no other start than that."""
    loop = four_bar()
    start, rest = loop.scenario.split("[initial.joints.drive_pin]")
    text = start + DRIVEN + rest.split("[integrator]")[1]
    text = text.replace('"20 Hz"', '"1 kHz"')
    return run_of(dataclasses.replace(loop, scenario=text), tmp_path_factory.mktemp("driven"), "duration=0.5")


def test_what_a_motion_takes_is_its_power_over_time(driven):
    assert drives_of(driven) == {"crank": {"joint": "drive_pin", "slides": False, "motion": True}}
    assert effort_unit(driven, "crank") == "N m"
    assert list(driven.data["motion"].values) == ["crank"]
    loads = drive_loads(driven).sel(drive="crank")
    torque = driven.data["drive_torque"].sel(drive="crank").values
    assert float(loads["peak_effort"]) == driven.data["peak_effort"].values[0]
    assert float(loads["time_of_peak_effort"]) == driven.data["time_of_peak_effort"].values[0]
    # Samples at 1 kHz miss a top by (w h)^2 / 8 of it: at some 30 rad/s 1e-4.
    assert 0.0 < float(loads["peak_effort"]) - np.abs(torque).max() < 2e-4
    power = drive_power(driven, "crank")
    # The rate is 12 rad/s but for round-off of what is read off the state.
    np.testing.assert_allclose(power, 12.0 * torque, rtol=1e-12)
    # The trapezoidal rule at 1 kHz errs by h^2 / 12 of the power's second derivative over the time: with
    # some 100 W that swing at up to 50 rad/s, 1e-5 J.
    time = driven.data["time"].values
    assert float(loads["work"]) == pytest.approx(np.trapezoid(power, time), abs=5e-5, rel=0.0)
    assert float(loads["gross_work"]) >= abs(float(loads["work"])) > 1e-2


def test_a_motion_supplies_what_the_loop_stores(driven):
    """At constant speed the torque about the ground pin is what lifts and speeds up the links."""
    data = driven.data
    stored = data["kinetic_energy"] + data["gravity_energy"]
    work = data["drive_work"].sel(drive="crank")
    # The run's tolerance, 1e-12, on energies of some joules, summed over its steps.
    np.testing.assert_allclose(work, stored - stored[0], rtol=0, atol=1e-9)


def test_the_ground_pin_carries_weight_and_inertia(driven):
    """Both pins at ground together hold the loop: Newton's law for all bodies, whatever is redundant."""
    loads = joint_loads(driven)["force"]
    ground = loads.sel(moving_joint="drive_pin") + loads.sel(moving_joint="ground_pin")
    momentum = driven.data["linear_momentum"].values
    time = driven.data["time"].values
    weight = 9.81 * (0.6 + 0.9 + 0.7)
    rate = (momentum[2:] - momentum[:-2]) / (time[2:] - time[:-2])[:, None]
    rate[:, 2] += weight
    # Central differences at 1 kHz err by h^2 / 6 of the third derivative: 1e-3 of forces of 60 N and less.
    np.testing.assert_allclose(ground.values[1:-1], rate, rtol=0, atol=0.05)
    assert np.abs(rate).max() > 30.0


def test_redundant_equations_are_counted_where_they_are(driven, spatial, tmp_path):
    """A plane loop needs 2 of the 5 equations; Bricard's ring any 4 ... of its 5 with one freedom left."""
    counts = driven.constraints
    assert said_of_constraints(counts) == (
        "5 equations of closures, 2 independent (3 redundant, rocker_pin: along z, about x, about y); "
        "1 motion; mobility 1, of which the motion leaves 0"
    )
    assert said_of_constraints(spatial[1].constraints) == "7 equations of closures, 7 independent; mobility 1"
    ring = run_of(bricard(), tmp_path, "duration=1e-3").constraints
    assert (ring["closure_equations"], ring["closure_rank"], ring["mobility"]) == (5, 4, 1)
    assert ring["redundant"]["pin_6"]["equations"] == 1
    assert "1 redundant, pin_6: 1 of " in said_of_constraints(ring)


def test_a_marked_point_of_a_closure_is_one_point(driven):
    """Both sides of the closure are where the result says, to the residual that it reports."""
    poses = body_poses(driven)
    (closure,) = closures_of(driven).values()
    ends = []
    for side in ("first", "second"):
        at = {"body": closure[f"{side}_body"]}
        turn = Rotation.from_quat(poses["attitude"].sel(at).values)
        ends.append(poses["position"].sel(at).values + turn.apply(closure[f"{side}_placement"][:3]))
    residual = driven.constraints["position_residual"]
    assert residual < 1e-12
    np.testing.assert_allclose(ends[0], ends[1], rtol=0, atol=residual + 1e-14)
