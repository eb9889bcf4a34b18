"""The mechanics of a URDF: is it one tree of bodies that can exist?"""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np

from antenna_pin.errors import MechanismError, UnknownNameError

# Moments are decimal numbers; a flat plate obeys the triangle rule with equality, up to their round-off.
_TRIANGLE_ROUND_OFF = 1e-9

# Joints whose massless link has its motion decided by what it carries.
_ONE_AXIS = ("revolute", "continuous", "prismatic")


def check(robot: Any, where: str, allow_impossible_inertia: Collection[str]) -> None:
    """Refuse what is not a mechanism.

    Args:
        robot: What yourdfpy read, a ``yourdfpy.Robot``.
        where: Name of the file, for messages.
        allow_impossible_inertia: Links whose inertia may break the triangle rule.
    """
    links = [link.name for link in robot.links]
    for name in allow_impossible_inertia:
        if name not in links:
            raise UnknownNameError(f"{where}: allow_impossible_inertia", "link", name, links)
    _check_tree(robot, where)
    for joint in robot.joints:
        _check_planar(joint, where)
    for link in robot.links:
        if link.inertial is not None:
            _check_inertial(link, where, link.name in allow_impossible_inertia)
    groups = rigid_groups(robot)
    for first, group in groups.items():
        if first == root_link(robot) or any(link.inertial is not None for link in group):
            continue
        mover = next(joint for joint in robot.joints if joint.child == first)
        if mover.type not in _ONE_AXIS or not _carries_mass(robot, groups, group):
            raise MechanismError(
                f"{where}: link {first!r} is moved by joint {mover.name!r} and must have an <inertial>, got "
                "none; a link may go without if it is fixed to one that has it, or if a hinge or a slide "
                "moves it and it carries one by a moving joint, as the cross of a universal joint"
            )


def root_link(robot: Any) -> str:
    """Return the name of the link that is nobody's child."""
    children = {joint.child for joint in robot.joints}
    return next(str(link.name) for link in robot.links if link.name not in children)


def rigid_groups(robot: Any) -> dict[str, list[Any]]:
    """Return the links that fixed joints make one body, by the first link of each.

    The first link is the root or one that a moving joint moves; from it outwards, in the file's order.
    """
    links = {link.name: link for link in robot.links}
    fixed: dict[str, list[str]] = {}
    for joint in robot.joints:
        if joint.type == "fixed":
            fixed.setdefault(joint.parent, []).append(joint.child)
    groups: dict[str, list[Any]] = {}
    for first in (root_link(robot), *(joint.child for joint in robot.joints if joint.type != "fixed")):
        names = [first]
        for name in names:  # grows while it is walked: breadth first
            names.extend(fixed.get(name, ()))
        groups[first] = [links[name] for name in names]
    return groups


def _carries_mass(robot: Any, groups: dict[str, list[Any]], group: list[Any]) -> bool:
    """Whether a link with mass hangs on a massless body by moving joints."""
    names = {link.name for link in group}
    carried = (groups[j.child] for j in robot.joints if j.parent in names and j.child in groups)
    return any(
        any(link.inertial is not None for link in body) or _carries_mass(robot, groups, body)
        for body in carried
    )


def _check_tree(robot: Any, where: str) -> None:
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


def _check_planar(joint: Any, where: str) -> None:
    """Pinocchio takes ``z`` of the joint frame as the normal, whatever the axis says."""
    if joint.type == "planar" and (np.any(joint.axis[:2] != 0.0) or joint.axis[2] <= 0.0):
        raise MechanismError(
            f"{where}: joint {joint.name!r} is planar and its axis must be 0 0 1, got "
            f"{' '.join(f'{a:g}' for a in joint.axis)}; turn its frame, or write it as 'continuous' and "
            "make it planar by a variant, which turns the frame"
        )


def _check_inertial(link: Any, where: str, allow_impossible: bool) -> None:
    mass = link.inertial.mass
    if not mass > 0.0:
        raise MechanismError(
            f"{where}: link {link.name!r}: mass must be positive, got {mass:g} kg; "
            "a mere frame has no <inertial> and is fixed to a link that has"
        )
    low, middle, high = (float(moment) for moment in np.linalg.eigvalsh(link.inertial.inertia))
    moments = f"{low:.6g}, {middle:.6g}, {high:.6g} kg m^2"
    if not low > 0.0:
        raise MechanismError(
            f"{where}: link {link.name!r}: principal moments of inertia must be positive, got {moments}"
        )
    excess = high - (low + middle)
    if excess > _TRIANGLE_ROUND_OFF * high and not allow_impossible:
        raise MechanismError(
            f"{where}: link {link.name!r}: the largest principal moment of inertia must not exceed the "
            f"sum of the other two, got {moments}: too large by {excess:.6g}; correct it, or name the link "
            "in allow_impossible_inertia"
        )
