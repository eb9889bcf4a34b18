"""From what sensors read to a fit's residuals: gains, offsets, statistics, and how far pieces are apart."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.fit.plan import FitPlan, place_in_record
from antenna_pin.fit.prepared import Prepared
from antenna_pin.fit.runs import NoRunError, Readings, Rig
from antenna_pin.fit.statistics import compared

__all__ = ["Number", "Rows"]

Array = NDArray[np.float64]


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
