"""Joints with clearance in words; those of a kind are its own (:class:`antenna_pin.geometry.Look`)."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from antenna_pin.base.readable import GIVEN, readable
from antenna_pin.geometry import LOOKS
from antenna_pin.report._runs import ReportedRun
from antenna_pin.scenario import ClearanceSpec, Scenario, TouchingSpec

__all__ = ["how_held", "words_of_carried_clearances", "words_of_clearances"]


#: What is said of a joint that a scenario's table ``[clearance]`` describes, and that has no play.
_WITHOUT_PLAY = {"constraint": "without play, held by constraint", "ideal": "without play"}


def how_held(spec: ClearanceSpec) -> str:
    """Return what holds a joint together."""
    return LOOKS[spec.kind].held if isinstance(spec, TouchingSpec) else _WITHOUT_PLAY[spec.model]


def words_of_clearances(scenario: Scenario) -> Iterator[tuple[str, str]]:
    """Yield each joint with play, with its dimensions and how its contacts are found."""
    for name, spec in scenario.clearance.items():
        if not isinstance(spec, TouchingSpec):
            continue
        parts = LOOKS[spec.kind].dimensions(spec.sizes())
        if spec.offset:
            parts.append(f"{readable(spec.offset, 'm', GIVEN)} along the axis from the joint's origin")
        if spec.bearing_on == "child":
            parts.append("the bearing is on the joint's child")
        gaps = "coal's distance queries" if spec.geometry == "coal" else "the closed form"
        parts.append(f"gaps by {gaps}")
        if spec.load == "distributed":
            parts.append(
                f"load spread over {spec.strips} strips of the bore and {spec.sectors} sectors of each flange"
            )
        else:
            parts.append("one force at each contact")
        yield name, "; ".join(parts)


#: Of dimensions that are no lengths.
_UNITS = {"roll": "rad"}


def words_of_carried_clearances(run: ReportedRun) -> Iterator[tuple[str, str]]:
    """Yield what the result of a system built in Python tells of its clearance joints."""
    places: dict[str, Any] = json.loads(run.data.attrs.get("clearance_joints", "{}"))
    for name, place in places.items():
        given = ", ".join(
            f"{key.replace('_', ' ')} {readable(value, _UNITS.get(key, 'm'), GIVEN)}"
            for key, value in place["dimensions"].items()
            if isinstance(value, float)
        )
        yield name, f"{place['kind']}, {place['journal_body']} in {place['bearing_body']}; {given}"
