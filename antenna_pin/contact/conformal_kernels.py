"""Arithmetic of the conformal contacts of :mod:`antenna_pin.contact.conformal`, compiled."""

from __future__ import annotations

import math

import numpy as np

from antenna_pin.base.records import Record
from antenna_pin.compiled.decorators import kernel
from antenna_pin.contact.power_kernels import power
from antenna_pin.contact.records import elastic_record


class FoundationLaw(Record):
    """An elastic foundation."""

    factor: float  # (pi/2) E* L / sqrt 2 [N/m]
    clearance: float  # dR, difference of the radii [m]


FOUNDATION_LAW = elastic_record(FoundationLaw)


class BaiZhaoLaw(Record):
    """The hybrid law of Bai and Zhao."""

    factor: float  # (pi/8) E* L sqrt 2 [N/m]
    clearance: float  # dR, difference of the radii [m]
    exponent: float  # n [-]


BAI_ZHAO_LAW = elastic_record(BaiZhaoLaw)


class PerssonLaw(Record):
    """Persson's conformal contact."""

    factor: float  # 2 pi E* L dR [N]
    clearance: float  # dR, difference of the radii [m]
    largest: float  # tan^2(eps/2) [-]
    root: float  # that of an infinite load [-]


PERSSON_LAW = elastic_record(PerssonLaw)

# Gauss-Legendre on [-1, 1].
LOAD_NODES, LOAD_WEIGHTS = np.polynomial.legendre.leggauss(24)


@kernel
def foundation_energy(factor: float, clearance: float, depth: float) -> float:
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
def bai_zhao_force(law: BaiZhaoLaw, depth: float) -> float:
    """Elastic force [N] of a record of ``BAI_ZHAO_LAW``."""
    if depth <= 0.0:
        return 0.0
    s = law.clearance + depth
    return float(
        law.factor
        * math.sqrt(depth / s)
        * (3.0 * law.clearance + 2.0 * depth)
        / s
        * power(depth, law.exponent)
    )  # K_n d^n


@kernel
def bai_zhao_energy(law: BaiZhaoLaw, depth: float) -> float:
    """Energy stored [J] by a record of ``BAI_ZHAO_LAW`` with an exponent of 1.

    K_n L is the slope of Liu's force F, whose factor is twice K_n's: F d - integral of F.
    """
    force = 2.0 * law.factor * depth * math.sqrt(depth / (law.clearance + depth))
    return float(force * depth - foundation_energy(2.0 * law.factor, law.clearance, depth))


@kernel
def persson_force(law: PerssonLaw, depth: float) -> float:
    """Elastic force [N] of a record of ``PERSSON_LAW``, continued analytically below zero depth."""
    x = max(depth, -0.5 * law.clearance)
    square = min(x / (2.0 * law.clearance + x), law.largest)  # tan^2(eps/2)
    return float(law.factor * square * (1.0 + square) / (2.0 - math.log1p(square) - 2.0 * square * square))


@kernel
def persson_energy(law: PerssonLaw, depth: float) -> float:
    """Return the energy stored by a record of ``PERSSON_LAW`` [J].

    The variable is s = tan^2(eps/2): depth = 2 dR s / (1 - s).

    The force has a pole at ``root``, just beyond the range: it is taken out, r / (s - root), and integrated
    in closed form. At small depth that would cancel, and the pole is far enough for the nodes alone.
    """
    root = law.root
    end = min(depth / (2.0 * law.clearance + depth), law.largest)
    residue = 0.0
    if end > 0.25:
        residue = -root * (1.0 + root) / ((1.0 - root) ** 2 * (1.0 / (1.0 + root) + 4.0 * root))
    total = residue * math.log1p(-end / root)
    for k in range(LOAD_NODES.shape[0]):
        s = 0.5 * end * (1.0 + LOAD_NODES[k])
        load = s * (1.0 + s) / (2.0 - math.log1p(s) - 2.0 * s * s)
        total += 0.5 * end * LOAD_WEIGHTS[k] * (load / (1.0 - s) ** 2 - residue / (s - root))
    # Beyond the range the force stays as it is there.
    beyond = depth - 2.0 * law.clearance * end / (1.0 - end) if end == law.largest else 0.0
    held = end * (1.0 + end) / (2.0 - math.log1p(end) - 2.0 * end * end)
    return float(law.factor * (2.0 * law.clearance * total + max(beyond, 0.0) * held))
