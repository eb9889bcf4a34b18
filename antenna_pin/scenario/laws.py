"""Contact and friction laws of a scenario: names and parameters in SI units.

Names, parameters and units come from :mod:`antenna_pin.contact`, and so does what the parameters must be: a
law is built once to see that it accepts them.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field, model_serializer, model_validator

from antenna_pin.base.units import shown
from antenna_pin.errors import InvalidParameterError, nearest
from antenna_pin.scenario.spec import Spec, read_quantity, refuse, refuse_key, refuse_name

if TYPE_CHECKING:
    from antenna_pin.contact import Parameter

Family = Literal["normal", "friction"]

# What stands in for parameters that come from the joint, to see that a law accepts the others.
_STAND_INS = {"stiffness": 1.0, "length": 0.05, "bearing_radius": 0.01, "modulus": 1e11}
_STAND_IN_PLAY = 2e-4

# Parameters that follow from the materials of the pair.
_OF_MATERIALS = ("stiffness", "modulus")

_EXPONENT = re.compile(r"(?<=\*\*)[A-Za-z_]\w*")


class LawSpec(Spec):
    """A contact or friction law.

    ``LawSpec(law="hertz", parameters={"stiffness": 1e11})`` is what a file writes as
    ``law = "hertz"`` and ``stiffness = "1e11 N/m**1.5"`` in one table. Beside an elastic normal law a file
    may name a dissipation, whose parameters stand in the same table: ``dissipation = "flores"``,
    ``restitution = 0.9``.

    Attributes:
        law: Name in ``contact.NORMAL_LAWS`` or ``contact.FRICTION_LAWS``.
        dissipation: Name in ``contact.DISSIPATIONS``, of an elastic normal law.
        parameters: The parameters given, in SI units; what follows from the joint may be missing.
    """

    law: str
    dissipation: str | None = None
    parameters: dict[str, float] = Field(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _read_table(cls, data: Any) -> Any:
        if not isinstance(data, Mapping):
            return data
        table = _nested(data)
        if "law" in table and not table.keys() - {"law", "dissipation", "parameters"}:
            check_law_name(table["law"], [*laws("normal"), *laws("friction")], "law")
            known = laws("friction" if table["law"] in laws("friction") else "normal")
            dissipation = table.get("dissipation")
            check_dissipation(dissipation, table["law"], "dissipation")
            table["parameters"] = read_parameters(
                table["law"], known, table["parameters"], dissipation=dissipation
            )
        return table

    @model_serializer
    def _as_in_files(self) -> dict[str, Any]:
        return _names(self) | self.parameters


class LawChange(Spec):
    """Differences of one kind of contact, radial or axial, from the normal law of both.

    Attributes:
        law: Another law, which then takes nothing from the common one; None for the same law.
        dissipation: Another dissipation, of an elastic law; None for the same one.
        parameters: Parameters given, in SI units; those of the common law hold for the rest.
    """

    law: str | None = None
    dissipation: str | None = None
    parameters: dict[str, float] = Field(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _read_table(cls, data: Any) -> Any:
        return _nested(data) if isinstance(data, Mapping) else data

    @model_serializer
    def _as_in_files(self) -> dict[str, Any]:
        return _names(self) | self.parameters


def _names(spec: LawSpec | LawChange) -> dict[str, Any]:
    names = {"law": spec.law, "dissipation": spec.dissipation}
    return {key: name for key, name in names.items() if name is not None}


def laws(family: Family) -> Mapping[str, type[Any]]:
    """Return the laws of a family by name."""
    # Imported on first use: compiled laws take a quarter of a second, and listing scenarios needs none.
    from antenna_pin import contact

    return contact.NORMAL_LAWS if family == "normal" else contact.FRICTION_LAWS


def declared_parameters(
    law: str, known: Mapping[str, type[Any]], dissipation: str | None = None
) -> dict[str, Parameter]:
    """Return a law's declared parameters by name, with those of a dissipation."""
    from antenna_pin import contact

    own = contact.law_parameters(known[law])
    return own if dissipation is None else own | contact.law_parameters(contact.DISSIPATIONS[dissipation])


def check_dissipation(name: object, law: str, *location: str) -> None:
    """Refuse an unknown dissipation, and one beside a law with its own."""
    from antenna_pin import contact

    if name is None:
        return
    if law not in contact.NORMAL_LAWS:
        refuse_key(f"is unknown; law {law} is a friction law and has no dissipation", *location)
    if not isinstance(name, str):
        refuse(f"must be text, got {shown(name)}", *location, value=name)
    if name not in contact.DISSIPATIONS:
        refuse_name("dissipation", name, contact.DISSIPATIONS, *location)
    if not contact.is_elastic(law):
        elastic = ", ".join(law for law in contact.NORMAL_LAWS if contact.is_elastic(law))
        refuse(f"must be left out, for law {law} brings its own; elastic laws are {elastic}", *location)


def check_law_name(name: object, known: Collection[str], *location: str) -> None:
    """Refuse what is not the name of a known law."""
    if not isinstance(name, str):
        refuse(f"must be text, got {shown(name)}", *location, value=name)
    if name not in known:
        refuse_name("law", name, known, *location)


def read_parameters(
    law: str,
    known: Mapping[str, type[Any]],
    table: Mapping[str, Any],
    common: Mapping[str, float] | None = None,
    location: tuple[str, ...] = (),
    dissipation: str | None = None,
) -> dict[str, float]:
    """Return a table's parameters in SI units, or refuse the first wrong one."""
    declared = declared_parameters(law, known, dissipation)
    for name in table:
        if name not in declared:
            _refuse_parameter(title(law_spec(law, {}, dissipation)), declared, name, location)
    # A unit may depend on a pure number of the same table: N/m**exponent.
    values: dict[str, float] = {}
    for name in sorted(table, key=lambda name: bool(depends_on(declared[name].unit))):
        unit = unit_of(name, law, known, dict(common or {}) | values, dissipation)
        values[name] = read_quantity(table[name], unit, "", *location, name)
    return {name: values[name] for name in table}


def read_law(table: dict[str, Any], known: Mapping[str, type[Any]], place: str) -> LawSpec:
    """Return the law in a flat table."""
    if "law" not in table:
        refuse(f"is missing; give one of {', '.join(known)}", place, "law")
    law = table.pop("law")
    check_law_name(law, known, place, "law")
    dissipation = table.pop("dissipation", None)
    check_dissipation(dissipation, law, place, "dissipation")
    return law_spec(law, read_parameters(law, known, table, {}, (place,), dissipation), dissipation)


def read_change(table: dict[str, Any], normal: object, kind: str) -> LawChange:
    """Return what a flat table changes of the normal law.

    The units of its parameters may depend on others that only the normal law has. One that it takes over must
    not get another unit by what it changes.
    """
    known = laws("normal")
    other = table.pop("law", None)
    if other is not None:
        check_law_name(other, known, kind, "law")
    if not isinstance(normal, LawSpec) and other is None:
        refuse("is missing; there is no normal law to change", kind, "law")
    # The common law as far as this one shares it: not at all if it is another.
    same = normal if isinstance(normal, LawSpec) and other in (None, normal.law) else None
    law = same.law if same is not None else str(other)
    changed = table.pop("dissipation", None)
    check_dissipation(changed, law, kind, "dissipation")
    dissipation = same.dissipation if same is not None and changed is None else changed
    declared = declared_parameters(law, known, dissipation)
    shared = {} if same is None else same.parameters
    common = {key: value for key, value in shared.items() if key in declared}
    own = read_parameters(law, known, table, common, (kind,), dissipation)
    for name in common.keys() - own.keys():
        for base in depends_on(declared[name].unit):
            if base in own and own[base] != common.get(base, declared[base].default):
                refuse(f"is missing; another {base} changes the unit of the one in normal", kind, name)
    return LawChange.model_construct(law=other, dissipation=changed, parameters=own)


def law_spec(law: str, parameters: Mapping[str, float], dissipation: str | None = None) -> LawSpec:
    """Return a law whose parameters were read."""
    return LawSpec.model_construct(law=law, dissipation=dissipation, parameters=dict(parameters))


def changed_law(normal: LawSpec | None, change: LawChange | None) -> LawSpec | None:
    """Return the law of a kind of contact: common law with changes."""
    if change is None:
        return normal
    if normal is None or change.law not in (None, normal.law):
        return None if change.law is None else law_spec(change.law, change.parameters, change.dissipation)
    dissipation = normal.dissipation if change.dissipation is None else change.dissipation
    # Another dissipation may not know the parameters of the one that it takes the place of.
    declared = declared_parameters(normal.law, laws("normal"), dissipation)
    kept = {name: value for name, value in normal.parameters.items() if name in declared}
    return law_spec(normal.law, kept | change.parameters, dissipation)


def missing_parameters(law: LawSpec, known: Mapping[str, type[Any]]) -> list[str]:
    """Return a law's required parameters that neither table nor joint gives."""
    declared = declared_parameters(law.law, known, law.dissipation)
    return [
        name
        for name, parameter in declared.items()
        if parameter.required and name not in law.parameters and not parameter.from_joint
    ]


def needs_materials(law: LawSpec) -> str | None:
    """Return the parameter of a normal law that is left to the materials, or None."""
    declared = declared_parameters(law.law, laws("normal"), law.dissipation)
    left = [name for name in _OF_MATERIALS if name in declared and name not in law.parameters]
    return left[0] if left else None


def check_values(law: LawSpec, family: Family) -> tuple[str, str] | None:
    """Return the first parameter refused by a law, and the rule; else None."""
    from antenna_pin import contact

    known = laws(family)
    declared = declared_parameters(law.law, known, law.dissipation)
    stand_ins = _STAND_INS | {"journal_radius": _STAND_INS["bearing_radius"] - _STAND_IN_PLAY}
    if "journal_radius" in law.parameters:
        stand_ins["bearing_radius"] = law.parameters["journal_radius"] + _STAND_IN_PLAY
    elif "bearing_radius" in law.parameters:
        radius = law.parameters["bearing_radius"]
        stand_ins["journal_radius"] = radius - min(_STAND_IN_PLAY, 0.5 * radius)
    left = [name for name, p in declared.items() if p.from_joint and p.required]
    parameters = {name: stand_ins[name] for name in left} | law.parameters
    try:
        if family == "normal":
            contact.make_normal_law(law.law, parameters, law.dissipation)
        else:
            known[law.law](**parameters)
    except InvalidParameterError as error:
        # "LankaraniNikravesh: restitution must be in [0, 1], got 1.3": the parameter is in the place.
        text = str(error).partition(": ")[2]
        return error.parameter, text.removeprefix(f"{error.parameter} ")
    return None


def title(law: LawSpec) -> str:
    """Return a law's name, with that of the dissipation beside it."""
    return law.law if law.dissipation is None else f"{law.law} with {law.dissipation}"


def depends_on(unit: str) -> list[str]:
    """Return the parameters that a unit depends on: ``exponent`` for ``N/m**exponent``."""
    return _EXPONENT.findall(unit)


def unit_of(
    name: str,
    law: str,
    known: Mapping[str, type[Any]],
    values: Mapping[str, float],
    dissipation: str | None = None,
) -> str:
    """Return the unit of a parameter, which may depend on others: "N/m**1.5" for ``N/m**exponent``."""
    declared = declared_parameters(law, known, dissipation)

    def number(match: re.Match[str]) -> str:
        value = values.get(match.group(), declared[match.group()].default)
        return "1" if value is None else repr(float(value)).removesuffix(".0")

    return _EXPONENT.sub(number, declared[name].unit)


def flat(table: Mapping[str, Any] | LawSpec | LawChange) -> dict[str, Any]:
    """Return a law's table with name and parameters side by side."""
    if isinstance(table, LawSpec | LawChange):
        return table.model_dump()
    nested = _nested(table)
    inner = nested.pop("parameters")
    return nested | dict(inner) if isinstance(inner, Mapping) else dict(table)


def _nested(table: Mapping[str, Any]) -> dict[str, Any]:
    if isinstance(table.get("parameters"), Mapping):
        return dict(table)
    names = {name: table[name] for name in ("law", "dissipation") if name in table}
    return names | {"parameters": {name: value for name, value in table.items() if name not in names}}


def _refuse_parameter(
    law: str, declared: Mapping[str, Parameter], name: str, location: tuple[str, ...]
) -> None:
    guess = nearest(name, declared)
    hint = f"did you mean {guess}? " if guess else ""
    takes = ", ".join(declared) if declared else "no parameters"
    refuse_key(f"is unknown; {hint}law {law} takes {takes}", *location, name)
