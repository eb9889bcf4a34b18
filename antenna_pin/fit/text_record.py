"""Columns of a record from a text, as loggers and spreadsheets write them."""

from __future__ import annotations

import datetime
import json
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.files import marked_encoding
from antenna_pin.base.numerals import decimal_in
from antenna_pin.base.tables import BadTableError, TextLayout, UnknownColumnError, hint, read_cells
from antenna_pin.base.units import shown
from antenna_pin.errors import ScenarioError, UnknownNameError
from antenna_pin.fit.layout import LayoutSpec

__all__ = ["from_text"]

Array = NDArray[np.float64]

# Cells that say that there is no number, as spreadsheets and recorders write them.
_NO_NUMBER = frozenset({"", "nan", "na", "n/a", "null", "none", "inf", "-inf", "+inf", "-", "#n/a"})
_OF_TEXT = ("delimiter", "decimal", "comment", "skip", "names", "units_row")
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
    text, where = _text(path, layout, place), f"{place}: {path.name}"
    known = {name: getattr(layout, name) for name in _OF_TEXT}
    try:
        cells = read_cells(text, names, TextLayout(holes=True, **known), headless=False)
    except UnknownColumnError as error:
        if not error.known:
            raise ScenarioError(f"{where} must have a header with {', '.join(names)}, got nothing") from None
        if layout.names is None:
            _look_for(names, error.line, text.splitlines(), layout, where)
        shown_names = [one for one in error.known if one][:_SHOWN]
        raise UnknownNameError(where, "column", error.name, shown_names) from None
    except BadTableError as error:
        raise ScenarioError(f"{where}: {error}") from None
    columns: dict[str, list[float]] = {name: [] for name in names}
    first: tuple[datetime.datetime, float] | None = None
    for name, column in columns.items():
        for line, cell in zip(cells.lines, cells.text[name], strict=True):
            at = f"{where}: line {line}"
            if layout.time_format is not None and name == layout.time:
                stamp = _stamp(cell, name, layout.time_format, at)
                first = first or stamp
                column.append(_since(stamp, first, at))
            else:
                column.append(_number(cell, name, not column, at))
    return {name: np.array(values, dtype=float) for name, values in columns.items()}, cells.units


def _text(path: Path, layout: LayoutSpec, place: str) -> str:
    is_utf_8 = layout.encoding.lower().replace("_", "-") in ("utf-8", "utf8")
    try:
        data = path.read_bytes()
        return data.decode((marked_encoding(data) if is_utf_8 else None) or layout.encoding)
    except UnicodeError as error:
        said = "UTF-8" if is_utf_8 else layout.encoding
        byte = f" (byte {error.start})" if isinstance(error, UnicodeDecodeError) else ""
        way = 'give encoding = "latin-1", "utf-16" or what it is in'
        raise ScenarioError(f"{place}: {path.name} is not {said} text{byte}; {way}") from None
    except OSError as error:
        raise ScenarioError(f"{place}: {path.name} cannot be read: {error.strerror}") from None


def _look_for(names: Sequence[str], head: int, lines: list[str], layout: LayoutSpec, where: str) -> None:
    """Refuse a text whose names of columns are elsewhere than in its line ``head``, and say where."""
    for k, line in enumerate(lines[:_LOOKED_AT], 1):
        bare = line.strip().removeprefix(layout.comment)
        for delimiter in dict.fromkeys((*([layout.delimiter] if layout.delimiter else []), ";", "\t", ",")):
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


def _number(cell: str, name: str, first: bool, line: str) -> float:
    number = decimal_in(cell)
    if number is not None:
        return number
    if cell.strip().lower() in _NO_NUMBER:
        return float("nan")
    way = hint(cell) or ("; if it is a unit, give units_row = true" if first else "")
    raise ScenarioError(f"{line}: {name} must be a number, got {shown(cell)}{way}")


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
