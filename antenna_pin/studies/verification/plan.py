"""Verification file: requirements and uncertain numbers, of a scenario or beside one."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from antenna_pin.analysis import own_source
from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import readable
from antenna_pin.base.units import QuantityError, any_quantity, quantity, shown, with_signs
from antenna_pin.errors import AntennaPinError, ScenarioError, UnknownNameError
from antenna_pin.scenario import Scenario, list_scenarios, load_scenario
from antenna_pin.scenario.numbers import number_of
from antenna_pin.scenario.parameters import ParameterSpec
from antenna_pin.scenario.requirements import RequirementSpec, check_requirements
from antenna_pin.scenario.runs_file import RunsFile, nested
from antenna_pin.scenario.shipped import models_path, read_toml
from antenna_pin.scenario.spec import Count, Folder, Spec
from antenna_pin.studies.sweep.design import put_value
from antenna_pin.studies.verification.quantities import quantity_of
from antenna_pin.studies.verification.quantity import VerifiedQuantity

# Share of a distribution without ends that counts as within its limits: three standard deviations.
_WITHIN = 0.9973002039367398
# Significant digits of a value inside its limits, and of a limit.
_DIGITS, _EXACT = 9, 14


class ScenarioReference(Spec):
    """Reference of comparisons, mostly the mechanism with ideal joints.

    Attributes:
        case: Case of the scenario.
        set: Overrides instead of the file's ``set``.
    """

    case: str | None = None
    set: dict[str, Any] = Field(default_factory=dict)


class RequirementsFile(RunsFile):
    """Requirements on a scenario, in a file of their own.

    Attributes:
        seed: Seed of searches and samples [-].
        uncertain: Uncertain numbers of the scenario, by name.
        requirements: Requirements, by name.
        reference: Reference of compared quantities.
        name: Name of the verification: that of its file.
        folder: Folder of the file.
    """

    suffix: ClassVar[str] = ".requirements.toml"
    word: ClassVar[str] = "requirements"

    seed: Annotated[int, BeforeValidator(Count(0, 2**62).read)] = 0
    uncertain: dict[str, ParameterSpec] = Field(default_factory=dict)
    requirements: dict[str, RequirementSpec]
    reference: ScenarioReference | None = None
    name: str = "requirements"
    folder: Folder = Path()

    @model_validator(mode="after")
    def _check_together(self) -> Self:
        check_requirements(self.requirements, self.uncertain)
        return self


@dataclass(frozen=True, slots=True)
class UncertainNumber:
    """Uncertain number of a scenario.

    Attributes:
        name: Its name.
        keys: Keys of the scenario that get its value.
        nominal: Value in the scenario; NaN for no number [SI].
        unit: SI unit, "1" if none.
        low: Lower limit; NaN for a list of names [SI].
        high: Upper limit [SI].
        levels: Values at limits, or those of a list, as they are set.
        texts: The same as text.
        spec: Its table.
        set_unit: SI unit of values that are set; "" for none.
        note: Note on its limits, or "".
    """

    name: str
    keys: tuple[str, ...]
    nominal: float
    unit: str
    low: float
    high: float
    levels: tuple[Any, ...]
    texts: tuple[str, ...]
    spec: ParameterSpec
    set_unit: str = ""
    note: str = ""

    @property
    def listed(self) -> bool:
        """True for a list of values, which has nothing between them."""
        return self.spec.values is not None

    def at(self, share: float) -> Any:
        """Return the value at a share of the range, as it is set."""
        if self.listed:
            return self.levels[round(share * (len(self.levels) - 1))]
        if share in (0.0, 1.0):
            return self.levels[int(share)]
        if self.spec.spacing == "log":
            return self._set(float(self.low ** (1.0 - share) * self.high**share))
        return self._set(self.low + share * (self.high - self.low))

    def drawn(self, probability: float) -> Any:
        """Return the value at a cumulative probability, as it is set."""
        return self._set(self.spec.drawn([probability]).values[0].number)

    def _set(self, number: float) -> Any:
        # As many digits as anybody reads; limits stay what they are.
        number = min(max(float(f"{number:.{_DIGITS}g}"), self.low), self.high)
        return f"{number!r} {self.set_unit}" if self.set_unit not in ("", "1") else number


@dataclass(frozen=True, slots=True)
class Verification:
    """Verification ready to be run.

    Attributes:
        name: Its name.
        title: In a few words.
        label: Name or path that it was loaded by.
        base: The scenario, without requirements.
        reference: Scenario of the reference, or None.
        uncertain: Uncertain numbers, by name.
        requirements: Requirements, by name.
        quantities: Their quantities, by name of the requirement.
        bounds: Lower and upper bound of each in SI units; infinite for none.
        sources: Texts of the files of functions, by function.
        seed: Seed of searches and samples [-].
    """

    name: str
    title: str
    label: str
    base: Scenario
    reference: Scenario | None
    uncertain: dict[str, UncertainNumber]
    requirements: dict[str, RequirementSpec]
    quantities: dict[str, VerifiedQuantity]
    bounds: dict[str, tuple[float, float]]
    sources: dict[str, str] = field(default_factory=dict)
    seed: int = 0

    def varies(self, requirement: str) -> list[UncertainNumber]:
        """Return the uncertain numbers that vary for a requirement."""
        names = self.requirements[requirement].varies or tuple(self.uncertain)
        return [self.uncertain[name] for name in names]

    def overrides(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Return the overrides of the scenario for values of uncertain numbers, by name."""
        found: dict[str, Any] = {}
        for name, value in values.items():
            for key in self.uncertain[name].keys:
                put_value(found, key, value, self.base)
        return found


@takes()
def list_verifications() -> list[str]:
    """Return the names of the shipped requirements files, as ``gimbal/pointing``."""
    return RequirementsFile.shipped()


@takes()
def load_verification(
    path: str | os.PathLike[str], settings: Mapping[str, Any] | Sequence[str] = ()
) -> Verification:
    """Return the verification of a file, complete and checked.

    Args:
        path: Requirements file, or scenario file with requirements, or the name of a shipped one.
        settings: Overrides of the file's keys: ``["set.duration=0.5 s"]``, of a scenario its own.

    Raises:
        ScenarioError: With one line that gives file, place, rule, value and a way out.
        UnknownNameError: No such file or quantity exists.
    """
    label = os.fspath(path)
    if _is_scenario(Path(os.path.expanduser(label)), label):
        whole = load_scenario(label, None, settings)
        if not whole.requirements:
            raise ScenarioError(
                f"{label}: must have requirements, tables [requirements.NAME] with a quantity and a bound, "
                f"got none; shipped: {', '.join(list_verifications()) or 'none'}"
            )
        name, title, seed, reference = whole.name, whole.title, 0, None
        uncertain, requirements, folder = whole.uncertain, whole.requirements, whole.folder
    else:
        file = RequirementsFile.loaded("load_verification", path, settings)
        if not file.requirements:
            raise ScenarioError(f"{label}: requirements must hold one at least, got none")
        whole = file.base()
        name, title, seed = file.name, file.title or whole.title, file.seed
        uncertain, requirements, folder = file.uncertain, file.requirements, file.folder
        reference = None
        if file.reference is not None:
            reference = file.scenario_with(file.reference.case, nested(file.reference.set))
    base = whole.model_copy(update={"requirements": {}, "uncertain": {}})
    quantities = {
        key: quantity_of(spec, f"{label}: requirements.{key}") for key, spec in requirements.items()
    }
    bounds = {
        key: _bounds(spec, quantities[key], f"{label}: requirements.{key}")
        for key, spec in requirements.items()
    }
    for key, one in quantities.items():
        if one.compares and reference is None:
            rule = "its reference, a table [reference] with the case to compare with, in a file of its own"
            raise ScenarioError(f"{label}: requirements.{key}: {one.name} must have {rule}")
        if one.needs_series and base.output.form == "lean":
            rule = f'{one.name} must have the series of a run, got output.form = "lean"; set it to "full"'
            raise ScenarioError(f"{label}: requirements.{key}: {rule}")
    numbers = {key: _number(key, one, base, f"{label}: uncertain.{key}") for key, one in uncertain.items()}
    own = [spec.quantity for spec in requirements.values() if ":" in spec.quantity]
    sources = {one: own_source(one, folder, f"{label}: {one}") for one in own}
    found = Verification(
        name, title, label, base, reference, numbers, dict(requirements), quantities, bounds, sources, seed
    )
    _check_limits(found)
    return found


def _is_scenario(path: Path, label: str) -> bool:
    if path.is_file():
        return "mechanism" in read_toml(path, label)
    if path.is_dir():
        return True
    shipped = (models_path() / f"{label}{RequirementsFile.suffix}").is_file()
    return not shipped and label in {one.name for one in list_scenarios()}


def unit_of(units: str) -> str:
    """Return a unit of the catalogue for the reader of quantities: ``N*m``."""
    return with_signs(units.replace("^", "**")) if units else units


def _bounds(spec: RequirementSpec, quantity_: VerifiedQuantity, place: str) -> tuple[float, float]:
    """Return lower and upper bound in SI units."""
    found = []
    for key, value in (("at_least", spec.at_least), ("at_most", spec.at_most)):
        if value is None:
            found.append(-np.inf if key == "at_least" else np.inf)
        elif quantity_.units:
            try:
                found.append(quantity(value, unit_of(quantity_.units), ""))
            except QuantityError as error:
                raise ScenarioError(f"{place}.{key} {error.reason}") from None
        else:
            read = any_quantity(value)
            assert read is not None
            found.append(read[0])
    low, high = found
    if not low <= high:
        raise ScenarioError(
            f"{place}.at_least must not be above at_most, {shown(spec.at_most)}, got {shown(spec.at_least)}"
        )
    return float(low), float(high)


def _number(name: str, spec: ParameterSpec, base: Scenario, place: str) -> UncertainNumber:
    nominal, unit, note = np.nan, "", ""
    first = spec.keys_set[0]
    if spec.values is not None:
        settings = spec.settings()
        levels = tuple(one.set for one in settings.values)
        texts = tuple(one.text for one in settings.values)
        numbers = [one.number for one in settings.values]
        low, high = (min(numbers), max(numbers)) if np.isfinite(numbers).all() else (np.nan, np.nan)
        if len(levels) < 2:
            raise ScenarioError(f"{place}.values must hold two values at least, got {len(levels)}")
        return UncertainNumber(name, spec.keys_set, nominal, settings.unit, low, high, levels, texts, spec)
    known = number_of(base, first, f"{place}.key")
    distribution, own = spec.frozen()
    nominal, unit = known.value, known.unit or own
    low, high = (float(one) for one in distribution.support())
    if not np.isfinite([low, high]).all():
        tail = 0.5 * (1.0 - _WITHIN)
        low, high = float(distribution.ppf(tail)), float(distribution.ppf(1.0 - tail))
        note = f"limits that hold {100.0 * _WITHIN:.2f} % of the distribution"
    # Sums of decimals, so without the last digit of their doubles: 0.5 - 0.05 is 0.45.
    low, high = (float(f"{one:.{_EXACT}g}") for one in (low, high))
    # In the key's own unit: both are SI's.
    own = (known.unit or own) if own not in ("", "1") else ""
    suffix = f" {own}" if own else ""
    levels = tuple(f"{one!r}{suffix}" if suffix else one for one in (low, high))
    texts = tuple(readable(one, unit or "1") for one in (low, high))
    return UncertainNumber(name, spec.keys_set, nominal, unit, low, high, levels, texts, spec, own, note)


def _check_limits(plan: Verification) -> None:
    """Refuse limits that the scenario's key does not take."""
    for name, one in plan.uncertain.items():
        for level, text in zip(one.levels, one.texts, strict=True):
            try:
                plan.base.with_overrides(plan.overrides({name: level}))
            except (ScenarioError, UnknownNameError, AntennaPinError) as error:
                raise ScenarioError(f"{plan.label}: uncertain.{name} at {text}: {error}") from None
