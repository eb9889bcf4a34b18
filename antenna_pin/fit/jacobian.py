"""Derivatives of a fit's residuals by its unknowns: by central differences of runs, or by what else."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.fit.runs import NoRunError

__all__ = ["APART", "Derived", "by_differences"]

Array = NDArray[np.float64]


#: By how much the equation may contradict differences of runs, over the size of derivatives by one unknown.
APART = 1e-2


class Derived(NamedTuple):
    """By what the derivatives of a fit were found.

    Attributes:
        equation: How often by the variational equation.
        differences: How often by differences of runs.
        why: Why the first time not by the equation, where that was asked for; "" if that was not.
        apart: By how much the two differed where they were held against one another, over the size of the
            derivatives by one unknown; NaN if they were not.
    """

    equation: int = 0
    differences: int = 0
    why: str = ""
    apart: float = float("nan")

    def once_more(self, equation: bool, why: str = "") -> Derived:
        """Return the same after one time more."""
        if equation:
            return self._replace(equation=self.equation + 1)
        return self._replace(differences=self.differences + 1, why=self.why or why)

    def held(self, equation: Array, runs: Array) -> Derived:
        """Return the same once the equation's derivatives were held against those of runs."""
        sizes = np.linalg.norm(runs, axis=0)
        off = np.linalg.norm(equation - runs, axis=0) / np.where(sizes > 0.0, sizes, 1.0)
        apart = float(off.max(initial=0.0))
        why = f"they contradict runs, by {apart:.2g} of their size" if apart > APART else self.why
        return self._replace(apart=apart, why=why)

    def words(self) -> str:
        """Return it in words."""
        if not self.equation:
            return "differences of runs" + (f", not the equation: {self.why}" if self.why else "")
        said = f"the variational equation, within {self.apart:.1g} of differences of runs where it began"
        if not self.differences:
            return said
        every = self.equation + self.differences
        return f"{said}; {self.differences} of {every} times by these: {self.why}"


def by_differences(
    evaluate: Callable[[Sequence[Array]], list[Array]], here: Array, lower: Array, upper: Array, step: float
) -> Array:
    """Return the derivatives of residuals, (m, n), at unknowns.

    The error of central differences is of the square of the step. Next to a bound, and where a neighbour has
    no run, they go to one side, with an error of the step itself; where neither has one, a tenth of the step
    or ten times as far.

    Args:
        evaluate: The residuals at several unknowns, (m,) each.
        here: The unknowns, (n,), each over its size.
        lower: Their bounds, (n,).
        upper: Likewise.
        step: Of each.

    Raises:
        NoRunError: There is no run here, or none on either side.
    """
    n = len(here)
    steps = step * np.eye(n)
    ends = [np.clip(here + sign * one, lower, upper) for one in steps for sign in (-1.0, 1.0)]
    try:
        found: list[Array | None] = list(evaluate(ends))
    except NoRunError:
        found = [_or_none(evaluate, end) for end in ends]
    columns = []
    for i in range(n):
        sides = []
        for end, residuals in zip(ends[2 * i : 2 * i + 2], found[2 * i : 2 * i + 2], strict=True):
            if residuals is None:
                end, residuals = here, evaluate([here])[0]
            sides.append((float(end[i]), residuals))
        (left, below), (right, above) = sides
        if not right > left:
            columns.append(_nearby(evaluate, here, i, lower, upper, step))
            continue
        columns.append((above - below) / (right - left))
    return np.column_stack(columns)


def _nearby(
    evaluate: Callable[[Sequence[Array]], list[Array]],
    here: Array,
    i: int,
    lower: Array,
    upper: Array,
    step: float,
) -> Array:
    """Return the derivatives by one unknown, to one side, where a step away from here there is no run."""
    for farther in (0.1, -0.1, 10.0, -10.0):
        end = here.copy()
        end[i] = np.clip(here[i] + farther * step, lower[i], upper[i])
        found = _or_none(evaluate, end) if end[i] != here[i] else None
        if found is not None:
            return np.asarray((found - evaluate([here])[0]) / (end[i] - here[i]))
    raise NoRunError(f"unknown {i + 1} has no run on either side of {here[i]:g}, a step of {step:g} away")


def _or_none(evaluate: Callable[[Sequence[Array]], list[Array]], there: Array) -> Array | None:
    try:
        return evaluate([there])[0]
    except NoRunError:
        return None
