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
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import AskedFunction
from antenna_pin.base.interruption import FunctionInterrupted
from antenna_pin.base.records import CONTACT, POSE
from antenna_pin.compiled.given_functions import address_of, is_compiled
from antenna_pin.contact import CustomFriction, CustomNormal
from antenna_pin.contact.normal import normal_questions
from antenna_pin.dynamics import Workspace, acting_in, kernels
from antenna_pin.dynamics.adjust import Acting
from antenna_pin.dynamics.links import desk_in, written_by
from antenna_pin.elements import CallableElement, CallableForce, Element
from antenna_pin.errors import FunctionError
from antenna_pin.integrate import Stepper
from antenna_pin.joints.geometry.own_backend import OwnBackend
from antenna_pin.joints.pose_kernels import place_journal
from antenna_pin.joints.python_path import coefficient_of, functions_of_law, has_code, range_of
from antenna_pin.run.simulation.event_watch import is_known
from antenna_pin.run.simulation.events import Event, Moment, moment_text

Array = NDArray[np.float64]

# --- compiled functions called from Python ------------------------------------------------------------------


class ExchangeableFunction(Protocol):
    """Compiled function whose address may be exchanged."""

    arguments: int

    @property
    def call(self) -> Callable[..., float]:
        """Function as called from Python."""

    def places(self, program: Array) -> NDArray[np.int64]:
        """Return the places of the function's address in a program."""


class CompiledFunction:
    """Compiled function, and the places of its address in a program."""

    def __init__(self, function: AskedFunction, users: Any, arguments: int, block: int) -> None:
        """Find the address of the function."""
        self.call, self.arguments, self._block = function, arguments, block
        self._address = (
            address_of(function.name, "function", users, arguments) if is_compiled(users) else math.nan
        )

    def places(self, program: Array) -> NDArray[np.int64]:
        """Return the places of the address in a program; none if not compiled."""
        first = self._block
        length = int(program[first : first + 2].view(np.int64)[1])  # of every block the second number
        return first + np.flatnonzero(program[first : first + length] == self._address)


def failure_in(
    functions: Sequence[ExchangeableFunction], program: Array, stepper: Stepper, h: float
) -> FunctionError | None:
    """Return the failure of a function at a state or in a step, or None.

    Kernels call functions by address, and a failed call shows only as a step without a valid error. The step
    is therefore repeated with other addresses in the program: those of functions in Python that call the
    user's and check the values.

    Args:
        functions: Functions to test.
        program: Program of the run, with their addresses.
        stepper: Stepper of the run; its trial step is lost.
        h: Size of the step [s].
    """
    errors: list[BaseException] = []
    with _called_from_python(functions, program, errors):
        stepper.rates(stepper.t, stepper.start)
        if not errors:
            stepper.attempt(h)
    for error in errors[:1]:
        if isinstance(error, FunctionError):
            return error
        raise FunctionInterrupted from error
    return None


@contextmanager
def _called_from_python(
    functions: Sequence[ExchangeableFunction], program: Array, errors: list[BaseException]
) -> Iterator[None]:
    """Redirect the functions' addresses to Python, and collect their exceptions."""
    before, kept = program.copy(), []
    for one in functions:
        places = one.places(before)
        if places.size:
            called = ctypes.CFUNCTYPE(*[ctypes.c_double] * (one.arguments + 1))(_recording(one.call, errors))
            kept.append(called)
            program[places] = float(ctypes.cast(called, ctypes.c_void_p).value or 0)
    try:
        yield
    finally:
        for one in functions:
            places = one.places(before)
            program[places] = before[places]


def _recording(function: Callable[..., float], errors: list[BaseException]) -> Callable[..., float]:
    def call(*inputs: float) -> float:
        try:
            return function(*inputs)
        except BaseException as error:  # nothing passes through machine code
            errors.append(error)
            return math.nan

    return call


# --- users' functions of a run ------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class UserFunction:
    """Function of a user's that a run calls, in one form for all kinds."""

    name: str  # of the function and its owner
    inputs_at: Callable[[float, Array], Any]  # arguments at a time [s] and state; None where not called
    evaluate: Callable[[Any], tuple[float, ...]]  # results of a call
    text: Callable[[Any], str]  # arguments as text
    first: Any = None  # arguments for a call before all others; None if the first state supplies them
    called: ExchangeableFunction | None = None  # function as kernels call it
    tolerance: float = 0.0  # difference up to which results are equal

    def differs(self, one: Sequence[float], other: Sequence[float]) -> bool:
        """Return whether two results differ."""
        return any(
            a != b and not (abs(a - b) <= self.tolerance or (a != a and b != b))
            for a, b in zip(one, other, strict=True)
        )


class LinkFunction:
    """Function that acts on links, as kernels call it."""

    arguments = 3

    def __init__(self, one: Acting, workspace: Workspace) -> None:
        """Find the head of the element in the program."""
        self._one = one
        self.head = workspace.program[one.block :][: kernels.PARAMETERS].view(kernels.ELEMENT)[0]

    def places(self, program: Array) -> NDArray[np.int64]:
        """Return the place of the function's address in a program."""
        return np.array([self._one.block + int(kernels.PARAMETERS)])

    def call(self, t: float, place: float, _: float) -> float:
        """Call the function in Python with a time [s] and a desk's address.

        Raises:
            FunctionError: The function has no valid result.
        """
        numbers = len(self._one.element.tail())
        behind = int(self.head["length"]) - int(self.head["partner"])
        memory = (ctypes.c_double * (numbers + behind)).from_address(int(place))
        element: Any = self._one.element
        element.ask(self._one.label, t, desk_in(np.ctypeslib.as_array(memory)[numbers:], None))
        return 0.0 if math.isfinite(t) else 1.0


def _on_links(one: Acting, workspace: Workspace) -> UserFunction:
    """Return a function that acts on links, evaluated in a workspace of its own."""
    own, link = Workspace(workspace.system), LinkFunction(one, workspace)

    def evaluate(inputs: tuple[float, Array, Array]) -> tuple[float, ...]:
        t, y, own.program[:] = inputs
        own.see_on_links(one.block, t, y, one.element)
        return written_by(own.program, one.block)

    return UserFunction(
        name=f"{one.label}: its function",
        inputs_at=lambda t, y: None if link.head["on"] == 0.0 else (t, y.copy(), workspace.program.copy()),
        evaluate=evaluate,
        text=lambda inputs: f"t = {inputs[0]:.9g} s",
        called=link if getattr(one.element, "called", False) else None,
    )


def _of_numbers(
    function: AskedFunction,
    inputs_at: Callable[[float, Array], tuple[float, ...] | None],
    called: CompiledFunction,
    slowest: tuple[float, ...] | None = None,
) -> UserFunction:
    """Return a function of numbers; a compiled one is called from Python."""
    return UserFunction(
        name=function.name,
        inputs_at=inputs_at,
        evaluate=lambda inputs: (function(*inputs),),
        text=function.told,
        first=slowest,
        called=called,
    )


def _of_backend(distances: OwnBackend, workspace: Workspace, joint: int) -> UserFunction:
    """Return a function that measures the gaps of a joint.

    A search that starts from the last result reproduces a gap up to its own round-off only. Results therefore
    count as equal within a billionth of the play, the distance up to which contacts are located.
    """
    system = workspace.system
    clearance = system.clearances[joint]
    block, nq = system.clearance_blocks[clearance.name], system.model.nq
    first = sum(one.contacts for one in system.clearances[:joint])
    table, pose = np.zeros(system.rows, CONTACT), np.zeros(1, POSE)

    def inputs_at(t: float, y: Array) -> NDArray[Any]:
        place_journal(workspace.program, block, y, nq, pose)
        return pose.copy()

    def evaluate(inputs: NDArray[Any]) -> tuple[float, ...]:
        distances.query(inputs.copy(), table, first)
        return tuple(table["gap"][first : first + clearance.contacts].tolist())

    return UserFunction(
        name=distances.name,
        inputs_at=inputs_at,
        evaluate=evaluate,
        text=distances.pose_text,
        tolerance=1e-9 * clearance.geometry.radial_clearance,
    )


def _of_event(function: AskedFunction, workspace: Workspace) -> UserFunction:
    """Return a function of an event, evaluated in a workspace of its own."""
    own = Workspace(workspace.system)
    moment = Moment(own)

    def evaluate(inputs: tuple[float, Array, NDArray[Any], Array]) -> tuple[float, ...]:
        t, y, own.memory[:], own.program[:] = inputs
        return (function(moment.set(t, y)),)

    return UserFunction(
        name=function.name,
        inputs_at=lambda t, y: (t, y.copy(), workspace.memory.copy(), workspace.program.copy()),
        evaluate=evaluate,
        text=lambda inputs: moment_text((moment.set(*inputs[:2]),)),
    )


def functions_in_kernels(functions: Sequence[UserFunction]) -> tuple[ExchangeableFunction, ...]:
    """Return the functions of a run that kernels may call."""
    return tuple(one.called for one in functions if one.called is not None)


def user_functions(workspace: Workspace, events: Sequence[Event]) -> tuple[UserFunction, ...]:
    """Return the users' functions that a run calls, compiled or not."""
    return (*_of_elements(workspace), *_of_joints(workspace), *_of_events(workspace, events))


def _of_elements(workspace: Workspace) -> Iterator[UserFunction]:
    system = workspace.system
    for one in acting_in(system):
        if isinstance(one.element, CallableElement | CallableForce):
            yield _on_links(one, workspace)
        if not isinstance(one.element, Element):
            continue
        functions = one.element.callbacks(one.label, system.slides(one.element.joint))
        for function, (_, own, count) in zip(functions, one.element.functions, strict=True):
            called = CompiledFunction(function, own, count, one.block)
            yield _of_numbers(function, _motion_of(workspace, one.block, count), called)


def _motion_of(workspace: Workspace, block: int, count: int) -> Callable[[float, Array], Any]:
    """Return a function for time, angle and rate of an element's joint; None if off."""
    program, nq = workspace.program, workspace.model.nq
    on = program[block : block + kernels.PARAMETERS].view(kernels.ELEMENT)["on"]

    def inputs_at(t: float, y: Array) -> tuple[float, ...] | None:
        if on[0] == 0.0:
            return None
        angle, rate, _, _ = kernels.joint_motion(program, block, y, nq)
        return (t, float(angle), float(rate))[:count]

    return inputs_at


def _of_joints(workspace: Workspace) -> Iterator[UserFunction]:
    row = 0
    for number, joint in enumerate(workspace.system.clearances):
        checked = set()
        for k, law in enumerate(joint.normal_laws):
            if id(law) not in checked and (isinstance(law, CustomNormal) or not has_code(law)):
                checked.add(id(law))
                rows = [row + i for i, other in enumerate(joint.normal_laws) if other is law]
                # A thousandth of the depth limit, at the slowest approach speed.
                first = 1e-3 * joint.depth_limits[k], 0.0, joint.approach_speed_floor
                block = workspace.system.clearance_blocks[joint.name]
                yield from _of_law(joint.law_names[k], law, rows, workspace, block, first)
        friction: Any = joint.friction
        if isinstance(friction, CustomFriction) or not has_code(friction):
            rows = list(range(row, row + joint.contacts))
            function, slow = coefficient_of(friction, f"joint {joint.name!r}"), (joint.approach_speed_floor,)
            block = workspace.system.clearance_blocks[joint.name]
            called = CompiledFunction(function, friction.coefficient, 1, block)
            yield _of_numbers(function, _slip_of(workspace, rows), called, slow)
        backend = joint.own_backend
        if backend is not None:
            yield _of_backend(backend, workspace, number)
        row += joint.contacts


def _of_law(
    name: str, law: Any, rows: Sequence[int], workspace: Workspace, block: int, slowest: tuple[float, ...]
) -> Iterator[UserFunction]:
    for function, (_, own, words) in zip(functions_of_law(law, name), normal_questions(law), strict=True):
        count = len(words)
        inputs_at = _depth_of(workspace, rows, range_of(law), count)
        called = CompiledFunction(function, own, count, block)
        yield _of_numbers(function, inputs_at, called, slowest[:count])


def _deepest(workspace: Workspace, rows: Sequence[int]) -> int:
    """Return the row of the deepest touching contact at the last evaluation; -1 if none."""
    gaps = [(float(workspace.table[k].gap), k) for k in rows if workspace.memory[k].touching]
    gap, row = min(gaps, default=(0.0, -1))
    return row if gap < 0.0 else -1


def _depth_of(
    workspace: Workspace, rows: Sequence[int], limit: float, count: int
) -> Callable[[float, Array], Any]:
    """Return a function for depth, rate and approach speed of a contact; None if apart."""

    def inputs_at(t: float, y: Array) -> tuple[float, ...] | None:
        row = _deepest(workspace, rows)
        if row < 0:
            return None
        contact, memory = workspace.table[row], workspace.memory[row]
        depth = min(-float(contact.gap), limit)
        return (depth, float(contact.rate), float(memory.approach_speed))[:count]

    return inputs_at


def _slip_of(workspace: Workspace, rows: Sequence[int]) -> Callable[[float, Array], Any]:
    """Return a function for the slip speed of a contact; None if none slips."""

    def inputs_at(t: float, y: Array) -> tuple[float, ...] | None:
        row = _deepest(workspace, rows)
        speed = 0.0 if row < 0 else float(np.linalg.norm(workspace.table[row].slip))
        return (speed,) if speed > 0.0 else None

    return inputs_at


def _of_events(workspace: Workspace, events: Sequence[Event]) -> Iterator[UserFunction]:
    for event in events:
        if is_known(event):
            continue
        yield from (_of_event(function, workspace) for function in event.functions() if function is not None)


# --- repeatability ------------------------------------------------------------------------------------------

_LOOKS_AT_FIRST = 32  # consecutive states
_EVALUATIONS = 192  # of the run between two checks: three calls each, 1.6 % of the run's
_AGES = 8  # calls stored besides the first: of ages 1, 2, 4, ... checks


class _FunctionHistory:
    """Function with arguments of several ages and their results."""

    def __init__(self, function: UserFunction) -> None:
        self._function = function
        self._looks = 0
        self._first: tuple[Any, tuple[float, ...]] | None = None
        self._kept: dict[int, tuple[Any, tuple[float, ...]]] = {}
        self._last = -1

    def check(self, t: float, y: Array) -> str:
        """Repeat two calls and make a new one; return the contradiction as text."""
        words = self._again(self._older()) or self._again(self._kept.get(self._last))
        inputs = None if words else self._function.inputs_at(t, y)
        if inputs is None and self._first is None:
            inputs = self._function.first
        if inputs is not None:
            self._looks += 1
            self._last = min((self._looks & -self._looks).bit_length() - 1, _AGES - 1)
            self._kept[self._last] = inputs, self._function.evaluate(inputs)
            self._first = self._first or self._kept[self._last]
        return words

    def _older(self) -> tuple[Any, tuple[float, ...]] | None:
        """Return the first call, or one of another age, in turn."""
        kept = [self._first, *self._kept.values()]
        return kept[self._looks % len(kept)]

    def again(self) -> str:
        """Repeat all calls; return the contradiction as text."""
        return next((words for one in (self._first, *self._kept.values()) if (words := self._again(one))), "")

    def _again(self, one: tuple[Any, tuple[float, ...]] | None) -> str:
        if one is None:
            return ""
        inputs, before = one
        now = self._function.evaluate(inputs)
        if not self._function.differs(before, now):
            return ""
        k = next(k for k in range(len(now)) if self._function.differs(before[k : k + 1], now[k : k + 1]))
        described = self._function.text(inputs)
        return f", {self._function.name} of {described} gave {before[k]:.12g} and then {now[k]:.12g}"


class RepeatabilityCheck:
    """Repeated calls of a run's user functions with earlier arguments.

    A run calls functions out of order: in stages of a step, in rejected and repeated steps, in dense output,
    for samples. A function with memory, of chance or of the clock returns different values each time, and
    error control, located events and the path between states become meaningless. Calls at earlier states are
    therefore repeated now and then, with all other calls of the run in between.
    """

    def __init__(self, workspace: Workspace, events: Sequence[Event]) -> None:
        """Begin without a call."""
        #: Functions to check.
        self.functions = user_functions(workspace, events)
        self._histories = [_FunctionHistory(one) for one in self.functions]
        self._at_first = _LOOKS_AT_FIRST
        self._next = 0

    def check(self, t: float, y: Array, evaluations: int) -> str:
        """Repeat calls at a state of the run, if due; return the contradiction as text."""
        if not self._histories or (self._at_first <= 0 and evaluations < self._next):
            return ""
        self._at_first -= 1
        self._next = evaluations + _EVALUATIONS
        return next((words for one in self._histories if (words := one.check(t, y))), "")

    def end(self) -> str:
        """Repeat all calls after the last step; return the contradiction as text."""
        return next((words for one in self._histories if (words := one.again())), "")
