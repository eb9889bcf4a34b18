"""What a record's sensors would read for values of what is unknown: one run, or one of each piece."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.errors import AntennaPinError
from antenna_pin.fit.bench import Bench, Ran, at_times
from antenna_pin.fit.columns import ColumnSpec
from antenna_pin.fit.pieces import from_origin, piece_start
from antenna_pin.fit.sensors import instants, reading
from antenna_pin.scenario import Scenario
from antenna_pin.simulation.samples import Chunk
from antenna_pin.state import State
from antenna_pin.sweep.design import put_value

__all__ = ["WHOLE", "Asked", "NoRunError", "Readings", "Rig", "make", "make_all", "scenario_with"]

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
        units: Of those values.
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
    columns: Mapping[str, ColumnSpec]
    read_in: Mapping[str, str]
    time: Array
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
    """

    record: int
    values: tuple[float, ...]
    shift: float
    starts: tuple[tuple[int, tuple[float, ...]], ...] = WHOLE


class Readings(NamedTuple):
    """What came of one run.

    Attributes:
        columns: What each sensor reads at the rows, before gain and offset.
        lead: Of a piece: the way from its origin to where it starts, in error scales; () of the first.
        end: Of a piece that another follows: the way from that one's origin to its end; () of the last.
        failed: Why there is nothing, in words; "" if there is.
    """

    columns: tuple[Array, ...]
    lead: Array
    end: Array
    failed: str = ""


@functools.lru_cache(maxsize=16)
def _scenario(text: str) -> Scenario:
    return Scenario.model_validate_json(text)


def scenario_with(rig: Rig, values: tuple[float, ...]) -> Scenario:
    """Return a record's scenario with values of its fitted keys [SI]."""
    return _scenario_with(rig.scenario, rig.keys, rig.units, values)


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


def make(rig: Rig, asked: Asked) -> tuple[Readings, ...]:
    """Make some runs and read their sensors, one answer a start.

    Raises:
        KeyboardInterrupt: It was interrupted.
    """
    try:
        bench = _bench(rig.scenario, rig.keys, rig.units, asked.values)
        rows = [_rows(rig, asked.shift, piece) for piece, _ in asked.starts]
        made = [_ran(rig, bench, one, *start) for one, start in zip(rows, asked.starts, strict=True)]
        return _read(rig, bench, rows, made)
    except AntennaPinError as error:
        return tuple(_nothing(str(error)) for _ in asked.starts)


class _Made(NamedTuple):
    """A run of a piece, or the whole one.

    Attributes:
        ran: The run; None if it could not begin.
        lead: As of :class:`Readings`.
        end: Likewise.
        failed: Likewise.
    """

    ran: Ran | None
    lead: Array
    end: Array
    failed: str


def _rows(rig: Rig, shift: float, piece: int) -> Array:
    """Return the rows of a piece, by the run's clock [s]."""
    rows = rig.time + shift
    if not rig.pieces:
        return rows
    begin, end = rig.pieces[piece : piece + 2]
    last = piece == len(rig.pieces) - 2
    return rows[(rows >= begin) & ((rows <= end) if last else (rows < end))]


def _ran(rig: Rig, bench: Bench, rows: Array, piece: int, at: tuple[float, ...]) -> _Made:
    """Make one run."""
    nothing, start = np.zeros(0), None
    wanted = [instants(column, rows) for column in rig.columns.values()]
    try:
        if rig.pieces:
            until = rig.pieces[piece + 1]
            if piece > 0:
                start = piece_start(rig.begun, rig.origins[piece - 1], np.array(at), bench.system)
        else:
            until = bench.scenario.duration
            until = min(until, float(rows[-1])) if rows[-1] > 0.0 else until
        ran = bench.run(np.unique(np.concatenate(wanted)), until, start)
    except AntennaPinError as error:
        return _Made(None, nothing, nothing, str(error))
    return _Made(ran, *_ways(rig, piece, start, ran.end), ran.failed)


def _ways(rig: Rig, piece: int, start: State | None, end: State) -> tuple[Array, Array]:
    """Return where a piece starts and ends, about its origin and the next one's."""
    lead = joint = np.zeros(0)
    if start is not None:
        lead = from_origin(rig.begun, rig.origins[piece - 1], start.q, start.v)
    if rig.pieces and piece < len(rig.pieces) - 2:
        joint = from_origin(rig.begun, rig.origins[piece], end.q, end.v)
    return lead, joint


def _read(rig: Rig, bench: Bench, rows: Sequence[Array], made: Sequence[_Made]) -> tuple[Readings, ...]:
    """Read the sensors of runs: of all of them at once, which takes longer than a short run does."""
    good = [k for k, one in enumerate(made) if not one.failed]
    seen: dict[bytes, Any] = {}  # of columns without filters the same
    columns: list[list[Array]] = [[] for _ in made]
    for name, column in rig.columns.items() if good else ():
        wanted = [instants(column, rows[k]) for k in good]
        key = b"|".join(one.tobytes() for one in wanted)
        if key not in seen:
            chunks = [
                at_times(one.ran.chunk, times)
                for one, times in zip((made[k] for k in good), wanted, strict=True)
                if one.ran is not None
            ]
            seen[key] = bench.data(Chunk.joined(chunks))
        read = reading(seen[key], column, rig.read_in[name], np.concatenate([rows[k] for k in good]))
        ends = np.cumsum([len(rows[k]) for k in good])
        for k, part in zip(good, np.split(read, ends[:-1]), strict=True):
            columns[k].append(part)
    return tuple(
        _nothing(one.failed) if one.failed else Readings(tuple(parts), one.lead, one.end)
        for one, parts in zip(made, columns, strict=True)
    )


def _nothing(why: str) -> Readings:
    return Readings((), np.zeros(0), np.zeros(0), why)


def make_all(rigs: tuple[Rig, ...], batch: list[Asked]) -> list[tuple[Readings, ...]]:
    """Make what is asked for, one after the other: what an executor calls."""
    return [make(rigs[asked.record], asked) for asked in batch]
