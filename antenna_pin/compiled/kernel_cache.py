"""Store of kernels' machine code in files, verified when read, and optional.

Numba trusts its files: a truncated one ends in an error of pickle, one with a flipped bit is executed. Here
every file starts with the digest of the rest and names what it was compiled for; an invalid file counts as
missing, so that the kernel is compiled and written again. The files are pickles, which execute code when
read: a folder that another user may write to (:mod:`antenna_pin.compiled.ownership`) is neither read nor
written.

Of processes that need the same kernel one compiles it, and the others wait.

A kernel called from Python needs a hundred kernels compiled alone (:mod:`antenna_pin.compiled.stand_alone`).
They are read one by one at its first load, and packed into one file for the next process, which links them
for machine code only.
"""

from __future__ import annotations

import contextlib
import functools
import gc
import glob
import hashlib
import io
import itertools
import os
import pickle
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

from antenna_pin.compiled.compile_time import tell_of_compiling
from antenna_pin.compiled.machine_code import Kept, KernelCode, called, kept_of, link
from antenna_pin.compiled.ownership import open_to, stranger_of
from antenna_pin.compiled.slots import declare
from antenna_pin.compiled.stand_alone import (
    all_needs,
    deferred_calls_of,
    kernel_named,
    needs_of,
    noted,
    parts_of,
    symbols_of,
)
from antenna_pin.compiled.target import BASELINE, aim_at_baseline, baseline_runs

#: Modules cleaned by this process, by folder of machine code and name.
_swept: set[tuple[Path, str]] = set()


def pack_of(index: str, key: Any) -> str:
    """Return the path of a function's pack for argument types, by index and key."""
    digest = hashlib.sha256(str(key[0]).encode()).hexdigest()
    return f"{index.removesuffix('.nbi')}.{digest[:16]}.nbp"


def sweep(index: str, read: Callable[[str], Any], stamp: tuple[Any, Any], source: Path) -> None:
    """Delete a folder's machine code of other stamps of a module, and of missing modules.

    Files of the same version of Python only. A process about to read a deleted file finds nothing, and
    compiles. Unreadable files are left: they may belong to others.

    Args:
        index: Path of the index of a function of the module.
        read: Reads an index.
        stamp: Version of Numba and stamp of the module's machine code.
        source: File of the module.
    """
    folder = Path(index).parent
    if (folder, source.stem) in _swept:
        return
    _swept.add((folder, source.stem))
    tag = index.removesuffix(".nbi").rpartition(".")[2]
    # Listed before indexes are read: a file written meanwhile is in its index first.
    found = {
        path
        for kind in ("nbi", "*.nbc", "*.nbp")
        for path in folder.glob(f"*.{tag}.{kind}")
        if _module(path) == source.stem or not source.with_name(f"{_module(path)}.py").exists()
    }
    for path in [path for path in found if path.suffix == ".nbi"]:
        try:
            *own, names = read(str(path))
        except Exception:  # pickle may raise any exception
            found.difference_update(folder.glob(f"{glob.escape(path.stem)}.*"))
            continue
        if tuple(own) == stamp and _module(path) == source.stem:
            packs = (pack_of(str(path), key) for key in names)
            found.difference_update([path, *map(Path, packs), *(folder / name for name in names.values())])
    for path in found:
        with contextlib.suppress(OSError):
            path.unlink()


def _module(path: Path) -> str:
    """Return the name of the module whose machine code a file holds."""
    return path.name.partition(".")[0]


# Longest wait for a process that hangs [s], and time between two checks [s].
_LONGEST, _LOOK = 300.0, 0.02


class Turn:
    """Turn of a kernel in this process."""

    def __init__(self, kernel: str) -> None:
        """Name the kernel."""
        self.kernel = kernel
        # Below 4 GB: some systems cannot lock bytes beyond.
        self._byte = int.from_bytes(hashlib.sha256(kernel.encode()).digest()[:4], "little")
        self._file: int | None = None

    @property
    def is_held(self) -> bool:
        """Return whether this process has the turn."""
        return self._file is not None

    def begin(self, folder: str) -> None:
        """Take the turn to compile the kernel into a folder, after whoever has it."""
        if self.is_held:
            return
        end = time.monotonic() + _LONGEST
        with contextlib.suppress(OSError, AttributeError):  # Windows has no lockf
            file = _file_in(folder)
            while time.monotonic() < end:
                try:
                    _move(file, self._byte)
                    os.lockf(file, os.F_TLOCK, 1)
                except BlockingIOError:
                    time.sleep(_LOOK)
                else:
                    self._file = file
                    break

    def end(self) -> None:
        """Let others have it."""
        file, self._file = self._file, None  # once, whichever thread ends it
        if file is not None:
            with contextlib.suppress(OSError):
                _move(file, self._byte)
                os.lockf(file, os.F_ULOCK, 1)


@lru_cache
def _file_in(folder: str) -> int:
    """Return the open lock file of a folder; closing it releases all turns."""
    return os.open(os.path.join(folder, "kernels.turns"), os.O_RDWR | os.O_CREAT, 0o644)


def _move(file: int, byte: int) -> None:
    os.lseek(file, byte, os.SEEK_SET)


try:
    from numba.core.caching import FunctionCache, IndexDataCacheFile, InTreeCacheLocator, NullCache
except ImportError:  # internal to Numba
    FunctionCache = IndexDataCacheFile = NullCache = object

FORMAT = 9  # of what is kept

_DIGEST = hashlib.sha256().digest_size


class KernelCacheWarning(RuntimeWarning):
    """Compiled kernels cannot be stored, so that every process compiles them anew."""


def keep(dispatcher: Any, stamp: str, entry: bool = False) -> None:
    """Store a compiled function in the first writable folder, under a stamp.

    A function for Python has files of its own beside those of the same function for kernels. The folders are
    NUMBA_CACHE_DIR, the sources' ``__pycache__`` and the user's cache, in this order. If none is writable, a
    :class:`KernelCacheWarning` states this once, when something has been compiled.
    """
    function = getattr(dispatcher, "py_func", None)
    if function is None:  # NUMBA_DISABLE_JIT=1
        return
    cache = dispatcher._cache = _LazyCache(function, stamp, entry)
    compile_or_load = dispatcher.compile

    def compiled(signature: Any) -> Any:
        _nested.depth += 1
        collects = gc.isenabled()
        gc.disable()  # of what Numba makes little is garbage before it is done
        try:
            entry = compile_or_load(signature)
        finally:
            _nested.depth -= 1
            cache.turn.end()
            if collects:
                gc.enable()
        if _nested.depth == 0:
            cache.pack()
        return entry

    dispatcher.compile = compiled


class _Nested(threading.local):
    """Depth of nested loading or compilation, per thread."""

    depth = 0


_nested = _Nested()


class _LazyCache:
    """Cache of a function, opened at the function's first call."""

    def __init__(self, function: Any, stamp: str, entry: bool) -> None:
        self._given = function, stamp, entry
        self.turn = Turn(f"{function.__module__}:{function.__qualname__}")

    @functools.cached_property
    def _opened(self) -> Any:
        try:
            return _KernelCache(*self._given, self.turn)
        except RuntimeError:
            return _NoCache("neither the sources' folder nor the user's cache can be written")
        except (OSError, AttributeError, TypeError) as error:
            return _NoCache(str(error))

    def __getattr__(self, name: str) -> Any:
        return getattr(self._opened, name)


@functools.lru_cache
def _closed(folder: str, owner: int) -> bool:
    """Return whether only trusted users may write to a folder; warn once where others may."""
    found = stranger_of(folder, owner)
    if found:
        _tell(f"{folder} is not safe, for {found}", "remove the others' write permission")
    return not found


class _SealedFiles(IndexDataCacheFile):  # type: ignore[misc]
    """An index and its entries, each with a digest, in a closed folder."""

    def __init__(self, cache_path: str, filename_base: str, stamp: str, owner: int) -> None:
        super().__init__(cache_path, filename_base, stamp)
        self._folder, self._owner = cache_path, owner

    @property
    def closed(self) -> bool:
        """Return whether no other user may write to the folder."""
        return _closed(self._folder, self._owner)

    def save(self, key: Any, data: Any) -> None:
        super().save(key, (key, data))

    def load(self, key: Any) -> Any:
        """Return a valid entry, or None.

        Two processes that compile at the same time may give two entries one name; the key in the entry
        distinguishes them.
        """
        try:
            found = super().load(key)
            return found[1] if found is not None and found[0] == key else None
        except Exception:  # pickle may raise any exception
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

    def read_pack(self, key: Any) -> Any:
        """Return the stored parts that an entry needs.

        Raises:
            Exception: No valid parts are stored.
        """
        return self._read(self._pack_path(key))

    def write_pack(self, key: Any, content: Any) -> None:
        """Keep what an entry needs; OSError where it cannot be."""
        self._write(self._pack_path(key), content)

    def sweep(self, source: Path) -> None:
        """Delete machine code of a module's other stamps beside the index."""
        if self.closed:
            sweep(self._index_path, self._read, (self._version, self._source_stamp), source)

    def _pack_path(self, key: Any) -> str:
        return pack_of(self._index_path, key)

    def _read(self, path: str) -> Any:
        with open(path, "rb") as file:
            if not self.closed or open_to(os.fstat(file.fileno()), self._owner):
                raise ValueError(f"{path}: may be somebody else's")
            raw = file.read()
        content = raw[_DIGEST:]
        if hashlib.sha256(content).digest() != raw[:_DIGEST]:
            raise ValueError(f"{path}: does not hold what was written")
        return _Unpickler(io.BytesIO(content)).load()

    def _write(self, path: str, content: Any) -> None:
        dumped = self._dump(content)
        with self._open_for_write(path) as file:
            file.write(hashlib.sha256(dumped).digest() + dumped)


class _Unpickler(pickle.Unpickler):
    """Reader of stored code that imports no module for its environment alone.

    Numba imports the module of each function whose code it loads; a run's loop has those of all kinds.
    """

    def find_class(self, module: str, name: str) -> Any:
        if (module, name) == ("numba.core.environment", "_rebuild_env"):
            return _environment
        return super().find_class(module, name)


def _environment(module: str, constants: list[Any], name: str) -> Any:
    """Return the environment of a loaded function, without an import of its module."""
    from numba.core import environment

    found = environment.lookup_environment(name)
    if found is None:
        known = sys.modules.get(module)
        found = environment.Environment({"__name__": module} if known is None else vars(known))
        found.consts[:] = constants
        found.env_name = name
        environment.Environment._memo[name] = found
    return found


def remembered(function: Any, contents: str, make: Callable[[], str]) -> str:
    """Return a text derived from files' contents, made once and stored beside machine code."""
    try:
        cache, owner = FunctionCache(function), os.stat(function.__code__.co_filename).st_uid
        files = _SealedFiles(cache._cache_path, "stamp", contents, owner)
    except (RuntimeError, OSError, AttributeError, TypeError):  # nothing can be stored
        return make()
    found = files.load(contents)
    if found is None:
        found = make()
        with contextlib.suppress(OSError):
            cache._impl.locator.ensure_cache_path()
            if files.closed:
                files.save(contents, found)
    return str(found)


def stored_code(source: Path, stamp: str) -> Iterator[Kept]:
    """Yield the stored machine code of a module's kernels, for the family of processors.

    Args:
        source: File of the module.
        stamp: Of the module.
    """
    for index in sorted((source.parent / "__pycache__").glob(f"{source.stem}.*.nbi")):
        files = _SealedFiles(str(index.parent), index.stem, stamp, os.stat(source).st_uid)
        for key in files._load_index():
            kept = files.load(key) if key[1][1:] == (BASELINE, "") else None
            if isinstance(kept, Kept):
                yield kept


class _KernelCache(FunctionCache):  # type: ignore[misc]
    """Cache of a function's machine code."""

    def __init__(self, function: Any, stamp: str, entry: bool, turn: Turn) -> None:
        super().__init__(function)
        self._turn, self._is_entry = turn, entry
        self._source = Path(function.__code__.co_filename)
        base, source = self._impl.filename_base, function.__code__.co_filename
        if "<" not in function.__qualname__:  # a file has at most one function of this name
            base = base.replace(f"-{function.__code__.co_firstlineno}.", ".")
        if entry:
            name, _, tag = base.rpartition(".")
            base = f"{name}.entry.{tag}"
        owner = os.stat(source).st_uid  # The owner of the sources is trusted with their machine code.
        # Beside the sources may be machine code of the installing user, readable for others.
        beside = InTreeCacheLocator(function, source).get_cache_path()
        folders = [self._cache_path, *([beside] if beside != self._cache_path else [])]
        self._all_files = [_SealedFiles(folder, base, stamp, owner) for folder in folders]
        self._cache_file = self._all_files[0]
        self._stamp = stamp
        self._unpacked: Any = None

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return a function's stored code for argument types; None without any."""
        keys = self._keys(sig, target_context.codegen())
        self._unpacked = None
        found = self._stored(keys)
        if found is None:
            self._turn.begin(self._cache_path)
            found = self._stored(keys)  # another process may have created it meanwhile
        if found is not None:
            return self._loaded(*found, target_context)
        tell_of_compiling()
        target_context.refresh()
        return None

    def _keys(self, sig: Any, codegen: Any) -> list[Any]:
        """Return the keys of entries compiled for this processor or its family."""
        aim_at_baseline()
        key = self._index_key(sig, codegen)
        signature, (triple, *target), code = key
        if target == [BASELINE, ""] or not baseline_runs():
            return [key]
        return [key, (signature, (triple, BASELINE, ""), code)]

    def _stored(self, keys: list[Any]) -> tuple[Any, Any] | None:
        for key, files in itertools.product(keys, self._all_files):
            kept = files.load(key)
            if kept is not None:
                return key, kept
        return None

    def _loaded(self, key: Any, stored: Any, target_context: Any) -> Any:
        parts = self._pack(key) if stored.needs and _nested.depth == 1 else ()
        for call in {*stored.deferred, *(call for part in parts for call in part.deferred)}:
            declare(call)
        for part in parts:
            link(target_context, part)
        if not parts:
            for name, arguments in stored.needs:
                kernel_named(name).compile(arguments)
            self._note(key, stored)
        result = called(target_context, stored)
        needs_of(result.library).update(stored.needs)
        deferred_calls_of(result.library).update(stored.deferred)
        return result

    def _note(self, key: Any, stored: Kept) -> None:
        """Record the parts of a pack: of this function, or of its caller."""
        if not self._is_entry:
            noted(self._turn.kernel, stored)
        self._unpacked = key, symbols_of(stored)

    def _pack(self, key: Any) -> tuple[KernelCode, ...]:
        """Return a function's parts in order of dependence; nothing without a pack."""
        for files in self._all_files:
            with contextlib.suppress(Exception):  # pickle may raise any exception
                whose, parts = files.read_pack(key)
                if whose == (self._stamp, str(key)):
                    return tuple(parts)
        return ()

    def pack(self) -> None:
        """Pack a function's parts, read from many files or compiled, into one."""
        (key, needs), self._unpacked = self._unpacked or (None, ()), None
        parts = parts_of(needs)
        if parts and self._cache_file.closed:
            with contextlib.suppress(OSError):  # unpacked kernels are read one by one
                self._cache_file.write_pack(key, ((self._stamp, str(key)), parts))

    def save_overload(self, sig: Any, data: Any) -> None:
        try:
            if self._impl.check_cachable(data):
                self._impl.locator.ensure_cache_path()
                kept = kept_of(*all_needs(data.library), self._impl.reduce(data))
                if self._cache_file.closed and kept is not None:
                    key = self._index_key(sig, data.codegen)
                    self._cache_file.save(key, kept)
                    self._cache_file.sweep(self._source)
                    self._note(key, kept)
        except OSError as error:  # disk full, or no longer writable
            _tell(f"{self._cache_path}: {error.strerror or error}")


class _NoCache(NullCache):  # type: ignore[misc]
    """Cache that stores nothing, and warns of it."""

    def __init__(self, reason: str) -> None:
        self._reason = reason

    def load_overload(self, sig: Any, target_context: Any) -> None:
        tell_of_compiling()

    def save_overload(self, sig: Any, cres: Any) -> None:
        _tell(self._reason)

    def pack(self) -> None:
        """Keep nothing."""


_told: list[str] = []


def _tell(reason: str, way_out: str = "") -> None:
    """Warn, once in a process."""
    if not _told:
        _told.append(reason)
        warnings.warn(
            f"compiled kernels cannot be cached ({reason}), so each process compiles them again, for a "
            f"minute or two; {way_out and f'{way_out}, or '}set NUMBA_CACHE_DIR to a folder of your own "
            "that can be written",
            KernelCacheWarning,
            stacklevel=2,
        )
