"""Runs of a record's test, whole or in pieces (multiple shooting), with sensor readings.

A motion with impacts forgets its start: over a long record the sum of squares has a valley for each order in
which impacts can follow one another. Over a piece it has not, and the gaps between pieces are further
residuals (Bock 1981, Springer Series in Chemical Physics 18, 102-125).
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from antenna_pin.base.arrays import Array
from antenna_pin.base.interruption import interruptible, is_interruption, uninterrupted
from antenna_pin.base.state import OpenContact, State
from antenna_pin.dynamics import System, contact_memory
from antenna_pin.errors import AntennaPinError, ScenarioError
from antenna_pin.run.simulation.inputs import RunStart, controllers_of, events_of, prepare_run, settings_of
from antenna_pin.run.simulation.loop import Run
from antenna_pin.run.simulation.recorder import labelled_at, open_ledger
from antenna_pin.run.simulation.samples import Chunk
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.assemble import build_system, initial_angles, initial_state
from antenna_pin.studies.fit.sensors import reading, sample_times
from antenna_pin.studies.fit.specs import ColumnSpec, evaluate
from antenna_pin.studies.nonlinear import Chart, Flow
from antenna_pin.studies.nonlinear.coordinates import configuration_difference
from antenna_pin.studies.sweep.design import put_value
from antenna_pin.trajectory import ENDED_WELL

# --- a scenario set up once ---------------------------------------------------------------------------------

_ROUND_OFF = 1e-12  # by which a run may end before its end [s]


class RunSamples(NamedTuple):
    """Samples of a run for a fit."""

    chunk: Chunk  # samples
    end: State  # final state
    failed: str  # reason for an early end; "" if completed
    unbalanced: str = ""  # imbalance of energy or momentum as text; "" if balanced


class PreparedScenario:
    """Scenario with its system, built once."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario, self.system = scenario, build_system(scenario)
        self._latest: Run | None = None

    @cached_property
    def _run_start(self) -> RunStart:
        q, v = initial_state(self.scenario, self.system)
        return RunStart(q, v, initial_angles(self.scenario, self.system))

    @cached_property
    def flow(self) -> Flow:
        """Flow of the system, with the scenario's integrator."""
        return Flow(self.system, settings_of(self.scenario), events_of(self.scenario), self.scenario)

    @cached_property
    def first_state(self) -> State:
        """First state of the scenario."""
        q, v = initial_state(self.scenario, self.system)
        return self.flow.first(q, v, initial_angles(self.scenario, self.system))

    def run(self, times: Array, until: float, start: State | None = None) -> RunSamples:
        """Make a run sampled at rising times [s], from a state or the scenario's start.

        Raises:
            AntennaPinError: The run cannot begin.
            KeyboardInterrupt: The run was interrupted.
        """
        begin = 0.0 if start is None else start.reached
        settings = dataclasses.replace(
            settings_of(self.scenario),
            accuracy=None,
            output_rate=0.5 / (until - begin),
            output_times=tuple(times[(times >= begin) & (times <= until)].tolist()),
            output_form="full",
        )
        given = self._run_start if start is None else RunStart(start=start)
        events, controllers = events_of(self.scenario), controllers_of(self.scenario)
        ready = prepare_run("fit", self.system, given, settings, events, until - begin, None, controllers)
        run = Run(self.system, ready.first, until, settings, events, begin, controllers=controllers)
        with interruptible() as interrupted:
            run.advance(interrupted=interrupted)
        self._latest = uninterrupted(run)
        ended = run.outcome in ENDED_WELL and run.stepper.t >= until - _ROUND_OFF
        unbalanced = open_ledger(run) if ended else ""
        return RunSamples(run.samples.chunk, run.present(), "" if ended else run.message, unbalanced)

    def counted(self, chunk: Chunk) -> Chunk:
        """Return one state twice, with all integrals larger by 1 in the second.

        A quantity that differs between both counts from a run's start on, as work does: pieces of a run, and
        perturbed states, do not have it.
        """
        both = Chunk.joined([chunk.part(0, 1), chunk.part(0, 1)])
        system, first = self.system, self.system.model.nq + self.system.model.nv
        books = np.ones(system.manifold.nx, dtype=bool)
        books[np.asarray(system.bristle_x, dtype=int)] = False
        books[list(system.turn_x.values())] = False
        states = both.states.copy()
        states[1, first:][books] += 1.0
        return both._replace(states=states)

    def data(self, chunk: Chunk) -> xr.Dataset:
        """Return states of this system, possibly of several runs, as a result.

        Integrals along a run, such as work, count from the first state.
        """
        if self._latest is None:
            first, settings = np.ascontiguousarray(chunk.states[0]), settings_of(self.scenario)
            self._latest = Run(self.system, first, 1.0, settings)
        return labelled_at(self._latest, chunk)


# --- pieces of a record -------------------------------------------------------------------------------------


def piece_times(length: float, until: float) -> tuple[float, ...]:
    """Return the borders of pieces of a length [s] up to an end [s]."""
    count = max(1, round(until / length))
    return (*(k * length for k in range(count)), until)


@functools.lru_cache(maxsize=4)
def _system(begun: str) -> System:
    return build_system(Scenario.model_validate_json(begun))


@functools.lru_cache(maxsize=1024)
def _chart(begun: str, origin: str) -> Chart:
    """Return the chart about an origin, with the start values' units."""
    return Chart(_system(begun), State.from_json(origin))


def start_size(begun: str, origin: str) -> int:
    """Return the number of coordinates of a piece's start: positions and rates."""
    return 2 * _chart(begun, origin).positions


def piece_start(begun: str, origin: str, z: Array, system: System) -> State:
    """Return the state of a system at coordinates z about an origin, (coordinates,).

    A journal that penetrates the wall there, without contact at the origin, is in contact as at the start of
    a
    scenario: with its present speed as approach speed.
    """
    chart = _chart(begun, origin)
    whole = np.zeros(chart.size)
    whole[: len(z)] = z
    return with_contacts(chart.state(whole, system), system)


def with_contacts(state: State, system: System) -> State:
    """Return a state in which contacts without a gap touch, new ones as at onset.

    A run from inside the wall would otherwise detect them in its first step, at a time that no perturbed
    run's depth and speed move.
    """
    if not system.contact_names:
        return state
    first, books = contact_memory(system, state.y), state.x
    new = np.flatnonzero((first[:, 0] != 0.0) & (state.memory[:, 0] == 0.0)).tolist()
    if not new:
        return state
    memory = state.memory.copy()
    memory[new] = first[new]
    contacts = [
        OpenContact(
            contact=c,
            onset=state.time,
            approach_speed=float(first[c, 1]),
            effective_mass=float(first[c, 2]),
            impulse=-float(books[system.impulse_x[c]]),
            dissipated=-float(books[system.lost_normal_x[c]] + books[system.lost_friction_x[c]]),
            peak=(0.0, state.time, 0.0),
            peak_state=np.zeros(0),
            peak_memory=np.zeros((0, 3)),
        )
        for c in new
    ]
    every = sorted((*state.contacts, *contacts), key=lambda one: one.contact)
    return dataclasses.replace(state, memory=memory, contacts=tuple(every))


def difference_from_origin(begun: str, origin: str, q: Array, v: Array) -> Array:
    """Return configuration and velocity relative to an origin, (2 nv,), in error scales."""
    chart = _chart(begun, origin)
    way = configuration_difference(chart.system, chart.origin.q, q) / chart.units.position
    return np.concatenate([way, (v - chart.origin.v) / chart.units.rate])


# --- readings of runs ---------------------------------------------------------------------------------------


class NoRunError(AntennaPinError, RuntimeError):
    """Values of the unknowns without a run; the message gives the reason."""


@dataclass(frozen=True, slots=True)
class RecordTest:
    """Test of a record as plain data, for any process that makes its runs."""

    name: str  # of the record
    scenario: str  # as JSON, without fitted values
    keys: tuple[tuple[str, ...], ...]  # scenario keys of each of :attr:`RunRequest.values`
    units: tuple[str, ...]  # of those values
    sizes: tuple[float, ...]  # of those values, for difference steps [SI]
    columns: Mapping[str, ColumnSpec]  # columns to read, by name
    read_in: Mapping[str, str]  # SI units of the readings
    time: Array  # of the rows, by the file's clock [s]
    names: tuple[str, ...] = ()  # of those values, in derived expressions
    derived: tuple[tuple[tuple[str, ...], str], ...] = ()  # keys and expression of each derived number
    pieces: tuple[float, ...] = ()  # borders of the pieces, the end included [s]; () for a whole run
    origins: tuple[str, ...] = ()  # start states of the pieces but the first, as text
    begun: str = ""  # scenario of these states, with start values, as JSON; "" for a whole run


#: Start of a whole run.
_WHOLE: tuple[tuple[int, tuple[float, ...]], ...] = ((-1, ()),)


class RunRequest(NamedTuple):
    """Runs of one test requested together."""

    record: int  # index of the test
    values: tuple[float, ...]  # of the scenario's fitted keys [SI]
    shift: float  # of the clock [s]
    # index of a piece, -1 for the whole, and coordinates of its start
    starts: tuple[tuple[int, tuple[float, ...]], ...] = _WHOLE
    slopes: bool = False  # with derivatives, by the variational equation
    clock: bool = False  # with derivatives over time


class ReadingSlopes(NamedTuple):
    """Derivatives of a run's readings by parameters [1/SI], and by its start."""

    columns: tuple[Array, ...]  # per sensor, (rows, fitted)
    lead: Array  # (coordinates, fitted)
    end: Array  # (coordinates, fitted)
    clock: tuple[Array, ...] | None = None  # per sensor, over time [1/s]; None if not requested


class Readings(NamedTuple):
    """Readings of one run."""

    columns: tuple[Array, ...]  # per sensor at the rows, before gain and offset
    lead: Array  # start of a piece relative to its origin, in error scales; () for the first
    end: Array  # end of a piece relative to the next origin, in error scales; () for the last
    failed: str = ""  # reason for a missing run; "" for a run
    slopes: ReadingSlopes | None = None  # derivatives, if requested
    unbalanced: str = ""  # imbalance of energy or momentum as text; "" if balanced


@functools.lru_cache(maxsize=16)
def _scenario(text: str) -> Scenario:
    return Scenario.model_validate_json(text)


def scenario_with(test: RecordTest, values: tuple[float, ...]) -> Scenario:
    """Return a record's scenario with values of its fitted keys [SI]."""
    return _scenario_with(*_assembly(test, values))


def _assembly(test: RecordTest, values: tuple[float, ...]) -> tuple[Any, ...]:
    """Return the arguments of a record's scenario with values."""
    every, units, numbers = list(test.keys), list(test.units), list(values)
    for keys, expression in test.derived:
        try:
            numbers.append(evaluate(expression, dict(zip(test.names, values, strict=True))))
        except ValueError as error:
            raise ScenarioError(f"derived: {error}") from None
        every.append(keys)
        units.append("")
    return test.scenario, tuple(every), tuple(units), tuple(numbers)


def _scenario_with(
    text: str, every: tuple[tuple[str, ...], ...], units: tuple[str, ...], values: tuple[float, ...]
) -> Scenario:
    base, found = _scenario(text), dict[str, Any]()
    for keys, unit, value in zip(every, units, values, strict=True):
        for key in keys:
            put_value(found, key, f"{value!r} {unit}" if unit not in ("", "1") else value, base)
    return base.with_overrides(found) if found else base


@functools.lru_cache(maxsize=4)
def _cached_scenario(*test: Any) -> PreparedScenario:
    return PreparedScenario(_scenario_with(*test))


def prepared_scenario(test: RecordTest, values: tuple[float, ...]) -> PreparedScenario:
    """Return a record's test with values of its fitted keys [SI]."""
    return _cached_scenario(*_assembly(test, values))


def make_runs(test: RecordTest, request: RunRequest) -> tuple[Readings, ...]:
    """Make some runs and read their sensors, once for each start."""
    try:
        bench = prepared_scenario(test, request.values)
        rows = [piece_rows(test, request.shift, piece) for piece, _ in request.starts]
        made = [_run_piece(test, bench, one, *start) for one, start in zip(rows, request.starts, strict=True)]
        good = [k for k, one in enumerate(made) if isinstance(one, _PieceRun)]
        chunks = [one.ran.chunk for one in made if isinstance(one, _PieceRun)]
        read = dict(zip(good, sensor_readings(test, bench, [rows[k] for k in good], chunks), strict=True))
    except Exception as error:
        return tuple(failed_readings(failure_reason(error)) for _ in request.starts)
    return tuple(
        Readings(tuple(read[k]), one.lead, one.end, unbalanced=one.ran.unbalanced)
        if isinstance(one, _PieceRun)
        else failed_readings(one)
        for k, one in enumerate(made)
    )


class _PieceRun(NamedTuple):
    """Completed run with start and end relative to origins, as in :class:`Readings`."""

    ran: RunSamples
    lead: Array
    end: Array


def piece_rows(test: RecordTest, shift: float, piece: int) -> Array:
    """Return the rows of a piece, -1 for the whole, by the run's clock [s]."""
    rows = test.time + shift
    if not test.pieces:
        return rows
    begin, end = test.pieces[piece : piece + 2]
    last = piece == len(test.pieces) - 2
    return rows[(rows >= begin) & ((rows <= end) if last else (rows < end))]


def piece_end(test: RecordTest, bench: PreparedScenario, piece: int, rows: Array) -> float:
    """Return the end of a piece's run, -1 for the whole [s]."""
    if test.pieces:
        return test.pieces[piece + 1]
    until = bench.scenario.duration
    return min(until, float(rows[-1])) if rows[-1] > 0.0 else until


def _run_piece(
    test: RecordTest, bench: PreparedScenario, rows: Array, piece: int, at: tuple[float, ...]
) -> _PieceRun | str:
    """Make one run, or return the reason for none."""
    start, lead, joint = None, np.zeros(0), np.zeros(0)
    wanted = [sample_times(column, rows) for column in test.columns.values()]
    try:
        if piece > 0:
            start = piece_start(test.begun, test.origins[piece - 1], np.array(at), bench.system)
            lead = difference_from_origin(test.begun, test.origins[piece - 1], start.q, start.v)
        ran = bench.run(np.unique(np.concatenate(wanted)), piece_end(test, bench, piece, rows), start)
    except Exception as error:
        return failure_reason(error)
    if test.pieces and piece < len(test.pieces) - 2:
        joint = difference_from_origin(test.begun, test.origins[piece], ran.end.q, ran.end.v)
    return ran.failed or _PieceRun(ran, lead, joint)


def sensor_readings(
    test: RecordTest, bench: PreparedScenario, rows: Sequence[Array], chunks: Sequence[Chunk]
) -> list[list[Array]]:
    """Return the readings of some runs, by run and sensor.

    All runs are read at once, as reading takes longer than a short run.
    """
    read: list[list[Array]] = [[] for _ in rows]
    if not rows:
        return read
    data = bench.data(Chunk.joined(list(chunks)))
    begins = np.concatenate([[0], np.cumsum([len(one.times) for one in chunks])])
    for name, column in test.columns.items():
        if column.filter is None:
            values = reading(data, column, test.read_in[name], data["time"].values)
            for own, first, one, chunk in zip(read, begins, rows, chunks, strict=False):
                own.append(values[first + np.searchsorted(chunk.times, one, side="right") - 1])
            continue
        for own, first, last, one in zip(read, begins, begins[1:], rows, strict=False):
            part = data if len(rows) == 1 else data.isel(time=slice(first, last))
            own.append(reading(part, column, test.read_in[name], one))
    return read


def failure_reason(error: Exception) -> str:
    """Return the reason for a failed run: a refusal, or an unexpected error; raise interruptions."""
    if is_interruption(error):
        raise error
    if isinstance(error, AntennaPinError):
        return str(error)
    return f"the run died of {type(error).__name__}: {' '.join(str(error).split())}"


def failed_readings(why: str) -> Readings:
    """Return readings of a failed run, with the reason."""
    return Readings((), np.zeros(0), np.zeros(0), why)
