"""Steps of an implicit method, Radau IIA of order 5, for contact so stiff that explicit steps collapse."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.integrate import newton_kernels as _newton
from antenna_pin.integrate import radau_kernels as kernels
from antenna_pin.integrate.methods import Method
from antenna_pin.integrate.stepper import Problem, Stepper

__all__ = ["ImplicitStepper", "made_stepper", "newton_of"]

Array = NDArray[np.float64]

# From the coordinates in which A^-1 parts into a number and a pair to the stages' (Hairer and Wanner 1996,
# IV.8, and their program RADAU5).
_BACK = (
    (9.1232394870892942792e-02, -0.14125529502095420843, -3.0029194105147424492e-02),
    (0.24171793270710701896, 0.20412935229379993199, 0.38294211275726193779),
    (0.96604818261509293619, 1.0, 0.0),
)


def newton_of(method: Method, size: int, columns: NDArray[np.int64]) -> _newton.Radau:
    """Return what the kernels solve the equations of a step with.

    Args:
        method: Radau IIA.
        size: Components of z.
        columns: Those that the derivative depends on, increasing.
    """
    root, third = math.sqrt(6.0), np.cbrt(3.0)
    m = len(columns)
    return _newton.Radau(
        progress=np.zeros(1, _newton.PROGRESS),
        nodes=np.ascontiguousarray(method.nodes[1:4]),
        inverse=np.linalg.inv(method.weights[1:4, 1:4]),
        back=np.array(_BACK),
        forth=np.linalg.inv(np.array(_BACK)),
        values=np.array(
            [
                3.0 + third**2 - third,
                3.0 + 0.5 * (third - third**2),
                0.5 * math.sqrt(3.0) * (third + third**2),
            ]
        ),
        error=np.array([-13.0 - 7.0 * root, -13.0 + 7.0 * root, -1.0]) / 3.0,
        columns=np.ascontiguousarray(columns, dtype=np.int64),
        z=np.zeros((3, size)),
        w=np.zeros((3, size)),
        f=np.zeros((3, size)),
        jacobian=np.zeros((size, m)),
        real=np.zeros((m, m)),
        complex=np.zeros((m, m), dtype=complex),
        pivots=np.zeros((2, m), dtype=np.int64),
        solved=np.zeros(m),
        paired=np.zeros(m, dtype=complex),
    )


class ImplicitStepper(Stepper):
    """A stepper for stiff problems: its steps are as long as the solution is smooth, whatever decays.

    The Jacobian, by differences, is that of the step's start. A problem may name the plain numbers that its
    derivative depends on as ``coupled``, places in x; else it is taken to depend on all.

    Args:
        problem: The differential equation.
        method: Radau IIA of order 5.
        scales: As for :class:`Stepper`.
        rtol: Likewise.
    """

    def __init__(self, problem: Problem, method: Method, scales: Array, rtol: float) -> None:
        """Allocate the work space once."""
        super().__init__(problem, method, scales, rtol)
        twice, nx = 2 * self.manifold.nv, self.manifold.nx
        coupled: Any = getattr(problem, "coupled", range(nx))
        columns = np.array([*range(twice), *(twice + k for k in sorted(coupled))], dtype=np.int64)
        self.newton = newton_of(method, twice + nx, columns)

    def restart(self, t: float, y: Array) -> None:
        """Make (t, y) the state and evaluate its derivative."""
        super().restart(t, y)
        self.newton.progress["fresh"] = 0

    def accept(self) -> None:
        """Make the trial step the state."""
        super().accept()
        self.newton.progress["fresh"] = 0

    def attempt(self, h: float) -> float:
        """Try a step of size h [s]; return its scaled error: 1 is the tolerance.

        A step whose equations Newton's method does not solve has an error of 10.
        """
        newton, stages = self.newton, self.method.stages
        layout, work, scales, rtol = self.manifold.layout, self.work, self.scales, self.rtol
        progress = newton.progress[0]
        progress.phase = kernels.BEGIN
        self.h, self.has_dense = h, False
        while True:
            asked = kernels.go_on(self.t, h, stages, layout, work, scales, rtol, newton)
            if asked != kernels.ASK:
                break
            self._derivative(float(progress.t))
            self.evaluations += 1
        if asked == kernels.FAILED:
            return kernels.NOT_SOLVED
        self._has_moved = False
        if self._project is not None:
            self._moved[:] = self.y
            self._has_moved = self._project(self.t + h, self.y)
            if not math.isfinite(self.y[0]):
                return math.nan
        self._derivative(self.t + h)
        self.evaluations += 1
        return float(progress.error)


def made_stepper(problem: Problem, method: Method, scales: Array, rtol: float) -> Stepper:
    """Return the stepper that a method needs (:class:`Stepper` says what it is given)."""
    kind = ImplicitStepper if method.implicit else Stepper
    return kind(problem, method, scales, rtol)
