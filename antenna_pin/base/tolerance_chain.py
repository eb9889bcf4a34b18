r"""Chains of dimensions: worst case, root sum square, and distribution of the sum.

A play, or any other closing dimension, is :math:`y = \sum c_i x_i`. Of independent dimensions with zones of
width :math:`T_i` the worst case is :math:`\bar y \pm \tfrac12 \sum |c_i| T_i`, the root sum square
:math:`\bar y \pm \tfrac12 \sqrt{\sum (c_i T_i)^2}`. The distribution of y is the convolution of theirs.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import check_number, takes
from antenna_pin.base.rules import Positive
from antenna_pin.errors import InvalidParameterError

Array = NDArray[np.float64]
Distribution = Literal["normal", "uniform", "triangular"]

# Cells of the whole range of a sum, whose distribution is exact to the square of their width.
_CELLS = 1 << 14


@takes(nominal="m", minus="m", plus="m")
@dataclass(frozen=True, slots=True, kw_only=True)
class Dimension:
    """Dimension of a chain with its tolerance.

    Attributes:
        name: Of the dimension.
        nominal: Nominal dimension [m].
        minus: Lower deviation, with its sign [m].
        plus: Upper deviation, at least the lower one [m].
        coefficient: c, its part in the sum: 1 adds, -1 takes away, 0.5 makes a radius of a diameter [-].
        distribution: Between the limits: ``normal`` about the middle, cut off at the limits, ``uniform`` or
            ``triangular``.
        sigmas: Standard deviations of ``normal`` from the middle to a limit, 3 C_p [-].
    """

    name: str
    nominal: float
    minus: float
    plus: float
    coefficient: float = 1.0
    distribution: Distribution = "normal"
    sigmas: Positive = 3.0

    def __post_init__(self) -> None:
        """Check the zone."""
        if not self.plus >= self.minus:
            raise InvalidParameterError(self, "plus", f"at least minus = {self.minus:g} m", self.plus)
        if self.coefficient == 0.0:
            raise InvalidParameterError(self, "coefficient", "other than zero", self.coefficient)
        if self.distribution not in get_args(Distribution):
            rule = f"one of {', '.join(get_args(Distribution))}"
            raise InvalidParameterError(self, "distribution", rule, self.distribution)

    @property
    def tolerance(self) -> float:
        """Width of the zone [m]."""
        return self.plus - self.minus

    @property
    def mean(self) -> float:
        """Dimension in the middle of its zone [m]."""
        return self.nominal + 0.5 * (self.plus + self.minus)

    @property
    def sigma(self) -> float:
        """Standard deviation [m]."""
        half = 0.5 * self.tolerance
        if self.distribution == "uniform":
            return half / math.sqrt(3.0)
        if self.distribution == "triangular":
            return half / math.sqrt(6.0)
        k = self.sigmas  # of a normal distribution that is cut off at k standard deviations
        inside = math.erf(k / math.sqrt(2.0))
        return (
            half / k * math.sqrt(1.0 - 2.0 * k * math.exp(-0.5 * k * k) / math.sqrt(2.0 * math.pi) / inside)
        )

    def share_below(self, places: Array) -> Array:
        """Return the probability that it lies below places, from -1 to 1 in its zone."""
        u = np.clip(places, -1.0, 1.0)
        if self.distribution == "uniform":
            found = 0.5 * (1.0 + u)
        elif self.distribution == "triangular":
            found = 0.5 + u - 0.5 * u * np.abs(u)
        else:
            from scipy.special import erf

            found = 0.5 * (
                1.0 + erf(self.sigmas * u / math.sqrt(2.0)) / math.erf(self.sigmas / math.sqrt(2.0))
            )
        return np.asarray(found, dtype=float)


@takes()
@dataclass(frozen=True, kw_only=True)
class ToleranceChain:
    """Sum of dimensions, as a play is.

    Attributes:
        name: Of the sum.
        dimensions: What it is the sum of.
    """

    name: str
    dimensions: Sequence[Dimension]

    def __post_init__(self) -> None:
        """Check that there is a dimension."""
        if not self.dimensions:
            raise InvalidParameterError(self, "dimensions", "at least one", said="none")

    @property
    def nominal(self) -> float:
        """Sum of the nominal dimensions [m]."""
        return math.fsum(one.coefficient * one.nominal for one in self.dimensions)

    @property
    def mean(self) -> float:
        """Sum in the middle of all zones, the mean of their distributions [m]."""
        return math.fsum(one.coefficient * one.mean for one in self.dimensions)

    @property
    def tolerance(self) -> float:
        """Width of the worst case [m]."""
        return math.fsum(abs(one.coefficient) * one.tolerance for one in self.dimensions)

    @property
    def worst_case(self) -> tuple[float, float]:
        """Least and largest sum with all dimensions within their limits [m]."""
        return self.mean - 0.5 * self.tolerance, self.mean + 0.5 * self.tolerance

    @property
    def root_sum_square(self) -> tuple[float, float]:
        """Mean less and plus half the root of the sum of squared tolerances [m]."""
        half = 0.5 * math.sqrt(math.fsum((one.coefficient * one.tolerance) ** 2 for one in self.dimensions))
        return self.mean - half, self.mean + half

    @property
    def sigma(self) -> float:
        """Standard deviation of independent dimensions [m]."""
        return math.sqrt(math.fsum((one.coefficient * one.sigma) ** 2 for one in self.dimensions))

    @property
    def tolerance_ratio(self) -> float:
        """Mean over the width of the worst case [-], at least 3 by ECSS-E-ST-33-01C."""
        return self.mean / self.tolerance if self.tolerance else math.copysign(math.inf, self.mean)

    @property
    def shares(self) -> dict[str, float]:
        """Share of each dimension in the variance of the sum [-]."""
        total = self.sigma**2
        return {
            one.name: (one.coefficient * one.sigma) ** 2 / total if total else 0.0 for one in self.dimensions
        }

    @cached_property
    def _cumulative(self) -> tuple[Array, Array]:
        """Places of the sum [m] and the probability that it lies below."""
        low, high = self.worst_case
        width = (high - low) / _CELLS if high > low else 1.0
        size = 2 * _CELLS
        spectrum = np.ones(size // 2 + 1, dtype=complex)
        for one in self.dimensions:
            half = 0.5 * abs(one.coefficient) * one.tolerance
            if half == 0.0:
                continue
            # Probabilities of cells about the middle, as coefficients of a sum that is even about it.
            cells = np.arange(-_CELLS // 2, _CELLS // 2 + 1)
            edges = one.share_below((np.append(cells, cells[-1] + 1) - 0.5) * width / half)
            mass = np.zeros(size)
            np.add.at(mass, cells % size, np.diff(edges))
            spectrum *= np.fft.rfft(mass)
        found = np.fft.irfft(spectrum, size)
        ordered = np.maximum(np.concatenate([found[-_CELLS:], found[:_CELLS]]), 0.0)
        places = np.asarray(self.mean + (np.arange(-_CELLS, _CELLS + 1) - 0.5) * width, dtype=float)
        below = np.concatenate([[0.0], np.cumsum(ordered)])
        return places, np.asarray(below / below[-1], dtype=float)

    @property
    def density(self) -> tuple[Array, Array]:
        """Sums within the worst case, (n,) [m], and their probability density, (n,) [1/m]."""
        places, below = self._cumulative
        middle, found = 0.5 * (places[1:] + places[:-1]), np.diff(below) / np.diff(places)
        low, high = self.worst_case
        inside = (middle >= low) & (middle <= high)
        return middle[inside], found[inside]

    def probability_below(self, limit: float) -> float:
        """Return the probability that the sum lies below a limit [-].

        Args:
            limit: [m].
        """
        low, high = self.worst_case
        if limit <= low:
            return 0.0
        if limit >= high:
            return 1.0
        return float(np.interp(limit, *self._cumulative))

    def quantile(self, probability: float) -> float:
        """Return the sum that is not reached with a probability [m].

        Args:
            probability: Above 0 and below 1 [-].
        """
        check_number(self, "probability", probability, "between 0 and 1")
        places, below = self._cumulative
        return float(np.interp(probability, below, places))
