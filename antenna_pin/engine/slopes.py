"""Derivatives of the rates of a compiled system along displacements of a state."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from antenna_pin.engine._slope_kernels import write_slopes
from antenna_pin.engine.compiled import CompiledStepper
from antenna_pin.engine.implicit import CompiledImplicitStepper
from antenna_pin.records import MEMORY

__all__ = ["Slopes"]

Array = NDArray[np.float64]


class Slopes:
    """Central differences of a system's rates, all of them in one call.

    Args:
        stepper: Whose system; its contact memory and program are those of the moment.
        bristles: Places in x of the bristles, (bristles,).
        weights: Of the differences at 1, 2, ... steps, of each kind, (kinds, points).
    """

    def __init__(
        self, stepper: CompiledStepper | CompiledImplicitStepper, bristles: NDArray[np.int64], weights: Array
    ) -> None:
        """Allocate once."""
        self._numbers, self._layout = stepper.numbers, stepper.manifold.layout
        self._bristles, self._weights = np.ascontiguousarray(bristles, dtype=np.int64), weights
        self._rows = np.zeros((2, stepper.manifold.size))
        self._kept = np.zeros(len(stepper.numbers.memory), MEMORY)
        self._rates = stepper.manifold.nv + stepper.manifold.nx

    def along(self, time: float, y: Array, ways: Array, steps: Array) -> Array:
        """Return the derivatives of [acceleration (nv), rate of x (nx)], (kinds, nv + nx, k).

        Args:
            time: [s].
            y: State.
            ways: Displacements as :mod:`antenna_pin.engine._slope_kernels` lays them out, (displacement, k).
            steps: Of the differences, over a displacement, (k,).
        """
        out = np.zeros((len(self._weights), ways.shape[1], self._rates))
        write_slopes(
            time,
            np.ascontiguousarray(y),
            np.ascontiguousarray(ways.T),
            steps,
            self._weights,
            self._layout,
            self._bristles,
            self._numbers,
            self._rows,
            self._kept,
            out,
        )
        return np.asarray(out.transpose(0, 2, 1))
