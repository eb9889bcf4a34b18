"""A controller that follows a reference, compiled."""

from __future__ import annotations

import math
from typing import Any

from antenna_pin.base.records import layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.ledger_kernels import write_work
from antenna_pin.elements.term_kernels import course

#: Behind it stand ``terms`` words of what it follows, its table among it.
LAYOUT = layout(
    ("kp", "f8"),
    ("kd", "f8"),
    ("limit", "f8"),
    ("angle", "f8"),
    ("rate", "f8"),
    ("amplitude", "f8"),
    ("angular_frequency", "f8"),
    ("phase", "f8"),
    ("terms", "i8"),
)
SIZE = words_of(LAYOUT)
write_rates = write_work


@inlined
def reference(words: Any, at: int, t: float) -> tuple[float, float]:
    """Angle to be followed and its rate."""
    pd = record(words[at : at + SIZE], LAYOUT)
    omega = pd.angular_frequency
    turned = omega * t + pd.phase
    angle = pd.angle + pd.rate * t + pd.amplitude * math.sin(turned)
    rate = pd.rate + pd.amplitude * omega * math.cos(turned)
    if pd.terms > 0:
        own = course(words, at + SIZE, at + SIZE + pd.terms, t)
        angle += own[0]
        rate += own[1]
    return angle, rate


@inlined
def demand(words: Any, at: int, t: float, angle: float, rate: float) -> float:
    """Torque that it would give without a limit [N m], or force [N]."""
    pd = record(words[at : at + SIZE], LAYOUT)
    wanted, wanted_rate = reference(words, at, t)
    return float(pd.kp * (wanted - angle) + pd.kd * (wanted_rate - rate))


@inlined
def effort(words: Any, at: int, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    limit = record(words[at : at + SIZE], LAYOUT).limit
    return float(min(max(demand(words, at, t, angle, rate), -limit), limit))


@inlined
def kink(words: Any, at: int, t: float, angle: float, rate: float) -> float:
    """What the demand is beyond the limit, negative within it: the effort has a kink where this is zero."""
    return float(abs(demand(words, at, t, angle, rate)) - record(words[at : at + SIZE], LAYOUT).limit)
