r"""How a motion recurs, from its section points: with a period, quasi-periodically, chaotically.

**Period n.** The points return: the root mean square of :math:`|z_{k+n} - z_k|`, each coordinate by its
scale, is within a tolerance, and over half the series, a multiple of n, too: a slow drift is no return. The
least such n counts.

**Not periodic.** Two tests of independent kinds have to agree: the 0-1 test of Gottwald and Melbourne
(:mod:`antenna_pin.analysis.chaos_test`), and whether the spectrum is one of lines or is continuous. For the
latter the points are averaged with :math:`e^{-2 \pi i f k}` under the weight :math:`\exp(-1/(s(1-s)))`, s
from 0 to 1 along the series. Such averages vanish faster than any power of 1/n at every f that is no line of
a quasi-periodic motion, and as :math:`n^{-1/2}` in chaos (weighted Birkhoff averages: Das, Saiki, Sander and
Yorke 2017, Nonlinearity 30, 4111; Sander and Meiss 2020, Physica D 411, 132569). The **floor** is the median
of their sizes over frequencies, 1 for white noise: below 0.1 the motion is quasi-periodic, above 0.2 chaotic.
Where the points go round m bands in turn, the means of the bands are taken off first.

Where the tests are at odds, the points too few for them, or not settled
(:mod:`antenna_pin.analysis.transients`), the answer is "too short to say". Noise cannot be told from chaos by
either.

**Confidence** is the share of seven windows of half the length, evenly spaced along the series, in which the
same rules come to the same kind and period. A verdict that less than half of them share is not given.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import ArrayLike

from antenna_pin.analysis._run import Array
from antenna_pin.analysis.chaos_test import Chaos, ChaosTest, chaos_test
from antenna_pin.analysis.transients import scaled, settled
from antenna_pin.base.arguments import takes

__all__ = ["Recurrence", "RecurrenceKind", "recurrence", "section_lines"]

_WINDOWS = 7
_LEAST = 200  # points for the tests of what is not periodic
_BANDS = 16
_QUASI, _CHAOTIC = 0.1, 0.2  # floor of the spectrum
_NAMED = 8  # lines of a spectrum


class RecurrenceKind(Enum):
    """How section points recur."""

    PERIODIC = "periodic"
    QUASI_PERIODIC = "quasi-periodic"
    CHAOTIC = "chaotic"
    TOO_SHORT = "too short to say"


@dataclass(frozen=True, slots=True, eq=False)
class Recurrence:
    """How section points recur.

    Attributes:
        kind: Periodic, quasi-periodic, chaotic or too short to say.
        period: In iterations, if it is periodic; None else.
        confidence: Share of windows of half the length that say the same, in [0, 1] [-]; 0 where the answer
            is "too short to say".
        closeness: Root mean square distance of returns after the period, or of the closest ones that were
            looked for, as a share of the scale [-].
        longest: The longest period that was looked for [iterations].
        bands: Into how many sets the points of a motion that is not periodic fall in turn; 1 if it is one.
        chaos: Outcome of the 0-1 test; None where it was not asked.
        floor: Of the spectrum, see the module's text [-]; NaN where it was not asked for.
        frequency: Strongest lines of the spectrum, (k,), the strongest first [cycles per iteration]; of
            points that go round a closed curve the first is the rotation number, up to sign and whole ones.
        amplitude: Of these lines, (k,), by the scale [-].
        points: How many points there are.
    """

    kind: RecurrenceKind
    period: int | None
    confidence: float
    closeness: float
    longest: int
    bands: int
    chaos: ChaosTest | None
    floor: float
    frequency: Array
    amplitude: Array
    points: int

    @property
    def words(self) -> str:
        """The verdict, as a line says it."""
        if self.kind is RecurrenceKind.PERIODIC:
            return f"period {self.period}"
        if self.kind is RecurrenceKind.TOO_SHORT and self.longest:
            return f"too short to say ({self.points} points); no period up to {self.longest}"
        return f"{self.kind.value}" + (f", {self.bands} bands" if self.bands > 1 else "")


@takes()
def recurrence(
    points: ArrayLike,
    *,
    scale: ArrayLike | None = None,
    tolerance: float = 1e-4,
    longest: int = 32,
) -> Recurrence:
    """Return how section points recur.

    Args:
        points: Of a settled motion (:func:`antenna_pin.analysis.settled`), in order of time, (n,) or (n, d).
        scale: Size of each coordinate, () or (d,), in its unit, such as the range of the quantity over the
            run; the largest size among the points if left out, which is of no use for a coordinate
            that is zero but for round-off (below 1e-9 of the largest coordinate it is left out).
        tolerance: Distance of points that are the same, as a share of the scale [-]: above the error of the
            run and of its settling, far below what motions differ by.
        longest: Longest period to look for; a quarter of the points at most.

    Raises:
        InvalidParameterError: A value is not finite, or a scale is not positive.
    """
    x = np.asarray(points, dtype=float)
    x = x[:, None] if x.ndim == 1 else x
    least = np.abs(x).max(axis=0, initial=0.0) if x.ndim == 2 else None
    if least is not None:
        least = np.maximum(least, 1e-9 * least.max(initial=0.0))
    z = scaled("recurrence", x, scale, least)
    count = len(z)
    kind, period, closeness, chaos, floor, bands, looked = _judged(z, tolerance, longest)
    confidence = 0.0
    if kind is not RecurrenceKind.TOO_SHORT:
        half = count // 2
        starts = np.linspace(0, count - half, _WINDOWS).astype(int)
        windows = [
            _judged(z[k : k + half], tolerance, longest, window=True, deep=period is None) for k in starts
        ]
        confidence = sum(one[:2] == (kind, period) for one in windows) / _WINDOWS
        if confidence < 0.5:
            kind, period, confidence = RecurrenceKind.TOO_SHORT, None, 0.0
    frequency, amplitude = section_lines(z)
    return Recurrence(
        kind, period, confidence, closeness, looked, bands, chaos, floor, frequency, amplitude, count
    )


_Judged = tuple[RecurrenceKind, int | None, float, ChaosTest | None, float, int, int]


def _judged(z: Array, tolerance: float, longest: int, window: bool = False, deep: bool = True) -> _Judged:
    """Return kind, period, closeness, 0-1 test, floor, bands and the longest period that was looked for."""
    looked = min(longest, len(z) // (2 if window else 4))
    closeness = np.inf
    for period in range(1, looked + 1):
        found = _distance(z, period)
        # A drift that is small over one period adds up over many.
        far = _distance(z, period * max(1, len(z) // (2 * period)))
        if max(found, far) <= tolerance:
            return RecurrenceKind.PERIODIC, period, found, None, np.nan, 1, looked
        closeness = min(closeness, found)
    if len(z) < (_LEAST // 2 if window else _LEAST) or not deep:
        return RecurrenceKind.TOO_SHORT, None, float(closeness), None, np.nan, 1, looked
    bands, rest = _without_bands(z)
    floor = _spectral_floor(rest)
    principal = rest @ np.linalg.svd(rest[: 10 * _LEAST], full_matrices=False)[2][0]
    chaos = chaos_test(principal, angles=25 if window else 100, noise=tolerance)
    verdict = chaos.verdict
    if window:  # it says which side it is on: the whole series is what has to be clear
        verdict = Chaos.REGULAR if chaos.K < 0.5 else Chaos.CHAOTIC
    kind = RecurrenceKind.TOO_SHORT
    if not window and not _stationary(z):
        pass
    elif verdict is Chaos.REGULAR and floor < _QUASI:
        kind = RecurrenceKind.QUASI_PERIODIC
    elif verdict is Chaos.CHAOTIC and floor > _CHAOTIC:
        kind = RecurrenceKind.CHAOTIC
    return kind, None, float(closeness), chaos, floor, bands, looked


def _distance(z: Array, after: int) -> float:
    """Return the root mean square distance of points that are so many iterations apart [-]."""
    if after >= len(z):
        return float("inf")
    return float(np.sqrt(((z[after:] - z[:-after]) ** 2).sum(axis=1).mean()))


def _stationary(z: Array) -> bool:
    """Return whether scaled points have settled from the start on, or nearly: the judge errs now and then."""
    start = settled(z).start
    return start is not None and start <= len(z) // 4


def _without_bands(z: Array) -> tuple[int, Array]:
    """Return how many bands the points visit in turn, and the points without the means of their bands."""
    whole = z - z.mean(axis=0)
    total = float((whole**2).mean())
    found = {1: (1.0, whole)}
    for bands in range(2, min(_BANDS, len(z) // 20) + 1):
        rest = whole.copy()
        for k in range(bands):
            rest[k::bands] -= rest[k::bands].mean(axis=0)
        # As many means were fitted as there are bands.
        found[bands] = (float((rest**2).mean()) / total * len(z) / (len(z) - bands), rest)
    best = min(share for share, _ in found.values())
    bands = next(n for n, (share, _) in found.items() if share <= 1.5 * best or share <= 1e-8)
    return (bands, found[bands][1]) if best < 0.3 else (1, whole)


def _spectral_floor(z: Array) -> float:
    """Return the median size of weighted averages at all frequencies, over that of white noise [-]."""
    place = (np.arange(len(z)) + 0.5) / len(z)
    weights = np.exp(-1.0 / (place * (1.0 - place)))
    averages = np.fft.rfft((z - z.mean(axis=0)) * weights[:, None], axis=0)
    power = (np.abs(averages) ** 2).sum(axis=1)
    white = float(z.var(axis=0).sum() * (weights @ weights))
    # The median of an exponential distribution, that of a line of white noise, is ln 2 of its mean.
    return float(np.sqrt(np.median(power) / (np.log(2.0) * white))) if white > 0.0 else 0.0


@takes()
def section_lines(points: ArrayLike) -> tuple[Array, Array]:
    """Return the strongest lines in the spectrum of section points.

    Under a Hann window; between the bins by the peak of the parabola through the logarithms, which errs by
    some hundredths of a bin, that is of 1/n, and by up to 4 % in amplitude.

    Args:
        points: (n,) or (n, d).

    Returns:
        Frequencies [cycles per iteration], in [0, 1/2], and amplitudes in the unit of the points (root of the
        sum of squares over coordinates), the strongest first, at most eight; weaker ones than a
        hundredth of the strongest are left out.
    """
    x = np.asarray(points, dtype=float)
    x = x[:, None] if x.ndim == 1 else x
    if len(x) < 8:
        return np.empty(0), np.empty(0)
    weights = np.hanning(len(x) + 1)[:-1]
    transform = np.abs(np.fft.rfft((x - x.mean(axis=0)) * weights[:, None], axis=0)) * 2.0 / weights.sum()
    size = np.sqrt((transform**2).sum(axis=1))
    # Beyond half a cycle per iteration the spectrum is its mirror image.
    wide = np.concatenate([[0.0], size, [size[-2] if len(x) % 2 == 0 else size[-1]]])
    peaks = np.flatnonzero((size > wide[:-2]) & (size >= wide[2:]) & (size > 1e-2 * size.max()))
    peaks = peaks[peaks > 0]
    peaks = peaks[np.argsort(-size[peaks])][:_NAMED]
    low, top, high = (np.log(np.maximum(wide[peaks + k], 1e-300)) for k in range(3))
    shift = 0.5 * (low - high) / (low - 2.0 * top + high)
    frequency, amplitude = (peaks + shift) / len(x), np.exp(top - 0.25 * (low - high) * shift)
    # At half a cycle there is one line instead of a pair.
    return frequency, np.where(frequency > 0.5 - 0.1 / len(x), 0.5 * amplitude, amplitude)
