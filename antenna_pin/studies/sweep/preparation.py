"""Preparation of a study: scenario with its files, jobs, and a trial run."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from antenna_pin.base.arguments import takes
from antenna_pin.base.interruption import uninterrupted
from antenna_pin.errors import AntennaPinError, ScenarioError
from antenna_pin.run.simulation import simulate
from antenna_pin.scenario import Scenario
from antenna_pin.studies.sweep.design import Design, design_of
from antenna_pin.studies.sweep.jobs import Job, Work, scenario_of
from antenna_pin.studies.sweep.measures import MEASURES
from antenna_pin.studies.sweep.responses import evaluate, source_of
from antenna_pin.studies.sweep.study import Study
from antenna_pin.trajectory import Trajectory, is_lean, library_versions

_TRIAL_SHARE = 0.02  # of a run's duration
_LONG_ENOUGH = 1.0  # [s] for a trial to tell the pace of a run


@dataclass(frozen=True, slots=True)
class PreparedStudy:
    """Study ready to be run."""

    study: Study  # the study
    design: Design  # its runs
    base: Scenario  # scenario before the overrides of parameters
    work: Work  # data that all runs share
    record: Mapping[str, Any]  # overrides of what runs record

    @property
    def place(self) -> str:
        """Name in messages."""
        return f"study {self.study.name}"

    def job(self, run: int) -> Job:
        """Return one run as data; files that it names are read here."""
        overrides = {**self.record, **self.design.overrides(run, self.base)}
        follows = self.study.reference.follows if self.study.reference is not None else ()
        more = self.design.overrides(run, self.base, follows) if follows else {}
        files = any(key.rpartition(".")[2] in ("file", "urdf") for key in overrides)
        whole = self.base.with_overrides(overrides).model_dump_json() if files else ""
        return Job(run, overrides, int(self.design.seeds[run]), more, whole)

    def jobs(self, runs: Sequence[int]) -> Iterator[Job]:
        """Yield runs as data."""
        return (self.job(run) for run in runs)


@dataclass(frozen=True, slots=True)
class TrialRun:
    """Findings of a short part of the first run."""

    seconds: float  # estimated time of a whole run on this machine [s]
    notes: tuple[str, ...] = ()  # notes, a line each


@takes()
def prepare(study: Study) -> PreparedStudy:
    """Return a study ready to be run: scenario, runs and functions read and checked.

    Raises:
        AntennaPinError: The study is not valid.
    """
    design = design_of(study)
    base = study.base()
    quantities = study.recorded_quantities(base)
    record = {} if quantities is None else {"output.form": "lean", "output.keep": list(quantities)}
    reference = study.reference_base()
    for name in study.parameters:
        if study.reference is None and "duration" in study.parameters[name].keys_set:
            continue
        if "duration" in study.parameters[name].keys_set and name not in study.reference.follows:  # type: ignore[union-attr]
            raise ScenarioError(
                f"study {study.name}: reference.follows must name {name}, which varies the duration"
            )
    try:
        sources = {name: source_of(one, study.folder, name) for name, one in study.responses.items()}
    except ScenarioError as error:
        raise ScenarioError(f"study {study.name}: {error}") from None
    work = Work(
        base=base.model_dump_json(),
        reference="" if reference is None else reference.model_dump_json(),
        responses=dict(study.responses),
        sources={name: text for name, text in sources.items() if text},
        results=study.results,
        versions=library_versions(),
    )
    return PreparedStudy(study, design, base, work, record)


@takes()
def trial(plan: PreparedStudy, run: int = 0) -> TrialRun:
    """Make a short part of a run; check its responses, and estimate the run time.

    Raises:
        AntennaPinError: The run cannot be built, or a response does not exist for it.
    """
    place = f"{plan.place}: {plan.design.label(run)}"
    try:
        job = plan.job(run)
        scenario = scenario_of(plan.work, job)
        span = scenario.duration * _TRIAL_SHARE
        uninterrupted(simulate(scenario, duration=span))  # loads the kernels
        began = time.perf_counter()
        made = uninterrupted(simulate(scenario, duration=span))
        seconds = time.perf_counter() - began
    except AntennaPinError as error:
        raise ScenarioError(f"{place}: {error}") from None
    reference = _reference(plan, job, span)
    notes = []
    for name, response in plan.study.responses.items():
        where = f"{plan.place}: responses.{name}"
        measure = MEASURES.get(response.measure or "")
        if measure is not None and measure.series and is_lean(made.data):
            raise ScenarioError(
                f'{where}: {measure.name} must have the series of a run, got output.form = "lean"; set '
                'output.form to "full"'
            )
        windows = (response.window, response.drift_spacing, response.period)
        longest = max((window for window in windows if window is not None), default=0.0)
        if longest > scenario.duration:
            raise ScenarioError(
                f"{where}: its windows must be within the run's {scenario.duration:g} s, got {longest:g} s"
            )
        if longest > made.data.attrs["end_time"]:
            continue  # can be told of a whole run only
        source = plan.work.sources.get(name, "")
        try:
            evaluate(name, response, source, made, reference, job.seed)
        except AntennaPinError as error:
            raise ScenarioError(f"{where}: {error}") from None
        except (NameError, AttributeError, ImportError, TypeError, SyntaxError) as error:
            raise ScenarioError(f"{where}: {response.function} raises {error!r}") from None
        except Exception as error:
            notes.append(f"{where}: {response.function} raises {error!r} on a trial of {span:g} s")
    stepping = made.counts.wall_seconds
    whole = seconds - stepping + stepping * scenario.duration / max(float(made.data.attrs["end_time"]), 1e-12)
    return TrialRun(whole, tuple(notes))


class RunTime(NamedTuple):
    """Estimates of the time of a run [s]."""

    least: float  # estimate at the greatest measured pace
    mean: float  # estimate at the last pace
    most: float  # estimate at the least pace


@takes()
def run_seconds(plan: PreparedStudy) -> RunTime:
    """Return estimates of a run's time on this machine [s], means over three runs.

    Parts of the first, the middle and the last run are made, longer and longer, up to the whole or to a part
    of one second; the rest is extrapolated at a pace of these parts.

    Raises:
        AntennaPinError: A run cannot be built.
    """
    last = plan.design.count - 1
    every = np.mean([_seconds(plan, run) for run in sorted({0, last // 2, last})], axis=0)
    return RunTime(*map(float, every))


def _seconds(plan: PreparedStudy, run: int) -> RunTime:
    scenario = scenario_of(plan.work, plan.job(run))
    share, before, paces = _TRIAL_SHARE, (0.0, 0.0), list[float]()
    while True:
        began = time.perf_counter()
        counts = uninterrupted(simulate(scenario, duration=share * scenario.duration)).counts
        spent = time.perf_counter() - began - counts.compile_seconds  # which is for once
        stepping = counts.wall_seconds  # without what it takes to build it
        paces.append(max((stepping - before[1]) / (share - before[0]), 0.0))
        if share == 1.0 or stepping > _LONG_ENOUGH:
            return RunTime(*(spent + one * (1.0 - share) for one in (min(paces), paces[-1], max(paces))))
        before, share = (share, stepping), min(2.0 * share, 1.0)


def _reference(plan: PreparedStudy, job: Job, span: float) -> Trajectory | None:
    text = plan.work.reference
    if not text:
        return None
    values: dict[str, Any] = job.follows
    try:
        scenario = Scenario.model_validate_json(text).with_overrides(values)
        if scenario.output.form == "lean":
            raise ScenarioError('output.form must be "full" for runs to be compared with it, got "lean"')
        return uninterrupted(simulate(scenario, duration=span))
    except AntennaPinError as error:
        raise ScenarioError(f"{plan.place}: reference: {error}") from None
