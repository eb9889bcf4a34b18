"""The largest force and depth of each touching contact in a trial step, compiled."""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Record, Records, layout
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.dynamics.trial_kernels import (
    DEPTH_RATE,
    GAP,
    NORMAL_FORCE,
    TrialStep,
    rise_of_tangents,
    root_of,
    value_at,
)

#: Parts of a step for the search.
NODES = 4


class Peak(Record):
    """Largest values of a contact while it lasts."""

    force: float  # [N]
    time: float  # of the largest force [s]
    depth: float  # largest depth [m]


PEAK = layout(Peak)
_GOLDEN = 0.3819660112501051
# Permitted error of the place, in steps: the force is flat there, with an error of the square.
_NEAR = 1e-6


@kernel
def highest_force(
    c: int, low: float, middle: float, high: float, force: float, trial: TrialStep
) -> tuple[float, float]:
    """Return the largest normal force [N] of contact c between two fractions, and its fraction.

    Brent's method (1973): parabolas through the three best points, golden section otherwise.

    Args:
        c: The contact.
        low: Lower end.
        middle: Point with a larger force than at both ends, or an end with the larger one.
        high: Upper end.
        force: Force at the middle.
        trial: The step.
    """
    a, b = low, high
    x = w = v = middle
    fx = fw = fv = force
    last = before = 0.0
    for _ in range(40):
        centre = 0.5 * (a + b)
        if abs(x - centre) <= 2.0 * _NEAR - 0.5 * (b - a):
            break
        parabola = False
        if abs(before) > _NEAR:
            r = (x - w) * (fv - fx)
            q = (x - v) * (fw - fx)
            p = (x - v) * q - (x - w) * r
            q = 2.0 * (q - r)
            if q > 0.0:
                p = -p
            q = abs(q)
            if abs(p) < abs(0.5 * q * before) and q * (a - x) < p < q * (b - x):
                parabola = True
                before, last = last, p / q
                if x + last - a < 2.0 * _NEAR or b - x - last < 2.0 * _NEAR:
                    last = math.copysign(_NEAR, centre - x)
        if not parabola:
            before = b - x if x < centre else a - x
            last = _GOLDEN * before
        u = x + (last if abs(last) >= _NEAR else math.copysign(_NEAR, last))
        fu = value_at(NORMAL_FORCE, u, c, trial)
        if fu >= fx:
            if u < x:
                b = x
            else:
                a = x
            v, w, x = w, x, u
            fv, fw, fx = fw, fx, fu
            continue
        if u < x:
            a = u
        else:
            b = u
        if fu >= fw or w == x:
            v, w = w, u
            fv, fw = fw, fu
        elif fu >= fv or v in (x, w):
            v, fv = u, fu
    return fx, x


@inlined
def _may_pass(nodes: Floats, best: int, c: int, least: float, trial: TrialStep) -> bool:
    """Return whether the contact's force may exceed ``least`` beside its largest sample."""
    force = nodes[NORMAL_FORCE, best, c]
    if best == NODES:
        return bool(1.05 * force > least and value_at(NORMAL_FORCE, 1.0 - 1e-3, c, trial) > force)
    if best == 0:
        return bool(1.05 * force > least and value_at(NORMAL_FORCE, 1e-3, c, trial) > force)
    # Four times the vertex of the parabola through three points allows for other shapes.
    before, after = nodes[NORMAL_FORCE, best - 1, c], nodes[NORMAL_FORCE, best + 1, c]
    bend = 2.0 * force - before - after
    return bool(bend > 0.0 and force + 0.5 * (after - before) ** 2 / bend > least)


@kernel
def track_peaks(t: float, h: float, nodes: Floats, peaks: Records[Peak], trial: TrialStep) -> None:
    """Raise the peaks of touching contacts (``PEAK``) to maxima of the dense output."""
    memory = trial.memory
    for c in range(memory.shape[0]):
        if memory[c].touching == 0.0:
            continue
        peak = peaks[c]
        best = 0
        for k in range(1, NODES + 1):
            if nodes[NORMAL_FORCE, k, c] > nodes[NORMAL_FORCE, best, c]:
                best = k
        force = nodes[NORMAL_FORCE, best, c]
        if force > peak.force:
            peak.force = force
            peak.time = t + h * best / NODES
        if force > 0.0 and _may_pass(nodes, best, c, peak.force, trial):
            low, high = max(0.0, (best - 1) / NODES), min(1.0, (best + 1) / NODES)
            top, when = highest_force(c, low, best / NODES, high, force, trial)
            if top > peak.force:
                peak.force = top
                peak.time = t + h * when
        for k in range(NODES + 1):
            peak.depth = max(peak.depth, -nodes[GAP, k, c])
        for k in range(NODES):
            depth, rate = -nodes[GAP, k, c], nodes[DEPTH_RATE, k, c]
            end_depth, end_rate = -nodes[GAP, k + 1, c], nodes[DEPTH_RATE, k + 1, c]
            if not rate > 0.0 > end_rate:
                continue
            # Twice the rise of the tangents allows for a changing curvature.
            if depth + 2.0 * rise_of_tangents(depth, end_depth, rate, end_rate, h / NODES) <= peak.depth:
                continue
            m = root_of(DEPTH_RATE, c, k / NODES, (k + 1) / NODES, rate, end_rate, 0.0, trial)
            peak.depth = max(peak.depth, -value_at(GAP, m, c, trial))
