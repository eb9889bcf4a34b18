"""Trials, one after another or in processes of their own: failures when they occur, counts at the end."""

from __future__ import annotations

import contextlib
import ctypes
import itertools
import multiprocessing
import os
import resource
import signal
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

import psutil

_MEMORY = 8 << 30  # bytes that a process may have
_START = 90.0  # [s] that the first item of a process may take longer, for imports
_WAITING = 20.0  # times as long that an item may last as it may compute: the machine has other work
_DIES_WITH_PARENT = 1  # PR_SET_PDEATHSIG

Content = bytes | str | Callable[[Path], Any]
"""Content of a file, or a function that writes one."""


class TrialError(Exception):
    """Something that must not come of a trial, in words."""


def must(holds: object, problem: str) -> None:
    """Raise a :class:`TrialError` unless something holds."""
    if not holds:
        raise TrialError(problem)


class Report:
    """Trials by kind: how many, how many failed, and the slowest."""

    verbose = False  # whether trials without a fault are printed too

    def __init__(self) -> None:
        """Begin with no trials."""
        self.tried: Counter[str] = Counter()
        self.failed: Counter[str] = Counter()
        self.slowest: dict[str, tuple[float, str]] = {}

    def add(self, kind: str, label: str, problem: str | None, seconds: float = 0.0) -> None:
        """Count a trial, and print its label and problem."""
        self.tried[kind] += 1
        self.failed[kind] += problem is not None
        self.slowest[kind] = max(self.slowest.get(kind, (0.0, "")), (seconds, label))
        if problem is not None or self.verbose:
            print(f"{label}: {problem or 'as it should'}", flush=True)

    @contextlib.contextmanager
    def trial(self, kind: str, label: str) -> Iterator[None]:
        """Count the body of a ``with`` statement as a trial, which a :class:`TrialError` fails."""
        began, problem = time.monotonic(), None
        try:
            yield
        except TrialError as error:
            problem = str(error)
        self.add(kind, label, problem, time.monotonic() - began)

    def each(self, kinds: Iterable[str], count: int, check: Callable[[str], object]) -> None:
        """Make so many trials of each kind, in turn."""
        for number, kind in itertools.product(range(count), kinds):
            with self.trial(kind, f"{kind} {number}"):
                check(kind)

    def close(self) -> int:
        """Print the counts; return 1 if any trial failed, else 0."""
        for kind, count in self.tried.items():
            seconds, label = self.slowest[kind]
            print(f"{kind}: {count} tried, {self.failed[kind]} failed; at most {seconds:.1f} s ({label})")
        print(f"{self.tried.total()} tried, {self.failed.total()} failed")
        return int(self.failed.total() > 0)


# --- files and bytes ---------------------------------------------------------------------------------------


def write_files(folder: Path, files: Mapping[str, Content]) -> None:
    """Write files, by their names in a folder."""
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if callable(content):
            content(path)
        else:
            is_text = isinstance(content, str)
            path.write_bytes(content.encode("utf-8", "surrogatepass") if is_text else content)


def read_files(folder: Path) -> dict[str, bytes]:
    """Return the contents of a folder's files, by their names in it."""
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def flipped(content: bytes, bit: int) -> bytes:
    """Return bytes of which one bit is another."""
    k = bit // 8
    return content[:k] + bytes([content[k] ^ 1 << bit % 8]) + content[k + 1 :]


# --- processes of their own --------------------------------------------------------------------------------


def ends_with(parent: int) -> None:
    """Have the system kill this process when its parent ends, even if that is killed."""
    ctypes.CDLL(None).prctl(_DIES_WITH_PARENT, signal.SIGKILL)
    if os.getppid() != parent:  # which has ended before
        os._exit(70)


def _work(pipe: Connection, parent: int, items: Sequence[Any], act: Callable[[Any], Any], setup: Any) -> None:
    ends_with(parent)
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
    if setup is not None:
        setup()
    with tempfile.TemporaryDirectory(prefix="robust-home-") as home:
        os.environ["HOME"] = home
        for item in items:
            began = _computed(psutil.Process())
            result = act(item)
            pipe.send((result, _computed(psutil.Process()) - began))


def _computed(process: psutil.Process) -> float:
    """Return the CPU time of a process and of those that it has waited for [s]."""
    return float(sum(process.cpu_times()[:4]))


class _Worker:
    """A process that tries items one after the other."""

    def __init__(self, items: Sequence[Any], limit: float, *work: Any) -> None:
        context = multiprocessing.get_context("spawn")
        self.items, self.limit = list(items), limit
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(
            target=_work, args=(theirs, os.getpid(), self.items, *work), daemon=True
        )
        self.process.start()
        theirs.close()
        self._look = psutil.Process(self.process.pid)
        self._mark(_START)

    def _mark(self, more: float = 0.0) -> None:
        """Let the time of an item begin, with more of it [s]."""
        with contextlib.suppress(psutil.NoSuchProcess):
            self._most = _computed(self._look) + self.limit + more
        self._until = time.monotonic() + _WAITING * (self.limit + more)

    def next(self) -> None:
        """Pass on to the next item."""
        self.items = self.items[1:]
        self._mark()

    def stall(self) -> str | None:
        """Return how the item under way takes too long; None if it does not."""
        with contextlib.suppress(psutil.NoSuchProcess):
            if _computed(self._look) > self._most:
                return f"computes for more than {self.limit:g} s"
        if time.monotonic() > self._until:
            return f"does not end within {_WAITING * self.limit:g} s, computing less than {self.limit:g} s"
        return None

    def end(self) -> int | None:
        """End the process and return its exit code."""
        self.process.join(0.5)
        self.process.kill()
        self.process.join()
        return self.process.exitcode


def tried(
    act: Callable[[Any], Any],
    items: Sequence[Any],
    limit: float,
    jobs: int = 1,
    setup: Callable[[], Any] | None = None,
) -> Iterator[tuple[Any, Any, str | None, float]]:
    """Call a function with each item, in processes that others take over from where one ends or hangs.

    Args:
        act: The function, and what it takes and returns, can be pickled.
        items: What it is called with.
        limit: CPU time that each call may take [s]; the first of a process may take more, to import.
        jobs: Processes at a time.
        setup: Called first in each process.

    Yields:
        The item, the result, None or how the process failed, and the CPU time [s].
    """
    workers = [_Worker(part, limit, act, setup) for k in range(jobs) if (part := items[k::jobs])]
    try:
        while workers:
            ready = wait([worker.pipe for worker in workers], timeout=1.0)
            for worker in list(workers):
                fault, result, seconds = None, None, limit
                if worker.pipe in ready:
                    try:
                        result, seconds = worker.pipe.recv()
                    except EOFError:
                        fault = f"the process ended with code {worker.end()}"
                elif not (fault := worker.stall()):
                    continue
                yield worker.items[0], result, fault, seconds
                worker.next()
                if fault or not worker.items:
                    workers.remove(worker)
                    worker.end()
                    workers += [_Worker(worker.items, limit, act, setup)] if worker.items else []
    finally:
        for worker in workers:
            worker.process.kill()
