"""Distances of round sections by coal's own primitives: planar journal, ball in a socket.

The hollow part is queried at the point on the line of centres, as a sphere of radius zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import coal
import numpy as np
from numpy.typing import NDArray

from antenna_pin.joints.geometry import kernels
from antenna_pin.joints.geometry.round_kernels import ROUND

__all__ = ["CoalPlanar", "CoalSpherical"]


class _CoalRound:
    """A point of the hollow against the solid inside.

    Args:
        primitive: Of the closed form that gives the point.
        bearing_radius: Of the hollow [m].
        journal_radius: Of the solid [m].
        solid: The solid as coal's shape.
    """

    def __init__(self, primitive: int, bearing_radius: float, journal_radius: float, solid: Any) -> None:
        """Build shapes, functors and buffers once."""
        numbers = np.array([(primitive, bearing_radius, journal_radius, (0.0,) * 6)], dtype=ROUND)
        self._candidate = numbers.view(np.float64)
        self._point = coal.Sphere(0.0)
        self._solid = solid
        self._functor = coal.ComputeDistance(self._point, self._solid)
        self._request = coal.DistanceRequest()
        self._result = coal.DistanceResult()
        self._at_point = coal.Transform3s()
        self._at_solid = coal.Transform3s()

    def query(
        self, pose: NDArray[Any], table: NDArray[Any], row: int, wanted: Sequence[float] | None = None
    ) -> None:
        """Fill the one row (see :class:`antenna_pin.joints.geometry.Distances`)."""
        rows = table[row : row + 1]
        kernels.fill(self._candidate, pose, rows)
        self._at_point.setTranslation(rows["point"][0])
        self._at_solid.setTranslation(pose["centre"][0])
        self._result.clear()
        rows["gap"] = self._functor(self._at_point, self._at_solid, self._request, self._result)
        rows["normal"] = self._result.normal


class CoalPlanar(_CoalRound):
    """A point of the bore against the journal as a cylinder.

    Args:
        bearing_radius: [m].
        journal_radius: [m].
    """

    def __init__(self, bearing_radius: float, journal_radius: float) -> None:
        """Make the journal long: its end faces must not count."""
        cylinder = coal.Cylinder(journal_radius, 10.0 * bearing_radius)
        super().__init__(kernels.CIRCLE_IN_CIRCLE, bearing_radius, journal_radius, cylinder)


class CoalSpherical(_CoalRound):
    """A point of the socket against the ball.

    Args:
        bearing_radius: Of the socket [m].
        journal_radius: Of the ball [m].
    """

    def __init__(self, bearing_radius: float, journal_radius: float) -> None:
        """Make the ball."""
        super().__init__(kernels.BALL, bearing_radius, journal_radius, coal.Sphere(journal_radius))
