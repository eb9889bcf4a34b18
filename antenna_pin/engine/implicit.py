"""Implicit steps of the compiled engine."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Workspace
from antenna_pin.engine.compiled import Compiled
from antenna_pin.engine.hold_kernels import MOVED
from antenna_pin.engine.implicit_kernels import attempt_implicit
from antenna_pin.engine.step_kernels import derivative
from antenna_pin.integrate import ImplicitStepper, Method

__all__ = ["CompiledImplicitStepper"]

Array = NDArray[np.float64]


class CompiledImplicitStepper(ImplicitStepper):
    """An implicit stepper each of whose steps is one call of compiled code.

    Args:
        workspace: What the run works on.
        compiled: Its system in numbers.
        method: The method.
        scales: As for :class:`antenna_pin.integrate.Stepper`.
        rtol: Likewise.
    """

    def __init__(
        self, workspace: Workspace, compiled: Compiled, method: Method, scales: Array, rtol: float
    ) -> None:
        """Allocate the work space once."""
        super().__init__(workspace, method, scales, rtol)
        self.numbers = compiled.numbers
        self._asked = np.zeros(1, dtype=np.int64)
        y, rates, numbers = self.y, self._rates, self.numbers
        self._derivative = lambda t: derivative(t, y, numbers, rates, False)

    def attempt(self, h: float) -> float:
        """Try a step of size h [s]; return its scaled error."""
        self._asked[0] = 0
        error = attempt_implicit(
            self.t,
            h,
            self.method.stages,
            self.manifold.layout,
            self.work,
            self.scales,
            self.rtol,
            self.newton,
            self.numbers,
            self._asked,
        )
        self.evaluations += int(self._asked[0])
        self.h = h
        self.has_dense = False
        self._has_moved = bool(self.numbers.flag[0] == MOVED)
        if self._has_moved:
            self._moved[:] = self.numbers.moved
        return float(error)
