"""Modal data from text: CSV, or the tables that NASTRAN and its kin print.

CSV has the header ``frequency,damping_ratio,tx,ty,tz,rx,ry,rz``, of which ``damping_ratio`` may be left out.

A printed table is known by its heading, MODAL PARTICIPATION FACTORS, letters spaced out or not. Below it, a
line names the columns, ``T1 T2 T3 R1 R2 R3`` or ``X-COMPONENT`` to ``Z-ROTATION``, with FREQUENCY or without;
then frequencies are the CYCLES of the REAL EIGENVALUES (EIGENVALUE OUTPUT) before it, which must be those of
their RADIANS and eigenvalue, to the digits printed. Anything else, headings of pages in between too, is
skipped. Numbers may be written the short way, ``1.25-3``, or with a D.
"""

from __future__ import annotations

import csv
import decimal
import math
import re
from collections.abc import Container
from dataclasses import dataclass
from typing import Any

from antenna_pin.errors import FileFormatError
from antenna_pin.numerals import decimal_in, whole_in
from antenna_pin.parameters import RULES, SWINGS
from antenna_pin.units import shown

__all__ = ["BadModalTableError", "ModalTable", "read_modal_table"]

_CSV = ("frequency", "damping_ratio", "tx", "ty", "tz", "rx", "ry", "rz")
_SHORT = re.compile(r"([0-9.])([+-][0-9]+)$")  # 1.25-3 for 1.25e-3
_AXES = (
    ("T1", "T2", "T3", "R1", "R2", "R3"),
    ("X-COMPONENT", "Y-COMPONENT", "Z-COMPONENT", "X-ROTATION", "Y-ROTATION", "Z-ROTATION"),
)
# What a row of eigenvalues has, by how many numbers: NASTRAN's, and Abaqus'.
_EIGENVALUES = {
    7: (
        "MODE",
        "ORDER",
        "EIGENVALUE",
        "RADIANS",
        "CYCLES",
        "GENERALIZED MASS",
        "GENERALIZED STIFFNESS",
    ),
    6: ("MODE", "EIGENVALUE", "RADIANS", "CYCLES", "GENERALIZED MASS", "COMPOSITE DAMPING"),
}
# Letters alone that make a line the heading of another table.
_SPACED = 6
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
    seen: dict[tuple[float, ...], int] = {}
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
        before = seen.setdefault(tuple(numbers), rows.line_num)
        if before != rows.line_num:
            raise BadModalTableError(f"{place}: a mode must stand once, got that of line {before} again")
        frequency.append(_positive(numbers[0], place))
        if len(header) == len(_CSV):
            if not RULES[SWINGS](numbers[1]):
                raise BadModalTableError(
                    f"{place}: damping_ratio must be {SWINGS}, got {numbers[1]:g}; 2 % are 0.02"
                )
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
    cycles: dict[int, _Printed] = {}
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
        elif sum(len(word) == 1 and word.isalpha() for word in words) >= _SPACED:
            section, columns = "", 0
        elif section == "factors" and tuple(words[-6:]) in _AXES:
            columns = 8 if "FREQUENCY" in words else 7
        elif section == "factors" and columns and _is_row(words):
            if len(words) != columns:
                raise BadModalTableError(f"{place}: must have {columns} numbers, got {len(words)}")
            mode = _new_mode(words[0], lines, place)
            values = [_number(word, "a factor", place) for word in words[1:]]
            if columns == 8:
                own, other = _printed(words[1], "FREQUENCY", place), cycles.get(mode)
                if other is not None and not own.is_like(other.number, other.step):
                    raise BadModalTableError(
                        f"{place}: FREQUENCY of mode {mode} must be its CYCLES among the REAL EIGENVALUES, "
                        f"{other.number:g} Hz, got {own.number:g}"
                    )
                cycles[mode] = own
            factors[mode], lines[mode] = _factors(values[-6:], place), number
        elif section == "eigenvalues" and _is_row(words):
            cycles[_new_mode(words[0], cycles, place)] = _eigenvalue(words, place)
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
        tuple(_positive(cycles[mode].number, f"line {lines[mode]}") for mode in order),
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
    return len(words) > 1 and whole_in(words[0]) is not None and 2 * numbers > len(words)


def _new_mode(word: str, known: Container[int], place: str) -> int:
    """Return a mode's number, or refuse one that the table has had."""
    mode = whole_in(word)
    assert mode is not None
    if mode in known:
        raise BadModalTableError(
            f"{place}: mode {mode} must stand once, got it again; keep one subcase in the file"
        )
    return mode


@dataclass(frozen=True, slots=True)
class _Printed:
    """A number, and one of its last digit, by which it may be off."""

    number: float
    step: float

    def is_like(self, other: float, step: float) -> bool:
        """Whether a number, known to a step, is this one."""
        return abs(self.number - other) <= 1.001 * (self.step + step)


def _printed(word: str, name: str, place: str) -> _Printed:
    number = _number(word, name, place)
    exponent = decimal.Decimal(_as_written(word)).as_tuple().exponent
    return _Printed(number, float(f"1e{exponent}"))


def _eigenvalue(words: list[str], place: str) -> _Printed:
    """Return the frequency [Hz] of a mode's line, whose numbers must say the same."""
    columns = _EIGENVALUES.get(len(words))
    if columns is None:
        *first, last = (f"{count} ({', '.join(names)})" for count, names in _EIGENVALUES.items())
        raise BadModalTableError(
            f"{place}: a row of the REAL EIGENVALUES must have {', '.join(first)} or {last} numbers, "
            f"got {len(words)}"
        )
    row = {name: _printed(word, name, place) for name, word in zip(columns, words, strict=True)}
    value, radians, cycles = row["EIGENVALUE"], row["RADIANS"], row["CYCLES"]
    mass = row["GENERALIZED MASS"].number
    if abs(mass - 1.0) > _UNIT:
        raise BadModalTableError(
            f"{place}: the generalized mass of mode {words[0]} must be 1, got {mass:g}; "
            "have the code scale modes by mass (NORM = MASS)"
        )
    if not _Printed(abs(value.number), value.step).is_like(
        radians.number**2, 2.0 * abs(radians.number) * radians.step + radians.step**2
    ):
        raise BadModalTableError(
            f"{place}: RADIANS of mode {words[0]} must be the root of its EIGENVALUE, "
            f"{math.sqrt(abs(value.number)):.7g} rad/s, got {radians.number:.7g}"
        )
    if not cycles.is_like(radians.number / math.tau, radians.step / math.tau):
        raise BadModalTableError(
            f"{place}: CYCLES of mode {words[0]} must be its RADIANS over 2 pi, "
            f"{radians.number / math.tau:.7g} Hz, got {cycles.number:.7g}"
        )
    # A code prints the root of what is below zero, too.
    return _Printed(math.copysign(cycles.number, value.number), cycles.step)


def _as_written(word: str) -> str:
    """Return a number as printed tables write it, with an E."""
    return _SHORT.sub(r"\1E\2", word.strip().upper().replace("D", "E"))


def _value(word: str) -> float | None:
    """Return a finite number, as it is printed; None if it is none."""
    return decimal_in(_as_written(word))


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
