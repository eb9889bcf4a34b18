"""Integrals of drives, compiled."""

from __future__ import annotations

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, record


class Works(Record):
    """Integrals of a drive in x, in the order of ``Drive.integrals``."""

    work: float  # [J]
    gross_work: float  # [J]


WORKS = layout(Works)
WORKS_WORDS = words_of(WORKS)


@inlined
def write_work(power: float, rates: Floats, x: int) -> None:
    """Write work and gross work of a drive, the integrals of power and size."""
    works = record(rates[x : x + WORKS_WORDS], WORKS)
    works.work = power
    works.gross_work = abs(power)


@inlined
def write_work_change(power: float, change: float, rates: Floats, x: int) -> None:
    """Change of what :func:`write_work` writes, with that of the power."""
    works = record(rates[x : x + WORKS_WORDS], WORKS)
    works.work = change
    works.gross_work = change if power >= 0.0 else -change
