"""What carried displacements miss: a run's steps go over kinks, and so come to them at other instants.

A step over a kink of a force is wrong by what no estimate of its error tells, so that a run may be off by
thousands of its tolerances there. How much is known from the same step made anew, cut at the kink: it is a
displacement, carried along as all are. A run that is off by e comes to a kink whose passing goes with n by
``dt = -(n e) / g'`` later. As long, the derivative of rates is that of the other side, ``b n'`` from its own,
and displacements W miss ``b (n' W) dt``: a column that is carried on from there, and how much of it each has.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.settings import RunSettings
from antenna_pin.dynamics import Workspace
from antenna_pin.integrate import Stepper, method_named
from antenna_pin.nonlinear.field import Field
from antenna_pin.nonlinear.frames import way_between
from antenna_pin.nonlinear.instants import Carried
from antenna_pin.simulation.steps import stepper_of

__all__ = ["Kink", "Missed", "StepAnew"]

Array = NDArray[np.float64]

# What a run is off by in units, over its tolerance, where nothing more is known.
_OFF = 10.0
# How many columns are kept of what was missed; then the two that are oldest are one.
_MOST = 16


class Kink(NamedTuple):
    """How a kink is passed.

    Attributes:
        force: b, a direction of the coordinates, (size,).
        passing: n, likewise; the derivative of rates jumps by ``b n'`` [1/s].
        later: By how much later a neighbour comes there that is off by n over its own square [s].
    """

    force: Array
    passing: Array
    later: float

    @classmethod
    def of(cls, jump: Array, way: Array, later: float) -> Kink:
        """Return it.

        Args:
            jump: Of the derivative of the coordinates' rates, (size, size).
            way: Some displacement, (size,).
            later: By how much later a neighbour there comes to it [s].
        """
        forces, sizes, passings = np.linalg.svd(jump)
        passing = sizes[0] * passings[0]
        along = float(passing @ way)
        return cls(forces[:, 0], passing, abs(later / along) if along != 0.0 else 0.0)


class Missed:
    """Counts what displacements miss, by columns behind them, and has the flow as one more displacement.

    The columns are displacements, what the run is off by, the flow, what is missed.

    Args:
        count: How many displacements there are.
        rtol: The run's tolerance.
    """

    def __init__(self, count: int, rtol: float) -> None:
        """Begin with nothing."""
        self._count, self._least = count, _OFF * rtol
        self._parts: list[Array] = []

    def begin(self, ways: Array) -> Array:
        """Return displacements, (size, count), with what is behind them, which is nothing yet."""
        return np.hstack([ways, np.zeros((len(ways), 2))])

    @property
    def flow(self) -> int:
        """Which column the flow is, where it is carried; else it is zero."""
        return self._count + 1

    def own(self, carried: Carried) -> Carried:
        """Return the displacements alone."""
        matrix, other, books = (
            one[:, : self._count] for one in (carried.matrix, carried.other, carried.books)
        )
        return Carried(matrix, other, carried.frame, books)

    def error(self, carried: Carried) -> Array:
        """Return what the run is off by, as a displacement, (size,)."""
        return np.asarray(carried.matrix[:, self._count])

    def off(self, carried: Carried, more: Array) -> Carried:
        """Return displacements with a run that is off by more, (size,)."""
        both = carried.matrix.copy(), carried.other.copy()
        for one in both:
            one[:, self._count] += more
        return Carried(*both, carried.frame, carried.books)

    def passed(self, kink: Kink, error: Array, carried: Carried) -> Carried:
        """Return displacements with what they miss of a kink that a run passes which is off by an error."""
        size = float(np.linalg.norm(kink.passing))
        late = kink.later * (abs(float(kink.passing @ error)) + size * self._least)
        self._parts.append(np.abs(kink.passing @ carried.matrix[:, : self._count]) * late)
        column = kink.force[:, None]
        matrix, other = (np.hstack([one, column]) for one in carried[:2])
        return Carried(matrix, other, carried.frame, np.pad(carried.books, ((0, 0), (0, 1))))

    def merged(self, carried: Carried) -> Carried:
        """Return displacements with the oldest of what is missed in one column, where there are too many."""
        while len(self._parts) > _MOST:
            first = self._count + 2
            sizes = np.linalg.norm(carried.matrix[:, first : first + 2], axis=0)
            kept = int(np.argmax(sizes))
            if sizes[kept] > 0.0:
                self._parts[1 - kept] = self._parts[1 - kept] * (sizes[1 - kept] / sizes[kept])
            self._parts[:2] = [self._parts[0] + self._parts[1]]
            matrix, other, books = (
                np.delete(one, first + 1 - kept, axis=1)
                for one in (carried.matrix, carried.other, carried.books)
            )
            carried = Carried(matrix, other, carried.frame, books)
        return carried

    def sizes(self, carried: Carried) -> Array:
        """Return how much is missed of each displacement, (count,)."""
        matrix = carried.matrix
        out = np.linalg.norm(matrix[:, : self._count], axis=0) * float(np.linalg.norm(self.error(carried)))
        for column, parts in zip(matrix.T[self._count + 2 :], self._parts, strict=True):
            out += float(np.linalg.norm(column)) * parts
        return np.asarray(out)


class StepAnew:
    """Makes a run's step anew, cut at kinks: what the run's own is off by.

    Args:
        field: The rates.
        settings: Of the run.
        scales: Of the run's errors.
        source: Its contact memory and program are those of the step.
    """

    def __init__(self, field: Field, settings: RunSettings, scales: Array, source: Workspace) -> None:
        """Allocate nothing: most runs come to no kink."""
        self._field, self._settings, self._scales, self._source = field, settings, scales, source
        self._made: tuple[Workspace, Stepper] | None = None
        self._begun = False

    def begin(self, time: float, y: Array) -> None:
        """Begin a step in a state."""
        self._start = time, y.copy()
        self._begun = False

    def to(self, time: float) -> Array:
        """Return the state at a time within the step, to which it is cut [s]."""
        workspace, stepper = self._made = self._made or self._make()
        if not self._begun:
            workspace.memory[:], workspace.program[:] = self._source.memory, self._source.program
            stepper.restart(*self._start)
            self._begun = True
        if time > stepper.t:
            stepper.attempt(time - stepper.t)
            stepper.restart(time, stepper.y.copy())
        return np.array(stepper.start)

    def _make(self) -> tuple[Workspace, Stepper]:
        workspace, method = Workspace(self._field.system), method_named(self._settings.method)
        return workspace, stepper_of(workspace, method, self._scales, self._settings)

    def off(self, time: float, y: Array) -> Array:
        """Return by how much a state at a time is off, as a displacement; none where nothing was cut."""
        out = np.zeros(self._field.displacement)
        if not self._begun:
            return out
        nq, nv = self._field.system.model.nq, self._field.system.model.nv
        there = self.to(time)
        way, rate, bristles, *_ = self._field.parts
        out[way] = way_between(self._field.system, there[:nq], y[:nq])
        out[rate] = y[nq : nq + nv] - there[nq : nq + nv]
        out[bristles] = (y - there)[nq + nv + self._field.bristles]
        return out
