r"""Friction of joints by the bristle laws of contacts.

The laws are those of :mod:`antenna_pin.contact.bristle`, each written once: with a torque in the place of a
coefficient of friction, an angle for the deflection and the joint's rate for the slip they are friction of a
joint. Bristles are straight where a run starts, if ``start`` does not bend them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined
from antenna_pin.contact.bristle import GONTHIER, gonthier_kink
from antenna_pin.contact.kernels import bristle
from antenna_pin.contact.records import FRICTION_SIZE
from antenna_pin.elements.element import LOSS, Element, Integral, packed
from antenna_pin.elements.hook_kernels import Motion, Own, Powered
from antenna_pin.elements.own_load import (
    LABELS_OF_LOAD,
    NUMBERS_OF_LOAD,
    check_load,
    check_unloaded,
    numbers_of_load,
)
from antenna_pin.errors import InvalidParameterError

BEND = Integral("bend", "1")
DWELL = Integral("dwell", "1")
# Places among what it integrates.
_HEAT_AT, _BEND_AT, _DWELL_AT = range(3)


@dataclass(frozen=True, slots=True, kw_only=True)
class BristleFriction(Element):
    """Base of these laws.

    Attributes:
        coulomb: T_c, of slipping [N*m] ([N]).
        stiffness: sigma_0, of the bristles [N*m/rad] ([N/m]).
        viscous: b, whatever the load [N*m*s/rad] ([N*s/m]).
        coefficient: mu, of slipping under load; zero for friction whatever the load [-].
        radius: r, at which a turning joint slips under radial load [m].
        axial_radius: r_a, at which a turning joint slips under axial load [m].
        bending_arm: a: a moment M presses like a force M / a [m]; None for moments that do not press.
        middle: Place of the bearing's middle along the axis, from the joint's origin [m].
        start: Deflection of the bristles at the start, over T_c / sigma_0 [-].
    """

    kernels: ClassVar[str] = __name__
    at_start: ClassVar[tuple[str, ...]] = ("start",)
    senses: ClassVar[bool] = True
    integrals: ClassVar[tuple[Integral, ...]] = (LOSS, BEND)
    states: ClassVar[tuple[Integral, ...]] = (BEND,)
    labels: ClassVar[Mapping[str, str]] = {
        "coulomb": "Coulomb friction",
        "static": "static",
        "stiffness": "bristle stiffness",
        "damping": "bristle damping",
        "stribeck_rate": "Stribeck rate",
        "dwell_time": "dwell time",
        "viscous": "viscous",
        "coefficient": "under load",
        **LABELS_OF_LOAD,
    }

    coulomb: float = parameter("N*m", sliding="N", rule="positive")
    stiffness: float = parameter("N*m/rad", sliding="N/m", rule="positive")
    viscous: float = parameter("N*m*s/rad", sliding="N*s/m", rule="zero or more", default=0.0)
    coefficient: float = parameter(rule="zero or more", default=0.0)
    radius: float | None = parameter("m", rule="positive", default=None)
    axial_radius: float | None = parameter("m", rule="zero or more", default=None)
    bending_arm: float | None = parameter("m", rule="positive", default=None)
    middle: float | None = parameter("m", default=None)
    start: float = parameter(default=0.0)
    on: bool = True

    def __post_init__(self) -> None:
        """Check the parameters together."""
        Element.__post_init__(self)
        static = self._static
        if static is not None and not static >= self.coulomb:
            rule = f"at least coulomb = {self.coulomb:g}, or left out"
            raise InvalidParameterError(self, "static", rule, static)
        if not self.under_load:
            check_unloaded(self, *NUMBERS_OF_LOAD)
        if not abs(self.start) <= self.limit:
            rule = f"at most {self.limit:g} in size, where bristles slip"
            raise InvalidParameterError(self, "start", rule, self.start)

    def check_joint(self, place: str, slides: bool) -> None:
        """Refuse what a joint of this kind has not, or lacks."""
        check_load(self, place, slides)

    @property
    def under_load(self) -> bool:
        """Return whether the friction is of a load."""
        return self.coefficient > 0.0

    @property
    def limit(self) -> float:
        """Bristle deflection at slip, over T_c / sigma_0 [-]."""
        return 1.0 if self._static is None else self._static / self.coulomb

    @property
    def _static(self) -> float | None:
        """Break-away torque, of laws that distinguish it from slip."""
        return getattr(self, "static", None)

    @packed
    def reach(self) -> float:
        """By how much bristles are bent at Coulomb friction, T_c / sigma_0 [rad] ([m])."""
        return self.coulomb / self.stiffness

    @property
    def law(self) -> Any:
        """The law of contacts, with torques in the place of coefficients."""
        raise NotImplementedError

    @property
    def has_kinks(self) -> bool:
        """Return the joints whose reversals are kinks."""
        return True

    @packed
    def share(self) -> float:
        """Share by which a load adds to all of it [1/(N*m)] ([1/N])."""
        return self.coefficient / self.coulomb

    @packed
    def load_numbers(self) -> tuple[float, float, float, float]:
        """Weights of the joint's load and the bearing's middle, of hook ``bearing``."""
        return numbers_of_load(self)

    def tail(self) -> tuple[float, ...]:
        """Return the law's friction."""
        return tuple(map(float, self.law.code()))

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        return ", ".join([type(self).__name__.removesuffix("Friction"), *self.said_of(self.labels, slides)])


@dataclass(frozen=True, slots=True, kw_only=True)
class DahlFriction(BristleFriction):
    r"""Dahl's friction of a joint; the units are those of a turning (sliding) joint.

    .. math:: \dot z = \dot\phi\, (1 - \sigma_0 z\, \mathrm{sgn}\, \dot\phi / T_c)^i, \qquad
        \tau = -\left(1 + \frac{\mu N}{T_c}\right) \sigma_0 z - b\, \dot\phi

    A curve of torque over angle, whatever the rate, of the length :math:`T_c / \sigma_0`: a spring at rest,
    which creeps under a torque that comes and goes.

    N is the load of the joint as :class:`antenna_pin.elements.StickingFriction` has it; without a coefficient
    none counts. Under load stiffness and friction grow alike, so that bristles slip at the same angle: a
    joint without friction but that of its load has a ``coulomb`` and ``stiffness`` that are as small as you
    like, with their ratio.

    Stored is :math:`\sigma_0 z^2 / 2`; lost is the rest. What bristles hold by a load is no potential energy,
    as loads vary, and counts as lost until they give it back.

    Attributes:
        shape: i, 1 or more; the larger, the rounder is the curve [-].

    References:
        Dahl (1968), Aerospace Corp. report TOR-158; as :class:`antenna_pin.contact.Dahl`.
    """

    shape: float = parameter(rule="1 or more", default=1.0)

    @property
    def law(self) -> Any:
        """The law of contacts, with torques in the place of coefficients."""
        from antenna_pin.contact import Dahl

        return Dahl(coefficient_of_friction=self.coulomb, bristle_stiffness=self.stiffness, shape=self.shape)


@dataclass(frozen=True, slots=True, kw_only=True)
class LuGreFriction(BristleFriction):
    r"""The LuGre friction of a joint; the units are those of a turning (sliding) joint.

    .. math:: \dot z = \dot\phi - \frac{\sigma_0 |\dot\phi|}{g} z, \qquad
        g = T_c + (T_s - T_c)\, e^{-(\dot\phi / \omega_s)^2}, \qquad
        \tau = -\left(1 + \frac{\mu N}{T_c}\right) (\sigma_0 z + \sigma_1 \dot z) - b\, \dot\phi

    At a constant rate it comes to :math:`g + b |\dot\phi|` against the rate; about rest it is a spring
    :math:`\sigma_0` with a damper :math:`\sigma_1 + b`. It drifts under a torque that oscillates below
    break-away, and where :math:`\sigma_1 |\dot\phi| > g` its damper may put energy in.

    Load, energy and loss as :class:`DahlFriction` has them.

    Attributes:
        static: T_s, to break away; T_c if left out [N*m] ([N]).
        stribeck_rate: omega_s, over which friction falls from T_s to T_c; left out where that are one
            [rad/s] ([m/s]).
        damping: sigma_1, of the bristles [N*m*s/rad] ([N*s/m]).

    References:
        Canudas de Wit, Olsson, Astrom and Lischinsky (1995), IEEE Trans. Autom. Control 40, 419-425; as
        :class:`antenna_pin.contact.LuGre`.
    """

    static: float | None = parameter("N*m", sliding="N", rule="positive", default=None)
    stribeck_rate: float | None = parameter("rad/s", sliding="m/s", rule="positive", default=None)
    damping: float = parameter("N*m*s/rad", sliding="N*s/m", rule="zero or more", default=0.0)

    def __post_init__(self) -> None:
        """Check the parameters together."""
        BristleFriction.__post_init__(self)
        if self.limit > 1.0 and self.stribeck_rate is None:
            rule = f"given with static above coulomb = {self.coulomb:g}"
            raise InvalidParameterError(self, "stribeck_rate", rule, None)

    @property
    def law(self) -> Any:
        """The law of contacts, with torques in the place of coefficients."""
        from antenna_pin.contact import LuGre

        return LuGre(
            static=self.coulomb * self.limit,
            dynamic=self.coulomb,
            stribeck_speed=self.stribeck_rate or 1.0,  # of no influence where static is dynamic
            bristle_stiffness=self.stiffness,
            bristle_damping=self.damping,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class GonthierFriction(BristleFriction):
    r"""Gonthier et al.'s friction of a turning (sliding) joint, which grows during rest.

    With :math:`s = e^{-(\dot\phi / \omega_s)^2}`, 1 when sticking and 0 when sliding,

    .. math:: \dot z = s\, \dot\phi + (1 - s) \frac{T_c\, \mathrm{dir}(\dot\phi) - \sigma_0 z}{\sigma_1},
        \qquad \dot s_{dw} = \frac{s - s_{dw}}{\tau_{dw} \text{ or } \sigma_1 / \sigma_0}

    .. math:: \tau = -\left(1 + \frac{\mu N}{T_c}\right) \mathrm{sat}(\sigma_0 z + \sigma_1 \dot z,\;
        T_c + (T_s - T_c) s_{dw}) - b\, \dot\phi

    in which dwell grows over :math:`\tau_{dw}` and fades over :math:`\sigma_1 / \sigma_0`; sat cuts the size,
    and dir is the sign, rounded off below omega_d. A run starts with a dwell of zero.

    Load, energy and loss as :class:`DahlFriction` has them.

    Attributes:
        static: T_s, to break away after a long rest; T_c if left out [N*m] ([N]).
        stribeck_rate: omega_s, below which it sticks [rad/s] ([m/s]).
        damping: sigma_1, of the bristles, which follow within sigma_1 / sigma_0 [N*m*s/rad] ([N*s/m]).
        dwell_time: tau_dw, over which static friction builds up [s].
        direction_rate: omega_d, below which the sign is rounded off; a hundredth of omega_s if left at zero
            [rad/s] ([m/s]).

    References:
        Gonthier, McPhee, Lange and Piedboeuf (2004), Multibody Syst. Dyn. 11, 209-233; as
        :class:`antenna_pin.contact.GonthierBristle`.
    """

    integrals: ClassVar[tuple[Integral, ...]] = (LOSS, BEND, DWELL)
    states: ClassVar[tuple[Integral, ...]] = (BEND, DWELL)

    static: float | None = parameter("N*m", sliding="N", rule="positive", default=None)
    stribeck_rate: float = parameter("rad/s", sliding="m/s", rule="positive")
    damping: float = parameter("N*m*s/rad", sliding="N*s/m", rule="positive")
    dwell_time: float = parameter("s", rule="positive")
    direction_rate: float = parameter("rad/s", sliding="m/s", rule="zero or more", default=0.0)

    @property
    def kinks(self) -> int:
        """Return the number of kinks: begin and end of dwell, and saturation."""
        return 2

    @property
    def law(self) -> Any:
        """The law of contacts, with torques in the place of coefficients."""
        from antenna_pin.contact import GonthierBristle

        return GonthierBristle(
            static=self.coulomb * self.limit,
            dynamic=self.coulomb,
            stribeck_speed=self.stribeck_rate,
            bristle_stiffness=self.stiffness,
            bristle_damping=self.damping,
            dwell_time=self.dwell_time,
            direction_speed=self.direction_rate,
        )


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def _bent(
    friction: BristleFriction, tail: Floats, rate: float, own: Own
) -> tuple[float, float, float, float]:
    """Torque of the bristles, their deflection, the rate of that, and of the dwell."""
    law = tail[:FRICTION_SIZE]
    y, i = own
    z = friction.reach * (friction.start + y[i + _BEND_AT])
    dwell = y[i + _DWELL_AT] if law[0] == GONTHIER else 0.0
    bend = z, 0.0, 0.0
    force, _, _, moves, _, _, dwells = bristle(law, 1.0, (rate, 0.0, 0.0), bend, bend, dwell)
    return force, z, moves, dwells


@inlined
def effort_of(friction: BristleFriction, tail: Floats, motion: Motion, own: Own) -> float:
    """Torque [N m], or force [N], without that of a load."""
    _, _, rate = motion
    force, _, _, _ = _bent(friction, tail, rate, own)
    return float(force - friction.viscous * rate)


@inlined
def write_rates_of(
    friction: BristleFriction, tail: Floats, motion: Powered, own: Own, rates: Floats, x: int
) -> None:
    """Power that is lost [W], and the rates of deflection and dwell [1/s]."""
    _, rate, power = motion
    _, z, moves, dwells = _bent(friction, tail, rate, own)
    rates[x + _HEAT_AT] = -power - friction.stiffness * z * moves
    rates[x + _BEND_AT] = moves / friction.reach
    if tail[0] == GONTHIER:
        rates[x + _DWELL_AT] = dwells


@inlined
def stored_of(friction: BristleFriction, angle: float, own: Own) -> float:
    """Energy stored in the bristles [J]."""
    y, i = own
    z = friction.reach * (friction.start + y[i + _BEND_AT])
    return float(0.5 * friction.stiffness * z * z)


@inlined
def kink_of(friction: BristleFriction, tail: Floats, k: int, motion: Motion, own: Own) -> float:
    """Return the rate, or of Gonthier's law its functions k, zero at kinks."""
    law = tail[:FRICTION_SIZE]
    _, _, rate = motion
    if law[0] != GONTHIER:
        return float(rate)
    y, i = own
    return gonthier_kink(law, k, rate, friction.reach * (friction.start + y[i + _BEND_AT]), y[i + _DWELL_AT])


@inlined
def rub(friction: BristleFriction, tail: Floats, rate: float, own: Own) -> float:
    """Torque by load, with its sign [-]."""
    if friction.share == 0.0:
        return 0.0
    force, _, _, _ = _bent(friction, tail, rate, own)
    return friction.share * force
