"""Torque over time from CSV text."""

from __future__ import annotations

import csv
import math

from antenna_pin.errors import FileFormatError
from antenna_pin.units import shown

__all__ = ["BadTableError", "read_torque_table"]

_HEADER = ["time", "torque"]


class BadTableError(FileFormatError):
    """What is wrong in which line of a table."""


def read_torque_table(text: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the columns time and torque of CSV text; blank lines and lines that start with # are skipped."""
    rows = csv.reader(text.splitlines())
    header: list[str] | None = None
    times: list[float] = []
    torques: list[float] = []
    for row in rows:
        if not row or row[0].lstrip().startswith("#"):
            continue
        line = f"line {rows.line_num}"
        if header is None:
            header = [cell.strip() for cell in row]
            if header != _HEADER:
                raise BadTableError(f"{line}: the header must be time,torque, got {shown(','.join(header))}")
            continue
        if len(row) != 2:
            raise BadTableError(f"{line}: must have 2 values, got {len(row)}")
        time, torque = (_number(cell, name, line) for cell, name in zip(row, header, strict=True))
        if times and not time > times[-1]:
            raise BadTableError(f"{line}: time must increase strictly, got {time!r} after {times[-1]!r}")
        times.append(time)
        torques.append(torque)
    if header is None:
        raise BadTableError("line 1: the header must be time,torque, got an empty file")
    if len(times) < 2:
        raise BadTableError(f"line {rows.line_num}: must have at least 2 rows of numbers, got {len(times)}")
    return tuple(times), tuple(torques)


def _number(cell: str, name: str, line: str) -> float:
    try:
        number = float(cell)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise BadTableError(f"{line}: {name} must be a finite number, got {shown(cell.strip())}")
    return number
