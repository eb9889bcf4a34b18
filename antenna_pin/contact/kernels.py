"""Arithmetic of the normal laws on flat parameters, compiled: selection by kind.

A normal law travels as ``NORMAL_SIZE`` floats, which :mod:`antenna_pin.contact.records` gives names. Kernels
check nothing and raise nothing; the classes of :mod:`antenna_pin.contact` check, document and name. A kind
that is unknown here gives NaN.

A new kind of elastic law has a record and a force in a file of its family, and here a line in
``ELASTIC_RECORDS`` and a branch in ``_other_force``; where no energy is given it is integrated. The kinds
that run most come first; the rest stands in functions of its own, so that it costs the others nothing.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import Layout, deferred, inlined, kernel, record
from antenna_pin.contact.called_kernels import CALLED, CALLED_LAW, called_energy, called_force
from antenna_pin.contact.conformal_kernels import (
    BAI_ZHAO_LAW,
    FOUNDATION_LAW,
    PERSSON_LAW,
    bai_zhao_energy,
    bai_zhao_force,
    foundation_energy,
    persson_energy,
    persson_force,
)
from antenna_pin.contact.cylinder_kernels import LOGARITHMIC_LAW, logarithmic_energy, logarithmic_force
from antenna_pin.contact.damping_kernels import DISSIPATION_RECORDS, damped_force, takes_mass_of_contact
from antenna_pin.contact.pin_joint_kernels import PIN_JOINT_LAW, pin_joint_force
from antenna_pin.contact.power_kernels import POWER_LAW, power
from antenna_pin.contact.records import (
    BAI_ZHAO,
    FOUNDATION,
    LOGARITHMIC,
    NORMAL_LAW,
    NORMAL_SIZE,
    PERSSON,
    PIN_JOINT,
    POWER,
)

__all__ = [
    "DISSIPATION_RECORDS",
    "ELASTIC_RECORDS",
    "NORMAL_SIZE",
    "damped_force",
    "elastic_energy",
    "elastic_force",
    "normal_force",
    "takes_mass_of_contact",
]

ELASTIC_RECORDS: dict[float, Layout[Any]] = {
    POWER: POWER_LAW,
    LOGARITHMIC: LOGARITHMIC_LAW,
    FOUNDATION: FOUNDATION_LAW,
    BAI_ZHAO: BAI_ZHAO_LAW,
    PERSSON: PERSSON_LAW,
    PIN_JOINT: PIN_JOINT_LAW,
    CALLED: CALLED_LAW,
}

# Gauss-Legendre on [-1, 1].
DEPTH_NODES, DEPTH_WEIGHTS = np.polynomial.legendre.leggauss(8)


@deferred
def _other_force(law: Floats, kind: float, depth: float) -> float:
    """Elastic force [N] of the rarer kinds."""
    if kind == LOGARITHMIC:
        return logarithmic_force(record(law, LOGARITHMIC_LAW), depth)
    if kind == BAI_ZHAO:
        return bai_zhao_force(record(law, BAI_ZHAO_LAW), depth)
    if kind == PERSSON:
        return persson_force(record(law, PERSSON_LAW), depth)
    if kind == PIN_JOINT:
        return pin_joint_force(record(law, PIN_JOINT_LAW), depth)
    if kind == CALLED:
        return called_force(record(law, CALLED_LAW), depth)
    return math.nan  # no such kind


@inlined
def elastic_force(law: Floats, depth: float) -> float:
    """Elastic part of the normal force [N] at ``depth`` [m]."""
    kind = record(law, NORMAL_LAW).elastic
    if kind == POWER:
        spring = record(law, POWER_LAW)
        return float(spring.stiffness * power(depth, spring.exponent))  # f = K d^n
    if kind == FOUNDATION:
        bed = record(law, FOUNDATION_LAW)
        return float(bed.factor * depth * math.sqrt(depth / (bed.clearance + depth))) if depth > 0.0 else 0.0
    return _other_force(law, kind, depth)


@kernel
def _quadrature(law: Floats, kind: float, depth: float) -> float:
    """Return the integral of the elastic force from 0 to ``depth`` [J], by quadrature.

    For laws without a closed form.

    Over u of ``depth exp(-u)``, in which these forces are smooth down to depth zero; what lies beyond u = 40
    is less than the round-off.
    """
    total = 0.0
    low = 0.0
    width = 0.5
    while low < 40.0:
        for k in range(DEPTH_NODES.shape[0]):
            x = depth * math.exp(-low - 0.5 * width * (1.0 + DEPTH_NODES[k]))
            total += 0.5 * width * DEPTH_WEIGHTS[k] * x * _other_force(law, kind, x)
        low += width
        width *= 1.25
    return total


@deferred
def _other_energy(law: Floats, kind: float, depth: float) -> float:
    """Energy stored [J] by the kinds that are no power of the depth."""
    if kind == FOUNDATION:
        bed = record(law, FOUNDATION_LAW)
        return foundation_energy(bed.factor, bed.clearance, depth)
    if kind == LOGARITHMIC:
        return logarithmic_energy(record(law, LOGARITHMIC_LAW), depth)
    if kind == PERSSON:
        return persson_energy(record(law, PERSSON_LAW), depth)
    if kind == BAI_ZHAO and record(law, BAI_ZHAO_LAW).exponent == 1.0:
        return bai_zhao_energy(record(law, BAI_ZHAO_LAW), depth)
    if kind == CALLED:
        return called_energy(record(law, CALLED_LAW), depth)
    return _quadrature(law, kind, depth)


@kernel
def elastic_energy(law: Floats, depth: float) -> float:
    """Return the energy stored by the elastic part [J].

    It is the integral of the force from 0 to ``depth``.
    """
    if depth <= 0.0:
        return 0.0
    kind = record(law, NORMAL_LAW).elastic
    if kind == POWER:
        spring = record(law, POWER_LAW)
        return float(spring.stiffness * power(depth, spring.exponent) * depth / (spring.exponent + 1.0))
    return _other_energy(law, kind, depth)


@kernel
def normal_force(law: Floats, depth: float, rate: float, approach_speed: float, mass: float) -> float:
    """Normal force on the journal [N]; never adhesive at positive depth, continued below zero depth."""
    return damped_force(law, elastic_force(law, depth), depth, rate, approach_speed, mass)
