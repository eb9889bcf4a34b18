"""Runs made in this process, one after the other: what needs no cluster."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, Protocol, TypeVar

__all__ = ["Executor", "Here", "Lost"]

T = TypeVar("T")


class Lost(Exception):  # noqa: N818 - an answer, not an error
    """Failure of runs that repeatedly ended their process, or could not be returned."""


class Executor(Protocol):
    """Protocol of executors of runs."""

    def start(self) -> None:
        """Get ready; called before anything is given out, and not where nothing will be."""

    @property
    def width(self) -> int:
        """Number of runs at a time."""

    def each(
        self, call: Callable[[Any, list[T]], Any], shared: Any, batches: Iterator[list[T]]
    ) -> Iterator[tuple[list[T], Any]]:
        """Yield each batch with ``call(shared, batch)``, or with :class:`Lost`, as they come."""

    def close(self) -> None:
        """Let go of all."""


class Here:
    """This process."""

    width = 1

    def start(self) -> None:
        """Return True: the executor is always available."""

    def each(
        self, call: Callable[[Any, list[T]], Any], shared: Any, batches: Iterator[list[T]]
    ) -> Iterator[tuple[list[T], Any]]:
        """Yield each batch with its answer."""
        for batch in batches:
            yield batch, call(shared, batch)

    def close(self) -> None:
        """Nothing is to be let go of."""
