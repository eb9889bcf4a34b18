"""What is looked for in the middle of a run, and what happens then."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal, Self, get_args

from pydantic import BeforeValidator, model_validator

from antenna_pin.scenario._base import (
    Quantity,
    Spec,
    read_quantity,
    refuse,
    refuse_key,
    refuse_name,
    unknown_key,
)
from antenna_pin.scenario._joint import JointTable
from antenna_pin.units import shown

__all__ = ["AngleEvent", "EventSpec", "ForceEvent", "GapEvent", "RateEvent", "TimeEvent", "number_to_set"]

Direction = Literal["both", "rising", "falling"]


def _count(value: object) -> int:
    number = read_quantity(value, "1", "1 or more")
    if number != int(number):
        refuse(f"must be a whole number, got {shown(value)}", value=value)
    return int(number)


def _instants(value: object) -> tuple[float, ...]:
    given = value if isinstance(value, list | tuple) else [value]
    if not given:
        refuse("must be one or more times, got none", value=value)
    return tuple(read_quantity(entry, "s", "positive", i) for i, entry in enumerate(given))


class _Event(Spec):
    """What all events share.

    Attributes:
        action: ``mark`` it in the result, as every event is; ``stop`` the run; or ``set`` a number.
        after: The passage from which on that is done; earlier ones are only marked.
        set: What is set: ``drives.NAME.KEY``, ``springs.NAME.KEY``, ...; the key ``on`` is the whole of it.
        to: What it is set to; of ``on`` true or false.
    """

    action: Literal["mark", "stop", "set"] = "mark"
    after: Annotated[int, BeforeValidator(_count)] = 1
    set: str | None = None
    to: bool | float | str | None = None

    @model_validator(mode="after")
    def _check_action(self) -> Self:
        for name in ("set", "to"):
            given = getattr(self, name)
            if (given is None) == (self.action == "set"):
                rule = "is missing; give it" if given is None else "must be left out"
                refuse(f'{rule} where action is "{self.action}"', name, value=given)
        return self


class AngleEvent(_Event, JointTable):
    """The angle of a joint, whole turns included, or the position of a sliding one passes a value.

    Attributes:
        joint: Name of the joint.
        value: That is passed [rad] ([m]).
        direction: Which passages count.
    """

    kind: Literal["angle"]
    joint: str
    value: Annotated[float, Quantity(("rad", "m"))]
    direction: Direction = "both"


class RateEvent(_Event, JointTable):
    """The rate of a joint passes a value; at zero it turns back.

    Attributes:
        joint: Name of the joint.
        value: That is passed [rad/s] ([m/s]).
        direction: Which passages count.
    """

    kind: Literal["rate"]
    joint: str
    value: Annotated[float, Quantity(("rad/s", "m/s"))] = 0.0
    direction: Direction = "both"


class TimeEvent(_Event):
    """Instants are reached.

    Attributes:
        time: When [s].
    """

    kind: Literal["time"]
    time: Annotated[tuple[float, ...], BeforeValidator(_instants)]


class GapEvent(_Event):
    """The gap of a contact passes a value; minus a penetration.

    Attributes:
        contact: Name of the contact, such as ``elevation.radial+``.
        value: That is passed [m].
        direction: Which passages count.
    """

    kind: Literal["gap"]
    contact: str
    value: Annotated[float, Quantity("m")]
    direction: Direction = "both"


class ForceEvent(_Event):
    """The normal force of a contact passes a value.

    Attributes:
        contact: Name of the contact, such as ``elevation.radial+``.
        value: That is passed [N].
        direction: Which passages count.
    """

    kind: Literal["force"]
    contact: str
    value: Annotated[float, Quantity("N", "positive")]
    direction: Direction = "both"


EventSpec = AngleEvent | RateEvent | TimeEvent | GapEvent | ForceEvent
"""An event; ``kind`` says which class it is."""


def number_to_set(event: EventSpec, tables: Mapping[str, Mapping[str, Spec]], *place: str) -> float:
    """Return what an event sets, in SI units, or refuse it from inside a validator.

    Args:
        event: One whose action is ``set``.
        tables: The elements of the scenario by family, then by name.
        *place: Where the event stands.
    """
    element, _, key = (event.set or "").rpartition(".")
    kind, _, name = element.partition(".")
    known = [f"{place}.{one}" for place, named in tables.items() for one in named]
    if element not in known:
        refuse_name("element", element or key, known, *place, "set")
    quantities = _quantities(tables[kind][name])
    switched = "on" in type(tables[kind][name]).model_fields
    if key == "on" and switched:
        if not isinstance(event.to, bool):
            refuse(f"must be true or false, got {shown(event.to)}", *place, "to", value=event.to)
        return float(event.to)
    if key not in quantities:
        refuse_key(
            f"sets {key!r}, which {unknown_key([*quantities, *(['on'] * switched)], key)}", *place, "set"
        )
    unit = quantities[key]
    return read_quantity(event.to, unit.unit, unit.rule, *place, "to")


def _quantities(table: Spec) -> dict[str, Quantity]:
    """Return the numbers that a table has and that may change, by key."""
    found = {}
    at_start = getattr(getattr(table, "fills", None), "at_start", ())
    for key, field in type(table).model_fields.items():
        for item in (*field.metadata, *get_args(field.annotation)):
            if isinstance(item, Quantity) and key not in at_start:
                found[key] = item
    return found
