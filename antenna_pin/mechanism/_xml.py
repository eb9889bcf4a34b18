"""The syntax of a URDF: is it one, and is each element complete and each number a number?

This comes before any other reader sees the text, because the readers are lenient in ways that change the
physics without a word: yourdfpy takes a missing moment of inertia as 1 kg m^2 and merges repeated names, and
Pinocchio's parser drops an inertial it cannot read (mass zero) and goes on.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from typing import Any

from lxml import etree

from antenna_pin.errors import MechanismError, nearest

JOINT_TYPES = ("continuous", "fixed", "floating", "planar", "prismatic", "revolute")

# Tag of a shape -> its attributes: how many numbers each holds.
SHAPES: dict[str, dict[str, int]] = {
    "box": {"size": 3},
    "cylinder": {"radius": 1, "length": 1},
    "sphere": {"radius": 1},
    "mesh": {},
}

_RESERVED = ("universe", "root_joint")

# Elements of which there may be one: of a second the readers take the first, the last or both.
_SINGLE = {
    "link": ("inertial",),
    "inertial": ("origin", "mass", "inertia"),
    "visual": ("origin", "geometry", "material"),
    "collision": ("origin", "geometry"),
    "joint": ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "calibration"),
    "material": ("color", "texture"),
}

# Letters of a name: it stands in messages, tables and the labels of a result.
_LONGEST_NAME = 200

# Numbers beyond that cannot be squared.
_LARGEST = 1e150

MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


def read(data: bytes, where: str, encoding: str | None = None) -> Any:
    """Return the root element of a URDF whose syntax is sound.

    Args:
        data: The file's bytes.
        where: Name of the file, for messages.
        encoding: What the bytes are in; None leaves it to the XML declaration.
    """
    try:
        robot = parsed(data, encoding)
    except etree.XMLSyntaxError as error:
        what = re.sub(r",? *line \d+.*$", "", error.msg or "the document is empty").strip()
        raise MechanismError(f"{where}, line {error.lineno or 1}: not well-formed XML: {what}") from None
    if etree.QName(robot).localname != "robot":
        raise MechanismError(f"{_at(robot, where)}: the root of a URDF must be <robot>, got <{robot.tag}>")
    _refuse_xacro(robot, where)
    _attribute(robot, "name", where)
    _refuse_repeated(robot, where)
    _check_names(robot, where)
    for link in robot.findall("link"):
        _check_link(link, where)
    for joint in robot.findall("joint"):
        _check_joint(joint, where)
    for material in robot.iter("material"):
        _attribute(material, "name", where)
    for color in robot.iter("color"):
        _numbers(color, "rgba", (4,), where, required=True)
    return robot


def parsed(data: bytes, encoding: str | None = None) -> Any:
    """Return the root element of an XML text, unchecked; one that was checked before."""
    return etree.fromstring(data, etree.XMLParser(encoding=encoding, resolve_entities=False, no_network=True))


def write(robot: Any) -> str:
    """Return the text of a URDF, comments included, one newline at its end."""
    text: str = etree.tostring(robot.getroottree(), encoding="unicode")
    return text.rstrip() + "\n"


def _at(element: Any, where: str) -> str:
    """Return file, line and the link or joint that an element belongs to."""
    owner = next(
        (e for e in (element, *element.iterancestors()) if e.tag in ("link", "joint") and e.get("name")), None
    )
    name = "" if owner is None else f": {owner.tag} {owner.get('name')!r}"
    return f"{where}, line {element.sourceline}{name}"


def _refuse_xacro(robot: Any, where: str) -> None:
    for element in robot.iter(etree.Element):
        if "xacro" in (etree.QName(element).namespace or ""):
            raise MechanismError(
                f"{_at(element, where)}: <{etree.QName(element).localname}> is a xacro macro, not URDF; "
                "expand it first: xacro in.xacro > out.urdf"
            )


def _refuse_repeated(robot: Any, where: str) -> None:
    for element in robot.iter(*_SINGLE):
        for tag in _SINGLE[element.tag]:
            found = element.findall(tag)
            if len(found) > 1:
                raise MechanismError(
                    f"{_at(found[1], where)}: <{element.tag}> must have one <{tag}>, got {len(found)}, the "
                    f"first in line {found[0].sourceline}; remove the others"
                )


def _check_names(robot: Any, where: str) -> None:
    """Names are present, unique and not those that Pinocchio gives to its own frames."""
    for kind in ("link", "joint", "material"):
        elements = robot.findall(kind)
        if kind == "link" and not elements:
            raise MechanismError(f"{_at(robot, where)}: a mechanism must have at least one <link>, got none")
        seen: dict[str, int] = {}
        for element in elements:
            name = _attribute(element, "name", where)
            if name in seen:
                raise MechanismError(
                    f"{where}, line {element.sourceline}: {kind} name {name!r} must be unique, "
                    f"first used in line {seen[name]}; rename one"
                )
            if name in _RESERVED and kind != "material":
                raise MechanismError(
                    f"{where}, line {element.sourceline}: {kind} name {name!r} is Pinocchio's own; rename it"
                )
            if len(name) > _LONGEST_NAME or not name.isprintable():
                got = f"{len(name)} letters" if len(name) > _LONGEST_NAME else repr(name)
                raise MechanismError(
                    f"{where}, line {element.sourceline}: {kind} name must be at most {_LONGEST_NAME} "
                    f"printable letters, got {got}; rename it"
                )
            seen[name] = element.sourceline


def _check_link(link: Any, where: str) -> None:
    for inertial in link.findall("inertial"):
        _check_origin(inertial, where)
        _numbers(_child(inertial, "mass", where), "value", (1,), where, required=True)
        inertia = _child(inertial, "inertia", where)
        for moment in MOMENTS:
            _numbers(inertia, moment, (1,), where, required=True)
    for shape in (*link.findall("visual"), *link.findall("collision")):
        _check_origin(shape, where)
        _check_geometry(_child(shape, "geometry", where), where)


def _check_geometry(geometry: Any, where: str) -> None:
    found = [child for child in geometry if isinstance(child.tag, str)]
    if len(found) != 1 or found[0].tag not in SHAPES:
        got = " and ".join(f"<{child.tag}>" for child in found) or "none"
        raise MechanismError(
            f"{_at(geometry, where)}: <geometry> must hold one of {', '.join(SHAPES)}, got {got}"
        )
    shape = found[0]
    for name, count in SHAPES[shape.tag].items():
        values = _numbers(shape, name, (count,), where, required=True)
        if not all(value > 0.0 for value in values):
            raise MechanismError(
                f"{_at(shape, where)}: <{shape.tag}> {name} must be positive, got {shape.get(name)!r}"
            )
    if shape.tag == "mesh":
        _attribute(shape, "filename", where)
        _numbers(shape, "scale", (1, 3), where)


def _check_joint(joint: Any, where: str) -> None:
    kind = _attribute(joint, "type", where)
    if kind not in JOINT_TYPES:
        guess = nearest(kind, JOINT_TYPES)
        hint = f"; did you mean {guess}?" if guess else ""
        raise MechanismError(
            f"{_at(joint, where)}: type must be one of {', '.join(JOINT_TYPES)}, got {kind!r}{hint}"
        )
    for end in ("parent", "child"):
        _attribute(_child(joint, end, where), "link", where)
    _check_origin(joint, where)
    mimic = joint.find("mimic")
    if mimic is not None:
        _attribute(mimic, "joint", where)
        for name in ("multiplier", "offset"):
            _numbers(mimic, name, (1,), where)
    axis = joint.find("axis")
    if axis is not None and not any(_numbers(axis, "xyz", (3,), where, required=True)):
        raise MechanismError(f"{_at(axis, where)}: axis must be nonzero, got {axis.get('xyz')!r}")
    dynamics = joint.find("dynamics")
    if dynamics is not None:
        for name in ("damping", "friction"):
            values = _numbers(dynamics, name, (1,), where)
            if any(value < 0.0 for value in values):
                raise MechanismError(
                    f"{_at(dynamics, where)}: <dynamics> {name} must be zero or more, "
                    f"got {dynamics.get(name)!r}"
                )
    _check_limit(joint, kind, where)


def _check_limit(joint: Any, kind: str, where: str) -> None:
    limit = joint.find("limit")
    if limit is not None:
        for name in ("lower", "upper"):
            _numbers(limit, name, (1,), where)
        for name in ("effort", "velocity"):
            if _numbers(limit, name, (1,), where, required=True)[0] < 0.0:
                got = limit.get(name)
                raise MechanismError(f"{_at(limit, where)}: <limit> {name} must not be negative, got {got!r}")
    elif kind in ("revolute", "prismatic"):
        way_out = "; a hinge without stops is type 'continuous'" if kind == "revolute" else ""
        raise MechanismError(f"{_at(joint, where)}: a {kind} joint must have a <limit>, got none{way_out}")


def _check_origin(element: Any, where: str) -> None:
    origin = element.find("origin")
    if origin is not None:
        for name in ("xyz", "rpy"):
            _numbers(origin, name, (3,), where)


def _child(element: Any, tag: str, where: str) -> Any:
    child = element.find(tag)
    if child is None:
        raise MechanismError(f"{_at(element, where)}: <{element.tag}> must have a <{tag}>, got none")
    return child


def _attribute(element: Any, name: str, where: str) -> str:
    value: str = element.get(name, "")
    if not value.strip():
        got = repr(value) if name in element.attrib else "none"
        raise MechanismError(f"{_at(element, where)}: <{element.tag}> must have a {name}, got {got}")
    return value


def _numbers(
    element: Any, name: str, counts: Iterable[int], where: str, *, required: bool = False
) -> tuple[float, ...]:
    """Return the finite numbers of an attribute; none of them where it is absent and need not be there."""
    text: str | None = element.get(name)
    if text is None and not required:
        return ()
    counts = tuple(counts)
    rule = f"<{element.tag}> {name} must be {' or '.join(str(c) for c in counts)} finite number(s)"
    try:
        # Python reads 1_000 and digits of other scripts; Pinocchio's parser does not.
        plain = (text or "").replace("_", "?").encode("ascii", "replace").decode()
        numbers = tuple(float(word) for word in plain.split())
    except ValueError:
        numbers = ()
    if len(numbers) not in counts or not all(math.isfinite(number) for number in numbers):
        got = "none" if text is None else repr(text)
        raise MechanismError(f"{_at(element, where)}: {rule}, got {got}")
    if any(abs(number) > _LARGEST for number in numbers):
        rule = f"<{element.tag}> {name} must be at most {_LARGEST:g} in size"
        got = repr(text)
        raise MechanismError(f"{_at(element, where)}: {rule}, got {got}")
    return numbers
