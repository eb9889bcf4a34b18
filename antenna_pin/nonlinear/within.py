"""States within a step that a run has made, and where rates break among them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Workspace
from antenna_pin.integrate import method_named
from antenna_pin.nonlinear.breaks import SAMPLES, located
from antenna_pin.nonlinear.field import Field
from antenna_pin.nonlinear.frames import Frame
from antenna_pin.nonlinear.missed import Kink
from antenna_pin.nonlinear.pieces import Piece
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.steps import stepper_of

__all__ = ["Within", "kink_in"]

Array = NDArray[np.float64]


class Within:
    """States within a step of a run: the step is made again where they are asked for.

    Args:
        run: The run.

    Attributes:
        workspace: Its contact memory and program are those of the step.
        time: When the step begins [s].
        size: How long it is [s].
    """

    def __init__(self, run: Run) -> None:
        """Allocate once."""
        self.workspace = Workspace(run.system)
        method = method_named(run.settings.method)
        self._dense = stepper_of(self.workspace, method, run.stepper.scales, run.settings)
        self.time, self.size = run.stepper.t, 0.0
        self._first = run.here.copy()
        self._end: Array | None = None
        self._made = False

    @property
    def touching(self) -> NDArray[Any]:
        """Which contacts touch in the step, 0 or not, (contacts,)."""
        return np.asarray(self.workspace.memory["touching"])

    def take_over(self, run: Run) -> None:
        """Take the contact memory and the program of a run, for the step that follows."""
        memory, program = run.workspace.memory, run.workspace.program
        self.workspace.memory[:], self.workspace.program[:] = memory, program

    def begin(self, time: float, y: Array, size: float, end: Array | None) -> None:
        """Take up a step.

        Args:
            time: When it begins [s].
            y: State there.
            size: Its size [s].
            end: State at its end; None if that is not known but from the step.
        """
        self.time, self._first, self.size, self._end = time, y, size, end
        self._made = False

    def at(self, theta: float) -> Array:
        """Return the state at a fraction of the step."""
        if theta == 0.0:
            return self._first
        if theta == 1.0 and self._end is not None:
            return self._end
        if not self._made:
            self._dense.restart(self.time, self._first)
            self._dense.attempt(self.size)
            self._dense.prepare_dense()
            self._made = True
        y = np.zeros_like(self._first)
        self._dense.interpolate(theta, y)
        return y


def kink_in(
    piece: Piece,
    between: tuple[int, int],
    seen: list[tuple[Array, float]],
    within: Within,
    by: tuple[Field, Frame, Array, Array],
) -> tuple[float, Kink] | None:
    """Return where rates break between two samples of a piece, as a fraction of the step, or None.

    Args:
        piece: The part of the step.
        between: Which of :data:`antenna_pin.nonlinear.breaks.SAMPLES`.
        seen: What rates are along a displacement at each of them, first.
        within: States within the step.
        by: The rates, the axes of coordinates, the displacement, and that in coordinates.
    """
    field, frame, way, unit = by

    def looked(place: float, look: Callable[[float, Array, Array], tuple[Array, float]]) -> Array:
        (theta,), (slope,) = piece.at(np.array([place]))
        there = within.time + float(theta) * within.size, within.at(float(theta))
        return float(slope) * look(*there, way)[0]

    low, high = between
    found = located(
        lambda place: looked(place, field.across_kinks),
        lambda place: looked(place, field.along_way),
        float(SAMPLES[low]),
        float(SAMPLES[high]),
        seen[low][0],
        seen[high][0],
    )
    if found is None:
        return None
    (cut, before, behind), (slope, *_) = piece.at(np.array([found.place, *found.beside]))
    one, other = (
        field.matrix(frame, within.time + s * within.size, within.at(s), way).sixth
        for s in (float(before), float(behind))
    )
    step = field.across_kinks(within.time + cut * within.size, within.at(float(cut)), way)[1]
    later = found.later * slope * (piece.b - piece.a) * within.size / step
    return float(cut), Kink.of(other - one, unit, later)
