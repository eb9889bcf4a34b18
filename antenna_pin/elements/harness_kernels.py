"""A harness with a table for each direction of motion, compiled."""

from __future__ import annotations

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.angle_table_kernels import ends_at, given_at, torque_at
from antenna_pin.elements.hook_kernels import Motion, Own, Powered


class PackedHarness(Record):
    """A harness; curves of mean and half difference, each with its integral, stand behind."""

    points: int  # of each curve
    goes_on: int  # 1: the mean's slope continues beyond the table
    reversal: float  # angle over which the torque turns over [rad]
    start: float  # z at the start, in -1 to 1


LAYOUT = layout(PackedHarness)
SIZE = words_of(LAYOUT)
# Among what it integrates.
HEAT = 0
Z = 1


@inlined
def _half(words: Floats, at: int, angle: float) -> tuple[float, float]:
    """Return half the difference of the tables, H, and its slope.

    Both stay constant beyond the tables.
    """
    points = record(words[at : at + SIZE], LAYOUT).points
    return torque_at(words, at + SIZE + 6 * points - 4, (points, False), angle)


@inlined
def effort_of(words: Floats, at: int, motion: Motion, own: Own) -> float:
    """Torque [N m], or force [N]."""
    table = record(words[at : at + SIZE], LAYOUT)
    _, angle, _ = motion
    y, i = own
    mean, _ = torque_at(words, at + SIZE, (table.points, table.goes_on != 0), angle)
    half, _ = _half(words, at, angle)
    return float(mean - half * (table.start + y[i + Z]))


@inlined
def write_rates_of(words: Floats, at: int, motion: Powered, own: Own, rates: Floats, x: int) -> None:
    """Power that is lost [W], and the rate of z [1/s]."""
    table = record(words[at : at + SIZE], LAYOUT)
    angle, rate, _ = motion
    y, i = own
    z = table.start + y[i + Z]
    half, slope = _half(words, at, angle)
    rates[x + Z] = (rate - abs(rate) * z) / table.reversal
    rates[x + HEAT] = z * z * (half * abs(rate) - 0.5 * slope * rate * table.reversal)


@inlined
def stored_of(words: Floats, at: int, angle: float, own: Own) -> float:
    """Energy stored [J]."""
    table = record(words[at : at + SIZE], LAYOUT)
    y, i = own
    z = table.start + y[i + Z]
    half, _ = _half(words, at, angle)
    mean = given_at(words, at + SIZE, (table.points, table.goes_on != 0), angle)
    return float(0.5 * half * table.reversal * z * z - mean)


@inlined
def kink(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Return a function that passes zero at reversals and ends of the tables."""
    return rate * ends_at(words, at + SIZE, record(words[at : at + SIZE], LAYOUT).points, angle)
