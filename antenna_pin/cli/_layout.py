"""How a table stands in lines of a given width: words may go to the next line, but no number is split.

A table that does not fit side by side is cut into blocks of columns, one below the other, each with the first
column; where not even one column fits beside the first, every row becomes lines of their own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from antenna_pin.errors import printable

__all__ = ["Table", "laid_out"]

# What the first column is not narrowed below as long as that saves a block, in characters.
_LABEL = 30
# Between two columns, and before the first.
_GAP = 3
_EDGE = 1
# Longer names of columns are cut anywhere: they are files and laws, not numbers.
_LONGEST_NAME = 24


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A table as text.

    Attributes:
        title: Above the table; none if empty.
        head: Names of the columns; a line break in one stays one.
        rows: Texts of the cells, each row as long as the head.
        numbers: Whether all columns but the first hold numbers, which stand at the right.
        sparse: Whether rows are left out of a block that has nothing but dashes for them.
    """

    title: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    numbers: bool = True
    sparse: bool = False


def laid_out(table: Table, width: int) -> list[str]:
    """Return the lines of a table, an empty one after each block.

    Control characters are shown, not sent: titles and names are those of files.

    Args:
        table: The table.
        width: Characters that a line should keep to. Where a single word is longer, the line is.
    """
    table = replace(
        table,
        title=_shown(table.title),
        head=[_shown(name) for name in table.head],
        rows=[[_shown(cell) for cell in row] for row in table.rows],
    )
    lines = _wrapped(table.title, max(width, 1))
    columns = [
        _Column(_folded(name), [row[place] for row in table.rows]) for place, name in enumerate(table.head)
    ]
    for block in _blocks(columns, width):
        shown = [k for k in range(len(table.rows)) if not (table.sparse and block.is_empty(k))]
        if block.widths is None:
            lines += [*_records(block, shown, width), ""]
        else:
            lines += [*_rows(block, shown, table.numbers), ""]
    return lines


def _shown(text: str) -> str:
    """Return a text with its control characters as Python writes them, but for ends of lines."""
    return text if text.isprintable() else "\n".join(map(printable, text.split("\n")))


class _Column:
    """A column with the width it would like to have and the one that its longest word asks for."""

    def __init__(self, name: str, cells: Sequence[str]) -> None:
        from rich.cells import cell_len

        texts = [name, *cells]
        self.name, self.cells = name, cells
        self.natural = max((cell_len(line) for text in texts for line in text.split("\n")), default=0)
        self.least = max((cell_len(word) for text in texts for word in text.split()), default=0)


@dataclass(frozen=True, slots=True)
class _Block:
    """Columns that stand side by side, and how wide; no widths where not even two do."""

    columns: Sequence[_Column]
    widths: Sequence[int] | None

    def is_empty(self, row: int) -> bool:
        """Whether a row has nothing but its label."""
        return all(column.cells[row] in ("", "-") for column in self.columns[1:])


def _blocks(columns: Sequence[_Column], width: int) -> list[_Block]:
    """Return the columns in as few blocks as there can be, the first column in each."""
    label, *others = columns
    if not others:
        return [_Block(columns, [min(label.natural, max(label.least, width - _EDGE))])]
    whole = [column.natural for column in columns]
    if _total(whole) <= width:
        return [_Block(columns, whole)]
    least = min(label.natural, max(label.least, _LABEL))
    if _total([least, *(column.least for column in others)]) <= width:
        return [_fitted(columns, least, width)]
    found = _packed(label, others, least, width)
    if found is None and least > label.least:
        least = label.least
        found = _packed(label, others, least, width)
    return [_Block(columns, None)] if found is None else [_fitted(block, least, width) for block in found]


def _packed(label: _Column, others: Sequence[_Column], least: int, width: int) -> list[list[_Column]] | None:
    """Return the columns in blocks that keep to the width, evenly filled; None where one does not fit."""
    if any(_total([least, column.least]) > width for column in others):
        return None
    for count in range(1, len(others) + 1):
        cuts = [round(k * len(others) / count) for k in range(count + 1)]
        blocks = [[label, *others[first:last]] for first, last in pairwise(cuts)]
        if all(_total([least, *(column.least for column in block[1:])]) <= width for block in blocks):
            return blocks
    raise AssertionError("a block of one column fits")


def _fitted(columns: Sequence[_Column], least: int, width: int) -> _Block:
    """Return the columns with the widest narrowed until they fit, none below its longest word."""
    floors = [least, *(column.least for column in columns[1:])]
    widths = [column.natural for column in columns]
    while (excess := _total(widths) - width) > 0:
        room = [have - floor for have, floor in zip(widths, floors, strict=True)]
        if not any(room):
            break
        place = max((k for k in range(len(widths)) if room[k]), key=lambda k: widths[k])
        next_widest = max((w for k, w in enumerate(widths) if w < widths[place]), default=0)
        widths[place] -= max(1, min(excess, room[place], widths[place] - next_widest))
    return _Block(columns, widths)


def _total(widths: Sequence[int]) -> int:
    return _EDGE + sum(widths) + _GAP * (len(widths) - 1)


def _rows(block: _Block, shown: Sequence[int], numbers: bool) -> list[str]:
    """Return head, rule and rows of a block."""
    assert block.widths is not None
    names = [column.name for column in block.columns]
    lines = _row(names, block.widths, numbers) if any(names) else []
    lines.append(" " + "─" * (_total(block.widths) - _EDGE))
    for k in shown:
        lines += _row([column.cells[k] for column in block.columns], block.widths, numbers)
    return lines


def _row(cells: Sequence[str], widths: Sequence[int], numbers: bool) -> list[str]:
    """Return the lines of one row."""
    from rich.cells import cell_len

    texts = [_wrapped(cell, width) for cell, width in zip(cells, widths, strict=True)]
    lines = []
    for k in range(max(map(len, texts), default=0)):
        parts = []
        for place, (text, width) in enumerate(zip(texts, widths, strict=True)):
            part = text[k] if k < len(text) else ""
            space = " " * (width - cell_len(part))
            parts.append(space + part if numbers and place else part + space)
        lines.append((" " * _EDGE + (" " * _GAP).join(parts)).rstrip())
    return lines


def _records(block: _Block, shown: Sequence[int], width: int) -> list[str]:
    """Return every row as its label and, below it, the name and the text of each cell."""
    label, *others = block.columns
    lines = []
    for k in shown:
        lines += _wrapped(label.cells[k] or "-", max(width, 1))
        for column in others:
            name = " ".join(column.name.split())
            pair = f"{name}: {column.cells[k]}" if name else column.cells[k]
            lines += [f"  {line}" for line in _wrapped(pair, max(width - 2, 1))]
    return lines


def _wrapped(text: str, width: int) -> list[str]:
    """Return a text in lines that break between words; a word that is longer than a line has its own."""
    from rich.cells import cell_len

    lines: list[str] = []
    for part in text.split("\n") if text else ():
        if cell_len(part) <= width:
            lines.append(part)
            continue
        line = ""
        for word in part.split():
            if line and cell_len(line) + 1 + cell_len(word) > width:
                lines.append(line)
                line = word
            else:
                line = f"{line} {word}" if line else word
        lines.append(line)
    return lines


def _folded(name: str) -> str:
    """Return the name of a column with its longest words cut into lines."""
    parts = []
    for word in name.split(" "):
        if "\n" in word or len(word) <= _LONGEST_NAME:
            parts.append(word)
        else:
            parts.append("\n".join(word[k : k + _LONGEST_NAME] for k in range(0, len(word), _LONGEST_NAME)))
    return " ".join(parts)
