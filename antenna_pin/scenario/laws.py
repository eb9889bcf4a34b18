"""Contact and friction laws as a scenario names them: a law's name and its parameters in SI units.

Names, parameters and units come from :mod:`antenna_pin.contact`, and so does what the parameters must be: a
law is built once to see that it accepts them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field, model_serializer, model_validator

from antenna_pin.errors import InvalidParameterError, nearest
from antenna_pin.scenario._base import Spec, read_quantity, refuse, refuse_key, refuse_name
from antenna_pin.units import shown

if TYPE_CHECKING:
    from antenna_pin.contact import Parameter

Family = Literal["normal", "friction"]

# A parameter that may be left out though the law needs it: it comes from the materials of the pair.
FROM_MATERIALS = "stiffness"

_EXPONENT = re.compile(r"(?<=\*\*)[A-Za-z_]\w*")


class LawSpec(Spec):
    """A contact or friction law.

    ``LawSpec(law="hertz", parameters={"stiffness": 1e11})`` is what a file writes as
    ``law = "hertz"`` and ``stiffness = "1e11 N/m**1.5"`` in one table.

    Attributes:
        law: Name in ``contact.NORMAL_LAWS`` or ``contact.FRICTION_LAWS``.
        parameters: The parameters given, in SI units; ``stiffness`` may be missing.
    """

    law: str
    parameters: dict[str, float] = Field(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _read_table(cls, data: Any) -> Any:
        if not isinstance(data, Mapping):
            return data
        table = _nested(data)
        if "law" in table and len(table) == 2:
            known = laws("normal") | laws("friction")
            check_law_name(table["law"], known, "law")
            table["parameters"] = read_parameters(table["law"], known, table["parameters"])
        return table

    @model_serializer
    def _as_in_files(self) -> dict[str, Any]:
        return {"law": self.law, **self.parameters}


class LawChange(Spec):
    """What one kind of contact, radial or axial, has different from the normal law of both.

    Attributes:
        law: Another law, which then takes nothing from the common one; None for the same law.
        parameters: Parameters given, in SI units; those of the common law hold for the rest.
    """

    law: str | None = None
    parameters: dict[str, float] = Field(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _read_table(cls, data: Any) -> Any:
        return _nested(data) if isinstance(data, Mapping) else data

    @model_serializer
    def _as_in_files(self) -> dict[str, Any]:
        return ({} if self.law is None else {"law": self.law}) | self.parameters


def laws(family: Family) -> dict[str, type[Any]]:
    """Return the laws of a family by name."""
    # Imported on first use: compiled laws take a quarter of a second, and listing scenarios needs none.
    from antenna_pin import contact

    return dict(contact.NORMAL_LAWS if family == "normal" else contact.FRICTION_LAWS)


def declared_parameters(law: str, known: Mapping[str, type[Any]]) -> dict[str, Parameter]:
    """Return the parameters that a law declares, by name."""
    from antenna_pin import contact

    return contact.law_parameters(known[law])


def check_law_name(name: object, known: Mapping[str, type[Any]], *location: str) -> None:
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
) -> dict[str, float]:
    """Return the parameters in a table in SI units, or refuse the first that is wrong.

    Args:
        law: Name of the law.
        known: The laws by name.
        table: The parameters as they were given.
        common: Parameters that hold where the table says nothing.
        location: Where the table stands.
    """
    declared = declared_parameters(law, known)
    for name in table:
        if name not in declared:
            _refuse_parameter(law, declared, name, location)
    # A unit may depend on a pure number of the same table: N/m**exponent.
    values: dict[str, float] = {}
    for name in sorted(table, key=lambda name: bool(depends_on(declared[name].unit))):
        unit = unit_of(name, law, known, dict(common or {}) | values)
        values[name] = read_quantity(table[name], unit, "", *location, name)
    return {name: values[name] for name in table}


def read_law(table: dict[str, Any], known: Mapping[str, type[Any]], place: str) -> LawSpec:
    """Return the law in a flat table."""
    if "law" not in table:
        refuse(f"is missing; give one of {', '.join(known)}", place, "law")
    law = table.pop("law")
    check_law_name(law, known, place, "law")
    return law_spec(law, read_parameters(law, known, table, {}, (place,)))


def read_change(table: dict[str, Any], normal: object, kind: str) -> LawChange:
    """Return what a flat table changes of the normal law.

    The units of its parameters may depend on others that only the normal law has. One that it takes over must
    not get another unit by what it changes.
    """
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


def law_spec(law: str, parameters: Mapping[str, float]) -> LawSpec:
    """Return a law whose parameters were read."""
    return LawSpec.model_construct(law=law, parameters=dict(parameters))


def missing_parameters(law: str, known: Mapping[str, type[Any]], given: Mapping[str, float]) -> list[str]:
    """Return the names of the parameters that a law needs and that were not given."""
    declared = declared_parameters(law, known)
    return [
        name
        for name, parameter in declared.items()
        if parameter.required and name not in given and name != FROM_MATERIALS
    ]


def needs_materials(law: LawSpec) -> bool:
    """Return whether the stiffness of a normal law is left to the materials."""
    declared = declared_parameters(law.law, laws("normal"))
    return FROM_MATERIALS in declared and FROM_MATERIALS not in law.parameters


def check_values(
    law: str, known: Mapping[str, type[Any]], parameters: Mapping[str, float]
) -> tuple[str, str] | None:
    """Return the first parameter that the law itself refuses and the rule it breaks, or None.

    The parameters must be complete but for the stiffness.
    """
    stand_in = {FROM_MATERIALS: 1.0} if FROM_MATERIALS in declared_parameters(law, known) else {}
    try:
        known[law](**(stand_in | dict(parameters)))
    except InvalidParameterError as error:
        # "LankaraniNikravesh: restitution must be in [0, 1], got 1.3": the parameter is in the place.
        text = str(error).partition(": ")[2]
        return error.parameter, text.removeprefix(f"{error.parameter} ")
    return None


def depends_on(unit: str) -> list[str]:
    """Return the parameters that a unit depends on: ``exponent`` for ``N/m**exponent``."""
    return _EXPONENT.findall(unit)


def unit_of(name: str, law: str, known: Mapping[str, type[Any]], values: Mapping[str, float]) -> str:
    """Return the unit of a parameter, which may depend on others: "N/m**1.5" for ``N/m**exponent``."""
    declared = declared_parameters(law, known)

    def number(match: re.Match[str]) -> str:
        value = values.get(match.group(), declared[match.group()].default)
        return "1" if value is None else repr(float(value)).removesuffix(".0")

    return _EXPONENT.sub(number, declared[name].unit)


def flat(table: Mapping[str, Any] | LawSpec | LawChange) -> dict[str, Any]:
    """Return a law's table as a file has it: the name of the law and its parameters side by side."""
    if isinstance(table, LawSpec | LawChange):
        return table.model_dump()
    nested = _nested(table)
    inner = nested.pop("parameters")
    return nested | dict(inner) if isinstance(inner, Mapping) else dict(table)


def _nested(table: Mapping[str, Any]) -> dict[str, Any]:
    if isinstance(table.get("parameters"), Mapping):
        return dict(table)
    rest = {name: value for name, value in table.items() if name != "law"}
    return ({"law": table["law"]} if "law" in table else {}) | {"parameters": rest}


def _refuse_parameter(
    law: str, declared: Mapping[str, Parameter], name: str, location: tuple[str, ...]
) -> None:
    guess = nearest(name, declared)
    hint = f"did you mean {guess}? " if guess else ""
    takes = ", ".join(declared) if declared else "no parameters"
    refuse_key(f"is unknown; {hint}law {law} takes {takes}", *location, name)
