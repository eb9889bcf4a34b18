"""What is looked at between the steps of a run: whether it may go on, and what its user is to know."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.interruption import FunctionInterrupted
from antenna_pin.compiled.compile_time import compiling_so_far
from antenna_pin.dynamics import Workspace
from antenna_pin.errors import FunctionError, LongRunWarning, StiffRunWarning
from antenna_pin.integrate import Stepper
from antenna_pin.simulation.control import StepControl
from antenna_pin.simulation.events import Event
from antenna_pin.simulation.expected import Expected, rough, turning
from antenna_pin.simulation.given_courses import GivenCourses
from antenna_pin.simulation.questions import called_functions
from antenna_pin.simulation.repeatable import Repeatable
from antenna_pin.simulation.stiffness import Stiffness
from antenna_pin.simulation.stretches import Made
from antenna_pin.simulation.witness import failure_in
from antenna_pin.trajectory import Outcome

__all__ = ["Oversight"]

Array = NDArray[np.float64]

# Share of steps that are rejected, or end where something happens, from which on they take the time.
_MANY = 0.2
_WAY_OUT = "; integrator.max_wall_time ends a run in time, and keeps what it has"


def _without_compiling(made: Made) -> Made:
    return made._replace(wall=made.wall - compiling_so_far())


class Oversight:
    """Looks at a run between its steps; what it works on is not changed.

    Args:
        workspace: What the run works on.
        control: Knows its method and limits.
        events: What it looks for.
    """

    def __init__(self, workspace: Workspace, control: StepControl, events: Sequence[Event]) -> None:
        """Begin without a look."""
        self._workspace, self._control = workspace, control
        self._expected = Expected(control.end)
        self._slow, self._began = "", 0.0
        self._repeatable = Repeatable(workspace, events)
        self._courses = GivenCourses(workspace)
        self._stiffness = Stiffness(workspace, control.method, control.settings, control.end)

    @property
    def advice(self) -> str:
        """What the user is to know of the run; empty if nothing."""
        return self._stiffness.words

    def words(self, outcome: Outcome) -> str:
        """Return what of the advice belongs to the words on how a run has ended."""
        why = self.advice or self._slow
        return "" if outcome is Outcome.COMPLETED or not why else f"; {why}"

    def begin(self, t: float, y: Array, made: Made) -> None:
        """Look at the state that the run starts from: time [s], [q, v, x], and what it has made before."""
        self._began = made.wall
        self._expected.begin(t, _without_compiling(made))
        self._repeatable.look(t, y, 0)
        self._courses.look(t, made.tried)

    def look(self, t: float, y: Array, made: Made, interrupted: bool) -> tuple[Outcome | None, str]:
        """Return why the run may not go on, None if it may, and what of.

        Args:
            t: Time [s].
            y: State [q, v, x].
            made: What it has made so far.
            interrupted: Whether the user has stopped it.
        """
        limit = self._control.limit(made.tried, t, made.wall - self._began)
        if self._stiffness.look(t, y, made.tried):
            warnings.warn(f"at t = {t:.9g} s the run is {self.advice}", StiffRunWarning, stacklevel=2)
        if self._expected.look(t, _without_compiling(made)):
            known = self._slow or self.advice
            why = self._why(t, y)
            said = "what makes it slow was said" if why == known else why
            warnings.warn(f"{self._expected.words(t)}: {said}{_WAY_OUT}", LongRunWarning, stacklevel=2)
        elif limit is Outcome.NO_PROGRESS:
            self._expected.measure(t, _without_compiling(made))
            self._why(t, y)
        words = self._repeatable.look(t, y, made.evaluations)
        if words:
            return Outcome.FUNCTION_WITH_MEMORY, words
        words = self._courses.look(t, made.tried)
        if words:
            return Outcome.REFUSED, words
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

    def _why(self, t: float, y: Array) -> str:
        """Return in words what makes the run slow, as far as can be told."""
        pace, settings = self._expected, self._control.settings
        if not self.advice and self._control.method.adaptive:
            self._slow = rough(self._workspace, settings, t, y, pace.step)
            if not self._slow:
                self._slow = turning(self._workspace, y, pace.step)
            if not self._slow and pace.rejected > _MANY:
                self._slow = (
                    f"{100.0 * pace.rejected:.0f} % of its steps are rejected, as by a force that jumps: "
                    "friction that is not zero at rest, a drive that switches"
                )
            elif not self._slow and pace.relocated > _MANY:
                share = 100.0 * pace.relocated
                self._slow = f"{share:.0f} % of its steps end at an event or where a contact changes"
        usual = "loosen integrator.rtol" if self._control.method.adaptive else "take a longer integrator.step"
        if settings.engine == "pinocchio":
            usual += ", or take integrator.engine = 'compiled'"
        return self.advice or self._slow or usual

    def end(self, outcome: Outcome) -> tuple[Outcome | None, str]:
        """Return why a run that ends means nothing after all, None if it does, and what of."""
        if outcome in (Outcome.INTERRUPTED, Outcome.FUNCTION_WITH_MEMORY, Outcome.FUNCTION_FAILED):
            return None, ""  # what goes on is asked again; what is known is known
        words = self._repeatable.end()
        return (Outcome.FUNCTION_WITH_MEMORY if words else None), words
