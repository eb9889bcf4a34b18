"""How far a run is."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from antenna_pin.base.state import State

__all__ = ["Foreseeing", "Keeping", "Progress", "Reporter"]

_INTERVAL = 0.1  # [s] of wall time between reports


@dataclass(frozen=True, slots=True)
class Progress:
    """Where a run is.

    Attributes:
        time: Simulated so far [s].
        end: To be simulated [s].
        step: Size of the last step [s].
        steps: Steps accepted.
        wall: Wall time so far [s].
    """

    time: float
    end: float
    step: float
    steps: int
    wall: float


class Keeping(Protocol):
    """What keeps a run's record, and so much of it that it can be taken up."""

    def look(self, run: Any) -> None:
        """See a run between two steps."""

    def end(self, run: Any) -> None:
        """See it after its last step, before its record is completed."""


class Foreseeing(Protocol):
    """What is told of things to come in a run, before it comes to them."""

    def step(self) -> None:
        """Hear that a step is made, and more are to come."""

    def end(self) -> State:
        """Hear that the next step is the first that the run's end cuts; return the state there."""

    def events(self, ahead: Sequence[Sequence[Any]]) -> None:
        """Hear which events are in the step that was tried: as they come, those at one instant together."""


class Reporter:
    """Tells of a run's progress now and then.

    Args:
        progress: Whom; None for nobody.
        end: Of the run [s].
        before: Wall time that it took already [s].
    """

    def __init__(self, progress: Callable[[Progress], None] | None, end: float, before: float = 0.0) -> None:
        """Begin to take the time."""
        self._progress = progress
        self._end = end
        self._told = time.perf_counter()
        self._began = self._told - before

    @property
    def wall(self) -> float:
        """Wall time since the beginning [s]."""
        return time.perf_counter() - self._began

    def __call__(self, t: float, h: float, accepted: int, *, last: bool = False) -> None:
        """Tell that the run is at t [s], with steps of h [s] and so many made, if it is time to."""
        if self._progress is None:
            return
        now = time.perf_counter()
        if last or now - self._told > _INTERVAL:
            self._told = now
            self._progress(Progress(t, self._end, h, accepted, now - self._began))
