"""Elements that change their mode in a run: what is looked for, and what happens then.

A function of an element (:mod:`antenna_pin.elements.modal`) is positive while its mode stays. It is located
as an event's is; what happens is the element's to say. What else passes at the same instant, by the impulse
of the first, is seen to at once and by logic: a function that is zero but for round-off passes where its rate
is negative, one of a load where it is negative.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.dynamics import Adjustments, System, Workspace, acting_in, first_modes, impulse, kernels
from antenna_pin.dynamics.acting import Acting
from antenna_pin.dynamics.restraints import check_restraint
from antenna_pin.elements import FAMILIES, LOSS, Change, Met, Modal, StickingFriction
from antenna_pin.engine.watch_kernels import WEIGHED
from antenna_pin.errors import MechanismError
from antenna_pin.simulation.events import Event
from antenna_pin.simulation.kinks import edges_of, ends_of, kinks_of
from antenna_pin.simulation.moment import Moment
from antenna_pin.simulation.own_actions import STILL, Switch
from antenna_pin.simulation.passages import Blow, Turned
from antenna_pin.simulation.sticking import NeverSettlesError, Settling, Shift

__all__ = [
    "ZERO",
    "Changed",
    "Modes",
    "NeverSettlesError",
    "Switching",
    "kinetic",
    "own_events",
    "switches_of",
]

Array = NDArray[np.float64]

# Changes at one instant, for each element, from which on they would never end.
_AT_MOST = 100
# Of a function of angles and rates: what round-off leaves of it where it is zero.
ZERO = 1e-11


@dataclass(frozen=True, slots=True)
class Switching:
    """The function of an element that is positive while its mode stays.

    Attributes:
        place: Of the element.
        block: Place of the element in the program.
        number: Of the function.
        hold: Of the hold whose load it asks for, or -1; WEIGHED if for its joint's reduced inertia.
    """

    place: str
    block: int
    number: int
    hold: int

    def __call__(self, moment: Moment) -> float:
        """Return its value."""
        return moment.switch(self.block, self.number, self.hold)[0]

    def rate(self, moment: Moment) -> float:
        """Return its rate, 0 where that is not known."""
        return moment.switch(self.block, self.number, self.hold)[1]


@dataclass(frozen=True, slots=True)
class Changed:
    """A change of mode that has happened.

    Attributes:
        name: What it is, such as ``stop hinge: upper: on``.
        element: Place of the element.
        time: When [s].
        mode: The next one, in a word.
        angle: Of the joint [rad] ([m]).
        rate: Before it [rad/s] ([m/s]), ``rate_after`` it.
        rate_after: See there.
        loss: Energy lost in the impulse [J].
        impulse: On the child [N m s] ([N s]).
        energy: Of the joint's own motion before, of elements that weigh it [J]; NaN of others.
    """

    name: str
    element: str
    time: float
    mode: str
    angle: float
    rate: float
    rate_after: float
    loss: float
    impulse: float
    energy: float = math.nan


def switches_of(system: System) -> tuple[Event, ...]:
    """Return the events at which elements may change their mode."""
    holds = [one.name for one in system.holds]
    return tuple(
        Event(
            name=f"{one.label} switches by {k}",
            when=Switching(one.place, one.block, k, _asks(one.element, one.place, k, holds)),
            direction=-1,
            action=Switch(one.place, k),
        )
        for one in acting_in(system)
        if isinstance(one.element, Modal) and one.element.ever_changes
        for k in range(one.element.switches)
    )


def _asks(element: Modal, place: str, k: int, holds: list[str]) -> int:
    """Return what function k of an element asks for: the number of its hold, WEIGHED, or -1 for nothing."""
    if k in element.weighed:
        return WEIGHED
    return holds.index(place) if k in element.loaded else -1


def own_events(system: System) -> tuple[Event, ...]:
    """Return what every run of a system looks for itself."""
    return (*ends_of(system), *kinks_of(system), *edges_of(system), *switches_of(system))


class Modes:
    """The elements with modes of a run.

    Args:
        workspace: What the run works on.
        adjustments: Its elements as they are; written.

    Attributes:
        changed: What has happened, in order.
        done: What has been done since that was last forgotten, for who does it again to neighbours.
    """

    def __init__(self, workspace: Workspace, adjustments: Adjustments) -> None:
        """Begin with what the system has."""
        self._workspace = workspace
        self._adjustments = adjustments
        self._moment = Moment(workspace)
        system = workspace.system
        self._acting: Mapping[str, Acting] = {
            one.place: one for one in acting_in(system) if isinstance(one.element, Modal)
        }
        self._holds = [one.name for one in system.holds]
        self.changed: list[Changed] = []
        self.done: list[Turned | Blow] = []
        self._dry = Settling(workspace, adjustments, self._acting)
        self._limit = _AT_MOST * (1 + len(self._acting))
        self._instant, self._taken = math.nan, 0
        self._places = [
            int(workspace.program[one.block :][: kernels.PARAMETERS].view(kernels.ELEMENT)[0]["x"])
            + one.element.integrals.index(LOSS)
            for one in self._acting.values()
        ]

    def __bool__(self) -> bool:
        """Whether there are any."""
        return bool(self._acting)

    def _element(self, place: str) -> Modal:
        element = self._adjustments.elements[place]
        assert isinstance(element, Modal)
        return element

    def _met(self, place: str, t: float, y: Array) -> Met:
        nq = self._workspace.model.nq
        angle, rate, _, _ = kernels.joint_motion(self._workspace.program, self._acting[place].block, y, nq)
        load = 0.0
        if self._element(place).holds:
            load = self._moment.set(t, y).load(self._holds.index(place))
        head = self._workspace.program[self._acting[place].block :][: kernels.PARAMETERS]
        first = nq + self._workspace.model.nv + int(head.view(kernels.ELEMENT)[0]["x"])
        own = tuple(float(y[first + k]) for k in range(len(self._element(place).integrals)))
        inertia = 0.0
        if self._element(place).weighs:
            inertia = self._moment.set(t, y).inertia(self._acting[place].block)
        return Met(t, float(angle), float(rate), load, own, inertia)

    def begin(self, t: float, y: Array) -> None:
        """Bring all into the modes that they have at the start of a run."""
        for place, value in first_modes(self._workspace.system, y, t):
            self._adjustments.set(place, value)
        try:
            self._settle(t, y)
        except NeverSettlesError as error:
            raise MechanismError(
                f"{error}: what sticks and what slips at the start does not settle; give its friction a "
                "Stribeck rate, by which it falls bit by bit as it begins to slip"
            ) from None
        self.changed.clear()

    def arm(self, place: str, t: float, y: Array) -> None:
        """Tell an element that is switched on where its joint is, if it has modes."""
        if place in self._acting:
            change = self._element(place).armed(self._met(place, t, y))
            if change is not None:
                self._adjustments.change(place, change)

    def take(self, action: Switch, t: float, y: Array) -> bool:
        """Let a function pass, and all that passes by that at the same instant; y is changed in place.

        Returns:
            Whether anything was changed.

        Raises:
            NeverSettlesError: Changes at one instant would never end.
        """
        if t != self._instant:
            self._instant, self._taken = t, 0
        self._taken += 1
        if self._taken > self._limit:
            raise NeverSettlesError(action.place)
        if action.place in self._dry:
            self._settle(t, y, action)
        elif not self._pass(action.place, action.number, t, y):
            element = self._element(action.place)
            asks = _asks(element, action.place, action.number, self._holds)
            block = self._acting[action.place].block
            if asks < 0 and self._moment.set(t, y).switch(block, action.number, asks)[0] < -ZERO:
                raise NeverSettlesError(action.place)
            return False
        settled = action.place in self._dry
        for _ in range(self._limit):
            due = self.due(t, y, dry=False)
            if due is not None:
                self._pass(due.place, due.number, t, y)
            elif settled:
                return True
            else:
                self._settle(t, y)
            settled = due is None
        raise NeverSettlesError(action.place)

    def _settle(self, t: float, y: Array, action: Switch | None = None) -> None:
        """Have joints with dry friction agree on what they do."""
        for shift in self._dry.settle(t, y, action) if self._dry else ():
            self._note(shift, t, y)
            if shift.before.mode != self._element(shift.place).mode:
                self.done.append(Turned(shift.place, shift.before, _comes_to_stick))

    def _note(self, shift: Shift, t: float, y: Array) -> None:
        """Record what has become of a joint with dry friction."""
        element, met = self._element(shift.place), shift.met
        what = element.change_said(shift.before.mode)
        if what:
            one, rate = self._acting[shift.place], self._met(shift.place, t, y).rate
            name = f"{FAMILIES[one.family].word} {one.name}: {what}"
            mode = element.modes[element.mode]
            self.changed.append(Changed(name, shift.place, t, mode, met.angle, met.rate, rate, 0.0, 0.0))

    def jammed(self, t: float, y: Array) -> str:
        """Return of which joints friction by load has no solution, as a part of a message; "" if of none."""
        return self._dry.jammed(t, y) if self._dry else ""

    def lost(self, y: Array) -> float:
        """Return all that impulses and dampers of these elements have taken [J]."""
        at = self._workspace.model.nq + self._workspace.model.nv
        return float(sum(y[at + place] for place in self._places))

    def due(self, t: float, y: Array, *, dry: bool = True) -> Switch | None:
        """Return a function that passes at this state; of dry friction only if that is asked for."""
        moment = self._moment.set(t, y)
        for place, one in self._acting.items():
            element = self._element(place)
            if not dry and place in self._dry:
                continue
            for k in range(element.switches):
                hold = _asks(element, place, k, self._holds)
                value, slope = moment.switch(one.block, k, hold)
                if hold >= 0 or abs(value) > ZERO:
                    passes = value < 0.0
                else:
                    passes = slope < -ZERO
                if passes and element.passed(k, self._met(place, t, y)) is not None:
                    return Switch(place, k)
        return None

    def _pass(self, place: str, k: int, t: float, y: Array) -> bool:
        element, met = self._element(place), self._met(place, t, y)
        change = element.passed(k, met)
        if change is None:
            return False
        self.done.append(Turned(place, element, lambda one, there: one.passed(k, there)))
        self._adjustments.change(place, change)
        for other in change.switches_off:
            self._adjustments.set(f"{other}.on", False)
        after = self._element(place)
        loss, blow, rate = change.loss, change.impulse, met.rate
        if change.restitution is not None or (after.holds and self._adjustments.holds(place)):
            check_restraint(self._workspace, self._adjustments, t, y, place, self._holds)
            loss, blow = self._jump(place, change.restitution, met, t, y)
            rate = self._met(place, t, y).rate
        if change.what:
            one = self._acting[place]
            name = f"{FAMILIES[one.family].word} {one.name}: {change.what}"
            mode = element.modes[change.mode]
            energy = met.energy if element.weighs else math.nan
            self.changed.append(Changed(name, place, t, mode, met.angle, met.rate, rate, loss, blow, energy))
        return True

    def _jump(
        self, place: str, restitution: float | None, met: Met, t: float, y: Array
    ) -> tuple[float, float]:
        """Make the impulse of an element; return the energy that is lost and its impulse."""
        workspace = self._workspace
        nq, nv = workspace.model.nq, workspace.model.nv
        head = workspace.program[self._acting[place].block :][: kernels.PARAMETERS].view(kernels.ELEMENT)[0]
        wanted = {} if restitution is None else {int(head["v"]): -restitution * met.rate}
        moves = abs(met.rate) > STILL  # else nothing jumps but by round-off, and all that holds goes on
        for _ in range(1 + len(self._holds)):
            after, held, own = impulse(workspace, t, y, wanted)
            for other, blow in zip(self._holds, held, strict=True):
                bears = moves and other != place and other in self._acting
                let_go = self._element(other).bears(float(blow)) if bears else None
                if let_go is not None and self._adjustments.holds(other):
                    self._adjustments.change(other, let_go)
                    break
            else:
                break
        self.done.append(
            Blow(workspace.program.copy(), int(head["v"]), self._acting[place].block, restitution)
        )
        before = kinetic(workspace, y)
        y[nq : nq + nv] = after
        loss = before - kinetic(workspace, y)
        y[nq + nv + int(head["x"]) + self._element(place).integrals.index(LOSS)] += loss
        blow = own[0] if len(own) else held[self._holds.index(place)]
        return float(loss), float(blow)


def _comes_to_stick(element: Modal, met: Met) -> Change | None:
    return element.sticks(met) if isinstance(element, StickingFriction) else None


def kinetic(workspace: Workspace, y: Array) -> float:
    """Return the kinetic energy of a state [J]."""
    model = workspace.model
    nq, nv = model.nq, model.nv
    found = float(pin.computeKineticEnergy(model, workspace.data, y[:nq], y[nq : nq + nv]))
    return found if math.isfinite(found) else math.nan
