"""Modal data from text: CSV, or the tables that NASTRAN and its kin print.

CSV has the header ``frequency,damping_ratio,tx,ty,tz,rx,ry,rz``, of which ``damping_ratio`` may be left out.

A printed table is known by its heading, MODAL PARTICIPATION FACTORS, letters spaced out or not. Below it, a
line names the columns, ``T1 T2 T3 R1 R2 R3`` or ``X-COMPONENT`` to ``Z-ROTATION``, with FREQUENCY or without;
then frequencies are the CYCLES of the REAL EIGENVALUES (EIGENVALUE OUTPUT) before it. Anything else, headings
of pages in between too, is skipped. Numbers may be written the short way, ``1.25-3``, or with a D.
"""

from __future__ import annotations

import csv
import math
import re
from dataclasses import dataclass
from typing import Any

from antenna_pin.errors import FileFormatError
from antenna_pin.units import shown

__all__ = ["BadModalTableError", "ModalTable", "read_modal_table"]

_CSV = ("frequency", "damping_ratio", "tx", "ty", "tz", "rx", "ry", "rz")
_SHORT = re.compile(r"([0-9.])([+-]\d+)$")  # 1.25-3 for 1.25e-3
_AXES = (
    ("T1", "T2", "T3", "R1", "R2", "R3"),
    ("X-COMPONENT", "Y-COMPONENT", "Z-COMPONENT", "X-ROTATION", "Y-ROTATION", "Z-ROTATION"),
)
# A generalized mass that is one, as printed tables round it.
_UNIT = 1e-4


class BadModalTableError(FileFormatError):
    """What is wrong in which line of modal data."""


@dataclass(frozen=True, slots=True)
class ModalTable:
    """Modal data as a file gives them.

    Attributes:
        frequency: Of each mode [Hz].
        participation: Six numbers for each mode, one mode after the other [sqrt(kg)], [sqrt(kg) m].
        damping_ratio: Of each mode [-]; None where the file does not say.
        lines: Of each mode's factors in the file, from 1.
    """

    frequency: tuple[float, ...]
    participation: tuple[float, ...]
    damping_ratio: tuple[float, ...] | None
    lines: tuple[int, ...]


def read_modal_table(text: str) -> ModalTable:
    """Return the modes of a file's text, CSV or a printed table.

    Raises:
        BadModalTableError: It is neither, or a line is not what it should be.
    """
    for line in text.splitlines():
        if line.strip() and not line.lstrip().startswith("#"):
            if line.split(",")[0].strip() == "frequency":
                rows = csv.reader(text.splitlines())
                try:
                    return _of_csv(rows)
                except csv.Error as error:  # a field of more than 131072 letters
                    raise BadModalTableError(f"line {rows.line_num}: cannot be read: {error}") from None
            break
    return _of_print(text)


def _of_csv(rows: Any) -> ModalTable:
    header: list[str] | None = None
    frequency: list[float] = []
    damping: list[float] = []
    participation: list[float] = []
    lines: list[int] = []
    for row in rows:
        if not row or row[0].lstrip().startswith("#"):
            continue
        place = f"line {rows.line_num}"
        if header is None:
            header = [cell.strip() for cell in row]
            if tuple(header) not in (_CSV, (_CSV[0], *_CSV[2:])):
                raise BadModalTableError(
                    f"{place}: the header must be {','.join(_CSV)}, damping_ratio or not, "
                    f"got {shown(','.join(header))}"
                )
            continue
        if len(row) != len(header):
            raise BadModalTableError(f"{place}: must have {len(header)} values, got {len(row)}")
        numbers = [_number(cell, name, place) for cell, name in zip(row, header, strict=True)]
        frequency.append(_positive(numbers[0], place))
        if len(header) == len(_CSV):
            if not numbers[1] >= 0.0:
                raise BadModalTableError(f"{place}: damping_ratio must be zero or more, got {numbers[1]:g}")
            damping.append(numbers[1])
        participation += _factors(numbers[-6:], place)
        lines.append(rows.line_num)
    if not frequency:
        raise BadModalTableError(
            f"line {rows.line_num}: must have at least one mode below the header, got none"
        )
    return ModalTable(tuple(frequency), tuple(participation), tuple(damping) or None, tuple(lines))


def _of_print(text: str) -> ModalTable:
    """Read a printed table; modes go by their numbers, so that one may go on over several pages."""
    cycles: dict[int, float] = {}
    factors: dict[int, list[float]] = {}
    lines: dict[int, int] = {}
    section, columns = "", 0
    for number, line in enumerate(text.splitlines(), start=1):
        place, words = f"line {number}", line.upper().split()
        squeezed = "".join(words)
        if "PARTICIPATIONFACTORS" in squeezed:
            section, columns = "factors", 0
        elif "REALEIGENVALUES" in squeezed or "EIGENVALUEOUTPUT" in squeezed:
            section, columns = "eigenvalues", 0
        elif re.search(r"EFFECTIVE(MODAL)?(MASS|WEIGHT)", squeezed):
            section, columns = "", 0
        elif section == "factors" and tuple(words[-6:]) in _AXES:
            columns = 8 if "FREQUENCY" in words else 7
        elif section == "factors" and columns and _is_row(words):
            if len(words) != columns:
                raise BadModalTableError(f"{place}: must have {columns} numbers, got {len(words)}")
            mode = int(words[0])
            if mode in factors:
                raise BadModalTableError(
                    f"{place}: mode {mode} must stand once, got it again; keep one subcase in the file"
                )
            values = [_number(word, "a factor", place) for word in words[1:]]
            if columns == 8:
                cycles[mode] = _positive(values[0], place)
            factors[mode], lines[mode] = _factors(values[-6:], place), number
        elif section == "eigenvalues" and len(words) >= 5 and _is_row(words):
            _read_eigenvalue(words, place, cycles)
    if not factors:
        raise BadModalTableError(
            "line 1: must be CSV with the header " + ",".join(_CSV) + ", or have a table under the heading "
            "MODAL PARTICIPATION FACTORS with columns T1 to R3, got neither"
        )
    lacking = [mode for mode in factors if mode not in cycles]
    if lacking:
        raise BadModalTableError(
            f"mode {lacking[0]} of the participation factors must have a frequency, in a column FREQUENCY or "
            "among the REAL EIGENVALUES, got none"
        )
    order = list(factors)
    return ModalTable(
        tuple(cycles[mode] for mode in order),
        tuple(x for mode in order for x in factors[mode]),
        None,
        tuple(lines[mode] for mode in order),
    )


def _factors(numbers: list[float], place: str) -> list[float]:
    if not any(numbers):
        raise BadModalTableError(
            f"{place}: {_CSV[2]} to {_CSV[-1]} must be other than six zeros, which no hub feels; "
            "leave the mode out"
        )
    return numbers


def _is_row(words: list[str]) -> bool:
    """Whether a line is one of a table: a page's heading has a number in front too, but words behind it."""
    numbers = sum(_value(word) is not None for word in words)
    return len(words) > 1 and words[0].isdigit() and 2 * numbers > len(words)


def _read_eigenvalue(words: list[str], place: str, cycles: dict[int, float]) -> None:
    """Read a mode's line: number, [order of extraction,] eigenvalue, rad/s, Hz, [generalized mass, ...]."""
    at = 4 if len(words) == 7 else 3
    cycles[int(words[0])] = _number(words[at], "the frequency", place)
    if len(words) == 7:
        mass = _number(words[5], "the generalized mass", place)
        if abs(mass - 1.0) > _UNIT:
            raise BadModalTableError(
                f"{place}: the generalized mass of mode {words[0]} must be 1, got {mass:g}; "
                "have the code scale modes by mass (NORM = MASS)"
            )


def _value(word: str) -> float | None:
    """Return a finite number, as it is printed; None if it is none."""
    try:
        number = float(_SHORT.sub(r"\1e\2", word.strip().upper().replace("D", "E").replace("_", "?")))
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def _number(word: str, name: str, place: str) -> float:
    number = _value(word)
    if number is None:
        raise BadModalTableError(f"{place}: {name} must be a finite number, got {shown(word.strip())}")
    return number


def _positive(frequency: float, place: str) -> float:
    if not frequency > 0.0:
        raise BadModalTableError(
            f"{place}: frequency must be positive, got {frequency:g} Hz; "
            "a mode without one is a motion of the whole, which the link's joint has: hold the root"
        )
    return frequency
