"""Arithmetic of the friction laws on flat parameters, compiled.

A friction law travels as ``FRICTION_SIZE`` floats, which :mod:`antenna_pin.contact.records` gives names: its
kind, then its parameters by the names of its class. Laws of the slip speed give a coefficient; those from
``BRISTLE`` on carry a state per contact, which the integrator advances: a deflection in metres, three numbers
in bearing axes, and what else the law remembers behind it. The two have functions of their own, so that the
laws that run most pay nothing for the others. A kind that is unknown here gives NaN.
"""

from __future__ import annotations

import math
from typing import Any

from antenna_pin.base.records import Floats, Record, Triple
from antenna_pin.compiled.decorators import Layout, deferred, inlined, kernel, record
from antenna_pin.contact.called_kernels import CALLED_FRICTION, CALLED_FRICTION_LAW, called_ratio
from antenna_pin.contact.records import FRICTION_LAW, FRICTION_SIZE, friction_record

__all__ = [
    "FRICTION_RECORDS",
    "FRICTION_SIZE",
    "friction_force",
    "friction_ratio",
]

DEFLECTION_SIZE = 3
DWELL = DEFLECTION_SIZE  # where in a state its dwell stands

FRICTIONLESS = 0.0
VELOCITY_BASED = 1.0
AMBROSIO = 2.0
TANH = 3.0
COULOMB = 4.0
STRIBECK = 5.0
THRELFALL = 6.0
BENGISU_AKAY = 7.0
LINEAR = 8.0
BROWN_MCPHEE = 9.0
BRISTLE = 100.0  # those from here on carry a state
DAHL = 100.0
LUGRE = 101.0
GONTHIER = 102.0


class VelocityBasedLaw(Record):
    """Two coefficients, and the slip speeds at which they hold."""

    static: float  # coefficient [-]
    dynamic: float  # coefficient [-]
    static_speed: float  # of the static one [m/s]
    dynamic_speed: float  # from which on it is the dynamic one [m/s]


VELOCITY_BASED_LAW = friction_record(VelocityBasedLaw)


class AmbrosioLaw(Record):
    """A coefficient that grows between two slip speeds."""

    coefficient_of_friction: float  # [-]
    lower_speed: float  # [m/s]
    upper_speed: float  # [m/s]


AMBROSIO_LAW = friction_record(AmbrosioLaw)


class TanhLaw(Record):
    """Coulomb's law smoothed by tanh."""

    coefficient_of_friction: float  # [-]
    transition_speed: float  # [m/s]


TANH_LAW = friction_record(TanhLaw)


class CoulombLaw(Record):
    """Coulomb's law, regularised."""

    coefficient_of_friction: float  # [-]
    regularisation_speed: float  # [m/s]


COULOMB_LAW = friction_record(CoulombLaw)


class StribeckLaw(Record):
    """Stribeck's curve."""

    dynamic: float  # coefficient [-]
    static: float  # coefficient [-]
    stribeck_speed: float  # [m/s]
    exponent: float  # [-]
    viscous: float  # coefficient over slip speed [s/m]
    transition_speed: float  # [m/s]


STRIBECK_LAW = friction_record(StribeckLaw)


class ThrelfallLaw(Record):
    """Threlfall's law."""

    coefficient_of_friction: float  # [-]
    transition_speed: float  # [m/s]


THRELFALL_LAW = friction_record(ThrelfallLaw)


class BengisuAkayLaw(Record):
    """The law of Bengisu and Akay."""

    dynamic: float  # coefficient [-]
    static: float  # coefficient [-]
    static_speed: float  # of the static one [m/s]
    decay: float  # from static to dynamic [s/m]


BENGISU_AKAY_LAW = friction_record(BengisuAkayLaw)


class LinearLaw(Record):
    """A coefficient that grows linearly up to a slip speed."""

    coefficient_of_friction: float  # [-]
    regularisation_speed: float  # [m/s]


LINEAR_LAW = friction_record(LinearLaw)


class BrownMcPheeLaw(Record):
    """The law of Brown and McPhee."""

    static: float  # coefficient [-]
    dynamic: float  # coefficient [-]
    transition_speed: float  # [m/s]
    viscous: float  # force over slip speed [N s/m]
    transition_force: float  # normal force of full viscous friction [N]


BROWN_MCPHEE_LAW = friction_record(BrownMcPheeLaw)


class DahlLaw(Record):
    """Dahl's bristles."""

    coefficient_of_friction: float  # [-]
    bristle_stiffness: float  # over the normal force [1/m]
    exponent: float  # [-]


DAHL_LAW = friction_record(DahlLaw)


class LuGreLaw(Record):
    """The bristles of LuGre."""

    dynamic: float  # coefficient [-]
    static: float  # coefficient [-]
    stribeck_speed: float  # [m/s]
    bristle_stiffness: float  # over the normal force [1/m]
    bristle_damping: float  # over the normal force [s/m]
    viscous: float  # coefficient over slip speed [s/m]


LUGRE_LAW = friction_record(LuGreLaw)


class GonthierLaw(LuGreLaw):
    """Gonthier's bristles; begins as :class:`LuGreLaw`."""

    dwell_time: float  # [s]
    rounding_speed: float  # [m/s]


GONTHIER_LAW = friction_record(GonthierLaw)

FRICTION_RECORDS: dict[float, Layout[Any]] = {
    FRICTIONLESS: friction_record(Record),
    VELOCITY_BASED: VELOCITY_BASED_LAW,
    AMBROSIO: AMBROSIO_LAW,
    TANH: TANH_LAW,
    COULOMB: COULOMB_LAW,
    STRIBECK: STRIBECK_LAW,
    THRELFALL: THRELFALL_LAW,
    BENGISU_AKAY: BENGISU_AKAY_LAW,
    LINEAR: LINEAR_LAW,
    BROWN_MCPHEE: BROWN_MCPHEE_LAW,
    CALLED_FRICTION: CALLED_FRICTION_LAW,
    DAHL: DAHL_LAW,
    LUGRE: LUGRE_LAW,
    GONTHIER: GONTHIER_LAW,
}


@kernel
def tanh_ratio(y: float) -> float:
    """``tanh(y) / y`` for y >= 0, by its series near zero."""
    return 1.0 - y * y / 3.0 if y < 1e-4 else math.tanh(y) / y


@kernel
def _threlfall_ratio(law: ThrelfallLaw, speed: float) -> float:
    mu, v_0 = law.coefficient_of_friction, law.transition_speed
    if speed == 0.0:
        return float(3.0 * mu / v_0)
    return float(-mu * math.expm1(-3.0 * min(speed / v_0, 1.0)) / speed)


@kernel
def _bengisu_akay_ratio(law: BengisuAkayLaw, speed: float) -> float:
    mu_c, mu_s, v_0 = law.dynamic, law.static, law.static_speed
    if speed < v_0:
        return float(mu_s * (2.0 * v_0 - speed) / (v_0 * v_0))
    return float((mu_c + (mu_s - mu_c) * math.exp(-law.decay * (speed - v_0))) / speed)


@kernel
def _stribeck_ratio(law: StribeckLaw, speed: float) -> float:
    level = law.dynamic + (law.static - law.dynamic) * math.exp(
        -((speed / law.stribeck_speed) ** law.exponent)
    )
    return float(level * tanh_ratio(speed / law.transition_speed) / law.transition_speed + law.viscous)


@kernel
def _brown_mcphee_ratio(law: BrownMcPheeLaw, speed: float, force: float) -> float:
    y = speed / law.transition_speed
    valley = 0.25 * y * y + 0.75
    dry = 4.0 * law.dynamic * tanh_ratio(4.0 * y) + (law.static - law.dynamic) / (valley * valley)
    # The last term is mu_v tanh(4 F / F_nt) / F.
    whole = law.transition_force
    wet = law.viscous * tanh_ratio(4.0 * abs(force) / whole) * 4.0 / whole
    return float(dry / law.transition_speed + wet)


@deferred
def _other_friction_ratio(law: Floats, kind: float, speed: float, force: float) -> float:
    """Friction coefficient over slip speed [s/m] of the rarer laws."""
    if kind == COULOMB:
        rounded = record(law, COULOMB_LAW)
        return float(rounded.coefficient_of_friction / math.hypot(speed, rounded.regularisation_speed))
    if kind == STRIBECK:
        return _stribeck_ratio(record(law, STRIBECK_LAW), speed)
    if kind == THRELFALL:
        return _threlfall_ratio(record(law, THRELFALL_LAW), speed)
    if kind == BENGISU_AKAY:
        return _bengisu_akay_ratio(record(law, BENGISU_AKAY_LAW), speed)
    if kind == LINEAR:
        ramp = record(law, LINEAR_LAW)
        return float(ramp.coefficient_of_friction / max(speed, ramp.regularisation_speed))
    if kind == BROWN_MCPHEE:
        return _brown_mcphee_ratio(record(law, BROWN_MCPHEE_LAW), speed, force)
    if kind == CALLED_FRICTION:
        return called_ratio(record(law, CALLED_FRICTION_LAW), speed)
    # A law with bristles has its friction from bristle_force; others there are none.
    return 0.0 if kind >= BRISTLE else math.nan


@inlined
def friction_ratio(law: Floats, speed: float, force: float) -> float:
    """Friction coefficient over slip speed, ``mu(|v|) / |v|`` [s/m]; finite at rest for regular laws.

    Only laws whose friction is not proportional to the normal force [N] depend on it.
    """
    kind = record(law, FRICTION_LAW).kind
    if kind == VELOCITY_BASED:
        # Corrected law (14) of Bai and Zhao 2020: cubic STEP 0 -> mu_s at v_s -> mu_d at v_d.
        adams = record(law, VELOCITY_BASED_LAW)
        mu_s, mu_d, v_s, v_d = adams.static, adams.dynamic, adams.static_speed, adams.dynamic_speed
        if speed < v_s:
            y = speed / v_s
            return float(0.5 * mu_s * (3.0 - y * y) / v_s)
        if speed < v_d:
            x = (v_d - speed) / (v_d - v_s)
            return float((mu_d + (mu_s - mu_d) * x * x * (3.0 - 2.0 * x)) / speed)
        return float(mu_d / speed)
    if kind == FRICTIONLESS:
        return 0.0
    if kind == AMBROSIO:
        ramp = record(law, AMBROSIO_LAW)
        mu, v_0, v_1 = ramp.coefficient_of_friction, ramp.lower_speed, ramp.upper_speed
        if speed <= v_0:
            return 0.0
        if speed < v_1:
            return float(mu * (speed - v_0) / (v_1 - v_0) / speed)
        return float(mu / speed)
    if kind == TANH:
        smooth = record(law, TANH_LAW)
        level, v_t = smooth.coefficient_of_friction, smooth.transition_speed
        z = speed / v_t
        if z < 1e-4:
            return float(level * (1.0 - z * z / 3.0) / v_t)
        return float(level * math.tanh(z) / speed)
    return _other_friction_ratio(law, kind, speed, force)


@inlined
def friction_force(law: Floats, force: float, slip_x: float, slip_y: float, slip_z: float) -> Triple:
    """Return the friction on the journal by a law of the slip speed [N].

    Arguments are the normal force [N] and the slip [m/s].
    """
    speed = math.sqrt(slip_x * slip_x + slip_y * slip_y + slip_z * slip_z)
    factor = -force * friction_ratio(law, speed, force)
    return factor * slip_x, factor * slip_y, factor * slip_z
