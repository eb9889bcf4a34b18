r"""Friction laws of the slip speed whose friction falls from a static to a dynamic coefficient.

As the others of the slip speed (:mod:`antenna_pin.contact.friction`) they are regular at rest: no stiction.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from antenna_pin.contact import friction_kernels as kernels
from antenna_pin.contact.friction import (
    CompiledFrictionLaw,
    check_at_least,
    check_coefficient,
    check_positive,
)
from antenna_pin.errors import InvalidParameterError

__all__ = ["BengisuAkay", "BrownMcPhee", "Stribeck", "VelocityBased"]


@dataclass(frozen=True, slots=True, kw_only=True)
class VelocityBased(CompiledFrictionLaw):
    r"""Velocity-based ("modified Coulomb") friction of ADAMS type, as Bai and Zhao use it, corrected.

    With :math:`y = |v| / v_s` and :math:`x = (v_d - |v|) / (v_d - v_s)`

    .. math:: \mu = \begin{cases}
        \mu_s\, y (3 - y^2) / 2 & |v| < v_s \\
        \mu_d + (\mu_s - \mu_d)\, x^2 (3 - 2x) & v_s \le |v| < v_d \\
        \mu_d & v_d \le |v| \end{cases}

    continuous with its slope. Near rest it is viscous, with slope :math:`1.5 \mu_s / v_s`. Put right are the
    paper's (14), whose second branch has its argument reversed, and (13), which applies the sign of the slip
    twice.

    Attributes:
        static: mu_s, reached at ``static_speed`` [-].
        dynamic: mu_d, from ``dynamic_speed`` on [-].
        static_speed: v_s [m/s].
        dynamic_speed: v_d, above v_s [m/s].

    References:
        Bai and Zhao (2020), Int. J. Aerospace Eng., 8846177, equations (13), (14), Table 2.
    """

    kind: ClassVar[float] = kernels.VELOCITY_BASED

    static: float = field(metadata={"unit": "1", "doc": "mu_s, at static_speed"})
    dynamic: float = field(metadata={"unit": "1", "doc": "mu_d, from dynamic_speed on"})
    static_speed: float = field(metadata={"unit": "m/s", "doc": "v_s"})
    dynamic_speed: float = field(metadata={"unit": "m/s", "doc": "v_d, above v_s"})

    def __post_init__(self) -> None:
        """Check the parameters."""
        check_coefficient(self, "static")
        check_coefficient(self, "dynamic")
        check_positive(self, "static_speed")
        if not self.static_speed < self.dynamic_speed < np.inf:
            raise InvalidParameterError(self, "dynamic_speed", f"above static_speed = {self.static_speed}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Stribeck(CompiledFrictionLaw):
    r"""Friction that falls from static to dynamic with the speed, and a viscous part.

    .. math:: \mu(|v|) = \left[\mu_d + (\mu_s - \mu_d)\, e^{-(|v| / v_s)^a}\right] \tanh(|v| / v_t)
              + \sigma |v|

    The tanh stands for the sign of the slip, whose jump it rounds off. The viscous part is proportional to
    the load, like the rest, so that an unloaded contact has no friction.

    Attributes:
        static: mu_s, at least ``dynamic`` [-].
        dynamic: mu_d [-].
        stribeck_speed: v_s [m/s].
        transition_speed: v_t, below v_s [m/s].
        viscous: sigma, viscous coefficient [s/m].
        shape: a [-]; 2 is usual, 1/2 to 2 in the literature.

    References:
        Stribeck (1902); the form of Bo and Pavelescu (1982), as Andersson, Soderberg and Bjorklund (2007),
        Tribol. Int. 40, 580-587, regularise it.
    """

    kind: ClassVar[float] = kernels.STRIBECK

    static: float = field(metadata={"unit": "1", "doc": "mu_s, at least dynamic"})
    dynamic: float = field(metadata={"unit": "1", "doc": "mu_d"})
    stribeck_speed: float = field(metadata={"unit": "m/s", "doc": "v_s, over which friction falls"})
    transition_speed: float = field(
        default=1e-4, metadata={"unit": "m/s", "doc": "v_t, below v_s, over which it rises from rest"}
    )
    viscous: float = field(default=0.0, metadata={"unit": "s/m", "doc": "sigma, viscous coefficient"})
    shape: float = field(default=2.0, metadata={"unit": "1", "doc": "a of exp(-(v/v_s)^a)"})

    def __post_init__(self) -> None:
        """Check the parameters."""
        check_coefficient(self, "dynamic")
        check_at_least(self, "static", "dynamic")
        check_positive(self, "stribeck_speed", "transition_speed", "shape")
        if not self.transition_speed < self.stribeck_speed:
            raise InvalidParameterError(
                self, "transition_speed", f"below stribeck_speed = {self.stribeck_speed}"
            )
        check_coefficient(self, "viscous")

    @property
    def exponent(self) -> float:
        """A [-]: the shape, as the kernels name it."""
        return self.shape


@dataclass(frozen=True, slots=True, kw_only=True)
class BengisuAkay(CompiledFrictionLaw):
    r"""Bengisu and Akay's rise to static friction and fall to dynamic friction.

    .. math:: \mu(|v|) = \begin{cases}
        \mu_s \left[1 - (1 - |v| / v_0)^2\right] & |v| < v_0 \\
        \mu_d + (\mu_s - \mu_d)\, e^{-\xi (|v| - v_0)} & v_0 \le |v| \end{cases}

    Continuous, with a kink at v_0.

    Attributes:
        static: mu_s, at ``static_speed``; at least ``dynamic`` [-].
        dynamic: mu_d, at high speed [-].
        static_speed: v_0 [m/s].
        decay: xi, how fast friction falls [s/m].

    References:
        Bengisu and Akay (1994), J. Sound Vib. 171(4), 557-570. Recalled, not checked against the paper.
    """

    kind: ClassVar[float] = kernels.BENGISU_AKAY

    static: float = field(metadata={"unit": "1", "doc": "mu_s, at static_speed; at least dynamic"})
    dynamic: float = field(metadata={"unit": "1", "doc": "mu_d, at high speed"})
    static_speed: float = field(metadata={"unit": "m/s", "doc": "v_0"})
    decay: float = field(metadata={"unit": "s/m", "doc": "xi of exp(-xi (v - v_0))"})

    def __post_init__(self) -> None:
        """Check the parameters."""
        check_coefficient(self, "dynamic")
        check_at_least(self, "static", "dynamic")
        check_positive(self, "static_speed")
        check_coefficient(self, "decay")


@dataclass(frozen=True, slots=True, kw_only=True)
class BrownMcPhee(CompiledFrictionLaw):
    r"""Brown and McPhee's smooth law with Stribeck peak and viscous part.

    .. math:: F_t = F_n \left[\mu_d \tanh\frac{4 v}{v_t}
              + \frac{(\mu_s - \mu_d)\, v / v_t}{\left[\tfrac14 (v / v_t)^2 + \tfrac34\right]^2}\right]
              + \mu_v\, v \tanh\frac{4 F_n}{F_{nt}}

    Infinitely differentiable. The peak, mu_s but for :math:`\mu_d (1 - \tanh 4) = 0.0007 \mu_d`, is at v_t.
    The viscous part does not grow with the load, but fades in with it.

    Attributes:
        static: mu_s, at least ``dynamic`` [-].
        dynamic: mu_d [-].
        transition_speed: v_t, of the peak [m/s].
        viscous: mu_v [N s/m].
        transition_force: F_nt, normal force from which on the viscous part acts in full [N].

    References:
        Brown and McPhee (2016), J. Comput. Nonlinear Dyn. 11, 054502; the formula as public multibody codes
        have it.
    """

    kind: ClassVar[float] = kernels.BROWN_MCPHEE

    static: float = field(metadata={"unit": "1", "doc": "mu_s, at the peak; at least dynamic"})
    dynamic: float = field(metadata={"unit": "1", "doc": "mu_d, at high speed"})
    transition_speed: float = field(metadata={"unit": "m/s", "doc": "v_t, of the peak"})
    viscous: float = field(default=0.0, metadata={"unit": "N*s/m", "doc": "mu_v, viscous coefficient"})
    transition_force: float = field(
        default=1.0, metadata={"unit": "N", "doc": "F_nt, load from which on mu_v acts in full"}
    )

    def __post_init__(self) -> None:
        """Check the parameters."""
        check_coefficient(self, "dynamic")
        check_at_least(self, "static", "dynamic")
        check_positive(self, "transition_speed", "transition_force")
        check_coefficient(self, "viscous")
