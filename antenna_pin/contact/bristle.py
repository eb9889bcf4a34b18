r"""Friction laws with bristles: they stick, and remember by how much they are bent.

A bristle law carries a deflection :math:`z` per contact, which the integrator advances with the rest of the
state. All are written relative to the normal force,

.. math:: F_t = -F_n (\sigma_0 z + \sigma_1 \dot z + \sigma_2 v)

with :math:`\sigma_0` [1/m], :math:`\sigma_1`, :math:`\sigma_2` [s/m] and coefficients of friction in the
place of forces, so that nothing is divided by a load that vanishes at the begin and end of each contact. A
stiffness [N/m] of the literature is :math:`\sigma_0` times the load at which it was found.

**Frame.** :math:`z` is a vector in bearing axes. It grows along the slip, which is tangent. As the contact
moves round the bore the tangent plane turns: what of :math:`z` has turned out of it carries no force, and
fades as the rest does. Bristles bend by :math:`\mu / \sigma_0`, micrometres, while the plane turns by 1 rad
per radius.

**Begin and end.** A bristle is straight when a contact begins. While a contact does not touch its bristle
does not change; whoever advances the system sets it to zero at the onset (the state has a jump there, as the
approach speed has).

**Energy.** The friction ledger counts all that friction takes, :math:`-F_t \cdot v`, with what the bristles
hold: it may fall by :math:`\tfrac12 F_n \sigma_0 z^2` when they spring back. Under a varying load that is no
potential energy, so that it is not given apart.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from antenna_pin.base.parameters import parameter
from antenna_pin.base.records import Floats, Triple, packed
from antenna_pin.compiled.decorators import inlined, kernel, record
from antenna_pin.contact.friction import CompiledFrictionLaw, check_static, no_ratio
from antenna_pin.contact.kernels import DEFLECTION_SIZE, Rates, steady_coefficient
from antenna_pin.contact.records import friction_record, number_of


@inlined
def no_dwell(law: Any) -> bool:
    """Return that the state of a law is a deflection alone."""
    return False


@inlined
def has_dwell(law: Any) -> bool:
    """Return that the state of a law has a dwell behind the deflection."""
    return True


class BristleLaw(CompiledFrictionLaw):
    """Base of the laws with a deflection per contact.

    Attributes:
        kernel: With the arguments of :func:`antenna_pin.contact.kernels.bristle`, the law being its record.
        steady: Of record and slip speed [m/s]: the coefficient in steady sliding [-].
        dwells: Of the record: whether its state has a dwell.
    """

    __slots__ = ()

    ratio = staticmethod(no_ratio)
    steady: ClassVar[Any]
    dwells = staticmethod(no_dwell)

    def coefficient(self, speed: float, normal_force: float = np.inf) -> float:
        """Return the friction coefficient in steady sliding [-].

        Args:
            speed: Slip speed [m/s], zero or more; at zero it is what is needed to break away.
            normal_force: Without influence [N].
        """
        return float(steady_coefficient(self.code(), speed))


@kernel
def dahl(law: Dahl, force: float, slip: Triple, whole: Triple, along: Triple, dwell: float) -> Rates:
    """Return friction and rates, with w = v / |v| - sigma_0 z / mu."""
    vx, vy, vz = slip
    zx, zy, zz = whole
    tx, ty, tz = along
    mu, sigma_0, exponent = law.coefficient_of_friction, law.bristle_stiffness, law.exponent
    speed = math.sqrt(vx * vx + vy * vy + vz * vz)
    grip = 1.0
    if exponent != 1.0 and speed > 0.0:
        wx = vx / speed - sigma_0 * zx / mu
        wy = vy / speed - sigma_0 * zy / mu
        wz = vz / speed - sigma_0 * zz / mu
        grip = math.sqrt(wx * wx + wy * wy + wz * wz) ** (exponent - 1.0)
    fade = sigma_0 * speed / mu
    rx, ry, rz = grip * (vx - fade * zx), grip * (vy - fade * zy), grip * (vz - fade * zz)
    factor = -force * sigma_0
    return factor * tx, factor * ty, factor * tz, rx, ry, rz, 0.0


@inlined
def steady_dahl(law: Dahl, speed: float) -> float:
    """Friction coefficient in steady sliding [-]."""
    return float(law.coefficient_of_friction)


@dataclass(frozen=True, slots=True, kw_only=True)
class Dahl(BristleLaw):
    r"""Dahl's friction: an elastic deflection that saturates at Coulomb friction.

    .. math:: \dot z = |v|\, w\, |w|^{i - 1}, \quad w = \frac{v}{|v|} - \frac{\sigma_0}{\mu} z,
              \qquad F_t = -F_n \sigma_0 z

    In one dimension :math:`\dot z = v (1 - \sigma_0 z\, \mathrm{sgn}\, v / \mu)^i`. Independent of the rate:
    a stress-strain curve. No Stribeck effect, and no static friction above the dynamic.

    Attributes:
        coefficient_of_friction: mu, positive [-].
        bristle_stiffness: sigma_0, stiffness of the bristles over the load [1/m].
        shape: i, at least 1 [-].

    References:
        Dahl (1968), Aerospace Corp. report TOR-158; vector form here. Recalled, not checked.
    """

    kernel = staticmethod(dahl)
    steady = staticmethod(steady_dahl)
    unpacked: ClassVar[tuple[str, ...]] = ("shape",)

    coefficient_of_friction: float = parameter(rule="positive")
    bristle_stiffness: float = parameter("1/m", rule="positive")
    shape: float = parameter(rule="1 or more", default=1.0)

    @property
    def state_scales(self) -> tuple[float, ...]:
        """Largest deflection [m], for each of its components."""
        return (self.coefficient_of_friction / self.bristle_stiffness,) * DEFLECTION_SIZE

    @packed
    def exponent(self) -> float:
        """I [-]: the shape, as the kernels name it."""
        return self.shape


@inlined
def stribeck_level(law: LuGre | GonthierBristle, speed: float) -> float:
    """``mu_d + (mu_s - mu_d) exp(-(|v| / v_s)^2)`` [-]."""
    y = speed / law.stribeck_speed
    return float(law.dynamic + (law.static - law.dynamic) * math.exp(-y * y))


@kernel
def lugre(law: LuGre, force: float, slip: Triple, whole: Triple, along: Triple, dwell: float) -> Rates:
    """Return friction and rates."""
    vx, vy, vz = slip
    speed = math.sqrt(vx * vx + vy * vy + vz * vz)
    fade = law.bristle_stiffness * speed / stribeck_level(law, speed)
    return _bent(law, (force, 1.0, fade, math.inf), slip, whole, along, 0.0)


@inlined
def _bent(
    law: LuGre | GonthierBristle,
    pull: tuple[float, float, float, float],
    slip: Triple,
    whole: Triple,
    along: Triple,
    dwelling: float,
) -> Rates:
    """Return friction and rates, of the deflection follow v - fade z.

    Args:
        law: The law, or one with its numbers.
        pull: Normal force [N], follow [-], fade [1/s], largest friction coefficient [-].
        slip: As of the law.
        whole: Likewise.
        along: Likewise.
        dwelling: Rate of the dwell [1/s].
    """
    vx, vy, vz = slip
    zx, zy, zz = whole
    tx, ty, tz = along
    force, follow, fade, limit = pull
    rx, ry, rz = follow * vx - fade * zx, follow * vy - fade * zy, follow * vz - fade * zz
    stiff = law.bristle_stiffness - law.bristle_damping * fade
    damp = law.bristle_damping * follow
    bx, by, bz = stiff * tx + damp * vx, stiff * ty + damp * vy, stiff * tz + damp * vz
    size = math.sqrt(bx * bx + by * by + bz * bz)
    cut = limit / size if size > limit else 1.0
    fx = -force * (cut * bx + law.viscous * vx)
    fy = -force * (cut * by + law.viscous * vy)
    fz = -force * (cut * bz + law.viscous * vz)
    return fx, fy, fz, rx, ry, rz, dwelling


@inlined
def steady_lugre(law: LuGre, speed: float) -> float:
    """Friction coefficient in steady sliding [-]."""
    return float(stribeck_level(law, speed) + law.viscous * speed)


@dataclass(frozen=True, slots=True, kw_only=True)
class LuGre(BristleLaw):
    r"""The LuGre law: bristles whose steady deflection follows the Stribeck curve.

    .. math:: \dot z = v - \frac{\sigma_0 |v|}{g(v)} z, \qquad
              g = \mu_d + (\mu_s - \mu_d)\, e^{-(v / v_s)^2}, \qquad
              F_t = -F_n (\sigma_0 z + \sigma_1 \dot z + \sigma_2 v)

    Known defects: it drifts under a load that oscillates below break-away, and with a constant
    :math:`\sigma_1` it is not passive at speeds above :math:`g / \sigma_1`, where the damping changes
    sign.

    Attributes:
        static: mu_s, at least ``dynamic`` [-].
        dynamic: mu_d, positive [-].
        stribeck_speed: v_s, over which friction falls [m/s].
        bristle_stiffness: sigma_0, stiffness of the bristles over the load [1/m].
        bristle_damping: sigma_1, damping of the bristles over the load [s/m].
        viscous: sigma_2, viscous coefficient [s/m].

    References:
        Canudas de Wit, Olsson, Astrom and Lischinsky (1995), IEEE Trans. Autom. Control 40, 419-425.
        Recalled, not checked against the paper.
    """

    kernel = staticmethod(lugre)
    steady = staticmethod(steady_lugre)

    static: float = parameter()
    dynamic: float = parameter(rule="positive")
    stribeck_speed: float = parameter("m/s", rule="positive")
    bristle_stiffness: float = parameter("1/m", rule="positive")
    bristle_damping: float = parameter("s/m", rule="zero or more", default=0.0)
    viscous: float = parameter("s/m", rule="zero or more", default=0.0)

    @classmethod
    def check_rules(cls, law: Any) -> None:
        """Refuse a static coefficient below the dynamic one."""
        check_static(law)

    @property
    def state_scales(self) -> tuple[float, ...]:
        """Largest deflection [m], for each of its components."""
        return (self.static / self.bristle_stiffness,) * DEFLECTION_SIZE


@inlined
def _sticking(law: GonthierBristle, speed: float) -> Triple:
    """Return stick s, and factors of v and -z in the deflection's rate.

    The bristle sticks (rate v) as far as s says, and slides (bristle force mu_d) as far as 1 - s.
    """
    s = math.exp(-((speed / law.stribeck_speed) ** 2))
    v_e = law.rounding_speed
    u = speed / v_e
    direction = (1.5 - 0.5 * u * u) / v_e if u < 1.0 else 1.0 / speed  # dir(v) = direction v
    follow = s + (1.0 - s) * law.dynamic * direction / law.bristle_damping
    return s, follow, (1.0 - s) * law.bristle_stiffness / law.bristle_damping


@inlined
def _strength(law: GonthierBristle, dwell: float) -> float:
    """Return the largest friction coefficient [-]."""
    return float(law.dynamic + (law.static - law.dynamic) * dwell)


@kernel
def gonthier(
    law: GonthierBristle, force: float, slip: Triple, whole: Triple, along: Triple, dwell: float
) -> Rates:
    """Return friction and rates."""
    vx, vy, vz = slip
    s, follow, fade = _sticking(law, math.sqrt(vx * vx + vy * vy + vz * vz))
    dwelling = (s - dwell) / (law.dwell_time if s >= dwell else law.bristle_damping / law.bristle_stiffness)
    return _bent(law, (force, follow, fade, _strength(law, dwell)), slip, whole, along, dwelling)


@kernel
def steady_gonthier(law: GonthierBristle, speed: float) -> float:
    """Friction coefficient in steady sliding [-].

    sigma_0 z = mu_d dir(v) + sigma_1 s v / (1 - s), at most mu_max, with the dwell state s_dw = s.
    """
    level = stribeck_level(law, speed)
    s = math.exp(-((speed / law.stribeck_speed) ** 2))
    u = min(speed / law.rounding_speed, 1.0)
    bent = law.dynamic * u * (1.5 - 0.5 * u * u)
    bent = min(bent + law.bristle_damping * s * speed / (1.0 - s), level) if s < 1.0 else level
    return float(bent + law.viscous * speed)


@kernel
def gonthier_kink(words: Floats, k: int, rate: float, bend: float, dwell: float) -> float:
    """Return function k of Gonthier's law, zero at kinks of the friction.

    0: how much it sticks beyond its dwell, which grows slowly and fades fast; 1: what its bristles would give
    beyond what they can.

    Args:
        words: The law's packed parameters, (FRICTION_SIZE,).
        k: Which.
        rate: Of the joint.
        bend: Deflection of the bristles.
        dwell: What is remembered of it [-].
    """
    law = record(words, GONTHIER_LAW)
    s, follow, fade = _sticking(law, abs(rate))
    if k == 0:
        return float(s - dwell)
    pull = law.bristle_stiffness * bend + law.bristle_damping * (follow * rate - fade * bend)
    return float(abs(pull) - _strength(law, dwell))


@dataclass(frozen=True, slots=True, kw_only=True)
class GonthierBristle(BristleLaw):
    r"""Gonthier et al.'s law: bristles stick or slide, and friction grows with dwell time.

    With :math:`s = e^{-(v / v_s)^2}`, 1 when sticking and 0 when sliding,

    .. math:: \dot z = s\, v + (1 - s) \frac{\mu_d\, \mathrm{dir}(v) - \sigma_0 z}{\sigma_1}, \qquad
              \dot s_{dw} = \frac{s - s_{dw}}{\tau}, \quad
              \tau = \begin{cases} \tau_{dw} & s \ge s_{dw} \\ \sigma_1 / \sigma_0 & s < s_{dw} \end{cases}

    .. math:: F_t = -F_n \left[\mathrm{sat}(\sigma_0 z + \sigma_1 \dot z,\;
              \mu_d + (\mu_s - \mu_d) s_{dw}) + \sigma_2 v\right]

    where sat cuts the vector's length, and :math:`\mathrm{dir}(v) = v / |v|`, rounded below v_e to
    :math:`\tfrac{v}{v_e} (\tfrac32 - \tfrac12 v^2 / v_e^2)`. The fourth integrated number is the dwell state
    :math:`s_{dw}`, zero at first touch.

    Attributes:
        static: mu_s, at least ``dynamic`` [-].
        dynamic: mu_d, positive [-].
        stribeck_speed: v_s, below which it sticks [m/s].
        bristle_stiffness: sigma_0, stiffness of the bristles over the load [1/m].
        bristle_damping: sigma_1, positive: the bristles follow within sigma_1 / sigma_0 [s/m].
        dwell_time: tau_dw, over which static friction builds up [s].
        viscous: sigma_2, viscous coefficient [s/m].
        direction_speed: v_e, rounds the direction off; 0: v_s / 100 [m/s].

    References:
        Gonthier, McPhee, Lange and Piedboeuf (2004), Multibody Syst. Dyn. 11, 209-233. Recalled, not checked
        against the paper.
    """

    kernel = staticmethod(gonthier)
    steady = staticmethod(steady_gonthier)
    dwells = staticmethod(has_dwell)

    static: float = parameter()
    dynamic: float = parameter(rule="positive")
    stribeck_speed: float = parameter("m/s", rule="positive")
    bristle_stiffness: float = parameter("1/m", rule="positive")
    bristle_damping: float = parameter("s/m", rule="positive")
    dwell_time: float = parameter("s", rule="positive")
    viscous: float = parameter("s/m", rule="zero or more", default=0.0)
    direction_speed: float = parameter("m/s", rule="zero or more", default=0.0)

    @classmethod
    def check_rules(cls, law: Any) -> None:
        """Refuse a static coefficient below the dynamic one."""
        check_static(law)

    @property
    def state_scales(self) -> tuple[float, ...]:
        """Largest deflection [m], for each of its components, and 1 for the dwell state [-]."""
        return ((self.static / self.bristle_stiffness,) * DEFLECTION_SIZE) + (1.0,)

    @packed
    def rounding_speed(self) -> float:
        """v_e as it is used [m/s]."""
        return self.direction_speed if self.direction_speed > 0.0 else 0.01 * self.stribeck_speed


#: Kind of Gonthier's law; its record.
GONTHIER, GONTHIER_LAW = number_of(gonthier), friction_record(gonthier)
