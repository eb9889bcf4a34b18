"""A base shaken at random by a power spectral density of acceleration."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.parameters import parameter
from antenna_pin.base.readable import GIVEN, number, readable
from antenna_pin.compiled.lanes import LANES
from antenna_pin.elements import term_kernels as kernels
from antenna_pin.elements.curve import check_as_many
from antenna_pin.elements.reference import term
from antenna_pin.elements.shake import Shake
from antenna_pin.errors import InvalidParameterError

_MOST_LINES = 100_000


def density_at(
    frequency: ArrayLike, at: tuple[float, ...], density: tuple[float, ...]
) -> NDArray[np.float64]:
    """Return a power spectral density between break points, straight in double logarithmic axes.

    Args:
        frequency: Where, (n,) [Hz].
        at: Of the break points, rising [Hz].
        density: There.

    Returns:
        (n,), zero outside the band.
    """
    f = np.asarray(frequency, dtype=float)
    inside = (f >= at[0]) & (f <= at[-1])
    kept = np.exp(np.interp(np.log(np.where(inside, f, at[0])), np.log(at), np.log(density)))
    return np.where(inside, kept, 0.0)


def band_power(low: float, high: float, at: tuple[float, ...], density: tuple[float, ...]) -> float:
    """Return the integral of a density over a band: its mean square."""
    total = 0.0
    for (f1, f2), (s1, s2) in zip(pairwise(at), pairwise(density), strict=True):
        a, b = max(low, f1), min(high, f2)
        if not a < b:
            continue
        slope = math.log(s2 / s1) / math.log(f2 / f1)
        # s1 f1 of the integral of u^slope over u = f / f1, by a form that slope = -1 does not hurt.
        power, span = slope + 1.0, math.log(b / a)
        grown = math.expm1(power * span) / power if abs(power) > 1e-12 else span
        total += s1 * f1 * (a / f1) ** power * grown
    return total


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomShake(Shake):
    r"""Random base motion: a sum of sines of a one-sided density.

    .. math:: a(t) = \sum_k \sqrt{2 \sigma_k^2} \cos(2 \pi k t / T + \varphi_k), \qquad
              \sigma_k^2 = \int S(f)\,df

    integrated over the width 1/T about the line k/T, so that the mean square over a period is the
    density's exactly. Displacement and velocity are the exact integrals, without drift. It repeats after
    T: give one as long as the run.

    Attributes:
        frequency: Of the break points, rising [Hz].
        density: One-sided, of acceleration, straight between points in double logarithmic axes; also ``"0.04
            g^2/Hz"`` [m^2/s^3].
        angular_density: Likewise of the angular acceleration [rad^2/s^3].
        period: T, after which it repeats itself; lines are 1/T apart [s].
        seed: Of the random phases [-].
    """

    at_start: ClassVar[tuple[str, ...]] = ("period", "seed", "fade_in")

    frequency: tuple[float, ...] = parameter("Hz", rule="positive", sizes=(0,))
    density: tuple[float, ...] | None = parameter("m**2/s**3", rule="positive", sizes=(0,), default=None)
    angular_density: tuple[float, ...] | None = parameter(
        "rad**2/s**3", rule="positive", sizes=(0,), default=None
    )
    period: float = parameter("s", rule="positive")
    seed: int = parameter("1", rule="zero or more")

    def __post_init__(self) -> None:
        """Check the parts."""
        Shake.__post_init__(self)
        own, other = ("density", "angular_density") if self.slides else ("angular_density", "density")
        way = "along a direction" if self.slides else "about an axis"
        if getattr(self, other) is not None:
            raise InvalidParameterError(self, other, f"left out of what is shaken {way}; give {own}")
        if getattr(self, own) is None:
            raise InvalidParameterError(self, own, f"given of what is shaken {way}", said="none")
        if len(self.frequency) < 2:
            rule = "at least 2 break points"
            raise InvalidParameterError(self, "frequency", rule, said=f"{len(self.frequency)}")
        check_as_many(self, "frequency", own)
        for k, (before, after) in enumerate(pairwise(self.frequency), start=1):
            if not after > before:
                rule = f"above the one before, {before!r}"
                raise InvalidParameterError(self, f"frequency[{k}]", rule, said=repr(after))
        low, high = self._range
        if low < 1:
            rule = (
                f"at least {number(0.5 / self.frequency[0], GIVEN)} s, for a line in the lowest of the band"
            )
            raise InvalidParameterError(self, "period", rule)
        if high - low + 1 > _MOST_LINES:
            rule = f"such that the band has {_MOST_LINES} lines 1/period apart or fewer, not {high - low + 1}"
            raise InvalidParameterError(self, "period", rule)

    @property
    def powers(self) -> tuple[float, ...]:
        """Power spectral density at the break points, of acceleration or angular acceleration."""
        return self.density or self.angular_density or ()

    @property
    def _range(self) -> tuple[int, int]:
        """The first and the last line."""
        low, high = (one * self.period for one in (self.frequency[0], self.frequency[-1]))
        first = math.floor(low + 0.5)
        return first, max(first, math.ceil(high - 0.5))

    @property
    def longest_step(self) -> float:
        """An eighth of the shortest period [s]."""
        return 0.125 / self.frequency[-1]

    @property
    def instants(self) -> tuple[float, ...]:
        """The time at which it has faded in [s]."""
        return self.faded

    @property
    def rms(self) -> float:
        """Root mean square of the acceleration [m/s^2], or of the angular one [rad/s^2]."""
        return math.sqrt(band_power(self.frequency[0], self.frequency[-1], self.frequency, self.powers))

    def lines(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Return frequency [Hz], amplitude of acceleration [m/s^2, rad/s^2] and phase [rad] of lines."""
        first, last = self._range
        k = np.arange(first, last + 1)
        edges = (np.arange(first, last + 2) - 0.5) / self.period
        edges[0], edges[-1] = min(edges[0], self.frequency[0]), max(edges[-1], self.frequency[-1])
        powers = [band_power(a, b, self.frequency, self.powers) for a, b in pairwise(edges.tolist())]
        phases = 2.0 * math.pi * np.random.Generator(np.random.PCG64(int(self.seed))).random(len(k))
        return k / self.period, np.sqrt(2.0 * np.array(powers)), phases

    def carried(self) -> dict[str, Any]:
        """Return what a result carries of it: its density too."""
        return Shake.carried(self) | {"frequency": list(self.frequency), "density": list(self.powers)}

    def terms(self) -> tuple[float, ...]:
        """Return the lines of the displacement for kernels."""
        return _terms(self)

    def check_span(self, place: str, begin: float, end: float) -> None:
        """Refuse a run in which it would repeat itself."""
        if end > self.period * (1.0 + 1e-12):
            rule = f"as long as the run, {number(end, GIVEN)} s, or it repeats itself; lengthen it"
            raise InvalidParameterError(place, "period", rule, self.period)

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        slopes = [
            10.0 * math.log10(s2 / s1) / math.log2(f2 / f1)
            for (f1, f2), (s1, s2) in zip(pairwise(self.frequency), pairwise(self.powers), strict=True)
        ]
        said = ", ".join(f"{number(one + 0.0, 3)}" for one in slopes)
        band = f"{number(self.frequency[0], GIVEN)} to {number(self.frequency[-1], GIVEN)} Hz"
        first, last = self._range
        unit = "m/s^2" if self.slides else "rad/s^2"
        lines = f"{last - first + 1} lines, repeats after {readable(self.period, 's', GIVEN)}"
        return (
            f"{self.way()}: random, {band}, {readable(self.rms, unit)} rms, {said} dB/octave, {lines}, "
            f"seed {int(self.seed)}{self.said_fade()}"
        )


@cache
def _terms(shake: RandomShake) -> tuple[float, ...]:
    """Return the lines as kernels take them: in whole lanes, those that are none zero."""
    frequency, amplitude, phase = shake.lines()
    along = -amplitude / (2.0 * math.pi * frequency) ** 2
    both = np.zeros((2, -(-len(along) // LANES) * LANES))
    both[:, : len(along)] = along * np.cos(phase), along * np.sin(phase)
    lines = both.reshape(2, -1, LANES).transpose(1, 0, 2).ravel()
    own = (*np.eye(LANES).ravel().tolist(), *map(float, range(LANES)), *lines.tolist())
    lowest = round(float(frequency[0]) * shake.period)
    return term(kernels.LINES, own, count=len(lines) // (2 * LANES), powers=lowest, span=shake.period)
