"""Residuals of a fit from readings of its runs: calibration, statistics, gaps between pieces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.base.arrays import Array
from antenna_pin.studies.fit.plan import FitPlan, record_place
from antenna_pin.studies.fit.preparation import PreparedRecords
from antenna_pin.studies.fit.runs import NoRunError, Readings, RecordTest
from antenna_pin.studies.fit.sensors import Target, compared_numbers, compared_slopes

_Indices = NDArray[np.int_]


class _RecordNumber(NamedTuple):
    """Number of a record that is a parameter."""

    parameter: int  # index of the parameter
    record: int  # index of the record
    column: str  # name of the column; "" for the record itself
    name: str  # of the number


class ResidualRows:
    """Residuals of all records from the readings of their runs."""

    def __init__(self, plan: FitPlan, records: PreparedRecords) -> None:
        self._plan, self._prepared, self.tie = plan, records, 1.0
        order = {name: r for r, name in enumerate(plan.records)}
        self.numbers = tuple(
            _RecordNumber(i, order[place[0]], place[1], place[2])
            for i, one in enumerate(plan.parameters.values())
            for place in map(record_place, one.keys_set)
            if place is not None
        )

    def shift(self, whole: Array, record: int) -> float:
        """Return the shift of a record's clock [s]."""
        for number in self.numbers:
            if number.record == record and number.name == "clock_shift":
                return float(whole[number.parameter])
        return list(self._plan.records.values())[record].clock_shift

    def has_clock(self, record: int) -> bool:
        """Return whether a record's clock is fitted."""
        return any((one.record, one.name) == (record, "clock_shift") for one in self.numbers)

    def calibration(self, whole: Array, record: int, column: str) -> tuple[float, float]:
        """Return gain [-] and offset [SI] of a column."""
        name = list(self._plan.records)[record]
        gain = self._plan.records[name].columns[column].gain
        offset = self._prepared.offsets[f"{name}.{column}"]
        for number in self.numbers:
            if (number.record, number.column) == (record, column):
                gain = float(whole[number.parameter]) if number.name == "gain" else gain
                offset = float(whole[number.parameter]) if number.name == "offset" else offset
        return gain, offset

    def models(self, whole: Array, readings: Sequence[Readings]) -> list[Array]:
        """Return the model's numbers of each column; raise a NoRunError for a failed run."""
        models = []
        for r, test, pieces in self.by_record(readings):
            for one in pieces:
                if one.failed:
                    raise NoRunError(f"fit {self._plan.name}: records.{test.name}: {one.failed}")
            for c, (name, column) in enumerate(test.columns.items()):
                gain, offset = self.calibration(whole, r, name)
                read = gain * np.concatenate([one.columns[c] for one in pieces]) + offset
                models.append(compared_numbers(column, test.read_in[name], test.time, read))
        return models

    def _compared(
        self, whole: Array, readings: Sequence[Readings]
    ) -> Iterator[tuple[str, str, Target, Array]]:
        """Yield record, column, data and model of each column."""
        models = self.models(whole, readings)
        for (name, target), model in zip(self._prepared.targets.items(), models, strict=True):
            record, _, column = name.partition(".")
            yield record, column, target, model

    def residuals(self, whole: Array, readings: Sequence[Readings]) -> Array:
        """Return weighted residuals of all columns, then gaps between pieces, (m,) [-]."""
        parts = []
        for record, column, target, model in self._compared(whole, readings):
            weight = self._plan.records[record].columns[column].weight
            parts.append((model - target.data) * weight / target.sd)
        for _, test, pieces in self.by_record(readings):
            for one, other in zip(pieces, pieces[1:], strict=False):
                parts.append(self.weight(test) * (one.end - other.lead))
        return np.concatenate(parts)

    def by_curve(self, residuals: Array) -> dict[str, Array]:
        """Return the residuals of each column, by its place in the plan."""
        ends = np.cumsum([len(target.data) for target in self._prepared.targets.values()])
        return dict(zip(self._prepared.targets, np.split(residuals[: ends[-1]], ends[:-1]), strict=True))

    def curve_numbers(self) -> NDArray[np.intp]:
        """Return the curve number of each residual, (m,), joints and priors apart."""
        rows = [len(target.data) for target in self._prepared.targets.values()]
        single = sum(self._prepared.joints)
        single += sum(one.prior is not None for one in self._plan.parameters.values())
        return np.repeat(np.arange(len(rows) + single), [*rows, *[1] * single])

    def noise_of_statistics(self) -> Array:
        """Return the variance of each residual due to sensors, (m,)."""
        return np.concatenate(
            [
                np.full(len(self._prepared.targets[f"{test.name}.{name}"].data), float(spec.sd is not None))
                for test in self._prepared.record_tests
                for name, spec in test.columns.items()
            ]
        )

    def curves(self, whole: Array, readings: Sequence[Readings]) -> dict[str, tuple[Array, Array]]:
        """Return times and curves over their noise, of records of one run."""
        curves = dict[str, list[Array]]()
        for record, column, target, model in self._compared(whole, readings):
            spec = self._plan.records[record]
            if spec.pieces is None and spec.columns[column].compare == "curve":
                curves.setdefault(record, []).append(model / target.sd)
        times = {one.name: one.time for one in self._prepared.record_tests}
        return {name: (times[name], np.array(rows)) for name, rows in curves.items()}

    def slopes(self, whole: Array, readings: Sequence[Readings], fitted: Sequence[_Indices]) -> Array:
        """Return the derivatives of :meth:`residuals` by values with states, (m, p + h)."""
        parts, joints, at = [], [], 0
        for r, test, pieces in self.by_record(readings):
            own = fitted[at : at + len(pieces)]
            at += len(pieces)
            for c, name in enumerate(test.columns):
                parts.append(self._slopes_of_column(whole, r, test, c, name, pieces, own))
            for one, other, mine, theirs in zip(pieces, pieces[1:], own, own[1:], strict=False):
                assert one.slopes is not None and other.slopes is not None
                table = np.zeros((len(one.end), len(whole)))
                table[:, mine] += one.slopes.end
                table[:, theirs] -= other.slopes.lead
                joints.append(self.weight(test) * table)
        return np.concatenate([*parts, *joints])

    def _slopes_of_column(
        self,
        whole: Array,
        record: int,
        test: RecordTest,
        place: int,
        name: str,
        pieces: Sequence[Readings],
        fitted: Sequence[_Indices],
    ) -> Array:
        """Return the derivatives of one column's residuals, (numbers, p + h)."""
        gain, offset = self.calibration(whole, record, name)
        read = np.concatenate([one.columns[place] for one in pieces])
        table, row = np.zeros((len(read), len(whole))), 0
        for one, own in zip(pieces, fitted, strict=True):
            assert one.slopes is not None
            rows = slice(row, row + len(one.columns[place]))
            table[rows, own] += gain * one.slopes.columns[place]
            for number in self.numbers:
                clock = one.slopes.clock
                if number.record == record and number.name == "clock_shift" and clock is not None:
                    table[rows, number.parameter] += gain * clock[place]
            row = rows.stop
        for number in self.numbers:
            if (number.record, number.column) == (record, name):
                table[:, number.parameter] += read if number.name == "gain" else 1.0
        spec, target = test.columns[name], self._prepared.targets[f"{test.name}.{name}"]
        slopes = compared_slopes(spec, test.time, gain * read + offset, table)
        return slopes * (spec.weight / target.sd)[:, np.newaxis]

    def table(self, whole: Array, readings: Sequence[Readings]) -> xr.Dataset:
        """Return models beside records, all along ``row``, for a fit's dataset."""
        parts: dict[str, list[Array]] = {name: [] for name in ("model", "data", "sd", "at", "residual")}
        words: dict[str, list[str]] = {"record": [], "column": [], "measure": [], "unit": []}
        for record, column, target, model in self._compared(whole, readings):
            spec = self._plan.records[record].columns[column]
            shift = self.shift(whole, list(self._plan.records).index(record))
            at = target.at + shift if target.unit == "s" and spec.compare != "blows" else target.at
            rows = (model, target.data, target.sd, at, (model - target.data) * spec.weight / target.sd)
            for key, row in zip(parts, rows, strict=True):
                parts[key].append(row)
            unit = self._prepared.units[f"{record}.{column}"] if target.measure in ("reading", "rms") else "1"
            for key, text in zip(words, (record, column, target.measure, unit), strict=True):
                words[key] += [text] * len(model)
        columns = {name: ("row", np.concatenate(one)) for name, one in parts.items()}
        data = xr.Dataset({name: columns[name] for name in ("model", "data", "sd", "residual")})
        return data.assign_coords({"at": columns["at"]} | {name: ("row", one) for name, one in words.items()})

    def weight(self, test: RecordTest) -> float:
        """Return the weight of the joints of a record's pieces [-]."""
        pieces = self._plan.records[test.name].pieces
        assert pieces is not None
        return self.tie * pieces.weight

    def by_record(self, readings: Sequence[Readings]) -> list[tuple[int, RecordTest, list[Readings]]]:
        """Return number, test and pieces of each record."""
        parts, at = [], 0
        for r, test in enumerate(self._prepared.record_tests):
            count = max(1, len(test.pieces) - 1)
            parts.append((r, test, list(readings[at : at + count])))
            at += count
        return parts
