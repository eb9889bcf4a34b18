"""Named tuples handed on by their address (``by_address.py``), as Numba compiles them."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.imputils import impl_ret_borrowed
from numba.extending import (
    NativeValue,
    lower_getattr_generic,
    models,
    register_model,
    typeof_impl,
    unbox,
)

from antenna_pin.compiled.by_address import is_by_address

__all__: list[str] = []


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
