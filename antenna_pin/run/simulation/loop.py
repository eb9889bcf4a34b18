"""Run of a system: the loop around the compiled steps, and its three services.

Steps are made, searched for changes of contact, sampled and accepted in
:mod:`antenna_pin.run.engine.loop_kernels`, for every engine, in batches (:class:`steps.StepBatches`). A batch
ends with a reason that :meth:`Run._handle` passes to a service:

- recorder: samples (``Run.samples``), contact episodes (``Run.contacts``); an observer between batches stores
  checkpoints; :mod:`recorder` derives the variables of the result.
- events: users' and elements' events (``Run.watch``), their actions and changes of mode (``Run.actions``),
  controllers' sample times (``Run.controllers``).
- monitor: limits, pace, interrupts, stiffness, checks of users' functions (``Run.monitor``), singular
  positions (``Run.singular``).
"""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import memory_numbers
from antenna_pin.base.settings import RunSettings
from antenna_pin.base.state import State
from antenna_pin.dynamics import System, Workspace, acting_in
from antenna_pin.dynamics.workspace import ON_SURFACE
from antenna_pin.elements.control import Controller
from antenna_pin.errors import MechanismError
from antenna_pin.integrate import method_named
from antenna_pin.run.engine import change_kernels
from antenna_pin.run.engine import loop_kernels as kernels
from antenna_pin.run.simulation.constraints import Singularities
from antenna_pin.run.simulation.contacts import ContactSearch, Episodes
from antenna_pin.run.simulation.controllers import Controllers
from antenna_pin.run.simulation.element_events import NeverSettlesError, own_events
from antenna_pin.run.simulation.event_actions import Actions
from antenna_pin.run.simulation.event_watch import EventWatch, ZeroCrossing
from antenna_pin.run.simulation.events import Event, Set
from antenna_pin.run.simulation.monitor import Monitor
from antenna_pin.run.simulation.samples import Samples
from antenna_pin.run.simulation.steps import LoopParts, StepBatches, StepControl, scale_vector, stepper_of
from antenna_pin.trajectory import Counts, Outcome

Array = NDArray[np.float64]

# --- progress -----------------------------------------------------------------------------------------------

_INTERVAL = 0.1  # [s] of wall time between reports


@dataclass(frozen=True, slots=True)
class Progress:
    """Progress of a run.

    Attributes:
        time: Simulated time [s].
        end: End of the run [s].
        step: Size of the last step [s].
        steps: Steps accepted.
        wall: Wall time so far [s].
    """

    time: float
    end: float
    step: float
    steps: int
    wall: float


class RunObserver(Protocol):
    """Observer of a run between its batches of steps."""

    def observe(self, run: Any) -> None:
        """Inspect the run between two steps."""

    def end(self, run: Any) -> None:
        """Inspect the run after its last step, before its record is completed."""


class StepListener(Protocol):
    """Listener to steps that a run is about to make."""

    def step(self) -> None:
        """Handle the end of a batch of steps that is not the last."""

    def end(self) -> State:
        """Handle the first step that the run's end cuts; return the state before it."""

    def events(self, ahead: Sequence[Sequence[Any]]) -> None:
        """Handle the events in the trial step, coincident ones together."""


class ProgressReporter:
    """Reports of a run's progress, at intervals of wall time."""

    def __init__(self, progress: Callable[[Progress], None] | None, end: float, before: float = 0.0) -> None:
        """Start the clock."""
        self._progress = progress
        self._end = end
        self._told = time.perf_counter()
        self._began = self._told - before

    @property
    def wall(self) -> float:
        """Wall time since the beginning [s]."""
        return time.perf_counter() - self._began

    def __call__(self, t: float, h: float, accepted: int, *, last: bool = False) -> None:
        """Report time [s], step size [s] and accepted steps, if a report is due."""
        if self._progress is None:
            return
        now = time.perf_counter()
        if last or now - self._told > _INTERVAL:
            self._told = now
            self._progress(Progress(t, self._end, h, accepted, now - self._began))


# --- the run ------------------------------------------------------------------------------------------------


class Run:
    """Run of a system from an initial state.

    Args:
        system: The system; its contact memory is set from the initial state.
        start: State left by a run, or the initial one as [q, v, x] (:meth:`System.state`), at time zero,
            whose contacts touch by the rule of :func:`antenna_pin.dynamics.contact_memory`.
        end: Time at which the run ends [s].
        since: Time from which the run records [s]; by default the time of ``start``.
        singly: Whether a batch ends after each step.
        logged: Whether steps are logged, and a batch ends at each change of contact and event.
        few: Whether it records few samples, as of :class:`Samples`.
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
        logged: bool = False,
        controllers: Mapping[str, Controller] = MappingProxyType({}),
        few: bool = False,
    ) -> None:
        """Prepare the stepper, the search of its steps, and the initial contacts."""
        self.system, self.settings = system, settings
        self.workspace = Workspace(system)
        self.duration = end
        #: Listener to the first step that the run's end cuts, before it is made, and to events ahead.
        self.listener: StepListener | None = None
        #: Time from which the run records [s].
        self.begin = since if since is not None else start.reached if isinstance(start, State) else 0.0
        method = method_named(settings.method)
        scales = scale_vector(system, settings.scales)
        self.stepper = stepper_of(self.workspace, method, scales, settings)
        #: Time after which events are recorded [s]; those at the start of a continued run were before.
        self.after = self.begin if isinstance(start, State) else math.nextafter(self.begin, -math.inf)
        self.control = StepControl(self.workspace, method, settings, self.begin, end)
        output = settings.output_rate, settings.output_times
        self.samples = Samples(self.workspace, *output, self.begin, end, few)
        self.contacts = Episodes(self.workspace, self.stepper, self.samples, self.begin)
        self.search = ContactSearch(self.workspace, self.stepper, self.contacts)
        self.events = tuple(events)
        self.watch = EventWatch((*self.events, *own_events(system)), self.workspace, self.stepper)
        self.control.pace.end_at(self.watch.instants)
        worked_on = self.workspace, self.stepper, self.control, self.samples
        self.actions = Actions(self.watch, *worked_on, self.after)
        self.controllers = Controllers(controllers, self.workspace, self.actions, self.begin)
        self.watch.tick = self.controllers.next
        self.monitor = Monitor(self.workspace, self.control, self.events)
        self.singular = None if system.plan is None else Singularities(Workspace(system))
        self.steps = StepBatches(self.stepper, self._parts(), singly, logged)
        self._ahead: list[list[ZeroCrossing]] = []
        self.outcome, self.message = Outcome.COMPLETED, Outcome.COMPLETED.value
        self.wall = 0.0
        self.left: State | None = None
        if isinstance(start, State):
            self.take_up(start)
        else:
            self._start(start)

    def _parts(self) -> LoopParts:
        parts = self.control, self.samples, self.contacts, self.search, self.watch, self.singular
        return LoopParts(*parts, self.actions.modes.peaks.numbers)

    def _start(self, y: Array) -> None:
        self.stepper.restart(0.0, y)
        self.control.limit_turns(self.system.turn_on(self.stepper.start))
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
        self.steps.following = self.control.first_step

    # --- results --------------------------------------------------------------------------------------------

    @property
    def state(self) -> State:
        """State that the run leaves, from which another run can continue."""
        return self.left if self.left is not None else self.present()

    @property
    def episodes(self) -> NDArray[Any]:
        """Contacts from onset to release, in the order of their onsets, EPISODE."""
        return self.contacts.all

    def counts(self) -> Counts:
        """Return the counts of steps and evaluations so far."""
        made = self.steps
        return Counts(made.accepted, made.rejected, made.relocated, self.stepper.evaluations, self.wall)

    def present(self) -> State:
        """Return the state between the last step and the next."""
        nq, nv, y = self.system.model.nq, self.system.model.nv, self.here
        return State(
            time=self.stepper.t,
            reached=self.stepper.t,
            q=y[:nq].copy(),
            v=y[nq : nq + nv].copy(),
            x=y[nq + nv :].copy(),
            memory=memory_numbers(self.workspace.memory),
            contacts=self.contacts.value(),
            step=self.steps.following,
            error=self.control.error,
            sizes=self.control.sizes.value(),
            changed=tuple(self.search.ignore.tolist()),
            events=self.watch.value(),
            adjusted=tuple(self.actions.adjustments.values.items()),
            controllers=self.controllers.value(),
        )

    def take_up(self, state: State) -> None:
        """Continue from a state, between two steps."""
        self.contacts.take_up(state)
        for place, value in state.adjusted:
            if self.actions.adjustments.values.get(place) != value:
                self.actions.set(place, value)
        self.stepper.restart(state.time, state.y)
        self.actions.motions.renew(state.time)
        self.control.limit_turns(self.system.turn_on(self.stepper.start))
        self.control.sizes.take_up(state.sizes)
        self.search.ignore[:] = state.changed
        self.steps.following = state.step
        self.control.error = state.error
        self.watch.take_up(state.events, state.time)
        self.watch.renew()
        self.controllers.take_up(state.controllers, state.reached)
        if state.time == state.reached:
            self.samples.add(state.time, state.y)

    @property
    def here(self) -> Array:
        """Present state [q, v, x]; a view."""
        return np.asarray(self.stepper.start[: self.system.manifold.size])

    # --- stepping -------------------------------------------------------------------------------------------

    def advance(
        self,
        progress: Callable[[Progress], None] | None = None,
        interrupted: Callable[[], bool] = lambda: False,
        observer: RunObserver | None = None,
    ) -> None:
        """Run to the end, or to an earlier stop."""
        report = ProgressReporter(progress, self.duration, self.wall)
        with self.monitor.guarded(self._stop):
            self.monitor.begin(self.stepper.t, self.here, self.steps.so_far(self.wall))
            self.tick()
            for _ in self._batches(lambda: report.wall, interrupted):
                report(self.stepper.t, self.steps.following, self.steps.accepted)
                if observer is not None:
                    observer.observe(self)
                    self.steps.log.clear()
        self.judge()
        if observer is not None:
            observer.end(self)
        self.complete()
        self.wall = report.wall
        report(self.stepper.t, self.steps.following, self.steps.accepted, last=True)

    def go_to(self, end: float, interrupted: Callable[[], bool] = lambda: False) -> None:
        """Run to a time [s], or to an earlier stop; the run may continue."""
        clock = ProgressReporter(None, end, self.wall)
        self.duration = end
        self.control.move_end(end)
        self.steps.move_end(end)
        with self.monitor.guarded(self._stop):
            if not self.steps.tried_so_far:
                self.monitor.begin(self.stepper.t, self.here, self.steps.so_far(self.wall))
            self.tick()
            for _ in self._batches(lambda: clock.wall, interrupted):
                if self.listener is not None:
                    self.listener.step()

    def judge(self) -> None:
        """Check at the end whether the users' functions were repeatable."""
        with self.monitor.guarded(self._stop):
            self._stop(*self.monitor.end(self.outcome))

    def complete(self) -> None:
        """Complete the record of a run that has reached its end."""
        self.left = dataclasses.replace(self.state, reached=self.stepper.t)
        self.contacts.close()
        self.samples.finish(self.stepper.t, self.here.copy())
        if self.singular is not None:
            self.message += self.singular.text()
        self.message += _undetermined(self) + self.monitor.text(self.outcome)

    def obey(self, name: str, action: Set) -> None:
        """Carry out an action at the present state, recorded as an event of this name."""
        with self.monitor.guarded(self._stop), self._settling():
            self.actions.obey(name, action)

    def look_for(self, events: Sequence[Event], singly: bool) -> None:
        """Replace the users' events, keeping the discrete states of known ones."""
        known = self.watch.value()
        self.events = tuple(events)
        self.watch = EventWatch((*self.events, *own_events(self.system)), self.workspace, self.stepper)
        self.watch.take_up(known, self.stepper.t)
        self.watch.tick = self.controllers.next
        self.control.pace.end_at(self.watch.instants)
        self.actions.watch = self.watch
        steps = self.steps
        self.steps = StepBatches(self.stepper, self._parts(), singly)
        self.steps.take_up(steps)
        self.watch.renew()

    def _batches(self, wall: Callable[[], float], interrupted: Callable[[], bool]) -> Iterator[None]:
        """Make steps to the end, or to an earlier stop; yield after each batch."""
        while self.stepper.t < self.duration and self.outcome is Outcome.COMPLETED:
            self._step()
            self.wall = wall()
            here = self.stepper.t, self.here, self.steps.so_far(self.wall)
            if self.outcome is Outcome.COMPLETED and self._stop(*self.monitor.check(*here, interrupted())):
                yield

    def _step(self) -> None:
        """Make a batch of steps, or one step up to its end."""
        self._handle(self.steps.go_on())
        while not self.steps.at_rest:
            self._handle(self.steps.finish_step())

    def _handle(self, reason: int) -> None:
        """Handle an interruption of the compiled loop."""
        if self.watch and (reason == kernels.MOVED_ON or self.steps.has_moved):
            self.watch.renew()
        if reason == kernels.CUT_BY_END:
            if self.left is None:
                self.left = self.present() if self.listener is None else self.listener.end()
        elif reason == kernels.TRIAL_STANDS:
            self._ahead = self.watch.ahead()
            if self.listener is not None:
                self.listener.events(self._ahead)
            self.steps.search_until(self._ahead[0][0].theta if self._ahead else 2.0)
        elif reason == kernels.EVENT:
            self._carry_out(self._ahead)
        elif reason == kernels.MOVED_ON:
            self._due()
        elif reason == kernels.TOO_DEEP:
            self._stop(*_too_deep(self))
        elif reason in (kernels.STANDS_STILL, kernels.NO_WAY, change_kernels.HOPELESS):
            self.steps.rest()
            self._stop(*_no_step(self, reason))

    def _carry_out(self, ahead: list[list[ZeroCrossing]]) -> None:
        """Carry out the events ahead in the trial step, one time after the other.

        If the events at one time change nothing, the next ones were located with them: a step leads there.
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
                    self._handle(reason)
                    return
                if len(ahead) == 1:
                    watch.renew()
            self._act(sorted([*watch.due(), *group], key=lambda one: one.event))
            self.tick()
        steps.rest()
        if len(ahead) > 1:
            watch.renew()

    def _due(self) -> None:
        """Carry out the events and then the controllers due at the present time."""
        self._act(self.watch.due())
        self.tick()

    def tick(self) -> None:
        """Call the controllers that are due; let a step end at the next sample time."""
        following, t = self.controllers.next, self.stepper.t
        if following is None or self.outcome is not Outcome.COMPLETED:
            return
        if following <= t:
            with self._settling():
                self.controllers.update(t, self.here)
            following = self.controllers.next
        if following is not None:
            self.watch.tick = following
            self.control.pace.end_next_at(t, following)

    def _act(self, crossings: list[ZeroCrossing]) -> None:
        """Carry out all events of the present time."""
        with self._settling():
            self.actions.take(crossings)

    @contextmanager
    def _settling(self) -> Iterator[None]:
        """End the run on endless mode changes, impossible motions, or request."""
        try:
            yield
            last, self.actions.ending = self.actions.ending, None
            if last is not None and self.outcome is Outcome.COMPLETED:
                self._stop(Outcome.STOPPED, f", event {last!r}")
        except NeverSettlesError as error:
            self._stop(error.outcome, error.text)
        except MechanismError as error:
            self._stop(Outcome.REFUSED, f", {error}")

    def _stop(self, outcome: Outcome | None, what: str = "") -> bool:
        """End the run for a reason; return whether there is no reason."""
        if outcome is None:
            return True
        self.outcome, self.message = _message_of(self, outcome, what)
        return False


# --- outcome ------------------------------------------------------------------------------------------------


def _no_step(run: Run, reason: int) -> tuple[Outcome, str]:
    """Return outcome and reason of a run whose step failed."""
    tried, error, refused = run.steps.tried
    if reason == kernels.NO_WAY:
        return Outcome.NO_PROGRESS, ""
    if reason == kernels.STANDS_STILL:
        return Outcome.STEP_TOO_SMALL, ""
    failure = run.stepper.answers.refusal if refused else run.monitor.failure_in(run.stepper, tried)
    if failure is not None:
        return Outcome.FUNCTION_FAILED, f", {failure.seen}"
    return (Outcome.STEP_TOO_SMALL if math.isfinite(error) else Outcome.NOT_FINITE), ""


def _too_deep(run: Run) -> tuple[Outcome, str]:
    """Return outcome and reason of a run whose contact has reached a depth limit."""
    c = run.steps.contact
    of_joint = run.search.reasons[c] == "maximum_depth"
    return (Outcome.TOO_DEEP if of_joint else Outcome.OUT_OF_LAW_RANGE), f", {run.search.depth_text(c)}"


def _undetermined(run: Run) -> str:
    """Return the elements whose load is indeterminate, as part of a message; "" if none."""
    names = [
        one.label
        for one in acting_in(run.system)
        if getattr(run.actions.adjustments.elements[one.place], "prescribed", False)
    ]
    said = (
        f"; {', '.join(names)}: the joint is held to a motion, and while it stands the torque of friction is "
        "not determined: recorded is that of the way it came"
        if names
        else ""
    )
    if shares := sorted(run.actions.modes.shares):
        said += (
            f"; {', '.join(shares)}: one freedom is held by several, the share of its load is not determined"
        )
    return said


def _message_of(run: Run, outcome: Outcome, what: str) -> tuple[Outcome, str]:
    """Return the outcome, refined by known causes, and the message."""
    found = outcome
    if outcome in (Outcome.NOT_FINITE, Outcome.STEP_TOO_SMALL) and run.singular and run.singular.nearly_lost:
        found, what = Outcome.NOT_CLOSED, run.singular.nearly_lost
    if outcome is Outcome.NOT_FINITE and (jammed := run.actions.modes.jammed(run.stepper.t, run.here)):
        what = jammed
    return found, f"at t = {run.stepper.t:.9g} s{what}: {found.value}"
