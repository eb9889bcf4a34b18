"""Bands of a fit's parameters: what is said of one that a bound holds, and of the others."""

from types import SimpleNamespace

import numpy as np
import pytest

from antenna_pin.studies.fit.confidence_bands import parameter_bands
from antenna_pin.studies.fit.plan import Unknowns

SD = 0.1
TIMES = np.linspace(0.0, 3.0, 31)
PLAN = SimpleNamespace(name="line", noise="given", loss="linear", loss_scale=1.0)


def unknowns(lower):
    """Three coefficients of a parabola."""
    names, one = ("a", "b", "c"), np.ones(3)
    bounds, prior = (np.array(lower), 9.0 * one), (one, np.inf * one)
    return Unknowns(names, names, ("", "", ""), one, *bounds, one, *prior, one.astype(bool) & False, 0)


@pytest.mark.parametrize("held", [None, 0, 1, 2])
def test_a_parameter_at_its_bound_has_no_band_and_the_others_have_theirs(held):
    """The covariance of the others is that of a fit of them alone: sd^2 (J^T J)^-1."""
    values = np.array([2.0, 0.5, -0.25])
    lower = np.full(3, -9.0)
    free = [k for k in range(3) if k != held]
    if held is not None:
        lower[held] = values[held]
    slopes = np.stack([TIMES**k for k in range(3)], axis=1) / SD
    rng = np.random.default_rng(3)
    found = parameter_bands(
        PLAN, unknowns(lower), values, rng.standard_normal(TIMES.size), slopes, np.zeros(TIMES.size, int)
    )
    exact = np.full((3, 3), np.nan)
    exact[np.ix_(free, free)] = np.linalg.inv(slopes[:, free].T @ slopes[:, free])
    # Round-off by the condition of a parabola's slopes, some 1e3.
    np.testing.assert_allclose(found.covariance, exact, rtol=1e-11)
    np.testing.assert_allclose(found.sd, np.sqrt(np.diag(exact)), rtol=1e-11)
    half = 1.959963984540054 * np.sqrt(np.diag(exact))
    np.testing.assert_allclose(found.low, values - half, rtol=1e-9)
    np.testing.assert_allclose(found.high, values + half, rtol=1e-9)
    assert found.freedoms == TIMES.size - len(free)
