"""Responses of a study: numbers of each run, by measures or users' functions."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import BeforeValidator, model_validator

from antenna_pin.analysis import own_number, own_source
from antenna_pin.scenario.spec import PositiveTime, QuantityRule, Spec, refuse, refuse_name
from antenna_pin.studies.sweep.measures import MEASURES

if TYPE_CHECKING:
    from antenna_pin.trajectory import Trajectory


class ResponseSpec(Spec):
    """Number of each run by a measure or a function; a text alone names either.

    Attributes:
        measure: Name of a measure.
        function: ``FILE.py:NAME``, from the study file's folder, or ``MODULE:NAME``; called with the run, a
            Trajectory, and with the run's seed for an argument ``seed``; returns a number.
        of: Object of the measure: a contact, a joint, a drive, a quantity as ``elevation angle``; all by
            default, where that makes sense.
        index: ``pointing``: index of ECSS-E-ST-60-10C.
        component: ``pointing``: ``half-cone``, ``boresight``, ``cross`` or ``up``.
        value: ``pointing``: the ``largest`` value, or the ``level`` of the confidence.
        window: ``pointing``: length of the windows.
        drift_spacing: ``pointing``: time between the windows of the PDE.
        period: ``pointing``: length of the observation periods.
        confidence: ``pointing``: confidence of the level [-].
        units: Unit of a function's number, or of a measure at a sliding joint.
        title: Title in figures; the name by default.
    """

    measure: str | None = None
    function: str | None = None
    of: str | None = None
    index: Literal["APE", "MPE", "RPE", "PDE", "PRE"] = "APE"
    component: Annotated[
        Literal["half-cone", "boresight", "cross", "up"],
        BeforeValidator(lambda name: name.replace("_", "-") if isinstance(name, str) else name),
    ] = "half-cone"
    value: Literal["largest", "level"] = "largest"
    window: PositiveTime | None = None
    drift_spacing: PositiveTime | None = None
    period: PositiveTime | None = None
    confidence: Annotated[float, QuantityRule("1", "above 0 and at most 1")] = 0.997
    units: str = ""
    title: str = ""

    @model_validator(mode="before")
    @classmethod
    def _read_text(cls, data: Any) -> Any:
        """Accept a text for a measure, or, with a colon, for a function."""
        if isinstance(data, str):
            return {"function" if ":" in data else "measure": data}
        if isinstance(data, Mapping) and ":" in str(data.get("measure", "")) and "function" not in data:
            return {"function" if key == "measure" else key: value for key, value in data.items()}
        return data

    @property
    def compares(self) -> bool:
        """True for a comparison with the study's reference."""
        return self.measure is not None and MEASURES[self.measure].compares

    @model_validator(mode="after")
    def _check_choice(self) -> Self:
        if (self.measure is None) == (self.function is None):
            refuse(f"must have either measure or function, got {'both' if self.measure else 'neither'}")
        given = self.model_fields_set - {"measure", "function", "title"}
        if self.function is not None:
            if not all(self.function.rpartition(":")[::2]):
                refuse(f"must be FILE.py:NAME or MODULE:NAME, got {self.function!r}", "function")
            for key in sorted(given - {"units"}):
                refuse("must be left out with function", key)
            return self
        assert self.measure is not None
        if self.measure not in MEASURES:
            refuse_name("measure", self.measure, MEASURES, "measure")
        allowed = {"of"} if MEASURES[self.measure].of else set()
        if MEASURES[self.measure].sliding:
            allowed |= {"units"}  # of a joint that slides they are others
        if self.measure == "pointing":
            allowed = {
                "index", "component", "value", "window", "drift_spacing", "period", "confidence",
            }  # fmt: skip
        for key in sorted(given - allowed):
            refuse(f"must be left out: {self.measure} has no {key}", key)
        return self

    @property
    def unit(self) -> str:
        """Unit of the number, as text."""
        if self.measure is None:
            return self.units
        if MEASURES[self.measure].of == "quantity":
            words = (self.of or "").split()
            return _UNITS.get(" ".join(words[-1:]), "")
        return self.units or MEASURES[self.measure].units

    @property
    def meaning(self) -> str:
        """Description of the number."""
        if self.title:
            return self.title
        if self.measure is None:
            return str(self.function)
        if self.measure == "pointing":
            which = "largest" if self.value == "largest" else f"{100.0 * self.confidence:g} % level of the"
            return f"{which} {self.index} of the pointing error, {self.component}"
        meaning = MEASURES[self.measure].meaning.split(" (")[0].split(", of a joint's quantity")[0]
        return f"{meaning}, {self.of}" if self.of else meaning


_UNITS = {"angle": "rad", "rate": "rad/s", "acceleration": "rad/s^2"}


def source_of(response: ResponseSpec, folder: Path, name: str) -> str:
    """Return the text of a response's function file, or ""."""
    return "" if response.function is None else own_source(response.function, folder, f"responses.{name}")


def evaluate(
    name: str, response: ResponseSpec, source: str, run: Trajectory, reference: Trajectory | None, seed: int
) -> float:
    """Return a response of a run; exceptions of a user's function pass through."""
    if response.measure is not None:
        return MEASURES[response.measure].find(run, response, reference if response.compares else None)
    assert response.function is not None
    return own_number(response.function, source, f"responses.{name}", run, seed)
