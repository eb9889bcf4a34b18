"""Functions of a user's in a run, and the questions that it asks them, in one form for every kind.

A drive, a motion, a law, a backend and an event are asked different things in different places. Here each is
a thing that has a question at a state of the run and an answer to it, so that it can be asked again
(:mod:`antenna_pin.simulation.repeatable`). Asking changes nothing that the run works on.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.answers import AskedFunction
from antenna_pin.base.records import CONTACT, POSE
from antenna_pin.contact import CustomFriction, CustomNormal
from antenna_pin.contact.normal import normal_questions
from antenna_pin.dynamics import Workspace, acting_in, kernels
from antenna_pin.dynamics.acting import Acting
from antenna_pin.dynamics.links import desk_in, written_by
from antenna_pin.elements import CallableElement, CallableForce, Element
from antenna_pin.geometry.own_backend import OwnBackend
from antenna_pin.joints.pose_kernels import place_journal
from antenna_pin.joints.python_path import coefficient_of, functions_of_law, has_code, range_of
from antenna_pin.simulation.events import Event, told_moment
from antenna_pin.simulation.moment import Moment
from antenna_pin.simulation.watched import is_known
from antenna_pin.simulation.witness import Called

__all__ = ["Asked", "asked_functions", "called_functions"]


Array = NDArray[np.float64]


# --- functions of a user's that act on links, asked again as others are, and where their addresses stand ---

Question = tuple[float, Array, Array]


class AskedOnLinks:
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
    def called(self) -> AskedOnLinks | None:
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


class Asked(Protocol):
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


class _Numbers:
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
        called: Called,
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


class _Backend:
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


class _Condition:
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
        return told_moment((self._moment.set(*question[:2]),))


def called_functions(functions: Sequence[Asked]) -> tuple[Called | AskedOnLinks, ...]:
    """Return those of a run's functions that kernels may call."""
    found = (one.called for one in functions if isinstance(one, _Numbers | AskedOnLinks))
    return tuple(one for one in found if one is not None)


def asked_functions(workspace: Workspace, events: Sequence[Event]) -> tuple[Asked, ...]:
    """Return the functions of a user's that a run asks, compiled by the user or not.

    Args:
        workspace: What the run works on.
        events: What it looks for.
    """
    return (*_of_elements(workspace), *_of_joints(workspace), *_of_events(workspace, events))


def _of_elements(workspace: Workspace) -> Iterator[Asked]:
    system = workspace.system
    for one in acting_in(system):
        if isinstance(one.element, CallableElement | CallableForce):
            yield AskedOnLinks(one, workspace)
        if not isinstance(one.element, Element):
            continue
        asked = one.element.asked(one.label, system.slides(one.element.joint))
        for function, (_, own, count) in zip(asked, one.element.functions, strict=True):
            called = Called(function, own, count, one.block)
            yield _Numbers(function, _motion_of(workspace, one.block, count), called)


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


def _of_joints(workspace: Workspace) -> Iterator[Asked]:
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
            called = Called(function, friction.coefficient, 1, block)
            yield _Numbers(function, _slip_of(workspace, rows), called, slow)
        backend = joint.own_backend
        if backend is not None:
            yield _Backend(backend, workspace, number)
        row += joint.contacts


def _of_law(
    name: str, law: Any, rows: Sequence[int], workspace: Workspace, block: int, first: tuple[float, ...]
) -> Iterator[Asked]:
    for function, (_, own, words) in zip(functions_of_law(law, name), normal_questions(law), strict=True):
        count = len(words)
        asked = _depth_of(workspace, rows, range_of(law), count)
        yield _Numbers(function, asked, Called(function, own, count, block), first[:count])


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


def _of_events(workspace: Workspace, events: Sequence[Event]) -> Iterator[Asked]:
    for event in events:
        if is_known(event):
            continue
        yield from (_Condition(function, workspace) for function in event.asked() if function is not None)
