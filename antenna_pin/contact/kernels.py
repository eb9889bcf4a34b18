"""Normal laws in packed parameters, compiled: dispatch to the kernels of elastic laws and dissipations.

Kernels check nothing and raise nothing; a kind that is unknown here gives NaN. Laws that are ``frequent`` are
compiled into the callers; the others stand in functions of their own, at no cost to these.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from antenna_pin.base.records import Floats
from antenna_pin.compiled.calls import call_1, call_3
from antenna_pin.compiled.decorators import composed, inlined, kernel, record
from antenna_pin.contact import registry
from antenna_pin.contact.records import (
    NORMAL_LAW,
    NORMAL_SIZE,
    chain,
    dissipation_record,
    elastic_record,
    number_of,
)

__all__ = [
    "NORMAL_SIZE",
    "CalledLaw",
    "CalledWholeLaw",
    "called_force",
    "called_whole",
    "damped_force",
    "elastic_energy",
    "elastic_force",
    "normal_force",
]

# --- functions of a user's, called by address ---------------------------------------------------------------


class CalledLaw(NamedTuple):
    """Elastic law."""

    address: float  # of its force
    energy: float  # address of its energy
    limit: float  # depth at whose end it is called past it [m]


class CalledWholeLaw(NamedTuple):
    """Law of force over depth and rate."""

    whole: float  # address
    end: float  # depth at whose end it is called past it [m]


@inlined
def called_force(law: CalledLaw, depth: float) -> float:
    """Elastic force [N]."""
    return float(call_1(law.address, min(depth, law.limit))) if depth > 0.0 else 0.0


@inlined
def called_whole(
    law: CalledWholeLaw, elastic: float, depth: float, rate: float, approach_speed: float, mass: float
) -> float:
    """Whole normal force [N]; never adhesive."""
    if depth <= 0.0:
        return 0.0
    force = float(call_3(law.whole, min(depth, law.end), rate, approach_speed))
    return force if not force < 0.0 else 0.0  # NaN stays NaN


_CALLED, _CALLED_LAW = number_of(called_force), elastic_record(called_force)
_CALLED_WHOLE, _CALLED_WHOLE_LAW = number_of(called_whole), dissipation_record(called_whole)

# --- elastic laws -------------------------------------------------------------------------------------------

# Gauss-Legendre on [-1, 1].
DEPTH_NODES, DEPTH_WEIGHTS = np.polynomial.legendre.leggauss(8)


def _elastic(frequent: bool) -> list[Any]:
    laws = registry.NORMAL_LAWS.values()
    return [law for law in laws if getattr(law, "frequent", None) == frequent]


@composed
def _called_force(law: Floats, kind: float, depth: float) -> float:
    return called_force(record(law, _CALLED_LAW), depth) if kind == _CALLED else math.nan


_rare_force = chain(lambda: _elastic(frequent=False), "kernel", elastic_record, _called_force)


@kernel
def _other_force(law: Floats, kind: float, depth: float) -> float:
    """Elastic force [N] of the rarer kinds."""
    return float(_rare_force(law, kind, depth))


_force = chain(lambda: _elastic(frequent=True), "kernel", elastic_record, _other_force)


@inlined
def elastic_force(law: Floats, depth: float) -> float:
    """Elastic part of the normal force [N] at ``depth`` [m]."""
    return float(_force(law, record(law, NORMAL_LAW).elastic, depth))


@kernel
def _quadrature(law: Floats, kind: float, depth: float) -> float:
    """Return the integral of the elastic force from 0 to ``depth`` [J], by quadrature.

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


@composed
def _no_energy(law: Floats, kind: float, depth: float) -> float:
    return math.nan


_rare_energy = chain(lambda: _elastic(frequent=False), "energy", elastic_record, _no_energy)


@kernel
def _other_energy(law: Floats, kind: float, depth: float) -> float:
    """Energy stored [J] by the rarer kinds."""
    if kind == _CALLED:
        return float(call_1(record(law, _CALLED_LAW).energy, min(depth, record(law, _CALLED_LAW).limit)))
    energy = float(_rare_energy(law, kind, depth))
    return _quadrature(law, kind, depth) if math.isnan(energy) else energy


_energy = chain(lambda: _elastic(frequent=True), "energy", elastic_record, _other_energy)


@kernel
def elastic_energy(law: Floats, depth: float) -> float:
    """Return the energy stored by the elastic part [J].

    It is the integral of the force from 0 to ``depth``.
    """
    if depth <= 0.0:
        return 0.0
    return float(_energy(law, record(law, NORMAL_LAW).elastic, depth))


# --- with dissipation ---------------------------------------------------------------------------------------


def _dissipations(frequent: bool) -> list[Any]:
    return [law for law in registry.DISSIPATIONS.values() if law.frequent == frequent]


@composed
def _called_whole(
    law: Floats, kind: float, elastic: float, depth: float, rate: float, approach_speed: float, mass: float
) -> float:
    if kind != _CALLED_WHOLE:
        return math.nan
    return called_whole(record(law, _CALLED_WHOLE_LAW), elastic, depth, rate, approach_speed, mass)


_rare_damped = chain(lambda: _dissipations(frequent=False), "kernel", dissipation_record, _called_whole)


@kernel
def _other_damped(
    law: Floats, kind: float, elastic: float, depth: float, rate: float, approach_speed: float, mass: float
) -> float:
    """Normal force [N] with the rarer dissipations."""
    return float(_rare_damped(law, kind, elastic, depth, rate, approach_speed, mass))


_damped = chain(lambda: _dissipations(frequent=True), "kernel", dissipation_record, _other_damped)


@inlined
def damped_force(
    law: Floats, elastic: float, depth: float, rate: float, approach_speed: float, mass: float
) -> float:
    """Normal force on the journal [N], from its elastic part; never adhesive at positive depth.

    ``mass`` [kg], that of the contact, is for laws that depend on one and have none of their own.
    """
    kind = record(law, NORMAL_LAW).dissipation
    force = float(_damped(law, kind, elastic, depth, rate, approach_speed, mass))
    return 0.0 if depth > 0.0 and force < 0.0 else force


@kernel
def normal_force(law: Floats, depth: float, rate: float, approach_speed: float, mass: float) -> float:
    """Normal force on the journal [N]; never adhesive at positive depth, continued below zero depth."""
    return damped_force(law, elastic_force(law, depth), depth, rate, approach_speed, mass)
