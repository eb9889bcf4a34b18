"""Functions of a user's compiled by Numba: checks and addresses.

Kernels call them by address (``calls.py``).
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from functools import cache
from typing import Any

from antenna_pin.errors import InvalidParameterError


def is_compiled(*functions: object) -> bool:
    """Return whether functions are compiled, by ``numba.njit`` or ``numba.cfunc``."""
    if "numba" not in sys.modules:  # without Numba no function is compiled
        return not functions
    from numba.core.ccallback import CFunc
    from numba.core.dispatcher import Dispatcher

    return all(isinstance(function, Dispatcher | CFunc) for function in functions)


def callable_of(function: Callable[..., float], arguments: int) -> Callable[..., float]:
    """Return a function of floats as Python can call it, with kernels' results."""
    if not is_compiled(function):
        return function
    of_user = _dispatched(function)
    called = _compiled(function, arguments).ctypes

    def call(*question: float) -> float:
        answer = float(called(*question))
        if math.isnan(answer):
            of_user(*question)  # raises an error with the reason
        return answer

    return call


def address_of(place: str, name: str, function: Any, arguments: int) -> float:
    """Return the address of a compiled function of so many floats that returns a float.

    Raises:
        InvalidParameterError: It has other arguments, or another return type.
    """
    from numba.core.errors import NumbaError

    count = "1 float" if arguments == 1 else f"{arguments} floats"
    rule = f"a compiled function of {count} that returns a float"
    given = getattr(function, "_sig", _signature(arguments))  # compiled by cfunc
    if given != _signature(arguments):
        raise InvalidParameterError(place, name, rule, f"one of {given}")
    try:
        return float(_compiled(function, arguments).address)
    except NumbaError as error:
        first = next(line for line in str(error).splitlines() if line.strip())
        raise InvalidParameterError(place, name, rule, f"one of which Numba says: {first.strip()}") from None


def _signature(arguments: int) -> Any:
    from numba import float64

    return float64(*[float64] * arguments)


@cache
def _dispatched(function: Any) -> Any:
    """Return a compiled function that other compiled ones can call."""
    from numba import njit
    from numba.core.ccallback import CFunc

    return njit(function.__wrapped__) if isinstance(function, CFunc) else function


@cache
def _compiled(function: Any, arguments: int) -> Any:
    """Return a function for kernels, which gives NaN where it raises."""
    from numba import cfunc

    given = _dispatched(function)

    def one(a: float) -> float:
        try:
            return given(a)  # type: ignore[no-any-return]
        except Exception:
            return math.nan

    def three(a: float, b: float, c: float) -> float:
        try:
            return given(a, b, c)  # type: ignore[no-any-return]
        except Exception:
            return math.nan

    wrapped: Callable[..., float] = one if arguments == 1 else three
    compiled: Any = cfunc(_signature(arguments), error_model="numpy")(wrapped)
    _KEPT.append(compiled)
    return compiled


#: Compiled functions, referenced as long as their addresses are in use.
_KEPT: list[Any] = []
