"""Sampled controllers and sensors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields
from functools import cache
from typing import Annotated, Any, ClassVar, Literal, Self, get_args, get_type_hints

from pydantic import BeforeValidator, model_validator

from antenna_pin.base.units import matching_unit, shown
from antenna_pin.elements.control import Course, Matrix, Sensor
from antenna_pin.elements.control.registry import CONTROLLERS
from antenna_pin.scenario._class_tables import MadeSpec, Motion, made_of, name_of_kind, reads
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


class ControllerSpec(MadeSpec):
    """A table of a controller, derived from the class of its ``kind``."""


class _Following(ControllerSpec):
    """A controller that may follow a reference instead of a number.

    Attributes:
        follows: A table of ``[references]``, by name, instead of a number; none if left out.
    """

    # The key of the number.
    course: ClassVar[str]

    follows: str | None = None

    @model_validator(mode="after")
    def _check_one_course(self) -> Self:
        """Refuse a number to be held beside a course to be followed."""
        # Not by the keys that are set: those of a copied scenario all are.
        default = type(self).model_fields[self.course].default
        if self.follows is not None and getattr(self, self.course) != default:
            refuse(f"must be left out with follows, which gives the {self.course}", self.course)
        return self


class _FollowingMeasure(_Following):
    """A controller that may follow a reference in the unit of its measurement.

    Attributes:
        motion: Motion of the measured joint by the unit of the number; None without a unit.
    """

    carried: ClassVar[frozenset[str]] = frozenset({"motion"})

    motion: Motion | None = None

    @model_validator(mode="before")
    @classmethod
    def _read_course(cls, data: Any) -> Any:
        """Read the number in a unit of what is measured."""
        if not isinstance(data, Mapping) or cls.course not in data:
            return data
        measures, given = data.get("measures") or "angle", data[cls.course]
        units = _UNITS.get(str(measures).split(" ")[0], ("1",))
        unit, done = matching_unit(given, units), dict(data)
        if len(units) > 1 and unit is not None:
            done["motion"] = "translation" if units.index(unit) else "rotation"
        done[cls.course] = read_quantity(given, units, "", cls.course)
        return done


def _matrix(value: object) -> object:
    """Read rows of numbers."""
    if not isinstance(value, list | tuple) or not all(isinstance(row, list | tuple) for row in value):
        refuse(f"must be rows of numbers, as [[1, 2], [3, 4]], got {shown(value)}", value=value)
    return tuple(
        tuple(read_quantity(entry, "1", "", i, j) for j, entry in enumerate(row))
        for i, row in enumerate(value)
    )


_ROWS: Any = Annotated[Matrix, BeforeValidator(_matrix)] | None


@cache
def _table_of(kind: str) -> type[ControllerSpec]:
    """Return the table of a kind of controller; its memory is no key."""
    cls, base, course = CONTROLLERS[kind], ControllerSpec, ""
    hints = get_type_hints(cls)
    nested: dict[str, Any] = {}
    for item in fields(cls):
        hint: Any = hints[item.name]
        if hint in (Sensor, tuple[Sensor, ...]):
            nested[item.name] = SensorSpec if hint is Sensor else tuple[SensorSpec, ...]
        elif Matrix in get_args(hint):
            nested[item.name] = _ROWS
        elif Course in get_args(hint):
            nested[item.name], course = float, item.name
            base = _FollowingMeasure if hints.get("measures") is str else _Following
    key: Any = (Literal[kind], ...)
    table = made_of(cls, base, key, __name__, ("state",), name_of_kind(kind), **nested)
    if course:
        table.course = course  # type: ignore[attr-defined]
    return table


def __getattr__(name: str) -> Any:
    """Return a table's class by name: ``PidSpec`` of ``pid``."""
    for kind in CONTROLLERS:
        if name_of_kind(kind) == name:
            return _table_of(kind)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


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
