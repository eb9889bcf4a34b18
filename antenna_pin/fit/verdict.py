"""Judgement of a fit as a whole: residuals beyond chance with their likely causes, parameters at bounds."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.readable import number, readable
from antenna_pin.fit.covariance import Bands
from antenna_pin.fit.problem import Problem
from antenna_pin.fit.runs import NoRunError

__all__ = ["advises_starts", "verdict_of"]

Array = NDArray[np.float64]

# Distance from a bound, over that of both, at which a value stands there.
_AT_BOUND = 1e-6
# Ratio of a record to the model at the start from which on a unit is suspected; correlation below which a
# sign is; share of chi2 that a shift of the clock must take to be named; and shifts tried, over the record.
_UNIT, _SIGN, _CLOCK, _SHIFTS = 5.0, -0.8, 0.8, np.linspace(-0.2, 0.2, 161)


class _Curve(NamedTuple):
    """A column that is compared row by row: its name, times, model and record."""

    name: str
    at: Array
    model: Array
    data: Array


def verdict_of(problem: Problem, whole: Array, bands: Bands) -> tuple[str, ...]:
    """Return what must be known before any value is read: the judgement and its likely causes, a line each.

    Args:
        problem: What was fitted.
        whole: Values with states that were found, (p + h,) [SI].
        bands: What is known of the values.

    Returns:
        Nothing if there is nothing to object to.
    """
    lines = list(_at_bounds(problem, whole))
    if bands.beyond_chance:
        spread = math.sqrt(2.0 * bands.freedoms)
        lines.append(
            f"the model does not fit the records: chi2 is {number(bands.chi2, 4)}, where noise of the stated "
            f"sd leaves {bands.freedoms} ± {number(spread, 2)}; {_of_bands(bands)}"
        )
        lines += [f"  may be {cause}" for cause in _causes(problem, whole, bands)]
    return tuple(lines)


def advises_starts(problem: Problem, bands: Bands) -> bool:
    """Return whether a search from many starts, which the plan could have, comes before other advice."""
    bounded = all(one.between is not None for one in problem.plan.parameters.values())
    return bands.beyond_chance and problem.plan.starts is None and bounded


def _of_bands(bands: Bands) -> str:
    if bands.without:
        return f"the values have no bands: {bands.without}"
    widened = number(math.sqrt(bands.excess), 3)
    return f"bands are widened by {widened}, as if each sd was larger by that"


def _at_bounds(problem: Problem, whole: Array) -> Iterator[str]:
    """Yield a line if each parameter stands at a bound."""
    unknowns = problem.unknowns
    p = unknowns.count
    at, (lower, upper) = unknowns.searched(whole)[:p], (one[:p] for one in unknowns.bounds())
    width = np.where(np.isfinite(upper - lower), upper - lower, 1.0)
    if np.all(np.minimum(at - lower, upper - at) <= _AT_BOUND * width):
        said = []
        for k, name in enumerate(unknowns.names):
            said.append(f"{name} at {readable(whole[k], unknowns.units[k] or '1', 5)}")
        every = "every parameter stands" if p > 1 else "the parameter stands"
        yield f"{every} at its bound, {', '.join(said)}: the records ask for what lies beyond"


def _causes(problem: Problem, whole: Array, bands: Bands) -> Iterator[str]:
    """Yield what may be wrong, the likeliest first."""
    begun, ended = (_curves(problem, at) for at in (np.concatenate([problem.first, problem.states]), whole))
    yield from _of_units(begun)
    clocks = [*_of_clocks(begun), *_of_clocks(ended)]
    yield from clocks[:1]
    if advises_starts(problem, bands):
        yield "a wrong valley of the sum of squares: search from many points, [starts] with count = 64"
    elif problem.plan.starts is None:
        yield "a wrong valley of the sum of squares: give each parameter bounds (between), and [starts]"
    yield "a model that lacks something, or an sd that is too small"


def _curves(problem: Problem, whole: Array) -> list[_Curve]:
    """Return the columns that are compared as curves; none where there is no run."""
    try:
        found = problem.predictions(whole)
    except NoRunError:
        return []
    names = np.array(
        [f"{r}.{c}" for r, c in zip(found["record"].values, found["column"].values, strict=True)]
    )
    curves = []
    for name in dict.fromkeys(names.tolist()):
        rows = names == name
        if (found["measure"].values[rows] == "reading").all():
            parts = (found[key].values[rows].astype(float) for key in ("at", "model", "data"))
            curves.append(_Curve(name, *parts))
    return curves


def _of_units(curves: Sequence[_Curve]) -> Iterator[str]:
    """Yield columns whose size or sign is not the model's where the search began."""
    for name, _, model, data in curves:
        if not (np.ptp(model) > 0.0 and np.ptp(data) > 0.0):
            continue
        ratio = math.sqrt(float(np.mean(data**2) / np.mean(model**2)))
        if not 1.0 / _UNIT < ratio < _UNIT:
            times = f"{number(ratio, 2)} times as large as"
            yield f"the unit of {name}: the record is {times} the model at the start"
        elif np.corrcoef(model, data)[0, 1] < _SIGN:
            yield f"the sign of {name}: the record goes against the model at the start; give gain = -1"


def _of_clocks(curves: Sequence[_Curve]) -> Iterator[str]:
    """Yield records that a shift of the clock would bring nearer to the model."""
    for name, at, model, data in curves:
        shifts, costs = _SHIFTS * float(at[-1] - at[0]), []
        for shift in shifts:
            inside = (at + shift >= at[0]) & (at + shift <= at[-1])
            off = np.interp(at[inside] + shift, at, model) - data[inside]
            costs.append(float(np.mean(off**2)))
        best = int(np.argmin(costs))
        if costs[best] < (1.0 - _CLOCK) * costs[len(costs) // 2] and 0 < best < len(costs) - 1:
            record, shift = name.partition(".")[0], readable(float(shifts[best]), "s", 2)
            yield f"the clock of {record}: {shift} more of clock_shift would take most of chi2"
