"""What may happen in a step along a branch though its two ends do not tell of it.

Numbers that pass zero at what happens have the same sign where they pass it twice. So it is asked whether the
cubic of the parameter through both ends turns in between, whether a parabola through those numbers at a third
orbit comes near to zero there, and whether as many multipliers have left the unit circle as signs say.
"""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from antenna_pin.nonlinear.follower import Node
from antenna_pin.nonlinear.locate import Step

__all__ = ["doubling", "hidden", "is_torus", "pairs", "shedding"]

Complex = NDArray[np.complex128]

# Places of a step at which its cubic is looked at; and how near to zero, over its values at the ends, a
# parabola may come without a look.
_PLACES = np.linspace(0.0, 1.0, 33)
_NEAR = 0.3
_ON = 1e-6  # how near to the unit circle a multiplier is on no side of it


def pairs(multipliers: Complex) -> list[tuple[complex, complex]]:
    """Return every two multipliers of an orbit."""
    return list(itertools.combinations(multipliers.tolist(), 2))


def doubling(multipliers: Complex) -> float:
    """Return a number that passes zero where an orbit doubles its period, 1 in size at most at large ones.

    It is the product of all 1 + multiplier, those that are larger than 1 taken over themselves.
    """
    return float(np.prod((multipliers + 1.0) / np.maximum(np.abs(multipliers), 1.0)).real)


def shedding(multipliers: Complex) -> float:
    """Return a number that passes zero where an orbit sheds a torus.

    Likewise of the products of two multipliers, less 1.
    """
    products = [one * other for one, other in pairs(multipliers)]
    return float(np.prod([(one - 1.0) / max(abs(one), 1.0) for one in products]).real) if products else 1.0


def is_torus(multipliers: Complex) -> bool:
    """Return whether the two multipliers whose product is nearest to 1 are complex, not two real ones."""
    one, other = min(pairs(multipliers), key=lambda pair: abs(pair[0] * pair[1] - 1.0))
    return abs(one.imag) > 1e-9 and abs(one - other.conjugate()) < 1e-6 * abs(one)


def hidden(step: Step, low: float, high: float) -> float | None:
    """Return where between two places of a step an orbit must be looked at; None where the ends tell all."""
    one, other = step.node(low), step.node(high)
    if len(one.way) != len(other.way) or one.point.orbit.onsets != other.point.orbit.onsets:
        return None
    middle = 0.5 * (low + high)
    turns = _turns(step, low, high)
    if turns is not None:
        return turns
    nodes = step.nodes()
    aside = [along for along in nodes if not low <= along <= high]
    if not aside:
        return middle
    third = min(aside, key=lambda along: abs(along - middle))
    for test in (doubling, shedding):
        values = [test(nodes[along].point.orbit.multipliers) for along in (low, high, third)]
        dips = _dips((low, high, third), values)
        if dips is not None:
            return dips
    return None if _told(one, other) else middle


def _turns(step: Step, low: float, high: float) -> float | None:
    """Return where the parameter turns more often than its slopes at two places say, by the cubic there."""
    one, other = step.slope(low), step.slope(high)
    rise = (step.point(high).value - step.point(low).value) / (step.follower.unit * (high - low))
    u = _PLACES
    slopes = one * (1.0 - 4.0 * u + 3.0 * u**2) + other * (3.0 * u**2 - 2.0 * u) + 6.0 * rise * (u - u**2)
    if np.count_nonzero(np.diff(slopes > 0.0)) <= int((one > 0.0) != (other > 0.0)):
        return None
    far = float(u[1:-1][np.argmax(np.abs(slopes - one * (1.0 - u) - other * u)[1:-1])])
    return low + min(max(far, 0.25), 0.75) * (high - low)


def _dips(places: tuple[float, float, float], values: list[float]) -> float | None:
    """Return where between the first two places a parabola through values of one sign comes near to zero."""
    (low, high, _), (one, other, _) = places, values
    if (one > 0.0) != (other > 0.0):
        return None
    bend, slope, _ = np.polyfit(np.array(places) - low, values, 2)
    if bend == 0.0:
        return None
    turn = -0.5 * slope / bend
    least = one - bend * turn**2
    if not 0.0 < turn < high - low or least * np.sign(one) > _NEAR * min(abs(one), abs(other)):
        return None
    return low + float(np.clip(turn, 0.25 * (high - low), 0.75 * (high - low)))


def _told(one: Node, other: Node) -> bool:
    """Whether as many multipliers have passed the unit circle as signs of what happens at both ends say."""
    outside = []
    for node in (one, other):
        orbit = node.point.orbit
        sizes = np.abs(orbit.multipliers) - 1.0
        if np.any(np.abs(sizes) <= max(orbit.doubt, _ON)):
            return True  # it is on neither side
        outside.append(int(np.count_nonzero(sizes > 0.0)))
    ends = [node.point.orbit.multipliers for node in (one, other)]
    if len(ends[0]) != len(ends[1]):
        return True
    real = [doubling(ends[0]) > 0.0, one.way[-1] > 0.0, one.crossing > 0.0]
    then = [doubling(ends[1]) > 0.0, other.way[-1] > 0.0, other.crossing > 0.0]
    ways: list[tuple[int, ...]] = [(-1, 1) for was, now in zip(real, then, strict=True) if was != now]
    ways += [(-2, 0, 2)] if (shedding(ends[0]) > 0.0) != (shedding(ends[1]) > 0.0) else []
    return outside[1] - outside[0] in {sum(each) for each in itertools.product(*ways)}
