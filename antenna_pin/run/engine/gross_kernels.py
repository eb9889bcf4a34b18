"""Gross works of a step, compiled: integrals of |P| over sources of power P.

|P| has a kink where P changes its sign, and steps continue across it. The work W, with the rate P, is smooth
and integrated with the state; its total variation is the gross work. An error of the turning point has an
effect of second order only.
"""

from __future__ import annotations

from antenna_pin.base.records import Floats, Ints
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.integrate.explicit_kernels import Tableau
from antenna_pin.integrate.kernels import START
from antenna_pin.integrate.manifold_kernels import space_of

# Parts of a step in which a reversal of a work is searched, and number of their halvings.
_PARTS, _HALVINGS = 16, 50


@inlined
def _turns(i: int, last: int, work: Floats) -> bool:
    """Return whether rates of component i change sign among the stages."""
    least, most = 0.0, 0.0
    for j in range(last + 1):
        least = min(least, work[j, i])
        most = max(most, work[j, i])
    return bool(least < 0.0 < most)


@kernel
def turn_back(works: Ints, tableau: Tableau, space: Ints, work: Floats) -> bool:
    """Return whether any work reverses within the step.

    Args:
        works: Places of works and their gross works in x, (n, 2).
        tableau: Coefficients of the method.
        space: Layout of the manifold.
        work: Rows of the stepper.
    """
    found = False
    first = 2 * space_of(space).nv
    for n in range(works.shape[0]):
        found = found or _turns(first + works[n, 0], tableau.last, work)
    return found


@inlined
def _gone(i: int, theta: float, dense: Floats) -> tuple[float, float]:
    """Return relative distance and rate of component i at a fraction of the step."""
    value, slope = 0.0, 0.0
    for p in range(dense.shape[0] - 1, -1, -1):
        value = value * theta + dense[p, i]
        slope = slope * theta + (p + 1) * dense[p, i]
    return value * theta, slope


@inlined
def _turning(i: int, low: float, high: float, rises: bool, dense: Floats) -> float:
    """Return at which fraction of the step component i turns back, between two of them."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if (_gone(i, middle, dense)[1] > 0.0) == rises:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


@inlined
def _way(i: int, theta: float, dense: Floats) -> float:
    """Return the total variation of component i up to a fraction of the step."""
    total, since = 0.0, 0.0
    low, (_, slope) = 0.0, _gone(i, 0.0, dense)
    rises = slope > 0.0
    for part in range(1, _PARTS + 1):
        high = theta * part / _PARTS
        rises_there = _gone(i, high, dense)[1] > 0.0
        if rises_there != rises:
            here = _gone(i, _turning(i, low, high, rises, dense), dense)[0]
            total += abs(here - since)
            since = here
        low, rises = high, rises_there
    return total + abs(_gone(i, theta, dense)[0] - since)


@kernel
def settle(
    theta: float, works: Ints, tableau: Tableau, space: Ints, work: Floats, dense: Floats, y: Floats
) -> None:
    """Write the gross works of reversing powers to a state within the step.

    Args:
        theta: Fraction of the step at the state.
        works: As for :func:`turn_back`.
        tableau: Coefficients of the method.
        space: Layout of the manifold.
        work: Rows of the stepper.
        dense: Coefficients of the dense output.
        y: State.
    """
    sizes, start = space_of(space), tableau.weights.shape[0] + START
    for n in range(works.shape[0]):
        i = 2 * sizes.nv + works[n, 0]
        if _turns(i, tableau.last, work):
            gross = sizes.nq + sizes.nv + works[n, 1]
            y[gross] = work[start, gross] + _way(i, theta, dense)
