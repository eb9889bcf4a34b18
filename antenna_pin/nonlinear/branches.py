"""One value of a bifurcation diagram: what is asked there, and what is found, as plain data."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from antenna_pin.base.state import State
from antenna_pin.errors import AntennaPinError
from antenna_pin.nonlinear.carry import carried
from antenna_pin.nonlinear.returns import Returns
from antenna_pin.nonlinear.sections import settled_points
from antenna_pin.nonlinear.surfaces import Section
from antenna_pin.scenario import Scenario
from antenna_pin.simulation import Progress

__all__ = ["BRANCHES", "Asked", "Branch", "Entry", "make", "watching"]

Branch = Literal["fresh", "forward", "backward"]
"""How a value is come to: from the scenario's start, or from the end of the value before or after it."""

#: All of them.
BRANCHES: tuple[Branch, ...] = ("fresh", "forward", "backward")

Entry = dict[str, Any]
"""What is found at one value of one branch, as JSON takes it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """What is asked at every value.

    Attributes:
        scenario: What the parameter is laid over.
        parameter: Key of the scenario, with dots.
        section: Where the motion is looked at.
        quantities: What is noted there.
        count: Points kept [-].
        transient: Points cut before them; None to judge [-].
        most: Points after which to stop cutting; None for 20 times ``count`` [-].
        tolerance: See :func:`antenna_pin.nonlinear.poincare` [-].
    """

    scenario: Scenario
    parameter: str
    section: Section
    quantities: tuple[str, ...]
    count: int
    transient: int | None
    most: int | None
    tolerance: float

    def at(self, value: Any) -> Scenario:
        """Return the scenario with the parameter set to a value."""
        return self.scenario.with_overrides({self.parameter: value})


def make(
    asked: Asked,
    value: Any,
    start: State | None = None,
    period: float = math.nan,
    ending: threading.Event | None = None,
) -> Entry:
    """Return what is found at a value.

    Args:
        asked: What is asked.
        value: Of the parameter.
        start: State to carry over; the scenario's own start if left out.
        period: Of the stroboscope where that state comes from [s].
        ending: Ends the run when set, by KeyboardInterrupt.
    """
    entry: Entry = {"times": [], "values": [], "units": [], "titles": [], "settled": False, "drift": None}
    entry |= {"transient": 0, "period": None, "state": ""}
    try:
        returns = Returns(asked.at(value), asked.section, asked.quantities, progress=watching(ending))
        if start is not None:
            scale = returns.period / period if math.isfinite(period) else 1.0
            returns.state = carried(start, returns.system, scale=scale)
        found = settled_points(returns, asked.count, asked.transient, asked.most, asked.tolerance)
    except AntennaPinError as error:
        return entry | {"outcome": "REFUSED", "message": str(error)}
    except Exception as error:  # a bug must not end a diagram of hours
        return entry | {"outcome": "FAILED", "message": " ".join(f"{type(error).__name__}: {error}".split())}
    return entry | {
        "times": found.times.tolist(),
        "values": found.values.tolist(),
        "units": list(returns.units),
        "titles": list(returns.titles),
        "settled": found.settled,
        "drift": found.drift if math.isfinite(found.drift) else None,
        "transient": found.transient,
        "period": returns.period if math.isfinite(returns.period) else None,
        "outcome": found.outcome,
        "message": found.message,
        "state": "" if found.end is None or returns.ended else found.end.to_json(),
    }


def watching(ending: threading.Event | None) -> Callable[[Progress], None] | None:
    """Return what a run tells its progress to that ends it, by KeyboardInterrupt, once an event is set."""
    if ending is None:
        return None

    def look(_: Progress) -> None:
        if ending.is_set():
            raise KeyboardInterrupt

    return look
