"""Joints with clearance in words: one entry for each kind."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

from antenna_pin.readable import GIVEN, readable
from antenna_pin.report._runs import ReportedRun
from antenna_pin.scenario import (
    ContactClearance,
    PlanarClearance,
    PrismaticClearance,
    Scenario,
    SphericalClearance,
)

__all__ = ["CLEARANCES", "words_of_carried_clearances", "words_of_clearances"]


class ClearanceWords(NamedTuple):
    """What is said of a kind of joint."""

    held: str  # what holds it together
    dimensions: Callable[[Any], list[str]] | None = None  # its parts, from its table of the scenario


def _length(value: float) -> str:
    return readable(value, "m", GIVEN)


def _radial(spec: ContactClearance | PlanarClearance | SphericalClearance, hole: str, pin: str) -> list[str]:
    inner = spec.bearing_radius - spec.radial_play
    return [
        f"radial clearance {_length(spec.radial_play)}: {hole} of radius {_length(spec.bearing_radius)}, "
        f"{pin} of {_length(inner)}"
    ]


def _bore(spec: PlanarClearance) -> list[str]:
    return _radial(spec, "bore", "journal")


def _socket(spec: SphericalClearance) -> list[str]:
    return _radial(spec, "socket", "ball")


def _flanged(spec: ContactClearance) -> list[str]:
    flanges = spec.bearing_length + 2.0 * spec.axial_play
    return [
        *_radial(spec, "bore", "journal"),
        f"axial clearance {_length(spec.axial_play)} at each flange: bearing "
        f"{_length(spec.bearing_length)} long, flanges {_length(flanges)} apart",
        f"bearing's outer radius {_length(spec.bearing_outer_radius)}, flanges' radius "
        f"{_length(spec.flange_radius)}",
    ]


def _guide(spec: PrismaticClearance) -> list[str]:
    size: Any = spec.shape()
    parts = [
        f"guide {_length(size.guide_width)} wide and {_length(size.guide_height)} high, slider "
        f"{_length(size.slider_width)} wide, {_length(size.slider_height)} high and "
        f"{_length(size.slider_length)} long",
        f"clearance {_length(0.5 * (size.guide_width - size.slider_width))} to each side along the width, "
        f"{_length(0.5 * (size.guide_height - size.slider_height))} along the height",
    ]
    if size.corner_radius:
        parts.append(f"slider's edges rounded by {_length(size.corner_radius)}")
    if size.roll:
        parts.append(f"section turned by {readable(size.roll, 'rad', GIVEN)} about the axis")
    return parts


#: What is said of each kind of joint that a scenario's table ``[clearance]`` names.
CLEARANCES: dict[str, ClearanceWords] = {
    "contact": ClearanceWords("a journal with flanges in a bore, held by contact alone", _flanged),
    "planar": ClearanceWords("a journal in a bore, held in the plane by contact alone", _bore),
    "spherical": ClearanceWords("a ball in a socket, held by contact alone", _socket),
    "prismatic": ClearanceWords("a rectangular slider in a guide, held by contact alone", _guide),
    "constraint": ClearanceWords("without play, held by constraint"),
    "ideal": ClearanceWords("without play"),
}


def words_of_clearances(scenario: Scenario) -> Iterator[tuple[str, str]]:
    """Yield each joint with play, with its dimensions and how its contacts are found."""
    for name, spec in scenario.clearance.items():
        dimensions = CLEARANCES[spec.model].dimensions
        if dimensions is None:
            continue
        parts = dimensions(spec)
        if spec.offset:
            parts.append(f"{_length(spec.offset)} along the axis from the joint's origin")
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
