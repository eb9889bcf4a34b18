r"""Kind of a motion from its section points: periodic, quasi-periodic or chaotic.

**Period n.** The points return: the root mean square of :math:`|z_{k+n} - z_k|`, each coordinate by its
scale, is within a tolerance, and over half the series, a multiple of n, too: a slow drift is no return. The
least such n counts.

**Not periodic.** Two tests of independent kinds have to agree: the 0-1 test of Gottwald and Melbourne
(:mod:`antenna_pin.analysis.recurrence`), and whether the spectrum is one of lines or is continuous. For the
latter the points are averaged with :math:`e^{-2 \pi i f k}` under the weight :math:`\exp(-1/(s(1-s)))`, s
from 0 to 1 along the series. Such averages vanish faster than any power of 1/n at every f that is no line of
a quasi-periodic motion, and as :math:`n^{-1/2}` in chaos (weighted Birkhoff averages: Das, Saiki, Sander and
Yorke 2017, Nonlinearity 30, 4111; Sander and Meiss 2020, Physica D 411, 132569). The **floor** is the median
of their sizes over frequencies, 1 for white noise: below 0.1 the motion is quasi-periodic, above 0.2 chaotic.
Where the points go round m bands in turn, the means of the bands are taken off first.

Where the tests are at odds, the points too few for them, or not settled
(:mod:`antenna_pin.analysis.transients`), the result is "too short to decide". Neither test separates noise
from chaos.

**Confidence** is the share of seven windows of half the length, evenly spaced along the series, in which the
same rules come to the same kind and period. A verdict that less than half of them share is not given.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy.fft import irfft, next_fast_len, rfft

from antenna_pin.analysis._run import floats
from antenna_pin.analysis.transients import scaled, settled
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.errors import InvalidParameterError

# --- 0-1 test for chaos -------------------------------------------------------------------------------------
#
# The series :math:`\varphi(j)`, its mean taken off, drives a walk in the plane for an angle c,
#
# .. math:: p_c(n) = \sum_{j \le n} \varphi(j) \cos jc, \qquad q_c(n) = \sum_{j \le n} \varphi(j) \sin jc,
#
# which stays bounded if the motion is regular and spreads as Brownian motion does if it is chaotic. The
# mean square displacement :math:`M_c(n)` grows linearly in the second case, and :math:`K_c` is its
# correlation with n: 0 or 1. Of many angles the median counts, as single ones are in resonance with the
# motion.
#
# References:
#     Gottwald and Melbourne (2004), Proc. R. Soc. Lond. A 460, 603-611.
#     Gottwald and Melbourne (2009), SIAM J. Appl. Dyn. Syst. 8(1), 129-145: the correlation
#     method, the choice of c, N and n.

_FEWEST = 200  # points; below, K of the logistic map at 4 and of a circle map come too near to each other
_REGULAR, _CHAOTIC = 0.25, 0.75
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)


class Chaos(Enum):
    """Verdict of the 0-1 test."""

    REGULAR = "regular"
    CHAOTIC = "chaotic"
    TOO_SHORT = "too short to decide"


class ChaosTest(NamedTuple):
    """Outcome of the 0-1 test."""

    verdict: Chaos
    K: float  # median of K over the angles, in [-1, 1] [-]
    spread: float  # half the distance of the quartiles of K [-]
    half: float  # median K of the first half of the series [-]
    values: Array  # (angles,), K of each angle [-]
    angles: Array  # (angles,), in (pi/5, 4 pi/5) [rad]


@takes()
def chaos_test(values: ArrayLike, *, angles: int = 100, noise: float = 0.0) -> ChaosTest:
    """Return the outcome of the 0-1 test of a series.

    The series is of a map: points of a section, not the close samples of a smooth motion, for which the
    displacement grows at first whatever the motion is. The verdict is regular where the median K is below
    0.25, chaotic above 0.75, and "too short to decide" between, with fewer than 200 points, or where
    half the series lies on the other side. Noise counts as chaos.

    Args:
        values: One number per iteration, (n,), of any unit.
        angles: How many angles c to take; they are a fixed sequence that is even and hits no resonance.
        noise: Size below which deviations from the mean are no motion, in the unit of the values; a series
            that stays within it is regular, K = 0.

    Raises:
        InvalidParameterError: A value is not finite, or the series is not one of numbers.
    """
    x = np.asarray(values, dtype=float)
    if x.ndim != 1 or not np.isfinite(x).all():
        raise InvalidParameterError(
            "chaos_test", "values", "finite numbers, one per iteration", said=f"an array {x.shape}"
        )
    c = np.pi * (0.2 + 0.6 * np.modf(_GOLDEN * np.arange(1, angles + 1))[0])
    if x.size < 20:
        return ChaosTest(Chaos.TOO_SHORT, np.nan, np.nan, np.nan, np.full(angles, np.nan), c)
    size = float(np.abs(x - x.mean()).max())
    if size <= max(noise, 1e-13 * float(np.abs(x).max())):
        verdict = Chaos.REGULAR if x.size >= _FEWEST else Chaos.TOO_SHORT
        return ChaosTest(verdict, 0.0, 0.0, 0.0, np.zeros(angles), c)
    k = _correlations(x, c)
    low, median, high = (float(q) for q in np.quantile(k, [0.25, 0.5, 0.75]))
    half = float(np.median(_correlations(x[: x.size // 2], c)))
    verdict = Chaos.TOO_SHORT
    if x.size >= _FEWEST and median < _REGULAR and half < 0.5:
        verdict = Chaos.REGULAR
    elif x.size >= _FEWEST and median > _CHAOTIC and half > 0.5:
        verdict = Chaos.CHAOTIC
    return ChaosTest(verdict, median, 0.5 * (high - low), half, k, c)


def _correlations(x: Array, angles: Array) -> Array:
    """Return K of each angle: correlation of steps and mean square displacement."""
    spread = x - x.mean()  # so that the oscillating part of the displacement is zero
    spread = spread / (spread.std() or 1.0)
    most = x.size // 10
    kept = x.size - most
    length = next_fast_len(x.size + most, real=True)
    steps = np.arange(1, most + 1)
    turns = np.outer(angles, np.arange(1, x.size + 1))
    displacement = np.zeros((angles.size, most))
    for walk in (np.cumsum(spread * np.cos(turns), axis=1), np.cumsum(spread * np.sin(turns), axis=1)):
        # sum over j of (w[j + n] - w[j])^2 for j < kept, the product by one transform for all n
        squares = np.concatenate([np.zeros((angles.size, 1)), np.cumsum(walk**2, axis=1)], axis=1)
        product = irfft(np.conj(rfft(walk[:, :kept], length)) * rfft(walk, length), length)[:, 1 : most + 1]
        displacement += squares[:, kept + steps] - squares[:, steps] + squares[:, [kept]] - 2.0 * product
    displacement /= kept
    apart = displacement - displacement.mean(axis=1, keepdims=True)
    count = steps - steps.mean()
    size = np.sqrt((apart**2).sum(axis=1) * (count**2).sum())
    return np.where(size > 0.0, apart @ count / np.where(size > 0.0, size, 1.0), 0.0)


# --- recurrence ---------------------------------------------------------------------------------------------

_WINDOWS = 7
_LEAST = 200  # points for the tests of what is not periodic
_BANDS = 16
_QUASI, _CHAOTIC = 0.1, 0.2  # floor of the spectrum
_NAMED = 8  # lines of a spectrum


class RecurrenceKind(Enum):
    """Kind of recurrence of section points."""

    PERIODIC = "periodic"
    QUASI_PERIODIC = "quasi-periodic"
    CHAOTIC = "chaotic"
    TOO_SHORT = "too short to decide"


@dataclass(frozen=True, slots=True, eq=False)
class Recurrence:
    """Recurrence of section points.

    Of points around a closed curve the first frequency is the rotation number, up to sign and whole turns.
    """

    kind: RecurrenceKind
    period: int | None  # [iterations]; None if it is not periodic
    confidence: float  # share of windows of half the length with the same verdict [-]; 0 if too short
    closeness: float  # root mean square distance of the closest returns, as a share of the scale [-]
    longest: int  # longest period of the search [iterations]
    bands: int  # number of sets between which the points of a motion without period alternate
    chaos: ChaosTest | None  # outcome of the 0-1 test; None if it was not needed
    floor: float  # of the spectrum, see the module's text [-]; NaN if it was not needed
    frequency: Array  # strongest lines of the spectrum, (k,), the strongest first [cycles per iteration]
    amplitude: Array  # of these lines, (k,), by the scale [-]
    points: int  # number of points

    @property
    def words(self) -> str:
        """Verdict as text."""
        if self.kind is RecurrenceKind.PERIODIC:
            return f"period {self.period}"
        if self.kind is RecurrenceKind.TOO_SHORT and self.longest:
            return f"too short to decide ({self.points} points); no period up to {self.longest}"
        return f"{self.kind.value}" + (f", {self.bands} bands" if self.bands > 1 else "")


@takes()
def recurrence(
    points: ArrayLike, *, scale: ArrayLike | None = None, tolerance: float = 1e-4, longest: int = 32
) -> Recurrence:
    """Return the recurrence of section points.

    Args:
        points: Of a settled motion (:func:`antenna_pin.analysis.settled`), in order of time, (n,) or (n, d).
        scale: Size of each coordinate, () or (d,), in its unit, such as the range of the quantity over the
            run; the largest size among the points if left out, which is of no use for a coordinate
            that is zero except for round-off (below 1e-9 of the largest coordinate it is left out).
        tolerance: Distance of points that are the same, as a share of the scale [-]: above the error of the
            run and of its settling, far below what motions differ by.
        longest: Longest period in the search; a quarter of the points at most.

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
    """Return kind, period, closeness, 0-1 test, floor, bands and longest period."""
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
    """Return the root mean square distance of points some iterations apart [-]."""
    if after >= len(z):
        return float("inf")
    return float(np.sqrt(((z[after:] - z[:-after]) ** 2).sum(axis=1).mean()))


def _stationary(z: Array) -> bool:
    """Return whether scaled points have settled in their first quarter."""
    start = settled(z).start
    return start is not None and start <= len(z) // 4


def _without_bands(z: Array) -> tuple[int, Array]:
    """Return the number of bands, and the points less the means of their bands."""
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
    """Return the median of weighted averages over that of white noise [-]."""
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


# --- diagrams -----------------------------------------------------------------------------------------------

Verdict = str
"""What a motion is: "period 1", "period 2" and so on, "quasi-periodic", "chaotic", or "too short to "
"decide"."""

#: What is not any of these is "too short to decide": of few points only periods can be told.
_UNDECIDED = RecurrenceKind.TOO_SHORT.value


# What is smaller than this part of the largest quantity of its unit is zero but for round-off.
_ZERO = 1e-6


@takes()
def diagram_verdicts(
    diagram: xr.Dataset,
    quantities: Sequence[str] | None = None,
    *,
    branch: str | None = None,
    vector: bool = False,
    tolerance: float = 1e-3,
) -> list[Verdict | None]:
    """Return the kind of motion at each value of a diagram; None if unsettled.

    Points are the same that differ by less than the tolerance, over the largest amount of the quantity in the
    diagram: less than a dot in a figure of it.

    Args:
        diagram: As :func:`antenna_pin.studies.nonlinear.bifurcation` returns it.
        quantities: Which of its quantities are examined; all if left out.
        branch: Which of its branches; the first if left out.
        vector: Whether the quantities are components of one vector, whose largest amount counts for all.
        tolerance: Above what the accuracy of the runs leaves [-].
    """
    names = list(quantities or json.loads(diagram.attrs["quantities"]))
    whole = [floats(diagram[name]) for name in names]
    sizes = np.array([float(np.nanmax(np.abs(one), initial=0.0)) for one in whole])
    units = np.array([str(diagram[name].attrs.get("units", "1")) for name in names])
    largest = np.array([sizes[units == unit].max() for unit in units])
    scale = largest if vector else np.maximum(sizes, _ZERO * largest)
    scale[scale == 0.0] = 1.0
    place = 0 if branch is None else [str(one) for one in diagram["branch"].values].index(branch)
    found: list[Verdict | None] = []
    for k, is_settled in enumerate(np.asarray(diagram["settled"].values[place], dtype=bool)):
        points = np.stack([one[place, k] for one in whole], axis=-1)
        points = points[np.isfinite(points).all(axis=1)]
        if not is_settled or not len(points):
            found.append(None)
            continue
        recurs = recurrence(points, scale=scale, tolerance=tolerance)
        found.append(recurs.kind.value if recurs.period is None else f"period {recurs.period}")
    return found


@takes()
def said_of_verdicts(
    values: Sequence[float], verdicts: Sequence[Verdict | None], unit: str = ""
) -> list[str]:
    """Return lines as "period 1 at 9 values: 0.01 to 0.09 mm", by frequency."""
    kinds = sorted(set(verdicts), key=lambda one: (one is None, -verdicts.count(one), str(one)))
    said = []
    for kind in kinds:
        words = "not settled" if kind is None else "no period told" if kind == _UNDECIDED else kind
        there = [k for k, one in enumerate(verdicts) if one == kind]
        noun = "value" if len(there) == 1 else "values"
        said.append(f"{words} at {len(there)} {noun}: {_spans(values, there)}" + (f" {unit}" if unit else ""))
    return said


def _spans(values: Sequence[float], there: Sequence[int]) -> str:
    """Return values as spans of neighbours, such as "0.01 to 0.05, 0.2"."""
    spans: list[list[int]] = []
    for k in there:
        if spans and k == spans[-1][-1] + 1:
            spans[-1].append(k)
        else:
            spans.append([k])
    ends = [(values[span[0]], values[span[-1]], len(span)) for span in spans]
    return ", ".join(f"{a:.3g}" if count == 1 else f"{a:.3g} to {b:.3g}" for a, b, count in ends)
