"""What a run asks of its constraints: accelerations, corrections, forces."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.constraints import _layout_kernels as _layout
from antenna_pin.constraints import _rows_kernels, _solve_kernels
from antenna_pin.constraints._solve_kernels import CLOSED, NEAR, OPEN, ROUNDS
from antenna_pin.constraints.plan import Plan
from antenna_pin.mechanism import PLACE

__all__ = ["Constraints"]

Array = NDArray[np.float64]


class Found(NamedTuple):
    """What a solution has found.

    Attributes:
        rank: How many rows are independent.
        least: The least of what was left of a row that counts as independent, over its scale [-].
        most: The most of what was left of one that does not [-].
        gap: Largest residual in ways [m], ``turn`` in turns [rad]; ``speed``, ``spin``: of their rates.
    """

    rank: int
    least: float
    most: float
    gap: float
    turn: float
    speed: float
    spin: float


class Constraints:
    """A place to solve the equations of motion under constraints; one for each run.

    Args:
        plan: The constraints.
        model: ``pin.Model``.
        data: ``pin.Data`` of the run.
    """

    def __init__(self, plan: Plan, model: Any, data: Any) -> None:
        """Allocate everything once."""
        self.plan = plan
        self.model = model
        self.data = data
        self.work = np.zeros(plan.size)
        head = plan.words[: _layout.PLAN_WORDS].view(_layout.PLAN)[0]
        nv, rows = int(head["nv"]), int(head["rows"])
        self.rows, self.nv = rows, nv

        def part(name: str, *shape: int) -> Array:
            at = int(head[name])
            return self.work[at : at + int(np.prod(shape))].reshape(shape)

        #: J, in metres; what accelerations lack; residuals; multipliers.
        self.jacobian = part("jacobian", rows, nv)
        self.gap, self.speed, self.force = part("gap", rows), part("speed", rows), part("force", rows)
        self.lack = part("lack", rows)
        self.triangle, self.order = part("triangle", rows, rows), part("order", rows)
        #: What is left of each row's length over its scale, and the scale.
        self.shares = part("lengths", rows, 2)
        self._found = part("found", _layout.FOUND_WORDS).view(_layout.FOUND)
        self._step = np.zeros(nv)
        bodies, closures = int(head["bodies"]), int(head["closures"])
        self._places = self.work[: _layout.PLACE_WORDS * bodies].view(PLACE)
        at = _layout.PLAN_WORDS + _layout.BODY_WORDS * bodies
        to = at + _layout.CLOSURE_WORDS * closures
        self._closures = plan.words[at:to].view(_layout.CLOSURE)
        self._on_axes = self._axes_of_rows()
        #: Closures that hold two axes at right angles: number and row of that.
        self._squares = [
            (c, int(one["row"]) + int(one["rows"]) - 1)
            for c, one in enumerate(self._closures)
            if one["square"]
        ]
        slides = plan.words[to:].view(_layout.DRIVEN)["slides"]
        #: By what the rows of motions are multiplied.
        self.motion_scales = np.where(slides != 0, 1.0, plan.length)

    @property
    def found(self) -> Found:
        """What the last solution found."""
        return Found._make(self._found.item())

    @property
    def residual(self) -> tuple[float, float, float, float]:
        """The largest residuals of the rows that were written last [m], [rad], [m/s], [rad/s]."""
        found = self.found
        return found.gap, found.turn, found.speed, found.spin

    def bind(self, y: Array, program: Array, effort: Array, rates: Array) -> Callable[[float], None]:
        """Return the accelerations of a state held in an array, and powers of motions, as a function of time.

        Args:
            y: State [q, v, x]; read at each call.
            program: Of the system's elements; read at each call.
            effort: Generalized force of the elements, (nv,); read at each call.
            rates: Written at each call, (nv + nx,).
        """
        nq = self.model.nq
        q, v = y[:nq], y[nq : nq + self.nv]
        model, data, plan, work = self.model, self.data, self.plan.words, self.work
        crba, bias, accelerate = pin.crba, pin.nonLinearEffects, _solve_kernels.accelerate

        def solve(t: float) -> None:
            mass = crba(model, data, q)
            accelerate(t, y, program, plan, work, effort, mass, bias(model, data, q, v), rates)

        return solve

    def residuals(self, t: float, y: Array, program: Array) -> Found:
        """Write the rows of a state; return what is found, with the largest residuals."""
        _rows_kernels.write_rows(t, y, program, self.plan.words, self.work)
        return self.found

    def factorize(self, q: Array) -> None:
        """Factorize the rows that were written last."""
        _solve_kernels.factorize(self.plan.words, self.work, pin.crba(self.model, self.data, q))

    def step(self, *, of_speed: bool) -> Array:
        """Return the generalized step that takes the residuals away, least in kinetic energy, (nv,).

        The rows must be factorized. The array is the same each time.
        """
        _solve_kernels.correction(self.plan.words, self.work, of_speed, self._step)
        return self._step

    def closed_at(self, t: float, y: Array, program: Array) -> bool:
        """Whether the residuals of a state are round-off, of positions and of velocities."""
        self.residuals(t, y, program)
        return self._in_place() and self._in_motion()

    def _in_place(self) -> bool:
        found = self.found
        return bool(found.gap <= CLOSED * self.plan.length and found.turn <= CLOSED)

    def _in_motion(self) -> bool:
        found = self.found
        return bool(found.speed <= CLOSED * self.plan.length and found.spin <= CLOSED)

    def project(self, t: float, y: Array, program: Array, retract: Callable[[Array, Array], None]) -> bool:
        """Bring a state that is nearly there onto the constraints, in place.

        Corrections are the least ones in kinetic energy: momentum stays.

        Args:
            t: Time [s].
            y: State [q, v, x].
            program: Of the system's elements.
            retract: ``(y, step)``: moves the configuration in y by a generalized step.

        Returns:
            Whether it is closed; if not, the state is of no use.
        """
        nq, nv = self.model.nq, self.nv
        self.residuals(t, y, program)
        at_rest = self._in_place()
        length = self.plan.length
        last = max(self.found.gap, self.found.turn * length)
        # The rows hardly turn over such a correction: one factorization serves it all, else there is another.
        near = last < NEAR * length
        self.factorize(y[:nq])
        for _ in range(ROUNDS):
            if at_rest:
                break
            retract(y, self.step(of_speed=False))
            found = self.residuals(t, y, program)
            now = max(found.gap, found.turn * length)
            at_rest = self._in_place() or now > 0.5 * last
            last = now
            if not near:
                self.factorize(y[:nq])
        y[nq : nq + nv] += self.step(of_speed=True)
        return bool(last <= OPEN * length)

    def least_forces(self) -> Array:
        """Return the multipliers of least norm that do what those of the last solution do, (rows,).

        Redundant rows share what their independent ones would carry alone. A turn's row counts with its
        moment over the plan's length.
        """
        rank = self.found.rank
        order = self.order.astype(int)
        independent, others = order[:rank], order[rank:]
        if len(others) == 0:
            return self.force.copy()
        triangle = self.triangle[:rank]
        share = np.linalg.solve(triangle[:, independent], triangle[:, others])
        # (1 + S S^T)^-1 = 1 - S (1 + S^T S)^-1 S^T, and of redundant rows there are few.
        forces = np.zeros(self.rows)
        given = share.T @ self.force[independent]
        fewer = np.linalg.solve(np.eye(len(others)) + share.T @ share, given)
        forces[independent], forces[others] = self.force[independent] - share @ fewer, fewer
        return forces

    def motion_forces(self, forces: Array) -> Array:
        """Return the forces [N] and torques [N m] that hold the motions, (motions,).

        Args:
            forces: Multipliers, (rows,).
        """
        return np.asarray(forces[: len(self.motion_scales)] * self.motion_scales)

    def wrenches(self, forces: Array) -> Array:
        """Return force [N] and moment [N m] of each closure on its second link, (closures, 2, 3).

        In axes of the first side's frame, the moment about the second side's point.

        Args:
            forces: Multipliers of the state that was solved last, (rows,).
        """
        found = np.zeros((len(self._closures), 2, 3))
        rows, places, scales = self._on_axes
        found.reshape(-1)[places] = scales * forces[rows]
        for c, row in self._squares:
            closure = self._closures[c]
            first = self._rotation(int(closure["first"])) @ closure["first_rotation"]
            second = self._rotation(int(closure["second"])) @ closure["second_rotation"]
            (ax, ay, az), (bx, by, bz) = first[:, 2], second[:, 2]
            direction = np.array([by * az - bz * ay, bz * ax - bx * az, bx * ay - by * ax]) @ first
            found[c, 1] = self.plan.length * forces[row] * direction
        return found

    def _axes_of_rows(self) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
        """Return of each row that is a component of a wrench: itself, its place among these, its scale."""
        found = []
        for c, closure in enumerate(self._closures):
            held = [6 * c + k for k in np.flatnonzero(closure["along"])]
            held += [6 * c + 3 + k for k in np.flatnonzero(closure["about"])]
            scales = [1.0 if place % 6 < 3 else self.plan.length for place in held]
            found += list(zip(range(int(closure["row"]), self.rows), held, scales, strict=False))
        rows, places, scale = zip(*found, strict=True) if found else ((), (), ())
        return np.array(rows, dtype=int), np.array(places, dtype=int), np.array(scale, dtype=float)

    def _rotation(self, body: int) -> Array:
        """Return the rotation of a body in the world, (3, 3)."""
        return np.eye(3) if body < 0 else np.asarray(self._places[body]["rotation"])
