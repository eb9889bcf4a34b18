"""Verification of requirements: nominal run, corners, searches, probabilities, sensitivities."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.errors import OutputError, ScenarioError
from antenna_pin.scenario.requirements import RequirementSpec
from antenna_pin.studies.sweep.box_search import corners_of, worst_case
from antenna_pin.studies.sweep.executor import Executor
from antenna_pin.studies.verification.evaluation import Evaluated, PointEvaluator, key_of
from antenna_pin.studies.verification.plan import UncertainNumber, Verification
from antenna_pin.studies.verification.reliability import (
    FailureProbability,
    importance_sampling,
    plain_sampling,
    subset_simulation,
)

Array = NDArray[np.float64]

#: Verdicts of a requirement: shown to be met, shown to fall short, and neither.
MET, NOT_MET, NOT_SHOWN = "met", "falls short", "not shown"

# Runs of a search and of a study where none are given.
_SEARCH_PER_NUMBER, _STUDY, _SUBSET, _IMPORTANCE = 30, 300, 500, 500
# Distance to a bound that stands for none.
_LEAST = 1e-300


@dataclass(frozen=True, slots=True, kw_only=True)
class Demonstration:
    """Requirement with the numbers that show it.

    Attributes:
        name: Name of the requirement.
        verdict: ``met``, ``falls short`` or ``not shown``.
        method: Method, in words.
        units: Unit of the numbers, "1" if none.
        low: Lower bound; -infinity for none.
        high: Upper bound; infinity for none.
        nominal: Value of the nominal run.
        result: Worst value that was found; of a probability the nominal one.
        margin: Distance of the result to the nearer bound, negative beyond it; of a probability that of the
            failure probability's upper end to the allowed one [-].
        worst: Values of the uncertain numbers there, as they are set, by name; {} for the nominal run.
        overrides: Overrides of the scenario there.
        runs: Number of points that were evaluated for it.
        inside: True if the worst point lies inside all corners.
        probability: Failure probability, for a study.
        facts: Outcome and ledger of the run that is the worst; {} without a run.
        message: Reason for a missing number, or "".
    """

    name: str
    verdict: str
    method: str
    units: str
    low: float
    high: float
    nominal: float
    result: float
    margin: float
    worst: dict[str, Any] = field(default_factory=dict)
    overrides: dict[str, Any] = field(default_factory=dict)
    runs: int = 1
    inside: bool = False
    probability: FailureProbability | None = None
    facts: dict[str, Any] = field(default_factory=dict)
    message: str = ""


@dataclass(frozen=True, slots=True)
class Effect:
    """Effect of one uncertain number on a requirement, all others nominal.

    Attributes:
        requirement: Name of the requirement.
        number: Name of the uncertain number.
        nominal: Value of the quantity in the nominal run.
        low: Value at the lower limit.
        high: Value at the upper limit.
    """

    requirement: str
    number: str
    nominal: float
    low: float
    high: float

    @property
    def change(self) -> float:
        """Largest deviation from the nominal value, with its sign."""
        ends = [one - self.nominal for one in (self.low, self.high)]
        known = [one for one in ends if math.isfinite(one)]
        return max(known, key=abs) if known else math.nan


@dataclass(frozen=True, slots=True, kw_only=True)
class Verified:
    """Result of a verification.

    Attributes:
        plan: The verification.
        demonstrations: Requirements with the numbers that show them, by name.
        effects: Effects of the uncertain numbers one at a time.
        digest: Identity of scenario, functions and versions.
        store: Folder of the journal of all points.
        points: Number of points in the journal.
        made: Number of points evaluated by this call.
        nominal: Numbers of the nominal point.
    """

    plan: Verification
    demonstrations: dict[str, Demonstration]
    effects: tuple[Effect, ...]
    digest: str
    store: Path
    points: int
    made: int
    nominal: Evaluated

    @property
    def met(self) -> bool:
        """Verdict on all requirements together."""
        return all(one.verdict == MET for one in self.demonstrations.values())


@takes()
def verify(
    plan: Verification,
    folder: Path | str,
    *,
    executor: Executor | None = None,
    progress: Callable[[str, int, int], None] | None = None,
) -> Verified:
    """Return the requirements of a verification with the numbers that show them.

    Points of the uncertain numbers are evaluated once and kept in the folder; an interrupted call continues
    there, and bounds may change without another run.

    Args:
        plan: The verification.
        folder: Folder of the output, made if missing.
        executor: Executor of the points; this process by default.
        progress: Called with the stage, points done and their number.

    Raises:
        OutputError: The folder cannot be written, or is in use.
        ScenarioError: A quantity does not exist for the nominal run.
    """
    target = Path(folder)
    try:
        target.mkdir(parents=True, exist_ok=True)
        evaluator = PointEvaluator(plan, target, executor, progress)
    except FileExistsError:
        raise OutputError(f"{target}: must be a folder, got a file; name another with --output") from None
    except OSError as error:
        if isinstance(error, OutputError):
            raise
        raise OutputError(f"{target}: cannot be written: {error.strerror or error}") from None
    with evaluator:
        shown = _Demonstrator(plan, evaluator)
        demonstrations = {name: shown.demonstrate(name) for name in plan.requirements}
        effects = tuple(shown.effects())
        return Verified(
            plan=plan,
            demonstrations=demonstrations,
            effects=effects,
            digest=evaluator.digest,
            store=evaluator.store,
            points=evaluator.count,
            made=evaluator.made,
            nominal=shown.nominal,
        )


class _Demonstrator:
    """Demonstration of the requirements of one verification."""

    def __init__(self, plan: Verification, evaluator: PointEvaluator) -> None:
        self.plan, self._evaluator = plan, evaluator
        self.nominal = self._nominal()

    def _nominal(self) -> Evaluated:
        """Return the nominal point; refuse a quantity that does not exist there."""
        plan = self.plan
        (nominal,) = self._evaluator.at([{}], list(plan.requirements), "nominal run")
        for name, spec in plan.requirements.items():
            error = nominal.errors.get(key_of(spec))
            asked = "is unknown" in (error or "") or " must be " in (error or "")
            if error is not None and asked:
                raise ScenarioError(f"{plan.label}: requirements.{name}: {error}")
        return nominal

    # --- one requirement ---

    def demonstrate(self, name: str) -> Demonstration:
        """Return a requirement with the numbers that show it."""
        spec = self.plan.requirements[name]
        if spec.over == "nominal":
            return self._worst_of(name, [({}, self.nominal)], "nominal run", 1)
        if spec.over == "study":
            return self._by_study(name, spec)
        return self._by_search(name, spec)

    def _value(self, name: str, at: Evaluated) -> float:
        return at.values.get(key_of(self.plan.requirements[name]), math.nan)

    def _margin(self, name: str, value: float) -> float:
        """Return the distance of a value to the nearer bound, negative beyond."""
        low, high = self.plan.bounds[name]
        return float(min(value - low, high - value)) if math.isfinite(value) else math.nan

    def _units(self, name: str) -> str:
        found = self.nominal.units.get(key_of(self.plan.requirements[name]), "")
        return found or self.plan.quantities[name].units or "1"

    def _worst_of(
        self,
        name: str,
        points: Sequence[tuple[Mapping[str, Any], Evaluated]],
        method: str,
        runs: int,
        inside: bool = False,
    ) -> Demonstration:
        """Return the demonstration by the worst of some points."""
        margins = [self._margin(name, self._value(name, at)) for _, at in points]
        missing = [k for k, margin in enumerate(margins) if math.isnan(margin)]
        k = missing[0] if missing else int(np.argmin(margins))
        values, at = points[k]
        message = at.errors.get(key_of(self.plan.requirements[name]), "")
        if missing and len(points) > 1:
            message = f"{len(missing)} of {len(points)} points have no number: {message}"
        margin = margins[k]
        verdict = NOT_SHOWN if missing else (MET if margin >= 0.0 else NOT_MET)
        facts = dict(at.facts) if self.plan.quantities[name].needs_run else {}
        if verdict == MET and facts.get("outcome", "COMPLETED") not in ("COMPLETED", "STOPPED"):
            verdict, message = NOT_SHOWN, f"the run is {facts['outcome']}: {facts.get('message', '')}"
        low, high = self.plan.bounds[name]
        return Demonstration(
            name=name, verdict=verdict, method=method, units=self._units(name), low=low, high=high,
            nominal=self._value(name, self.nominal), result=self._value(name, at), margin=margin,
            worst=dict(values), overrides=dict(at.overrides), runs=runs, inside=inside, facts=facts,
            message=message,
        )  # fmt: skip

    # --- corners, and a search ---

    def _corner_values(self, numbers: Sequence[UncertainNumber]) -> tuple[Array, list[dict[str, Any]]]:
        points = corners_of([len(one.levels) for one in numbers])
        return points, [self._values(numbers, point) for point in points]

    @staticmethod
    def _values(numbers: Sequence[UncertainNumber], point: Array) -> dict[str, Any]:
        return {one.name: one.at(float(x)) for one, x in zip(numbers, point, strict=True)}

    def _with_same_numbers(self, name: str, over: tuple[str, ...]) -> list[str]:
        """Return the requirements that vary the same numbers, which share their points."""
        mine = [one.name for one in self.plan.varies(name)]
        return [
            other
            for other, spec in self.plan.requirements.items()
            if spec.over in over and [one.name for one in self.plan.varies(other)] == mine
        ]

    def _by_search(self, name: str, spec: RequirementSpec) -> Demonstration:
        numbers = self.plan.varies(name)
        try:
            shares, corners = self._corner_values(numbers)
        except Exception as error:
            raise ScenarioError(f"{self.plan.label}: requirements.{name}: {error}") from None
        shared = self._with_same_numbers(name, ("corners", "worst-case"))
        at_corners = self._evaluator.at(corners, shared, f"{len(corners)} corners")
        points: list[tuple[Mapping[str, Any], Evaluated]] = [({}, self.nominal)]
        points += list(zip(corners, at_corners, strict=True))
        method = f"all {len(corners)} corners of {_counted(len(numbers))}"
        if spec.over == "corners":
            return self._worst_of(name, points, method, len(points))
        runs = spec.runs or _SEARCH_PER_NUMBER * len(numbers)

        def worse(batch: Array) -> Array:
            values = [self._values(numbers, point) for point in batch]
            found = self._evaluator.at(values, [name], f"{name}: search")
            points.extend(zip(values, found, strict=True))
            return np.array([-self._margin(name, self._value(name, one)) for one in found])

        if any(not one.listed for one in numbers):
            found = worst_case(worse, len(numbers), runs=runs, seed=self.plan.seed, corners=shares)
            inside = found.inside
            method += f", and a search of {found.runs - len(corners)} points inside"
        else:
            inside = False
        return self._worst_of(name, points, method, len(points), inside)

    # --- studies with a probability ---

    def _by_study(self, name: str, spec: RequirementSpec) -> Demonstration:
        numbers = self.plan.varies(name)
        units, facts = self._units(name), self.nominal.facts
        low, high = self.plan.bounds[name]
        unknown: list[str] = []
        beyond: list[tuple[float, dict[str, Any], Evaluated]] = []

        def limit(batch: Array) -> Array:
            from scipy.stats import norm

            shares = np.clip(norm.cdf(batch), 1e-16, 1.0 - 1e-16)
            values = [
                {one.name: one.drawn(float(x)) for one, x in zip(numbers, row, strict=True)} for row in shares
            ]
            shared = [name] if spec.method != "sampling" else self._same_samples(name, spec)
            found = self._evaluator.at(values, shared, f"{name}: samples")
            margins = []
            for each, at in zip(values, found, strict=True):
                margin = self._margin(name, self._value(name, at))
                if math.isnan(margin):
                    unknown.append(at.errors.get(key_of(spec), ""))
                margins.append(margin)
                beyond.append((margin, each, at))
            # A run without a number counts as a failure, as bad as any; a value at its bound is met.
            worst = min((one for one in margins if not math.isnan(one)), default=0.0)
            least = min(worst, -_LEAST)
            return np.array([least if math.isnan(one) else one or _LEAST for one in margins])

        runs, seed, confidence = spec.runs, self.plan.seed, spec.confidence
        assert spec.probability is not None
        count = len(numbers)
        if spec.method == "subset":
            found = subset_simulation(limit, count, samples=runs or _SUBSET, seed=seed, confidence=confidence)
        elif spec.method == "importance":
            found = importance_sampling(
                limit, count, samples=runs or _IMPORTANCE, seed=seed, confidence=confidence
            )
        else:
            found = plain_sampling(limit, count, runs=runs or _STUDY, seed=seed, confidence=confidence)
        allowed = round(1.0 - spec.probability, 12)
        verdict = MET if found.high <= allowed else NOT_MET if found.low > allowed else NOT_SHOWN
        message = (
            f"{len(unknown)} samples have no number and count as failures: {unknown[0]}" if unknown else ""
        )
        if verdict == NOT_SHOWN:
            message = message or f"the interval holds the allowed probability, {allowed:.3g}: take more runs"
        worst: tuple[float, dict[str, Any], Evaluated] = min(
            beyond, key=lambda one: -math.inf if math.isnan(one[0]) else one[0]
        )
        return Demonstration(
            name=name, verdict=verdict, method=f"{found.method} of {_counted(count)}", units=units, low=low,
            high=high, nominal=self._value(name, self.nominal), result=self._value(name, worst[2]),
            margin=allowed - found.high, worst=worst[1], overrides=dict(worst[2].overrides),
            runs=found.runs, probability=found, facts=dict(worst[2].facts) or facts, message=message,
        )  # fmt: skip

    def _same_samples(self, name: str, spec: RequirementSpec) -> list[str]:
        """Return the requirements whose plain samples are the same points."""
        return [
            other
            for other in self._with_same_numbers(name, ("study",))
            if self.plan.requirements[other].method == "sampling"
            and (self.plan.requirements[other].runs or _STUDY) == (spec.runs or _STUDY)
        ]

    # --- one at a time ---

    def effects(self) -> list[Effect]:
        """Return the effects of the uncertain numbers on all requirements, one number at a time."""
        found = []
        names = list(self.plan.requirements)
        ends = [
            (one, level) for one in self.plan.uncertain.values() for level in (one.levels[0], one.levels[-1])
        ]
        points = [{one.name: level} for one, level in ends]
        values = self._evaluator.at(points, names, "sensitivities") if points else []
        for (one, _), low, high in zip(ends[::2], values[::2], values[1::2], strict=True):
            for name in names:
                numbers = [self._value(name, at) for at in (self.nominal, low, high)]
                found.append(Effect(name, one.name, *numbers))
        return found


def _counted(count: int) -> str:
    return f"{count} uncertain number{'s' if count > 1 else ''}"
