"""Exclusive use of a session: one thread at a time."""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Concatenate, ParamSpec, TypeVar

from antenna_pin.errors import AntennaPinError

__all__ = ["Exclusive", "InUseError", "exclusive"]

S = TypeVar("S", bound="Exclusive")
P = ParamSpec("P")
R = TypeVar("R")


class InUseError(AntennaPinError, RuntimeError):
    """A session is called by a thread while another works with it."""


class Exclusive:
    """An object with a state that two threads must not work on at once; calls within a thread may nest."""

    def __init__(self) -> None:
        """Begin unused."""
        self._lock = threading.RLock()
        self._user = ""

    @contextmanager
    def used(self, name: str) -> Iterator[None]:
        """Keep other threads out; ``name`` is of the call.

        Raises:
            InUseError: Another thread is in.
        """
        if not self._lock.acquire(blocking=False):
            raise InUseError(
                f"session: must be used by one thread at a time, got {name} of thread "
                f"{threading.current_thread().name!r} during {self._user}; "
                "wait for it, or give each thread a session of its own: copy()"
            )
        before = self._user
        try:
            self._user = f"{name} of thread {threading.current_thread().name!r}"
            yield
        finally:
            self._user = before
            self._lock.release()


def exclusive(method: Callable[Concatenate[S, P], R]) -> Callable[Concatenate[S, P], R]:
    """Refuse a method while another thread is in one of the same object.

    Raises:
        InUseError: Another thread is.
    """

    @functools.wraps(method)
    def alone(self: S, /, *args: P.args, **named: P.kwargs) -> R:
        with self.used(method.__name__.strip("_")):
            return method(self, *args, **named)

    return alone
