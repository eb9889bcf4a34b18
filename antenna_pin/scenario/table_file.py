"""Numbers over time, or over an angle, from CSV text."""

from __future__ import annotations

import csv
from typing import Any

from antenna_pin.errors import FileFormatError
from antenna_pin.numerals import decimal_in
from antenna_pin.units import shown

__all__ = ["BadTableError", "read_table"]


class BadTableError(FileFormatError):
    """What is wrong in which line of a table."""


def read_table(text: str, columns: tuple[str, ...]) -> tuple[tuple[float, ...], ...]:
    """Return columns of CSV text, of which the first increases; blank lines and lines with # are skipped.

    Args:
        text: The file's text.
        columns: Their names, as its header must have them.
    """
    rows = csv.reader(text.splitlines())
    try:
        return _columns(rows, columns)
    except csv.Error as error:  # a field of more than 131072 letters
        raise BadTableError(f"line {rows.line_num}: cannot be read: {error}") from None


def _columns(rows: Any, columns: tuple[str, ...]) -> tuple[tuple[float, ...], ...]:
    wanted = ",".join(columns)
    header: list[str] | None = None
    found: list[tuple[float, ...]] = []
    for row in rows:
        if not row or row[0].lstrip().startswith("#"):
            continue
        line = f"line {rows.line_num}"
        if header is None:
            header = [cell.strip() for cell in row]
            if header != [*columns]:
                raise BadTableError(f"{line}: the header must be {wanted}, got {shown(','.join(header))}")
            continue
        if len(row) != len(columns):
            raise BadTableError(f"{line}: must have {len(columns)} values, got {len(row)}")
        numbers = tuple(_number(cell, name, line) for cell, name in zip(row, header, strict=True))
        if found and not numbers[0] > found[-1][0]:
            last = found[-1][0]
            raise BadTableError(
                f"{line}: {columns[0]} must increase strictly, got {numbers[0]!r} after {last!r}"
            )
        found.append(numbers)
    if header is None:
        raise BadTableError(f"line 1: the header must be {wanted}, got an empty file")
    if len(found) < 2:
        raise BadTableError(f"line {rows.line_num}: must have at least 2 rows of numbers, got {len(found)}")
    return tuple(zip(*found, strict=True))


def _number(cell: str, name: str, line: str) -> float:
    number = decimal_in(cell)
    if number is None:
        raise BadTableError(f"{line}: {name} must be a finite number, got {shown(cell.strip())}")
    return number
