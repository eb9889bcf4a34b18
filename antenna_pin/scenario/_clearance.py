"""Base of the tables of joints with play: laws, and their checks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self, get_args

from pydantic import Field, model_validator

from antenna_pin.scenario.laws import (
    Family,
    LawChange,
    LawSpec,
    changed_law,
    check_values,
    declared_parameters,
    flat,
    laws,
    missing_parameters,
    read_change,
    read_law,
    title,
    unit_of,
)
from antenna_pin.scenario.spec import (
    Count,
    Length,
    PositiveLength,
    PositiveSpeed,
    QuantityRule,
    Spec,
    refuse,
)

Kind = Literal["radial", "axial"]
KINDS: tuple[Kind, ...] = get_args(Kind)


class Clearance(Spec):
    """Base of the models of a joint with play.

    Attributes:
        offset: Bearing centre along the joint's axis from the joint's origin [m].
        bearing_on: Link of the joint with the bearing; the other has the journal.
        geometry: Method for gaps: coal's distance queries or the closed form.
        load: One force per contact (``point``), or strips of the bore and sectors of the flanges
            (``distributed``).
        strips: Of the bore under distributed load, even [-].
        sectors: Of the loaded arc of each flange under distributed load [-].
        flange_modulus: Of the flanges' foundation under distributed load [N/m^3]; None for that of a rigid
            annular punch.
        approach_speed_floor: Least approach speed that a law sees [m/s].
        maximum_depth: A run that presses deeper ends [m]; None for a hundredth of the bearing's radius.
        journal_material: Name of a material; steel is assumed of both parts where neither they nor a law are
            given.
        bearing_material: Likewise.
        normal: Normal law of both kinds of contact; where no law is given lankarani-nikravesh with a
            restitution of 0.9 is assumed.
        radial: What is different at the bore.
        axial: What is different at the flanges.
        friction: Friction law of both kinds of contact.
    """

    # The kinds of contact that occur; whether the joint slides along its axis rather than turning about it.
    kinds: ClassVar[tuple[Kind, ...]] = ()
    slides: ClassVar[bool] = False

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...

    offset: Length = 0.0
    bearing_on: Literal["parent", "child"] = "parent"
    geometry: Literal["coal", "closed-form"] = "coal"
    load: Literal["point", "distributed"] = "point"
    strips: Annotated[int, Count(2, 1000, even=True)] = 16
    sectors: Annotated[int, Count(3, 1000)] = 16
    flange_modulus: Annotated[float, QuantityRule("N/m**3", "positive")] | None = None
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
        """Read the laws together, as units may depend on a sister table."""
        if not isinstance(data, Mapping):
            return data
        return dict(data) | _read_law_tables(data)

    @model_validator(mode="after")
    def _check_laws(self) -> Self:
        """Refuse laws that do not accept their parameters, and for contacts that occur incomplete ones."""
        for kind in KINDS:
            law, change = self.law(kind), self._change(kind)
            if law is None:
                if kind in self.kinds:
                    refuse("is missing; it names the law of the contact and its parameters", "normal")
                continue
            places = dict.fromkeys(change.parameters if change else (), kind)
            table = kind if change is not None and change.law is not None else "normal"
            _check_law(law, "normal", kind in self.kinds, table, places)
        _check_law(self.friction, "friction", bool(self.kinds), "friction", {})
        return self

    def _change(self, kind: Kind) -> LawChange | None:
        return self.radial if kind == "radial" else self.axial

    def law(self, kind: Kind) -> LawSpec | None:
        """Return the normal law of a kind of contact: common law with its changes."""
        return changed_law(self.normal, self._change(kind))

    @property
    def assumed(self) -> dict[str, float | str]:
        """Assumed values, by key: SI numbers, names."""
        return {}


def law_tables(joint: Clearance) -> dict[str, dict[str, Any]]:
    """Return a joint's normal laws as in a file, with dependent units resolved.

    So the stiffness of a law of one exponent is not taken for that of another, laid over it.
    """
    known = laws("normal")
    found = {}
    for place in ("normal", *KINDS):
        table: LawSpec | LawChange | None = getattr(joint, place)
        if table is None:
            continue
        common = joint.normal if joint.normal is not None else table
        law = table.law or common.law or ""
        outer = common.parameters if law == common.law else {}
        dissipation = table.dissipation or (common.dissipation if law == common.law else None)
        units = {
            name: unit_of(name, law, known, outer | table.parameters, dissipation)
            for name in table.parameters
        }
        found[place] = flat(table) | {name: f"{table.parameters[name]!r} {units[name]}" for name in units}
    return found


def _check_law(law: LawSpec, family: Family, complete: bool, table: str, places: Mapping[str, str]) -> None:
    """Refuse a law that rejects its parameters, or if ``complete`` lacks some."""
    known = laws(family)
    missing = missing_parameters(law, known)
    if missing and not complete:
        return
    for name in missing:
        takes = ", ".join(declared_parameters(law.law, known, law.dissipation))
        refuse(f"is missing; law {title(law)} takes {takes}", places.get(name, table), name)
    broken = check_values(law, family)
    if broken is not None:
        name, text = broken
        refuse(text, places.get(name, table), name)


def _read_law_tables(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the law tables of a joint, their parameters in SI units."""
    tables = {name: data[name] for name in ("normal", "radial", "axial", "friction") if name in data}
    families: tuple[Family, ...] = ("normal", "friction")
    for family in families:
        if isinstance(tables.get(family), Mapping | LawSpec):
            tables[family] = read_law(flat(tables[family]), laws(family), family)
    if tables.get("normal") is not None and not isinstance(tables["normal"], LawSpec):
        return tables  # refused for its normal law
    for kind in KINDS:
        if isinstance(tables.get(kind), Mapping | LawSpec | LawChange):
            tables[kind] = read_change(flat(tables[kind]), tables.get("normal"), kind)
    return tables
