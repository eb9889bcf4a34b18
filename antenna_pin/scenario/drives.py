"""What acts at the joints: drives and springs, with the keys of the elements that they are made of."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal, Self, Union

from pydantic import Field, create_model, model_validator

from antenna_pin.elements import DRIVES, SPRINGS, PointSpring, TableDrive
from antenna_pin.scenario._base import refuse
from antenna_pin.scenario._joint import JointTable
from antenna_pin.scenario._made import MadeSpec, reads
from antenna_pin.scenario.closures import PlaceSpec

__all__ = [
    "DRIVE_SPECS",
    "SPRING_SPECS",
    "AnySpring",
    "DriveSpec",
    "FrictionSpec",
    "PointSpringSpec",
    "SpringSpec",
    "file_columns",
    "kind_of_spring",
]


class _ElementSpec(JointTable, MadeSpec):
    """A table of a force element."""


class _SpringSpec(_ElementSpec):
    @model_validator(mode="after")
    def _check_something(self) -> Self:
        _ask_for_something(self)
        return self


@reads(PointSpring, without=("first", "second"))
class PointSpringSpec(MadeSpec):
    """A linear spring and damper between points of two links, or of a link and the world.

    Attributes:
        first: One end.
        second: The other, on another link.
    """

    kind: Literal["between-points"] = "between-points"
    first: PlaceSpec = Field(...)
    second: PlaceSpec = Field(...)

    def build(self, **more: Any) -> Any:
        """Return the spring; ends that are frames have to be given.

        Args:
            **more: ``first`` and ``second`` as a spring takes them, where the URDF has told.
        """
        said = {
            name: (side.link or side.frame, side.point or (0.0, 0.0, 0.0))
            for name, side in (("first", self.first), ("second", self.second))
        }
        return super().build(**said | more)

    @model_validator(mode="after")
    def _check_something(self) -> Self:
        _ask_for_something(self)
        for key in ("link", "frame"):
            name = getattr(self.first, key)
            if name is not None and name == getattr(self.second, key):
                refuse(f"must be on another link than first, got {name!r}", "second", key)
        return self


def _ask_for_something(spring: MadeSpec) -> None:
    asked = spring.fills.one_above_zero
    if asked and not any(getattr(spring, name) for name in asked):
        refuse(f"must have a {' or a '.join(asked)} above zero, got neither")


def kind_of_spring(table: Mapping[str, Any]) -> str:
    """Return the kind of a spring's table that names none: one with an end is between points."""
    return "spring" if {"first", "second"}.isdisjoint(table) else "between-points"


class _TableSpec(_ElementSpec):
    @model_validator(mode="before")
    @classmethod
    def _check_given(cls, data: Any) -> Any:
        if isinstance(data, Mapping) and not data.keys() & {"file", *TableDrive.columns}:
            refuse("must have either file, or time and torque, got neither")
        return data


def _table(kind: str, cls: type[Any], base: type[_ElementSpec], default: Any = ...) -> type[_ElementSpec]:
    """Return the table of a kind of element at a joint."""
    key: Any = (Literal[kind], default)
    name = f"{cls.__name__.removeprefix('Joint')}Spec"
    return reads(cls)(create_model(name, __base__=base, __doc__=cls.__doc__, __module__=__name__, kind=key))


DRIVE_SPECS: Mapping[str, type[_ElementSpec]] = {
    kind: _table(kind, cls, _TableSpec if cls is TableDrive else _ElementSpec) for kind, cls in DRIVES.items()
}
"""The tables of drives by their kind."""

SPRING_SPECS: Mapping[str, type[MadeSpec]] = {
    kind: PointSpringSpec
    if cls is PointSpring
    else _table(kind, cls, _SpringSpec, "spring" if kind == "spring" else ...)
    for kind, cls in SPRINGS.items()
}
"""The tables of what is in ``[springs]`` by their kind."""

# A scenario that is pickled names its classes as this module does.
globals().update({spec.__name__: spec for spec in (*DRIVE_SPECS.values(), *SPRING_SPECS.values())})

if TYPE_CHECKING:
    DriveSpec = _ElementSpec
    SpringSpec = FrictionSpec = _SpringSpec
    AnySpring = _SpringSpec | PointSpringSpec
else:
    DriveSpec = Union[tuple(DRIVE_SPECS.values())]  # noqa: UP007 - of values
    """A drive; ``kind`` says which class it is."""
    AnySpring = Union[tuple(SPRING_SPECS.values())]  # noqa: UP007 - of values
    """A spring; ``kind`` says which class it is."""


def file_columns(table: object) -> tuple[str, str] | None:
    """Return the columns of the file that a drive's table may name instead of numbers; None if it may not."""
    if not isinstance(table, Mapping) or not isinstance(table.get("kind"), str):
        return None
    return getattr(DRIVES.get(table["kind"]), "columns", None)
