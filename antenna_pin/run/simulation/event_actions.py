"""Actions of users' events, elements' events and commands on a run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.readable import number
from antenna_pin.dynamics import Adjustments, NotFollowedError, Workspace, audit, check_restraint
from antenna_pin.elements import OnLinks
from antenna_pin.errors import InvalidParameterError
from antenna_pin.integrate import Stepper
from antenna_pin.run.simulation.constraints import Motions
from antenna_pin.run.simulation.element_events import (
    ZERO,
    EventEffect,
    ModeChangeEvent,
    NeverSettlesError,
    effects_of,
)
from antenna_pin.run.simulation.event_watch import EventWatch, ZeroCrossing
from antenna_pin.run.simulation.events import Edge, ElementChange, Event, Jump, Kink, Set, Stop, Switch
from antenna_pin.run.simulation.mode_changes import ModeChanges
from antenna_pin.run.simulation.samples import Samples
from antenna_pin.run.simulation.steps import StepControl
from antenna_pin.trajectory import Outcome

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class EventRecord:
    """Recorded event."""

    name: str  # name of the event
    time: float  # time [s]
    energy: float  # energy brought in by the actions [J]


class RefusedError(NeverSettlesError):
    """Setting of an element that the position of its joint forbids; the reason."""

    outcome: ClassVar[Outcome] = Outcome.REFUSED

    @property
    def text(self) -> str:
        """Return the reason as part of a message."""
        return f", {self}"


def _text_of(action: Set | Jump) -> str:
    """Return the object and value of an action, as a scenario writes it."""
    if isinstance(action, Jump):
        return "the state"
    is_switch = action.place.endswith(".on")
    return f"{action.place} = {str(bool(action.value)).lower() if is_switch else number(action.value)}"


class Actions:
    """Actions of events, and the record of events.

    Args:
        samples: Samples of the run, updated by changes of the program.
        after: Time after which events are recorded [s].

    Attributes:
        watch: Watch of the events.
        happened: Recorded events, in order.
        adjustments: Present elements of the run.
        modes: Elements with modes.
        motions: Prescribed motions.
        effects: Effects of the events since the last batch of steps; None if not recorded.
        ending: Name of the event that ends the run here, if one does.
    """

    def __init__(
        self,
        watch: EventWatch,
        workspace: Workspace,
        stepper: Stepper,
        control: StepControl,
        samples: Samples,
        after: float,
    ) -> None:
        """Begin without events."""
        self.watch = watch
        self._workspace = workspace
        self._stepper = stepper
        self._control = control
        self._samples = samples
        self._after = after
        self.happened: list[EventRecord] = []
        self.adjustments = Adjustments(workspace.system, workspace.program)
        self.modes = ModeChanges(workspace, self.adjustments)
        self.motions = Motions(workspace, self.adjustments)
        self.effects: list[EventEffect] | None = None
        self.ending: str | None = None

    def take(self, crossings: Sequence[ZeroCrossing]) -> None:
        """Count the events at the present time and carry out their actions.

        Users' events come first, in their order; then elements change, all together; then come the events on
        these changes.
        """
        events, changes = self.watch.events, False
        switches: list[Event] = []
        for crossing in crossings:
            event = events[crossing.event]
            count = self.watch.count(crossing)
            if isinstance(event.action, Kink):
                continue
            if isinstance(event.action, Switch):
                switches.append(event)
            elif isinstance(event.action, Edge):
                changes = self._edge(event.action) or changes
            else:
                changes = self._occur(event, count) or changes
        if switches or changes:
            self._resolve(switches)

    @property
    def _is_new(self) -> bool:
        """Return whether the present time belongs to this run's record."""
        return self._stepper.t > self._after

    @property
    def _counts(self) -> bool:
        """Return whether users' events are recorded now; settings at time zero are not."""
        return self._is_new and self._stepper.t > 0.0

    def _edge(self, action: Edge) -> bool:
        """Apply a change at a time set by an element; return whether velocities may jump."""
        drives = self.motions.is_one(action.place)
        if drives:
            self.motions.renew(self._stepper.t)
            self._drive()
        else:
            self._change(action.place)
            self._renew()
        self._stepper.refresh()
        self.watch.renew()
        self._samples.add(self._stepper.t, self._here.copy())
        return drives

    def _occur(self, event: Event, count: int) -> bool:
        """Carry out and record a user's event; return whether it changes the system."""
        acts, energy = event.acts(count), 0.0
        changes = acts and event.has(Set, Jump)
        for action in event.actions if acts else ():
            if isinstance(action, Set | Jump):
                try:
                    energy += self._carry_out(event.name, action)
                except InvalidParameterError as error:
                    raise RefusedError(f"event {event.name!r} sets {_text_of(action)}: {error}") from None
            elif isinstance(action, Stop) and self._counts:
                self.ending = event.name
        self._keep(event, acts)
        if self._counts:
            self.happened.append(EventRecord(event.name, self._stepper.t, energy))
        self._samples.add(self._stepper.t, self._here.copy())
        return changes

    def _keep(self, event: Event, acts: bool) -> None:
        """Record the effect of an event, if effects are recorded."""
        if self.effects is None:
            return
        if isinstance(event.when, ElementChange):
            rule = "which neighbours come to at other times, through which no derivatives are carried"
            raise NotFollowedError(f"event {event.name!r} is on a change of {event.when.element}, {rule}")
        self.effects.append(EventEffect(self._stepper.t, event, acts, (), self._workspace.program.copy()))

    def obey(self, name: str, action: Set) -> None:
        """Carry out an action at the present state, recorded as an event of this name.

        Raises:
            InvalidParameterError: The element cannot have this value here; nothing is changed.
        """
        energy = self._carry_out(name, action)
        if self._counts:
            self.happened.append(EventRecord(name, self._stepper.t, energy))
        self._samples.add(self._stepper.t, self._here.copy())
        self._resolve(())

    def _carry_out(self, name: str, action: Set | Jump) -> float:
        """Carry out one action; return the energy brought in [J]."""
        energy = -self._energy()
        if isinstance(action, Set):
            kept = self.adjustments.snapshot()
            element, _, key = action.place.rpartition(".")
            try:
                for place, value in self._set_by(action).items():
                    self.adjustments.set(place, value)
                self.modes.arm(element, key, self._stepper.t, self._here)
            except InvalidParameterError:
                self.adjustments.go_back(kept)
                raise
            finally:
                self._renew()
            if self.motions.is_one(element):
                energy -= self._drive()
        else:
            self._jump(name, action)
        energy += self._energy()
        self._stepper.refresh()
        self.watch.renew()
        return energy

    def _set_by(self, action: Set) -> Mapping[str, float]:
        """Return the numbers to set, by place, for a motion to continue from its position."""
        element, _, key = action.place.rpartition(".")
        if self.motions.is_one(element):
            return self.motions.goes_on(action.place, action.value, self._stepper.t)
        if key == "on" and action.value:
            held = self._workspace, self.adjustments, self._stepper.t, self._here, element
            check_restraint(*held, [one.name for one in self._workspace.system.holds])
        return {action.place: action.value}

    def _drive(self) -> float:
        """Apply the present rates of motions; return their work [J]."""
        if self.effects is not None:
            raise NotFollowedError(
                "a motion's rate jumps, through which no derivatives are carried; take a smooth course, or "
                "differences of runs"
            )
        work = self.modes.drive(self._stepper.t, self._here)
        self._renew()
        self._control.limit_turns(self._workspace.system.turn_on(self._stepper.start))
        return work

    def begin(self) -> None:
        """Set the initial modes of elements, and carry out their changes at the start."""
        t, y = self._stepper.t, self._here
        self.modes.prepare(t, y)
        self.modes.begin(t, y)
        self.happened += [EventRecord(one.name, t, 0.0) for one in self.modes.changed]
        for place in self.adjustments.elements:
            self._change(place)
        self._renew()

    def _change(self, place: str) -> None:
        """Update an element that depends on the time since its last change."""
        element = self.adjustments.elements[place]
        if isinstance(element, OnLinks):
            for key, value in element.from_now_on(self._stepper.t).items():
                self.adjustments.set(f"{place}.{key}", value)

    def _resolve(self, switches: Sequence[Event]) -> bool:
        """Carry out changes of mode and the events on these; return whether any occurred."""
        if not self.modes:
            return False
        modes, y, t = self.modes, self._here, self._stepper.t
        modes.effects.clear()
        recorded, before, lost = len(modes.changed), self._energy(), modes.losses(y)
        located = [event.action for event in switches if isinstance(event.action, Switch)]
        program = self._workspace.program.copy() if self.effects is not None else None
        changed = modes.resolve(located, t, y)
        if changed:
            self._control.limit_turns(self._workspace.system.turn_on(self._stepper.start))
            energy = self._energy() - before + modes.losses(y) - lost
            self._renew()
            self._stepper.refresh()
            self.watch.renew()
            if self._is_new:
                names = [one.name for one in modes.changed[recorded:]]
                self.happened += [
                    EventRecord(name, t, energy if k == 0 else 0.0) for k, name in enumerate(names)
                ]
            self._samples.add(t, y.copy())
            if self.effects is not None and program is not None:
                # Changes without a located function belong to the user's event that caused them.
                events = switches or [one.event for one in self.effects[-1:]]
                del self.effects[len(self.effects) - (not switches) :]
                self.effects += effects_of(modes.effects, events, program, self._workspace, t)
        if changed or switches:
            self.watch.logical(ZERO, modes.grazed)
        self._follow(modes.changed[recorded:])
        return changed

    def _follow(self, changed: Sequence[ModeChangeEvent]) -> None:
        """Carry out the events on changes of elements, and the changes that follow."""
        changes = False
        made = [(one.element, one.what) for one in changed]
        for crossing in self.watch.on_changes(self.adjustments.elements, made):
            count = self.watch.count(crossing)
            changes = self._occur(self.watch.events[crossing.event], count) or changes
        if changes:
            self._resolve(())

    def _renew(self) -> None:
        self._control.renew(self.adjustments.elements.values())
        self.motions.renew(self._stepper.t)
        self._samples.program = self.motions.whole()

    def set(self, place: str, value: float) -> None:
        """Change a number of a drive or a spring."""
        self.adjustments.set(place, value)
        self._renew()

    def command(self, numbers: Mapping[str, float]) -> None:
        """Write commands, by place; stored energy does not depend on them."""
        peaks, here = self.modes.peaks, (self._stepper.t, self._here)
        peaks.command(self._workspace.program, *here)
        for place, value in numbers.items():
            self.adjustments.set(place, value)
        peaks.command(self._workspace.program, *here)
        self._renew()
        self._stepper.refresh()
        self.watch.renew()
        if self.modes and self.modes.is_due(self._stepper.t, self._here) and self._resolve(()):
            return
        if self._stepper.t <= self._samples.last or any(self._workspace.memory["touching"]):
            # The sample gets the new commands; peaks of contacts take their program from it.
            self._samples.add(self._stepper.t, self._here.copy())

    def _jump(self, event: str, action: Jump) -> None:
        system, here = self._workspace.system, self._here
        n = system.model.nq + system.model.nv
        after = action.state_after(event, self.watch.moment.set(self._stepper.t, here))
        here[:n] = after[:n]
        self._control.limit_turns(system.turn_on(self._stepper.start))

    def _energy(self) -> float:
        """Return the energy stored at the present state [J]."""
        self._workspace.measure(self._here)
        return audit(self._workspace, self._here).energy

    @property
    def _here(self) -> Array:
        here: Array = self._stepper.start[: self._workspace.manifold.size]
        return here
