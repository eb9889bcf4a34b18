"""Solver of a run's constraints: accelerations, corrections, forces."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.dynamics.constraints import (
    factor_kernels,
    force_kernels,
    loaded_kernels,
    rows_kernels,
    solve_kernels,
)
from antenna_pin.dynamics.constraints import layout_kernels as _layout
from antenna_pin.dynamics.constraints.plan import ConstraintPlan
from antenna_pin.dynamics.constraints.solve_kernels import CLOSED, NEAR, OPEN, ROUNDS
from antenna_pin.mechanism.inertia import mass_matrix

__all__ = ["Constraints"]

Array = NDArray[np.float64]


class Solution(NamedTuple):
    """Numbers of a solution."""

    rank: int  # number of independent rows
    least: float  # smallest remainder of an independent row, over its scale [-]
    most: float  # largest remainder of a dependent row, over its scale [-]
    gap: float  # largest residual of displacements [m]; ``turn``: angles [rad]; ``speed``, ``spin``: rates
    turn: float
    speed: float
    spin: float


class Constraints:
    """Solver of the equations of motion under constraints; one for each run.

    Args:
        plan: The constraints.
        model: ``pin.Model``.
        data: ``pin.Data`` of the run.
    """

    def __init__(self, plan: ConstraintPlan, model: Any, data: Any) -> None:
        """Allocate everything once."""
        self.plan = plan
        self.model = model
        self.data = data
        self.work = np.zeros(plan.size)
        head = plan.words[: _layout.PLAN_WORDS].view(_layout.PLAN)[0]
        nv, holds, every = int(head["nv"]), int(head["holds"]), int(head["rows"])
        #: Number of rows of motions, couplings and closures; the rows of elements that hold follow.
        rows = every - holds
        self.rows, self.nv = rows, nv

        def part(name: str, *shape: int) -> Array:
            at = int(head[name])
            return self.work[at : at + int(np.prod(shape))].reshape(shape)

        #: J, in metres; right sides of accelerations; residuals; multipliers.
        self.jacobian = part("jacobian", nv, int(head["width"]))[:, :rows].T
        self._all_forces = part("force", every)
        self.gap, self.speed, self.force = part("gap", rows), part("speed", rows), part("force", rows)
        self.lack = part("lack", rows)
        #: Remainder of each row, over its length and times its scale factor.
        self.shares = part("shares", rows)
        #: Actions of elements on links on bodies, if friction by load needs them, else empty.
        self.applied = self.work[int(head["loaded"]) :][: 6 * int(head["bodies"]) if head["loaded"] else 0]
        self._solution = part("found", _layout.FOUND_WORDS).view(_layout.FOUND)
        self._step = np.zeros(nv)
        #: Scratch for the least forces, and these forces, of redundant rows (``force_kernels.least_forces``).
        self.least_room = np.zeros(2 * every * (every + 1))
        self.least = np.zeros(every)
        #: All of J, in metres, rows of elements that hold included, and the residuals.
        self.every_row = part("jacobian", nv, int(head["width"]))[:, :every].T
        self.every_gap, self.every_speed = part("gap", every), part("speed", every)
        self._loads, self._holds = np.zeros(len(plan.motions) + len(plan.couplings) + holds), holds
        parts = plan.parts
        slides = [plan.words[parts.motions].view(_layout.DRIVEN)["slides"]]
        slides.append(plan.words[parts.couplings].view(_layout.COUPLED)["slides"])
        #: Whether the rows of motions and couplings, which come first, are of angles.
        self.turning = np.concatenate(slides) == 0

    @property
    def solution(self) -> Solution:
        """Numbers of the last solution."""
        return Solution._make(self._solution.item())

    @property
    def residual(self) -> tuple[float, float, float, float]:
        """The largest residuals of the rows that were written last [m], [rad], [m/s], [rad/s]."""
        found = self.solution
        return found.gap, found.turn, found.speed, found.spin

    def accelerate(self, t: float, y: Array, program: Array, effort: Array, rates: Array) -> None:
        """Write accelerations, and powers of motions.

        Args:
            t: Time [s].
            y: State [q, v, x].
            program: Program of the system's elements.
            effort: Generalized force of the elements, (nv,).
            rates: Written, (nv + nx,).
        """
        nq, model, data = self.model.nq, self.model, self.data
        mass, q, v = pin.crba(model, data, y[:nq]), y[:nq], y[nq : nq + self.nv]
        bias = pin.nonLinearEffects(model, data, q, v)
        loaded_kernels.accelerate(t, y, program, self.plan.words, self.work, effort, mass, bias, rates)

    def loads(self) -> Array:
        """Return loads of holding elements in the last solved state, (holds,) [N m] or [N]."""
        force_kernels.joint_forces(self.plan.words, self._all_forces, self._loads)
        return self._loads[len(self._loads) - self._holds :]

    def residuals(self, t: float, y: Array, program: Array) -> Solution:
        """Write the rows of a state; return what is found, with the largest residuals."""
        rows_kernels.write_rows(t, y, program, self.plan.words, self.work)
        return self.solution

    def mass(self, q: Array) -> Array:
        """Return the mass matrix of the constraints, (nv, nv), with couplings where necessary."""
        matrix = mass_matrix(self.model, self.data, q)
        factor_kernels.brace(self.plan.words, matrix)
        return matrix

    def factorize(self, q: Array) -> None:
        """Factorize the rows that were written last."""
        factor_kernels.factorize(self.plan.words, self.work, pin.crba(self.model, self.data, q))

    def step(self, *, of_speed: bool) -> Array:
        """Return the generalized step of least kinetic energy that removes the residuals, (nv,).

        The rows must be factorized. The array is the same each time.
        """
        solve_kernels.correction(self.plan.words, self.work, of_speed, self._step)
        return self._step

    def closed_at(self, t: float, y: Array, program: Array) -> bool:
        """Return whether the residuals of a state are round-off, of positions and of velocities."""
        self.residuals(t, y, program)
        return self._in_place() and self._in_motion()

    def _in_place(self) -> bool:
        found = self.solution
        return bool(found.gap <= CLOSED * self.plan.length and found.turn <= CLOSED)

    def _in_motion(self) -> bool:
        found = self.solution
        return bool(found.speed <= CLOSED * self.plan.length and found.spin <= CLOSED)

    def project(self, t: float, y: Array, program: Array, retract: Callable[[Array, Array], None]) -> bool:
        """Correct a state of small residuals onto the constraints, in place.

        Corrections are the least ones in kinetic energy, which conserves momentum.

        Args:
            t: Time [s].
            y: State [q, v, x].
            program: Program of the system's elements.
            retract: ``(y, step)``: moves the configuration in y by a generalized step.

        Returns:
            Whether it is closed; if not, the state is invalid.
        """
        nq, nv = self.model.nq, self.nv
        self.residuals(t, y, program)
        at_rest = self._in_place()
        length = self.plan.length
        last = np.maximum(self.solution.gap, self.solution.turn * length)  # NaN if any is NaN
        # The rows hardly change in such a correction: one factorization suffices, else another is made.
        near = last < NEAR * length
        self.factorize(y[:nq])
        for _ in range(ROUNDS):
            if at_rest:
                break
            retract(y, self.step(of_speed=False))
            found = self.residuals(t, y, program)
            now = np.maximum(found.gap, found.turn * length)
            at_rest = self._in_place() or now > 0.5 * last
            last = now
            if not near:
                self.factorize(y[:nq])
        y[nq : nq + nv] += self.step(of_speed=True)
        return bool(last <= OPEN * length)
