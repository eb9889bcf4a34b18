"""Residuals of a fit from readings of its runs: calibration, statistics, gaps between pieces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.fit.plan import FitPlan, place_in_record
from antenna_pin.fit.preparation import Prepared
from antenna_pin.fit.runs import NoRunError, Readings, Rig
from antenna_pin.fit.sensors import compared, slopes_of

__all__ = ["Number", "Rows"]

Array = NDArray[np.float64]

Fitted = NDArray[np.int_]


class Number(NamedTuple):
    """A number of a record as a parameter.

    Attributes:
        parameter: Number of the parameter.
        record: Number of the record.
        column: Name of its column; "" of the record itself.
        name: Of the number.
    """

    parameter: int
    record: int
    column: str
    name: str


class Rows:
    """What of all records is compared, and how.

    Args:
        plan: What the fit file says.
        prepared: Its records.

    Attributes:
        numbers: Of the records, those that are parameters.
        tie: By what joints of pieces count beside the weights of the plan: less than 1 while a search has
            not found its way.
    """

    def __init__(self, plan: FitPlan, prepared: Prepared) -> None:
        """Find which parameters are numbers of records."""
        self._plan, self._prepared, self.tie = plan, prepared, 1.0
        order = {name: r for r, name in enumerate(plan.records)}
        self.numbers = tuple(
            Number(i, order[place[0]], place[1], place[2])
            for i, one in enumerate(plan.parameters.values())
            for place in map(place_in_record, one.keys_set)
            if place is not None
        )

    def shift(self, whole: Array, record: int) -> float:
        """Return what is added to a record's clock [s]."""
        for number in self.numbers:
            if number.record == record and number.name == "clock_shift":
                return float(whole[number.parameter])
        return list(self._plan.records.values())[record].clock_shift

    def has_clock(self, record: int) -> bool:
        """Whether a record's clock is fitted."""
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

    def models(self, whole: Array, found: Sequence[Readings]) -> list[Array]:
        """Return the numbers of each column that are compared with the record's.

        Raises:
            NoRunError: A run has failed.
        """
        models = []
        for r, rig, pieces in self.by_record(found):
            for one in pieces:
                if one.failed:
                    raise NoRunError(f"fit {self._plan.name}: records.{rig.name}: {one.failed}")
            for c, (name, column) in enumerate(rig.columns.items()):
                gain, offset = self.calibration(whole, r, name)
                read = gain * np.concatenate([one.columns[c] for one in pieces]) + offset
                models.append(compared(column, rig.read_in[name], rig.time, read))
        return models

    def residuals(self, whole: Array, found: Sequence[Readings]) -> Array:
        """Return (model - data) / sd of all columns, and behind them how far pieces are apart, (m,) [-].

        Raises:
            NoRunError: A run has failed.
        """
        parts = []
        for (name, target), model in zip(
            self._prepared.targets.items(), self.models(whole, found), strict=True
        ):
            record, _, column = name.partition(".")
            weight = self._plan.records[record].columns[column].weight
            parts.append((model - target.data) * weight / target.sd)
        for _, rig, pieces in self.by_record(found):
            for one, other in zip(pieces, pieces[1:], strict=False):
                parts.append(self.weight(rig) * (one.end - other.lead))
        return np.concatenate(parts)

    def by_curve(self, residuals: Array) -> dict[str, Array]:
        """Return the residuals of each column, by its place in the plan."""
        ends = np.cumsum([len(target.data) for target in self._prepared.targets.values()])
        return dict(zip(self._prepared.targets, np.split(residuals[: ends[-1]], ends[:-1]), strict=True))

    def curve_numbers(self) -> NDArray[np.intp]:
        """Return the number of the curve that each residual is of, (m,); each joint and prior has its own."""
        rows = [len(target.data) for target in self._prepared.targets.values()]
        single = sum(self._prepared.sizes_of_joints())
        single += sum(one.prior is not None for one in self._plan.parameters.values())
        return np.repeat(np.arange(len(rows) + single), [*rows, *[1] * single])

    def noise_of_statistics(self) -> Array:
        """Return what sensors' noise adds to the variance of each residual, (m,): of columns with an sd."""
        return np.concatenate(
            [
                np.full(len(self._prepared.targets[f"{rig.name}.{name}"].data), float(spec.sd is not None))
                for rig in self._prepared.rigs
                for name, spec in rig.columns.items()
            ]
        )

    def curves(self, whole: Array, found: Sequence[Readings]) -> dict[str, tuple[Array, Array]]:
        """Return times, (rows,), and curves over their noise, (columns, rows), of records that are one run.

        Raises:
            NoRunError: A run has failed.
        """
        curves = dict[str, list[Array]]()
        models = self.models(whole, found)
        for (name, target), model in zip(self._prepared.targets.items(), models, strict=True):
            record, _, column = name.partition(".")
            spec = self._plan.records[record]
            if spec.pieces is None and spec.columns[column].compare == "curve":
                curves.setdefault(record, []).append(model / target.sd)
        times = {one.name: one.time for one in self._prepared.rigs}
        return {name: (times[name], np.array(rows)) for name, rows in curves.items()}

    def slopes(self, whole: Array, found: Sequence[Readings], fitted: Sequence[Fitted]) -> Array:
        """Return the derivatives of :meth:`residuals` by values with states, (m, p + h).

        Args:
            whole: Values with states, (p + h,) [SI].
            found: What came of the runs, with derivatives.
            fitted: Of each run, where its fitted numbers and its start stand among the unknowns.
        """
        parts, joints, at = [], [], 0
        for r, rig, pieces in self.by_record(found):
            own = fitted[at : at + len(pieces)]
            at += len(pieces)
            for c, name in enumerate(rig.columns):
                parts.append(self._slopes_of_column(whole, r, rig, c, name, pieces, own))
            for one, other, mine, theirs in zip(pieces, pieces[1:], own, own[1:], strict=False):
                assert one.slopes is not None and other.slopes is not None
                table = np.zeros((len(one.end), len(whole)))
                table[:, mine] += one.slopes.end
                table[:, theirs] -= other.slopes.lead
                joints.append(self.weight(rig) * table)
        return np.concatenate([*parts, *joints])

    def _slopes_of_column(
        self,
        whole: Array,
        record: int,
        rig: Rig,
        place: int,
        name: str,
        pieces: Sequence[Readings],
        fitted: Sequence[Fitted],
    ) -> Array:
        """Return the derivatives of the residuals of one column, (numbers, p + h)."""
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
        spec, target = rig.columns[name], self._prepared.targets[f"{rig.name}.{name}"]
        slopes = slopes_of(spec, rig.time, gain * read + offset, table)
        return slopes * (spec.weight / target.sd)[:, np.newaxis]

    def table(self, whole: Array, found: Sequence[Readings]) -> xr.Dataset:
        """Return models beside what they are compared with, all along ``row``, as a fit's result has them.

        Raises:
            NoRunError: A run has failed.
        """
        parts: dict[str, list[Array]] = {name: [] for name in ("model", "data", "sd", "at", "residual")}
        words: dict[str, list[str]] = {"record": [], "column": [], "measure": [], "unit": []}
        for (name, target), model in zip(
            self._prepared.targets.items(), self.models(whole, found), strict=True
        ):
            record, _, column = name.partition(".")
            spec = self._plan.records[record].columns[column]
            shift = self.shift(whole, list(self._plan.records).index(record))
            at = target.at + shift if target.unit == "s" and spec.compare != "blows" else target.at
            rows = (model, target.data, target.sd, at, (model - target.data) * spec.weight / target.sd)
            for key, row in zip(parts, rows, strict=True):
                parts[key].append(row)
            unit = self._prepared.units[name] if target.measure in ("reading", "rms") else "1"
            for key, text in zip(words, (record, column, target.measure, unit), strict=True):
                words[key] += [text] * len(model)
        columns = {name: ("row", np.concatenate(one)) for name, one in parts.items()}
        data = xr.Dataset({name: columns[name] for name in ("model", "data", "sd", "residual")})
        return data.assign_coords({"at": columns["at"]} | {name: ("row", one) for name, one in words.items()})

    def weight(self, rig: Rig) -> float:
        """Return by what the joints of a record's pieces count [-]."""
        pieces = self._plan.records[rig.name].pieces
        assert pieces is not None
        return self.tie * pieces.weight

    def by_record(self, found: Sequence[Readings]) -> list[tuple[int, Rig, list[Readings]]]:
        """Return number, rig and pieces of each record."""
        parts, at = [], 0
        for r, rig in enumerate(self._prepared.rigs):
            count = max(1, len(rig.pieces) - 1)
            parts.append((r, rig, list(found[at : at + count])))
            at += count
        return parts
