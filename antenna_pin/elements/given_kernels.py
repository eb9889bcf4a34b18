"""A torque whose value Python writes before each evaluation, or a compiled function gives, compiled."""

from __future__ import annotations

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.calls import call_3
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.ledger_kernels import write_work


class PackedGiven(Record):
    """An effort by a function."""

    value: float  # present effort [N m] ([N])
    address: float  # of the function; 0: Python writes the value


LAYOUT = layout(PackedGiven)
SIZE = words_of(LAYOUT)
write_rates = write_work


@inlined
def effort(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    given = record(words[at : at + SIZE], LAYOUT)
    return float(given.value if given.address == 0.0 else call_3(given.address, t, angle, rate))
