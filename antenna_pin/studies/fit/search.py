r"""Search of a fit: least squares from one or many starts, or response surfaces.

Statistics of a chaotic motion jump with the smallest change of any number, as a record's would from another
start: their derivatives are noise, and a search by them stays at its start. The mean does follow the numbers.
So runs are made at points of a box about a centre, and a surface of second order is fitted to each
statistic r by least squares,

.. math:: r(u) = b + B u + u^T C u + \epsilon,

with u the distance from the centre in half widths of the box (Box and Wilson 1951, J. R. Stat. Soc. B 13,
1-45). The scatter of runs about it, :math:`S = \mathrm{cov}\,\epsilon`, is that of records as well, each of
which is one more such run at the true numbers: so S, with the covariances of statistics, weighs them and
makes the bands (Wood 2010, Nature 466, 1102-1104). The box follows the least of :math:`r^T S^{-1} r` and
shrinks.

S is of n runs less t terms, f = n - t, and of m statistics: its inverse is too large by f / (f - m - 1)
(Hartlap, Simon and Schneider 2007, Astron. Astrophys. 464, 399-404); the error of the surface itself is a
share h, the leverage of its least, of S; and weights from so few runs make p numbers less certain by
(m - p) / (f - m) (Dodelson and Schneider 2013, Phys. Rev. D 88, 063537).
"""

from __future__ import annotations

import dataclasses
import importlib
import math
import os
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.files import check_writable
from antenna_pin.base.readable import number
from antenna_pin.errors import InvalidParameterError, MissingToolError
from antenna_pin.studies.fit.confidence_bands import WITHHELD, ParameterBands, parameter_bands
from antenna_pin.studies.fit.diagnostics import (
    DifferenceGrowth,
    difference_growth,
    recommends_starts,
    residual_notes,
    verdict,
)
from antenna_pin.studies.fit.plan import FitPlan, SurfaceSpec
from antenna_pin.studies.fit.problem import Problem
from antenna_pin.studies.fit.result import Fit, Search, Validation
from antenna_pin.studies.fit.run_service import RunService, RunStore
from antenna_pin.studies.fit.runs import NoRunError
from antenna_pin.studies.fit.uncertainty import cost, is_correlated
from antenna_pin.studies.sweep import Executor

# --- search by response surfaces ----------------------------------------------------------------------------

# Half width of the last box in standard errors, to a factor; least ratio of consecutive boxes; share of a box
# that counts as inside.
_ERRORS, _NEAR, _SHRINKS, _INSIDE = 3.0, 1.5, 0.4, 0.95


class ResponseSurface(NamedTuple):
    """Statistics over a box, by runs at points of it."""

    terms: Array  # coefficients, (terms, m)
    scatter: Array  # covariance of one run about the surface, with the sensors' noise, (m, m)
    inner: Array  # inverse of the terms' sum of squares over the points, (terms, terms)
    freedom: int  # runs less terms

    @classmethod
    def through(cls, points: Array, statistics: Array, noise: Array) -> ResponseSurface:
        """Return the surface through statistics (n, m) at points (n, p).

        The variances of the sensors' noise, (m,), add to the scatter.
        """
        table = np.array([_terms(one) for one in points])
        terms, *_ = np.linalg.lstsq(table, statistics, rcond=None)
        off, freedom = statistics - table @ terms, len(table) - table.shape[1]
        return cls(terms, off.T @ off / freedom + np.diag(noise), np.linalg.inv(table.T @ table), freedom)

    def at(self, u: Array) -> Array:
        """Return the mean of the statistics, (m,)."""
        return np.asarray(_terms(u) @ self.terms)

    def slopes(self, u: Array) -> Array:
        """Return the derivatives of the mean, (m, p), exact for second order."""
        return np.column_stack([0.5 * (self.at(u + one) - self.at(u - one)) for one in np.eye(len(u))])

    def root(self, u: Array) -> Array:
        """Return the whitening matrix of the statistics at a point, (m, m)."""
        m, p, f = len(self.scatter), len(u), self.freedom
        leverage = float(_terms(u) @ self.inner @ _terms(u))
        factor = (f / (f - m - 1.0)) * (1.0 + leverage) * (1.0 + max(m - p, 0) / (f - m))
        return np.linalg.inv(np.linalg.cholesky(factor * self.scatter))

    def least(self, lower: Array, upper: Array) -> Array:
        """Return the point within bounds nearest to zero statistics, (p,)."""
        from scipy.optimize import least_squares

        middle = 0.5 * (lower + upper)
        root = self.root(middle)

        def off(u: Array) -> Array:
            return np.asarray(root @ self.at(u))

        def slopes(u: Array) -> Array:
            return np.asarray(root @ self.slopes(u))

        made = [
            least_squares(off, start, jac=slopes, bounds=(lower, upper))
            for start in (middle, *(middle + 0.25 * sign * (upper - lower) for sign in (-1.0, 1.0)))
        ]
        return np.asarray(min(made, key=lambda one: float(one.cost)).x)


def _terms(u: Array) -> Array:
    """Return 1, u and the products of two elements of u."""
    return np.concatenate([[1.0], u, np.outer(u, u)[np.triu_indices(len(u))]])


def _term_count(p: int) -> int:
    """Return the number of terms of a surface over p numbers."""
    return 1 + p + p * (p + 1) // 2


def fit_by_surface(problem: Problem, spec: SurfaceSpec) -> Fit:
    """Return the fit of statistics by surfaces over boxes.

    Raises:
        InvalidParameterError: The runs are too few for so many statistics.
    """
    from scipy.stats import qmc

    unknowns, plan = problem.unknowns, problem.plan
    p, m = unknowns.count, problem.count
    if spec.runs <= _term_count(p) + 2 * m:
        rule = f"more than {_term_count(p) + 2 * m}, for {m} statistics of {p} numbers"
        raise InvalidParameterError(f"fit {plan.name}", "surface.runs", rule, spec.runs)
    (lower, upper), noise = unknowns.bounds(), problem.rows.noise_of_statistics()
    centre, half = unknowns.to_search(unknowns.start), np.full(p, spec.width)
    points, found, done = np.zeros((0, p)), np.zeros((0, m)), False
    for turn in range(spec.rounds):
        below, above = np.maximum(lower, centre - half), np.minimum(upper, centre + half)
        centre, half = 0.5 * (below + above), 0.5 * (above - below)
        new = qmc.Sobol(p, scramble=True, rng=np.random.default_rng([spec.seed, turn])).random(spec.runs)
        at = below + new * (above - below)
        made = problem.tried([unknowns.from_search(one) for one in at])
        good = [k for k, one in enumerate(made) if one is not None]
        points = np.vstack([points, at[good]])
        found = np.vstack([found, *(made[k][np.newaxis] for k in good)])  # type: ignore[index]
        inside = np.all(np.abs(points - centre) <= half * (1.0 + 1e-9), axis=1)
        if inside.sum() <= _term_count(p) + m + 2:
            rule = f"such that more than {_term_count(p) + m + 2} runs come to their end"
            raise InvalidParameterError(f"fit {plan.name}", "surface", rule, int(inside.sum()))
        surface = ResponseSurface.through((points[inside] - centre) / half, found[inside], noise)
        u = surface.least(-np.ones(p), np.ones(p))
        residuals, slopes = surface.root(u) @ surface.at(u), surface.root(u) @ surface.slopes(u) / half
        x, error = centre + half * u, _errors(slopes)
        at_bound = (x <= lower) | (x >= upper)
        done = bool(np.all((np.abs(u) <= _INSIDE) | at_bound))
        if done and np.all(half <= _NEAR * np.maximum(_ERRORS * error, 1e-12)):
            break
        if turn + 1 < spec.rounds:
            centre = x
            if done:
                half = np.clip(_ERRORS * error, _SHRINKS * half, half)
    whole = unknowns.from_search(x)
    # Statistics are no curves: none continues another.
    bands = parameter_bands(plan, unknowns, whole, residuals, slopes, np.arange(m))
    cost = 0.5 * float(residuals @ residuals)
    words = (
        "the least of its surface is within its box"
        if done
        else "aborted: the minimum is at the edge of the box"
    )
    return Fit(
        problem=problem,
        values=whole,
        states=np.zeros(0),
        bands=bands,
        residuals=residuals,
        slopes=slopes * unknowns.search_slopes(whole),
        converged=done,
        message=words,
        evaluations=len(points),
        searches=(Search(unknowns.start, whole, cost),),
        verdict=verdict(problem, whole, bands),
        notes=(
            *problem.notes,
            *problem.failed(),
            *problem.unbalanced(whole),
            *_chance_note(bands.chi2, bands.freedoms),
        ),
    )


def _errors(slopes: Array) -> Array:
    """Return standard errors, (p,), very large for unidentified numbers."""
    values, axes = np.linalg.eigh(slopes.T @ slopes)
    return np.asarray(np.sqrt((axes**2 / np.maximum(values, 1e-300)).sum(axis=1)))


def _chance_note(chi2: float, freedoms: int) -> Sequence[str]:
    from scipy.stats import chi2 as distribution

    if freedoms > 0 and math.isfinite(chi2) and distribution.sf(chi2, freedoms) < 1e-3:
        return (
            "note: the record's statistics are farther from the model's than runs are from one another: chi2 "
            f"{chi2:.3g} for {freedoms} degrees of freedom; the model lacks something",
        )
    return ()


# --- search by least squares --------------------------------------------------------------------------------

# Ratio of joint weights of consecutive searches, and most of the first: a gap of a hundredth of an error
# scale counts as a row off by its noise; and relative change of the sum at the end of all but the last.
_TIGHTER, _ROUGHLY = 100.0, 1e-2

# Difference steps that a start may be off by where the search ended badly.
_REACH = 100.0

# Ratio of widths from which narrow bands are reported.
_NARROW = 1.5

# Ends of SciPy's search, by its status.
_ENDS = {
    0: "aborted: more evaluations than most allows; start nearer, or raise most",
    1: "the gradient is next to none",
    2: "the sum of squares falls no more",
    3: "the parameters move no more",
    4: "sum of squares and parameters have converged",
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
    """Find the values of a fit's parameters that bring its runs nearest to its records.

    With ``out`` the result is written there. Until then all runs are stored beside it, in the folder
    ``OUT.parts``; an interrupted or killed fit continues with the same call, bit for bit.

    Args:
        plan: The fit's file.
        out: File of the result, NAME.nc.
        executor: Executor of the runs: this process by default, or a
            :class:`antenna_pin.studies.sweep.Cluster`.
        progress: Called with the number of runs after each run.
        then: Called with the saved fit while its runs are still stored: further runs, such as those of
            profiles, are stored with them, and continue likewise.

    Raises:
        AntennaPinError: Plan, records or scenarios are not valid; raised before any run.
        NoRunError: The start values have no run.
        MissingToolError: lmfit is not installed.
        KeyboardInterrupt: The fit was interrupted; with ``out`` its runs are stored.
    """
    try:
        importlib.import_module("lmfit")
    except ImportError:
        raise MissingToolError("a fit needs lmfit; install it with pip install 'antenna-pin[fit]'") from None
    target = None if out is None else check_writable(out, ".nc")
    if target is not None:
        plan.check_output(target)
    store = None if target is None else RunStore(target)
    try:
        validation = Validation(plan, executor)
        problem = Problem(plan, RunService(executor, store, progress))
        found = _search(problem)
        found = dataclasses.replace(found, validation=validation.at(found.names, found.values))
        if target is not None:
            found.save(target)
        if then is not None:
            then(found)
    finally:
        if store is not None:
            store.close()
    if store is not None:
        store.remove()
    return found


def _search(problem: Problem) -> Fit:
    """Return the fit with the best end of all searches."""
    if problem.plan.surface is not None:
        return fit_by_surface(problem, problem.plan.surface)
    unknowns = problem.unknowns
    first = np.concatenate([problem.first, problem.states])
    problem.residuals_at([first])  # there must be a run to begin with
    ends = []
    for start in _starts(problem, first):
        try:
            ends.append((start, _least_squares(problem, start)))
        except NoRunError:
            if start is first:
                raise
            ends.append((start, None))
    order = sorted(range(len(ends)), key=lambda k: math.inf if ends[k][1] is None else ends[k][1].cost)
    best = ends[order[0]][1]
    p = unknowns.count
    whole = unknowns.from_search(best.x)
    problem.states = whole[p:]
    residuals = problem.residuals_at([whole])[0]
    slopes = problem.slopes(best.x)
    searches = []
    for k in order:
        start, end = ends[k]
        values = np.full(p, math.nan) if end is None else unknowns.from_search(end.x)[:p]
        searches.append(Search(start[:p], values, math.nan if end is None else float(end.cost)))
    bands = parameter_bands(problem.plan, unknowns, whole, residuals, slopes, problem.rows.curve_numbers())
    bad = best.status <= 0 or bands.chi2 > WITHHELD * bands.freedoms
    # Before a search from many starts, nonlinearity far away may be another valley.
    grown = _growth_notes(problem, first, whole, bad and not recommends_starts(problem, bands))
    return Fit(
        problem=problem,
        values=whole[:p],
        states=whole[p:],
        bands=bands,
        residuals=residuals,
        slopes=(slopes * unknowns.search_slopes(whole))[:, :p],
        converged=best.status > 0,
        message=_ENDS.get(int(best.status), str(best.message)),
        evaluations=int(sum(end.nfev for _, end in ends if end is not None)),
        searches=tuple(searches),
        verdict=verdict(problem, whole, bands),
        notes=(
            *problem.notes,
            *problem.failed(),
            *problem.unbalanced(whole),
            *grown,
            *_correlation_notes(problem, bands, residuals),
            *([f"derivatives by {problem.derived.words()}"] if problem.plan.jacobian == "equation" else []),
        ),
    )


def _correlation_notes(problem: Problem, bands: ParameterBands, residuals: Array) -> list[str]:
    """Return notes on residuals that are no white noise, so that bands are too narrow."""
    every = problem.rows.by_curve(residuals)
    curves = [name for name, one in every.items() if is_correlated(one)]
    others = [] if bands.beyond_chance else list(residual_notes(every))
    if not curves or bands.widening < _NARROW:
        return others
    return [
        *others,
        f"note: residuals of {', '.join(curves)} hang together in time: bands are up to "
        f'{number(bands.widening, 2)} times too narrow (noise = "correlated" counts it); the model lacks '
        "something, or the noise is not white",
    ]


def _growth_notes(problem: Problem, start: Array, end: Array, bad: bool) -> list[str]:
    """Return a note for each record too long for one run.

    Perturbed runs at the start and the end of the search decide, which the search has anyway; after a bad end
    also with a larger error of the start.
    """
    found: dict[str, str] = {}
    for reach in (1.0, _REACH) if bad else (1.0,):
        for whole in (start, end):
            for record, words in _growth_at(problem, whole, reach).items():
                found.setdefault(record, words)
    return list(found.values())


def _growth_at(problem: Problem, whole: Array, reach: float) -> dict[str, str]:
    """Return the same by record, from perturbed runs at values with states."""
    plan, unknowns, found = problem.plan, problem.unknowns, dict[str, tuple[DifferenceGrowth, str]]()
    searched, (lower, upper) = unknowns.to_search(whole), unknowns.bounds()
    here = problem.curves(whole)
    for k, name in enumerate(unknowns.names) if here else ():
        ends = [searched.copy(), searched.copy()]
        for end, sign in zip(ends, (-1.0, 1.0), strict=True):
            end[k] += sign * plan.difference_step
        if not (lower[k] <= ends[0][k] and ends[1][k] <= upper[k]):
            continue
        try:
            sides = [problem.curves(unknowns.from_search(end)) for end in ends]
        except NoRunError:
            continue
        for record, (time, rows) in here.items():
            one = difference_growth(time, sides[0][record][1], rows, sides[1][record][1], reach)
            if one is not None and (record not in found or one.since < found[record][0].since):
                found[record] = one, name
    step = reach * plan.difference_step
    return {record: one.words(record, name, step) for record, (one, name) in found.items()}


def _least_squares(problem: Problem, start: Array) -> Any:
    """Return the result of SciPy's search from values with states.

    Pieces tied to one motion from the beginning have no valleys but those of that motion, along which a
    search creeps. So the joints' weights rise from search to search.
    """
    from scipy.optimize import least_squares

    plan, unknowns = problem.plan, problem.unknowns

    def residuals(coordinates: Array) -> Array:
        try:
            return problem.residuals_at([unknowns.from_search(coordinates)])[0]
        except NoRunError:  # the search goes on with a shorter step
            return np.full(problem.count, math.nan)

    problem.residuals_at([start])
    at, evaluations = unknowns.to_search(start), 0
    for tie in _tie_weights(plan):
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


def _tie_weights(plan: FitPlan) -> list[float]:
    """Return the weights of joints in consecutive searches, beside the plan's."""
    most = max((one.pieces.weight for one in plan.records.values() if one.pieces), default=1.0)
    ties = [1.0]
    while ties[0] * most > _TIGHTER:
        ties.insert(0, ties[0] / _TIGHTER)
    return ties


def _starts(problem: Problem, origin: Array) -> list[Array]:
    """Return the starts of searches: the given one, and the best sampled points."""
    plan, starts = problem.plan, problem.plan.starts
    if starts is None:
        return [origin]
    from scipy.stats import qmc

    p = problem.unknowns.count
    lower, upper = (one[:p] for one in problem.unknowns.bounds())
    points = qmc.Sobol(p, scramble=True, rng=np.random.default_rng(starts.seed)).random(starts.count)
    rest = problem.unknowns.to_search(origin)[p:]
    wholes = [
        problem.unknowns.from_search(np.concatenate([lower + point * (upper - lower), rest]))
        for point in points
    ]
    costs = [
        math.inf if found is None else 0.5 * cost(found, plan.loss, plan.loss_scale)
        for found in problem.tried(wholes)
    ]
    best = np.argsort(costs, kind="stable")[: starts.keep]
    return [origin, *(wholes[int(k)] for k in best if math.isfinite(costs[int(k)]))]
