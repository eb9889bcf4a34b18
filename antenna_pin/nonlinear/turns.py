"""Steps cut where works turn back: there the rate of a gross work, the size of a power, has a kink.

What it integrates to has none, so that its derivative is the integral of ``sgn(P) dP``, with no jump: it is
enough that no part of a step has both signs of the power in it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from antenna_pin.nonlinear.along import Step
from antenna_pin.nonlinear.field import Field
from antenna_pin.nonlinear.within import Within

__all__ = ["cut_at_turns"]

# What gross works and works differ by in a step that no work turns back in, over their sizes; in how many
# parts of a step the sign of a power is looked at.
_ROUND_OFF, _PARTS = 16.0 * float(np.finfo(float).eps), 16


def cut_at_turns(step: Step, within: Within, field: Field) -> list[Step]:
    """Return the parts of a step in which works go one way each, where numbers displace what is booked.

    Args:
        step: The step.
        within: States within it.
        field: The rates.
    """
    works = field.works
    if field.numbers is None or not len(works):
        return [step]
    places = works + field.system.model.nq + field.system.model.nv
    gone = np.abs(step.end[places] - step.y[places])
    turn = gone[:, 1] - gone[:, 0] > _ROUND_OFF * np.abs(step.end[places]).sum(axis=1)
    if not turn.any():
        return [step]
    within.begin(step.time, step.y, step.size, step.end)
    thetas = np.unique([0.0, *_turns(works[turn, 0], step, within, field), 1.0]).tolist()
    instants = [*(step.time + theta * step.size for theta in thetas[:-1]), step.until]
    states = [step.y, *(within.at(theta) for theta in thetas[1:-1]), step.end]
    last, parts = len(thetas) - 2, []
    for k in range(last + 1):
        ends = k == 0, k == last
        changes = ends[0] and step.changes[0], ends[1] and step.changes[1]
        known = not ends[0] or step.known[0], not ends[1] or step.known[1]
        size = (thetas[k + 1] - thetas[k]) * step.size
        parts.append(Step(instants[k], size, states[k], instants[k + 1], states[k + 1], changes, known))
    return parts


def _turns(works: NDArray[np.int_], step: Step, within: Within, field: Field) -> list[float]:
    """Return at which fractions of a step some works turn back."""

    def power(theta: float, x: int) -> float:
        return float(field.booked(step.time + theta * step.size, within.at(theta))[x])

    found = []
    for x in works.tolist():
        values = np.array([power(k / _PARTS, x) for k in range(_PARTS + 1)])
        for k in np.flatnonzero(values[1:] * values[:-1] < 0.0).tolist():
            low, high = k / _PARTS, (k + 1) / _PARTS
            found.append(float(brentq(power, low, high, args=(x,), xtol=1e-15)))
    return found
