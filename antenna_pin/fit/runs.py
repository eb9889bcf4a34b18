"""Runs of a record's test, whole or in pieces (multiple shooting), and the readings of its sensors.

A motion with impacts forgets its start: over a long record the sum of squares has a valley for each order in
which impacts can follow one another. Over a piece it does not, and the gaps between pieces are further
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
from numpy.typing import NDArray

from antenna_pin.assemble import build_system, initial_angles, initial_state
from antenna_pin.base.interruption import interruptible, is_interruption
from antenna_pin.base.state import OpenContact, State
from antenna_pin.dynamics import System, contact_memory
from antenna_pin.errors import AntennaPinError, ScenarioError
from antenna_pin.fit.sensors import instants, reading
from antenna_pin.fit.specs import ColumnSpec, evaluate
from antenna_pin.nonlinear import Chart, Flow
from antenna_pin.nonlinear.coordinates import configuration_difference
from antenna_pin.scenario import Scenario
from antenna_pin.simulation.inputs import RunStart, controllers_of, events_of, prepared, settings_of
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.recorder import labelled_at, open_ledger
from antenna_pin.simulation.samples import Chunk
from antenna_pin.sweep.design import put_value
from antenna_pin.trajectory import ENDED_WELL, Outcome

__all__ = [
    "Asked",
    "Bench",
    "NoRunError",
    "Ran",
    "Readings",
    "Rig",
    "Slopes",
    "WHOLE",
    "at_times",
    "bench_of",
    "from_origin",
    "instants_of",
    "make",
    "nothing",
    "piece_start",
    "reason_of",
    "rows_of",
    "scenario_with",
    "sensed",
    "touching",
    "until_of",
    "ways_of",
]

Array = NDArray[np.float64]

# --- a scenario set up once ---------------------------------------------------------------------------------

_ROUND_OFF = 1e-12  # by which a run may end before its end [s]


class Ran(NamedTuple):
    """One run.

    Attributes:
        chunk: Its samples.
        end: The state that it came to.
        failed: Why it did not come to its end, in words; "" if it did.
        unbalanced: How its energy or momentum does not balance, in words; "" if both do.
    """

    chunk: Chunk
    end: State
    failed: str
    unbalanced: str = ""


class Bench:
    """A scenario with its system, which is built once.

    Args:
        scenario: What is run.
    """

    def __init__(self, scenario: Scenario) -> None:
        """Build the system."""
        self.scenario, self.system = scenario, build_system(scenario)
        self._latest: Run | None = None

    @cached_property
    def _first(self) -> RunStart:
        q, v = initial_state(self.scenario, self.system)
        return RunStart(q, v, initial_angles(self.scenario, self.system))

    @cached_property
    def flow(self) -> Flow:
        """The system's flow, as its runs are integrated."""
        return Flow(self.system, settings_of(self.scenario), events_of(self.scenario), self.scenario)

    @cached_property
    def first(self) -> State:
        """The state that the scenario starts from."""
        q, v = initial_state(self.scenario, self.system)
        return self.flow.first(q, v, initial_angles(self.scenario, self.system))

    def run(self, times: Array, until: float, start: State | None = None) -> Ran:
        """Make a run that is sampled at times, rising [s], and goes on until an instant [s].

        Args:
            times: Of its samples, beside its start and end; those of the run's span count.
            until: Its end [s].
            start: From where; the scenario's start if left out.

        Raises:
            AntennaPinError: It cannot begin.
            KeyboardInterrupt: It was interrupted.
        """
        begin = 0.0 if start is None else start.reached
        settings = dataclasses.replace(
            settings_of(self.scenario),
            accuracy=None,
            output_rate=0.5 / (until - begin),
            output_times=tuple(times[(times >= begin) & (times <= until)].tolist()),
            output_form="full",
        )
        given = self._first if start is None else RunStart(start=start)
        events, controllers = events_of(self.scenario), controllers_of(self.scenario)
        ready = prepared("fit", self.system, given, settings, events, until - begin, None, controllers)
        run = Run(self.system, ready.first, until, settings, events, begin, controllers=controllers)
        with interruptible() as interrupted:
            run.advance(interrupted=interrupted)
        if run.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        self._latest = run
        ended = run.outcome in ENDED_WELL and run.stepper.t >= until - _ROUND_OFF
        unbalanced = open_ledger(run) if ended else ""
        return Ran(run.samples.held, run.present(), "" if ended else run.message, unbalanced)

    def counted(self, chunk: Chunk) -> Chunk:
        """Return one state twice, all that is integrated along a run larger by 1 in the second.

        What is not the same of both counts from a run's start on, as work does: pieces of a run, and states
        displaced, do not have it.
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
        """Return what states of this system show, as a result has it; they may be of several of its runs.

        What is integrated along a run, as work is, counts from the first of them.
        """
        if self._latest is None:
            first, settings = np.ascontiguousarray(chunk.states[0]), settings_of(self.scenario)
            self._latest = Run(self.system, first, 1.0, settings)
        return labelled_at(self._latest, chunk)


def at_times(chunk: Chunk, times: Array) -> NDArray[np.intp]:
    """Return the places of samples at times that are among them; of two at an instant, the later one."""
    return np.searchsorted(chunk.times, times, side="right") - 1


# --- pieces of a record -------------------------------------------------------------------------------------


def instants_of(length: float, until: float) -> tuple[float, ...]:
    """Return when pieces of a length [s] begin and the last one ends [s]; it may be shorter, or longer."""
    count = max(1, round(until / length))
    return (*(k * length for k in range(count)), until)


@functools.lru_cache(maxsize=4)
def _system(begun: str) -> System:
    return build_system(Scenario.model_validate_json(begun))


@functools.lru_cache(maxsize=1024)
def _chart(begun: str, origin: str) -> Chart:
    """Return the coordinates about an origin; their units are those of the start values, and stay."""
    return Chart(_system(begun), State.from_json(origin))


def ways_of(begun: str, origin: str) -> int:
    """Return in how many coordinates a piece's start is told: its ways and as many rates.

    Args:
        begun: The scenario with the start values, as JSON.
        origin: A state of it, as text.
    """
    return 2 * _chart(begun, origin).positions


def piece_start(begun: str, origin: str, z: Array, system: System) -> State:
    """Return the state at coordinates z about an origin, (ways,), in error scales, of a system.

    A journal that is in the wall there, and was not touching at the origin, touches as one does that a
    scenario starts from: with its speed there as that of its approach.
    """
    chart = _chart(begun, origin)
    whole = np.zeros(chart.size)
    whole[: len(z)] = z
    return touching(chart.state(whole, system), system)


def touching(state: State, system: System) -> State:
    """Return a state in which contacts without a gap touch: those that did not before as if they began.

    Without it a run from inside the wall would find them begun in its first step, at an instant that no
    neighbour's depth and speed there move.
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


def from_origin(begun: str, origin: str, q: Array, v: Array) -> Array:
    """Return the way from an origin to a configuration and velocity, (2 nv,), in error scales."""
    chart = _chart(begun, origin)
    way = configuration_difference(chart.system, chart.origin.q, q) / chart.units.position
    return np.concatenate([way, (v - chart.origin.v) / chart.units.rate])


# --- readings of runs ---------------------------------------------------------------------------------------


class NoRunError(AntennaPinError, RuntimeError):
    """For some values of what is unknown there is no run; the message says why."""


@dataclass(frozen=True, slots=True)
class Rig:
    """A record's test as data, which goes to whoever makes its runs.

    Attributes:
        name: Of the record.
        scenario: Its scenario as JSON, before what is fitted.
        keys: Of the scenario that are fitted, one tuple for each of :attr:`Asked.values`.
        names: Of those values: what :attr:`derived` calls them.
        derived: Numbers of the scenario that follow from the values: keys and expression of each.
        units: Of those values.
        sizes: Of those values: what a change is small beside [SI].
        columns: What is read, by name.
        read_in: SI unit of each.
        time: Of the rows, by the file's clock [s].
        pieces: Instants at which pieces begin and the last one ends [s]; () of a whole run.
        origins: State about which each piece's start is told, but the first's, as text.
        begun: The scenario whose states these are, with the start values, as JSON; "" of a whole run.
    """

    name: str
    scenario: str
    keys: tuple[tuple[str, ...], ...]
    units: tuple[str, ...]
    sizes: tuple[float, ...]
    columns: Mapping[str, ColumnSpec]
    read_in: Mapping[str, str]
    time: Array
    names: tuple[str, ...] = ()
    derived: tuple[tuple[tuple[str, ...], str], ...] = ()
    pieces: tuple[float, ...] = ()
    origins: tuple[str, ...] = ()
    begun: str = ""


#: The one start of a run that is in no pieces.
WHOLE: tuple[tuple[int, tuple[float, ...]], ...] = ((-1, ()),)


class Asked(NamedTuple):
    """Runs that are asked for together, of one test: what they are run on is built once.

    Attributes:
        record: Number of its rig.
        values: Of its scenario's fitted keys [SI].
        shift: Of its clock [s].
        starts: Number of a piece, -1 for the whole, and where it starts: coordinates about its origin.
        slopes: Whether with derivatives, by the variational equation.
        clock: Whether with those over time.
    """

    record: int
    values: tuple[float, ...]
    shift: float
    starts: tuple[tuple[int, tuple[float, ...]], ...] = WHOLE
    slopes: bool = False
    clock: bool = False


class Slopes(NamedTuple):
    """Derivatives of what came of a run by the scenario's fitted numbers [1/SI], and by its start.

    Attributes:
        columns: Of what each sensor reads, (rows, fitted).
        lead: (ways, fitted).
        end: Likewise.
        clock: Of what each sensor reads over time [1/s]; None if not asked for.
    """

    columns: tuple[Array, ...]
    lead: Array
    end: Array
    clock: tuple[Array, ...] | None = None


class Readings(NamedTuple):
    """What came of one run.

    Attributes:
        columns: What each sensor reads at the rows, before gain and offset.
        lead: Of a piece: the way from its origin to where it starts, in error scales; () of the first.
        end: Of a piece that another follows: the way from that one's origin to its end; () of the last.
        failed: Why there is nothing, in words; "" if there is.
        slopes: Derivatives, if they were asked for.
        unbalanced: How the run's energy or momentum does not balance, in words; "" if both do.
    """

    columns: tuple[Array, ...]
    lead: Array
    end: Array
    failed: str = ""
    slopes: Slopes | None = None
    unbalanced: str = ""


@functools.lru_cache(maxsize=16)
def _scenario(text: str) -> Scenario:
    return Scenario.model_validate_json(text)


def scenario_with(rig: Rig, values: tuple[float, ...]) -> Scenario:
    """Return a record's scenario with values of its fitted keys [SI]."""
    return _scenario_with(*_assembly(rig, values))


def _assembly(rig: Rig, values: tuple[float, ...]) -> tuple[Any, ...]:
    """Return what a record's scenario with values is made of.

    Raises:
        ScenarioError: A derived number is none there.
    """
    every, units, numbers = list(rig.keys), list(rig.units), list(values)
    for keys, expression in rig.derived:
        try:
            numbers.append(evaluate(expression, dict(zip(rig.names, values, strict=True))))
        except ValueError as error:
            raise ScenarioError(f"derived: {error}") from None
        every.append(keys)
        units.append("")
    return rig.scenario, tuple(every), tuple(units), tuple(numbers)


def _scenario_with(
    text: str, every: tuple[tuple[str, ...], ...], units: tuple[str, ...], values: tuple[float, ...]
) -> Scenario:
    base, found = _scenario(text), dict[str, Any]()
    for keys, unit, value in zip(every, units, values, strict=True):
        for key in keys:
            put_value(found, key, f"{value!r} {unit}" if unit not in ("", "1") else value, base)
    return base.with_overrides(found) if found else base


@functools.lru_cache(maxsize=4)
def _bench(*test: Any) -> Bench:
    return Bench(_scenario_with(*test))


def bench_of(rig: Rig, values: tuple[float, ...]) -> Bench:
    """Return a record's test with values of its fitted keys [SI], set up."""
    return _bench(*_assembly(rig, values))


def make(rig: Rig, asked: Asked) -> tuple[Readings, ...]:
    """Make some runs and read their sensors, one answer a start.

    Raises:
        KeyboardInterrupt: It was interrupted.
    """
    try:
        bench = bench_of(rig, asked.values)
        rows = [rows_of(rig, asked.shift, piece) for piece, _ in asked.starts]
        made = [_ran(rig, bench, one, *start) for one, start in zip(rows, asked.starts, strict=True)]
        good = [k for k, one in enumerate(made) if isinstance(one, _Made)]
        chunks = [one.ran.chunk for one in made if isinstance(one, _Made)]
        read = dict(zip(good, sensed(rig, bench, [rows[k] for k in good], chunks), strict=True))
    except Exception as error:
        return tuple(nothing(reason_of(error)) for _ in asked.starts)
    return tuple(
        Readings(tuple(read[k]), one.lead, one.end, unbalanced=one.ran.unbalanced)
        if isinstance(one, _Made)
        else nothing(one)
        for k, one in enumerate(made)
    )


class _Made(NamedTuple):
    """A run that came to its end.

    Attributes:
        ran: The run.
        lead: As of :class:`Readings`.
        end: Likewise.
    """

    ran: Ran
    lead: Array
    end: Array


def rows_of(rig: Rig, shift: float, piece: int) -> Array:
    """Return the rows of a piece, -1 for the whole, by the run's clock [s]."""
    rows = rig.time + shift
    if not rig.pieces:
        return rows
    begin, end = rig.pieces[piece : piece + 2]
    last = piece == len(rig.pieces) - 2
    return rows[(rows >= begin) & ((rows <= end) if last else (rows < end))]


def until_of(rig: Rig, bench: Bench, piece: int, rows: Array) -> float:
    """Return when the run of a piece, -1 for the whole, ends [s]."""
    if rig.pieces:
        return rig.pieces[piece + 1]
    until = bench.scenario.duration
    return min(until, float(rows[-1])) if rows[-1] > 0.0 else until


def _ran(rig: Rig, bench: Bench, rows: Array, piece: int, at: tuple[float, ...]) -> _Made | str:
    """Make one run, or return why there is none."""
    start, lead, joint = None, np.zeros(0), np.zeros(0)
    wanted = [instants(column, rows) for column in rig.columns.values()]
    try:
        if piece > 0:
            start = piece_start(rig.begun, rig.origins[piece - 1], np.array(at), bench.system)
            lead = from_origin(rig.begun, rig.origins[piece - 1], start.q, start.v)
        ran = bench.run(np.unique(np.concatenate(wanted)), until_of(rig, bench, piece, rows), start)
    except Exception as error:
        return reason_of(error)
    if rig.pieces and piece < len(rig.pieces) - 2:
        joint = from_origin(rig.begun, rig.origins[piece], ran.end.q, ran.end.v)
    return ran.failed or _Made(ran, lead, joint)


def sensed(rig: Rig, bench: Bench, rows: Sequence[Array], chunks: Sequence[Chunk]) -> list[list[Array]]:
    """Return what sensors read of some runs, by run and sensor.

    They are read all at once, which takes longer than a short run does.

    Args:
        rig: Whose sensors.
        bench: Of whose system the runs are.
        rows: Of each, by the run's clock [s].
        chunks: Samples of each, those at which its sensors are asked for among them.
    """
    read: list[list[Array]] = [[] for _ in rows]
    if not rows:
        return read
    data = bench.data(Chunk.joined(list(chunks)))
    begins = np.concatenate([[0], np.cumsum([len(one.times) for one in chunks])])
    for name, column in rig.columns.items():
        if column.filter is None:
            values = reading(data, column, rig.read_in[name], data["time"].values)
            for own, first, one, chunk in zip(read, begins, rows, chunks, strict=False):
                own.append(values[first + at_times(chunk, one)])
            continue
        for own, first, last, one in zip(read, begins, begins[1:], rows, strict=False):
            part = data if len(rows) == 1 else data.isel(time=slice(first, last))
            own.append(reading(part, column, rig.read_in[name], one))
    return read


def reason_of(error: Exception) -> str:
    """Return why there is no run, in words: refused, or dead of what nobody expected.

    To a search both are a trial that cannot be made.

    Raises:
        Exception: The same, if it is an interruption.
    """
    if is_interruption(error):
        raise error
    if isinstance(error, AntennaPinError):
        return str(error)
    return f"the run died of {type(error).__name__}: {' '.join(str(error).split())}"


def nothing(why: str) -> Readings:
    """Return what came of a run of which nothing did, with why."""
    return Readings((), np.zeros(0), np.zeros(0), why)
