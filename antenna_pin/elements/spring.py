"""A spring and damper."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.element import LOSS, Element, Integral
from antenna_pin.errors import InvalidParameterError


@dataclass(frozen=True, slots=True, kw_only=True)
class JointSpring(Element):
    r"""A linear spring and damper at a turning (sliding) joint.

    .. math:: \tau = -k (\phi - \phi_0) - c \dot\phi

    The generalized force is the exact gradient of phi, so that it conserves energy at a joint with play too,
    under tilt. A spring wound by three turns unwinds.

    Attributes:
        stiffness: [N*m/rad] ([N/m]).
        damping: [N*m*s/rad] ([N*s/m]).
        rest_angle: Rest angle [rad] ([m]).
        shorter_way: Whether the deflection is taken the shorter way round, as a magnet's: it jumps at half a
            turn.
    """

    kernels: ClassVar[str] = __name__
    senses: ClassVar[bool] = True
    integrals: ClassVar[tuple[Integral, ...]] = (LOSS,)
    one_above_zero: ClassVar[tuple[str, ...]] = ("stiffness", "damping")
    labels: ClassVar[Mapping[str, str]] = {
        "stiffness": "stiffness",
        "damping": "damping",
        "rest_angle": "at rest at",
    }

    stiffness: float = parameter("N*m/rad", sliding="N/m", rule="zero or more", default=0.0)
    damping: float = parameter("N*m*s/rad", sliding="N*s/m", rule="zero or more", default=0.0)
    rest_angle: float = parameter("rad", sliding="m", default=0.0)
    shorter_way: bool = False
    on: bool = True

    def check_joint(self, place: str, slides: bool) -> None:
        """Refuse a shorter way along a line."""
        if slides and self.shorter_way:
            raise InvalidParameterError(place, "shorter_way", f"false: joint {self.joint!r} slides", True)


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def deflection(spring: JointSpring, angle: float) -> float:
    """Return the angle of the joint from rest, the shorter way round with that option."""
    turned = float(angle - spring.rest_angle)
    if spring.shorter_way:
        return turned + 2.0 * math.pi * math.floor(0.5 - turned / (2.0 * math.pi))
    return turned


@inlined
def effort(spring: JointSpring, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    return float(-spring.stiffness * deflection(spring, angle) - spring.damping * rate)


@inlined
def write_rates(spring: JointSpring, angle: float, rate: float, power: float, rates: Floats, x: int) -> None:
    """Power that the damper takes [W]."""
    rates[x] = spring.damping * rate * rate


@inlined
def stored(spring: JointSpring, angle: float) -> float:
    """Energy stored [J]."""
    turned = deflection(spring, angle)
    return float(0.5 * spring.stiffness * turned * turned)
