"""Numbers over time from CSV text."""

from __future__ import annotations

import csv
from typing import Any

from antenna_pin.errors import FileFormatError
from antenna_pin.numerals import decimal_in
from antenna_pin.units import shown

__all__ = ["BadTableError", "read_table"]


class BadTableError(FileFormatError):
    """What is wrong in which line of a table."""


def read_table(text: str, columns: tuple[str, str]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return two columns of CSV text, of which the first is time; blank lines and lines with # are skipped.

    Args:
        text: The file's text.
        columns: Their names, as its header must have them.
    """
    rows = csv.reader(text.splitlines())
    try:
        return _columns(rows, columns)
    except csv.Error as error:  # a field of more than 131072 letters
        raise BadTableError(f"line {rows.line_num}: cannot be read: {error}") from None


def _columns(rows: Any, columns: tuple[str, str]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    wanted = ",".join(columns)
    header: list[str] | None = None
    times: list[float] = []
    values: list[float] = []
    for row in rows:
        if not row or row[0].lstrip().startswith("#"):
            continue
        line = f"line {rows.line_num}"
        if header is None:
            header = [cell.strip() for cell in row]
            if header != [*columns]:
                raise BadTableError(f"{line}: the header must be {wanted}, got {shown(','.join(header))}")
            continue
        if len(row) != 2:
            raise BadTableError(f"{line}: must have 2 values, got {len(row)}")
        time, value = (_number(cell, name, line) for cell, name in zip(row, header, strict=True))
        if times and not time > times[-1]:
            raise BadTableError(f"{line}: time must increase strictly, got {time!r} after {times[-1]!r}")
        times.append(time)
        values.append(value)
    if header is None:
        raise BadTableError(f"line 1: the header must be {wanted}, got an empty file")
    if len(times) < 2:
        raise BadTableError(f"line {rows.line_num}: must have at least 2 rows of numbers, got {len(times)}")
    return tuple(times), tuple(values)


def _number(cell: str, name: str, line: str) -> float:
    number = decimal_in(cell)
    if number is None:
        raise BadTableError(f"{line}: {name} must be a finite number, got {shown(cell.strip())}")
    return number
