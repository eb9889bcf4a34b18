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

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from antenna_pin.base.parameters import parameter
from antenna_pin.contact import friction_kernels as kernels
from antenna_pin.contact.bristle_kernels import steady_coefficient
from antenna_pin.contact.friction import CompiledFrictionLaw, check_static

__all__ = ["BristleLaw", "Dahl", "GonthierBristle", "LuGre"]


class BristleLaw(CompiledFrictionLaw):
    """Base of the laws with a deflection per contact."""

    __slots__ = ()

    def coefficient(self, speed: float, normal_force: float = np.inf) -> float:
        """Return the friction coefficient in steady sliding [-].

        Args:
            speed: Slip speed [m/s], zero or more; at zero it is what is needed to break away.
            normal_force: Without influence [N].
        """
        return float(steady_coefficient(self.code(), speed))


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

    kind: ClassVar[float] = kernels.DAHL

    coefficient_of_friction: float = parameter(rule="positive")
    bristle_stiffness: float = parameter("1/m", rule="positive")
    shape: float = parameter(rule="1 or more", default=1.0)

    @property
    def state_scales(self) -> tuple[float, ...]:
        """Largest deflection [m], for each of its components."""
        return (self.coefficient_of_friction / self.bristle_stiffness,) * kernels.DEFLECTION_SIZE

    @property
    def exponent(self) -> float:
        """I [-]: the shape, as the kernels name it."""
        return self.shape


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

    kind: ClassVar[float] = kernels.LUGRE

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
        return (self.static / self.bristle_stiffness,) * kernels.DEFLECTION_SIZE


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

    kind: ClassVar[float] = kernels.GONTHIER

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
        return ((self.static / self.bristle_stiffness,) * kernels.DEFLECTION_SIZE) + (1.0,)

    @property
    def rounding_speed(self) -> float:
        """v_e as it is used [m/s]."""
        return self.direction_speed if self.direction_speed > 0.0 else 0.01 * self.stribeck_speed
