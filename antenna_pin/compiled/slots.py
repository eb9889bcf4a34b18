"""Calls of deferred kernels (``decorators.deferred``) through slots, as Numba compiles them.

A slot is a place in memory for a kernel's address, under a name that holds in every process. Callers are
compiled with the types of the call alone. Where the kernel's group is required, the kernel is compiled or
loaded and its slot filled before they run; elsewhere the slot stays empty, for they do not come to the call.
"""

from __future__ import annotations

import ctypes
import pickle
import sys
from typing import Any

from llvmlite import ir
from llvmlite.binding import add_symbol
from numba import types
from numba.core import cgutils
from numba.core.base import OverloadSelector
from numba.core.imputils import lower_constant
from numba.core.registry import cpu_target
from numba.core.typing import signature
from numba.extending import models, register_model

from antenna_pin.compiled.deferred import is_required
from antenna_pin.compiled.machine_code import DeferredCall, address_of
from antenna_pin.compiled.stand_alone import deferred_calls_of, kernel_named, symbol_of

__all__ = ["SLOT", "call_type", "declare", "fill", "symbol_of_call"]

#: What the name of a slot begins with, before the symbol of its kernel.
SLOT = "slot:"

_RETURNED = {"None": types.none, "int": types.int64, "float": types.float64, "bool": types.boolean}


@ctypes.PYFUNCTYPE(ctypes.c_int32)
def _missing() -> int:
    """Fail as a kernel called without its group; Python raises ``SystemError``."""
    sys.stderr.write("a deferred kernel is called, but nothing has required its group\n")
    return -1  # Numba's status of an exception


class _Slot:
    """Place of a deferred kernel's address; ``_missing`` until its group is required."""

    def __init__(self, call: DeferredCall, symbol: str) -> None:
        """Define the slot's name for loaded code."""
        self.call, self._symbol, self._is_filled = call, symbol, False
        self._address = ctypes.cast(_missing, ctypes.c_void_p)
        add_symbol(SLOT + symbol, ctypes.addressof(self._address))

    def fill(self) -> None:
        """Compile or load the kernel and write its address."""
        if not self._is_filled:
            kernel_named(self.call.kernel).compile(_arguments(self.call))
            self._address.value = address_of(self._symbol)
            self._is_filled = True


_slots: dict[DeferredCall, _Slot] = {}


def _arguments(call: DeferredCall) -> tuple[Any, ...]:
    return tuple(pickle.loads(call.types))  # noqa: S301 - of this process, or from a sealed file


def symbol_of_call(call: DeferredCall) -> str:
    """Return the symbol of the kernel that a call means."""
    return symbol_of(call.kernel, _arguments(call))


def declare(call: DeferredCall) -> None:
    """Make the slot of a call, and fill it if its group is required already."""
    if call not in _slots:
        _slots[call] = _Slot(call, symbol_of_call(call))
    if is_required(call.group):
        _slots[call].fill()


def fill(group: str) -> None:
    """Fill the slots of a group."""
    for call in [one for one in _slots if one.group == group]:
        _slots[call].fill()


class _Deferred(types.Callable, types.Dummy):  # type: ignore[misc]
    """Type of a deferred kernel."""

    def __init__(self, kernel: str, group: str, returned: Any) -> None:
        """Name the kernel and what it returns."""
        self._kernel, self._group, self._returned = kernel, group, returned
        super().__init__(f"deferred({kernel})")

    def get_call_type(self, context: Any, args: Any, kws: Any) -> Any:
        """Return the signature of a call, whose slot is declared."""
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
        return DeferredCall(self._group, self._kernel, pickle.dumps(arguments))

    def _lowered(self, context: Any, builder: Any, sig: Any, args: Any) -> Any:
        """Call the kernel at the address in its slot."""
        deferred_calls_of(context.active_code_library).add(self._call(sig.args))
        convention, name = context.call_conv, SLOT + symbol_of(self._kernel, sig.args)
        kind = convention.get_function_type(sig.return_type, sig.args).as_pointer()
        slot = builder.module.globals.get(name) or ir.GlobalVariable(builder.module, kind, name)
        status, value = convention.call_function(builder, builder.load(slot), sig.return_type, sig.args, args)
        with cgutils.if_unlikely(builder, status.is_error):
            convention.return_status_propagate(builder, status)
        return value


@register_model(_Deferred)
class _DeferredModel(models.OpaqueModel):  # type: ignore[misc]
    """Nothing at run time: calls go to the slot."""


@lower_constant(_Deferred)
def _constant(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    return context.get_dummy_value()


def call_type(kernel: str, group: str, returned: str) -> Any:
    """Return Numba's type of a deferred kernel.

    Args:
        kernel: Module and name.
        group: Group that a run requires.
        returned: Annotation of what it returns: None, int, float or bool.
    """
    return _Deferred(kernel, group, _RETURNED[returned])
