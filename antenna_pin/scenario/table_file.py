"""Numbers over time, or over an angle, from text."""

from __future__ import annotations

from collections.abc import Sequence

from antenna_pin.base.tables import BadTableError, column_of, read_cells
from antenna_pin.scenario._joint import JOINTS, Motion, motion_of

__all__ = ["read_table"]


def read_table(
    text: str, columns: Sequence[str], units: Sequence[str | tuple[str, ...]]
) -> tuple[tuple[tuple[float, ...], ...], Motion | None]:
    """Return columns of a table in SI units, of which the first increases.

    Args:
        text: The file's text.
        columns: Their names, as its header must have them.
        units: SI unit of each, or those of a turning and of a sliding joint.

    Returns:
        The numbers, and what the units in the text say of the joint's motion; None without any.

    Raises:
        BadTableError: It cannot be read so; with the line.
    """
    cells = read_cells(text, columns)
    numbers = tuple(column_of(cells, name, unit) for name, unit in zip(columns, units, strict=True))
    if len(cells.lines) < 2:
        last = max(cells.lines, default=cells.header)
        raise BadTableError(f"line {last}: must have at least 2 rows of numbers, got {len(cells.lines)}")
    for line, before, number in zip(cells.lines[1:], numbers[0], numbers[0][1:], strict=False):
        if not number > before:
            raise BadTableError(
                f"line {line}: {columns[0]} must increase strictly, got {number!r} after {before!r}"
            )
    with_unit = {name: unit for name, unit in zip(columns, units, strict=True) if name in cells.units}
    motions = {name: motion_of(f"1 {cells.units[name]}", unit) for name, unit in with_unit.items()}
    known = {name: motion for name, motion in motions.items() if motion is not None}
    for name, motion in known.items():
        first = next(iter(known))
        if motion != known[first]:
            raise BadTableError(
                f"line {cells.header}: {name} must be for a {JOINTS[known[first]]} joint, as {first} is, "
                f"got {cells.units[name]!r} ({JOINTS[motion]})"
            )
    return numbers, next(iter(known.values()), None)
