"""Tables of numbers in text, in the layouts of spreadsheets, loggers and programs.

Detected unless given: the delimiter (``;``, tabulators, commas, else blanks), a decimal comma, the line of
names, units in it (``time [s]``, ``time (ms)``, ``Time/s``) or in a line beneath. Columns go by name,
capitals or not, whatever accompanies them. What could be read in two ways is refused, and nothing is
evaluated.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, TextIO

from antenna_pin.base.readable import decimal_in
from antenna_pin.base.units import QuantityError, any_quantity, scaled, shown, unit_factor
from antenna_pin.errors import FileFormatError

_SEPARATOR = re.compile(r'"?sep=(.)"?', re.IGNORECASE)  # the first line for Excel
_HEADING = re.compile(
    r"(?P<name>[^\[(/]*?)\s*(?:\[(?P<square>[^\]]*)\]|\((?P<round>.*)\)|/\s*(?P<slash>\S.*))?", re.DOTALL
)
_COMMA = re.compile(r"[+-]?([0-9]*),([0-9]+)(?:[eEdD][+-]?[0-9]+)?")
_POINT = re.compile(r"[+-]?[0-9]*\.[0-9]*(?:[eEdD][+-]?[0-9]+)?")
_FORTRAN = re.compile(r"(?<=[0-9.])[dD](?=[+-]?[0-9]+$)")
_FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n")  # what a cell begins with that a spreadsheet evaluates
_BRACKETS = re.compile(r"\s*([\[(][^\])]*[\])])")


class BadTableError(FileFormatError):
    """A table of numbers that cannot be read, with its line."""


class UnknownColumnError(BadTableError):
    """A table without a column of a name.

    Attributes:
        name: The column that is wanted.
        known: The names that there are.
        line: The line that they are in.
    """

    def __init__(self, wanted: Sequence[str], name: str, known: Sequence[str], line: int) -> None:
        """Compose the one-line message."""
        got = shown(",".join(known)) if known else "an empty file"
        super().__init__(f"line {max(line, 1)}: the header must have {','.join(wanted)}, got {got}")
        self.name, self.known, self.line = name, tuple(known), line


@dataclass(frozen=True, slots=True, kw_only=True)
class TextLayout:
    """Layout of a table in a text; None for what is to be detected.

    Attributes:
        delimiter: Sign between columns; a blank is any number of blanks.
        decimal: Decimal sign.
        comment: Beginning of lines that do not count.
        skip: Lines in front of the names [-].
        names: Names of the columns, where no line has them.
        units_row: Whether a line beneath the names has units.
        holes: Whether rows may be empty: all but those at the end count.
    """

    delimiter: str | None = None
    decimal: Literal[".", ","] | None = None
    comment: str = "#"
    skip: int = 0
    names: tuple[str, ...] | None = None
    units_row: bool | None = None
    holes: bool = False


class Cells(NamedTuple):
    """Cells of the columns that are wanted, (rows,) each.

    Attributes:
        text: Cells by the name that was wanted; numbers have a point and an E.
        units: Units that the text gives of columns.
        lines: Line of each row, from 1.
        header: Line of the names; 0 if none has them.
    """

    text: dict[str, list[str]]
    units: dict[str, str]
    lines: list[int]
    header: int


def read_cells(
    text: str,
    wanted: Sequence[str],
    layout: TextLayout | None = None,
    *,
    optional: Sequence[str] = (),
    headless: bool = True,
) -> Cells:
    """Return the cells of columns of a text.

    Args:
        text: The table.
        wanted: Names of the columns.
        layout: What is known of the layout.
        optional: Names of columns that may be absent.
        headless: Whether two columns may be read in their order from a text of two columns without names.

    Raises:
        UnknownColumnError: A column is absent.
        BadTableError: The table cannot be read, or could be read in two ways; with the line.
    """
    layout = layout or TextLayout()
    lines = text.removeprefix("\ufeff").splitlines()
    skip, delimiter = layout.skip, layout.delimiter
    separator = _SEPARATOR.fullmatch(lines[0].strip()) if lines else None
    if separator is not None and skip == 0:
        skip, delimiter = 1, delimiter or separator[1]
    delimiter = delimiter or _delimiter(lines[skip:], layout.comment)
    rows = _rows(lines, skip, delimiter, layout)
    line, first = next(rows, (0, []))
    header, is_headless = _header(first, line, lines, wanted, delimiter, layout, headless)
    if not header:
        raise UnknownColumnError(wanted, wanted[0], (), line)
    at = {name: _place(name, header, wanted, line) for name in wanted}
    at |= {name: _place(name, header, wanted, line) for name in optional if _is_there(name, header)}
    units = {name: unit for name, k in at.items() if (unit := _split(header[k])[1])}
    body = [(line, first)] if is_headless else []
    body += [(n, row) for n, row in rows if layout.holes or any(cell.strip() for cell in row)]
    while body and not any(cell.strip() for cell in body[-1][1]):
        body.pop()
    for n, row in body:
        _check_length(row, header, max(at.values()), n, delimiter)
    if body and _has_units(body[0][1], at, layout.units_row):
        units |= {name: _bare_unit(body[0][1][k]) for name, k in at.items()}
        body = body[1:]
    columns = {name: [row[k].strip() for _, row in body] for name, k in at.items()}
    numbers = [n for n, _ in body]
    decimal = layout.decimal or _decimal(columns, numbers, delimiter)
    if layout.decimal == ",":
        _check_points(columns, numbers)
    plain = {name: [_plain(cell, decimal) for cell in cells] for name, cells in columns.items()}
    return Cells(plain, units, numbers, 0 if is_headless else line)


def column_of(cells: Cells, name: str, unit: str | tuple[str, ...]) -> tuple[float, ...]:
    """Return a column in SI units, converted from its unit in the text.

    Raises:
        BadTableError: A cell is no finite number, or the unit is of something else.
    """
    factor = 1.0
    if name in cells.units:
        try:
            factor = unit_factor(cells.units[name], unit, f"the unit of column {name}")
        except QuantityError as error:
            raise BadTableError(str(error)) from None
    numbers = []
    for line, cell in zip(cells.lines, cells.text[name], strict=True):
        number = decimal_in(cell)
        if number is None:
            raise BadTableError(f"line {line}: {name} must be a finite number, got {shown(cell)}{hint(cell)}")
        numbers.append(number if factor == 1.0 else scaled(cell, factor))
    return tuple(numbers)


def write_csv(stream: TextIO, head: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
    """Write a table in CSV.

    A number is the shortest text that reads back as the same number, a cell without a value is empty. Text
    that a spreadsheet would evaluate as a formula, such as a joint's name ``=1+1``, has an apostrophe in
    front, which spreadsheets take as the sign of text.

    Args:
        stream: Opened with ``newline=""``.
        head: Names of the columns.
        rows: Numbers, texts, and lists of these.
    """
    writer = csv.writer(stream)
    writer.writerow([_csv_cell(name) for name in head])
    writer.writerows([_csv_cell(value) for value in row] for row in rows)


def _csv_cell(value: Any) -> Any:
    if value is None:
        return ""
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, (list, tuple)):
        return "; ".join(str(_csv_cell(each)) for each in value)
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, str) and value.startswith(_FORMULA) and decimal_in(value) is None:
        return f"'{value}"
    return value


def hint(cell: str) -> str:
    """Return the way out behind an invalid cell; "" without one."""
    if _COMMA.fullmatch(cell):
        return "; a decimal comma needs another delimiter, such as ;"
    return "; units stand in the header, as in time [s]" if any_quantity(cell) is not None else ""


def headings(text: str) -> list[str]:
    """Return the names in the first line of a text that counts, without units."""
    lines = text.removeprefix("\ufeff").splitlines()
    skip = 1 if lines and _SEPARATOR.fullmatch(lines[0].strip()) else 0
    layout = TextLayout()
    try:
        _, first = next(_rows(lines, skip, _delimiter(lines[skip:], layout.comment), layout), (0, []))
    except BadTableError:
        return []
    return [bare_name(cell) for cell in first]


def bare_name(heading: str) -> str:
    """Return the name in a column's heading, without the unit behind it."""
    return _split(heading)[0]


def _split(heading: str) -> tuple[str, str]:
    """Return name and unit of a heading such as ``time [s]``; unit "" without one."""
    heading = heading.strip()
    if heading.startswith("'") and heading[1:].startswith(_FORMULA):  # as :func:`write_csv` writes it
        heading = heading[1:]
    match = _HEADING.fullmatch(heading)
    if match is None or not match["name"]:
        return heading, ""
    if match["slash"] and any_quantity(f"1 {match['slash']}") is None:
        return heading, ""
    unit = match["square"] or match["round"] or match["slash"] or ""
    return match["name"].strip(), unit.strip()


def _delimiter(lines: Sequence[str], comment: str) -> str:
    """Return the sign between the columns of the first line that counts."""
    counting = (line for line in lines if line.strip() and not line.lstrip().startswith(comment))
    line = re.sub(r'"[^"]*"', "", next(counting, ""))
    return next((sign for sign in (";", "\t", ",") if sign in line), " ")


def _cells_of(lines: Sequence[str], delimiter: str) -> Iterator[tuple[int, list[str]]]:
    """Yield rows with the number of their last line, from 1."""
    if delimiter == " ":
        lines = [
            " ".join(_BRACKETS.sub(lambda match: match[1].replace(" ", "*"), line).split()) for line in lines
        ]
    reader = csv.reader(lines, delimiter=delimiter, skipinitialspace=delimiter != "\t")
    try:
        for row in reader:
            yield reader.line_num, row
    except csv.Error as error:  # a field of more than 131072 letters
        raise BadTableError(f"line {reader.line_num}: cannot be read: {error}") from None


def _rows(
    lines: Sequence[str], skip: int, delimiter: str, layout: TextLayout
) -> Iterator[tuple[int, list[str]]]:
    try:
        for number, row in _cells_of(lines[skip:], delimiter):
            if row and not row[0].lstrip().startswith(layout.comment):
                yield skip + number, row
    except BadTableError as error:
        at, _, reason = str(error).removeprefix("line ").partition(":")
        raise BadTableError(f"line {skip + int(at)}:{reason}") from None


def _header(
    row: list[str],
    line: int,
    lines: Sequence[str],
    wanted: Sequence[str],
    delimiter: str,
    layout: TextLayout,
    headless: bool,
) -> tuple[list[str], bool]:
    """Return the names of the columns, and whether the first row has numbers."""
    if layout.names is not None:
        return list(layout.names), bool(row)
    cells = [cell.strip() for cell in row]
    if not cells or any(cell and decimal_in(_plain(cell, ",")) is None for cell in cells):
        return cells, False
    for remark in reversed(lines[: line - 1]):  # as numpy.savetxt writes them
        bare = remark.strip().removeprefix(layout.comment).strip()
        names = [cell.strip() for _, other in _cells_of([bare], delimiter) for cell in other]
        if bare and all(_is_there(name, names) for name in wanted):
            return names, True
    while len(cells) > 2 and not cells[-1]:
        cells.pop()
    if headless and len(wanted) == len(cells) == 2:
        return list(wanted), True
    raise UnknownColumnError(wanted, wanted[0], cells, line)


def _is_there(name: str, header: Sequence[str]) -> bool:
    return any(name in (cell, bare_name(cell)) or bare_name(cell).lower() == name.lower() for cell in header)


def _place(name: str, header: Sequence[str], wanted: Sequence[str], line: int) -> int:
    """Return a column's index: by heading, by name, by name without regard to case."""
    bare = [bare_name(cell) for cell in header]
    lower = [cell.lower() for cell in bare]
    for key, names in ((name, list(header)), (name, bare), (name.lower(), lower)):
        if names.count(key) == 1:
            return names.index(key)
        if key in names:
            places = [str(k + 1) for k, one in enumerate(names) if one == key]
            rule = f"{name} must be the name of one column, got it of columns {' and '.join(places)}"
            raise BadTableError(f"line {line}: {rule}; give each column its own name")
    raise UnknownColumnError(wanted, name, header, line)


def _check_length(row: Sequence[str], header: Sequence[str], last: int, line: int, delimiter: str) -> None:
    """Refuse a row longer than the header, or without a required column."""
    count = len(row)
    while count > len(header) and not row[count - 1].strip():  # a delimiter at the end is no cell
        count -= 1
    if last < count <= len(header):
        return
    hint = ""
    if delimiter == "," and count == 2 * len(header):
        hint = "; if commas are in numbers, have the file written with another delimiter"
    raise BadTableError(f"line {line}: must have {len(header)} values, got {count}{hint}")


def _has_units(row: Sequence[str], at: dict[str, int], of_layout: bool | None) -> bool:
    """Return whether a row contains units: by the layout, else if each column has one."""
    if of_layout is not None:
        return of_layout
    cells = [row[k].strip() for k in at.values()]
    if any(not cell or decimal_in(_plain(cell, ",")) is not None for cell in cells):
        return False
    return all(any_quantity(f"1 {_bare_unit(cell)}") is not None or cell in ("-", "[-]") for cell in cells)


def _bare_unit(cell: str) -> str:
    """Return the unit that a cell is, without brackets about it."""
    word = cell.strip()
    if len(word) > 1 and (word[0], word[-1]) in (("[", "]"), ("(", ")")):
        word = word[1:-1].strip()
    return word


def _decimal(columns: dict[str, list[str]], lines: Sequence[int], delimiter: str) -> Literal[".", ","]:
    """Return the decimal sign of cells, or refuse ambiguous numbers."""
    pointed = any(_POINT.fullmatch(cell) for cells in columns.values() for cell in cells)
    doubtful = ""
    for name, cells in columns.items():
        for line, cell in zip(lines, cells, strict=True):
            comma = _COMMA.fullmatch(cell) if "," in cell else None
            if comma is None or delimiter == ",":
                continue
            if pointed:
                rule = f"{name} must be a finite number, got {shown(cell)} where others have a point"
                raise BadTableError(
                    f"line {line}: {rule}; write all with one decimal sign and without thousands"
                )
            if len(comma[2]) != 3 or not comma[1].lstrip("0"):
                return ","
            rule = f"{name} must be a number in one reading, got {shown(cell)}, of decimals or thousands"
            doubtful = doubtful or f"line {line}: {rule}; write a point, or no thousands"
    if doubtful:
        raise BadTableError(doubtful)
    return "."


def _check_points(columns: dict[str, list[str]], lines: Sequence[int]) -> None:
    """Refuse a number with a point where the layout has commas."""
    for name, cells in columns.items():
        for line, cell in zip(lines, cells, strict=True):
            if _POINT.fullmatch(cell):
                rule = f'must be a number with a comma, got {shown(cell)}; if it is one, give decimal = "."'
                raise BadTableError(f"line {line}: {name} {rule}")


def _plain(cell: str, decimal: str) -> str:
    """Return a number with a point and an E; what is none as it is."""
    plain = cell.strip()
    if decimal == "," and _COMMA.fullmatch(plain):
        plain = plain.replace(",", ".")
    return _FORTRAN.sub("E", plain)
