"""Springs that slip, side by side, compiled."""

from __future__ import annotations

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.hook_kernels import Loaded, Own, Powered


class PackedMaxwellSlip(Record):
    """Springs that slip; stiffness, reach and anchor of each stand behind."""

    count: int  # how many
    mode: int  # HELD, UP, or the one after it: falling
    slips: int  # which of them slip, the k-th counts 2^k


LAYOUT = layout(PackedMaxwellSlip)
SIZE = words_of(LAYOUT)
EACH = 3
# Modes: none slips; some slip, or did last, as the angle grows, or as it falls.
HELD = 0
UP = 1
# Share of its reach by which one is bent further before its mode follows: one that has just been let go is
# not told from one that slips. The torque is right either way; of the loss as large a share is left out.
_SLACK = 1e-11


@inlined
def _bent(words: Floats, one: int, angle: float) -> float:
    """By how much one spring is bent, and at most can be."""
    reach = words[one + 1]
    return float(min(max(angle - words[one + 2], -reach), reach))


@inlined
def effort(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    found = 0.0
    for k in range(record(words[at : at + SIZE], LAYOUT).count):
        one = at + SIZE + EACH * k
        found -= words[one] * _bent(words, one, angle)
    return found


@inlined
def write_rates_of(words: Floats, at: int, motion: Powered, own: Own, rates: Floats, x: int) -> None:
    """Return the power of the slipping springs [W].

    Which slip is a discrete state, for the power jumps where one begins to.
    """
    angle, rate, _ = motion
    springs = record(words[at : at + SIZE], LAYOUT)
    found = 0.0
    for k in range(springs.count):
        one = at + SIZE + EACH * k
        if springs.slips & (1 << k):
            found += words[one] * _bent(words, one, angle) * rate
    rates[x] = found


@inlined
def stored(words: Floats, at: int, angle: float) -> float:
    """Energy stored [J]."""
    found = 0.0
    for k in range(record(words[at : at + SIZE], LAYOUT).count):
        one = at + SIZE + EACH * k
        z = _bent(words, one, angle)
        found += 0.5 * words[one] * z * z
    return found


@inlined
def kink(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Return the product of the margins to slip, as shares.

    One spring begins to slip where it passes zero.
    """
    found = 1.0
    for k in range(record(words[at : at + SIZE], LAYOUT).count):
        one = at + SIZE + EACH * k
        found *= 1.0 - abs(angle - words[one + 2]) / words[one + 1]
    return found


@inlined
def mode(words: Floats, at: int) -> int:
    """Return the present mode."""
    return int(record(words[at : at + SIZE], LAYOUT).mode)


@inlined
def switch(words: Floats, at: int, k: int, motion: Loaded) -> tuple[float, float]:
    """Return function k: margin to slip, or the rate of slipping springs."""
    springs = record(words[at : at + SIZE], LAYOUT)
    _, angle, rate, _ = motion
    way = 1.0 if springs.mode == UP else -1.0
    left, slope, slips, more = 1.0, 0.0, False, 1.0
    for i in range(springs.count):
        one = at + SIZE + EACH * i
        bent, reach = angle - words[one + 2], words[one + 1]
        if springs.mode == HELD:
            back = -1.0 if bent > 0.0 else 1.0
        else:
            back = way
            # From half way on, well before it slips: where the joint turns back, nothing jumps that is seen.
            slips = slips or way * bent > 0.5 * reach
            if not springs.slips & (1 << i):
                more = min(more, (1.0 + _SLACK) * reach - way * bent)
        own = (1.0 + _SLACK) * reach + back * bent
        if i == 0 or own < left:
            left, slope = own, back * rate
    if k == 0:
        return float(left), float(slope)
    if k == 2:
        return float(more), float(-way * rate) if more < 1.0 else 0.0
    if slips:
        return float(way * rate), 0.0
    return 1.0, 0.0
