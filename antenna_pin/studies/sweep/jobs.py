"""Jobs of a study: one run as plain data, in any process."""

from __future__ import annotations

import contextlib
import json
import math
import platform
import tempfile
import threading
import time
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

from antenna_pin.base.interruption import uninterrupted
from antenna_pin.errors import AntennaPinError, AssumedWarning, LedgerOpenWarning, MissingToolError
from antenna_pin.run.simulation import simulate
from antenna_pin.run.simulation.inputs import check_scenario
from antenna_pin.scenario import Scenario
from antenna_pin.studies.sweep.responses import ResponseSpec, evaluate
from antenna_pin.trajectory import Trajectory, library_versions


@dataclass(frozen=True, slots=True)
class Job:
    """Run of a study as plain data."""

    run: int  # number of the run
    overrides: dict[str, Any]  # of the scenario
    seed: int  # of the run [-]
    follows: dict[str, Any] = field(default_factory=dict)  # overrides that the reference shares
    scenario: str = ""  # as JSON if it names files, which must travel along; else ""


@dataclass(frozen=True, slots=True)
class Work:
    """Data that all runs of a study share."""

    base: str  # scenario as JSON, with all files that it names
    reference: str  # scenario of the reference as JSON; "" without one
    responses: dict[str, ResponseSpec]  # by name
    sources: dict[str, str]  # texts of the files of functions, by response
    results: str  # full results to keep: ``none``, ``failed``, ``all``
    versions: dict[str, str]  # required versions of the package and its libraries


@dataclass(frozen=True, slots=True)
class FinishedRun:
    """Finished run of a study."""

    entry: dict[str, Any]  # line of the journal, as JSON types
    result: bytes = b""  # full result file, or b""


@lru_cache(maxsize=8)
def _scenario(text: str) -> Scenario:
    return Scenario.model_validate_json(text)


@lru_cache(maxsize=64)
def _reference(text: str, follows: str) -> Trajectory:
    scenario = _scenario(text)
    values = json.loads(follows)
    return uninterrupted(simulate(scenario.with_overrides(values) if values else scenario))


def scenario_of(work: Work, job: Job) -> Scenario:
    """Return the scenario of a run."""
    return _scenario(job.scenario) if job.scenario else _scenario(work.base).with_overrides(job.overrides)


def check_jobs(work: Work, jobs: Sequence[Job]) -> list[tuple[int, str]]:
    """Return the numbers of the runs that cannot be built, each with the reason."""
    _check_versions(work)
    found = []
    for job in jobs:
        try:
            check_scenario(scenario_of(work, job))
            if work.reference and job.follows:
                check_scenario(_scenario(work.reference).with_overrides(job.follows))
        except AntennaPinError as error:
            found.append((job.run, str(error)))
    return found


def _check_versions(work: Work) -> None:
    own = library_versions()
    for name, version in work.versions.items():
        if own.get(name) != version:
            raise MissingToolError(
                f"worker {platform.node()}: {name} must be the study's {version}, got {own.get(name)}; "
                "install the same version there"
            )


def do_jobs(work: Work, jobs: Sequence[Job]) -> list[FinishedRun]:
    """Make runs in order, up to an interrupted one; refuse versions other than the study's."""
    _check_versions(work)
    done: list[FinishedRun] = []
    for job in jobs:
        done.append(_do(work, job))
        if done[-1].entry["outcome"] == "INTERRUPTED":
            break
    return done


def _do(work: Work, job: Job) -> FinishedRun:
    began, busy = time.perf_counter(), time.thread_time()
    entry: dict[str, Any] = {"run": job.run, "seed": job.seed, "values": {}}
    reference: Trajectory | None = None
    result = b""
    try:
        with _told_of(job):
            run = simulate(scenario_of(work, job))
    except AntennaPinError as error:  # only what the check before the start could not see
        entry |= failed_entry("REFUSED", str(error))
    except Exception as error:  # a bug must not end a study of a week
        entry |= failed_entry("FAILED", f"{type(error).__name__}: {error}")
    else:
        simulated, cpu = time.perf_counter() - began, time.thread_time() - busy
        counts = run.counts
        message = run.message
        for name, response in work.responses.items():
            try:
                if response.compares and reference is None and work.reference:
                    reference = _reference(work.reference, json.dumps(job.follows, sort_keys=True))
                value = float(evaluate(name, response, work.sources.get(name, ""), run, reference, job.seed))
                entry["values"][name] = value
                if not math.isfinite(value):
                    message += f"; response {name}: it is {value} for this run, not a number"
            except Exception as error:
                entry["values"][name] = float("nan")
                kind = "" if isinstance(error, AntennaPinError) else f"{type(error).__name__}: "
                message += f"; response {name}: {kind}{error}"
        entry |= {
            "outcome": run.outcome.name,
            "message": " ".join(message.split()),
            "end_time": float(run.data.attrs["end_time"]),
            "steps": counts.accepted,
            **{name: getattr(counts, name) for name in ("rejected", "relocated", "evaluations")},
            "simulated": simulated,
            "cpu": cpu,
        }
        if work.results == "all" or (work.results == "failed" and not run.completed):
            with tempfile.TemporaryDirectory() as folder:
                result = run.save(Path(folder, "run.nc")).read_bytes()
    entry |= {"wall_time": time.perf_counter() - began, "worker": platform.node()}
    return FinishedRun(entry, result)


class _NumberedWarnings:
    """Warnings of runs with their numbers in the study, for all threads together."""

    def __init__(self) -> None:
        self._of_thread, self._lock, self._inside = threading.local(), threading.Lock(), 0
        self._caught = contextlib.ExitStack()

    @contextlib.contextmanager
    def __call__(self, job: Job) -> Iterator[None]:
        """Prefix warnings of this thread with a run's number."""
        self._of_thread.run = job.run
        with self._lock:  # Python's filters and their display are those of the process
            if self._inside == 0:
                self._begin()
            self._inside += 1
        try:
            yield
        finally:
            with self._lock:
                self._inside -= 1
                if self._inside == 0:
                    self._caught.close()

    def _begin(self) -> None:
        self._caught.enter_context(warnings.catch_warnings())
        warnings.simplefilter("ignore", LedgerOpenWarning)  # such runs are counted, with their message
        warnings.simplefilter("ignore", AssumedWarning)  # alike of all runs; each result has it
        told = warnings.showwarning

        def with_number(message: Warning | str, category: type[Warning], *where: Any, **more: Any) -> None:
            told(f"run {self._of_thread.run}: {message}", category, *where, **more)

        warnings.showwarning = with_number


_told_of = _NumberedWarnings()


def failed_entry(outcome: str, message: str) -> dict[str, Any]:
    """Return the entry of a run without a result."""
    counts = dict.fromkeys(("steps", "rejected", "relocated", "evaluations"), 0)
    seconds = dict.fromkeys(("end_time", "simulated", "cpu"), 0.0)
    return {"outcome": outcome, "message": " ".join(message.split()), **counts, **seconds}
