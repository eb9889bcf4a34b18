"""Sampled controllers and sensors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, model_validator

from antenna_pin.base.units import matching_unit, shown
from antenna_pin.elements.control import AttitudeFeedback, BangBang, Matrix, Pid, Sensor, StateFeedback
from antenna_pin.scenario._class_tables import MadeSpec, Motion, reads
from antenna_pin.scenario.spec import read_quantity, refuse

# Units of what is measured, by its kind; of a joint that turns, and that slides.
_UNITS: Mapping[str, tuple[str, ...]] = {
    "angle": ("rad", "m"),
    "rate": ("rad/s", "m/s"),
    "base-rotation": ("rad",),
    "base-rate": ("rad/s",),
    "force": ("N",),
    "gap": ("m",),
}


@reads(Sensor)
class SensorSpec(MadeSpec):
    """Errors of a sensor: bias, noise by seed, steps."""


@reads(Pid, without=("state",), reference=float, sensor=SensorSpec, rate_sensor=SensorSpec)
class PidSpec(MadeSpec):
    """A sampled PID controller.

    Attributes:
        motion: Motion of the measured joint by the unit of the reference; None without a unit.
        follows: A table of ``[references]``, by name, instead of a number as reference; none if left out.
    """

    carried: ClassVar[frozenset[str]] = frozenset({"motion"})

    motion: Motion | None = None
    kind: Literal["pid"]
    follows: str | None = None

    @model_validator(mode="after")
    def _check_one_reference(self) -> Self:
        """Refuse a number to be held beside a course to be followed."""
        # Not by the keys that are set: those of a copied scenario all are.
        if self.follows is not None and self.reference != 0.0:
            refuse("must be left out with follows, which gives the reference", "reference")
        return self

    @model_validator(mode="before")
    @classmethod
    def _read_reference(cls, data: Any) -> Any:
        """Read the reference in a unit of what is measured."""
        if not isinstance(data, Mapping) or "reference" not in data:
            return data
        measures = data.get("measures") or "angle"
        units = _UNITS.get(str(measures).split(" ")[0], ("1",))
        unit, done = matching_unit(data["reference"], units), dict(data)
        if len(units) > 1 and unit is not None:
            done["motion"] = "translation" if units.index(unit) else "rotation"
        done["reference"] = read_quantity(data["reference"], units, "", "reference")
        return done


def _matrix(value: object) -> object:
    """Read rows of numbers."""
    if not isinstance(value, list | tuple) or not all(isinstance(row, list | tuple) for row in value):
        refuse(f"must be rows of numbers, as [[1, 2], [3, 4]], got {shown(value)}", value=value)
    return tuple(
        tuple(read_quantity(entry, "1", "", i, j) for j, entry in enumerate(row))
        for i, row in enumerate(value)
    )


_Rows = Annotated[Matrix, BeforeValidator(_matrix)] | None


@reads(
    StateFeedback,
    without=("state",),
    sensors=tuple[SensorSpec, ...],
    gain=_Rows,
    a=_Rows,
    b=_Rows,
    c=_Rows,
    g=_Rows,
)
class StateFeedbackSpec(MadeSpec):
    """A sampled controller that feeds back what it measures by matrices."""

    kind: Literal["state-feedback"]

    motion: ClassVar[None] = None


@reads(AttitudeFeedback, share=float)
class AttitudeSpec(MadeSpec):
    """Feedback of the base's quaternion and rate, by wheels.

    Attributes:
        follows: A table of ``[references]``, by name, from 0 to 1: the share of the way; none if left out.
    """

    kind: Literal["attitude"]
    follows: str | None = None

    motion: ClassVar[None] = None

    @model_validator(mode="after")
    def _check_one_share(self) -> Self:
        """Refuse a share to be held beside one to be followed."""
        if self.follows is not None and self.share != 1.0:
            refuse("must be left out with follows, which gives the share", "share")
        return self


@reads(BangBang, without=("state",), sensor=SensorSpec, rate_sensor=SensorSpec)
class BangBangSpec(MadeSpec):
    """A sampled on-off controller with a switching line of angle and rate."""

    kind: Literal["bang-bang"]

    motion: ClassVar[None] = None


ControllerSpec = PidSpec | StateFeedbackSpec | AttitudeSpec | BangBangSpec
"""A controller; ``kind`` says which class it is."""


def check_commands(controllers: Mapping[str, Any], families: Mapping[str, Mapping[str, Any]]) -> None:
    """Refuse, in a validator, controllers of elements that take no commands."""
    known = [
        name
        for table, named in families.items()
        for element, spec in named.items()
        if spec.fills.commanded
        for name in (element, f"{table}.{element}", f"{table}.{element}.{spec.fills.commanded}")
    ]
    names = [name for name in known if "." not in name]
    for name, table in controllers.items():
        for key, command in _commanded(table):
            if command not in known:
                said = ", ".join(names) if names else "none here: give a drive of kind constant"
                refuse(
                    f"must be an element that takes commands ({said}), got {command!r}",
                    "controllers",
                    name,
                    key,
                    value=command,
                )


def _commanded(table: Any) -> Iterator[tuple[str, str]]:
    """Yield what a table commands, each behind the key that names it."""
    for key in ("acts_on", "positive", "negative"):
        given = getattr(table, key, ())
        for name in (given,) if isinstance(given, str) else given:
            if name:
                yield key, name
