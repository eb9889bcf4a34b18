"""Independent pieces of work in processes of their own, where cores are free.

The processes are forked: they have what this one has in memory, without loading or copying it, and what
they make comes back through a pipe. They write no files. So one that is killed leaves nothing behind, and
its piece is made here instead, as is one that an exception ended: it is raised where it would be without
processes.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Generator, Sequence
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Generic, TypeVar

from antenna_pin.base.capacity import cores, free_memory

#: Pieces per process that pay for starting it.
_WORTH = 2

T = TypeVar("T")
R = TypeVar("R")


def cores_for(memory: float) -> int:
    """Return the number of processes for which free cores and memory [bytes] suffice."""
    free = free_memory()
    return max(1, cores() if free is None else min(cores(), int(free / memory)))


def side_by_side(work: Callable[[T], R], pieces: Sequence[T], processes: int = 1) -> Generator[R, None, None]:
    """Yield what is made of each piece, in their order.

    Args:
        work: Makes it. What it returns must be picklable; what it changes elsewhere is lost.
        pieces: What it is given.
        processes: How many at most; with one, or few pieces, all is made in this process. Others must be no
            threads of which one may hold a lock that the work needs: processes are forked.
    """
    count = min(processes, len(pieces) // _WORTH)
    if count < 2 or sys.platform != "linux" or multiprocessing.current_process().daemon:
        yield from map(work, pieces)
        return
    with contextlib.closing(_Pool(work, pieces, count)) as pool:
        for number, piece in enumerate(pieces):
            made = pool.result_of(number)
            yield work(piece) if made is None else made[0]


def end_with_parent() -> None:
    """End this process when its parent has ended, even if that was killed."""
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


class _Pool(Generic[T, R]):
    """Processes that make the pieces, the next one as soon as they have made one."""

    def __init__(self, work: Callable[[T], R], pieces: Sequence[T], count: int) -> None:
        self._left = iter(range(len(pieces)))
        self._made: dict[int, tuple[R]] = {}
        self._at_work: dict[Connection, int] = {}  # by pipe, the number of the piece
        self._processes: dict[Connection, BaseProcess] = {}
        try:
            for _ in range(count):
                self._start(work, pieces)
        except OSError:  # no more processes, files or memory: those that are there will do
            pass
        except BaseException:
            self.close()
            raise

    def result_of(self, number: int) -> tuple[R] | None:
        """Return what was made of a piece; None if its process has not made it."""
        while number not in self._made and number in self._at_work.values():
            for pipe in wait(list(self._at_work)):
                self._take(pipe)  # type: ignore[arg-type]
        return self._made.pop(number, None)

    def close(self) -> None:
        """End the processes, at work or not."""
        for process in self._processes.values():
            process.kill()
        for pipe, process in self._processes.items():
            process.join()
            pipe.close()

    def _start(self, work: Callable[[T], R], pieces: Sequence[T]) -> None:
        ours, theirs = multiprocessing.Pipe()
        fork = multiprocessing.get_context("fork").Process
        process = fork(target=_serve, args=(theirs, [*self._processes, ours], work, pieces), daemon=True)
        with warnings.catch_warnings():
            # Threads of a library that does sums wait while none are asked for, and it knows of forks.
            warnings.simplefilter("ignore", DeprecationWarning)
            process.start()
        theirs.close()
        self._processes[ours] = process
        self._give(ours)

    def _give(self, pipe: Connection) -> None:
        number = next(self._left, None)
        if number is not None:
            self._at_work[pipe] = number
            with contextlib.suppress(OSError):  # it is dead: told when its answer is waited for
                pipe.send(number)

    def _take(self, pipe: Connection) -> None:
        number = self._at_work.pop(pipe)
        try:
            made, told = pipe.recv()
        except (EOFError, OSError):  # killed, for want of memory perhaps
            return
        for one in told:
            warnings.warn_explicit(*one)
        if made is not None:
            self._made[number] = made
        self._give(pipe)


def _serve(
    pipe: Connection, others: Sequence[Connection], work: Callable[[T], R], pieces: Sequence[T]
) -> None:
    """Make the pieces whose numbers come through a pipe, until its other end is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C comes to all of a terminal's; who waits acts on it
    for number in (signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, signal.SIG_DFL)
    for one in others:  # held open here, they would keep this process alive after the one it works for
        one.close()
    with contextlib.suppress(EOFError, OSError):
        while True:
            piece = pieces[pipe.recv()]
            with warnings.catch_warnings(record=True) as told:
                try:
                    made = (work(piece),)
                except Exception:
                    made = None
            pipe.send((made, [(one.message, one.category, one.filename, one.lineno) for one in told]))
