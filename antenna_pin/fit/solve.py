"""The search: least squares from one start or the best of many, kept on the disk as it goes."""

from __future__ import annotations

import dataclasses
import importlib
import math
import os
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.files import check_writable
from antenna_pin.base.readable import number, prefixed
from antenna_pin.errors import MissingToolError
from antenna_pin.fit.covariance import WITHHELD, Bands, bands_of
from antenna_pin.fit.laboratory import Laboratory
from antenna_pin.fit.losses import cost
from antenna_pin.fit.notebook import Notebook
from antenna_pin.fit.plan import FitPlan
from antenna_pin.fit.problem import Problem
from antenna_pin.fit.result import Fit, Search
from antenna_pin.fit.runs import NoRunError
from antenna_pin.fit.sureness import hang_together, persistence
from antenna_pin.fit.surface import on_surface
from antenna_pin.fit.validation import Validation
from antenna_pin.fit.verdict import advises_starts, verdict_of
from antenna_pin.sweep import Executor

__all__ = ["run_fit"]


Array = NDArray[np.float64]


# Fewest residuals of which tests tell something; chance below which they are said to fail; and the excess
# kurtosis from which on tails matter to a least squares fit.
_FEWEST, _RARE, _TAILS = 20, 1e-4, 1.0


# --- tests of residuals: whiteness by their correlation, randomness by runs of sign, normality by moments ---
#
# References:
#     Wald and Wolfowitz (1940), Ann. Math. Stat. 11, 147-162: runs.
#     D'Agostino and Pearson (1973), Biometrika 60, 613-622: normality.


class ResidualTests(NamedTuple):
    """Tests of the residuals of one column, chances being those that noise does as badly.

    Attributes:
        correlation: Of each residual with the next [-].
        runs: Stretches of one sign, about the mean.
        runs_chance: That independent residuals have a number as far from the expected one [-].
        excess_kurtosis: Fourth moment over the squared variance, less 3 [-].
        normal_chance: That normal residuals have skewness and kurtosis as far from theirs [-].
    """

    correlation: float
    runs: int
    runs_chance: float
    excess_kurtosis: float
    normal_chance: float


def tests_of(residuals: Array) -> ResidualTests | None:
    """Return the tests of residuals in the order of time, (n,); None of fewer than 20, or all the same."""
    from scipy import stats

    if len(residuals) < _FEWEST or not np.ptp(residuals) > 0.0:
        return None
    above = residuals > residuals.mean()
    runs, (a, b) = 1 + int(np.count_nonzero(np.diff(above))), (int(above.sum()), int((~above).sum()))
    expected = 1.0 + 2.0 * a * b / (a + b)
    variance = (expected - 1.0) * (expected - 2.0) / (a + b - 1.0)
    apart = abs(runs - expected) / math.sqrt(variance)
    return ResidualTests(
        persistence(residuals),
        runs,
        float(2.0 * stats.norm.sf(apart)),
        float(stats.kurtosis(residuals)),
        float(stats.normaltest(residuals).pvalue),
    )


def notes_on_residuals(curves: Mapping[str, Array]) -> Iterator[str]:
    """Yield a line for each column whose residuals are no noise, though their correlation is that of noise.

    Args:
        curves: Residuals of each column that is compared row by row, in the order of time.
    """
    for name, residuals in curves.items():
        found = None if hang_together(residuals) else tests_of(residuals)
        if found is not None and found.runs_chance < _RARE:
            yield (
                f"note: residuals of {name} have {found.runs} stretches of one sign, as by chance "
                f"{number(found.runs_chance, 1)} of records would: the model lacks something"
            )
        if found is not None and found.normal_chance < _RARE and found.excess_kurtosis > _TAILS:
            yield (
                f"note: residuals of {name} have tails that normal noise has not, an excess kurtosis of "
                f'{number(found.excess_kurtosis, 2)}: outliers count less by loss = "soft_l1"'
            )


# In how many parts a record is looked at; the bend of a difference over the difference from which on it is
# none that is straight; and over how many growths by e a piece is to go.
_PARTS, _BENT, _FOLDS = 24, 0.5, 1.0
# --- whether one run can hold a record: how differences between neighbours grow along it ---
#
# A search goes by derivatives. Along a chaotic motion differences grow with its exponent: behind some instant
# neighbours a small step away have nothing in common but their statistics, and derivatives, true as they may
# be, tell nothing of where the sum of squares is smaller. Over pieces that are short enough they do.

_AT_LEAST = 3.0  # growths by e that have been, where one cannot be told
_ROUND_OFF = 1e-9  # of what runs read [-]


class Growth(NamedTuple):
    """How differences grow along a record that one run does not hold.

    Attributes:
        since: From when on neighbours differ by more than is straight [s].
        fold: In what time a difference grows by e [s].
    """

    since: float
    fold: float

    @property
    def length(self) -> float:
        """Length of pieces over which it does not grow by much [s]."""
        return _FOLDS * self.fold

    def words(self, record: str, parameter: str, step: float) -> str:
        """Return a line on it.

        Args:
            record: Name of the record.
            parameter: Name of the parameter that neighbours differ by.
            step: By how much of its size [-].
        """
        since, fold, length = (_time(one) for one in (self.since, self.fold, self.length))
        return (
            f"note: records.{record}: one run does not hold it: from {since} on the effect of {step:g} of "
            f"{parameter} is not straight any more, and it grows by e in {fold}; give it "
            f'pieces = {{ length = "{length}" }}'
        )


def _time(value: float) -> str:
    factor, unit = prefixed("s", [value])
    return f"{factor * value:.2g} {unit.replace('µ', 'u')}"


def growth_of(time: Array, below: Array, here: Array, above: Array, reach: float = 1.0) -> Growth | None:
    """Return how differences of neighbours grow along a record; None where they stay small.

    Args:
        time: Of its rows [s].
        below: What is read in a run on one side, over the noise, (columns, rows).
        here: Likewise in the run itself.
        above: On the other side.
        reach: How much farther neighbours are looked for than these are, by how the difference bends.
    """
    if len(time) < 2 * _PARTS:
        return None
    bends, sizes = np.zeros(_PARTS), np.zeros(_PARTS)
    for k, rows in enumerate(np.array_split(np.arange(len(time)), _PARTS)):
        bends[k] = np.linalg.norm(above[:, rows] + below[:, rows] - 2.0 * here[:, rows])
        sizes[k] = np.linalg.norm(above[:, rows] - below[:, rows])
    floor = _ROUND_OFF * np.linalg.norm(here)  # differences of next to nothing are bent by round-off
    bent = (reach * bends > _BENT * sizes) & (sizes > floor)
    # Where it begins for good: a single part of nothing but crossings is none.
    first = next((k for k in range(_PARTS) if bent[k] and bent[k:].mean() > _BENT), None)
    if first is None or not sizes[first] > 0.0:
        return None
    middles = np.array([one.mean() for one in np.array_split(time, _PARTS)])
    grown = np.flatnonzero(sizes[: first + 1] > 0.0)
    since = float(middles[first] - time[0])
    fold = since / _AT_LEAST
    if len(grown) > 2:
        rate = float(np.polyfit(middles[grown], np.log(sizes[grown]), 1)[0])
        if not rate > 0.0:
            return None
        fold = min(fold, 1.0 / rate)
    return Growth(float(middles[first]), fold) if fold > 0.0 else None


# By what joints of pieces count more in the next search, and at most in the first: one that is open by a
# hundredth of an error scale is as a row that is off by its noise; and the relative change of the sum below
# which those before the last have ended.
_TIGHTER, _ROUGHLY = 100.0, 1e-2

# How many steps of differences a start may be off by where the end is a bad one.
_REACH = 100.0

# By what bands are too narrow from which on that is said.
_NARROW = 1.5

# How SciPy's search has ended, by its status.
_ENDS = {
    0: "given up: more evaluations than most allows; start nearer, or allow more",
    1: "the gradient is next to none",
    2: "the sum of squares falls no more",
    3: "the parameters move no more",
    4: "neither the sum of squares nor the parameters move any more",
}


@takes()
def run_fit(
    plan: FitPlan,
    out: str | os.PathLike[str] | None = None,
    *,
    executor: Executor | None = None,
    progress: Callable[[int], None] | None = None,
    then: Callable[[Fit], None] | None = None,
) -> Fit:
    """Find the values of a fit's parameters for which its runs are nearest to its records.

    With ``out`` the result is written there. What runs come to is kept beside it, in the folder
    ``OUT.parts``, until it is; a fit that is interrupted or killed goes on with the same call, bit for bit.

    Args:
        plan: The fit's file.
        out: File of the result, NAME.nc.
        executor: Who makes the runs: this process if left out, or a :class:`antenna_pin.sweep.Cluster`.
        progress: Called after each run with how many there are.
        then: Called with the fit once it is saved, while its runs are still kept: what it asks for, such as
            profiles, is kept with them, and goes on likewise.

    Raises:
        AntennaPinError: Something of plan, records or scenarios is not valid: raised before any run.
        NoRunError: There is no run for the values of the start.
        MissingToolError: lmfit is not installed.
        KeyboardInterrupt: It was interrupted; what was made is kept with ``out``.
    """
    try:
        importlib.import_module("lmfit")
    except ImportError:
        raise MissingToolError("a fit needs lmfit; install it with pip install 'antenna-pin[fit]'") from None
    target = None if out is None else check_writable(out, ".nc")
    if target is not None:
        plan.check_output(target)
    notebook = None if target is None else Notebook(target)
    try:
        validation = Validation(plan, executor)
        problem = Problem(plan, Laboratory(executor, notebook, progress))
        found = _found(problem)
        found = dataclasses.replace(found, validation=validation.at(found.names, found.values))
        if target is not None:
            found.save(target)
        if then is not None:
            then(found)
    finally:
        if notebook is not None:
            notebook.close()
    if notebook is not None:
        notebook.remove()
    return found


def _found(problem: Problem) -> Fit:
    """Search from all starts, and tell of the best end."""
    if problem.plan.surface is not None:
        return on_surface(problem, problem.plan.surface)
    unknowns = problem.unknowns
    first = np.concatenate([problem.first, problem.states])
    problem.residuals_at([first])  # there must be a run to begin with
    ends = []
    for start in _starts(problem, first):
        try:
            ends.append((start, _searched(problem, start)))
        except NoRunError:
            if start is first:
                raise
            ends.append((start, None))
    order = sorted(range(len(ends)), key=lambda k: math.inf if ends[k][1] is None else ends[k][1].cost)
    best = ends[order[0]][1]
    p = unknowns.count
    whole = unknowns.natural(best.x)
    problem.states = whole[p:]
    residuals = problem.residuals_at([whole])[0]
    slopes = problem.slopes(best.x)
    searches = []
    for k in order:
        start, end = ends[k]
        values = np.full(p, math.nan) if end is None else unknowns.natural(end.x)[:p]
        searches.append(Search(start[:p], values, math.nan if end is None else float(end.cost)))
    bands = bands_of(problem.plan, unknowns, whole, residuals, slopes, problem.rows.curve_numbers())
    bad = best.status <= 0 or bands.chi2 > WITHHELD * bands.freedoms
    # Where a search from many starts comes first, what is not straight from afar may be a valley's side.
    grown = _grown(problem, first, whole, bad and not advises_starts(problem, bands))
    return Fit(
        problem=problem,
        values=whole[:p],
        states=whole[p:],
        bands=bands,
        residuals=residuals,
        slopes=(slopes * unknowns.rates(whole))[:, :p],
        converged=best.status > 0,
        message=_ENDS.get(int(best.status), str(best.message)),
        evaluations=int(sum(end.nfev for _, end in ends if end is not None)),
        searches=tuple(searches),
        verdict=verdict_of(problem, whole, bands),
        notes=(
            *problem.notes,
            *problem.failed(),
            *problem.unbalanced(whole),
            *grown,
            *_together(problem, bands, residuals),
            *_of_derivatives(problem),
        ),
    )


def _of_derivatives(problem: Problem) -> list[str]:
    """Return by what derivatives were found, where that was asked for."""
    asked = problem.plan.jacobian == "equation"
    return [f"derivatives by {problem.derived.words()}"] if asked else []


def _together(problem: Problem, bands: Bands, residuals: Array) -> list[str]:
    """Return a line where residuals are no white noise, so that bands are too narrow."""
    every = problem.rows.by_curve(residuals)
    curves = [name for name, one in every.items() if hang_together(one)]
    others = [] if bands.beyond_chance else list(notes_on_residuals(every))
    if not curves or bands.wider < _NARROW:
        return others
    return [
        *others,
        f"note: residuals of {', '.join(curves)} hang together in time: bands are up to "
        f'{number(bands.wider, 2)} times too narrow (noise = "correlated" counts it); the model lacks '
        "something, or the noise is not white",
    ]


def _grown(problem: Problem, first: Array, last: Array, bad: bool) -> list[str]:
    """Return a line for each record that one run does not hold.

    By neighbours that a search has anyway, at its start and its end; of one that has come to no good end also
    by how far its start may be off.
    """
    found: dict[str, str] = {}
    for reach in (1.0, _REACH) if bad else (1.0,):
        for whole in (first, last):
            for record, words in _grown_at(problem, whole, reach).items():
                found.setdefault(record, words)
    return list(found.values())


def _grown_at(problem: Problem, whole: Array, reach: float) -> dict[str, str]:
    """Return the same by record, from neighbours of these values with states."""
    plan, unknowns, found = problem.plan, problem.unknowns, dict[str, tuple[Growth, str]]()
    searched, (lower, upper) = unknowns.searched(whole), unknowns.bounds()
    here = problem.curves(whole)
    for k, name in enumerate(unknowns.names) if here else ():
        ends = [searched.copy(), searched.copy()]
        for end, sign in zip(ends, (-1.0, 1.0), strict=True):
            end[k] += sign * plan.difference_step
        if not (lower[k] <= ends[0][k] and ends[1][k] <= upper[k]):
            continue
        try:
            sides = [problem.curves(unknowns.natural(end)) for end in ends]
        except NoRunError:
            continue
        for record, (time, rows) in here.items():
            one = growth_of(time, sides[0][record][1], rows, sides[1][record][1], reach)
            if one is not None and (record not in found or one.since < found[record][0].since):
                found[record] = one, name
    step = reach * plan.difference_step
    return {record: one.words(record, name, step) for record, (one, name) in found.items()}


def _searched(problem: Problem, start: Array) -> Any:
    """Return what SciPy's search from values with states comes to.

    Pieces that are tied to one motion from the beginning leave it nothing but that motion's valleys, along
    which it creeps. So each first finds its own way to the record, next to free; then joints count more and
    more.
    """
    from scipy.optimize import least_squares

    plan, unknowns = problem.plan, problem.unknowns

    def residuals(searched: Array) -> Array:
        try:
            return problem.residuals_at([unknowns.natural(searched)])[0]
        except NoRunError:  # the search goes on with a shorter step
            return np.full(problem.count, math.nan)

    problem.residuals_at([start])
    at, evaluations = unknowns.searched(start), 0
    for tie in _ties(plan):
        problem.rows.tie = tie
        found = least_squares(
            residuals,
            at,
            jac=problem.slopes,
            bounds=unknowns.bounds(),
            loss=plan.loss,
            f_scale=plan.loss_scale,
            ftol=plan.tolerance if tie == 1.0 else max(plan.tolerance, _ROUGHLY),
            xtol=plan.tolerance,
            gtol=plan.tolerance,
            max_nfev=plan.most,
        )
        at, evaluations = found.x, evaluations + int(found.nfev)
    found.nfev = evaluations
    return found


def _ties(plan: FitPlan) -> list[float]:
    """Return by what joints of pieces count in one search after the other, beside their weights."""
    most = max((one.pieces.weight for one in plan.records.values() if one.pieces), default=1.0)
    ties = [1.0]
    while ties[0] * most > _TIGHTER:
        ties.insert(0, ties[0] / _TIGHTER)
    return ties


def _starts(problem: Problem, first: Array) -> list[Array]:
    """Return from where to search: the start, and of points between the bounds the best."""
    plan, starts = problem.plan, problem.plan.starts
    if starts is None:
        return [first]
    from scipy.stats import qmc

    p = problem.unknowns.count
    lower, upper = (one[:p] for one in problem.unknowns.bounds())
    points = qmc.Sobol(p, scramble=True, rng=np.random.default_rng(starts.seed)).random(starts.count)
    rest = problem.unknowns.searched(first)[p:]
    wholes = [
        problem.unknowns.natural(np.concatenate([lower + point * (upper - lower), rest])) for point in points
    ]
    costs = [
        math.inf if found is None else 0.5 * cost(found, plan.loss, plan.loss_scale)
        for found in problem.tried(wholes)
    ]
    best = np.argsort(costs, kind="stable")[: starts.keep]
    return [first, *(wholes[int(k)] for k in best if math.isfinite(costs[int(k)]))]
