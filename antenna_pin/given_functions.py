"""Functions of a user's that Numba has compiled: what they must be, and where they stand.

Kernels call them by their addresses (``_called.py``).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from numba import cfunc, float64
from numba.core.ccallback import CFunc
from numba.core.dispatcher import Dispatcher
from numba.core.errors import NumbaError

from antenna_pin.errors import InvalidParameterError

__all__ = ["address_of", "callable_of", "is_compiled"]


def is_compiled(*functions: object) -> bool:
    """Whether functions are compiled ones: by ``numba.njit`` or ``numba.cfunc``."""
    return all(isinstance(function, Dispatcher | CFunc) for function in functions)


def callable_of(function: Callable[..., float]) -> Callable[..., float]:
    """Return a function as Python can call it: one compiled by ``numba.cfunc`` stands for itself only."""
    return function.ctypes if isinstance(function, CFunc) else function


def address_of(place: str, name: str, function: Any, arguments: int) -> float:
    """Return where a compiled function of so many floats stands, which gives a float.

    Args:
        place: Whose it is, for the refusal.
        name: Which one, for the refusal.
        function: Compiled by ``numba.njit`` or ``numba.cfunc``.
        arguments: How many floats it takes.

    Raises:
        InvalidParameterError: It does not take them, or gives something else.
    """
    return float(_address(place, name, function, arguments))


@cache
def _address(place: str, name: str, function: Any, arguments: int) -> int:
    signature = float64(*[float64] * arguments)
    count = "1 float" if arguments == 1 else f"{arguments} floats"
    rule = f"a compiled function of {count} that returns a float"
    if isinstance(function, CFunc):
        given: Any = function
        if given._sig != signature:
            raise InvalidParameterError(place, name, rule, f"one of {given._sig}")
        _KEPT.append(given)
        return int(given.address)

    def one(a: float) -> float:
        return function(a)  # type: ignore[no-any-return]

    def three(a: float, b: float, c: float) -> float:
        return function(a, b, c)  # type: ignore[no-any-return]

    wrapped: Callable[..., float] = one if arguments == 1 else three
    try:
        compiled: Any = cfunc(signature, error_model="numpy")(wrapped)
    except NumbaError as error:
        first = next(line for line in str(error).splitlines() if line.strip())
        raise InvalidParameterError(place, name, rule, f"one of which Numba says: {first.strip()}") from None
    _KEPT.append(compiled)
    return int(compiled.address)


#: Compiled functions, kept for as long as their addresses are in use anywhere.
_KEPT: list[Any] = []
