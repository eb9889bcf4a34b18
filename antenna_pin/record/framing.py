"""What the camera of a recording begins with: all of the motion in view, from where most of it is seen."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.record.scene import packed_floats

__all__ = ["camera", "clearest", "nice"]

Array = NDArray[np.float64]

# Views that are compared: so many around, at these heights over the horizon [rad]. The first is kept unless
# another shows so much more [-].
_AROUND = 12
_HEIGHTS = (0.41, 0.75)
_BETTER = 0.1
_CELLS = 48  # over the greatest way of all that moves, by which it is counted who hides whom


def nice(value: float) -> float:
    """Return the largest 1, 2 or 5 times a power of ten that is not above a positive value."""
    power = 10.0 ** np.floor(np.log10(value))
    digit = max(step for step in (1.0, 2.0, 5.0) if step * power <= value * (1.0 + 1e-12))
    return float(f"{digit * power:.1g}")


def camera(points: Array, direction: ArrayLike, upright: ArrayLike | None = None) -> dict[str, Any]:
    """Return what the player frames: the outermost of the points, their middle, and from where it looks.

    Args:
        points: (n, 3) [m].
        direction: From the middle to the camera, (3,) [-]; in axes of which z points up.
        upright: Rotation from the points' axes to those, (3, 3) [-]; none if left out.
    """
    k = np.arange(256)
    z = 1.0 - (2.0 * k + 1.0) / len(k)
    phi = np.pi * (3.0 - np.sqrt(5.0)) * k
    sphere = np.stack([np.sqrt(1.0 - z * z) * np.cos(phi), np.sqrt(1.0 - z * z) * np.sin(phi), z], axis=1)
    outermost = np.unique([int(np.argmax(points @ direction)) for direction in sphere])
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    return {
        "points": packed_floats(points[outermost]),
        "target": middle.tolist(),
        "direction": np.asarray(direction, dtype=float).tolist(),
        "upright": np.asarray(np.eye(3) if upright is None else upright, dtype=float).tolist(),
    }


def clearest(places: Sequence[Array], first: ArrayLike, upright: Array) -> Array:
    """Return the direction from which the bodies hide one another least, (3,) [-].

    Of each direction it is counted, at some instants, in how many cells of a coarse picture each body lies in
    front, as a share of the most that any direction has of it. The mean of the shares' square roots counts: a
    body that is not seen at all weighs more than a tenth of many that is hidden.

    Args:
        places: Points of the surface of each body at the instants, (instants, points, 3) each [m].
        first: Direction that is taken where no other shows more, (3,) [-]; as the result, in axes of which z
            points up.
        upright: Rotation from the points' axes to those, (3, 3) [-].
    """
    some = [points @ upright.T for points in places if points.size]
    start: Array = np.asarray(first, dtype=float) / np.linalg.norm(first)
    if len(some) < 2:
        return start
    azimuth = np.arctan2(start[1], start[0])
    ways = [start] + [
        np.array([np.cos(height) * np.cos(phi), np.cos(height) * np.sin(phi), np.sin(height)])
        for height in _HEIGHTS
        for phi in azimuth + 2.0 * np.pi * np.arange(_AROUND) / _AROUND
    ]
    every = np.concatenate([points.reshape(-1, 3) for points in some])
    step = max(float(np.ptp(every, axis=0).max()), 1e-300) / _CELLS
    seen = np.array([_in_front(some, way, step) for way in ways])  # (ways, instants, bodies)
    most = seen.max(axis=0)
    counted = most > 0.0
    score = np.sqrt(seen / np.where(counted, most, 1.0)).sum(axis=(1, 2)) / max(counted.sum(), 1)
    best = int(np.argmax(score))
    chosen: Array = ways[best] if score[best] > score[0] + _BETTER else start
    return chosen


def _in_front(places: Sequence[Array], way: Array, step: float) -> Array:
    """Return in how many cells of the picture, a step wide, each body lies in front, (instants, bodies)."""
    right = np.cross([0.0, 0.0, 1.0], way)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(way, right), way])
    seen = [points @ axes.T for points in places]  # right, up, towards who looks
    count = np.zeros((seen[0].shape[0], len(seen)))
    owner = np.repeat(np.arange(len(seen)), [points.shape[1] for points in seen])
    for k in range(count.shape[0]):
        points = np.concatenate([one[k] for one in seen])
        low = points[:, :2].min(axis=0)
        column, row = np.floor((points[:, :2] - low) / step).astype(int).T
        cell = row * (2 * _CELLS) + column
        order = np.lexsort((points[:, 2], cell))  # of each cell the foremost comes last
        last = np.flatnonzero(np.diff(cell[order], append=-1))
        count[k] = np.bincount(owner[order[last]], minlength=len(seen))
    return count
