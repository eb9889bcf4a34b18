"""Events of a run and their actions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal, Self, get_args

from pydantic import BeforeValidator, model_validator

from antenna_pin.base.units import shown
from antenna_pin.scenario._class_tables import JointTable
from antenna_pin.scenario.spec import (
    QuantityRule,
    Spec,
    read_count,
    read_quantity,
    refuse,
    refuse_key,
    refuse_name,
    unknown_key,
)

Direction = Literal["both", "rising", "falling"]
ActionName = Literal["mark", "stop", "set"]


def _instants(value: object) -> tuple[float, ...]:
    given = value if isinstance(value, list | tuple) else [value]
    if not given:
        refuse("must be one or more times, got none", value=value)
    return tuple(read_quantity(entry, "s", "positive", i) for i, entry in enumerate(given))


class _Event(Spec):
    """Base of all events.

    Attributes:
        action: ``mark`` it in the result, as every event is; ``stop`` the run; ``set`` numbers; or several,
            as ``["set", "stop"]``.
        after: The passage from which on that is done; earlier ones are only marked.
        once: Whether it is done at that passage alone, else at each from it on.
        set: Number to set: ``drives.NAME.KEY``, ``springs.NAME.KEY``, ...; the key ``on`` switches the
            element. A table of such keys sets several, ``{ "springs.a.on" = false, "drives.b.value" = "2 N*m"
            }``.
        to: New value; of ``on`` true or false; left out with a table.
    """

    action: ActionName | tuple[ActionName, ...] = "mark"
    after: Annotated[int, read_count("1 or more")] = 1
    once: bool = False
    set: str | dict[str, bool | float | str] | None = None
    to: bool | float | str | None = None

    @property
    def actions(self) -> tuple[ActionName, ...]:
        """Actions, in order."""
        return (self.action,) if isinstance(self.action, str) else self.action

    @property
    def numbers(self) -> dict[str, bool | float | str]:
        """Numbers to set, as given, by key."""
        if self.set is None or isinstance(self.set, str):
            return {} if self.set is None or self.to is None else {self.set: self.to}
        return self.set

    @model_validator(mode="after")
    def _check_action(self) -> Self:
        said = ", ".join(self.actions)
        if not self.actions:
            refuse("must be mark, stop or set, or several of these, got none", "action")
        sets, table = "set" in self.actions, isinstance(self.set, dict)
        for name, wanted in (("set", sets), ("to", sets and not table)):
            given = getattr(self, name)
            if (given is None) == wanted:
                rule = "is missing; give it" if given is None else "must be left out"
                beside = "with a table in set" if sets and table else f'where action is "{said}"'
                refuse(f"{rule} {beside}", name, value=given)
        if table and not self.set:
            refuse("must be the numbers to set, got an empty table", "set")
        return self


class AngleEvent(_Event, JointTable):
    """The angle (whole turns included) or position of a joint crosses a value.

    Attributes:
        joint: Name of the joint.
        value: Value to pass [rad] ([m]).
        direction: Direction of crossings that count.
    """

    kind: Literal["angle"]
    joint: str
    value: Annotated[float, QuantityRule(("rad", "m"))]
    direction: Direction = "both"


class RateEvent(_Event, JointTable):
    """The rate of a joint passes a value; at zero it turns back.

    Attributes:
        joint: Name of the joint.
        value: Value to pass [rad/s] ([m/s]).
        direction: Direction of crossings that count.
    """

    kind: Literal["rate"]
    joint: str
    value: Annotated[float, QuantityRule(("rad/s", "m/s"))] = 0.0
    direction: Direction = "both"


class TimeEvent(_Event):
    """Instants are reached.

    Attributes:
        time: Times [s].
    """

    kind: Literal["time"]
    time: Annotated[tuple[float, ...], BeforeValidator(_instants)]


class GapEvent(_Event):
    """The gap of a contact passes a value; minus a penetration.

    Attributes:
        contact: Name of the contact, such as ``elevation.radial+``.
        value: Value to pass [m].
        direction: Direction of crossings that count.
    """

    kind: Literal["gap"]
    contact: str
    value: Annotated[float, QuantityRule("m")]
    direction: Direction = "both"


class ForceEvent(_Event):
    """The normal force of a contact passes a value.

    Attributes:
        contact: Name of the contact, such as ``elevation.radial+``.
        value: Value to pass [N].
        direction: Direction of crossings that count.
    """

    kind: Literal["force"]
    contact: str
    value: Annotated[float, QuantityRule("N", "positive")]
    direction: Direction = "both"


class ChangeEvent(_Event):
    """A change of an element or contact: capture, touch, stick.

    Attributes:
        of: Place of the element, as ``latches.root``, or name of a contact, as ``elevation.radial+``.
        change: ``capture``, ``refusal`` or ``release`` of a latch; ``touch``, ``rest`` (of a rigid one),
            ``turn`` (of others) or ``lift-off`` of a stop or a gear; ``stick`` or ``slip`` of a friction;
            ``touch`` or ``lift-off`` of a contact.
        side: ``lower`` or ``upper`` of a stop, ``plus`` or ``minus`` of a gear; either if left out.
    """

    kind: Literal["change"]
    of: str
    change: str
    side: str | None = None


EventSpec = AngleEvent | RateEvent | TimeEvent | GapEvent | ForceEvent | ChangeEvent
"""An event; ``kind`` says which class it is."""


def numbers_to_set(
    event: EventSpec, tables: Mapping[str, Mapping[str, Spec]], *place: str
) -> dict[str, float]:
    """Return an event's numbers to set by key, in SI units, or refuse them."""
    alone = event.to is not None
    return {
        key: _number_to_set(key, value, tables, place, () if alone else (key,))
        for key, value in event.numbers.items()
    }


def _number_to_set(
    whole: str,
    value: bool | float | str,
    tables: Mapping[str, Mapping[str, Spec]],
    place: tuple[str, ...],
    entry: tuple[str, ...],
) -> float:
    """Return one number to set, in an entry of the table ``set`` or alone."""
    element, _, key = whole.rpartition(".")
    kind, _, name = element.partition(".")
    known = [f"{family}.{one}" for family, named in tables.items() for one in named]
    at = (*place, "set", *entry)
    if not known:
        refuse(f"must be of an element, FAMILY.NAME.KEY, but the scenario has none, got {whole!r}", *at)
    if element not in known:
        refuse_name("element", element or key, known, *at)
    value_at = at if entry else (*place, "to")
    quantities = _quantities(tables[kind][name])
    switched = "on" in type(tables[kind][name]).model_fields
    if key == "on" and switched:
        if not isinstance(value, bool):
            refuse(f"must be true or false, got {shown(value)}", *value_at, value=value)
        return float(value)
    if key not in quantities:
        refuse_key(f"sets {key!r}, which {unknown_key([*quantities, *(['on'] * switched)], key)}", *at)
    unit = quantities[key]
    return read_quantity(value, unit.unit, unit.rule, *value_at)


def _quantities(table: Spec) -> dict[str, QuantityRule]:
    """Return the numbers that a table has and that may change, by key."""
    found = {}
    at_start = getattr(getattr(table, "fills", None), "at_start", ())
    for key, field in type(table).model_fields.items():
        for item in (*field.metadata, *get_args(field.annotation)):
            if isinstance(item, QuantityRule) and key not in at_start:
                found[key] = item
    return found
