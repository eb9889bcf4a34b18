"""Statistics that scatter from run to run: their surfaces, and how often the bands by their scatter hold."""

from types import SimpleNamespace

import numpy as np
import pytest

from antenna_pin.errors import InvalidParameterError, ScenarioError
from antenna_pin.studies.fit.plan import SurfaceSpec, Unknowns
from antenna_pin.studies.fit.search import ResponseSurface, fit_by_surface

from .conftest import FIT

TRUTH = np.array([1.15, 0.8])
# Of six statistics, by what each scatters, and with what they have in common.
ROOT = np.diag([0.02, 0.03, 0.05, 0.1, 0.04, 0.02]) @ (np.eye(6) + 0.5)


def means(x):
    """Return what six statistics are on average, bent over both numbers."""
    a, b = x
    return np.array([a, a * b, b**2, np.exp(a - b), a**2 - b, np.log(a) + b])


class Scattering:
    """A problem whose every run scatters: what surfaces ask of a fit's."""

    def __init__(self, seed):
        self._rng = np.random.default_rng(seed)
        self.record = self._one(TRUTH)
        one = np.ones(2)
        bounds, prior = (0.2 * one, 3.0 * one), (one, np.inf * one)
        self.unknowns = Unknowns(
            ("a", "b"), ("a", "b"), ("", ""), one, *bounds, one, *prior, one.astype(bool) & False, 0
        )
        self.plan = SimpleNamespace(name="scatter", noise="given", loss="linear", loss_scale=1.0)
        self.rows = SimpleNamespace(noise_of_statistics=lambda: np.zeros(6))
        self.count, self.notes = 6, ()

    def _one(self, x):
        return means(x) + ROOT @ self._rng.standard_normal(6)

    def tried(self, wholes):
        return [self._one(x) - self.record for x in wholes]

    def unbalanced(self, whole):
        return ()

    def failed(self):
        return ()


@pytest.mark.slow
def test_bands_by_the_scatter_of_runs_hold_as_often_as_they_say():
    """The record is one more run: of 100 bands 95 hold, although only runs say what runs scatter by."""
    count, held, errors, chi2 = 400, np.zeros(2, int), [], []
    for seed in range(count):
        fit = fit_by_surface(Scattering(seed), SurfaceSpec(runs=64))
        held += (fit.bands.low <= TRUTH) & (TRUTH <= fit.bands.high)
        errors.append((fit.values - TRUTH) / fit.bands.sd)
        chi2.append(fit.bands.chi2)
        assert fit.converged and fit.bands.freedoms == 4
    # Of 400 draws of 0.95, give or take three times 4.4.
    assert np.all(np.abs(held - 0.95 * count) <= 13), held
    # Mean squares of errors over stated errors: 1, three times the root of 2/400 to either side.
    assert np.mean(np.square(errors), axis=0) == pytest.approx(np.ones(2), abs=0.21)
    # Likewise of the mean of chi squared of 4 degrees, whose variance is 8.
    assert np.mean(chi2) == pytest.approx(4.0, abs=3.0 * np.sqrt(8.0 / count))


def test_a_surface_of_second_order_is_found_exactly():
    rng = np.random.default_rng(2)
    points = rng.uniform(-1.0, 1.0, (12, 2))
    found = np.array([[1.0 + u - 2.0 * v, 3.0 * u * v + v**2] for u, v in points])
    surface = ResponseSurface.through(points, found, np.array([0.0, 0.25]))
    u = np.array([0.3, -0.4])
    assert surface.at(u) == pytest.approx([2.1, -0.2], abs=1e-13)
    assert surface.slopes(u) == pytest.approx(np.array([[1.0, -2.0], [-1.2, 0.1]]), abs=1e-13)
    # What runs do not scatter by, a sensor's noise does.
    assert surface.scatter == pytest.approx(np.diag([0.0, 0.25]), abs=1e-25)


def test_what_a_surface_cannot_take_is_refused(write):
    """Too few runs for so many statistics, curves beside it."""
    with pytest.raises(InvalidParameterError, match=r"surface\.runs must be more than 18, for 6 statistics"):
        fit_by_surface(Scattering(0), SurfaceSpec(runs=16))
    with pytest.raises(ScenarioError, match="compare must be a statistic with a surface"):
        write(text=FIT.replace("{more}", "surface = {{ runs = 64 }}"))
