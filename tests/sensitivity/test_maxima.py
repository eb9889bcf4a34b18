"""Largest forces of contacts, when they are, and largest sizes of series, by the equation."""

import numpy as np
import pytest

from antenna_pin import load_scenario
from antenna_pin.studies.sensitivity import sensitivities
from tests.sensitivity.test_gross_works import DRIVES, scenario
from tests.sensitivity.test_onsets import END, KEYS, MASS, PLAY, RIG, SPEED, STIFFNESS

CLOSED = ["integrator.engine=compiled", "clearance.hinge.geometry=closed-form"]


def test_an_elastic_impact_is_hardest_where_it_is_deepest():
    """Of ``F = K d^1.5``: d = (1.25 m v^2 / K)^0.4 at a time like d / v behind the onset, F like d^1.5."""
    law = f"clearance.bore.normal={{ law = 'hertz', stiffness = {STIFFNESS}, replace = true }}"
    changes = [*(f"{key}={value}" for key, value in RIG.items()), law]
    pair = load_scenario("impact_pair", case="planar", overrides=changes)
    keys = [*KEYS, "initial.joints.bore.journal_velocity[0]"]
    found = sensitivities(pair, keys, [END], method="equation")
    onset, peak, force = (
        float(found.run.data[name].values[0]) for name in ("onset_time", "peak_time", "peak_force")
    )
    assert (onset, force) == pytest.approx(
        (PLAY / SPEED, STIFFNESS * (1.25 * MASS * SPEED**2 / STIFFNESS) ** 0.6), rel=1e-9
    )
    # Exponents of mass, stiffness, play and speed.
    deep = (peak - onset) * np.array([0.4, -0.4, 0.0, -0.2])
    begins = np.array([0.0, 0.0, PLAY / SPEED, -PLAY / SPEED])
    exact = {"peak_time": begins + deep, "peak_force": force * np.array([0.6, 0.4, 0.0, 1.2])}
    for name, wanted in exact.items():
        off = np.abs(found.relative(name)[0] - wanted)
        # The run's own instant is located by values of the force: to the root of round-off, 1.5e-8.
        assert off.max() < (1e-9 * force if name == "peak_force" else 3e-8 * (peak - onset))
        doubt = (found.doubt(name) * [one.scale for one in found.parameters])[0]
        assert (off <= doubt).all()
        assert (doubt < 1e-4 * np.abs(wanted).max()).all()


def test_a_joint_turns_fastest_where_a_contact_pushes_most():
    """A bar's acceleration is largest at its blow's own instant, in neighbours at theirs: as runs say."""
    bar = load_scenario("pendulum", case="planar", overrides=CLOSED)
    law = "clearance.hinge.normal.restitution"
    keys = ["clearance.hinge.radial_clearance", law, "mechanism.gravity[2]"]
    runs, equation = (sensitivities(bar, keys, [6e-3], method=one) for one in ("runs", "equation"))
    data = equation.run.data
    at = int(np.argmax(np.abs(data["motion_acceleration"].values[:, 0])))
    assert float(data["time"].values[at]) == float(data["peak_time"].values[0])
    scales = np.array([one.scale for one in equation.parameters])
    for name in ("peak_acceleration", "peak_time"):
        off = np.abs(equation.relative(name) - runs.relative(name))
        ours = equation.doubt(name) * (name != "peak_time")  # which says what quick runs say otherwise
        assert (off <= (runs.doubt(name) + ours) * scales).all()
        # Of instants runs say no more: 1.5e-8 of 0.3 ms over a step of a thousandth.
        size = 3e-4 if name == "peak_time" else np.abs(runs.relative(name)).max()
        assert off.max() < (3e-5 if name == "peak_time" else 1e-6) * size


def test_a_size_at_an_output_time_stays_there():
    """Of a bar let go the largest acceleration is the first: - g m l sin(angle) / I, like the gravity."""
    bar = load_scenario("pendulum", case="ideal", overrides=CLOSED[:1])
    found = sensitivities(bar, {"mechanism.gravity[2]": None}, [0.0, 1e-3], method="equation")
    size, slope = found.run.data["peak_acceleration"].values[0], found.relative("peak_acceleration")[0, 0]
    assert slope == pytest.approx(-size, rel=1e-9)  # a scale up from - 9.81 m/s^2


def test_an_effort_that_is_largest_between_samples_changes_at_its_top(tmp_path):
    """Of a mass that is swung it is m A (2 pi f)^2, at a quarter of a swing, which no output time meets."""
    case, keys = scenario(tmp_path, "motion"), DRIVES["motion"][2]
    swing, frequency, mass = keys.values()
    found = sensitivities(case, keys, [0.0, 0.17 / frequency, 0.4 / frequency], method="equation")
    largest = mass * swing * (2.0 * np.pi * frequency) ** 2
    data = found.run.data
    assert data["peak_effort"].values[0] == pytest.approx(largest, rel=1e-9)
    # A flat top is known in time to the root of what it is known to in size.
    assert data["time_of_peak_effort"].values[0] == pytest.approx(0.25 / frequency, rel=1e-4)
    assert np.abs(data["drive_torque"].values).max() < 0.99 * largest
    assert found.relative("peak_effort")[0] == pytest.approx(largest * np.array([1.0, 2.0, 1.0]), rel=1e-4)
