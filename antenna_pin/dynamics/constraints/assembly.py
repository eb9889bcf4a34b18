"""Velocities consistent with the constraints, and the remaining degrees of freedom."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.dynamics.constraints.factor_kernels import DEPENDENT, NOTHING
from antenna_pin.dynamics.constraints.solver import Constraints

# --- prescribed joints --------------------------------------------------------------------------------------
#
# A joint's rate is prescribed where its unit vector e is a combination of rows,
#
# .. math:: J^T x = e,
#
# for then all velocities that satisfy the rows have the same rate there.

Array = NDArray[np.float64]

# Part of a unit vector, or of a row of length one, that counts as zero.
_RANK = 1e-9


def motions_that_prescribe(
    constraints: Constraints, at: int, holding_rows: Sequence[int] = ()
) -> tuple[str, ...]:
    """Return the names of the motions that determine the rate of a joint.

    Args:
        constraints: With the rows of the state written.
        at: Place of the joint in v.
        holding_rows: Rows of elements that hold their joints, among the last of the plan, which count too.
    """
    motions = constraints.plan.motions
    rows = constraints.every_row[[*range(constraints.rows), *(constraints.rows + k for k in holding_rows)]]
    if not motions or _combination(rows[len(motions) :], at) is not None:
        return ()
    shares = _combination(rows, at)
    if shares is None:
        return ()
    return tuple(name for name, share in zip(motions, shares, strict=False) if abs(share) > _RANK)


def _combination(rows: Array, at: int) -> Array | None:
    """Return the share of each unit row in a joint's unit vector, or None."""
    wanted = np.zeros(rows.shape[1])
    wanted[at] = 1.0
    lengths = np.linalg.norm(rows, axis=1)
    lengths[lengths <= NOTHING] = np.inf
    unit = rows / lengths[:, None]
    found = np.linalg.lstsq(unit.T, wanted, rcond=_RANK)[0] if len(rows) else np.zeros(0)
    return found if np.abs(unit.T @ found - wanted).max() < _RANK else None


def rows_that_share(constraints: Constraints) -> tuple[int, ...]:
    """Return the row numbers of elements whose load is statically indeterminate.

    Args:
        constraints: With the rows of the state written.
    """
    rows = constraints.every_row
    lengths = np.linalg.norm(rows, axis=1)
    some = np.flatnonzero(lengths > NOTHING * constraints.plan.length)
    if not len(some):
        return ()
    _, sizes, ways = np.linalg.svd((rows[some] / lengths[some, None]).T)
    loads = ways[np.count_nonzero(sizes > _RANK) :]  # rows that balance each other
    shares = np.abs(loads).max(axis=0, initial=0.0) > _RANK
    return tuple(int(k) - constraints.rows for k in some[shares] if k >= constraints.rows)


# --- poses --------------------------------------------------------------------------------------------------
#
# A loop may have several closed configurations; the required one is the nearest to the pose of the
# URDF. Newton's method alone may leave it if driven joints start elsewhere, so several paths are followed
# from the first guess, and the nearest of their ends is taken:
#
# - Newton's method with steps of least size;
# - the same with driven joints at their start from the beginning;
# - loops closed with driven joints at their present positions, which then move to their start gradually;
# - all residuals reduced gradually, r(q) = (1 - s) r(q_0).
#
# The last two follow one solution (Allgower and Georg (1990), Numerical Continuation Methods, 1.1 and 2.2)
# and so stay on the branch of the guess as long as it exists.

Retract = Callable[[Array, Array], None]

#: Residual of an assembled state, of displacements over the mechanism's length, or of angles.
ASSEMBLED = 1e-12
# Largest step, and number of steps; for a followed path the least fraction of a step and the largest motion
# of a part [rad, or lengths of the mechanism]: in 0.2 rad a cosine changes by 2 %, so that Newton's next
# guess is on the same branch.
_LONGEST = 0.5
_STEPS = 100
_LEAST_PART = 1.0 / 1024.0
_FARTHEST = 0.2
_PARTS = 300
_FEW = 8
# Distance to the guess within which no further paths are followed [same units].
_NEAR = 0.2
# Random starts around the guess if no path ends in a closed configuration.
_STARTS = 12
# Distance of two poses that count as one, relative to that to the guess.
_SAME = 1e-6


@dataclass(frozen=True, slots=True)
class Unclosed:
    """Failure to find a state.

    Attributes:
        residual: Largest residual of the best state [m] or [rad], or of the rates [m/s] or [rad/s].
        row: Description of its row: closure and direction, or motion or coupling.
        turns: Whether it is an angle.
    """

    residual: float
    row: str
    turns: bool


def row_names(constraints: Constraints) -> list[tuple[str, bool]]:
    """Return what each row is, in words, and whether it holds a turn."""
    plan = constraints.plan
    singles = [f"motion {name!r}" for name in plan.motions]
    singles += [f"coupling {name!r}" for name in plan.couplings]
    names = list(zip(singles, constraints.turning.tolist(), strict=True))
    for closure, rows in plan.rows.items():
        names += [(f"closure {closure!r}", not row.startswith("along")) for row in rows]
    return names


def worst(constraints: Constraints, residuals: Array) -> Unclosed:
    """Return the largest residual of rows that count in metres."""
    names = row_names(constraints)
    row = int(np.argmax(np.abs(residuals)))
    name, turns = names[row]
    return Unclosed(float(abs(residuals[row])) / (constraints.plan.length if turns else 1.0), name, turns)


def worst_row(constraints: Constraints) -> str:
    """Return the name of the row with the largest residual of position."""
    return worst(constraints, constraints.gap).row


@dataclass(frozen=True, slots=True)
class _Search:
    """Unknowns of the search, and their directions."""

    constraints: Constraints  # constraints at time zero
    program: Array  # program of the elements
    free: Array  # admissible generalized directions, (nv, k)
    retract: Retract  # ``(y, step)``: moves the configuration in y by a generalized step
    reach: Array  # equivalent of a 1 rad turn in each direction, (nv,)

    def gap(self, y: Array) -> Array:
        """Return the residuals of a state, which count in metres."""
        self.constraints.residuals(0.0, y, self.program)
        return self.constraints.gap.copy()

    def step(self, lack: Array, rows: slice = slice(None)) -> Array:
        """Return the least step that takes away what is lacking, where rows were written last."""
        jacobian = self.constraints.jacobian[rows] @ self.free
        return np.asarray(-self.free @ np.linalg.lstsq(jacobian, lack[rows], rcond=1e-10)[0])

    def way(self, one: Array, other: Array) -> Array:
        """Return the distance between two states in each direction, [rad] or equivalent lengths."""
        nq = self.constraints.model.nq
        difference = pin.difference(self.constraints.model, one[:nq], other[:nq])
        return np.asarray(difference / self.reach)


def find_configuration(
    constraints: Constraints, y: Array, program: Array, free: Array, retract: Retract, reach: Array
) -> Unclosed | None:
    """Close all loops from a first guess, in place: the nearest solution that is found.

    Args:
        constraints: Constraints at time zero.
        y: State [q, v, x]; its q is the guess.
        program: Program of the system's elements.
        free: Generalized directions in which the configuration may be changed, (nv, k).
        retract: ``(y, step)``: moves the configuration in y by a generalized step.
        reach: Equivalent of 1 rad in each generalized direction, (nv,): the mechanism's size for
            displacements [m].

    Returns:
        Failure of the best attempt, if none closes the loops.
    """
    search = _Search(constraints, program, free, retract, reach)
    guess = y.copy()
    found: list[tuple[float, Array]] = []
    lacks: list[Unclosed] = []

    def look(trial: Array) -> float:
        """Finish by Newton's method; return the largest distance from the guess if it converges."""
        unclosed = _newton(search, trial)
        if unclosed is not None:
            lacks.append(unclosed)
            return np.inf
        way = search.way(guess, trial)
        found.append((float(np.linalg.norm(way)), trial))
        return float(np.abs(way).max())

    if look(guess.copy()) > _NEAR:
        if not found and _out_of_reach(search, guess):
            return lacks[0]
        for trial in _led(search, guess):
            look(trial)
    if not found:
        # From a singular guess no step reduces the residual: other guesses around it, increasingly far away.
        random = np.random.default_rng(20210)
        for start in range(1, _STARTS):
            trial = guess.copy()
            retract(trial, free @ random.normal(scale=0.05 * start, size=free.shape[1]))
            look(trial)
            if found and start >= _STARTS // 2:
                break
    if not found:
        return min(lacks, key=lambda one: one.residual)
    nearest = min(far for far, _ in found)
    y[:] = next(trial for far, trial in found if far <= (1.0 + _SAME) * nearest)
    return None


def _out_of_reach(search: _Search, guess: Array) -> bool:
    """Return whether an open equation is insensitive to motion, here and nearby."""
    y = guess.copy()
    open_here = np.full(search.constraints.rows, True)
    for scale in (0.0, 0.1):
        way = np.random.default_rng(11).normal(scale=scale, size=search.free.shape[1])
        search.retract(y, search.free @ way)
        gap = search.gap(y)
        moved = np.abs(search.constraints.jacobian @ search.free).max(axis=1, initial=0.0)
        length = search.constraints.plan.length
        open_here &= (np.abs(gap) > np.sqrt(ASSEMBLED) * length) & (moved <= np.sqrt(ASSEMBLED) * length)
    return bool(open_here.any())


def _led(search: _Search, guess: Array) -> Iterator[Array]:
    """Yield states reached from driven joints at their start, or by gradual steps."""
    motions = slice(0, len(search.constraints.plan.motions))
    lack = search.gap(guess)
    if motions.stop:
        there = guess.copy()
        step = search.step(lack, motions)
        search.retract(there, step)
        yield there
        stay = np.zeros_like(lack)
        stay[motions] = lack[motions]
        closed = guess.copy()
        if _newton(search, closed, stay) is None and _follow_solution(search, closed, stay):
            yield closed
    if _follow_solution(search, whole := guess.copy(), lack):
        yield whole


def _follow_solution(search: _Search, y: Array, lack: Array) -> bool:
    """Move a state, in place, along one solution until no residual is left.

    Returns:
        Whether it is closed.
    """
    done, part = 0.0, 1.0 / 16.0
    for _ in range(_PARTS):
        if done >= 1.0:
            return True
        part = min(part, 1.0 - done)
        trial = y.copy()
        ahead = lack * (1.0 - done - part)
        if (
            _newton(search, trial, ahead, few=True) is None
            and float(np.abs(search.way(y, trial)).max()) <= _FARTHEST
        ):
            y[:], done, part = trial, done + part, 2.0 * part
            continue
        part *= 0.5
        if part < _LEAST_PART:
            return False
    return done >= 1.0


def _newton(search: _Search, y: Array, lack: Array | float = 0.0, *, few: bool = False) -> Unclosed | None:
    """Close the loops by Newton's method with least steps, in place, within a tolerance.

    Residuals are reduced to ``lack``; if ``few``, by a few full steps only.
    """
    length = search.constraints.plan.length
    gap = search.gap(y) - lack
    size = float(np.abs(gap).max())
    for _ in range(_FEW if few else _STEPS):
        if size <= 1e-15 * length:
            break
        step = search.step(gap)
        largest = float(np.abs(step).max())
        if not np.isfinite(largest) or largest == 0.0:
            break
        step *= min(1.0, _LONGEST / largest)
        for _ in range(1 if few else 12):
            trial = y.copy()
            search.retract(trial, step)
            found = search.gap(trial) - lack
            if np.linalg.norm(found) < np.linalg.norm(gap):
                break
            step *= 0.5
        else:
            break
        y[:], gap = trial, found
        before, size = size, float(np.abs(gap).max())
        if size <= ASSEMBLED * length and size > 0.3 * before:
            break
    gap = search.gap(y) - lack
    return None if float(np.abs(gap).max()) <= ASSEMBLED * length else worst(search.constraints, gap)


# --- velocities ---------------------------------------------------------------------------------------------

# Residual of an equation that is round-off, as a share of the fastest rate.
_SILENT = 1e-14


def least_row(constraints: Constraints) -> str:
    """Return the name of the least independent row of the last factorization."""
    names, plan = row_names(constraints), constraints.plan
    singles = len(plan.motions) + len(plan.couplings)
    rows = range(singles if plan.closures else len(plan.motions) if plan.couplings else 0, constraints.rows)
    shares = np.where(constraints.shares > 0.0, constraints.shares, np.inf)
    return names[min(rows, key=lambda row: shares[row])][0]


def find_velocity(constraints: Constraints, y: Array, program: Array, free: Array) -> Unclosed | None:
    """Make the velocity consistent with loops and motions, in place.

    Only freedoms connected to a violated equation change, to the nearest velocity in kinetic energy; all
    others remain exactly.

    Args:
        constraints: Constraints at time zero.
        y: State [q, v, x]; its v is the guess, its q is closed.
        program: Program of the system's elements.
        free: Generalized directions in which the velocity may be changed, (nv, k).

    Returns:
        Failure, if there is no such velocity.
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
    """Mobility of a mechanism in one configuration.

    Attributes:
        freedoms: Freedoms of the tree, nv.
        closed: Equations of the closures and couplings.
        closed_rank: Number of independent ones.
        driven: Equations of the motions.
        rank: Number of independent equations in all.
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
    """Return the rows in directions of equal kinetic energy, (rows, nv), zero where ineffective."""
    model = constraints.model
    constraints.residuals(t, y, program)
    rows = constraints.jacobian.copy()
    root = np.linalg.cholesky(constraints.mass(y[: model.nq]))
    return _scaled(constraints, np.asarray(np.linalg.solve(root, rows.T).T, dtype=float))


@dataclass(frozen=True, slots=True)
class Redundancy:
    """Warning that equations of a closure or coupling are redundant."""

    equations: int  # number of equations that could be omitted together
    # equations that could be omitted singly, as text: ``along z`` in axes of the first side
    among: tuple[str, ...]


def redundancies(constraints: Constraints, t: float, y: Array, program: Array) -> dict[str, Redundancy]:
    """Return the closures and couplings with equations implied by all others, by name.

    Loops that share a redundancy are each named, so that the numbers may add up to more.
    """
    plan = constraints.plan
    rows = _reduced(constraints, t, y, program)[len(plan.motions) :]
    rank = _rank(rows)
    found = {}
    for name, first, words in plan.row_groups():
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
    """Return rows scaled to the length of their largest number in J.

    The largest number is that of all rows of a closure, of displacements or of angles.
    """
    plan = constraints.plan
    counts = np.abs(constraints.jacobian).max(axis=1, initial=0.0)
    counts[counts <= NOTHING * plan.length] = 0.0  # only round-off, whatever the scale
    counts[: len(plan.motions)] = 1.0
    for _, first, held in plan.row_groups():
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
