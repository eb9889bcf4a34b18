"""Time of compilation of kernels, excluded from a run's time."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Iterator
from typing import Any

from numba.core import event

__all__ = ["CompileClock", "compiling_so_far", "compiling_timed"]

_KIND = "numba:compile"


class CompileClock(event.Listener):  # type: ignore[misc]
    """Clock of this thread's compilation time, nested compilation counted once.

    What is found compiled on the disk takes none.
    """

    def __init__(self) -> None:
        """Stand at zero."""
        #: Time so far [s].
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

    def on_start(self, _: Any) -> None:
        """Hear that something is to be compiled."""
        if threading.get_ident() == self._thread:
            if self._depth == 0:
                self._began = time.perf_counter()
            self._depth += 1

    def on_end(self, _: Any) -> None:
        """Hear that it is."""
        if threading.get_ident() == self._thread and self._depth:
            self._depth -= 1
            if self._depth == 0:
                self.seconds += time.perf_counter() - self._began


#: Clocks that run, of all threads, the innermost last.
_clocks: list[CompileClock] = []


@contextlib.contextmanager
def compiling_timed() -> Iterator[CompileClock]:
    """Take the time that is spent compiling."""
    clock = CompileClock()
    event.register(_KIND, clock)
    _clocks.append(clock)
    try:
        yield clock
    finally:
        _clocks.remove(clock)
        event.unregister(_KIND, clock)


def compiling_so_far() -> float:
    """Return how long this thread has compiled since its time is taken [s]."""
    here = threading.get_ident()
    return next((clock.seconds for clock in reversed(_clocks) if clock.is_of(here)), 0.0)
