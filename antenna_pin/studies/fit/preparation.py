"""Records of a fit in SI units with their scenarios, checked before any long run."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.base.arrays import Array
from antenna_pin.base.parameters import LARGEST
from antenna_pin.base.units import unit_factor
from antenna_pin.errors import AntennaPinError, ScenarioError
from antenna_pin.run.simulation.inputs import check_without_controllers
from antenna_pin.scenario import Scenario
from antenna_pin.studies.fit.kalman_filter import ColumnData, ParameterEstimate, estimate_starts
from antenna_pin.studies.fit.plan import FitPlan, RecordSpec, Unknowns, parameter_size, record_place
from antenna_pin.studies.fit.record_file import read_columns
from antenna_pin.studies.fit.runs import PreparedScenario, RecordTest, piece_times, scenario_with, start_size
from antenna_pin.studies.fit.sensors import (
    Target,
    check_sensor,
    comparison_target,
    reading,
    reading_noise,
    sensor_unit,
    si_amount,
)
from antenna_pin.studies.fit.specs import ColumnSpec, evaluate
from antenna_pin.studies.sweep.design import put_value

# --- measured records ---------------------------------------------------------------------------------------

# Steps of a clock over their median from which rows are missing; relative deviation of even steps.
_GAP, _EVEN = 5.5, 1e-3
# Rows in succession at an extreme value that noise does not explain.
_STAYS = 5


@dataclass(frozen=True, slots=True)
class _MeasuredData:
    """Measured data of a record."""

    time: Array  # of the rows that count, by the file's clock, rising [s]
    values: Mapping[str, Array]  # of the columns in SI units, by name, (rows,)
    notes: tuple[str, ...] = ()  # oddities, a line each


def _read_record(spec: RecordSpec, folder: Path, units: Mapping[str, str], place: str) -> _MeasuredData:
    """Return a record from its file, or refuse it."""
    in_file = {name: one.column or name for name, one in spec.columns.items()}
    path = folder / os.path.expanduser(spec.file)
    for name, one in spec.columns.items():  # what is written wrongly is told before a file is read
        _factor(one, None, units[name], f"{place}.columns.{name}")
    columns = read_columns(path, list(dict.fromkeys(in_file.values())), spec, place)
    time = columns.time
    values = {
        name: columns.values[in_file[name]]
        * _factor(one, columns.units.get(in_file[name]), units[name], f"{place}.columns.{name}")
        for name, one in spec.columns.items()
    }
    where, clock = f"{place}: {path.name}", spec.time if spec.rate is None else "rate"
    kept = np.ones(len(time), dtype=bool)
    if not np.all(np.isfinite(time)):
        row = int(np.flatnonzero(~np.isfinite(time))[0]) + 1
        raise ScenarioError(f"{where}: {clock} must be a number in each row, got none in row {row}")
    _check_rising(time, f"{where}: {clock}")
    if spec.window is not None:
        kept &= (time >= spec.window[0]) & (time <= spec.window[1])
        if np.count_nonzero(kept) < 2:
            rule = f"must hold 2 rows at least of {time[0]:g} s to {time[-1]:g} s"
            raise ScenarioError(f"{place}.window {rule}, got {spec.window[0]:g} s to {spec.window[1]:g} s")
    for name, column in values.items():
        bad = kept & ~np.isfinite(column)
        if spec.gaps == "refuse" and bad.any():
            rows = np.flatnonzero(bad)
            row, count = int(rows[0]), len(rows)
            more = f" and {count - 1} others up to row {rows[-1] + 1}" if count > 1 else ""
            raise ScenarioError(
                f"{where}: {in_file[name]} must be a number in each row, got none in row {row + 1}, at "
                f'{time[row]:g} s{more}; give a window, or gaps = "skip"'
            )
        kept &= np.isfinite(column)
    if np.count_nonzero(kept) < 2:
        raise ScenarioError(f"{where} must have 2 rows of numbers at least, got {np.count_nonzero(kept)}")
    time = time[kept]
    if spec.gaps == "refuse":
        _check_gaps(time, where)
    for name, one in spec.columns.items():
        if one.compare in ("spectrum", "blows"):
            _check_even(time, f"{place}.columns.{name}: {one.compare}")
    rows = np.flatnonzero(kept) + 1
    found = {name: column[kept] for name, column in values.items()}
    notes = [
        f"records.{place.rpartition('records.')[2]}: {path.name}: {in_file[name]} {words}"
        for name, one in spec.columns.items()
        if one.sensor != "encoder" and (words := _suspicion(found[name], rows))
    ]
    return _MeasuredData(time, found, tuple(notes))


def _suspicion(values: Array, rows: NDArray[np.int64]) -> str:
    """Return a note on a column that is constant or saturated, or ""."""
    changes = np.flatnonzero(np.diff(values) != 0.0)
    if not changes.size:
        return f"is the same in all {len(values)} rows: is its sensor connected?"
    begins, ends = np.append(0, changes + 1), np.append(changes, len(values) - 1)
    for end, side in ((np.max(values), "largest"), (np.min(values), "smallest")):
        long = (values[begins] == end) & (ends - begins >= _STAYS - 1)
        if long.any():
            k = int(np.flatnonzero(long)[0])
            stays = int(np.sum((ends - begins + 1)[long]))
            return (
                f"stays at its {side} value in {stays} rows, first from row {rows[begins[k]]} to "
                f'{rows[ends[k]]}: if that is as far as its sensor goes, empty them and give gaps = "skip"'
            )
    return ""


def _factor(column: ColumnSpec, in_file: str | None, unit: str, place: str) -> float:
    """Return a column's unit in SI units: of the fit file, its own, or 1."""
    if column.unit is not None:
        return unit_factor(column.unit, unit, f"{place}.unit")
    if in_file is None:
        return 1.0
    try:
        return unit_factor(in_file, unit, f"{place}: the file's unit")
    except ScenarioError as error:
        raise ScenarioError(f"{error}; give its unit with the key unit") from None


def _check_rising(time: Array, place: str) -> None:
    back = np.flatnonzero(np.diff(time) <= 0.0)
    if back.size:
        row = int(back[0])
        raise ScenarioError(
            f"{place} must rise from row to row, got {time[row + 1]:.9g} s after {time[row]:.9g} s in row "
            f"{row + 2}"
        )


def _check_gaps(time: Array, place: str) -> None:
    steps = np.diff(time)
    middle = float(np.median(steps))
    wide = np.flatnonzero(steps > _GAP * middle)
    if wide.size:
        at = int(wide[0])
        raise ScenarioError(
            f"{place} must have no gaps, got none between {time[at]:.6g} s and {time[at + 1]:.6g} s in rows "
            f'{middle:.3g} s apart; give a window, or gaps = "skip"'
        )


def _check_even(time: Array, place: str) -> None:
    steps = np.diff(time)
    off = float(np.max(np.abs(steps - np.mean(steps))) / np.mean(steps))
    if off > _EVEN:
        raise ScenarioError(
            f"{place}: must have rows at even times, got steps that differ by {100.0 * off:.3g} %; give a "
            "window without gaps"
        )


# --- records with their scenarios ---------------------------------------------------------------------------

# Ratio of the durations of record and run that suggests a wrong unit.
_FAR = 100.0
# Least noise over the largest reading, its round-off; least corner of a filter in periods of the record.
_LEAST_NOISE, _LEAST_PERIODS = 1e-15, 0.01
_GLANCE = 1e-6  # of a run's duration: enough to have all its variables


@dataclass(frozen=True, slots=True)
class PreparedRecords:
    """Records of a fit with their scenarios."""

    place: str  # name of the fit in messages
    record_tests: tuple[RecordTest, ...]  # in the order of the records
    targets: dict[str, Target]  # by ``record.column``, in order
    units: dict[str, str]  # SI units of the readings, likewise
    offsets: dict[str, float]  # of the readings [SI], likewise
    ways: tuple[tuple[int, ...], ...]  # per record, number of start coordinates of each piece but the first
    joints: tuple[int, ...]  # per record, number of gaps between pieces
    first: np.ndarray  # parameters at the start of the search, (p,) [SI]; along pieces an estimate
    notes: tuple[str, ...]  # oddities of the records, a line each

    def check_span(self, record: str, least: float, most: float, span: float, windowed: bool) -> None:
        """Refuse rows before a run's start or after its end."""
        test = next(one for one in self.record_tests if one.name == record)
        first, last = float(test.time[0]) + least, float(test.time[-1]) + most
        where = f"{self.place}: records.{record}"
        if first < 0.0:
            rule = "must begin at the run's start, 0 s, or later"
            raise ScenarioError(f"{where} {rule}, got a row at {first:.6g} s; give a window or a clock_shift")
        if last > span * (1.0 + 1e-12):
            rule = f"must end with the run, at {span:g} s, or before"
            also = "" if last < _FAR * span else ", or a time_unit if they are no seconds"
            raise ScenarioError(
                f"{where} {rule}, got a row at {last:.6g} s; give a window, a clock_shift or a longer "
                f"duration{also}"
            )
        if last < span / _FAR and not windowed:
            raise ScenarioError(
                f"{where} must reach beyond a hundredth of its run of {span:g} s, got its last row at "
                f"{last:.6g} s; give time_unit or rate as they are, or a shorter duration, or a window"
            )


def prepare_records(plan: FitPlan) -> PreparedRecords:
    """Return the records and scenarios of a fit, checked before any run."""
    place = f"fit {plan.name}"
    record_tests: list[RecordTest] = []
    targets: dict[str, Target] = {}
    units: dict[str, str] = {}
    offsets: dict[str, float] = {}
    ways: list[tuple[int, ...]] = []
    joints: list[int] = []
    notes: list[str] = []
    unknowns = Unknowns.of(plan, 0)
    known = ParameterEstimate.before(unknowns)
    for name, spec in plan.records.items():
        where = f"{place}: records.{name}"
        base = plan.scenario_of(name)
        begun = _at_start(plan, name, base)
        data, counted = _probe(begun, where)
        read_in = {}
        for column, one in spec.columns.items():
            at = f"{where}.columns.{column}"
            read_in[column] = sensor_unit(data, one, at)
            check_sensor(one, read_in[column], at)
            if spec.pieces is not None or plan.jacobian == "equation":
                _check_state_function(
                    one, read_in[column], counted, at, "pieces" if spec.pieces else "jacobian"
                )
        found = _read_record(spec, plan.folder, read_in, where)
        notes.extend(found.notes)
        for column, one in spec.columns.items():
            _check_pace(one, found.time, f"{where}.columns.{column}")
            full = f"{name}.{column}"
            at = f"{where}.columns.{column}"
            _check_sizes(one, found.values[column], read_in[column], at)
            targets[full] = comparison_target(one, read_in[column], found.time, found.values[column], at)
            units[full], offsets[full] = (
                read_in[column],
                si_amount(one.offset, read_in[column], f"{at}.offset"),
            )
        numbers = plan.own_parameters(name)
        names = [list(plan.parameters)[k] for k in numbers]
        fitted = [plan.parameters[one] for one in names]
        test = RecordTest(
            name=name,
            scenario=base.model_dump_json(),
            keys=tuple(one.keys_set if one.records is None or name in one.records else () for one in fitted),
            names=tuple(names),
            derived=tuple((one.keys_set, one.value) for one in plan.derived_of(name).values()),
            units=tuple(one.numbers()[3] for one in fitted),
            sizes=tuple(parameter_size(*one.numbers()[:3]) for one in fitted),
            columns=dict(spec.columns),
            read_in=read_in,
            time=found.time,
        )
        if spec.pieces is not None:
            check_without_controllers(where, begun)
            curves = [
                ColumnData(
                    (one.gain, _number(plan, f"records.{name}.columns.{column}.gain")),
                    (offsets[full], _number(plan, f"records.{name}.columns.{column}.offset")),
                    *targets[full][2:4],
                )
                for column, one in spec.columns.items()
                for full in (f"{name}.{column}",)
            ]
            test, known = _cut_into_pieces(test, spec, unknowns, numbers, known, curves, where)
        record_tests.append(test)
        ways.append(tuple(start_size(test.begun, origin) for origin in test.origins))
        joints.append(2 * data.sizes["coordinate"] * len(test.origins))
    first = unknowns.from_search(known.at) if any(test.pieces for test in record_tests) else unknowns.start
    return PreparedRecords(
        place, tuple(record_tests), targets, units, offsets, tuple(ways), tuple(joints), first, tuple(notes)
    )


def _check_pace(column: ColumnSpec, time: np.ndarray, place: str) -> None:
    """Refuse a filter with a corner beyond the row rate, or too low."""
    pace = 1.0 / float(np.median(np.diff(time)))
    if column.filter is not None and column.filter.corner > 0.5 * pace:
        raise ScenarioError(
            f"{place}.filter.corner must be at most half of the record's {pace:g} rows per second, got "
            f"{column.filter.corner:g} Hz; give that of the recorder, or leave the filter out"
        )
    span = float(time[-1] - time[0])
    if column.filter is not None and column.filter.corner * span < _LEAST_PERIODS:
        raise ScenarioError(
            f"{place}.filter.corner must be {_LEAST_PERIODS / span:.3g} Hz or more for a record of "
            f"{span:g} s, of which less lets nothing pass, got {column.filter.corner:g} Hz"
        )


def _check_sizes(column: ColumnSpec, values: np.ndarray, unit: str, place: str) -> None:
    """Refuse readings, or noise beside them, whose squares overflow or vanish."""
    most = float(np.max(np.abs(values)))
    if most > LARGEST:
        row = int(np.argmax(np.abs(values)))
        raise ScenarioError(
            f"{place} must be at most {LARGEST:g} in size, got {values[row]:g} in row {row + 1} of those "
            'that count; empty it, and give gaps = "skip"'
        )
    if column.compare in ("curve", "rms") and reading_noise(column, unit) < _LEAST_NOISE * most:
        rule = f"must be {_LEAST_NOISE:g} of the largest reading or more, {_LEAST_NOISE * most:.2g} {unit}"
        raise ScenarioError(f"{place}.sd {rule}, got {column.sd}; give that of the sensor's noise")


def _number(plan: FitPlan, key: str) -> int:
    """Return the parameter of a record's number, or -1."""
    every = list(plan.parameters.values())
    return next((k for k, one in enumerate(every) if key in one.keys_set), -1)


def _cut_into_pieces(
    test: RecordTest,
    spec: RecordSpec,
    unknowns: Unknowns,
    numbers: list[int],
    known: ParameterEstimate,
    curves: list[ColumnData],
    place: str,
) -> tuple[RecordTest, ParameterEstimate]:
    """Return a record's test in pieces with estimated starts, and the parameters' estimate."""
    assert spec.pieces is not None
    length, last = spec.pieces.length, float(test.time[-1])
    if not length < last:
        rule = f"must be shorter than the record, whose last row is at {last:g} s"
        raise ScenarioError(f"{place}.pieces.length {rule}, got {length:g} s")
    least = last / len(test.time)
    if length < least:
        rule = f"must be {least:.3g} s or more, for a row in each piece"
        raise ScenarioError(f"{place}.pieces.length {rule}, got {length:g} s")
    cut = dataclasses.replace(test, pieces=piece_times(length, last + spec.clock_shift))
    along = estimate_starts(cut, unknowns, numbers, known, curves, spec.clock_shift, place)
    values = unknowns.from_search(along.known.at)[numbers]
    begun = scenario_with(cut, tuple(values.tolist())).model_dump_json()
    return dataclasses.replace(cut, origins=along.origins, begun=begun), along.known


def _at_start(plan: FitPlan, record: str, base: Scenario) -> Scenario:
    """Return a record's scenario with the parameters' starts; keys and units are checked by it."""
    overrides: dict[str, Any] = {}
    for name, one in plan.parameters.items():
        if one.records is not None and record not in one.records:
            continue
        where = f"fit {plan.name}: parameters.{name}"
        for key in one.keys_set:
            if record_place(key) is not None:
                continue
            try:
                put_value(overrides, key, one.start, base)
                for value in (*(one.between or ()), one.start):  # the scenario says whether it may be so
                    trial: dict[str, Any] = dict(overrides)
                    put_value(trial, key, value, base)
                    found = base.with_overrides(trial)
            except AntennaPinError as error:
                raise ScenarioError(f"{where}: {error}") from None
    starts = {name: one.numbers()[0] for name, one in plan.parameters.items()}
    for name, derived in plan.derived_of(record).items():
        for key in derived.keys_set:
            try:
                put_value(overrides, key, evaluate(derived.value, starts), base)
                found = base.with_overrides(overrides)
            except AntennaPinError as error:
                raise ScenarioError(f"fit {plan.name}: derived.{name}: {error}") from None
    return found if overrides else base


def _probe(scenario: Scenario, place: str) -> tuple[xr.Dataset, xr.Dataset]:
    """Return a very short run's data, and the change of its integrals."""
    try:
        bench = PreparedScenario(scenario)
        chunk = bench.run(np.zeros(1), max(_GLANCE * scenario.duration, 1e-9)).chunk
        return bench.data(chunk), bench.data(bench.counted(chunk))
    except AntennaPinError as error:
        raise ScenarioError(f"{place}: {error}") from None


def _check_state_function(
    column: ColumnSpec, unit: str, counted: xr.Dataset, place: str, setting: str
) -> None:
    """Refuse a column that depends on integrals where states must suffice."""
    here, other = reading(counted, column.model_copy(update={"filter": None}), unit, np.zeros(2))
    if here != other and not (np.isnan(here) and np.isnan(other)):
        way_out = "leave the pieces out" if setting == "pieces" else 'take jacobian = "differences"'
        raise ScenarioError(
            f"{place} must follow from the state of a moment, not count from a run's start as "
            f"{column.of} does; {way_out}"
        )
