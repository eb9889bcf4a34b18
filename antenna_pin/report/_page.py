"""What a page is made of: sections of text, tables, pictures, recordings. Templates draw them."""

from __future__ import annotations

import base64
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from antenna_pin.analysis import ROUND_OFF_WORDS, is_round_off
from antenna_pin.base.readable import number, prefixed, readable
from antenna_pin.plot import Drawn

__all__ = [
    "Beside",
    "Cell",
    "Details",
    "Embedded",
    "Item",
    "Picture",
    "Row",
    "Section",
    "Statement",
    "Table",
    "ZERO",
    "counts",
    "quantities",
    "quantity",
    "said_of_zeros",
    "shares_row",
    "turned",
    "words",
]


ZERO = "≈ 0"
"""What stands for a number that is zero to round-off."""

_SHORT = 24


@dataclass(frozen=True, slots=True)
class Cell:
    """One entry of a table.

    Attributes:
        text: As it is printed.
        value: The number behind it, in SI units; None for words.
    """

    text: str
    value: float | None = None


@dataclass(frozen=True, slots=True)
class Row:
    """A row of a table; one without cells is a heading over the rows below it."""

    name: str
    cells: tuple[Cell, ...] = ()
    unit: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A table.

    Attributes:
        columns: Headings of the columns, the first of the rows' names among them.
        rows: From top to bottom.
        caption: What it shows.
        key: Name by which it is found in the page.
        dense: Whether it has so many rows that it is set small.
    """

    columns: tuple[str, ...]
    rows: tuple[Row, ...]
    caption: str = ""
    key: str = ""
    dense: bool = False
    kind: str = field(default="table", init=False)

    @property
    def short(self) -> bool:
        """Whether it is to stay on one page of paper."""
        return len(self.rows) <= _SHORT


@dataclass(frozen=True, slots=True, kw_only=True)
class Statement:
    """One thing said of the runs.

    Attributes:
        label: What it is about.
        texts: Names of runs, and what is said of them; no names if the same holds for all.
        code: Whether it is to be typed, or the name of a file.
    """

    label: str
    texts: tuple[tuple[tuple[str, ...], str], ...]
    code: bool = False


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Picture:
    """A figure.

    Attributes:
        svg: Its file.
        packed: The same as the page's script unpacks it.
        caption: What it shows, in words that also do for those who cannot see it.
        size: Width and height at which it was drawn [mm].
        key: Name by which it is found in the page.
        name: Its short name, beside others of a section; its caption if empty.
        numbers: What it shows as numbers.
        plain: Whether it is in the page as it is, so that it is seen where no script runs.
    """

    svg: bytes
    packed: str
    caption: str
    size: tuple[float, float] = (180.0, 100.0)
    key: str = ""
    name: str = ""
    numbers: Sequence[Drawn] = ()
    plain: bool = False
    kind: str = field(default="picture", init=False)

    @property
    def source(self) -> str:
        """A ``data:`` address."""
        return "data:image/svg+xml;base64," + base64.b64encode(self.svg).decode()


@dataclass(frozen=True, slots=True, kw_only=True)
class Embedded:
    """A recording: a part of the page that the viewer's own room made.

    Attributes:
        html: Its markup, which is safe as it stands.
        caption: What it shows.
    """

    html: str
    caption: str
    kind: str = field(default="recording", init=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class Beside:
    """A table, and what is seen beside it where the screen is wide enough.

    Attributes:
        table: The table.
        seen: Recordings and pictures.
    """

    table: Table
    seen: tuple[Embedded | Picture, ...] = ()
    kind: str = field(default="beside", init=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class Details:
    """What is shown when asked for: tables, or text as it stands in a file.

    Attributes:
        title: What is in it.
        tables: Tables, or nothing.
        text: Text set as code, or nothing.
        notes: What the numbers mean.
        key: Name by which it is found in the page.
    """

    title: str
    tables: tuple[Table, ...] = ()
    text: str = ""
    notes: tuple[str, ...] = ()
    key: str = ""
    kind: str = field(default="details", init=False)


Item: TypeAlias = Table | Picture | Embedded | Beside | Details


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """A part of the page under a heading.

    Attributes:
        key: Its address in the page.
        title: Its heading.
        lead: What is to be known before the rest, one paragraph each.
        statements: Facts by label.
        items: Tables, pictures, recordings and details, in order.
        notes: What is missing and why.
        meaning: What the numbers mean; shown when asked for.
        parts: Sections within it.
        folded: Whether all of it is shown when asked for, and on paper.
    """

    key: str
    title: str
    lead: tuple[str, ...] = ()
    statements: tuple[Statement, ...] = ()
    items: tuple[Item, ...] = ()
    notes: tuple[str, ...] = ()
    meaning: tuple[str, ...] = ()
    parts: tuple[Section, ...] = ()
    folded: bool = False

    @property
    def empty(self) -> bool:
        """Whether there is nothing under the heading."""
        return not (self.lead or self.statements or self.items or self.notes or self.parts)

    @property
    def pictures(self) -> tuple[Picture, ...]:
        """All figures in it."""
        beside = (seen for item in self.items if isinstance(item, Beside) for seen in item.seen)
        return tuple(one for one in (*self.items, *beside) if isinstance(one, Picture))


def quantities(
    name: str,
    values: Sequence[float | None],
    unit: str = "1",
    digits: int = 4,
    scales: Mapping[str, float] | None = None,
) -> Row:
    """Return a row of numbers with one prefix for all; what is None or not finite is a dash.

    Args:
        name: Of the row.
        values: One per column, in the SI unit.
        unit: Their SI unit.
        digits: Significant digits.
        scales: Of the runs, by which numbers may be zero to round-off; none is if not given.
    """
    still = [is_round_off(value, unit, scales or {}) for value in values]
    factor, printed = prefixed(unit, [v for v, zero in zip(values, still, strict=True) if not zero])
    cells = (
        Cell(ZERO, value) if zero else _cell(value, factor, digits)
        for value, zero in zip(values, still, strict=True)
    )
    return Row(name, tuple(cells), printed)


def quantity(
    value: float | None, unit: str = "1", digits: int = 4, scales: Mapping[str, float] | None = None
) -> Cell:
    """Return a cell with a number and its unit; ``scales`` as for :func:`quantities`."""
    if is_round_off(value, unit, scales or {}):
        return Cell(ZERO, value)
    if value is None or not math.isfinite(value):
        return Cell(number(None))
    return Cell(readable(value, unit, digits), value)


def said_of_zeros(tables: Iterable[Table]) -> tuple[str, ...]:
    """Return what the sign of zero means, as notes of a section, where its tables have one."""
    cells = (cell for table in tables for row in table.rows for cell in row.cells)
    return (f"{ROUND_OFF_WORDS}.",) if any(cell.text == ZERO for cell in cells) else ()


def shares_row(name: str, shares: Sequence[float | None]) -> Row:
    """Return a row of shares in per cent."""
    cells = tuple(Cell(number(None if s is None else 100.0 * s, 3), s) for s in shares)
    return Row(name, cells, "%")


def counts(name: str, values: Iterable[int | None]) -> Row:
    """Return a row of whole numbers."""
    return Row(name, tuple(Cell(number(None)) if v is None else Cell(str(v), float(v)) for v in values))


def words(name: str, texts: Iterable[str]) -> Row:
    """Return a row of words."""
    return Row(name, tuple(Cell(text or number(None)) for text in texts))


def _cell(value: float | None, factor: float, digits: int) -> Cell:
    if value is None or math.isnan(value):
        return Cell(number(None))
    return Cell(number(value * factor, digits), value)


# Groups up to which a table stays as it is.
_FEW = 2
_SPACE = "\N{NO-BREAK SPACE}"


def turned(table: Table) -> Table:
    """Return a table whose groups of rows are lines, one for each thing and run, if there are many groups.

    One of few groups, or of groups of different rows, stays as it is. What is zero or missing in all is left
    out, but for the first quantity.

    Args:
        table: With a group of rows for each thing, its columns being runs.
    """
    groups = _groups(table.rows)
    names = [tuple(row.name for row in rows) for _, rows in groups]
    if len(groups) <= _FEW or len(set(names)) > 1 or not names[0]:
        return table
    told = [k for k in range(len(names[0])) if k == 0 or any(_tells(rows[k]) for _, rows in groups)]
    shared = [len({rows[k].unit for _, rows in groups}) == 1 for k in told]
    heads = [
        f"{names[0][k]} [{groups[0][1][k].unit.replace(' ', _SPACE)}]"
        if same and groups[0][1][k].unit
        else names[0][k]
        for k, same in zip(told, shared, strict=True)
    ]
    runs = table.columns[1:]
    lines = [
        Row(
            f"{name}, {run}" if len(runs) > 1 else name,
            tuple(
                rows[k].cells[j] if same else _with_unit(rows[k].cells[j], rows[k].unit)
                for k, same in zip(told, shared, strict=True)
            ),
        )
        for name, rows in groups
        for j, run in enumerate(runs)
    ]
    return Table(columns=("", *heads), rows=tuple(lines), caption=table.caption, key=table.key)


def _groups(rows: Sequence[Row]) -> list[tuple[str, list[Row]]]:
    """Return headings with the rows below each."""
    found: list[tuple[str, list[Row]]] = []
    for row in rows:
        if not row.cells:
            found.append((row.name, []))
        elif found:
            found[-1][1].append(row)
    return found


def _tells(row: Row) -> bool:
    """Whether there is a number other than zero, or a word, in a row."""
    return any(cell.value if cell.value is not None else cell.text != number(None) for cell in row.cells)


def _with_unit(cell: Cell, unit: str) -> Cell:
    if cell.text in (number(None), ZERO) or not unit:
        return cell
    return Cell(f"{cell.text}{_SPACE}{unit}", cell.value)
