"""Whether the points of a section have settled: each half of them lies where the other half does.

A drift shows as points of one half that lie farther from those of the other than these from one another. The
rule asks for no kind of motion: a fixed point, several, a closed curve and a strange attractor all pass it
once the motion is there, for then both halves are samples of the same set; points of the way there do not.
A drift of a strange attractor or of a closed curve by less than its points are apart is not seen.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["RULE", "LEAST", "Settled", "judge"]

Array = NDArray[np.float64]

#: Points that a judgement takes at the least.
LEAST = 8

# How much farther from the other half than from their own points may lie: samples of one set give about 1.
_FARTHER = 3.0

#: The rule in words, for a result.
RULE = (
    "settled if no point of either half lies farther from the nearest of the other half than 3 times what "
    "any point of the second half lies from the nearest of its own half, or than the tolerance times the "
    "size of the quantities"
)


@dataclass(frozen=True, slots=True)
class Settled:
    """A judgement.

    Attributes:
        yes: Whether they have settled.
        drift: Largest distance of a point from the nearest of the other half, over the size of the
            quantities, the largest difference in any of them counting [-].
        spacing: Likewise of the second half from the nearest of its own [-].
    """

    yes: bool
    drift: float
    spacing: float


def judge(values: ArrayLike, tolerance: float = 1e-4, scale: ArrayLike | None = None) -> Settled:
    """Return whether points of a section, in the order of time, have settled.

    Args:
        values: Of each quantity, (n, quantities); fewer than 8 points have never settled.
        tolerance: A drift below this part of the quantities' size is none [-].
        scale: Size of each quantity, (quantities,); the largest amount among the points if left out.
    """
    points = np.asarray(values, dtype=float)
    n = len(points)
    if n < LEAST or not np.isfinite(points).all():
        return Settled(False, float("inf"), float("inf"))
    sizes = np.abs(points).max(axis=0) if scale is None else np.asarray(scale, dtype=float)
    sizes = np.where(sizes > 0.0, sizes, 1.0)
    scaled = points / sizes
    first, second = scaled[: n // 2], scaled[n - n // 2 :]
    across = _distances(second, first)
    within = _distances(second, second)
    np.fill_diagonal(within, np.inf)
    drift = float(max(across.min(axis=1).max(), across.min(axis=0).max()))
    spacing = float(within.min(axis=1).max())
    return Settled(drift <= max(_FARTHER * spacing, tolerance), drift, spacing)


def _distances(one: Array, other: Array) -> Array:
    """Return the largest difference in any quantity, of each point and each other one."""
    found: Array = np.abs(one[:, None, :] - other[None, :, :]).max(axis=2)
    return found
