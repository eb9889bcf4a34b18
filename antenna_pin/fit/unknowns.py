"""What a fit looks for: parameters with bounds, in SI units and as a search has them, and pieces' starts."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from antenna_pin.fit.plan import FitPlan

__all__ = ["Unknowns", "size_of"]

Array = NDArray[np.float64]

# Size of a coordinate of a piece's start, in error scales: a search's first step.
_REACH = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class Unknowns:
    """The numbers that are looked for: p parameters, and h coordinates of pieces' starts behind them.

    A search has each over its size, of some the logarithm.

    Attributes:
        names: Of the parameters.
        titles: What they are called in figures.
        units: Theirs, SI; "" of a pure number or one whose unit nobody gave.
        start: Where the search begins, (p,) [SI].
        lower: Bounds, (p,) [SI]; infinite if there is none.
        upper: Likewise.
        scale: Size of each, (p,) [SI]: of its start, or of the way between its bounds.
        prior_mean: Means of priors, (p,) [SI].
        prior_sd: Their standard deviations, (p,) [SI]; infinite if there is none.
        logarithmic: Of which the logarithm is searched for, (p,).
        states: How many coordinates there are, h.
    """

    names: tuple[str, ...]
    titles: tuple[str, ...]
    units: tuple[str, ...]
    start: Array
    lower: Array
    upper: Array
    scale: Array
    prior_mean: Array
    prior_sd: Array
    logarithmic: NDArray[np.bool_]
    states: int

    @classmethod
    def of(cls, plan: FitPlan, states: int) -> Unknowns:
        """Return those of a fit's file with so many coordinates of pieces' starts."""
        specs = plan.parameters
        numbers = [one.numbers() for one in specs.values()]
        start, lower, upper = (np.array([n[k] for n in numbers], dtype=float) for k in range(3))
        return cls(
            names=tuple(specs),
            titles=tuple(one.title or name for name, one in specs.items()),
            units=tuple(n[3] for n in numbers),
            start=start,
            lower=lower,
            upper=upper,
            scale=np.array([size_of(*n[:3]) for n in numbers]),
            prior_mean=np.array([one.prior_numbers()[0] for one in specs.values()]),
            prior_sd=np.array([one.prior_numbers()[1] for one in specs.values()]),
            logarithmic=np.array([one.scale == "log" for one in specs.values()]),
            states=states,
        )

    @property
    def count(self) -> int:
        """How many parameters there are."""
        return len(self.names)

    def sizes(self) -> Array:
        """Return the size of each, (p + h,): of a logarithm 1."""
        return np.concatenate([np.where(self.logarithmic, 1.0, self.scale), np.full(self.states, _REACH)])

    def searched(self, whole: Array) -> Array:
        """Return what a search has for values with states, (p + h,)."""
        found, p = np.array(whole, dtype=float), self.count
        logarithms = np.log(np.where(self.logarithmic, found[:p], 1.0))
        found[:p] = np.where(self.logarithmic, logarithms, found[:p])
        return found / self.sizes()

    def natural(self, searched: Array) -> Array:
        """Return values with states from what a search has, (p + h,)."""
        found, p = np.asarray(searched, dtype=float) * self.sizes(), self.count
        values = np.where(self.logarithmic, np.exp(np.where(self.logarithmic, found[:p], 0.0)), found[:p])
        # What exp and log round must not lead out of the bounds, beyond which a scenario may be none.
        found[:p] = np.clip(values, self.lower, self.upper)
        return found

    def rates(self, whole: Array) -> Array:
        """Return the derivative of what a search has by each value, (p + h,)."""
        rates, p = 1.0 / self.sizes(), self.count
        rates[:p] = np.where(self.logarithmic, 1.0 / np.where(self.logarithmic, whole[:p], 1.0), rates[:p])
        return rates

    def prior_residuals(self, whole: Array) -> Array:
        """Return values less the means of their priors, over the standard deviations, (priors,)."""
        known = np.isfinite(self.prior_sd)
        return np.asarray(((whole[: self.count] - self.prior_mean) / self.prior_sd)[known])

    def prior_slopes(self, whole: Array) -> Array:
        """Return the derivatives of the same by what a search has, (priors, p + h)."""
        known = np.isfinite(self.prior_sd)
        slopes = np.zeros((self.count, len(whole)))
        slopes[:, : self.count] = np.diag(1.0 / self.prior_sd / self.rates(whole)[: self.count])
        return slopes[known]

    def bounds(self) -> tuple[Array, Array]:
        """Return the bounds of what a search has, (p + h,) each."""
        free = np.full(self.states, math.inf)
        lower = np.where(self.logarithmic & ~np.isfinite(self.lower), 0.0, self.lower)
        with np.errstate(divide="ignore"):
            return self.searched(np.concatenate([lower, -free])), self.searched(
                np.concatenate([self.upper, free])
            )


def size_of(start: float, low: float, high: float) -> float:
    """Return what a change of a parameter is small beside: its start, or the way between its bounds [SI]."""
    if start != 0.0:
        return abs(start)
    return high - low if math.isfinite(high - low) else 1.0
