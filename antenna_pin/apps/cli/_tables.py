"""Tables for people, and numbers as they stand in them."""

from __future__ import annotations

import math
import shutil
import sys
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any, TypeAlias

import typer

from antenna_pin.apps.cli._common import say
from antenna_pin.errors import printable

if TYPE_CHECKING:
    from antenna_pin.trajectory import Trajectory
    from antenna_pin.trajectory.columns import Variable

#: Text of a thing in each column of a table, by heading.
Columns: TypeAlias = Mapping[str, Callable[[Any], str]]

# What the first column is not narrowed below as long as that saves a block, in characters.
_LABEL = 30
# Between two columns, and before the first.
_GAP = 3
_EDGE = 1
# Longer names of columns are cut anywhere: they are files and laws, not numbers.
_LONGEST_NAME = 24


@dataclass(frozen=True, slots=True, kw_only=True)
class TextTable:
    """Table as text."""

    title: str
    head: Sequence[str]  # a line break in a name stays one
    rows: Sequence[Sequence[str]]
    numbers: bool = True  # in all columns but the first, and aligned to the right
    sparse: bool = False  # a block leaves out rows of nothing but dashes


def laid_out(table: TextTable, width: int) -> list[str]:
    """Return the lines of a table within a width, an empty one after each block.

    A line is wider only for a single word. Control characters are escaped, as titles come from files.
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
            lines += [*_block_lines(block, shown, table.numbers), ""]
    return lines


def _shown(text: str) -> str:
    """Return a text with its control characters escaped, but for line breaks."""
    return text if text.isprintable() else "\n".join(map(printable, text.split("\n")))


class _Column:
    """Column with its natural width and the width of its longest word."""

    def __init__(self, name: str, cells: Sequence[str]) -> None:
        from rich.cells import cell_len

        texts = [name, *cells]
        self.name, self.cells = name, cells
        self.natural = max((cell_len(line) for text in texts for line in text.split("\n")), default=0)
        self.least = max((cell_len(word) for text in texts for word in text.split()), default=0)


@dataclass(frozen=True, slots=True)
class _ColumnBlock:
    """Columns side by side and their widths; None where not even two fit."""

    columns: Sequence[_Column]
    widths: Sequence[int] | None

    def is_empty(self, row: int) -> bool:
        """Return whether a row is empty but for its label."""
        return all(column.cells[row] in ("", "-") for column in self.columns[1:])


def _blocks(columns: Sequence[_Column], width: int) -> list[_ColumnBlock]:
    """Return the columns in the fewest blocks, the first column in each."""
    label, *others = columns
    if not others:
        return [_ColumnBlock(columns, [min(label.natural, max(label.least, width - _EDGE))])]
    whole = [column.natural for column in columns]
    if _total(whole) <= width:
        return [_ColumnBlock(columns, whole)]
    least = min(label.natural, max(label.least, _LABEL))
    if _total([least, *(column.least for column in others)]) <= width:
        return [_fitted(columns, least, width)]
    found = _packed(label, others, least, width)
    if found is None and least > label.least:
        least = label.least
        found = _packed(label, others, least, width)
    return (
        [_ColumnBlock(columns, None)] if found is None else [_fitted(block, least, width) for block in found]
    )


def _packed(label: _Column, others: Sequence[_Column], least: int, width: int) -> list[list[_Column]] | None:
    """Return the columns in evenly filled blocks; None where one does not fit."""
    if any(_total([least, column.least]) > width for column in others):
        return None
    for count in range(1, len(others) + 1):
        cuts = [round(k * len(others) / count) for k in range(count + 1)]
        blocks = [[label, *others[first:last]] for first, last in pairwise(cuts)]
        if all(_total([least, *(column.least for column in block[1:])]) <= width for block in blocks):
            return blocks
    raise AssertionError("a block of one column fits")


def _fitted(columns: Sequence[_Column], least: int, width: int) -> _ColumnBlock:
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
    return _ColumnBlock(columns, widths)


def _total(widths: Sequence[int]) -> int:
    return _EDGE + sum(widths) + _GAP * (len(widths) - 1)


def _block_lines(block: _ColumnBlock, shown: Sequence[int], numbers: bool) -> list[str]:
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


def _records(block: _ColumnBlock, shown: Sequence[int], width: int) -> list[str]:
    """Return every row as its label and, below, name and text of each cell."""
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
    """Return a text in lines broken between words; a longer word has its own."""
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


class Zeros:
    """Detector of numbers that are zero to round-off by the scales of some runs."""

    def __init__(self, runs: Iterable[Trajectory]) -> None:
        """Take the scales of the runs whose numbers stand together."""
        from antenna_pin.analysis import round_off_scales

        self._scales: Mapping[str, float] = round_off_scales(*(run.data for run in runs))
        self._met = False

    def is_zero(self, value: Any, unit: str) -> bool:
        """Return whether a number is zero to round-off."""
        from antenna_pin.analysis import is_round_off

        return isinstance(value, int | float) and is_round_off(value, unit, self._scales)

    def text(self, value: Any, of: Variable | None, slides: bool | None = False) -> str:
        """Return a table's text of a number; ``slides``: of a sliding joint, None if unknown."""
        if of is None or of.exact or of.form == "count" or not self.is_zero(value, of.unit(slides)):
            return text_of(value)
        self._met = True
        return "≈ 0"

    def say(self) -> None:
        """Print the meaning of the sign for zero, if one was printed."""
        if self._met:
            from antenna_pin.analysis import ROUND_OFF_WORDS

            typer.echo(ROUND_OFF_WORDS)
        self._met = False


_ANSWER_ROWS = 11  # in all; a line on where the file is comes after them


def say_answer(trajectory: Trajectory, label: str = "") -> None:
    """Print a run at a glance, in eleven rows of a usual screen.

    If the rows do not suffice, the longest lines lose their last parts.
    """
    from antenna_pin.analysis import answer

    found = answer(trajectory)
    told = found.title if not label or found.title.endswith(f"case {label}") else f"{label}: {found.title}"
    width = shutil.get_terminal_size().columns if sys.stdout.isatty() else _PAGE
    widest = max(len(line.about) for line in found.lines)
    head = _text_rows(f"{told}: {found.ended}", width, " " * 4)
    parts = [line.text.split("; ") for line in found.lines]
    room = max(width - widest - 4, 30)
    rows = [_text_rows("; ".join(part), room) for part in parts]
    while sum(map(len, rows)) + len(head) > _ANSWER_ROWS:
        longest = max((len(row), len(part)) for row, part in zip(rows, parts, strict=True))
        if longest[1] < 2:
            break
        for k, (row, part) in enumerate(zip(rows, parts, strict=True)):
            if (len(row), len(part)) == longest:
                part.pop()
                rows[k] = _text_rows("; ".join(part), room)
    for text in head:
        say(text)
    for line, (first, *more) in zip(found.lines, rows, strict=True):
        about = f"  {line.about:<{widest}}  "
        say(about + first)
        for text in more:
            say(" " * len(about) + text)


def _text_rows(text: str, width: int, further: str = "") -> list[str]:
    """Return a text in rows, all but the first after the text ``further``."""
    return textwrap.wrap(
        text, width, subsequent_indent=further, break_long_words=False, break_on_hyphens=False
    )


# What stands where an entry has no number, but for a dash.
_WITHOUT = {"energy_error_relative": "nothing moves"}
# Entries that tables leave out: what they say is said in a sentence.
_SAID = ("title", "message", "redundant", "singular", "energy_scale_of")
# Entries that they leave out where they are zero.
_UNLESS_ZERO = ("compile_seconds",)
# Groups of a summary whose name says nothing that their entries do not say.
_PLAIN_GROUPS = ("counts", "conservation", "constraints")


def print_summaries(summaries: Sequence[tuple[str, Mapping[str, Any]]], zeros: Zeros) -> None:
    """Print labelled summaries side by side, one row per number."""
    columns = [{name: (key, value) for name, key, value in _rows(one)} for _, one in summaries]
    titles = dict.fromkeys(str(summary.get("title", "")) for _, summary in summaries)
    rows = []
    for row in dict.fromkeys(name for column in columns for name in column):
        found = (column.get(row, ("", None)) for column in columns)
        rows.append(
            [row, *(_WITHOUT.get(key, "-") if v is None else _cell(v, key, zeros) for key, v in found)]
        )
    head = ["", *(label for label, _ in summaries)]
    _print(TextTable(title="; ".join(filter(None, titles)), head=head, rows=rows, sparse=True), pipe=_PAGE)


def print_summary(label: str, summary: Mapping[str, Any], zeros: Zeros) -> None:
    """Print a whole summary: a table of the run, then one for each group."""
    from antenna_pin.trajectory.quantities import GROUPS, heading_of

    print_summaries([(label, {key: one for key, one in summary.items() if key not in GROUPS})], zeros)
    for key, group in GROUPS.items():
        if named := summary.get(key):
            entries = list(dict.fromkeys(entry for one in named.values() for entry in one))
            rows = [
                [name, *(_cell(one.get(entry), entry, zeros) for entry in entries)]
                for name, one in named.items()
            ]
            print_rows("", (group.title, *map(heading_of, entries)), rows)


def _cell(value: Any, key: str, zeros: Zeros) -> str:
    from antenna_pin.trajectory.quantities import HEADINGS

    return zeros.text(value, *HEADINGS.get(key, (None,)))


def print_table(title: str, name: str, entries: Sequence[Mapping[str, Any]], zeros: Zeros) -> None:
    """Print a table of the catalogue, with a ``name`` or ``of`` for each row."""
    from antenna_pin.trajectory.quantities import TABLES

    columns = TABLES[name]
    head = [one.words() if one.sliding else one.heading() for one in columns.values()]
    rows = []
    for one in entries:
        slides = one.get("units") in [column.sliding for column in columns.values() if column.sliding]
        unit = f" [{one['units']}]" if "units" in one else ""
        cells = (zeros.text(one[key], column, slides) for key, column in columns.items())
        rows.append([f"{one.get('name', one['of'])}{unit}", *cells])
    print_rows(title, ("", *head), rows)


def print_rows(title: str, head: Sequence[str], rows: Sequence[Sequence[str]], numbers: bool = True) -> None:
    """Print a table; ``numbers``: those of all columns but the first stand at the right."""
    _print(TextTable(title=title, head=head, rows=rows, numbers=numbers), pipe=_ENDLESS)


def print_columns(title: str, things: Iterable[Any], columns: Columns, numbers: bool = True) -> None:
    """Print a table with a row for each thing."""
    print_rows(title, [*columns], [[text(one) for text in columns.values()] for one in things], numbers)


# A pipe has no width to keep to; but files go down at some point, not across.
_ENDLESS = 300
_PAGE = 130


def _print(table: TextTable, pipe: int) -> None:
    width = shutil.get_terminal_size().columns if sys.stdout.isatty() else pipe
    typer.echo("\n".join(laid_out(table, width)))


def flat(summary: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entries of a summary by their names in tables, with units."""
    return {name: value for name, _, value in _rows(summary)}


def _rows(summary: Mapping[str, Any], group: str = "") -> Iterator[tuple[str, str, Any]]:
    """Yield name, key and value of every entry, a group's after its name."""
    from antenna_pin.trajectory.quantities import GROUPS, heading_of

    for key, value in summary.items():
        if key in _SAID or (key in _UNLESS_ZERO and not value):
            continue
        if isinstance(value, dict):
            plain = key in _PLAIN_GROUPS or (key in GROUPS and not GROUPS[key].prefix)
            yield from _rows(value, group if plain else f"{group}{key} ")
        else:
            yield f"{group}{heading_of(key)}", key, value


def text_of(value: Any) -> str:
    """Return the text of an entry in a table: a dash for none or NaN."""
    if value is None or value == "" or value != value:
        return "-"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, (list, tuple)):
        return ", ".join(map(text_of, value))
    return str(value)


# --- numbers ---


def formatted(value: float, form: str, scale: float = 0.0) -> str:
    """Return a number in a format such as ``.4g``; infinity is a dash, round-off 0."""
    from antenna_pin.analysis import is_round_off

    if is_round_off(value, "1", {"1": scale}):
        return "0"
    return format(value, form) if math.isfinite(value) else "-"


def number_text(value: float) -> str:
    return formatted(value, ".4g" if abs(value) < 1e4 else ".0f")


def length_text(value: float, digits: int = 4) -> str:
    """Return a length with a unit that suits it."""
    if not math.isfinite(value):
        return "-"
    large = abs(value)
    size, unit = (1.0, "m") if large >= 0.1 else (1e-3, "mm") if large >= 1e-4 else (1e-6, "um")
    return f"{value / size:.{digits}g} {unit}"


def power_above(value: float) -> str:
    """Return the power of ten that a size does not exceed."""
    return f"1e{math.ceil(math.log10(value))}" if value > 0.0 else "0"
