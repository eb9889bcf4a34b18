"""The closures of a scenario."""

from __future__ import annotations

from antenna_pin.assemble.places import check_known, where
from antenna_pin.constraints import WORLD, Anchor, Closure
from antenna_pin.errors import ScenarioError
from antenna_pin.mechanism import Mechanism
from antenna_pin.scenario import AnchorSpec, Scenario

__all__ = ["closures_of"]


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
    urdf = mechanism.urdf
    links = [link.name for link in urdf.robot.links]
    axis = (0.0, 0.0, 1.0)
    if spec.link is not None:
        check_known(scenario, [spec.link], "link", [*links, WORLD], "closures", name, side, "link")
        link = spec.link
    else:
        assert spec.frame is not None
        joints = {joint.name: joint for joint in urdf.robot.joints}
        known = [*links, *joints]
        check_known(scenario, [spec.frame], "frame", known, "closures", name, side, "frame")
        link = spec.frame
        if spec.frame not in links:
            link = joints[spec.frame].child
            if joints[spec.frame].type not in ("fixed", "floating"):
                x, y, z = map(float, urdf.axis(spec.frame))
                axis = (x, y, z)
    return Anchor.at(link, spec.point or (0.0, 0.0, 0.0), spec.axis or axis, spec.across)
