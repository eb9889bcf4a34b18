"""Integration of the motion, and its record."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError, model_validator

from antenna_pin.base.arguments import takes
from antenna_pin.base.settings import ErrorScales, RunSettings, choice_for
from antenna_pin.base.units import shown
from antenna_pin.scenario._base import read_quantity, refuse
from antenna_pin.scenario._made import MadeSpec, reads

__all__ = ["IntegratorSpec", "OutputSpec", "ScalesSpec", "settings_key"]


@reads(ErrorScales)
class ScalesSpec(MadeSpec):
    """Error scale per kind of quantity: ``rtol * (scale + |value|)``."""


@reads(RunSettings, without=("output_rate", "output_times", "output_form"), scales=ScalesSpec)
class IntegratorSpec(MadeSpec):
    """Integration of the motion."""

    @model_validator(mode="before")
    @classmethod
    def _choose(cls, data: Any) -> Any:
        """Refuse an accuracy beside what it chooses, and fill that in."""
        if not isinstance(data, Mapping) or data.get("accuracy") is None:
            return data
        try:
            given = read_quantity(data["accuracy"], "1", "between 0 and 1")
        except ValidationError:
            return data  # refused where it is read
        chosen = dict(zip(("method", "rtol"), choice_for(given), strict=True))
        for name, value in chosen.items():
            if data.get(name, value) != value:
                rule = f"must be left out beside accuracy = {given:g}, which chooses it"
                refuse(f"{rule}, got {shown(data[name])}; leave out one of them", name)
        return {**data, **chosen}


@takes()
def settings_key(parameter: str) -> tuple[str, ...]:
    """Return the keys of a scenario by which a parameter of the settings, or of their run, is set."""
    if parameter == "duration":
        return (parameter,)
    output = parameter.removeprefix("output_")
    return ("integrator", parameter) if output == parameter else ("output", output)


@reads(
    RunSettings,
    only=("output_rate", "output_times", "output_form"),
    renamed={"output_rate": "rate", "output_times": "times", "output_form": "form"},
)
class OutputSpec(MadeSpec):
    """Record of the motion."""
