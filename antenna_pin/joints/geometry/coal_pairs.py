"""Distances of candidate contacts by coal, each of two shapes of its own."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import coal
import numpy as np
from numpy.typing import NDArray

from antenna_pin.compiled.native import NOT_TURNED, PLANE_GIVEN, SECOND_TURNED, ShapePair
from antenna_pin.joints.geometry import kernels
from antenna_pin.joints.geometry.coal_backend import CoalBackend
from antenna_pin.joints.geometry.coal_kernels import PAIRS, SHAPE_AT
from antenna_pin.joints.geometry.coal_pair_kernels import PAIR, ROW_WORDS
from antenna_pin.joints.geometry.corner_kernels import CORNER
from antenna_pin.joints.geometry.guide_kernels import EDGE
from antenna_pin.joints.geometry.revolute_kernels import REVOLUTE
from antenna_pin.joints.geometry.round_kernels import ROUND


class Partners(NamedTuple):
    """Two shapes of coal whose distance is that of a candidate contact.

    Attributes:
        first: The first shape.
        second: The second shape; of a given plane any half-space.
        turned: ``NOT_TURNED``, ``SECOND_TURNED`` or ``PLANE_GIVEN`` (:mod:`antenna_pin.compiled.native`).
    """

    first: Any
    second: Any
    turned: int = NOT_TURNED


class CoalPairs(CoalBackend):
    """Distances of candidate contacts by coal.

    Args:
        candidates: Those of the joint as the kernels have them, (contacts, CANDIDATE).
        partners: Of each contact the shapes of its one or two queries
            (:func:`antenna_pin.joints.geometry.coal_pair_kernels.pairs_set_out`).
    """

    def __init__(self, candidates: NDArray[np.float64], partners: Sequence[Sequence[Partners]]) -> None:
        """Build functors once."""
        super().__init__(PAIRS, len(candidates), SHAPE_AT + len(candidates) * ROW_WORDS)
        self._candidates = candidates
        self._request = coal.DistanceRequest()
        #: Bit of each query, its shapes, and their functor.
        self._pairs = [
            (2 * k + which, pair, coal.ComputeDistance(pair.first, pair.second))
            for k, row in enumerate(partners)
            for which, pair in enumerate(row)
        ]

    def prepare(self, work: NDArray[np.float64]) -> Sequence[Callable[[], None]]:
        """Write the candidates into an array; return the queries in Python, bit by bit."""
        end = SHAPE_AT + self._candidates.size
        work[SHAPE_AT:end] = self._candidates.ravel()
        self._numbers = work[end : self.words].view(PAIR)
        questions: list[Callable[[], None]] = [lambda: None] * (2 * self._contacts)
        for bit, pair, functor in self._pairs:
            questions[bit] = self._question(self._numbers[bit // 2], pair, functor)
        return questions

    def pairs(self) -> Sequence[ShapePair]:
        """Return the pairs of shapes, as machine code evaluates them."""
        numbers = self._numbers
        return [
            ShapePair(
                functor=functor,
                request=self._request,
                asked=self._asked,
                bit=bit,
                distance=numbers["gap"][bit // 2 : bit // 2 + 1],
                normal=numbers["normal"][bit // 2],
                point=numbers["point"][bit // 2],
                first=numbers["first"][bit // 2],
                second=numbers["second"][bit // 2],
                turned=pair.turned,
                turn=None if pair.turned == NOT_TURNED else numbers["turn"][bit // 2],
                plane=pair.second if pair.turned == PLANE_GIVEN else None,
                shapes=pair,
            )
            for bit, pair, functor in self._pairs
        ]

    def _question(self, numbers: Any, pair: Partners, functor: Any) -> Callable[[], None]:
        """Return a query of coal in Python."""
        at_first, at_second = coal.Transform3s(), coal.Transform3s()
        request, result = self._request, coal.DistanceResult()
        first, second, turn = numbers["first"], numbers["second"], numbers["turn"]

        def ask() -> None:
            measure = functor
            at_first.setTranslation(first)
            at_second.setTranslation(second)
            if pair.turned == SECOND_TURNED:
                at_second.setRotation(turn)
            elif pair.turned == PLANE_GIVEN:
                plane = coal.Halfspace(turn[0].copy(), float(turn[1, 0]))
                measure = coal.ComputeDistance(pair.first, plane)
            result.clear()
            numbers["gap"] = measure(at_first, at_second, request, result)
            numbers["normal"] = result.normal
            numbers["point"] = result.getNearestPoint1()

        return ask


# --- a round part in a round hollow -------------------------------------------------------------------------


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


# --- sliders in guides --------------------------------------------------------------------------------------


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
