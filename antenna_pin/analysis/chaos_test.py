r"""The 0-1 test for chaos of Gottwald and Melbourne: from one series of numbers, without an embedding.

The series :math:`\varphi(j)`, its mean taken off, drives a walk in the plane for an angle c,

.. math:: p_c(n) = \sum_{j \le n} \varphi(j) \cos jc, \qquad q_c(n) = \sum_{j \le n} \varphi(j) \sin jc,

which stays bounded if the motion is regular and spreads as Brownian motion does if it is chaotic. The mean
square displacement :math:`M_c(n)` grows linearly in the second case, and :math:`K_c` is its correlation with
n: 0 or 1. Of many angles the median counts, as single ones are in resonance with the motion.

References:
    Gottwald and Melbourne (2004), Proc. R. Soc. Lond. A 460, 603-611.
    Gottwald and Melbourne (2009), SIAM J. Appl. Dyn. Syst. 8(1), 129-145: the correlation
    method, the choice of c, N and n.
"""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.fft import irfft, next_fast_len, rfft

from antenna_pin.analysis._run import Array
from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError

__all__ = ["Chaos", "ChaosTest", "chaos_test"]

_LEAST = 200  # points; below, K of the logistic map at 4 and of a circle map come too near to each other
_REGULAR, _CHAOTIC = 0.25, 0.75
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)


class Chaos(Enum):
    """What the 0-1 test finds."""

    REGULAR = "regular"
    CHAOTIC = "chaotic"
    TOO_SHORT = "too short to say"


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
    """Return what the 0-1 test says of a series.

    The series is of a map: points of a section, not the close samples of a smooth motion, for which the
    displacement grows at first whatever the motion is. The verdict is regular where the median K is below
    0.25, chaotic where it is above 0.75, and "too short to say" between, with fewer than 200 points, or where
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
        verdict = Chaos.REGULAR if x.size >= _LEAST else Chaos.TOO_SHORT
        return ChaosTest(verdict, 0.0, 0.0, 0.0, np.zeros(angles), c)
    k = _correlations(x, c)
    low, median, high = (float(q) for q in np.quantile(k, [0.25, 0.5, 0.75]))
    half = float(np.median(_correlations(x[: x.size // 2], c)))
    verdict = Chaos.TOO_SHORT
    if x.size >= _LEAST and median < _REGULAR and half < 0.5:
        verdict = Chaos.REGULAR
    elif x.size >= _LEAST and median > _CHAOTIC and half > 0.5:
        verdict = Chaos.CHAOTIC
    return ChaosTest(verdict, median, 0.5 * (high - low), half, k, c)


def _correlations(x: Array, angles: Array) -> Array:
    """Return K of each angle: the correlation of n with the mean square displacement over n steps."""
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
