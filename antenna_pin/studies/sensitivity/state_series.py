"""Series of a result, differentiated over parameters and time at samples of a run.

A state y follows its flow f(t, y), so that the rate of any function g of it is the derivative of ``g(t + s, y
+ s f)`` over s, along a straight line. A perturbed state's rate is that of its own flow; the derivative of
both over a parameter is the mixed one, which gives the delay of largest values.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import chain
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arrays import Array
from antenna_pin.base.calculus import WEIGHTS
from antenna_pin.base.settings import RunSettings
from antenna_pin.base.state import State
from antenna_pin.dynamics import System, observed
from antenna_pin.run.simulation.loop import Run
from antenna_pin.run.simulation.recorder import series_at
from antenna_pin.run.simulation.samples import Chunk
from antenna_pin.run.simulation.variables import MOTORS_SINCE_BEGIN
from antenna_pin.studies.nonlinear.chart import StatePerturbation
from antenna_pin.studies.nonlinear.perturbed_system import PerturbedParameters, PerturbedSystem
from antenna_pin.studies.sensitivity.tangent_run import PerturbedSamples
from antenna_pin.trajectory.schema import VARIABLES

# --- series over parameters ---------------------------------------------------------------------------------

#: Shifts of perturbed states in steps, ahead and then behind.
_SIDES = np.array([1, 2, 3, -1, -2, -3])
# Difference steps over parameters in their scales, the largest first; relative agreement of two orders that
# suffices; relative round-off of a series.
_STEPS, _GOOD, _ROUND_OFF = (1e-3, 1e-4, 1e-5, 1e-6), 1e-9, 1e-14
# Approximate number of states evaluated at once.
_AT_ONCE = 4096
# Series that vanish but for round-off, judged beside others of their unit.
_CONSERVED = ("linear_momentum", "angular_momentum", "energy_error")


class _Shift(NamedTuple):
    """Parameter, and its shift in scales."""

    parameter: int
    far: float


class _SeriesTable:
    """Differentiable series in columns, one row for each sample."""

    def __init__(self, here: Mapping[str, Array]) -> None:
        taken = {name: one for name, one in here.items() if one.dtype.kind == "f" and name != "time"}
        self.shapes = {name: one.shape[1:] for name, one in taken.items()}
        widths = [int(np.prod(shape)) for shape in self.shapes.values()]
        ends = np.cumsum([0, *widths])
        #: Columns of each series, by name.
        self.columns = {
            name: slice(first, last)
            for name, first, last in zip(taken, ends[:-1].tolist(), ends[1:].tolist(), strict=True)
        }
        self._filled = [name for name, width in zip(taken, widths, strict=True) if width]
        self._starts = np.array([self.columns[name].start for name in self._filled], dtype=int)
        #: Index of the nonempty series of each column.
        self.owner = np.repeat(np.arange(len(self._filled)), [width for width in widths if width])
        #: Whether each column counts from the first sample.
        counts = [VARIABLES[name].source == "ledger" or name in MOTORS_SINCE_BEGIN for name in taken]
        self.since = np.repeat(counts, widths)

    def flat(self, series: Mapping[str, Array]) -> Array:
        """Return series as rows, (n, columns)."""
        return np.hstack([series[name].reshape(len(series[name]), -1) for name in self.columns])

    def largest(self, sizes: Array) -> Array:
        """Return the largest of each nonempty series at each sample, (n, series)."""
        return np.maximum.reduceat(sizes, self._starts, axis=1)

    def known_beside(self, sizes: Array) -> Array:
        """Return the reference size of each series for its accuracy, (n, series)."""
        units = [VARIABLES[name].units for name in self._filled]
        out = sizes.copy()
        for k, name in enumerate(self._filled):
            if name in _CONSERVED:
                out[:, k] = sizes[:, [unit == units[k] for unit in units]].max(axis=1)
        return out

    def by_name(self, values: Array, doubts: Array) -> dict[str, tuple[Array, Array]]:
        """Return derivatives and errors by name, (n, ..., parameters), of (parameters, n, columns)."""
        return {name: (self._shaped(values, name), self._shaped(doubts, name)) for name in self.columns}

    def _shaped(self, rows: Array, name: str) -> Array:
        part = np.moveaxis(rows[:, :, self.columns[name]], 0, -1)
        return part.reshape(rows.shape[1], *self.shapes[name], len(rows))


class StateSeries:
    """Series of a result at states of a run, and their derivatives over parameters."""

    def __init__(
        self,
        parameters: PerturbedParameters,
        displacer: StatePerturbation,
        settings: RunSettings,
        start: State,
        scales: Array,
    ) -> None:
        self.beside, self._displacer, self._settings, self._first = parameters, displacer, settings, start
        self.scales = scales
        self._shown: Run | None = None

    def series_at(self, chunk: Chunk) -> dict[str, Array]:
        """Return the series at states of the system, by name."""
        with self.beside.at(0, 0.0) as near:
            return self._series_of(near.system, chunk)

    def perturbed(
        self, displaced: PerturbedSamples, wanted: Sequence[_Shift]
    ) -> Iterator[tuple[Sequence[int], PerturbedSystem, list[Chunk]]]:
        """Yield indices of perturbed runs, their system and their states, for runs of one system."""
        together = [i for i, one in enumerate(wanted) if self.beside.by_program[one.parameter]]
        for part in _batches(together, _AT_ONCE // len(displaced.chunk.times)):
            with self.beside.at(0, 0.0) as near:
                yield part, near, [self._moved(displaced, wanted[i], near.system) for i in part]
        for i in sorted({*range(len(wanted))}.difference(together)):
            with self.beside.at(*wanted[i]) as near:
                yield [i], near, [self._moved(displaced, wanted[i], near.system)]

    def series(self, displaced: PerturbedSamples) -> dict[str, tuple[Array, Array]]:
        """Return derivatives of the series at samples, with error estimates, (n, ..., parameters).

        Integrals along the run count from the first sample.
        """
        here = self.series_at(displaced.chunk)
        table, count = _SeriesTable(here), len(self.scales)
        values = table.flat(here)
        size = table.known_beside(table.largest(np.abs(values)))
        best, rest = np.zeros((count, *values.shape)), np.full((count, *size.shape), np.nan)
        left = list(range(count))
        for step in _STEPS:
            parts = list(_batches(left, _AT_ONCE // (len(_SIDES) * len(values))))
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

    def _differences(
        self, displaced: PerturbedSamples, table: _SeriesTable, left: Sequence[int], step: float
    ) -> Array:
        """Return differences of series over both sides, (parameters, 3, n, columns)."""
        wanted = [_Shift(k, far) for k in left for far in (_SIDES * step).tolist()]
        rows = np.zeros((len(wanted), len(displaced.chunk.times), len(table.owner)))
        for numbers, near, chunks in self.perturbed(displaced, wanted):
            found = table.flat(self._series_of(near.system, _interleaved(chunks)))
            found = found.reshape(len(displaced.chunk.times), len(chunks), -1)
            found[:, :, table.since] -= found[:1, :, table.since]
            rows[numbers] = np.swapaxes(found, 0, 1)
        ahead, behind = np.split(rows.reshape(len(left), len(_SIDES), *rows.shape[1:]), 2, axis=1)
        return ahead - behind

    def _series_of(self, system: System, chunk: Chunk) -> dict[str, Array]:
        if self._shown is None or self._shown.system is not system:
            first = self._first
            self._shown = Run(system, first, first.reached + 1.0, self._settings, ())
        return dict(series_at(self._shown, chunk))

    def _moved(self, displaced: PerturbedSamples, to: _Shift, there: System) -> Chunk:
        """Return states perturbed by a shift, of its system."""
        k, far = to
        every = displaced.perturbations[..., k], displaced.program_slopes[:, k], displaced.integrals[..., k]
        moves, words, books = (far * one for one in every)
        return self._displacer.states(displaced.chunk, moves, words, there, books)


def _batches(numbers: Sequence[int], count: int) -> Iterator[Sequence[int]]:
    """Yield numbers in batches of a count, one at least."""
    count = max(count, 1)
    return (numbers[first : first + count] for first in range(0, len(numbers), count))


def _interleaved(chunks: Sequence[Chunk]) -> Chunk:
    """Return perturbed states as those of one run: at each time one after another."""
    times = np.stack([one.times for one in chunks], axis=1)
    states = np.stack([one.states for one in chunks], axis=1)
    memories = np.stack([one.memories for one in chunks], axis=1)
    programs = [one for each in zip(*(chunk.programs for chunk in chunks), strict=True) for one in each]
    n = times.size
    return Chunk(times.reshape(n), states.reshape(n, -1), memories.reshape(n, memories.shape[-1]), programs)


# --- series and forces over time ----------------------------------------------------------------------------

# Difference steps in time over the duration, the largest first; those along a parameter, in its scale.
_TIME_STEPS, _ALONG = (3e-2, 1e-2, 3e-3, 1e-3, 1e-4, 1e-5), (1e-3, 1e-4, 1e-5)
# Relative round-off of differentiated values.
_TIME_ROUND_OFF = 1e-15


class _ForceCurvature(NamedTuple):
    """Contact forces with their derivatives over time and parameters, at samples."""

    force: Array  # [N]
    rate: Array  # of the force [N/s]
    bend: Array  # of the rate [N/s^2]
    over: Array  # of the rate over each parameter, in its scale, at equal times
    bend_doubt: Array  # error estimate
    over_doubt: Array  # error estimate

    def of(self, n: int) -> _ForceCurvature:
        """Return the data of one sample, (1,)."""
        return _ForceCurvature(*(one[n : n + 1] for one in self))

    def is_maximum(self, tolerance: float) -> bool:
        """Return whether a force has its maximum here, within a share of its time scale."""
        force, rate, bend = (float(one[0]) for one in self[:3])
        return bend < 0.0 and rate**2 < tolerance**2 * force * -bend

    def delay(self, known: Array) -> tuple[Array, Array, Array]:
        """Return the delay of a force's maximum [s], its error, and the force's correction.

        The correction is the additional change of the force at its maximum, relative to this sample.
        """
        (force,), (rate,), (bend,), (over,), (rough,), (rest,) = self
        late, off = -over / bend, -rate / bend
        slow = np.sqrt(-force / bend)  # what it takes to bend
        doubt = rest / abs(bend) + np.abs(late) * (known + rough / abs(bend) + abs(off) / slow)
        return late, doubt, over * off


class TimeDerivatives:
    """Derivatives over time of series at perturbed samples."""

    def __init__(self, source: StateSeries, displaced: PerturbedSamples) -> None:
        self._told, self._all = source, displaced
        self._rates: dict[tuple[int, float], dict[str, tuple[Array, Array]]] = {}

    def forces(self, places: NDArray[np.int_], contacts: NDArray[np.int_], long: Array) -> _ForceCurvature:
        """Return normal forces of contacts with their derivatives.

        ``long`` is the duration of each contact [s].
        """
        told, part, n = self._told, self._part(places), len(places)

        def force(chunk: Chunk, evaluator: PerturbedSystem) -> Array:
            """Return forces in states sample by sample, (n, states of each)."""
            seen = observed(evaluator.system, chunk.times, chunk.states, chunk.memories, chunk.programs)
            found = np.asarray(seen.contact["normal_force"]).reshape(n, -1, seen.contact.shape[-1])
            return found[np.arange(n), :, contacts]

        def rate(chunk: Chunk, evaluator: PerturbedSystem) -> Array:
            """Return rates of forces likewise, by the best steps of the run's own rates."""
            lines, count = _lines(chunk, evaluator), len(chunk.times) // n
            far = np.repeat(step, count)
            ahead_and_behind = force(lines(far[:, None] * _SIDES), evaluator).reshape(n, count, len(_SIDES))
            return _orders(ahead_and_behind)[0] / step[:, None]

        with told.beside.at(0, 0.0) as own:
            lines, most = _lines(part.chunk, own), force(part.chunk, own)[:, 0]
            noise = _TIME_ROUND_OFF * np.abs(most)
            here, doubt, step = _best(lambda h: force(lines(h), own), long, _TIME_STEPS, noise)
            bend, off, _ = _best(lambda h: rate(lines(h), own), long, _TIME_STEPS[:3], doubt)
        count = len(told.scales)
        over, rest = np.zeros((n, count)), np.full((n, count), np.inf)
        for far in _ALONG:
            wanted = [_Shift(k, one) for k in range(count) for one in (_SIDES * far).tolist()]
            rates = np.zeros((n, len(wanted)))
            for numbers, near, chunks in told.perturbed(part, wanted):
                rates[:, numbers] = rate(_interleaved(chunks), near)
            sixth, apart = _orders(rates.reshape(n, count, len(_SIDES)))
            value, other = sixth / far, (apart + doubt[:, None]) / far
            over, rest = np.where(other < rest, value, over), np.fmin(other, rest)
        return _ForceCurvature(most, here, bend, over, off, rest)

    def series(self, place: int, long: float) -> dict[str, tuple[Array, Array]]:
        """Return the rates of all series at a sample in an event, with errors."""
        if (place, long) not in self._rates:
            self._rates[place, long] = self._series(place, long)
        return self._rates[place, long]

    def _series(self, place: int, long: float) -> dict[str, tuple[Array, Array]]:
        chunk = self._part(np.array([place])).chunk
        with self._told.beside.at(0, 0.0) as near:
            lines = _lines(chunk, near)
        here = self._told.series_at(chunk)
        steps = np.array(_TIME_STEPS) * long
        told = self._told.series_at(lines(np.outer(steps, _SIDES).reshape(1, -1)))
        best: dict[str, tuple[Array, Array]] = {}
        for name in (one for one, value in here.items() if value.dtype.kind == "f" and one != "time"):
            values = np.moveaxis(told[name].reshape(len(steps), len(_SIDES), *here[name].shape[1:]), 1, -1)
            noise = _TIME_ROUND_OFF * np.abs(here[name][0]).max(initial=0.0)
            for h, (sixth, apart) in zip(steps.tolist(), zip(*_orders(values), strict=True), strict=True):
                rest = (apart + noise) / h
                if name not in best or rest.max(initial=0.0) < best[name][1].max(initial=0.0):
                    best[name] = sixth / h, rest
        return best

    def _part(self, places: NDArray[np.int_]) -> PerturbedSamples:
        """Return some of the samples."""
        every = self._all
        old = every.chunk
        programs = [old.programs[k] for k in places.tolist()]
        chunk = Chunk(old.times[places], old.states[places], old.memories[places], programs)
        return PerturbedSamples(chunk, *(one[places] for one in every[1:]))


def _lines(chunk: Chunk, evaluator: PerturbedSystem) -> Callable[[Array], Chunk]:
    """Return a function for states along straight lines in time, (n, of each) [s]."""
    system = evaluator.system
    nq, nv = system.model.nq, system.model.nv
    flows = []
    for time, state, memory, program in zip(
        chunk.times.tolist(), chunk.states, chunk.memories, chunk.programs, strict=True
    ):
        evaluator.workspace.memory[:], evaluator.workspace.program[:] = memory, program
        flows.append(evaluator.rates(time, np.ascontiguousarray(state)).copy())

    def line(h: Array) -> Chunk:
        count = h.shape[1]
        states = np.repeat(chunk.states, count, axis=0)
        for i, (y, s) in enumerate(zip(states, h.reshape(-1).tolist(), strict=True)):
            way = s * y[nq : nq + nv]
            evaluator.workspace.retract(y, way)
            y[nq:] += s * flows[i // count]
            system.turn_on(y)
        times = np.repeat(chunk.times, count) + h.reshape(-1)
        programs = [program for program in chunk.programs for _ in range(count)]
        return Chunk(times, states, np.repeat(chunk.memories, count, axis=0), programs)

    return line


def _orders(values: Array) -> tuple[Array, Array]:
    """Return differences of sixth order, and their distance from fourth order."""
    sixth, fourth = ((values[..., :3] - values[..., 3:]) @ one for one in WEIGHTS)
    return sixth, np.abs(sixth - fourth)


def _best(
    function: Callable[[Array], Array], sizes: Array, steps: tuple[float, ...], noise: Array
) -> tuple[Array, Array, Array]:
    """Return derivatives at zero, their errors and steps, (n,) each, of best agreement."""
    best, doubt, used = np.zeros_like(sizes), np.full_like(sizes, np.inf), sizes.copy()
    for h in (step * sizes for step in steps):
        sixth, apart = _orders(function(h[:, None] * _SIDES))
        rest = (apart + noise) / h
        better = rest < doubt
        best, used = np.where(better, sixth / h, best), np.where(better, h, used)
        doubt = np.where(better, rest, doubt)
    return best, doubt, used
