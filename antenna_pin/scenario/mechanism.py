"""Mechanism of a scenario: its URDF, changes of it, materials, and rotors of motors."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from antenna_pin.base.changes import JointChange, JointVariant, LinkChange, Rotor, ShapeChange
from antenna_pin.base.material import Material
from antenna_pin.scenario._class_tables import JointTable, MadeSpec, reads
from antenna_pin.scenario.spec import QuantityRule, Spec, Vector, Vector3


@reads(ShapeChange)
class ShapeSpec(MadeSpec):
    """Other dimensions of a named visual or collision shape of a link."""


@reads(LinkChange, shapes=dict[str, ShapeSpec])
class LinkSpec(MadeSpec):
    """Changes of a link; None leaves the URDF's value."""


@reads(JointChange)
class JointSpec(JointTable, MadeSpec):
    """Changes of a joint; None leaves the URDF's value.

    Attributes:
        kind: ``ideal`` as in the URDF, ``locked``, ``free`` in all six directions without contact, or
            ``planar``, free in the plane across its axis.
        regularisation_speed: Where its own Coulomb friction is 71 % of its limit [rad/s] ([m/s]); None for
            1e-3.
        sticks: Whether its own Coulomb friction holds what it sticks, as ``[frictions.NAME]``; if left out it
            does at a joint without play that no motion moves, unless ``regularisation_speed`` is given.
    """

    kind: JointVariant | None = None
    regularisation_speed: Annotated[float, QuantityRule(("rad/s", "m/s"), "positive")] | None = None
    sticks: bool | None = None


class MechanismSpec(Spec):
    """The mechanism: its URDF and what differs from it.

    Attributes:
        urdf: Path of the URDF, relative to the scenario's folder.
        base: Whether the root link floats freely or is fixed in the world; one called `world` must be fixed.
        gravity: In world axes [m/s^2].
        package_path: Folders of packages of ``package://``, relative to the scenario's; then come
            ROS_PACKAGE_PATH and the folders above the URDF.
        allow_impossible_inertia: Links whose inertia may break the triangle inequality without a word.
        strict: Whether a URDF is refused whose inertia no body can have, rather than taken with a warning.
        links: What differs in links, by name.
        joints: What differs in joints, by name.
    """

    urdf: str
    base: Literal["free", "fixed"] = "free"
    gravity: Annotated[Vector3, Vector("m/s**2")] = (0.0, 0.0, 0.0)
    package_path: tuple[str, ...] = ()
    allow_impossible_inertia: tuple[str, ...] = ()
    strict: bool = False
    links: dict[str, LinkSpec] = Field(default_factory=dict)
    joints: dict[str, JointSpec] = Field(default_factory=dict)


@reads(Material)
class MaterialSpec(MadeSpec):
    """An isotropic linear-elastic material."""


@reads(Rotor)
class RotorSpec(MadeSpec):
    """The rotor of a motor, geared to a joint."""
