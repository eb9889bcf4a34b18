"""Modal data of structures from text: CSV, and tables printed by finite-element codes.

NASTRAN, MYSTRAN, Abaqus, CalculiX: a table under (MODAL) PARTICIPATION FACTORS, letters spaced out or not.
Below it a line names the columns, ``T1 T2 T3 R1 R2 R3`` or ``X-COMPONENT`` to ``Z-ROTATION``, in any order,
with FREQUENCY or CYCLES or without; then frequencies are the CYCLES of the REAL EIGENVALUES (EIGENVALUE
OUTPUT) before it, which must be those of their RADIANS and eigenvalue, to the digits printed. Ansys: a table
under PARTICIPATION FACTOR CALCULATION for each DIRECTION, X to ROTZ, with FREQUENCY, PARTIC.FACTOR and
EFFECTIVE MASS, which must be the factor's square. Anything else is skipped, headings of pages too. Numbers
may be written the short way, ``1.25-3``, or with a D.
"""

from __future__ import annotations

import decimal
import math
import re
from collections.abc import Container, Sequence
from dataclasses import dataclass, field

from antenna_pin.base.readable import alternatives, decimal_in, whole_in
from antenna_pin.base.rules import SWINGS, obeys
from antenna_pin.base.tables import BadTableError, column_of, headings, read_cells
from antenna_pin.base.units import shown
from antenna_pin.errors import FileFormatError
from antenna_pin.mechanism.flexible.modal_data import FACTORS

# --- modal tables -------------------------------------------------------------------------------------------


class BadModalTableError(FileFormatError):
    """Modal data that cannot be read, with the line."""


@dataclass(frozen=True, slots=True)
class ModalTable:
    """Modal data as a file gives them.

    Attributes:
        frequency: Of each mode [Hz].
        participation: Six numbers for each mode, one mode after the other [sqrt(kg)], [sqrt(kg) m].
        damping_ratio: Of each mode [-]; None where the file does not say.
        lines: Of each mode's factors in the file, from 1.
        reading: Headings and lines that the numbers were taken from, as text.
    """

    frequency: tuple[float, ...]
    participation: tuple[float, ...]
    damping_ratio: tuple[float, ...] | None
    lines: tuple[int, ...]
    reading: str


def checked_factors(numbers: list[float], place: str) -> list[float]:
    """Return the six factors of a mode, or refuse a mode that no hub feels."""
    if not any(numbers):
        raise BadModalTableError(
            f"{place}: {FACTORS[0]} to {FACTORS[-1]} must be other than six zeros, which no hub feels; "
            "leave the mode out"
        )
    return numbers


def checked_frequency(frequency: float, place: str) -> float:
    """Return the frequency of a mode [Hz], or refuse one that does not swing."""
    if not frequency > 0.0:
        raise BadModalTableError(
            f"{place}: frequency must be positive, got {frequency:g} Hz; "
            "a mode without one is a motion of the whole, which the link's joint has: hold the root"
        )
    return frequency


# --- tables printed by finite-element codes -----------------------------------------------------------------

_SHORT = re.compile(r"([0-9.])([+-][0-9]+)$")  # 1.25-3 for 1.25e-3
_AXES = (
    ("T1", "T2", "T3", "R1", "R2", "R3"),
    ("X-COMPONENT", "Y-COMPONENT", "Z-COMPONENT", "X-ROTATION", "Y-ROTATION", "Z-ROTATION"),
)
_DIRECTIONS = ("X", "Y", "Z", "ROTX", "ROTY", "ROTZ")
_NO_COLUMNS = frozenset({"NO.", "NO", "NUM", "NUMBER", "(HZ)", "[HZ]"})  # words behind the names of columns
# Columns of the eigenvalues by their order: NASTRAN's and MYSTRAN's, Abaqus', CalculiX's.
_EIGENVALUES = {
    7: ("MODE", "ORDER", "EIGENVALUE", "RADIANS", "CYCLES", "GENERALIZED MASS", "GENERALIZED STIFFNESS"),
    6: ("MODE", "EIGENVALUE", "RADIANS", "CYCLES", "GENERALIZED MASS", "COMPOSITE DAMPING"),
    5: ("MODE", "EIGENVALUE", "RADIANS", "CYCLES", "IMAGINARY PART"),
}
# Three that say the same, in that order; words of a heading that has another order.
_SAME = ("EIGENVALUE", "RADIANS", "CYCLES")
_HEADINGS = re.compile(
    r"(?P<mode>\bMODE\b(?! DAMPING))|(?P<order>\bORDER\b)|(?P<value>\bEIGENVALUE\b)|(?P<radians>\bRADIANS\b)"
    r"|(?P<cycles>\bCYCLES\b(?!/))|(?P<mass>\bMASS\b)|(?P<stiffness>\bSTIFFNESS\b)"
)
_OF_HEADINGS = dict(
    zip(("mode", "order", "value", "radians", "cycles", "mass", "stiffness"), _EIGENVALUES[7], strict=True)
)
_ANSYS = re.compile(r"PARTICIPATION FACTOR CALCULATION\W*\b(X|Y|Z|ROTX|ROTY|ROTZ)\s+DIRECTION")
_ANSYS_HEADINGS = re.compile(
    r"MODE|FREQUENCY|PERIOD|PARTIC\.\s?FACTOR|EFFECTIVE MASS|MASS FRACTION|RATIO|TO TOTAL MASS"
)
# Letters alone that make a line the heading of another table.
_SPACED = 6
# A generalized mass that is one, as printed tables round it.
_UNIT = 1e-4


@dataclass(frozen=True, slots=True)
class _Printed:
    """A number, and one of its last digit, by which it may be off."""

    number: float
    step: float

    def is_like(self, other: float, step: float) -> bool:
        """Return whether a number, known to a step, is this one."""
        return abs(self.number - other) <= 1.001 * (self.step + step)


@dataclass(slots=True)
class _Reader:
    """Numbers read so far, by mode number; a table may continue over pages."""

    cycles: dict[int, _Printed] = field(default_factory=dict)
    factors: dict[int, list[float | None]] = field(default_factory=dict)
    lines: dict[int, int] = field(default_factory=dict)
    reading: list[str] = field(default_factory=list)
    section: str = ""
    columns: tuple[str, ...] = ()
    headings: list[str] = field(default_factory=list)

    def begin(self, section: str) -> None:
        """Begin a table."""
        self.section, self.columns, self.headings = section, (), []

    def read(self, line: str, number: int) -> None:
        """Read the next line."""
        words, squeezed, place = line.split(), "".join(line.split()), f"line {number}"
        if ansys := _ANSYS.search(line):
            self.begin(ansys[1])
        elif "PARTICIPATIONFACTORS" in squeezed and "FORFREQUENCY" not in squeezed:
            self.begin("factors")
        elif "REALEIGENVALUES" in squeezed or "EIGENVALUEOUTPUT" in squeezed:
            self.begin("eigenvalues")
        elif self.section in _DIRECTIONS:
            if "MODE" in words and "FREQUENCY" in words:
                self.columns = tuple(_ANSYS_HEADINGS.findall(line))
                self.note(f"{self.section} DIRECTION", number)
            elif self.columns and _is_row(words):
                self.read_direction(words, place, number)
            elif re.search(r"EFFECTIVE\s+MASSES|\*{3}", line):
                self.begin("")
        elif re.search(r"EFFECTIVE(MODAL)?(MASS|WEIGHT)", squeezed):
            self.begin("")
        elif sum(len(word) == 1 and word.isalpha() for word in words) >= _SPACED:
            self.begin("")
        elif self.section == "factors" and any(set(axes) <= set(words) for axes in _AXES):
            names = ("FREQUENCY" if word.startswith("FREQ") else word for word in words)
            self.columns = tuple(dict.fromkeys(("MODE",) * ("MODE" not in words) + tuple(names)))
            self.columns = tuple(name for name in self.columns if name not in _NO_COLUMNS)
            self.note(" ".join(self.columns), number)
        elif self.section == "factors" and self.columns and _is_row(words):
            self.read_factors(words, place, number)
        elif self.section == "eigenvalues" and _is_row(words):
            if not self.columns:
                self.columns = _order(self.headings, len(words))
                self.note("CYCLES of the eigenvalues", number)
            mode = _new_mode(words[0], self.cycles, place)
            self.cycles[mode] = _eigenvalue(words, self.columns, place)
        elif self.section == "eigenvalues":
            self.headings.append(line)

    def note(self, heading: str, number: int) -> None:
        """Note where a table begins, once; pages repeat its heading."""
        if not any(one.startswith(heading) for one in self.reading):
            self.reading.append(f"{heading} (line {number})")

    def read_factors(self, words: Sequence[str], place: str, number: int) -> None:
        """Read a mode's factors of all directions."""
        if len(words) != len(self.columns):
            raise BadModalTableError(f"{place}: must have {len(self.columns)} numbers, got {len(words)}")
        row = dict(zip(self.columns, words, strict=True))
        mode = _new_mode(row["MODE"], self.lines, place)
        axes = next(axes for axes in _AXES if axes[0] in row)
        values = [_number(row[axis], "a factor", place) for axis in axes]
        for name in ("FREQUENCY", "CYCLES"):
            if name in row:
                self.compare(mode, _printed(row[name], name, place), name, place)
        self.factors[mode], self.lines[mode] = [*checked_factors(values, place)], number

    def read_direction(self, words: Sequence[str], place: str, number: int) -> None:
        """Read a mode's factor of one direction."""
        if len(words) != len(self.columns):
            raise BadModalTableError(f"{place}: must have {len(self.columns)} numbers, got {len(words)}")
        row = dict(zip((one.replace(". ", ".") for one in self.columns), words, strict=True))
        factor = _printed(row.get("PARTIC.FACTOR", ""), "PARTIC.FACTOR", place)
        mode = _new_mode(row["MODE"], (), place)
        values, k = self.factors.setdefault(mode, [None] * 6), _DIRECTIONS.index(self.section)
        if values[k] is not None:
            raise BadModalTableError(
                f"{place}: mode {mode} must stand once in direction {self.section}, got it again; "
                "keep one load step in the file"
            )
        if "EFFECTIVE MASS" in row:
            mass = _printed(row["EFFECTIVE MASS"], "EFFECTIVE MASS", place)
            square, step = factor.number**2, 2.0 * abs(factor.number) * factor.step + factor.step**2
            if not mass.is_like(square, step):
                raise BadModalTableError(
                    f"{place}: EFFECTIVE MASS of mode {mode} must be the square of its PARTIC.FACTOR, "
                    f"{square:.7g}, got {mass.number:.7g}; have modes scaled by mass (Nrmkey of MODOPT)"
                )
        self.compare(mode, _printed(row["FREQUENCY"], "FREQUENCY", place), "FREQUENCY", place)
        values[k] = factor.number
        self.lines.setdefault(mode, number)

    def compare(self, mode: int, own: _Printed, name: str, place: str) -> None:
        """Refuse a frequency that contradicts the mode's other entries in the file."""
        other = self.cycles.setdefault(mode, own)
        if not own.is_like(other.number, other.step):
            where = (
                "in the other tables"
                if self.section in _DIRECTIONS
                else "its CYCLES among the REAL EIGENVALUES"
            )
            raise BadModalTableError(
                f"{place}: {name} of mode {mode} must be {where}, {other.number:g} Hz, got {own.number:g}"
            )


def read_printed(text: str, or_else: str) -> ModalTable:
    """Return the modes of a printed table.

    Raises:
        BadModalTableError: There is no such table, or a line is not what it should be.
    """
    reader = _Reader()
    for number, line in enumerate(text.upper().splitlines(), start=1):
        reader.read(line, number)
    factors, lines, cycles = reader.factors, reader.lines, reader.cycles
    if not factors:
        raise BadModalTableError(
            f"line 1: must be {or_else}, or have a table under the heading MODAL PARTICIPATION FACTORS with "
            "columns T1 to R3 or X-COMPONENT to Z-ROTATION, or one PARTICIPATION FACTOR CALCULATION for each "
            "DIRECTION, got neither"
        )
    for mode, values in factors.items():
        lacking = [name for name, one in zip(_DIRECTIONS, values, strict=True) if one is None]
        if lacking:
            raise BadModalTableError(
                f"line {lines[mode]}: mode {mode} must have a factor in each DIRECTION, got none in "
                f"{', '.join(lacking)}"
            )
        if mode not in cycles:
            raise BadModalTableError(
                f"mode {mode} of the participation factors must have a frequency, in a column FREQUENCY or "
                "CYCLES or among the REAL EIGENVALUES, got none"
            )
    numbers = [[one for one in values if one is not None] for values in factors.values()]
    return ModalTable(
        tuple(checked_frequency(cycles[mode].number, f"line {lines[mode]}") for mode in factors),
        tuple(
            one
            for mode, values in zip(factors, numbers, strict=True)
            for one in checked_factors(values, f"line {lines[mode]}")
        ),
        None,
        tuple(lines[mode] for mode in factors),
        ", ".join(reader.reading),
    )


def _is_row(words: Sequence[str]) -> bool:
    """Return true for a line of a table; page headings have words after their number."""
    numbers = sum(_value(word) is not None for word in words)
    return len(words) > 1 and whole_in(words[0]) is not None and 2 * numbers > len(words)


def _order(headings: Sequence[str], count: int) -> tuple[str, ...]:
    """Return the columns of eigenvalues, by the heading or by their count."""
    for line in headings:
        names = tuple(_OF_HEADINGS[str(word.lastgroup)] for word in _HEADINGS.finditer(line))
        own = [name for name in names if name in _SAME]
        if len(names) == count and sorted(own) == sorted(_SAME) and own != list(_SAME):
            return names
    return _EIGENVALUES.get(count, ())


def _new_mode(word: str, known: Container[int], place: str) -> int:
    """Return a mode's number, or refuse one that the table has had."""
    mode = whole_in(word)
    if mode is None:
        raise BadModalTableError(f"{place}: MODE must be a whole number, got {shown(word)}")
    if mode in known:
        raise BadModalTableError(
            f"{place}: mode {mode} must appear once, got a second one; keep one subcase in the file"
        )
    return mode


def _printed(word: str, name: str, place: str) -> _Printed:
    number = _number(word, name, place)
    exponent = decimal.Decimal(_as_written(word)).as_tuple().exponent
    return _Printed(number, float(f"1e{exponent}"))


def _eigenvalue(words: Sequence[str], columns: Sequence[str], place: str) -> _Printed:
    """Return the frequency [Hz] of a mode's line, checked against its other numbers."""
    if len(words) != len(columns):
        counts = (f"{count} ({', '.join(names)})" for count, names in _EIGENVALUES.items())
        raise BadModalTableError(
            f"{place}: a row of the REAL EIGENVALUES must have {alternatives(counts)} numbers, "
            f"got {len(words)}"
        )
    row = {name: _printed(word, name, place) for name, word in zip(columns, words, strict=True)}
    value, radians, cycles = row["EIGENVALUE"], row["RADIANS"], row["CYCLES"]
    if "GENERALIZED MASS" in row and abs(row["GENERALIZED MASS"].number - 1.0) > _UNIT:
        raise BadModalTableError(
            f"{place}: the generalized mass of mode {words[0]} must be 1, got "
            f"{row['GENERALIZED MASS'].number:g}; have the code scale modes by mass (NORM = MASS)"
        )
    if "IMAGINARY PART" in row and row["IMAGINARY PART"].number != 0.0:
        raise BadModalTableError(
            f"{place}: the frequency of mode {words[0]} must be real, got an imaginary part of "
            f"{row['IMAGINARY PART'].number:g} rad/s; hold the root, and leave out what buckles"
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


# --- text files ---------------------------------------------------------------------------------------------

_FREQUENCY, _DAMPING = "frequency", "damping_ratio"
_UNITS = dict(zip(FACTORS, ("kg**0.5",) * 3 + ("kg**0.5*m",) * 3, strict=True))


def read_modal_table(text: str) -> ModalTable:
    """Return the modes of a file's text, CSV or a printed table.

    Raises:
        BadModalTableError: It is neither, or a line is not what it should be.
    """
    if _FREQUENCY not in [name.lower() for name in headings(text)]:
        return read_printed(text, f"CSV with the header {_FREQUENCY},{_DAMPING},{','.join(FACTORS)}")
    try:
        return _of_csv(text)
    except BadTableError as error:
        raise BadModalTableError(str(error)) from None


def _of_csv(text: str) -> ModalTable:
    cells = read_cells(text, (_FREQUENCY, *FACTORS), optional=(_DAMPING,), headless=False)
    frequency = column_of(cells, _FREQUENCY, "Hz")
    columns = [column_of(cells, name, unit) for name, unit in _UNITS.items()]
    damping = column_of(cells, _DAMPING, "1") if _DAMPING in cells.text else None
    if not frequency:
        raise BadModalTableError(
            f"line {cells.header}: must have at least one mode below the header, got none"
        )
    participation: list[float] = []
    before: dict[tuple[float, ...], int] = {}
    for k, line in enumerate(cells.lines):
        place, factors = f"line {line}", [column[k] for column in columns]
        checked_frequency(frequency[k], place)
        participation += checked_factors(factors, place)
        if damping is not None and not obeys(damping[k], SWINGS):
            raise BadModalTableError(
                f"{place}: {_DAMPING} must be {SWINGS}, got {damping[k]:g}; 2 % are 0.02"
            )
        first = before.setdefault((frequency[k], *factors), line)
        if first != line:
            raise BadModalTableError(f"{place}: a mode must stand once, got that of line {first} again")
    reading = f"columns {', '.join(cells.text)} under line {cells.header}"
    return ModalTable(frequency, tuple(participation), damping, tuple(cells.lines), reading)
