"""A deployment against a stop, seen by a filtered accelerometer with an offset and a clock of its own."""

from pathlib import Path

import deployed_panel
import numpy as np
import played_panel
import pytest
from deployed_panel import CLOCK, NOISE, TRUTH

from antenna_pin.studies.fit import Problem, load_fit, run_fit

EXAMPLES = Path(__file__).resolve().parents[2] / "scripts" / "examples"


@pytest.fixture(scope="module")
def plan():
    return load_fit(EXAMPLES / "deployment.fit.toml")


def test_the_shipped_record_is_that_of_the_other_code():
    # Their last digit is 1e-3 m/s^2; a round-off may turn it in one row of many.
    shipped = (EXAMPLES / "deployment.csv").read_text().splitlines()
    made = deployed_panel.text().splitlines()
    assert shipped[:5] == made[:5] and len(shipped) == len(made)
    numbers = [
        np.array([[float(cell.replace(",", ".")) for cell in line.split(";")] for line in lines[5:]])
        for lines in (shipped, made)
    ]
    np.testing.assert_allclose(*numbers, rtol=0.0, atol=1.5e-3)


def test_at_the_true_numbers_the_model_is_the_other_code(plan):
    problem = Problem(plan)
    assert problem.names == tuple(TRUTH)
    seen = problem.predictions([*TRUTH.values()])
    inside = (CLOCK >= 0.02) & (CLOCK <= 1.4)
    np.testing.assert_allclose(seen["at"], CLOCK[inside] + TRUTH["clock"], rtol=0.0, atol=1e-12)
    off = seen["model"].values - deployed_panel.clean()[inside]
    # At its 64 instants a period the filter makes of a sine at its corner what it is to 8e-4, and the stop's
    # blows jump by 40 m/s^2: a tenth of the noise at most, and in the mean much less.
    assert np.abs(off).max() < 0.1 * NOISE
    assert np.sqrt(np.mean(off**2)) < 0.01 * NOISE


@pytest.mark.slow
def test_the_bands_hold_the_true_numbers(plan):
    found = run_fit(plan)
    assert found.converged
    truth = np.array([*TRUTH.values()])
    # Six bands of 95 % of one record, whose noise is fixed: all hold them.
    assert np.all((found.bands.low <= truth) & (truth <= found.bands.high))
    # Chi squared: 684 give or take the root of twice that, three times.
    assert abs(found.bands.chi2 - found.bands.freedoms) < 3.0 * np.sqrt(2.0 * found.bands.freedoms)


def test_a_panel_on_a_hinge_with_play_is_that_of_the_other_code():
    problem = Problem(load_fit(EXAMPLES / "bounces.fit.toml"))
    clean = played_panel.record(*played_panel.TRUTH.values(), played_panel.TIMES[:300])
    seen = problem.predictions([*played_panel.TRUTH.values()])
    # Both are integrated to 1e-8 and better, over blows on the stop with the play's between them.
    assert np.abs(seen["model"].values[:300] - clean).max() < 1e-7 and np.ptp(np.sign(np.diff(clean))) == 2.0
    noise = (seen["data"].values - seen["model"].values) / played_panel.NOISE
    # 500 numbers of a normal distribution, written to a hundredth of their spread: three sigmas.
    assert abs(noise @ noise - 500) < 3.0 * np.sqrt(2.0 * 500)


@pytest.mark.slow
def test_numbers_that_go_along_the_record_in_pieces_come_to_the_true_ones():
    """From half the spring's stiffness, with which a run comes to the stop 0.3 s too late."""
    half = ["parameters.spring.start=1 N*m/rad", "records.panel.pieces.length=500 ms"]
    problem = Problem(load_fit(EXAMPLES / "bounces.fit.toml", half))
    truth = np.array([*played_panel.TRUTH.values()])
    assert np.all(np.abs(problem.start / truth - 1.0) > 0.19)
    # To what ten pieces tell that are joined to a hundredth of an error scale only: some hundredths.
    np.testing.assert_allclose(problem.first, truth, rtol=0.03)
    off = problem.residuals(np.concatenate([problem.first, problem.states]))[:500]
    # Pieces that start as they want to leave no more than the noise, of which they explain a part.
    assert off @ off < 500 + 3.0 * np.sqrt(2.0 * 500)
