r"""Friction laws of the slip speed: force over normal force and slip.

Every law opposes the slip: with slip velocity :math:`v` of the journal's material point over the bearing's,
:math:`F_t = -\mu(|v|) F_n v / |v|`. All are regular at rest, where friction is viscous: they have no
stiction, and a joint under a static load creeps. Laws that stick remember a deflection: they are in
:mod:`antenna_pin.contact.bristle`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import check_takes, takes
from antenna_pin.base.parameters import parameter
from antenna_pin.base.records import packed
from antenna_pin.compiled.calls import call_1
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.compiled.given_functions import address_of, callable_of, is_compiled
from antenna_pin.contact.kernels import friction_ratio
from antenna_pin.contact.normal import Law
from antenna_pin.contact.records import friction_code
from antenna_pin.errors import InvalidParameterError


@runtime_checkable
class FrictionLaw(Protocol):
    """Protocol of a friction law of the slip speed."""

    def coefficient(self, speed: float) -> float:
        """Return the friction coefficient mu at a slip speed [m/s] [-], never negative."""


class CompiledFrictionLaw(Law):
    """Base of the laws whose arithmetic is a compiled kernel.

    Attributes:
        kernel: Of record, slip speed [m/s] and normal force [N]: the coefficient over the speed [s/m], finite
            at rest. Only laws whose friction is not proportional to the force depend on it.
        frequent: Whether it is compiled into its callers.
    """

    __slots__ = ()

    kernel: ClassVar[Any]
    frequent: ClassVar[bool] = False

    @property
    def states(self) -> int:
        """Integrated values per contact that the law carries [-]."""
        return len(self.state_scales)

    @property
    def state_scales(self) -> tuple[float, ...]:
        """Scale of each internal state, in its own unit, for error control."""
        return ()

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (12,), for the fused kernels."""
        return friction_code(self)

    def coefficient(self, speed: float, normal_force: float = np.inf) -> float:
        """Return the friction coefficient at a slip speed; at least 0 [-].

        Args:
            speed: Slip speed [m/s], zero or more.
            normal_force: What presses the surfaces together [N]; for laws whose friction is not proportional
                to it.
        """
        return float(friction_ratio(self.code(), speed, normal_force) * speed)


@kernel
def tanh_ratio(y: float) -> float:
    """``tanh(y) / y`` for y >= 0, by its series near zero."""
    return 1.0 - y * y / 3.0 if y < 1e-4 else math.tanh(y) / y


# A law that has not fallen by half at this speed from what it reaches further on jumps at rest [m/s].
_REST, _SPEEDS = 1e-12, (1e-9, 1e-6, 1e-3, 1.0)


def check_at_rest(place: str, coefficient: Callable[[float], float]) -> None:
    """Refuse friction that jumps at rest: no step resolves it.

    Args:
        place: Owner, for the message.
        coefficient: ``speed [m/s] -> mu [-]``.
    """
    try:
        first, *further = (float(coefficient(speed)) for speed in (_REST, *_SPEEDS))
    except Exception:
        return
    if first > 0.5 * max(further):
        rule = (
            "a function that tends to 0 with the speed, since force and slip are opposed and the force would "
            "jump where the slip turns round; multiply it by tanh(speed / 1e-4), or use a law that sticks, "
            "such as LuGre"
        )
        raise InvalidParameterError(place, "coefficient", rule, said=f"{first:g} at {_REST:g} m/s")


def check_static(law: Any) -> None:
    """Refuse a static coefficient below the dynamic one."""
    if not law.dynamic <= law.static:
        raise InvalidParameterError(law, "static", f"at least dynamic = {law.dynamic}")


@inlined
def no_ratio(law: NoFriction, speed: float, force: float) -> float:
    """Zero [s/m]."""
    return 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class NoFriction(CompiledFrictionLaw):
    """No friction at all."""

    kernel = staticmethod(no_ratio)
    frequent: ClassVar[bool] = True


@inlined
def ambrosio_ratio(law: Ambrosio, speed: float, force: float) -> float:
    """Friction coefficient over slip speed [s/m]."""
    mu, v_0, v_1 = law.coefficient_of_friction, law.lower_speed, law.upper_speed
    if speed <= v_0:
        return 0.0
    if speed < v_1:
        return float(mu * (speed - v_0) / (v_1 - v_0) / speed)
    return float(mu / speed)


@dataclass(frozen=True, slots=True, kw_only=True)
class Ambrosio(CompiledFrictionLaw):
    r"""Coulomb friction with a linear ramp between two speeds.

    .. math:: \mu(|v|) = \mu\, c_d, \qquad
              c_d = \min\{1, \max[0, (|v| - v_0) / (v_1 - v_0)]\}

    Zero below :math:`v_0`: a joint creeps under a static load.

    Attributes:
        coefficient_of_friction: mu, from ``upper_speed`` on [-].
        lower_speed: v_0, no friction below [m/s].
        upper_speed: v_1, above v_0, full friction above [m/s].

    References:
        Ambrosio (2003), in Virtual Nonlinear Multibody Systems, 57-81; Chen and Cui (2021), equation (19).
    """

    kernel = staticmethod(ambrosio_ratio)
    frequent: ClassVar[bool] = True

    coefficient_of_friction: float = parameter(rule="zero or more")
    lower_speed: float = parameter("m/s", rule="zero or more", default=1e-4)
    upper_speed: float = parameter("m/s", default=1e-3)

    @classmethod
    def check_rules(cls, law: Any) -> None:
        """Refuse a ramp that does not rise."""
        if not law.lower_speed < law.upper_speed:
            raise InvalidParameterError(law, "upper_speed", f"above lower_speed = {law.lower_speed}")


@inlined
def smooth_ratio(law: Tanh, speed: float, force: float) -> float:
    """Friction coefficient over slip speed [s/m]."""
    level, v_t = law.coefficient_of_friction, law.transition_speed
    z = speed / v_t
    if z < 1e-4:
        return float(level * (1.0 - z * z / 3.0) / v_t)
    return float(level * math.tanh(z) / speed)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tanh(CompiledFrictionLaw):
    r"""Coulomb friction smoothed by a hyperbolic tangent.

    .. math:: \mu(|v|) = \mu \tanh(|v| / v_t)

    Infinitely differentiable; viscous near rest with slope mu / v_t.

    Attributes:
        coefficient_of_friction: mu at high speed [-].
        transition_speed: v_t, where mu is 76 % of its limit [m/s].

    References:
        Coulomb's law (1785); this smoothing is a usual one, in other codes as tanh(5 v) with v in m/s.
    """

    kernel = staticmethod(smooth_ratio)
    frequent: ClassVar[bool] = True

    coefficient_of_friction: float = parameter(rule="zero or more")
    transition_speed: float = parameter("m/s", rule="positive")


@inlined
def coulomb_ratio(law: Coulomb, speed: float, force: float) -> float:
    """Friction coefficient over slip speed [s/m]."""
    return float(law.coefficient_of_friction / math.hypot(speed, law.regularisation_speed))


@dataclass(frozen=True, slots=True, kw_only=True)
class Coulomb(CompiledFrictionLaw):
    r"""Coulomb friction with its jump at rest rounded off.

    .. math:: \mu(|v|) = \mu\, \frac{|v|}{\sqrt{v^2 + v_r^2}}

    Infinitely differentiable in the slip velocity. It tends to Coulomb's law as v_r tends to zero, except for
    its sticking: :math:`\mu` is approached as :math:`1 - v_r^2 / (2 v^2)`.

    Attributes:
        coefficient_of_friction: mu at high speed [-].
        regularisation_speed: v_r, where mu is 71 % of its limit [m/s].

    References:
        The law is Coulomb's (1785); this regularisation is a usual one.
    """

    kernel = staticmethod(coulomb_ratio)

    coefficient_of_friction: float = parameter(rule="zero or more")
    regularisation_speed: float = parameter("m/s", rule="positive", default=1e-4)


@inlined
def linear_ratio(law: LinearFriction, speed: float, force: float) -> float:
    """Friction coefficient over slip speed [s/m]."""
    return float(law.coefficient_of_friction / max(speed, law.regularisation_speed))


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearFriction(CompiledFrictionLaw):
    r"""Coulomb friction with a straight ramp through rest.

    .. math:: \mu(|v|) = \mu \min(1, |v| / v_r)

    Continuous, with a kink at v_r.

    Attributes:
        coefficient_of_friction: mu at high speed [-].
        regularisation_speed: v_r, full friction from there on [m/s].

    References:
        As the multibody code Exudyn regularises Coulomb friction.
    """

    kernel = staticmethod(linear_ratio)

    coefficient_of_friction: float = parameter(rule="zero or more")
    regularisation_speed: float = parameter("m/s", rule="positive")


@kernel
def threlfall_ratio(law: Threlfall, speed: float, force: float) -> float:
    """Friction coefficient over slip speed [s/m]."""
    mu, v_0 = law.coefficient_of_friction, law.transition_speed
    if speed == 0.0:
        return float(3.0 * mu / v_0)
    return float(-mu * math.expm1(-3.0 * min(speed / v_0, 1.0)) / speed)


@dataclass(frozen=True, slots=True, kw_only=True)
class Threlfall(CompiledFrictionLaw):
    r"""Threlfall's exponential rise to Coulomb friction.

    .. math:: \mu(|v|) = \mu \left(1 - e^{-3 |v| / v_0}\right) \text{ up to } v_0,
              \quad \mu (1 - e^{-3}) \text{ above}

    Printed with 0.95 above v_0, which is :math:`1 - e^{-3}` rounded, a jump. There is a kink at v_0.

    Attributes:
        coefficient_of_friction: mu, of which 95 % are reached [-].
        transition_speed: v_0, constant from there on [m/s].

    References:
        Threlfall (1978), Mech. Mach. Theory 13, 475-483. Recalled, not checked against the paper.
    """

    kernel = staticmethod(threlfall_ratio)

    coefficient_of_friction: float = parameter(rule="zero or more")
    transition_speed: float = parameter("m/s", rule="positive")


@inlined
def called_ratio(law: CustomFriction, speed: float, force: float) -> float:
    """Friction coefficient over slip speed [s/m]; none at rest."""
    return float(call_1(law.address, speed)) / speed if speed > 0.0 else 0.0


@takes()
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CustomFriction:
    """A user's friction coefficient over slip speed; slower unless compiled.

    It must tend to zero with the speed, and answer equal questions equally: a run ends as
    ``FUNCTION_WITH_MEMORY`` where it keeps something between calls.

    Attributes:
        coefficient: ``speed [m/s] -> mu [-]``, at least 0; a plain function, or compiled by ``numba.njit`` or
            ``numba.cfunc``.
    """

    kernel = staticmethod(called_ratio)
    frequent: ClassVar[bool] = False
    unpacked: ClassVar[tuple[str, ...]] = ()

    coefficient: Callable[[float], float]

    def __post_init__(self) -> None:
        """Check that the function can be called, and refuse a law that jumps at rest."""
        check_takes(self, "coefficient", self.coefficient, "slip speed")
        check_at_rest(type(self).__name__, lambda speed: callable_of(self.coefficient, 1)(speed))

    @property
    def is_compiled(self) -> bool:
        """Return whether the law's function is compiled."""
        return is_compiled(self.coefficient)

    @packed
    def address(self) -> float:
        """Address of the function in this process."""
        return address_of(type(self).__name__, "coefficient", self.coefficient, 1)

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (12,): where its function stands in this process.

        Raises:
            InvalidParameterError: It does not take a float, or does not return one.
        """
        return friction_code(self)


# --- friction that falls with the slip speed ----------------------------------------------------------------


@inlined
def adams_ratio(law: VelocityBased, speed: float, force: float) -> float:
    """Friction coefficient over slip speed [s/m]."""
    mu_s, mu_d, v_s, v_d = law.static, law.dynamic, law.static_speed, law.dynamic_speed
    if speed < v_s:
        y = speed / v_s
        return float(0.5 * mu_s * (3.0 - y * y) / v_s)
    if speed < v_d:
        x = (v_d - speed) / (v_d - v_s)
        return float((mu_d + (mu_s - mu_d) * x * x * (3.0 - 2.0 * x)) / speed)
    return float(mu_d / speed)


@dataclass(frozen=True, slots=True, kw_only=True)
class VelocityBased(CompiledFrictionLaw):
    r"""Velocity-based ("modified Coulomb") friction of ADAMS type, as Bai and Zhao use it, corrected.

    With :math:`y = |v| / v_s` and :math:`x = (v_d - |v|) / (v_d - v_s)`

    .. math:: \mu = \begin{cases}
        \mu_s\, y (3 - y^2) / 2 & |v| < v_s \\
        \mu_d + (\mu_s - \mu_d)\, x^2 (3 - 2x) & v_s \le |v| < v_d \\
        \mu_d & v_d \le |v| \end{cases}

    continuous with its slope; near rest viscous, with slope :math:`1.5 \mu_s / v_s`. Corrected: (14), whose
    second branch has its argument reversed, and (13), which applies the sign of the slip twice.

    Attributes:
        static: mu_s, reached at ``static_speed`` [-].
        dynamic: mu_d, from ``dynamic_speed`` on [-].
        static_speed: v_s [m/s].
        dynamic_speed: v_d, above v_s [m/s].

    References:
        Bai and Zhao (2020), Int. J. Aerospace Eng., 8846177, equations (13), (14), Table 2.
    """

    kernel = staticmethod(adams_ratio)
    frequent: ClassVar[bool] = True

    static: float = parameter(rule="zero or more")
    dynamic: float = parameter(rule="zero or more")
    static_speed: float = parameter("m/s", rule="positive")
    dynamic_speed: float = parameter("m/s")

    @classmethod
    def check_rules(cls, law: Any) -> None:
        """Refuse speeds in the wrong order."""
        if not law.static_speed < law.dynamic_speed:
            raise InvalidParameterError(law, "dynamic_speed", f"above static_speed = {law.static_speed}")


@kernel
def stribeck_ratio(law: Stribeck, speed: float, force: float) -> float:
    """Friction coefficient over slip speed [s/m]."""
    level = law.dynamic + (law.static - law.dynamic) * math.exp(
        -((speed / law.stribeck_speed) ** law.exponent)
    )
    return float(level * tanh_ratio(speed / law.transition_speed) / law.transition_speed + law.viscous)


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
        stribeck_speed: v_s, over which friction falls [m/s].
        transition_speed: v_t, below v_s, over which it rises from rest [m/s].
        viscous: sigma, viscous coefficient [s/m].
        shape: a of exp(-(v/v_s)^a); 2 is usual, 1/2 to 2 in the literature [-].

    References:
        Stribeck (1902); the form of Bo and Pavelescu (1982), as Andersson, Soderberg and Bjorklund (2007),
        Tribol. Int. 40, 580-587, regularise it.
    """

    kernel = staticmethod(stribeck_ratio)
    unpacked: ClassVar[tuple[str, ...]] = ("shape",)

    static: float = parameter()
    dynamic: float = parameter(rule="zero or more")
    stribeck_speed: float = parameter("m/s", rule="positive")
    transition_speed: float = parameter("m/s", rule="positive", default=1e-4)
    viscous: float = parameter("s/m", rule="zero or more", default=0.0)
    shape: float = parameter(rule="positive", default=2.0)

    @classmethod
    def check_rules(cls, law: Any) -> None:
        """Refuse coefficients or speeds in the wrong order."""
        check_static(law)
        if not law.transition_speed < law.stribeck_speed:
            rule = f"below stribeck_speed = {law.stribeck_speed}"
            raise InvalidParameterError(law, "transition_speed", rule)

    @packed
    def exponent(self) -> float:
        """A [-]: the shape, as the kernels name it."""
        return self.shape


@kernel
def bengisu_akay_ratio(law: BengisuAkay, speed: float, force: float) -> float:
    """Friction coefficient over slip speed [s/m]."""
    mu_c, mu_s, v_0 = law.dynamic, law.static, law.static_speed
    if speed < v_0:
        return float(mu_s * (2.0 * v_0 - speed) / (v_0 * v_0))
    return float((mu_c + (mu_s - mu_c) * math.exp(-law.decay * (speed - v_0))) / speed)


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
        decay: xi of exp(-xi (v - v_0)) [s/m].

    References:
        Bengisu and Akay (1994), J. Sound Vib. 171(4), 557-570. Recalled, not checked against the paper.
    """

    kernel = staticmethod(bengisu_akay_ratio)

    static: float = parameter()
    dynamic: float = parameter(rule="zero or more")
    static_speed: float = parameter("m/s", rule="positive")
    decay: float = parameter("s/m", rule="zero or more")

    @classmethod
    def check_rules(cls, law: Any) -> None:
        """Refuse a static coefficient below the dynamic one."""
        check_static(law)


@kernel
def brown_mcphee_ratio(law: BrownMcPhee, speed: float, force: float) -> float:
    """Friction coefficient over slip speed [s/m]."""
    y = speed / law.transition_speed
    valley = 0.25 * y * y + 0.75
    dry = 4.0 * law.dynamic * tanh_ratio(4.0 * y) + (law.static - law.dynamic) / (valley * valley)
    # The last term is mu_v tanh(4 F / F_nt) / F.
    whole = law.transition_force
    wet = law.viscous * tanh_ratio(4.0 * abs(force) / whole) * 4.0 / whole
    return float(dry / law.transition_speed + wet)


@dataclass(frozen=True, slots=True, kw_only=True)
class BrownMcPhee(CompiledFrictionLaw):
    r"""Brown and McPhee's smooth law with Stribeck peak and viscous part.

    .. math:: F_t = F_n \left[\mu_d \tanh\frac{4 v}{v_t}
              + \frac{(\mu_s - \mu_d)\, v / v_t}{\left[\tfrac14 (v / v_t)^2 + \tfrac34\right]^2}\right]
              + \mu_v\, v \tanh\frac{4 F_n}{F_{nt}}

    Infinitely differentiable. The peak, mu_s except for :math:`\mu_d (1 - \tanh 4) = 0.0007 \mu_d`, is at
    v_t. The viscous part does not grow with the load, but fades in with it.

    Attributes:
        static: mu_s, at the peak; at least ``dynamic`` [-].
        dynamic: mu_d, at high speed [-].
        transition_speed: v_t, of the peak [m/s].
        viscous: mu_v, viscous coefficient [N s/m].
        transition_force: F_nt, normal force from which on the viscous part acts in full [N].

    References:
        Brown and McPhee (2016), J. Comput. Nonlinear Dyn. 11, 054502; the formula as public multibody codes
        have it.
    """

    kernel = staticmethod(brown_mcphee_ratio)

    static: float = parameter()
    dynamic: float = parameter(rule="zero or more")
    transition_speed: float = parameter("m/s", rule="positive")
    viscous: float = parameter("N*s/m", rule="zero or more", default=0.0)
    transition_force: float = parameter("N", rule="positive", default=1.0)

    @classmethod
    def check_rules(cls, law: Any) -> None:
        """Refuse a static coefficient below the dynamic one."""
        check_static(law)
