r"""The search where one run tells nothing of its neighbours: statistics of chaotic motions.

What a chaotic motion's statistics come to jumps with the smallest change of any number, as a record's would
from another start: its derivatives over a number are noise, and a search by them stays where it began. What
does follow the numbers is the mean. So runs are made at points of a box about a centre, and a surface of
second order is laid through each statistic r by least squares,

.. math:: r(u) = b + B u + u^T C u + \epsilon,

with u the way from the centre in half widths of the box (Box and Wilson 1951, J. R. Stat. Soc. B 13, 1-45).
What runs scatter about it by, :math:`S = \mathrm{cov}\,\epsilon`, is how records scatter as well, each of
which is one more such run at the true numbers: so S, with what statistics have in common, weighs them and
makes the bands (Wood 2010, Nature 466, 1102-1104). The box goes after the least of :math:`r^T S^{-1} r` and
becomes smaller.

S is of n runs less t terms, f = n - t, and of m statistics: its inverse is too large by f / (f - m - 1)
(Hartlap, Simon and Schneider 2007, Astron. Astrophys. 464, 399-404); what the surface itself is off by is a
share h, the leverage of its least, of S; and weights that are known from so few runs make p numbers less sure
by (m - p) / (f - m) (Dodelson and Schneider 2013, Phys. Rev. D 88, 063537).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.errors import InvalidParameterError
from antenna_pin.fit.covariance import bands_of
from antenna_pin.fit.plan import SurfaceSpec
from antenna_pin.fit.problem import Problem
from antenna_pin.fit.result import Fit, Search
from antenna_pin.fit.verdict import verdict_of

__all__ = ["Surface", "on_surface"]

Array = NDArray[np.float64]

# How many standard errors a half width of the last box is, to a factor; its least share of the one before;
# and where in a box the least is taken to be inside.
_ERRORS, _NEAR, _SHRINKS, _INSIDE = 3.0, 1.5, 0.4, 0.95


class Surface(NamedTuple):
    """Statistics over a box, by runs at points of it.

    Attributes:
        terms: Coefficients, (terms, m).
        scatter: Of one run about it, with what the sensors' noise adds, (m, m).
        inner: Inverse of the sum of squares of the terms over the points, (terms, terms).
        freedom: Runs less terms.
    """

    terms: Array
    scatter: Array
    inner: Array
    freedom: int

    @classmethod
    def through(cls, points: Array, found: Array, noise: Array) -> Surface:
        """Return the one through statistics at points.

        Args:
            points: In half widths of the box, (n, p).
            found: Statistics there, (n, m).
            noise: What sensors add to a statistic's variance, (m,).
        """
        table = np.array([_terms(one) for one in points])
        terms, *_ = np.linalg.lstsq(table, found, rcond=None)
        off, freedom = found - table @ terms, len(table) - table.shape[1]
        return cls(terms, off.T @ off / freedom + np.diag(noise), np.linalg.inv(table.T @ table), freedom)

    def at(self, u: Array) -> Array:
        """Return the mean of the statistics, (m,)."""
        return np.asarray(_terms(u) @ self.terms)

    def slopes(self, u: Array) -> Array:
        """Return their derivatives, (m, p): of second order as it is, differences are exact."""
        return np.column_stack([0.5 * (self.at(u + one) - self.at(u - one)) for one in np.eye(len(u))])

    def root(self, u: Array) -> Array:
        """Return what makes statistics at a point independent of one another, each of variance 1, (m, m)."""
        m, p, f = len(self.scatter), len(u), self.freedom
        leverage = float(_terms(u) @ self.inner @ _terms(u))
        factor = (f / (f - m - 1.0)) * (1.0 + leverage) * (1.0 + max(m - p, 0) / (f - m))
        return np.linalg.inv(np.linalg.cholesky(factor * self.scatter))

    def least(self, lower: Array, upper: Array) -> Array:
        """Return where within bounds the statistics are nearest to zero, (p,)."""
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
    """Return one, u and the products of two of them."""
    return np.concatenate([[1.0], u, np.outer(u, u)[np.triu_indices(len(u))]])


def count_of(p: int) -> int:
    """Return how many terms a surface over p numbers has."""
    return 1 + p + p * (p + 1) // 2


def on_surface(problem: Problem, spec: SurfaceSpec) -> Fit:
    """Return the fit of statistics by surfaces over boxes.

    Args:
        problem: Without pieces, all its columns statistics.
        spec: How many runs, over how wide a box.

    Raises:
        InvalidParameterError: There are too few runs for so many statistics.
    """
    from scipy.stats import qmc

    unknowns, plan = problem.unknowns, problem.plan
    p, m = unknowns.count, problem.count
    if spec.runs <= count_of(p) + 2 * m:
        rule = f"more than {count_of(p) + 2 * m}, for {m} statistics of {p} numbers"
        raise InvalidParameterError(f"fit {plan.name}", "surface.runs", rule, spec.runs)
    (lower, upper), noise = unknowns.bounds(), problem.rows.noise_of_statistics()
    centre, half = unknowns.searched(unknowns.start), np.full(p, spec.width)
    points, found, done = np.zeros((0, p)), np.zeros((0, m)), False
    for turn in range(spec.rounds):
        below, above = np.maximum(lower, centre - half), np.minimum(upper, centre + half)
        centre, half = 0.5 * (below + above), 0.5 * (above - below)
        new = qmc.Sobol(p, scramble=True, rng=np.random.default_rng([spec.seed, turn])).random(spec.runs)
        at = below + new * (above - below)
        made = problem.tried([unknowns.natural(one) for one in at])
        good = [k for k, one in enumerate(made) if one is not None]
        points = np.vstack([points, at[good]])
        found = np.vstack([found, *(made[k][np.newaxis] for k in good)])  # type: ignore[index]
        inside = np.all(np.abs(points - centre) <= half * (1.0 + 1e-9), axis=1)
        if inside.sum() <= count_of(p) + m + 2:
            rule = f"such that more than {count_of(p) + m + 2} runs come to their end"
            raise InvalidParameterError(f"fit {plan.name}", "surface", rule, int(inside.sum()))
        surface = Surface.through((points[inside] - centre) / half, found[inside], noise)
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
    whole = unknowns.natural(x)
    # Statistics are no curves: none goes on from another.
    bands = bands_of(plan, unknowns, whole, residuals, slopes, np.arange(m))
    cost = 0.5 * float(residuals @ residuals)
    words = "the least of its surface is within its box" if done else "given up: the least is at a box's edge"
    return Fit(
        problem=problem,
        values=whole,
        states=np.zeros(0),
        bands=bands,
        residuals=residuals,
        slopes=slopes * unknowns.rates(whole),
        converged=done,
        message=words,
        evaluations=len(points),
        searches=(Search(unknowns.start, whole, cost),),
        verdict=verdict_of(problem, whole, bands),
        notes=(
            *problem.notes,
            *problem.failed(),
            *problem.unbalanced(whole),
            *_odd(bands.chi2, bands.freedoms),
        ),
    )


def _errors(slopes: Array) -> Array:
    """Return standard errors, (p,); those of numbers that are not told are without bounds."""
    values, axes = np.linalg.eigh(slopes.T @ slopes)
    return np.asarray(np.sqrt((axes**2 / np.maximum(values, 1e-300)).sum(axis=1)))


def _odd(chi2: float, freedoms: int) -> Sequence[str]:
    from scipy.stats import chi2 as distribution

    if freedoms > 0 and math.isfinite(chi2) and distribution.sf(chi2, freedoms) < 1e-3:
        return (
            "note: the record's statistics are farther from the model's than runs are from one another: chi2 "
            f"{chi2:.3g} for {freedoms} degrees of freedom; the model lacks something",
        )
    return ()
