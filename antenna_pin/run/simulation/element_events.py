"""Events of elements: ends of ranges, kinks, pulses, changes of mode; their effects."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Adjustments, System, Workspace, acting_in, kernels
from antenna_pin.dynamics.adjust import Acting
from antenna_pin.elements import Change, Met, Modal
from antenna_pin.run.engine.watch_kernels import WEIGHED
from antenna_pin.run.simulation.events import (
    GRAZE,
    Angle,
    Edge,
    Event,
    Kink,
    Moment,
    Rate,
    Stop,
    Switch,
    Time,
)
from antenna_pin.trajectory import Outcome

Array = NDArray[np.float64]

# --- kinks, ranges and pulses of elements -------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class KinkFunction:
    """Function of an element that is zero at a kink of its effort."""

    block: int  # place of the element in the program
    number: int = 0  # number of the function

    def __call__(self, moment: Moment) -> float:
        """Return the distance past the kink."""
        return moment.kink(self.block, self.number)


@dataclass(frozen=True, slots=True)
class RangeEnd(Angle):
    """End of an element's range; the joint may be beyond while the element is off."""

    block: int  # place of the element in the program
    side: float  # side of the range: -1 below the end, +1 above it

    def __call__(self, moment: Moment) -> float:
        """Return the distance past the end; while the element is off, the side."""
        return Angle.__call__(self, moment) if moment.acts(self.block) else self.side


def range_events(system: System) -> tuple[Event, ...]:
    """Return the events that end a run at the ends of elements' ranges."""
    return tuple(
        Event(
            name=f"{one.label} has no torque beyond {end:g}",
            when=RangeEnd(joint, end, one.block, 1.0 if end == min(one.element.ends) else -1.0),
            action=Stop(),
        )
        for one in acting_in(system)
        if (joint := one.element.acts_at) is not None
        for end in one.element.ends
    )


def edge_events(system: System) -> tuple[Event, ...]:
    """Return the events at which pulses begin and end and motions jump."""
    return tuple(
        Event(name=f"{one.label} changes", when=Time(*edges), action=Edge(one.place))
        for one in acting_in(system)
        if (edges := one.element.edges)
    )


def kink_events(system: System) -> tuple[Event, ...]:
    """Return the events that end steps at kinks of elements' efforts.

    Names are unique, for a run that continues another finds the memory of an event by its name.
    """
    kinks = [
        Event(
            name=f"{one.label} has a kink{f' ({k + 1})' if k else ''}",
            when=KinkFunction(one.block, k),
            action=Kink(),
        )
        for one in acting_in(system)
        for k in range(one.element.kinks)
    ]
    reversals = [
        Event(name=f"{one.label} has a kink where {joint!r} turns back", when=Rate(joint), action=Kink())
        for one in acting_in(system)
        for joint in one.element.reversals
    ]
    return (*kinks, *reversals)


# --- changes of mode ----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class ModeFunction:
    """Function of an element that is positive while its mode persists."""

    place: str  # place of the element, as ``stops.hinge``
    block: int  # place of the element in the program
    number: int  # number of the function
    hold: int  # number of the hold whose load the function takes, WEIGHED for a reduced inertia, or -1

    def __call__(self, moment: Moment) -> float:
        """Return the value of the function."""
        return moment.switch(self.block, self.number, self.hold)[0]

    def rate(self, moment: Moment) -> float:
        """Return the rate of the function, 0 if unknown."""
        return moment.switch(self.block, self.number, self.hold)[1]


@dataclass(frozen=True, slots=True)
class ModeChangeEvent:
    """Recorded change of mode of an element."""

    name: str  # name of the change, as ``stop hinge: upper: on``
    element: str  # place of the element
    what: str  # description of the change, as ``upper: on``
    time: float  # time [s]
    mode: str  # name of the next mode
    angle: float  # angle of the joint [rad] ([m])
    rate: float  # rate of the joint before the change [rad/s] ([m/s])
    rate_after: float  # rate of the joint after the change [rad/s] ([m/s])
    loss: float  # energy lost in the impulse [J]
    impulse: float  # impulse on the child [N m s] ([N s])
    energy: float = math.nan  # energy of the joint's motion before, for elements that use it [J]; else NaN
    peak_effort: float = math.nan  # largest effort of the touch that ends [N m] ([N]); else NaN
    peak_time: float = math.nan  # time of the largest effort [s]; else NaN


def mode_events(system: System) -> tuple[Event, ...]:
    """Return the events at which elements may change their mode."""
    holds = [one.name for one in system.holds]
    return tuple(
        Event(
            name=f"{one.label} switches by {k}",
            when=ModeFunction(one.place, one.block, k, hold_of(one.element, one.place, k, holds)),
            direction=-1,
            action=Switch(one.place, k),
        )
        for one in acting_in(system)
        if isinstance(one.element, Modal) and one.element.ever_changes
        for k in range(one.element.switches)
    )


def hold_of(element: Modal, place: str, k: int, holds: list[str]) -> int:
    """Return the load that function k depends on: number of a hold, WEIGHED or -1."""
    if k in element.weighed:
        return WEIGHED
    return holds.index(place) if k in element.loaded else -1


class NeverSettlesError(Exception):
    """Endless changes of mode at one time; the element."""

    outcome: ClassVar[Outcome] = Outcome.NO_PROGRESS

    @property
    def text(self) -> str:
        """Return the reason as part of a message."""
        return f", {self} comes to no mode in which it stays"


def own_events(system: System) -> tuple[Event, ...]:
    """Return the events that every run of a system detects."""
    return (*range_events(system), *kink_events(system), *edge_events(system), *mode_events(system))


# --- effects of an event ------------------------------------------------------------------------------------


class ModeEffect(NamedTuple):
    """Element that has changed its mode."""

    place: str  # place of the element
    before: Modal  # element before the change
    change: Callable[[Modal, Met], Change | None]  # function for the change, given the state of the joint


class StruckElement(NamedTuple):
    """Element at which an impulse acts."""

    element: str  # place of the element
    at: int  # index of the joint in v
    block: int  # place of the element in the program, for the joint's rate
    restitution: float | None  # coefficient of restitution [-]; None where a constraint stops the joint


class ImpulseEffect(NamedTuple):
    """Impulses of one time."""

    program: Array  # program of force elements after the impulses
    struck: tuple[StruckElement, ...]  # struck elements; other holding elements have rows in the program
    apart: bool  # whether no impulse changes the rate of another struck joint


class EventEffect(NamedTuple):
    """Effect of an event."""

    time: float  # time [s]
    event: Event
    acts: bool  # whether the actions were carried out
    done: tuple[ModeEffect | ImpulseEffect, ...]  # effects at elements, in order
    program: Array  # program of force elements after the event

    @property
    def together(self) -> bool:
        """Return whether several impulses of the event interact, so that their order matters."""
        return any(isinstance(one, ImpulseEffect) and len(one.struck) > 1 for one in self.done)


def effects_of(
    done: Sequence[ModeEffect | ImpulseEffect],
    events: Sequence[Event],
    program: Array,
    workspace: Workspace,
    t: float,
) -> list[EventEffect]:
    """Return the effects at elements at one time, each with its located event.

    Independent impulses belong to their own events each; interacting ones, with the effects at their
    elements, to the last event, and so do effects without an event.
    """
    ranges = {one.place: _words_of(one) for one in acting_in(workspace.system)}
    left, found, before = _apart(done), list[EventEffect](), program
    coupled = {
        struck.element
        for one in left
        if isinstance(one, ImpulseEffect) and len(one.struck) > 1
        for struck in one.struck
    }
    for k, event in enumerate(events):
        place = event.action.place if isinstance(event.action, Switch) else ""
        place = "" if place in coupled else place
        last = k + 1 == len(events)
        own = [one for one in left if last or _is_of(one, place)]
        left = [one for one in left if not (last or _is_of(one, place))]
        behind = workspace.program.copy()
        if not last:
            behind[:] = before
            for one in own:
                if isinstance(one, ModeEffect):
                    behind[ranges[one.place]] = workspace.program[ranges[one.place]]
        own = [
            one._replace(program=behind) if isinstance(one, ImpulseEffect) and not last else one
            for one in own
        ]
        found.append(EventEffect(t, event, True, tuple(own), behind))
        before = behind
    return found


def _words_of(one: Acting) -> slice:
    return slice(one.block, one.block + int(kernels.PARAMETERS) + len(one.element.words_of_kernel()))


def _is_of(one: ModeEffect | ImpulseEffect, place: str) -> bool:
    if isinstance(one, ModeEffect):
        return one.place == place
    return len(one.struck) == 1 and one.struck[0].element == place


def _apart(done: Sequence[ModeEffect | ImpulseEffect]) -> list[ModeEffect | ImpulseEffect]:
    """Return the effects, with independent impulses separated."""
    found: list[ModeEffect | ImpulseEffect] = []
    for one in done:
        if isinstance(one, ModeEffect) or len(one.struck) < 2 or not one.apart:
            found.append(one)
        else:
            found += [one._replace(struck=(struck,)) for struck in one.struck]
    return found


# --- coincident events --------------------------------------------------------------------------------------

# Round-off of a function of angles and rates at its zero.
ZERO = 1e-11


class LocatedFunction(NamedTuple):
    """Function located at this time: its element and mode, and its value."""

    place: str
    number: int
    mode: int
    value: float


class CoincidentChange(NamedTuple):
    """Function that passes zero: its element, the state of the joint, the change."""

    place: str
    number: int
    met: Met
    change: Change


def met_at(workspace: Workspace, one: Acting, t: float, y: Array) -> Met:
    """Return position and rate of an element's joint."""
    angle, rate, _, _ = kernels.joint_motion(workspace.program, one.block, y, workspace.model.nq)
    return Met(t, float(angle), float(rate), 0.0)


class CoincidentEvents:
    """Functions of elements that pass zero at one state.

    Beside the functions that the search has located others pass by logic: a function that is zero except for
    round-off if its rate is negative, or if that is zero too, by the next derivative; one of a load if it is
    negative.
    """

    def __init__(self, workspace: Workspace, adjustments: Adjustments, acting: Mapping[str, Acting]) -> None:
        """Allocate once."""
        self._workspace, self._adjustments, self._acting = workspace, adjustments, acting
        self._moment = Moment(workspace)
        self._holds = [one.name for one in workspace.system.holds]
        self._rates = np.zeros(workspace.model.nv + workspace.manifold.nx)

    def _element(self, place: str) -> Modal:
        element = self._adjustments.elements[place]
        assert isinstance(element, Modal)
        return element

    def met(self, place: str, t: float, y: Array) -> Met:
        """Return the state of an element's joint: angle, rate, load, integrals, inertia."""
        met, nq = met_at(self._workspace, self._acting[place], t, y), self._workspace.model.nq
        load = 0.0
        if self._element(place).holds:
            load = self._moment.set(t, y).load(self._holds.index(place))
        head = self._workspace.program[self._acting[place].block :][: kernels.PARAMETERS]
        first = nq + self._workspace.model.nv + int(head.view(kernels.ELEMENT)[0]["x"])
        own = tuple(float(y[first + k]) for k in range(len(self._element(place).integrals)))
        inertia = 0.0
        if self._element(place).weighs:
            inertia = self._moment.set(t, y).inertia(self._acting[place].block)
        return met._replace(load=load, integrals=own, inertia=inertia)

    def pending(self, one: Switch, t: float, y: Array) -> LocatedFunction:
        """Return a located function with its present mode and value."""
        self._moment.set(t, y)
        return LocatedFunction(one.place, one.number, self._element(one.place).mode, self.value(one)[0])

    def is_past(self, one: Switch, t: float, y: Array) -> bool:
        """Return whether a function, except of a load, is negative beyond round-off."""
        self._moment.set(t, y)
        if hold_of(self._element(one.place), one.place, one.number, self._holds) >= 0:
            return False
        return self.value(one)[0] < -ZERO

    def value(self, one: Switch | LocatedFunction) -> tuple[float, float]:
        """Return value and rate of a function at the moment's state."""
        hold = hold_of(self._element(one.place), one.place, one.number, self._holds)
        return self._moment.switch(self._acting[one.place].block, one.number, hold)

    def grazes(self, one: Switch | LocatedFunction, t: float, y: Array) -> bool:
        """Return whether a function near zero turns back, by its second derivative.

        The search finds zeros in the dense output, which is off by more than a step's end is. A function f
        with rate f' < 0 and f'' > 0 comes down to f - f'^2 / (2 f''): where that is above zero except for
        round-off nothing passes.
        """
        value, slope = self.value(one)
        if slope == 0.0 or value < -GRAZE:
            return False
        nq, nv = self._workspace.model.nq, self._workspace.model.nv
        self._workspace.derivative(t, y, self._rates)
        faster = y.copy()
        faster[nq : nq + nv] += self._rates[:nv]
        self._moment.set(t, faster)
        bend = self.value(one)[1] - slope
        self._moment.set(t, y)
        return bend > 0.0 and (slope > 0.0 or value - 0.5 * slope * slope / bend > -GRAZE)

    def passing(
        self, t: float, y: Array, pending: Sequence[LocatedFunction], decided: Callable[[str, int], bool]
    ) -> list[CoincidentChange]:
        """Return the changes due at this state, the earliest phase of each element."""
        known = {(one.place, one.number) for one in pending}
        self._moment.set(t, y)
        found = []
        for place in self._acting:
            element = self._element(place)
            numbers = [
                k
                for k in range(element.switches)
                if not decided(place, k)
                and ((place, k) in known or self._passes(Switch(place, k), bool(known), t, y))
            ]
            if not numbers:
                continue
            met = self.met(place, t, y)
            self._moment.set(t, y)
            changes = [
                CoincidentChange(place, k, met, change)
                for k in numbers
                if (change := element.passed(k, met)) is not None
            ]
            found += [min(changes, key=lambda one: one.change.phase)] if changes else []
        return found

    def _passes(self, one: Switch, is_first: bool, t: float, y: Array) -> bool:
        """Return whether a function passes that was not located; loads only after the first round."""
        loaded = hold_of(self._element(one.place), one.place, one.number, self._holds) >= 0
        if loaded and is_first:
            return False
        value, slope = self.value(one)
        if loaded or abs(value) > ZERO:
            return value < 0.0
        return slope < -ZERO and not self.grazes(one, t, y)

    def still(
        self,
        pending: Sequence[LocatedFunction],
        before: Mapping[str, object],
        decided: Callable[[str, int], bool],
        t: float,
        y: Array,
    ) -> list[LocatedFunction]:
        """Return the located functions that still pass after changes."""
        self._moment.set(t, y)
        found = []
        for one in pending:
            if decided(one.place, one.number) or self._adjustments.elements[one.place] is before[one.place]:
                value, slope = self.value(one)
                if abs(value - one.value) <= ZERO * max(1.0, abs(one.value)) and slope <= 0.0:
                    found.append(one)
        return found
