"""Calls of deferred kernels (``decorators.deferred``) through slots, as Numba compiles them.

A slot is a place in memory for a kernel's address, under a name that holds in every process. Callers are
compiled with the types of the call alone. A call that finds its slot empty has Python compile or load the
kernel and fill it. Kernels of many kinds have a row of slots, by the number of the kind.
"""

from __future__ import annotations

import ctypes
import pickle
from functools import cache
from typing import Any, get_args, get_origin

from llvmlite import ir
from llvmlite.binding import add_symbol
from numba import types
from numba.core import cgutils
from numba.core.base import OverloadSelector
from numba.core.imputils import lower_constant
from numba.core.registry import cpu_target
from numba.core.typing import signature
from numba.extending import models, register_model

from antenna_pin.compiled.deferred import KINDS, failures
from antenna_pin.compiled.machine_code import DeferredCall, address_of
from antenna_pin.compiled.stand_alone import deferred_calls_of, kernel_named, symbol_of

#: What the name of a slot begins with, before the symbol of its kernel.
SLOT = "slot:"
#: Name of the function that fills a slot: of the address of a row and a number in it, the kernel's address.
FILL = "fill a slot"

_ADDRESS, _WORD = ir.IntType(8).as_pointer(), ir.IntType(64)
_RETURNED = {None: types.none, int: types.int64, float: types.float64, bool: types.boolean}


@ctypes.PYFUNCTYPE(ctypes.c_int32)
def _failing() -> int:
    """Fail as a kernel does."""
    return -1  # Numba's status of an exception


class _Row:
    """Slots of a call: one, or one for each kind; zero until called."""

    def __init__(self, call: DeferredCall) -> None:
        """Define the row's name for loaded code."""
        self._kernel, self._types = kernel_named(call.kernel), _arguments(call)
        self.addresses = (ctypes.c_void_p * self._kernel.places)()
        add_symbol(_name(call), ctypes.addressof(self.addresses))

    def fill(self, number: int) -> int:
        """Compile or load a kernel, write its address, and return that."""
        kernel = self._kernel.at(number)
        kernel.compile(self._types)
        returned, declared = kernel.overloads[self._types].signature.return_type, returned_by(self._kernel)
        found = types.unliteral(returned)
        if found != declared:
            raise TypeError(f"{kernel.name} is declared to return {declared}, not {found}")
        self.addresses[number] = address_of(symbol_of(kernel.name, self._types))
        return int(self.addresses[number] or 0)


_rows: dict[DeferredCall, _Row] = {}
_rows_at: dict[int, _Row] = {}


@ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64)
def _fill(place: int, number: int) -> int | None:
    """Fill a slot for machine code; with a failing function if Python raises."""
    try:
        return _rows_at[place].fill(number)
    except BaseException as error:  # of a user who interrupts, too
        failures.append(error)
        return ctypes.cast(_failing, ctypes.c_void_p).value


add_symbol(FILL, ctypes.cast(_fill, ctypes.c_void_p).value)


def _arguments(call: DeferredCall) -> tuple[Any, ...]:
    return tuple(pickle.loads(call.types))  # noqa: S301 - of this process, or from a sealed file


def _name(call: DeferredCall) -> str:
    return SLOT + symbol_of(call.kernel, _arguments(call))


def symbols_of_call(call: DeferredCall) -> tuple[str, list[str]]:
    """Return the name of a call's row of slots, and its kernels' symbols."""
    kernel, kinds = kernel_named(call.kernel), _arguments(call)
    return _name(call), [symbol_of(kernel.at(number).name, kinds) for number in range(kernel.places)]


def declare(call: DeferredCall) -> None:
    """Make the slots of a call."""
    if call not in _rows:
        row = _rows[call] = _Row(call)
        _rows_at[ctypes.addressof(row.addresses)] = row


def fill_all(backwards: bool = False) -> None:
    """Fill all slots of loaded kernels, and of those that these call.

    Of two processes one may begin at the end.
    """
    while empty := [(row, k) for row in _rows.values() for k, one in enumerate(row.addresses) if not one]:
        for row, number in reversed(empty) if backwards else empty:
            row.fill(number)


class _Deferred(types.Callable, types.Dummy):  # type: ignore[misc]
    """Type of a deferred kernel, or of a row of them."""

    def __init__(self, kernel: str, is_row: bool, returned: Any) -> None:
        """Name the kernel and what it returns."""
        self._kernel, self._is_row, self._returned = kernel, is_row, returned
        super().__init__(f"deferred({kernel})")

    def get_call_type(self, context: Any, args: Any, kws: Any) -> Any:
        """Return the signature of a call, whose slots are declared."""
        if kws:
            raise TypeError(f"{self._kernel} is deferred and takes no arguments by name")
        arguments = tuple(map(types.unliteral, args))
        declare(self._call(arguments))
        return signature(self._returned, *arguments)

    def get_call_signatures(self) -> tuple[tuple[Any, ...], bool]:
        """Return none: each call has its own."""
        return (), True

    def get_impl_key(self, sig: Any) -> str:
        """Return the name under which calls are registered for lowering."""
        definitions, name = cpu_target.target_context._defns, SLOT + self._kernel
        if name not in definitions:
            definitions[name] = OverloadSelector()
            definitions[name].append(self._lowered, (types.VarArg(types.Any),))
        return name

    def _call(self, arguments: tuple[Any, ...]) -> DeferredCall:
        return DeferredCall(self._kernel, pickle.dumps(arguments[self._is_row :]))

    def _lowered(self, context: Any, builder: Any, sig: Any, args: Any) -> Any:
        """Call the kernel at the address in its slot, filled first if it is empty."""
        call = self._call(sig.args)
        deferred_calls_of(context.active_code_library).add(call)
        convention, given = context.call_conv, sig.args[self._is_row :]
        kind = convention.get_function_type(sig.return_type, given).as_pointer()
        slots = _global(builder.module, _name(call), ir.ArrayType(_ADDRESS, KINDS if self._is_row else 1))
        number = _WORD(0)
        if self._is_row:
            number = builder.sext(args[0], _WORD) if args[0].type.width < _WORD.width else args[0]
            is_known = builder.icmp_unsigned("<", number, _WORD(KINDS - 1))
            number = builder.select(is_known, number, _WORD(KINDS - 1))
        slot = builder.gep(slots, [_WORD(0), number])
        address = cgutils.alloca_once_value(builder, builder.load(slot))
        with cgutils.if_unlikely(builder, cgutils.is_null(builder, builder.load(address))):
            fill = cgutils.get_or_insert_function(
                builder.module, ir.FunctionType(_ADDRESS, [_ADDRESS, _WORD]), FILL
            )
            builder.store(builder.call(fill, [builder.bitcast(slots, _ADDRESS), number]), address)
        kernel = builder.bitcast(builder.load(address), kind)
        status, value = convention.call_function(
            builder, kernel, sig.return_type, given, args[self._is_row :]
        )
        with cgutils.if_unlikely(builder, status.is_error):
            convention.return_status_propagate(builder, status)
        return value


def _global(module: Any, name: str, kind: Any) -> Any:
    return module.globals.get(name) or ir.GlobalVariable(module, kind, name)


@register_model(_Deferred)
class _DeferredModel(models.OpaqueModel):  # type: ignore[misc]
    """Nothing at run time: calls go to the slot."""


@lower_constant(_Deferred)
def _constant(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    return context.get_dummy_value()


@cache
def returned_by(kernel: Any) -> Any:
    """Return Numba's type of what a deferred kernel returns, as annotated."""
    function = kernel.__wrapped__
    annotation = function.__annotations__["return"]
    if isinstance(annotation, str):
        annotation = eval(annotation, function.__globals__)  # noqa: S307 - a kernel's own source
    return _type_of(annotation)


def _type_of(annotation: Any) -> Any:
    if get_origin(annotation) is tuple:
        return types.Tuple(tuple(map(_type_of, get_args(annotation))))
    return _RETURNED[annotation]


def call_type(kernel: Any) -> Any:
    """Return Numba's type of a deferred kernel, or of those of all kinds."""
    return _Deferred(kernel.name, kernel.places > 1, returned_by(kernel))
