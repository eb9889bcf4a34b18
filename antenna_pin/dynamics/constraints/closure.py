"""A closure: a joint that closes a loop of the tree, held by constraint."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.directions import direction, unit
from antenna_pin.errors import InvalidParameterError
from antenna_pin.mechanism import frame_aligning_z

Array = NDArray[np.float64]

ClosureKind = Literal["revolute", "universal", "spherical", "prismatic", "cylindrical", "planar", "fixed"]

#: Angle between axes that should be parallel from which on they count as opposite, instead of as far off
#: in a first guess [rad]; between 90 deg and this angle both are possible, and axes are taken as written.
OPPOSITE = np.radians(150.0)


@dataclass(frozen=True, slots=True)
class Holds:
    """Directions held by a kind of closure, in axes of the first side's frame.

    Attributes:
        along: Axes along which the second side's point is held at the first's.
        about: Axes about which relative rotation is blocked.
        square: Whether the two sides' axes are held at right angles.
        axis: Whether the kind has an axis.
    """

    along: str = ""
    about: str = ""
    square: bool = False
    axis: bool = True

    @property
    def rows(self) -> int:
        """Number of equations."""
        return len(self.along) + len(self.about) + self.square


CLOSURES: Mapping[str, Holds] = MappingProxyType(
    {
        "revolute": Holds("xyz", "xy"),
        "universal": Holds("xyz", square=True),
        "spherical": Holds("xyz", axis=False),
        "prismatic": Holds("xy", "xyz"),
        "cylindrical": Holds("xy", "xy"),
        "planar": Holds("z", "xy"),
        "fixed": Holds("xyz", "xyz", axis=False),
    }
)
"""The kinds of closures; z is the axis, of a planar one the normal."""


@takes()
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Anchor:
    """Side of a closure: a frame on a link.

    Attributes:
        link: Name of the URDF link, or ``world``.
        rotation: The frame's axes in the link's frame, columns, (3, 3) [-].
        origin: Its origin there, (3,) [m].
    """

    link: str
    rotation: Array
    origin: Array

    @classmethod
    def at(
        cls,
        link: str,
        point: tuple[float, float, float] = (0.0, 0.0, 0.0),
        axis: tuple[float, float, float] = (0.0, 0.0, 1.0),
        across: tuple[float, float, float] | None = None,
    ) -> Anchor:
        """Return the anchor at a point of a link.

        Args:
            link: Name of the URDF link, or ``world``.
            point: In the link's frame [m].
            axis: Direction of the closure's axis in the link's frame; of any length [-].
            across: Direction across the axis that both sides have in common where a closure blocks rotation
                about the axis; its component along the axis is ignored. Without it links with equal
                components of the axis have parallel axes.
        """
        z = direction(axis, "closure", "axis")
        if across is None:
            rotation = frame_aligning_z(z)
        else:
            x = direction(across, "closure", "across")
            x = x - z * (z @ x)
            if not np.linalg.norm(x) > 1e-6:
                raise InvalidParameterError("closure", "across", "a direction off the axis", tuple(across))
            x = unit(x)
            rotation = np.column_stack([x, np.cross(z, x), z])
        return cls(link=link, rotation=np.array(rotation), origin=np.array(point, dtype=float))


@takes()
@dataclass(frozen=True, slots=True, kw_only=True)
class Closure:
    """A joint between two links of the tree.

    Attributes:
        kind: Kind of joint (:data:`CLOSURES`). The axis of each side's frame is its z; a universal closure
            holds the two at right angles, others with an axis hold them parallel.
        first: One side; forces are given in its frame's axes.
        second: The other; forces act on its link.
    """

    kind: ClosureKind
    first: Anchor
    second: Anchor

    def __post_init__(self) -> None:
        """Check the kind, and that there are two links."""
        if self.kind not in CLOSURES:
            raise InvalidParameterError(self, "kind", f"one of {', '.join(CLOSURES)}")
        if self.first.link == self.second.link:
            raise InvalidParameterError(
                self, "second", f"on another link than first, {self.first.link!r}", self.second.link
            )

    @property
    def holds(self) -> Holds:
        """Directions held by the closure's kind."""
        return CLOSURES[self.kind]
