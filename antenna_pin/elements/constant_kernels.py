"""A constant torque, compiled."""

from __future__ import annotations

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.ledger_kernels import write_work


class PackedConstant(Record):
    """A constant effort."""

    value: float  # [N m] ([N])


LAYOUT = layout(PackedConstant)
SIZE = words_of(LAYOUT)
write_rates = write_work


@inlined
def effort(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    return float(record(words[at : at + SIZE], LAYOUT).value)
