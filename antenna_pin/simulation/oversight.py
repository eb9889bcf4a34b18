"""What is looked at between the steps of a run: whether it may go on, and what its user is to know."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Workspace
from antenna_pin.errors import FunctionError, StiffRunWarning
from antenna_pin.integrate import Stepper
from antenna_pin.interruption import FunctionInterrupted
from antenna_pin.simulation.control import StepControl
from antenna_pin.simulation.events import Event
from antenna_pin.simulation.questions import called_functions
from antenna_pin.simulation.repeatable import Repeatable
from antenna_pin.simulation.stiffness import Stiffness
from antenna_pin.simulation.witness import failure_in
from antenna_pin.trajectory import Outcome

__all__ = ["Oversight"]

Array = NDArray[np.float64]


class Oversight:
    """Looks at a run between its steps; what it works on is not changed.

    Args:
        workspace: What the run works on.
        control: Knows its method and limits.
        events: What it looks for.
    """

    def __init__(self, workspace: Workspace, control: StepControl, events: Sequence[Event]) -> None:
        """Begin without a look."""
        self._control, self._workspace = control, workspace
        self._repeatable = Repeatable(workspace, events)
        self._stiffness = Stiffness(workspace, control.method, control.settings, control.end)

    @property
    def advice(self) -> str:
        """What the user is to know of the run; empty if nothing."""
        return self._stiffness.words

    def words(self, outcome: Outcome) -> str:
        """Return what of the advice belongs to the words on how a run has ended."""
        return "" if outcome is Outcome.COMPLETED or not self.advice else f"; {self.advice}"

    def begin(self, t: float, y: Array) -> None:
        """Look at the state that the run starts from: time [s], [q, v, x]."""
        self._repeatable.look(t, y, 0)

    def look(
        self, t: float, y: Array, counts: tuple[int, int], wall: float, interrupted: bool
    ) -> tuple[Outcome | None, str]:
        """Return why the run may not go on, None if it may, and what of.

        Args:
            t: Time [s].
            y: State [q, v, x].
            counts: Trial steps and evaluations made so far.
            wall: Wall time they took [s].
            interrupted: Whether the user has stopped it.
        """
        made, evaluations = counts
        limit = self._control.limit(made, t, wall)
        if self._stiffness.look(t, y, made, wall):
            warnings.warn(f"at t = {t:.9g} s the run is {self.advice}", StiffRunWarning, stacklevel=2)
        words = self._repeatable.look(t, y, evaluations)
        if words:
            return Outcome.FUNCTION_WITH_MEMORY, words
        return Outcome.INTERRUPTED if interrupted else limit, ""

    @contextmanager
    def listening(self, stop: Callable[[Outcome, str], bool]) -> Iterator[None]:
        """End the run where a function of its user's has no answer, or is interrupted: what it has is whole.

        Args:
            stop: Ends the run, for a reason and in words.
        """
        try:
            yield
        except FunctionError as error:
            stop(Outcome.FUNCTION_FAILED, f", {error.seen}")
        except FunctionInterrupted:
            stop(Outcome.INTERRUPTED, "")

    def failure_in(self, stepper: Stepper, h: float) -> FunctionError | None:
        """Return what a function that kernels call has failed by, in a step of size h [s] from a state."""
        called = called_functions(self._repeatable.asked)
        return failure_in(called, self._workspace.program, stepper, h) if called else None

    def end(self, outcome: Outcome) -> tuple[Outcome | None, str]:
        """Return why a run that ends means nothing after all, None if it does, and what of."""
        if outcome in (Outcome.INTERRUPTED, Outcome.FUNCTION_WITH_MEMORY, Outcome.FUNCTION_FAILED):
            return None, ""  # what goes on is asked again; what is known is known
        words = self._repeatable.end()
        return (Outcome.FUNCTION_WITH_MEMORY if words else None), words
