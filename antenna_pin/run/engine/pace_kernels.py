"""Step size, compiled: by error control and by instants at step ends."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import Floats, Ints, Memory, Record, Records, layout
from antenna_pin.compiled.by_address import by_address
from antenna_pin.compiled.decorators import kernel

SAFETY = 0.9
SHRINK = 0.2
GROW = 6.0
LEAST_ERROR = 1e-4  # least error in the control: an accidentally small one must not shorten the next step
LARGEST_TURN = 2.0  # [rad] of a joint in one step: whole turns are counted from step to step


class PaceRecord(Record):
    """The control of step sizes."""

    adaptive: int  # 1: sizes follow errors
    power: int  # gains of the control
    step: float  # fixed size [s]
    longest: float  # longest size [s]
    least: float  # least size [s]
    end: float  # end of the run [s]
    spin: float  # fastest rate of a joint without limits [rad/s]
    next: int  # index of the next time at which steps must end
    integral: float  # exponent of the method's control
    proportional: float  # exponent of the method's control
    error: float  # scaled error of the last accepted step; 0: none


PACE = layout(PaceRecord)


@kernel
def cut(pace: Records[PaceRecord], breaks: Floats, t: float, h: float) -> tuple[float, bool]:
    """Cut a step to its maximum, a required end, or the run's end.

    Args:
        pace: PACE, (1,); advanced to the next required end.
        breaks: Times at which steps must end, increasing [s].
        t: Start [s].
        h: Wished size [s].

    Returns:
        Step size [s], and whether the run's end has cut it.
    """
    p = pace[0]
    h = min(h, p.longest)
    if h * p.spin > LARGEST_TURN:
        h = LARGEST_TURN / p.spin
    while p.next < breaks.shape[0] and breaks[p.next] <= t:
        p.next += 1
    last = p.next >= breaks.shape[0]
    end = p.end if last else breaks[p.next]
    rest = end - t
    # Two equal steps instead of a very short one at the end.
    halved = p.adaptive != 0 and h > 0.5 * rest
    by_end = (h >= rest or halved) and last
    if h >= rest:
        return rest, by_end
    return (0.5 * rest if halved else h), by_end


@kernel
def following(pace: Records[PaceRecord], wished: float, tried: float, error: float, rejected: bool) -> float:
    """Return the next step size to try after an accepted one [s].

    Args:
        pace: PACE, (1,).
        wished: Wished size of the step [s].
        tried: Size of the accepted step, after cuts [s].
        error: Its scaled error [-].
        rejected: Whether longer steps were rejected.
    """
    p = pace[0]
    if p.adaptive == 0:
        return float(p.step)
    grow = GROW
    if error != 0.0:
        grow = SAFETY * math.pow(error, -(p.integral + p.proportional) / p.power)
        if p.proportional != 0.0 and p.error != 0.0:
            grow *= math.pow(p.error, p.proportional / p.power)
        grow = min(GROW, max(SHRINK, grow))
    p.error = max(error, LEAST_ERROR)
    size = tried * grow
    if rejected:
        size = min(size, tried)
    if tried < wished:  # cut for an output or the end, not because of the error
        size = max(size, wished)
    return float(size)


@kernel
def shortened(pace: Records[PaceRecord], tried: float, error: float) -> float:
    """Return the step to try after one with too large an error [s]."""
    if math.isfinite(error):
        return float(tried * max(SHRINK, SAFETY * math.pow(error, -1.0 / pace[0].power)))
    return float(tried * SHRINK)


@kernel
def hopeless(pace: Records[PaceRecord], h: float) -> bool:
    """Return whether a step shortened to h [s] is too short to try."""
    return bool(h < pace[0].least or pace[0].adaptive == 0)


@by_address
class StepSizeArrays(NamedTuple):
    """Step sizes by pattern of touching contacts: similar impacts need similar steps.

    Attributes:
        patterns: Touching contacts, 0 or 1, (capacity, contacts).
        sizes: Step sizes, (capacity,) [s].
        count: Number of patterns, (1,).
    """

    patterns: NDArray[np.uint8]
    sizes: Floats
    count: Ints  # type: ignore[assignment]  # hides a method of tuples


@kernel
def _number(table: StepSizeArrays, memory: Records[Memory]) -> int:
    """Return where the present pattern stands, or how many there are."""
    count = table.count[0]
    for k in range(count):
        same = True
        for c in range(memory.shape[0]):
            if (memory[c].touching != 0.0) != (table.patterns[k, c] != 0):
                same = False
                break
        if same:
            return int(k)
    return int(count)


@kernel
def note_size(table: StepSizeArrays, memory: Records[Memory], h: float) -> None:
    """Note the step that goes well in the present pattern of touching contacts [s]."""
    k = _number(table, memory)
    if k == table.count[0]:
        if k == table.sizes.shape[0]:  # the outer loop provides space
            return
        table.count[0] = k + 1
        for c in range(memory.shape[0]):
            table.patterns[k, c] = 1 if memory[c].touching != 0.0 else 0
    table.sizes[k] = h


@kernel
def size_after_change(table: StepSizeArrays, memory: Records[Memory], h: float) -> float:
    """Return the first step size in a new contact pattern [s], from h [s] before."""
    k = _number(table, memory)
    return float(h if k == table.count[0] else min(table.sizes[k], 10.0 * h))
