"""A torque from a table, compiled."""

from __future__ import annotations

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.curve_kernels import curve
from antenna_pin.elements.ledger_kernels import write_work


class PackedTable(Record):
    """An effort over time; times, then coefficients of the cubics stand behind."""

    points: int  # how many


LAYOUT = layout(PackedTable)
SIZE = words_of(LAYOUT)
write_rates = write_work


@inlined
def effort(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    value, _ = curve(words, at + SIZE, record(words[at : at + SIZE], LAYOUT).points, t)
    return value
