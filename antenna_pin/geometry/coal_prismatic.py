"""Distances between a slider's corners and its guide's walls by coal: balls and half-spaces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import coal
import numpy as np
from numpy.typing import NDArray

from antenna_pin.geometry.corner_kernels import CORNER

__all__ = ["CoalPrismatic"]


class CoalPrismatic:
    """Distances of a slider in a guide by coal.

    Args:
        candidates: The corners on walls as the kernels have them, (contacts, CANDIDATE).
    """

    def __init__(self, candidates: NDArray[np.float64]) -> None:
        """Build shapes, functors and buffers once."""
        corners = np.ascontiguousarray(candidates).view(CORNER)[:, 0]
        self._corners = corners["corner"].copy()
        self._balls = [coal.Sphere(float(radius)) for radius in corners["radius"]]
        # A half-space is {x : n.x <= d}; the material behind a wall whose normal points into the hollow.
        self._walls = [
            coal.Halfspace(np.array(wall), -float(distance))
            for wall, distance in zip(corners["wall"], corners["distance"], strict=True)
        ]
        pairs = zip(self._balls, self._walls, strict=True)
        self._functors = [coal.ComputeDistance(ball, wall) for ball, wall in pairs]
        self._request = coal.DistanceRequest()
        self._result = coal.DistanceResult()
        self._at_ball = coal.Transform3s()
        self._at_wall = coal.Transform3s()

    def query(
        self, pose: NDArray[Any], table: NDArray[Any], row: int, wanted: Sequence[float] | None = None
    ) -> None:
        """Fill the corners' rows (see :class:`antenna_pin.geometry.Distances`)."""
        centres = pose["centre"][0] + self._corners @ pose["rotation"][0].T
        for k, functor in enumerate(self._functors):
            if wanted is not None and not wanted[k]:
                continue
            self._at_ball.setTranslation(centres[k])
            self._result.clear()
            table["gap"][row + k] = functor(self._at_ball, self._at_wall, self._request, self._result)
            # coal's normal runs from the slider to the wall.
            table["normal"][row + k] = -self._result.normal
            table["point"][row + k] = self._result.getNearestPoint1()
