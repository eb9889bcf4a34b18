"""Decorators of compiled kernels, which load Numba at first use.

Many importers of a module of kernels call none of them, such as commands that describe a scenario. A
placeholder becomes Numba's kernel at its first call, or when Numba finds it in a caller.
"""

from __future__ import annotations

import functools
import math
import os
import sys
import threading
import types
from collections.abc import Callable
from typing import Any, TypeVar

from antenna_pin.compiled.deferred import KINDS, raise_failure
from antenna_pin.compiled.record import Layout, record

__all__ = [
    "ByKind",
    "Layout",
    "composed",
    "composed_later",
    "deferred",
    "in_python",
    "inlined",
    "kernel",
    "record",
    "released",
]

_Function = TypeVar("_Function", bound=Callable[..., Any])


def kernel(function: _Function) -> _Function:
    """Compile a function at its first call, separately, and store the machine code.

    Division by zero gives infinity in compiled code, not an exception. Nothing may be allocated: references
    to arrays are not counted, since counting would take as long as all the arithmetic.
    """
    # Without an explicit setting Numba would use the caller's.
    return _later(function, cached=True, alone=True, forceinline=False)


def deferred(function: _Function) -> _Function:
    """Compile as a kernel a function that only some runs need, when one calls it.

    Its callers are compiled without it (``slots.py``). It returns nothing, int, float, bool or a tuple of
    these, as annotated.
    """
    return function if _plain() else _DeferredKernel(function)  # type: ignore[return-value]


def released(function: _Function) -> _Function:
    """Compile as a kernel a function that lets other threads run while it does."""
    return _later(function, cached=True, forceinline=False, nogil=True)


def inlined(function: _Function) -> _Function:
    """Compile a small function that is always inlined into its callers."""
    return _later(function, cached=True, forceinline=True)


def composed(function: _Function) -> _Function:
    """Compile a function composed of kernels at import, inlined into its callers.

    It has no machine code of its own: its callers contain it, and its parts belong to their stamp.
    """
    return _later(function, cached=False, forceinline=True)


def composed_later(make: Callable[[], Any]) -> Any:
    """Return the composition by ``make``, delayed until its first call or compilation.

    A process that finds its callers compiled neither composes it nor loads its parts.
    """
    if _plain():
        made = functools.cache(make)
        return lambda *arguments: made()(*arguments)
    return _Composed(make)


def in_python(function: _Function) -> _Function:
    """Return the Python function of a compiled one: same whole numbers, without Numba."""
    return getattr(function, "__wrapped__", function)


def _later(function: _Function, **options: bool) -> _Function:
    if _plain():
        plain = _as_compiled()
        if "math" in function.__globals__:
            function.__globals__["math"] = plain
        return function
    return _LazyKernel(function, options)  # type: ignore[return-value]


def _plain() -> bool:
    """Return whether compilation is disabled."""
    return os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")


@functools.cache
def _as_compiled() -> types.SimpleNamespace:
    """Return the ``math`` of compiled code, which gives NaN or infinity instead of errors.

    It does not warn, and switches off NumPy's warnings as well.
    """
    import numpy as np

    np.seterr(divide="ignore", over="ignore", invalid="ignore")

    def same(function: Callable[..., float]) -> Callable[..., float]:
        @functools.wraps(function)
        def answer(*numbers: float) -> float:
            try:
                return function(*numbers)
            except ValueError:
                return math.nan
            except OverflowError:
                return math.inf

        return answer

    return types.SimpleNamespace(
        **{name: same(one) if callable(one) else one for name, one in vars(math).items() if name[0] != "_"}
    )


# Numba infers the types of callees within the inference of their caller, some forty frames each: the chain
# of all kinds of elements exceeds Python's limit of a thousand.
_DEEP = 10_000
#: Of several threads that need a kernel one compiles it.
_MAKING = threading.RLock()


def _load_numba(name: str) -> None:
    """Load Numba for a kernel.

    Raises:
        MissingToolError: Numba is not installed.
    """
    from antenna_pin.compiled.compile_time import clock_numba
    from antenna_pin.compiled.shipped_code import misfit
    from antenna_pin.errors import MissingToolError

    try:
        clock_numba()
    except ModuleNotFoundError as error:
        if error.name not in ("numba", "llvmlite"):
            raise
        reason = misfit() or "the shipped machine code has none for the types of these arguments"
        raise MissingToolError(
            f"kernel {name!r} needs machine code, and {reason}; install what compiles it with pip install "
            "'antenna-pin[compile]'"
        ) from None


@functools.cache
def _for_kernels(kind: type[Any]) -> type[Any]:
    """Return Numba's class of compiled functions, without calls from Python.

    A function without an entry for Python has no address to call there.
    """

    def refuse_call(self: Any, *_: Any) -> None:
        raise RuntimeError(f"{self.py_func.__qualname__}: compiled for kernels only; call the kernel itself")

    return type(kind.__name__, (kind,), {"__call__": refuse_call, "_reduce_class": lambda _: kind})


class _LazyKernel:
    """A function that is compiled by Numba at its first use.

    Kernels called by other kernels only have no wrapper for Python: for a run's arrays a wrapper is more
    machine code than the arithmetic. Kernels called from Python are compiled with one.
    """

    __wrapped__: Callable[..., Any]
    _made: Any  # Numba's function, for kernels
    _entry: Any  # Numba's function, for Python
    _called: Any  # function that Python calls: of a shared library, else the entry

    def __init__(self, function: Callable[..., Any], options: dict[str, bool]) -> None:
        functools.update_wrapper(self, function)
        self._options = options

    def __call__(self, *arguments: Any) -> Any:
        try:
            return self._called(*arguments)
        except SystemError:  # of machine code, without a reason
            raise_failure()
            raise

    def __getattr__(self, name: str) -> Any:
        # Tools that inspect any object request such names; one of Numba's begins with a single underscore.
        if name.startswith("__"):
            raise AttributeError(name)
        if name not in ("_made", "_entry", "_called"):
            return getattr(self._made, name)
        with _MAKING:
            if name not in vars(self):
                made = (
                    self._shipped() or self._entry if name == "_called" else self._compiled(name == "_entry")
                )
                setattr(self, name, made)
        return vars(self)[name]

    def _compiled(self, entry: bool) -> Any:
        """Return the function as Numba compiles it, for Python or for kernels."""
        _load_numba(self.name)
        from antenna_pin.compiled.jit import dispatcher

        sys.setrecursionlimit(max(sys.getrecursionlimit(), _DEEP))
        compiled = dispatcher(self.__wrapped__, entry=entry, **self._options)
        if not entry:
            kind: Any = type(compiled)
            compiled.__class__ = _for_kernels(kind)
        return compiled

    @property
    def name(self) -> str:
        """Module and name."""
        return f"{self.__wrapped__.__module__}:{self.__wrapped__.__qualname__}"

    def _shipped(self) -> Callable[..., Any] | None:
        from antenna_pin.compiled.shipped_code import shipped

        return shipped(self.name, self._options.get("nogil", False), lambda: self._entry)

    def __reduce__(self) -> str:
        return self.__wrapped__.__qualname__  # pickled by name, like a function


class _DeferredKernel(_LazyKernel):
    """Kernel that other kernels call through a slot."""

    places = 1  # slots of a call

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function, {"cached": True, "alone": True, "forceinline": False})

    def at(self, number: int) -> _DeferredKernel:
        """Return the kernel of a slot."""
        return self

    @functools.cached_property
    def _numba_type_(self) -> Any:
        return _call_type(self)


class _Composed(_LazyKernel):
    """Function that is composed at its first use."""

    def __init__(self, make: Callable[[], _LazyKernel]) -> None:
        self._make = make

    def _compiled(self, entry: bool) -> Any:
        return self._make()._entry if entry else self._make()._made

    def _shipped(self) -> None:
        """Return nothing: it is a part of other kernels only."""


class ByKind:
    """Kernels called by the number of a kind, each compiled at its first call."""

    places = KINDS

    def __init__(self, name: str, like: Callable[..., Any], of_kind: Callable[[int], _Function]) -> None:
        """Make no kernel yet.

        Args:
            name: Module and name of these kernels.
            like: Function that returns what they return, as annotated.
            of_kind: Returns a kernel by the number of the kind, 0 to ``KINDS`` - 1.
        """
        self.name, self.__wrapped__ = name, like
        self.at = functools.cache(of_kind)

    def __call__(self, kind: int, *arguments: Any) -> Any:
        """Call the kernel of a kind; the last one by numbers beyond."""
        return self.at(int(kind) if 0 <= kind < KINDS else KINDS - 1)(*arguments)

    @functools.cached_property
    def _numba_type_(self) -> Any:
        return _call_type(self)


def _call_type(kernel: Any) -> Any:
    from antenna_pin.compiled.slots import call_type

    return call_type(kernel)
