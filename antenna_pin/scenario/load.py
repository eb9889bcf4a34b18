"""From a file to a Scenario: a case laid over the file, overrides over both, files read, all checked."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import ValidationError

from antenna_pin.errors import AntennaPinError, ScenarioError, UnknownNameError, nearest
from antenna_pin.scenario._base import (
    Location,
    Place,
    dotted,
    explained,
    explained_line,
    located_lines,
    unknown_key,
)
from antenna_pin.scenario.clearance import law_tables
from antenna_pin.scenario.merge import Overrides, merge, read_overrides
from antenna_pin.scenario.scenario import Scenario
from antenna_pin.scenario.shipped import find_scenario, read_toml, tables
from antenna_pin.scenario.torque_table import BadTableError, read_torque_table
from antenna_pin.units import shown

__all__ = ["load_scenario"]


# The least that a table drive needs, in place of a file that is not to be read.
_STAND_IN = {"time": (0.0, 1.0), "torque": (0.0, 0.0)}


class _Case(NamedTuple):
    """A named case: what it is, and what it lays over the file."""

    description: str
    table: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class _Source:
    """Where the values come from: a file, a case laid over it, and overrides laid over both.

    Attributes:
        label: How messages call the file.
        base: The file without its cases.
        case: Name of the case, or None.
        case_table: What the case lays over the file.
        overrides: What is laid over both.
        note: What is to be said after a message about a value of the file.
    """

    label: str
    base: Mapping[str, Any]
    case: str | None = None
    case_table: Mapping[str, Any] = field(default_factory=dict)
    overrides: Mapping[str, Any] = field(default_factory=dict)
    note: str = ""

    def merged(self) -> dict[str, Any]:
        """Return the layers as one."""
        return merge(merge(self.base, self.case_table), self.overrides)

    def place(self, location: Location) -> Place:
        """Return where a value stands, or is missing: in the file, in its case, or in an override."""
        if _from_layer(self.overrides, location, self.base, self.case_table):
            return Place(f"{self.label}: {dotted(location)}", " (set by an override)")
        if self.case is not None and _from_layer(self.case_table, location, self.base):
            return Place(f"{self.label}: {dotted(('cases', self.case, *location))}")
        if not location:
            return Place(f"{self.label}:", self.note)
        return Place(f"{self.label}: {dotted(location)}", self.note, self._stale(location[:-1]))

    def _stale(self, table: Location) -> str:
        """Say why a key of the file may have become unknown: what is laid over it has changed the kind."""
        for layer, values in (("an override", self.overrides), (f"case {self.case}", self.case_table)):
            for key in ("kind", "law"):
                if _holds(values, (*table, key)):
                    return f" ({layer} sets {key}: with replace = true beside it, the old keys go)"
        return ""

    def error(self, text: str, *location: str) -> ScenarioError:
        """Return the error about a value."""
        where, note, _ = self.place(location)
        return ScenarioError(f"{where} {text}{note}")


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
    layer, record = _read_layer(overrides)
    carried = {
        "name": found.name,
        "case": name,
        "description": chosen.description,
        "overrides": record,
        "folder": found.path.parent.resolve(),
    }
    source = _Source(found.label, base, name, chosen.table, layer)
    _check_drives(source.merged().get("drives"), source)
    scenario = _build(carried, source)
    for other, (_, table) in cases.items():
        if other != name:
            _check_case(_Source(found.label, base, other, table, note=f" (in case {other})"), layer)
    return scenario


def override_scenario(scenario: Scenario, overrides: Overrides) -> Scenario:
    """Return a scenario with some values replaced; files are read only where another file is named."""
    layer, record = _read_layer(overrides)
    data = scenario.model_dump(exclude_none=True)
    carried = {name: data.pop(name, None) for name in Scenario.carried}
    carried["overrides"] = (*scenario.overrides, *record)
    if "urdf" in tables(layer.get("mechanism")):
        del carried["urdf_text"]
    for joint, clearance in scenario.clearance.items():
        data["clearance"][joint].update(law_tables(clearance))
    # What old units said of a joint's motion does not bind new values.
    joints = tables(layer.get("initial")).get("joints")
    for below, above in (
        (data["drives"], layer.get("drives")),
        (data["springs"], layer.get("springs")),
        (data["initial"]["joints"], joints),
    ):
        for name in tables(above).keys() & below.keys():
            below[name].pop("motion", None)
    source = _Source(f"scenario {scenario.name}".strip(), data, overrides=layer)
    _check_drives(layer.get("drives"), source)
    return _build(carried, source)


def _read_layer(overrides: Overrides) -> tuple[dict[str, Any], tuple[str, ...]]:
    layer, record = read_overrides(overrides)
    for key in ("cases", "default_case"):
        if key in layer:
            raise ScenarioError(f"override {key}: choose a case, and set its values without {key}")
    return layer, record


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
        cases[name] = _Case(description, {key: value for key, value in table.items() if key != "description"})
    return cases, default


def _build(carried: dict[str, Any], source: _Source) -> Scenario:
    """Return the scenario of all layers, with the files it names."""
    data = source.merged()
    _check_keys(data, source)
    folder = Path(carried["folder"])
    drives = data.get("drives")
    if isinstance(drives, Mapping):
        data = data | {"drives": {name: _with_table(name, drives[name], folder, source) for name in drives}}
    urdf = tables(data.get("mechanism")).get("urdf")
    if "urdf_text" not in carried:  # a mechanism without is refused for that
        text = _read_file(urdf, folder, source, "mechanism", "urdf") if isinstance(urdf, str) else ""
        data = data | {"urdf_text": text}
    try:
        return Scenario.validated(data | carried)
    except ValidationError as error:
        raise explained(error, source.place) from None


def _check_case(source: _Source, overrides: Mapping[str, Any]) -> None:
    """Refuse what is wrong in a case that is not to be run; its files are not read.

    A file that overrides have to complete is no fault of the case.
    """
    problem = _problem_of_case(source, source.merged())
    if problem is not None and _problem_of_case(source, merge(source.merged(), overrides)) is not None:
        raise problem


def _problem_of_case(source: _Source, data: dict[str, Any]) -> AntennaPinError | None:
    _check_keys(data, source)
    drives = data.get("drives")
    _check_drives(drives, source)
    if isinstance(drives, Mapping):
        data["drives"] = {
            name: table | _STAND_IN if _is_table_drive(table) and "file" in table else table
            for name, table in drives.items()
        }
    try:
        Scenario.validated(data | {"urdf_text": ""})
    except ValidationError as error:
        for line in located_lines(error):
            if _from_layer(source.case_table, line[0]):
                return explained_line(line, source.place)
    return None


def _check_keys(data: Mapping[str, Any], source: _Source) -> None:
    known = [name for name in Scenario.model_fields if name not in Scenario.carried]
    for key in Scenario.carried & data.keys():
        raise source.error(unknown_key([*known, "default_case", "cases"], key), key)


def _check_drives(drives: object, source: _Source) -> None:
    for name, table in tables(drives).items():
        if "file" in tables(table) and table.keys() & _STAND_IN.keys():
            raise source.error("must have either file, or time and torque, got both", "drives", name)


def _is_table_drive(table: object) -> bool:
    return isinstance(table, Mapping) and table.get("kind") == "table"


def _with_table(name: str, table: Any, folder: Path, source: _Source) -> Any:
    """Return a drive with the numbers of the file it names, if it names one and has none."""
    if not _is_table_drive(table) or "file" not in table or table.keys() & _STAND_IN.keys():
        return table
    if not isinstance(table["file"], str):
        return table | _STAND_IN  # refused for its file
    place = ("drives", name, "file")
    text = _read_file(table["file"], folder, source, *place)
    try:
        time, torque = read_torque_table(text)
    except BadTableError as problem:
        where, note, _ = source.place(place)
        raise ScenarioError(f"{where}: {table['file']}, {problem}{note}") from None
    return table | {"time": time, "torque": torque}


def _read_file(name: str, folder: Path, source: _Source, *location: str) -> str:
    """Return the text of a file that the scenario names."""
    path = folder / os.path.expanduser(name)
    if not os.path.isfile(path):
        around = path.parent
        names = [other.name for other in around.glob(f"*{path.suffix}")] if around.is_dir() else []
        guess = nearest(path.name, names)
        hint = f"did you mean {guess}?" if guess else f"it is looked for in {around}"
        raise source.error(f"must be an existing file, got {shown(name)}; {hint}", *location)
    try:
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        problem = f"must be UTF-8 text, got {shown(name)} (byte {error.start})"
    except OSError as error:
        problem = f"must be readable, got {shown(name)} ({error.strerror})"
    raise source.error(problem, *location)


def _from_layer(layer: Mapping[str, Any], location: Location, *below: Mapping[str, Any]) -> bool:
    """Return whether a value is given in a layer, or is missing in a table that only this layer has."""
    outer = location[:-1]
    if _holds(layer, location):
        return True
    return _holds(layer, outer) and not any(_holds(table, outer) for table in below)


def _holds(tree: Mapping[str, Any], location: Location) -> bool:
    """Return whether a table has the value at a location."""
    table: Any = tree
    for key in location:
        if isinstance(table, list):
            return True
        if not isinstance(table, Mapping) or key not in table:
            return False
        table = table[key]
    return bool(location)
