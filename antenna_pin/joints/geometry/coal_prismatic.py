"""Distances between a slider and its guide by coal: balls, half-spaces and cylinders.

Adjacent parts of the two are found in closed form (:mod:`antenna_pin.joints.geometry.guide_kernels`); coal
measures their distances.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import coal
import numpy as np
from numpy.typing import NDArray

from antenna_pin.compiled.native import PLANE_GIVEN, SECOND_TURNED
from antenna_pin.joints.geometry import kernels
from antenna_pin.joints.geometry.coal_pairs import CoalPairs, Partners
from antenna_pin.joints.geometry.corner_kernels import CORNER
from antenna_pin.joints.geometry.guide_kernels import EDGE
from antenna_pin.joints.geometry.revolute_kernels import REVOLUTE

__all__ = ["CoalPrismatic"]

_LONG = 10.0  # length over the bearing's radius of a cylinder whose ends must not count


class CoalPrismatic(CoalPairs):
    """Distances of a slider in a guide by coal.

    Args:
        candidates: Candidates of the joint as in kernels, (contacts, CANDIDATE).
    """

    def __init__(self, candidates: NDArray[np.float64]) -> None:
        """Build the shapes once."""
        super().__init__(
            candidates, [_PARTNERS[int(words.view(CORNER)["primitive"][0])](words) for words in candidates]
        )


def _corner_on_wall(words: NDArray[np.float64]) -> Sequence[Partners]:
    """Return the ball of a corner's rounding, and the material behind a wall.

    A half-space is {x : n.x <= d}; the wall's normal points into the hollow.
    """
    shape = words.view(CORNER)[0]
    wall = coal.Halfspace(np.array(shape["wall"]), -float(shape["distance"]))
    return [Partners(coal.Sphere(float(shape["radius"])), wall)]


def _edge_in_guide(words: NDArray[np.float64]) -> Sequence[Partners]:
    """Return the ball of a corner or edge, and a plane, given with each pose."""
    ball = coal.Sphere(float(words.view(EDGE)["radius"][0]))
    return [Partners(ball, coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0), PLANE_GIVEN)]


def _rod_in_guide(words: NDArray[np.float64]) -> Sequence[Partners]:
    """Return the rim's point and the guide, and the mouth's point and slider."""
    shape = words.view(REVOLUTE)[0]
    long = _LONG * (shape["bearing_radius"] + 2.0 * shape["half_distance"])
    return [
        Partners(coal.Sphere(0.0), coal.Cylinder(float(shape["bearing_radius"]), long)),
        Partners(coal.Sphere(0.0), coal.Cylinder(float(shape["journal_radius"]), long), SECOND_TURNED),
    ]


_PARTNERS: Mapping[int, Callable[[Any], Sequence[Partners]]] = {
    kernels.CORNER_ON_WALL: _corner_on_wall,
    kernels.EDGE_IN_GUIDE: _edge_in_guide,
    kernels.ROD_IN_GUIDE: _rod_in_guide,
}
