"""A pose that satisfies the constraints, found from one that need not: the nearest that is found.

A loop can be closed in more ways than one, and the one that is meant is the one near the pose that the
mechanism is drawn in. Newton's method alone may leave it where driven joints start elsewhere, so several ways
are gone from the first guess, and of what they come to the nearest is taken:

- Newton's method with steps of least size;
- the same with driven joints at their start from the outset;
- loops closed with driven joints where they are, which then are moved to their start bit by bit;
- all that is lacking taken away bit by bit, r(q) = (1 - s) r(q_0).

The last two follow one solution (Allgower and Georg (1990), Numerical Continuation Methods, 1.1 and 2.2) and
so keep the branch of the guess as long as it has one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.constraints.solver import Constraints

__all__ = ["ASSEMBLED", "Unclosed", "find_configuration", "row_names", "worst", "worst_row"]

Array = NDArray[np.float64]
Retract = Callable[[Array, Array], None]

#: Residual of an assembled state, of ways over the mechanism's length, or of turns.
ASSEMBLED = 1e-12
# The most of one step, and how many; of a way that is followed, the least part at once and the most that a
# part may move [rad, or lengths of the mechanism]: in 0.2 rad a cosine changes by 2 %, so that Newton's next
# guess is on the same branch.
_LONGEST = 0.5
_STEPS = 100
_LEAST_PART = 1.0 / 1024.0
_FARTHEST = 0.2
_PARTS = 300
_FEW = 8
# A pose that is found no further from the guess than that is not looked for in other ways [same units].
_NEAR = 0.2
# Starts at random around the guess where no way leads anywhere.
_STARTS = 12
# Two poses this close, of their distance to the guess, are one.
_SAME = 1e-6


@dataclass(frozen=True, slots=True)
class Unclosed:
    """That no state was found.

    Attributes:
        residual: Largest of what the best one lacks [m] or [rad], or of the rates [m/s] or [rad/s].
        row: The row of it, by its closure and what that holds, or by its motion or coupling.
        turns: Whether it is one of a turn.
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
    """Return which row has the largest residual of position, in words, as far as rows were last written."""
    return worst(constraints, constraints.gap).row


@dataclass(frozen=True, slots=True)
class _Search:
    """What is looked for, and in which directions.

    Attributes:
        constraints: What is to hold at time zero.
        program: Of the system's elements.
        free: Generalized directions in which the configuration may be changed, (nv, k).
        retract: ``(y, step)``: moves the configuration in y by a generalized step.
        reach: What counts as much as 1 rad, of each generalized direction, (nv,).
    """

    constraints: Constraints
    program: Array
    free: Array
    retract: Retract
    reach: Array

    def gap(self, y: Array) -> Array:
        """Return the residuals of a state, which count in metres."""
        self.constraints.residuals(0.0, y, self.program)
        return self.constraints.gap.copy()

    def step(self, lack: Array, rows: slice = slice(None)) -> Array:
        """Return the least step that takes away what is lacking, where rows were written last."""
        jacobian = self.constraints.jacobian[rows] @ self.free
        return np.asarray(-self.free @ np.linalg.lstsq(jacobian, lack[rows], rcond=1e-10)[0])

    def way(self, one: Array, other: Array) -> Array:
        """Return how far each direction goes from one state to another, [rad] or of ways the same."""
        nq = self.constraints.model.nq
        difference = pin.difference(self.constraints.model, one[:nq], other[:nq])
        return np.asarray(difference / self.reach)


def find_configuration(
    constraints: Constraints, y: Array, program: Array, free: Array, retract: Retract, reach: Array
) -> Unclosed | None:
    """Close all loops from a first guess, in place: the nearest solution that is found.

    Args:
        constraints: What is to hold at time zero.
        y: State [q, v, x]; its q is the guess.
        program: Of the system's elements.
        free: Generalized directions in which the configuration may be changed, (nv, k).
        retract: ``(y, step)``: moves the configuration in y by a generalized step.
        reach: What counts as much as 1 rad, of each generalized direction, (nv,): the mechanism's size for
            ways [m].

    Returns:
        What the best attempt lacks, if none closes the loops.
    """
    search = _Search(constraints, program, free, retract, reach)
    guess = y.copy()
    found: list[tuple[float, Array]] = []
    lacks: list[Unclosed] = []

    def look(trial: Array) -> float:
        """Finish by Newton's method; return how far from the guess its farthest part is, if it closes."""
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
        # From a singular guess no step leads anywhere: others around it, further and further away.
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
    """Whether an equation is open that no motion changes, here and beside: as of axes that stay opposite."""
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
    """Yield where ways lead that begin with driven joints at their start, or are gone bit by bit."""
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
        if _newton(search, closed, stay) is None and _followed(search, closed, stay):
            yield closed
    if _followed(search, whole := guess.copy(), lack):
        yield whole


def _followed(search: _Search, y: Array, lack: Array) -> bool:
    """Move a state, in place, that lacks something, on to where it lacks nothing; along one solution.

    Returns:
        Whether it came there.
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
    """Close the loops by Newton's method with steps of least size, in place; up to what may be lacking.

    Args:
        search: What is looked for.
        y: State [q, v, x].
        lack: What rows are to come to.
        few: Whether it is to come there at once, in steps that are whole.
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
