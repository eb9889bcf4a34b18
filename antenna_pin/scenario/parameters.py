"""Parameters of a study: lists, ranges, distributions, tolerances over keys of a scenario."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BeforeValidator, Field, model_validator

from antenna_pin.base.units import any_quantity, shown
from antenna_pin.scenario.merge import toml_value
from antenna_pin.scenario.spec import Count, QuantityRule, Spec, refuse, refuse_name

Array = NDArray[np.float64]


class Value(NamedTuple):
    """Value of a parameter."""

    set: Any  # in the scenario, as in a file
    number: float  # in SI units; NaN for no quantity
    text: str  # as a person would write it


class Settings(NamedTuple):
    """Values of a parameter, and the SI unit of their texts, or ""."""

    values: tuple[Value, ...]
    unit: str


class KeysSpec(Spec):
    """Table with keys of a scenario that get one value.

    Attributes:
        key: Key of the scenario, or several keys.
    """

    key: str | tuple[str, ...]

    @property
    def keys_set(self) -> tuple[str, ...]:
        """Keys of the scenario that are set."""
        return (self.key,) if isinstance(self.key, str) else self.key


def _quantity(value: object) -> object:
    if any_quantity(value) is None:
        refuse(f"must be a number, or text with a unit, got {shown(value)}", value=value)
    return value


def _keys(value: object) -> object:
    several = value if isinstance(value, list | tuple) else [value]
    for one in several:
        if not isinstance(one, str):
            refuse(f"must be a key of the scenario, or an array of keys, got {shown(one)}", value=one)
    return value


#: A number or text with a unit, of any dimension: the scenario's key checks it.
AnyQuantity = Annotated[Any, BeforeValidator(_quantity)]

#: The same, or None for none; a copied table holds its defaults.
OptionalQuantity = Annotated[Any, BeforeValidator(lambda value: None if value is None else _quantity(value))]

Spacing = Literal["linear", "log"]


class ToleranceSpec(Spec):
    """Dimension as in a drawing; parts outside its limits are rejected at inspection.

    Attributes:
        nominal: Nominal dimension.
        plus: Upper deviation; it may be negative, as the zone may lie below the nominal.
        minus: Lower deviation with its sign, so mostly negative or zero.
        distribution: Distribution between the limits: ``normal`` about the zone's middle, cut off at its
            ends; ``uniform``; ``triangular``.
        sigmas: Standard deviations of ``normal`` from the middle to a limit [-].
    """

    nominal: AnyQuantity
    plus: AnyQuantity
    minus: AnyQuantity
    distribution: Literal["normal", "uniform", "triangular"] = "normal"
    sigmas: Annotated[float, QuantityRule("1", "positive")] = 3.0

    @model_validator(mode="after")
    def _check_zone(self) -> Self:
        numbers, _ = numbers_of({"nominal": self.nominal, "plus": self.plus, "minus": self.minus})
        if not numbers["plus"] > numbers["minus"]:
            rule = f"must be above minus, {shown(self.minus)}, got {shown(self.plus)}"
            refuse(rule, "plus")
        return self


class ParameterSpec(KeysSpec):
    """Parameter of a study: exactly one of values, start, between, distribution, tolerance.

    Attributes:
        key: Key of the scenario with dots, as in ``--set``; ``mechanism.gravity[2]`` for one number of an
            array; several keys get the same value.
        values: List of values.
        start: First value of a range.
        stop: Last value of the range.
        count: Number of values of the range, both ends included [-].
        spacing: Spacing of the range or of ``between``: ``linear`` or ``log``.
        between: Two limits of evenly distributed samples.
        distribution: Distribution of scipy.stats by ``name``, with its own parameters (``loc``, ``scale`` and
            shapes).
        tolerance: Dimension with its deviations.
        zip: Name of a group of parameters that go through their values together.
        title: Title in figures; the name by default.
    """

    key: Annotated[str | tuple[str, ...], BeforeValidator(_keys)]
    values: tuple[Any, ...] | None = None
    start: OptionalQuantity = None
    stop: OptionalQuantity = None
    count: Annotated[int, BeforeValidator(Count(2, 1_000_000).read)] | None = None
    spacing: Spacing = "linear"
    between: tuple[AnyQuantity, AnyQuantity] | None = None
    distribution: dict[str, Any] | None = None
    tolerance: ToleranceSpec | None = None
    zip: str | None = None
    title: str = Field(default="")

    @property
    def sampled(self) -> bool:
        """True for a parameter whose values are samples."""
        return self.values is None and self.start is None

    @property
    def length(self) -> int:
        """Number of values; 0 for a sampled parameter."""
        return self.count or 0 if self.values is None else len(self.values)

    @model_validator(mode="after")
    def _check_choice(self) -> Self:
        ways = ("values", "start", "between", "distribution", "tolerance")
        given = [way for way in ways if getattr(self, way) is not None]
        if len(given) != 1:
            refuse(f"must have exactly one of {', '.join(ways)}, got {' and '.join(given) or 'none'}")
        if not self.keys_set:
            refuse("must name a key of the scenario, got none", "key")
        known: list[Any] = []
        for i, value in enumerate(self.values or ()):
            known.append(any_quantity(value) or value)  # 0.1 mm and 100 um are one value
            if known[-1] in known[:-1]:
                refuse(f"must be another value than those before it, got {shown(value)}", "values", i)
        if self.values == ():
            refuse("must hold a value at least, got an empty list", "values")
        if (self.start is None) != (self.stop is None) or (self.start is None) != (self.count is None):
            refuse("must have start, stop and count together")
        if self.zip is not None and self.sampled:
            refuse("must be left out: only values and ranges go together one by one", "zip")
        if self.start is not None:
            self._ends({"start": self.start, "stop": self.stop})
        elif self.between is not None:
            self._ends({"between[0]": self.between[0], "between[1]": self.between[1]})
        elif self.spacing != "linear":
            refuse("must be left out but for a range or between", "spacing")
        if self.distribution is not None:
            self.frozen()
        return self

    def _ends(self, ends: Mapping[str, Any]) -> tuple[float, float, str]:
        numbers, unit = numbers_of(ends)
        (low, first), (high, second) = zip(numbers.values(), ends.values(), strict=True)
        if not low < high:
            refuse(f"must be a range that rises, got {shown(first)} to {shown(second)}", list(ends)[0])
        if self.spacing == "log" and not low > 0.0:
            refuse(f'must be positive for spacing = "log", got {shown(first)}', list(ends)[0])
        return low, high, unit

    def settings(self) -> Settings:
        """Return the values of a list or range."""
        if self.values is not None:
            read = [any_quantity(value) for value in self.values]
            units = {one[1] for one in read if one is not None and one[1]}
            if None in read or len(units) > 1:  # names, tables, or things of different kinds
                texts = [v if isinstance(v, str) else toml_value(_plain(v)) for v in self.values]
                return Settings(
                    tuple(Value(v, math.nan, t) for v, t in zip(self.values, texts, strict=True)), ""
                )
            numbers = [one[0] for one in read if one is not None]
            made = [Value(v, n, str(v)) for v, n in zip(self.values, numbers, strict=True)]
            return Settings(tuple(made), units.pop() if units else "")
        low, high, unit = self._ends({"start": self.start, "stop": self.stop})
        assert self.count is not None
        space = np.geomspace if self.spacing == "log" else np.linspace
        return self._of(space(low, high, self.count), unit)

    def drawn(self, probability: ArrayLike) -> Settings:
        """Return the values at cumulative probabilities of the distribution, (n,) [-]."""
        distribution, unit = self.frozen()
        return self._of(np.asarray(distribution.ppf(np.asarray(probability, dtype=float)), dtype=float), unit)

    def _of(self, numbers: Array, unit: str) -> Settings:
        # With its unit, so that the scenario's key checks what it is.
        suffix = f" {unit}" if unit not in ("", "1") else ""
        made = [
            Value(f"{number!r}{suffix}" if suffix else number, number, f"{number:.6g}{suffix}")
            for number in numbers.tolist()
        ]
        return Settings(tuple(made), unit)

    def frozen(self) -> tuple[Any, str]:
        """Return the distribution in SI units, frozen as in scipy.stats, and the unit."""
        from scipy import stats

        if self.between is not None:
            low, high, unit = self._ends({"between[0]": self.between[0], "between[1]": self.between[1]})
            if self.spacing == "log":
                return stats.loguniform(low, high), unit
            return stats.uniform(low, high - low), unit
        if self.tolerance is not None:
            return _tolerance(self.tolerance)
        assert self.distribution is not None
        table = dict(self.distribution)
        name = table.pop("name", None)
        known = [
            one
            for one in dir(stats)
            if isinstance(getattr(stats, one), stats.rv_continuous | stats.rv_discrete)
        ]
        if not isinstance(name, str):
            refuse("is missing; give the name of one of scipy.stats, as norm", "distribution", "name")
        if name not in known:
            refuse_name("distribution of scipy.stats", name, known, "distribution", "name")
        numbers, unit = numbers_of(table, "distribution", pure=_shapes(getattr(stats, name)))
        if not numbers.get("scale", 1.0) > 0.0:
            refuse(f"must be positive, got {shown(table['scale'])}", "distribution", "scale")
        try:
            distribution = getattr(stats, name)(**numbers)
            middle = float(distribution.ppf(0.5))
        except (TypeError, ValueError) as error:
            takes = ", ".join([*_shapes(getattr(stats, name)), "loc", "scale"])
            refuse(f"must be of parameters that {name} takes ({takes}), got: {error}", "distribution")
        if not math.isfinite(middle):
            got = ", ".join(f"{key} = {shown(value)}" for key, value in table.items())
            refuse(f"must be of parameters that {name} allows, got {got}", "distribution")
        return distribution, unit


def _shapes(distribution: Any) -> tuple[str, ...]:
    return tuple(part.strip() for part in (distribution.shapes or "").split(",") if part.strip())


def _tolerance(spec: ToleranceSpec) -> tuple[Any, str]:
    from scipy import stats

    numbers, unit = numbers_of({"nominal": spec.nominal, "plus": spec.plus, "minus": spec.minus})
    low, high = (numbers["nominal"] + numbers[end] for end in ("minus", "plus"))
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    if spec.distribution == "normal":
        return stats.truncnorm(-spec.sigmas, spec.sigmas, loc=middle, scale=half / spec.sigmas), unit
    if spec.distribution == "triangular":
        return stats.triang(0.5, loc=low, scale=2.0 * half), unit
    return stats.uniform(low, 2.0 * half), unit


def numbers_of(
    table: Mapping[str, Any], *place: str, pure: tuple[str, ...] = ()
) -> tuple[dict[str, float], str]:
    """Return quantities of one kind in SI units, by name, and their common unit."""
    numbers, units = {}, {}
    for name, value in table.items():
        found = any_quantity(value)
        if found is None:
            refuse(f"must be a number, or text with a unit, got {shown(value)}", *place, name, value=value)
        numbers[name], unit = found
        if name in pure and unit not in ("", "1"):
            refuse(f"must be a pure number, got {shown(value)}", *place, name, value=value)
        if unit and name not in pure:
            units[name] = unit
    if len(set(units.values())) > 1:
        (first, unit), (second, other) = (
            list(units.items())[0],
            next(item for item in units.items() if item[1] != list(units.values())[0]),
        )
        refuse(f"must be of the unit of {first} [{unit}], got one in [{other}]", *place, second)
    unit = next(iter(units.values()), "")
    for name in table:
        if unit not in ("", "1") and name not in pure and name not in units and numbers[name] != 0.0:
            refuse(f"must have a unit as {next(iter(units))} has, got {shown(table[name])}", *place, name)
    return numbers, unit


def _plain(value: Any) -> Any:
    return [_plain(entry) for entry in value] if isinstance(value, tuple) else value
