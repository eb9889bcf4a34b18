"""What measures and commands at instants of its own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

from pydantic import model_validator

from antenna_pin.control import CONTROLLERS, Pid, Sensor
from antenna_pin.scenario._base import read_quantity, refuse
from antenna_pin.scenario._explained import TAGGED
from antenna_pin.scenario._joint import Motion
from antenna_pin.scenario._made import MadeSpec, reads
from antenna_pin.units import matching_unit

__all__ = ["ControllerSpec", "PidSpec", "SensorSpec"]

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
    """What a sensor makes of a number: bias, noise by seed, steps."""


class _ControllerSpec(MadeSpec):
    """A table of a controller.

    Attributes:
        motion: What the unit of its reference says of the joint that it measures; None without a unit.
    """

    motion: Motion | None = None

    carried: ClassVar[frozenset[str]] = frozenset({"motion"})


class _Pid(_ControllerSpec):
    kind: Literal["pid"]

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


@reads(Pid, without=("state",), reference=float, sensor=SensorSpec, rate_sensor=SensorSpec)
class PidSpec(_Pid):
    """A sampled PID controller."""


ControllerSpec = PidSpec
"""A controller; ``kind`` says which class it is."""

TAGGED["controllers"] = tuple(CONTROLLERS)


def check_commands(controllers: Mapping[str, Any], families: Mapping[str, Mapping[str, Any]]) -> None:
    """Refuse, from inside a validator, controllers of what takes no commands.

    Args:
        controllers: The tables of controllers by name.
        families: Those of elements, by family and name.
    """
    known = [
        name
        for table, named in families.items()
        for element, spec in named.items()
        if spec.fills.commanded
        for name in (element, f"{table}.{element}", f"{table}.{element}.{spec.fills.commanded}")
    ]
    names = [name for name in known if "." not in name]
    for name, table in controllers.items():
        for command in table.build().commands:
            if command not in known:
                said = ", ".join(names) if names else "none here: give a drive of kind constant"
                refuse(
                    f"must be of what takes commands ({said}), got {command!r}",
                    "controllers",
                    name,
                    "acts_on",
                    value=command,
                )
