"""End stops at the limits that the URDF has."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Mapping, Sequence, Set
from typing import Any
from xml.etree import ElementTree as ET

from antenna_pin.base.arguments import takes
from antenna_pin.base.parameters import NO_BOUND
from antenna_pin.scenario.merge import merge
from antenna_pin.scenario.shipped import tables
from antenna_pin.scenario.spec import read_quantity, refuse

#: Name of the table that stands for a stop at each joint with limits that has no stop of its own.
ALL = "*"
_SIDES = ("lower", "upper")
# Kinds of drives that prescribe their joint's motion.
_MOTIONS = ("motion", "distance")
_UNITS = {"revolute": "rad", "prismatic": "m"}


@takes()
def joint_limits(urdf: str, *, continuous: bool = False) -> dict[str, tuple[float, float]]:
    """Return lower and upper limits of a URDF's bounded joints, by name.

    There are none in a text that is no URDF: who needs the mechanism refuses it.

    Args:
        urdf: The text.
        continuous: Of continuous joints instead, which have no limits, what their ``<limit>`` states.
    """
    kinds = ("continuous",) if continuous else tuple(_UNITS)
    return {name: (lower, upper) for name, (kind, lower, upper) in _limits(urdf).items() if kind in kinds}


def _limits(urdf: str) -> dict[str, tuple[str, float, float]]:
    """Return type, lower and upper limit of joints with bounds."""
    found: dict[str, tuple[str, float, float]] = {}
    if "<limit" not in urdf or "<!DOCTYPE" in urdf:
        return found
    try:
        joints = ET.fromstring(urdf).findall("joint")  # noqa: S314 - entities need a DOCTYPE
    except ET.ParseError:
        return found
    for joint in joints:
        limit, kind = joint.find("limit"), str(joint.get("type"))
        if limit is not None and kind in (*_UNITS, "continuous"):
            with contextlib.suppress(ValueError):  # what is no number was refused before, or does not count
                bounds = (float(limit.get("lower", 0.0)), float(limit.get("upper", 0.0)))
                lower, upper = (
                    math.copysign(math.inf, one) if abs(one) > NO_BOUND else one for one in bounds
                )
                if lower < upper and not (math.isinf(lower) and math.isinf(upper)):
                    found[str(joint.get("name"))] = (kind, lower, upper)
    return found


def with_urdf_limits(data: Mapping[str, Any]) -> Any:
    """Return the table of stops, completed by the URDF's limits.

    A stop with neither ``lower`` nor ``upper`` gets both from the ``<limit>`` of its joint, as
    ``mechanism.joints`` changes it; the table ``[stops."*"]`` becomes a stop at each joint with limits that
    has none, and ``stops = true`` rigid stops there, of restitution 0; rigid ones at no joint that a motion
    moves, itself or by couplings.
    """
    stops = merge({}, {"stops": data.get("stops")})["stops"]
    known = isinstance(data.get("urdf_text"), str) and isinstance(data.get("mechanism"), Mapping)
    if not isinstance(stops, Mapping) or not known:
        return stops
    open_ = [
        name
        for name, table in stops.items()
        if isinstance(table, Mapping) and table.keys().isdisjoint(_SIDES)
    ]
    if not open_ and ALL not in stops:
        return stops
    limits = _changed(data)
    done: dict[str, Any] = {}
    for name, table in stops.items():
        if name == ALL:
            around = list(joint_limits(data["urdf_text"], continuous=True))
            done |= _everywhere(stops, limits, moved_joints(data), around)
        elif name in open_:
            done[name] = {**table, **limits.get(str(table.get("joint", name)), {})}
        else:
            done[name] = table
    return done


def _changed(data: Mapping[str, Any]) -> dict[str, dict[str, float]]:
    """Return the limits of the joints by name, the scenario's changes of the URDF made."""
    changes = tables(tables(data.get("mechanism")).get("joints"))
    found = {}
    for name, (kind, *limits) in _limits(data["urdf_text"]).items():
        if kind not in _UNITS:
            continue
        own = dict(zip(_SIDES, limits, strict=True))
        for side in _SIDES:
            given = tables(changes.get(name)).get(side)
            if given is not None:
                own[side] = read_quantity(given, _UNITS[kind], "", "mechanism", "joints", name, side)
        found[name] = own
    return found


@takes()
def moved_joints(data: Mapping[str, Any]) -> set[str]:
    """Return the joints that motions move, directly or by couplings."""
    found = {
        str(drive.get("joint", name))
        for name, one in tables(data.get("drives")).items()
        if (drive := tables(one)).get("kind") in _MOTIONS
    }
    couplings = [(name, tables(one)) for name, one in tables(data.get("couplings")).items()]
    for _ in couplings:  # each may follow one that follows another
        found |= {
            str(coupling.get("follower", name))
            for name, coupling in couplings
            if coupling.get("leader") in found and coupling.get("second", coupling["leader"]) in found
        }
    return found


def _everywhere(
    stops: Mapping[str, Any],
    limits: Mapping[str, Mapping[str, float]],
    moved: Set[str],
    around: Sequence[str],
) -> dict[str, Any]:
    """Return the stops of the table for all joints, not at moved joints if rigid."""
    table = stops[ALL]
    if not isinstance(table, Mapping):
        refuse("must be a table", "stops", ALL, value=table)
    for key in ("joint", *_SIDES):
        if key in table:
            refuse(
                "must be left out: stops = true adds one at the limits of each joint in the URDF",
                "stops",
                ALL,
                key,
            )
    if not limits:
        said = "no joint of the URDF has a <limit> with bounds"
        if around:
            said += f"; continuous joints have none, even if the file gives them: {', '.join(around)}"
            said += "; give each a stop, or make them revolute in the URDF"
        refuse(f"must stand for a joint, but {said}", "stops", ALL)
    taken = {str(tables(one).get("joint", name)) for name, one in stops.items() if name != ALL} | stops.keys()
    taken |= moved if table.get("kind") == "rigid" else set()
    return {joint: {**table, **own} for joint, own in limits.items() if joint not in taken}
