"""Study file: scenario, parameters and responses."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import brief
from antenna_pin.base.views import StudyFiguresView, StudyReporter, View, as_html
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.merge import merge
from antenna_pin.scenario.parameters import ParameterSpec
from antenna_pin.scenario.runs_file import RunsFile, nested
from antenna_pin.scenario.spec import Count, Folder, Spec, refuse, refuse_name
from antenna_pin.studies.sweep.measures import MEASURES
from antenna_pin.studies.sweep.responses import ResponseSpec
from antenna_pin.trajectory.quantities import KEEPABLE, needs_samples

#: Names that the dataset of a study has for itself.
RESERVED = (
    "sample",
    "factor",
    "probability",
    "run",
    "seed",
    "outcome",
    "message",
    "end_time",
    "steps",
    "rejected",
    "relocated",
    "evaluations",
    "wall_time",
    "worker",
)


class SamplingSpec(Spec):
    """Sampling of parameters with a distribution.

    Attributes:
        method: ``random``; ``latin-hypercube``; ``sobol``, a scrambled sequence of low discrepancy;
            ``morris`` and ``saltelli``, designs for sensitivities.
        count: Number of samples, a power of two for Sobol' and Saltelli; of trajectories for Morris [-].
        levels: Levels of Morris's grid [-].
        second_order: True for interactions in Saltelli's design.
    """

    method: Literal["random", "latin-hypercube", "sobol", "morris", "saltelli"] = "latin-hypercube"
    count: Annotated[int, BeforeValidator(Count(1, 10_000_000).read)]
    levels: Annotated[int, BeforeValidator(Count(4, 1000, even=True).read)] = 4
    second_order: bool = False

    @model_validator(mode="after")
    def _check_count(self) -> Self:
        if self.method in ("sobol", "saltelli") and self.count & (self.count - 1):
            refuse(f"must be a power of two for {self.method}, got {self.count}", "count")
        if self.method != "morris" and "levels" in self.model_fields_set:
            refuse('must be left out but for method = "morris"', "levels")
        if self.method != "saltelli" and self.second_order:
            refuse('must be left out but for method = "saltelli"', "second_order")
        return self


class ComparisonSpec(Spec):
    """Reference of comparisons, mostly the mechanism with ideal joints.

    Attributes:
        case: Case of the scenario.
        set: Overrides instead of the study's ``set``.
        follows: Parameters of the study that the reference shares, with a run for each of their values.
    """

    case: str | None = None
    set: dict[str, Any] = Field(default_factory=dict)
    follows: tuple[str, ...] = ()


class Study(RunsFile):
    """Parameter study.

    Attributes:
        seed: Seed of the samples and of the runs' own seeds [-].
        parameters: Varied parameters, by name.
        sampling: Sampling of parameters with distributions.
        reference: Reference of compared responses.
        responses: Numbers of each run, by name; or a list of measures and functions.
        results: Full result files to keep: ``none``, those that ``failed`` (ended early or with an open
            ledger), or ``all``.
        keep: Quantities that runs record (``output.keep``), or ``all``; by default the measures of the
            responses, where these suffice.
        name: Name of the study: that of its file.
        folder: Folder of the study file.

    After its runs it has figures and a report: ``study.plot(name)`` and ``study.report("report.html")``.
    """

    __repr__ = __str__ = brief

    plot: ClassVar[View[StudyFiguresView]] = View()
    report: ClassVar[View[StudyReporter]] = View()

    suffix: ClassVar[str] = ".study.toml"
    word: ClassVar[str] = "study"

    seed: Annotated[int, BeforeValidator(Count(0, 2**62).read)] = 0
    parameters: dict[str, ParameterSpec]
    sampling: SamplingSpec | None = None
    reference: ComparisonSpec | None = None
    responses: dict[str, ResponseSpec]
    results: Literal["none", "failed", "all"] = "none"
    keep: Literal["all"] | tuple[str, ...] | None = None
    name: str = "study"
    folder: Folder = Path()

    def _repr_html_(self) -> str:
        """Return the representation in a notebook."""
        return as_html(self)

    @model_validator(mode="before")
    @classmethod
    def _name_responses(cls, data: Any) -> Any:
        """Accept a list of measures and functions for responses of their names."""
        if not (isinstance(data, Mapping) and isinstance(data.get("responses"), list | tuple)):
            return data
        named: dict[str, str] = {}
        for i, entry in enumerate(data["responses"]):
            if not isinstance(entry, str):
                rule = "must be the name of a measure or a function, FILE.py:NAME"
                refuse(f"{rule}, got {entry!r}", "responses", i)
            name = entry.rpartition(":")[2]
            if named.setdefault(name, entry) != entry:
                rule = f"must have a different name, got that of {named[name]}; give both in [responses]"
                refuse(rule, "responses", i)
            named[name] = entry
        return dict(data) | {"responses": named}

    @model_validator(mode="after")
    def _check_together(self) -> Self:
        if not self.parameters:
            refuse("must hold one parameter at least, got none", "parameters")
        if not self.responses:
            refuse("must hold one response at least, got none", "responses")
        for place in ("parameters", "responses"):
            for name in getattr(self, place):
                if name in RESERVED or not name.replace("_", "a").replace("-", "a").isalnum():
                    rule = f"letters, digits, - and _, other than {', '.join(RESERVED)}"
                    refuse(f"must have a name of {rule}", place, name)
        for name in self.responses:
            if name in self.parameters:
                refuse("must not be called as a parameter is", "responses", name)
        self._check_zips()
        self._check_sampling()
        if self.reference is not None:
            for i, name in enumerate(self.reference.follows):
                if name not in self.parameters:
                    refuse_name("parameter", name, self.parameters, "reference", "follows", i)
        if isinstance(self.keep, tuple):
            self._check_keep(self.keep)
        for name, response in self.responses.items():
            if response.compares and self.reference is None:
                rule = "its reference, a table [reference] with the case to compare with"
                refuse(f"{response.measure} must have {rule}", "responses", name)
        return self

    def _check_zips(self) -> None:
        """Refuse two parameters of one key, and zipped ones of different lengths."""
        owners: dict[str, str] = {}
        lengths: dict[str, tuple[str, int]] = {}
        for name, parameter in self.parameters.items():
            for key in parameter.keys_set:
                for other, owner in owners.items():
                    if other == key:
                        refuse(f"must be a different key, got that of {owner}", "parameters", name, "key")
                    if _is_within(key, other) or _is_within(other, key):
                        rule = (
                            f"must not lie within {owner}'s {other}, nor contain it, since one would undo "
                            f"the other"
                        )
                        refuse(f"{rule}, got {key}", "parameters", name, "key")
                owners[key] = name
            group = parameter.zip
            if group is None:
                continue
            if group in self.parameters or group in self.responses or group in RESERVED:
                refuse(f"must be a different name, got {group!r}", "parameters", name, "zip")
            first, length = lengths.setdefault(group, (name, parameter.length))
            if parameter.length != length:
                rule = f"must have as many values as {first}, {length}, got {parameter.length}"
                refuse(rule, "parameters", name)

    def _check_sampling(self) -> None:
        sampled = [name for name, parameter in self.parameters.items() if parameter.sampled]
        if sampled and self.sampling is None:
            refuse(f"is missing; {sampled[0]} has a distribution: give method and count", "sampling")
        if self.sampling is not None and not sampled:
            refuse("must be left out: no parameter has a distribution", "sampling")

    def _check_keep(self, keep: tuple[str, ...]) -> None:
        """Refuse a record that lacks what a response needs."""
        for i, name in enumerate(keep):
            if name not in KEEPABLE:
                refuse_name("quantity", name, KEEPABLE, "keep", i)
        if _form(self.set) == "full":
            refuse('must be left out with set.output.form = "full", which records all', "keep")
        kept = ", ".join(keep) or "nothing"
        for name, response in self.responses.items():
            if response.measure is None:
                continue
            if MEASURES[response.measure].series:
                rule = f"its measure {response.measure} needs the series of a run, which keep leaves out"
                refuse(f"{rule}, got keep = {kept}; leave keep out", "responses", name)
            if response.measure not in keep:
                rule = f"its measure {response.measure} must be in keep, got {kept}"
                refuse(f"{rule}; add it, or leave keep out", "responses", name)

    def recorded_quantities(self, base: Scenario) -> tuple[str, ...] | None:
        """Return the quantities that runs of a scenario record; None for all."""
        if self.keep is not None:
            return None if self.keep == "all" else self.keep
        measures = [response.measure for response in self.responses.values()]
        varied = {key for parameter in self.parameters.values() for key in parameter.keys_set}
        names = tuple(dict.fromkeys(name for name in measures if name is not None))
        if (
            self.results != "none"
            or len(names) < len(set(measures))  # of a function it is not known what it reads
            or any(MEASURES[name].series for name in names)
            or needs_samples(names)
            or any(key.startswith("output.") for key in varied)
            or "form" in base.output.model_fields_set
            and base.output.form == "full"
            or base.output.keep is not None
        ):
            return None
        return names

    def reference_base(self) -> Scenario | None:
        """Return the scenario of the reference, of the runs' duration, before what it follows."""
        if self.reference is None:
            return None
        lasts = {"duration": self.base().duration}
        return self.scenario_with(self.reference.case, merge(lasts, nested(self.reference.set)))


def _form(settings: Mapping[str, Any]) -> Any:
    """Return the form of results that settings of a scenario name; None without one."""
    output = settings.get("output")
    return output.get("form") if isinstance(output, Mapping) else settings.get("output.form")


def _is_within(key: str, table: str) -> bool:
    """Return true for a key of a table, or of an array's numbers."""
    return key.startswith((f"{table}.", f"{table}["))


def list_studies() -> list[str]:
    """Return the names of the shipped studies, as ``bai2020/clearances``."""
    return Study.shipped()


@takes()
def load_study(path: str | os.PathLike[str], settings: Mapping[str, Any] | Sequence[str] = ()) -> Study:
    """Return a study, complete and checked; its scenario is not read yet.

    Args:
        path: Path of a study file, or the name of a shipped one, as ``bai2020/clearances``.
        settings: Overrides of the study's keys: ``["sampling.count=64", "set.duration=0.5 s"]``.

    Raises:
        ScenarioError: With one line that gives file, place, rule, value and a way out.
        UnknownNameError: No such study exists.
    """
    return Study.loaded("load_study", path, settings)
