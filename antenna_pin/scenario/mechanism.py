"""The mechanism of a scenario: its URDF, what differs from it, and materials."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from antenna_pin.scenario._base import (
    Position,
    PositiveLength,
    Quantity,
    Rotation,
    Spec,
    Vector,
    Vector3,
    refuse,
)
from antenna_pin.units import shown

__all__ = ["JointSpec", "LinkSpec", "MaterialSpec", "MechanismSpec", "ShapeSpec"]


class ShapeSpec(Spec):
    """Other dimensions of a named visual or collision shape of a link.

    Attributes:
        radius: Of a cylinder or sphere [m].
        length: Of a cylinder [m].
        size: Of a box [m].
    """

    radius: PositiveLength | None = None
    length: PositiveLength | None = None
    size: Position | None = None

    @model_validator(mode="after")
    def _check_size(self) -> Self:
        if self.size is not None and not all(side > 0.0 for side in self.size):
            refuse(f"must be positive, got {shown(self.size)}", "size", value=self.size)
        return self


class LinkSpec(Spec):
    """What differs from the URDF in a link; None where nothing does.

    Attributes:
        mass: [kg].
        inertia: About the centre of mass, in the link's inertial axes: ixx, iyy, izz and, if six are given,
            ixy, ixz, iyz [kg*m^2].
        centre_of_mass: In the link's frame [m].
        shapes: Dimensions of its shapes, by name.
    """

    mass: Annotated[float, Quantity("kg", "positive")] | None = None
    inertia: Annotated[tuple[float, ...], Vector("kg*m**2", (3, 6))] | None = None
    centre_of_mass: Position | None = None
    shapes: dict[str, ShapeSpec] = Field(default_factory=dict)


class JointSpec(Spec):
    """What differs from the URDF in a joint; None where nothing does.

    Attributes:
        origin_xyz: Of the joint's frame in its parent link's [m].
        origin_rpy: Roll, pitch, yaw of the same [rad].
        axis: In the joint's frame, any length but zero [-].
        kind: ``ideal`` as in the URDF, ``locked``, ``free`` in all six directions without contact, or
            ``planar``, free in the plane across its axis.
    """

    origin_xyz: Position | None = None
    origin_rpy: Rotation | None = None
    axis: Annotated[Vector3, Vector("1")] | None = None
    kind: Literal["ideal", "locked", "free", "planar"] | None = None

    @model_validator(mode="after")
    def _check_axis(self) -> Self:
        if self.axis is not None and not any(self.axis):
            refuse(f"must not be zero, got {shown(self.axis)}", "axis", value=self.axis)
        return self


class MechanismSpec(Spec):
    """The mechanism: its URDF and what differs from it.

    Attributes:
        urdf: Path of the URDF, relative to the scenario's folder.
        base: Whether the root link floats freely or is fixed in the world.
        gravity: In world axes [m/s^2].
        allow_impossible_inertia: Links whose inertia may break the triangle inequality.
        links: What differs in links, by name.
        joints: What differs in joints, by name.
    """

    urdf: str
    base: Literal["free", "fixed"] = "free"
    gravity: Annotated[Vector3, Vector("m/s**2")] = (0.0, 0.0, 0.0)
    allow_impossible_inertia: tuple[str, ...] = ()
    links: dict[str, LinkSpec] = Field(default_factory=dict)
    joints: dict[str, JointSpec] = Field(default_factory=dict)


class MaterialSpec(Spec):
    """An isotropic linear-elastic material.

    Attributes:
        young: Young's modulus [Pa].
        poisson: Poisson's ratio [-].
        density: [kg/m^3]; None where not needed.
        source: Where the numbers come from.
    """

    young: Annotated[float, Quantity("Pa", "positive")]
    poisson: Annotated[float, Quantity("1", "above -1 and at most 0.5")]
    density: Annotated[float, Quantity("kg/m**3", "positive")] | None = None
    source: str = ""
