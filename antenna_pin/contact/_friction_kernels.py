"""Arithmetic of the friction laws on flat parameters, compiled.

A friction law travels as ``FRICTION_SIZE`` floats ``[kind, parameters (11)]``. Laws of the slip speed give a
coefficient; those from ``BRISTLE`` on carry a state per contact, which the integrator advances: a deflection
in metres, three numbers in bearing axes, and what else the law remembers behind it. The two have functions of
their own, so that the laws that run most pay nothing for the others.
"""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import inlined, kernel

FRICTION_SIZE = 12
DEFLECTION_SIZE = 3

# Friction kinds and their parameters, from 1 on.
FRICTIONLESS = 0.0
VELOCITY_BASED = 1.0  # mu_s, mu_d, v_s, v_d
AMBROSIO = 2.0  # mu, v_0, v_1
TANH = 3.0  # mu, v_t
COULOMB = 4.0  # mu, v_r
STRIBECK = 5.0  # mu_c, mu_s, v_s, a, sigma, v_t
THRELFALL = 6.0  # mu, v_0
BENGISU_AKAY = 7.0  # mu_c, mu_s, v_0, xi
LINEAR = 8.0  # mu, v_r
BROWN_MCPHEE = 9.0  # mu_s, mu_d, v_t, mu_v, F_nt
BRISTLE = 100.0  # those from here on carry a state
DAHL = 100.0  # mu, sigma_0, i
LUGRE = 101.0  # mu_c, mu_s, v_s, sigma_0, sigma_1, sigma_2
GONTHIER = 102.0  # mu_c, mu_s, v_s, sigma_0, sigma_1, sigma_2, tau_dw, v_e


@kernel
def tanh_ratio(y: float) -> float:
    """``tanh(y) / y`` for y >= 0, by its series near zero."""
    return 1.0 - y * y / 3.0 if y < 1e-4 else math.tanh(y) / y


@kernel
def _other_friction_ratio(
    kind: float, a: float, b: float, c: float, d: float, e: float, f: float, speed: float, force: float
) -> float:
    """Friction coefficient over slip speed [s/m] of the rarer laws, from their parameters a to f."""
    if kind == COULOMB:
        return a / math.hypot(speed, b)
    if kind == STRIBECK:
        level = a + (b - a) * math.exp(-((speed / c) ** d))
        return level * tanh_ratio(speed / f) / f + e
    if kind == THRELFALL:
        if speed == 0.0:
            return 3.0 * a / b
        return -a * math.expm1(-3.0 * min(speed / b, 1.0)) / speed
    if kind == BENGISU_AKAY:
        if speed < c:
            return b * (2.0 * c - speed) / (c * c)
        return (a + (b - a) * math.exp(-d * (speed - c))) / speed
    if kind == LINEAR:
        return a / max(speed, b)
    if kind == BROWN_MCPHEE:
        y = speed / c
        valley = 0.25 * y * y + 0.75
        dry = 4.0 * b * tanh_ratio(4.0 * y) + (a - b) / (valley * valley)
        # The last term is mu_v tanh(4 F / F_nt) / F.
        return dry / c + d * tanh_ratio(4.0 * abs(force) / e) * 4.0 / e
    return 0.0


@inlined
def friction_ratio(law: Any, speed: float, force: float) -> float:
    """Friction coefficient over slip speed, ``mu(|v|) / |v|`` [s/m]; finite at rest for regular laws.

    Only a law whose friction is not proportional to the normal force [N] looks at it.
    """
    kind = law[0]
    if kind == VELOCITY_BASED:
        # Corrected law (14) of Bai and Zhao 2020: cubic STEP 0 -> mu_s at v_s -> mu_d at v_d.
        mu_s, mu_d, v_s, v_d = law[1], law[2], law[3], law[4]
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
        mu, v_0, v_1 = law[1], law[2], law[3]
        if speed <= v_0:
            return 0.0
        if speed < v_1:
            return float(mu * (speed - v_0) / (v_1 - v_0) / speed)
        return float(mu / speed)
    if kind == TANH:
        mu, v_t = law[1], law[2]
        y = speed / v_t
        if y < 1e-4:
            return float(mu * (1.0 - y * y / 3.0) / v_t)
        return float(mu * math.tanh(y) / speed)
    return _other_friction_ratio(kind, law[1], law[2], law[3], law[4], law[5], law[6], speed, force)


@kernel
def stribeck_level(mu_c: float, mu_s: float, v_s: float, speed: float) -> float:
    """``mu_c + (mu_s - mu_c) exp(-(|v| / v_s)^2)`` [-]."""
    y = speed / v_s
    return mu_c + (mu_s - mu_c) * math.exp(-y * y)


@kernel
def steady_coefficient(law: Any, speed: float) -> float:
    """Friction coefficient of a bristle law in steady sliding [-]."""
    if law[0] == DAHL:
        return float(law[1])
    level = stribeck_level(law[1], law[2], law[3], speed)
    if law[0] == LUGRE:
        return float(level + law[6] * speed)
    # Gonthier: sigma_0 z = mu_c dir(v) + sigma_1 s v / (1 - s) at most mu_max, with the dwell state s_dw = s.
    s = math.exp(-((speed / law[3]) ** 2))
    u = min(speed / law[8], 1.0)
    bristle = law[1] * u * (1.5 - 0.5 * u * u)
    if s < 1.0:
        bristle = min(bristle + law[5] * s * speed / (1.0 - s), level)
    else:
        bristle = level
    return float(bristle + law[6] * speed)


@kernel
def _dahl(
    mu: float,
    sigma_0: float,
    exponent: float,
    speed: float,
    vx: float,
    vy: float,
    vz: float,
    zx: float,
    zy: float,
    zz: float,
) -> tuple[float, float, float]:
    """Rate of the deflection of Dahl's law: ``|v| w |w|^(i - 1)``, ``w = v / |v| - sigma_0 z / mu``."""
    grip = 1.0
    if exponent != 1.0 and speed > 0.0:
        wx = vx / speed - sigma_0 * zx / mu
        wy = vy / speed - sigma_0 * zy / mu
        wz = vz / speed - sigma_0 * zz / mu
        grip = math.sqrt(wx * wx + wy * wy + wz * wz) ** (exponent - 1.0)
    fade = sigma_0 * speed / mu
    return grip * (vx - fade * zx), grip * (vy - fade * zy), grip * (vz - fade * zz)


@kernel
def _gonthier(
    mu_d: float, v_s: float, sigma_0: float, sigma_1: float, v_e: float, speed: float
) -> tuple[float, float, float]:
    """Stick s and the factors of v and -z in the rate of the deflection of Gonthier's law.

    The bristle sticks (rate v) as far as s says, and slides (bristle force mu_d) as far as 1 - s.
    """
    s = math.exp(-((speed / v_s) ** 2))
    u = speed / v_e
    direction = (1.5 - 0.5 * u * u) / v_e if u < 1.0 else 1.0 / speed  # dir(v) = direction v
    return s, s + (1.0 - s) * mu_d * direction / sigma_1, (1.0 - s) * sigma_0 / sigma_1


@kernel
def bristle_force(
    law: Any,
    at: int,
    force: float,
    vx: float,
    vy: float,
    vz: float,
    nx: float,
    ny: float,
    nz: float,
    state: Any,
    start: int,
    rates: Any,
    rate_start: int,
) -> tuple[float, float, float]:
    """Friction on the journal [N] of a law with bristles at ``law[at]``; writes the rates of its state."""
    speed = math.sqrt(vx * vx + vy * vy + vz * vz)
    kind = law[at]
    zx, zy, zz = state[start], state[start + 1], state[start + 2]
    # What has turned out of the tangent plane, as the contact moved round the bore, carries no force; the law
    # lets it fade like the rest.
    normal = zx * nx + zy * ny + zz * nz
    tx, ty, tz = zx - normal * nx, zy - normal * ny, zz - normal * nz
    if kind == DAHL:
        rx, ry, rz = _dahl(law[at + 1], law[at + 2], law[at + 3], speed, vx, vy, vz, zx, zy, zz)
        rates[rate_start] = rx
        rates[rate_start + 1] = ry
        rates[rate_start + 2] = rz
        factor = -force * law[at + 2]
        return factor * tx, factor * ty, factor * tz
    mu_d, mu_s, v_s = law[at + 1], law[at + 2], law[at + 3]
    sigma_0, sigma_1, sigma_2 = law[at + 4], law[at + 5], law[at + 6]
    follow = 1.0  # the deflection's rate is follow v - fade z
    limit = math.inf
    if kind == LUGRE:
        fade = sigma_0 * speed / stribeck_level(mu_d, mu_s, v_s, speed)
    else:
        s, follow, fade = _gonthier(mu_d, v_s, sigma_0, sigma_1, law[at + 8], speed)
        dwell = state[start + 3]
        rates[rate_start + 3] = (s - dwell) / (law[at + 7] if s >= dwell else sigma_1 / sigma_0)
        limit = mu_d + (mu_s - mu_d) * dwell
    rates[rate_start] = follow * vx - fade * zx
    rates[rate_start + 1] = follow * vy - fade * zy
    rates[rate_start + 2] = follow * vz - fade * zz
    stiff = sigma_0 - sigma_1 * fade
    damp = sigma_1 * follow
    bx, by, bz = stiff * tx + damp * vx, stiff * ty + damp * vy, stiff * tz + damp * vz
    size = math.sqrt(bx * bx + by * by + bz * bz)
    cut = limit / size if size > limit else 1.0
    return (
        -force * (cut * bx + sigma_2 * vx),
        -force * (cut * by + sigma_2 * vy),
        -force * (cut * bz + sigma_2 * vz),
    )


@inlined
def friction_force(
    law: Any, force: float, slip_x: float, slip_y: float, slip_z: float
) -> tuple[float, float, float]:
    """Friction on the journal [N] of a law of the slip speed, for a normal force [N] and a slip [m/s]."""
    speed = math.sqrt(slip_x * slip_x + slip_y * slip_y + slip_z * slip_z)
    factor = -force * friction_ratio(law, speed, force)
    return factor * slip_x, factor * slip_y, factor * slip_z
