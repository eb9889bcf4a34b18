"""A motor with its circuit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Literal

from antenna_pin.base.parameters import parameter
from antenna_pin.base.readable import GIVEN, readable
from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.element import GROSS_WORK, WORK, Drive, Integral, packed
from antenna_pin.elements.hook_kernels import Motion, Own, Powered
from antenna_pin.errors import InvalidParameterError

_CURRENT = Integral("current", "A")
# Places among what it integrates.
_WORK_AT, _GROSS_AT, _ELECTRIC_AT, _HEAT_AT, _CURRENT_AT = range(5)


@dataclass(frozen=True, slots=True, kw_only=True)
class Motor(Drive):
    r"""A motor with brushes, or controlled like one, at a geared joint.

    .. math:: \tau = n (K_t i - T_c \sin(c n \phi + \psi)), \quad L \dot i = U - R i - K_e n \dot\phi

    Without an inductance the current follows at once. The driver applies the commanded voltage within its
    limit and that of the current: U lies within :math:`K_e n \dot\phi \pm R i_{max}`. A commanded current
    needs the voltage :math:`R i + K_e n \dot\phi`, which is limited.

    Its work is that on the joint, without the cogging, whose energy is stored,
    :math:`-(T_c / c) \cos(c n \phi + \psi)`. The energy from its supply, :math:`\int U i`, and the heat
    of the winding, :math:`\int R i^2`, are separate results: less the heat and :math:`L i^2 / 2` the
    first is the work if both constants are equal, as in SI units. Switched off it does not act on the
    joint, and its circuit continues as if the joint stood still.

    Attributes:
        value: Commanded voltage [V] or current [A], by ``mode``.
        mode: Commanded quantity.
        torque_constant: K_t [N*m/A].
        back_emf: K_e; that of the torque, if not given [V*s/rad].
        resistance: R [ohm].
        inductance: L; 0 for a current that follows at once [H].
        voltage_limit: Largest voltage either way; none if not given [V].
        current_limit: Largest current either way; none if not given [A].
        cogging: T_c, largest cogging torque, of the motor [N*m].
        cycles: c, cycles of the cogging in a turn of the motor [-].
        cogging_phase: psi [rad].
        ratio: n: turns of the motor per turn of its joint [-] ([rad/m]); below zero it turns the other way.
    """

    kernels: ClassVar[str] = __name__
    commanded: ClassVar[str] = "value"
    senses: ClassVar[bool] = True
    integrals: ClassVar[tuple[Integral, ...]] = (
        WORK,
        GROSS_WORK,
        Integral("electric"),
        Integral("heat"),
        _CURRENT,
    )
    states: ClassVar[tuple[Integral, ...]] = (_CURRENT,)

    value: float = parameter(default=0.0)
    mode: Literal["voltage", "current"] = "voltage"
    torque_constant: float = parameter("N*m/A", rule="positive")
    back_emf: float | None = parameter("V*s/rad", rule="zero or more", default=None)
    resistance: float = parameter("ohm", rule="positive")
    inductance: float = parameter("H", rule="zero or more", default=0.0)
    voltage_limit: float | None = parameter("V", rule="positive", default=None)
    current_limit: float | None = parameter("A", rule="positive", default=None)
    cogging: float = parameter("N*m", rule="zero or more", default=0.0)
    cycles: int = parameter(rule="1 or more", default=1)
    cogging_phase: float = parameter("rad", default=0.0)
    ratio: float = parameter("1", sliding="rad/m", default=1.0)

    def __post_init__(self) -> None:
        """Check the parameters together."""
        Drive.__post_init__(self)
        if self.ratio == 0.0:
            raise InvalidParameterError(self, "ratio", "other than zero", self.ratio)
        if self.mode == "current" and self.inductance > 0.0:
            rule = "zero where the current is commanded, which its driver then makes whatever it takes"
            raise InvalidParameterError(self, "inductance", rule, self.inductance)

    @property
    def has_kinks(self) -> bool:
        """Return whether a limit may act."""
        return (self.voltage_limit if self.mode == "current" else self.current_limit) is not None

    @packed
    def by_current(self) -> bool:
        """Command of a current, not of a voltage."""
        return self.mode == "current"

    @packed
    def voltage_per_rate(self) -> float:
        """Back-EMF over the rate of the motor, K_e [V*s/rad]."""
        return self.torque_constant if self.back_emf is None else self.back_emf

    @packed
    def largest_voltage(self) -> float:
        """Largest voltage either way, infinity without a limit [V]."""
        return math.inf if self.voltage_limit is None else self.voltage_limit

    @packed
    def largest_current(self) -> float:
        """Largest current either way, infinity without a limit [A]."""
        return math.inf if self.current_limit is None else self.current_limit

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        unit = "V" if self.mode == "voltage" else "A"
        said = {"torque_constant": "K_t", "resistance": "R", "inductance": "L", "cogging": "cogging"}
        given = f"commanded {readable(self.value, unit, GIVEN)}"
        return f"motor, {', '.join([given, *self.said_of(said, slides)])}, ratio {self.ratio:g}"


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def _clamped(value: float, middle: float, reach: float) -> float:
    return min(max(value, middle - reach), middle + reach)


@inlined
def _voltage(m: Motor, back: float) -> float:
    """Voltage that the driver puts on [V], at a back-EMF [V]."""
    if m.by_current:
        wished = m.resistance * _clamped(m.value, 0.0, m.largest_current) + back
        return float(_clamped(wished, 0.0, m.largest_voltage))
    return float(_clamped(_clamped(m.value, 0.0, m.largest_voltage), back, m.resistance * m.largest_current))


@inlined
def _current(m: Motor, back: float, voltage: float, own: Own) -> float:
    """Current [A]: a state where there is an inductance."""
    y, i = own
    return float(y[i + _CURRENT_AT] if m.inductance > 0.0 else (voltage - back) / m.resistance)


@inlined
def _cogging(m: Motor, angle: float) -> float:
    """Torque of the cogging on the rotor [N m]."""
    return float(-m.cogging * math.sin(m.cycles * m.ratio * angle + m.cogging_phase))


@inlined
def effort_of(m: Motor, motion: Motion, own: Own) -> float:
    """Torque [N m], or force [N]."""
    _, angle, rate = motion
    back = m.voltage_per_rate * m.ratio * rate
    current = _current(m, back, _voltage(m, back), own)
    return float(m.ratio * (m.torque_constant * current + _cogging(m, angle)))


@inlined
def write_rates_of(m: Motor, motion: Powered, own: Own, rates: Floats, x: int) -> None:
    """Powers without the cogging's, which is stored, [W], and the rate of the current [A/s]."""
    angle, rate, power = motion
    back = m.voltage_per_rate * m.ratio * rate
    voltage = _voltage(m, back)
    current = _current(m, back, voltage, own)
    put_in = power - m.ratio * _cogging(m, angle) * rate
    rates[x + _WORK_AT] = put_in
    rates[x + _GROSS_AT] = abs(put_in)
    rates[x + _ELECTRIC_AT] = voltage * current
    rates[x + _HEAT_AT] = m.resistance * current * current
    rates[x + _CURRENT_AT] = 0.0
    if m.inductance > 0.0:
        rates[x + _CURRENT_AT] = (voltage - back - m.resistance * current) / m.inductance


@inlined
def stored_of(m: Motor, angle: float, own: Own) -> float:
    """Energy stored in the cogging [J]."""
    if m.cogging == 0.0:
        return 0.0
    return float(-m.cogging / m.cycles * math.cos(m.cycles * m.ratio * angle + m.cogging_phase))


@inlined
def kink(m: Motor, t: float, angle: float, rate: float) -> float:
    """Return the margin to a limit, by the rate of the joint [V]."""
    back = m.voltage_per_rate * m.ratio * rate
    if m.by_current:
        wished = m.resistance * _clamped(m.value, 0.0, m.largest_current) + back
        return float(abs(wished) - m.largest_voltage)
    return float(abs(_clamped(m.value, 0.0, m.largest_voltage) - back) - m.resistance * m.largest_current)
