"""Arithmetic of the friction laws that carry a state, bristles, on flat parameters, compiled.

Their kinds and records stand with those of all (:mod:`antenna_pin.contact.friction_kernels`).
"""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Triple
from antenna_pin.compiled.decorators import inlined, kernel, record
from antenna_pin.contact.friction_kernels import (
    DAHL,
    DAHL_LAW,
    DWELL,
    GONTHIER,
    GONTHIER_LAW,
    LUGRE,
    LUGRE_LAW,
)
from antenna_pin.contact.records import FRICTION_LAW

__all__ = ["bristle", "bristle_force", "gonthier_kink", "steady_coefficient"]


@kernel
def stribeck_level(mu_c: float, mu_s: float, v_s: float, speed: float) -> float:
    """``mu_c + (mu_s - mu_c) exp(-(|v| / v_s)^2)`` [-]."""
    y = speed / v_s
    return mu_c + (mu_s - mu_c) * math.exp(-y * y)


@kernel
def steady_coefficient(law: Floats, speed: float) -> float:
    """Friction coefficient of a bristle law in steady sliding [-]."""
    kind = record(law, FRICTION_LAW).kind
    if kind == DAHL:
        return float(record(law, DAHL_LAW).coefficient_of_friction)
    bent = record(law, LUGRE_LAW)
    level = stribeck_level(bent.dynamic, bent.static, bent.stribeck_speed, speed)
    if kind == LUGRE:
        return float(level + bent.viscous * speed)
    # Gonthier: sigma_0 z = mu_c dir(v) + sigma_1 s v / (1 - s) at most mu_max, with the dwell state s_dw = s.
    s = math.exp(-((speed / bent.stribeck_speed) ** 2))
    u = min(speed / record(law, GONTHIER_LAW).rounding_speed, 1.0)
    bristle = bent.dynamic * u * (1.5 - 0.5 * u * u)
    if s < 1.0:
        bristle = min(bristle + bent.bristle_damping * s * speed / (1.0 - s), level)
    else:
        bristle = level
    return float(bristle + bent.viscous * speed)


@kernel
def _dahl(mu: float, sigma_0: float, exponent: float, speed: float, v: Triple, z: Triple) -> Triple:
    """Return the rate of the deflection by Dahl's law.

    It is ``|v| w |w|^(i - 1)``, with ``w = v / |v| - sigma_0 z / mu``.
    """
    vx, vy, vz = v
    zx, zy, zz = z
    grip = 1.0
    if exponent != 1.0 and speed > 0.0:
        wx = vx / speed - sigma_0 * zx / mu
        wy = vy / speed - sigma_0 * zy / mu
        wz = vz / speed - sigma_0 * zz / mu
        grip = math.sqrt(wx * wx + wy * wy + wz * wz) ** (exponent - 1.0)
    fade = sigma_0 * speed / mu
    return grip * (vx - fade * zx), grip * (vy - fade * zy), grip * (vz - fade * zz)


@kernel
def _gonthier(mu_d: float, v_s: float, sigma_0: float, sigma_1: float, v_e: float, speed: float) -> Triple:
    """Return stick s, and the factors of v and -z in Gonthier's deflection rate.

    The bristle sticks (rate v) as far as s says, and slides (bristle force mu_d) as far as 1 - s.
    """
    s = math.exp(-((speed / v_s) ** 2))
    u = speed / v_e
    direction = (1.5 - 0.5 * u * u) / v_e if u < 1.0 else 1.0 / speed  # dir(v) = direction v
    return s, s + (1.0 - s) * mu_d * direction / sigma_1, (1.0 - s) * sigma_0 / sigma_1


@inlined
def _strength(mu_d: float, mu_s: float, dwell: float) -> float:
    """Return the largest friction of Gonthier's law [-]."""
    return mu_d + (mu_s - mu_d) * dwell


@kernel
def gonthier_kink(law: Floats, k: int, rate: float, bend: float, dwell: float) -> float:
    """Return function k of Gonthier's law, zero at kinks of the friction.

    0: how much it sticks beyond its dwell, which grows slowly and fades fast; 1: what its bristles would give
    beyond what they can.

    Args:
        law: The law, (FRICTION_SIZE,).
        k: Which.
        rate: Of the joint.
        bend: Deflection of the bristles.
        dwell: What is remembered of it [-].
    """
    bent, dwelling = record(law, LUGRE_LAW), record(law, GONTHIER_LAW)
    sigma_0, sigma_1 = bent.bristle_stiffness, bent.bristle_damping
    s, follow, fade = _gonthier(
        bent.dynamic, bent.stribeck_speed, sigma_0, sigma_1, dwelling.rounding_speed, abs(rate)
    )
    if k == 0:
        return float(s - dwell)
    pull = sigma_0 * bend + sigma_1 * (follow * rate - fade * bend)
    return float(abs(pull) - _strength(bent.dynamic, bent.static, dwell))


@kernel
def bristle(
    law: Floats, force: float, slip: Triple, whole: Triple, along: Triple, dwell: float
) -> tuple[float, float, float, float, float, float, float]:
    """Return the friction of a bristle law [N], and the rates of deflection and dwell.

    With torques in the place of coefficients, one for the normal force and rates of a joint for slip, it is
    the friction of that joint.

    Args:
        law: The law, (FRICTION_SIZE,).
        force: Normal force [N].
        slip: Velocity of the journal's material point over the bearing's, three numbers [m/s].
        whole: The deflection, three numbers [m].
        along: The part of it that carries force, likewise.
        dwell: What a law with a dwell remembers of it [-].
    """
    vx, vy, vz = slip
    zx, zy, zz = whole
    tx, ty, tz = along
    speed = math.sqrt(vx * vx + vy * vy + vz * vz)
    kind = record(law, FRICTION_LAW).kind
    if kind == DAHL:
        dahl = record(law, DAHL_LAW)
        mu, stiffness = dahl.coefficient_of_friction, dahl.bristle_stiffness
        rx, ry, rz = _dahl(mu, stiffness, dahl.exponent, speed, slip, whole)
        factor = -force * stiffness
        return factor * tx, factor * ty, factor * tz, rx, ry, rz, 0.0
    bent = record(law, LUGRE_LAW)
    mu_d, mu_s, v_s = bent.dynamic, bent.static, bent.stribeck_speed
    sigma_0, sigma_1, sigma_2 = bent.bristle_stiffness, bent.bristle_damping, bent.viscous
    follow, fade = 1.0, math.nan  # the deflection's rate is follow v - fade z; of no other kind
    limit, dwelling_on = math.inf, 0.0
    if kind == LUGRE:
        fade = sigma_0 * speed / stribeck_level(mu_d, mu_s, v_s, speed)
    elif kind == GONTHIER:
        dwelling = record(law, GONTHIER_LAW)
        s, follow, fade = _gonthier(mu_d, v_s, sigma_0, sigma_1, dwelling.rounding_speed, speed)
        dwelling_on = (s - dwell) / (dwelling.dwell_time if s >= dwell else sigma_1 / sigma_0)
        limit = _strength(mu_d, mu_s, dwell)
    rx, ry, rz = follow * vx - fade * zx, follow * vy - fade * zy, follow * vz - fade * zz
    stiff = sigma_0 - sigma_1 * fade
    damp = sigma_1 * follow
    bx, by, bz = stiff * tx + damp * vx, stiff * ty + damp * vy, stiff * tz + damp * vz
    size = math.sqrt(bx * bx + by * by + bz * bz)
    cut = limit / size if size > limit else 1.0
    return (
        -force * (cut * bx + sigma_2 * vx),
        -force * (cut * by + sigma_2 * vy),
        -force * (cut * bz + sigma_2 * vz),
        rx,
        ry,
        rz,
        dwelling_on,
    )


@kernel
def bristle_force(
    law: Floats, force: float, slip: Triple, normal: Triple, state: Floats, rates: Floats
) -> Triple:
    """Return the friction of a bristle law on the journal [N]; write its state rates.

    Args:
        law: The law, (FRICTION_SIZE,).
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
    dwells = record(law, FRICTION_LAW).kind == GONTHIER
    dwell = state[DWELL] if dwells else 0.0
    fx, fy, fz, rx, ry, rz, rate = bristle(law, force, slip, (zx, zy, zz), along, dwell)
    rates[0] = rx
    rates[1] = ry
    rates[2] = rz
    if dwells:
        rates[DWELL] = rate
    return fx, fy, fz
