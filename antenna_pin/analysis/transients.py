"""End of a transient: statistics of section points without drift.

The rest of the points behind a candidate start is cut into eight blocks of equal length. Of each block and
coordinate four statistics are taken: the mean and the root mean square about the mean of all, both under Hann
weights, so that it matters little how many oscillations fit into a block; the least and the largest value,
which of a strange attractor scatter much less. A statistic drifts where the eight values rise or fall all
the way, except for two neighbours at most (Kendall's S of 26 or more, of 28: by chance once in 2500). Means
and root mean squares also do where they follow a straight line, or where the first block is further from the
others than they are from each other (Student's t, risk 1 % each). A drift smaller than a tolerance does not
count.

That is the method of batch means, with the comparison of early and late parts of Geweke (1992), Bayesian
Statistics 4, 169-193. It cannot see a change that is still to come: one so slow that the run is short beside
it looks settled. A beat that is slow beside a block looks like a drift.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import ArrayLike

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.errors import InvalidParameterError

_BLOCKS = 8

#: Points behind a start that a judgement takes at the least.
LEAST = 4 * _BLOCKS

#: The rule in words, for a result.
RULE = (
    "settled if of eight blocks of the points mean, root mean square about the mean of all, least and "
    "largest value neither rise nor fall all the way (Kendall's S of 26, of 28), mean and root mean square "
    "follow no straight line and are in the first block what they are in the others (Student's t, 1 %), or "
    "the drift is below the tolerance times the size of the quantities"
)

_STARTS = 32  # candidate starts along the whole, of which the first half is tried
_RISK = 0.01  # of calling a stationary series drifting, over all statistics of one test
_MONOTONE = 26  # Kendall's S of eight values, 28 at most


@dataclass(frozen=True, slots=True)
class Settled:
    """Settled part of a series of points; the drift is NaN for too few points."""

    start: int | None  # index of the first settled point; None without one in the first half
    drift: float  # largest drift of a statistic behind the start, else the middle, by the scale [-]
    tolerance: float  # drift that does not count, by the scale [-]
    points: int  # number of points

    @property
    def words(self) -> str:
        """Verdict as text."""
        if self.points < LEAST:
            return f"too short to decide ({self.points} points, {LEAST} are needed)"
        if self.start is None:
            return (
                f"not settled: its statistics drift by {self.drift:.2g} of their scale over the second half"
            )
        return f"settled from point {self.start} of {self.points} on"


@takes()
def settled(
    points: ArrayLike, *, scale: ArrayLike | None = None, tolerance: float = 1e-3, whole: bool = False
) -> Settled:
    """Return the settled part of a series.

    Args:
        points: Section points in order of time, (n,) or (n, d); or even samples of signals, where a block, a
            sixteenth of them, spans several oscillations.
        scale: Size of each coordinate's motion, () or (d,), in its unit; half the range of all the points,
            its transient in, if left out.
        tolerance: Drift that does not count, as a share of the scale [-].
        whole: Whether to judge all the points only, and no part of them behind a later start.

    Raises:
        InvalidParameterError: A value is not finite, or a scale is not positive.
    """
    z = scaled("settled", points, scale, None)
    count = len(z)
    if count < LEAST:
        return Settled(None, float("nan"), tolerance, count)
    step = max(1, count // _STARTS)
    latest = 0 if whole else min(count // 2, count - LEAST)
    drift = 0.0
    for start in range(0, latest + 1, step):
        drift, moved = _drift(z[start:], tolerance)
        if not moved:
            return Settled(start, drift, tolerance, count)
    return Settled(None, drift, tolerance, count)


def scaled(place: str, points: ArrayLike, scale: ArrayLike | None, least: Array | None) -> Array:
    """Return points (n, d) by their scale [-].

    Args:
        place: Name of the caller, for messages.
        points: (n,) or (n, d).
        scale: () or (d,), half the range of the points if left out.
        least: Least scale, (d,), where none is given.
    """
    x = np.asarray(points, dtype=float)
    x = x[:, None] if x.ndim == 1 else x
    if x.ndim != 2 or not np.isfinite(x).all():
        raise InvalidParameterError(place, "points", "finite, (n,) or (n, d)", said=f"an array {x.shape}")
    if scale is not None:
        sizes = np.broadcast_to(np.asarray(scale, dtype=float), (x.shape[1],))
        if not (np.isfinite(sizes).all() and (sizes > 0.0).all()):
            raise InvalidParameterError(place, "scale", "positive, one for each coordinate", scale)
        return np.asarray(x / sizes)
    if len(x) == 0:
        return x
    sizes = 0.5 * np.ptp(x, axis=0) if least is None else least
    # Round-off about a point is no motion.
    floor = 1e-9 * np.abs(x).max(axis=0)
    sizes = np.maximum(sizes, floor)
    return np.asarray(x / np.where(sizes > 0.0, sizes, 1.0))


def _drift(z: Array, tolerance: float) -> tuple[float, bool]:
    """Return the largest drift of a statistic, and whether it is significant."""
    length = len(z) // _BLOCKS
    z = z[len(z) - length * _BLOCKS :]
    weights = np.hanning(length + 2)[1:-1]
    weights /= weights.sum()
    blocks = z.reshape(_BLOCKS, length, -1)
    squares = ((z - z.mean(axis=0)) ** 2).reshape(blocks.shape)
    mean, square = (np.einsum("l,bls->bs", weights, one) for one in (blocks, squares))
    moments = np.concatenate([mean, np.sqrt(square)], axis=1)  # (blocks, statistics)
    found = np.concatenate([moments, blocks.min(axis=1), blocks.max(axis=1)], axis=1)
    later, sooner = np.triu_indices(_BLOCKS, 1)
    order = np.abs(np.sign(found[sooner] - found[later]).sum(axis=0))
    rise = np.abs(found[-1] - found[0])
    rising = (rise > tolerance) & (order >= _MONOTONE)
    farthest = scipy.stats.t.isf(0.5 * _RISK / moments.shape[1], _BLOCKS - 2)
    rest = moments[1:]
    off = np.abs(moments[0] - rest.mean(axis=0))
    scatter = rest.std(axis=0, ddof=1) * np.sqrt(1.0 + 1.0 / (_BLOCKS - 1))
    apart = (off > tolerance) & (off > scatter * farthest)
    place = np.arange(_BLOCKS) - 0.5 * (_BLOCKS - 1)
    slope = place @ moments / (place @ place)
    left = moments - moments.mean(axis=0) - place[:, None] * slope
    error = np.sqrt((left**2).sum(axis=0) / (_BLOCKS - 2) / (place @ place))
    way = np.abs(slope) * (_BLOCKS - 1)
    inclined = (way > tolerance) & (np.abs(slope) > error * farthest)
    return float(max(rise.max(), off.max())), bool(rising.any() or (apart | inclined).any())
