"""What a result says of a run's states, in its neighbours: derivatives of its series over parameters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.differences import WEIGHTS
from antenna_pin.base.settings import RunSettings
from antenna_pin.base.state import State
from antenna_pin.dynamics import System
from antenna_pin.nonlinear.chart import Displacer
from antenna_pin.nonlinear.perturbed_system import Beside, Near
from antenna_pin.sensitivity.along import Displaced
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.recorder import series_at
from antenna_pin.simulation.samples import Chunk
from antenna_pin.simulation.variables import MOTORS_SINCE_BEGIN
from antenna_pin.trajectory.schema import VARIABLES

__all__ = ["SIDES", "OfStates", "Row", "beside_one_another"]

Array = NDArray[np.float64]

#: At how many steps neighbours are, ahead and then behind.
SIDES = np.array([1, 2, 3, -1, -2, -3])
# Steps of differences over parameters, in their scales, the largest first; how well their two orders agree at
# least, over the derivative; round-off of a series, over its size.
_STEPS, _GOOD, _ROUND_OFF = (1e-3, 1e-4, 1e-5, 1e-6), 1e-9, 1e-14
# How many states are told of at once, about.
_AT_ONCE = 4096
# Series that are zero but for round-off where they must be; they are small beside others of their unit.
_KEPT = ("linear_momentum", "angular_momentum", "energy_error")


class Row(NamedTuple):
    """A parameter, and how many of its scales farther a neighbour is."""

    parameter: int
    far: float


class Table:
    """Series side by side: of each sample one row of numbers.

    Args:
        here: The series, by name, (n, ...); those that are differentiated are taken.
    """

    def __init__(self, here: Mapping[str, Array]) -> None:
        """Lay them out."""
        taken = {name: one for name, one in here.items() if one.dtype.kind == "f" and name != "time"}
        self.shapes = {name: one.shape[1:] for name, one in taken.items()}
        widths = [int(np.prod(shape)) for shape in self.shapes.values()]
        ends = np.cumsum([0, *widths])
        #: Columns of each, by name.
        self.columns = {
            name: slice(first, last)
            for name, first, last in zip(taken, ends[:-1].tolist(), ends[1:].tolist(), strict=True)
        }
        self._filled = [name for name, width in zip(taken, widths, strict=True) if width]
        self._starts = np.array([self.columns[name].start for name in self._filled], dtype=int)
        #: Of each column, which of those that are not empty it is of.
        self.owner = np.repeat(np.arange(len(self._filled)), [width for width in widths if width])
        #: Whether it counts from the first sample on.
        counts = [VARIABLES[name].source == "ledger" or name in MOTORS_SINCE_BEGIN for name in taken]
        self.since = np.repeat(counts, widths)

    def flat(self, series: Mapping[str, Array]) -> Array:
        """Return series as rows, (n, columns)."""
        return np.hstack([series[name].reshape(len(series[name]), -1) for name in self.columns])

    def largest(self, sizes: Array) -> Array:
        """Return the largest of each series at each sample, of those that are not empty, (n, series)."""
        return np.maximum.reduceat(sizes, self._starts, axis=1)

    def known_beside(self, sizes: Array) -> Array:
        """Return beside what each must be known, of the largest of each, (n, series)."""
        units = [VARIABLES[name].units for name in self._filled]
        out = sizes.copy()
        for k, name in enumerate(self._filled):
            if name in _KEPT:
                out[:, k] = sizes[:, [unit == units[k] for unit in units]].max(axis=1)
        return out

    def by_name(self, values: Array, doubts: Array) -> dict[str, tuple[Array, Array]]:
        """Return derivatives and doubts by name, (n, ..., parameters), of (parameters, n, columns) each."""
        return {name: (self._shaped(values, name), self._shaped(doubts, name)) for name in self.columns}

    def _shaped(self, rows: Array, name: str) -> Array:
        part = np.moveaxis(rows[:, :, self.columns[name]], 0, -1)
        return part.reshape(rows.shape[1], *self.shapes[name], len(rows))


class OfStates:
    """Tells what a result says of states of a run, and how that goes with parameters.

    Args:
        beside: What stands for neighbours of the run's system.
        displacer: Makes their states.
        settings: Of the run.
        first: Its first state.
        scales: Of the parameters, (parameters,).
    """

    def __init__(
        self, beside: Beside, displacer: Displacer, settings: RunSettings, first: State, scales: Array
    ) -> None:
        """Take them."""
        self.beside, self._displacer, self._settings, self._first = beside, displacer, settings, first
        self.scales = scales
        self._shown: Run | None = None

    def seen(self, chunk: Chunk) -> dict[str, Array]:
        """Return the series that states of the system imply, by name."""
        with self.beside.at(0, 0.0) as near:
            return self._told(near.system, chunk)

    def neighbours(
        self, displaced: Displaced, wanted: Sequence[Row]
    ) -> Iterator[tuple[Sequence[int], Near, list[Chunk]]]:
        """Yield states displaced to neighbours, as many together as one system can be asked of.

        Args:
            displaced: The states.
            wanted: The neighbours.

        Yields:
            Numbers of neighbours, what evaluates them, and the states of each.
        """
        together = [i for i, one in enumerate(wanted) if self.beside.by_program[one.parameter]]
        for part in _parts(together, _AT_ONCE // len(displaced.chunk.times)):
            with self.beside.at(0, 0.0) as near:
                yield part, near, [self._moved(displaced, wanted[i], near.system) for i in part]
        for i in sorted({*range(len(wanted))}.difference(together)):
            with self.beside.at(*wanted[i]) as near:
                yield [i], near, [self._moved(displaced, wanted[i], near.system)]

    def series(self, displaced: Displaced) -> dict[str, tuple[Array, Array]]:
        """Return derivatives of the series of a result at samples, and their doubts, (n, ..., parameters).

        The first sample is where what is integrated along the run counts from.
        """
        here = self.seen(displaced.chunk)
        table, count = Table(here), len(self.scales)
        values = table.flat(here)
        size = table.known_beside(table.largest(np.abs(values)))
        best, rest = np.zeros((count, *values.shape)), np.full((count, *size.shape), np.nan)
        left = list(range(count))
        for step in _STEPS:
            parts = list(_parts(left, _AT_ONCE // (len(SIDES) * len(values))))
            for k, odd in chain.from_iterable(
                zip(part, self._differences(displaced, table, part, step), strict=True) for part in parts
            ):
                sixth, fourth = np.tensordot(WEIGHTS, odd, 1) / step
                off = table.largest(np.abs(sixth - fourth) + _ROUND_OFF * np.abs(values) / step)
                poor = ~(rest[k] <= _GOOD * np.maximum(table.largest(np.abs(best[k])), size))
                better = (off < rest[k]) | np.isnan(rest[k])
                best[k] = np.where(better[:, table.owner], sixth, best[k])
                rest[k] = np.where(better, off, rest[k])
                good = rest[k] <= _GOOD * np.maximum(table.largest(np.abs(best[k])), size)
                if good.all() or not (better & poor).any():
                    left.remove(k)
            if not left:
                break
        most = np.array([table.largest(np.abs(one)) for one in best])
        doubts = rest + displaced.doubts.T[:, :, None] * most
        scales = self.scales[:, None, None]
        return table.by_name(best / scales, doubts[:, :, table.owner] / scales)

    def _differences(self, displaced: Displaced, table: Table, left: Sequence[int], step: float) -> Array:
        """Return what neighbours ahead are more than those behind, (parameters, 3, n, columns)."""
        wanted = [Row(k, far) for k in left for far in (SIDES * step).tolist()]
        rows = np.zeros((len(wanted), len(displaced.chunk.times), len(table.owner)))
        for numbers, near, chunks in self.neighbours(displaced, wanted):
            found = table.flat(self._told(near.system, beside_one_another(chunks)))
            found = found.reshape(len(displaced.chunk.times), len(chunks), -1)
            found[:, :, table.since] -= found[:1, :, table.since]
            rows[numbers] = np.swapaxes(found, 0, 1)
        ahead, behind = np.split(rows.reshape(len(left), len(SIDES), *rows.shape[1:]), 2, axis=1)
        return ahead - behind

    def _told(self, system: System, chunk: Chunk) -> dict[str, Array]:
        if self._shown is None or self._shown.system is not system:
            first = self._first
            self._shown = Run(system, first, first.reached + 1.0, self._settings, ())
        return dict(series_at(self._shown, chunk))

    def _moved(self, displaced: Displaced, to: Row, there: System) -> Chunk:
        """Return states displaced to a neighbour, whose system that is."""
        k, far = to
        every = displaced.ways[..., k], displaced.words[:, k], displaced.books[..., k]
        moves, words, books = (far * one for one in every)
        return self._displacer.states(displaced.chunk, moves, words, there, books)


def _parts(numbers: Sequence[int], count: int) -> Iterator[Sequence[int]]:
    """Yield numbers so many at once, one at least."""
    count = max(count, 1)
    return (numbers[first : first + count] for first in range(0, len(numbers), count))


def beside_one_another(chunks: Sequence[Chunk]) -> Chunk:
    """Return states of neighbours as those of one run: at each time one neighbour's after another's."""
    times = np.stack([one.times for one in chunks], axis=1)
    states = np.stack([one.states for one in chunks], axis=1)
    memories = np.stack([one.memories for one in chunks], axis=1)
    programs = [one for each in zip(*(chunk.programs for chunk in chunks), strict=True) for one in each]
    n = times.size
    return Chunk(times.reshape(n), states.reshape(n, -1), memories.reshape(n, memories.shape[-1]), programs)
