"""Modal data from text: CSV, or the tables that finite-element codes print.

CSV has the columns ``frequency``, ``tx``, ``ty``, ``tz``, ``rx``, ``ry``, ``rz`` and, if known,
``damping_ratio``.
"""

from __future__ import annotations

from antenna_pin.base.parameters import RULES, SWINGS
from antenna_pin.base.tables import BadTableError, column_of, headings, read_cells
from antenna_pin.flexible.modal_print import read_printed
from antenna_pin.flexible.modal_table import (
    FACTORS,
    BadModalTableError,
    ModalTable,
    checked_factors,
    checked_frequency,
)

__all__ = ["BadModalTableError", "ModalTable", "read_modal_table"]

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
        if damping is not None and not RULES[SWINGS](damping[k]):
            raise BadModalTableError(
                f"{place}: {_DAMPING} must be {SWINGS}, got {damping[k]:g}; 2 % are 0.02"
            )
        first = before.setdefault((frequency[k], *factors), line)
        if first != line:
            raise BadModalTableError(f"{place}: a mode must stand once, got that of line {first} again")
    reading = f"columns {', '.join(cells.text)} under line {cells.header}"
    return ModalTable(frequency, tuple(participation), damping, tuple(cells.lines), reading)
