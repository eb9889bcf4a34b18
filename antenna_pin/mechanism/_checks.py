"""The mechanics of a URDF: is it one tree of bodies that can exist?"""

from __future__ import annotations

from collections.abc import Collection

from antenna_pin.errors import MechanismError, UnknownNameError
from antenna_pin.mechanism import _inertia
from antenna_pin.mechanism._robot import Robot


def check(robot: Robot, where: str, allow_impossible_inertia: Collection[str]) -> None:
    """Refuse what is not a mechanism.

    Args:
        robot: Its links and joints.
        where: Name of the file, for messages.
        allow_impossible_inertia: Links whose body's inertia may break the triangle rule.
    """
    links = [link.name for link in robot.links]
    for name in allow_impossible_inertia:
        if name not in links:
            raise UnknownNameError(f"{where}: allow_impossible_inertia", "link", name, links)
    _check_tree(robot, where)
    _check_mimics(robot, where)
    _inertia.check_masses(robot, where)


def root_link(robot: Robot) -> str:
    """Return the name of the link that is nobody's child."""
    children = {joint.child for joint in robot.joints}
    return next(str(link.name) for link in robot.links if link.name not in children)


def _check_tree(robot: Robot, where: str) -> None:
    links = [link.name for link in robot.links]
    mover: dict[str, str] = {}
    for joint in robot.joints:
        for end, name in (("parent", joint.parent), ("child", joint.child)):
            if name not in links:
                raise UnknownNameError(f"{where}: {end} of joint {joint.name!r}", "link", name, links)
        if joint.child in mover:
            raise MechanismError(
                f"{where}: link {joint.child!r} must be the child of one joint, "
                f"got {mover[joint.child]!r} and {joint.name!r}; a URDF is a tree, cut the loop"
            )
        mover[joint.child] = joint.name
    roots = [name for name in links if name not in mover]
    if len(roots) > 1:
        raise MechanismError(
            f"{where}: exactly one link must be nobody's child, got {', '.join(roots)}; join them by joints"
        )
    reached = roots[:]
    for name in reached:  # grows while it is walked
        reached.extend(joint.child for joint in robot.joints if joint.parent == name)
    looped = [name for name in links if name not in reached]
    if looped:
        raise MechanismError(
            f"{where}: links {', '.join(looped)} hang in a loop of joints that no root carries; "
            "a URDF is a tree, cut the loop"
        )


def _check_mimics(robot: Robot, where: str) -> None:
    joints = [joint.name for joint in robot.joints]
    for joint in robot.joints:
        if joint.mimic is not None and joint.mimic.joint not in joints:
            raise UnknownNameError(
                f"{where}: <mimic> of joint {joint.name!r}", "joint", str(joint.mimic.joint), joints
            )
