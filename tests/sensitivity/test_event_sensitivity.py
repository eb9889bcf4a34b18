"""What events come to, by the equation: instants, the energy they bring in, what a latch weighs."""

import numpy as np
import pytest

from antenna_pin.studies.sensitivity import results_of, sensitivities
from tests.sensitivity.test_closed_forms import (
    COIL,
    DAMPING,
    KEYS,
    MASS,
    PULL,
    STIFFNESS,
    mass,
    oscillation,
    stepped_numbers,
)

EVENTS = """
[events.passes]
kind = "angle"
joint = "way"
value = "0.1 m"
action = "mark"
[events.stiffer]
kind = "angle"
joint = "way"
value = "-0.1 m"
action = "set"
set = "springs.coil.stiffness"
to = "80 N/m"
[events.later]
kind = "time"
time = "0.25 s"
action = "mark"
"""
LATCH = """
[latches.catch]
kind = "rigid"
joint = "way"
angle = "0.2 m"
switches_off = ["springs.coil"]
"""


def slopes_at(place, about):
    """By how much later the oscillator first comes to a place with each number, and its rate there changes.

    Of x(t, p) = place the instant goes with -(dx/dp) / v, the rate with dv/dp + a dt/dp: by the complex step.
    """
    numbers = list(KEYS.values())
    rate = oscillation(about, *numbers)[1]
    slowing = PULL * -1.0 - (STIFFNESS * place + DAMPING * rate) / MASS
    found = []
    for _, _, stepped in stepped_numbers(KEYS):
        x, v = oscillation(about, *stepped)
        late = -(x.imag / 1e-30) / rate
        found.append((late, v.imag / 1e-30 + slowing * late))
    return rate, np.array(found).T


def test_events_of_an_oscillator(tmp_path):
    """One that is noted, one that makes the spring stiffer, one of a time: instants by the closed form.

    A spring of 80 for 50 N/m, bent by 0.1 m, brings in 0.005 (80 - k) J, wherever that comes.
    """
    found = sensitivities(mass(tmp_path, COIL + EVENTS), list(KEYS), [0.27], method="equation")
    scales = np.array([one.scale for one in found.parameters])
    data = found.run.data
    assert data["event"].values.tolist() == ["passes", "later", "stiffer"]
    for k, place in ((0, 0.1), (2, -0.1)):
        late = slopes_at(place, float(data["event_time"].values[k]))[1][0]
        # Instants are located to 1e-13 s; derivatives to some of the run's tolerances.
        assert np.abs((found.derivative("event_time")[k] - late) * scales).max() < 1e-11
    assert np.abs(found.derivative("event_time")[1]).max() == 0.0
    brought = found.derivative("event_energy") * scales
    # Differences of some 10 J, of which 0.15 are left, to 1e-12 of them over a step of 1e-4.
    assert brought[2] == pytest.approx([-0.005 * STIFFNESS, 0.0, 0.0, 0.0, 0.0], abs=1e-9)
    assert np.abs(brought[:2]).max() == 0.0
    assert (found.doubt("event_energy") * scales).max() < 1e-6


def test_events_in_one_step_that_change_nothing(tmp_path):
    """Three places that one step passes: instants go by the closed form, what follows by nothing."""
    places = (0.1, 0.1005, 0.101)
    marks = "".join(
        f'[events.at{k}]\nkind = "angle"\njoint = "way"\nvalue = "{place} m"\naction = "mark"\n'
        for k, place in enumerate(places)
    )
    plain, marked = (
        sensitivities(mass(tmp_path, COIL + more), list(KEYS), [0.22], method="equation")
        for more in ("", marks)
    )
    scales = np.array([one.scale for one in marked.parameters])
    for k, place in enumerate(places):
        late = slopes_at(place, float(marked.run.data["event_time"].values[k]))[1][0]
        assert np.abs((marked.derivative("event_time")[k] - late) * scales).max() < 1e-11  # as above
    # Steps end elsewhere: each run is good to some of its tolerances.
    assert np.abs((marked.derivative("v") - plain.derivative("v"))[-1] * scales).max() < 1e-10


def test_what_a_latch_weighs_and_lets_go(tmp_path):
    """Of the mass m v^2 / 2 where it is caught; of the spring that is switched off - k x^2 / 2 there."""
    found = sensitivities(mass(tmp_path, COIL + LATCH), list(KEYS), [0.25], method="equation")
    scales = np.array([one.scale for one in found.parameters])
    rate, (late, speeds) = slopes_at(0.2, float(found.run.data["event_time"].values[0]))
    weighed = MASS * rate * speeds + np.array([0.0, 0.0, 0.5 * rate**2, 0.0, 0.0])
    assert np.abs((found.derivative("change_time")[0] - late) * scales).max() < 1e-11
    # Numbers of 10 J.
    assert np.abs((found.derivative("change_energy")[0] - weighed) * scales).max() < 1e-9
    assert np.abs((found.derivative("change_loss")[0] - weighed) * scales).max() < 1e-9
    let_go = found.derivative("event_energy")[0] * scales
    assert let_go == pytest.approx([-0.5 * STIFFNESS * 0.2**2, 0.0, 0.0, 0.0, 0.0], abs=1e-9)


def test_events_of_one_name_are_told_together(tmp_path):
    """The last of two instants at which the mass passes a place; all that the event of a name brings in."""
    long = mass(tmp_path, COIL + EVENTS)
    found = sensitivities(long, ["springs.coil.stiffness"], [1.4], method="quick-runs")
    rows = {row.result: row for row in results_of(found)}
    data = found.run.data
    at = [k for k, name in enumerate(data["event"].values) if name == "passes"]
    assert len(at) > 1 and rows["last event_time passes"].value == data["event_time"].values[at[-1]]
    assert rows["last event_time passes"].slopes == found.relative("event_time")[at[-1]]
    assert rows["sum event_energy stiffer"].value == pytest.approx(0.15, abs=1e-9)
    assert not any(name.startswith("change_") for name in rows)
