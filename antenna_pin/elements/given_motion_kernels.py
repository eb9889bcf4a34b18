"""A prescribed motion whose numbers Python writes before each evaluation, or compiled functions give."""

from __future__ import annotations

from typing import Any

from antenna_pin.base.records import layout, words_of
from antenna_pin.compiled.calls import call_1
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.ledger_kernels import write_work
from antenna_pin.elements.motion_kernels import effort

__all__ = ["LAYOUT", "effort", "motion", "write_rates"]

#: Its numbers, and where its functions stand; 0 where Python writes the numbers.
LAYOUT = layout(
    ("position", "f8"),
    ("rate", "f8"),
    ("acceleration", "f8"),
    ("first", "f8"),
    ("second", "f8"),
    ("third", "f8"),
)
SIZE = words_of(LAYOUT)
write_rates = write_work


@inlined
def motion(words: Any, at: int, t: float) -> tuple[float, float, float]:
    """Position, its rate and its acceleration."""
    m = record(words[at : at + SIZE], LAYOUT)
    if m.first != 0.0:
        return float(call_1(m.first, t)), float(call_1(m.second, t)), float(call_1(m.third, t))
    return float(m.position), float(m.rate), float(m.acceleration)
