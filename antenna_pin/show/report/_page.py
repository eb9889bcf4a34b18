"""Parts of a page, for templates: sections of text, tables, pictures, recordings."""

from __future__ import annotations

import base64
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from antenna_pin.analysis import ROUND_OFF_WORDS, is_round_off
from antenna_pin.base.readable import number, prefixed, readable
from antenna_pin.show.plot import Drawn

ZERO = "≈ 0"
"""What stands for a number that is zero to round-off."""

_SHORT = 24


@dataclass(frozen=True, slots=True)
class Cell:
    """Entry of a table."""

    text: str
    value: float | None = None  # the number behind the text, in SI units; None for words


@dataclass(frozen=True, slots=True)
class Row:
    """Row of a table; without cells a heading over the rows below."""

    name: str
    cells: tuple[Cell, ...] = ()
    unit: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class PageTable:
    """Table."""

    columns: tuple[str, ...]  # headings, that of the rows' names first
    rows: tuple[Row, ...]
    caption: str = ""
    key: str = ""  # identifier in the page
    dense: bool = False  # of so many rows that it is set small
    sentences: bool = False  # of text: read from the left, and row below row on a phone
    kind: str = field(default="table", init=False)

    @property
    def short(self) -> bool:
        """Return whether the table stays on one page of paper."""
        return len(self.rows) <= _SHORT


@dataclass(frozen=True, slots=True, kw_only=True)
class Statement:
    """Statement on the runs."""

    label: str
    texts: tuple[tuple[tuple[str, ...], str], ...]  # labels of runs, none for all of them, and the text
    code: bool = False  # a command or the name of a file


def statement(label: str, text: str, code: bool = False) -> Statement:
    """Return a statement on all runs."""
    return Statement(label=label, texts=(((), text),), code=code)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Picture:
    """Figure."""

    svg: bytes
    packed: str  # the same for the page's script to unpack
    caption: str  # also for those who cannot see the figure
    size: tuple[float, float] = (180.0, 100.0)  # width and height [mm]
    key: str = ""  # identifier in the page
    name: str = ""  # short name beside others of a section; the caption if empty
    numbers: Sequence[Drawn] = ()
    plain: bool = False  # stands unpacked in the page, for readers without scripts
    kind: str = field(default="picture", init=False)

    @property
    def source(self) -> str:
        """A ``data:`` address."""
        return "data:image/svg+xml;base64," + base64.b64encode(self.svg).decode()


@dataclass(frozen=True, slots=True, kw_only=True)
class Embedded:
    """A recording as markup that is safe to embed."""

    html: str
    caption: str
    kind: str = field(default="recording", init=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class PicturedTable:
    """Table with pictures and recordings beside it on a wide screen."""

    table: PageTable
    seen: tuple[Embedded | Picture, ...] = ()
    kind: str = field(default="beside", init=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class Details:
    """Folded tables or text."""

    title: str
    tables: tuple[PageTable, ...] = ()
    text: str = ""  # set as code
    notes: tuple[str, ...] = ()  # meaning of the numbers
    key: str = ""  # identifier in the page
    kind: str = field(default="details", init=False)


Item: TypeAlias = PageTable | Picture | Embedded | PicturedTable | Details


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """Part of the page under a heading."""

    key: str  # address in the page
    title: str
    lead: tuple[str, ...] = ()  # paragraphs before the rest
    statements: tuple[Statement, ...] = ()
    items: tuple[Item, ...] = ()
    notes: tuple[str, ...] = ()  # missing parts and the reasons
    meaning: tuple[str, ...] = ()  # of the numbers; folded
    parts: tuple[Section, ...] = ()
    folded: bool = False  # unfolded on paper

    @property
    def empty(self) -> bool:
        """Return whether there is nothing under the heading."""
        return not (self.lead or self.statements or self.items or self.notes or self.parts)

    @property
    def pictures(self) -> tuple[Picture, ...]:
        """All figures of the section."""
        beside = (seen for item in self.items if isinstance(item, PicturedTable) for seen in item.seen)
        return tuple(one for one in (*self.items, *beside) if isinstance(one, Picture))


@dataclass(frozen=True, slots=True)
class Status:
    """Outcome of a run, a finding or a study, for the page's head."""

    label: str
    completed: bool
    outcome: str  # in a word or two
    text: str  # in a line


def quantities(
    name: str,
    values: Sequence[float | None],
    unit: str = "1",
    digits: int = 4,
    scales: Mapping[str, float] | None = None,
) -> Row:
    """Return a row of numbers with one prefix; None and infinite are dashes.

    ``scales`` are those of the runs, by which numbers may be zero to round-off.
    """
    still = [is_round_off(value, unit, scales) for value in values] if scales else [False] * len(values)
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


def said_of_zeros(tables: Iterable[PageTable]) -> tuple[str, ...]:
    """Return the note on the sign of zero, if a table has one."""
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


def turned(table: PageTable) -> PageTable:
    """Return a table of many groups with one line for each thing and run.

    A table of few groups, or of groups of different rows, stays as it is. Quantities that are zero or missing
    in all groups are left out, except for the first.
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
    return PageTable(columns=("", *heads), rows=tuple(lines), caption=table.caption, key=table.key)


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
    """Return whether a row has a number other than zero, or a word."""
    return any(cell.value if cell.value is not None else cell.text != number(None) for cell in row.cells)


def _with_unit(cell: Cell, unit: str) -> Cell:
    if cell.text in (number(None), ZERO) or not unit:
        return cell
    return Cell(f"{cell.text}{_SPACE}{unit}", cell.value)
