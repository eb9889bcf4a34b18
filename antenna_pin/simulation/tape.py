"""Steps that a run has made, for what looks at it where something has changed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Tape", "Taped"]

Array = NDArray[np.float64]


class Taped(NamedTuple):
    """A step, in which nothing changes.

    Attributes:
        time: When it begins [s].
        size: Of it [s].
        y: State where it begins.
        until: When it ends [s].
        end: State there, before what changes then.
    """

    time: float
    size: float
    y: Array
    until: float
    end: Array


class Tape:
    """Steps that a run has made since it was shown last.

    Attributes:
        steps: These, in their order.
    """

    def __init__(self) -> None:
        """Begin with none."""
        self.steps: list[Taped] = []

    def extend(self, time: float, y: Array, ends: tuple[Array, Array, Array]) -> None:
        """Put steps behind those that are there, each of which begins where the last one ends.

        Args:
            time: When the first begins [s].
            y: State there.
            ends: When each ends [s], its size [s], (n,) each, and the state there, (n, size); copied.
        """
        for until, size, end in zip(ends[0].tolist(), ends[1].tolist(), ends[2].copy(), strict=True):
            self.steps.append(Taped(time, size, y, until, end))
            time, y = until, end
