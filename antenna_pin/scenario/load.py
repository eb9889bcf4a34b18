"""From a file to a Scenario: a case laid over the file, overrides over both, files read, all checked."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, NamedTuple, TypeVar

from pydantic import ValidationError

from antenna_pin.base.arguments import takes
from antenna_pin.base.units import shown
from antenna_pin.errors import AntennaPinError, ScenarioError, UnknownNameError, printable
from antenna_pin.scenario._explained import dotted, explained_line, located_lines
from antenna_pin.scenario._layers import (
    Source,
    built,
    check_drives,
    check_keys,
    from_layer,
    read_layer,
    stand_in,
)
from antenna_pin.scenario._modal_file import has_modal_file, modal_stand_in
from antenna_pin.scenario.drives import WITH_FILES, file_columns
from antenna_pin.scenario.merge import Overrides, merge
from antenna_pin.scenario.scenario import Scenario
from antenna_pin.scenario.shipped import find_scenario, read_toml

__all__ = ["load_scenario", "scenario_named"]

Named = TypeVar("Named")


class _Case(NamedTuple):
    """A named case: what it is, what it lays over the file, and the cases that it builds on."""

    description: str
    table: Mapping[str, Any]
    base: str | None = None
    below: tuple[tuple[str, Mapping[str, Any]], ...] = ()


@takes()
def load_scenario(
    name_or_path: str | os.PathLike[str], case: str | None = None, overrides: Overrides = ()
) -> Scenario:
    """Return a scenario, complete and checked.

    Args:
        name_or_path: Name of a shipped scenario, path of a scenario file, or of a folder with a
            ``scenario.toml``.
        case: Name of a case; the file's ``default_case`` if left out, or no case if it names none.
        overrides: Values set over those of the file and the case: ``{"integrator.rtol": 1e-9}``, or text as
            on the command line: ``["integrator.rtol=1e-9", "clearance.elevation.radial_clearance=0.1 mm"]``.

    Raises:
        ScenarioError: With one line that gives file, place, rule, the value seen and a way out.
        UnknownNameError: If a scenario, case, law or material of that name does not exist.
    """
    found = find_scenario(name_or_path)
    base = read_toml(found.path, found.label)
    cases, default = _take_cases(base, found.label)
    name = default if case is None else case
    for place, wanted in ((": default_case", default), ("", name)):
        if wanted is not None and wanted not in cases:
            raise UnknownNameError(found.label + place, "case", wanted, cases)
    chosen = _Case("", {}) if name is None else cases[name]
    layer, record = read_layer(overrides)
    carried = {
        "name": printable(found.name),
        "case": name,
        "description": chosen.description,
        "overrides": record,
        "folder": found.path.parent.resolve(),
    }
    source = Source(found.label, base, name, chosen.table, layer, below=chosen.below)
    check_drives(source.merged(), source)
    scenario = built(Scenario, carried, source)
    for other, one in cases.items():
        if other != name:
            note = f" (in case {other})"
            _check_case(Source(found.label, base, other, one.table, note=note, below=one.below), layer)
    return scenario


def scenario_named(model: Named | str | os.PathLike[str]) -> Named | Scenario:
    """Return what is run: a scenario by name or path in its default case, anything else as it is.

    Raises:
        ScenarioError: As :func:`load_scenario`.
        UnknownNameError: Likewise.
    """
    return load_scenario(model) if isinstance(model, str | os.PathLike) else model


def _take_cases(document: dict[str, Any], label: str) -> tuple[dict[str, _Case], str | None]:
    """Take the cases and the name of the default one out of a file's contents."""
    default, found = document.pop("default_case", None), document.pop("cases", {})
    if default is not None and not isinstance(default, str):
        raise ScenarioError(f"{label}: default_case must be text, got {shown(default)}")
    if not isinstance(found, Mapping):
        raise ScenarioError(f"{label}: cases must be a table, got {shown(found)}")
    cases = {}
    for name, table in found.items():
        place = f"{label}: {dotted(('cases', name))}"
        if not isinstance(table, Mapping):
            raise ScenarioError(f"{place} must be a table, got {shown(table)}")
        description = table.get("description", "")
        if not isinstance(description, str):
            raise ScenarioError(f"{place}.description must be text, got {shown(description)}")
        base = table.get("base")
        if base is not None and not isinstance(base, str):
            raise ScenarioError(f"{place}.base must be text, the name of a case, got {shown(base)}")
        own = {key: value for key, value in table.items() if key not in ("description", "base")}
        cases[name] = _Case(description, own, base)
    return {name: case._replace(below=_below(name, cases, label)) for name, case in cases.items()}, default


def _below(name: str, cases: Mapping[str, _Case], label: str) -> tuple[tuple[str, Mapping[str, Any]], ...]:
    """Return the cases that a case builds on, with what they lay over the file, the lowest first."""
    chain = [name]
    while (base := cases[chain[-1]].base) is not None:
        place = f"{label}: {dotted(('cases', chain[-1], 'base'))}"
        if base not in cases:
            raise UnknownNameError(place, "case", base, cases)
        if base in chain:
            circle = " - ".join([*chain, base])
            raise ScenarioError(f"{place} must be a case that does not build on this one, got {circle}")
        chain.append(base)
    return tuple((each, cases[each].table) for each in reversed(chain[1:]))


def _check_case(source: Source, overrides: Mapping[str, Any]) -> None:
    """Refuse what is wrong in a case that is not to be run; its files are not read.

    A file that overrides have to complete is no fault of the case.
    """
    problem = _problem_of_case(source, source.merged())
    if problem is not None and _problem_of_case(source, merge(source.merged(), overrides)) is not None:
        raise problem


def _problem_of_case(source: Source, data: dict[str, Any]) -> AntennaPinError | None:
    check_keys(Scenario, data, source)
    check_drives(data, source)
    for family in WITH_FILES:
        of_family = data.get(family)
        if isinstance(of_family, Mapping):
            data[family] = {
                name: table | stand_in(table, family)
                if file_columns(table, family) and "file" in table
                else table
                for name, table in of_family.items()
            }
    flexible = data.get("flexible")
    if isinstance(flexible, Mapping):
        data["flexible"] = {
            name: table | modal_stand_in() if has_modal_file(table) else table
            for name, table in flexible.items()
        }
    try:
        Scenario.validated(data | {"urdf_text": ""})
    except ValidationError as error:
        for line in located_lines(error):
            if from_layer(source.case_table, line[0]):
                return explained_line(line, source.place)
    return None
