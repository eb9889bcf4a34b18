"""A fit's problem in the coordinates of its search, and what is found there in SI units.

There a parameter is over its size, or the logarithm of it, and the starts of a record's pieces are unknown
beside the parameters: an interval of a parameter is as wide as not knowing them makes it, and one of a
logarithm lies about its value as logarithms do.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.fit.bands import CurveBands
from antenna_pin.fit.profiled import Profile
from antenna_pin.fit.sureness import Sure
from antenna_pin.fit.unknowns import Unknowns

__all__ = [
    "DOUBT",
    "Fitted",
    "Natural",
    "Searched",
    "band_columns",
    "names_of",
    "natural",
    "profile_columns",
]

Array = NDArray[np.float64]
Columns = dict[str, tuple[tuple[str, ...], Any, dict[str, str]]]

#: Relative error that columns of a Jacobian are taken to have [-]: differences of runs at 1e-4 of a size lose
#: four digits of what runs are good to. Those of the equation are nearer; by how much is not known of each.
DOUBT = 1e-5

_SIDES = ("below", "above")


def names_of(unknowns: Unknowns) -> tuple[str, ...]:
    """Return the names of all that is unknown, (p + h,): parameters, then states."""
    return (*unknowns.names, *(f"state {k + 1}" for k in range(unknowns.states)))


class Fitted(Protocol):
    """What the search of a fit is over."""

    @property
    def unknowns(self) -> Unknowns:
        """Parameters and the pieces' starts."""

    def residuals(self, values: Array) -> Array:
        """Return weighted residuals at values with states, (m,)."""

    def slopes(self, searched: Array) -> Array:
        """Return their derivatives by what is searched for, (m, p + h)."""


class Searched:
    """Residuals over what is searched for; :class:`antenna_pin.fit.sureness.Residuals` of it.

    Args:
        problem: The fit's problem.
        whole: Values with states that the search starts from, (p + h,) [SI].
    """

    def __init__(self, problem: Fitted, whole: Array) -> None:
        """Take bounds and start."""
        self._problem, self._unknowns = problem, problem.unknowns
        self.names = names_of(self._unknowns)
        self.start = self._unknowns.searched(whole)
        self.lower, self.upper = self._unknowns.bounds()
        self.scale = np.ones(len(self.start))

    def residuals(self, values: Array) -> Array:
        """Return model less record, and what pieces are apart, (m,) [-]."""
        return self._problem.residuals(self._unknowns.natural(values))

    def jacobian(self, values: Array) -> Array:
        """Return their derivatives, (m, p + h)."""
        return self._problem.slopes(values)


def _natural(unknowns: Unknowns, values: Array, place: int) -> Array:
    """Return numbers of one parameter in SI units, bounds or no bounds."""
    with np.errstate(over="ignore"):
        found = np.exp(values) if unknowns.logarithmic[place] else values * unknowns.sizes()[place]
    return np.asarray(found)


class Natural(NamedTuple):
    """How sure the parameters of a fit are, in SI units.

    Attributes:
        covariance: (p, p), to first order.
        low: Lower ends of their intervals, (p,).
        high: Upper ends.
    """

    covariance: Array
    low: Array
    high: Array


def natural(found: Sure, unknowns: Unknowns) -> Natural:
    """Return how sure the parameters of a fit are, in SI units.

    Args:
        found: In the coordinates of the search.
        unknowns: What these are.
    """
    p = unknowns.count
    whole = np.array([_natural(unknowns, found.values[k], k) for k in range(p)])
    values = np.concatenate([whole, found.values[p:]])
    rates = unknowns.rates(values)[:p]
    low, high = (
        np.array([float(_natural(unknowns, ends[k], k)) for k in range(p)])
        for ends in (found.low, found.high)
    )
    return Natural(found.covariance[:p, :p] / np.outer(rates, rates), low, high)


def profile_columns(found: Sequence[Profile], unknowns: Unknowns) -> Columns:
    """Return profiles as columns of a fit's dataset, in SI units; NaN of parameters that have none.

    Args:
        found: In the coordinates of the search.
        unknowns: What these are.
    """
    p, most = unknowns.count, max((len(one.values) for one in found), default=0)
    values, roots = np.full((2, p, most), np.nan)
    ends, words = np.full((p, 2), np.nan), np.full((p, 2), "", dtype=object)
    for one in found:
        k = unknowns.names.index(one.name)
        values[k, : len(one.values)] = _natural(unknowns, one.values, k)
        roots[k, : len(one.root)] = one.root
        ends[k] = _natural(unknowns, np.array([one.low, one.high]), k)
        words[k] = one.ends
    steps, sides = ("parameter", "step"), ("parameter", "side")
    return {
        "profile_value": (steps, values, {"long_name": "value at which the parameter was held"}),
        "profile_root": (steps, roots, {"units": "1", "long_name": "signed root of the growth of the loss"}),
        "profile_end": (sides, ends, {"long_name": "end of the profile's interval"}),
        "profile_reach": (
            (),
            found[0].threshold if found else np.nan,
            {"units": "1", "long_name": "root at an end"},
        ),
        "profile_how": (sides, words, {"long_name": "how it ends: crossed, bounded, open, stopped"}),
    }


def band_columns(found: CurveBands, predicted: xr.Dataset, weights: Array) -> Columns:
    """Return bands of a fit's curves as columns of its dataset, in the units of its rows.

    Args:
        found: Of the weighted residuals, those of pieces' joints behind those of rows.
        predicted: Rows of the fit: ``model``, ``data`` and ``noise``.
        weights: By which a row's residual counts beside others, (rows,) [-].
    """
    count, rows = predicted.sizes["row"], ("row",)
    one = predicted["noise"].values / np.asarray(weights)
    return {
        name: (rows, predicted["data"].values + ends[:count] * one, {"long_name": words})
        for name, ends, words in (
            ("band_low", found.low, "lower end of where the model's curve may be"),
            ("band_high", found.high, "upper end"),
            ("new_low", found.new_low, "lower end of where a new measurement may be"),
            ("new_high", found.new_high, "upper end"),
        )
    }
