"""Laws of the literature and distributed load inside runs: ledgers, bristles, ranges."""

import math

import pytest

from antenna_pin import Outcome, load_scenario, simulate

CLOSED = "clearance.elevation.geometry=closed-form"


def antenna(*overrides, duration=0.05):
    return simulate(load_scenario("bai2020", case="case3", overrides=[CLOSED, *overrides]), duration=duration)


def kept(run):
    assert run.completed, run.message
    found = run.summary()["conservation"]
    assert found["linear_momentum_drift_relative"] < 1e-8
    assert abs(found["energy_error_relative"]) < 1e-6
    assert run.data.sizes["episode"] > 0


#: Normal laws of a line, beside a dissipation (at flanges Hertz's law stands in), and whole ones; bristles.
NORMAL = {
    **dict.fromkeys(
        ("johnson", "liu-foundation", "hertz-line", "radzimovsky", "persson", "bai-zhao-elastic"),
        "dissipation='flores', restitution=0.9",
    ),
    **dict.fromkeys(
        ("hunt-crossley", "exact-restitution", "flores", "gonthier", "hu-guo"), "restitution=0.8"
    ),
}
LUGRE = "dynamic=0.1, static=0.15, stribeck_speed=5e-3, bristle_stiffness=1e5, bristle_damping=50"
BRISTLES = {
    "dahl": "coefficient_of_friction=0.1, bristle_stiffness=1e5",
    "lugre": LUGRE,
    "gonthier-bristle": f"{LUGRE}, dwell_time=0.05",
}


@pytest.mark.parametrize(
    ("part", "law", "given"),
    [("normal", *one) for one in NORMAL.items()] + [("friction", *one) for one in BRISTLES.items()],
)
def test_a_law_is_named_in_a_table_and_keeps_the_ledgers(part, law, given):
    run = antenna(f"clearance.elevation.{part}={{law='{law}', {given}, replace=true}}")
    kept(run)
    assert run.data["friction_force"].values.max() > 0.0


# A pendulum let go at 0.5 degrees in a bore of 10 mm: its journal of 9.9 mm rolls up the bore until the
# contact point is above the mass centre, if friction holds it there.
HANGING = {
    "gonthier-bristle": "dynamic=0.1, static=0.15, stribeck_speed=1e-3, bristle_stiffness=1e5,"
    " bristle_damping=300, dwell_time=0.05",
    "velocity-based": "static=0.15, dynamic=0.1, static_speed='1 mm/s', dynamic_speed='10 mm/s'",
}


def hanging(law):
    overrides = [
        "clearance.hinge.geometry=closed-form",
        f"clearance.hinge.friction={{law='{law}', {HANGING[law]}, replace=true}}",
        "initial.joints.hinge.angle=0.5 deg",
    ]
    run = simulate(load_scenario("pendulum", case="planar-rest", overrides=overrides), duration=2.0)
    assert run.completed, run.message
    data = run.data
    fallen = float(data["gravity_energy"].values[0] - data["gravity_energy"].values[-1])
    assert abs(data["energy_error"].values).max() < 1e-9 * fallen  # of the steps; rtol is 1e-10
    return data


def test_a_bristle_holds_a_static_load():
    """It comes to rest out of plumb, on more than its dynamic friction, and stays there."""
    data = hanging("gonthier-bristle")
    angle = float(data["motion_angle"].values[-1, 0])
    ratio = float(data["friction_force"].values[-1, 0] / data["normal_force"].values[-1, 0])
    assert angle > math.radians(0.4)
    assert 0.1 < ratio < 0.15
    # No moment about the contact point, which the depth of 0.2 um takes 2e-5 of its radius into the bore.
    assert 0.2 * math.sin(angle) == pytest.approx(9.9e-3 * math.sin(math.atan(ratio)), rel=1e-4, abs=0.0)
    # What is left of the creeping in the hinge's damper; the play divides the angle's rate by a hundred.
    assert abs(float(data["motion_rate"].values[-1, 0])) < 1e-6
    assert float(data["slip_speed"].values[-1, 0]) < 1e-8


def test_without_bristles_the_same_load_creeps_away():
    data = hanging("velocity-based")
    assert abs(float(data["motion_angle"].values[-1, 0])) < math.radians(0.01)


def test_distributed_load_keeps_the_ledgers():
    run = antenna(
        "clearance.elevation.load=distributed",
        "clearance.elevation.normal="
        "{law='liu-foundation', dissipation='lankarani-nikravesh', restitution=0.9, replace=true}",
        "integrator.rtol=1e-9",
    )
    kept(run)


def test_a_run_that_leaves_the_range_of_its_law_says_which_contact():
    """Johnson's law turns over at 0.541 of the play; a play of 5 um is soon pressed that far."""
    run = antenna(
        "clearance.elevation.normal={law='johnson', replace=true}",
        "clearance.elevation.radial_clearance=2 um",
        "drives.elevation.amplitude=4000",
        "drives.azimuth.amplitude=40000",
        duration=0.5,
    )
    assert run.outcome is Outcome.OUT_OF_LAW_RANGE
    assert "elevation.radial" in run.message
    assert "Johnson" in run.message
