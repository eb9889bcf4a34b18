"""The syntax of a URDF: is it one, has each element what it needs, is each number a number?

Reading looks at what no change can mend: names, the format's and the file's own, parents, children.
:func:`judge` looks at the numbers of the mechanics, once all changes are made and what does not count is out
(``_plain.py``). Both come before any other reader sees the text, because the readers are lenient in ways that
change the physics without a word: yourdfpy takes a missing moment of inertia as 1 kg m^2 and merges repeated
names, and Pinocchio's parser drops an inertial it cannot read (mass zero) and goes on.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from lxml import etree

from antenna_pin.base.parameters import LARGEST
from antenna_pin.errors import MechanismError, nearest
from antenna_pin.mechanism._format import MOMENTS, check_names, numbers_in, placed
from antenna_pin.mechanism._source import is_xacro, root_of, tag_of

JOINT_TYPES = ("continuous", "fixed", "floating", "planar", "prismatic", "revolute")

_RESERVED = ("universe", "root_joint")

# Elements of which there may be one: of a second the readers take the first, the last or both.
_SINGLE = {
    "link": ("inertial",),
    "inertial": ("origin", "mass", "inertia"),
    "joint": ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic"),
}

# Letters of a name: it stands in messages, tables and the labels of a result.
_LONGEST_NAME = 200


# Elements of xacro that define something, and put nothing in their place.
_DEFINITIONS = ("arg", "macro", "property")
_EXPAND = "expand it first: xacro in.xacro > out.urdf"

# Roots of other formats, and of files that go with a URDF.
_OTHERS = {
    "mujoco": "MJCF, MuJoCo's format; convert it to URDF, or take the URDF that it was made from",
    "mujocoinclude": "a part of an MJCF, MuJoCo's format; take the URDF that it was made from",
    "sdf": "SDF, Gazebo's format; convert it to URDF, or take the URDF or xacro that it was made from",
    "gazebo": "SDF, Gazebo's format; convert it to URDF, or take the URDF or xacro that it was made from",
    "COLLADA": "COLLADA, a mesh; name the URDF that names it",
    "launch": "a launch file of ROS; name the URDF that it loads",
}


def read(text: str, where: str) -> Any:
    """Return the root element of a URDF whose outline is sound.

    Args:
        text: The XML.
        where: Name of the file, for messages.
    """
    if where.endswith(".xacro"):
        raise MechanismError(f"{where}: a xacro file is not URDF yet; {_EXPAND}")
    robot = root_of(text, where)
    if robot.tag != "robot":
        name = tag_of(robot)
        what = f": this is {_OTHERS[name]}" if name in _OTHERS else ""
        raise MechanismError(
            f"{placed(robot, where)}: the root of a URDF must be <robot>, got <{name}>{what}"
        )
    _refuse_xacro(robot, where)
    check_names(robot, where)
    _check_own_names(robot, where)
    for joint in robot.findall("joint"):
        for end in ("parent", "child"):
            _refuse_repeated(joint, (end,), where)
            _attribute(_child(joint, end, where), "link", where)
    return robot


def judge(robot: Any, where: str) -> None:
    """Refuse numbers that are none, where the mechanics needs them, and names that Pinocchio has itself.

    Args:
        robot: Root element, without what does not count.
        where: Name of the file, for messages.
    """
    for element in (*robot.findall("link"), *robot.findall("joint")):
        name = element.get("name")
        if name in _RESERVED and element.get("type") != "fixed":  # one that is fixed is a frame
            raise MechanismError(
                f"{where}, line {element.sourceline}: {element.tag} name {name!r} is Pinocchio's own; "
                "rename it"
            )
        _refuse_repeated(element, _SINGLE[element.tag], where)
    for inertial in robot.iterfind("link/inertial"):
        _refuse_repeated(inertial, _SINGLE["inertial"], where)
        check_origin(inertial, where)
        _numbers(_child(inertial, "mass", where), "value", (1,), where)
        inertia = _child(inertial, "inertia", where)
        for moment in MOMENTS:
            _numbers(inertia, moment, (1,), where)
    for joint in robot.findall("joint"):
        _check_joint(joint, where)


def _refuse_xacro(robot: Any, where: str) -> None:
    """Refuse macros among what is read; what stands in other elements is not looked at.

    Definitions that were left behind mean nothing: what used them is an expression or a macro's call.
    """
    for part in robot.iterchildren(etree.Element):
        for element in part.iter(etree.Element) if part.tag in ("link", "joint") else (part,):
            if is_xacro(element) and etree.QName(element).localname in _DEFINITIONS:
                continue
            if is_xacro(element) or element.tag in ("include", "macro"):
                name = etree.QName(element).localname
                raise MechanismError(
                    f"{placed(element, where)}: <{name}> is a xacro macro, not URDF; {_EXPAND}"
                )


def _refuse_repeated(element: Any, tags: Iterable[str], where: str) -> None:
    for tag in tags:
        found = element.findall(tag)
        if len(found) > 1:
            raise MechanismError(
                f"{placed(found[1], where)}: <{element.tag}> must have one <{tag}>, got {len(found)}, the "
                f"first in line {found[0].sourceline}; remove the others"
            )


def _check_own_names(robot: Any, where: str) -> None:
    """Names are present and unique."""
    for kind in ("link", "joint"):
        elements = robot.findall(kind)
        if kind == "link" and not elements:
            hint = ""
            if robot.find("group") is not None or robot.find("disable_collisions") is not None:
                hint = ": this is an SRDF of MoveIt, which goes with a URDF; name that"
            raise MechanismError(
                f"{placed(robot, where)}: a mechanism must have at least one <link>, got none{hint}"
            )
        seen: dict[str, int] = {}
        for element in elements:
            name = _attribute(element, "name", where)
            if name in seen:
                raise MechanismError(
                    f"{where}, line {element.sourceline}: {kind} name {name!r} must be unique, "
                    f"first used in line {seen[name]}; rename one"
                )
            if len(name) > _LONGEST_NAME or not name.isprintable():
                got = f"{len(name)} letters" if len(name) > _LONGEST_NAME else repr(name)
                raise MechanismError(
                    f"{where}, line {element.sourceline}: {kind} name must be at most {_LONGEST_NAME} "
                    f"printable letters, got {got}; rename it"
                )
            seen[name] = element.sourceline


def _check_joint(joint: Any, where: str) -> None:
    kind = _attribute(joint, "type", where)
    if kind not in JOINT_TYPES:
        guess = nearest(kind, JOINT_TYPES)
        hint = f"; did you mean {guess}?" if guess else ""
        raise MechanismError(
            f"{placed(joint, where)}: type must be one of {', '.join(JOINT_TYPES)}, got {kind!r}{hint}"
        )
    check_origin(joint, where)
    mimic = joint.find("mimic")
    if mimic is not None:
        _attribute(mimic, "joint", where)
        for name in ("multiplier", "offset"):
            if name in mimic.attrib:
                _numbers(mimic, name, (1,), where)
    axis_of(joint, where)
    check_dynamics(joint, where)
    limit = joint.find("limit")
    if limit is not None:
        for name in ("lower", "upper"):
            if name in limit.attrib:
                _numbers(limit, name, (1,), where, infinite=True)


def check_dynamics(joint: Any, where: str) -> None:
    """Refuse damping and friction of a joint that are no numbers, or below zero."""
    _refuse_repeated(joint, ("dynamics",), where)
    dynamics = joint.find("dynamics")
    if dynamics is not None:
        for name in ("damping", "friction"):
            if name in dynamics.attrib and _numbers(dynamics, name, (1,), where)[0] < 0.0:
                raise MechanismError(
                    f"{placed(dynamics, where)}: <dynamics> {name} must be zero or more, "
                    f"got {dynamics.get(name)!r}"
                )


def axis_of(joint: Any, where: str) -> tuple[float, ...]:
    """Return the axis of a joint as it is written, URDF's x where there is none (3,) [-].

    Raises:
        MechanismError: It is no direction.
    """
    _refuse_repeated(joint, ("axis",), where)
    axis = joint.find("axis")
    if axis is None:
        return 1.0, 0.0, 0.0
    numbers = _numbers(axis, "xyz", (3,), where, any_size=True)
    if not any(numbers):
        raise MechanismError(f"{placed(axis, where)}: axis must be nonzero, got {axis.get('xyz')!r}")
    return numbers


def check_origin(element: Any, where: str) -> tuple[float, ...]:
    """Return roll, pitch and yaw of an element's origin [rad], zeros where it has none.

    Raises:
        MechanismError: Its numbers are none.
    """
    origin = element.find("origin")
    if origin is None:
        return 0.0, 0.0, 0.0
    found = [_numbers(origin, name, (3,), where) if name in origin.attrib else () for name in ("xyz", "rpy")]
    return found[1] or (0.0, 0.0, 0.0)


def _child(element: Any, tag: str, where: str) -> Any:
    child = element.find(tag)
    if child is None:
        raise MechanismError(f"{placed(element, where)}: <{element.tag}> must have a <{tag}>, got none")
    return child


def _attribute(element: Any, name: str, where: str) -> str:
    value: str = element.get(name, "")
    if not value.strip():
        got = repr(value) if name in element.attrib else "none"
        raise MechanismError(f"{placed(element, where)}: <{element.tag}> must have a {name}, got {got}")
    _refuse_expression(element, value, where)
    return value


def _numbers(
    element: Any,
    name: str,
    counts: Iterable[int],
    where: str,
    *,
    infinite: bool = False,
    any_size: bool = False,
) -> tuple[float, ...]:
    """Return the finite numbers of an attribute, or infinite ones where they may be.

    The size of a direction does not count; what is something else must be such that it can be squared.
    """
    text: str | None = element.get(name)
    _refuse_expression(element, text or "", where)
    counts = tuple(counts)
    numbers = numbers_in(text) or ()
    if len(numbers) not in counts or not all(
        math.isfinite(number) or (infinite and not math.isnan(number)) for number in numbers
    ):
        got = "none" if text is None else repr(text)
        raise MechanismError(
            f"{placed(element, where)}: <{element.tag}> {name} must be {' or '.join(str(c) for c in counts)} "
            f"finite number(s), got {got}"
        )
    if not any_size and any(LARGEST < abs(number) < math.inf for number in numbers):
        raise MechanismError(
            f"{placed(element, where)}: <{element.tag}> {name} must be at most {LARGEST:g} in size, "
            f"got {text!r}"
        )
    return numbers


def _refuse_expression(element: Any, text: str, where: str) -> None:
    if "${" in text or "$(" in text:
        raise MechanismError(
            f"{placed(element, where)}: {text!r} is an expression of xacro, not URDF; {_EXPAND}"
        )
