"""Functions of a user's that act on links, asked again as others are, and where their addresses stand."""

from __future__ import annotations

import ctypes
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Workspace, kernels
from antenna_pin.dynamics.acting import Acting
from antenna_pin.dynamics.links import desk_in, written_by

__all__ = ["AskedOnLinks"]

Array = NDArray[np.float64]

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
        return any(a != b and not (a != a and b != b) for a, b in zip(one, other, strict=True))

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
