"""Requirements on a mechanism: quantity, bound, and the runs that have to meet it."""

from __future__ import annotations

import re
from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, model_validator

from antenna_pin.base.units import any_quantity, shown
from antenna_pin.scenario.parameters import AnyQuantity, OptionalQuantity, ParameterSpec
from antenna_pin.scenario.spec import (
    Count,
    PositiveTime,
    QuantityRule,
    Spec,
    read_quantity,
    refuse,
    refuse_name,
)

# A name that a file of any system can have.
_FILE_NAME = re.compile(r"\w[\w-]{0,99}")


def _band(value: object) -> tuple[float, float]:
    if not isinstance(value, list | tuple) or len(value) != 2:
        refuse(f"must be an array of a lower and a higher frequency, got {shown(value)}", value=value)
    low, high = (read_quantity(one, "Hz", "zero or more", k) for k, one in enumerate(value))
    if not low < high:
        refuse(f"must rise, got {shown(value[0])} to {shown(value[1])}", value=value)
    return low, high


Probability = Annotated[float, QuantityRule("1", "between 0 and 1")]


class RequirementSpec(Spec):
    """Requirement: bound of a quantity over runs.

    Attributes:
        text: Requirement in words.
        clause: Clause of a standard or a specification, with its edition.
        quantity: Name of a quantity, or function of a run, ``FILE.py:NAME``.
        of: Object of the quantity: a joint, a contact, a drive, a signal; all by default, where that makes
            sense.
        at_most: Upper bound.
        at_least: Lower bound.
        units: Unit of a function's number.
        over: Runs that have to meet it: the ``nominal`` one; all ``corners`` of the uncertain numbers; the
            ``worst-case`` of corners and a search; a ``study`` with a probability.
        varies: Uncertain numbers that vary; all by default.
        probability: ``study``: least probability of meeting the bounds [-].
        confidence: ``study``: confidence level of the probability's interval [-].
        method: ``study``: plain ``sampling``; for rare failures ``subset`` simulation or ``importance``
            sampling.
        runs: Number of runs of a study (of a level of a subset simulation), or of the search.
        after: Start of the time that counts, of a signal.
        before: End of the time that counts, of a signal.
        band: Frequencies that count.
        quality: Q of the oscillators of a shock response spectrum [-].
        source: Source of a frequency response.
        number: Number of a mode, from 1 on.
        index: ``pointing``: index of ECSS-E-ST-60-10C.
        component: ``pointing``: ``half-cone``, ``boresight``, ``cross`` or ``up``.
        value: ``pointing``: the ``largest`` value, or the ``level``.
        window: ``pointing``: length of the windows.
        drift_spacing: ``pointing``: time between the windows of the PDE.
        period: ``pointing``: length of the observation periods.
        level: ``pointing``: confidence of the level [-].
        travel: Ends of the travel of a joint, as a motorization margin takes it.
        positions: Number of positions over the travel, or of a wheel's speeds.
        factors: Set of factors of a motorization margin.
        torque: Amplitude of a torque-angle loop.
        amplitude: Amplitude of the sine references of a loop measured in runs.
        operating_point: Mean of these references; the measurement at the start if left out.
        hold: Joints that do not move in a torque-angle loop, beside those that the scenario holds.
        speeds: Lowest and highest speed of a wheel.
        harmonic: Harmonic of a wheel's speed [-].
        axis: Axis of a wheel's disturbance: ``fx``, ``fy``, ``fz`` of the force, ``mx``, ``my``, ``mz`` of
            the moment.
    """

    text: str = ""
    clause: str = ""
    quantity: str
    of: str | None = None
    at_most: OptionalQuantity = None
    at_least: OptionalQuantity = None
    units: str = ""
    over: Literal["nominal", "corners", "worst-case", "study"] = "nominal"
    varies: tuple[str, ...] | None = None
    probability: Probability | None = None
    confidence: Probability = 0.95
    method: Literal["sampling", "subset", "importance"] = "sampling"
    runs: Annotated[int, BeforeValidator(Count(1, 1_000_000).read)] | None = None
    after: Annotated[float, QuantityRule("s", "zero or more")] | None = None
    before: PositiveTime | None = None
    band: Annotated[tuple[float, float], BeforeValidator(_band)] | None = None
    quality: Annotated[float, QuantityRule("1", "positive")] = 10.0
    source: str | None = None
    number: Annotated[int, BeforeValidator(Count(1, 10_000).read)] = 1
    index: Literal["APE", "MPE", "RPE", "PDE", "PRE"] = "APE"
    component: Literal["half-cone", "boresight", "cross", "up"] = "half-cone"
    value: Literal["largest", "level"] = "largest"
    window: PositiveTime | None = None
    drift_spacing: PositiveTime | None = None
    period: PositiveTime | None = None
    level: Probability = 0.997
    travel: tuple[AnyQuantity, AnyQuantity] | None = None
    positions: Annotated[int, BeforeValidator(Count(2, 100_000).read)] | None = None
    factors: str | None = None
    torque: OptionalQuantity = None
    amplitude: OptionalQuantity = None
    operating_point: OptionalQuantity = None
    hold: tuple[str, ...] = ()
    speeds: tuple[AnyQuantity, AnyQuantity] | None = None
    harmonic: Annotated[float, QuantityRule("1", "positive")] = 1.0
    axis: Literal["fx", "fy", "fz", "mx", "my", "mz"] | None = None

    @model_validator(mode="after")
    def _check_choice(self) -> Self:
        if self.at_most is None and self.at_least is None:
            refuse("must have a bound: at_most, at_least, or both; got none")
        if self.at_most is not None and self.at_least is not None:
            (high, upper), (low, lower) = _read(self.at_most), _read(self.at_least)
            if upper != lower and "" not in (upper, lower):
                refuse(f"must be of the unit of at_most [{upper}], got one in [{lower}]", "at_least")
            if not low <= high:
                rule = f"must not be above at_most, {shown(self.at_most)}"
                refuse(f"{rule}, got {shown(self.at_least)}", "at_least")
        options = self.options
        if self.over == "study" and self.probability is None:
            refuse("is missing: a study shows a probability", "probability")
        for key in ("probability", "confidence", "method"):
            if self.over != "study" and key in options:
                refuse(f'must be left out but for over = "study", got over = "{self.over}"', key)
        if self.over in ("nominal", "corners") and "runs" in options:
            refuse('must be left out but for over = "worst-case" or "study"', "runs")
        if self.over == "nominal" and "varies" in options:
            refuse('must be left out for over = "nominal", where nothing varies', "varies")
        if self.varies == ():
            refuse("must name an uncertain number, got none", "varies")
        if self.after is not None and self.before is not None and not self.after < self.before:
            refuse(f"must be above after, {self.after:g} s, got {self.before:g} s", "before")
        return self

    @property
    def options(self) -> set[str]:
        """Names of the keys with other than default values."""
        fields = type(self).model_fields
        return {name for name, field in fields.items() if getattr(self, name) != field.get_default()}


def _read(value: object) -> tuple[float, str]:
    found = any_quantity(value)
    assert found is not None  # by the field's own rule
    return found


#: Keys that some quantities have and others do not.
OPTIONS = (
    *("units", "after", "before", "band", "quality", "source", "number", "index", "component", "value"),
    *("window", "drift_spacing", "period", "level", "travel", "positions", "factors"),
    *("torque", "hold", "amplitude", "operating_point", "speeds", "harmonic", "axis"),
)


def check_requirements(requirements: dict[str, RequirementSpec], uncertain: dict[str, ParameterSpec]) -> None:
    """Refuse uncertain numbers without limits, and requirements that vary others, from inside a validator."""
    for name, one in uncertain.items():
        if one.start is not None or one.zip is not None:
            rule = "must have values, between, distribution or tolerance, got a range for a grid"
            refuse(rule, "uncertain", name, "start" if one.start is not None else "zip")
    for name, requirement in requirements.items():
        if not _FILE_NAME.fullmatch(name):
            rule = "must have a name of letters, digits, _ and -, as the file of its worst case has it"
            refuse(f"{rule}, got {shown(name)}", "requirements", name)
        for k, varied in enumerate(requirement.varies or ()):
            if varied not in uncertain:
                refuse_name("uncertain number", varied, uncertain, "requirements", name, "varies", k)
        if requirement.over != "nominal" and not uncertain:
            rule = "must have numbers that vary, tables [uncertain.NAME] with key and between, got none"
            refuse(rule, "requirements", name, "over")
        listed = [one for one in requirement.varies or uncertain if uncertain[one].values is not None]
        if requirement.over == "study" and listed:
            rule = f"must have a distribution for a study, got values; {name} may leave it out by `varies`"
            refuse(rule, "uncertain", listed[0], "values")
