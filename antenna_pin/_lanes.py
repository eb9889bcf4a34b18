"""Four numbers at once in compiled code, as processors multiply them: written down, not left to be found.

Compilers make such code of sums only if they may change the order of additions, which changes results. Here
each of the four goes its own way: what comes out are the numbers of as many loops, to the last bit. Lanes
add, subtract and multiply, with one another and with a number. Uncompiled they are arrays.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import lower_builtin, models, register_model, type_callable

__all__ = ["LANES", "lane", "put_lane", "same_lane", "sum_of_lane"]

#: Numbers in a lane.
LANES = 4

_VECTOR = ir.VectorType(ir.DoubleType(), LANES)
# Numbers stand anywhere in their arrays.
_ALIGNMENT = 8


class _Lane(types.Type):  # type: ignore[misc]
    """Numba's type of a lane."""


_LANE = _Lane("lane")


@register_model(_Lane)
class _LaneModel(models.PrimitiveModel):  # type: ignore[misc]
    """A lane is one of the processor's registers, or several."""

    def __init__(self, manager: Any, own_type: Any) -> None:
        """Say what it is to LLVM."""
        super().__init__(manager, own_type, _VECTOR)


def lane(numbers: Any, at: int) -> Any:
    """Return ``numbers[at : at + LANES]`` of a contiguous array; nothing is checked."""
    return numbers[at : at + LANES].copy()


def put_lane(numbers: Any, at: int, value: Any) -> None:
    """Write a lane into ``numbers[at : at + LANES]`` of a contiguous array; nothing is checked."""
    numbers[at : at + LANES] = value


def same_lane(number: float) -> Any:
    """Return a lane that is one number all along."""
    return np.full(LANES, number)


def sum_of_lane(value: Any) -> float:
    """Return the sum of a lane's numbers."""
    return float((value[0] + value[1]) + (value[2] + value[3]))


@type_callable(lane)
def _type_of_lane(context: Any) -> Any:
    return lambda numbers, at: _LANE


@type_callable(put_lane)
def _type_of_put_lane(context: Any) -> Any:
    return lambda numbers, at, value: types.none


@type_callable(same_lane)
def _type_of_same_lane(context: Any) -> Any:
    return lambda number: _LANE


@type_callable(sum_of_lane)
def _type_of_sum(context: Any) -> Any:
    return lambda value: types.float64


def _place(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """Return the address of a lane in an array."""
    array = context.make_array(signature.args[0])(context, builder, arguments[0])
    return builder.bitcast(builder.gep(array.data, [arguments[1]]), _VECTOR.as_pointer())


@lower_builtin(lane, types.Array, types.Integer)
def _lowered_lane(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    return builder.load(_place(context, builder, signature, arguments), align=_ALIGNMENT)


@lower_builtin(put_lane, types.Array, types.Integer, _Lane)
def _lowered_put_lane(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    builder.store(arguments[2], _place(context, builder, signature, arguments), align=_ALIGNMENT)
    return context.get_dummy_value()


def _spread(builder: Any, number: Any) -> Any:
    value = ir.Constant(_VECTOR, ir.Undefined)
    for k in range(LANES):
        value = builder.insert_element(value, number, ir.Constant(ir.IntType(32), k))
    return value


@lower_builtin(same_lane, types.Float)
def _lowered_same_lane(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    return _spread(builder, arguments[0])


@lower_builtin(sum_of_lane, _Lane)
def _lowered_sum(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    a, b, c, d = (builder.extract_element(arguments[0], ir.Constant(ir.IntType(32), k)) for k in range(LANES))
    return builder.fadd(builder.fadd(a, b), builder.fadd(c, d))


def _arithmetic(function: Callable[..., Any], instruction: str) -> None:
    """Let an operator take lanes, and a lane and a number."""

    @type_callable(function)
    def type_of_result(context: Any) -> Any:
        def typed(one: Any, other: Any) -> Any:
            kinds = {one, other}
            return _LANE if kinds == {_LANE} or kinds == {_LANE, types.float64} else None

        return typed

    def lowered(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        values = [
            value if kind == _LANE else _spread(builder, value)
            for value, kind in zip(arguments, signature.args, strict=True)
        ]
        return getattr(builder, instruction)(*values)

    for kinds in ((_Lane, _Lane), (_Lane, types.Float), (types.Float, _Lane)):
        lower_builtin(function, *kinds)(lowered)


_arithmetic(operator.add, "fadd")
_arithmetic(operator.sub, "fsub")
_arithmetic(operator.mul, "fmul")
