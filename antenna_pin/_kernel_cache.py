"""Machine code of kernels kept in files: checked when it is read, and done without where it cannot be kept.

Numba trusts its files: one that was cut off ends in an error of pickle, one with a flipped bit is called.
Here every file starts with the digest of the rest and names what it was compiled for; one that does not hold
counts as not there, so that it is compiled and written anew. They are pickles, which run code as they are
read: a folder that somebody else may write (:mod:`antenna_pin._ownership`) is neither read nor written.

Numba also puts all that a function calls into it and optimises it there once more, so that what is called
from ten places is compiled ten times over. Here a kernel stands alone (:func:`stand_alone`): its callers know
its name, and find it when they are loaded.
"""

from __future__ import annotations

import contextlib
import copy
import functools
import hashlib
import importlib
import os
import pickle
import warnings
from collections.abc import Callable, Iterator
from typing import Any

from llvmlite.binding import add_symbol

from antenna_pin._machine_code import called, kept_of
from antenna_pin._ownership import open_to, stranger_of
from antenna_pin._turns import Turn

try:
    from numba.core.base import OverloadSelector
    from numba.core.caching import FunctionCache, IndexDataCacheFile, InTreeCacheLocator, NullCache
    from numba.core.imputils import user_function
except ImportError:  # none of it is promised by Numba
    FunctionCache = IndexDataCacheFile = NullCache = object

__all__ = ["FORMAT", "KernelCacheWarning", "keep", "stand_alone", "told_of_compiling"]

FORMAT = 3  # of what is kept

_DIGEST = hashlib.sha256().digest_size


class KernelCacheWarning(RuntimeWarning):
    """Compiled kernels cannot be kept, so that every process compiles them anew."""


def keep(dispatcher: Any, stamp: str) -> None:
    """Let a compiled function be kept in the first folder that can be written, tied to a stamp.

    These are NUMBA_CACHE_DIR, the sources' ``__pycache__`` and the user's cache, in this order. If there is
    none, a :class:`KernelCacheWarning` says so once, when something has been compiled.
    """
    function = getattr(dispatcher, "py_func", None)
    if function is None:  # NUMBA_DISABLE_JIT=1
        return
    cache = dispatcher._cache = _Later(function, stamp)
    compile_or_load = dispatcher.compile

    def compiled(signature: Any) -> Any:
        try:
            return compile_or_load(signature)
        finally:
            cache.turn.end()

    dispatcher.compile = compiled


class _Later:
    """What is kept of a function, looked for when it is first called: of many a process calls none."""

    def __init__(self, function: Any, stamp: str) -> None:
        self._given = function, stamp
        self.turn = Turn(f"{function.__module__}:{function.__qualname__}")

    @functools.cached_property
    def _found(self) -> Any:
        try:
            return _KernelCache(*self._given, self.turn)
        except RuntimeError:
            return _NoCache("neither the sources' folder nor the user's cache can be written")
        except (OSError, AttributeError, TypeError) as error:
            return _NoCache(str(error))

    def __getattr__(self, name: str) -> Any:
        return getattr(self._found, name)


_listeners: list[Callable[[], None]] = []


@contextlib.contextmanager
def told_of_compiling(listener: Callable[[], None]) -> Iterator[None]:
    """Call a function whenever a kernel is about to be compiled, because no file holds it."""
    _listeners.append(listener)
    try:
        yield
    finally:
        _listeners.remove(listener)


def _to_be_compiled() -> None:
    for listener in _listeners:
        listener()


def stand_alone(dispatcher: Any) -> None:
    """Let callers of a compiled function call it by name instead of holding its code.

    What they need is kept with their machine code, and loaded or compiled before that is. Where Numba has
    changed inside, they hold it, as Numba has it.
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


def _named(name: str) -> Any:
    """Return a kernel that stands alone, by its module and name."""
    module, _, own = name.partition(":")
    return getattr(importlib.import_module(module), own)


def _publish(name: str, context: Any, result: Any) -> None:
    """Give a compiled function a name that holds in every process, and let it be called by that."""
    arguments = tuple(result.signature.args)
    symbol = f"{name}:{hashlib.sha256(str(arguments).encode()).hexdigest()}"
    add_symbol(symbol, result.library.get_pointer_to_function(result.fndesc.llvm_func_name))
    alias = copy.copy(result.fndesc)
    alias.mangled_name = symbol
    call = user_function(alias, ())

    def noted(context: Any, *rest: Any, **more: Any) -> Any:
        _needs_of(context.active_code_library).add((name, arguments))
        return call(context, *rest, **more)

    vars(noted).update(vars(call))
    overloads = OverloadSelector()
    overloads.append(noted, call.signature)
    context._defns[result.entry_point] = overloads


def _needs_of(library: Any) -> set[Any]:
    """Return the set of what machine code calls by name: kernels, each with the types of its arguments."""
    if "needs" not in vars(library):
        library.needs = set()
    needs: set[Any] = library.needs
    return needs


def _all_needs(library: Any) -> set[Any]:
    needs, seen, left = set(), set(), [library]
    while left:
        one = left.pop()
        if id(one) not in seen:
            seen.add(id(one))
            needs |= _needs_of(one)
            left += getattr(one, "_linking_libraries", [])
    return needs


@functools.lru_cache
def _closed(folder: str, owner: int) -> bool:
    """Whether only those who are trusted may write to a folder; says so, once, where others may."""
    found = stranger_of(folder, owner)
    if found:
        _tell(f"{folder} is not safe, for {found}", "keep others from writing there")
    return not found


class _SealedFiles(IndexDataCacheFile):  # type: ignore[misc]
    """An index and its entries, each behind its digest, in a folder that is nobody else's."""

    def __init__(self, cache_path: str, filename_base: str, stamp: str, owner: int) -> None:
        super().__init__(cache_path, filename_base, stamp)
        self._folder, self._owner = cache_path, owner

    @property
    def closed(self) -> bool:
        """Whether nobody else may write there."""
        return _closed(self._folder, self._owner)

    def save(self, key: Any, data: Any) -> None:
        super().save(key, (key, data))

    def load(self, key: Any) -> Any:
        """Return an entry, or None if there is none that holds.

        Two processes that compile at once may give two entries one name; the key in it tells them apart.
        """
        try:
            found = super().load(key)
            return found[1] if found is not None and found[0] == key else None
        except Exception:  # pickle promises no certain ones
            return None

    def _load_index(self) -> Any:
        try:
            version, stamp, names = self._read(self._index_path)
        except Exception:
            return {}
        return names if (version, stamp) == (self._version, self._source_stamp) else {}

    def _save_index(self, overloads: Any) -> None:
        self._write(self._index_path, (self._version, self._source_stamp, overloads))

    def _load_data(self, name: str) -> Any:
        return self._read(self._data_path(name))

    def _save_data(self, name: str, data: Any) -> None:
        self._write(self._data_path(name), data)

    def _read(self, path: str) -> Any:
        with open(path, "rb") as file:
            if not self.closed or open_to(os.fstat(file.fileno()), self._owner):
                raise ValueError(f"{path}: may be somebody else's")
            raw = file.read()
        content = raw[_DIGEST:]
        if hashlib.sha256(content).digest() != raw[:_DIGEST]:
            raise ValueError(f"{path}: does not hold what was written")
        return pickle.loads(content)  # noqa: S301 - as Numba does

    def _write(self, path: str, content: Any) -> None:
        dumped = self._dump(content)
        with self._open_for_write(path) as file:
            file.write(hashlib.sha256(dumped).digest() + dumped)


class _KernelCache(FunctionCache):  # type: ignore[misc]
    """What is kept of one function."""

    def __init__(self, function: Any, stamp: str, turn: Turn) -> None:
        super().__init__(function)
        self._turn = turn
        base, source = self._impl.filename_base, function.__code__.co_filename
        owner = os.stat(source).st_uid  # who is trusted with the sources is with what they are compiled to
        self._cache_file = _SealedFiles(self._cache_path, base, stamp, owner)
        # Beside the sources may stand what who installed them has compiled, for others to read.
        beside = InTreeCacheLocator(function, source).get_cache_path()
        self._beside = None if beside == self._cache_path else _SealedFiles(beside, base, stamp, owner)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return what is kept of a function for arguments of certain types, None if nothing is."""
        key = self._index_key(sig, target_context.codegen())
        kept = self._kept(key)
        if kept is None:
            self._turn.begin(self._cache_path)
            kept = self._kept(key)  # another process may have made it by now
        if kept is not None:
            return self._loaded(kept, target_context)
        _to_be_compiled()
        target_context.refresh()
        return None

    def _kept(self, key: Any) -> Any:
        for files in (self._cache_file, self._beside):
            kept = None if files is None else files.load(key)
            if kept is not None:
                return kept
        return None

    def _loaded(self, kept: Any, target_context: Any) -> Any:
        for name, arguments in kept.needs:
            _named(name).compile(arguments)
        result = called(target_context, kept)
        _needs_of(result.library).update(kept.needs)
        return result

    def save_overload(self, sig: Any, data: Any) -> None:
        try:
            if self._impl.check_cachable(data):
                self._impl.locator.ensure_cache_path()
                kept = kept_of(_all_needs(data.library), self._impl.reduce(data))
                if self._cache_file.closed and kept is not None:
                    self._cache_file.save(self._index_key(sig, data.codegen), kept)
        except OSError as error:  # full, or no longer to be written
            _tell(f"{self._cache_path}: {error.strerror or error}")


class _NoCache(NullCache):  # type: ignore[misc]
    """Keeps nothing, and says so when there would be something to keep."""

    def __init__(self, reason: str) -> None:
        self._reason = reason

    def load_overload(self, sig: Any, target_context: Any) -> None:
        _to_be_compiled()

    def save_overload(self, sig: Any, cres: Any) -> None:
        _tell(self._reason)


_told: list[str] = []


def _tell(reason: str, way_out: str = "") -> None:
    """Warn, once in a process."""
    if not _told:
        _told.append(reason)
        warnings.warn(
            f"compiled kernels cannot be kept ({reason}), so that each process compiles them anew, for a "
            f"minute or two; {way_out and f'{way_out}, or '}set NUMBA_CACHE_DIR to a folder of your own "
            "that can be written",
            KernelCacheWarning,
            stacklevel=2,
        )
