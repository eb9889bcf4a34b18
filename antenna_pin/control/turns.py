"""Quaternions xyzw of attitudes: products, turns from one to another."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

__all__ = ["between_quaternions", "product_of", "quaternion_of", "turned_back"]

Array = NDArray[np.float64]


def quaternion_of(turn: Array) -> Array:
    """Return the quaternion of a rotation vector [rad]."""
    size = float(np.linalg.norm(turn))
    half = 0.5 * size
    return np.append(turn * (0.5 if size == 0.0 else math.sin(half) / size), math.cos(half))


def product_of(first: Array, second: Array) -> Array:
    """Return the quaternion of a turn, then another in the axes that the first has turned."""
    a, b = first[:3], second[:3]
    return np.append(first[3] * b + second[3] * a + np.cross(a, b), first[3] * second[3] - a @ b)


def between_quaternions(first: Array, second: Array) -> Array:
    """Return the quaternion from one attitude to another in axes of the first, by the shorter turn."""
    found = product_of(np.append(-first[:3], first[3]), second)
    return found if found[3] >= 0.0 else -found


def turned_back(quaternion: Array, vector: Array) -> Array:
    """Return a vector in axes that have turned by a quaternion."""
    a, w = -quaternion[:3], quaternion[3]
    across = 2.0 * np.cross(a, vector)
    return np.asarray(vector + w * across + np.cross(a, across))
