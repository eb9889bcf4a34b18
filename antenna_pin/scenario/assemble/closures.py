"""Closures of a scenario."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from antenna_pin.dynamics.constraints import CLOSURES, OPPOSITE, Anchor, Closure
from antenna_pin.errors import ScenarioError
from antenna_pin.mechanism import WORLD, Mechanism, link_poses, rotation
from antenna_pin.scenario import AnchorSpec, LinkPlaceSpec, Scenario
from antenna_pin.scenario.assemble.initial import given_state
from antenna_pin.scenario.assemble.places import check_known, where

_Z = (0.0, 0.0, 1.0)


def closures_of(scenario: Scenario, mechanism: Mechanism) -> dict[str, Closure]:
    """Return the closures of a scenario by name.

    The axis of a hinge, a slide, a plane is a line, and no arrow: where the two sides' point opposite ways in
    the pose that the search for a start begins in, the second is taken the other way, as if it had been
    written so. Forces are in the axes of the first, and stay as they are.

    Raises:
        ScenarioError: A link or frame that there is not, or a name that a joint has.
    """
    joints = {joint.name for joint in mechanism.urdf.robot.joints}
    found = {}
    for name, spec in scenario.closures.items():
        if name in joints:
            raise ScenarioError(
                f"{where(scenario, 'closures', name)}: must have another name; the URDF has a joint {name!r}"
            )
        found[name] = Closure(
            kind=spec.kind,
            first=_anchor(scenario, mechanism, name, "first", spec.first),
            second=_anchor(scenario, mechanism, name, "second", spec.second),
        )
    opposite = _opposite(scenario, mechanism, found)
    return {
        name: replace(
            closure,
            second=_anchor(scenario, mechanism, name, "second", scenario.closures[name].second, -1.0),
        )
        if name in opposite
        else closure
        for name, closure in found.items()
    }


def _anchor(
    scenario: Scenario, mechanism: Mechanism, name: str, side: str, spec: AnchorSpec, sign: float = 1.0
) -> Anchor:
    link, axis = link_of(scenario, mechanism, spec, "closures", name, side)
    x, y, z = spec.axis or axis
    return Anchor.at(link, spec.point or (0.0, 0.0, 0.0), (sign * x, sign * y, sign * z), spec.across)


def _opposite(scenario: Scenario, mechanism: Mechanism, closures: dict[str, Closure]) -> list[str]:
    """Return the closures whose axes are antiparallel in the first guess."""
    lines = {name: one for name, one in closures.items() if CLOSURES[one.kind].axis and not one.holds.square}
    if not lines:
        return []
    links = [side.link for one in lines.values() for side in (one.first, one.second) if side.link != WORLD]
    names = list(dict.fromkeys(links))
    _, attitudes = link_poses(mechanism, given_state(scenario, mechanism)[0][np.newaxis], names)
    turns = {name: rotation(attitude) for name, attitude in zip(names, attitudes[0], strict=True)} | {
        WORLD: np.eye(3)
    }

    def axis(side: Anchor) -> np.ndarray:
        return np.asarray(turns[side.link] @ side.rotation[:, 2])

    return [
        name for name, one in lines.items() if float(axis(one.first) @ axis(one.second)) < np.cos(OPPOSITE)
    ]


def reversed_axes(scenario: Scenario, mechanism: Mechanism, closures: Mapping[str, Closure]) -> list[str]:
    """Return the closures of a scenario's system whose second axis is reversed."""
    return [
        name
        for name, spec in scenario.closures.items()
        if float(
            closures[name].second.rotation[:, 2]
            @ _anchor(scenario, mechanism, name, "second", spec.second).rotation[:, 2]
        )
        < 0.0
    ]


def link_of(
    scenario: Scenario, mechanism: Mechanism, spec: LinkPlaceSpec, *place: str
) -> tuple[str, tuple[float, float, float]]:
    """Return the link of a place or frame, and the frame's axis, z by default."""
    urdf = mechanism.urdf
    links = [link.name for link in urdf.robot.links]
    if spec.link is not None:
        check_known(scenario, [spec.link], "link", dict.fromkeys([*links, WORLD]), *place, "link")
        return spec.link, _Z
    assert spec.frame is not None
    joints = {joint.name: joint for joint in urdf.robot.joints}
    check_known(scenario, [spec.frame], "frame", [*links, *joints], *place, "frame")
    if spec.frame in links:
        return spec.frame, _Z
    joint = joints[spec.frame]
    if joint.type in ("fixed", "floating"):
        return joint.child, _Z
    x, y, z = map(float, urdf.axis(spec.frame))
    return joint.child, (x, y, z)
