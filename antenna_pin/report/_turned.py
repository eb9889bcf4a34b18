"""Tables of many alike things: a line for each, its quantities side by side."""

from __future__ import annotations

from collections.abc import Sequence

from antenna_pin.base.readable import number
from antenna_pin.report._page import ZERO, Cell, Row, Table

__all__ = ["turned"]

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
