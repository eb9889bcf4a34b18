"""A public record of a real pendulum: as it was published, and its hinge's friction in two ways."""

from pathlib import Path

import numpy as np
import pytest
from scipy.special import ellipk

from antenna_pin.studies.fit import load_fit, run_fit

SWING = Path(__file__).resolve().parents[2] / "scripts" / "examples" / "free_swing"
RECORD = SWING / "pendulum_free_swing_data_01.txt"
COUNT, ROW = 2.0 * np.pi / 4000.0, 1.024e-3  # of the encoder [rad], of the clock [s]
MASS, LENGTH = 0.01225, 0.124  # of the rod [kg], [m]
FIRST = 500  # row from which on the hand is gone


@pytest.fixture(scope="module")
def counts():
    return np.round(11.0 * np.loadtxt(RECORD, skiprows=2)).astype(int)


def test_the_record_is_as_it_was_published(counts):
    text = RECORD.read_bytes()
    assert text.startswith(b"trigger_start_deg, sample_rate, duration_sec\n90, 1000, 5 \n")
    # Two digits of a count over 11, as the recorder's float has it, and nothing more.
    rows = "".join(f"{one / 11:.2f}\n" for one in counts.tolist())
    assert text.decode().split("\n", 2)[2] == rows.replace("-0.00", "0.00")
    assert len(counts) == 5000 and len(text) == 32632
    assert np.abs(np.diff(counts)).max() == 11  # no row is missing where it is fast


def half_swings(counts):
    """Return amplitude, duration, loss of speed squared over two, path and integral of speed over it."""
    angle = COUNT * counts - np.deg2rad(0.31)  # from where it hangs
    ends = np.flatnonzero(np.diff(np.sign(angle)) != 0)
    ends = ends[ends > FIRST]
    ends = ends[np.diff(ends, prepend=0) > 100]
    at, speed = [], []
    for one in ends:
        near = np.arange(one - 40, one + 41)
        line = np.polynomial.Polynomial.fit(ROW * (near - one), angle[near], 3).convert()
        zero = min((root.real for root in line.roots() if abs(root.imag) < 1e-9), key=abs)
        at.append(ROW * one + zero)
        speed.append(line.deriv()(zero))
    found = []
    for k, (a, b) in enumerate(zip(ends, ends[1:], strict=False)):
        mine = np.convolve(angle[a - 10 : b + 11], np.full(9, 1.0 / 9.0), "same")
        rate = np.gradient(mine, ROW)[10:-10]
        found.append(
            (
                np.abs(angle[a:b]).max(),
                at[k + 1] - at[k],
                0.5 * (speed[k] ** 2 - speed[k + 1] ** 2),
                np.abs(np.diff(angle[a : b + 1])).sum(),
                float(rate @ rate) * ROW,
            )
        )
    return np.array(found).T


@pytest.mark.slow
def test_its_friction_is_what_its_half_swings_lose(counts):
    """A second way, without a run: periods by the elliptic integral, losses by the speeds at the bottom."""
    found = run_fit(load_fit(SWING / "swing.fit.toml"))
    assert found.converged
    centre, coulomb, viscous = found.values[:3]
    inertia = MASS * (centre**2 + LENGTH**2 / 12.0)
    amplitude, lasts, lost, path, along = half_swings(counts)
    pulls = (2.0 * ellipk(np.sin(0.5 * amplitude) ** 2) / lasts) ** 2  # gravity's torque over the inertia
    spread = 2.0 * pulls.std() / np.sqrt(len(pulls))
    assert -MASS * 9.81 * centre / inertia == pytest.approx(pulls.mean(), abs=spread)
    over = np.column_stack([path, along])
    told, left, *_ = np.linalg.lstsq(over, lost, rcond=None)
    error = np.sqrt(np.diag(np.linalg.inv(over.T @ over)) * left[0] / (len(lost) - 2))
    # Two standard errors of fourteen half swings, which are not alike on both sides.
    assert np.all(np.abs(np.array([coulomb, viscous]) / inertia - told) < 2.0 * error)
    # Both at once, by what half swings differ from one another.
    unlike = 2.0 * np.std((lost - over @ told) / lost) / np.sqrt(len(lost))
    assert np.sum(over @ [coulomb / inertia, viscous / inertia]) == pytest.approx(lost.sum(), rel=unlike)
    assert found.bands.low[1] > 0.0 and found.bands.low[2] > 0.0  # it takes both


@pytest.mark.slow
@pytest.mark.parametrize("other", ["coulomb", "viscous"])
def test_one_friction_alone_is_not_enough(other):
    """The sum of squares is eight and eleven times as large; what hangs together is no more than that."""
    small = [f"parameters.{other}.start=1e-9", f"parameters.{other}.between=[0, 1e-9]"]
    both, alone = (run_fit(load_fit(SWING / "swing.fit.toml", asked)) for asked in ([], small))
    assert alone.bands.chi2 > 5.0 * both.bands.chi2
