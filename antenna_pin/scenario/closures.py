"""Joints that close loops of the tree, and joints that follow others."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from antenna_pin.base.units import matching_unit
from antenna_pin.scenario._class_tables import JointTable
from antenna_pin.scenario.spec import Direction, Position, QuantityRule, Spec, refuse

ClosureKind = Literal["revolute", "universal", "spherical", "prismatic", "cylindrical", "planar", "fixed"]
# Kinds without an axis.
_POINTS = ("spherical", "fixed")


class LinkPlaceSpec(Spec):
    """A link, or a frame, and a place on it that may be left out.

    Attributes:
        link: Name of the link, or ``world``.
        frame: Or a frame of the URDF, by its link or joint: its origin.
        point: In the link's frame [m]; None for a frame's origin, and where no place is needed.
    """

    link: str | None = None
    frame: str | None = None
    point: Position | None = None

    @model_validator(mode="after")
    def _check_place(self) -> Self:
        if (self.link is None) == (self.frame is None):
            got = "neither" if self.link is None else "both"
            refuse(f"must have exactly one of link and frame, got {got}")
        if self.frame is not None and self.point is not None:
            refuse("must be left out with frame, whose origin is used; or give link and point", "point")
        return self

    def check_point(self, *place: str) -> None:
        """Refuse a link without a place on it, from inside a validator."""
        if self.link is not None and self.point is None:
            text = "is missing; it is a place in the link's frame, such as [0, 0, 0] for its origin"
            refuse(text, *place, "point")


class PlaceSpec(LinkPlaceSpec):
    """A place on a link, or a frame.

    Attributes:
        point: In the link's frame [m]; None for a frame's origin.
    """

    @model_validator(mode="after")
    def _check_point(self) -> Self:
        self.check_point()
        return self


class AnchorSpec(PlaceSpec):
    """Side of a closure: a place on a link, or a frame.

    Attributes:
        frame: Or a frame of the URDF, by its link or joint: origin and z axis, or the joint's own axis.
        axis: Direction of the closure's axis in the link's frame, of any length.
        across: Direction that both sides have across the axis, for kinds that hold its turn; left out if
            ``axis`` alone makes axes parallel.
    """

    axis: Direction | None = None
    across: Direction | None = None


class ClosureSpec(Spec):
    """A joint that closes a loop between two links, held by constraint.

    Attributes:
        kind: What it is. Of the universal one the two axes stay at right angles, of others that have one they
            stay parallel; a planar one's axis is the normal of its plane.
        first: One side; its forces are given in axes of this side's frame, z along the axis.
        second: The other side; its forces are those on this side's link.
    """

    kind: ClosureKind
    first: AnchorSpec = Field(...)
    second: AnchorSpec = Field(...)

    @model_validator(mode="after")
    def _check_sides(self) -> Self:
        for name in ("first", "second"):
            side = getattr(self, name)
            if self.kind not in _POINTS and side.link is not None and side.axis is None:
                refuse(f"is missing; a {self.kind} closure has an axis on each side", name, "axis")
        if (self.first.across is None) != (self.second.across is None):
            missing = "first" if self.first.across is None else "second"
            refuse("must be given on both sides, or on neither", missing, "across")
        for key in ("link", "frame"):
            name = getattr(self.first, key)
            if name is not None and name == getattr(self.second, key):
                refuse(f"must be on another link than first, got {name!r}", "second", key)
        return self


# --- couplings ----------------------------------------------------------------------------------------------


_RATIOS = ("1", "m/rad", "rad/m")


class CouplingSpec(JointTable):
    """A joint held to a multiple of another's position, or of two others'.

    Attributes:
        kind: Which of the tables it is.
        follower: Name of the joint that follows.
        leader: Name of the joint that it follows.
        multiplier: Angle or way of the follower for one of the leader, negative the other way [-].
        offset: The follower's position where those of the leaders are zero [rad] ([m]).
        second: Name of a second joint that it follows, times its own multiplier.
        second_multiplier: Angle or way of the follower for one of the second joint, in SI units [-].
        conversion: What the unit of the multiplier says; None if it came without one.
    """

    # The key of each joint, by the name that it has in a coupling.
    roles: ClassVar[Mapping[str, str]] = {"follower": "follower", "leader": "leader", "second": "second"}

    kind: Literal["ratio"] = "ratio"
    follower: str
    leader: str
    multiplier: Annotated[float, QuantityRule(_RATIOS)] = 1.0
    offset: Annotated[float, QuantityRule(("rad", "m"))] = 0.0
    second: str | None = None
    second_multiplier: Annotated[float, QuantityRule("1")] = 1.0
    conversion: Literal["m/rad", "rad/m"] | None = None

    @model_validator(mode="before")
    @classmethod
    def _read_conversion(cls, data: Any) -> Any:
        unit = matching_unit(data.get("multiplier"), _RATIOS[1:]) if isinstance(data, Mapping) else None
        return data if unit is None else {**data, "conversion": unit}

    @model_validator(mode="after")
    def _check_joints(self) -> Self:
        if self.leader == self.follower:
            refuse(f"must be another joint than the follower, got {self.leader!r}", "leader")
        if self.second in (self.follower, self.leader):
            refuse(f"must be a third joint, got {self.second!r}", "second")
        return self


class DifferentialSpec(Spec):
    """A differential: its carrier turns by the mean of what its two sides turn by.

    Attributes:
        kind: Which of the tables it is.
        carrier: Name of the joint of the carrier.
        first: Name of the joint of one side.
        second: Name of the joint of the other side.
    """

    roles: ClassVar[Mapping[str, str]] = {"follower": "carrier", "leader": "first", "second": "second"}

    kind: Literal["differential"]
    carrier: str
    first: str
    second: str


class PlanetarySpec(Spec):
    """A planetary gear, (1 + ratio) carrier = sun + ratio ring.

    Attributes:
        kind: Which of the tables it is.
        carrier: Name of the joint of the planets' carrier.
        sun: Name of the joint of the sun.
        ring: Name of the joint of the ring.
        ratio: Teeth of the ring over those of the sun, above 1.
    """

    roles: ClassVar[Mapping[str, str]] = {"follower": "carrier", "leader": "sun", "second": "ring"}

    kind: Literal["planetary"]
    carrier: str
    sun: str
    ring: str
    ratio: Annotated[float, QuantityRule("1")]


AnyCoupling = CouplingSpec | DifferentialSpec | PlanetarySpec
"""A coupling; ``kind`` says which class it is."""
