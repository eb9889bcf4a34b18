"""What gears, belts and cables of a run did: touches of flanks, how long no side was in contact.

It is read from the run's changes of mode, whose instants are located; torques are those of samples.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from antenna_pin.trajectory.read import is_lean
from antenna_pin.trajectory.touches import Touch, elements_of, mode_changes, touches

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Span", "mesh_spans", "mesh_touches", "met_by_meshes"]

_BITS = {"plus": 1, "minus": 2}
_INTO, _OUT_OF = ("on", "taut"), ("off", "slack")


class Span(NamedTuple):
    """A time between two changes of what is in contact.

    Attributes:
        begin: [s].
        end: [s].
        plus: Whether the side of a positive deflection is in contact: a flank meshes, a strand is taut.
        minus: Likewise of a negative one.
    """

    begin: float
    end: float
    plus: bool
    minus: bool


def mesh_spans(data: xr.Dataset, place: str) -> list[Span]:
    """Return what is in contact of a gear, belt or cable, over the whole run.

    Args:
        data: Of a run.
        place: Of the element, as ``gears.drive``.

    Returns:
        One after the other; none of a run that is saved without samples, which tell how it began.
    """
    if is_lean(data) or "element_mode" not in data:
        return []
    bits = int(data["element_mode"].sel(element=place).values[0])
    found, begin = [], float(data["time"].values[0])
    for change in mode_changes(data, "gears"):
        if change.element != place:
            continue
        side, _, what = change.what.partition(": ")
        if what not in (*_INTO, *_OUT_OF):
            continue
        found.append(Span(begin, change.time, bool(bits & 1), bool(bits & 2)))
        begin = change.time
        bits = bits | _BITS[side] if what in _INTO else bits & ~_BITS[side]
    found.append(Span(begin, float(data.attrs["end_time"]), bool(bits & 1), bool(bits & 2)))
    return [one for one in found if one.end > one.begin]


def mesh_touches(data: xr.Dataset) -> list[Touch]:
    """Return the touches of gears, belts and cables in order of their onset; each has its place for a stop.

    Losses and impulses are known of touches of one side alone: where both strands were taut they are NaN.
    """
    return [
        replace(one, impulse=np.nan, loss=np.nan) if one.impulse == 0.0 else one
        for one in touches(data, "gears")
    ]


def met_by_meshes(data: xr.Dataset) -> dict[str, dict[str, Any]]:
    """Return what gears, belts and cables did, for a summary, by name."""
    found: dict[str, dict[str, Any]] = {}
    every = mesh_touches(data)
    for place, one in elements_of(data).items():
        if not place.startswith("gears."):
            continue
        slides, sides = one["slides"], [side for side in _BITS if side in one["numbers"]]
        peak = None
        if not is_lean(data) and "element_effort" in data:
            peak = float(np.abs(data["element_effort"].sel(element=place).values).max(initial=0.0))
        mine = [touch for touch in every if touch.stop == place]
        located = [touch.peak_effort for touch in mine if np.isfinite(touch.peak_effort)]
        if located:
            peak = max(*located, peak or 0.0)
        own: dict[str, Any] = {"peak_force" if slides else "peak_torque": peak}
        if sides:
            spans = mesh_spans(data, place)
            own |= {
                "touches": len(mine),
                "fastest_touch": max((touch.approach_rate for touch in mine), default=0.0),
                "largest_blow": max((t.impulse for t in mine if np.isfinite(t.impulse)), default=None),
                "time_apart": _time(spans, 1) if spans else None,
            }
            if one["kind"] in ("Belt", "Cable") and spans:
                own["time_slack"] = _time(spans, len(sides))
        own["element_loss"] = float(data["total_element_loss"].sel(element=place))
        found[place.partition(".")[2]] = own
    return found


def _time(spans: list[Span], sides: int) -> float:
    """Return how long fewer sides were in contact than so many [s]."""
    return float(sum(span.end - span.begin for span in spans if span.plus + span.minus < sides))
