"""Which way is which in a picture: the axes that numbers are given in, and gravity."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from antenna_pin.record.scene import packed_doubles, packed_floats

__all__ = ["triad"]


def triad(
    label: str, axes: ArrayLike, gravity: ArrayLike | None = None, times: ArrayLike = (0.0,)
) -> dict[str, Any]:
    """Return a triad as the player takes it, all in the axes of the scene.

    Args:
        label: Whose axes they are.
        axes: Unit vectors x, y and z, (3, 3), a row each [-].
        gravity: Its direction over time, (n, 3), any length [-]; None or zero without gravity.
        times: Of these directions, (n,) [s].
    """
    pull = np.zeros((1, 3)) if gravity is None else np.atleast_2d(np.asarray(gravity, dtype=float))
    moments = np.asarray(times, dtype=float)
    if np.ptp(pull, axis=0).max() <= 1e-6 * np.abs(pull).max():
        pull, moments = pull[:1], moments[:1]  # it does not turn
    return {
        "label": label,
        "axes": np.asarray(axes, dtype=float).tolist(),
        "gravity": packed_floats(pull) if pull.any() else None,
        "times": packed_doubles(moments),
    }
