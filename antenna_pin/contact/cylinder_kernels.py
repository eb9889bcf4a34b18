"""Arithmetic of the line contacts with a logarithm, of :mod:`antenna_pin.contact.cylinder`, compiled."""

from __future__ import annotations

import math

from antenna_pin.base.records import Record
from antenna_pin.compiled.decorators import kernel
from antenna_pin.contact.records import elastic_record


class LogarithmicLawRecord(Record):
    """A line contact: d = d_0 s ln(1/s), F = F_0 s."""

    force_scale: float  # F_0 [N]
    depth_scale: float  # d_0 [m]


LOGARITHMIC_LAW = elastic_record(LogarithmicLawRecord)


@kernel
def log_ratio(ratio: float) -> float:
    """Return the larger root w of ``w exp(-w) = ratio``.

    The ratio is in (0, 1/e]; beyond 1/e the root is that of 1/e: 1.

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
def logarithmic_force(law: LogarithmicLawRecord, depth: float) -> float:
    """Elastic force [N] of a record of ``LOGARITHMIC_LAW``; odd in the depth.

    d = d_0 w exp(-w), F = F_0 exp(-w), on the branch below the turn-over at w = 1. Odd, as the law is nearly
    linear and an integrator may step across its end.
    """
    ratio = abs(depth) / law.depth_scale
    if ratio < 1e-300:
        return 0.0
    force = law.force_scale * math.exp(-log_ratio(ratio))
    return float(force if depth > 0.0 else -force)


@kernel
def logarithmic_energy(law: LogarithmicLawRecord, depth: float) -> float:
    """Energy stored [J] by a record of ``LOGARITHMIC_LAW``.

    F d - integral of d dF, with d = d_0 s ln(1/s): F_0 d_0 s^2 (w/2 - 1/4), w = ln(1/s).
    """
    if depth < 1e-300 * law.depth_scale:
        return 0.0
    w = log_ratio(depth / law.depth_scale)
    s = math.exp(-w)
    # Beyond the turn-over the force stays as it is there.
    beyond = max(0.0, depth - law.depth_scale * w * s) * law.force_scale * s
    return float(law.force_scale * law.depth_scale * s * s * (0.5 * w - 0.25) + beyond)
