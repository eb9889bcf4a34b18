"""Stored machine code of a kernel, made callable without Numba's compiler.

Numba reads a stored function as input for compilation: it loads its whole compiler, half a second, parses the
function's LLVM code and examines its symbols. A call needs none of that: the object file is passed to LLVM's
linker as it is. The LLVM code is stored too, and parsed for callers that are compiled again only.
"""

from __future__ import annotations

import ctypes
import zlib
from functools import cache, cached_property
from typing import Any, NamedTuple

from llvmlite.binding import ObjectFileRef, add_symbol, parse_bitcode

try:
    from numba import _dynfunc
    from numba.core.compiler import compile_result
    from numba.core.runtime import _nrt_python
except ImportError:  # both are internal to Numba
    _dynfunc = _nrt_python = compile_result = None


class DeferredCall(NamedTuple):
    """Call of a kernel, or of a kind's, that is compiled at its first call.

    Attributes:
        kernel: Module and name.
        types: Pickled types of the arguments.
    """

    kernel: str
    types: bytes


class Kept(NamedTuple):
    """Machine code of a compiled function as stored.

    Attributes:
        needs: Kernels that it calls by name, each with the types of its arguments.
        object: Its object file; empty for a function that is only inlined.
        bitcode: Its LLVM code, for callers into which it is put, compressed: two thirds of all.
        description: Numba's.
        environments: What it needs of Python, its own first.
        signature: Types of its arguments and of what it returns.
        deferred: Calls of kernels through slots.
    """

    needs: set[Any]
    object: bytes
    bitcode: bytes
    description: Any
    environments: tuple[Any, ...]
    signature: Any
    deferred: frozenset[DeferredCall]


class KernelCode(NamedTuple):
    """Machine code of a kernel that loaded callers call by name.

    Attributes:
        symbol: The name.
        function: Name in its object file.
        needs: Symbols of kernels that it calls.
        object: Its object file.
        environments: What it needs of Python.
        deferred: Calls of kernels through slots.
    """

    symbol: str
    function: str
    needs: tuple[str, ...]
    object: bytes
    environments: tuple[Any, ...]
    deferred: frozenset[DeferredCall]


class Code:
    """Loaded machine code in place of Numba's library, for its callers."""

    def __init__(self, engine: Any, code: Kept) -> None:
        """Store the engine, and the stored code."""
        self._engine, self._stored = engine, code
        self._linking_libraries: tuple[Any, ...] = ()
        self._reload_init: frozenset[Any] = frozenset()

    def get_pointer_to_function(self, name: str) -> int:
        """Return the address of a function."""
        return int(self._engine.get_function_address(name)) if self._stored.object else 0

    def _ensure_finalized(self) -> None:
        pass

    def _get_module_for_linking(self) -> Any:
        return self._module

    @cached_property
    def _module(self) -> Any:
        return parse_bitcode(zlib.decompress(self._stored.bitcode))


def kept_of(needs: set[Any], deferred: set[DeferredCall], reduced: tuple[Any, ...]) -> Kept | None:
    """Return the storable form of Numba's reduced result; None for an unknown form."""
    (_, form, code), description, environment, signature, objectmode, _, _, reload_init, others = reduced
    if form != "object" or objectmode or reload_init:
        return None
    machine_code, bitcode = code
    code_of_llvm, environments = zlib.compress(bitcode, 1), (environment, *others)
    return Kept(needs, machine_code, code_of_llvm, description, environments, signature, frozenset(deferred))


def called(context: Any, code: Kept) -> Any:
    """Return a stored function, linked, as Numba's compile result.

    Raises:
        AttributeError: Internals of Numba or llvmlite have changed.
    """
    description, environment = code.description, code.environments[0]
    engine = context.codegen()._engine._ee
    _name_memory()
    if code.object and (
        description.llvm_func_name not in _linked or _linked[description.llvm_func_name] != hash(code.object)
    ):
        engine.add_object_file(ObjectFileRef.from_data(code.object))
    library = Code(engine, code)
    entry = _dynfunc.make_function(
        description.lookup_module(),
        description.qualname.split(".")[-1],
        f"compiled wrapper for {description.qualname!r}",
        library.get_pointer_to_function(description.llvm_cpython_wrapper_name),
        environment,
        (library,),
    )
    _place(engine, code.environments)
    return compile_result(
        target_context=context,
        typing_context=context.typing_context,
        library=library,
        environment=environment,
        entry_point=entry,
        fndesc=description,
        signature=code.signature,
        objectmode=False,
        referenced_envs=code.environments,
    )


#: Addresses of kernels by their process-independent names; digests of object files loaded for callers only,
#: by function; and environments whose address compiled code stores.
_symbols: dict[str, int] = {}
_linked: dict[str, int] = {}
_placed: dict[str, Any] = {}


def add_kernel_symbol(symbol: str, address: int) -> None:
    """Let loaded code call a function by a name."""
    _symbols[symbol] = address
    add_symbol(symbol, address)


def address_of(symbol: str) -> int:
    """Return the address of a kernel that has been compiled or loaded, by its symbol."""
    return _symbols[symbol]


def link(context: Any, part: KernelCode) -> None:
    """Load a kernel for callers by name, after the kernels that it calls."""
    if part.symbol not in _symbols:
        engine = context.codegen()._engine._ee
        _name_memory()
        engine.add_object_file(ObjectFileRef.from_data(part.object))
        _linked[part.function] = hash(part.object)
        add_kernel_symbol(part.symbol, engine.get_function_address(part.function))
        _place(engine, part.environments)


def _place(engine: Any, environments: tuple[Any, ...]) -> None:
    """Set the environments' addresses in code; all object files share one place."""
    for one in environments:
        if _placed.get(one.env_name) is not one:
            _placed[one.env_name] = one
            if place := engine.get_global_value_address(one.env_name):
                ctypes.c_void_p.from_address(place).value = id(one)


@cache
def _name_memory() -> None:
    """Define the names of memory functions that Numba's compiler would define."""
    for name, address in _nrt_python.c_helpers.items():
        add_symbol(name if name.startswith("_") else f"NRT_{name}", address)
