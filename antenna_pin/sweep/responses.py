"""The responses of a study: the numbers kept of each run, by measures or functions of the user's own."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import BeforeValidator, model_validator

from antenna_pin.analysis import own_number, own_source
from antenna_pin.scenario.spec import PositiveTime, Quantity, Spec, refuse, refuse_name
from antenna_pin.sweep.measures import MEASURES

if TYPE_CHECKING:
    from antenna_pin.trajectory import Trajectory

__all__ = ["ResponseSpec", "evaluate", "source_of"]


def _share(value: object) -> float:
    number = Quantity("1").read(value)
    if not 0.0 < number <= 1.0:
        refuse(f"must be above 0 and at most 1, got {value}", value=value)
    return number


class ResponseSpec(Spec):
    """One number of each run: by a measure, or a function; a text alone stands for either.

    Attributes:
        measure: Name of a measure.
        function: ``FILE.py:NAME``, from the study file's folder, or ``MODULE:NAME``; called with the run, a
            Trajectory, and if it has an argument ``seed`` with the run's; returns a number.
        of: What the measure is of: a contact, a joint, a drive, a quantity as ``elevation angle``; all if
            left out, where that makes sense.
        index: Of ``pointing``: index of ECSS-E-ST-60-10C.
        component: Of ``pointing``: ``half-cone``, ``boresight``, ``cross`` or ``up``.
        value: Of ``pointing``: the ``largest`` one, or the ``level`` of the confidence.
        window: Of ``pointing``: length of the windows.
        drift_spacing: Of ``pointing``: from one window of the PDE to the other.
        period: Of ``pointing``: length of the observation periods.
        confidence: Of ``pointing``'s level [-].
        units: Of a function's number; of a measure of what turns or slides, where it slides.
        title: What it is called in figures; its name if left out.
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
    confidence: Annotated[float, BeforeValidator(_share)] = 0.997
    units: str = ""
    title: str = ""

    @model_validator(mode="before")
    @classmethod
    def _read_text(cls, data: Any) -> Any:
        """Let a text stand for a measure, or, with a colon, for a function."""
        if isinstance(data, str):
            return {"function" if ":" in data else "measure": data}
        if isinstance(data, Mapping) and ":" in str(data.get("measure", "")) and "function" not in data:
            return {"function" if key == "measure" else key: value for key, value in data.items()}
        return data

    @property
    def compares(self) -> bool:
        """Whether it compares with the study's reference."""
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
                refuse("must be left out beside function", key)
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
        """The unit of the number, as text."""
        if self.measure is None:
            return self.units
        if MEASURES[self.measure].of == "quantity":
            words = (self.of or "").split()
            return _UNITS.get(" ".join(words[-1:]), "")
        return self.units or MEASURES[self.measure].units

    @property
    def meaning(self) -> str:
        """What the number is, in words."""
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
    """Return the text of the file that a response's function stands in; "" for a module's or a measure.

    Raises:
        ScenarioError: There is no such file or module, or no such function in it.
    """
    return "" if response.function is None else own_source(response.function, folder, f"responses.{name}")


def evaluate(
    name: str,
    response: ResponseSpec,
    source: str,
    run: Trajectory,
    reference: Trajectory | None,
    seed: int,
) -> float:
    """Return a response of a run.

    Args:
        name: Of the response.
        response: The response.
        source: The text of its function's file, or "".
        run: The run.
        reference: What it is compared with.
        seed: Of the run.

    Raises:
        AntennaPinError: The measure does not exist for this run.
        Exception: Whatever a function of the user's own raises.
    """
    if response.measure is not None:
        return MEASURES[response.measure].find(run, response, reference if response.compares else None)
    assert response.function is not None
    return own_number(response.function, source, f"responses.{name}", run, seed)
