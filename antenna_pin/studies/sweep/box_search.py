"""Largest value of a response over a box: all corners, then a global search inside.

Numbers in, numbers out: all points of a batch are passed at once, so that a caller may evaluate them side by
side. Coordinates are those of the unit cube; 0 and 1 are the limits of a variable.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.rules import AtLeastOne
from antenna_pin.errors import InvalidParameterError

Response = Callable[[Array], Array]

#: Largest number of corners: those of twelve variables.
MOST_CORNERS = 4096
# Share of the evaluations of a search for its first points and for its last, local part.
_FIRST, _LOCAL = 0.3, 0.3
# Members of a generation per variable, within limits.
_MEMBERS, _FEWEST, _MOST = 4, 8, 40


@dataclass(frozen=True, slots=True)
class WorstCase:
    """Largest value found over a box."""

    point: Array  # its coordinates in the unit cube, (variables,) [-]
    value: float  # the value; NaN where no point has one
    corner: Array  # coordinates of the largest corner, (variables,) [-]
    at_corner: float  # value there
    runs: int  # number of evaluations [-]

    @property
    def inside(self) -> bool:
        """True where a point inside the box is beyond all corners."""
        return bool(self.value > self.at_corner)


@takes()
def corners_of(levels: ArrayLike) -> Array:
    """Return all combinations of levels in the unit cube, (combinations, variables) [-].

    Raises:
        InvalidParameterError: There are more than :data:`MOST_CORNERS`.
    """
    counts = [int(one) for one in np.atleast_1d(np.asarray(levels, dtype=int))]
    total = int(np.prod(counts, dtype=float))
    if total > MOST_CORNERS:
        rule = f"of at most {MOST_CORNERS} combinations; name fewer numbers in `corners`, or search"
        raise InvalidParameterError("corners", "ranges", rule, said=f"{total}")
    return np.array(list(itertools.product(*(np.linspace(0.0, 1.0, n) for n in counts))), dtype=float)


class _Evaluated:
    """Response with a count of points and the largest value."""

    def __init__(self, response: Response) -> None:
        self._response = response
        self.runs, self.value = 0, -np.inf
        self.point: Array = np.zeros(0)

    def __call__(self, points: Array) -> Array:
        values = np.asarray(self._response(points), dtype=float)
        if values.shape != (len(points),):
            rule = f"{len(points)} numbers, one for each point"
            raise InvalidParameterError("worst_case", "response", rule, said=f"shape {values.shape}")
        self.runs += len(points)
        known = np.where(np.isnan(values), -np.inf, values)
        k = int(known.argmax())
        if known[k] > self.value or not self.point.size:
            self.value, self.point = float(known[k]), points[k].copy()
        return known


@takes()
def worst_case(
    response: Response,
    variables: AtLeastOne,
    *,
    runs: int = 0,
    seed: int = 0,
    corners: ArrayLike | None = None,
) -> WorstCase:
    """Return the largest value of a response over the unit cube.

    All corners come first. Then differential evolution (Storn and Price 1997, J. Glob. Optim. 11, 341-359;
    rand-to-best/1/bin) starts from the best corners and a Sobol' sequence, and a pattern search ends at its
    best point. A monotone response keeps its corner; of any other the result is never below the best corner.

    Args:
        response: Values, (points,), at points of the unit cube, (points, variables); NaN for none.
        variables: Number of variables.
        runs: Evaluations of the search; 0 for corners only.
        seed: Seed of the search.
        corners: Points that count as corners, (corners, variables); all of the cube by default.

    Raises:
        InvalidParameterError: There are too many corners, or the response gives other than numbers.
    """
    ends = corners_of(np.full(variables, 2)) if corners is None else np.asarray(corners, dtype=float)
    evaluated = _Evaluated(response)
    at_ends = evaluated(ends)
    corner, at_corner = evaluated.point.copy(), evaluated.value
    if runs > 0:
        _search(evaluated, ends[np.argsort(-at_ends, kind="stable")], variables, runs, seed)
    value = evaluated.value if np.isfinite(evaluated.value) else np.nan
    return WorstCase(
        evaluated.point, value, corner, at_corner if np.isfinite(at_corner) else np.nan, evaluated.runs
    )


def _search(evaluated: _Evaluated, ends: Array, variables: int, runs: int, seed: int) -> None:
    """Search the cube by differential evolution and a pattern search, with so many evaluations."""
    from scipy.stats import qmc

    generator = np.random.default_rng(seed)
    most = evaluated.runs + runs
    size = int(np.clip(_MEMBERS * variables, _FEWEST, _MOST))
    first = max(int(_FIRST * runs), min(size, runs))
    power = int(np.ceil(np.log2(max(first, 2))))
    sobol = qmc.Sobol(variables, scramble=True, rng=generator).random_base2(power)[:first]
    inside = evaluated(sobol)
    # The best corners take part; their values are known, and asking for them again costs nothing new.
    kept = ends[: max(size // 4, 1)]
    members = np.concatenate([kept, sobol])
    values = np.concatenate([evaluated(kept), inside])
    evaluated.runs -= len(kept)
    best = np.argsort(-values, kind="stable")[:size]
    members, values = members[best], values[best]
    local = int(_LOCAL * runs)
    while most - local - evaluated.runs >= len(members):
        trials = _trials(members, values, generator)
        found = evaluated(trials)
        better = found >= values
        members = np.where(better[:, None], trials, members)
        values = np.where(better, found, values)
    _pattern(evaluated, variables, most)


def _trials(members: Array, values: Array, generator: np.random.Generator) -> Array:
    """Return a generation of trials: towards the best, along a difference of others, mixed."""
    count, variables = members.shape
    best = members[int(values.argmax())]
    first, second = (generator.permuted(np.tile(np.arange(count), (count, 1)), axis=1)[:, k] for k in (0, 1))
    weight = generator.uniform(0.4, 0.9, (count, 1))
    moved = members + weight * (best - members) + weight * (members[first] - members[second])
    mixed = generator.random((count, variables)) < 0.8
    mixed[np.arange(count), generator.integers(variables, size=count)] = True
    trials = np.where(mixed, moved, members)
    # Beyond a limit a trial is put between its member and the limit.
    low, high = trials < 0.0, trials > 1.0
    between = generator.random(trials.shape)
    trials = np.where(low, members * between, trials)
    return np.asarray(np.where(high, members + (1.0 - members) * between, trials))


def _pattern(evaluated: _Evaluated, variables: int, most: int) -> None:
    """Improve the best point by a compass search with a parabola along each axis."""
    step = 0.1
    while evaluated.runs + 2 * variables <= most and step > 1e-9:
        centre, value = evaluated.point.copy(), evaluated.value
        moves = np.concatenate([np.eye(variables), -np.eye(variables)]) * step
        points = np.clip(centre + moves, 0.0, 1.0)
        found = evaluated(points)
        up, down = found[:variables], found[variables:]
        if evaluated.runs < most:
            with np.errstate(invalid="ignore", divide="ignore"):
                bend = up + down - 2.0 * value
                vertex = np.where(bend < 0.0, 0.5 * step * (down - up) / bend, 0.0)
            free = np.all([points[:variables].diagonal() - centre == step, bend < 0.0], axis=0)
            jump = np.where(free & np.isfinite(vertex), np.clip(vertex, -step, step), 0.0)
            if jump.any():
                evaluated(np.clip(centre + jump, 0.0, 1.0)[None, :])
        if evaluated.value <= value:
            step *= 0.25
        elif np.abs(evaluated.point - centre).max() < 0.5 * step:
            step *= 0.5
