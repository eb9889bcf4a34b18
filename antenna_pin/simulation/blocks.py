"""The samples of a run in the order of time, block by block: from parts on the disk, and from memory."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from antenna_pin.simulation.parts import Parts
from antenna_pin.simulation.samples import Chunk, Late, Samples

__all__ = ["BLOCK", "blocks_of", "count_of"]

#: Samples of a block: few enough that all which they imply takes little room. Blocks are the same ones
#: however a record is spread over disk and memory, or round-off might tell.
BLOCK = 8192


def _chunks(samples: Samples, parts: Parts | None) -> Iterator[Chunk]:
    if parts is not None:
        yield from map(parts.read, range(len(parts.rows)))
    yield samples.held


def _with_late(chunk: Chunk, late: Sequence[Late], samples: Samples) -> Chunk:
    """Return a chunk with late samples at their places; where there is one of their time that one stays."""
    there = set(chunk.times[np.searchsorted(chunk.times, [one.time for one in late])].tolist())
    new = [one for one in late if one.time not in there]
    if not new:
        return chunk
    places = np.searchsorted(chunk.times, [one.time for one in new])
    programs = list(chunk.programs)
    # What held at the sample before holds on to the next event.
    states = [one.state.copy() for one in new]
    for place, one, state in zip(places.tolist(), new, states, strict=True):
        samples.hold(one.time, state, programs[max(place - 1, 0)])
    for place, _ in sorted(zip(places.tolist(), new, strict=True), key=lambda one: -one[0]):
        programs.insert(place, programs[max(place - 1, 0)])
    return Chunk(
        np.insert(chunk.times, places, [one.time for one in new]),
        np.insert(chunk.states, places, states, axis=0),
        np.insert(chunk.memories, places, np.array([one.memory for one in new]), axis=0),
        programs,
    )


def _merged(samples: Samples, parts: Parts | None) -> Iterator[Chunk]:
    first = {one.time: one for one in reversed(samples.late)}  # of those of one time the first
    late = [first[time] for time in sorted(first)]
    before: Chunk | None = None
    for chunk in _chunks(samples, parts):
        if not len(chunk.times):
            continue
        if late and late[0].time <= chunk.times[-1]:
            count = sum(one.time <= chunk.times[-1] for one in late)
            mine, late = late[:count], late[count:]
            if before is not None:  # whose last program goes on before this chunk's first sample
                chunk = Chunk.joined([before.part(-1, None), chunk])
            chunk = _with_late(chunk, mine, samples)
            if before is not None:
                chunk = chunk.part(1, None)
        before = chunk
        yield chunk


def blocks_of(samples: Samples, parts: Parts | None = None) -> Iterator[Chunk]:
    """Yield the samples of a run, in blocks of :data:`BLOCK` and one of the rest.

    Args:
        samples: Those in memory.
        parts: Those before them.

    Raises:
        FileFormatError: A part is not as it was written.
    """
    waiting: list[Chunk] = []
    for chunk in _merged(samples, parts):
        waiting.append(chunk)
        count = sum(len(one.times) for one in waiting)
        if count < BLOCK:
            continue
        whole = Chunk.joined(waiting)
        for first in range(0, count - BLOCK + 1, BLOCK):
            yield whole.part(first, first + BLOCK)
        waiting = [whole.part(count - count % BLOCK, None)]
    rest = Chunk.joined(waiting)
    if len(rest.times):
        yield rest


def count_of(samples: Samples, parts: Parts | None = None) -> int:
    """Return how many samples a run has."""
    if not samples.late:
        return len(samples.times) + (0 if parts is None else sum(parts.rows))
    return sum(len(chunk.times) for chunk in _merged(samples, parts))
