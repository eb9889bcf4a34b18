"""The layers of a scenario, a file with a case and overrides over it, and the scenario made of them."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from antenna_pin.base.files import absence, decoded, marked_encoding
from antenna_pin.base.tables import BadTableError, column_of, read_cells
from antenna_pin.base.units import shown
from antenna_pin.errors import ScenarioError, nearest
from antenna_pin.scenario._base import Spec, unknown_key
from antenna_pin.scenario._explained import Location, Place, dotted, explained
from antenna_pin.scenario._joint import JOINTS, Motion, motion_of
from antenna_pin.scenario._modal_file import has_modal_file, modal_stand_in
from antenna_pin.scenario.drives import WITH_FILES, file_columns, file_units
from antenna_pin.scenario.merge import Overrides, merge, read_overrides
from antenna_pin.scenario.shipped import tables

__all__ = [
    "Source",
    "built",
    "check_drives",
    "check_keys",
    "from_layer",
    "read_layer",
    "stand_in",
]


# --- numbers over time, or over an angle, from text ---


def read_table(
    text: str, columns: Sequence[str], units: Sequence[str | tuple[str, ...]]
) -> tuple[tuple[tuple[float, ...], ...], Motion | None]:
    """Return columns of a table in SI units, of which the first increases.

    Args:
        text: The file's text.
        columns: Their names, as its header must have them.
        units: SI unit of each, or those of a turning and of a sliding joint.

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


@dataclass(frozen=True, slots=True)
class Source:
    """Layers of values: a file, a case laid over it, and overrides laid over both.

    Attributes:
        label: How messages call the file.
        base: The file without its cases.
        case: Name of the case, or None.
        case_table: What the case lays over the file.
        overrides: What is laid over both.
        note: What is to be said after a message about a value of the file.
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

    def place(self, location: Location) -> Place:
        """Return where a value stands, or is missing: in the file, in its case, or in an override."""
        lower = [self.base, *(table for _, table in self.below)]
        if from_layer(self.overrides, location, *lower, self.case_table):
            return Place(f"{self.label}: {dotted(location)}", " (set by an override)")
        for case, table in reversed([*self.below, (self.case, self.case_table)]):
            if case is not None and from_layer(table, location, *lower):
                return Place(f"{self.label}: {dotted(('cases', case, *location))}")
            lower = lower[:-1] or lower
        if not location:
            return Place(f"{self.label}:", self.note)
        return Place(f"{self.label}: {dotted(location)}", self.note, self._stale(location[:-1]))

    def _stale(self, table: Location) -> str:
        """Say why a key of the file may have become unknown: what is laid over it has changed the kind."""
        cases = [(f"case {case}", table) for case, table in ((self.case, self.case_table), *self.below[::-1])]
        for layer, values in (("an override", self.overrides), *cases):
            for key in ("kind", "law"):
                if _holds(values, (*table, key)):
                    return f" ({layer} sets {key}: with replace = true beside it, the old keys go)"
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

    Args:
        kind: The class of a scenario.
        carried: What it carries beside the values of the layers.
        source: The layers.

    Raises:
        ScenarioError: With one line that gives file, place, rule, the value seen and a way out.
    """
    data = source.merged()
    check_keys(kind, data, source)
    folder = Path(carried["folder"])
    for family in WITH_FILES:
        of_family = data.get(family)
        if isinstance(of_family, Mapping):
            read = {name: _with_table((family, name), of_family[name], folder, source) for name in of_family}
            data = data | {family: read}
    flexible = data.get("flexible")
    if isinstance(flexible, Mapping):
        data = data | {
            "flexible": {name: _with_modes(name, flexible[name], folder, source) for name in flexible}
        }
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


def check_drives(data: Mapping[str, Any], source: Source) -> None:
    """Refuse an element with a table, or an appendage's modal data, that has its numbers twice."""
    for name, table in tables(data.get("flexible")).items():
        if has_modal_file(table) and table.keys() & modal_stand_in().keys():
            rule = "must have either file, or frequency and participation, got both"
            raise source.error(rule, "flexible", name)
    for family in WITH_FILES:
        for name, table in tables(data.get(family)).items():
            columns = file_columns(table, family) or (("time", "torque") if family == "drives" else ())
            if "file" in tables(table) and table.keys() & {*columns}:
                rule = f"must have either file, or {', '.join(columns[:-1])} and {columns[-1]}, got both"
                raise source.error(rule, family, name)


def stand_in(table: object, family: str) -> dict[str, tuple[float, ...]]:
    """Return the least that an element needs in place of a file that is not to be read."""
    return dict.fromkeys(file_columns(table, family) or (), (0.0, 1.0))


def _with_table(element: tuple[str, str], table: Any, folder: Path, source: Source) -> Any:
    """Return an element, by family and name, with the numbers of the file it names, if it has none."""
    columns = file_columns(table, element[0])
    if columns is None or "file" not in table or table.keys() & {*columns}:
        return table
    if not isinstance(table["file"], str):
        return table | stand_in(table, element[0])  # refused for its file
    place = (*element, "file")
    text = _read_file(table["file"], folder, source, *place)
    try:
        numbers, motion = read_table(text, columns, file_units(table, element[0]))
    except BadTableError as problem:
        where, note, _ = source.place(place)
        raise ScenarioError(f"{where}: {table['file']}, {problem}{note}") from None
    return table | dict(zip(columns, numbers, strict=True)) | ({"motion": motion} if motion else {})


def _with_modes(name: str, table: Any, folder: Path, source: Source) -> Any:
    """Return a flexible link with the modes of the file it names, if it names one and has none."""
    if not has_modal_file(table) or table.keys() & modal_stand_in().keys():
        return table
    if not isinstance(table["file"], str):
        return table | modal_stand_in()  # refused for its file
    from antenna_pin.flexible.modal_text import BadModalTableError, read_modal_table

    place = ("flexible", name, "file")
    text = _read_file(table["file"], folder, source, *place)
    try:
        modes = read_modal_table(text)
    except BadModalTableError as problem:
        where, note, _ = source.place(place)
        raise ScenarioError(f"{where}: {table['file']}, {problem}{note}") from None
    found: dict[str, Any] = {"frequency": modes.frequency, "participation": modes.participation}
    found["reading"] = modes.reading
    found["places"] = [f"{table['file']}, line {line}" for line in modes.lines]
    if modes.damping_ratio is not None and "damping_ratio" not in table:
        found["damping_ratio"] = modes.damping_ratio
    return table | found


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
        hint = f"did you mean {guess}?" if guess else f"it is looked for in {around}"
        raise source.error(f"must be an existing file, got {shown(name)}; {hint}", *location)
    try:
        return decode(path.read_bytes())
    except UnicodeDecodeError as error:
        problem = f"must be UTF-8 text, got {shown(name)} (byte {error.start})"
    except OSError as error:
        problem = f"must be readable, got {shown(name)} ({error.strerror})"
    raise source.error(problem, *location)


def from_layer(layer: Mapping[str, Any], location: Location, *below: Mapping[str, Any]) -> bool:
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
