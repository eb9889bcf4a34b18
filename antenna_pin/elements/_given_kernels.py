"""A torque whose value Python writes before each evaluation, compiled."""

from __future__ import annotations

from typing import Any

from antenna_pin._compile import inlined
from antenna_pin.elements._ledger_kernels import write_work
from antenna_pin.records import record, words_of

KIND = 13
LAYOUT = record(("value", "f8"))
SIZE = words_of(LAYOUT)
write_rates = write_work


@inlined
def effort(words: Any, at: int, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    return float(words[at : at + SIZE].view(LAYOUT)[0].value)
