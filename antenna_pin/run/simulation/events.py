"""Events: zero crossings of functions of the state, with actions.

Events are located on the dense output of steps; the step is repeated to end there, and the actions are
carried out. Onsets and releases of contacts are events of a kind of their own, which are always detected.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.arguments import (
    AskedFunction,
    answer_of,
    check_takes,
    fits,
    takes,
    unknown_type,
)
from antenna_pin.base.parameters import holds
from antenna_pin.base.records import PROGRAM, memory_numbers
from antenna_pin.base.rules import Positive
from antenna_pin.dynamics import JointMotion, System, Workspace, acting_in, kernels, reduced_inertia
from antenna_pin.elements import ForceElement, Modal
from antenna_pin.errors import FunctionError, InvalidParameterError, UnknownNameError
from antenna_pin.run.engine.watch_kernels import WEIGHED

Array = NDArray[np.float64]

# --- actions of the run itself ------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Kink:
    """End of a step, unrecorded, at a kink of an element's effort."""


#: Rate of an element's function that counts as zero [1/s].
STILL = 1e-11
#: Negative value of an element's function that counts as round-off [rad] ([m]).
GRAZE = 1e-15


@dataclass(frozen=True, slots=True)
class Switch:
    """Possible change of mode of an element."""

    place: str  # place of the element, as ``latches.hinge``
    number: int  # number of the element's function that passes zero


@dataclass(frozen=True, slots=True)
class Edge:
    """Change of an element at times that it defines itself."""

    place: str  # place of the element, as ``forces.jet``


# --- state passed to users' functions -----------------------------------------------------------------------


class Moment:
    """Time and state with derived quantities; valid while the function that receives it runs.

    Arrays are copies.

    Args:
        workspace: Workspace of the run.

    Attributes:
        time: [s].
        system: The system.
    """

    def __init__(self, workspace: Workspace) -> None:
        """Allocate once; ``set`` supplies time and state."""
        self.time = 0.0
        self.system: System = workspace.system
        self._workspace = workspace
        self._nq, self._nv = workspace.model.nq, workspace.model.nv
        self._y = np.zeros(workspace.manifold.size)
        self._rates = np.zeros(self._nv + workspace.manifold.nx)
        self._motions: dict[str, JointMotion] = {}
        self._found: dict[str, tuple[float, float]] = {}  # at the present time and state
        self._loads: list[float] = []  # of the elements that hold, at the present time and state
        self._contacts: Mapping[str, int] = {name: c for c, name in enumerate(self.system.contact_names)}
        self._measured = self._evaluated = False

    def set(self, time: float, y: Array) -> Moment:
        """Set time and state; return the moment."""
        self.time = time
        self._y[:] = y
        self._found.clear()
        self._loads = []
        self._measured = self._evaluated = False
        return self

    def acts(self, block: int) -> bool:
        """Return whether the element at a place in the program is on."""
        return bool(self._workspace.program[block:][: kernels.PARAMETERS].view(kernels.ELEMENT)[0]["on"])

    def kink(self, block: int, number: int) -> float:
        """Return the distance of an element's effort past one of its kinks."""
        if block >= int(self._workspace.program[: kernels.HEADER].view(PROGRAM)["points"][0]):
            return self._workspace.kink_on_links(block, self.time, self._y)
        return float(kernels.element_kink(self._workspace.program, block, number, self.time, self._y))

    def load(self, hold: int) -> float:
        """Return the torque [N m] (force [N]) of an element that holds its joint."""
        if not self._loads:
            self._workspace.derivative(self.time, self._y, self._rates)
            self._evaluated, self._measured = True, False
            assert self._workspace.constraints is not None
            self._loads = self._workspace.constraints.loads().tolist()
        return float(self._loads[hold])

    def inertia(self, block: int) -> float:
        """Return the reduced inertia of an element's joint [kg m^2]."""
        return reduced_inertia(self._workspace, self.time, self._y, block)

    def switch(self, block: int, number: int, hold: int) -> tuple[float, float]:
        """Return a mode function of an element, and its rate (0: unknown)."""
        if hold == WEIGHED:
            load = self.inertia(block)
        else:
            load = self.load(hold) if hold >= 0 else 0.0
        return kernels.element_switch(self._workspace.program, block, number, self.time, self._y, load)

    @property
    def q(self) -> Array:
        """Configuration, (nq,)."""
        return self._y[: self._nq].copy()

    @property
    def v(self) -> Array:
        """Velocity, (nv,)."""
        return self._y[self._nq : self._nq + self._nv].copy()

    @property
    def x(self) -> Array:
        """Plain numbers: turned angles, integrals, bristles, (nx,)."""
        return self._y[self._nq + self._nv :].copy()

    @property
    def memory(self) -> Array:
        """Contact memory: touching, approach speed [m/s], effective mass [kg], (contacts, 3)."""
        return memory_numbers(self._workspace.memory)

    def angle(self, joint: str) -> float:
        """Return the angle of a joint, whole turns included [rad], or its position [m]."""
        return self._motion(joint)[0]

    def rate(self, joint: str) -> float:
        """Return the rate of :meth:`angle` [rad/s] or [m/s]."""
        return self._motion(joint)[1]

    def _motion(self, joint: str) -> tuple[float, float]:
        found = self._found.get(joint)
        if found is None:
            if joint not in self._motions:
                self._motions[joint] = JointMotion(self.system, joint)
            self._found[joint] = found = self._motions[joint](self._y)
        return found

    def contact_number(self, contact: str) -> int:
        """Return the number of a contact.

        Raises:
            UnknownNameError: There is none of that name.
        """
        if contact not in self._contacts:
            raise UnknownNameError("event", "contact", contact, self._contacts)
        return self._contacts[contact]

    def gap(self, contact: str) -> float:
        """Return the distance of the surfaces at a contact, negative in contact [m]."""
        return self._measure(contact, "gap")

    def depth_rate(self, contact: str) -> float:
        """Return the rate of penetration at a contact, positive closing [m/s]."""
        return self._measure(contact, "rate")

    def _measure(self, contact: str, field: str) -> float:
        c = self.contact_number(contact)
        if not self._measured:
            self._workspace.measure(self._y)
            self._measured = True
        return float(self._workspace.table[field][c])

    def touching(self, contact: str) -> bool:
        """Return whether a contact touches."""
        return bool(self._workspace.memory["touching"][self.contact_number(contact)])

    def force(self, contact: str) -> float:
        """Return the normal force at a contact [N]; zero if it does not touch."""
        c = self.contact_number(contact)
        if not self._workspace.memory[c].touching:
            return 0.0
        if not self._evaluated:
            self._workspace.apply_elements(self.time, self._y, self._rates)
            self._evaluated, self._measured = True, False
        return max(0.0, float(self._workspace.table[c].force))


# --- events of users ----------------------------------------------------------------------------------------


@runtime_checkable
class Rated(Protocol):
    """Function of the state with its own rate."""

    def __call__(self, moment: Moment) -> float:
        """Return the value of the function."""

    def rate(self, moment: Moment) -> float:
        """Return the rate of the function, in its unit per second."""


# --- functions of the state -----------------------------------------------------------------------------


@takes(value=("rad", "m"))
@dataclass(frozen=True, slots=True)
class Angle:
    """Angle of a joint, whole turns included, at a value.

    Attributes:
        joint: Name of the joint; one that has an axis.
        value: [rad], or [m] of a sliding joint.
    """

    joint: str
    value: float

    def __call__(self, moment: Moment) -> float:
        """Return the angle less the value [rad]."""
        return moment.angle(self.joint) - self.value

    def rate(self, moment: Moment) -> float:
        """Return the joint's rate [rad/s]."""
        return moment.rate(self.joint)


@takes(value=("rad/s", "m/s"))
@dataclass(frozen=True, slots=True)
class Rate:
    """Rate of a joint at a value: zero where the joint reverses.

    Attributes:
        joint: Name of the joint; one that has an axis.
        value: [rad/s], or [m/s] of a sliding joint.
    """

    joint: str
    value: float = 0.0

    def __call__(self, moment: Moment) -> float:
        """Return the rate less the value [rad/s]."""
        return moment.rate(self.joint) - self.value


@takes(value="m")
@dataclass(frozen=True, slots=True)
class Gap:
    """Gap of a contact at a value; negative for a penetration.

    Attributes:
        contact: Name of the contact, such as ``elevation.radial+``.
        value: [m].
    """

    contact: str
    value: float

    def __call__(self, moment: Moment) -> float:
        """Return the gap less the value [m]."""
        return moment.gap(self.contact) - self.value

    def rate(self, moment: Moment) -> float:
        """Return the rate of the gap [m/s]."""
        return -moment.depth_rate(self.contact)


@takes(value="N")
@dataclass(frozen=True, slots=True)
class Force:
    """Normal force of a contact at a value.

    A jump of a law's force at the onset of a contact is a crossing too.

    Attributes:
        contact: Name of the contact, such as ``elevation.radial+``.
        value: Positive [N].
    """

    contact: str
    value: Positive

    def __call__(self, moment: Moment) -> float:
        """Return the force less the value [N]."""
        return moment.force(self.contact) - self.value


@takes(instants="s")
class Time:
    """Times on which steps end exactly.

    Args:
        instants: Times of zero or more [s], or text with a unit. At zero nothing is recorded: what is set
            there holds from the start.
    """

    __slots__ = ("instants",)

    def __init__(self, *instants: float | str) -> None:
        """Check and sort the times."""
        if not instants or not all(holds(t, "zero or more") for t in instants):
            raise InvalidParameterError("Time", "instants", "one or more times of zero or more [s]", instants)
        self.instants = tuple(sorted({float(t) for t in instants}))

    def __call__(self, moment: Moment) -> float:
        """Return the time since the last instant, or, negative, to the first [s]."""
        return moment.time - max((t for t in self.instants if t <= moment.time), default=self.instants[0])


@takes()
@dataclass(frozen=True, slots=True)
class ElementChange:
    """Change of mode of an element, such as a capture of a latch.

    Changes are those that a run records (``change`` of the result), not an event that switches a latch off.
    The event occurs at the time of the change, after it; no function passes zero.

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
        """Return 1: the function never passes zero by itself."""
        return 1.0

    def is_met(self, elements: Mapping[str, ForceElement], element: str, what: str) -> bool:
        """Return whether a recorded change of an element is the specified one."""
        found = elements[element]
        return (
            element == self.element
            and isinstance(found, Modal)
            and found.is_change(self.change, self.side, what)
        )

    def check(self, event: str, system: System) -> None:
        """Refuse an unknown element, change or side.

        Raises:
            UnknownNameError: The message lists the known names.
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
    """No action beyond the record of the event and a sample of the state."""


@dataclass(frozen=True, slots=True)
class Stop:
    """End of the run."""


@takes()
@dataclass(frozen=True, slots=True)
class Set:
    """New value of a number of a drive or a spring.

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
    """Jump of the state: a latch, an impulse.

    The energy brought in counts as the event's. Contact memory is not changed.

    Attributes:
        change: Returns configuration and velocity after it, (nq,) and (nv,).
    """

    change: Callable[[Moment], tuple[ArrayLike, ArrayLike]]

    def __post_init__(self) -> None:
        """Check that the function takes a moment."""
        check_takes(self, "change", self.change, "moment")

    def state_after(self, event: str, moment: Moment) -> Array:
        """Return the state after the jump [q, v, x].

        Args:
            event: Name of the event.
            moment: State before the jump.

        Raises:
            FunctionError: The function returns no state.
        """
        name, told, rule = (
            f"event {event!r}: change",
            moment_text((moment,)),
            "a configuration and a velocity",
        )
        answer = answer_of(name, told, rule, self.change, moment)
        if not fits(answer, tuple[ArrayLike, ArrayLike]) or any(np.iscomplexobj(one) for one in answer):
            raise FunctionError(name, told, rule, unknown_type(answer))
        return np.asarray(answer_of(name, told, rule, moment.system.state, *answer))


Action = Mark | Stop | Set | Jump | Kink | Switch | Edge


# --- the event ------------------------------------------------------------------------------------------


@takes()
@dataclass(frozen=True, slots=True, kw_only=True)
class Event:
    """Zero crossing of a function of the state, with actions.

    A step is searched in ``nodes`` equal parts: two crossings within one part are missed,
    unless the function has a ``rate``, whose sign shows them (:class:`Angle` and :class:`Gap` have one).
    Each crossing is recorded, with its time and a sample of the state. An event occurs once at one time.

    Attributes:
        name: Name in the result.
        when: Function ``(moment) -> float``: continuous within a step, smooth if its zero is to be located
            to round-off. A jump past zero, at a contact or by another event, is a crossing too. Equal
            arguments must give equal values, or the run ends as ``FUNCTION_WITH_MEMORY``.
        direction: +1: rising; -1: falling; 0: both.
        action: Action; or several of :class:`Set`, :class:`Stop` and :class:`Mark`, in order.
        after: Number of the crossing from which ``action`` is taken; earlier ones are only recorded [-].
        once: Whether the action is taken at that crossing only.
        nodes: Equal parts of a step at whose ends the function is evaluated [-].
    """

    name: str
    when: Callable[[Moment], float]
    direction: Literal[-1, 0, 1] = 0
    action: Action | Sequence[Mark | Stop | Set] = field(default_factory=Mark)
    after: int = 1
    once: bool = False
    nodes: int = 4

    def __post_init__(self) -> None:
        """Check everything that needs no system."""
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

    def functions(self) -> tuple[AskedFunction, AskedFunction | None]:
        """Return the checked functions of value and rate; None without a rate."""
        name = f"event {self.name!r}: "
        rate = (
            AskedFunction(f"{name}rate", self.when.rate, moment_text)
            if isinstance(self.when, Rated)
            else None
        )
        return AskedFunction(f"{name}when", self.when, moment_text), rate

    @property
    def actions(self) -> tuple[Action, ...]:
        """Actions, in order."""
        return (self.action,) if isinstance(self.action, Action) else tuple(self.action)

    def has(self, *kinds: type) -> bool:
        """Return whether one of its actions is of these kinds."""
        return any(isinstance(one, kinds) for one in self.actions)

    def acts(self, count: int) -> bool:
        """Return whether the actions are taken at this crossing, counted from 1."""
        return count == self.after if self.once else count >= self.after

    @property
    def changes(self) -> bool:
        """Return whether the event may change the motion or end the run."""
        return self.has(Set, Jump, Stop, Switch, Edge)

    def counts(self, side: float) -> bool:
        """Return whether a crossing to this sign is an event."""
        return self.direction in (0, side)


def moment_text(question: Sequence[Moment]) -> str:
    """Return the argument of an event's function as text."""
    return f"the moment t = {question[0].time:.9g} s"
