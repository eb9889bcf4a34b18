"""Calls of functions by their addresses, from kernels.

A kernel is compiled once, whatever functions it is given: an address is a number among numbers
(``given_functions.py``). Compiled, these calls are what ``_intrinsics.py`` says.
"""

from __future__ import annotations

import ctypes

__all__ = ["CALLED_BACK", "call_1", "call_3", "call_back"]

#: A function in Python that kernels call by its address: of a time [s], it gives a status.
CALLED_BACK = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_double)

_OF_1 = ctypes.CFUNCTYPE(*[ctypes.c_double] * 2)
_OF_3 = ctypes.CFUNCTYPE(*[ctypes.c_double] * 4)


def call_1(address: float, a: float) -> float:
    """Call a function of one float by its address."""
    return float(_OF_1(int(address))(a))


def call_3(address: float, a: float, b: float, c: float) -> float:
    """Call a function of three floats by its address."""
    return float(_OF_3(int(address))(a, b, c))


def call_back(address: int, t: float) -> int:
    """Call a function that was made a ``CALLED_BACK``, by its address; return its status."""
    return int(CALLED_BACK(int(address))(t))
