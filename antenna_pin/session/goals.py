"""Where a session is told to go: times and conditions as they are given, and whether it may go there."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

from antenna_pin.base.parameters import holds
from antenna_pin.base.units import quantity
from antenna_pin.dynamics import check_motions
from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.simulation import Event, Mark, Moment
from antenna_pin.simulation.first import check_spans
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.run import Ready

__all__ = ["looked_to", "seconds", "sought"]

_UNTIL = "until"  # what an event is called that a session goes to


def sought(goal: Event | Callable[[Moment], float]) -> Event:
    """Return the event that a session goes to: one, or a condition."""
    if isinstance(goal, Event):
        return dataclasses.replace(goal, name=f"{_UNTIL} {goal.name}", action=Mark())
    return Event(name=_UNTIL, when=goal)


def looked_to(ready: Ready, run: Run, end: float) -> float:
    """Refuse to go to a time at which an element or a motion knows nothing, or leaves its limits.

    Args:
        ready: What the run is made of.
        run: The run.
        end: The time [s].

    Returns:
        Up to when it may go at least [s]: far ahead, so that it is looked rarely.

    Raises:
        AntennaPinError: It may not go there.
    """
    for far in (end + (end - ready.begin), end):
        try:
            check_spans(ready.system, ready.begin, far)
            check_motions(ready.system, run.here, run.stepper.t, far)
        except AntennaPinError:
            if far == end:
                raise
        else:
            return far
    return end


def seconds(place: str, name: str, value: float | str) -> float:
    """Return a time that is given in seconds or as text with a unit, or refuse it."""
    seconds = quantity(value, "s", f"{place}: {name}") if isinstance(value, str) else value
    if not holds(seconds, "positive"):
        raise InvalidParameterError(place, name, "a positive time [s], or text with a unit", value)
    return float(seconds)
