"""The measured pin joint of Liu et al. (2013): a ramp that is static, fits held against a second way."""

import numpy as np
import pytest
from scipy.optimize import brentq, least_squares
from scipy.stats import t as student

from antenna_pin import load_scenario, models_path, simulate
from antenna_pin.analysis.law_studies import LIU_2013, LIU_2013_STEEL, elastic_laws_of_joint
from antenna_pin.studies.fit import load_fit, run_fit

CASES = {"paper": "liu-2013", "corrected": "liu-2013-corrected", "foundation": "liu-foundation"}
LOADS = np.array([500.0, 1000.0, 2000.0, 3000.0])  # [N]


def law_of(case, play, length=1e-3):
    made = elastic_laws_of_joint(
        bearing_radius=5e-3, journal_radius=5e-3 - play, length=length,
        bearing=LIU_2013_STEEL, journal=LIU_2013_STEEL,
    )  # fmt: skip
    return made[CASES[case]]


def depth_of(law, load):
    return brentq(lambda depth: law.elastic_force(depth) - load, 1e-9, 1.5e-4, xtol=1e-15)


@pytest.mark.parametrize("case", CASES)
def test_the_ramp_shows_each_laws_static_displacement(case):
    run = simulate(load_scenario("liu2013", case=case, overrides=["output.rate=2"]))
    assert run.completed, run.message
    seen = run.data["journal_position"].squeeze("clearance_joint").sel(axis="y")
    at = dict(zip(run.data["time"].values.tolist(), seen.values.tolist(), strict=True))
    for load in LOADS:
        expected = depth_of(law_of(case, 0.067e-3), load)
        # The damper is late: 20 kN s/m times 20 um/s, 0.4 N, over 50 MN/m are 8 nm.
        assert at[load / 1e3] - 0.067e-3 == pytest.approx(expected, abs=1e-8)


def test_the_files_are_the_table():
    for play in (0.067, 0.094, 0.104):
        rows = np.loadtxt(
            models_path() / "liu2013" / f"play_{round(1e3 * play):03d}.csv", delimiter=",", skiprows=3
        )
        table = [(one.load, one.depth) for one in LIU_2013 if one.clearance == pytest.approx(1e-3 * play)]
        np.testing.assert_allclose(rows[:, 1:] * [1.0, 1e-3], table, rtol=1e-15)
        np.testing.assert_allclose(rows[:, 0] * 1e3, rows[:, 1], rtol=1e-15)


def judged():
    """Return play, load and displacement of the two joints by which laws can be judged."""
    return [(one.clearance, one.load, one.depth) for one in LIU_2013 if one.clearance < 0.1e-3]


def test_the_length_is_what_the_laws_own_statics_give():
    """A second way, without a run: the law solved for the depth, and the table's displacements."""
    found = run_fit(load_fit("liu2013/length"))

    def off(searched):
        rows = [
            (depth_of(law_of("corrected", play, np.exp(searched[0])), load), depth)
            for play, load, depth in judged()
        ]
        return [(model - depth) / 1e-6 for model, depth in rows]

    made = least_squares(off, [np.log(1e-3)], xtol=1e-12)
    # 5 nm of 5 to 45 um, all on one side: 2e-4 of the length.
    assert found.values[0] == pytest.approx(float(np.exp(made.x[0])), rel=1e-3)
    error = np.sqrt(2.0 * made.cost / 7.0 / (made.jac.T @ made.jac).item()) * student.ppf(0.975, 7)
    half = 0.5 * float(np.log(found.bands.high[0] / found.bands.low[0]))
    assert half == pytest.approx(error, rel=1e-2)  # finite differences, and what the ramp is late
    assert found.bands.low[0] < 1e-3 < found.bands.high[0]  # the paper's one millimetre


def test_the_power_law_is_hertzs_rather_than_a_line():
    found = run_fit(load_fit("liu2013/power"))
    _, load, depth = np.array(judged()).T

    def off(searched):
        return ((load / np.exp(searched[0])) ** (1.0 / searched[1]) - depth) / 1e-6

    made = least_squares(off, [18.0, 1.0], xtol=1e-12, x_scale=[1.0, 0.1])
    # The two hang together by 0.9995, so that what the ramp is late by moves each by a tenth of its error.
    assert found.values[1] == pytest.approx(made.x[1], abs=5e-3)
    low, high = found.bands.low[1], found.bands.high[1]
    assert 1.0 < low < 1.5 < high  # (6) is a line; spheres and, nearly, cylinders in bores have 3/2
