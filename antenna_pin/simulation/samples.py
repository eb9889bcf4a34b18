"""What a run keeps of its states: those at its output times, at events and at the peaks of contacts."""

from __future__ import annotations

import bisect
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

__all__ = ["Samples"]

Array = NDArray[np.float64]


@dataclass(slots=True)
class Samples:
    """States of a run at its output times, with the contacts' memory there."""

    times: list[float] = field(default_factory=list)
    states: list[Array] = field(default_factory=list)
    memories: list[Array] = field(default_factory=list)

    def add(self, t: float, y: Array, memory: Array) -> None:
        """Append one sample, or replace the last where it is the same instant but for round-off.

        An event may fall on an output time; what holds from the event on is what is kept.
        """
        if self.times and t <= self.times[-1]:
            self.states[-1] = y
            self.memories[-1] = memory
            return
        self.times.append(t)
        self.states.append(y)
        self.memories.append(memory)

    def insert(self, t: float, y: Array, memory: Array) -> None:
        """Put a sample between others in time; one that is there already stays."""
        place = bisect.bisect_left(self.times, t)
        if place < len(self.times) and self.times[place] == t:
            return
        self.times.insert(place, t)
        self.states.insert(place, y)
        self.memories.insert(place, memory)
