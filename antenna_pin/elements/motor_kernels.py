"""A motor with brushes, or one that is driven as if it had them, compiled."""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.hook_kernels import Motion, Own, Powered


class PackedMotor(Record):
    """A motor's parameters; ``value`` is what its driver is commanded."""

    value: float  # command, a voltage [V] or a current [A]
    by_current: float  # 1: the command is a current, 0: a voltage
    torque_constant: float  # [N m/A]
    back_emf: float  # voltage over the rotor's rate [V s/rad]
    resistance: float  # of the winding [ohm]
    inductance: float  # of the winding [H]; 0: the current follows at once
    voltage_limit: float  # largest voltage of the driver [V]
    current_limit: float  # largest current of the driver [A]
    cogging: float  # largest cogging torque, on the rotor [N m]
    cycles: float  # of the cogging in a turn of the rotor
    phase: float  # of the cogging [rad]
    ratio: float  # turns of the rotor over those of the joint


LAYOUT = layout(PackedMotor)
SIZE = words_of(LAYOUT)
# Among what it integrates.
WORK = 0
GROSS_WORK = 1
ELECTRIC = 2
WINDING_HEAT = 3
CURRENT = 4


@inlined
def _clamped(value: float, middle: float, reach: float) -> float:
    return min(max(value, middle - reach), middle + reach)


@inlined
def _voltage(m: PackedMotor, back: float) -> float:
    """Voltage that the driver puts on [V], at a back-EMF [V]."""
    if m.by_current != 0.0:
        wished = m.resistance * _clamped(m.value, 0.0, m.current_limit) + back
        return float(_clamped(wished, 0.0, m.voltage_limit))
    return float(_clamped(_clamped(m.value, 0.0, m.voltage_limit), back, m.resistance * m.current_limit))


@inlined
def _current(m: PackedMotor, back: float, voltage: float, own: Own) -> float:
    """Current [A]: a state where there is an inductance."""
    y, i = own
    return float(y[i + CURRENT] if m.inductance > 0.0 else (voltage - back) / m.resistance)


@inlined
def _cogging(m: PackedMotor, angle: float) -> float:
    """Torque of the cogging on the rotor [N m]."""
    return float(-m.cogging * math.sin(m.cycles * m.ratio * angle + m.phase))


@inlined
def effort_of(words: Floats, at: int, motion: Motion, own: Own) -> float:
    """Torque [N m], or force [N]."""
    m = record(words[at : at + SIZE], LAYOUT)
    _, angle, rate = motion
    back = m.back_emf * m.ratio * rate
    current = _current(m, back, _voltage(m, back), own)
    return float(m.ratio * (m.torque_constant * current + _cogging(m, angle)))


@inlined
def write_rates_of(words: Floats, at: int, motion: Powered, own: Own, rates: Floats, x: int) -> None:
    """Powers without the cogging's, which is stored, [W], and the rate of the current [A/s]."""
    m = record(words[at : at + SIZE], LAYOUT)
    angle, rate, power = motion
    back = m.back_emf * m.ratio * rate
    voltage = _voltage(m, back)
    current = _current(m, back, voltage, own)
    put_in = power - m.ratio * _cogging(m, angle) * rate
    rates[x + WORK] = put_in
    rates[x + GROSS_WORK] = abs(put_in)
    rates[x + ELECTRIC] = voltage * current
    rates[x + WINDING_HEAT] = m.resistance * current * current
    rates[x + CURRENT] = 0.0
    if m.inductance > 0.0:
        rates[x + CURRENT] = (voltage - back - m.resistance * current) / m.inductance


@inlined
def stored_of(words: Floats, at: int, angle: float, own: Own) -> float:
    """Energy stored in the cogging [J]."""
    m = record(words[at : at + SIZE], LAYOUT)
    if m.cogging == 0.0:
        return 0.0
    return float(-m.cogging / m.cycles * math.cos(m.cycles * m.ratio * angle + m.phase))


@inlined
def kink(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Return the margin to a limit, by the rate of the joint [V]."""
    m = record(words[at : at + SIZE], LAYOUT)
    back = m.back_emf * m.ratio * rate
    if m.by_current != 0.0:
        wished = m.resistance * _clamped(m.value, 0.0, m.current_limit) + back
        return float(abs(wished) - m.voltage_limit)
    return float(abs(_clamped(m.value, 0.0, m.voltage_limit) - back) - m.resistance * m.current_limit)
