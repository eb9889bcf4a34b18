"""Laws in packed parameters, compiled: dispatch to the kernels of elastic laws, dissipations and friction.

Kernels check nothing and raise nothing; a kind that is unknown here gives NaN. Laws that are ``frequent`` are
compiled into the callers; the others stand in functions of their own, at no cost to these.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from antenna_pin.base.records import Floats, Triple
from antenna_pin.compiled.calls import call_1, call_3
from antenna_pin.compiled.decorators import composed, deferred, inlined, kernel, record
from antenna_pin.contact import registry
from antenna_pin.contact.records import (
    FRICTION_LAW,
    FRICTION_SIZE,
    NORMAL_LAW,
    NORMAL_SIZE,
    chain,
    dissipation_record,
    elastic_record,
    friction_record,
    number_of,
)

__all__ = [
    "DEFLECTION_SIZE",
    "FRICTION_SIZE",
    "NORMAL_SIZE",
    "CalledLaw",
    "CalledWholeLaw",
    "Rates",
    "bristle",
    "bristle_force",
    "called_force",
    "called_whole",
    "damped_force",
    "elastic_energy",
    "elastic_force",
    "friction_force",
    "friction_ratio",
    "normal_force",
    "steady_coefficient",
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


@deferred
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


@deferred
def _other_energy(law: Floats, kind: float, depth: float) -> float:
    """Energy stored [J] by the rarer kinds."""
    if kind == _CALLED:
        return float(call_1(record(law, _CALLED_LAW).energy, min(depth, record(law, _CALLED_LAW).limit)))
    energy = float(_rare_energy(law, kind, depth))
    return _quadrature(law, kind, depth) if math.isnan(energy) else energy


_energy = chain(lambda: _elastic(frequent=True), "energy", elastic_record, _other_energy)


@kernel
def elastic_energy(law: Floats, depth: float) -> float:
    """Return the elastic energy [J], the integral of the elastic force up to ``depth``."""
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


@deferred
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


# --- friction of the slip speed -----------------------------------------------------------------------------


def _frictions(frequent: bool) -> list[Any]:
    laws = (*registry.FRICTION_LAWS.values(), registry.CUSTOM_FRICTION["custom"])
    return [law for law in laws if law.frequent == frequent]


@composed
def _no_ratio(law: Floats, kind: float, speed: float, force: float) -> float:
    return math.nan


_rare_ratio = chain(lambda: _frictions(frequent=False), "ratio", friction_record, _no_ratio)


@deferred
def _other_ratio(law: Floats, kind: float, speed: float, force: float) -> float:
    """Friction coefficient over slip speed [s/m] of the rarer laws."""
    return float(_rare_ratio(law, kind, speed, force))


_ratio = chain(lambda: _frictions(frequent=True), "ratio", friction_record, _other_ratio)


@inlined
def friction_ratio(law: Floats, speed: float, force: float) -> float:
    """Friction coefficient over slip speed [s/m]; zero of bristles."""
    return float(_ratio(law, record(law, FRICTION_LAW).kind, speed, force))


@inlined
def friction_force(law: Floats, force: float, slip_x: float, slip_y: float, slip_z: float) -> Triple:
    """Return the friction on the journal by a law of the slip speed [N]."""
    speed = math.sqrt(slip_x * slip_x + slip_y * slip_y + slip_z * slip_z)
    factor = -force * friction_ratio(law, speed, force)
    return factor * slip_x, factor * slip_y, factor * slip_z


# --- bristles -----------------------------------------------------------------------------------------------
#
# They carry a state per contact: a deflection in metres, three numbers in bearing axes, and behind it what
# else the law remembers.

DEFLECTION_SIZE = 3
DWELL = DEFLECTION_SIZE  # where in a state its dwell stands

#: Friction [N], and the rates of deflection [m/s] and dwell [1/s].
Rates = tuple[float, float, float, float, float, float, float]


def _bristles() -> list[Any]:
    return [law for law in registry.FRICTION_LAWS.values() if hasattr(law, "steady")]


@composed
def _no_friction(
    law: Floats, kind: float, force: float, slip: Triple, whole: Triple, along: Triple, dwell: float
) -> Rates:
    return math.nan, math.nan, math.nan, math.nan, math.nan, math.nan, math.nan


@composed
def _no_coefficient(law: Floats, kind: float, speed: float) -> float:
    return math.nan


@composed
def _no_dwell(law: Floats, kind: float) -> bool:
    return False


_friction = chain(_bristles, "kernel", friction_record, _no_friction)
_steady = chain(_bristles, "steady", friction_record, _no_coefficient)
_dwells = chain(_bristles, "dwells", friction_record, _no_dwell)


@kernel
def steady_coefficient(law: Floats, speed: float) -> float:
    """Friction coefficient of a bristle law in steady sliding [-]."""
    return float(_steady(law, record(law, FRICTION_LAW).kind, speed))


@kernel
def bristle(law: Floats, force: float, slip: Triple, whole: Triple, along: Triple, dwell: float) -> Rates:
    """Return the friction of a bristle law [N], and the rates of deflection and dwell.

    With torques in the place of coefficients, one for the normal force and rates of a joint for slip, it is
    the friction of that joint.

    Args:
        law: Packed parameters, (FRICTION_SIZE,).
        force: Normal force [N].
        slip: Velocity of the journal's material point over the bearing's, three numbers [m/s].
        whole: The deflection, three numbers [m].
        along: The part of it that carries force, likewise.
        dwell: What a law with a dwell remembers of it [-].
    """
    return _friction(  # type: ignore[no-any-return]
        law, record(law, FRICTION_LAW).kind, force, slip, whole, along, dwell
    )


@kernel
def bristle_force(
    law: Floats, force: float, slip: Triple, normal: Triple, state: Floats, rates: Floats
) -> Triple:
    """Return the friction of a bristle law on the journal [N]; write its state rates.

    Args:
        law: Packed parameters, (FRICTION_SIZE,).
        force: Normal force [N].
        slip: Velocity of the journal's material point over the bearing's, (3,) [m/s].
        normal: Of the contact, unit, (3,).
        state: What the law remembers; its deflection comes first.
        rates: To write to, of that.
    """
    nx, ny, nz = normal
    zx, zy, zz = state[0], state[1], state[2]
    # What has turned out of the tangent plane, as the contact moved round the bore, carries no force; the law
    # lets it fade like the rest.
    out = zx * nx + zy * ny + zz * nz
    along = zx - out * nx, zy - out * ny, zz - out * nz
    dwells = _dwells(law, record(law, FRICTION_LAW).kind)
    dwell = state[DWELL] if dwells else 0.0
    fx, fy, fz, rx, ry, rz, rate = bristle(law, force, slip, (zx, zy, zz), along, dwell)
    rates[0] = rx
    rates[1] = ry
    rates[2] = rz
    if dwells:
        rates[DWELL] = rate
    return fx, fy, fz
