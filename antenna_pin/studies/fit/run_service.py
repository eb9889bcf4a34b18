"""Runs of a fit, with derivatives where requested, stored in memory and on disk.

By the variational equation fitted parameters and coordinates of a piece's start are propagated together along
its run, through onsets, releases and events (:mod:`antenna_pin.studies.nonlinear.variational`). Readings are
then differentiated along the tangents, at states next to those of the run and without further runs, so that
filters, which are linear, and all other effects of a sensor are included.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from antenna_pin.base.arrays import Array
from antenna_pin.base.calculus import few
from antenna_pin.base.state import State
from antenna_pin.run.simulation.inputs import check_without_controllers
from antenna_pin.run.simulation.samples import Chunk
from antenna_pin.studies.fit.plan import FitPlan
from antenna_pin.studies.fit.runs import (
    PreparedScenario,
    Readings,
    ReadingSlopes,
    RecordTest,
    RunRequest,
    difference_from_origin,
    failed_readings,
    failure_reason,
    make_runs,
    piece_end,
    piece_rows,
    piece_start,
    prepared_scenario,
    sensor_readings,
)
from antenna_pin.studies.fit.sensors import sample_times
from antenna_pin.studies.nonlinear.chart import Chart
from antenna_pin.studies.nonlinear.coordinates import Lift, Units
from antenna_pin.studies.nonlinear.variational import TangentPropagation
from antenna_pin.studies.sensitivity import SensitivityError
from antenna_pin.studies.sensitivity.forward_sensitivity import ParameterTangents
from antenna_pin.studies.sensitivity.tangent_run import check_finite
from antenna_pin.studies.sweep import Executor, Here
from antenna_pin.studies.sweep.executor import Lost
from antenna_pin.studies.sweep.journal import Parts, scenario_content
from antenna_pin.trajectory import library_versions

# --- derivatives by the variational equation ----------------------------------------------------------------

# Difference step of first states, in sizes or error scales; and of readings, in error scales of the
# perturbation: about a thousandth of the depth of a light contact.
_START, _READ = 1e-3, 1e-6
# Weights of fourth-order differences at one and two steps.
_FOURTH = np.array([8.0, -1.0]) / 12.0
# Time step for a clock's shift, over that between rows.
_TICK = 1e-4


class _TangentSamples(NamedTuple):
    """States of one run, with their perturbations by the unknowns."""

    chunk: Chunk  # states, the last at the run's end
    ways: Array  # perturbations, (n, perturbation, fitted)
    words: Array  # derivatives of the program, (n, numbers, words)


def _readings_with_slopes(test: RecordTest, request: RunRequest) -> tuple[Readings, ...]:
    """Return readings of runs with derivatives, or reasons for their absence."""
    try:
        return _ReadingSensitivity(test, request).readings()
    except Exception as error:
        return tuple(failed_readings(failure_reason(error)) for _ in request.starts)


class _ReadingSensitivity:
    """Test of a record at one set of values, with perturbations of each."""

    def __init__(self, test: RecordTest, request: RunRequest) -> None:
        self._test, self._request, self._at = test, request, functools.cache(self._neighbour)
        self._here = prepared_scenario(test, request.values)
        check_without_controllers("fit: derivatives by the equation", self._here.scenario)
        system, self._count = self._here.system, len(request.values)
        self._scales = np.fmax(np.abs(request.values), test.sizes)
        names = [keys[0] if keys else name for keys, name in zip(test.keys, test.names, strict=True)]
        builds = [functools.partial(self._system, k) for k in range(self._count)]
        self._tangents = ParameterTangents(system, builds, names)

    def _neighbour(self, k: int, s: float) -> PreparedScenario:
        """Return the test with one parameter shifted by s sizes."""
        if s == 0.0:
            return self._here
        values = list(self._request.values)
        values[k] += s * float(self._scales[k])
        found = prepared_scenario(self._test, tuple(values))
        if found.scenario.events != self._here.scenario.events:
            raise SensitivityError(
                f"{self._test.names[k]} is a number of an event, which needs method = 'runs'"
            )
        return found

    def _system(self, k: int, s: float) -> Any:
        return self._at(k, s).system

    # --- states ---------------------------------------------------------------------------------------------

    def _start_state(self, bench: PreparedScenario, piece: int, at: Array) -> State:
        if piece <= 0:
            return bench.first_state
        return piece_start(self._test.begun, self._test.origins[piece - 1], at, bench.system)

    def _neighbours(self, piece: int, at: Array) -> list[Callable[[float], State]]:
        """Return functions for a piece's first state over each parameter and coordinate."""

        def of_number(k: int, s: float) -> State:
            return self._start_state(self._at(k, s), piece, at)

        def of_start(i: int, s: float) -> State:
            return self._start_state(self._here, piece, at + s * np.eye(len(at))[i])

        numbers = [functools.partial(of_number, k) for k in range(self._count)]
        return [*numbers, *(functools.partial(of_start, i) for i in range(len(at)))]

    def _carried(self, piece: int, at: Array, times: Array, until: float) -> tuple[_TangentSamples, State]:
        """Return perturbed states of a piece at times and its end, and its start."""
        first = self._start_state(self._here, piece, at)
        ways = self._tangents.of_start(first, self._neighbours(piece, at))

        def start(lift: Lift) -> Array:
            return np.asarray(lift.down @ ways)

        seen: list[tuple[Any, ...]] = []

        def see(carrier: TangentPropagation, time: float, y: Array, ways: Array) -> None:
            field = carrier.field
            check_finite(carrier, time, ways)
            words = np.zeros((0, 0)) if field.numbers is None else field.numbers.program.copy()
            memory, program = field.workspace.memory.copy(), field.workspace.program.copy()
            seen.append((time, y.copy(), memory, program, ways.copy(), words))

        flow = self._here.flow
        frame = Chart(flow.system, first).frame
        looks = np.unique(np.append(times[times >= first.time], until)).tolist()
        flow.propagate(
            first, until - first.time, frame, start, numbers=self._tangents.numbers, looks=looks, on_look=see
        )
        when, states, memories, programs, found, words = zip(*seen, strict=True)
        chunk = Chunk(np.array(when), np.array(states), np.array(memories), list(programs))
        return _TangentSamples(chunk, np.array(found), np.array(words)), first

    def _moved(self, carried: _TangentSamples, column: int, s: float) -> Chunk:
        """Return states perturbed along one unknown."""
        number = column < self._count
        there = self._at(column, s).system if number else self._here.system
        words = s * carried.words[:, column] if number else np.zeros((1, 1))
        return self._tangents.perturbation.states(carried.chunk, s * carried.ways[..., column], words, there)

    def _step(self, carried: _TangentSamples, column: int) -> float:
        """Return the step of readings along a perturbation."""
        units = Units.of(self._here.system)
        way, rate = self._tangents.perturbation.parts[:2]
        sizes = [
            np.abs(carried.ways[:, part, column]) / unit
            for part, unit in ((way, units.position), (rate, units.rate))
        ]
        return _READ / max(1.0, *(float(one.max(initial=0.0)) for one in sizes))

    # --- readings -------------------------------------------------------------------------------------------

    def readings(self) -> tuple[Readings, ...]:
        """Return readings with derivatives by parameters, clock shift and start."""
        test, request, here = self._test, self._request, self._here
        rows = [piece_rows(test, request.shift, piece) for piece, _ in request.starts]
        made = []
        for own, (piece, at) in zip(rows, request.starts, strict=True):
            wanted = [sample_times(column, own) for column in test.columns.values()]
            until = piece_end(test, here, piece, own)
            made.append(self._carried(piece, np.array(at), np.unique(np.concatenate(wanted)), until))
        columns = sensor_readings(test, here, rows, [one.chunk for one, _ in made])
        fitted = [self._count + len(at) for _, at in request.starts]
        tables = [[np.zeros((len(part), n)) for part in own] for own, n in zip(columns, fitted, strict=True)]
        ends = [
            np.zeros((len(self._end(k, one.chunk)), n))
            for k, ((one, _), n) in enumerate(zip(made, fitted, strict=True))
        ]
        for column in range(max(fitted)):
            pieces = [k for k, n in enumerate(fitted) if column < n]
            steps = [self._step(made[k][0], column) for k in pieces]
            if column < self._count:  # all are read of one perturbed run's system
                steps = [min(steps)] * len(steps)
            sides = [
                [self._moved(made[k][0], column, side * j * h) for k, h in zip(pieces, steps, strict=True)]
                for j in (1, 2)
                for side in (1, -1)
            ]
            read = self._read(pieces, rows, sides, column, steps)
            for n, (k, h) in enumerate(zip(pieces, steps, strict=True)):
                for c in range(len(test.columns)):
                    values = [one[n][c] for one in read]
                    tables[k][c][:, column] = _fourth(values, h)
                ends[k][:, column] = _fourth([self._end(k, one[n]) for one in sides], h)
        found = []
        for k, (piece, at) in enumerate(request.starts):
            lead, slopes = self._lead(piece, made[k][1], np.array(at))
            clock = self._clock(piece, np.array(at), rows[k]) if request.clock else None
            sizes = np.concatenate([self._scales, np.ones(len(at))])
            slopes_of = ReadingSlopes(
                tuple(one / sizes for one in tables[k]), slopes / sizes, ends[k] / sizes, clock
            )
            found.append(Readings(tuple(columns[k]), lead, self._end(k, made[k][0].chunk), slopes=slopes_of))
        return tuple(found)

    def _read(
        self,
        pieces: Sequence[int],
        rows: Sequence[Array],
        sides: Sequence[Sequence[Chunk]],
        column: int,
        steps: Sequence[float],
    ) -> list[list[list[Array]]]:
        """Return readings of perturbed states: by side, piece and sensor."""
        own = [rows[k] for k in pieces]
        if column >= self._count:
            read = sensor_readings(
                self._test, self._here, own * len(sides), [one for side in sides for one in side]
            )
            return [read[i * len(pieces) : (i + 1) * len(pieces)] for i in range(len(sides))]
        signs = [side * j for j in (1, 2) for side in (1, -1)]
        return [
            sensor_readings(self._test, self._at(column, sign * steps[0]), own, list(chunks))
            for sign, chunks in zip(signs, sides, strict=True)
        ]

    def _end(self, k: int, chunk: Chunk) -> Array:
        """Return the end of a run, relative to the next piece's origin."""
        piece, model = self._request.starts[k][0], self._here.system.model
        if not self._test.pieces or piece >= len(self._test.pieces) - 2:
            return np.zeros(0)
        q, v = np.split(chunk.states[-1][: model.nq + model.nv], [model.nq])
        return difference_from_origin(self._test.begun, self._test.origins[piece], q, v)

    def _lead(self, piece: int, start: State, at: Array) -> tuple[Array, Array]:
        """Return the start of a piece relative to its origin, and its derivatives."""
        if piece <= 0:
            return np.zeros(0), np.zeros((0, self._count + len(at)))
        begun, origin = self._test.begun, self._test.origins[piece - 1]

        def lead(there: Callable[[float], State], j: int) -> Array:
            found = there(j * _START)
            return difference_from_origin(begun, origin, found.q, found.v)

        columns = [few(functools.partial(lead, one), _START)[0] for one in self._neighbours(piece, at)]
        return difference_from_origin(begun, origin, start.q, start.v), np.column_stack(columns)

    def _clock(self, piece: int, at: Array, rows: Array) -> tuple[Array, ...]:
        """Return derivatives of readings over time, of the run's dense output."""
        test, here = self._test, self._here
        h = _TICK * float(np.median(np.diff(test.time)))
        shifted = np.concatenate([rows + side * j * h for j in (1, 2) for side in (1, -1)])
        first = self._start_state(here, piece, at) if piece > 0 else None
        until = piece_end(test, here, piece, rows) + 2.0 * h
        wanted = np.unique(
            np.concatenate([sample_times(c, np.unique(shifted)) for c in test.columns.values()])
        )
        ran = here.run(wanted[wanted >= 0.0], until, first)
        (read,) = sensor_readings(test, here, [shifted], [ran.chunk])
        return tuple(_fourth(np.split(one, 4), h) for one in read)


def _fourth(values: Sequence[Array], h: float) -> Array:
    """Return a derivative of fourth order from values at h, -h, 2h and -2h."""
    ahead, behind, farther, farthest = values
    return np.asarray((_FOURTH[0] * (ahead - behind) + _FOURTH[1] * (farther - farthest)) / h)


# --- store of runs on the disk ------------------------------------------------------------------------------

_FORM = 3  # of a line
# Keys of a column that no reading depends on.
_OF_COMPARISON = "gain offset sd weight compare spectrum blows column unit".split()


class RunStore:
    """Runs of a fit stored beside its result, in the folder ``FILE.parts``.

    Lines of other records, parameter keys, scenarios or versions are refused; fits with other starts, bounds
    and losses share the runs that are the same.

    Raises:
        OutputError: The folder belongs to another fit, cannot be written, or is in use.
    """

    def __init__(self, target: Path) -> None:
        self._target, self._parts = target, Parts(None, dict, "fit")
        self._entries: dict[tuple[Any, ...], dict[str, Any]] = {}

    def open(self, plan: FitPlan, record_tests: tuple[RecordTest, ...]) -> None:
        """Begin a fit's store, or continue it."""
        self._parts = Parts(self._target, lambda: _identity(plan, record_tests), "fit")
        self._entries = {_key(entry["asked"]): entry for entry in self._parts.entries.values()}

    def read(self, request: RunRequest) -> tuple[Readings, ...] | None:
        """Return stored readings of runs, or None."""
        entry = self._entries.get(_key(request))
        return None if entry is None else tuple(_readings(one) for one in entry["found"])

    def write(self, request: RunRequest, readings: Sequence[Readings]) -> None:
        """Store the readings of runs."""
        number, found = next(reversed(self._parts.entries), -1) + 1, [_as_lists(one) for one in readings]
        self._entries[_key(request)] = entry = {"run": number, "asked": list(request), "found": found}
        self._parts.add(entry)

    def close(self) -> None:
        """Flush and release the store."""
        self._parts.close()

    def remove(self) -> None:
        """Remove the folder of a saved fit."""
        self._parts.remove()


def _as_lists(readings: Readings) -> dict[str, Any]:
    """Return readings as JSON types."""
    lists: dict[str, Any] = _plain({name: getattr(readings, name) for name in ("columns", "lead", "end")})
    lists |= {"failed": readings.failed, "unbalanced": readings.unbalanced}
    if readings.slopes is not None:
        lists["slopes"] = _plain(readings.slopes._asdict())
        lists["fitted"] = readings.slopes.lead.shape[1]
    return lists


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _plain(one) for name, one in value.items()}
    if isinstance(value, tuple):
        return [_plain(one) for one in value]
    return value.tolist() if isinstance(value, np.ndarray) else value


def _readings(lists: dict[str, Any]) -> Readings:
    """Return readings from their stored form."""
    found = Readings(_arrays(lists["columns"]), np.array(lists["lead"]), np.array(lists["end"]))
    slopes = lists.get("slopes")
    if slopes is not None:
        lead, end = (np.array(slopes[name]).reshape(-1, lists["fitted"]) for name in ("lead", "end"))
        columns = tuple(one.reshape(-1, lists["fitted"]) for one in _arrays(slopes["columns"]))
        clock = None if slopes["clock"] is None else _arrays(slopes["clock"])
        found = found._replace(slopes=ReadingSlopes(columns, lead, end, clock))
    return found._replace(failed=lists["failed"], unbalanced=lists.get("unbalanced", ""))


def _arrays(lists: list[Any]) -> tuple[np.ndarray, ...]:
    return tuple(np.array(one) for one in lists)


def _key(request: Any) -> tuple[Any, ...]:
    record, values, shift, starts, *rest = request
    return record, tuple(values), shift, tuple((piece, tuple(start)) for piece, start in starts), *rest


def _identity(plan: FitPlan, record_tests: tuple[RecordTest, ...]) -> dict[str, Any]:
    """Return all that readings depend on, as JSON types."""
    records = {}
    for test in record_tests:
        scenario = scenario_content(test.scenario)
        scenario.pop("name", None)
        columns = {name: one.model_dump(mode="json") for name, one in test.columns.items()}
        for one in columns.values():
            for number in _OF_COMPARISON:
                one.pop(number)
        time = hashlib.sha256(test.time.tobytes()).hexdigest()
        made_of = [scenario, test.keys, test.units, test.derived]
        records[test.name] = [*made_of, columns, time, test.pieces, test.origins]
    return {"form": _FORM, "records": records, "versions": library_versions()}


# --- runs on demand -----------------------------------------------------------------------------------------


def _make_all(record_tests: tuple[RecordTest, ...], batch: list[RunRequest]) -> list[tuple[Readings, ...]]:
    """Make the requested runs, one after the other."""
    return [
        (_readings_with_slopes if one.slopes else make_runs)(record_tests[one.record], one) for one in batch
    ]


_REMEMBERED = 512  # answers that stay in memory


class RunService:
    """Runs made on demand, each once.

    A repeated search requests the same runs in the same order; stored runs are not made again, so that an
    interrupted search continues bit for bit.
    """

    def __init__(
        self,
        executor: Executor | None = None,
        store: RunStore | None = None,
        progress: Callable[[int], None] | None = None,
    ) -> None:
        self.executor, self.store, self.progress = executor or Here(), store, progress
        self.made = 0
        #: Reports on unbalanced energy or momentum, one entry a run.
        self.unbalanced: list[str] = []
        #: Reasons of failed runs, one entry a run, without those for derivatives.
        self.failed: list[str] = []
        self._record_tests: tuple[RecordTest, ...] = ()
        self._known: dict[RunRequest, tuple[Readings, ...]] = {}

    def take(self, plan: FitPlan, record_tests: tuple[RecordTest, ...]) -> None:
        """Set the tests of the runs, and open the store."""
        self._record_tests = record_tests
        if self.store is not None:
            self.store.open(plan, record_tests)

    def readings(self, request: Sequence[RunRequest]) -> list[tuple[Readings, ...]]:
        """Return the readings of each request; missing runs are made in parallel."""
        missing = [one for one in dict.fromkeys(request) if one not in self._known]
        found: dict[RunRequest, tuple[Readings, ...]] = {}
        for one in list(missing):
            old = None if self.store is None else self.store.read(one)
            if old is not None:
                found[one] = old
                self.made += len(old)
                missing.remove(one)
        if missing:
            self.executor.start()
        batches: Iterator[list[RunRequest]] = ([one] for one in missing)
        for (one,), answer in self.executor.each(_make_all, self._record_tests, batches):
            lost = isinstance(answer, Lost)
            found[one] = tuple(failed_readings(str(answer)) for _ in one.starts) if lost else answer[0]
            self.made += len(one.starts)
            if self.store is not None:
                self.store.write(one, found[one])
            if self.progress is not None:
                self.progress(self.made)
        self.unbalanced += [one.unbalanced for made in found.values() for one in made if one.unbalanced]
        self.failed += [
            one.failed for key, made in found.items() if not key.slopes for one in made if one.failed
        ]
        self._known |= found
        answers = [self._known[one] for one in request]
        for one in list(self._known)[: max(0, len(self._known) - _REMEMBERED)]:
            del self._known[one]
        return answers

    def said_of_unbalanced(self, last: Sequence[Readings]) -> list[str]:
        """Return a note on unbalanced runs, if any; ``last`` have the fitted values."""
        if not self.unbalanced:
            return []
        mine = [one.unbalanced for one in last if one.unbalanced]
        which = "those with the fitted values among them" if mine else "none with the fitted values"
        return [
            f"note: the energy or momentum of {len(self.unbalanced)} of {self.made} runs does not balance, "
            f"{which}: {[*mine, *self.unbalanced][0]}"
        ]
