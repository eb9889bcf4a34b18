"""Candidate experiments of a fit, and the derivatives of their residuals.

An experiment resembles one of the fit's records, with keys of the scenario set again, and other columns or
times if given. Its information depends on the derivatives of its residuals only, and not on measured numbers:
so it is run as a record of the model's own readings.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, ValidationError, model_validator

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.files import absence
from antenna_pin.base.tables import write_csv
from antenna_pin.base.units import shown
from antenna_pin.errors import AntennaPinError, ScenarioError, UnknownNameError
from antenna_pin.scenario.merge import merge
from antenna_pin.scenario.runs_file import nested
from antenna_pin.scenario.shipped import read_toml
from antenna_pin.scenario.spec import Count, QuantityRule, Spec, ValuePlace, dotted, explained, refuse
from antenna_pin.studies.fit.identifiability import Criterion
from antenna_pin.studies.fit.plan import FitPlan, RecordSpec, record_place
from antenna_pin.studies.fit.problem import Problem
from antenna_pin.studies.fit.record_file import read_columns
from antenna_pin.studies.fit.run_service import RunService
from antenna_pin.studies.fit.specs import ColumnSpec, FitParameterSpec, LayoutSpec, names_in

# Most samples of a synthetic record.
_MOST = 1_000_000


class _TimesSpec(Spec):
    """Sample times of an experiment, from its run's start, or later by its clock.

    Attributes:
        until: Time of the last sample, at most [s].
        rate: Samples per second [Hz].
    """

    until: Annotated[float, QuantityRule("s", "positive")]
    rate: Annotated[float, QuantityRule("Hz", "positive")]

    @model_validator(mode="after")
    def _check_count(self) -> Self:
        count = self.until * self.rate
        if not 1.0 <= count <= _MOST:
            refuse(f"must make 2 to {_MOST} samples until then, got {count + 1.0:.6g}", "rate")
        return self

    def instants(self) -> Array:
        """Return the times of the samples, (m,) [s]."""
        return np.asarray(np.arange(int(self.until * self.rate * (1.0 + 1e-12)) + 1) / self.rate)


class _ExperimentSpec(Spec):
    """Experiment of a fit.

    Attributes:
        like: Record of the fit that it resembles; the first by default.
        what: Short description.
        case: Case of the scenario, if not that record's.
        set: Overrides of the record's scenario: dotted keys, or tables.
        times: Sample times, if not that record's.
        columns: Measured quantities, if not that record's.
        repeat: Number of repetitions [-].
    """

    like: str | None = None
    what: str = ""
    case: str | None = None
    set: dict[str, Any] = Field(default_factory=dict)
    times: _TimesSpec | None = None
    columns: dict[str, ColumnSpec] | None = None
    repeat: Annotated[int, BeforeValidator(Count(1, 1_000_000).read)] = 1

    @model_validator(mode="after")
    def _check_columns(self) -> Self:
        if self.columns is not None and not self.columns:
            refuse("must hold one column at least, got none", "columns")
        return self

    @property
    def words(self) -> str:
        """Description, or the keys set."""
        parts = [f"{key} = {shown(value)}" for key, value in _dotted(self.set)]
        parts += [] if self.times is None else [f"{self.times.until:g} s at {self.times.rate:g} Hz"]
        parts += [] if self.columns is None else [f"columns {', '.join(self.columns)}"]
        parts += [f"{self.repeat} times"] if self.repeat > 1 else []
        return self.what or ", ".join(parts)


def _dotted(table: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the keys of nested tables with dots, and their values."""
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from _dotted(value, f"{above}{key}.")
        else:
            yield f"{above}{key}", value


class Experiments(Spec):
    """File of candidate experiments.

    Attributes:
        format: Version of the file format.
        title: Short title.
        criterion: Criterion to minimise: ``D``, the volume of the confidence region; ``c``, the error of the
            ``wanted`` parameter; ``A``, the sum of squared errors; ``E``, the longest axis.
        wanted: Parameter of criterion ``c``.
        total: Total number of experiments of a plan of repetitions; 0 for no plan [-].
        experiments: Experiments by name.
    """

    format: Literal[1] = 1
    title: str = ""
    criterion: Criterion = "D"
    wanted: str | None = None
    total: Annotated[int, BeforeValidator(Count(0, 10_000).read)] = 0
    experiments: dict[str, _ExperimentSpec]

    @model_validator(mode="after")
    def _check_together(self) -> Self:
        if not self.experiments:
            refuse("must hold one experiment at least, got none", "experiments")
        if self.criterion == "c" and self.wanted is None:
            refuse('is missing; criterion = "c" is of one parameter', "wanted")
        if self.total and self.criterion == "E":
            refuse('must be left out for criterion = "E", which has no plan; take D, c or A', "total")
        return self


@takes()
def load_experiments(path: str | os.PathLike[str]) -> Experiments:
    """Return a file of experiments, complete and checked.

    Raises:
        ScenarioError: With one line that gives file, place, rule, the value seen and a way out.
    """
    found, label = Path(os.path.expanduser(os.fspath(path))), str(path)
    if not found.is_file():
        raise ScenarioError(f"{label}: {absence(found)}; it must be a file of experiments, NAME.toml")
    try:
        return Experiments.validated(read_toml(found, label))
    except ValidationError as error:
        raise explained(error, lambda location: ValuePlace(f"{label}: {dotted(location)}".strip())) from None


class Trial:
    """Experiment ready to be run as the model would make it.

    Unknowns of its own, the shift of its clock and the starts of its pieces, are eliminated: residuals that
    they explain give no information.

    Raises:
        AntennaPinError: Record, scenario, columns or parameters are not valid.
    """

    def __init__(
        self,
        plan: FitPlan,
        name: str,
        experiment: _ExperimentSpec,
        values: Array,
        service: Callable[[], RunService] = RunService,
    ) -> None:
        like = next(iter(plan.records)) if experiment.like is None else experiment.like
        if like not in plan.records:
            raise UnknownNameError(f"experiments.{name}.like", "record", like, plan.records)
        self._every = dict(zip(plan.parameters, values, strict=True))
        self._kept = _parameters(plan, like, experiment)
        self._repeat = experiment.repeat
        try:
            with tempfile.TemporaryDirectory() as folder:
                self._problem = _problem(plan, like, experiment, self._kept, values, Path(folder), service)
        except AntennaPinError as error:
            raise ScenarioError(f"experiments.{name}: {error}") from None

    def slopes(self) -> Array:
        """Return the derivatives of its residuals by the parameters of the fit, (m, p).

        Raises:
            NoRunError: The model has no run near the values.
        """
        problem, order = self._problem, list(self._every)
        whole = np.concatenate([[self._every[one] for one in problem.names], problem.states])
        slopes = problem.jacobian(whole)
        anew = [k for k, one in enumerate(problem.names) if _is_clock(self._kept[one])]
        anew += range(len(problem.names), len(whole))
        slopes = eliminate(slopes, np.array(anew, dtype=int))
        found = np.zeros((len(slopes), len(order)))
        for k, one in enumerate(problem.names):
            found[:, order.index(one)] = slopes[:, k]
        return np.asarray(np.sqrt(float(self._repeat)) * found)


def eliminate(slopes: Array, anew: NDArray[np.intp]) -> Array:
    """Return derivatives of residuals with some unknowns eliminated, their columns zero."""
    found = slopes.copy()
    if len(anew):
        theirs = slopes[:, anew]
        sizes = np.linalg.norm(theirs, axis=0)
        theirs = theirs / np.where(sizes > 0.0, sizes, 1.0)
        shares, *_ = np.linalg.lstsq(theirs, slopes, rcond=None)
        found = slopes - theirs @ shares
        found[:, anew] = 0.0
    return np.asarray(found)


def _is_clock(parameter: FitParameterSpec) -> bool:
    """Return whether a parameter is a clock, set anew in each experiment."""
    places = [record_place(key) for key in parameter.keys_set]
    return bool(places) and all(place is not None and place[2] == "clock_shift" for place in places)


def _parameters(plan: FitPlan, like: str, experiment: _ExperimentSpec) -> dict[str, FitParameterSpec]:
    """Return the parameters of an experiment, with its own keys."""
    found = {}
    for name, one in plan.parameters.items():
        if one.records is not None and like not in one.records:
            continue
        keys = []
        for key in one.keys_set:
            place = record_place(key)
            of_columns = experiment.columns is not None and place is not None and bool(place[1])
            if place is None or (place[0] == like and not of_columns):
                keys.append(key)
        used = any(name in names_in(other.value) for other in plan.derived.values())
        if keys or used:
            more = {"key": tuple(keys), "records": None, "prior": None}  # which counts once, before
            found[name] = one.model_copy(update=more)
    return found


def _problem(
    plan: FitPlan,
    like: str,
    experiment: _ExperimentSpec,
    parameters: dict[str, FitParameterSpec],
    values: Array,
    folder: Path,
    service: Callable[[], RunService],
) -> Problem:
    """Return the experiment as a fit of one record."""
    spec = plan.records[like]
    settings = merge(spec.set, nested(experiment.set))
    columns = dict(spec.columns if experiment.columns is None else experiment.columns)
    update: dict[str, Any] = {
        "set": settings,
        "case": spec.case if experiment.case is None else experiment.case,
        "columns": columns,
    }

    def problem(record: RecordSpec) -> Problem:
        changed = {"parameters": parameters, "records": {like: record}, "starts": None}
        return Problem(plan.model_copy(update=changed), service())

    if experiment.times is None and experiment.columns is None:
        return problem(spec.model_copy(update=update))
    if experiment.times is None:
        file = plan.folder / os.path.expanduser(spec.file)
        names = [one.column or name for name, one in spec.columns.items()]
        time = read_columns(file, names, spec, f"records.{like}").time
    else:
        clocks = [one.numbers() for one in parameters.values() if _is_clock(one)]
        # With an early clock the first sample suits any shift.
        early = max(0.0, -min([spec.clock_shift, *(low for _, low, _, _ in clocks)]))
        time = experiment.times.instants() + early
        last = float(time[-1]) + max([spec.clock_shift, *(high for _, _, high, _ in clocks)])
        update |= {"window": None}
        if "duration" not in settings:
            update["set"] = settings | {"duration": last}
    made = {key: one.model_copy(update={"column": key, "unit": None}) for key, one in columns.items()}
    update |= {"file": str(folder / "made.csv"), "columns": made, **LayoutSpec().model_dump()}
    readings = {key: np.zeros(len(time)) for key in made}
    _write(folder / "made.csv", time, readings)
    if any(one.compare in ("spectrum", "blows") for one in made.values()):
        # The noise of bands and impacts depends on a record: the model's own.
        curves = {"compare": "curve", "spectrum": None, "blows": None, "sd": 1.0}
        plain = {key: one.model_copy(update=curves) for key, one in made.items()}
        first = problem(spec.model_copy(update=update | {"columns": plain, "gaps": "skip", "pieces": None}))
        every = dict(zip(plan.parameters, values, strict=True))
        seen = first.predictions([every[one] for one in first.names])
        for key in made:
            mine = seen["column"].values == key
            readings[key] = seen["model"].values[mine]
        _write(folder / "made.csv", time, readings)
    return problem(spec.model_copy(update=update))


def _write(path: Path, time: Array, columns: dict[str, Array]) -> None:
    with path.open("w", newline="", encoding="utf-8") as stream:
        every = (one.tolist() for one in (time, *columns.values()))
        write_csv(stream, ["time", *columns], zip(*every, strict=True))
