"""Events: a function of the state that passes zero, and what happens then.

A run finds them on the dense output of its steps, makes the step again to end there, and does what they ask
for. Contacts that touch and part are events of their own kind, always looked for.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.answers import AskedFunction, asked, check_takes
from antenna_pin.base.arguments import fits, takes, unknown_type
from antenna_pin.base.parameters import holds
from antenna_pin.dynamics import Adjustments, System, Workspace, acting_in
from antenna_pin.elements import ForceElement, Modal
from antenna_pin.errors import FunctionError, InvalidParameterError, UnknownNameError
from antenna_pin.simulation.moment import Moment
from antenna_pin.simulation.own_actions import Edge, Kink, Switch

__all__ = ["Angle", "ElementChange", "Event", "Force", "Gap", "Jump", "Mark", "Rate", "Set", "Stop", "Time"]

Array = NDArray[np.float64]


@runtime_checkable
class Rated(Protocol):
    """A function of the state that knows its own rate."""

    def __call__(self, moment: Moment) -> float:
        """Return its value."""

    def rate(self, moment: Moment) -> float:
        """Return its rate, in its unit per second."""


# --- functions of the state -----------------------------------------------------------------------------


@takes(value=("rad", "m"))
@dataclass(frozen=True, slots=True)
class Angle:
    """The angle of a joint, whole turns included, passes a value.

    Attributes:
        joint: Name of the joint; one that has an axis.
        value: [rad], or [m] of a sliding joint.
    """

    joint: str
    value: float

    def __call__(self, moment: Moment) -> float:
        """Return how far the joint is past the value [rad]."""
        return moment.angle(self.joint) - self.value

    def rate(self, moment: Moment) -> float:
        """Return the joint's rate [rad/s]."""
        return moment.rate(self.joint)


@takes(value=("rad/s", "m/s"))
@dataclass(frozen=True, slots=True)
class Rate:
    """The rate of a joint passes a value: zero where it turns back.

    Attributes:
        joint: Name of the joint; one that has an axis.
        value: [rad/s], or [m/s] of a sliding joint.
    """

    joint: str
    value: float = 0.0

    def __call__(self, moment: Moment) -> float:
        """Return how much faster the joint is [rad/s]."""
        return moment.rate(self.joint) - self.value


@takes(value="m")
@dataclass(frozen=True, slots=True)
class Gap:
    """The gap of a contact passes a value; minus a penetration.

    Attributes:
        contact: Name of the contact, such as ``elevation.radial+``.
        value: [m].
    """

    contact: str
    value: float

    def __call__(self, moment: Moment) -> float:
        """Return how much wider the gap is [m]."""
        return moment.gap(self.contact) - self.value

    def rate(self, moment: Moment) -> float:
        """Return the gap's rate [m/s]."""
        return -moment.depth_rate(self.contact)


@takes(value="N")
@dataclass(frozen=True, slots=True)
class Force:
    """The normal force of a contact passes a value.

    Where a law's force jumps at the onset of a contact, that is a passage too.

    Attributes:
        contact: Name of the contact, such as ``elevation.radial+``.
        value: Positive [N].
    """

    contact: str
    value: float

    def __post_init__(self) -> None:
        """Check the value."""
        if not 0.0 < self.value < math.inf:
            raise InvalidParameterError(self, "value", "positive and finite [N]", self.value)

    def __call__(self, moment: Moment) -> float:
        """Return how much larger the force is [N]."""
        return moment.force(self.contact) - self.value


@takes(instants="s")
class Time:
    """Instants are reached; steps end on them exactly.

    Args:
        instants: When, zero or later [s], or as text with a unit. At zero nothing is recorded: what is set
            there holds from the start.
    """

    __slots__ = ("instants",)

    def __init__(self, *instants: float | str) -> None:
        """Check and sort them."""
        if not instants or not all(holds(t, "zero or more") for t in instants):
            raise InvalidParameterError("Time", "instants", "one or more times of zero or more [s]", instants)
        self.instants = tuple(sorted({float(t) for t in instants}))

    def __call__(self, moment: Moment) -> float:
        """Return the time since the last instant reached, or else to the first one, negative [s]."""
        return moment.time - max((t for t in self.instants if t <= moment.time), default=self.instants[0])


@takes()
@dataclass(frozen=True, slots=True)
class ElementChange:
    """An element changes its mode: a latch captures, a stop is touched, a friction sticks.

    What a run records as a change (``change`` of the result) is meant; a latch that an event puts off is that
    event. No function passes zero: the event is at the instant of the change, behind it.

    Attributes:
        element: Place of the element, as ``latches.root``.
        change: ``capture``, ``refusal`` or ``release`` of a latch; ``touch``, ``rest``, ``turn`` or
            ``lift-off`` of a stop or a gear; ``stick`` or ``slip`` of a friction.
        side: ``lower`` or ``upper`` of a stop, ``plus`` or ``minus`` of a gear; None for either.
    """

    element: str
    change: str
    side: str | None = None

    def __call__(self, moment: Moment) -> float:
        """Return 1: it never passes by itself."""
        return 1.0

    def is_met(self, elements: Mapping[str, ForceElement], element: str, what: str) -> bool:
        """Return whether a recorded change of an element is the one meant."""
        found = elements[element]
        return (
            element == self.element
            and isinstance(found, Modal)
            and found.is_change(self.change, self.side, what)
        )

    def check(self, event: str, system: System) -> None:
        """Refuse an element, a change or a side that there is not.

        Raises:
            UnknownNameError: It lists those that there are.
        """
        known = {
            one.place: one.element
            for one in acting_in(system)
            if isinstance(one.element, Modal) and one.element.change_names
        }
        if self.element not in known:
            raise UnknownNameError(event, "element with changes", self.element, known)
        found = known[self.element]
        for what, name, names in (
            ("change", self.change, found.change_names),
            ("side", self.side, found.sides),
        ):
            if name is not None and name not in names:
                raise UnknownNameError(event, f"{what} of {self.element}", name, names)


Condition = Angle | Rate | Gap | Force | Time | ElementChange


# --- actions --------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Mark:
    """Nothing but what every event does: it is recorded, with a sample of the state."""


@dataclass(frozen=True, slots=True)
class Stop:
    """The run ends there."""


@takes()
@dataclass(frozen=True, slots=True)
class Set:
    """A number of a drive or a spring changes.

    Energy that springs gain or lose by that counts as the event's.

    Attributes:
        place: As in a scenario: ``drives.motor.value``, ``springs.coil.stiffness``; ``drives.motor.on`` for
            the whole drive.
        value: In SI units; of ``on`` true or false.
    """

    place: str
    value: float | bool


@takes()
@dataclass(frozen=True, slots=True)
class Jump:
    """The state jumps: a latch, an impulse.

    The energy that this brings in counts as the event's. What contacts remember stays as it is.

    Attributes:
        change: Returns configuration and velocity after it, (nq,) and (nv,).
    """

    change: Callable[[Moment], tuple[ArrayLike, ArrayLike]]

    def __post_init__(self) -> None:
        """Check that it can be asked."""
        check_takes(self, "change", self.change, "moment")

    def state_after(self, event: str, moment: Moment) -> Array:
        """Return the state behind it [q, v, x].

        Args:
            event: Whose action it is.
            moment: Before it.

        Raises:
            FunctionError: Its function gives none.
        """
        name, told, rule = (
            f"event {event!r}: change",
            told_moment((moment,)),
            "a configuration and a velocity",
        )
        answer = asked(name, told, rule, self.change, moment)
        if not fits(answer, tuple[ArrayLike, ArrayLike]) or any(np.iscomplexobj(one) for one in answer):
            raise FunctionError(name, told, rule, unknown_type(answer))
        return np.asarray(asked(name, told, rule, moment.system.state, *answer))


Action = Mark | Stop | Set | Jump | Kink | Switch | Edge


# --- the event ------------------------------------------------------------------------------------------


@takes()
@dataclass(frozen=True, slots=True, kw_only=True)
class Event:
    """Something that happens when a function of the state passes zero.

    A step is looked at in ``nodes`` equal parts: what passes zero and comes back within one is not seen,
    unless the function has a ``rate``, whose sign then tells (:class:`Angle` and :class:`Gap` have one).
    Each passage is recorded, with its time and a sample of the state. An event happens once at one instant.

    Attributes:
        name: Its name in the result.
        when: The function, ``(moment) -> float``: continuous within a step, smooth if its zero is to be found
            to round-off. A jump of it past zero, at a contact or by another event, is a passage too. It must
            answer equal questions equally, or the run ends as ``FUNCTION_WITH_MEMORY``.
        direction: +1: rising; -1: falling; 0: both.
        action: What happens; or several of :class:`Set`, :class:`Stop` and :class:`Mark`, done in order.
        after: The passage from which on ``action`` is taken; the earlier ones are only recorded [-].
        once: Whether it is taken at that passage alone.
        nodes: Parts of a step that are looked at [-].
    """

    name: str
    when: Callable[[Moment], float]
    direction: Literal[-1, 0, 1] = 0
    action: Action | Sequence[Mark | Stop | Set] = field(default_factory=Mark)
    after: int = 1
    once: bool = False
    nodes: int = 4

    def __post_init__(self) -> None:
        """Check what can be checked without a system."""
        place = f"event {self.name!r}"
        if not self.name:
            raise InvalidParameterError("Event", "name", "given", self.name)
        check_takes(place, "when", self.when, "moment")
        if isinstance(self.when, Rated):
            check_takes(place, "rate", self.when.rate, "moment")
        if self.direction not in (-1, 0, 1):
            raise InvalidParameterError(place, "direction", "-1, 0 or 1", self.direction)
        for name in ("after", "nodes"):
            if not (isinstance(getattr(self, name), int) and getattr(self, name) >= 1):
                raise InvalidParameterError(place, name, "a whole number of 1 or more", getattr(self, name))

    def asked(self) -> tuple[AskedFunction, AskedFunction | None]:
        """Return its function as a run asks it, and that of its rate, None if it has none."""
        name = f"event {self.name!r}: "
        rate = (
            AskedFunction(f"{name}rate", self.when.rate, told_moment)
            if isinstance(self.when, Rated)
            else None
        )
        return AskedFunction(f"{name}when", self.when, told_moment), rate

    @property
    def actions(self) -> tuple[Action, ...]:
        """What happens, in order."""
        return (self.action,) if isinstance(self.action, Action) else tuple(self.action)

    def has(self, *kinds: type) -> bool:
        """Return whether one of its actions is of these kinds."""
        return any(isinstance(one, kinds) for one in self.actions)

    def acts(self, count: int) -> bool:
        """Return whether its actions are taken at this passage, counted from 1."""
        return count == self.after if self.once else count >= self.after

    @property
    def changes(self) -> bool:
        """Whether it may change what moves, or end it: nothing is known of what comes after it."""
        return self.has(Set, Jump, Stop, Switch, Edge)

    def counts(self, side: float) -> bool:
        """Whether the function's passing to this sign is what is looked for."""
        return self.direction in (0, side)


def told_moment(question: Sequence[Moment]) -> str:
    """Return in words what the function of an event is asked."""
    return f"the moment t = {question[0].time:.9g} s"


def check_events(events: Sequence[Event], system: System, y: ArrayLike) -> None:
    """Refuse events that do not fit a system, by asking each in its initial state [q, v, x].

    Raises:
        AntennaPinError: Names that there are not, places that cannot be set, a function without an answer.
    """
    names = [event.name for event in events]
    if len(set(names)) != len(names):
        raise InvalidParameterError("simulate", "events", "of different names", names)
    if not events:
        return
    workspace = Workspace(system)
    moment = Moment(workspace)
    trial = Adjustments(system, workspace.program.copy())
    for event in events:
        moment.set(0.0, y)  # type: ignore[arg-type]
        if isinstance(event.when, Force):
            moment.contact_number(event.when.contact)
        if isinstance(event.when, ElementChange):
            event.when.check(f"event {event.name!r}", system)
        for function in event.asked():
            if function is not None:
                function(moment)
        for action in event.actions:
            if isinstance(action, Set):
                trial.set(action.place, action.value)
