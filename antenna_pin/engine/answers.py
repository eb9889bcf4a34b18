"""Functions in Python that compiled code asks by their addresses, and what they could not answer."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.compiled.calls import CALLED_BACK
from antenna_pin.dynamics import Workspace
from antenna_pin.dynamics import outside_kernels as kernels
from antenna_pin.dynamics.by_pinocchio import accelerations_of, terms_of
from antenna_pin.errors import FunctionError

__all__ = ["Answers", "give_pinocchio", "give_python"]

Array = NDArray[np.float64]


class Answers:
    """Who answers what compiled code asks outside, in one run.

    Nothing that is raised passes through machine code: it is kept, and raised where the compiled code was
    called from (:meth:`check`). The functions hold what they look at; nothing that they hold knows of them,
    so that a run's memory is free when the run is.

    Attributes:
        outside: Questions and answers, as the kernels take them.
    """

    def __init__(self, size: int, nv: int) -> None:
        """Begin with nobody to be asked, about states of a size and so many velocities."""
        self.outside = kernels.Outside(
            asked=np.zeros(1, kernels.ASKED),
            state=np.zeros(size),
            effort=np.zeros(nv),
            acceleration=np.zeros(nv),
        )
        self._raised: list[BaseException] = []
        self._kept: dict[str, Any] = {}

    def give(self, question: str, function: Callable[[float], None]) -> None:
        """Let a function answer a question, a field of ``ASKED``.

        Args:
            question: Its name.
            function: Of a time [s]; looks at ``outside`` and writes there, or raises what keeps it from that.
        """
        raised = self._raised

        def answer(t: float) -> int:
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
        self.outside.asked[question] = ctypes.cast(called, ctypes.c_void_p).value

    def asks(self, question: str) -> bool:
        """Whether anybody is asked a question."""
        return question in self._kept

    @property
    def refusal(self) -> FunctionError | None:
        """What a function of the user's has refused to answer last."""
        for error in self._raised:
            if isinstance(error, FunctionError):
                return error
        return None

    def check(self) -> None:
        """Raise what has been raised where compiled code asked last, if anything was."""
        asked = self.outside.asked
        if asked["failed"][0] != kernels.ANSWERED:
            asked["failed"] = kernels.ANSWERED
            raise self._raised.pop()


def give_python(answers: Answers, workspace: Workspace, table: NDArray[Any]) -> None:
    """Let what of a system's elements happens in Python be asked.

    Args:
        answers: Who answers.
        workspace: What the run works on; its contact table and program are written to.
        table: Contact table that gaps are located in, CONTACT, written.
    """
    state, asked = answers.outside.state, answers.outside.asked
    if workspace.paths or workspace.system.callables:
        ask = workspace.asked_in_steps()
        answers.give("elements", lambda t: ask(t, state))
        # Forces of laws in Python are zero again only once they have been asked after a release.
        compiled = all(path.compiled for path in workspace.paths)
        asked["touching"] = compiled and not workspace.system.callables
    if workspace.system.callables and workspace.constraints is not None:
        answers.give("motions", lambda t: workspace.prepare_motions(t, state))
    if workspace.measured:
        answers.give("gaps", lambda t: workspace.measure_into(table, state, int(asked["contact"][0])))
    if workspace.asked_laws:
        answers.give("forces", lambda t: workspace.ask_laws(table, int(asked["contact"][0])))


def give_pinocchio(answers: Answers, workspace: Workspace, mass: Array, bias: Array) -> None:
    """Let Pinocchio answer for the dynamics of the tree.

    Args:
        answers: Who answers.
        workspace: What the run works on.
        mass: Mass matrix, (nv, nv), written.
        bias: (nv,), written.
    """
    tree = workspace.model, workspace.data, answers.outside.state
    if workspace.constraints is None:
        function, acceleration = accelerations_of(*tree, answers.outside.effort)
        answers.outside = answers.outside._replace(acceleration=acceleration)
        answers.give("acceleration", function)
    else:
        answers.give("terms", terms_of(*tree, mass, bias))
