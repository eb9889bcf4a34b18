"""A spring with hysteresis after Bouc and Wen."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.element import LOSS, Element, Integral
from antenna_pin.elements.hook_kernels import Motion, Own, Powered
from antenna_pin.errors import InvalidParameterError

_Z = Integral("z", "1")
# Places among what it integrates.
HEAT, Z = range(2)


@dataclass(frozen=True, slots=True, kw_only=True)
class BoucWen(Element):
    r"""A spring with hysteresis after Bouc and Wen, at a turning (sliding) joint.

    .. math:: \tau = -\alpha k (\phi - \phi_0) - (1 - \alpha) k D z, \quad
        D \dot z = A \dot\phi - \beta |\dot\phi| |z|^{n-1} z - \gamma \dot\phi |z|^n

    z ends at :math:`\pm (A / (\beta + \gamma))^{1/n}`; with the defaults D is the angle at which it yields.
    Only the displacement counts, not time. :math:`|\gamma| \le \beta` is required: otherwise small cycles
    gain energy.

    The stored energy is :math:`\alpha k (\phi - \phi_0)^2 / 2 + (1 - \alpha) k D^2 z^2 / (2 A)`; the loss
    rate :math:`(1 - \alpha) k D |z|^n (\beta |\dot\phi z| + \gamma \dot\phi z) / A` is never negative if
    :math:`|\gamma| \le \beta`.

    Attributes:
        alpha: Share of the stiffness that is elastic, up to 1.
        stiffness: k, of the start [N*m/rad] ([N/m]).
        yield_angle: D [rad] ([m]).
        slope: A, initial growth of z per yield angle [-].
        beta: Rate of yielding away from zero; the larger, the thicker is the loop [-].
        gamma: Difference of that on the way back, at most beta in size [-].
        exponent: n; the larger, the sharper is the knee [-].
        rest_angle: Rest angle of the elastic part [rad] ([m]).
        start: z at the start of a run [-].

    References:
        Wen, Y.-K.: Method for random vibration of hysteretic systems. J. Engineering Mechanics Division 102
        (1976), 249-263.
    """

    kernels: ClassVar[str] = __name__
    at_start: ClassVar[tuple[str, ...]] = ("start",)
    traced: ClassVar[bool] = True
    senses: ClassVar[bool] = True
    integrals: ClassVar[tuple[Integral, ...]] = (LOSS, _Z)
    states: ClassVar[tuple[Integral, ...]] = (_Z,)

    alpha: float = parameter(rule="from 0 to 1")
    stiffness: float = parameter("N*m/rad", sliding="N/m", rule="positive")
    yield_angle: float = parameter("rad", sliding="m", rule="positive")
    slope: float = parameter(rule="positive", default=1.0)
    beta: float = parameter(rule="zero or more", default=0.5)
    gamma: float = parameter(default=0.5)
    exponent: float = parameter(rule="1 or more", default=1.0)
    rest_angle: float = parameter("rad", sliding="m", default=0.0)
    start: float = parameter(default=0.0)
    on: bool = True

    def __post_init__(self) -> None:
        """Check the parameters together."""
        Element.__post_init__(self)
        if not abs(self.gamma) <= self.beta:
            rule = f"at most beta = {self.beta:g} in size, or small cycles would make energy; raise beta"
            raise InvalidParameterError(self, "gamma", rule, self.gamma)
        if not self.beta + self.gamma > 0.0:
            rule = "above -beta, or it would never yield; take a spring with no hysteresis"
            raise InvalidParameterError(self, "gamma", rule, self.gamma)
        if not abs(self.start) <= self.limit:
            rule = f"at most {self.limit:g} in size, where z ends"
            raise InvalidParameterError(self, "start", rule, self.start)

    @property
    def limit(self) -> float:
        """Bound of z [-]."""
        return float((self.slope / (self.beta + self.gamma)) ** (1.0 / self.exponent))

    @property
    def kinks(self) -> int:
        """Return the number of kinks: reversals, and zeros of z."""
        odd = self.exponent % 2.0 == 1.0 and self.gamma == 0.0
        return 1 if odd else 2

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        said = {"stiffness": "stiffness", "yield_angle": "yields at", "rest_angle": "at rest at"}
        shape = f"alpha {self.alpha:g}, A {self.slope:g}, beta {self.beta:g}, gamma {self.gamma:g}"
        return f"Bouc-Wen, {', '.join(self.said_of(said, slides))}, {shape}, n {self.exponent:g}"


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def effort_of(law: BoucWen, motion: Motion, own: Own) -> float:
    """Torque [N m], or force [N]."""
    _, angle, _ = motion
    y, i = own
    z = law.start + y[i + Z]
    elastic = law.alpha * law.stiffness * (angle - law.rest_angle)
    return float(-elastic - (1.0 - law.alpha) * law.stiffness * law.yield_angle * z)


@inlined
def write_rates_of(law: BoucWen, motion: Powered, own: Own, rates: Floats, x: int) -> None:
    """Power that is lost [W], and the rate of z [1/s]."""
    _, rate, _ = motion
    y, i = own
    z = law.start + y[i + Z]
    size = math.pow(abs(z), law.exponent)
    sign = math.copysign(1.0, z)
    yields = size * (law.beta * abs(rate) * sign + law.gamma * rate)
    rates[x + Z] = (law.slope * rate - yields) / law.yield_angle
    rates[x + HEAT] = (1.0 - law.alpha) * law.stiffness * law.yield_angle * z * yields / law.slope


@inlined
def stored_of(law: BoucWen, angle: float, own: Own) -> float:
    """Energy stored [J]."""
    y, i = own
    z = law.yield_angle * (law.start + y[i + Z])
    turned = angle - law.rest_angle
    elastic = law.alpha * turned * turned + (1.0 - law.alpha) * z * z / law.slope
    return float(0.5 * law.stiffness * elastic)


@inlined
def kink_of(law: BoucWen, k: int, motion: Motion, own: Own) -> float:
    """Return the rate (k = 0) or z (1), zero at kinks.

    Where the joint turns back the rate of z changes; it depends on the size of z.
    """
    if k == 0:
        return float(motion[2])
    y, i = own
    return float(law.start + y[i + Z])
