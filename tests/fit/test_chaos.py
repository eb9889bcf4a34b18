"""A record over which the motion is chaotic: one run does not hold it, which is said; its pieces do."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from antenna_pin.studies.fit import load_fit, run_fit
from antenna_pin.studies.fit.diagnostics import difference_growth

from .conftest import INERTIA

DAMPING, ACCELERATION, FREQUENCY, FIRST = 0.05, 16.0, 0.9, 0.5  # N m s/rad, m/s^2, Hz, rad
MOMENT, G, SPAN, NOISE = 1.872 * 0.2, 9.80665, 7.5, 2e-3  # kg m, m/s^2, s, rad

FIT = """
scenario = "pendulum"
case = "ideal"
[set]
duration = "7.5 s"
mechanism.links.stand = {{ mass = "1 kg", inertia = [1.0, 1.0, 1.0] }}
springs.hinge = {{ replace = true, damping = 0.05 }}
initial.joints.hinge.angle = "0.5 rad"
integrator.engine = "compiled"
integrator.rtol = 1e-10
[set.shake.x]
kind = "sine"
direction = [1, 0, 0]
frequency = "0.9 Hz"
acceleration = "16 m/s^2"
[parameters.damping]
key = "springs.hinge.damping"
start = "0.06 N*m*s/rad"
[parameters.acceleration]
key = "shake.x.acceleration"
start = "15 m/s^2"
[records.swing]
file = "swing.csv"
{pieces}
[records.swing.columns.angle]
of = "motion_angle[hinge]"
sd = "2 mrad"
"""


def swing(time, first=FIRST):
    """Return the angle of a bar whose hinge is shaken, by equation and integrator of its own [rad]."""

    def rates(now, y):
        shaken = ACCELERATION * np.sin(2.0 * np.pi * FREQUENCY * now)
        torque = -DAMPING * y[1] - MOMENT * (G * np.sin(y[0]) + shaken * np.cos(y[0]))
        return [y[1], torque / INERTIA]

    found = solve_ivp(
        rates, (0.0, time[-1]), [first, 0.0], t_eval=time, method="DOP853", rtol=1e-12, atol=1e-13
    )
    return found.y[0]


def exponent(until):
    """Return with what power of e neighbours part, until they are a thousandth of a radian apart [1/s]."""
    time = np.linspace(0.0, until, 1000)
    apart = np.abs(swing(time, FIRST + 1e-9) - swing(time))
    last = int(np.argmax(apart > 1e-3))
    return np.log(apart[last] / 1e-9) / time[last]


@pytest.fixture
def fit(tmp_path):
    """Return a function that fits a chaotic record, in one run or in pieces."""
    time = np.linspace(0.0, SPAN, 751)
    noise = NOISE * np.random.default_rng(0).standard_normal(len(time))
    rows = np.column_stack([time, swing(time) + noise])
    np.savetxt(tmp_path / "swing.csv", rows, delimiter=",", header="time,angle", comments="", fmt="%.12g")

    def made(pieces="", *settings):
        (tmp_path / "chaos.fit.toml").write_text(FIT.format(pieces=pieces))
        return run_fit(load_fit(tmp_path / "chaos.fit.toml", settings))

    return made


@pytest.mark.slow
def test_ten_growths_are_found_in_pieces_and_not_in_one_run(fit):
    assert exponent(20.0) * SPAN > 10.0
    truth = np.array([DAMPING, ACCELERATION])
    single = fit()
    # Of noise alone it is 751 to 4 sigmas of 39; a run on another branch is off by radians.
    assert single.bands.chi2 > 1e3 * 751
    said = single.notes[0]
    assert said.startswith("note: records.swing: one run does not hold it: from ")
    length = said.rpartition('length = "')[2].partition('"')[0]
    pieces = fit(f'pieces = {{ length = "{length}" }}')
    assert pieces.bands.chi2 / pieces.bands.freedoms == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / 751))
    # 4 sigma of what is stated, and that is little: a thousandth of each.
    assert np.all(np.abs(pieces.values - truth) < 4.0 * pieces.bands.sd)
    assert np.all(pieces.bands.sd < 1e-2 * truth)
    assert not pieces.notes


def test_differences_that_grow_by_e_in_a_second_are_found():
    """Neighbours part by exp(t) up to the size of the motion, and are any two motions from there."""
    time = np.linspace(0.0, 20.0, 2001)
    ways = [1e-4 * sign * np.exp(time) for sign in (-1.0, 0.0, 1.0)]
    runs = [np.sin(3.0 * time + 7.0 * np.sin(way)) for way in ways]
    found = difference_growth(time, *(one[np.newaxis] for one in runs))
    # Not straight once 7e-4 exp(t) is about 1, at 7.3 s, to a part of the 24 that are looked at.
    assert found.since == pytest.approx(np.log(1.0 / 7e-4), abs=1.0)
    assert found.fold == pytest.approx(1.0, rel=0.2)  # over parts that the swing goes through zero in
    straight = [np.sin(3.0 * time) * (1.0 + sign * 1e-4) for sign in (-1.0, 0.0, 1.0)]
    assert difference_growth(time, *(one[np.newaxis] for one in straight)) is None
