"""Run with a moving end, and the snapshots to which it returns.

A step that the end of a run cuts differs from the step of a longer run. A run that continues without a change
therefore first returns to the snapshot before the cut: its numbers are those of one run, however often it
stops. After a command at its end the cut steps stay, as in one run whose steps end there.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.settings import RunSettings
from antenna_pin.base.state import State
from antenna_pin.control import Controller
from antenna_pin.dynamics import System
from antenna_pin.simulation.event_watch import Crossing
from antenna_pin.simulation.events import Event, Set, Stop
from antenna_pin.simulation.loop import Run
from antenna_pin.trajectory import Outcome

__all__ = ["OpenRun", "RecordSnapshot"]

Array = NDArray[np.float64]

# --- snapshots ----------------------------------------------------------------------------------------------


class RecordSnapshot:
    """The record of a run as it stands, to go back to; its steps stay where they are.

    Args:
        run: The run, between two steps.
    """

    def __init__(self, run: Run) -> None:
        """Keep what is not kept by anything that comes."""
        self._run = run
        self._samples, self._contacts = run.samples.snapshot(), run.contacts.snapshot()
        self._singular: Any = None if run.singular is None else run.singular.value()
        self._happened, self._changed = len(run.actions.happened), len(run.actions.modes.changed)
        self._ticks = run.controllers.counts()
        self._ended = run.outcome, run.message, run.left

    def restore(self) -> None:
        """Let the run have the record that it had."""
        run = self._run
        run.samples.restore(self._samples)
        run.contacts.restore(self._contacts)
        if run.singular is not None:
            run.singular.take_up(self._singular)
        del run.actions.happened[self._happened :], run.actions.modes.changed[self._changed :]
        run.controllers.cut(self._ticks)
        run.outcome, run.message, run.left = self._ended


class RunSnapshot:
    """A run as it stood at the beginning of a step, to go back to.

    Args:
        run: The run.
        state: Its state then; what is recorded since is nothing yet.
    """

    def __init__(self, run: Run, state: State) -> None:
        """Keep all of it."""
        self._run, self.state = run, state
        self._record = RecordSnapshot(run)
        self._numbers = run.actions.adjustments.kept()
        made = run.steps
        self._made = made.accepted, made.rejected, made.relocated, run.stepper.evaluations
        self._seen = run.control.paced, run.search.gap_difference

    def is_here(self) -> bool:
        """Whether the run stands at this state, with this record."""
        made = self._run.steps
        now = made.accepted, made.rejected, made.relocated, self._run.stepper.evaluations
        return now == self._made and self._run.stepper.t == self.state.time

    def left(self) -> State:
        """Return the state that the run leaves where it is now, if it goes on from here."""
        return dataclasses.replace(self.state, reached=self._run.stepper.t)

    def restore(self) -> None:
        """Let the run stand where it stood."""
        run = self._run
        run.actions.adjustments.go_back(self._numbers)
        run.take_up(self.state)
        self._record.restore()
        made = run.steps
        made.accepted, made.rejected, made.relocated, run.stepper.evaluations = self._made
        run.control.paced, run.search.gap_difference = self._seen
        run.control.renew(run.actions.adjustments.elements.values())
        run.left = None


# --- run with a moving end ----------------------------------------------------------------------------------

_MANY = 256  # samples from which on it is worth to let go of the old ones


class OpenRun:
    """A run whose end moves.

    Args:
        system: The system.
        start: A state that a run left, or a first one as [q, v, x], as a :class:`Run` takes them.
        settings: How to integrate and sample.
        events: What to look for besides contacts.
        window: How much of the past is kept at least [s].
        controllers: What commands it at instants of its own, by name.

    Attributes:
        run: The run itself, which stands where it was told to go.
    """

    def __init__(
        self,
        system: System,
        start: NDArray[np.float64] | State,
        settings: RunSettings,
        events: Sequence[Event] = (),
        window: float = math.inf,
        controllers: Mapping[str, Controller] = MappingProxyType({}),
    ) -> None:
        """Bring it to where the state was reached that it starts from."""
        self.run = Run(system, start, math.inf, settings, events, controllers=controllers)
        self.run.listener = self
        self._events, self._window = tuple(events), window
        #: Where its present end began to cut steps, if it has; where it has just gone back to.
        self._cut: RunSnapshot | None = None
        self._again: RunSnapshot | None = None
        self._sought = -1  # number of the event that it is to end at
        self._error = 0.0  # scaled, of the last step but one that is tried
        if isinstance(start, State) and start.time < start.reached:
            self.run.go_to(start.reached)

    @property
    def time(self) -> float:
        """Where it stands [s]."""
        return self.run.stepper.t

    @property
    def state(self) -> State:
        """The state that it leaves: one to go on from."""
        return self.run.present() if self._cut is None else self._cut.left()

    def go_to(self, end: float, interrupted: Callable[[], bool] = lambda: False) -> None:
        """Go to a time [s] later than the present one, or to what ends the run earlier."""
        self._go_back()
        self.run.go_to(end, interrupted)

    def go_until(self, event: Event, end: float, interrupted: Callable[[], bool] = lambda: False) -> bool:
        """Go to where an event happens next, to a time [s] or to what ends the run earlier.

        Returns:
            Whether it has happened. What is done then is nothing, and the event leaves no trace.
        """
        run = self.run
        self._go_back()
        self._again, self._sought = None, len(self._events)
        self._error = run.control.error
        run.look_for((*self._events, dataclasses.replace(event, action=Stop())), singly=True)
        try:
            run.go_to(end, interrupted)
        finally:
            happened = run.outcome is Outcome.STOPPED and run.actions.happened[-1].name == event.name
            run.actions.happened[:] = [one for one in run.actions.happened if one.name != event.name]
            if happened:
                self.may_go_on()
            self._sought = -1
            run.look_for(self._events, singly=False)
        return happened

    def command(self, name: str, action: Set) -> None:
        """Change a number at the present state, as an event of this name would that happened here.

        Raises:
            AntennaPinError: There is no such number, or it cannot have this value; nothing is changed.
        """
        self.run.obey(name, action)
        self._cut = self._again = self.run.left = None

    def may_go_on(self) -> None:
        """Let it go on that was ended by its user."""
        self.run.outcome, self.run.message = Outcome.COMPLETED, Outcome.COMPLETED.value

    def _go_back(self) -> None:
        if self._cut is not None:
            self._cut.restore()
        self._cut, self._again = None, self._cut

    # --- what the run foresees ------------------------------------------------------------------------------

    def step(self) -> None:
        """Note what the next trial step will change that is its beginning's."""
        self._error = self.run.control.error

    def end(self) -> State:
        """Keep the run as it stands: its end cuts the next step."""
        if self._again is None or not self._again.is_here():
            if self._window < math.inf:
                self._forget()
            self._again = RunSnapshot(self.run, self.run.present())
        self._cut = self._again
        return self._cut.state

    def events(self, ahead: Sequence[Sequence[Crossing]]) -> None:
        """Keep the run as it stands, if what it is to end at is in the next step."""
        sought = any(one.event == self._sought for group in ahead for one in group)
        if sought and self._cut is None:
            state = dataclasses.replace(self.run.present(), error=self._error)
            self._cut = RunSnapshot(self.run, state)
            self.run.left = state

    def _forget(self) -> None:
        """Let go of a past that is not asked for."""
        run = self.run
        begin = self.time - self._window
        if len(run.samples.times) < _MANY or not 2.0 * begin - self.time >= run.samples.times[0]:
            return
        run.begin = run.after = begin = run.samples.forget_before(begin)
        run.contacts.forget_before(begin)
        run.steps.record_from(begin)
        run.controllers.forget_before(begin)
        actions = run.actions
        actions.happened[:] = [one for one in actions.happened if one.time > begin]
        actions.modes.changed[:] = [one for one in actions.modes.changed if one.time > begin]
