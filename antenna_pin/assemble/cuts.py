"""Where else a loop could be cut, for a joint with play that stands among the closures."""

from __future__ import annotations

from antenna_pin.assemble.places import where
from antenna_pin.errors import ScenarioError
from antenna_pin.mechanism import WrittenUrdf
from antenna_pin.scenario import AnchorSpec, ElementSpec, JointsSpec, Scenario
from antenna_pin.scenario.clearance import TouchingSpec

__all__ = ["check_not_closures"]


def check_not_closures(scenario: Scenario, urdf: WrittenUrdf) -> None:
    """Refuse play at a closure: a joint with play is one of the tree, and another joint must close its loop.

    Raises:
        ScenarioError: It says which joints of the tree could close the loop instead.
    """
    for name in scenario.clearance:
        if name in scenario.closures and name not in urdf.joints:
            raise ScenarioError(
                f"{where(scenario, 'clearance', name)}: must be a joint of the tree, got a closure; "
                f"{_way_out(scenario, urdf, name)}"
            )


def _way_out(scenario: Scenario, urdf: WrittenUrdf, name: str) -> str:
    types = {joint: one.type for joint, one in urdf.joints.items()}
    loop = [joint for joint in _loop(scenario, urdf, name) if types[joint] != "fixed"]
    ideal = [joint for joint in loop if not isinstance(scenario.clearance.get(joint), TouchingSpec)]
    if not ideal:
        which = f" ({_or(loop)})" if loop else ""
        return f"nothing is left to cut: give one joint of the loop no play{which}"
    elements = [one for named in scenario.families.values() for one in named.values()]
    acting = {one.joint for one in elements if isinstance(one, ElementSpec)}
    acting |= {end for one in elements if isinstance(one, JointsSpec) for end in (one.input, one.output)}
    free = [joint for joint in ideal if joint not in acting]
    if not free:
        return (
            f"all joints of its loop without play ({', '.join(ideal)}) have drives or springs, which act at "
            "joints of the tree: take them off one of these to cut the loop there"
        )
    return f"cut the loop at {_or(free)} instead, so that {name} can be a joint of the URDF"


def _or(names: list[str]) -> str:
    *others, last = names
    return f"{', '.join(others)} or {last}" if others else last


def _loop(scenario: Scenario, urdf: WrittenUrdf, name: str) -> list[str]:
    """Return the joints of the tree between the two sides of a closure."""
    closure = scenario.closures[name]
    first, second = (_path(urdf, _link(urdf, side)) for side in (closure.first, closure.second))
    return [joint for joint in (*first, *second) if (joint in first) != (joint in second)]


def _link(urdf: WrittenUrdf, side: AnchorSpec) -> str:
    if side.link is not None:
        return side.link
    assert side.frame is not None
    children = {joint: one.child for joint, one in urdf.joints.items()}
    return children.get(side.frame, side.frame)


def _path(urdf: WrittenUrdf, link: str) -> list[str]:
    """Return the joints from a link to the root; none from the world."""
    above = {one.child: (joint, one.parent) for joint, one in urdf.joints.items()}
    found = []
    while link in above:
        joint, link = above[link]
        found.append(joint)
    return found
