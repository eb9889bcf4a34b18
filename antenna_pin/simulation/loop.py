"""The only time loop: steps, located events, sampling, stopping rules.

A trial step whose error passes is searched, in its dense output, for the first contact that changes and for
the first of the user's events; if there is one the step is made again to end there, what must is changed, and
the integration restarts from that state. So the equations are smooth inside every accepted step.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import System, Workspace
from antenna_pin.dynamics.workspace import ON_SURFACE
from antenna_pin.engine import CompiledStepper
from antenna_pin.integrate import method_named
from antenna_pin.settings import RunSettings
from antenna_pin.simulation.actions import Actions
from antenna_pin.simulation.control import StepControl
from antenna_pin.simulation.episodes import Episodes
from antenna_pin.simulation.events import Event
from antenna_pin.simulation.kinks import kinks_of
from antenna_pin.simulation.measured import NOTHING, Found
from antenna_pin.simulation.oversight import Oversight
from antenna_pin.simulation.progress import Keeping, Progress, Reporter
from antenna_pin.simulation.quiet import QuietTrials, stepper_of
from antenna_pin.simulation.samples import Samples
from antenna_pin.simulation.scales import scale_vector
from antenna_pin.simulation.search import ContactSearch
from antenna_pin.simulation.singular import Singularities
from antenna_pin.simulation.standing import state_of, take_up
from antenna_pin.simulation.trials import Trial, Trials
from antenna_pin.simulation.watch import Crossing, Watch
from antenna_pin.simulation.watched import is_known
from antenna_pin.state import State
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
        stretches: Whether the compiled engine may make many steps between two looks of what keeps it.
    """

    def __init__(
        self,
        system: System,
        start: Array | State,
        end: float,
        settings: RunSettings,
        events: Sequence[Event] = (),
        since: float | None = None,
        stretches: bool = True,
    ) -> None:
        """Prepare the stepper, the search of its steps, and the contacts that touch at the start."""
        self.system, self.settings = system, settings
        self.workspace = Workspace(system)
        self.duration = end
        #: From when on it records [s].
        self.begin = since if since is not None else start.reached if isinstance(start, State) else 0.0
        method = method_named(settings.method)
        scales = scale_vector(system, settings.scales)
        self.stepper = stepper_of(self.workspace, method, scales, settings)
        self.control = StepControl(self.workspace, method, settings, self.begin, end)
        self.samples = Samples(self.workspace, settings.output_rate, settings.output_times, self.begin, end)
        self.contacts = Episodes(self.workspace, self.stepper, self.samples, self.begin)
        self.search = ContactSearch(self.workspace, self.stepper, self.contacts)
        self.events = tuple(events)
        self.watch = Watch((*self.events, *kinks_of(system)), self.workspace, self.stepper)
        self.control.end_at(self.watch.instants)
        worked_on = self.workspace, self.stepper, self.control, self.samples
        self.actions = Actions(self.watch, *worked_on, self.begin)
        self.trials = Trials(self.stepper, self.control)
        self.oversight = Oversight(self.workspace, self.control, self.events)
        self.singular = None if system.plan is None else Singularities(Workspace(system))
        if stretches and isinstance(self.stepper, CompiledStepper) and all(map(is_known, self.watch.events)):
            parts = self.samples, self.contacts, self.search, self.watch, self.singular
            self.trials = QuietTrials(self.stepper, self.control, *parts)
        self.trials.failure_in = self.oversight.failure_in
        self.outcome, self.message = Outcome.COMPLETED, Outcome.COMPLETED.value
        self.wall = self.following = 0.0
        self.left: State | None = None
        if isinstance(start, State):
            take_up(self, start)
        else:
            self._start(start)

    def _start(self, y: Array) -> None:
        self.stepper.restart(0.0, y)
        self.control.spin = self.system.turn_on(self.stepper.start)
        self.search.measure(y)
        for c in range(len(self.contacts)):
            row = self.search.table[c]
            if row.gap <= ON_SURFACE:
                self.contacts.touch(c, max(float(row.rate), 0.0))
        self.stepper.refresh()
        self.watch.renew()
        self.samples.add(0.0, y.copy())
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
        tried = self.trials
        return Counts(tried.accepted, tried.rejected, tried.relocated, self.stepper.evaluations, self.wall)

    def present(self) -> State:
        """Return the state at this moment."""
        return state_of(self)

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
        h = self.following
        with self.oversight.listening(self._stop):
            self.oversight.begin(self.stepper.t, self.here, self.trials.so_far(self.wall))
            while self.stepper.t < self.duration and self.outcome is Outcome.COMPLETED:
                self.following = h = self._step(h)
                self.wall = report.wall
                if self.outcome is not Outcome.COMPLETED or not self._may_go_on(interrupted()):
                    break
                report(self.stepper.t, h, self.trials.accepted)
                if keep is not None:
                    keep.look(self)
            self._stop(*self.oversight.end(self.outcome))
        if keep is not None:
            keep.end(self)
        self.left = dataclasses.replace(self.state, reached=self.stepper.t)
        self.contacts.close()
        self.samples.finish(self.stepper.t, self.here.copy())
        if self.singular is not None:
            self.message += self.singular.words()
        self.message += self.oversight.words(self.outcome)
        self.wall = report.wall
        report(self.stepper.t, h, self.trials.accepted, last=True)

    def _may_go_on(self, interrupted: bool) -> bool:
        made = self.trials.so_far(self.wall)
        return self._stop(*self.oversight.look(self.stepper.t, self.here, made, interrupted))

    def _step(self, h: float) -> float:
        """Make one accepted step, or a stretch; return the size to try next."""
        trial = self.trials.first(h, self._keep)
        if not trial.tried:
            return trial.following
        return self._conclude(trial.following) if trial.passed else self._give_up(trial)

    def _keep(self, h: float) -> None:
        """Keep the state before the first step that the run's end cuts."""
        self.following = h
        if self.left is None:
            self.left = self.present()

    def _give_up(self, trial: Trial) -> float:
        """Accept nothing; return the size to try next, if the run does not end."""
        self._stop(trial.outcome, trial.words)
        return trial.following

    def _conclude(self, following: float) -> float:
        """Accept the trial step, or one that ends where something happens; return the size to try next."""
        contacts, search, watch = self.contacts, self.search, self.watch
        ahead: list[list[Crossing]] = []
        if contacts or watch:
            search.compare_gaps()
            self.stepper.prepare_dense()
            ahead = watch.ahead()
        found = search.first(ahead[0][0].theta if ahead else 2.0) if contacts else NOTHING
        if found.contact >= 0:
            act = self._end_too_deep if found.deep else self._change
            return act(found, following)
        if ahead:
            return self._happen(ahead, following)
        self._keep_and_accept()
        return following

    def _keep_and_accept(self, renew: bool = True) -> None:
        if self.contacts:
            self.contacts.keep_peaks()
            self.search.ignore[:] = 0
        self._accept(renew)

    def _end_too_deep(self, found: Found, following: float) -> float:
        c = found.contact
        if found.theta > 0.0:
            lack = self.search.lack(c, -float(self.search.limits[c]))
            trial = self._relocate(found.theta, lack)
            if not trial.passed:
                return self._give_up(trial)
        of_joint = self.search.reasons[c] == "maximum_depth"
        outcome = Outcome.TOO_DEEP if of_joint else Outcome.OUT_OF_LAW_RANGE
        self._stop(outcome, f", {self.search.words(c)}")
        return following

    def _change(self, found: Found, following: float) -> float:
        """Let a contact touch or part where it does; return the size to try next."""
        stepper, contacts, search = self.stepper, self.contacts, self.search
        c = found.contact
        sizes = self.control.sizes
        sizes.note(following)
        if found.theta > 0.0:
            trial = self._relocate(found.theta, search.lack(c))
            if not trial.passed:
                return self._give_up(trial)
        elif search.ignore[c] != 0:
            # It has just changed here and would change back at once: a graze. Let it, this once more.
            search.ignore[c] = 2
            contacts.flip(c, 0.0)
            self._restart()
            return following
        search.measure(stepper.start)
        contacts.flip(c, float(search.table[c].rate))
        search.ignore[c] = 1
        self._restart()
        self.samples.add(stepper.t, self.here.copy())
        return sizes.after_change(following)

    def _restart(self) -> None:
        """Take up the integration anew, after a change at the present state."""
        self.stepper.refresh()
        self.watch.renew()

    def _relocate(self, theta: float, lack: Callable[[], float], renew: bool = True) -> Trial:
        """Make the trial step again to end where something happens (:meth:`Trials.again`), and accept it."""
        trial = self.trials.again(theta * self.stepper.h, self.stepper.h, lack)
        if trial.passed:
            if self.contacts:
                self.search.compare_gaps()
                self.stepper.prepare_dense()
                self.search.track()
            self._keep_and_accept(renew)
        return trial

    def _happen(self, ahead: list[list[Crossing]], following: float) -> float:
        """Let events happen, one instant after the other, where they do; return the size to try next.

        Where those at one instant change nothing, those at the next were found with them: a step leads there.
        """
        stepper, (first, *more) = self.stepper, ahead
        begin, size = stepper.t, stepper.h
        if begin + first[0].theta * size > begin:
            trial = self._relocate(first[0].theta, self.watch.lack(first[0]), renew=not more)
            if not trial.passed:
                return self._give_up(trial)
        self._act(first)
        for before, group in itertools.pairwise(ahead):
            if any(self.watch.events[one.event].changes for one in before):
                break
            left, way = begin + size - stepper.t, begin + group[0].theta * size - stepper.t
            if stepper.t + way > stepper.t:
                trial = self.trials.again(way, left, self.watch.lack(group[0]))
                found = self._contacts_in_step() if trial.passed else NOTHING
                if not trial.passed or found.contact >= 0:
                    self.watch.renew()
                if not trial.passed:
                    return self._give_up(trial)
                if found.contact >= 0:
                    act = self._end_too_deep if found.deep else self._change
                    return act(found, following)
                self._keep_and_accept(renew=False)
            self._act(group)
        if more:
            self.watch.renew()
        return following

    def _contacts_in_step(self) -> Found:
        """Return which contact changes first in the trial step."""
        if not self.contacts:
            return NOTHING
        self.search.compare_gaps()
        self.stepper.prepare_dense()
        return self.search.first()

    def _act(self, crossings: list[Crossing]) -> None:
        for crossing in crossings:
            last = self.actions.take(crossing)
            if last is not None:
                self._stop(Outcome.STOPPED, f", event {last!r}")

    def _accept(self, renew: bool = True) -> None:
        stepper = self.stepper
        self.samples.during(stepper)
        stepper.accept()
        if self.system.turn_x:
            self.control.spin = self.system.turn_on(stepper.start)
        if stepper.t > self.duration - 1e-15 * self.duration:
            stepper.t = self.duration
        self.trials.accepted += 1
        if self.singular is not None:
            self.singular.look(stepper.t, self.here)
        if self.watch:
            if renew:
                self.watch.renew()
            self._act(self.watch.due())

    def _stop(self, outcome: Outcome | None, what: str = "") -> bool:
        """End the run for a reason; return whether there is none."""
        if outcome is None:
            return True
        self.outcome = outcome
        if outcome in (Outcome.NOT_FINITE, Outcome.STEP_TOO_SMALL) and self.singular and self.singular.near:
            self.outcome, what = Outcome.NOT_CLOSED, self.singular.near
        self.message = f"at t = {self.stepper.t:.9g} s{what}: {self.outcome.value}"
        return False
