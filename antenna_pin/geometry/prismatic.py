"""A rectangular slider in a rectangular guide, and what it shares with a round one."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError
from antenna_pin.geometry import kernels
from antenna_pin.geometry.coal_prismatic import CoalPrismatic
from antenna_pin.geometry.corner_kernels import CORNER
from antenna_pin.geometry.guide_kernels import EDGE
from antenna_pin.geometry.shape import ContactPlace, Motion, Shape, flat, require_lengths

__all__ = ["PrismaticClearance", "check_guide_length", "walls", "within"]

_SIGNS = ((1.0, "+"), (-1.0, "-"))
Vector = NDArray[np.float64]


class _Guided(Protocol):
    """What slides in a guide."""

    @property
    def guide_length(self) -> float: ...


def check_guide_length(shape: _Guided) -> None:
    """Refuse a guide's length that is none: of a guide without end it is 0."""
    if not 0.0 <= shape.guide_length < math.inf:
        raise InvalidParameterError(shape, "guide_length", "a length [m], or 0 for a guide without end")


def within(slider: float, guide: float) -> float:
    """Return how much of a slider is within its guide when it is in the middle, from their lengths [m]."""
    return min(slider, guide) if guide else slider


def walls(
    corners: Iterable[tuple[Vector, Vector, float]], radius: float, guide: float
) -> NDArray[np.float64]:
    """Return the records of corners on walls as flat numbers, (corners, CANDIDATE).

    Args:
        corners: Centre of each corner's rounding in the child's axes [m], its wall's normal into the hollow
            and the wall's distance from the bearing's centre [m].
        radius: Of the roundings [m].
        guide: Its length [m]; 0 for one without end.
    """
    if guide:
        kind, half = kernels.EDGE_IN_GUIDE, 0.5 * guide
        return flat(EDGE, *((kind, corner, wall[:2], at, radius, half) for corner, wall, at in corners))
    kind = kernels.CORNER_ON_WALL
    return flat(CORNER, *((kind, corner, wall, at, radius) for corner, wall, at in corners))


@takes(
    guide_width="m",
    guide_height="m",
    slider_width="m",
    slider_height="m",
    slider_length="m",
    corner_radius="m",
    guide_length="m",
    roll="rad",
)
@dataclass(frozen=True, slots=True, kw_only=True)
class PrismaticClearance(Shape):
    r"""A rectangular slider with rounded edges in a rectangular guide: a prismatic joint with play.

    The slider may touch each of the guide's four walls with the four corners of its own on that side: sixteen
    candidates, of which one is a tilt's edge contact, two a line along or across the wall, four a surface.
    Candidate ``wall+x+y-z`` is the wall at +x and there the corner at +y, -z. The gap between a corner and a
    wall is exact at any tilt and roll.

    A guide that ends, of whichever length, touches what is within it: where the slider reaches out of a
    mouth, the candidate is no longer the corner there but the mouth's edge against the slider's flank, at the
    slider's own long edge. Nothing stops the slider along the axis, and one that has left is free of the
    guide, but for its block's face.

    Attributes:
        guide_width: Of the hollow, along the section's x [m].
        guide_height: Along the section's y [m].
        slider_width: Below the guide's [m].
        slider_height: Below the guide's [m].
        slider_length: Along the axis [m].
        corner_radius: Of the rounding of the slider's edges, 0 or more, below half of each of its sides [m].
        roll: Of the section about the axis, from the x axis of the bearing frame [rad].
        guide_length: Along the axis, 0 for a guide that is longer than the slider's way [m].

    References:
        Flores, Leine and Glocker (2010), Multibody Syst. Dyn. 23, 165-190 (recalled): planar, with sharp
        corners; this is its extension to three dimensions.
    """

    kind: ClassVar[str] = "prismatic"
    planar: ClassVar[bool] = False
    motion: ClassVar[Motion] = "slide"

    guide_width: float
    guide_height: float
    slider_width: float
    slider_height: float
    slider_length: float
    corner_radius: float = 0.0
    roll: float = 0.0
    guide_length: float = 0.0

    def __post_init__(self) -> None:
        """Check the dimensions."""
        require_lengths(self, "guide_width", "guide_height", "slider_width", "slider_height", "slider_length")
        for side in ("width", "height"):
            guide = getattr(self, f"guide_{side}")
            if not getattr(self, f"slider_{side}") < guide:
                raise InvalidParameterError(self, f"slider_{side}", f"below guide_{side} = {guide:g} m")
        half = 0.5 * min(self.slider_width, self.slider_height, self.slider_length)
        if not 0.0 <= self.corner_radius < half:
            raise InvalidParameterError(
                self, "corner_radius", f"zero or more, and below half of each side, {half:g} m"
            )
        if not math.isfinite(self.roll):
            raise InvalidParameterError(self, "roll", "finite [rad]")
        check_guide_length(self)

    @property
    def radial_clearance(self) -> float:
        """The lesser of the plays to each side [m]."""
        return 0.5 * min(self.guide_width - self.slider_width, self.guide_height - self.slider_height)

    @property
    def section_radius(self) -> float:
        """Half the lesser side of the guide [m]."""
        return 0.5 * min(self.guide_width, self.guide_height)

    @property
    def half_length(self) -> float:
        """Half of what of the slider is within the guide when it is in the middle [m]."""
        return 0.5 * within(self.slider_length, self.guide_length)

    @property
    def contact_places(self) -> tuple[ContactPlace, ...]:
        """The corners on each wall."""
        return tuple(ContactPlace("wall", end) for end, *_ in self._corners())

    def _corners(self) -> list[tuple[str, NDArray[np.float64], NDArray[np.float64], float]]:
        """Return name, corner, inward normal and distance of the wall of all candidates, without roll."""
        half = 0.5 * np.array([self.slider_width, self.slider_height, self.slider_length])
        guide = 0.5 * np.array([self.guide_width, self.guide_height])
        found = []
        for axis, other in ((0, 1), (1, 0)):
            for (wall, w), (across, a), (along, z) in itertools.product(_SIGNS, _SIGNS, _SIGNS):
                signs = np.zeros(3)
                signs[axis], signs[other], signs[2] = wall, across, along
                normal = np.zeros(3)
                normal[axis] = -wall
                end = f"{w}{'xy'[axis]}{a}{'xy'[other]}{z}z"
                found.append((end, signs * (half - self.corner_radius), normal, float(guide[axis])))
        return found

    def candidates(self, axes: ArrayLike) -> NDArray[np.float64]:
        """Return the records of the candidate contacts as flat numbers, (16, CANDIDATE)."""
        in_child = np.asarray(axes, dtype=float)
        c, s = math.cos(self.roll), math.sin(self.roll)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        return walls(
            [(in_child @ turn @ corner, turn @ wall, at) for _, corner, wall, at in self._corners()],
            self.corner_radius,
            self.guide_length,
        )

    def coal(self, axes: ArrayLike) -> CoalPrismatic:
        """Return what asks coal for the same distances."""
        return CoalPrismatic(self.candidates(axes))
