"""The file of a fit: scenario, records, unknown numbers, search settings."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, model_validator

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.units import shown
from antenna_pin.errors import OutputError
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.runs_file import RunsFile, laid_over, nested
from antenna_pin.scenario.spec import Count, Folder, QuantityRule, Spec, refuse, refuse_name
from antenna_pin.studies.fit.specs import (
    ColumnSpec,
    DerivedSpec,
    FitParameterSpec,
    LayoutSpec,
    evaluate,
    names_in,
)
from antenna_pin.studies.fit.uncertainty import Loss, Noise

#: Numbers of a record: ``records.NAME.clock_shift``, ``records.NAME.columns.COLUMN.gain``.
_OF_RECORD = re.compile(r"records\.([^.]+)\.(?:(clock_shift)|columns\.([^.]+)\.(gain|offset))")

_Jacobian = Literal["differences", "equation"]

_LEAST_TOLERANCE = 1e-15  # [-]


def record_place(key: str) -> tuple[str, str, str] | None:
    """Return record, column or "" and number addressed by a key, or None."""
    found = _OF_RECORD.fullmatch(key)
    return None if found is None else (found[1], found[3] or "", found[2] or found[4])


class _PiecesSpec(Spec):
    """Record cut into pieces that start from states of their own (multiple shooting).

    Attributes:
        length: Length of a piece; the last may be shorter [s].
        weight: Weight of the jump from a piece's end to the next start, in units of the run's error scales:
            the larger, the closer to one continuous motion [-].
    """

    length: Annotated[float, QuantityRule("s", "positive")]
    weight: Annotated[float, QuantityRule("1", "positive")] = 1e4


class RecordSpec(LayoutSpec):
    """Measured run: layout of its file, and measured quantities.

    Attributes:
        file: Text (CSV and similar), NetCDF, MAT or universal file, relative to the fit file's folder.
        clock_shift: Run time less the file's time [s].
        window: Interval of the file's clock that counts [s]; all by default.
        gaps: ``refuse`` rows without numbers and missing rows, or ``skip`` them.
        case: Case of the scenario, if not the fit's.
        set: Overrides of the scenario for this record.
        pieces: Pieces of a comparison piece by piece.
        columns: Measured quantities, by name.
    """

    file: str
    clock_shift: Annotated[float, QuantityRule("s")] = 0.0
    window: tuple[Annotated[float, QuantityRule("s")], Annotated[float, QuantityRule("s")]] | None = None
    gaps: Literal["refuse", "skip"] = "refuse"
    case: str | None = None
    set: dict[str, Any] = Field(default_factory=dict)
    pieces: _PiecesSpec | None = None
    columns: dict[str, ColumnSpec]

    @model_validator(mode="before")
    @classmethod
    def _nest(cls, data: Any) -> Any:
        if isinstance(data, Mapping) and isinstance(data.get("set"), Mapping):
            return {**data, "set": nested(data["set"])}
        return data

    @model_validator(mode="after")
    def _check_together(self) -> Self:
        if not self.columns:
            refuse("must hold one column at least, got none", "columns")
        if self.window is not None and not self.window[0] < self.window[1]:
            refuse(f"must be two times that rise, got {shown(self.window)}", "window")
        if self.pieces is not None:
            for name, column in self.columns.items():
                if column.compare != "curve" or column.filter is not None:
                    rule = "must be a curve without a filter in a record of pieces, which restart"
                    refuse(rule, "columns", name)
        return self


class _StartsSpec(Spec):
    """Several starts, for a sum of squares with several valleys: Sobol' points between the bounds.

    Attributes:
        count: Number of points at which the sum is evaluated, a power of two; the start is one more [-].
        keep: Number of best points from which a search begins [-].
        seed: Seed of the scrambling [-].
    """

    count: Annotated[int, BeforeValidator(Count(2, 1_000_000, power=True).read)]
    keep: Annotated[int, BeforeValidator(Count(1, 10_000).read)] = 4
    seed: Annotated[int, BeforeValidator(Count(0, 2**62).read)] = 0


class SurfaceSpec(Spec):
    """Response surfaces through many runs, for statistics of chaotic motions.

    Attributes:
        runs: Runs at points of each box, a power of two [-].
        width: Half width of the first box, in sizes of the parameters [-].
        rounds: Largest number of boxes [-].
        seed: Seed of the points [-].
    """

    runs: Annotated[int, BeforeValidator(Count(16, 1_000_000, power=True).read)] = 64
    width: Annotated[float, QuantityRule("1", "positive")] = 0.3
    rounds: Annotated[int, BeforeValidator(Count(1, 1000).read)] = 8
    seed: Annotated[int, BeforeValidator(Count(0, 2**62).read)] = 0


class FitPlan(RunsFile):
    """Fit defined by a file.

    Attributes:
        parameters: Unknown numbers, by name.
        derived: Numbers of the scenario that follow from parameters, by name.
        records: Measured runs, by name.
        validation: Records that judge the fit, and are not fitted.
        noise: ``given``, the columns' ``sd`` are those of the noise; ``estimated``, only their ratios are,
            and the residuals give its size; ``correlated``, as estimated, with correlation in time.
        loss: Loss of a residual by SciPy's ``least_squares``: ``linear`` for its square, the others for less
            weight of large residuals.
        loss_scale: Residual from which the weight falls, in standard deviations [-].
        jacobian: Source of derivatives: central ``differences`` of runs, or the variational ``equation``
            along one run, for diverging runs or many unknowns.
        difference_step: Step of differences over a parameter's scale: its start's size, or the bounds'
            distance [-].
        tolerance: Relative change of the sum, and of parameters, at which a search ends [-].
        most: Largest number of evaluations by steps of a search [-].
        starts: Search from many points; from ``start`` alone by default.
        surface: Search among statistics that scatter from run to run; by derivatives by default.
        name: Name of the fit: that of its file.
        folder: Folder of the file.
    """

    suffix: ClassVar[str] = ".fit.toml"
    word: ClassVar[str] = "fit"

    parameters: dict[str, FitParameterSpec]
    derived: dict[str, DerivedSpec] = Field(default_factory=dict)
    records: dict[str, RecordSpec]
    validation: dict[str, RecordSpec] = Field(default_factory=dict)
    noise: Noise = "given"
    loss: Loss = "linear"
    loss_scale: Annotated[float, QuantityRule("1", "positive")] = 1.0
    jacobian: _Jacobian = "differences"
    difference_step: Annotated[float, QuantityRule("1", "between 0 and 1")] = 1e-4
    tolerance: Annotated[float, QuantityRule("1", "between 0 and 1")] = 1e-8
    most: Annotated[int, BeforeValidator(Count(1, 100_000).read)] = 100
    starts: _StartsSpec | None = None
    surface: SurfaceSpec | None = None
    name: str = "fit"
    folder: Folder = Path()

    @model_validator(mode="after")
    def _check_tolerance(self) -> Self:
        if self.tolerance < _LEAST_TOLERANCE:
            rule = f"must be {_LEAST_TOLERANCE:g} or more, the resolution of a double"
            refuse(f"{rule}, got {self.tolerance:g}", "tolerance")
        return self

    @model_validator(mode="after")
    def _check_jacobian(self) -> Self:
        every = [(name, *pair) for name, one in self.records.items() for pair in one.columns.items()]
        for name, column, spec in every if self.jacobian == "equation" else ():
            if spec.compare == "blows":
                rule = 'must be "differences" where blows are compared, which each run detects again'
                refuse(f"{rule}, as records.{name}.columns.{column} does", "jacobian")
        return self

    @model_validator(mode="after")
    def _check_surface(self) -> Self:
        if self.surface is None:
            return self
        for name, one in self.parameters.items():
            if one.prior is not None:
                refuse("must be left out with a surface", "parameters", name, "prior")
        for name, record in self.records.items():
            for column, spec in record.columns.items():
                if spec.compare == "curve":
                    rule = "must be a statistic with a surface: rms, spectrum or blows"
                    refuse(rule, "records", name, "columns", column, "compare")
        for name, wanted in (
            ("starts", None),
            ("jacobian", "differences"),
            ("loss", "linear"),
            ("noise", "given"),
        ):
            if getattr(self, name) != wanted:
                refuse("must be left out with a surface, which has its own", name)
        return self

    @model_validator(mode="after")
    def _check_together(self) -> Self:
        for place in ("parameters", "records"):
            if not getattr(self, place):
                refuse(f"must hold one {place[:-1]} at least, got none", place)
            for name in getattr(self, place):
                if not name.replace("_", "a").replace("-", "a").isalnum():
                    refuse("must have a name of letters, digits, - and _", place, name)
        owners: dict[tuple[str, str], str] = {}
        for name, parameter in self.parameters.items():
            self._check_owner("parameters", name, parameter, owners)
            used = any(name in names_in(one.value) for one in self.derived.values())
            if not parameter.keys_set and not used:
                rule = "is missing; only a parameter that derived numbers use has none"
                refuse(rule, "parameters", name, "key")
            if self.starts is not None and parameter.between is None:
                refuse("is missing; many starts lie between bounds", "parameters", name, "between")
        for name, derived in self.derived.items():
            self._check_derived(name, derived, owners)
        for name in self.validation:
            if name in self.records:
                refuse("must have a name that no fitted record has", "validation", name)
            if self.validation[name].pieces is not None:
                refuse("must be left out of validation, whose run is one", "validation", name, "pieces")
        return self

    def _check_derived(self, name: str, derived: DerivedSpec, owners: dict[tuple[str, str], str]) -> None:
        """Refuse a derived number of unknown names, or of a key set elsewhere."""
        for used in names_in(derived.value):
            if used not in self.parameters:
                refuse_name("parameter", used, self.parameters, "derived", name, "value")
        self._check_owner("derived", name, derived, owners)
        try:
            evaluate(derived.value, {one: spec.numbers()[0] for one, spec in self.parameters.items()})
        except ValueError as error:
            refuse(str(error), "derived", name, "value")

    def _check_owner(
        self,
        table: str,
        name: str,
        number: FitParameterSpec | DerivedSpec,
        owners: dict[tuple[str, str], str],
    ) -> None:
        """Refuse a number of unknown records, or of a key set elsewhere."""
        for i, record in enumerate(number.records or ()):
            if record not in self.records:
                refuse_name("record", record, self.records, table, name, "records", i)
        for key in number.keys_set:
            if table == "parameters":
                self._check_of_record(name, key)
            elif key.startswith("records."):
                refuse(f"must be a key of the scenario, got {key!r}", table, name, "key")
            for record in number.records or self.records:
                owner = owners.setdefault((key, record), name)
                if owner != name:
                    refuse(f"must be a different key, got that of {owner}", table, name, "key")

    def own_parameters(self, record: str) -> list[int]:
        """Return the indices of the parameters in a record's scenario."""
        derived = [one for one in self.derived.values() if one.records is None or record in one.records]
        used = {name for one in derived for name in names_in(one.value)}
        places = []
        for i, (name, one) in enumerate(self.parameters.items()):
            mine = one.records is None or record in one.records
            if name in used or (mine and one.keys_set and record_place(one.keys_set[0]) is None):
                places.append(i)
        return places

    def derived_of(self, record: str) -> dict[str, DerivedSpec]:
        """Return the derived numbers of a record's scenario."""
        return {
            name: one for name, one in self.derived.items() if one.records is None or record in one.records
        }

    def unfitted(self) -> FitPlan | None:
        """Return a plan of the records for validation with the scenario's parameters; None without any."""
        if not self.validation:
            return None
        kept = {
            name: one.model_copy(update={"records": None, "prior": None})
            for name, one in self.parameters.items()
            if not one.keys_set or record_place(one.keys_set[0]) is None
        }
        derived = {name: one.model_copy(update={"records": None}) for name, one in self.derived.items()}
        changed = {"parameters": kept, "derived": derived, "records": self.validation, "validation": {}}
        return self.model_copy(update=changed | {"starts": None})

    def _check_of_record(self, name: str, key: str) -> None:
        """Refuse a parameter of an unknown record, column or number."""
        if not key.startswith("records."):
            return
        place = record_place(key)
        at = ("parameters", name, "key")
        if place is None:
            rule = "must be records.NAME.clock_shift, or records.NAME.columns.COLUMN.gain or .offset"
            refuse(f"{rule}, got {key!r}", *at)
        record, column, _ = place
        if record not in self.records:
            refuse_name("record", record, self.records, *at)
        if column and column not in self.records[record].columns:
            refuse_name("column", column, self.records[record].columns, *at)
        if self.parameters[name].records is not None:
            refuse("must be left out for a number of one record", "parameters", name, "records")

    def check_output(self, path: Path) -> None:
        """Raise an OutputError for an output path that the fit reads from."""
        records = {**self.records, **self.validation}
        read = [self.scenario, *(one.file for one in records.values())]
        for name in read:
            there = self.folder / os.path.expanduser(name)
            if there.is_file() and path.exists() and path.samefile(there):
                raise OutputError(
                    f"{path}: must not be a file that the fit reads, got that; give another name"
                )

    def scenario_of(self, record: str) -> Scenario:
        """Return the scenario of a record, without fitted values."""
        spec = self.records[record]
        case = self.case if spec.case is None else spec.case
        return self.scenario_with(case, laid_over(self.set, spec.set))


@takes()
def load_fit(path: str | os.PathLike[str], settings: Mapping[str, Any] | Sequence[str] = ()) -> FitPlan:
    """Return a fit's file, complete and checked; its scenario and records are not read yet.

    Args:
        path: Path of the file, or the name of a shipped one.
        settings: Overrides of the file's keys: ``["loss=huber", "starts.count=64"]``.

    Raises:
        ScenarioError: With one line that gives file, place, rule, value and a way out.
        UnknownNameError: No such fit exists.
    """
    return FitPlan.loaded("load_fit", path, settings)


# --- unknowns of a fit --------------------------------------------------------------------------------------

# Size of a coordinate of a piece's start in error scales: a search's first step.
_REACH = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class Unknowns:
    """Unknowns of a fit: p parameters, then h coordinates of pieces' starts.

    In a search each is divided by its size, or replaced by its logarithm.
    """

    names: tuple[str, ...]  # of the parameters
    titles: tuple[str, ...]  # in figures
    units: tuple[str, ...]  # SI; "" for a pure number or an unknown unit
    start: Array  # start of the search, (p,) [SI]
    lower: Array  # lower bounds, (p,) [SI]; minus infinity for none
    upper: Array  # upper bounds, (p,) [SI]; infinity for none
    scale: Array  # size of the start value, or distance of the bounds, (p,) [SI]
    prior_mean: Array  # (p,) [SI]
    prior_sd: Array  # (p,) [SI]; infinite without a prior
    logarithmic: NDArray[np.bool_]  # parameters searched by their logarithm, (p,)
    states: int  # number of coordinates, h

    @classmethod
    def of(cls, plan: FitPlan, states: int) -> Unknowns:
        """Return the unknowns of a fit's file, with a number of start coordinates."""
        specs = plan.parameters
        numbers = [one.numbers() for one in specs.values()]
        start, lower, upper = (np.array([n[k] for n in numbers], dtype=float) for k in range(3))
        return cls(
            names=tuple(specs),
            titles=tuple(one.title or name for name, one in specs.items()),
            units=tuple(n[3] for n in numbers),
            start=start,
            lower=lower,
            upper=upper,
            scale=np.array([parameter_size(*n[:3]) for n in numbers]),
            prior_mean=np.array([one.prior_numbers()[0] for one in specs.values()]),
            prior_sd=np.array([one.prior_numbers()[1] for one in specs.values()]),
            logarithmic=np.array([one.scale == "log" for one in specs.values()]),
            states=states,
        )

    @property
    def count(self) -> int:
        """Number of parameters."""
        return len(self.names)

    def sizes(self) -> Array:
        """Return the size of each, (p + h,): of a logarithm 1."""
        return np.concatenate([np.where(self.logarithmic, 1.0, self.scale), np.full(self.states, _REACH)])

    def to_search(self, whole: Array) -> Array:
        """Return search coordinates of values with states, (p + h,)."""
        found, p = np.array(whole, dtype=float), self.count
        logarithms = np.log(np.where(self.logarithmic, found[:p], 1.0))
        found[:p] = np.where(self.logarithmic, logarithms, found[:p])
        return found / self.sizes()

    def from_search(self, coordinates: Array) -> Array:
        """Return values with states from search coordinates, (p + h,)."""
        found, p = np.asarray(coordinates, dtype=float) * self.sizes(), self.count
        values = np.where(self.logarithmic, np.exp(np.where(self.logarithmic, found[:p], 0.0)), found[:p])
        # Round-off of exp and log must not leave the bounds.
        found[:p] = np.clip(values, self.lower, self.upper)
        return found

    def search_slopes(self, whole: Array) -> Array:
        """Return the derivative of each search coordinate by its value, (p + h,)."""
        rates, p = 1.0 / self.sizes(), self.count
        rates[:p] = np.where(self.logarithmic, 1.0 / np.where(self.logarithmic, whole[:p], 1.0), rates[:p])
        return rates

    def prior_residuals(self, whole: Array) -> Array:
        """Return values less the means of their priors, over the standard deviations, (priors,)."""
        known = np.isfinite(self.prior_sd)
        return np.asarray(((whole[: self.count] - self.prior_mean) / self.prior_sd)[known])

    def prior_slopes(self, whole: Array) -> Array:
        """Return the derivatives of prior residuals by search coordinates, (priors, p + h)."""
        known = np.isfinite(self.prior_sd)
        slopes = np.zeros((self.count, len(whole)))
        slopes[:, : self.count] = np.diag(1.0 / self.prior_sd / self.search_slopes(whole)[: self.count])
        return slopes[known]

    def bounds(self) -> tuple[Array, Array]:
        """Return the bounds of search coordinates, (p + h,) each."""
        free = np.full(self.states, math.inf)
        lower = np.where(self.logarithmic & ~np.isfinite(self.lower), 0.0, self.lower)
        with np.errstate(divide="ignore"):
            return self.to_search(np.concatenate([lower, -free])), self.to_search(
                np.concatenate([self.upper, free])
            )


def parameter_size(start: float, low: float, high: float) -> float:
    """Return the size of a parameter: of its start, or its bounds' distance [SI]."""
    if start != 0.0:
        return abs(start)
    return high - low if math.isfinite(high - low) else 1.0
