"""A shaken base's table, compiled: cubics between points, of which rate and acceleration are exact."""

from __future__ import annotations

from typing import Any

from antenna_pin._compile import inlined, record
from antenna_pin.elements.curve_kernels import curvature, curve
from antenna_pin.elements.ledger_kernels import write_work
from antenna_pin.records import layout, words_of

#: Behind it stands the curve.
LAYOUT = layout(("points", "i8"))
SIZE = words_of(LAYOUT)
# Its power is known once the forces of constraint are.
write_rates = write_work


@inlined
def motion(words: Any, at: int, t: float) -> tuple[float, float, float]:
    """Position, its rate and its acceleration at time t [s]."""
    points = record(words[at : at + SIZE], LAYOUT).points
    along, speed = curve(words, at + SIZE, points, t)
    return along, speed, curvature(words, at + SIZE, points, t)


@inlined
def effort(words: Any, at: int, t: float, angle: float, rate: float) -> float:
    """Zero: what holds the motion is a force of constraint."""
    return 0.0
