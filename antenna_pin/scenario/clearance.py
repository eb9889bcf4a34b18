"""Joints with play: dimensions, laws, model, and assumptions.

The table of a joint whose parts touch follows from the class of its shape
(:mod:`antenna_pin.joints.geometry.registry`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self, cast, get_args

from pydantic import model_validator

from antenna_pin.base.readable import number, readable
from antenna_pin.errors import InvalidParameterError
from antenna_pin.joints.geometry.registry import MODELS, SHAPES
from antenna_pin.scenario._class_tables import Tables
from antenna_pin.scenario._clearance import Clearance, Kind
from antenna_pin.scenario._dimensions import check_plays, refuse_shape, solved, table_of
from antenna_pin.scenario.laws import LawSpec, needs_materials
from antenna_pin.scenario.spec import refuse

if TYPE_CHECKING:
    from antenna_pin.joints.geometry import ClearanceGeometry

#: The normal law where none is given, and the coefficient of restitution that it is asked for [-]: what the
#: literature on joints with play takes most often.
LAW, RESTITUTION = "lankarani-nikravesh", 0.9
#: What both parts are of, where neither a law nor a material is given.
MATERIAL = "steel"

Variant = Literal["free", "planar", "ideal"]
# Types that a joint may have in the URDF, by the purpose of its shape.
_URDF_TYPES = {
    "turn": ("revolute", "continuous"),
    "slide": ("prismatic",),
    None: ("revolute", "continuous", "floating"),
}


class IdealSpec(Clearance):
    """A joint modelled without play; dimensions and laws, if given, wait for another case.

    Attributes:
        model: ``ideal``, the joint as the URDF has it, or ``constraint``, the joint freed and held by
            constraint to what it is in the URDF; a floating one is held as a ball joint.
    """

    @property
    def variant(self) -> Variant:
        """Type that replaces the URDF's joint."""
        return "free" if self.model == "constraint" else "ideal"

    @property
    def urdf_types(self) -> tuple[str, ...]:
        """Types that the joint may have in the URDF."""
        return ("revolute", "continuous", "prismatic", *(("floating",) if self.model == "constraint" else ()))


class TouchingSpec(Clearance):
    """Base of the tables of joints whose journal touches the bearing.

    Attributes:
        model: Name of its shape.
    """

    # The class of its shape; the kinds of contact that occur; whether it slides.
    shape_class: ClassVar[type[Any]]

    @property
    def kind(self) -> str:
        """Kind of its shape, as in results."""
        return str(self.shape_class.kind)

    @property
    def kinds(self) -> tuple[Kind, ...]:  # type: ignore[override]
        """Kinds of contact that occur."""
        return ("radial", "axial") if "axial" in self.shape_class.look.contacts else ("radial",)

    @property
    def slides(self) -> bool:  # type: ignore[override]
        """Return whether the joint slides along its axis rather than turning about it."""
        return bool(self.shape_class.motion == "slide")

    @property
    def variant(self) -> Variant:
        """Type that replaces the URDF's joint."""
        return "planar" if self.shape_class.planar else "free"

    @property
    def urdf_types(self) -> tuple[str, ...]:
        """Types that the joint may have in the URDF."""
        return _URDF_TYPES[self.shape_class.motion]

    @property
    def radial_play(self) -> float:
        """C_r, whichever way it was given; of several across the axis the least [m]."""
        return min(self._plays(along=False))

    @property
    def axial_play(self) -> float:
        """C_a, however given; by default the radial play; NaN without flanges [m]."""
        return min(self._plays(along=True), default=math.nan)

    def _plays(self, *, along: bool) -> list[float]:
        keys = {play.key for play in self.shape_class.plays if play.along == along}
        return [play for key, play in solved(self).plays.items() if key in keys]

    def sizes(self) -> dict[str, float]:
        """Return the dimensions of its shape by the names that its class has for them."""
        return solved(self).sizes

    def shape(self) -> ClearanceGeometry:
        """Return the joint's shape."""
        shape: ClearanceGeometry = self.shape_class(**self.sizes())
        return shape

    def law(self, kind: Kind) -> LawSpec | None:
        """Return the assumed normal law of a kind of contact."""
        if self._says_no_law:
            return LawSpec(law=LAW, parameters={"restitution": RESTITUTION})
        return super().law(kind)

    @property
    def materials(self) -> tuple[str | None, str | None]:
        """Materials of bearing and journal."""
        if self.says_no_material:
            return MATERIAL, MATERIAL
        return self.bearing_material, self.journal_material

    @property
    def _says_no_law(self) -> bool:
        return self.normal is None and self.radial is None and self.axial is None

    @property
    def says_no_material(self) -> bool:
        """Return whether no key decides the stiffness; a given law has its own."""
        return self._says_no_law and self.bearing_material is None and self.journal_material is None

    @property
    def assumed(self) -> dict[str, float | str]:
        """Assumed values, by key: SI numbers, names."""
        found: dict[str, float | str] = {}
        if self._says_no_law:
            found["normal"] = LAW
        if self.says_no_material:
            found |= {"bearing_material": MATERIAL, "journal_material": MATERIAL}
        return found | {key: value for key, (value, _) in solved(self).assumed.items()}

    @property
    def radial_law(self) -> LawSpec:
        """Normal law at the bore, or of the only contacts: ``normal`` changed by ``radial``."""
        return cast(LawSpec, self.law("radial"))

    @property
    def axial_law(self) -> LawSpec:
        """Normal law at the flanges: ``normal`` changed by ``axial``."""
        return cast(LawSpec, self.law("axial"))

    @model_validator(mode="after")
    def _check_contact(self) -> Self:
        check_plays(self)
        try:
            shape: Any = self.shape()
        except InvalidParameterError as error:
            refuse_shape(self, error)
        if self.load == "distributed" and shape.patch_radius is None:
            rule = "must be point where the joint is not one of journal, bore and flanges"
            refuse(f"{rule}, got {self.load!r}", "load", value=self.load)
        left = needs_materials(self.radial_law)
        for name in ("journal_material", "bearing_material") if left and not self.says_no_material else ():
            if getattr(self, name) is None:
                refuse(f"is missing; it decides the {left}, or give normal.{left}", name)
        return self


ClearanceSpec = TouchingSpec | IdealSpec
"""A joint with play; ``model`` says which class it is."""

_IDEAL: Any = Literal["ideal", "constraint"]
_IDEALS: tuple[str, ...] = get_args(_IDEAL)


def _name_of(model: str) -> str:
    return "IdealClearance" if model in _IDEALS else f"{model.title().replace('-', '')}Clearance"


def _table(model: str) -> type[Any]:
    name = _name_of(model)
    if model == "constraint":
        return CLEARANCES["ideal"]
    if model == "ideal":
        table: type[Any] = table_of(name, IdealSpec, _IDEAL)
    else:
        table = table_of(name, TouchingSpec, Literal[model], SHAPES[MODELS[model]])
    return table


CLEARANCES = Tables((*MODELS, *_IDEALS), _table)
"""Joints with play by their ``model``."""


def __getattr__(name: str) -> Any:
    """Return a table's class by name: ``ContactClearance`` is that of ``contact``."""
    for model in CLEARANCES:
        if _name_of(model) == name:
            return CLEARANCES[model]
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def said_of_assumed(joints: Mapping[str, Clearance]) -> Iterator[str]:
    """Yield a line of assumptions for each joint with play, by name."""
    for name, joint in joints.items():
        if words := words_of_assumed(joint):
            yield f"{name}: assumed {words}; set keys of [clearance.{name}] to change this"


def words_of_assumed(joint: Clearance) -> str:
    """Return the assumptions about a joint with play as text; "" without any."""
    return ", ".join(_parts(joint))


def _parts(joint: Clearance) -> Iterator[str]:
    said = joint.assumed
    if "normal" in said:
        yield f"law {LAW} with restitution {number(RESTITUTION)}"
    if "journal_material" in said:
        yield f"{MATERIAL} on {MATERIAL}"
    if isinstance(joint, TouchingSpec):
        for value, words in solved(joint).assumed.values():
            yield words.format(readable(value, "m"))
