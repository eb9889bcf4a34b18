"""Profiles of bodies of revolution: their (radius, height) along the axis, for :func:`lathe`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from antenna_pin.record.shapes import Mesh, lathe

Array = NDArray[np.float64]


def line(radius: float, ends: Array) -> Array:
    """Return the profile of a cylinder between two heights, (2, 2) [m]."""
    return np.stack([np.full(2, radius), ends], axis=1)


def solid(radius: float, low: float, high: float) -> tuple[Array, Array]:
    """Return the inner and outer profile of a solid cylinder, (2, 2) each [m]."""
    ends = np.array([low, high])
    return line(0.0, ends), line(radius, ends)


def arc(radius: float) -> Array:
    """Return the profile of a sphere, (49, 2) [m]."""
    angle = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 49)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def ring(radius: float, height: float, thick: float) -> Mesh:
    """Return a thin ring about the axis at a height, of a wire of the radius ``thick`` [m]."""
    angle = np.linspace(0.0, np.pi, 9)
    across = np.stack([thick * np.cos(angle), thick * np.sin(angle)], axis=1)
    middle = np.array([radius, height])
    return lathe(middle + across[:, ::-1] * [-1.0, 1.0], middle + across[:, ::-1])
