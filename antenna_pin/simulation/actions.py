"""What the user's events do to a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Adjustments, NotFollowedError, Workspace, audit, check_restraint
from antenna_pin.elements import OnLinks
from antenna_pin.errors import InvalidParameterError
from antenna_pin.integrate import Stepper
from antenna_pin.simulation.control import StepControl
from antenna_pin.simulation.events import Event, Jump, Set, Stop
from antenna_pin.simulation.modes import ZERO, Modes
from antenna_pin.simulation.motions import Motions
from antenna_pin.simulation.now import Sight
from antenna_pin.simulation.own_actions import Edge, Kink, Switch
from antenna_pin.simulation.passages import Passage
from antenna_pin.simulation.samples import Samples
from antenna_pin.simulation.watch import Crossing, Watch

__all__ = ["Actions", "Happening"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Happening:
    """An event that has happened.

    Attributes:
        name: Of the event.
        time: When [s].
        energy: That its action brought in [J].
    """

    name: str
    time: float
    energy: float


class Actions:
    """Does what events ask for, and keeps what has happened.

    Args:
        watch: The events.
        workspace: What the run works on; its program is changed.
        stepper: Its state is changed.
        control: Learns of drives that have changed.
        samples: Learns of a program that has changed.
        begin: From when on the run records [s].

    Attributes:
        happened: Events that have happened, in their order.
        adjustments: Elements as they are.
        modes: Those that have modes.
        motions: Those that prescribe motions.
        passages: What has happened at each instant, for who takes it from there; None if nobody does.
    """

    def __init__(
        self,
        watch: Watch,
        workspace: Workspace,
        stepper: Stepper,
        control: StepControl,
        samples: Samples,
        begin: float,
    ) -> None:
        """Begin with nothing that has happened."""
        self._watch = watch
        self._workspace = workspace
        self._stepper = stepper
        self._control = control
        self._samples = samples
        self._begin = begin
        self.happened: list[Happening] = []
        self.adjustments = Adjustments(workspace.system, workspace.program)
        self.modes = Modes(workspace, self.adjustments)
        self.motions = Motions(workspace, self.adjustments)
        self.passages: list[Passage] | None = None

    def take(self, crossing: Crossing) -> str | None:
        """Count an event at the present state and do what it asks for; return its name if the run ends."""
        event = self._watch.events[crossing.event]
        action = event.action
        count = self._watch.happen(crossing)
        if isinstance(action, Kink):
            return None
        self.modes.done.clear()
        if isinstance(action, Switch):
            if self._switch(action):
                self._keep(event, True)
            return None
        if isinstance(action, Edge):
            if self.motions.is_one(action.place):
                self.motions.renew(self._stepper.t)
                self._strike()
                self._follow()
            else:
                self._change(action.place)
                self._renew()
                self._stepper.refresh()
                self._watch.renew()
            self._samples.add(self._stepper.t, self._here.copy())
            return None
        new = self._stepper.t > self._begin  # the others were the run's that was before
        energy = 0.0
        if count >= event.after and isinstance(action, Set | Jump):
            try:
                self.check(action, f"event {event.name!r}")
            except InvalidParameterError as error:
                raise NotFollowedError(str(error)) from None
            energy = self._carry_out(event.name, action)
        self._keep(event, count >= event.after)
        if new:
            self.happened.append(Happening(event.name, self._stepper.t, energy))
        self._samples.add(self._stepper.t, self._here.copy())
        return event.name if new and count >= event.after and isinstance(action, Stop) else None

    def _keep(self, event: Event, acts: bool) -> None:
        """Keep what has happened for who asks for it."""
        if self.passages is not None:
            done = tuple(self.modes.done)
            program = self._workspace.program.copy()
            self.passages.append(Passage(self._stepper.t, event, acts, done, program))

    def check(self, action: Set | Jump, who: str = "Set") -> None:
        """Refuse to set at the present state what makes a motion jump, or holds a joint that one moves.

        Args:
            action: What is to be done.
            who: Who sets it, for the refusal.

        Raises:
            InvalidParameterError: A motion would jump.
            NotFollowedError: A joint would be held where motions move it.
        """
        if not isinstance(action, Set):
            return
        element, _, key = action.place.rpartition(".")
        if self.motions.is_one(element):
            self.motions.goes_on(action.place, action.value, self._stepper.t, who)
        elif key == "on" and action.value:
            held = self._workspace, self.adjustments, self._stepper.t, self._here, element
            check_restraint(*held, [one.name for one in self._workspace.system.holds])

    def obey(self, name: str, action: Set) -> None:
        """Do at the present state what an event of this name would that happened here."""
        energy = self._carry_out(name, action)
        if self._stepper.t > self._begin:
            self.happened.append(Happening(name, self._stepper.t, energy))
        self._samples.add(self._stepper.t, self._here.copy())

    def _carry_out(self, name: str, action: Set | Jump) -> float:
        """Change what an event changes, and what changes by that; return the energy brought in [J]."""
        energy = -self._energy()
        if isinstance(action, Set):
            element, _, key = action.place.rpartition(".")
            if self.motions.is_one(element):
                for place, value in self.motions.goes_on(action.place, action.value, self._stepper.t).items():
                    self.set(place, value)
                energy -= self._strike()
            else:
                self.set(action.place, action.value)
            if key == "on" and action.value:
                self.modes.arm(element, self._stepper.t, self._here)
                self._renew()
        else:
            self._jump(name, action)
        energy += self._energy()
        self._follow()
        return energy

    def _strike(self) -> float:
        """Have the rates that motions have from now on; return their work [J]."""
        if self.passages is not None:
            raise NotFollowedError(
                "a motion's rate jumps, through which no derivatives are carried; take a smooth course, or "
                "differences of runs"
            )
        held = self.adjustments.held()
        work = self.motions.strike(self._stepper.t, self._here)
        if self.adjustments.held() != held:
            self._renew()
        self._control.spin = self._workspace.system.turn_on(self._stepper.start)
        return work

    def _follow(self) -> None:
        """Have all that follows from a change at once."""
        self._stepper.refresh()
        self._watch.renew()
        if self.modes and (due := self.modes.due(self._stepper.t, self._here)) is not None:
            self._switch(due)

    def look_by(self, watch: Watch) -> None:
        """Do from now on what the events of another watch ask for."""
        self._watch = watch

    def begin(self) -> None:
        """Bring elements into the modes that they have at the start of a run."""
        self.modes.begin(self._stepper.t, self._here)
        for place in self.adjustments.elements:
            self._change(place)
        self._renew()

    def _change(self, place: str) -> None:
        """Let an element be as it is by itself from the present time on."""
        element = self.adjustments.elements[place]
        if isinstance(element, OnLinks):
            for key, value in element.from_now_on(self._stepper.t).items():
                self.adjustments.set(f"{place}.{key}", value)

    def _switch(self, action: Switch) -> bool:
        """Let an element change its mode, and what changes by that at once; return whether any does."""
        recorded, before = len(self.modes.changed), self._energy()
        y = self._here
        lost = self.modes.lost(y)
        if not self.modes.take(action, self._stepper.t, y):
            self._watch.logical(ZERO)
            return False
        self._control.spin = self._workspace.system.turn_on(self._stepper.start)
        energy = self._energy() - before + self.modes.lost(y) - lost
        self._renew()
        self._stepper.refresh()
        self._watch.renew()
        self._watch.logical(ZERO)
        t = self._stepper.t
        for k, one in enumerate(self.modes.changed[recorded:]):
            if t > self._begin:
                self.happened.append(Happening(one.name, t, energy if k == 0 else 0.0))
        self._samples.add(t, self._here.copy())
        return True

    def _renew(self) -> None:
        self._control.renew(self.adjustments.elements.values())
        self.motions.renew(self._stepper.t)
        self._samples.program = self.motions.whole()

    def set(self, place: str, value: float) -> None:
        """Change a number of a drive or a spring."""
        self.adjustments.set(place, value)
        self._renew()

    def sight(self) -> Sight:
        """Return what lets controllers see the run."""
        return Sight(self._workspace)

    def command(self, numbers: Mapping[str, float]) -> None:
        """Change numbers that take commands, by place: what they store nothing hangs on."""
        for place, value in numbers.items():
            self.adjustments.set(place, value)
        self._renew()
        self._stepper.refresh()
        self._watch.renew()
        if self.modes and (due := self.modes.due(self._stepper.t, self._here)) is not None:
            self._switch(due)
        elif self._stepper.t <= self._samples.last or any(self._workspace.memory["touching"]):
            # What holds from now on is what is kept; the peaks of contacts find here what held at them.
            self._samples.add(self._stepper.t, self._here.copy())

    def _jump(self, event: str, action: Jump) -> None:
        system, here = self._workspace.system, self._here
        n = system.model.nq + system.model.nv
        after = action.state_after(event, self._watch.moment.set(self._stepper.t, here))
        here[:n] = after[:n]
        self._control.spin = system.turn_on(self._stepper.start)

    def _energy(self) -> float:
        """Return all that is stored at the present state [J]."""
        self._workspace.measure(self._here)
        return audit(self._workspace, self._here).energy

    @property
    def _here(self) -> Array:
        here: Array = self._stepper.start[: self._workspace.manifold.size]
        return here
