"""A spring of constant torque: a tape, a clock's spring."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.element import LOSS, Element, Integral, packed
from antenna_pin.errors import InvalidParameterError


@dataclass(frozen=True, slots=True, kw_only=True)
class ConstantSpring(Element):
    r"""A spring of constant torque: a tape spring, a clock's spring.

    It acts between two angles, or all the way. Outside there is no torque; between an end and ``ramp`` beyond
    it the torque falls to none in proportion, for one that jumps would have no place where it lies at rest.
    Stored is what the torque gives on the way to where that ends (without such an end, what it gives on the
    way to the angle zero, which may be less than nothing).

    Attributes:
        torque: On the child, about the joint's axis [N*m] ([N]).
        lower: Lower end of its range [rad] ([m]); None for no end there.
        upper: Upper end of its range [rad] ([m]); None for no end there.
        ramp: Angle in which it ceases, beyond an end [rad] ([m]).
    """

    kernels: ClassVar[str] = __name__
    traced: ClassVar[bool] = True
    senses: ClassVar[bool] = True
    integrals: ClassVar[tuple[Integral, ...]] = (LOSS,)

    torque: float = parameter("N*m", sliding="N")
    lower: float | None = parameter("rad", sliding="m", default=None)
    upper: float | None = parameter("rad", sliding="m", default=None)
    ramp: float = parameter("rad", sliding="m", rule="positive", default=1e-3)
    on: bool = True

    def __post_init__(self) -> None:
        """Check the parameters together."""
        Element.__post_init__(self)
        if self.lower is not None and self.upper is not None and not self.lower < self.upper:
            raise InvalidParameterError(self, "upper", f"above lower = {self.lower:g}", self.upper)

    @property
    def has_kinks(self) -> bool:
        """Return the number of kinks: ends of a ramp."""
        return self.lower is not None or self.upper is not None

    @packed
    def lowest(self) -> float:
        """Angle above which it acts, minus infinity without [rad] ([m])."""
        return -math.inf if self.lower is None else self.lower

    @packed
    def highest(self) -> float:
        """Angle below which it acts, infinity without [rad] ([m])."""
        return math.inf if self.upper is None else self.upper

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        ends = [
            f"{word} {self.text_of(name, slides)}"
            for name, word in (("lower", "from"), ("upper", "to"))
            if getattr(self, name) is not None
        ]
        where = f", {' '.join(ends)}, ceases within {self.text_of('ramp', slides)}" if ends else ""
        return f"constant {self.text_of('torque', slides)}{where}"


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def effort(spring: ConstantSpring, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    beyond = max(spring.lowest - angle, angle - spring.highest, 0.0) / spring.ramp
    return float(spring.torque * max(1.0 - beyond, 0.0))


@inlined
def _way(lower: float, upper: float, ramp: float, angle: float) -> float:
    """Return the integral of the active share of the torque, but for a constant."""
    found = min(angle, upper)
    if not math.isinf(lower):
        s = min(max(1.0 - (lower - angle) / ramp, 0.0), 1.0)
        found = 0.5 * ramp * s * s + max(found - lower, 0.0)
    if not math.isinf(upper):
        s = min(max((angle - upper) / ramp, 0.0), 1.0)
        found += ramp * s * (1.0 - 0.5 * s)
    return found


@inlined
def stored(spring: ConstantSpring, angle: float) -> float:
    """Return the energy stored [J]: work from here to the end, or to angle zero."""
    lower, upper, ramp = spring.lowest, spring.highest, spring.ramp
    if spring.torque > 0.0 and not math.isinf(upper):
        end = _way(lower, upper, ramp, upper + ramp)
    elif spring.torque < 0.0 and not math.isinf(lower):
        end = 0.0  # below its ramp
    else:
        end = _way(lower, upper, ramp, 0.0)
    return float(spring.torque * (end - _way(lower, upper, ramp, angle)))


@inlined
def kink(spring: ConstantSpring, t: float, angle: float, rate: float) -> float:
    """Product of the ways to where its ramps begin and end."""
    found = 1.0
    if not math.isinf(spring.lowest):
        found *= (angle - spring.lowest) * (angle - spring.lowest + spring.ramp)
    if not math.isinf(spring.highest):
        found *= (angle - spring.highest) * (angle - spring.highest - spring.ramp)
    return float(found)
