"""The decorator of the compiled kernels.

Numba caches a compiled function by the age of the file it stands in, and does not see that a function it
calls in another file has changed. The kernels call one another across rooms, so here every cache entry is
tied to the contents of all kernel files: a change in any of them compiles all of them anew.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import numba
import numpy as np
from numba.extending import lower_builtin, type_callable

from antenna_pin._kernel_cache import FORMAT, keep, stand_alone

__all__ = ["composed", "inlined", "kernel", "record", "released", "stamped_files"]

_Function = TypeVar("_Function", bound=Callable[..., Any])


def stamped_files() -> tuple[Path, ...]:
    """Return the files to whose contents compiled code is tied: all kernels, their constants and records."""
    folder = Path(__file__).parent
    names = (
        "*/*kernels.py",
        "contact/records.py",
        "records.py",
        "_called.py",
        "_lanes.py",
        "elements/registry.py",
    )
    return tuple(sorted(path for name in names for path in folder.glob(name)))


@cache
def _stamp() -> str:
    """Return a digest of all kernel files and of Numba's version."""
    digest = hashlib.sha256(f"{numba.__version__} {FORMAT}".encode())
    for path in (Path(__file__), *stamped_files()):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def kernel(function: _Function) -> _Function:
    """Compile a function at its first call and keep the machine code, which stands alone.

    Division by zero gives infinity there, not an exception. Nothing may be allocated: references to arrays
    are not counted, which would take as long as all the arithmetic.
    """
    # Left unsaid, Numba takes over what the caller says for which it is compiled.
    compiled = _compiled(function, forceinline=False)
    stand_alone(compiled)
    return compiled


def released(function: _Function) -> _Function:
    """Compile as a kernel a function that lets other threads run while it does."""
    return _compiled(function, forceinline=False, nogil=True)


def inlined(function: _Function) -> _Function:
    """Compile a small function that is always put into its callers: a call would cost more than it."""
    return _compiled(function, forceinline=True)


def composed(function: _Function) -> _Function:
    """Compile a function that is made from kernels when a module is imported; it is put into its callers.

    Nothing of it is kept: its callers' machine code holds it; what it is made from stands under the stamp.
    """
    return _njit(function, forceinline=True)  # type: ignore[no-any-return]


def _compiled(function: _Function, **options: bool) -> _Function:
    compiled = _njit(function, **options)
    _take_constants_as_numbers(compiled)
    keep(compiled, _stamp())
    return compiled  # type: ignore[no-any-return]


def _take_constants_as_numbers(compiled: Any) -> None:
    """Let a function that a kernel calls with a plain constant be the one that is called with a number.

    Numba makes of a constant a type of its own: the function, and all that it calls, would be compiled once
    more for each.
    """
    if getattr(compiled, "py_func", None) is None:  # NUMBA_DISABLE_JIT=1
        return
    template = compiled.get_call_template

    def of_numbers(arguments: Any, named: Any) -> Any:
        plain = {name: numba.types.unliteral(one) for name, one in named.items()}
        return template(tuple(map(numba.types.unliteral, arguments)), plain)

    compiled.get_call_template = of_numbers


def _njit(function: Callable[..., Any], **options: bool) -> Any:
    try:
        # No entry for C: nothing here asks for an address.
        return numba.njit(error_model="numpy", _nrt=False, no_cfunc_wrapper=True, **options)(function)
    except KeyError:
        # These options are Numba's own, not promised ones; without that against counting kernels are slower.
        return numba.njit(error_model="numpy", **options)(function)


def record(numbers: Any, layout: np.dtype[Any]) -> Any:
    """Return flat numbers, shape (n,), as a record of that size: names instead of offsets.

    Compiled code reads a field of it as it reads an entry of the array, and checks nothing; a ``view`` would
    cost 2 ns.
    """
    return numbers.view(layout)[0]


@type_callable(record)
def _type_of_record(context: Any) -> Any:
    def typed(numbers: Any, layout: Any) -> Any:
        return layout.dtype

    return typed


@lower_builtin(record, numba.types.Array, numba.types.DType)
def _lowered_record(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    array = context.make_array(signature.args[0])(context, builder, arguments[0])
    return builder.bitcast(array.data, context.get_value_type(signature.return_type))
