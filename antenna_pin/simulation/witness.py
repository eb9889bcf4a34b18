"""Which compiled function of a user's has no answer in a step that does not come about.

Kernels call such functions by their addresses, and all that is seen of an answer that is none is a step whose
error is none. So the step is made once more with other addresses in the program: those of functions in Python
that ask the user's and look at the answers.
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
from antenna_pin.compiled.given_functions import address_of, is_compiled
from antenna_pin.errors import FunctionError
from antenna_pin.integrate import Stepper

__all__ = ["Called", "failure_in"]

Array = NDArray[np.float64]


class Witnessed(Protocol):
    """A compiled function whose address may be exchanged."""

    arguments: int

    @property
    def asked(self) -> Callable[..., float]:
        """It, as Python asks it."""

    def places(self, program: Array) -> NDArray[np.int64]:
        """Return where in a program its address stands."""


class Called:
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
    functions: Sequence[Witnessed], program: Array, stepper: Stepper, h: float
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
def _seen_by(functions: Sequence[Witnessed], program: Array, seen: list[BaseException]) -> Iterator[None]:
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
