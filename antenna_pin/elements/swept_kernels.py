"""A sine whose frequency is swept, in pieces, compiled."""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import inlined, record
from antenna_pin.elements.fade_kernels import faded
from antenna_pin.elements.ledger_kernels import write_work
from antenna_pin.records import layout, words_of

#: Behind it stand the pieces, in the order of time.
LAYOUT = layout(("pieces", "i8"), ("fade_in", "f8"))
SIZE = words_of(LAYOUT)
#: Of a ``SweptPiece``: from ``start`` on the angular frequency is ``begin`` exp(growth s), or, where
#: ``octaves`` is 0, ``begin`` + growth s; the displacement's amplitude is ``height`` over its ``power``.
PIECE = layout(
    ("start", "f8"),
    ("begin", "f8"),
    ("growth", "f8"),
    ("octaves", "i8"),
    ("phase", "f8"),
    ("height", "f8"),
    ("power", "i8"),
)
PIECE_SIZE = words_of(PIECE)
# Its power is known once the forces of constraint are.
write_rates = write_work


@inlined
def _turned(p: Any, s: float) -> tuple[float, float, float, float]:
    """Phase since the piece's start, angular frequency and its first two derivatives, s after the start."""
    if p.octaves == 0 or p.growth == 0.0:
        return (p.begin + 0.5 * p.growth * s) * s, p.begin + p.growth * s, p.growth, 0.0
    grown = p.begin * math.expm1(p.growth * s)
    omega = p.begin + grown
    return grown / p.growth, omega, p.growth * omega, p.growth * p.growth * omega


@inlined
def motion(words: Any, at: int, t: float) -> tuple[float, float, float]:
    """Position, its rate and its acceleration at time t [s]: all exact of one another."""
    m = record(words[at : at + SIZE], LAYOUT)
    own = at + SIZE
    for _ in range(m.pieces - 1):
        if t < words[own + PIECE_SIZE]:
            break
        own += PIECE_SIZE
    p = record(words[own : own + PIECE_SIZE], PIECE)
    turned, omega, slope, bend = _turned(p, t - p.start)
    # The amplitude D = height omega^-power with its derivatives.
    size = p.height
    for _ in range(p.power):
        size /= omega
    grows = slope / omega
    first = -p.power * size * grows
    second = p.power * size * ((p.power + 1) * grows * grows - bend / omega)
    sine, cosine = math.sin(turned + p.phase), math.cos(turned + p.phase)
    x = size * sine
    v = first * sine + size * omega * cosine
    a = (second - size * omega * omega) * sine + (2.0 * first * omega + size * slope) * cosine
    return faded((x, v, a), t, m.fade_in)


@inlined
def effort(words: Any, at: int, t: float, angle: float, rate: float) -> float:
    """Zero: what holds the motion is a force of constraint."""
    return 0.0
