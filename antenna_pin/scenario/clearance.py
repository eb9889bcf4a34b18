"""A joint with play: its dimensions, its laws, and how it is to be modelled."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from antenna_pin.scenario._base import Length, PositiveLength, PositiveSpeed, Quantity, Spec, refuse
from antenna_pin.scenario.laws import (
    Family,
    LawChange,
    LawSpec,
    check_law_name,
    check_values,
    declared_parameters,
    depends_on,
    flat,
    laws,
    missing_parameters,
    needs_materials,
    read_parameters,
)

__all__ = ["ClearanceSpec", "ContactClearance", "IdealClearance", "PlanarClearance"]

Kind = Literal["radial", "axial"]

RADIAL_PLAY = ("radial_clearance", "journal_radius")
AXIAL_PLAY = ("axial_clearance", "flange_distance")

_ORDER = (
    ("radial_clearance", "smaller than", "bearing_radius"),
    ("journal_radius", "smaller than", "bearing_radius"),
    ("bearing_outer_radius", "larger than", "bearing_radius"),
    ("flange_radius", "larger than", "bearing_radius"),
    ("flange_distance", "at least", "bearing_length"),
)
_HOLDS: dict[str, Callable[[float, float], bool]] = {
    "smaller than": operator.lt,
    "larger than": operator.gt,
    "at least": operator.ge,
}


class _Clearance(Spec):
    """What the models of a joint with play share.

    Attributes:
        bearing_radius: R_i, radius of the bore [m].
        radial_clearance: C_r = R_i - R_j, if not given by the journal's radius [m].
        journal_radius: R_j, if not given by the clearance [m].
        bearing_length: L_i [m].
        axial_clearance: C_a, play at each flange when centred, 0 or more, if not given by the flanges [m].
        flange_distance: L_j = L_i + 2 C_a, between the flanges' inner faces, if not given by C_a [m].
        bearing_outer_radius: R_io [m].
        flange_radius: R_f [m].
        offset: Bearing centre along the joint's axis from the joint's origin [m].
        geometry: What measures the gaps: coal's distance queries or the closed form.
        load: How contact is spread; one force per contact.
        approach_speed_floor: Least approach speed that a law sees [m/s].
        maximum_depth: A run that presses deeper ends [m]; None for a hundredth of the bearing's radius.
        journal_material: Name of a material.
        bearing_material: Name of a material.
        normal: Normal law of both kinds of contact.
        radial: What is different at the bore.
        axial: What is different at the flanges.
        friction: Friction law of both kinds of contact.
    """

    bearing_radius: PositiveLength | None = None
    radial_clearance: PositiveLength | None = None
    journal_radius: PositiveLength | None = None
    bearing_length: PositiveLength | None = None
    axial_clearance: Annotated[float, Quantity("m", "zero or more")] | None = None
    flange_distance: PositiveLength | None = None
    bearing_outer_radius: PositiveLength | None = None
    flange_radius: PositiveLength | None = None
    offset: Length = 0.0
    geometry: Literal["coal", "closed-form"] = "coal"
    load: Literal["point"] = "point"
    approach_speed_floor: PositiveSpeed = 1e-4
    maximum_depth: PositiveLength | None = None
    journal_material: str | None = None
    bearing_material: str | None = None
    normal: LawSpec | None = None
    radial: LawChange | None = None
    axial: LawChange | None = None
    friction: LawSpec = Field(default_factory=lambda: LawSpec(law="none"))

    @model_validator(mode="before")
    @classmethod
    def _read_laws(cls, data: Any) -> Any:
        """Read the laws together: the unit of a parameter may depend on one in a sister table."""
        if not isinstance(data, Mapping):
            return data
        return dict(data) | _read_law_tables(data)

    @model_validator(mode="after")
    def _check_dimensions(self) -> Self:
        for pair in (RADIAL_PLAY, AXIAL_PLAY):
            if all(getattr(self, name) is not None for name in pair):
                refuse(f"must have exactly one of {' and '.join(pair)}, got both")
        for name, rule, other in _ORDER:
            value, limit = getattr(self, name), getattr(self, other)
            if value is not None and limit is not None and not _HOLDS[rule](value, limit):
                refuse(f"must be {rule} {other} = {limit:g} m, got {value:g} m", name, value=value)
        return self


class IdealClearance(_Clearance):
    """A joint modelled without play; dimensions and laws, if given, wait for another case.

    Attributes:
        model: ``ideal``, a revolute joint, or ``constraint``, the same by constrained dynamics.
    """

    model: Literal["ideal", "constraint"]


class _Touching(_Clearance):
    """What the models share whose journal touches the bearing."""

    kinds: ClassVar[tuple[Kind, ...]]

    bearing_radius: PositiveLength

    @property
    def radial_play(self) -> float:
        """C_r = R_i - R_j, whichever way it was given [m]."""
        if self.radial_clearance is not None:
            return self.radial_clearance
        assert self.journal_radius is not None
        return self.bearing_radius - self.journal_radius

    @property
    def radial_law(self) -> LawSpec:
        """The normal law at the bore, with what ``radial`` changes."""
        return self._law("radial")

    def _law(self, kind: Kind) -> LawSpec:
        change = self.radial if kind == "radial" else self.axial
        if change is None or self.normal is None or change.law not in (None, self.normal.law):
            law = change if change is not None and change.law is not None else self.normal
            if law is None or law.law is None:
                refuse("is missing; it names the law of the contact and its parameters", "normal")
            return LawSpec.model_construct(law=law.law, parameters=dict(law.parameters))
        return LawSpec.model_construct(
            law=self.normal.law, parameters=self.normal.parameters | change.parameters
        )

    @model_validator(mode="after")
    def _check_contact(self) -> Self:
        self._check_play(RADIAL_PLAY)
        for kind in self.kinds:
            change = self.radial if kind == "radial" else self.axial
            own = () if change is None else tuple(change.parameters)
            table = (
                kind if change is not None and (self.normal is None or change.law is not None) else "normal"
            )
            self._check_law(self._law(kind), "normal", {name: kind for name in own}, table)
        self._check_law(self.friction, "friction", {}, "friction")
        if needs_materials(self.radial_law):
            for name in ("journal_material", "bearing_material"):
                if getattr(self, name) is None:
                    refuse("is missing; it decides the stiffness, or give normal.stiffness", name)
        return self

    def _check_play(self, pair: tuple[str, str]) -> None:
        if all(getattr(self, name) is None for name in pair):
            refuse(f"must have exactly one of {' and '.join(pair)}, got neither")

    def _check_law(self, law: LawSpec, family: Family, tables: Mapping[str, str], table: str) -> None:
        """Refuse a law that lacks parameters or does not accept them.

        Args:
            law: The law as it is used.
            family: Which laws it is one of.
            tables: Table in which a parameter stands, by parameter.
            table: Table of the parameters not named there.
        """
        known = laws(family)
        for name in missing_parameters(law.law, known, law.parameters):
            takes = ", ".join(declared_parameters(law.law, known))
            refuse(f"is missing; law {law.law} takes {takes}", table, name)
        broken = check_values(law.law, known, law.parameters)
        if broken is not None:
            name, text = broken
            refuse(text, tables.get(name, table), name)


class PlanarClearance(_Touching):
    """A joint with radial play that keeps its plane and its axis' direction: contact at the bore only."""

    kinds = ("radial",)

    model: Literal["planar"]


class ContactClearance(_Touching):
    """A joint held together by contact alone: bore and flanges, six degrees of freedom."""

    kinds = ("radial", "axial")

    model: Literal["contact"]
    bearing_length: PositiveLength
    bearing_outer_radius: PositiveLength
    flange_radius: PositiveLength

    @property
    def axial_play(self) -> float:
        """C_a = (L_j - L_i) / 2, whichever way it was given [m]."""
        if self.axial_clearance is not None:
            return self.axial_clearance
        assert self.flange_distance is not None
        return (self.flange_distance - self.bearing_length) / 2.0

    @property
    def axial_law(self) -> LawSpec:
        """The normal law at the flanges, with what ``axial`` changes."""
        return self._law("axial")

    @model_validator(mode="after")
    def _check_flanges(self) -> Self:
        self._check_play(AXIAL_PLAY)
        return self


ClearanceSpec = ContactClearance | PlanarClearance | IdealClearance
"""A joint with play; ``model`` says which class it is."""


def _read_law_tables(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the law tables of a joint, their parameters in SI units."""
    tables = {name: data[name] for name in ("normal", "radial", "axial", "friction") if name in data}
    families: tuple[Family, ...] = ("normal", "friction")
    for family in families:
        if isinstance(tables.get(family), Mapping | LawSpec):
            tables[family] = _read_law(flat(tables[family]), laws(family), family)
    for kind in ("radial", "axial"):
        if isinstance(tables.get(kind), Mapping | LawSpec | LawChange):
            tables[kind] = _read_change(flat(tables[kind]), tables.get("normal"), kind)
    return tables


def _read_law(table: dict[str, Any], known: Mapping[str, type[Any]], place: str) -> LawSpec:
    if "law" not in table:
        refuse(f"is missing; give one of {', '.join(known)}", place, "law")
    law = table.pop("law")
    check_law_name(law, known, place, "law")
    return LawSpec.model_construct(law=law, parameters=read_parameters(law, known, table, {}, (place,)))


def _read_change(table: dict[str, Any], normal: object, kind: str) -> LawChange:
    known = laws("normal")
    other = table.pop("law", None)
    if other is not None:
        check_law_name(other, known, kind, "law")
    if not isinstance(normal, LawSpec):
        if other is None:
            refuse("is missing; there is no normal law to change", kind, "law")
        return LawChange.model_construct(
            law=other, parameters=read_parameters(other, known, table, {}, (kind,))
        )
    law = normal.law if other is None else other
    common = normal.parameters if law == normal.law else {}
    own = read_parameters(law, known, table, common, (kind,))
    declared = declared_parameters(law, known)
    for name in common.keys() - own.keys():
        for base in depends_on(declared[name].unit):
            if base in own and own[base] != common.get(base, declared[base].default):
                refuse(f"is missing; another {base} changes the unit of the one in normal", kind, name)
    return LawChange.model_construct(law=other, parameters=own)
