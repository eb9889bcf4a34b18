"""What elements take between two of their changes, as a stop that gives way from touch to release.

An element tells then what it has integrated since: a loss, an impulse. Neighbours' integrals are those at
their own instants, ``B + L dt`` of what is integrated at a rate L and displaced by B at equal times.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import System, acting_in, kernels
from antenna_pin.elements import Change, Met
from antenna_pin.nonlinear.saltation import Meeting
from antenna_pin.simulation.element_events import ModeEffect

__all__ = ["Taken"]

Array = NDArray[np.float64]


class Taken:
    """Differentiates what elements tell of their integrals where they change.

    Args:
        system: The system.
    """

    def __init__(self, system: System) -> None:
        """Begin before any change."""
        self._first = {
            one.place: int(system.program[one.block :][: kernels.PARAMETERS].view(kernels.ELEMENT)[0]["x"])
            for one in acting_in(system)
        }
        #: Of each element how its integrals were displaced when it last kept them, (integrals, parameters).
        self._kept: dict[str, Array] = {}

    def of(self, one: ModeEffect, met: Meeting, time: float, x: Array, books: Array) -> Array:
        """Return by how much more is lost, and what impulse is given, of a change, (2, parameters).

        Args:
            one: The change.
            met: How its joint was met.
            time: When [s].
            x: What is integrated, so far, (nx,).
            books: How that is displaced, at the neighbours' own instants, (nx, parameters).
        """
        first, count = self._first[one.place], len(one.before.integrals)
        here = slice(first, first + count)

        def changed(more: Array) -> Change | None:
            own = tuple((x[here] + more).tolist())
            return one.change(one.before, Met(time, met.angle, met.rate, 0.0, own))

        out, base = np.zeros((2, books.shape[1])), changed(np.zeros(count))
        if base is None:
            return out
        for k, more in enumerate(np.eye(count)):
            other = changed(more)  # all of it is linear in integrals
            if other is None:
                continue
            if other.memory != base.memory:
                self._kept[one.place] = books[here]
            kept = self._kept.get(one.place, np.zeros((count, books.shape[1])))
            for row, name in zip(out, ("loss", "impulse"), strict=True):
                row += (getattr(other, name) - getattr(base, name)) * (books[here] - kept)[k]
        return out
