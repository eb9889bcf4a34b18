"""Friction of a joint itself, apart from contacts: a URDF's ``<dynamics>``."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.element import LOSS, Element, Integral
from antenna_pin.errors import InvalidParameterError

if TYPE_CHECKING:
    from antenna_pin.elements.ball_bearing import BallBearing

# Exponent of the preload 1 + y, and z, of Palmgren's formula.
_EXPONENT, _PALMGREN = 1.33, 1e-3


@dataclass(frozen=True, slots=True, kw_only=True)
class JointFriction(Element):
    r"""Viscous and Coulomb friction of a turning (sliding) joint.

    .. math:: \tau = -c\, \dot\phi - T \frac{\dot\phi}{\sqrt{\dot\phi^2 + \omega_r^2}}

    Smooth and viscous near rest: it does not stick. Under a static load L below T it creeps, at
    :math:`\omega_r L / \sqrt{T^2 - L^2}`; a moment of inertia I comes to rest within some
    :math:`I \omega_r / T`, which explicit steps must resolve.

    At a clearance joint phi is the motion angle, as for springs; it acts beside the friction of the contacts.

    Friction of a preloaded ball bearing depends on its preload P, with temperature and tolerances,

    .. math:: T(P) = T_0 (P / P_0)^n

    measured as :math:`T_0` at :math:`P_0`, or of the rows i by Palmgren's formula with
    :math:`P_0 = P`, :math:`n = 1 + y`,

    .. math:: T_0 = i\, z \left(\frac{P}{C_{0a}}\right)^y 0.9\, P \cot\alpha\, d_m

    and :math:`C_{0a}` the axial rating of ISO 76. Outside loads, and events within a run, do not change it.

    Attributes:
        damping: c [N*m*s/rad] ([N*s/m]).
        friction: T, of a ball bearing T_0 [N*m] ([N]).
        regularisation_speed: omega_r, where Coulomb friction is 71 % of its limit [rad/s] ([m/s]).
        bearing: Ball bearing in ``[bearings.NAME]`` whose preload sets the friction; None without.
        at_preload: P_0, at which ``friction`` is given; None for Palmgren's formula [N].
        preload_exponent: n, 1.33 if left out: 1 slides, 4/3 spins and rolls, as contact ellipses grow [-].
        palmgren_factor: z, 0.001 if left out [-].

    References:
        URDF's ``<dynamics>`` names damping and friction and leaves open what friction does at rest. Harris
        and Kotzalas, Rolling Bearing Analysis, friction torque by Palmgren: z = 0.001 and y = 0.33 of
        angular contact at 30 to 40 degrees with oil (values not verified).
    """

    kernels: ClassVar[str] = __name__
    senses: ClassVar[bool] = True
    integrals: ClassVar[tuple[Integral, ...]] = (LOSS,)
    one_above_zero: ClassVar[tuple[str, ...]] = ("friction", "damping")
    at_start: ClassVar[tuple[str, ...]] = ("at_preload", "preload_exponent", "palmgren_factor")

    damping: float = parameter("N*m*s/rad", sliding="N*s/m", rule="zero or more", default=0.0)
    friction: float = parameter("N*m", sliding="N", rule="zero or more", default=0.0)
    regularisation_speed: float = parameter("rad/s", sliding="m/s", rule="positive", default=1e-3)
    bearing: str | None = None
    at_preload: float | None = parameter("N", rule="positive", default=None)
    preload_exponent: float | None = parameter(rule="positive", default=None)
    palmgren_factor: float | None = parameter(rule="positive", default=None)
    on: bool = True

    def __post_init__(self) -> None:
        """Check the parameters together."""
        Element.__post_init__(self)
        for name in ("at_preload", "preload_exponent", "palmgren_factor"):
            if getattr(self, name) is not None and self.bearing is None:
                raise InvalidParameterError(self, name, "left out without bearing", getattr(self, name))
        if self.at_preload is not None and self.palmgren_factor is not None:
            rule = "left out with at_preload, at which friction is given"
            raise InvalidParameterError(self, "palmgren_factor", rule, self.palmgren_factor)
        if self.bearing is not None and self.at_preload is None and self.friction:
            rule = "given: the preload of the bearing at which friction is measured; or leave friction out"
            raise InvalidParameterError(self, "at_preload", rule, None)

    def check_joint(self, place: str, slides: bool) -> None:
        """Refuse a bearing of a joint that slides."""
        if slides and self.bearing is not None:
            raise InvalidParameterError(
                place, "bearing", f"left out: joint {self.joint!r} slides", self.bearing
            )

    def under_preload(self, bearing: BallBearing) -> JointFriction:
        """Return the friction at the preload of its bearing."""
        exponent = _EXPONENT if self.preload_exponent is None else self.preload_exponent
        if self.at_preload is None:
            factor = _PALMGREN if self.palmgren_factor is None else self.palmgren_factor
            friction = palmgren_torque(bearing, factor, exponent - 1.0)
        else:
            friction = self.friction * (bearing.preload / self.at_preload) ** exponent
        return replace(self, friction=friction, at_preload=bearing.preload, palmgren_factor=None)

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        found = self.said_of({"damping": "damping", "friction": "friction"}, slides)
        if self.bearing is not None:
            preload = "its preload" if self.at_preload is None else self.text_of("at_preload", slides)
            found.append(f"of bearing {self.bearing} at {preload}")
        if self.friction:
            found.append(f"rounded off below {self.text_of('regularisation_speed', slides)}")
        return ", ".join(found)


def palmgren_torque(bearing: BallBearing, factor: float, exponent: float) -> float:
    """Return the load torque of a bearing's rows under its preload by Palmgren's formula [N*m].

    Args:
        bearing: The bearing.
        factor: z [-].
        exponent: y [-].

    Raises:
        InvalidParameterError: The contact angle is zero, at which a preload is no load of the formula.
    """
    if bearing.contact_angle == 0.0:
        rule = "above zero for Palmgren's friction; or give friction and at_preload"
        raise InvalidParameterError(f"bearing of joint {bearing.joint!r}", "contact_angle", rule, 0.0)
    load = 0.9 * bearing.preload / math.tan(bearing.contact_angle)
    share = bearing.preload / bearing.axial_rating
    return float(bearing.rows * factor * share**exponent * load * bearing.pitch_diameter)


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
