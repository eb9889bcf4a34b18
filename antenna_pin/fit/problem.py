"""A fit as a problem of least squares: residuals of all records as functions of what is unknown."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from antenna_pin.arguments import takes
from antenna_pin.errors import InvalidParameterError
from antenna_pin.fit.jacobian import by_differences
from antenna_pin.fit.laboratory import Laboratory
from antenna_pin.fit.plan import FitPlan, place_in_record
from antenna_pin.fit.prepared import Prepared, prepared
from antenna_pin.fit.runs import Asked, NoRunError, Readings, scenario_with
from antenna_pin.fit.statistics import Target, compared
from antenna_pin.fit.unknowns import Unknowns
from antenna_pin.scenario import Scenario

__all__ = ["NoRunError", "Problem"]

Array = NDArray[np.float64]


class _Number(NamedTuple):
    """A number of a record as a parameter: which, of which record and column ("" of the record itself)."""

    record: int
    column: str
    name: str


class Problem:
    """Records, scenarios and unknown numbers of a fit, checked; runs are made when residuals are asked for.

    With records in pieces the pieces' starts are unknown too: coordinates beside the parameters, ``states``,
    which are kept here and which :meth:`residuals` takes as they are if it is given parameters only.

    Args:
        plan: What the fit file says.
        laboratory: Who makes runs, and remembers them; this process if left out.

    Attributes:
        plan: The fit's file.
        unknowns: Parameters and the pieces' starts, with bounds and sizes.
        states: Coordinates of the pieces' starts, (h,), in the run's error scales.

    Raises:
        AntennaPinError: Something of plan, records or scenarios is not valid: before any run of any length.
    """

    @takes()
    def __init__(self, plan: FitPlan, laboratory: Laboratory | None = None) -> None:
        """Read and check all."""
        self.plan = plan
        self._prepared: Prepared = prepared(plan)
        self.laboratory = laboratory or Laboratory()
        self.laboratory.take(plan, self._prepared.rigs)
        self.unknowns = Unknowns.of(plan, sum(self._prepared.sizes_of_states()))
        self.states = np.zeros(self.unknowns.states)
        specs = list(plan.parameters.values())
        self._of_rig = [
            [i for i, one in enumerate(specs) if _is_of(one.records, name) and not _is_number(one.keys_set)]
            for name in plan.records
        ]
        order = {name: r for r, name in enumerate(plan.records)}
        self._numbers: list[tuple[int, _Number]] = []
        for i, one in enumerate(specs):
            for key in one.keys_set:
                place = place_in_record(key)
                if place is not None:
                    self._numbers.append((i, _Number(order[place[0]], place[1], place[2])))
        self._check_times()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters, (p,)."""
        return self.unknowns.names

    @property
    def start(self) -> Array:
        """Where the search begins, (p,) [SI]."""
        return self.unknowns.start

    @property
    def lower(self) -> Array:
        """Lower bounds, (p,) [SI]; minus infinity if there is none."""
        return self.unknowns.lower

    @property
    def upper(self) -> Array:
        """Upper bounds, (p,) [SI]; infinity if there is none."""
        return self.unknowns.upper

    @property
    def scale(self) -> Array:
        """Size of each parameter, (p,) [SI]."""
        return self.unknowns.scale

    @property
    def runs(self) -> int:
        """How many runs have been made, of all records and pieces."""
        return self.laboratory.made

    @property
    def count(self) -> int:
        """How many residuals there are."""
        return int(
            sum(len(target.data) for _, target in self._targets()) + sum(self._prepared.sizes_of_joints())
        )

    @takes()
    def residuals(self, values: ArrayLike) -> Array:
        """Return (model - data) / sd of all columns of all records, and what pieces are apart, (m,) [-].

        Args:
            values: Of the parameters, (p,) [SI], or of them and of the states, (p + h,).

        Raises:
            NoRunError: A record has no run for these values.
        """
        return self.residuals_at([self._whole(values)])[0]

    @takes()
    def jacobian(self, values: ArrayLike) -> Array:
        """Return the derivatives of the residuals, (m, p), or (m, p + h) of values of that length.

        Raises:
            NoRunError: A record has no run for values near these.
        """
        given = np.asarray(values, dtype=float)
        whole = self._whole(given)
        slopes = self.slopes(self.unknowns.searched(whole))
        return np.asarray(slopes * self.unknowns.rates(whole))[:, : len(given)]

    @takes()
    def predictions(self, values: ArrayLike) -> xr.Dataset:
        """Return what each record's columns would read, beside what they read, all along ``row``.

        Returns:
            ``model``, ``data``, ``sd`` and ``residual`` (row), with the coordinates ``record``, ``column``,
            ``measure`` (what is compared: ``reading``, ``rms``, ...) and ``at``, a time by the run's clock, a
            frequency or a bin's middle.
        """
        whole = self._whole(values)
        found = self.laboratory.readings(self._asked(whole))
        models = self._models(whole, found)
        parts: dict[str, list[Array]] = {name: [] for name in ("model", "data", "sd", "at", "residual")}
        words: dict[str, list[str]] = {"record": [], "column": [], "measure": [], "unit": []}
        for (name, target), model in zip(self._targets(), models, strict=True):
            record, _, column = name.partition(".")
            spec = self.plan.records[record].columns[column]
            shift = self._shift(whole, list(self.plan.records).index(record))
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

    # --- what searches and derivatives ask for

    def residuals_at(self, wholes: Sequence[Array]) -> list[Array]:
        """Return the residuals at several values with states, (p + h,) each; runs are made side by side.

        Raises:
            NoRunError: One of them has none.
        """
        asked = [self._asked(whole) for whole in wholes]
        self.laboratory.readings([one for several in asked for one in several])
        return [
            self._residuals(whole, self.laboratory.readings(one))
            for whole, one in zip(wholes, asked, strict=True)
        ]

    def tried(self, wholes: Sequence[Array]) -> list[Array | None]:
        """Return what :meth:`residuals_at` does, and None where there is no run."""
        asked = [self._asked(whole) for whole in wholes]
        self.laboratory.readings([one for several in asked for one in several])
        found: list[Array | None] = []
        for whole in wholes:
            try:
                found.append(self.residuals_at([whole])[0])
            except NoRunError:
                found.append(None)
        return found

    def scenario(self, record: str, values: Array) -> Scenario:
        """Return the scenario of a record with values of the parameters, (p,) [SI]."""
        r = list(self.plan.records).index(record)
        return scenario_with(self._prepared.rigs[r], tuple(float(values[i]) for i in self._of_rig[r]))

    def slopes(self, searched: Array) -> Array:
        """Return the derivatives of the residuals by what is searched for, (m, p + h)."""
        return by_differences(
            lambda ends: self.residuals_at([self.unknowns.natural(end) for end in ends]),
            searched,
            *self.unknowns.bounds(),
            self.plan.difference_step,
        )

    # --- one evaluation

    def _whole(self, values: ArrayLike) -> Array:
        given = np.asarray(values, dtype=float)
        p, h = len(self.names), len(self.states)
        if given.shape == (p,):
            return np.concatenate([given, self.states])
        if given.shape != (p + h,):
            rule = f"of shape ({p},)" + (f", or ({p + h},) with the states of pieces" if h else "")
            raise InvalidParameterError("Problem", "values", rule, said=str(given.shape))
        return given

    def _shift(self, whole: Array, record: int) -> float:
        for i, number in self._numbers:
            if number.record == record and number.name == "clock_shift":
                return float(whole[i])
        return list(self.plan.records.values())[record].clock_shift

    def _asked(self, whole: Array) -> list[Asked]:
        asked, at = [], len(self.names)
        for r, rig in enumerate(self._prepared.rigs):
            values = tuple(float(whole[i]) for i in self._of_rig[r])
            shift = self._shift(whole, r)
            if not rig.pieces:
                asked.append(Asked(r, values, shift))
                continue
            asked.append(Asked(r, values, shift, 0))
            for k, size in enumerate(self._prepared.ways[r]):
                asked.append(Asked(r, values, shift, k + 1, tuple(whole[at : at + size].tolist())))
                at += size
        return asked

    def _targets(self) -> Iterable[tuple[str, Target]]:
        return self._prepared.targets.items()

    def _models(self, whole: Array, found: Sequence[Readings]) -> list[Array]:
        """Return the numbers of each column that are compared with the record's."""
        models, at = [], 0
        for r, (record, rig) in enumerate(zip(self.plan.records, self._prepared.rigs, strict=True)):
            pieces = found[at : at + max(1, len(rig.pieces) - 1)]
            at += len(pieces)
            for one in pieces:
                if one.failed:
                    raise NoRunError(f"fit {self.plan.name}: records.{record}: {one.failed}")
            for c, (name, column) in enumerate(rig.columns.items()):
                gain, offset = column.gain, self._prepared.offsets[f"{record}.{name}"]
                for i, number in self._numbers:
                    if (number.record, number.column) == (r, name):
                        gain = float(whole[i]) if number.name == "gain" else gain
                        offset = float(whole[i]) if number.name == "offset" else offset
                read = gain * np.concatenate([one.columns[c] for one in pieces]) + offset
                models.append(compared(column, rig.read_in[name], rig.time, read))
        return models

    def _residuals(self, whole: Array, found: Sequence[Readings]) -> Array:
        parts = []
        for (name, target), model in zip(self._targets(), self._models(whole, found), strict=True):
            record, _, column = name.partition(".")
            weight = self.plan.records[record].columns[column].weight
            parts.append((model - target.data) * weight / target.sd)
        at = 0
        for spec, rig in zip(self.plan.records.values(), self._prepared.rigs, strict=True):
            pieces = found[at : at + max(1, len(rig.pieces) - 1)]
            at += len(pieces)
            for one, other in zip(pieces, pieces[1:], strict=False):
                assert spec.pieces is not None
                parts.append(spec.pieces.weight * (one.end - other.lead))
        return np.concatenate(parts)

    def _check_times(self) -> None:
        """Refuse a record that goes beyond its run, at whatever shift of its clock that may be fitted."""
        for r, (name, rig) in enumerate(zip(self.plan.records, self._prepared.rigs, strict=True)):
            shifts = [self._shift(self.start, r)]
            for i, number in self._numbers:
                if number.record == r and number.name == "clock_shift":
                    if not (math.isfinite(self.lower[i]) and math.isfinite(self.upper[i])):
                        rule = "given: a clock that is fitted must keep its record within the run"
                        raise InvalidParameterError(
                            f"fit {self.plan.name}", f"parameters.{self.names[i]}.between", rule, None
                        )
                    shifts += [float(self.lower[i]), float(self.upper[i])]
            span = json.loads(rig.scenario)["duration"]
            self._prepared.check_span(name, min(shifts), max(shifts), span)


def _is_of(records: tuple[str, ...] | None, name: str) -> bool:
    return records is None or name in records


def _is_number(keys: tuple[str, ...]) -> bool:
    return place_in_record(keys[0]) is not None
