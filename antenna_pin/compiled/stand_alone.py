"""Separately compiled kernels: callers refer to them by process-independent names.

Numba includes all callees in a function and optimises them there again: a callee of ten callers is compiled
ten times. A kernel that stands alone is compiled once; its callers are linked to it when loaded.
"""

from __future__ import annotations

import copy
import hashlib
import importlib
import itertools
from typing import Any

from antenna_pin.compiled.machine_code import DeferredCall, Kept, KernelCode, add_kernel_symbol

try:
    from numba.core.base import OverloadSelector
    from numba.core.imputils import user_function
except ImportError:  # both are internal to Numba
    OverloadSelector = user_function = None


def stand_alone(dispatcher: Any) -> None:
    """Let callers of a compiled function call it by name instead of holding its code.

    The kernels that they need are stored with their machine code, and loaded or compiled first. Where Numba's
    internals have changed, callers include the code, as by default.
    """
    if getattr(dispatcher, "py_func", None) is None:  # NUMBA_DISABLE_JIT=1
        return
    function = dispatcher.py_func
    name = f"{function.__module__}:{function.__qualname__}"
    add_overload = dispatcher.add_overload

    def added(result: Any) -> None:
        add_overload(result)
        try:
            _publish(name, dispatcher.targetctx, result)
        except AttributeError:
            return

    dispatcher.add_overload = added


def kernel_named(name: str) -> Any:
    """Return a kernel that stands alone, by its module and name."""
    module, _, own = name.partition(":")
    return getattr(importlib.import_module(module), own)


def symbol_of(name: str, arguments: Any) -> str:
    """Return the symbol of a kernel, from its name and its arguments' types."""
    return f"{name}:{hashlib.sha256(str(tuple(arguments)).encode()).hexdigest()}"


def _publish(name: str, context: Any, result: Any) -> None:
    """Register a compiled function under its process-independent name, for calls by name."""
    arguments = tuple(result.signature.args)
    symbol = symbol_of(name, arguments)
    add_kernel_symbol(symbol, result.library.get_pointer_to_function(result.fndesc.llvm_func_name))
    alias = copy.copy(result.fndesc)
    alias.mangled_name = symbol
    call = user_function(alias, ())

    def call_noted(context: Any, *rest: Any, **more: Any) -> Any:
        needs_of(context.active_code_library).add((name, arguments))
        return call(context, *rest, **more)

    vars(call_noted).update(vars(call))
    overloads = OverloadSelector()
    overloads.append(call_noted, call.signature)
    context._defns[result.entry_point] = overloads


def needs_of(library: Any) -> set[Any]:
    """Return the kernels that machine code calls by name, with their argument types."""
    if "needs" not in vars(library):
        library.needs = set()
    needs: set[Any] = library.needs
    return needs


def deferred_calls_of(library: Any) -> set[DeferredCall]:
    """Return the calls in machine code through slots."""
    if "deferred" not in vars(library):
        library.deferred = set()
    deferred: set[DeferredCall] = library.deferred
    return deferred


def all_needs(library: Any) -> tuple[set[Any], set[DeferredCall]]:
    """Return the kernels called by name and through slots, inlined code included."""
    needs, deferred, seen, left = set(), set(), set(), [library]
    while left:
        one = left.pop()
        if id(one) not in seen:
            seen.add(id(one))
            needs |= needs_of(one)
            deferred |= deferred_calls_of(one)
            left += getattr(one, "_linking_libraries", [])
    return needs, deferred


#: Kernels that this process has read or compiled, by name.
_parts: dict[str, KernelCode] = {}


def symbols_of(code: Kept) -> tuple[str, ...]:
    """Return the symbols of the kernels that a function calls."""
    return tuple(sorted(itertools.starmap(symbol_of, code.needs)))


def noted(name: str, code: Kept) -> None:
    """Record a kernel's part for its callers."""
    symbol, function = symbol_of(name, code.signature.args), code.description.llvm_func_name
    needs = symbols_of(code)
    _parts[symbol] = KernelCode(symbol, function, needs, code.object, code.environments, code.deferred)


def parts_of(symbols: tuple[str, ...]) -> tuple[KernelCode, ...]:
    """Return kernels in order of dependence; nothing if one is unknown."""
    found: dict[str, KernelCode] = {}
    return tuple(found.values()) if _gather(symbols, found) else ()


def _gather(needs: tuple[str, ...], parts: dict[str, KernelCode]) -> bool:
    for symbol in needs:
        if symbol not in parts:
            part = _parts.get(symbol)
            if part is None or not _gather(part.needs, parts):
                return False
            parts[symbol] = part
    return True
