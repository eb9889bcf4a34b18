"""Distances between a slider and its guide by coal: balls, half-spaces and cylinders.

Which parts of the two are next to each other, and where, is found in closed form
(:mod:`antenna_pin.joints.geometry.guide_kernels`); how far they are apart, coal says.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import coal
import numpy as np
from numpy.typing import NDArray

from antenna_pin.joints.geometry import kernels
from antenna_pin.joints.geometry.corner_kernels import CORNER
from antenna_pin.joints.geometry.guide_kernels import EDGE
from antenna_pin.joints.geometry.revolute_kernels import REVOLUTE
from antenna_pin.joints.geometry.shape import pose_of

__all__ = ["CoalPrismatic"]

_LONG = 10.0  # of a cylinder whose ends must not count, over the bearing's radius


class CoalPrismatic:
    """Distances of a slider in a guide by coal.

    Args:
        candidates: Those of the joint as the kernels have them, (contacts, CANDIDATE).
    """

    def __init__(self, candidates: NDArray[np.float64]) -> None:
        """Build shapes, functors and buffers once."""
        self._rows = [_PAIRS[int(words.view(CORNER)["primitive"][0])](words) for words in candidates]

    def query(
        self, pose: NDArray[Any], table: NDArray[Any], row: int, wanted: Sequence[float] | None = None
    ) -> None:
        """Fill the joint's rows (see :class:`antenna_pin.joints.geometry.Distances`)."""
        for k, pair in enumerate(self._rows):
            if wanted is None or wanted[k]:
                pair.ask(pose, table[row + k : row + k + 1])


class _ShapePair:
    """Two shapes of coal, and their distance query."""

    def __init__(self, shape: Any, second: Any) -> None:
        self._shapes = shape, second  # a functor keeps none
        self._functor = coal.ComputeDistance(shape, second)
        self._request = coal.DistanceRequest()
        self._result = coal.DistanceResult()
        self._places = coal.Transform3s(), coal.Transform3s()

    def distance(self, centre: NDArray[Any], second: NDArray[Any], turn: NDArray[Any] | None = None) -> float:
        """Return the distance [m] of the shapes at two places, the second turned."""
        for place, at in zip(self._places, (centre, second), strict=True):
            place.setTranslation(at)
        if turn is not None:
            self._places[1].setRotation(turn)
        self._result.clear()
        return float(self._functor(*self._places, self._request, self._result))

    @property
    def nearest(self) -> tuple[NDArray[Any], NDArray[Any]]:
        """Normal from the first to the second, and nearest point of the first."""
        return self._result.normal, self._result.getNearestPoint1()


class _CornerOnWall:
    """The ball of a corner's rounding against a wall."""

    def __init__(self, words: NDArray[np.float64]) -> None:
        shape = words.view(CORNER)[0]
        self._corner = shape["corner"].copy()
        # A half-space is {x : n.x <= d}; the material behind a wall whose normal points into the hollow.
        wall = coal.Halfspace(np.array(shape["wall"]), -float(shape["distance"]))
        self._asked = _ShapePair(coal.Sphere(float(shape["radius"])), wall)

    def ask(self, pose: NDArray[Any], out: NDArray[Any]) -> None:
        centre = pose["centre"][0] + self._corner @ pose["rotation"][0].T
        out["gap"] = self._asked.distance(centre, np.zeros(3))
        normal, out["point"][0] = self._asked.nearest
        out["normal"] = -normal  # coal's runs from the slider to the wall


class _EdgeInGuide:
    """The ball of a corner or mouth edge against the plane in contact."""

    def __init__(self, words: NDArray[np.float64]) -> None:
        self._words = words.copy()
        shape = words.view(EDGE)[0]
        self._radius, self._reach = float(shape["radius"]), float(shape["reach"])
        self._wall = np.append(-shape["distance"] * shape["wall"], 0.0)
        self._ball = coal.Sphere(self._radius)

    def ask(self, pose: NDArray[Any], out: NDArray[Any]) -> None:
        kernels.fill(self._words, pose, out)
        normal, point = out["normal"][0].copy(), out["point"][0]
        self._wall[2] = np.copysign(self._reach, point[2])  # the mouth's edge, as far as it counts
        asked = _ShapePair(self._ball, coal.Halfspace(normal, float(normal @ self._wall)))
        out["gap"] = asked.distance(point + self._radius * normal, np.zeros(3))
        out["normal"] = -asked.nearest[0]


class _RodInGuide:
    """A point of the rim against the guide, or of the mouth against the slider."""

    def __init__(self, words: NDArray[np.float64]) -> None:
        self._words = words.copy()
        shape = words.view(REVOLUTE)[0]
        self._reach = float(shape["half_length"])
        long = _LONG * (shape["bearing_radius"] + 2.0 * shape["half_distance"])
        self._guide = _ShapePair(coal.Sphere(0.0), coal.Cylinder(float(shape["bearing_radius"]), long))
        self._slider = _ShapePair(coal.Sphere(0.0), coal.Cylinder(float(shape["journal_radius"]), long))

    def ask(self, pose: NDArray[Any], out: NDArray[Any]) -> None:
        kernels.fill(self._words, pose, out)
        point, normal = out["point"][0], out["normal"][0]
        if abs(normal[2]) == 1.0:
            return  # out of the guide: nothing round is asked for
        if abs(point[2]) != self._reach:
            out["gap"] = -self._guide.distance(point, np.array([0.0, 0.0, point[2]]))
            return
        turn = pose_of((0.0, 0.0, 0.0), pose["axis"][0])["rotation"][0]
        out["gap"] = self._slider.distance(point, pose["centre"][0], turn)
        out["normal"] = self._slider.nearest[0]


_PAIRS: dict[int, Any] = {
    kernels.CORNER_ON_WALL: _CornerOnWall,
    kernels.EDGE_IN_GUIDE: _EdgeInGuide,
    kernels.ROD_IN_GUIDE: _RodInGuide,
}
