"""A controller that follows a reference, compiled."""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.ledger_kernels import write_work
from antenna_pin.elements.term_kernels import course


class PackedPD(Record):
    """A controller's gains and reference; ``terms`` words of its course stand behind."""

    kp: float  # [N m/rad] ([N/m])
    kd: float  # [N m s/rad] ([N s/m])
    limit: float  # largest effort [N m] ([N])
    angle: float  # reference at t = 0 [rad] ([m])
    rate: float  # of the reference [rad/s] ([m/s])
    amplitude: float  # of its sine [rad] ([m])
    angular_frequency: float  # [rad/s]
    phase: float  # [rad]
    terms: int  # words of the course behind


LAYOUT = layout(PackedPD)
SIZE = words_of(LAYOUT)
write_rates = write_work


@inlined
def reference(words: Floats, at: int, t: float) -> tuple[float, float]:
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
def demand(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Torque that it would give without a limit [N m], or force [N]."""
    pd = record(words[at : at + SIZE], LAYOUT)
    wanted, wanted_rate = reference(words, at, t)
    return float(pd.kp * (wanted - angle) + pd.kd * (wanted_rate - rate))


@inlined
def effort(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    limit = record(words[at : at + SIZE], LAYOUT).limit
    return float(min(max(demand(words, at, t, angle, rate), -limit), limit))


@inlined
def kink(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Return the demand's excess over the limit; the effort has a kink at its zero."""
    return float(abs(demand(words, at, t, angle, rate)) - record(words[at : at + SIZE], LAYOUT).limit)
