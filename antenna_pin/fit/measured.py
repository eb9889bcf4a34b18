"""Measured records in SI units, on their own clock: what of them counts, and what is wrong with them."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.units import unit_factor
from antenna_pin.errors import ScenarioError
from antenna_pin.fit.columns import ColumnSpec
from antenna_pin.fit.plan import RecordSpec
from antenna_pin.fit.record_file import read_columns

__all__ = ["Measured", "measured"]

Array = NDArray[np.float64]

# Of the middle step of a record's clock: from one row to the next more than this is a gap; and how far steps
# may be off for the clock to count as even.
_GAP, _EVEN = 5.5, 1e-3
# So many rows in turn at a column's end are no noise's doing.
_STAYS = 5


@dataclass(frozen=True, slots=True)
class Measured:
    """What was measured in one record.

    Attributes:
        time: Of the rows that count, by the file's clock, rising [s].
        values: Of the columns, in SI units, by name, (rows,).
        notes: What is odd about them, a line each.
    """

    time: Array
    values: Mapping[str, Array]
    notes: tuple[str, ...] = ()


def measured(spec: RecordSpec, folder: Path, units: Mapping[str, str], place: str) -> Measured:
    """Return a record from its file, or say what is wrong with it.

    Args:
        spec: What the fit file says of it.
        folder: From which its path starts.
        units: SI unit of what each column reads.
        place: Of the record, for messages.

    Raises:
        ScenarioError: Times do not rise, a number is missing, a unit does not fit, nothing is left.
        UnknownNameError: The file has no such column.
    """
    in_file = {name: one.column or name for name, one in spec.columns.items()}
    path = folder / os.path.expanduser(spec.file)
    for name, one in spec.columns.items():  # what is written wrongly is told before a file is read
        _factor(one, None, units[name], f"{place}.columns.{name}")
    columns = read_columns(path, list(dict.fromkeys(in_file.values())), spec, place)
    time = columns.time
    values = {
        name: columns.values[in_file[name]]
        * _factor(one, columns.units.get(in_file[name]), units[name], f"{place}.columns.{name}")
        for name, one in spec.columns.items()
    }
    where, clock = f"{place}: {path.name}", spec.time if spec.rate is None else "rate"
    kept = np.ones(len(time), dtype=bool)
    if not np.all(np.isfinite(time)):
        row = int(np.flatnonzero(~np.isfinite(time))[0]) + 1
        raise ScenarioError(f"{where}: {clock} must be a number in each row, got none in row {row}")
    _check_rising(time, f"{where}: {clock}")
    if spec.window is not None:
        kept &= (time >= spec.window[0]) & (time <= spec.window[1])
        if np.count_nonzero(kept) < 2:
            rule = f"must hold 2 rows at least of {time[0]:g} s to {time[-1]:g} s"
            raise ScenarioError(f"{place}.window {rule}, got {spec.window[0]:g} s to {spec.window[1]:g} s")
    for name, column in values.items():
        bad = kept & ~np.isfinite(column)
        if spec.gaps == "refuse" and bad.any():
            rows = np.flatnonzero(bad)
            row, count = int(rows[0]), len(rows)
            more = f" and {count - 1} others up to row {rows[-1] + 1}" if count > 1 else ""
            raise ScenarioError(
                f"{where}: {in_file[name]} must be a number in each row, got none in row {row + 1}, at "
                f'{time[row]:g} s{more}; give a window, or gaps = "skip"'
            )
        kept &= np.isfinite(column)
    if np.count_nonzero(kept) < 2:
        raise ScenarioError(f"{where} must have 2 rows of numbers at least, got {np.count_nonzero(kept)}")
    time = time[kept]
    if spec.gaps == "refuse":
        _check_gaps(time, where)
    for name, one in spec.columns.items():
        if one.compare in ("spectrum", "blows"):
            _check_even(time, f"{place}.columns.{name}: {one.compare}")
    rows = np.flatnonzero(kept) + 1
    found = {name: column[kept] for name, column in values.items()}
    notes = [
        f"records.{place.rpartition('records.')[2]}: {path.name}: {in_file[name]} {words}"
        for name, one in spec.columns.items()
        if one.sensor != "encoder" and (words := _odd(found[name], rows))
    ]
    return Measured(time, found, tuple(notes))


def _odd(values: Array, rows: NDArray[np.int64]) -> str:
    """Return what is odd about a column whose noise never lets it repeat itself, in words; or nothing.

    Args:
        values: The column, (rows,).
        rows: Their numbers in the file.
    """
    changes = np.flatnonzero(np.diff(values) != 0.0)
    if not changes.size:
        return f"is the same in all {len(values)} rows: is its sensor connected?"
    begins, ends = np.append(0, changes + 1), np.append(changes, len(values) - 1)
    for end, side in ((np.max(values), "largest"), (np.min(values), "smallest")):
        long = (values[begins] == end) & (ends - begins >= _STAYS - 1)
        if long.any():
            k = int(np.flatnonzero(long)[0])
            stays = int(np.sum((ends - begins + 1)[long]))
            return (
                f"stays at its {side} value in {stays} rows, first from row {rows[begins[k]]} to "
                f'{rows[ends[k]]}: if that is as far as its sensor goes, empty them and give gaps = "skip"'
            )
    return ""


def _factor(column: ColumnSpec, in_file: str | None, unit: str, place: str) -> float:
    """Return what one of a column's unit is in SI units: as the fit file says, else its own, else 1."""
    if column.unit is not None:
        return unit_factor(column.unit, unit, f"{place}.unit")
    if in_file is None:
        return 1.0
    try:
        return unit_factor(in_file, unit, f"{place}: the file's unit")
    except ScenarioError as error:
        raise ScenarioError(f"{error}; say by unit what it is") from None


def _check_rising(time: Array, place: str) -> None:
    back = np.flatnonzero(np.diff(time) <= 0.0)
    if back.size:
        row = int(back[0])
        raise ScenarioError(
            f"{place} must rise from row to row, got {time[row + 1]:.9g} s after {time[row]:.9g} s in row "
            f"{row + 2}"
        )


def _check_gaps(time: Array, place: str) -> None:
    steps = np.diff(time)
    middle = float(np.median(steps))
    wide = np.flatnonzero(steps > _GAP * middle)
    if wide.size:
        at = int(wide[0])
        raise ScenarioError(
            f"{place} must have no gaps, got none between {time[at]:.6g} s and {time[at + 1]:.6g} s in rows "
            f'{middle:.3g} s apart; give a window, or gaps = "skip"'
        )


def _check_even(time: Array, place: str) -> None:
    steps = np.diff(time)
    off = float(np.max(np.abs(steps - np.mean(steps))) / np.mean(steps))
    if off > _EVEN:
        raise ScenarioError(
            f"{place}: must have rows at even times, got steps that differ by {100.0 * off:.3g} %; give a "
            "window without gaps"
        )
