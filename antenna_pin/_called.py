"""Calls of functions by their addresses, from kernels.

A kernel is compiled once, whatever functions it is given: an address is a number among numbers
(``given_functions.py``).
"""

from __future__ import annotations

import ctypes
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic, lower_builtin, type_callable

__all__ = ["CALLED_BACK", "call_1", "call_3", "call_back"]

#: A function in Python that kernels call by its address: of a time [s], it gives a status.
CALLED_BACK = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_double)


def _call(count: int) -> Any:
    def typed(context: Any, address: Any, *arguments: Any) -> Any:
        def lowered(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            double = ir.DoubleType()
            function = ir.FunctionType(double, [double] * count).as_pointer()
            place = builder.fptoui(values[0], ir.IntType(64))
            return builder.call(builder.inttoptr(place, function), values[1:])

        return types.float64(types.float64, *[types.float64] * count), lowered

    return typed


_call_1, _call_3 = _call(1), _call(3)


@intrinsic
def call_1(context: Any, address: Any, a: Any) -> Any:
    """Call a function of one float by its address."""
    return _call_1(context, address, a)


@intrinsic
def call_3(context: Any, address: Any, a: Any, b: Any, c: Any) -> Any:
    """Call a function of three floats by its address."""
    return _call_3(context, address, a, b, c)


def call_back(address: int, t: float) -> int:
    """Call a function that was made a ``CALLED_BACK``, by its address; return its status."""
    return int(CALLED_BACK(int(address))(t))


@type_callable(call_back)
def _type_of_call(context: Any) -> Any:
    def typed(address: Any, t: Any) -> Any:
        return types.int64

    return typed


@lower_builtin(call_back, types.Integer, types.Float)
def _lowered_call(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    function = ir.FunctionType(ir.IntType(64), [ir.DoubleType()]).as_pointer()
    return builder.call(builder.inttoptr(values[0], function), [values[1]])
