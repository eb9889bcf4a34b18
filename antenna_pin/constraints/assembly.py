"""Velocities that satisfy the constraints, found from some that need not; and how freely a state can move."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from antenna_pin.constraints.factor_kernels import DEPENDENT, NOTHING
from antenna_pin.constraints.search import ASSEMBLED, Unclosed, row_names, worst
from antenna_pin.constraints.solver import Constraints

__all__ = [
    "Mobility",
    "Redundancy",
    "directions",
    "find_velocity",
    "least_row",
    "mobility",
    "redundancies",
]

Array = NDArray[np.float64]

# Residual of an equation that is round-off, as a share of the fastest rate.
_SILENT = 1e-14


def least_row(constraints: Constraints) -> str:
    """Return of which row the least was left when rows were last factorized, in words: a closure's first."""
    names, plan = row_names(constraints), constraints.plan
    singles = len(plan.motions) + len(plan.couplings)
    rows = range(singles if plan.closures else len(plan.motions) if plan.couplings else 0, constraints.rows)
    shares = np.where(constraints.shares > 0.0, constraints.shares, np.inf)
    return names[min(rows, key=lambda row: shares[row])][0]


def find_velocity(constraints: Constraints, y: Array, program: Array, free: Array) -> Unclosed | None:
    """Make the velocity consistent with loops and motions, in place.

    Only freedoms connected to a violated equation change, to the nearest velocity in kinetic energy; all
    others keep theirs exactly.

    Args:
        constraints: What is to hold at time zero.
        y: State [q, v, x]; its v is the guess, its q is closed.
        program: Of the system's elements.
        free: Generalized directions in which the velocity may be changed, (nv, k).

    Returns:
        What it lacks, if there is none.
    """
    model = constraints.model
    nq, nv = model.nq, model.nv
    constraints.residuals(0.0, y, program)
    lack = constraints.speed.copy()
    speed = max(float(np.abs(lack).max()), float(np.abs(y[nq : nq + nv]).max()) * constraints.plan.length)
    jacobian = constraints.jacobian @ free
    tied = np.abs(jacobian) > NOTHING * constraints.plan.length
    rows, columns = _connected(tied, np.abs(lack) > _SILENT * speed)
    if columns.any():
        free = free[:, columns]
        mass = free.T @ constraints.mass(y[:nq]) @ free
        root = np.linalg.cholesky(mass)
        reduced = np.linalg.solve(root, jacobian[np.ix_(rows, columns)].T).T
        change = np.linalg.lstsq(reduced, -lack[rows], rcond=1e-10)[0]
        y[nq : nq + nv] += free @ np.linalg.solve(root.T, change)
        constraints.residuals(0.0, y, program)
    rest = constraints.speed
    fastest = max(1.0, speed, float(np.abs(y[nq : nq + nv]).max()) * constraints.plan.length)
    return None if float(np.abs(rest).max()) <= ASSEMBLED * fastest else worst(constraints, rest)


def _connected(
    tied: NDArray[np.bool_], rows: NDArray[np.bool_]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return the rows connected to given rows through common columns, and these columns."""
    while True:
        columns = np.asarray(tied[rows].any(axis=0))
        more = rows | tied[:, columns].any(axis=1)
        if np.array_equal(more, rows):
            return rows, columns
        rows = more


@dataclass(frozen=True, slots=True)
class Mobility:
    """How a mechanism can move in one configuration.

    Attributes:
        freedoms: Of the tree, nv.
        closed: Equations of the closures and couplings.
        closed_rank: How many of them are independent.
        driven: Equations of the motions.
        rank: How many of all are independent.
    """

    freedoms: int
    closed: int
    closed_rank: int
    driven: int
    rank: int

    @property
    def free(self) -> int:
        """Freedoms that closures and couplings leave, motions not counted."""
        return self.freedoms - self.closed_rank

    @property
    def left(self) -> int:
        """Freedoms that closures, couplings and motions leave."""
        return self.freedoms - self.rank

    @property
    def redundant(self) -> int:
        """Equations of closures and couplings that others imply."""
        return self.closed - self.closed_rank


def mobility(constraints: Constraints, t: float, y: Array, program: Array) -> Mobility:
    """Return how a mechanism can move in a state."""
    rows = _reduced(constraints, t, y, program)
    motions = len(constraints.plan.motions)
    return Mobility(
        freedoms=constraints.model.nv,
        closed=len(rows) - motions,
        closed_rank=_rank(rows[motions:]),
        driven=motions,
        rank=_rank(rows),
    )


def _reduced(constraints: Constraints, t: float, y: Array, program: Array) -> Array:
    """Return the rows in directions of equal kinetic energy, (rows, nv); zero for one that says nothing."""
    model = constraints.model
    constraints.residuals(t, y, program)
    rows = constraints.jacobian.copy()
    root = np.linalg.cholesky(constraints.mass(y[: model.nq]))
    return _scaled(constraints, np.asarray(np.linalg.solve(root, rows.T).T, dtype=float))


@dataclass(frozen=True, slots=True)
class Redundancy:
    """That equations of a closure or coupling follow from others.

    Attributes:
        equations: How many could be left out together.
        among: Each equation that could be left out alone, in words: ``along z`` in axes of the first side.
    """

    equations: int
    among: tuple[str, ...]


def redundancies(constraints: Constraints, t: float, y: Array, program: Array) -> dict[str, Redundancy]:
    """Return which closures and couplings have equations that those of all others imply, by name.

    Where loops share what is redundant, each of them is named, so that the numbers may add up to more.
    """
    plan = constraints.plan
    rows = _reduced(constraints, t, y, program)[len(plan.motions) :]
    rank = _rank(rows)
    found = {}
    for name, first, words in plan.held():
        start = first - len(plan.motions)
        own = range(start, start + len(words))
        equations = len(words) - (rank - _rank(np.delete(rows, own, axis=0)))
        if equations > 0:
            among = (
                word
                for row, word in zip(own, words, strict=True)
                if _rank(np.delete(rows, row, axis=0)) == rank
            )
            found[name] = Redundancy(equations, tuple(among))
    return found


def _scaled(constraints: Constraints, rows: Array) -> Array:
    """Return rows with the length that they count with: that of their largest number in J.

    It is taken over the largest of their closure's, of ways or of turns.
    """
    plan = constraints.plan
    counts = np.abs(constraints.jacobian).max(axis=1, initial=0.0)
    counts[counts <= NOTHING * plan.length] = 0.0  # round-off says nothing, beside whatever
    counts[: len(plan.motions)] = 1.0
    for _, first, held in plan.held():
        end = first + len(held)
        turns = first + sum(row.startswith("along") for row in held)
        for own in (slice(first, turns), slice(turns, end)):
            largest = counts[own].max(initial=0.0)
            counts[own] /= largest if largest > 0.0 else 1.0
    lengths = np.linalg.norm(rows, axis=1)
    return np.asarray(rows * (counts / np.where(lengths > 0.0, lengths, 1.0))[:, None])


def _rank(rows: Array) -> int:
    rows = rows[rows.any(axis=1)]
    if len(rows) == 0:
        return 0
    return int(np.count_nonzero(np.linalg.svd(rows, compute_uv=False) > DEPENDENT))


def directions(
    constraints: Constraints, y: Array, program: Array, *, motions: bool, holds: bool = False
) -> Array:
    """Return the generalized directions that the constraints leave, (nv, k).

    Args:
        constraints: The constraints.
        y: State [q, v, x].
        program: Of the system's elements.
        motions: Whether motions are held.
        holds: Whether elements hold their joints that hold them at present.
    """
    constraints.residuals(0.0, y, program)
    rows = _scaled(constraints, constraints.jacobian)[0 if motions else len(constraints.plan.motions) :]
    if holds:
        held = constraints.every_row[constraints.rows :]
        lengths = np.linalg.norm(held, axis=1)
        rows = np.vstack([rows, held[lengths > 0.0] / lengths[lengths > 0.0, None]])
    if len(rows) == 0:
        return np.eye(constraints.nv)
    _, values, right = np.linalg.svd(rows)
    return np.asarray(right[int(np.count_nonzero(values > DEPENDENT)) :].T)
