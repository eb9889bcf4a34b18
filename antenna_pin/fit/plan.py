"""The file of a fit: which scenario, which records, which numbers are unknown, how they are found."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from antenna_pin.arguments import takes
from antenna_pin.fit.columns import AnyQuantity, ColumnSpec
from antenna_pin.fit.layout import LayoutSpec
from antenna_pin.fit.losses import Loss
from antenna_pin.fit.sureness import Noise
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.runs_file import RunsFile, laid_over, nested
from antenna_pin.scenario.spec import Count, Folder, Quantity, Spec, refuse, refuse_name
from antenna_pin.units import any_quantity, shown

__all__ = [
    "FitParameterSpec",
    "FitPlan",
    "PiecesSpec",
    "RecordSpec",
    "StartsSpec",
    "SurfaceSpec",
    "load_fit",
    "place_in_record",
]

#: Of a record's own numbers: ``records.NAME.clock_shift``, ``records.NAME.columns.COLUMN.gain``.
_OF_RECORD = re.compile(r"records\.([^.]+)\.(?:(clock_shift)|columns\.([^.]+)\.(gain|offset))")

Jacobian = Literal["differences", "equation"]


def place_in_record(key: str) -> tuple[str, str, str] | None:
    """Return record, column ("" of the record itself) and name of the number that a key is, or None."""
    found = _OF_RECORD.fullmatch(key)
    return None if found is None else (found[1], found[3] or "", found[2] or found[4])


class PiecesSpec(Spec):
    """A record cut into pieces that start from states of their own (multiple shooting).

    Attributes:
        length: Of a piece; the last may be shorter [s].
        weight: By which the jump from a piece's end to the next one's start counts, in units of the run's
            error scales: the larger, the nearer to one continuous motion [-].
    """

    length: Annotated[float, Quantity("s", "positive")]
    weight: Annotated[float, Quantity("1", "positive")] = 1e4


class RecordSpec(LayoutSpec):
    """One measured run: how its file is laid out, and what was measured.

    Attributes:
        file: A text (CSV and its kin), NetCDF, MAT or universal file, from the fit file's folder.
        clock_shift: What is added to the file's times to have the run's [s].
        window: Of the file's clock, what counts of it [s]; all if left out.
        gaps: Whether rows without numbers, and times at which rows are missing, are ``refuse``d, or the rows
            that are there count (``skip``).
        case: Of the scenario, if not the fit's.
        set: What is set over the scenario for this record.
        pieces: If it is compared piece by piece.
        columns: What was measured, by name.
    """

    file: str
    clock_shift: Annotated[float, Quantity("s")] = 0.0
    window: tuple[Annotated[float, Quantity("s")], Annotated[float, Quantity("s")]] | None = None
    gaps: Literal["refuse", "skip"] = "refuse"
    case: str | None = None
    set: dict[str, Any] = Field(default_factory=dict)
    pieces: PiecesSpec | None = None
    columns: dict[str, ColumnSpec]

    @model_validator(mode="before")
    @classmethod
    def _nest(cls, data: Any) -> Any:
        """Let keys of the scenario stand with dots."""
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
                    rule = "must be a curve without a filter in a record of pieces, which start anew"
                    refuse(rule, "columns", name)
        return self


class FitParameterSpec(Spec):
    """One unknown number.

    Attributes:
        key: Key of the scenario, as a study has it, or several that get the same value; or a number of a
            record: ``records.NAME.clock_shift``, ``records.NAME.columns.COLUMN.gain`` or ``.offset``.
        start: Where the search begins.
        between: Its bounds.
        scale: ``log`` for a positive number of which not even the size is known.
        records: Whose it is; of all records if left out.
        title: What it is called in figures; its name if left out.
    """

    key: str | tuple[str, ...]
    start: AnyQuantity
    between: tuple[AnyQuantity, AnyQuantity] | None = None
    scale: Literal["linear", "log"] = "linear"
    records: tuple[str, ...] | None = None
    title: str = ""

    @property
    def keys_set(self) -> tuple[str, ...]:
        """The keys that it is."""
        return (self.key,) if isinstance(self.key, str) else self.key

    def numbers(self) -> tuple[float, float, float, str]:
        """Return start, lower and upper bound in SI units (infinite if there is none), and the unit."""
        texts = (self.start, *(self.between or ()))
        read = [any_quantity(text) or (0.0, "") for text in texts]
        unit = next((unit for _, unit in read if unit not in ("", "1")), "")
        written = str(self.start).strip().partition(" ")[2].strip()
        if unit and any_quantity(f"1 {written}") == (1.0, unit):
            unit = written  # as its author knows it: N/m**1.5, not kg/m**0.5/s**2
        low, high = (read[1][0], read[2][0]) if self.between is not None else (-float("inf"), float("inf"))
        return read[0][0], low, high, unit

    @model_validator(mode="after")
    def _check_numbers(self) -> Self:
        if not self.keys_set:
            refuse("must name a key of the scenario, got none", "key")
        wanted = _unit(self.start)
        for i, value in enumerate(self.between or ()):
            number, unit = any_quantity(value) or (0.0, "")
            if _unit(value) != wanted and not (number == 0.0 and not unit):
                refuse(f"must be of start's unit [{wanted or '1'}], got {shown(value)}", "between", i)
        start, low, high, _ = self.numbers()
        if not low < high:
            refuse(f"must be bounds that rise, got {shown(self.between)}", "between")
        if not low <= start <= high:
            refuse(f"must be within the bounds {shown(self.between)}, got {shown(self.start)}", "start")
        if self.scale == "log" and not (start > 0.0 and (self.between is None or low > 0.0)):
            at = "start" if not start > 0.0 else "between"
            value = self.start if at == "start" else self.between
            refuse(f'must be positive for scale = "log", got {shown(value)}', at)
        return self


def _unit(value: object) -> str:
    """Return the SI unit that a quantity names; "" of a pure number."""
    unit = (any_quantity(value) or (0.0, ""))[1]
    return "" if unit == "1" else unit


class StartsSpec(Spec):
    """Many starts, for a sum of squares with several valleys: Sobol' points between the bounds.

    Attributes:
        count: Points at which the sum is looked at, a power of two; the start is one more [-].
        keep: Of them, the best, from which a search begins [-].
        seed: Of the scrambling [-].
    """

    count: Annotated[int, BeforeValidator(Count(2, 1_000_000).read)]
    keep: Annotated[int, BeforeValidator(Count(1, 10_000).read)] = 4
    seed: Annotated[int, BeforeValidator(Count(0, 2**62).read)] = 0

    @model_validator(mode="after")
    def _check_count(self) -> Self:
        if self.count & (self.count - 1):
            refuse(f"must be a power of two, got {self.count}", "count")
        return self


class SurfaceSpec(Spec):
    """Of statistics of chaotic motions: surfaces through what many runs come to, in place of derivatives.

    Attributes:
        runs: At points of a box, each time, a power of two [-].
        width: Half of the first box, in sizes of the parameters [-].
        rounds: Boxes at most [-].
        seed: Of the points [-].
    """

    runs: Annotated[int, BeforeValidator(Count(16, 1_000_000).read)] = 64
    width: Annotated[float, Quantity("1", "positive")] = 0.3
    rounds: Annotated[int, BeforeValidator(Count(1, 1000).read)] = 8
    seed: Annotated[int, BeforeValidator(Count(0, 2**62).read)] = 0

    @model_validator(mode="after")
    def _check_runs(self) -> Self:
        if self.runs & (self.runs - 1):
            refuse(f"must be a power of two, got {self.runs}", "runs")
        return self


class FitPlan(RunsFile):
    """A fit that can be asked for by a file.

    Attributes:
        parameters: What is unknown, by name.
        records: What was measured, by name.
        noise: ``given``, the columns' ``sd`` are what they say; ``estimated``, only their ratios are, and
            what the residuals come to says how large the noise is; or ``correlated``, and they hang together
            in time.
        loss: How a residual counts, as SciPy's ``least_squares`` has it: ``linear`` by its square, the others
            less where it is large.
        loss_scale: Where it begins to be large, in standard deviations [-].
        jacobian: Whence derivatives come: central ``differences`` of runs, or the variational ``equation``
            along one run, for where runs differ too much or are too many.
        difference_step: Of those, over a parameter's scale: its start's size, or the bounds' distance [-].
        tolerance: Relative change of the sum, and of parameters, below which the search has ended [-].
        most: Evaluations by steps of a search after which it is given up [-].
        starts: Of a search from many points; from ``start`` alone if left out.
        surface: Of a search among statistics that scatter from run to run; by derivatives if left out.
        name: Of the fit: that of its file.
        folder: Of the file.
    """

    suffix: ClassVar[str] = ".fit.toml"
    word: ClassVar[str] = "fit"

    parameters: dict[str, FitParameterSpec]
    records: dict[str, RecordSpec]
    noise: Noise = "given"
    loss: Loss = "linear"
    loss_scale: Annotated[float, Quantity("1", "positive")] = 1.0
    jacobian: Jacobian = "differences"
    difference_step: Annotated[float, Quantity("1", "between 0 and 1")] = 1e-4
    tolerance: Annotated[float, Quantity("1", "between 0 and 1")] = 1e-8
    most: Annotated[int, BeforeValidator(Count(1, 100_000).read)] = 100
    starts: StartsSpec | None = None
    surface: SurfaceSpec | None = None
    name: str = "fit"
    folder: Folder = Path()

    @model_validator(mode="after")
    def _check_jacobian(self) -> Self:
        every = [(name, *pair) for name, one in self.records.items() for pair in one.columns.items()]
        for name, column, spec in every if self.jacobian == "equation" else ():
            if spec.compare == "blows":
                rule = 'must be "differences" where blows are compared, which are found anew in each run'
                refuse(f"{rule}, as records.{name}.columns.{column} does", "jacobian")
        return self

    @model_validator(mode="after")
    def _check_surface(self) -> Self:
        if self.surface is None:
            return self
        for name, record in self.records.items():
            for column, spec in record.columns.items():
                if spec.compare == "curve":
                    rule = "must be a statistic beside a surface: rms, spectrum or blows"
                    refuse(rule, "records", name, "columns", column, "compare")
        for name, wanted in (
            ("starts", None),
            ("jacobian", "differences"),
            ("loss", "linear"),
            ("noise", "given"),
        ):
            if getattr(self, name) != wanted:
                refuse("must be left out beside a surface, which has its own", name)
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
            for i, record in enumerate(parameter.records or ()):
                if record not in self.records:
                    refuse_name("record", record, self.records, "parameters", name, "records", i)
            for key in parameter.keys_set:
                self._check_of_record(name, key)
                for record in parameter.records or self.records:
                    owner = owners.setdefault((key, record), name)
                    if owner != name:
                        refuse(f"must be a key of its own, got that of {owner}", "parameters", name, "key")
            if self.starts is not None and parameter.between is None:
                refuse("is missing; many starts lie between bounds", "parameters", name, "between")
        return self

    def _check_of_record(self, name: str, key: str) -> None:
        """Refuse a parameter of a record, column or number that is not there."""
        if not key.startswith("records."):
            return
        place = place_in_record(key)
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
            refuse("must be left out for a number of a record, whose it is", "parameters", name, "records")

    def scenario_of(self, record: str) -> Scenario:
        """Return the scenario of a record, before what is fitted."""
        spec = self.records[record]
        case = self.case if spec.case is None else spec.case
        return self.scenario_with(case, laid_over(self.set, spec.set))


@takes()
def load_fit(path: str | os.PathLike[str], settings: Mapping[str, Any] | Sequence[str] = ()) -> FitPlan:
    """Return a fit's file, complete and checked; its scenario and records are not read yet.

    Args:
        path: Of the file, or the name of a shipped one.
        settings: What is set over the file's keys: ``["loss=huber", "starts.count=64"]``.

    Raises:
        ScenarioError: With one line that gives file, place, rule, the value seen and a way out.
        UnknownNameError: There is no such fit.
    """
    return FitPlan.loaded("load_fit", path, settings)
