"""Identifiability of parameters before a fit, and optimal design of the next experiment.

The information of a record on the parameters is :math:`F = J^T J`, J being the derivatives of its residuals
in units of the noise; information of independent records adds up, and the inverse of the sum is the expected
covariance. So the worth of an experiment is known before it is made. The criterion is a choice:

======  ==================================================================================
``D``   its determinant: the volume of the region in which all parameters lie
``c``   the variance of one parameter, or of one combination of them
``A``   the sum of the variances, each over its parameter's scale squared
``E``   the longest axis of that region, in scales
======  ==================================================================================

All of them hold for a model that is linear about the present values: better values give another design.

References:
    Fedorov (1972), Theory of Optimal Experiments; Silvey (1980), Optimal Design.
    Kiefer and Wolfowitz (1960), Canadian J. Math. 12, 363-366: the equivalence theorem.
    Yu (2010), Ann. Statist. 38(3), 1593-1606: convergence of the multiplication of weights.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.readable import number
from antenna_pin.base.rules import AtLeastOne, BetweenZeroAndOne
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.studies.fit.uncertainty import DOUBT, Rank, Residuals, rank_of, student_quantile

# --- identifiability ----------------------------------------------------------------------------------------

# Least share of a parameter in a direction, over the largest, in its text.
_SAID = 0.02

#: Width of an interval, over the size of the value, from which it hardly informs [-].
_POOR = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Identifiable:
    """Identifiability of parameters from a record, at given values."""

    names: tuple[str, ...]  # names of the parameters
    values: Array  # values, (p,)
    scale: Array  # typical sizes, (p,)
    rank: Rank  # rank of the Jacobian
    error: Array  # expected standard errors by the stated noise, (p,); infinite if unidentifiable
    half: Array  # half widths of the expected intervals, (p,)
    alone: Array  # expected standard errors with all others known, (p,)
    inflation: Array  # ratio of both errors, (p,) [-]
    level: float  # confidence level of the intervals [-]
    quantile: float  # half widths over errors [-]
    # singular values of the Jacobian over the scales, falling, (p,) [-]: the inverse of a value is the
    # standard error along its direction, in scales
    singular: Array
    directions: Array  # those directions, a row each, (p, p), of length 1 in scales
    together: tuple[str, ...]  # unidentifiable parameters and combinations as text
    hold: tuple[str, ...]  # parameters to hold, one of each combination, so that the others are identifiable

    @property
    def poor(self) -> tuple[str, ...]:
        """Names of identifiable parameters with intervals wider than their own size."""
        wide = np.isfinite(self.half) & (self.half > _POOR * self.scale)
        return tuple(name for name, one in zip(self.names, wide, strict=True) if one)


@takes()
def identifiable(
    problem: Residuals, values: Array | None = None, *, level: BetweenZeroAndOne = 0.95, doubt: float = DOUBT
) -> Identifiable:
    """Return the identifiability of parameters from one Jacobian, without a fit.

    Args:
        problem: Problem of the fit.
        values: Values of the parameters, (p,); the start by default.
        level: Confidence level of the intervals [-].
        doubt: Relative error of the Jacobian's columns [-].
    """
    at = np.asarray(problem.start if values is None else values, dtype=float)
    scale, names = np.asarray(problem.scale, dtype=float), tuple(problem.names)
    jacobian = problem.jacobian(at)
    rank = rank_of(jacobian, scale, doubt)
    _, error = _standard_errors(rank, scale)
    with np.errstate(divide="ignore", invalid="ignore"):
        alone = np.where(rank.influential, scale / rank.lengths, math.inf)
        inflation = np.where(rank.influential, error / alone, math.nan)
    reach = student_quantile(level, math.inf)
    _, singular, directions = np.linalg.svd(jacobian * scale, full_matrices=len(jacobian) < len(scale))
    singular = np.concatenate([singular, np.zeros(len(scale) - len(singular))])
    return Identifiable(
        names,
        at,
        scale,
        rank,
        error,
        reach * error,
        alone,
        inflation,
        level,
        reach,
        singular,
        directions,
        tuple(_direction_text(row, names, scale, at) for row in rank.null),
        tuple(names[int(np.abs(row).argmax())] for row in rank.null),
    )


def _standard_errors(rank: Rank, scale: Array) -> tuple[Array, Array]:
    """Return the root of the covariance in scales, (p, rank), and standard errors, (p,)."""
    root = rank.identified.T / rank.singular[: len(rank.identified)]
    return root, np.where(rank.determined, np.linalg.norm(root, axis=1) * scale, math.inf)


def _direction_text(row: Array, names: tuple[str, ...], scale: Array, values: Array) -> str:
    """Return a direction that leaves the record unchanged, as text."""
    size = np.abs(row)
    places = [int(k) for k in np.argsort(-size, kind="stable") if size[k] > _SAID * size.max()]
    if len(places) == 1:
        return f"{names[places[0]]}: not at all: the record does not change with it"
    shares = [row[k] * scale[k] / abs(values[k]) if values[k] else row[k] for k in places]
    moves = ", ".join(
        f"{names[k]} by {number(share / shares[0], 2)} %{'' if values[k] else ' of its scale'}"
        for k, share in zip(places, shares, strict=True)
    )
    together = f"{', '.join(names[k] for k in places[:-1])} and {names[places[-1]]}"
    return f"{together}: only in combination: the record does not change when they change, {moves}"


# --- optimal design of experiments --------------------------------------------------------------------------

Criterion = Literal["D", "c", "A", "E"]
"""What is to be small: volume, one variance, the sum of variances, the longest axis."""

_CRITERIA: tuple[Criterion, ...] = get_args(Criterion)

#: Most rounds of multiplication, and relative gap to the bound at convergence.
_ROUNDS, _NEAR = 20_000, 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Design:
    """Comparison of experiments, each added to the known records."""

    names: tuple[str, ...]  # names of the parameters
    scale: Array  # their typical sizes, (p,)
    experiments: tuple[str, ...]  # names of the experiments, the best first
    half: Array  # half widths of the expected intervals after each, (e, p); infinite if unidentifiable
    before: Array  # half widths before any of them, (p,)
    # by name the square root of each criterion after each, as a length in scales, (e,): of D the p-th root of
    # the volume, so that all are widths that halve where noise halves
    criteria: Mapping[Criterion, Array]
    chosen: Criterion  # criterion of the order
    wanted: str  # parameter of ``c``; "" for all of ``D``, ``A`` and ``E``
    level: float  # confidence level of the intervals [-]


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """Optimal number of repetitions of each experiment."""

    experiments: tuple[str, ...]  # names, as given
    weights: Array  # shares of the total, (e,) [-]; their sum is 1
    counts: NDArray[np.intp]  # whole numbers of repetitions, (e,)
    # bound of the equivalence theorem on the improvement by the best design, as a share of the criterion [-]
    gap: float


@takes()
def design(
    jacobians: Mapping[str, Array],
    names: Sequence[str],
    scale: Array,
    *,
    known: Array | None = None,
    criterion: Criterion = "D",
    wanted: str | None = None,
    level: float = 0.95,
    doubt: float = DOUBT,
) -> Design:
    """Return experiments in order of their information, added to the known records.

    Args:
        jacobians: Derivatives of each experiment's residuals, in units of the noise, by its name, (m, p)
            each.
        names: Names of the parameters.
        scale: Their typical sizes, (p,).
        known: Derivatives of the residuals of the present records, (m, p); none by default.
        criterion: Criterion to minimise.
        wanted: Parameter of ``c``.
        level: Confidence level of the intervals [-].
        doubt: Relative error of the Jacobians' columns [-].

    Raises:
        InvalidParameterError: No experiment is given, or ``c`` without a parameter.
        UnknownNameError: The parameter is unknown.
    """
    known_rows = np.zeros((1, len(scale))) if known is None else known
    place = _parameter_place(criterion, wanted, names, jacobians)
    reach = student_quantile(level, math.inf)
    before, _ = _expected_errors(known_rows, scale, place, doubt)
    found = {
        name: _expected_errors(np.vstack([known_rows, rows]), scale, place, doubt)
        for name, rows in jacobians.items()
    }
    order = sorted(found, key=lambda name: (found[name][1][criterion], float(np.sum(found[name][0] / scale))))
    criteria: dict[Criterion, Array] = {
        one: np.array([found[name][1][one] for name in order])
        for one in _CRITERIA
        if one in found[order[0]][1]
    }
    return Design(
        tuple(names),
        np.asarray(scale, dtype=float),
        tuple(order),
        reach * np.stack([found[name][0] for name in order]),
        reach * before,
        criteria,
        criterion,
        "" if wanted is None else wanted,
        level,
    )


def _parameter_place(
    criterion: Criterion, wanted: str | None, names: Sequence[str], jacobians: Mapping[str, Array]
) -> int | None:
    """Return the index of the wanted parameter, or None; refuse no experiment."""
    if not jacobians:
        raise InvalidParameterError("fit", "experiments", "one or more", said="none")
    if criterion not in _CRITERIA:
        raise UnknownNameError("fit", "criterion", criterion, _CRITERIA)
    if wanted is None:
        if criterion == "c":
            raise InvalidParameterError("fit", "wanted", "the parameter that c is of", said="none")
        return None
    if wanted not in names:
        raise UnknownNameError("fit", "parameter", wanted, names)
    return list(names).index(wanted)


def _expected_errors(
    rows: Array, scale: Array, place: int | None, doubt: float
) -> tuple[Array, dict[Criterion, float]]:
    """Return expected standard errors, (p,), and every criterion's length in scales."""
    error = np.full(len(scale), math.inf)
    worth: dict[Criterion, float] = {"D": math.inf, "A": math.inf, "E": math.inf}
    if np.any(rows):
        rank = rank_of(rows, scale, doubt)
        root, error = _standard_errors(rank, scale)
        if rank.full:
            axes = np.linalg.svd(root, compute_uv=False)
            worth["D"] = float(np.exp(np.log(axes).mean()))
            worth["A"] = float(np.linalg.norm(axes))
            worth["E"] = float(axes[0])
    if place is not None:
        worth["c"] = float(error[place] / scale[place])
    return error, worth


@takes()
def planned(
    jacobians: Mapping[str, Array],
    names: Sequence[str],
    scale: Array,
    total: AtLeastOne,
    *,
    known: Array | None = None,
    criterion: Literal["D", "c", "A"] = "D",
    wanted: str | None = None,
) -> Plan:
    r"""Return the optimal repetitions of experiments for a total number.

    Weights are multiplied by :math:`(\mathrm{tr}(C F_k) / \mathrm{mean})^{1/2}`, with C the slope of the
    criterion in the information, until no experiment has more than the mean; whole numbers are the nearest
    ones of least criterion, by exchange of one at a time.

    Args:
        jacobians: Derivatives of each experiment's residuals, by its name, (m, p) each.
        names: Names of the parameters.
        scale: Their typical sizes, (p,).
        total: Total number of experiments.
        known: Derivatives of the residuals of the present records; none by default.
        criterion: Criterion to minimise.
        wanted: Parameter of ``c``.

    Raises:
        InvalidParameterError: All experiments together do not identify every parameter.
    """
    place = _parameter_place(criterion, wanted, names, jacobians)
    parts = np.stack([(rows * scale).T @ (rows * scale) for rows in jacobians.values()])
    have = np.zeros_like(parts[0]) if known is None else (known * scale).T @ (known * scale)
    every = np.vstack([*jacobians.values(), *(() if known is None else (known,))])
    rank = rank_of(every, scale)
    if not rank.full:
        lacking = ", ".join(name for name, one in zip(names, rank.determined, strict=True) if not one)
        raise InvalidParameterError(
            "fit",
            "experiments",
            "such that all of them together determine every parameter; hold those that they do not determine",
            said=f"none that determines {lacking}",
        )
    # Scaled by column lengths, so that the information can be inverted.
    weight = np.outer(rank.lengths, rank.lengths)
    parts, have, size = parts / weight, have / weight, 1.0 / rank.lengths
    costs = None if criterion == "D" else size**2
    if criterion == "c":
        costs = np.where(np.arange(len(size)) == place, size**2, 0.0)
    weights, gap = _weights(parts, have, total, costs)
    return Plan(tuple(jacobians), weights, _whole_counts(weights, parts, have, total, costs), gap)


def _loss(inverse: Array, costs: Array | None) -> float:
    """Return the criterion of a covariance: costs of variances, (p,), or, if None, D's logarithm."""
    if costs is not None:
        return float(np.diag(inverse) @ costs)
    sign, value = np.linalg.slogdet(inverse)
    return float(value) if sign > 0.0 else math.inf


def _weights(parts: Array, have: Array, total: int, costs: Array | None) -> tuple[Array, float]:
    weights = np.full(len(parts), 1.0 / len(parts))
    gap = math.inf
    for _ in range(_ROUNDS):
        inverse = np.linalg.inv(have + total * np.einsum("k,kij->ij", weights, parts))
        slope = inverse if costs is None else inverse @ np.diag(costs) @ inverse
        gains = total * np.einsum("ij,kji->k", slope, parts)
        mean = float(weights @ gains)
        # The convex criterion lies above its tangent, which bounds its decrease.
        gap = (float(gains.max()) - mean) / (len(have) if costs is None else _loss(inverse, costs))
        if gap <= _NEAR or not mean > 0.0:
            break
        weights = weights * np.sqrt(gains / mean)
        weights /= weights.sum()
    return weights, gap


def _whole_counts(
    weights: Array, parts: Array, have: Array, total: int, costs: Array | None
) -> NDArray[np.intp]:
    """Return whole counts near weights, exchanged while the criterion falls."""
    counts = np.floor(total * weights + 1e-9).astype(np.intp)
    rest = np.argsort(-(total * weights - counts), kind="stable")
    counts[rest[: total - int(counts.sum())]] += 1

    def loss(one: NDArray[np.intp]) -> float:
        whole = have + np.einsum("k,kij->ij", one.astype(float), parts)
        if not np.linalg.eigvalsh(whole)[0] > 1e-14 * np.trace(whole):
            return math.inf
        return _loss(np.linalg.inv(whole), costs)

    best = loss(counts)
    while True:
        tried = []
        for out in np.flatnonzero(counts):
            for into in range(len(counts)):
                if into != out:
                    other = counts.copy()
                    other[out] -= 1
                    other[into] += 1
                    tried.append((loss(other), other))
        value, other = min(tried, key=lambda one: one[0], default=(math.inf, counts))
        if not value < best - 1e-12 * max(abs(best), 1.0):
            return counts
        best, counts = value, other
