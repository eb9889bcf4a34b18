"""Friction of a joint itself, apart from contacts: a URDF's ``<dynamics>``."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.element import LOSS, Element, Integral

__all__ = ["JointFriction"]


@dataclass(frozen=True, slots=True, kw_only=True)
class JointFriction(Element):
    r"""Viscous and Coulomb friction of a turning (sliding) joint.

    .. math:: \tau = -c\, \dot\phi - T \frac{\dot\phi}{\sqrt{\dot\phi^2 + \omega_r^2}}

    Smooth and viscous near rest: it does not stick. Under a static load L below T it creeps, at
    :math:`\omega_r L / \sqrt{T^2 - L^2}`; a moment of inertia I comes to rest within some
    :math:`I \omega_r / T`, which explicit steps must resolve.

    At a clearance joint phi is the motion angle, as for springs; it acts beside the friction of the contacts.

    Attributes:
        damping: c [N*m*s/rad] ([N*s/m]).
        friction: T [N*m] ([N]).
        regularisation_speed: omega_r, where Coulomb friction is 71 % of its limit [rad/s] ([m/s]).

    References:
        URDF's ``<dynamics>`` names damping and friction and leaves open what friction does at rest.
    """

    kernels: ClassVar[str] = __name__
    senses: ClassVar[bool] = True
    integrals: ClassVar[tuple[Integral, ...]] = (LOSS,)
    one_above_zero: ClassVar[tuple[str, ...]] = ("friction", "damping")

    damping: float = parameter("N*m*s/rad", sliding="N*s/m", rule="zero or more", default=0.0)
    friction: float = parameter("N*m", sliding="N", rule="zero or more", default=0.0)
    regularisation_speed: float = parameter("rad/s", sliding="m/s", rule="positive", default=1e-3)
    on: bool = True

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        found = self.said_of({"damping": "damping", "friction": "friction"}, slides)
        if self.friction:
            found.append(f"rounded off below {self.text_of('regularisation_speed', slides)}")
        return ", ".join(found)


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def resistance(law: JointFriction, rate: float) -> float:
    """Torque [N m], or force [N], against the rate."""
    size = math.sqrt(rate * rate + law.regularisation_speed * law.regularisation_speed)
    return float(law.damping * rate + law.friction * rate / size)


@inlined
def effort(law: JointFriction, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    return -resistance(law, rate)


@inlined
def write_rates(law: JointFriction, angle: float, rate: float, power: float, rates: Floats, x: int) -> None:
    """Power that it takes [W]."""
    rates[x] = resistance(law, rate) * rate
