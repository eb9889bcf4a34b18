"""What a run keeps of its states: those at its output times, at events and at the peaks of contacts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Workspace
from antenna_pin.integrate import Stepper
from antenna_pin.records import MEMORY

__all__ = ["Samples"]

Array = NDArray[np.float64]

_ROOM = 256


class Samples:
    """States of a run at its output times, with what held there besides.

    Args:
        workspace: Its contact memory and program are kept with a state; the program as it is now.
        rate: Output times a second [Hz].
        chosen: Output times beside those at the rate, ascending [s].
        begin: From when on states are kept [s].
        end: Until when [s].

    Attributes:
        programs: Program of force elements at each: the same array as long as nothing was changed in it.
        program: That of samples to come.
    """

    def __init__(
        self, workspace: Workspace, rate: float, chosen: Sequence[float], begin: float, end: float
    ) -> None:
        """Begin without samples."""
        self._memory = workspace.memory
        self._workspace = workspace
        self.rate = rate
        self.chosen = np.array(chosen, dtype=float)
        self.begin = begin
        self._end = end
        self._count = 0
        self._times = np.zeros(_ROOM)
        self._states = np.zeros((_ROOM, workspace.system.manifold.size))
        # As bytes: to copy an array of records takes 20 times as long.
        self._memories = np.zeros((_ROOM, self._memory.nbytes), np.uint8)
        self.programs: list[Array] = []
        self.program = workspace.program.copy()

    @property
    def times(self) -> Array:
        """(n,) [s]."""
        return self._times[: self._count]

    @property
    def states(self) -> Array:
        """[q, v, x] at each, (n, size)."""
        return self._states[: self._count]

    @property
    def memories(self) -> NDArray[Any]:
        """Contact memory at each, MEMORY, (n, contacts)."""
        contacts = len(self._memory)
        return self._memories[: self._count].reshape(-1).view(MEMORY).reshape(self._count, contacts)

    @property
    def last(self) -> float:
        """Time of the last one [s]; minus infinity without any."""
        return float(self._times[self._count - 1]) if self._count else -math.inf

    def add(self, t: float, y: Array) -> None:
        """Append one sample, or replace the last where it is the same instant but for round-off.

        An event may fall on an output time; what holds from the event on is what is kept.
        """
        if t < self.begin:
            return
        place = self._count - 1 if t <= self.last else self._count
        if place == self._count:
            self._open(place, 1)
            self._times[place] = t
        self._put(place, y, self._memory)

    def during(self, stepper: Stepper) -> None:
        """Append the states at the output times within a trial step that is to be accepted."""
        t, h = stepper.t, stepper.h
        times = self._between(t, t + h)
        if t < self.begin <= t + h and self.begin not in times:
            times.insert(0, self.begin)
        if not times:
            return
        stepper.prepare_dense()
        for moment in times:
            state = np.empty(stepper.manifold.size)
            theta = (moment - t) / h
            if theta >= 1.0:
                state[:] = stepper.y
            else:
                stepper.interpolate(theta, state)
            self._hold(moment, state)
            self.add(min(moment, self._end), state)

    def _between(self, begin: float, end: float) -> list[float]:
        """Return the output times behind one time and up to another [s], as ``accept`` in compiled steps."""
        first = math.floor(begin * self.rate + 1e-9) + 1
        last = math.floor(end * self.rate + 1e-9)
        at_rate = [k / self.rate for k in range(first, last + 1)]
        if not len(self.chosen):
            return at_rate
        # A chosen time that is one at the rate but for round-off counts once, as it was chosen.
        same = 1e-9 / self.rate
        chosen = self.chosen[slice(*np.searchsorted(self.chosen, (begin, end), side="right"))].tolist()
        others = [t for t in at_rate if not any(abs(t - moment) <= same for moment in chosen)]
        return sorted((*chosen, *others))

    def extend(self, times: Array, states: Array, memories: NDArray[Any], early: NDArray[np.int64]) -> None:
        """Take over samples that compiled steps have left.

        Args:
            times: (n,) [s].
            states: [q, v, x] of each, (n, size); copied.
            memories: Contact memory at each, MEMORY, (n, contacts).
            early: Whether it is one of an earlier time, to be put between others, (n,).
        """
        first, stops = 0, [*np.flatnonzero(early).tolist(), len(times)]
        for stop in stops:
            self._append(times[first:stop], states[first:stop], memories[first:stop])
            if stop < len(times):
                self.insert(float(times[stop]), states[stop], memories[stop])
            first = stop + 1

    def _append(self, times: Array, states: Array, memories: NDArray[Any]) -> None:
        """Append samples in the order of time; of those at one instant the last counts."""
        kept = times >= self.begin
        kept[:-1] &= times[1:] > times[:-1]
        times, states, memories = times[kept], states[kept], memories[kept]
        count = len(times)
        if not count:
            return
        place = self._count - 1 if times[0] <= self.last else self._count
        self._open(self._count, count - (self._count - place))
        self._times[place : place + count] = times
        self._states[place : place + count] = states
        self._memories[place : place + count] = memories.view(np.uint8).reshape(count, -1)
        self.programs[place : place + count] = [self.program] * count

    def _hold(self, t: float, y: Array) -> None:
        """Bring a state of the dense output, which is only nearly there, onto the constraints."""
        if self._workspace.constraints is not None:
            self._workspace.hold(t, y)

    def insert(self, t: float, y: Array, memory: NDArray[Any]) -> None:
        """Put a sample with its contact memory between others in time; one that is there already stays."""
        place = int(np.searchsorted(self.times, t))
        if place < self._count and self._times[place] == t:
            return
        # What held at the sample before holds on to the next event.
        program = self.programs[place - 1] if place else self.program
        self._open(place, 1)
        self._times[place] = t
        self._put(place, y, memory)
        self.programs[place] = program
        self._hold(t, self._states[place])

    def _put(self, place: int, y: Array, memory: NDArray[Any]) -> None:
        self._states[place] = y
        self._memories[place] = memory.view(np.uint8)
        self.programs[place] = self.program

    def _open(self, place: int, count: int) -> None:
        """Let there be room for some samples before the one at a place."""
        total = self._count + count
        for name in ("_times", "_states", "_memories"):
            old = getattr(self, name)
            if total > len(old):
                grown = np.zeros((2 * total, *old.shape[1:]), old.dtype)
                grown[: self._count] = old[: self._count]
                setattr(self, name, grown)
                old = grown
            old[place + count : total] = old[place : self._count]
        self.programs[place:place] = [self.program] * count
        self._count = total
