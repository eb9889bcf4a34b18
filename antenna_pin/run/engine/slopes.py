"""Derivatives of the rates of a compiled system along displacements of a state."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import MEMORY
from antenna_pin.compiled.decorators import in_python
from antenna_pin.dynamics.constraints.layout_kernels import plan_of
from antenna_pin.run.engine.compiled import CompiledStepper
from antenna_pin.run.engine.slope_kernels import Room, write_slopes

Array = NDArray[np.float64]


class Slopes:
    """Central differences of a system's rates, all of them in one call.

    Args:
        stepper: Stepper of the system, at its present contact memory and program.
        bristles: Places of the bristles in x, (bristles,).
        weights: Weights of the differences at 1, 2, ... steps, of each kind, (kinds, points).
    """

    def __init__(self, stepper: CompiledStepper, bristles: NDArray[np.int64], weights: Array) -> None:
        """Allocate once."""
        manifold, numbers = stepper.manifold, stepper.numbers
        self._answers = stepper.answers
        self._room = Room(
            weights=weights,
            layout=manifold.layout,
            bristles=np.ascontiguousarray(bristles, dtype=np.int64),
            numbers=numbers,
            rows=np.zeros((2, manifold.size)),
            kept=np.zeros(len(numbers.memory), MEMORY),
        )
        self._rates = manifold.nv + manifold.nx
        self._held = in_python(plan_of)(numbers.plan).rows if len(numbers.plan) else 0

    def rates(self, time: float, y: Array, ways: Array, steps: Array) -> Array:
        """Return the derivatives of [acceleration (nv), rate of x (nx)], (kinds, nv + nx, k).

        Args:
            time: [s].
            y: State.
            ways: Displacements in the layout of :mod:`antenna_pin.run.engine.slope_kernels`, (displacement,
                k).
            steps: Steps of the differences, (k,).
        """
        return self._written(False, self._rates, time, y, ways, steps)

    def speeds(self, time: float, y: Array, ways: Array, steps: Array) -> Array:
        """Return the derivatives of how fast constraints are violated, (kinds, rows, k), as :meth:`rates`."""
        return self._written(True, self._held, time, y, ways, steps)

    def _written(
        self, of_speeds: bool, count: int, time: float, y: Array, ways: Array, steps: Array
    ) -> Array:
        out = np.zeros((len(self._room.weights), ways.shape[1], count))
        y, ways = np.ascontiguousarray(y), np.ascontiguousarray(ways.T)
        write_slopes(time, y, ways, steps, of_speeds, self._room, out)
        self._answers.check()
        return np.asarray(out.transpose(0, 2, 1))
