"""Layers of a scenario: file, case, overrides."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from antenna_pin.base.files import absence, decoded, marked_encoding
from antenna_pin.base.tables import BadTableError, column_of, read_cells
from antenna_pin.base.units import shown
from antenna_pin.errors import FileFormatError, ScenarioError, nearest
from antenna_pin.scenario._class_tables import JOINTS, Motion, motion_of
from antenna_pin.scenario.drives import WITH_FILES, file_columns, file_units
from antenna_pin.scenario.merge import Overrides, merge, read_overrides
from antenna_pin.scenario.shipped import tables
from antenna_pin.scenario.spec import Location, Spec, ValuePlace, dotted, explained, unknown_key


def read_table(
    text: str, columns: Sequence[str], units: Sequence[str | tuple[str, ...]]
) -> tuple[tuple[tuple[float, ...], ...], Motion | None]:
    """Return columns of a table in SI units, of which the first increases.

    Returns:
        The numbers, and what the units in the text say of the joint's motion; None without any.

    Raises:
        BadTableError: It cannot be read so; with the line.
    """
    cells = read_cells(text, columns)
    numbers = tuple(column_of(cells, name, unit) for name, unit in zip(columns, units, strict=True))
    if len(cells.lines) < 2:
        last = max(cells.lines, default=cells.header)
        raise BadTableError(f"line {last}: must have at least 2 rows of numbers, got {len(cells.lines)}")
    for line, before, number in zip(cells.lines[1:], numbers[0], numbers[0][1:], strict=False):
        if not number > before:
            raise BadTableError(
                f"line {line}: {columns[0]} must increase strictly, got {number!r} after {before!r}"
            )
    with_unit = {name: unit for name, unit in zip(columns, units, strict=True) if name in cells.units}
    motions = {name: motion_of(f"1 {cells.units[name]}", unit) for name, unit in with_unit.items()}
    known = {name: motion for name, motion in motions.items() if motion is not None}
    for name, motion in known.items():
        first = next(iter(known))
        if motion != known[first]:
            raise BadTableError(
                f"line {cells.header}: {name} must be for a {JOINTS[known[first]]} joint, as {first} is, "
                f"got {cells.units[name]!r} ({JOINTS[motion]})"
            )
    return numbers, next(iter(known.values()), None)


S = TypeVar("S", bound=Spec)

_WITH_FILES = ("flexible", *WITH_FILES)


@dataclass(frozen=True, slots=True)
class Source:
    """Layers of values: a file, a case laid over it, and overrides laid over both.

    Attributes:
        label: How messages call the file.
        base: The file without its cases.
        case: Name of the case, or None.
        case_table: What the case lays over the file.
        overrides: What is laid over both.
        note: Text after a message about a value of the file.
        below: The cases that the case builds on, with what they lay over the file, the lowest first.
    """

    label: str
    base: Mapping[str, Any]
    case: str | None = None
    case_table: Mapping[str, Any] = field(default_factory=dict)
    overrides: Mapping[str, Any] = field(default_factory=dict)
    note: str = ""
    below: tuple[tuple[str, Mapping[str, Any]], ...] = ()

    def merged(self) -> dict[str, Any]:
        """Return the layers as one."""
        merged: Mapping[str, Any] = self.base
        for table in (*(table for _, table in self.below), self.case_table, self.overrides):
            merged = merge(merged, table)
        return dict(merged)

    def place(self, location: Location) -> ValuePlace:
        """Return the place of a value or missing key: file, case, or override."""
        lower = [self.base, *(table for _, table in self.below)]
        if from_layer(self.overrides, location, *lower, self.case_table):
            return ValuePlace(f"{self.label}: {dotted(location)}", " (set by an override)")
        for case, table in reversed([*self.below, (self.case, self.case_table)]):
            if case is not None and from_layer(table, location, *lower):
                return ValuePlace(f"{self.label}: {dotted(('cases', case, *location))}")
            lower = lower[:-1] or lower
        if not location:
            return ValuePlace(f"{self.label}:", self.note)
        return ValuePlace(f"{self.label}: {dotted(location)}", self.note, self._stale(location[:-1]))

    def _stale(self, table: Location) -> str:
        """Return a hint for a key made unknown by another kind in a layer above."""
        cases = [(f"case {case}", table) for case, table in ((self.case, self.case_table), *self.below[::-1])]
        for layer, values in (("an override", self.overrides), *cases):
            for key in ("kind", "law"):
                if _holds(values, (*table, key)):
                    return f" ({layer} sets {key}: add replace = true to drop the old keys)"
        return ""

    def error(self, text: str, *location: str) -> ScenarioError:
        """Return the error about a value."""
        where, note, _ = self.place(location)
        return ScenarioError(f"{where} {text}{note}")


def read_layer(overrides: Overrides) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Return what overrides lay over a file, as a table and as text."""
    layer, record = read_overrides(overrides)
    for key in ("cases", "default_case"):
        if key in layer:
            raise ScenarioError(f"override {key}: choose a case, and set its values without {key}")
    return layer, record


def built(kind: type[S], carried: dict[str, Any], source: Source) -> S:
    """Return the scenario of all layers, with the files it names.

    Raises:
        ScenarioError: With one line that gives file, place, rule, the value seen and a way out.
    """
    data = source.merged()
    check_keys(kind, data, source)
    folder = Path(carried["folder"])
    for family in _WITH_FILES:
        data = with_each(data, family, partial(_with_numbers, family, folder=folder, source=source))
    urdf = tables(data.get("mechanism")).get("urdf")
    if "urdf_text" not in carried:  # a mechanism without is refused for that
        place = ("mechanism", "urdf")
        text = _read_file(urdf, folder, source, *place, decode=decoded) if isinstance(urdf, str) else ""
        data = data | {"urdf_text": text}
    try:
        return kind.validated(data | carried)
    except ValidationError as error:
        raise explained(error, source.place) from None


def check_keys(kind: type[Spec], data: Mapping[str, Any], source: Source) -> None:
    """Refuse what only a loaded scenario carries, and does not stand in its file."""
    known = kind.keys()
    for key in kind.carried & data.keys():
        raise source.error(unknown_key([*known, "default_case", "cases"], key), key)


def with_each(data: Mapping[str, Any], key: str, change: Callable[[str, Any], Any]) -> dict[str, Any]:
    """Return data in which each named table below a key is replaced by ``change(name, table)``."""
    named = data.get(key)
    if not isinstance(named, Mapping):
        return dict(data)
    return {**data, key: {name: change(name, table) for name, table in named.items()}}


def check_files(data: Mapping[str, Any], source: Source) -> None:
    """Refuse a table with both its numbers and a file of them."""
    for family in _WITH_FILES:
        for name, table in tables(data.get(family)).items():
            columns = (*_stand_in(table, family),) or (("time", "torque") if family == "drives" else ())
            if "file" in tables(table) and table.keys() & {*columns}:
                rule = f"must have either file, or {', '.join(columns[:-1])} and {columns[-1]}, got both"
                raise source.error(rule, family, name)


def without_files(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return data with stand-ins for the numbers of files, which are not read."""
    found = dict(data)
    for family in _WITH_FILES:
        found = with_each(found, family, partial(_without_file, family))
    return found


def _without_file(family: str, _: str, table: Any) -> Any:
    return table | _stand_in(table, family) if "file" in tables(table) else table


def _stand_in(table: object, family: str) -> dict[str, tuple[float, ...]]:
    """Return least numbers in place of a table's file; {} for tables without one."""
    if family != "flexible":
        return dict.fromkeys(file_columns(table, family) or (), (0.0, 1.0))
    is_modal = isinstance(table, Mapping) and table.get("kind") == "modal-data"
    return {"frequency": (1.0,), "participation": (1.0, 0.0, 0.0, 0.0, 0.0, 0.0)} if is_modal else {}


def _with_numbers(family: str, name: str, table: Any, folder: Path, source: Source) -> Any:
    """Return a table with the numbers of the file it names, if it has none."""
    numbers, place = _stand_in(table, family), (family, name, "file")
    if not numbers or "file" not in table or table.keys() & numbers.keys():
        return table
    if not isinstance(table["file"], str):
        return table | numbers  # refused for its file
    text = _read_file(table["file"], folder, source, *place)
    try:
        return table | (_modes(text, table) if family == "flexible" else _columns(text, table, family))
    except FileFormatError as problem:
        where, note, _ = source.place(place)
        raise ScenarioError(f"{where}: {table['file']}, {problem}{note}") from None


def _columns(text: str, table: Mapping[str, Any], family: str) -> dict[str, Any]:
    columns = tuple(_stand_in(table, family))
    numbers, motion = read_table(text, columns, file_units(table, family))
    return dict(zip(columns, numbers, strict=True)) | ({"motion": motion} if motion else {})


def _modes(text: str, table: Mapping[str, Any]) -> dict[str, Any]:
    from antenna_pin.mechanism.flexible.modal_files import read_modal_table

    modes = read_modal_table(text)
    found: dict[str, Any] = {"frequency": modes.frequency, "participation": modes.participation}
    found["reading"] = modes.reading
    found["places"] = [f"{table['file']}, line {line}" for line in modes.lines]
    if modes.damping_ratio is not None and "damping_ratio" not in table:
        found["damping_ratio"] = modes.damping_ratio
    return found


def _read_file(
    name: str,
    folder: Path,
    source: Source,
    *location: str,
    decode: Callable[[bytes], str] = lambda data: data.decode(marked_encoding(data) or "utf-8"),
) -> str:
    """Return the text of a file that the scenario names."""
    path = folder / os.path.expanduser(name)
    if path.exists() and not path.is_dir() and not path.is_file():
        raise source.error(f"{absence(path)}: {shown(name)}", *location)
    if not path.is_file():
        around = path.parent
        names = [other.name for other in around.glob(f"*{path.suffix}")] if around.is_dir() else []
        guess = nearest(path.name, names)
        hint = f"did you mean {guess}?" if guess else f"searched in {around}"
        raise source.error(f"must be an existing file, got {shown(name)}; {hint}", *location)
    try:
        return decode(path.read_bytes())
    except UnicodeDecodeError as error:
        problem = f"must be UTF-8 text, got {shown(name)} (byte {error.start})"
    except OSError as error:
        problem = f"must be readable, got {shown(name)} ({error.strerror})"
    raise source.error(problem, *location)


def from_layer(layer: Mapping[str, Any], location: Location, *below: Mapping[str, Any]) -> bool:
    """Return whether a value, or its missing key, belongs to a layer."""
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
