"""A run around the compiled loop: what begins and ends it, and what is seen to between and inside its steps.

Steps are made, searched for contacts that change, sampled and accepted in
:mod:`antenna_pin.engine.loop_kernels`, whatever engine it is; here is what is Python's: events of the user's
and what they do, progress, limits, checkpoints, and how a run ends.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.settings import RunSettings
from antenna_pin.base.state import State
from antenna_pin.control import Controller
from antenna_pin.dynamics import System, Workspace
from antenna_pin.dynamics.workspace import ON_SURFACE
from antenna_pin.engine import change_kernels
from antenna_pin.engine import loop_kernels as kernels
from antenna_pin.errors import MechanismError
from antenna_pin.integrate import method_named
from antenna_pin.simulation.actions import Actions
from antenna_pin.simulation.control import StepControl
from antenna_pin.simulation.ending import NeverSettlesError, message_of, no_step, too_deep, undetermined
from antenna_pin.simulation.episodes import Episodes
from antenna_pin.simulation.events import Event, Set
from antenna_pin.simulation.oversight import Oversight
from antenna_pin.simulation.progress import Foreseeing, Keeping, Progress, Reporter
from antenna_pin.simulation.samples import Samples
from antenna_pin.simulation.scales import scale_vector
from antenna_pin.simulation.search import ContactSearch
from antenna_pin.simulation.singular import Singularities
from antenna_pin.simulation.standing import state_of, take_up
from antenna_pin.simulation.stretches import Parts, Stretches, stepper_of
from antenna_pin.simulation.switches import own_events
from antenna_pin.simulation.ticks import Ticks
from antenna_pin.simulation.watch import Crossing, Watch
from antenna_pin.trajectory import Counts, Outcome

__all__ = ["Run"]

Array = NDArray[np.float64]


class Run:
    """One run of a system from an initial state.

    Args:
        system: The system; its contact memory is set from the initial state.
        start: A state that a run left, or the first one as [q, v, x] (:meth:`System.state`), at time zero,
            whose contacts touch by the rule of :func:`antenna_pin.dynamics.contact_memory`.
        end: Time at which the run ends [s].
        settings: How to integrate and sample.
        events: What to look for besides contacts.
        since: From when on it records [s]; when ``start`` was reached, if not given.
        singly: Whether what keeps it looks at it after each step.
        taped: Whether that looks where contacts change and events happen, at the steps up to there.
        controllers: That command it, by name.
    """

    def __init__(
        self,
        system: System,
        start: Array | State,
        end: float,
        settings: RunSettings,
        events: Sequence[Event] = (),
        since: float | None = None,
        singly: bool = False,
        taped: bool = False,
        controllers: Mapping[str, Controller] = MappingProxyType({}),
    ) -> None:
        """Prepare the stepper, the search of its steps, and the contacts that touch at the start."""
        self.system, self.settings = system, settings
        self.workspace = Workspace(system)
        self.duration = end
        #: Told of the first step that the run's end cuts, before it is made, and of events that are foreseen.
        self.foreseen: Foreseeing | None = None
        #: From when on it records [s].
        self.begin = since if since is not None else start.reached if isinstance(start, State) else 0.0
        method = method_named(settings.method)
        scales = scale_vector(system, settings.scales)
        self.stepper = stepper_of(self.workspace, method, scales, settings)
        #: What happens later than this is recorded [s]; at the start of a run that goes on it was before.
        self.after = self.begin if isinstance(start, State) else math.nextafter(self.begin, -math.inf)
        self.control = StepControl(self.workspace, method, settings, self.begin, end)
        self.samples = Samples(self.workspace, settings.output_rate, settings.output_times, self.begin, end)
        self.contacts = Episodes(self.workspace, self.stepper, self.samples, self.begin)
        self.search = ContactSearch(self.workspace, self.stepper, self.contacts)
        self.events = tuple(events)
        self.watch = Watch((*self.events, *own_events(system)), self.workspace, self.stepper)
        self.control.end_at(self.watch.instants)
        worked_on = self.workspace, self.stepper, self.control, self.samples
        self.actions = Actions(self.watch, *worked_on, self.after)
        self.ticks = Ticks(controllers, system, self.actions, self.begin)
        self.watch.tick = self.ticks.next
        self.oversight = Oversight(self.workspace, self.control, self.events)
        self.singular = None if system.plan is None else Singularities(Workspace(system))
        self.steps = Stretches(self.stepper, self._parts(), singly, taped)
        self._ahead: list[list[Crossing]] = []
        self.outcome, self.message = Outcome.COMPLETED, Outcome.COMPLETED.value
        self.wall = 0.0
        self.left: State | None = None
        if isinstance(start, State):
            take_up(self, start)
        else:
            self._start(start)

    def _parts(self) -> Parts:
        return Parts(self.control, self.samples, self.contacts, self.search, self.watch, self.singular)

    def _start(self, y: Array) -> None:
        self.stepper.restart(0.0, y)
        self.control.spin = self.system.turn_on(self.stepper.start)
        self.search.measure(y)
        for c in range(len(self.contacts)):
            row = self.search.table[c]
            if row.gap <= ON_SURFACE:
                self.contacts.touch_at_start(c, -float(row.gap), float(row.rate))
        self.actions.begin()
        self.stepper.refresh()
        self.watch.renew()
        self._act(self.watch.due())
        self.samples.add(0.0, self.here.copy())
        self.following = self.control.first

    # --- what there is at the end ---------------------------------------------------------------------------

    @property
    def state(self) -> State:
        """The state that the run leaves: one to go on from."""
        return self.left if self.left is not None else self.present()

    @property
    def episodes(self) -> NDArray[Any]:
        """Contacts from onset to release, in the order of their onsets, EPISODE."""
        return self.contacts.all

    def counts(self) -> Counts:
        """Return what the run took so far."""
        made = self.steps
        return Counts(made.accepted, made.rejected, made.relocated, self.stepper.evaluations, self.wall)

    def present(self) -> State:
        """Return the state at this moment."""
        return state_of(self)

    @property
    def following(self) -> float:
        """Size of the step to try next [s]."""
        return self.steps.following

    @following.setter
    def following(self, h: float) -> None:
        self.steps.following = h

    @property
    def here(self) -> Array:
        """The present state [q, v, x]; a view."""
        return np.asarray(self.stepper.start[: self.system.manifold.size])

    # --- stepping -------------------------------------------------------------------------------------------

    def advance(
        self,
        progress: Callable[[Progress], None] | None = None,
        interrupted: Callable[[], bool] = lambda: False,
        keep: Keeping | None = None,
    ) -> None:
        """Run to the end, or to what ends it earlier.

        Args:
            progress: Called now and then.
            interrupted: Asked between steps.
            keep: Shown the run between steps, and at its end.
        """
        report = Reporter(progress, self.duration, self.wall)
        with self.oversight.listening(self._stop):
            self.oversight.begin(self.stepper.t, self.here, self.steps.so_far(self.wall))
            self.tick()
            for _ in self._way(lambda: report.wall, interrupted):
                report(self.stepper.t, self.steps.following, self.steps.accepted)
                if keep is not None:
                    keep.look(self)
                    self.steps.tape.steps.clear()
        self.judge()
        if keep is not None:
            keep.end(self)
        self.complete()
        self.wall = report.wall
        report(self.stepper.t, self.steps.following, self.steps.accepted, last=True)

    def go_to(self, end: float, interrupted: Callable[[], bool] = lambda: False) -> None:
        """Run up to a time [s], from which it may go on to another, or to what ends it earlier."""
        clock = Reporter(None, end, self.wall)
        self.duration = end
        self.control.move_end(end)
        self.steps.move_end(end)
        with self.oversight.listening(self._stop):
            if not self.steps.made:
                self.oversight.begin(self.stepper.t, self.here, self.steps.so_far(self.wall))
            self.tick()
            for _ in self._way(lambda: clock.wall, interrupted):
                if self.foreseen is not None:
                    self.foreseen.step()

    def judge(self) -> None:
        """Look whether what the run has come to means nothing after all."""
        with self.oversight.listening(self._stop):
            self._stop(*self.oversight.end(self.outcome))

    def complete(self) -> None:
        """Complete the record of a run that has come to its end."""
        self.left = dataclasses.replace(self.state, reached=self.stepper.t)
        self.contacts.close()
        self.samples.finish(self.stepper.t, self.here.copy())
        if self.singular is not None:
            self.message += self.singular.words()
        self.message += undetermined(self) + self.oversight.words(self.outcome)

    def obey(self, name: str, action: Set) -> None:
        """Do at the present state what an event of this name would that happened here."""
        with self.oversight.listening(self._stop), self._settling():
            self.actions.obey(name, action)

    def look_for(self, events: Sequence[Event], singly: bool) -> None:
        """Look from now on for these events beside those that the system has; what is known of them stays."""
        known = self.watch.value()
        self.events = tuple(events)
        self.watch = Watch((*self.events, *own_events(self.system)), self.workspace, self.stepper)
        self.watch.take_up(known, self.stepper.t)
        self.watch.tick = self.ticks.next
        self.control.end_at(self.watch.instants)
        self.actions.look_by(self.watch)
        steps = self.steps
        self.steps = Stretches(self.stepper, self._parts(), singly)
        self.steps.take_up(steps)
        self.watch.renew()

    def _way(self, wall: Callable[[], float], interrupted: Callable[[], bool]) -> Iterator[None]:
        """Make steps to the end, or to what ends the run earlier; yield between them."""
        while self.stepper.t < self.duration and self.outcome is Outcome.COMPLETED:
            self._step()
            self.wall = wall()
            here = self.stepper.t, self.here, self.steps.so_far(self.wall)
            if self.outcome is Outcome.COMPLETED and self._stop(*self.oversight.look(*here, interrupted())):
                yield

    def _step(self) -> None:
        """Make steps up to the end of one that is seen to here, or of a stretch."""
        self._see_to(self.steps.go_on())
        while not self.steps.at_rest:
            self._see_to(self.steps.finish_step())

    def _see_to(self, reason: int) -> None:
        """See to what the loop cannot."""
        if self.watch and (reason == kernels.MOVED_ON or self.steps.has_moved):
            self.watch.renew()
        if reason == kernels.CUT_BY_END:
            if self.left is None:
                self.left = self.present() if self.foreseen is None else self.foreseen.end()
        elif reason == kernels.TRIAL_STANDS:
            self._ahead = self.watch.ahead()
            if self.foreseen is not None:
                self.foreseen.events(self._ahead)
            self.steps.search_until(self._ahead[0][0].theta if self._ahead else 2.0)
        elif reason == kernels.EVENT:
            self._happen(self._ahead)
        elif reason == kernels.MOVED_ON:
            self._due()
        elif reason == kernels.TOO_DEEP:
            self._stop(*too_deep(self))
        elif reason in (kernels.STANDS_STILL, kernels.NO_WAY, change_kernels.HOPELESS):
            self.steps.rest()
            self._stop(*no_step(self, reason))

    def _happen(self, ahead: list[list[Crossing]]) -> None:
        """Let events happen, one instant after the other, where they do.

        Where those at one instant change nothing, those at the next were found with them: a step leads there.
        """
        stepper, steps, watch = self.stepper, self.steps, self.watch
        begin, size = stepper.t, stepper.h
        for k, group in enumerate(ahead):
            if k > 0 and any(watch.events[one.event].changes for one in ahead[k - 1]):
                break
            left, way = size, group[0].theta * size
            if k > 0:
                left, way = begin + size - stepper.t, begin + way - stepper.t
            if stepper.t + way > stepper.t:
                reason = steps.end_at(way, left, watch.lack(group[0]), search=k > 0)
                if reason != kernels.MOVED_ON:
                    if k > 0:
                        watch.renew()
                    self._see_to(reason)
                    return
                if len(ahead) == 1:
                    watch.renew()
            self._act(sorted([*watch.due(), *group], key=lambda one: one.event))
            self.tick()
        steps.rest()
        if len(ahead) > 1:
            watch.renew()

    def _due(self) -> None:
        """Let happen what is due at this time: events first, then controllers."""
        self._act(self.watch.due())
        self.tick()

    def tick(self) -> None:
        """Ask controllers whose instant has come, and let the next step that must end at one end there."""
        following, t = self.ticks.next, self.stepper.t
        if following is None or self.outcome is not Outcome.COMPLETED:
            return
        if following <= t:
            with self._settling():
                self.ticks.happen(t, self.here)
            following = self.ticks.next
        if following is not None:
            self.watch.tick = following
            self.control.end_next_at(t, following)

    def _act(self, crossings: list[Crossing]) -> None:
        """Let all happen that does at this instant."""
        with self._settling():
            self.actions.take(crossings)

    @contextmanager
    def _settling(self) -> Iterator[None]:
        """End the run where modes come to no end, a motion cannot be followed, or an event says so."""
        try:
            yield
            last, self.actions.ending = self.actions.ending, None
            if last is not None and self.outcome is Outcome.COMPLETED:
                self._stop(Outcome.STOPPED, f", event {last!r}")
        except NeverSettlesError as error:
            self._stop(error.outcome, error.seen)
        except MechanismError as error:
            self._stop(Outcome.REFUSED, f", {error}")

    def _stop(self, outcome: Outcome | None, what: str = "") -> bool:
        """End the run for a reason; return whether there is none."""
        if outcome is None:
            return True
        self.outcome, self.message = message_of(self, outcome, what)
        return False
