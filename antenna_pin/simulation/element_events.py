"""Events of elements: ends of ranges, kinks, pulses, changes of mode; coincident events and their effects."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Adjustments, System, Workspace, acting_in, kernels
from antenna_pin.dynamics.acting import Acting
from antenna_pin.elements import Change, Met, Modal
from antenna_pin.engine.watch_kernels import WEIGHED
from antenna_pin.simulation.events import GRAZE, Angle, Edge, Event, Kink, Moment, Rate, Stop, Switch, Time
from antenna_pin.trajectory import Outcome

__all__ = [
    "CoincidentChange",
    "CoincidentEvents",
    "EventEffect",
    "ImpulseEffect",
    "KinkFunction",
    "ModeChange",
    "ModeEffect",
    "ModeFunction",
    "NeverSettlesError",
    "StruckElement",
    "ZERO",
    "effects_of",
    "met_at",
    "own_events",
]

Array = NDArray[np.float64]

# --- kinks, ranges and pulses of elements -------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class KinkFunction:
    """The function of an element that is zero where its effort has a kink.

    Attributes:
        block: Place of the element in the program.
        number: Of the function.
    """

    block: int
    number: int = 0

    def __call__(self, moment: Moment) -> float:
        """Return how far it is past the kink."""
        return moment.kink(self.block, self.number)


@dataclass(frozen=True, slots=True)
class RangeEnd(Angle):
    """End of the range of an element; its joint may lie beyond while the element is off.

    Attributes:
        block: Place of the element in the program.
        side: Of the range: -1 below the end, +1 above it.
    """

    block: int
    side: float

    def __call__(self, moment: Moment) -> float:
        """Return the distance of the joint past the end; the side of the range while the element is off."""
        return Angle.__call__(self, moment) if moment.acts(self.block) else self.side


def range_events(system: System) -> tuple[Event, ...]:
    """Return the events at which a run ends, for an element knows nothing of what is beyond."""
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
    """Return the events at which elements change by themselves: pulses begin and end, motions jump."""
    return tuple(
        Event(name=f"{one.label} changes", when=Time(*edges), action=Edge(one.place))
        for one in acting_in(system)
        if (edges := one.element.edges)
    )


def kink_events(system: System) -> tuple[Event, ...]:
    """Return the events at which steps end for the sake of elements whose effort has kinks.

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
class ModeChange:
    """A change of mode that has happened.

    Attributes:
        name: What it is, such as ``stop hinge: upper: on``.
        element: Place of the element.
        what: The change in words, such as ``upper: on``.
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
    what: str
    time: float
    mode: str
    angle: float
    rate: float
    rate_after: float
    loss: float
    impulse: float
    energy: float = math.nan


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
    """Return what function k of an element asks for: the number of its hold, WEIGHED, or -1 for nothing."""
    if k in element.weighed:
        return WEIGHED
    return holds.index(place) if k in element.loaded else -1


class NeverSettlesError(Exception):
    """Changes of mode at one instant would never end; of which element."""

    outcome: ClassVar[Outcome] = Outcome.NO_PROGRESS

    @property
    def seen(self) -> str:
        """Return the reason as part of a message."""
        return f", {self} comes to no mode in which it stays"


def own_events(system: System) -> tuple[Event, ...]:
    """Return what every run of a system looks for itself."""
    return (*range_events(system), *kink_events(system), *edge_events(system), *mode_events(system))


# --- effects of an event ------------------------------------------------------------------------------------


class ModeEffect(NamedTuple):
    """An element that has changed its mode.

    Attributes:
        place: Of it.
        before: As it was.
        change: What it does where it meets its joint.
    """

    place: str
    before: Modal
    change: Callable[[Modal, Met], Change | None]


class StruckElement(NamedTuple):
    """An element that an impulse is of.

    Attributes:
        element: Place of the element.
        at: Place in v of its joint.
        block: Of the element in the program, to tell the joint's rate.
        restitution: Of the joint; None where its row brings it to rest.
    """

    element: str
    at: int
    block: int
    restitution: float | None


class ImpulseEffect(NamedTuple):
    """The impulses of one instant.

    Attributes:
        program: Of the elements as they are behind them.
        struck: Elements that they are of; those that hold besides have rows in the program.
        apart: Whether none of them changes the rates of the other joints.
    """

    program: Array
    struck: tuple[StruckElement, ...]
    apart: bool


class EventEffect(NamedTuple):
    """What has happened at an instant, by an event.

    Attributes:
        time: When [s].
        event: By which.
        acts: Whether it did what it is there for.
        done: What elements did, in order.
        program: Behind it.
    """

    time: float
    event: Event
    acts: bool
    done: tuple[ModeEffect | ImpulseEffect, ...]
    program: Array

    @property
    def together(self) -> bool:
        """Return whether several blows of it feel each other: in which order they come then decides."""
        return any(isinstance(one, ImpulseEffect) and len(one.struck) > 1 for one in self.done)


def effects_of(
    done: Sequence[ModeEffect | ImpulseEffect],
    events: Sequence[Event],
    program: Array,
    workspace: Workspace,
    t: float,
) -> list[EventEffect]:
    """Return what elements did at an instant, each with the event at which it was located.

    Blows that do not feel each other are each of its own event; those that do, with what they are of, belong
    to the last, and so does what is of none.

    Args:
        done: What they did, in order.
        events: At which their functions passed.
        program: Before it.
        workspace: The run's, with its program behind it.
        t: When [s].
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
    """Return what was done with blows that do not feel each other one by one."""
    found: list[ModeEffect | ImpulseEffect] = []
    for one in done:
        if isinstance(one, ModeEffect) or len(one.struck) < 2 or not one.apart:
            found.append(one)
        else:
            found += [one._replace(struck=(struck,)) for struck in one.struck]
    return found


# --- coincident events --------------------------------------------------------------------------------------

# Of a function of angles and rates: what round-off leaves of it where it is zero.
ZERO = 1e-11


class LocatedFunction(NamedTuple):
    """A function that was located at this instant: of which element in which mode, and its value there."""

    place: str
    number: int
    mode: int
    value: float


class CoincidentChange(NamedTuple):
    """A function that passes: of which element, how that meets its joint, and what changes by it."""

    place: str
    number: int
    met: Met
    change: Change


def met_at(workspace: Workspace, one: Acting, t: float, y: Array) -> Met:
    """Return where an element finds its joint, and at what rate."""
    angle, rate, _, _ = kernels.joint_motion(workspace.program, one.block, y, workspace.model.nq)
    return Met(t, float(angle), float(rate), 0.0)


class CoincidentEvents:
    """Finds what passes at a state.

    Args:
        workspace: What a run works on.
        adjustments: Its elements as they are.
        acting: Elements with modes, by place.
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
        """Return how an element meets its joint."""
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
        """Return a function that was located, as it is."""
        self._moment.set(t, y)
        return LocatedFunction(one.place, one.number, self._element(one.place).mode, self.value(one)[0])

    def is_past(self, one: Switch, t: float, y: Array) -> bool:
        """Return whether a function, but of a load, is negative by more than round-off."""
        self._moment.set(t, y)
        if hold_of(self._element(one.place), one.place, one.number, self._holds) >= 0:
            return False
        return self.value(one)[0] < -ZERO

    def value(self, one: Switch | LocatedFunction) -> tuple[float, float]:
        """Return a function and its rate at the moment's state."""
        hold = hold_of(self._element(one.place), one.place, one.number, self._holds)
        return self._moment.switch(self._acting[one.place].block, one.number, hold)

    def grazes(self, one: Switch | LocatedFunction, t: float, y: Array) -> bool:
        """Return whether a function that is about zero goes back from there, by its next derivative.

        The search finds zeros in the dense output, which is off by more than a step's end is. A function f
        with rate f' < 0 and f'' > 0 comes down to f - f'^2 / (2 f''): where that is above zero but for
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
        """Return what passes at this state, of each element what comes first."""
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

    def _passes(self, one: Switch, first: bool, t: float, y: Array) -> bool:
        """Return whether a function that was not located passes; loads count behind the first round."""
        loaded = hold_of(self._element(one.place), one.place, one.number, self._holds) >= 0
        if loaded and first:
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
        """Return which of the located functions still pass behind changes."""
        self._moment.set(t, y)
        found = []
        for one in pending:
            if decided(one.place, one.number) or self._adjustments.elements[one.place] is before[one.place]:
                value, slope = self.value(one)
                if abs(value - one.value) <= ZERO * max(1.0, abs(one.value)) and slope <= 0.0:
                    found.append(one)
        return found
