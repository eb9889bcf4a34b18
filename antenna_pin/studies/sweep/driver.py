"""Driver of a study: prepares it, submits runs, and alone writes the store."""

from __future__ import annotations

import os
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from antenna_pin.base.arguments import takes
from antenna_pin.base.interruption import uninterrupted
from antenna_pin.errors import AntennaPinError, OutputError, ScenarioError
from antenna_pin.run.simulation import simulate
from antenna_pin.scenario import Scenario
from antenna_pin.studies.sweep.design import Design, design_of
from antenna_pin.studies.sweep.executor import Executor, Here, Lost
from antenna_pin.studies.sweep.jobs import (
    FinishedRun,
    Job,
    Work,
    check_jobs,
    do_jobs,
    failed_entry,
    scenario_of,
)
from antenna_pin.studies.sweep.measures import MEASURES
from antenna_pin.studies.sweep.responses import evaluate, source_of
from antenna_pin.studies.sweep.store import LOST, SUFFIX, Store, identity_of, open_study
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


_BATCH_SECONDS = 1.0  # of work in one batch
_LARGEST_BATCH = 200
_CHECKED_AT_ONCE = 100
_TRIES = 3  # of a run by itself that takes its process along
_TABLE_EVERY = 10.0  # [s]
_TABLE_SHARE = 0.02  # of the time, at most, goes into writing the dataset


@dataclass(frozen=True, slots=True)
class StudyProgress:
    """Progress of a study."""

    stage: str  # ``check`` of the runs, or ``run``
    done: int  # runs made or checked, including those of an earlier command
    count: int  # number of all runs
    failed: int  # runs that did not complete, or do not balance


@takes()
def run_study(
    study: Study,
    out: str | os.PathLike[str] | None = None,
    *,
    executor: Executor | None = None,
    apart: bool = False,
    progress: Callable[[StudyProgress], None] | None = None,
    say: Callable[[str], None] | None = None,
) -> xr.Dataset:
    """Make a study's missing runs, and return its dataset.

    Everything is checked before anything is run: each combination is built. An interrupted or killed study
    continues with the same call.

    Args:
        study: The study.
        out: Folder of the store, whose name ends in ``.study``; ``NAME.study`` here by default.
        executor: Executor of the runs: :class:`Here`, this process, by default, or
            :class:`~antenna_pin.studies.sweep.cluster.Cluster`.
        apart: True to give another study or version a store of its own beside an existing one,
            ``NAME-2.study``; else it is refused.
        progress: Called after each batch.
        say: Called with each note, one line.

    Raises:
        OutputError: The store is that of another study, or cannot be written; finished runs are kept.
        ScenarioError: A combination cannot be built, or the study is not valid.
    """
    prepared = prepare(study)
    identity = identity_of(study, prepared.design, prepared.work)
    path = Path(f"{study.name}{SUFFIX}") if out is None else Path(out)
    if path.suffix != SUFFIX:
        raise OutputError(f"{path}: the name of a store must end in {SUFFIX}; try {path.name}{SUFFIX}")
    store = _store(path, prepared, identity, apart)
    note_to = say or (lambda line: None)
    for note in store.notes:
        note_to(note)
    by = executor or Here()
    missing = store.missing()
    seconds = 0.0
    if missing:
        by.start()
        shown = trial(prepared, missing[0])
        seconds = shown.seconds
        for note in shown.notes:
            note_to(note)
        _check(prepared, missing, by, progress)
    with closing(store):
        store.begin()
        try:
            _StudyDriver(prepared, store, by, seconds, progress).run(missing)
        finally:
            store.write_table()
    return open_study(store.path)


def _store(path: Path, plan: PreparedStudy, identity: Any, apart: bool) -> Store:
    number = 1
    while True:
        target = path if number == 1 else path.with_name(f"{path.stem}-{number}{SUFFIX}")
        try:
            return Store(target, plan.study, plan.design, identity)
        except OutputError:
            if not (apart and target.is_dir()) or number >= 1000:
                raise
            number += 1


def _check(
    plan: PreparedStudy, runs: list[int], by: Executor, progress: Callable[[StudyProgress], None] | None
) -> None:
    """Refuse a study of which a run cannot be built, with the first such run."""
    refused: list[tuple[int, str]] = []
    done = 0
    size = max(1, min(_CHECKED_AT_ONCE, -(-len(runs) // by.width)))
    batches = ([_job(plan, run) for run in runs[first : first + size]] for first in range(0, len(runs), size))
    for batch, answer in by.each(check_jobs, plan.work, batches):
        if isinstance(answer, Lost):
            refused.append((batch[0].run, str(answer)))
        else:
            refused += answer
        done += len(batch)
        if progress is not None:
            progress(StudyProgress("check", done, len(runs), len(refused)))
    if refused:
        run, reason = min(refused)
        more = f" ({len(refused)} of {len(runs)} runs are refused)" if len(refused) > 1 else ""
        raise ScenarioError(f"{plan.place}: {plan.design.label(run)}: {reason}{more}")


def _job(plan: PreparedStudy, run: int) -> Job:
    try:
        return plan.job(run)
    except ScenarioError as error:
        raise ScenarioError(f"{plan.place}: {plan.design.label(run)}: {error}") from None


class _StudyDriver:
    """Share of a study for one command."""

    def __init__(
        self,
        plan: PreparedStudy,
        store: Store,
        by: Executor,
        seconds: float,
        progress: Callable[[StudyProgress], None] | None,
    ) -> None:
        self.prepared, self.store, self.by, self.progress = plan, store, by, progress
        self.seconds = max(seconds, 1e-4)  # of a run, as far as is known
        self.waiting: deque[int] = deque()
        self.again: deque[Job] = deque()
        self.tries: dict[int, int] = {}
        self.written, self.cost = time.monotonic(), 0.0
        self.failed = sum(e["outcome"] not in ("COMPLETED", "STOPPED") for e in store.entries.values())

    def run(self, runs: list[int]) -> None:
        self.waiting.extend(runs)
        self._tell()
        while self.waiting or self.again:
            for batch, answer in self.by.each(do_jobs, self.prepared.work, self._batches()):
                if isinstance(answer, Lost):
                    self._lost(batch, answer)
                else:
                    for done in answer:
                        self._keep(done)
                self._tell()
                self._write_now_and_then()

    def _batches(self) -> Iterator[list[Job]]:
        """Yield the next runs in batches of about a second; smaller towards the end."""
        while self.waiting or self.again:
            if self.again:
                yield [self.again.popleft()]
                continue
            fair = -(-len(self.waiting) // (4 * self.by.width))
            size = max(1, min(int(_BATCH_SECONDS / self.seconds), _LARGEST_BATCH, fair))
            taken = [self.waiting.popleft() for _ in range(min(size, len(self.waiting)))]
            yield [self.prepared.job(run) for run in taken]

    def _keep(self, done: FinishedRun) -> None:
        entry = done.entry
        if entry["outcome"] == "INTERRUPTED":  # by Ctrl-C, in this process
            raise KeyboardInterrupt
        self.store.add(entry, done.result)
        self.failed += entry["outcome"] not in ("COMPLETED", "STOPPED")
        self.seconds += 0.1 * (entry["wall_time"] - self.seconds)

    def _lost(self, batch: list[Job], reason: Lost) -> None:
        """Retry the runs of a lost batch one by one; give up repeated losses."""
        for job in batch:
            tries = self.tries[job.run] = self.tries.get(job.run, 0) + (len(batch) == 1)
            if tries < _TRIES:
                self.again.append(job)
                continue
            entry = {"run": job.run, "seed": job.seed, "values": {}, "wall_time": 0.0, "worker": ""}
            self._keep(FinishedRun(entry | failed_entry(LOST, f"{reason}, {tries} times")))

    def _tell(self) -> None:
        if self.progress is not None:
            self.progress(StudyProgress("run", len(self.store.entries), self.store.design.count, self.failed))

    def _write_now_and_then(self) -> None:
        if time.monotonic() - self.written > max(_TABLE_EVERY, self.cost / _TABLE_SHARE):
            began = time.monotonic()
            self.store.write_table()
            self.written = time.monotonic()
            self.cost = self.written - began
