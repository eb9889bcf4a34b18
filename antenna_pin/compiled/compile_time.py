"""Time of compilation of kernels, excluded from a run's time, and listeners to its beginning."""

from __future__ import annotations

import contextlib
import sys
import threading
import time
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

#: Forecast of the compile time of a first run on a machine, as text, on one or two cores.
COMPILE_TIME = "about a minute"


class CompileClock:
    """Clock of this thread's compilation time, nested compilation counted once.

    Code loaded from the cache takes none.
    """

    def __init__(self) -> None:
        """Stand at zero."""
        #: Compilation time so far [s].
        self.seconds = 0.0
        self._thread = threading.get_ident()
        self._depth, self._began = 0, 0.0

    def is_of(self, thread: int) -> bool:
        """Return whether it takes the time of a thread."""
        return self._thread == thread

    @property
    def is_compiling(self) -> bool:
        """Return whether the thread is compiling at present."""
        return self._depth > 0

    def begin(self) -> None:
        """Start, or go one deeper, in the thread whose time it takes."""
        if threading.get_ident() == self._thread:
            if self._depth == 0:
                self._began = time.perf_counter()
            self._depth += 1

    def end(self) -> None:
        """Stop, or come back from one deeper, in the thread whose time it takes."""
        if threading.get_ident() == self._thread and self._depth:
            self._depth -= 1
            if self._depth == 0:
                self.seconds += time.perf_counter() - self._began


#: Running clocks of all threads, the innermost last.
_clocks: list[CompileClock] = []


@contextlib.contextmanager
def compiling_timed() -> Iterator[CompileClock]:
    """Take the time that is spent compiling."""
    clock = CompileClock()
    if "numba" in sys.modules:
        clock_numba()
    _clocks.append(clock)
    try:
        yield clock
    finally:
        _clocks.remove(clock)


@cache
def clock_numba() -> None:
    """Register the clocks with Numba, once it is loaded."""
    from numba.core import event

    class Listener(event.Listener):  # type: ignore[misc]
        def on_start(self, _: Any) -> None:
            for clock in tuple(_clocks):
                clock.begin()

        def on_end(self, _: Any) -> None:
            for clock in tuple(_clocks):
                clock.end()

    event.register("numba:compile", Listener())


def compiling_so_far() -> float:
    """Return how long this thread has compiled since its time is taken [s]."""
    here = threading.get_ident()
    return next((clock.seconds for clock in reversed(_clocks) if clock.is_of(here)), 0.0)


_listeners: list[Callable[[], None]] = []


@contextlib.contextmanager
def told_of_compiling(listener: Callable[[], None]) -> Iterator[None]:
    """Call a function before each compilation of a kernel that is not stored."""
    _listeners.append(listener)
    try:
        yield
    finally:
        _listeners.remove(listener)


def tell_of_compiling() -> None:
    """Call the listeners."""
    for listener in _listeners:
        listener()
