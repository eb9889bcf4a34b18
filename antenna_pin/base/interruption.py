"""Ctrl-C and termination signals as flags, for work that must finish.

A script in Python is left its own ways with SIGTERM and SIGHUP, which mostly end it at once. The command line
asks that they count as Ctrl-C does, by :func:`ending_by_signals`: batch queues send the one when the time is
up, terminals the other when they are closed.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from types import FrameType
from typing import Any, NoReturn, TypeVar

from antenna_pin.errors import AntennaPinError

_ENDING = tuple(
    number for name in ("SIGTERM", "SIGHUP") if (number := getattr(signal, name, None)) is not None
)

_Run = TypeVar("_Run", bound=Any)

_SOON = 0.1  # [s] until a signal is sent again
_MUCH_LATER = 30.0  # [s] until one is sent again that nobody has acknowledged: something has caught it
_MOST_DEFERRED = 300
_LATEST = 10.0  # [s] after a signal that an error may be of its making


class Ended(KeyboardInterrupt):
    """SIGTERM or SIGHUP, handled as Ctrl-C."""


class FunctionInterrupted(KeyboardInterrupt):
    """Ctrl-C in a function of the user's, within work that must finish."""


# The signal that stopped or interrupted work last, and when one was last raised as an exception [s].
_last: list[int] = []
_raised: list[float] = []


def ended_by() -> int:
    """Return the signal that came last; SIGINT if none has."""
    return _last[-1] if _last else int(signal.SIGINT)


def is_interruption(error: BaseException) -> bool:
    """Return whether an exception was caused by a signal, after :func:`ending_by_signals`.

    Some libraries make another of it while they are imported: one in C an ImportError, one that puts a
    stand-in for what it could not import whatever comes of using that. Libraries in C that call Python raise
    errors of their own. Where Python has dropped it, as in what compiled code calls back, anything may come
    of that until it comes again.
    """
    if isinstance(error, KeyboardInterrupt) or _dropped:
        return True
    foreign = not isinstance(error, AntennaPinError | OSError)
    if foreign and _raised and time.monotonic() - _raised[0] < _LATEST:
        return True
    above = error.__cause__ or error.__context__
    if not _last:
        return False
    return (
        isinstance(error, ImportError)
        or _while_importing(error)
        or (above is not None and is_interruption(above))
    )


def _while_importing(error: BaseException) -> bool:
    return any(_is_import(frame) for frame, _ in traceback.walk_tb(error.__traceback__))


def _is_import(frame: FrameType) -> bool:
    """Return whether a frame is one of Python's import system."""
    return frame.f_code.co_filename.startswith("<frozen importlib")


def ending_by_signals() -> None:
    """Handle SIGTERM and SIGHUP as Ctrl-C, unless they are ignored (``nohup``)."""
    for number in _ENDING:
        if signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, _end)
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupt)
    if sys.unraisablehook is not _come_again:
        _hook.append(sys.unraisablehook)
        sys.unraisablehook = _come_again


# Signals that came where Python drops exceptions, and have not come again yet.
_dropped: list[int] = []

# What stood in the place of :func:`_come_again`.
_hook: list[Callable[[sys.UnraisableHookArgs], object]] = []


def _come_again(unraisable: sys.UnraisableHookArgs) -> None:
    """Send a signal again whose exception Python has dropped, as in a destructor."""
    if not isinstance(unraisable.exc_value, KeyboardInterrupt):
        _hook[-1](unraisable)
        return
    _send_again(ended_by())
    _dropped[:] = [ended_by()]


def _send_again(number: int, after: float = _SOON) -> None:
    """Send a signal again after a time [s].

    A handler must start no thread, as it may interrupt the start of another; a script may have its own alarm.
    """
    acknowledge()
    _again[:] = [number]
    is_main = threading.current_thread() is threading.main_thread()
    if is_main and signal.getsignal(signal.SIGALRM) in (signal.SIG_DFL, _alarm):
        signal.signal(signal.SIGALRM, _alarm)
        signal.setitimer(signal.ITIMER_REAL, after)
    else:
        timer = threading.Timer(after, _alarm, (signal.SIGALRM, None))
        timer.daemon = True
        timer.start()
        _timers[:] = [timer]


# The signal that is to be sent, and the thread that sends it where the alarm is another's.
_again: list[int] = []
_timers: list[threading.Timer] = []


def _alarm(number: int, frame: FrameType | None) -> None:
    if _again:
        os.kill(os.getpid(), _again.pop())


def acknowledge() -> None:
    """Cancel the signal to be sent again, as its interruption was handled."""
    _again.clear()
    _dropped.clear()
    if signal.getsignal(signal.SIGALRM) is _alarm:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
    for timer in _timers:
        timer.cancel()


def late_signal() -> int | None:
    """Return the signal that is to be sent again; None if there is none."""
    return _again[-1] if _again else None


def _end(number: int, frame: FrameType | None) -> None:
    if not _is_deferred(number, frame):
        _raise(number, Ended)


def _interrupt(number: int, frame: FrameType | None) -> None:
    if not _is_deferred(number, frame):
        _raise(number, KeyboardInterrupt)


def _raise(number: int, error: type[KeyboardInterrupt]) -> NoReturn:
    _come(number)
    _raised[:] = [time.monotonic()]
    _send_again(number, _MUCH_LATER)
    raise error


# Signals deferred one after the other.
_deferred: list[int] = []


def _is_deferred(number: int, frame: FrameType | None) -> bool:
    """Return whether a signal interrupts an import; it is sent again then, for some seconds.

    Some libraries catch every exception of an import, and the signal would be lost.
    """
    while frame is not None and not _is_import(frame):
        frame = frame.f_back
    if frame is None or len(_deferred) > _MOST_DEFERRED:
        _deferred.clear()
        return False
    _deferred.append(number)
    _send_again(number)
    return True


def _come(number: int) -> None:
    acknowledge()
    _last[:] = [number]


@contextmanager
def interruptible() -> Iterator[Callable[[], bool]]:
    """Turn Ctrl-C into a flag that a loop reads between steps.

    An impatient second one changes nothing; a third interrupts at once. One that came after the flag was last
    read comes again at once behind this.
    """
    presses, heard = 0, False
    flag = getattr(_of_thread, "flag", None)

    def is_pressed() -> bool:
        nonlocal heard
        heard = presses > 0
        return heard or (flag is not None and flag.is_set())

    def note(number: int, frame: FrameType | None) -> None:
        nonlocal presses
        presses += 1
        _come(number)
        if presses > 2:
            raise KeyboardInterrupt

    with _handled_by(note):
        yield is_pressed
    if presses and not heard:
        _send_again(ended_by())


# Flag that ends the work of a thread.
_of_thread = threading.local()


@contextmanager
def ended_with(flag: threading.Event) -> Iterator[None]:
    """Let a flag end interruptible work of this thread; signals reach the main thread only."""
    _of_thread.flag = flag
    try:
        yield
    finally:
        del _of_thread.flag


def uninterrupted(run: _Run) -> _Run:
    """Return a run, or raise KeyboardInterrupt if a signal has ended it."""
    if run.outcome.name == "INTERRUPTED":
        raise KeyboardInterrupt
    return run


@contextmanager
def held_back() -> Iterator[list[int]]:
    """Delay the effect of Ctrl-C until work, such as writing a file, is complete.

    Yields:
        Signals that have come; none of them has an effect where the work ends with an exception.
    """
    come: list[int] = []
    with _handled_by(lambda number, frame: come.append(number)):
        yield come
    for number in come[:1]:
        signal.raise_signal(number)


@contextmanager
def sheltered_processes() -> Iterator[None]:
    """Block signals that end processes in the threads and processes started within the context.

    Terminals and batch queues send them to all processes at once; this process ends the others.
    """
    from multiprocessing import resource_tracker

    resource_tracker.ensure_running()  # its start unblocks the signals
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, *_ENDING))
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


@contextmanager
def _handled_by(handler: Callable[[int, FrameType | None], None]) -> Iterator[None]:
    """Handle Ctrl-C, and the command line's signals, unless they are ignored."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    taken = [] if signal.getsignal(signal.SIGINT) in (signal.SIG_IGN, None) else [int(signal.SIGINT)]
    taken += [number for number in _ENDING if _is_ours(number)]
    before = {number: signal.signal(number, handler) for number in taken}
    _handling.append(before)
    try:
        yield
    finally:
        _handling.pop()
        for number, old in before.items():
            signal.signal(number, old)


# What stood before each handler that stands now, the innermost last.
_handling: list[Mapping[int, object]] = []


def _is_ours(number: int) -> bool:
    """Return whether the command line handles a signal, within another handler or not."""
    return signal.getsignal(number) is _end or any(number in before for before in _handling)
