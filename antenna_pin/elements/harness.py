"""A harness: one table of torque over angle for each direction of motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.angle_table import TableSpring, ends_at, given_at, torque_at
from antenna_pin.elements.element import LOSS, Integral
from antenna_pin.elements.hook_kernels import Motion, Own, Powered
from antenna_pin.errors import InvalidParameterError

_Z = Integral("z", "1")
# Places among what it integrates.
HEAT, Z = range(2)


@dataclass(frozen=True, slots=True, kw_only=True)
class HarnessSpring(TableSpring):
    r"""A spring with a table of torque over angle for each direction.

    With T the torque while the angle grows and T_b that while it falls, M their mean and
    :math:`H = (T_b - T) / 2`, never negative,

    .. math:: \tau = M(\phi) - H(\phi) z, \quad \delta \dot z = \dot\phi - |\dot\phi| z

    so that z comes to 1 on the way up, to -1 on the way down, by :math:`1 - e^{-1}` of what is left for each
    reversal angle. At rest it does not creep.

    Stored is the integral of M and :math:`H \delta z^2 / 2`; the rest of what is put in is lost,
    :math:`H |\dot\phi| z^2 - H' \dot\phi \delta z^2 / 2` at a time, the loop's area in a cycle.

    Attributes:
        torque: On the child while the angle grows, one for each angle [N*m] ([N]).
        torque_back: On the child while it falls, never below torque [N*m] ([N]).
        reversal: Angle in which the torque goes from one table to the other, delta [rad] ([m]).
        start: z at the start of a run, from -1 to 1 [-].
    """

    kernels: ClassVar[str] = __name__
    at_start: ClassVar[tuple[str, ...]] = ("start",)
    columns: ClassVar[tuple[str, ...]] = ("angle", "torque", "torque_back")
    integrals: ClassVar[tuple[Integral, ...]] = (LOSS, _Z)
    states: ClassVar[tuple[Integral, ...]] = (_Z,)

    torque_back: tuple[float, ...] = parameter("N*m", sliding="N", sizes=(0,), repr=False)
    reversal: float = parameter("rad", sliding="m", rule="positive")
    start: float = parameter(rule="from -1 to 1", default=0.0)

    def __post_init__(self) -> None:
        """Check tables and start."""
        TableSpring.__post_init__(self)
        for k, (up, back) in enumerate(zip(self.torque, self.torque_back, strict=True)):
            if back < up:
                rule = f"at least torque there, {up!r}, or each cycle would make energy; exchange the two"
                raise InvalidParameterError(self, f"torque_back[{k}]", rule, back)

    @property
    def has_kinks(self) -> bool:
        """Return the number of kinks: reversals and ends of the tables."""
        return True

    def tail(self) -> tuple[float, ...]:
        """Return the curves of the mean and of half the difference."""
        pairs = tuple(zip(self.torque, self.torque_back, strict=True))
        mean = tuple(0.5 * (up + back) for up, back in pairs)
        half = tuple(0.5 * (back - up) for up, back in pairs)
        return (*self.curve_of(mean), *self.curve_of(half))

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        reversal = self.text_of("reversal", slides)
        return f"both ways, {TableSpring.words(self, slides)}, goes over within {reversal}"


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def _half(table: HarnessSpring, tail: Floats, angle: float) -> tuple[float, float]:
    """Return half the difference of the tables, H, and its slope; constant beyond them."""
    return torque_at(tail, 6 * table.points - 4, (table.points, False), angle)


@inlined
def effort_of(table: HarnessSpring, tail: Floats, motion: Motion, own: Own) -> float:
    """Torque [N m], or force [N]."""
    _, angle, _ = motion
    y, i = own
    mean, _ = torque_at(tail, 0, (table.points, table.extends), angle)
    half, _ = _half(table, tail, angle)
    return float(mean - half * (table.start + y[i + Z]))


@inlined
def write_rates_of(
    table: HarnessSpring, tail: Floats, motion: Powered, own: Own, rates: Floats, x: int
) -> None:
    """Power that is lost [W], and the rate of z [1/s]."""
    angle, rate, _ = motion
    y, i = own
    z = table.start + y[i + Z]
    half, slope = _half(table, tail, angle)
    rates[x + Z] = (rate - abs(rate) * z) / table.reversal
    rates[x + HEAT] = z * z * (half * abs(rate) - 0.5 * slope * rate * table.reversal)


@inlined
def stored_of(table: HarnessSpring, tail: Floats, angle: float, own: Own) -> float:
    """Energy stored [J]."""
    y, i = own
    z = table.start + y[i + Z]
    half, _ = _half(table, tail, angle)
    mean = given_at(tail, 0, (table.points, table.extends), angle)
    return float(0.5 * half * table.reversal * z * z - mean)


@inlined
def kink(table: HarnessSpring, tail: Floats, t: float, angle: float, rate: float) -> float:
    """Return a function that passes zero at reversals and ends of the tables."""
    return rate * ends_at(tail, 0, table.points, angle)
