"""A rectangular slider in a rectangular guide, and what it shares with a round one."""

from __future__ import annotations

import cmath
import itertools
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.readable import GIVEN, readable
from antenna_pin.errors import InvalidParameterError
from antenna_pin.joints.geometry import kernels
from antenna_pin.joints.geometry.corner_kernels import CORNER
from antenna_pin.joints.geometry.dimension import RADIAL, Play, dimension
from antenna_pin.joints.geometry.guide_kernels import EDGE
from antenna_pin.joints.geometry.look import Across, Array, Look, Sizes, length
from antenna_pin.joints.geometry.shape import (
    ContactPlace,
    Motion,
    Shape,
    check_dimensions,
    flat,
)

if TYPE_CHECKING:
    from antenna_pin.joints.geometry.coal_pairs import CoalPrismatic

# --- readings of results ------------------------------------------------------------------------------------


def _across(size: Sizes, p: Array, z: Array) -> Across:
    """Return the slider's axis at its guided ends, and its play, a rectangle.

    The rectangle is turned by the roll.

    A centred slider touches with a corner, the centre of whose rounding is at (a, b): a cos + b sin = c.
    """
    half = 0.5 * size["slider_length"]
    guided = size.get("guide_length", 0.0)
    offset = clamped(p, z, half, guided)
    guide = 0.5 * np.array([size["guide_width"], size["guide_height"]])
    slider = 0.5 * np.array([size["slider_width"], size["slider_height"]])
    play, corner = guide - slider, slider - size["corner_radius"]
    c, s = math.cos(size["roll"]), math.sin(size["roll"])
    turn = np.array([[c, -s], [s, c]])  # from the section's axes to the bearing's
    rectangle = play * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]])
    if guided and guided < size["slider_length"]:
        tilts = [mouths(0.5 * guided, a, b) for a, b in zip(guide, slider, strict=True)]
    else:
        tilts = [touches(a, half - size["corner_radius"], a + d) for a, d in zip(corner, play, strict=True)]
    twists = [touches(a, b, a + d) for a, b, d in zip(corner, corner[::-1], play, strict=True)]
    return Across(
        ("+", "-"),
        offset,
        np.hypot(offset[..., 0], offset[..., 1]),
        np.max(np.abs(offset[..., :2] @ turn) / play, axis=2),
        float(play.min()),
        rectangle @ turn.T,
        tilt=math.hypot(*tilts),  # both directions at once
        twist=float(np.fmin.reduce(twists)),
    )


def _wall(size: Sizes, end: str) -> complex:
    """Return which way the wall of an end such as ``+x-y+z`` faces out."""
    return (1.0 if end[0] == "+" else -1.0) * (1j if end[1] == "y" else 1.0) * cmath.exp(1j * size["roll"])


def clamped(p: Array, z: Array, half: float, guide: float) -> Array:
    """Return a slider's axis at the ends of its guided part, (n, 2, 3) [m].

    Args:
        p: Its centre, (n, 3) [m].
        z: Its axis, (n, 3).
        half: Half its length [m].
        guide: The guide's length [m]; 0 for an unlimited one.
    """
    along = np.array([half, -half])[None, :] * np.ones((len(p), 1))
    if guide:
        ends = p[:, 2:] + along * z[:, 2:]
        along = (np.clip(ends, -0.5 * guide, 0.5 * guide) - p[:, 2:]) / z[:, 2:]
    return np.asarray(p[:, None, :] + along[:, :, None] * z[:, None, :])


def mouths(half: float, outer: float, inner: float) -> float:
    """Return the tilt at both mouths, of outer cos - half sin = inner [rad]."""
    play = outer - inner
    return 2.0 * math.atan2(play, half + math.sqrt(half * half + (outer + inner) * play))


def guide_words(size: Sizes) -> list[str]:
    """Return in words how long a guide is that ends."""
    guide = size.get("guide_length", 0.0)
    return [f"guide {length(guide)} long"] if guide else []


def touches(a: float, b: float, c: float) -> float:
    """Return the least root of a cos + b sin = c [rad]; else NaN."""
    left = b * b + a * a - c * c
    return math.nan if left < 0.0 else 2.0 * math.atan2(c - a, b + math.sqrt(left))


def _dimensions(size: Sizes) -> list[str]:
    play = {side: 0.5 * (size[f"guide_{side}"] - size[f"slider_{side}"]) for side in ("width", "height")}
    parts = [
        f"guide {length(size['guide_width'])} wide and {length(size['guide_height'])} high, slider "
        f"{length(size['slider_width'])} wide, {length(size['slider_height'])} high and "
        f"{length(size['slider_length'])} long",
        f"clearance {length(play['width'])} to each side along the width, {length(play['height'])} along the "
        "height",
    ]
    parts += guide_words(size)
    if size["corner_radius"]:
        parts.append(f"slider's edges rounded by {length(size['corner_radius'])}")
    if size["roll"]:
        parts.append(f"section turned by {readable(size['roll'], 'rad', GIVEN)} about the axis")
    return parts


LOOK = Look(
    held="a rectangular slider in a guide, held by contact alone",
    dimensions=_dimensions,
    picture="slider",
    contacts=frozenset({"wall"}),
    rows=("transverse",),
    across=_across,
    faces=_wall,
    outline="clearance rectangle",
)


# --- shape --------------------------------------------------------------------------------------------------

_SIGNS = ((1.0, "+"), (-1.0, "-"))
Vector = NDArray[np.float64]


def guided_length(slider: float, guide: float) -> float:
    """Return the guided length of a centred slider, from both lengths [m]."""
    return min(slider, guide) if guide else slider


def walls(
    corners: Iterable[tuple[Vector, Vector, float]], radius: float, guide: float
) -> NDArray[np.float64]:
    """Return the records of corners on walls as flat numbers, (corners, CANDIDATE).

    Args:
        corners: Centre of each corner's rounding in the child's axes [m], its wall's normal into the hollow
            and the wall's distance from the bearing's centre [m].
        radius: Radius of the roundings [m].
        guide: Its length [m]; 0 for an unlimited one.
    """
    if guide:
        kind, half = kernels.EDGE_IN_GUIDE, 0.5 * guide
        return flat(EDGE, *((kind, corner, wall[:2], at, radius, half) for corner, wall, at in corners))
    kind = kernels.CORNER_ON_WALL
    return flat(CORNER, *((kind, corner, wall, at, radius) for corner, wall, at in corners))


@dataclass(frozen=True, slots=True, kw_only=True)
class PrismaticClearance(Shape):
    """A rectangular slider with rounded edges in a rectangular guide: a prismatic joint with play.

    The slider may touch each of the guide's four walls with the four corners of its own on that side: sixteen
    candidates, of which one is a tilt's edge contact, two a line along or across the wall, four a surface.
    Candidate ``wall+x+y-z`` is the wall at +x with the corner at +y, -z. The gap between a corner and a wall
    is exact at any tilt and roll.

    A guide of limited length touches the part of the slider within it: where the slider protrudes from a
    mouth, the candidate is not the corner there but the mouth's edge against the slider's flank, at the
    slider's own long edge. Nothing stops the slider along the axis, and one that has left is free of the
    guide, except for its block's face.

    Attributes:
        guide_width: Of a guide's hollow, along its section's x [m].
        guide_height: Along its section's y [m].
        slider_width: Below the guide's [m].
        slider_height: Below the guide's [m].
        slider_length: Along the axis [m].
        corner_radius: Of the rounding of the slider's edges, below half of each of its sides; 0 for none [m].
        roll: Of a guide's section about the axis, from the x axis of the bearing frame [rad].
        guide_length: Along the axis; 0 for a guide longer than the slider's travel [m].

    References:
        Flores, Leine and Glocker (2010), Multibody Syst. Dyn. 23, 165-190 (recalled): planar, with sharp
        corners; this is its extension to three dimensions.
    """

    kind: ClassVar[str] = "prismatic"
    look: ClassVar[Look] = LOOK
    planar: ClassVar[bool] = False
    motion: ClassVar[Motion] = "slide"
    plays: ClassVar[tuple[Play, ...]] = tuple(
        RADIAL._replace(
            outer=f"guide_{side}", inner=f"slider_{side}", share=2.0, name=f"play across the {side}"
        )
        for side in ("width", "height")
    )
    no_line: ClassVar[str] = "the corner of a slider"
    sharp: ClassVar[str] = "corner_radius: a sharp corner has no stiffness"

    guide_width: float = dimension("bearing")
    guide_height: float = dimension("bearing")
    slider_width: float = dimension("journal", below="guide_width")
    slider_height: float = dimension("journal", below="guide_height")
    slider_length: float = dimension("journal")
    corner_radius: float = dimension("journal", rule="zero or more", default=0.0)
    roll: float = dimension("bearing", unit="rad", rule="", default=0.0)
    guide_length: float = dimension("bearing", rule="zero or more", default=0.0)

    def __post_init__(self) -> None:
        """Check the dimensions."""
        check_dimensions(self)
        half = 0.5 * min(self.slider_width, self.slider_height, self.slider_length)
        if not self.corner_radius < half:
            raise InvalidParameterError(self, "corner_radius", f"below half of each side, {half:g} m")

    @property
    def radial_clearance(self) -> float:
        """The lesser of the plays to each side [m]."""
        return 0.5 * min(self.guide_width - self.slider_width, self.guide_height - self.slider_height)

    @property
    def contact_radius(self) -> float:
        """Radius of a corner, which is on a plane [m]."""
        return self.corner_radius

    @property
    def section_radius(self) -> float:
        """Half the lesser side of the guide [m]."""
        return 0.5 * min(self.guide_width, self.guide_height)

    @property
    def half_length(self) -> float:
        """Half the guided length of a centred slider [m]."""
        return 0.5 * guided_length(self.slider_length, self.guide_length)

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
        """Return the queries of coal for the same distances."""
        from antenna_pin.joints.geometry.coal_pairs import CoalPrismatic

        return CoalPrismatic(self.candidates(axes))
