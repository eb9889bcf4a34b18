"""What acts at the joints: drives and springs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from antenna_pin.scenario._base import Quantity, read_quantity, refuse
from antenna_pin.scenario._joint import JointTable
from antenna_pin.units import shown

__all__ = ["ConstantDrive", "DriveSpec", "SineDrive", "SpringSpec", "TableDrive"]

_EFFORT = Quantity(("N*m", "N"))


class SpringSpec(JointTable):
    """A linear spring and damper at a joint; the units are those of a turning (sliding) joint.

    Attributes:
        joint: Name of the joint.
        stiffness: [N*m/rad] ([N/m]).
        damping: [N*m*s/rad] ([N*s/m]).
        rest_angle: Where the spring is at rest [rad] ([m]).
        shorter_way: Whether the deflection of a turning joint is taken the shorter way round, within half a
            turn, rather than with all its turns.
    """

    joint: str
    stiffness: Annotated[float, Quantity(("N*m/rad", "N/m"), "zero or more")] = 0.0
    damping: Annotated[float, Quantity(("N*m*s/rad", "N*s/m"), "zero or more")] = 0.0
    rest_angle: Annotated[float, Quantity(("rad", "m"))] = 0.0
    shorter_way: bool = False

    @model_validator(mode="after")
    def _check_use(self) -> Self:
        if self.stiffness == self.damping == 0.0:
            refuse("must have a stiffness or a damping above zero, got neither")
        return self


class _Drive(JointTable):
    """What all drives share.

    Attributes:
        joint: Name of the joint.
        axis: Whose axis the torque acts about; it matters at joints with play.
    """

    joint: str
    axis: Literal["bearing", "journal"] = "bearing"


class ConstantDrive(_Drive):
    """A constant torque, or force at a sliding joint.

    Attributes:
        value: [N*m] ([N]).
    """

    kind: Literal["constant"]
    value: Annotated[float, _EFFORT]


class SineDrive(_Drive):
    """The torque, or force at a sliding joint, ``amplitude * sin(2 pi frequency t + phase)``.

    Attributes:
        amplitude: [N*m] ([N]).
        frequency: [Hz].
        phase: [rad].
    """

    kind: Literal["sine"]
    amplitude: Annotated[float, _EFFORT]
    frequency: Annotated[float, Quantity("Hz", "positive")]
    phase: Annotated[float, Quantity("rad")] = 0.0


def _read_numbers(value: object) -> tuple[float, ...]:
    if hasattr(value, "tolist"):  # a NumPy array
        value = value.tolist()
    if not isinstance(value, list | tuple):
        refuse(f"must be an array of numbers, got {shown(value)}", value=value)
    return tuple(read_quantity(entry, "1", "", i) for i, entry in enumerate(value))


Numbers = Annotated[tuple[float, ...], BeforeValidator(_read_numbers)]


class TableDrive(_Drive):
    """A torque, or force at a sliding joint, interpolated in a table.

    Attributes:
        file: Where the table came from, relative to the scenario's folder; None if given as numbers.
        interpolation: ``linear`` or ``cubic``.
        time: Strictly increasing, at least two [s].
        torque: One for each time [N*m] ([N]).
    """

    kind: Literal["table"]
    file: str | None = None
    interpolation: Literal["linear", "cubic"] = "linear"
    time: Numbers = Field(repr=False)
    torque: Numbers = Field(repr=False)

    @model_validator(mode="before")
    @classmethod
    def _check_given(cls, data: Any) -> Any:
        if isinstance(data, Mapping) and not data.keys() & {"file", "time", "torque"}:
            refuse("must have either file, or time and torque, got neither")
        return data

    @model_validator(mode="after")
    def _check_table(self) -> Self:
        if len(self.time) < 2:
            refuse(f"must have at least 2 entries, got {len(self.time)}", "time")
        if len(self.torque) != len(self.time):
            refuse(f"must have as many entries as time, {len(self.time)}, got {len(self.torque)}", "torque")
        for i, (before, after) in enumerate(zip(self.time, self.time[1:], strict=False), start=1):
            if not after > before:
                refuse(f"must increase strictly, got {after!r} after {before!r}", "time", i)
        return self


DriveSpec = ConstantDrive | SineDrive | TableDrive
"""A drive; ``kind`` says which class it is."""
