"""Arithmetic of the contact laws on flat parameters, compiled.

A normal law travels as ``NORMAL_SIZE`` floats::

    [elastic kind, dissipation kind, elastic parameters (8), dissipation parameters (6)]

and a friction law as ``FRICTION_SIZE`` floats ``[kind, parameters (11)]``. Kernels check nothing and raise
nothing; the classes of :mod:`antenna_pin.contact` check, document and name. A new law is a new kind here and
a new class there: nothing that calls these functions changes.
"""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import kernel

NORMAL_SIZE = 16
FRICTION_SIZE = 12
BRISTLE_SIZE = 3  # integrated numbers per contact of a friction law with memory: a vector in bearing axes

ELASTIC = 0
DISSIPATION = 1
ELASTIC_PARAMETERS = 2
DISSIPATION_PARAMETERS = 10

# Elastic kinds.
POWER = 1.0
# Dissipation kinds.
CONSERVATIVE = 0.0
HYSTERETIC = 1.0
# Friction kinds; those from BRISTLE on carry a state.
FRICTIONLESS = 0.0
VELOCITY_BASED = 1.0
AMBROSIO = 2.0
TANH = 3.0
BRISTLE = 100.0


@kernel
def power(depth: float, exponent: float) -> float:
    """``depth**exponent``, continued to negative depth where the exponent is an integer, else zero there.

    The continuation lets an integrator step smoothly across the end of a contact before that end is
    located; no accepted state lies beyond it.
    """
    if depth > 0.0:
        if exponent == 1.5:
            return depth * math.sqrt(depth)
        if exponent == 1.0:
            return depth
        return float(depth**exponent)
    whole = math.floor(exponent)
    if whole != exponent:
        return 0.0
    size = float((-depth) ** exponent)
    return size if whole % 2.0 == 0.0 else -size


@kernel
def elastic_force(law: Any, depth: float) -> float:
    """Elastic part of the normal force [N] at ``depth`` [m]."""
    if law[ELASTIC] == POWER:
        return float(law[2] * power(depth, law[3]))  # f = K d^n
    return 0.0


@kernel
def elastic_energy(law: Any, depth: float) -> float:
    """Energy stored by the elastic part [J]: the integral of the force from 0 to ``depth``."""
    if depth <= 0.0:
        return 0.0
    if law[ELASTIC] == POWER:
        return float(law[2] * power(depth, law[3]) * depth / (law[3] + 1.0))
    return 0.0


@kernel
def dissipation_factor(law: Any, rate: float, approach_speed: float) -> float:
    """``chi rate / approach_speed``: what dissipation adds, as a part of the elastic force [-]."""
    if law[DISSIPATION] == HYSTERETIC:
        return float(law[10] * rate / approach_speed)
    return 0.0


@kernel
def normal_force(law: Any, depth: float, rate: float, approach_speed: float) -> float:
    """Normal force on the journal [N]; never adhesive at positive depth, continued below zero depth."""
    force = elastic_force(law, depth) * (1.0 + dissipation_factor(law, rate, approach_speed))
    if depth > 0.0 and force < 0.0:
        return 0.0
    return force


@kernel
def friction_ratio(law: Any, speed: float) -> float:
    """Friction coefficient over slip speed, ``mu(|v|) / |v|`` [s/m]; finite at rest for regular laws."""
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
    return 0.0


@kernel
def friction_force(
    law: Any,
    force: float,
    slip_x: float,
    slip_y: float,
    slip_z: float,
    state: Any,
    start: int,
    rates: Any,
    rate_start: int,
) -> tuple[float, float, float]:
    """Friction on the journal [N] for a slip velocity [m/s].

    ``state[start:start + 3]`` is the bristle of a law with memory, and its rate goes to
    ``rates[rate_start:rate_start + 3]``; laws of the slip speed alone touch neither.
    """
    speed = math.sqrt(slip_x * slip_x + slip_y * slip_y + slip_z * slip_z)
    factor = -force * friction_ratio(law, speed)
    return factor * slip_x, factor * slip_y, factor * slip_z
