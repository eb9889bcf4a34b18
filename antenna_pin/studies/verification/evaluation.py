"""Evaluation of quantities at points of the uncertain numbers, with a journal."""

from __future__ import annotations

import hashlib
import json
import math
import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from types import TracebackType
from typing import Any

from antenna_pin.base.interruption import uninterrupted
from antenna_pin.errors import AntennaPinError
from antenna_pin.run.simulation import simulate
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.requirements import OPTIONS, RequirementSpec
from antenna_pin.studies.sweep.executor import Executor, Here, Lost
from antenna_pin.studies.sweep.journal import open_journal
from antenna_pin.studies.verification.plan import Verification
from antenna_pin.studies.verification.quantities import quantity_of
from antenna_pin.studies.verification.quantity import Case
from antenna_pin.trajectory import Trajectory, code_digest, library_versions

#: Outcome of a point that no process could evaluate.
LOST = "LOST"


@dataclass(frozen=True, slots=True)
class EvaluatedPoint:
    """EvaluatedPoint of the uncertain numbers as plain data."""

    key: str  # identity of the point: its overrides as JSON
    overrides: dict[str, Any]  # of the scenario
    asked: tuple[str, ...]  # keys of the quantities


@dataclass(frozen=True, slots=True)
class EvaluationWork:
    """Data that all points share."""

    base: str  # scenario as JSON
    reference: str  # scenario of the reference as JSON, or ""
    specs: dict[str, RequirementSpec]  # quantities by their keys
    sources: dict[str, str]  # texts of the files of functions, by function


@dataclass(frozen=True, slots=True)
class Evaluated:
    """Numbers at one point.

    Attributes:
        overrides: Overrides of the scenario.
        values: Values by key of the quantity; NaN for none [SI].
        units: Units by key of the quantity, where the object decides them.
        errors: Reasons for missing values, by key.
        facts: Outcome, ledger and times of the run; {} without a run.
    """

    overrides: dict[str, Any]
    values: dict[str, float]
    units: dict[str, str]
    errors: dict[str, str]
    facts: dict[str, Any]


def key_of(spec: RequirementSpec) -> str:
    """Return the identity of a requirement's quantity: its name, object and options."""
    options = spec.options
    about = {key: getattr(spec, key) for key in ("quantity", "of", *OPTIONS) if key in options}
    return json.dumps({"quantity": spec.quantity, **about}, sort_keys=True, default=str)


@lru_cache(maxsize=8)
def _scenario(text: str) -> Scenario:
    return Scenario.model_validate_json(text)


@lru_cache(maxsize=2)
def _reference(text: str) -> Trajectory:
    return uninterrupted(simulate(_scenario(text)))


def evaluate_points(work: EvaluationWork, points: Sequence[EvaluatedPoint]) -> list[dict[str, Any]]:
    """Return the entries of points, as JSON types."""
    with warnings.catch_warnings():
        warnings.simplefilter(
            "ignore"
        )  # the ledger's state is in the facts; the nominal run has told all else
        return [_evaluated(work, point) for point in points]


def _evaluated(work: EvaluationWork, point: EvaluatedPoint) -> dict[str, Any]:
    began = time.perf_counter()
    entry: dict[str, Any] = {
        "point": point.key, "overrides": point.overrides,
        "values": {}, "units": {}, "errors": {}, "facts": {},
    }  # fmt: skip
    try:
        base = _scenario(work.base)
        scenario = base.with_overrides(point.overrides) if point.overrides else base
    except AntennaPinError as error:
        entry["values"] = dict.fromkeys(point.asked, math.nan)
        entry["errors"] = dict.fromkeys(point.asked, str(error))
        return entry
    case = Case(
        scenario,
        lambda: uninterrupted(simulate(scenario)),
        lambda: _reference(work.reference) if work.reference else None,
        work.sources,
    )
    for key in point.asked:
        spec = work.specs[key]
        try:
            quantity = quantity_of(spec, spec.quantity)
            found: Any = quantity.find(case, spec)
            value, units = found if isinstance(found, tuple) else (found, quantity.units)
            entry["values"][key], entry["units"][key] = float(value), units
            if not math.isfinite(float(value)):
                entry["errors"][key] = _reason(case)
        except AntennaPinError as error:
            entry["values"][key], entry["errors"][key] = math.nan, str(error)
        except Exception as error:  # of a user's function, or a bug: neither ends the verification
            said = " ".join(f"{type(error).__name__}: {error}".split())
            entry["values"][key], entry["errors"][key] = math.nan, said
    if case.has_run:
        entry["facts"] = _facts(case.run)
    entry["facts"]["wall_time"] = time.perf_counter() - began
    return entry


def _reason(case: Case) -> str:
    if case.has_run and not case.run.completed:
        return f"the run {case.run.outcome.verdict}: {case.run.message}"
    return "has no number: what it is of has not come about, or nothing bounds it"


def _facts(run: Trajectory) -> dict[str, Any]:
    books = json.loads(run.data.attrs["conservation"])
    names = (
        "energy_error", "energy_tolerance", "energy_error_relative", "linear_momentum_drift",
        "linear_momentum_tolerance", "angular_momentum_drift", "angular_momentum_tolerance",
    )  # fmt: skip
    return {
        "outcome": run.outcome.name,
        "message": " ".join(run.message.split()),
        "end_time": float(run.data.attrs["end_time"]),
        "steps": run.counts.accepted,
    } | {name: books[name] for name in names if books.get(name) is not None}


class PointEvaluator(AbstractContextManager["PointEvaluator"]):
    """Evaluation of points, with a journal of those that are done.

    Args:
        plan: The verification.
        folder: Folder of the output, which exists; the journal is in a folder of its own within.
        executor: Executor of the points; this process by default.
        progress: Called with a stage, points done and their number.
    """

    def __init__(
        self,
        plan: Verification,
        folder: Path,
        executor: Executor | None = None,
        progress: Callable[[str, int, int], None] | None = None,
    ) -> None:
        """Open or begin the journal."""
        self.plan, self._by = plan, executor or Here()
        self._progress = progress or (lambda stage, done, count: None)
        specs = {key_of(spec): spec for spec in plan.requirements.values()}
        reference = "" if plan.reference is None else plan.reference.model_dump_json()
        self._work = EvaluationWork(plan.base.model_dump_json(), reference, specs, dict(plan.sources))
        about = {
            "scenario": _digest(self._work.base),
            "reference": _digest(reference),
            "functions": _digest(json.dumps(self._work.sources, sort_keys=True)),
            "versions": library_versions() | {"code": code_digest()},
        }
        #: Identity of scenario, functions and versions, which all numbers are of.
        self.digest = _digest(json.dumps(about, sort_keys=True))[:12]
        points = folder / "points"
        points.mkdir(exist_ok=True)
        #: Folder of the journal.
        self.store = points / self.digest
        self._entries, self._journal = open_journal(self.store, about, "verification")
        self._known: dict[str, Evaluated] = {}
        for number in sorted(self._entries):
            self._learn(self._entries[number])
        self._count = max(self._entries, default=-1) + 1
        self._started = False
        #: Number of evaluated points, of this command and of all.
        self.made = 0

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the journal."""
        self._journal.close()

    @property
    def count(self) -> int:
        """Number of points in the journal."""
        return len(self._known)

    @property
    def simulated(self) -> int:
        """Number of points with a run."""
        return sum("outcome" in one.facts for one in self._known.values())

    def _learn(self, entry: Mapping[str, Any]) -> None:
        old = self._known.get(entry["point"])
        parts = [old] if old is not None else []
        self._known[entry["point"]] = Evaluated(
            dict(entry["overrides"]),
            {**(parts[0].values if parts else {}), **entry["values"]},
            {**(parts[0].units if parts else {}), **entry["units"]},
            {**(parts[0].errors if parts else {}), **entry["errors"]},
            {**(parts[0].facts if parts else {}), **entry["facts"]},
        )

    def at(
        self, points: Sequence[Mapping[str, Any]], requirements: Sequence[str], stage: str = ""
    ) -> list[Evaluated]:
        """Return the numbers of requirements at points; what the journal lacks is evaluated.

        Args:
            points: Values of uncertain numbers, as they are set, by name.
            requirements: Names of the requirements.
            stage: Name of the stage, for progress.
        """
        keys = [key_of(self.plan.requirements[name]) for name in requirements]
        asked: dict[str, EvaluatedPoint] = {}
        wanted: list[str] = []
        for values in points:
            overrides = self.plan.overrides(values)
            key = json.dumps(overrides, sort_keys=True, default=str)
            wanted.append(key)
            known = self._known.get(key)
            missing = tuple(dict.fromkeys(one for one in keys if known is None or one not in known.values))
            if missing and key not in asked:
                asked[key] = EvaluatedPoint(key, overrides, missing)
        if asked:
            self._evaluate(list(asked.values()), stage)
        return [self._known[key] for key in wanted]

    def _evaluate(self, points: list[EvaluatedPoint], stage: str) -> None:
        if not self._started:
            self._by.start()
            self._started = True
        self._progress(stage, 0, len(points))
        done = 0
        for batch, answer in self._by.each(evaluate_points, self._work, ([point] for point in points)):
            if isinstance(answer, Lost):
                answer = [_lost(point, str(answer)) for point in batch]
            for entry in answer:
                if entry["facts"].get("outcome") == "INTERRUPTED":
                    raise KeyboardInterrupt
                if entry["facts"].get("outcome") != LOST:
                    self._journal.add({"run": self._count, **entry})
                    self._count += 1
                self._learn(entry)
                done += 1
                self.made += 1
            self._progress(stage, done, len(points))


def _lost(point: EvaluatedPoint, reason: str) -> dict[str, Any]:
    return {
        "point": point.key, "overrides": point.overrides, "units": {},
        "values": dict.fromkeys(point.asked, math.nan),
        "errors": dict.fromkeys(point.asked, reason),
        "facts": {"outcome": LOST, "message": reason},
    }  # fmt: skip


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
