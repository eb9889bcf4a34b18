"""Calls of functions by their addresses, from kernels.

A kernel is compiled once for all functions: an address is a number (``given_functions.py``).
``intrinsics.py`` has the compiled form of these calls.
"""

from __future__ import annotations

import ctypes

#: Signature of a function that kernels call by address: time [s] and address of an object (ignored by
#: functions in Python); it returns a status.
CALLED_BACK = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_double, ctypes.c_void_p)

_OF_1 = ctypes.CFUNCTYPE(*[ctypes.c_double] * 2)
_OF_3 = ctypes.CFUNCTYPE(*[ctypes.c_double] * 4)


def call_1(address: float, a: float) -> float:
    """Call a function of one float by its address."""
    return float(_OF_1(int(address))(a))


def call_3(address: float, a: float, b: float, c: float) -> float:
    """Call a function of three floats by its address."""
    return float(_OF_3(int(address))(a, b, c))


def call_back(address: int, t: float, target: int) -> int:
    """Call a ``CALLED_BACK`` by its address; return its status.

    ``target`` is the address of an object of machine code; 0 for functions in Python.
    """
    return int(CALLED_BACK(int(address))(t, int(target)))
