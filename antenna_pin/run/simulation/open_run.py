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
from antenna_pin.dynamics import System
from antenna_pin.elements.control import Controller
from antenna_pin.run.simulation.event_watch import ZeroCrossing
from antenna_pin.run.simulation.events import Event, Set, Stop
from antenna_pin.run.simulation.loop import Run
from antenna_pin.trajectory import Outcome

Array = NDArray[np.float64]

# --- snapshots ----------------------------------------------------------------------------------------------


class RecordSnapshot:
    """Snapshot of the record of a run; its steps stay as they are."""

    def __init__(self, run: Run) -> None:
        """Copy the data that later steps change."""
        self._run = run
        self._samples, self._contacts = run.samples.snapshot(), run.contacts.snapshot()
        self._singular: Any = None if run.singular is None else run.singular.value()
        self._happened, self._changed = len(run.actions.happened), len(run.actions.modes.changed)
        self._touches = run.actions.modes.peaks.numbers.copy()
        self._ticks = run.controllers.counts()
        self._ended = run.outcome, run.message, run.left

    def restore(self) -> None:
        """Restore the record."""
        run = self._run
        run.samples.restore(self._samples)
        run.contacts.restore(self._contacts)
        if run.singular is not None:
            run.singular.take_up(self._singular)
        del run.actions.happened[self._happened :], run.actions.modes.changed[self._changed :]
        run.actions.modes.peaks.numbers[:] = self._touches
        run.controllers.cut(self._ticks)
        run.outcome, run.message, run.left = self._ended


class RunSnapshot:
    """Snapshot of a run at the beginning of a step."""

    def __init__(self, run: Run, state: State) -> None:
        """Copy the data that later steps change."""
        self._run, self.state = run, state
        self._record = RecordSnapshot(run)
        self._numbers = run.actions.adjustments.snapshot()
        made = run.steps
        self._made = made.accepted, made.rejected, made.relocated, run.stepper.evaluations
        self._seen = run.control.paced, run.search.difference[0]

    def is_here(self) -> bool:
        """Return whether the run is at this state, with this record."""
        made = self._run.steps
        now = made.accepted, made.rejected, made.relocated, self._run.stepper.evaluations
        return now == self._made and self._run.stepper.t == self.state.time

    def left(self) -> State:
        """Return the state that the run leaves if it continues from the snapshot."""
        return dataclasses.replace(self.state, reached=self._run.stepper.t)

    def restore(self) -> None:
        """Restore the run."""
        run = self._run
        run.actions.adjustments.go_back(self._numbers)
        run.take_up(self.state)
        self._record.restore()
        made = run.steps
        made.accepted, made.rejected, made.relocated, run.stepper.evaluations = self._made
        run.control.paced, run.search.difference[0] = self._seen
        run.control.renew(run.actions.adjustments.elements.values())
        run.left = None


# --- run with a moving end ----------------------------------------------------------------------------------

_MANY = 256  # samples beyond which old ones are discarded


class OpenRun:
    """Run whose end moves.

    Args:
        start: State left by a run, or initial state [q, v, x], as for :class:`Run`.
        window: Time span of the past that is kept at least [s].

    Attributes:
        run: Run at its present end.
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
        """Begin at the state, and advance to the time at which it was left."""
        self.run = Run(system, start, math.inf, settings, events, controllers=controllers)
        self.run.listener = self
        self._events, self._window = tuple(events), window
        #: Snapshot before the steps that the present end cuts, if any; snapshot last returned to.
        self._cut: RunSnapshot | None = None
        self._again: RunSnapshot | None = None
        self._sought = -1  # number of the event at which to stop
        self._error = 0.0  # scaled error of the last step before the present batch
        if isinstance(start, State) and start.time < start.reached:
            self.run.go_to(start.reached)

    @property
    def time(self) -> float:
        """Present time [s]."""
        return self.run.stepper.t

    @property
    def state(self) -> State:
        """State from which another run can continue."""
        return self.run.present() if self._cut is None else self._cut.left()

    def go_to(self, end: float, interrupted: Callable[[], bool] = lambda: False) -> None:
        """Run to a later time [s], or to an earlier stop."""
        self._go_back()
        self.run.go_to(end, interrupted)

    def go_until(self, event: Event, end: float, interrupted: Callable[[], bool] = lambda: False) -> bool:
        """Run to the next occurrence of an event, a time [s] or an earlier stop.

        Returns:
            Whether the event has occurred. Its actions are not carried out, and it leaves no trace.
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
        """Change a number at the present state, recorded as an event of this name.

        Raises:
            AntennaPinError: An unknown number, or an impossible value; nothing is changed.
        """
        self.run.obey(name, action)
        self._cut = self._again = self.run.left = None

    def may_go_on(self) -> None:
        """Allow a run that its user ended to continue."""
        self.run.outcome, self.run.message = Outcome.COMPLETED, Outcome.COMPLETED.value

    def _go_back(self) -> None:
        if self._cut is not None:
            self._cut.restore()
        self._cut, self._again = None, self._cut

    # --- listener -------------------------------------------------------------------------------------------

    def step(self) -> None:
        """Store the error of the step before the next batch."""
        self._error = self.run.control.error

    def end(self) -> State:
        """Take a snapshot before the step that the end cuts; return its state."""
        if self._again is None or not self._again.is_here():
            if self._window < math.inf:
                self._forget()
            self._again = RunSnapshot(self.run, self.run.present())
        self._cut = self._again
        return self._cut.state

    def events(self, ahead: Sequence[Sequence[ZeroCrossing]]) -> None:
        """Take a snapshot if the goal of the run is in the trial step."""
        sought = any(one.event == self._sought for group in ahead for one in group)
        if sought and self._cut is None:
            state = dataclasses.replace(self.run.present(), error=self._error)
            self._cut = RunSnapshot(self.run, state)
            self.run.left = state

    def _forget(self) -> None:
        """Discard the past beyond the window."""
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
