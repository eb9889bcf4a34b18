"""Compiled forms of a few functions: records, lanes, calls and tuples by address, pointers.

Loaded for Numba with the first kernel; the functions themselves are in modules that do not import Numba.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.imputils import impl_ret_borrowed
from numba.extending import (
    NativeValue,
    intrinsic,
    lower_builtin,
    lower_getattr_generic,
    models,
    register_model,
    type_callable,
    typeof_impl,
    unbox,
)

from antenna_pin.compiled.by_address import is_by_address
from antenna_pin.compiled.calls import call_1, call_3, call_back
from antenna_pin.compiled.lanes import (
    LANES,
    lane,
    lane_of_row,
    put_lane,
    put_lane_of_row,
    same_lane,
    sum_of_lane,
)
from antenna_pin.compiled.record import record


@intrinsic
def pointer(typing: Any, place: Any) -> Any:
    """Return the pointer to numbers at an address."""

    def lowered(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        number = builder.fptoui(arguments[0], ir.IntType(64))
        return builder.inttoptr(number, context.get_value_type(signature.return_type))

    return types.CPointer(types.float64)(types.float64), lowered


class _Block(types.NamedTuple):  # type: ignore[misc]
    """Numba's type of a named tuple that is known by its address."""


@register_model(_Block)
class _BlockModel(models.PrimitiveModel):  # type: ignore[misc]
    """A block is an address to the processor."""

    def __init__(self, manager: Any, own_type: Any) -> None:
        """Say what it is to LLVM."""
        parts = [manager.lookup(part).get_data_type() for part in own_type.types]
        super().__init__(manager, own_type, ir.LiteralStructType(parts).as_pointer())


_type_of_tuple = typeof_impl.dispatch(tuple)


@typeof_impl.register(tuple)
def _type_of(value: Any, context: Any) -> Any:
    if not is_by_address(value):
        return _type_of_tuple(value, context)
    parts = [typeof_impl(part, context) for part in value]
    return None if None in parts else _Block(parts, type(value))


@lower_getattr_generic(_Block)
def _lowered_part(context: Any, builder: Any, kind: Any, block: Any, name: str) -> Any:
    """Read a part of a block, an invariant load for LLVM."""
    number = kind.fields.index(name)
    part = kind.types[number]
    before = len(builder.block.instructions)
    place = cgutils.gep_inbounds(builder, block, 0, number)
    value = context.data_model_manager[part].load_from_data_pointer(builder, place)
    unchanged = builder.module.add_metadata([])
    for one in builder.block.instructions[before:]:
        if one.opname == "load":
            one.set_metadata("invariant.load", unchanged)
    return impl_ret_borrowed(context, builder, part, value)


@unbox(_Block)
def _unboxed(kind: Any, value: Any, c: Any) -> Any:
    """Lay a tuple of Python's out in the memory of who calls."""
    address = c.context.get_value_type(kind)
    block = cgutils.alloca_once(c.builder, address.pointee)
    failed = cgutils.alloca_once_value(c.builder, cgutils.false_bit)
    natives = []
    for number, part in enumerate(kind.types):
        native = c.unbox(part, c.pyapi.tuple_getitem(value, number))
        with c.builder.if_then(native.is_error, likely=False):
            c.builder.store(cgutils.true_bit, failed)
        natives.append((part, native))
        data = c.context.data_model_manager[part].as_data(c.builder, native.value)
        c.builder.store(data, cgutils.gep_inbounds(c.builder, block, 0, number))

    def cleanup() -> None:
        for part, native in reversed(natives):
            if native.cleanup is not None:
                native.cleanup()
            if c.context.enable_nrt:  # Numba's wrapper returns a counted object: its address alone is used.
                c.context.nrt.decref(c.builder, part, native.value)

    # Readers rely on the present values: reads must not be moved before writes, and LLVM must not assume
    # that the address is another one.
    seal = ir.InlineAsm(ir.FunctionType(address, [address]), "", "=r,0,~{memory}", side_effect=True)
    sealed = c.builder.call(seal, [block])
    return NativeValue(sealed, cleanup=cleanup, is_error=c.builder.load(failed))


@type_callable(record)
def _type_of_record(context: Any) -> Any:
    return lambda numbers, layout: layout.dtype


@lower_builtin(record, types.Array, types.DType)
def _lowered_record(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    array = context.make_array(signature.args[0])(context, builder, arguments[0])
    return builder.bitcast(array.data, context.get_value_type(signature.return_type))


@type_callable(call_1)
def _type_of_call_1(context: Any) -> Any:
    return lambda address, a: types.float64


@type_callable(call_3)
def _type_of_call_3(context: Any) -> Any:
    return lambda address, a, b, c: types.float64


@lower_builtin(call_1, *[types.Float] * 2)
@lower_builtin(call_3, *[types.Float] * 4)
def _lowered_call(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    double = ir.DoubleType()
    function = ir.FunctionType(double, [double] * len(values[1:])).as_pointer()
    place = builder.fptoui(values[0], ir.IntType(64))
    return builder.call(builder.inttoptr(place, function), values[1:])


@type_callable(call_back)
def _type_of_call_back(context: Any) -> Any:
    return lambda address, t, target: types.int64


@lower_builtin(call_back, types.Integer, types.Float, types.Integer)
def _lowered_call_back(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    function = ir.FunctionType(ir.IntType(64), [ir.DoubleType(), ir.IntType(64)]).as_pointer()
    return builder.call(builder.inttoptr(values[0], function), values[1:])


_VECTOR = ir.VectorType(ir.DoubleType(), LANES)
# Lanes may start at any index of an array.
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


@type_callable(lane)
def _type_of_lane(context: Any) -> Any:
    return lambda numbers, at: _LANE


@type_callable(put_lane)
def _type_of_put_lane(context: Any) -> Any:
    return lambda numbers, at, value: types.none


@type_callable(lane_of_row)
def _type_of_lane_of_row(context: Any) -> Any:
    return lambda rows, r, k: _LANE


@type_callable(put_lane_of_row)
def _type_of_put_lane_of_row(context: Any) -> Any:
    return lambda rows, r, k, value: types.none


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


def _place_in_row(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """Return the address of a lane in a row of an array."""
    rows = context.make_array(signature.args[0])(context, builder, arguments[0])
    width = builder.extract_value(rows.shape, 1)
    at = builder.add(builder.mul(arguments[1], width), arguments[2])
    return builder.bitcast(builder.gep(rows.data, [at]), _VECTOR.as_pointer())


@lower_builtin(lane_of_row, types.Array, types.Integer, types.Integer)
def _lowered_lane_of_row(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    return builder.load(_place_in_row(context, builder, signature, arguments), align=_ALIGNMENT)


@lower_builtin(put_lane_of_row, types.Array, types.Integer, types.Integer, _Lane)
def _lowered_put_lane_of_row(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    builder.store(arguments[3], _place_in_row(context, builder, signature, arguments), align=_ALIGNMENT)
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
