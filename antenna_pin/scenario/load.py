"""Scenarios from files with cases and overrides, and as text of a file."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from pydantic import ValidationError

from antenna_pin.base.arguments import takes
from antenna_pin.base.units import shown
from antenna_pin.errors import AntennaPinError, ScenarioError, UnknownNameError, printable
from antenna_pin.scenario._layers import (
    Source,
    built,
    check_files,
    check_keys,
    from_layer,
    read_layer,
    without_files,
)
from antenna_pin.scenario.drives import WITH_FILES
from antenna_pin.scenario.merge import Overrides, merge, toml_value
from antenna_pin.scenario.scenario import Scenario
from antenna_pin.scenario.shipped import find_scenario, read_toml
from antenna_pin.scenario.spec import dotted, explained_line, located_lines

Named = TypeVar("Named")

#: Cases without fault, by the texts of their files: studies load one file many times.
_SOUND: set[tuple[str, str]] = set()
_MOST_SOUND = 1000


class _Case(NamedTuple):
    """A case: description, values laid over the file, and base cases."""

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
    text = repr(base)
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
    check_files(source.merged(), source)
    scenario = built(Scenario, carried, source)
    for other, one in cases.items():
        if other != name and (text, other) not in _SOUND:
            note = f" (in case {other})"
            source = Source(found.label, base, other, one.table, note=note, below=one.below)
            if _is_sound(source, layer):
                _SOUND.add((text, other))
    if len(_SOUND) > _MOST_SOUND:
        _SOUND.clear()
    return scenario


def scenario_named(model: Named | str | os.PathLike[str]) -> Named | Scenario:
    """Return a scenario by name or path in its default case; others unchanged.

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
    """Return the base cases of a case with their tables, lowest first."""
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


def _is_sound(source: Source, overrides: Mapping[str, Any]) -> bool:
    """Return whether a case that is not run has no fault.

    Its files are not read. A file that overrides have to complete is no fault of the case.

    Raises:
        AntennaPinError: If the case has a fault also with the overrides.
    """
    problem = _problem_of_case(source, source.merged())
    if problem is not None and _problem_of_case(source, merge(source.merged(), overrides)) is not None:
        raise problem
    return problem is None


def _problem_of_case(source: Source, data: dict[str, Any]) -> AntennaPinError | None:
    check_keys(Scenario, data, source)
    check_files(data, source)
    try:
        Scenario.validated(without_files(data) | {"urdf_text": ""})
    except ValidationError as error:
        for line in located_lines(error):
            if from_layer(source.case_table, line[0]):
                return explained_line(line, source.place)
    return None


@takes()
def scenario_toml(scenario: Scenario) -> str:
    """Return a scenario as text of a file, with numbers in SI units.

    Everything that counts is written, defaults too; tables and an appendage's modes with their numbers
    instead of their file. Put beside the URDF that it names, it loads as the same scenario, without
    cases.
    """
    data = scenario.model_dump(mode="json", exclude_none=True, exclude=set(Scenario.carried))
    for one in (one for family in (*WITH_FILES, "flexible") for one in data.get(family, {}).values()):
        for key in ("file", "places", "reading"):
            one.pop(key, None)
    return "\n".join(_lines(data, ())).strip() + "\n"


def _lines(table: Mapping[str, Any], path: tuple[str, ...]) -> Iterator[str]:
    plain = {key: value for key, value in table.items() if not isinstance(value, Mapping)}
    if path and plain:
        yield f"\n[{dotted(path)}]"
    for key, value in plain.items():
        yield f"{dotted((key,))} = {toml_value(value)}"
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from _lines(value, (*path, key))


@takes()
def found_from(scenario: Scenario, folder: Path) -> Scenario:
    """Return a scenario with its files found from another folder, without links."""

    def there(name: str) -> str:
        path = (scenario.folder / name).resolve()
        return str(path.relative_to(folder)) if path.is_relative_to(folder) else str(path)

    mechanism = scenario.mechanism.model_copy(
        update={
            "urdf": there(scenario.mechanism.urdf),
            "package_path": tuple(there(name) for name in scenario.mechanism.package_path),
        }
    )
    return scenario.model_copy(update={"mechanism": mechanism, "folder": folder})
