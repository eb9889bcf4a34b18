"""Events of a run from a scenario's tables."""

from __future__ import annotations

from typing import Literal

from antenna_pin.scenario import AngleEvent, EventSpec, ForceEvent, GapEvent, RateEvent, Scenario
from antenna_pin.simulation.events import (
    Action,
    Angle,
    Condition,
    Event,
    Force,
    Gap,
    Mark,
    Rate,
    Set,
    Stop,
    Time,
)

__all__ = ["events_of"]

_DIRECTIONS: dict[str, Literal[-1, 0, 1]] = {"both": 0, "rising": 1, "falling": -1}


def events_of(scenario: Scenario) -> tuple[Event, ...]:
    """Return the events that a scenario looks for."""
    return tuple(
        Event(
            name=name,
            when=_condition(table),
            direction=_DIRECTIONS[getattr(table, "direction", "both")],
            action=_action(scenario, name),
            after=table.after,
        )
        for name, table in scenario.events.items()
    )


def _condition(table: EventSpec) -> Condition:
    if isinstance(table, AngleEvent):
        return Angle(table.joint, table.value)
    if isinstance(table, RateEvent):
        return Rate(table.joint, table.value)
    if isinstance(table, GapEvent):
        return Gap(table.contact, table.value)
    if isinstance(table, ForceEvent):
        return Force(table.contact, table.value)
    return Time(*table.time)


def _action(scenario: Scenario, name: str) -> Action:
    table, number = scenario.events[name], scenario.to_set(name)
    if table.set is not None and number is not None:
        return Set(table.set, number)
    return Stop() if table.action == "stop" else Mark()
