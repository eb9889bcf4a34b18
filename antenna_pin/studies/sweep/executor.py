"""Executors of runs: the protocol, and this process, one run after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, Protocol, TypeVar

__all__ = ["Executor", "Here", "Lost"]


T = TypeVar("T")


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
