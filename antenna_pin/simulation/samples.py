"""What a run keeps of its states: those at its output times, at events and at the peaks of contacts."""

from __future__ import annotations

import bisect
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Workspace
from antenna_pin.integrate import Stepper

__all__ = ["Samples"]

Array = NDArray[np.float64]


class Samples:
    """States of a run at its output times, with what held there besides.

    Args:
        workspace: Its contact memory and program are kept with a state; the program as it is now.
        rate: Output times a second [Hz].
        begin: From when on states are kept [s].
        end: Until when [s].

    Attributes:
        times: [s].
        states: [q, v, x] at each.
        memories: Contact memory at each, MEMORY, as bytes: to copy an array of records takes 20 times as
            long.
        programs: Program of force elements at each: the same array as long as nothing was changed in it.
        program: That of samples to come.
    """

    def __init__(self, workspace: Workspace, rate: float, begin: float, end: float) -> None:
        """Begin without samples."""
        self._memory = workspace.memory
        self._workspace = workspace
        self.rate = rate
        self.begin = begin
        self._end = end
        self.times: list[float] = []
        self.states: list[Array] = []
        self.memories: list[bytes] = []
        self.programs: list[Array] = []
        self.program = workspace.program.copy()

    def add(self, t: float, y: Array) -> None:
        """Append one sample, or replace the last where it is the same instant but for round-off.

        An event may fall on an output time; what holds from the event on is what is kept.
        """
        self._add(t, y, self._memory.tobytes())

    def _add(self, t: float, y: Array, memory: bytes) -> None:
        if t < self.begin:
            return
        if self.times and t <= self.times[-1]:
            self.states[-1] = y
            self.memories[-1] = memory
            self.programs[-1] = self.program
            return
        self._put(len(self.times), t, y, memory, self.program)

    def during(self, stepper: Stepper) -> None:
        """Append the states at the output times within a trial step that is to be accepted."""
        t, h = stepper.t, stepper.h
        first = math.floor(t * self.rate + 1e-9) + 1
        last = math.floor((t + h) * self.rate + 1e-9)
        times = [k / self.rate for k in range(first, last + 1)]
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

    def extend(self, times: Array, states: Array, memories: NDArray[Any], early: NDArray[np.int64]) -> None:
        """Take over samples that compiled steps have left.

        Args:
            times: (n,) [s].
            states: [q, v, x] of each, (n, size); copied.
            memories: Contact memory at each, MEMORY, (n, contacts).
            early: Whether it is one of an earlier time, to be put between others, (n,).
        """
        for t, state, memory, is_early in zip(times.tolist(), states.copy(), memories, early, strict=True):
            if is_early:
                self.insert(t, state, memory)
            else:
                self._add(t, state, memory.tobytes())

    def _hold(self, t: float, y: Array) -> None:
        """Bring a state of the dense output, which is only nearly there, onto the constraints."""
        if self._workspace.constraints is not None:
            self._workspace.hold(t, y)

    def insert(self, t: float, y: Array, memory: Array) -> None:
        """Put a sample with its contact memory between others in time; one that is there already stays."""
        place = bisect.bisect_left(self.times, t)
        if place < len(self.times) and self.times[place] == t:
            return
        y = y.copy()
        self._hold(t, y)
        # What held at the sample before holds on to the next event.
        program = self.programs[place - 1] if place else self.program
        self._put(place, t, y, memory.tobytes(), program)

    def _put(self, place: int, t: float, y: Array, memory: bytes, program: Array) -> None:
        self.times.insert(place, t)
        self.states.insert(place, y)
        self.memories.insert(place, memory)
        self.programs.insert(place, program)
