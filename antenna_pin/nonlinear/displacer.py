"""Displacements of whole states, with what contacts and elements remember; states that are displaced."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import memory_records
from antenna_pin.base.state import State
from antenna_pin.dynamics import System, Workspace
from antenna_pin.nonlinear.frames import parts_of, way_between
from antenna_pin.nonlinear.kept import Kept
from antenna_pin.simulation.samples import Chunk

__all__ = ["Displacer"]

Array = NDArray[np.float64]


class Displacer:
    """Makes displacements of states of a system, and states of displacements.

    Args:
        system: The system.
        numbers: How many of its numbers are displaced too.

    Attributes:
        kept: What its elements keep.
        parts: Of a displacement.
    """

    def __init__(self, system: System, numbers: int) -> None:
        """Lay out a displacement."""
        self._system, self.kept = system, Kept(system)
        self.parts = parts_of(system, len(self.kept), numbers)
        self._bristles = np.asarray(system.bristle_x, dtype=int)
        self._workspace = Workspace(system)

    def between(self, here: State, there: State) -> Array | None:
        """Return the displacement from a state to another, without that of numbers, (displacement,).

        None where other contacts touch in the other: there is no way between the two.
        """
        system = self._system
        ours, theirs = (memory_records(one.memory) for one in (here, there))
        if not np.array_equal(ours["touching"], theirs["touching"]):
            return None
        way, rate, bristles, speeds, masses, _, kept, _ = self.parts
        out = np.zeros(self.parts[-1].stop)
        out[way], out[rate] = way_between(system, here.q, there.q), there.v - here.v
        out[bristles] = there.x[self._bristles] - here.x[self._bristles]
        touch = ours["touching"] != 0.0
        for part, name in ((speeds, "approach_speed"), (masses, "effective_mass")):
            with np.errstate(divide="ignore", invalid="ignore"):
                logs = np.log(theirs[name] / ours[name])
            out[part] = np.where(touch & np.isfinite(logs), logs, 0.0)
        out[kept] = self.kept.between(tuple(range(len(self.kept))), here, there)
        return out

    def states(
        self, chunk: Chunk, moves: Array, words: Array, there: System, books: Array | None = None
    ) -> Chunk:
        """Return states that are displaced.

        Args:
            chunk: The states.
            moves: Their displacements, (n, displacement).
            words: By how much words of the program are besides, (n, words) or zero, (1, 1).
            there: The system to which they are displaced, which turns numbers on with the state.
            books: By how much what is integrated along a run is, (n, nx); its bristles are in ``moves``.
        """
        system = self._system
        first = system.model.nq + system.model.nv
        way, rate, bristles, speeds, masses, _, kept, _ = self.parts
        states, memories, programs = chunk.states.copy(), chunk.memories.copy(), []
        at = first + self._bristles
        more = np.broadcast_to(words, (len(states), words.shape[1]))
        for i, (y, move) in enumerate(zip(states, moves, strict=True)):
            self._workspace.retract(y, move[way])
            y[system.model.nq : first] += move[rate]
            if books is not None:
                y[first:] += books[i]
            y[at] = chunk.states[i, at] + move[bristles]
            memories[i]["approach_speed"] *= np.exp(move[speeds])
            memories[i]["effective_mass"] *= np.exp(move[masses])
            program = chunk.programs[i] + more[i]
            program[self.kept.words] += move[kept]
            programs.append(program)
            there.turn_on(y)
        return Chunk(chunk.times, states, memories, programs)
