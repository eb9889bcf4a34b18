"""Arithmetic of the dissipations, of :mod:`antenna_pin.contact.hysteresis` and ``damping``, compiled."""

from __future__ import annotations

import math
from typing import Any

from antenna_pin.base.records import Floats, Record
from antenna_pin.compiled.decorators import Layout, deferred, inlined, kernel, record
from antenna_pin.contact.called_kernels import CALLED_WHOLE, CALLED_WHOLE_LAW, called_whole
from antenna_pin.contact.records import NORMAL_LAW, dissipation_record

CONSERVATIVE = 0.0
HYSTERETIC = 1.0
PROPORTIONAL = 2.0
VISCOUS = 3.0
ROOT_DEPTH = 4.0
SECANT = 5.0
SECANT_LOADING = 6.0
STEP = 7.0
HYSTERETIC_LOADING = 8.0  # in the approach only


class HystereticLaw(Record):
    """Damping by a hysteresis factor."""

    hysteresis: float  # chi


HYSTERETIC_LAW = dissipation_record(HystereticLaw)


class ProportionalLaw(Record):
    """Damping by a hysteresis factor that goes with the approach speed."""

    hysteresis_over_speed: float  # chi over the approach speed


PROPORTIONAL_LAW = dissipation_record(ProportionalLaw)


class DamperLaw(Record):
    """A damper, constant or by the root of the depth."""

    damping: float  # D [N s/m], or c of c sqrt(depth)


DAMPER_LAW = dissipation_record(DamperLaw)


class SecantLaw(Record):
    """Damping by the secant stiffness."""

    damping: float  # alpha or 2 xi [-]
    mass: float  # m [kg]; 0: the contact's


SECANT_LAW = dissipation_record(SecantLaw)


class StepLaw(Record):
    """A damper that sets in over a depth."""

    damping: float  # D [N s/m]
    full_damping_depth: float  # d [m]


STEP_LAW = dissipation_record(StepLaw)

DISSIPATION_RECORDS: dict[float, Layout[Any]] = {
    CONSERVATIVE: dissipation_record(Record),
    HYSTERETIC: HYSTERETIC_LAW,
    PROPORTIONAL: PROPORTIONAL_LAW,
    VISCOUS: DAMPER_LAW,
    ROOT_DEPTH: DAMPER_LAW,
    SECANT: SECANT_LAW,
    SECANT_LOADING: SECANT_LAW,
    STEP: STEP_LAW,
    HYSTERETIC_LOADING: HYSTERETIC_LAW,
    CALLED_WHOLE: CALLED_WHOLE_LAW,
}


@deferred
def _additive_force(
    law: Floats, kind: float, elastic: float, depth: float, rate: float, mass: float
) -> float:
    """Return the sum of elastic and separate damping force [N], cut off at zero."""
    damping = 0.0
    if kind == VISCOUS:
        damping = record(law, DAMPER_LAW).damping
    elif kind == ROOT_DEPTH:
        damping = record(law, DAMPER_LAW).damping * math.sqrt(max(depth, 0.0))
    elif kind == SECANT or (kind == SECANT_LOADING and rate > 0.0):
        secant = record(law, SECANT_LAW)
        m = secant.mass if secant.mass > 0.0 else mass
        damping = secant.damping * math.sqrt(m * max(elastic / depth, 0.0)) if depth != 0.0 else 0.0
    elif kind == STEP:
        step = record(law, STEP_LAW)
        x = min(max(depth / step.full_damping_depth, 0.0), 1.0)
        damping = step.damping * x * x * (3.0 - 2.0 * x)
    elif kind != SECANT_LOADING:
        return math.nan  # no such kind
    return max(elastic + damping * rate, 0.0)


@inlined
def damped_force(
    law: Floats, elastic: float, depth: float, rate: float, approach_speed: float, mass: float
) -> float:
    """Normal force on the journal [N], from its elastic part; never adhesive at positive depth.

    ``mass`` [kg], that of the contact, is for laws that depend on one and have none of their own.
    """
    kind = record(law, NORMAL_LAW).dissipation
    if kind == HYSTERETIC:
        force = elastic * (1.0 + float(record(law, HYSTERETIC_LAW).hysteresis * rate / approach_speed))
    elif kind == CONSERVATIVE:
        force = elastic
    elif kind == PROPORTIONAL:
        force = elastic * (1.0 + record(law, PROPORTIONAL_LAW).hysteresis_over_speed * rate)
    elif kind == HYSTERETIC_LOADING:
        closing = max(rate, 0.0)
        force = elastic * (1.0 + float(record(law, HYSTERETIC_LAW).hysteresis * closing / approach_speed))
    else:
        if kind == CALLED_WHOLE:
            return called_whole(record(law, CALLED_WHOLE_LAW), depth, rate, approach_speed)
        return _additive_force(law, kind, elastic, depth, rate, mass)
    if depth > 0.0 and force < 0.0:
        return 0.0
    return force


@kernel
def takes_mass_of_contact(law: Floats) -> bool:
    """Return whether the force depends on the effective mass of the contact."""
    kind = record(law, NORMAL_LAW).dissipation
    return bool((kind == SECANT or kind == SECANT_LOADING) and record(law, SECANT_LAW).mass == 0.0)
