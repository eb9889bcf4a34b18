"""A motion of a shaken base, compiled: a course over time that fades in."""

from __future__ import annotations

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.fade_kernels import faded
from antenna_pin.elements.ledger_kernels import write_work
from antenna_pin.elements.term_kernels import course


class PackedShaken(Record):
    """A shaken base; ``terms`` words of its course stand behind."""

    terms: int  # words of the course behind
    fade_in: float  # time over which the motion grows [s]


LAYOUT = layout(PackedShaken)
SIZE = words_of(LAYOUT)
# Its power is known once the forces of constraint are.
write_rates = write_work


@inlined
def motion(words: Floats, at: int, t: float) -> tuple[float, float, float]:
    """Position, its rate and its acceleration at time t [s]: all exact of one another."""
    m = record(words[at : at + SIZE], LAYOUT)
    return faded(course(words, at + SIZE, at + SIZE + m.terms, t), t, m.fade_in)


@inlined
def effort(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Zero: what holds the motion is a force of constraint."""
    return 0.0
