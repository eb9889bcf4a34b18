"""Samples of a run: states at output times, events and peaks of contacts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.capacity import check_fits
from antenna_pin.base.records import MEMORY
from antenna_pin.dynamics import System, Workspace

Array = NDArray[np.float64]

# Numbers of a result per number of a state, with copies while it is made; measured on shipped scenarios.
_OF_STATE = 8.0


_ROOM = 256
#: Samples of a run that keeps no quantity of samples: for its balance.
FEW = 64


def check_room(system: System, count: float) -> None:
    """Refuse a number of samples that does not fit into memory."""
    size = system.model.nq + system.model.nv + system.manifold.nx
    check_fits(
        "simulate",
        f"{count:.3g} samples of a state of {size} numbers",
        8.0 * _OF_STATE * size * count,
        "lower the output rate, shorten the run, or have it written as it goes (out=)",
    )


class LateSample(NamedTuple):
    """Sample of an earlier time, to be inserted among samples on the disk."""

    time: float  # time [s]
    state: Array  # state [q, v, x] of the dense output, to be projected once its program is known
    memory: NDArray[Any]  # contact memory, MEMORY, (contacts,)


class Chunk(NamedTuple):
    """Consecutive samples."""

    times: Array  # times, (n,) [s]
    states: Array  # states [q, v, x], (n, size)
    memories: NDArray[Any]  # contact memories, MEMORY, (n, contacts)
    # program of force elements at each: the same array as long as nothing was changed in it
    programs: list[Array]

    def part(self, begin: int | None, end: int | None) -> Chunk:
        """Return a slice of the samples."""
        here = slice(begin, end)
        return Chunk(self.times[here], self.states[here], self.memories[here], self.programs[here])

    @staticmethod
    def joined(chunks: Sequence[Chunk]) -> Chunk:
        """Return chunks as one."""
        if len(chunks) == 1:
            return chunks[0]
        return Chunk(
            np.concatenate([one.times for one in chunks]),
            np.concatenate([one.states for one in chunks]),
            np.concatenate([one.memories for one in chunks]),
            [program for one in chunks for program in one.programs],
        )


class SamplesSnapshot(NamedTuple):
    """Snapshot of the samples of a run."""

    number: int  # number of samples
    inserted: int  # number of inserted samples
    last: Chunk | None  # last sample; None without samples
    program: Array  # program of the next samples
    begin: float  # time from which states are recorded [s]


class Samples:
    """States of a run at its output times, with contact memory and program.

    Args:
        workspace: Workspace of the run; contact memory and program are stored with each state.
        rate: Output times a second [Hz].
        chosen: Further output times, ascending [s].
        begin: Time from which states are recorded [s].
        few: Whether samples at the rate are recorded only, at most ``FEW`` in all, the end besides.

    Attributes:
        programs: Program of force elements at each: the same array as long as nothing was changed in it.
        program: Program of the next samples.
        late: Samples inserted after their neighbours had been written to the disk, in order of insertion.
    """

    def __init__(
        self,
        workspace: Workspace,
        rate: float,
        chosen: Sequence[float],
        begin: float,
        end: float,
        few: bool = False,
    ) -> None:
        """Begin without samples."""
        self._memory = workspace.memory
        self._workspace = workspace
        self.few = few
        self.rate = min(rate, FEW / (end - begin)) if few else rate
        self.chosen = np.array(() if few else chosen, dtype=float)
        self.begin = begin
        self._end = end
        self._count = 0
        self._times = np.zeros(_ROOM)
        self._states = np.zeros((_ROOM, workspace.system.manifold.size))
        # As bytes: to copy an array of records takes 20 times as long.
        self._memories = np.zeros((_ROOM, self._memory.nbytes), np.uint8)
        self.programs: list[Array] = []
        self.program = workspace.program.copy()
        self.late: list[LateSample] = []
        self._handed = -math.inf
        self._before: Array | None = None
        self._inserted: list[int] = []  # places of inserted samples, in order of insertion

    @property
    def times(self) -> Array:
        """Times, (n,) [s]."""
        return self._times[: self._count]

    @property
    def states(self) -> Array:
        """States [q, v, x], (n, size)."""
        return self._states[: self._count]

    @property
    def memories(self) -> NDArray[Any]:
        """Contact memory at each, MEMORY, (n, contacts)."""
        contacts = len(self._memory)
        return self._memories[: self._count].reshape(-1).view(MEMORY).reshape(self._count, contacts)

    @property
    def chunk(self) -> Chunk:
        """Samples in memory."""
        return Chunk(self.times, self.states, self.memories, self.programs)

    @property
    def size(self) -> int:
        """Size of the samples in memory [bytes]."""
        return self._count * (self._states.shape[1] * 8 + self._memories.shape[1] + 16)

    def hand_out(self) -> None:
        """Discard the samples in memory except the last, once they are on the disk."""
        if self._count > 1:
            self._handed, self._before = float(self._times[self._count - 2]), self.programs[-2]
            self.take_up(self.chunk.part(-1, None))

    def take_up(self, chunk: Chunk) -> None:
        """Replace the samples in memory."""
        times, states, memories = (np.array(part) for part in chunk[:3])
        programs = list(chunk.programs)
        self._count = 0
        for name in ("_times", "_states", "_memories"):
            old = getattr(self, name)
            setattr(self, name, np.zeros((_ROOM, *old.shape[1:]), old.dtype))
        self.programs = []
        self._open(0, len(times))
        self._times[: self._count] = times
        self._states[: self._count] = states
        self._memories[: self._count] = memories.view(np.uint8).reshape(self._count, self._memories.shape[1])
        self.programs[:] = programs

    @property
    def handed(self) -> tuple[float, Array] | tuple[None, None]:
        """Time [s] and program of the last sample on the disk."""
        return (None, None) if self._before is None else (self._handed, self._before)

    def go_on_after(self, time: float, program: Array) -> None:
        """Continue after samples on the disk, by time [s] and program of the last."""
        self._handed, self._before = time, program

    @property
    def last(self) -> float:
        """Time of the last sample [s]; minus infinity without any."""
        return float(self._times[self._count - 1]) if self._count else -math.inf

    def add(self, t: float, y: Array) -> None:
        """Append a sample, or replace the last one of the same time but for round-off.

        An event may fall on an output time; the state after the event is recorded.
        """
        if t < self.begin:
            return
        place = self._count - 1 if t <= self.last else self._count
        if place == self._count:
            self._open(place, 1)
            self._times[place] = t
        self._put(place, y, self._memory)

    def finish(self, t: float, y: Array) -> None:
        """Append the last sample, if missing; of a run that ended earlier the only one."""
        if not self._count and self._before is None:
            self.begin = min(self.begin, t)
        if self.last < t:
            self.add(t, y)
        elif self._count:
            self._times[self._count - 1] = t  # an output time that is the end but for round-off

    def extend(self, times: Array, states: Array, memories: NDArray[Any], early: NDArray[np.int64]) -> None:
        """Append samples from a batch of steps.

        Args:
            times: Times, (n,) [s].
            states: [q, v, x] of each, (n, size); copied.
            memories: Contact memories, MEMORY, (n, contacts).
            early: Whether a sample is of an earlier time, to be inserted among others, (n,).
        """
        # Ordered samples first, all at once: inserted ones then find the same neighbours.
        early = early.astype(bool)
        if self.few:
            kept = ~early & (times == np.round(times * self.rate) / self.rate)
            times, states, memories, early = times[kept], states[kept], memories[kept], early[kept]
        own = memories.view(np.uint8).reshape(len(times), self._memories.shape[1])
        self._append(np.flatnonzero(~early), times, states, own)
        if early.any():
            self._insert(times[early], states[early], own[early])

    def _append(
        self, chosen: NDArray[np.intp], times: Array, states: Array, memories: NDArray[np.uint8]
    ) -> None:
        """Append chosen samples, in order of time; of coincident samples the last counts."""
        own = times[chosen]
        kept = own >= self.begin
        kept[:-1] &= own[1:] > own[:-1]
        chosen = chosen[kept]
        count = len(chosen)
        if not count:
            return
        place = self._count - 1 if times[chosen[0]] <= self.last else self._count
        self._open(self._count, count - (self._count - place))
        self._times[place : place + count] = times[chosen]
        self._states[place : place + count] = states[chosen]
        self._memories[place : place + count] = memories[chosen]
        self.programs[place : place + count] = [self.program] * count

    def hold(self, t: float, y: Array, program: Array) -> None:
        """Project a state of the dense output onto the constraints of its program."""
        if self._workspace.constraints is not None:
            self._workspace.hold(t, y, program)

    def insert(self, t: float, y: Array, memory: NDArray[Any]) -> None:
        """Insert a sample with its contact memory by time; an existing sample stays."""
        if self.few:
            return
        self._insert(np.array([t]), y[np.newaxis], memory.view(np.uint8).reshape(1, -1))

    def _insert(self, times: Array, states: Array, memories: NDArray[np.uint8]) -> None:
        """Insert samples by their times, which differ from each other or are dropped."""
        for k in np.flatnonzero(times <= self._handed).tolist():
            self.late.append(LateSample(float(times[k]), states[k].copy(), memories[k].copy().view(MEMORY)))
        distinct, order = np.unique(times, return_index=True)
        behind = np.searchsorted(self.times, distinct)
        there = self.times[np.minimum(behind, self._count - 1)] == distinct if self._count else False
        new = (distinct > self._handed) & ~np.asarray(there)
        order, behind = order[new], behind[new]
        if not len(order):
            return
        places = behind + np.arange(len(order))
        first, old = int(places[0]), self._count
        self._open(old, len(order))
        moved = np.ones(self._count - first, bool)
        moved[places - first] = False
        for array, inserted in ((self._times, times), (self._states, states), (self._memories, memories)):
            tail = array[first:old].copy()
            array[first : self._count][moved] = tail
            array[places] = inserted[order]
        # The program of the previous sample is valid up to the next event.
        before = self.program if self._before is None else self._before
        del self.programs[old:]
        for place in places.tolist():
            program = self.programs[place - 1] if place else before
            self.programs.insert(place, program)
            self._inserted.append(place)
            self.hold(float(self._times[place]), self._states[place], program)

    # --- snapshots ------------------------------------------------------------------------------------------

    def snapshot(self) -> SamplesSnapshot:
        """Return a snapshot of the samples, to be restored later."""
        last = self.chunk.part(-1, None) if self._count else None
        if last is not None:
            last = Chunk(last.times.copy(), last.states.copy(), last.memories.copy(), list(last.programs))
        return SamplesSnapshot(self._count, len(self._inserted), last, self.program, self.begin)

    def leave(self) -> None:
        """Copy the arrays, so that later samples do not change a result made of them."""
        for name in ("_times", "_states", "_memories"):
            setattr(self, name, getattr(self, name).copy())

    def restore(self, snapshot: SamplesSnapshot) -> None:
        """Restore the samples of a snapshot."""
        for place in reversed(self._inserted[snapshot.inserted :]):
            for array in (self._times, self._states, self._memories):
                array[place : self._count - 1] = array[place + 1 : self._count]
            del self.programs[place]
            self._count -= 1
        del self._inserted[snapshot.inserted :], self.programs[snapshot.number :]
        self._count, self.program, self.begin = snapshot.number, snapshot.program, snapshot.begin
        if snapshot.last is not None:
            place = snapshot.number - 1
            self._times[place], self._states[place] = snapshot.last.times[0], snapshot.last.states[0]
            self._memories[place] = snapshot.last.memories.view(np.uint8).reshape(-1)
            self.programs[place] = snapshot.last.programs[0]

    def forget_before(self, t: float) -> float:
        """Discard samples not needed from a time on [s]; return the first time left.

        Earlier snapshots become invalid.
        """
        first = max(int(np.searchsorted(self.times, t, side="right")) - 1, 0)
        self.take_up(self.chunk.part(first, None))
        self._inserted.clear()
        self.begin = float(self._times[0])
        return self.begin

    def _put(self, place: int, y: Array, memory: NDArray[Any]) -> None:
        self._states[place] = y
        self._memories[place] = memory.view(np.uint8)
        self.programs[place] = self.program

    def _open(self, place: int, count: int) -> None:
        """Make room for some samples at a place."""
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
