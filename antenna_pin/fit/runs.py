"""What a record's sensors would read for values of what is unknown: one run, or one of each piece."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.assemble import build_system, initial_angles, initial_state
from antenna_pin.dynamics import System
from antenna_pin.errors import AntennaPinError
from antenna_pin.fit.columns import ColumnSpec
from antenna_pin.fit.pieces import from_origin, piece_start
from antenna_pin.fit.sensors import instants, reading
from antenna_pin.scenario import Scenario
from antenna_pin.simulation import simulate
from antenna_pin.simulation.from_scenario import controllers_of, events_of
from antenna_pin.simulation.run import settings_of
from antenna_pin.state import State
from antenna_pin.sweep.design import put_value
from antenna_pin.trajectory import Outcome, Trajectory

__all__ = ["Asked", "NoRunError", "Readings", "Rig", "make", "make_all", "run_at", "scenario_with"]

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


class Asked(NamedTuple):
    """One run that is asked for: of which record, with which numbers.

    Attributes:
        record: Number of its rig.
        values: Of its scenario's fitted keys [SI].
        shift: Of its clock [s].
        piece: Number of the piece; -1 for the whole.
        start: Of the piece: coordinates about its origin.
    """

    record: int
    values: tuple[float, ...]
    shift: float
    piece: int = -1
    start: tuple[float, ...] = ()


class Readings(NamedTuple):
    """What came of it.

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
    base, found = _scenario(rig.scenario), dict[str, Any]()
    for keys, unit, value in zip(rig.keys, rig.units, values, strict=True):
        for key in keys:
            put_value(found, key, f"{value!r} {unit}" if unit not in ("", "1") else value, base)
    return base.with_overrides(found) if found else base


def run_at(
    scenario: Scenario,
    times: Array,
    until: float,
    start: State | None = None,
    system: System | None = None,
) -> Trajectory:
    """Return a run that is sampled at times, rising [s], and goes on until an instant [s].

    Args:
        scenario: What is run.
        times: Of its samples.
        until: Its end [s].
        start: From where; the scenario's start if left out.
        system: The scenario's; made if left out.
    """
    system = system or build_system(scenario)
    begin = 0.0 if start is None else start.reached
    within = times[(times >= begin) & (times <= until)]
    settings = dataclasses.replace(
        settings_of(scenario),
        accuracy=None,
        output_rate=0.5 / (until - begin),
        output_times=tuple(within.tolist()),
        output_form="full",
    )
    more: dict[str, Any] = {"start": start}
    if start is None:
        q, v = initial_state(scenario, system)
        more = {"q": q, "v": v, "angles": initial_angles(scenario, system)}
    return simulate(
        system,
        duration=until - begin,
        settings=settings,
        events=events_of(scenario),
        controllers=controllers_of(scenario),
        **more,
    )


def at_instants(data: xr.Dataset, times: Array) -> xr.Dataset:
    """Return a result's samples at times that are among them; of two at an instant, the one after it."""
    found = np.searchsorted(data["time"].values, times, side="right") - 1
    return data.isel(time=found)


def make(rig: Rig, asked: Asked) -> Readings:
    """Make one run and read its sensors.

    Raises:
        KeyboardInterrupt: It was interrupted.
    """
    try:
        return _made(rig, asked)
    except AntennaPinError as error:
        return _nothing(str(error))


def _made(rig: Rig, asked: Asked) -> Readings:
    scenario = scenario_with(rig, asked.values)
    system = build_system(scenario)
    rows, start, end = rig.time + asked.shift, None, scenario.duration
    if rig.pieces:
        begin, end = rig.pieces[asked.piece : asked.piece + 2]
        last = asked.piece == len(rig.pieces) - 2
        rows = rows[(rows >= begin) & ((rows <= end) if last else (rows < end))]
        if asked.piece > 0:
            start = piece_start(rig.begun, rig.origins[asked.piece - 1], np.array(asked.start), system)
    else:
        end = min(end, float(rows[-1])) if rows[-1] > 0.0 else end
    wanted = [instants(column, rows) for column in rig.columns.values()]
    run = run_at(scenario, np.unique(np.concatenate(wanted)), end, start, system)
    if run.outcome is Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    if float(run.data.attrs["end_time"]) < rows[-1] - 1e-12:
        return _nothing(run.message)
    seen: dict[bytes, xr.Dataset] = {}  # of columns without filters the same, which takes longer than the run
    for times in wanted:
        if times.tobytes() not in seen:
            seen[times.tobytes()] = at_instants(run.data, times)
    columns = tuple(
        reading(seen[times.tobytes()], column, rig.read_in[name], rows)
        for (name, column), times in zip(rig.columns.items(), wanted, strict=True)
    )
    lead = joint = np.zeros(0)
    if start is not None:
        lead = from_origin(rig.begun, rig.origins[asked.piece - 1], start.q, start.v)
    if rig.pieces and asked.piece < len(rig.pieces) - 2:
        q, v = (run.data[name].values[-1] for name in "qv")
        joint = from_origin(rig.begun, rig.origins[asked.piece], q, v)
    return Readings(columns, lead, joint)


def _nothing(why: str) -> Readings:
    return Readings((), np.zeros(0), np.zeros(0), why)


def make_all(rigs: tuple[Rig, ...], batch: list[Asked]) -> list[Readings]:
    """Make several runs, one after the other: what an executor calls."""
    return [make(rigs[asked.record], asked) for asked in batch]
