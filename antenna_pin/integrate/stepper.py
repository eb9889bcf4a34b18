"""One step of a Runge-Kutta method on a manifold, tried, measured and accepted or left without trace."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from antenna_pin.integrate import kernels
from antenna_pin.integrate.manifold import Manifold
from antenna_pin.integrate.methods import Method

__all__ = ["Problem", "Stepper"]

Array = NDArray[np.float64]


class Problem(Protocol):
    """What the integrator needs to know: a manifold and the derivative on it."""

    @property
    def manifold(self) -> Manifold:
        """The state space."""

    def derivative(self, t: float, y: Array, rates: Array) -> None:
        """Write [acceleration (nv), rate of x (nx)] at time t [s] and state y = [q, v, x] into rates."""


def _bound(problem: Problem, y: Array, rates: Array) -> Callable[[float], None]:
    """Return the derivative for two arrays that stay the same, by the problem's ``bind`` if it has one."""
    bind = getattr(problem, "bind", None)
    if bind is not None:
        function: Callable[[float], None] = bind(y, rates)
        return function
    return lambda t: problem.derivative(t, y, rates)


class Stepper:
    """A state, and trial steps from it.

    ``attempt`` computes a trial step into ``y``; ``accept`` makes it the state; without ``accept`` the state
    and its derivative stay what they were, however many trials were made (the first stage is kept apart).

    Args:
        problem: The differential equation.
        method: The method.
        scales: Absolute size of one unit of tolerance per component of [u, v, x], (2 nv + nx,): the error
            of a step counts against rtol (scale + |value|); an infinite scale leaves a component out.
        rtol: Relative tolerance [-].
    """

    def __init__(self, problem: Problem, method: Method, scales: Array, rtol: float) -> None:
        """Allocate the work space once."""
        self.problem = problem
        self.method = method
        self.manifold = problem.manifold
        self.scales = np.ascontiguousarray(scales, dtype=float)
        self.rtol = rtol
        size = self.manifold.size
        stages = method.stages
        self.work = np.zeros((stages + kernels.EXTRA_ROWS, size))
        self.y = self.work[stages + kernels.STATE]
        self._rates = self.work[stages + kernels.RATES, : self.manifold.nv + self.manifold.nx]
        self.start_row = stages + kernels.START
        self.start = self.work[self.start_row]
        self._derivative = _bound(problem, self.y, self._rates)
        self.dense = np.zeros((method.polynomials.shape[1], size))
        #: Room for a state of the dense output, (2, size).
        self.out = np.zeros((2, size))
        self.t = 0.0
        self.h = 0.0
        self.evaluations = 0
        #: Brings a state at a time onto what holds besides, in place; returns whether it moved.
        self._project: Callable[[float, Array], bool] | None = getattr(problem, "project", None)
        self._moved = np.zeros(size)
        self._has_moved = False
        self._nodes = [float(c) for c in method.nodes]
        self.has_dense = False

    def restart(self, t: float, y: Array) -> None:
        """Make (t, y) the state and evaluate its derivative."""
        self.t = t
        self.y[:] = y
        self._derivative(t)
        self.evaluations += 1
        self.has_dense = False
        kernels.begin(self.method.stages, self.manifold.layout, self.work)

    def refresh(self) -> None:
        """Evaluate the derivative at the present state again, after the problem itself has changed."""
        self.restart(self.t, self.start)

    def rates(self, t: float, y: Array) -> Array:
        """Return [acceleration (nv), rate of x (nx)] of any state; the trial step is lost by that."""
        self.y[:] = y
        self._derivative(t)
        self.has_dense = False
        return self._rates.copy()

    def attempt(self, h: float) -> float:
        """Try a step of size h [s]; return its scaled error: 1 is the tolerance, 0 if the step is fixed."""
        method = self.method
        layout, work, weights = self.manifold.layout, self.work, method.weights
        derivative, stage = self._derivative, kernels.stage
        t, nodes, last = self.t, self._nodes, method.last
        stage(1, h, weights, layout, work, False)
        for i in range(1, last):
            derivative(t + nodes[i] * h)
            stage(i + 1, h, weights, layout, work, True)
        if self._project is not None:
            self._moved[:] = self.y
            self._has_moved = self._project(t + h, self.y)
        derivative(t + h)
        self.evaluations += last
        self.h = h
        self.has_dense = False
        error: float = kernels.finish(last, h, method.errors, layout, work, self.scales, self.rtol)
        return error if method.adaptive or not math.isfinite(error) else 0.0

    def prepare_dense(self) -> None:
        """Compute the dense output of the last trial step, with the stages it needs beyond the step's own."""
        if self.has_dense:
            return
        method = self.method
        layout = self.manifold.layout
        if method.stages > method.last + 1:
            end = self.work[method.stages + kernels.STATE :].copy()
            for i in range(method.last + 1, method.stages):
                kernels.stage(i, self.h, method.weights, layout, self.work, i > method.last + 1)
                self._derivative(self.t + self._nodes[i] * self.h)
            self.evaluations += method.stages - method.last - 1
            kernels.store(method.stages - 1, method.stages, layout, self.work)
            self.work[method.stages + kernels.STATE :] = end
        n = 2 * self.manifold.nv + self.manifold.nx
        kernels.dense_coefficients(self.h, method.polynomials, n, self.work, self.dense)
        if self._has_moved:
            kernels.bend(layout, self._moved, self.y, self.dense)
        self.has_dense = True

    def interpolate(self, theta: float, out: Array) -> None:
        """Write the state at the fraction theta of the last trial step into out (see ``prepare_dense``)."""
        kernels.dense_state(theta, self.manifold.layout, self.dense, self.work, self.start_row, self.out)
        out[:] = self.out[0]

    def accept(self) -> None:
        """Make the trial step the state."""
        self.t += self.h
        self.has_dense = False
        kernels.begin(self.method.stages, self.manifold.layout, self.work)
