"""Columns of a record from a text, as loggers and spreadsheets write them."""

from __future__ import annotations

import csv
import datetime
import json
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from antenna_pin.errors import ScenarioError, UnknownNameError
from antenna_pin.fit.layout import LayoutSpec
from antenna_pin.numerals import decimal_in
from antenna_pin.units import shown

__all__ = ["from_text"]

Array = NDArray[np.float64]

# Cells that say that there is no number, as spreadsheets and recorders write them.
_NO_NUMBER = frozenset({"", "nan", "na", "n/a", "null", "none", "inf", "-inf", "+inf", "-", "#n/a"})
_OF_UTF_16 = (b"\xff\xfe", b"\xfe\xff")  # with what such a text begins
_SHOWN = 12  # names that a message offers
_LOOKED_AT = 200  # lines in which column names are looked for, to say where they are
# Seconds of a stamp and what is behind their decimal sign: Python's own reading ends at microseconds.
_SECONDS = re.compile(r"(:[0-9]{2})[.,]([0-9]+)")


def from_text(
    path: Path, names: Sequence[str], layout: LayoutSpec, place: str
) -> tuple[dict[str, Array], dict[str, str]]:
    """Return columns by name, (rows,) each, and the units that the text gives of them.

    Args:
        path: The file.
        names: Of the columns that are wanted.
        layout: Of the text.
        place: Where the file is named, for messages.

    Raises:
        ScenarioError: It cannot be read, or a column holds what is no number.
        UnknownNameError: It has no such column.
    """
    lines = _text(path, layout, place).splitlines()
    rows = _rows(lines, layout, f"{place}: {path.name}")
    header, head = layout.names, 0
    if header is None:
        head, cells = next(rows, (0, []))
        header = tuple(cell.strip() for cell in cells)
    if not header:
        raise ScenarioError(f"{place}: {path.name} must have a header with {', '.join(names)}, got nothing")
    for name in names:
        if name not in header:
            if layout.names is None:
                _look_for(names, head, lines, layout, f"{place}: {path.name}")
            known = [one for one in header if one]
            raise UnknownNameError(f"{place}: {path.name}", "column", name, known[:_SHOWN])
        if header.count(name) > 1:
            places = [str(k + 1) for k, one in enumerate(header) if one == name]
            raise ScenarioError(
                f"{place}: {path.name}: line {head}: {name} must be the name of one column, got it of "
                f"columns {' and '.join(places)}; give names of your own, and skip = {head}"
            )
    at = {name: header.index(name) for name in names}
    units = {}
    if layout.units_row:
        line, cells = next(rows, (0, []))
        _check_length(cells, header, at, f"{place}: {path.name}: line {line}", layout)
        units = {name: _bare_unit(cells[k]) for name, k in at.items()}
    columns: dict[str, list[float]] = {name: [] for name in names}
    first: tuple[datetime.datetime, float] | None = None
    for line, cells in rows:
        where = f"{place}: {path.name}: line {line}"
        _check_length(cells, header, at, where, layout)
        for name, k in at.items():
            if layout.time_format is not None and name == layout.time:
                stamp = _stamp(cells[k], name, layout.time_format, where)
                first = first or stamp
                columns[name].append(_since(stamp, first, where))
            else:
                columns[name].append(_cell(cells[k], name, layout.decimal, not columns[name], where))
    return {name: np.array(values, dtype=float) for name, values in columns.items()}, units


def _text(path: Path, layout: LayoutSpec, place: str) -> str:
    encoding = "utf-8-sig" if layout.encoding.lower().replace("_", "-") in ("utf-8", "utf8") else None
    try:
        return path.read_text(encoding=encoding or layout.encoding)
    except UnicodeError as error:
        said = "UTF-8" if encoding else layout.encoding
        byte = f" (byte {error.start})" if isinstance(error, UnicodeDecodeError) else ""
        way = 'give encoding = "latin-1", "utf-16" or what it is in'
        if path.read_bytes()[:2] in _OF_UTF_16:
            way = 'give encoding = "utf-16"'
        raise ScenarioError(f"{place}: {path.name} is not {said} text{byte}; {way}") from None
    except OSError as error:
        raise ScenarioError(f"{place}: {path.name} cannot be read: {error.strerror}") from None


def _rows(lines: list[str], layout: LayoutSpec, place: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the number and the cells of each line that counts, behind those that are skipped."""
    kept = lines[layout.skip :]
    if layout.delimiter == " ":
        for k, line in enumerate(kept):
            if line.strip() and not line.lstrip().startswith(layout.comment):
                yield layout.skip + k + 1, line.split()
        return
    reader = csv.reader(kept, delimiter=layout.delimiter, skipinitialspace=layout.delimiter != "\t")
    try:
        for cells in reader:
            if cells and not cells[0].lstrip().startswith(layout.comment):
                yield layout.skip + reader.line_num, cells
    except csv.Error as error:
        raise ScenarioError(f"{place}: line {layout.skip + reader.line_num}: {error}") from None


def _check_length(
    cells: list[str], header: Sequence[str], at: dict[str, int], line: str, layout: LayoutSpec
) -> None:
    """Refuse a line that is longer than the names, or that ends before a column that is wanted."""
    more = [cell for cell in cells[len(header) :] if cell.strip()]  # a delimiter at the end is no cell
    if not more and max(at.values()) < len(cells):
        return
    hint = ""
    if layout.delimiter == "," and len(cells) == 2 * len(header):
        hint = "; if commas are in numbers, have the file written with another delimiter, or numbers quoted"
    raise ScenarioError(f"{line} must have {len(header)} values, got {len(cells)}{hint}")


def _look_for(names: Sequence[str], head: int, lines: list[str], layout: LayoutSpec, where: str) -> None:
    """Refuse a text whose names of columns are elsewhere than in its line ``head``, and say where."""
    for k, line in enumerate(lines[:_LOOKED_AT], 1):
        bare = line.strip().removeprefix(layout.comment)
        for delimiter in dict.fromkeys((layout.delimiter, ";", "\t", ",")):
            cells = [cell.strip().strip('"') for cell in bare.split(delimiter)]
            if not set(cells).issuperset(names):
                continue
            ways = [] if delimiter == layout.delimiter else [f"delimiter = {json.dumps(delimiter)}"]
            if bare != line.strip():
                ways.append(f"names = {json.dumps(cells, ensure_ascii=False)}")
            elif k != head:
                ways.append(f"skip = {k - 1}")
            rule = "the names of columns must be in the first line that counts"
            raise ScenarioError(
                f"{where}: {rule}, got {', '.join(names)} in line {k}; give {' and '.join(ways)}"
            )


def _bare_unit(cell: str) -> str:
    """Return the unit that a cell is, without brackets about it."""
    word = cell.strip()
    if len(word) > 1 and (word[0], word[-1]) in (("[", "]"), ("(", ")")):
        word = word[1:-1].strip()
    return word


def _cell(cell: str, name: str, decimal: str, first: bool, line: str) -> float:
    foreign = "," if decimal == "." else "."
    plain = cell if decimal == "." else cell.replace(",", ".")
    number = None if foreign in cell else decimal_in(plain)
    if number is not None:
        return number
    if cell.strip().lower() in _NO_NUMBER:
        return float("nan")
    hint = ""
    if cell.count(foreign) == 1 and decimal_in(cell.replace(foreign, "0")) is not None:
        hint = f'; if it is one, give decimal = "{foreign}"'
    elif first:
        hint = "; if it is a unit, give units_row = true"
    raise ScenarioError(f"{line}: {name} must be a number, got {shown(cell.strip())}{hint}")


def _stamp(cell: str, name: str, pattern: str, line: str) -> tuple[datetime.datetime, float]:
    """Return a stamp to the second, and what is behind it [s]."""
    word, rest = cell.strip(), 0.0
    found = _SECONDS.search(word)
    if found is not None:
        rest = float(f"0.{found[2]}")
        word = word[: found.end(1)] + word[found.end() :]
    plain = re.sub(r"[.,]%f", "", pattern)
    try:
        if pattern == "iso":
            return datetime.datetime.fromisoformat(word), rest
        return datetime.datetime.strptime(word, plain), rest
    except ValueError:
        rule = "ISO 8601" if pattern == "iso" else pattern
        said = f"{name} must be a time stamp of the time_format {rule}"
        raise ScenarioError(f"{line}: {said}, got {shown(cell.strip())}") from None


def _since(
    stamp: tuple[datetime.datetime, float], first: tuple[datetime.datetime, float], line: str
) -> float:
    """Return how long after the first a stamp is [s]."""
    if (stamp[0].tzinfo is None) != (first[0].tzinfo is None):
        raise ScenarioError(f"{line}: time stamps must all have a time zone, or none, got both")
    return (stamp[0] - first[0]).total_seconds() + (stamp[1] - first[1])
