"""A prescribed motion whose numbers Python writes before each evaluation, or compiled functions give."""

from __future__ import annotations

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.calls import call_1
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.ledger_kernels import write_work
from antenna_pin.elements.motion_kernels import effort

__all__ = ["LAYOUT", "effort", "motion", "write_rates"]


class PackedGivenMotion(Record):
    """A motion by functions: its present numbers, and the addresses; 0: Python writes the numbers."""

    position: float  # [rad] ([m])
    rate: float  # [rad/s] ([m/s])
    acceleration: float  # [rad/s^2] ([m/s^2])
    first: float  # address of the position's function
    second: float  # address of the rate's
    third: float  # address of the acceleration's


LAYOUT = layout(PackedGivenMotion)
SIZE = words_of(LAYOUT)
write_rates = write_work


@inlined
def motion(words: Floats, at: int, t: float) -> tuple[float, float, float]:
    """Position, its rate and its acceleration."""
    m = record(words[at : at + SIZE], LAYOUT)
    if m.first != 0.0:
        return float(call_1(m.first, t)), float(call_1(m.second, t)), float(call_1(m.third, t))
    return float(m.position), float(m.rate), float(m.acceleration)
