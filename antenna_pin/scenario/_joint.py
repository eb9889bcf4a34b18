"""Tables of a joint that turns or slides, by the given units."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal, get_args

from pydantic import model_validator
from pydantic.fields import FieldInfo

from antenna_pin.base.units import matching_unit, shown
from antenna_pin.scenario._base import Quantity, Spec, refuse

Motion = Literal["rotation", "translation"]
_MOTIONS: tuple[Motion, ...] = get_args(Motion)
JOINTS = {"rotation": "turning", "translation": "sliding"}
"""What moves so, by the motion."""


def motion_of(value: object, units: str | tuple[str, ...]) -> Motion | None:
    """Return the motion implied by a text's unit; None if units do not decide."""
    if isinstance(units, str) or len(units) != len(_MOTIONS):
        return None
    unit = matching_unit(value, units)
    return None if unit is None else _MOTIONS[units.index(unit)]


class JointTable(Spec):
    """A table about a joint that turns or slides.

    Attributes:
        motion: What the units given say of the joint's motion; None if all numbers came without unit.
    """

    motion: Motion | None = None

    carried: ClassVar[frozenset[str]] = frozenset({"motion"})

    @model_validator(mode="before")
    @classmethod
    def _read_motion(cls, data: Any) -> Any:
        """Find out from the units whether the joint turns or slides, and that they agree."""
        if not isinstance(data, Mapping):
            return data
        motion, first = data.get("motion"), "motion"
        for name, field in cls.model_fields.items():
            seen = motion_of(data.get(name), _either_unit(field))
            if seen is None:
                continue
            if motion in JOINTS and motion != seen:
                rule = f"must be for a {JOINTS[motion]} joint, as {first} is"
                refuse(f"{rule}, got {shown(data[name])} ({JOINTS[seen]})", name, value=data[name])
            motion, first = seen, first if motion is not None else name
        return data if motion is None else {**data, "motion": motion}


def _either_unit(field: FieldInfo) -> tuple[str, ...]:
    candidates = [*field.metadata, *(item for part in get_args(field.annotation) for item in get_args(part))]
    for item in candidates:
        if isinstance(item, Quantity) and isinstance(item.unit, tuple) and len(item.unit) == len(_MOTIONS):
            return item.unit
    return ()
