"""A sum of sines at equal spacing in frequency, compiled."""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import inlined, record
from antenna_pin.elements.fade_kernels import faded
from antenna_pin.elements.ledger_kernels import write_work
from antenna_pin.records import layout, words_of

#: Behind it stand the lines, two numbers each: of the displacement's cosine, and minus that of its sine.
LAYOUT = layout(("lines", "i8"), ("lowest", "i8"), ("period", "f8"), ("fade_in", "f8"))
SIZE = words_of(LAYOUT)
# Sines and cosines follow from those before by one product each; that often they are computed anew.
_ANEW = 64
# Its power is known once the forces of constraint are.
write_rates = write_work


@inlined
def motion(words: Any, at: int, t: float) -> tuple[float, float, float]:
    """Position, its rate and its acceleration at time t [s]."""
    m = record(words[at : at + SIZE], LAYOUT)
    spacing = 2.0 * math.pi / m.period
    turned = t / m.period
    turned = 2.0 * math.pi * (turned - math.floor(turned))
    step_cosine, step_sine = math.cos(turned), math.sin(turned)
    cosine = sine = x = v = a = 0.0
    for k in range(m.lines):
        line = m.lowest + k
        if k % _ANEW == 0:
            cosine, sine = math.cos(line * turned), math.sin(line * turned)
        omega = line * spacing
        p, r = words[at + SIZE + 2 * k], words[at + SIZE + 2 * k + 1]
        along = p * cosine - r * sine
        x += along
        v -= omega * (p * sine + r * cosine)
        a -= omega * omega * along
        cosine, sine = cosine * step_cosine - sine * step_sine, sine * step_cosine + cosine * step_sine
    return faded((x, v, a), t, m.fade_in)


@inlined
def effort(words: Any, at: int, t: float, angle: float, rate: float) -> float:
    """Zero: what holds the motion is a force of constraint."""
    return 0.0
