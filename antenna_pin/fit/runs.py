"""What a record's sensors would read for values of what is unknown: one run, or one of each piece."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.interruption import is_interruption
from antenna_pin.errors import AntennaPinError, ScenarioError
from antenna_pin.fit.bench import Bench, Ran, at_times
from antenna_pin.fit.columns import ColumnSpec
from antenna_pin.fit.expressions import evaluate
from antenna_pin.fit.pieces import from_origin, piece_start
from antenna_pin.fit.sensors import instants, reading
from antenna_pin.scenario import Scenario
from antenna_pin.simulation.samples import Chunk
from antenna_pin.sweep.design import put_value

__all__ = [
    "WHOLE",
    "Asked",
    "NoRunError",
    "Readings",
    "Rig",
    "Slopes",
    "bench_of",
    "make",
    "nothing",
    "rows_of",
    "scenario_with",
    "sensed",
    "until_of",
    "reason_of",
]

Array = NDArray[np.float64]


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
