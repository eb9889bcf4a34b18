"""Executors of runs: the protocol, and this process, on one thread or on several."""

from __future__ import annotations

import contextlib
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from typing import Any, Protocol, TypeVar

from antenna_pin.base.capacity import cores
from antenna_pin.base.interruption import ended_with
from antenna_pin.errors import InvalidParameterError

T = TypeVar("T")

#: Time after which a thread passes the interpreter's lock on [s]: a thread back from its loop would wait 5 ms
#: for the record of another's run.
SWITCH_INTERVAL = 5e-4
# Intervals before studies in threads that are under way, the oldest first.
_intervals: list[float] = []
_studies = threading.Lock()


@contextlib.contextmanager
def _short_switch_interval() -> Iterator[None]:
    """Have threads pass the lock on soon until the last study ends."""
    with _studies:
        _intervals.append(_intervals[0] if _intervals else sys.getswitchinterval())
        sys.setswitchinterval(min(_intervals[0], SWITCH_INTERVAL))
    try:
        yield
    finally:
        with _studies:
            before = _intervals.pop()
            if not _intervals:
                sys.setswitchinterval(before)


class Lost(Exception):  # noqa: N818 - an answer, not an error
    """A batch whose process died several times, or whose answer was lost."""


class Executor(Protocol):
    """Executor of runs."""

    def start(self) -> None:
        """Get ready; called before the first batch, if there is one."""

    @property
    def width(self) -> int:
        """Number of runs at a time."""

    def each(
        self, call: Callable[[Any, list[T]], Any], shared: Any, batches: Iterator[list[T]]
    ) -> Iterator[tuple[list[T], Any]]:
        """Yield each batch with ``call(shared, batch)`` or :class:`Lost`, in order of completion."""

    def close(self) -> None:
        """Release all resources."""


class Here:
    """Executor in this process."""

    width = 1

    def start(self) -> None:
        """Do nothing."""

    def each(
        self, call: Callable[[Any, list[T]], Any], shared: Any, batches: Iterator[list[T]]
    ) -> Iterator[tuple[list[T], Any]]:
        """Yield each batch with its answer."""
        for batch in batches:
            yield batch, call(shared, batch)

    def close(self) -> None:
        """Do nothing."""


class Threads:
    """Executor of studies in threads of this process.

    Compiled loops run without the interpreter's lock, as do those that call Pinocchio and coal through the
    shim to their machine code; the rest of a run holds it. Nothing is started, copied or sent, so short
    studies gain most. A run that crashes ends the process.

    Args:
        threads: Number of threads; one for each core by default.
    """

    def __init__(self, threads: int | None = None) -> None:
        if not (threads is None or threads > 0):
            raise InvalidParameterError("Threads", "threads", "positive", threads)
        self.width = threads or cores()

    def start(self) -> None:
        """Do nothing."""

    def each(
        self, call: Callable[[Any, list[T]], Any], shared: Any, batches: Iterator[list[T]]
    ) -> Iterator[tuple[list[T], Any]]:
        """Yield each batch with its answer, in order of completion."""
        stop = threading.Event()

        def answer(batch: list[T]) -> Any:
            with ended_with(stop):
                return call(shared, batch)

        under_way: dict[Future[Any], list[T]] = {}
        pool = ThreadPoolExecutor(self.width)
        with _short_switch_interval():
            try:
                while True:
                    while len(under_way) < self.width and (batch := next(batches, None)) is not None:
                        under_way[pool.submit(answer, batch)] = batch
                    if not under_way:
                        return
                    for future in wait(under_way, return_when=FIRST_COMPLETED).done:
                        yield under_way.pop(future), future.result()
            finally:  # after Ctrl-C in this thread as well: runs under way end as interrupted
                stop.set()
                pool.shutdown(cancel_futures=True)

    def close(self) -> None:
        """Do nothing."""
