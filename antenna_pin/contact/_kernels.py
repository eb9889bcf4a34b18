"""Arithmetic of the normal laws on flat parameters, compiled.

A normal law travels as ``NORMAL_SIZE`` floats::

    [elastic kind, dissipation kind, elastic parameters (8), dissipation parameters (6)]

Kernels check nothing and raise nothing; the classes of :mod:`antenna_pin.contact` check, document and name. A
new law is a new kind here and a new class there: nothing that calls these functions changes. The kinds that
run most come first; the rest stands in functions of its own, so that it costs the others nothing.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from antenna_pin._compile import inlined, kernel

NORMAL_SIZE = 16

ELASTIC = 0
DISSIPATION = 1
ELASTIC_PARAMETERS = 2
DISSIPATION_PARAMETERS = 10

# Elastic kinds and their parameters, from ELASTIC_PARAMETERS on.
POWER = 1.0  # K, n
LOGARITHMIC = 2.0  # F_0, d_0: d = d_0 s ln(1/s), F = F_0 s
FOUNDATION = 3.0  # (pi/2) E* L / sqrt 2, dR
BAI_ZHAO = 4.0  # (pi/8) E* L sqrt 2, dR, n
PERSSON = 5.0  # 2 pi E* L dR, dR, largest tan^2(eps/2), that of an infinite load
PIN_JOINT = 6.0  # (pi/2) E* L, R_j, R_i, dR, the share of the depth that shapes the contact
# Dissipation kinds and their parameters, from DISSIPATION_PARAMETERS on.
CONSERVATIVE = 0.0
HYSTERETIC = 1.0  # chi
PROPORTIONAL = 2.0  # chi over the approach speed
VISCOUS = 3.0  # D
ROOT_DEPTH = 4.0  # c
SECANT = 5.0  # alpha, m; a mass of 0 stands for that of the contact
SECANT_LOADING = 6.0  # 2 xi, m likewise
STEP = 7.0  # D, depth of full damping
HYSTERETIC_LOADING = 8.0  # chi, in the approach only

ELASTIC_KINDS = (POWER, LOGARITHMIC, FOUNDATION, BAI_ZHAO, PERSSON, PIN_JOINT)
DISSIPATION_KINDS = (
    CONSERVATIVE, HYSTERETIC, PROPORTIONAL, VISCOUS, ROOT_DEPTH, SECANT, SECANT_LOADING, STEP,
    HYSTERETIC_LOADING,
)  # fmt: skip

# Gauss-Legendre with 8 and with 24 points, on [-1, 1].
NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)
MANY_NODES, MANY_WEIGHTS = np.polynomial.legendre.leggauss(24)


@inlined
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
def log_ratio(ratio: float) -> float:
    """The larger root w of ``w exp(-w) = ratio``, for a ratio in (0, 1/e]; beyond 1/e that of 1/e: 1.

    By Newton's method on ``(w - 1) - ln w = u``, ``u = -1 - ln ratio``, between the bounds
    ``sqrt(2 u) + 2 u / 3`` and ``sqrt(2 u) + u`` of w - 1 (Chatzigeorgiou 2013). It is convex, so that from
    the lower bound the first step lands above the root and all others come down on it: four or five steps.
    """
    u = -1.0 - math.log(ratio)
    if not u > 0.0:
        return 1.0
    root = math.sqrt(2.0 * u)
    low = root + 2.0 / 3.0 * u
    high = root + u
    w = low
    for _ in range(12):
        step = (w - math.log1p(w) - u) * (1.0 + w) / w
        w = min(max(w - step, low), high)
        if abs(step) <= 1e-15 * w:
            break
    return 1.0 + w


@kernel
def _logarithmic(force_0: float, depth_0: float, depth: float) -> float:
    # d = d_0 w exp(-w), F = F_0 exp(-w), on the branch below the turn-over at w = 1. Odd, as the law is
    # nearly linear and an integrator may step across its end.
    ratio = abs(depth) / depth_0
    if ratio < 1e-300:
        return 0.0
    force = force_0 * math.exp(-log_ratio(ratio))
    return force if depth > 0.0 else -force


@kernel
def _pin_joint(
    factor: float, journal: float, bearing: float, clearance: float, share: float, depth: float
) -> float:
    # Liu et al. 2013 (24) and (28); a^2 is written so that nothing cancels at small depth. Odd.
    size = abs(depth)
    d = min(size * share, math.sqrt((bearing + journal) * clearance) - clearance)
    s = clearance + d
    inner = 4.0 * bearing * clearance + 2.0 * (bearing + clearance) * d + d * d
    square = d * (2.0 * journal - d) * inner / (4.0 * s * s)
    if square < 1e-300:
        return 0.0
    force = factor * size / (math.log(16.0 * journal * journal / square) - 1.0)
    return force if depth > 0.0 else -force


@kernel
def _bai_zhao(factor: float, clearance: float, exponent: float, depth: float) -> float:
    if depth <= 0.0:
        return 0.0
    s = clearance + depth
    return (
        factor * math.sqrt(depth / s) * (3.0 * clearance + 2.0 * depth) / s * power(depth, exponent)
    )  # K_n d^n


@kernel
def _persson(factor: float, clearance: float, largest: float, depth: float) -> float:
    x = max(depth, -0.5 * clearance)
    square = min(x / (2.0 * clearance + x), largest)  # tan^2(eps/2)
    return factor * square * (1.0 + square) / (2.0 - math.log1p(square) - 2.0 * square * square)


@kernel
def _cylinder_force(kind: float, a: float, b: float, c: float, d: float, e: float, depth: float) -> float:
    """Elastic force [N] of the rarer kinds, from their parameters a to e."""
    if kind == LOGARITHMIC:
        return _logarithmic(a, b, depth)
    if kind == BAI_ZHAO:
        return _bai_zhao(a, b, c, depth)
    if kind == PERSSON:
        return _persson(a, b, c, depth)
    if kind == PIN_JOINT:
        return _pin_joint(a, b, c, d, e, depth)
    return math.nan  # no such kind


@inlined
def elastic_force(law: Any, depth: float) -> float:
    """Elastic part of the normal force [N] at ``depth`` [m]."""
    kind = law[ELASTIC]
    if kind == POWER:
        return float(law[2] * power(depth, law[3]))  # f = K d^n
    if kind == FOUNDATION:
        return float(law[2] * depth * math.sqrt(depth / (law[3] + depth))) if depth > 0.0 else 0.0
    return _cylinder_force(kind, law[2], law[3], law[4], law[5], law[6], depth)


@kernel
def _foundation_energy(factor: float, clearance: float, depth: float) -> float:
    """Integral of ``factor x sqrt(x / (clearance + x))`` from 0 to ``depth`` [J]."""
    r = depth / clearance
    if r > 0.3:
        root = math.sqrt(r * (1.0 + r))
        return 0.25 * factor * clearance**2 * ((2.0 * r - 3.0) * root + 3.0 * math.asinh(math.sqrt(r)))
    # The terms of that cancel at small depth: sum over k of binomial(-1/2, k) r^k / (k + 5/2).
    total = 0.0
    term = 1.0
    for k in range(40):
        total += term / (k + 2.5)
        term *= -r * (k + 0.5) / (k + 1.0)
        if abs(term) < 1e-17:
            break
    return factor * depth * depth * math.sqrt(r) * total


@kernel
def _logarithmic_energy(force_0: float, depth_0: float, depth: float) -> float:
    # F d - integral of d dF, with d = d_0 s ln(1/s): F_0 d_0 s^2 (w/2 - 1/4), w = ln(1/s).
    if depth < 1e-300 * depth_0:
        return 0.0
    w = log_ratio(depth / depth_0)
    s = math.exp(-w)
    # Beyond the turn-over the force stays as it is there.
    beyond = max(0.0, depth - depth_0 * w * s) * force_0 * s
    return force_0 * depth_0 * s * s * (0.5 * w - 0.25) + beyond


@kernel
def _persson_energy(factor: float, clearance: float, largest: float, root: float, depth: float) -> float:
    """Energy of Persson's law [J], over s = tan^2(eps/2): depth = 2 dR s / (1 - s).

    The force has a pole at ``root``, just beyond the range: it is taken out, r / (s - root), and integrated
    in closed form. At small depth that would cancel, and the pole is far enough for the nodes alone.
    """
    end = min(depth / (2.0 * clearance + depth), largest)
    residue = 0.0
    if end > 0.25:
        residue = -root * (1.0 + root) / ((1.0 - root) ** 2 * (1.0 / (1.0 + root) + 4.0 * root))
    total = residue * math.log1p(-end / root)
    for k in range(MANY_NODES.shape[0]):
        s = 0.5 * end * (1.0 + MANY_NODES[k])
        load = s * (1.0 + s) / (2.0 - math.log1p(s) - 2.0 * s * s)
        total += 0.5 * end * MANY_WEIGHTS[k] * (load / (1.0 - s) ** 2 - residue / (s - root))
    # Beyond the range the force stays as it is there.
    beyond = depth - 2.0 * clearance * end / (1.0 - end) if end == largest else 0.0
    held = end * (1.0 + end) / (2.0 - math.log1p(end) - 2.0 * end * end)
    return factor * (2.0 * clearance * total + max(beyond, 0.0) * held)


@kernel
def _quadrature(kind: float, a: float, b: float, c: float, d: float, e: float, depth: float) -> float:
    """Integral of the elastic force from 0 to ``depth`` [J], where it has no closed form.

    Over u of ``depth exp(-u)``, in which these forces are smooth down to depth zero; what lies beyond u = 40
    is less than the round-off.
    """
    total = 0.0
    low = 0.0
    width = 0.5
    while low < 40.0:
        for k in range(NODES.shape[0]):
            x = depth * math.exp(-low - 0.5 * width * (1.0 + NODES[k]))
            total += 0.5 * width * WEIGHTS[k] * x * _cylinder_force(kind, a, b, c, d, e, x)
        low += width
        width *= 1.25
    return total


@kernel
def _cylinder_energy(kind: float, a: float, b: float, c: float, d: float, e: float, depth: float) -> float:
    """Energy stored [J] by the kinds that are no power of the depth, from their parameters a to e."""
    if kind == FOUNDATION:
        return _foundation_energy(a, b, depth)
    if kind == LOGARITHMIC:
        return _logarithmic_energy(a, b, depth)
    if kind == PERSSON:
        return _persson_energy(a, b, c, d, depth)
    if kind == BAI_ZHAO and c == 1.0:
        # K_n L is the slope of Liu's force F, whose factor is twice K_n's: F d - integral of F.
        force = 2.0 * a * depth * math.sqrt(depth / (b + depth))
        return force * depth - _foundation_energy(2.0 * a, b, depth)
    return _quadrature(kind, a, b, c, d, e, depth)


@kernel
def elastic_energy(law: Any, depth: float) -> float:
    """Energy stored by the elastic part [J]: the integral of the force from 0 to ``depth``."""
    if depth <= 0.0:
        return 0.0
    if law[ELASTIC] == POWER:
        return float(law[2] * power(depth, law[3]) * depth / (law[3] + 1.0))
    return _cylinder_energy(law[0], law[2], law[3], law[4], law[5], law[6], depth)


@kernel
def _additive_force(
    kind: float, a: float, b: float, elastic: float, depth: float, rate: float, mass: float
) -> float:
    """Elastic force and a damping that is no multiple of it [N], cut off at zero."""
    damping = 0.0
    if kind == VISCOUS:
        damping = a
    elif kind == ROOT_DEPTH:
        damping = a * math.sqrt(max(depth, 0.0))
    elif kind == SECANT or (kind == SECANT_LOADING and rate > 0.0):
        m = b if b > 0.0 else mass
        damping = a * math.sqrt(m * max(elastic / depth, 0.0)) if depth != 0.0 else 0.0
    elif kind == STEP:
        x = min(max(depth / b, 0.0), 1.0)
        damping = a * x * x * (3.0 - 2.0 * x)
    elif kind != SECANT_LOADING:
        return math.nan  # no such kind
    return max(elastic + damping * rate, 0.0)


@inlined
def damped_force(
    law: Any, elastic: float, depth: float, rate: float, approach_speed: float, mass: float
) -> float:
    """Normal force on the journal [N], from its elastic part; never adhesive at positive depth.

    ``mass`` [kg], that of the contact, is for laws that depend on one and have none of their own.
    """
    kind = law[DISSIPATION]
    if kind == HYSTERETIC:
        force = elastic * (1.0 + float(law[10] * rate / approach_speed))
    elif kind == CONSERVATIVE:
        force = elastic
    elif kind == PROPORTIONAL:
        force = elastic * (1.0 + law[10] * rate)
    elif kind == HYSTERETIC_LOADING:
        force = elastic * (1.0 + float(law[10] * max(rate, 0.0) / approach_speed))
    else:
        return _additive_force(kind, law[10], law[11], elastic, depth, rate, mass)
    if depth > 0.0 and force < 0.0:
        return 0.0
    return force


@kernel
def normal_force(law: Any, depth: float, rate: float, approach_speed: float, mass: float) -> float:
    """Normal force on the journal [N]; never adhesive at positive depth, continued below zero depth."""
    return damped_force(law, elastic_force(law, depth), depth, rate, approach_speed, mass)


@kernel
def takes_mass_of_contact(law: Any) -> bool:
    """Whether the force depends on a mass that the law does not have itself."""
    kind = law[DISSIPATION]
    return bool((kind == SECANT or kind == SECANT_LOADING) and law[11] == 0.0)
