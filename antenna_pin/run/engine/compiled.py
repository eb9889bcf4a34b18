"""A system in numbers, and a stepper of compiled steps."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import POSE
from antenna_pin.base.settings import Engine
from antenna_pin.compiled.calls import CALLED_BACK
from antenna_pin.compiled.native import Evaluator
from antenna_pin.dynamics import System, Workspace
from antenna_pin.dynamics import outside_kernels as kernels
from antenna_pin.dynamics.by_pinocchio import accelerations_of, machine_code_of, terms_of
from antenna_pin.dynamics.numbers_kernels import Numbers
from antenna_pin.errors import FunctionError, MechanismError
from antenna_pin.integrate import Method, Stepper
from antenna_pin.mechanism import PLACE, ROOM, TreeDynamics, body_tree
from antenna_pin.run.engine.implicit_kernels import attempt_implicit
from antenna_pin.run.engine.step_kernels import attempt, derivative, prepare_dense

Array = NDArray[np.float64]


# --- functions in Python that compiled code calls by address, and their failures ---


class Answers:
    """Callbacks of compiled code in one run.

    Exceptions do not pass through machine code: they are stored, and raised by the caller of the compiled
    code (:meth:`check`). The functions refer to the run's objects, not the reverse, so that a run's memory is
    released with the run.

    Attributes:
        outside: Function pointers, arguments and results, as the kernels take them.
    """

    def __init__(self, size: int, nv: int) -> None:
        """Begin without callbacks, for states of a size and a number of velocities."""
        self.outside = kernels.Outside(
            asked=np.zeros(1, kernels.ASKED),
            state=np.zeros(size),
            effort=np.zeros(nv),
            acceleration=np.zeros(nv),
        )
        self._raised: list[BaseException] = []
        self._kept: dict[str, Any] = {}
        self._machine: list[Callable[[], FunctionError | None]] = []

    def give(self, question: str, function: Callable[[float], None]) -> None:
        """Install a callback, a field of ``ASKED``.

        The function of a time [s] reads and writes ``outside``, or raises an error.
        """
        raised = self._raised

        def answer(t: float, _: int | None) -> int:
            try:
                function(t)
            except FunctionError as error:
                raised[:] = [error]
                return kernels.REFUSED
            except BaseException as error:
                raised[:] = [error]
                return kernels.RAISED
            return kernels.ANSWERED

        called = self._kept[question] = CALLED_BACK(answer)
        self.outside.asked[0][question] = ctypes.cast(called, ctypes.c_void_p).value

    def give_machine_code(self, failure: Callable[[], FunctionError | None], **fields: int) -> None:
        """Set addresses of machine code, fields of ``ASKED``, and its source of errors."""
        self._machine.append(failure)
        for name, value in fields.items():
            self.outside.asked[0][name] = value

    def asks(self, question: str) -> bool:
        """Return whether a callback in Python is given."""
        return question in self._kept

    @property
    def refusal(self) -> FunctionError | None:
        """Return the last refusal of a user's function."""
        found = next((error for error in self._raised if isinstance(error, FunctionError)), None)
        return found or next((error for failure in self._machine if (error := failure())), None)

    def check(self) -> None:
        """Raise what has been raised where compiled code asked last, if anything was."""
        asked: kernels.CallbackRecord = self.outside.asked[0]
        if asked.failed != kernels.ANSWERED:
            asked.failed = kernels.ANSWERED
            raise self._raised.pop() if self._raised else self.refusal or AssertionError("no callback failed")


def give_python(answers: Answers, workspace: Workspace, table: NDArray[Any]) -> None:
    """Register the callbacks of a system's elements in Python."""
    state = answers.outside.state
    asked: kernels.CallbackRecord = answers.outside.asked[0]
    if workspace.is_queried:
        answers.give_machine_code(lambda: workspace.coal_failure, queried=1)
    if workspace.python_paths or workspace.system.callables:
        ask = workspace.asked_in_steps()
        answers.give("elements", lambda t: ask(t, state))
        # Forces of laws in Python become zero only by an evaluation after the release.
        compiled = all(path.compiled for path in workspace.python_paths)
        asked.touching = compiled and not workspace.system.callables
    if workspace.system.callables and workspace.constraints is not None:
        answers.give("motions", lambda t: workspace.prepare_motions(t, state))
    if workspace.measured:
        answers.give("gaps", lambda t: workspace.measure_into(table, state, int(asked.contact)))
    if workspace.asked_laws:
        answers.give("forces", lambda t: workspace.ask_laws(table, int(asked.contact)))


def give_pinocchio(answers: Answers, workspace: Workspace, mass: Array, bias: Array) -> None:
    """Let Pinocchio answer for the dynamics of the tree."""
    outside = answers.outside
    code = machine_code_of(workspace.model, outside.state, outside.effort, outside.acceleration, mass, bias)
    if code is not None:
        evaluator, acceleration_at, terms_at = code
        free = workspace.constraints is None
        asked = {"acceleration": acceleration_at} if free else {"terms": terms_at}
        answers.give_machine_code(lambda: _failure_of(evaluator), tree=evaluator.address, **asked)
        return
    tree = workspace.model, workspace.data, outside.state
    if workspace.constraints is None:
        function, acceleration = accelerations_of(*tree, answers.outside.effort)
        answers.outside = answers.outside._replace(acceleration=acceleration)
        answers.give("acceleration", function)
    else:
        answers.give("terms", terms_of(*tree, mass, bias))


def _failure_of(evaluator: Evaluator) -> FunctionError | None:
    """Return an exception of Pinocchio in machine code, as an error; None without any."""
    if not evaluator.error:
        return None
    return FunctionError("Pinocchio", "a state", "the dynamics of the tree", evaluator.error)


def check_compiled(system: System) -> None:
    """Refuse a system that the compiled engine cannot take, with reason and way out.

    Raises:
        MechanismError: A part is evaluated in Python.
    """
    way_out = "or take integrator.engine = 'pinocchio'"
    for joint in system.clearances:
        if not joint.compiled:
            raise MechanismError(
                f"engine 'compiled': joint {joint.name!r} has a law in Python; compile its functions with "
                f"numba.njit, {way_out}"
            )
        if joint.backend != "closed-form":
            backend = joint.backend if isinstance(joint.backend, str) else type(joint.backend).__name__
            raise MechanismError(
                f"engine 'compiled': joint {joint.name!r} has its gaps measured by {backend}, which is not "
                f"compiled; set its geometry to 'closed-form', {way_out}"
            )
    for one in system.callables:
        raise MechanismError(
            f"engine 'compiled': {one.label} is a function in Python; compile it with numba.njit, {way_out}"
        )


class Compiled:
    """A workspace's system in numbers, with callbacks, for the steps of one run.

    Args:
        workspace: What the run works on; its contact memory, program and contact table are used.
        engine: Whose the tree's dynamics are: compiled, or Pinocchio's, asked from inside.
        tree: Bodies of the system as an earlier object has laid them out and compared them; None without.

    Attributes:
        numbers: The system, as the kernels take it.
        answers: Callbacks for uncompiled parts.

    Raises:
        MechanismError: The engine is ``compiled``, and the system is not one that it takes
            (:func:`check_compiled`), or its tree in numbers deviates from Pinocchio's.
    """

    def __init__(self, workspace: Workspace, engine: Engine, tree: NDArray[Any] | None = None) -> None:
        """Lay the numbers out; a compiled tree is compared with Pinocchio's."""
        system, model = workspace.system, workspace.model
        if engine == "compiled":
            check_compiled(system)
        if tree is None and engine == "compiled":
            tree = TreeDynamics(system.mechanism).tree
        elif tree is None:
            tree = body_tree(system.mechanism)
        plan, nq, nv, size = system.plan, model.nq, model.nv, system.manifold.size
        self.answers = Answers(size, nv)
        mass, bias, table = np.zeros((nv, nv)), np.zeros(nv), np.zeros_like(workspace.table)
        give_python(self.answers, workspace, table)
        if engine != "compiled":
            give_pinocchio(self.answers, workspace, mass, bias)
        self.numbers = Numbers(
            program=workspace.program,
            work=workspace.work,
            tree=tree,
            gravity=np.array(model.gravity.linear),
            room=np.zeros(len(tree) + 1, ROOM),
            places=np.zeros(len(tree) + 1, PLACE),
            plan=np.zeros(0) if plan is None else plan.words,
            held=np.zeros(0 if plan is None else plan.size),
            mass=mass,
            bias=bias,
            step=np.zeros(nv),
            pose=np.zeros(1, POSE),
            table=table,
            own=workspace.table,
            memory=workspace.memory,
            rates=np.zeros((2, nv + system.manifold.nx)),
            force=np.zeros(nv),
            moved=np.zeros(size),
            flag=np.zeros(1, dtype=np.int64),
            booked=-1 if plan is None else nq + nv + int(system.projection_x[0]),
            outside=self.answers.outside,
        )


class CompiledStepper(Stepper):
    """A stepper each of whose steps is one call of compiled code.

    Args:
        workspace: Workspace of the run.
        compiled: Its system in numbers.
        method: The method.
        scales: As for :class:`antenna_pin.integrate.Stepper`.
        rtol: Likewise.
    """

    def __init__(
        self, workspace: Workspace, compiled: Compiled, method: Method, scales: Array, rtol: float
    ) -> None:
        """Allocate the work space once."""
        super().__init__(workspace, method, scales, rtol)
        self.numbers, self.answers = compiled.numbers, compiled.answers
        self._asked = np.zeros(1, dtype=np.int64)

    def _derive(self, t: float) -> None:
        derivative(t, self.y, self.numbers, self._rates, False)
        self.answers.check()

    def attempt(self, h: float) -> float:
        """Try a step of size h [s]; return its scaled error.

        Raises:
            FunctionError: A function of the user's has no valid result in it.
        """
        error = self.tried(h)
        self.answers.check()
        return error

    def tried(self, h: float) -> float:
        """Try a step as :meth:`attempt`, without raising the errors of callbacks."""
        self.h, self.has_dense = h, False
        layout, work, numbers = self.manifold.layout, self.work, self.numbers
        if self.newton is None:
            self.evaluations += self.method.last
            return float(attempt(self.t, h, self.tableau, layout, work, self.scales, self.rtol, numbers))
        self._asked[0] = 0
        error = attempt_implicit(
            self.t,
            h,
            self.method.stages,
            layout,
            work,
            self.scales,
            self.rtol,
            self.newton,
            numbers,
            self._asked,
        )
        self.evaluations += int(self._asked[0])
        return float(error)

    def prepare_dense(self) -> None:
        """Compute the dense output of the last trial step."""
        if self.has_dense:
            return
        self.evaluations += prepare_dense(
            self.t,
            self.h,
            self.tableau,
            self.manifold.layout,
            self.work,
            self.dense,
            self.kept,
            self.numbers,
        )
        self.answers.check()
        self.has_dense = True
