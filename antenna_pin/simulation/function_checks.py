"""Checks of users' functions: failures inside compiled steps, and repeatability.

Drives, motions, laws, backends and events are called with different arguments in different places. Here each
function has one form: arguments at a state, and results (:class:`UserFunction`). A call changes nothing that
the run works on.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.answers import AskedFunction
from antenna_pin.base.interruption import FunctionInterrupted
from antenna_pin.base.records import CONTACT, POSE
from antenna_pin.compiled.given_functions import address_of, is_compiled
from antenna_pin.contact import CustomFriction, CustomNormal
from antenna_pin.contact.normal import normal_questions
from antenna_pin.dynamics import Workspace, acting_in, kernels
from antenna_pin.dynamics.acting import Acting
from antenna_pin.dynamics.links import desk_in, written_by
from antenna_pin.elements import CallableElement, CallableForce, Element
from antenna_pin.errors import FunctionError
from antenna_pin.geometry.own_backend import OwnBackend
from antenna_pin.integrate import Stepper
from antenna_pin.joints.pose_kernels import place_journal
from antenna_pin.joints.python_path import coefficient_of, functions_of_law, has_code, range_of
from antenna_pin.simulation.event_watch import is_known
from antenna_pin.simulation.events import Event, Moment, moment_text

__all__ = ["RepeatabilityCheck", "failure_in", "functions_in_kernels"]

Array = NDArray[np.float64]

# --- compiled functions called from Python ------------------------------------------------------------------


class ExchangeableFunction(Protocol):
    """A compiled function whose address may be exchanged."""

    arguments: int

    @property
    def asked(self) -> Callable[..., float]:
        """It, as Python asks it."""

    def places(self, program: Array) -> NDArray[np.int64]:
        """Return where in a program its address stands."""


class CompiledFunction:
    """A compiled function, and where in a program its address stands.

    Args:
        asked: It, as a run asks it.
        function: It.
        arguments: How many numbers it is asked.
        block: Where the block begins whose function it is.
    """

    def __init__(self, asked: AskedFunction, function: Any, arguments: int, block: int) -> None:
        """Find its address."""
        self.asked, self.arguments, self._block = asked, arguments, block
        self._address = (
            address_of(asked.name, "function", function, arguments) if is_compiled(function) else math.nan
        )

    def places(self, program: Array) -> NDArray[np.int64]:
        """Return where in a program its address stands; nowhere if it is not compiled."""
        first = self._block
        length = int(program[first : first + 2].view(np.int64)[1])  # of every block the second number
        return first + np.flatnonzero(program[first : first + length] == self._address)


def failure_in(
    functions: Sequence[ExchangeableFunction], program: Array, stepper: Stepper, h: float
) -> FunctionError | None:
    """Return what a function has failed by at a stepper's state, or in a step from there; None if none has.

    Args:
        functions: Those that may have.
        program: Of the run's force elements, in which they stand.
        stepper: Of the run; what it has tried is lost.
        h: Size of the step [s].
    """
    seen: list[BaseException] = []
    with _seen_by(functions, program, seen):
        stepper.rates(stepper.t, stepper.start)
        if not seen:
            stepper.attempt(h)
    for error in seen[:1]:
        if isinstance(error, FunctionError):
            return error
        raise FunctionInterrupted from error
    return None


@contextmanager
def _seen_by(
    functions: Sequence[ExchangeableFunction], program: Array, seen: list[BaseException]
) -> Iterator[None]:
    """Have functions asked by Python, and what they fail by noted."""
    before, kept = program.copy(), []
    for one in functions:
        places = one.places(before)
        if places.size:
            called = ctypes.CFUNCTYPE(*[ctypes.c_double] * (one.arguments + 1))(_noting(one.asked, seen))
            kept.append(called)
            program[places] = float(ctypes.cast(called, ctypes.c_void_p).value or 0)
    try:
        yield
    finally:
        for one in functions:
            places = one.places(before)
            program[places] = before[places]


def _noting(asked: Callable[..., float], seen: list[BaseException]) -> Callable[..., float]:
    def call(*question: float) -> float:
        try:
            return asked(*question)
        except BaseException as error:  # nothing passes through machine code
            seen.append(error)
            return math.nan

    return call


# --- users' functions of a run ------------------------------------------------------------------------------

# --- functions of a user's that act on links, asked again as others are, and where their addresses stand ---

Question = tuple[float, Array, Array]


class LinkFunction:
    """A function that acts on links, asked in a place of its own with elements as they were.

    Args:
        one: The element.
        workspace: What the run works on.
    """

    def __init__(self, one: Acting, workspace: Workspace) -> None:
        """Begin without a question."""
        self.name, self.first = f"{one.label}: its function", None
        self._one, self._run = one, workspace
        self._own = Workspace(workspace.system)
        head = workspace.program[one.block : one.block + kernels.PARAMETERS]
        self._head = head.view(kernels.ELEMENT)[0]
        self.arguments = 3

    def question(self, t: float, y: Array) -> Question | None:
        """Return what it is asked: time, state, and the elements; None if it is off."""
        return None if self._head["on"] == 0.0 else (t, y.copy(), self._run.program.copy())

    def answer(self, question: Question) -> tuple[float, ...]:
        """Return all that it writes."""
        t, y, program = question
        self._own.program[:] = program
        self._own.see_on_links(self._one.block, t, y, self._one.element)
        return written_by(self._own.program, self._one.block)

    def differ(self, one: tuple[float, ...], other: tuple[float, ...]) -> bool:
        """Whether two answers are not the same one."""
        return _differ(one, other)

    def told(self, question: Question) -> str:
        """Return a question in words."""
        return f"t = {question[0]:.9g} s"

    # --- as what kernels call -------------------------------------------------------------------------------

    @property
    def called(self) -> LinkFunction | None:
        """Itself, if kernels call it."""
        return self if getattr(self._one.element, "called", False) else None

    def places(self, program: Array) -> NDArray[np.int64]:
        """Return where in a program its address stands."""
        return np.array([self._one.block + int(kernels.PARAMETERS)])

    def asked(self, t: float, place: float, _: float) -> float:
        """Ask it in Python, as kernels do: with a time [s] and the place of a desk.

        Raises:
            FunctionError: It has no answer.
        """
        numbers = len(self._one.element.tail())
        behind = int(self._head["length"]) - int(self._head["partner"])
        memory = (ctypes.c_double * (numbers + behind)).from_address(int(place))
        desk = np.ctypeslib.as_array(memory)[numbers:]
        element: Any = self._one.element
        element.ask(self._one.label, t, desk_in(desk, None))
        return 0.0 if math.isfinite(t) else 1.0


class UserFunction(Protocol):
    """A function of a user's that a run asks.

    Attributes:
        name: Whose it is and what it is called.
        first: What it may be asked before it has a question, so that there is one from before all others.
    """

    name: str
    first: Any

    def question(self, t: float, y: Array) -> Any:
        """Return what it is asked at time t [s] and state y; None if nothing."""

    def answer(self, question: Any) -> tuple[float, ...]:
        """Return what it answers."""

    def differ(self, one: tuple[float, ...], other: tuple[float, ...]) -> bool:
        """Whether two answers are not the same one."""

    def told(self, question: Any) -> str:
        """Return a question in words."""


def _differ(one: Sequence[float], other: Sequence[float]) -> bool:
    return any(a != b and not (a != a and b != b) for a, b in zip(one, other, strict=True))


class _NumberFunction:
    """A function of numbers.

    Args:
        function: The function; compiled ones are called from Python.
        asked: Returns its arguments at a time and state, or None.
        called: It, if kernels may call it.
        first: Arguments before there are any; None if there always are.
    """

    def __init__(
        self,
        function: AskedFunction,
        asked: Callable[[float, Array], tuple[float, ...] | None],
        called: CompiledFunction,
        first: tuple[float, ...] | None = None,
    ) -> None:
        self.name, self.first, self.called = function.name, first, called
        self._function, self._asked = function, asked

    def question(self, t: float, y: Array) -> tuple[float, ...] | None:
        return self._asked(t, y)

    def answer(self, question: tuple[float, ...]) -> tuple[float, ...]:
        return (self._function(*question),)

    def differ(self, one: tuple[float, ...], other: tuple[float, ...]) -> bool:
        return _differ(one, other)

    def told(self, question: tuple[float, ...]) -> str:
        return self._function.told(question)


class _BackendFunction:
    """What measures the gaps of a joint.

    One that searches from its last answer on comes to the same gap up to its own round-off only. So answers
    are the same within a billionth of the play, the distance up to which contacts are located.
    """

    def __init__(self, distances: OwnBackend, workspace: Workspace, joint: int) -> None:
        system = workspace.system
        clearance = system.clearances[joint]
        self.name, self.first = distances.name, None
        self._distances, self._nq = distances, system.model.nq
        self._program, self._block = workspace.program, system.clearance_blocks[clearance.name]
        first = sum(one.contacts for one in system.clearances[:joint])
        self._rows = slice(first, first + clearance.contacts)
        self._table = np.zeros(system.rows, CONTACT)
        self._pose = np.zeros(1, POSE)
        self._small = 1e-9 * clearance.geometry.radial_clearance

    def question(self, t: float, y: Array) -> NDArray[Any]:
        place_journal(self._program, self._block, y, self._nq, self._pose)
        return self._pose.copy()

    def answer(self, question: NDArray[Any]) -> tuple[float, ...]:
        self._distances.query(question.copy(), self._table, self._rows.start)
        rows = self._table[self._rows]
        return tuple(float(gap) for gap in rows["gap"])

    def differ(self, one: tuple[float, ...], other: tuple[float, ...]) -> bool:
        return any(
            not abs(a - b) <= self._small and not (a != a and b != b) for a, b in zip(one, other, strict=True)
        )

    def told(self, question: NDArray[Any]) -> str:
        return self._distances.told(question)


class _EventFunction:
    """The function of an event, asked in a place of its own with contacts and elements as they were."""

    def __init__(self, function: AskedFunction, workspace: Workspace) -> None:
        self.name, self.first = function.name, None
        self._function = function
        self._run = workspace
        self._own = Workspace(workspace.system)
        self._moment = Moment(self._own)

    def question(self, t: float, y: Array) -> tuple[float, Array, NDArray[Any], Array]:
        return t, y.copy(), self._run.memory.copy(), self._run.program.copy()

    def answer(self, question: tuple[float, Array, NDArray[Any], Array]) -> tuple[float, ...]:
        t, y, memory, program = question
        self._own.memory[:], self._own.program[:] = memory, program
        return (self._function(self._moment.set(t, y)),)

    def differ(self, one: tuple[float, ...], other: tuple[float, ...]) -> bool:
        return _differ(one, other)

    def told(self, question: tuple[float, Array, NDArray[Any], Array]) -> str:
        return moment_text((self._moment.set(*question[:2]),))


def functions_in_kernels(functions: Sequence[UserFunction]) -> tuple[CompiledFunction | LinkFunction, ...]:
    """Return those of a run's functions that kernels may call."""
    found = (one.called for one in functions if isinstance(one, _NumberFunction | LinkFunction))
    return tuple(one for one in found if one is not None)


def user_functions(workspace: Workspace, events: Sequence[Event]) -> tuple[UserFunction, ...]:
    """Return the functions of a user's that a run asks, compiled by the user or not.

    Args:
        workspace: What the run works on.
        events: What it looks for.
    """
    return (*_of_elements(workspace), *_of_joints(workspace), *_of_events(workspace, events))


def _of_elements(workspace: Workspace) -> Iterator[UserFunction]:
    system = workspace.system
    for one in acting_in(system):
        if isinstance(one.element, CallableElement | CallableForce):
            yield LinkFunction(one, workspace)
        if not isinstance(one.element, Element):
            continue
        asked = one.element.asked(one.label, system.slides(one.element.joint))
        for function, (_, own, count) in zip(asked, one.element.functions, strict=True):
            called = CompiledFunction(function, own, count, one.block)
            yield _NumberFunction(function, _motion_of(workspace, one.block, count), called)


def _motion_of(workspace: Workspace, block: int, count: int) -> Callable[[float, Array], Any]:
    """Return what gives time, angle and rate of an element's joint, the first so many; None if it is off."""
    program, nq = workspace.program, workspace.model.nq
    on = program[block : block + kernels.PARAMETERS].view(kernels.ELEMENT)["on"]

    def asked(t: float, y: Array) -> tuple[float, ...] | None:
        if on[0] == 0.0:
            return None
        angle, rate, _, _ = kernels.joint_motion(program, block, y, nq)
        return (t, float(angle), float(rate))[:count]

    return asked


def _of_joints(workspace: Workspace) -> Iterator[UserFunction]:
    row = 0
    for number, joint in enumerate(workspace.system.clearances):
        seen = set()
        for k, law in enumerate(joint.normal_laws):
            if id(law) not in seen and (isinstance(law, CustomNormal) or not has_code(law)):
                seen.add(id(law))
                rows = [row + i for i, other in enumerate(joint.normal_laws) if other is law]
                # A thousandth of what it may be pressed to, at the slowest approach that it is told of.
                first = 1e-3 * joint.depth_limits[k], 0.0, joint.approach_speed_floor
                block = workspace.system.clearance_blocks[joint.name]
                yield from _of_law(joint.law_names[k], law, rows, workspace, block, first)
        friction: Any = joint.friction
        if isinstance(friction, CustomFriction) or not has_code(friction):
            rows = list(range(row, row + joint.contacts))
            function, slow = coefficient_of(friction, f"joint {joint.name!r}"), (joint.approach_speed_floor,)
            block = workspace.system.clearance_blocks[joint.name]
            called = CompiledFunction(function, friction.coefficient, 1, block)
            yield _NumberFunction(function, _slip_of(workspace, rows), called, slow)
        backend = joint.own_backend
        if backend is not None:
            yield _BackendFunction(backend, workspace, number)
        row += joint.contacts


def _of_law(
    name: str, law: Any, rows: Sequence[int], workspace: Workspace, block: int, first: tuple[float, ...]
) -> Iterator[UserFunction]:
    for function, (_, own, words) in zip(functions_of_law(law, name), normal_questions(law), strict=True):
        count = len(words)
        asked = _depth_of(workspace, rows, range_of(law), count)
        yield _NumberFunction(function, asked, CompiledFunction(function, own, count, block), first[:count])


def _deepest(workspace: Workspace, rows: Sequence[int]) -> int:
    """Return the row of some that touches and is the deepest at the last evaluation; -1 if none is."""
    gaps = [(float(workspace.table[k].gap), k) for k in rows if workspace.memory[k].touching]
    gap, row = min(gaps, default=(0.0, -1))
    return row if gap < 0.0 else -1


def _depth_of(
    workspace: Workspace, rows: Sequence[int], limit: float, count: int
) -> Callable[[float, Array], Any]:
    """Return what gives depth, rate and approach speed of a contact, the first so many; None if apart."""

    def asked(t: float, y: Array) -> tuple[float, ...] | None:
        row = _deepest(workspace, rows)
        if row < 0:
            return None
        contact, memory = workspace.table[row], workspace.memory[row]
        depth = min(-float(contact.gap), limit)
        return (depth, float(contact.rate), float(memory.approach_speed))[:count]

    return asked


def _slip_of(workspace: Workspace, rows: Sequence[int]) -> Callable[[float, Array], Any]:
    """Return what gives the slip speed of a contact; None if none slips."""

    def asked(t: float, y: Array) -> tuple[float, ...] | None:
        row = _deepest(workspace, rows)
        speed = 0.0 if row < 0 else float(np.linalg.norm(workspace.table[row].slip))
        return (speed,) if speed > 0.0 else None

    return asked


def _of_events(workspace: Workspace, events: Sequence[Event]) -> Iterator[UserFunction]:
    for event in events:
        if is_known(event):
            continue
        yield from (_EventFunction(function, workspace) for function in event.asked() if function is not None)


# --- repeatability ------------------------------------------------------------------------------------------

_LOOKS_AT_FIRST = 32  # states, one after the other
_EVALUATIONS = 192  # of the run from one look to the next: each asks three times, 1.6 % of what the run asks
_AGES = 8  # questions kept besides the first: of ages 1, 2, 4, ... looks


class _FunctionHistory:
    """One function, with questions of several ages and its answers to them."""

    def __init__(self, asked: UserFunction) -> None:
        self._asked = asked
        self._looks = 0
        self._first: tuple[Any, tuple[float, ...]] | None = None
        self._kept: dict[int, tuple[Any, tuple[float, ...]]] = {}
        self._last = -1

    def check(self, t: float, y: Array) -> str:
        """Ask two questions again and a new one; return what is wrong in words."""
        words = self._again(self._older()) or self._again(self._kept.get(self._last))
        question = None if words else self._asked.question(t, y)
        if question is None and self._first is None:
            question = self._asked.first
        if question is not None:
            self._looks += 1
            self._last = min((self._looks & -self._looks).bit_length() - 1, _AGES - 1)
            self._kept[self._last] = question, self._asked.answer(question)
            self._first = self._first or self._kept[self._last]
        return words

    def _older(self) -> tuple[Any, tuple[float, ...]] | None:
        """Return the first question, or one of another age, in turn."""
        kept = [self._first, *self._kept.values()]
        return kept[self._looks % len(kept)]

    def again(self) -> str:
        """Ask all again; return what is wrong in words."""
        return next((words for one in (self._first, *self._kept.values()) if (words := self._again(one))), "")

    def _again(self, one: tuple[Any, tuple[float, ...]] | None) -> str:
        if one is None:
            return ""
        question, before = one
        now = self._asked.answer(question)
        if not self._asked.differ(before, now):
            return ""
        k = next(k for k in range(len(now)) if self._asked.differ(before[k : k + 1], now[k : k + 1]))
        told = self._asked.told(question)
        return f", {self._asked.name} of {told} gave {before[k]:.12g} and then {now[k]:.12g}"


class RepeatabilityCheck:
    """Asks again what a run's functions of a user's were asked before.

    Args:
        workspace: What the run works on.
        events: What it looks for.
    """

    def __init__(self, workspace: Workspace, events: Sequence[Event]) -> None:
        """Begin without a question."""
        #: What it asks.
        self.asked = user_functions(workspace, events)
        self._functions = [_FunctionHistory(asked) for asked in self.asked]
        self._at_first = _LOOKS_AT_FIRST
        self._next = 0

    def check(self, t: float, y: Array, evaluations: int) -> str:
        """Ask at a state that the run has come to, if it is time to; return what is wrong in words.

        Args:
            t: Time [s].
            y: State [q, v, x].
            evaluations: That the run has made so far.
        """
        if not self._functions or (self._at_first <= 0 and evaluations < self._next):
            return ""
        self._at_first -= 1
        self._next = evaluations + _EVALUATIONS
        return next((words for one in self._functions if (words := one.check(t, y))), "")

    def end(self) -> str:
        """Ask all again, when the run has made its last step; return what is wrong in words."""
        return next((words for one in self._functions if (words := one.again())), "")
