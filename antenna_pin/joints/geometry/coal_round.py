"""Distances of round sections by coal's own primitives: planar journal, ball in a socket.

The hollow part is queried at the point on the line of centres, as a sphere of radius zero.
"""

from __future__ import annotations

from typing import Any

import coal
import numpy as np

from antenna_pin.joints.geometry import kernels
from antenna_pin.joints.geometry.coal_pairs import CoalPairs, Partners
from antenna_pin.joints.geometry.round_kernels import ROUND

__all__ = ["CoalPlanar", "CoalSpherical"]


class _CoalRound(CoalPairs):
    """A point of the hollow against the solid inside.

    Args:
        primitive: Primitive of the closed form that gives the point.
        bearing_radius: Radius of the hollow [m].
        journal_radius: Radius of the solid [m].
        solid: The solid as coal's shape.
    """

    def __init__(self, primitive: int, bearing_radius: float, journal_radius: float, solid: Any) -> None:
        """Build the shapes once."""
        numbers = np.array([(primitive, bearing_radius, journal_radius, (0.0,) * 6)], dtype=ROUND)
        super().__init__(numbers.view(np.float64).reshape(1, -1), [[Partners(coal.Sphere(0.0), solid)]])


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
