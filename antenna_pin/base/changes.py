"""Changes of a URDF by a scenario: bodies, their shapes, places of the joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, get_args

from antenna_pin.base.directions import A_DIRECTION
from antenna_pin.base.parameters import check, parameter
from antenna_pin.errors import InvalidParameterError

JointVariant = Literal["ideal", "locked", "free", "planar"]
"""What becomes of a joint: as in the URDF, no freedom, all six, the three of a plane across its axis."""

JOINT_VARIANTS: tuple[JointVariant, ...] = get_args(JointVariant)


@dataclass(frozen=True, slots=True, kw_only=True)
class ShapeChange:
    """Other dimensions of a named shape of a link, without effect on inertia.

    Attributes:
        radius: Of a cylinder or sphere [m].
        length: Of a cylinder [m].
        size: Of a box along its own x, y and z [m].
    """

    radius: float | None = parameter("m", rule="positive", default=None)
    length: float | None = parameter("m", rule="positive", default=None)
    size: tuple[float, ...] | None = parameter("m", rule="positive", sizes=(3,), default=None)

    def __post_init__(self) -> None:
        """Refuse what is not a dimension."""
        check(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkChange:
    """Changes of a link; None leaves the URDF's value.

    Each number stands for itself: a new mass does not scale the inertia.

    Attributes:
        mass: [kg].
        inertia: About the mass centre, in the axes of the URDF's inertial frame: ixx, iyy, izz, and ixy, ixz,
            iyz if six are given [kg*m^2].
        centre_of_mass: In the link's frame [m].
        shapes: Dimensions of its shapes, by the name of the ``<visual>`` and ``<collision>`` elements.
    """

    mass: float | None = parameter("kg", rule="zero or more", default=None)
    inertia: tuple[float, ...] | None = parameter("kg*m**2", sizes=(3, 6), default=None)
    centre_of_mass: tuple[float, ...] | None = parameter("m", sizes=(3,), default=None)
    shapes: Mapping[str, ShapeChange] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Refuse what is no inertial property; the triangle rule is the mechanism's to check."""
        check(self)
        object.__setattr__(self, "shapes", dict(self.shapes))


@dataclass(frozen=True, slots=True, kw_only=True)
class JointChange:
    """Changes of a joint: place, axis, bounds, ``<dynamics>``, ``<mimic>``; None leaves the URDF's value.

    Attributes:
        origin_xyz: Of the joint's frame in its parent link's [m].
        origin_rpy: Roll, pitch, yaw of the same [rad].
        axis: In the joint's frame, any length but zero [-].
        lower: Lower bound of a revolute or prismatic joint [rad] ([m]).
        upper: Upper bound of the same [rad] ([m]).
        damping: Of the joint itself, viscous [N*m*s/rad] ([N*s/m]).
        friction: Of the joint itself, Coulomb's [N*m] ([N]).
        mimic: False takes its ``<mimic>`` out, so that it follows no other joint.
    """

    origin_xyz: tuple[float, ...] | None = parameter("m", sizes=(3,), default=None)
    origin_rpy: tuple[float, ...] | None = parameter("rad", sizes=(3,), default=None)
    axis: tuple[float, ...] | None = parameter("1", rule=A_DIRECTION, sizes=(3,), default=None)
    lower: float | None = parameter("rad", sliding="m", default=None)
    upper: float | None = parameter("rad", sliding="m", default=None)
    damping: float | None = parameter("N*m*s/rad", sliding="N*s/m", rule="zero or more", default=None)
    friction: float | None = parameter("N*m", sliding="N", rule="zero or more", default=None)
    mimic: bool | None = None

    def __post_init__(self) -> None:
        """Refuse what is no place and no direction."""
        check(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class Rotor:
    """The rotor of a motor, geared to a joint: exact body, or plain armature.

    Exactly it is a body on the joint's axis: what carries it takes its reaction, and its spin bends with it.
    As armature the joint's rate alone feels :math:`r^2 J`: nothing reacts on the carrier, there is no
    gyroscopic torque, and of a free base the momentum that is kept is that without the rotor's. Both are
    one on a base that stands still.

    Its mass, and its inertia across the axis, are those of the link that carries it, in the URDF. The moment
    about the axis is the rotor's alone: the link's must not have it once more.

    Attributes:
        joint: Name of the joint, revolute or continuous, without play.
        kind: A body geared to the joint (``exact``), or ``armature`` that its rate alone feels.
        inertia: Moment of inertia about the axis [kg*m^2].
        ratio: Turns of the rotor on its carrier for one of the joint; negative the other way round.
        carrier: Which of the joint's links carries the motor; of armature the parent only.
    """

    joint: str
    kind: Literal["exact", "armature"] = "exact"
    inertia: float = parameter("kg*m^2", rule="positive")
    ratio: float = parameter("1", default=1.0)
    carrier: Literal["parent", "child"] = "parent"

    def __post_init__(self) -> None:
        """Check the numbers, and that armature is where it can be."""
        check(self)
        if self.kind == "armature" and self.carrier != "parent":
            raise InvalidParameterError(self, "carrier", "parent for armature", self.carrier)
