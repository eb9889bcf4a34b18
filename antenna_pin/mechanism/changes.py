"""What a scenario may change in a URDF: bodies, their shapes, and where the joints sit."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from antenna_pin.errors import InvalidParameterError

__all__ = ["JOINT_VARIANTS", "JointChange", "JointVariant", "LinkChange", "ShapeChange"]

JointVariant = Literal["ideal", "free", "locked", "planar"]
"""What becomes of a joint: as in the URDF, all six freedoms, none, the three of a plane across its axis."""

JOINT_VARIANTS: tuple[JointVariant, ...] = ("ideal", "free", "locked", "planar")


def _numbers(owner: object, name: str, lengths: tuple[int, ...], positive: bool = False) -> None:
    """Check a field of several numbers and store it as a tuple of floats."""
    value: Any = getattr(owner, name)
    if value is None:
        return
    kind = "positive" if positive else "finite"
    rule = f"{' or '.join(str(n) for n in lengths)} {kind} numbers"
    try:
        numbers = tuple(float(number) for number in value)
    except (TypeError, ValueError):
        raise InvalidParameterError(owner, name, rule, value) from None
    if len(numbers) not in lengths or not all(
        math.isfinite(n) and (n > 0.0 or not positive) for n in numbers
    ):
        raise InvalidParameterError(owner, name, rule, value)
    object.__setattr__(owner, name, numbers)


def _positive(owner: object, names: Iterable[str]) -> None:
    """Check fields of one positive number each, where given."""
    for name in names:
        value: Any = getattr(owner, name)
        if value is not None and not (isinstance(value, (int, float)) and 0.0 < value < math.inf):
            raise InvalidParameterError(owner, name, "positive and finite", value)


@dataclass(frozen=True, slots=True, kw_only=True)
class ShapeChange:
    """New dimensions of a named visual or collision shape. Looks only: no inertia follows from a shape.

    Attributes:
        radius: Of a cylinder or a sphere [m].
        length: Of a cylinder [m].
        size: Of a box along its own x, y and z [m].
    """

    radius: float | None = None
    length: float | None = None
    size: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        """Refuse what is not a dimension."""
        _positive(self, ("radius", "length"))
        _numbers(self, "size", (3,), positive=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkChange:
    """New inertial properties and shapes of a link; what is left out stays as it is.

    Each number stands for itself: a new mass does not scale the inertia.

    Attributes:
        mass: [kg].
        inertia: ``ixx, iyy, izz`` or ``ixx, iyy, izz, ixy, ixz, iyz`` about the centre of mass [kg m^2], in
            the axes of the URDF's inertial frame (those of the link where its ``rpy`` is zero); three numbers
            set the products to zero.
        centre_of_mass: (3,) in the link frame [m].
        shapes: New dimensions by the name of the ``<visual>`` and ``<collision>`` elements that take them.
    """

    mass: float | None = None
    inertia: tuple[float, ...] | None = None
    centre_of_mass: tuple[float, ...] | None = None
    shapes: Mapping[str, ShapeChange] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Refuse what is no inertial property; the triangle rule is the mechanism's to check."""
        _positive(self, ("mass",))
        _numbers(self, "inertia", (3, 6))
        _numbers(self, "centre_of_mass", (3,))
        object.__setattr__(self, "shapes", dict(self.shapes))


@dataclass(frozen=True, slots=True, kw_only=True)
class JointChange:
    """New place and axis of a joint; what is left out stays as it is.

    Attributes:
        origin_xyz: (3,) of the joint in its parent link's frame [m].
        origin_rpy: Roll, pitch and yaw of the joint frame in its parent link's frame [rad].
        axis: (3,) in the joint frame [-]; only its direction counts.
    """

    origin_xyz: tuple[float, ...] | None = None
    origin_rpy: tuple[float, ...] | None = None
    axis: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        """Refuse what is no place and no direction."""
        for name in ("origin_xyz", "origin_rpy", "axis"):
            _numbers(self, name, (3,))
        if self.axis is not None and not any(self.axis):
            raise InvalidParameterError(self, "axis", "nonzero")
