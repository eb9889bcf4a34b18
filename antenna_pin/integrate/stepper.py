"""One step of a Runge-Kutta method on a manifold, tried, measured and accepted or left without trace."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from antenna_pin.integrate import _kernels
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


class Stepper:
    """A state, and trial steps from it.

    ``attempt`` computes a trial step into ``y``; ``accept`` makes it the state; without ``accept`` the state and
    its derivative stay what they were, however many trials were made (the first stage is kept apart).

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
        self.y = np.zeros(size)
        self._rates = np.zeros(self.manifold.nv + self.manifold.nx)
        self._work = np.zeros((method.stages + 3, size))
        self.start = self._work[method.stages + 1]
        self.dense = np.zeros((method.polynomials.shape[1], size))
        self._scratch = np.zeros(size)
        self.t = 0.0
        self.h = 0.0
        self.evaluations = 0
        self._nodes = [float(c) for c in method.nodes]
        self._has_dense = False

    def restart(self, t: float, y: Array) -> None:
        """Make (t, y) the state and evaluate its derivative."""
        self.t = t
        self.y[:] = y
        self.problem.derivative(t, self.y, self._rates)
        self.evaluations += 1
        _kernels.begin(
            self.method.stages, self.manifold.sizes, self._work, self.y, self._rates, self.manifold.blocks
        )

    def refresh(self) -> None:
        """Evaluate the derivative at the present state again, after the problem itself has changed."""
        self.restart(self.t, self.start.copy())

    def attempt(self, h: float) -> float:
        """Try a step of size h [s]; return its scaled error (1 is the tolerance; 0 for a fixed-step method)."""
        method = self.method
        manifold = self.manifold
        sizes, blocks = manifold.sizes, manifold.blocks
        y, rates, work, weights = self.y, self._rates, self._work, method.weights
        derivative = self.problem.derivative
        stage = _kernels.stage
        t, nodes, last = self.t, self._nodes, method.last
        stage(1, h, weights, sizes, work, y, rates, blocks, False)
        for i in range(1, last):
            derivative(t + nodes[i] * h, y, rates)
            stage(i + 1, h, weights, sizes, work, y, rates, blocks, True)
        derivative(t + h, y, rates)
        self.evaluations += last
        self.h = h
        self._has_dense = False
        error: float = _kernels.finish(
            last, h, method.errors, sizes, work, y, rates, blocks, self.scales, self.rtol
        )
        return error if method.adaptive or not np.isfinite(error) else 0.0

    def prepare_dense(self) -> None:
        """Compute the dense output of the last trial step, with the stages it needs beyond the step's own."""
        if self._has_dense:
            return
        method = self.method
        manifold = self.manifold
        if method.stages > method.last + 1:
            keep = self.y.copy()
            keep_rates = self._rates.copy()
            for i in range(method.last + 1, method.stages):
                _kernels.stage(
                    i,
                    self.h,
                    method.weights,
                    manifold.sizes,
                    self._work,
                    self.y,
                    self._rates,
                    manifold.blocks,
                    i > method.last + 1,
                )
                self.problem.derivative(self.t + self._nodes[i] * self.h, self.y, self._rates)
                self.evaluations += 1
            _kernels.store(
                method.stages - 1, method.stages, manifold.sizes, self._work, self.y, self._rates, manifold.blocks
            )
            self.y[:] = keep
            self._rates[:] = keep_rates
        n = 2 * manifold.nv + manifold.nx
        _kernels.dense_coefficients(self.h, method.polynomials, n, self._work, self.dense)
        self._has_dense = True

    def interpolate(self, theta: float, out: Array) -> None:
        """Write the state at the fraction theta of the last trial step into out (see ``prepare_dense``)."""
        _kernels.dense_state(
            theta,
            self.dense.shape[0],
            self.manifold.sizes,
            self.dense,
            self.start,
            self.manifold.blocks,
            self._scratch,
            out,
        )

    def accept(self) -> None:
        """Make the trial step the state."""
        self.t += self.h
        self._has_dense = False
        _kernels.begin(
            self.method.stages, self.manifold.sizes, self._work, self.y, self._rates, self.manifold.blocks
        )
