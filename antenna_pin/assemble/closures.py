"""The closures of a scenario."""

from __future__ import annotations

from antenna_pin.assemble.places import check_known, where
from antenna_pin.constraints import WORLD, Anchor, Closure
from antenna_pin.errors import ScenarioError
from antenna_pin.mechanism import Mechanism
from antenna_pin.scenario import AnchorSpec, PlaceSpec, Scenario

__all__ = ["closures_of", "link_of"]

_Z = (0.0, 0.0, 1.0)


def closures_of(scenario: Scenario, mechanism: Mechanism) -> dict[str, Closure]:
    """Return the closures of a scenario by name.

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
    return found


def _anchor(scenario: Scenario, mechanism: Mechanism, name: str, side: str, spec: AnchorSpec) -> Anchor:
    link, axis = link_of(scenario, mechanism, spec, "closures", name, side)
    return Anchor.at(link, spec.point or (0.0, 0.0, 0.0), spec.axis or axis, spec.across)


def link_of(
    scenario: Scenario, mechanism: Mechanism, spec: PlaceSpec, *place: str
) -> tuple[str, tuple[float, float, float]]:
    """Return the link that a place or frame is on, and the frame's axis there, z if it has none of its own.

    Args:
        scenario: For the refusal of a name that there is not.
        mechanism: The mechanism.
        spec: The place.
        *place: Where in the scenario it stands.
    """
    urdf = mechanism.urdf
    links = [link.name for link in urdf.robot.links]
    if spec.link is not None:
        check_known(scenario, [spec.link], "link", [*links, WORLD], *place, "link")
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
