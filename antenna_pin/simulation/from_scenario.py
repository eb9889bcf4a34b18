"""What of a run stands in a scenario: its settings and events; and a scenario as it was run."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any, Literal

from antenna_pin.assemble import reference_for
from antenna_pin.base.settings import RunSettings
from antenna_pin.control import Controller
from antenna_pin.elements import FAMILIES
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.scenario import Scenario
from antenna_pin.simulation.events import (
    Action,
    Angle,
    Condition,
    ElementChange,
    Event,
    Force,
    Gap,
    Mark,
    Rate,
    Set,
    Stop,
    Time,
)

__all__ = ["as_run", "both", "check_without_controllers", "controllers_of", "events_of", "settings_of"]

_DIRECTIONS: dict[str, Literal[-1, 0, 1]] = {"both": 0, "rising": 1, "falling": -1}


def settings_of(scenario: Scenario) -> RunSettings:
    """Return how a scenario is to be integrated and sampled."""
    output = scenario.output
    settings: RunSettings = scenario.integrator.build(
        output_rate=output.rate, output_times=output.times, output_form=output.form
    )
    return settings


def as_run(scenario: Scenario, duration: float, settings: RunSettings) -> Scenario:
    """Return the scenario with what was given beside it, so that the result tells how to repeat it."""
    changes: dict[str, Any] = {}
    planned = settings_of(scenario)
    for name, place in (("", "integrator"), ("scales", "integrator.scales")):
        used, told = (getattr(one, name) if name else one for one in (settings, planned))
        for field in dataclasses.fields(used):
            value = getattr(used, field.name)
            if field.name != "scales" and value is not None and value != getattr(told, field.name):
                output = field.name.startswith("output_")
                changes[field.name.replace("_", ".") if output else f"{place}.{field.name}"] = value
    if duration != scenario.duration and not changes:
        return scenario.lasting(duration)
    if duration != scenario.duration:
        changes = {"duration": duration, **changes}
    return scenario.with_overrides(changes) if changes else scenario


def events_of(scenario: Scenario) -> tuple[Event, ...]:
    """Return the events that a scenario looks for."""
    return tuple(
        Event(
            name=name,
            when=_CONDITIONS[table.kind](table),
            direction=_DIRECTIONS[_direction(table)],
            action=_actions(scenario, name),
            after=table.after,
            once=table.once,
        )
        for name, table in scenario.events.items()
    )


def controllers_of(scenario: Scenario) -> dict[str, Controller]:
    """Return the controllers of a scenario, by name."""
    found = {}
    for name, table in scenario.controllers.items():
        follows = getattr(table, "follows", None)
        key = "share" if table.kind == "attitude" else "reference"
        more = {} if follows is None else {key: reference_for(scenario, follows, None).over_time()}
        found[name] = table.build(**more)
    return found


def both(own: Mapping[str, Controller], given: Mapping[str, Controller]) -> dict[str, Controller]:
    """Return a scenario's controllers and those that are given beside it.

    Raises:
        InvalidParameterError: Two have one name.
    """
    for name in given:
        if name in own:
            rule = f"of other names than the scenario's own, {', '.join(own)}"
            raise InvalidParameterError("simulate", "controllers", rule, name)
    return {**own, **given}


def check_without_controllers(place: str, scenario: Scenario) -> None:
    """Refuse a scenario with controllers, where a state must be all that the motion after it depends on.

    Raises:
        InvalidParameterError: It has some.
    """
    if scenario.controllers:
        rule = "without [controllers], whose memory is no part of its states; have a pd drive follow a course"
        raise InvalidParameterError(place, "scenario", rule, said=", ".join(scenario.controllers))


# What is looked for, by the kind of an event's table.
_CONDITIONS: Mapping[str, Callable[[Any], Condition]] = {
    "angle": lambda table: Angle(table.joint, table.value),
    "rate": lambda table: Rate(table.joint, table.value),
    "time": lambda table: Time(*table.time),
    "gap": lambda table: Gap(table.contact, table.value),
    "force": lambda table: Force(table.contact, table.value),
    "change": lambda table: (
        ElementChange(table.of, table.change, table.side) if _is_element(table) else _of_contact(table)
    ),
}
# Of a contact, by the way of its gap through zero.
_OF_CONTACTS = {"touch": "falling", "lift-off": "rising"}


def _is_element(table: Any) -> bool:
    return table.of.partition(".")[0] in FAMILIES


def _of_contact(table: Any) -> Gap:
    """Return the condition of an event on a change of a contact: its gap passes zero."""
    if table.change not in _OF_CONTACTS:
        raise UnknownNameError("events", f"change of contact {table.of}", table.change, _OF_CONTACTS)
    if table.side is not None:
        raise InvalidParameterError("events", "side", "left out for a contact", table.side)
    return Gap(table.of, 0.0)


def _direction(table: Any) -> str:
    if table.kind == "change" and not _is_element(table):
        return _OF_CONTACTS.get(table.change, "both")
    return str(getattr(table, "direction", "both"))


def _actions(scenario: Scenario, name: str) -> Action | tuple[Mark | Stop | Set, ...]:
    found: list[Mark | Stop | Set] = []
    for one in scenario.events[name].actions:
        if one == "set":
            found += [Set(place, number) for place, number in scenario.to_set(name).items()]
        else:
            found.append(Stop() if one == "stop" else Mark())
    return found[0] if len(found) == 1 else tuple(found)
