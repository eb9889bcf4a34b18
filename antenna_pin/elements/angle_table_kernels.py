"""A torque from a table over the joint's angle, compiled."""

from __future__ import annotations

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.curve_kernels import area, curve


class PackedAngleTable(Record):
    """A torque over the angle.

    The curve stands behind, with its integral up to each point.
    """

    points: int  # of the curve
    goes_on: int  # 1: the slope continues beyond the table


LAYOUT = layout(PackedAngleTable)
SIZE = words_of(LAYOUT)


@inlined
def torque_at(words: Floats, at: int, shape: tuple[int, bool], angle: float) -> tuple[float, float]:
    """Return torque and slope at an angle, of the curve at words[at:].

    ``shape`` has the number of points, and whether the curve continues.
    """
    points, goes_on = shape
    inside = min(max(angle, words[at]), words[at + points - 1])
    value, slope = curve(words, at, points, inside)
    if angle != inside:
        slope = slope if goes_on else 0.0
        value += slope * (angle - inside)
    return float(value), float(slope)


@inlined
def given_at(words: Floats, at: int, shape: tuple[int, bool], angle: float) -> float:
    """Integral of the torque up to an angle [J]."""
    points, goes_on = shape
    inside = min(max(angle, words[at]), words[at + points - 1])
    found = area(words, at, points, inside)
    if angle != inside:
        beyond = angle - inside
        value, slope = curve(words, at, points, inside)
        found += value * beyond + (0.5 * slope * beyond * beyond if goes_on else 0.0)
    return float(found)


@inlined
def ends_at(words: Floats, at: int, points: int, angle: float) -> float:
    """Product of the ways to the table's ends: it passes zero there."""
    return float((angle - words[at]) * (angle - words[at + points - 1]))


@inlined
def effort(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    table = record(words[at : at + SIZE], LAYOUT)
    value, _ = torque_at(words, at + SIZE, (table.points, table.goes_on != 0), angle)
    return value


@inlined
def write_rates(
    words: Floats, at: int, angle: float, rate: float, power: float, rates: Floats, x: int
) -> None:
    """Nothing is lost."""
    rates[x] = 0.0


@inlined
def stored(words: Floats, at: int, angle: float) -> float:
    """Energy stored [J]."""
    table = record(words[at : at + SIZE], LAYOUT)
    return -given_at(words, at + SIZE, (table.points, table.goes_on != 0), angle)


@inlined
def kink(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Return a function that passes zero at the ends of the table."""
    return ends_at(words, at + SIZE, record(words[at : at + SIZE], LAYOUT).points, angle)
