"""XML of a URDF: well-formed text, the elements and attributes of the format, numbers.

Other parsers of URDFs forgive a default namespace, a prefix that nothing declares, two hyphens in a comment,
text before the XML declaration, and a version of XML that does not exist (PyBullet's 0.0). Each is mended in
the text, so that what is written can be read by any parser; lines keep their numbers. Names that the format
does not define belong to other tools and are ignored, but a name that is almost one of the format's own is
refused: ``<origin xzy="0 0 1"/>`` would be a joint at zero. Numbers of the mechanics are checked by
:func:`judge`, once all changes are made. Both come before any other reader sees the text: yourdfpy takes a
missing moment of inertia as 1 kg m^2 and merges repeated names, and Pinocchio's parser gives a link whose
inertial it cannot read a mass of zero.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from decimal import Decimal, InvalidOperation
from typing import Any, NamedTuple

from lxml import etree

from antenna_pin.base.parameters import LARGEST
from antenna_pin.base.readable import decimal_in
from antenna_pin.errors import MechanismError, nearest

# --- text ---------------------------------------------------------------------------------------------------

_COMMENT = re.compile(r"<!--(.*?)-->", re.DOTALL)
# Nothing is tried twice (*+): a text with many comments would take for ever.
_BEFORE_DECLARATION = re.compile(r"\A((?:\s++|<!--(?:(?!-->).)*+-->)*+)<\?xml\s[^>]*\?>", re.DOTALL)
_VERSION = re.compile(r"""\A(\s*<\?xml\s+version\s*=\s*)(?:"[^"]*"|'[^']*')""")
_PREFIX = re.compile(r"Namespace prefix (\S+) (?:on|for) ")
_XACRO = "http://www.ros.org/wiki/xacro"

# Mends of one text, each of which another can come up behind.
_MENDS = 8


def root_of(text: str, where: str) -> Any:
    """Return the root element of well-formed XML, by names without the root's own namespace."""
    text = text.removeprefix("\ufeff")
    early = _BEFORE_DECLARATION.match(text)
    if early and early[1]:
        text = early[1] + text[early.end() :]
    for _ in range(_MENDS):
        parser = _parser()
        try:
            return _without_namespace(_parsed(text, parser))
        except etree.XMLSyntaxError as error:
            mended = _mended(text, parser)
            if mended == text:
                what = re.sub(r",? *line \d+.*$", "", error.msg or "the document is empty").strip()
                raise MechanismError(
                    f"{where}, line {error.lineno or 1}: not well-formed XML: {what}"
                ) from None
            text = mended
    raise MechanismError(f"{where}, line 1: not well-formed XML: too many faults")


def parsed(text: str) -> Any:
    """Return the root element of a text by :func:`write`."""
    return _parsed(text, _parser())


def write(robot: Any) -> str:
    """Return the text of a URDF, comments included, one newline at its end."""
    tree = robot.getroottree()
    kinds = tree.docinfo.internalDTD
    if kinds is not None and not any(kinds.iterentities()):
        tree.docinfo.clear()  # a DOCTYPE that declares nothing
    text: str = etree.tostring(tree, encoding="unicode")
    return text.rstrip() + "\n"


def tag_of(element: Any) -> str:
    """Return the written name of an element, with its prefix."""
    name = etree.QName(element).localname
    return f"{element.prefix}:{name}" if element.prefix else str(name)


def name_of(element: Any, key: str) -> str:
    """Return the written name of an attribute, with its prefix."""
    name = etree.QName(key)
    prefix = next((one for one, space in element.nsmap.items() if space == name.namespace), None)
    return f"{prefix}:{name.localname}" if prefix else str(name.localname)


def is_xacro(element: Any) -> bool:
    """Return whether an element is one of xacro's."""
    return "xacro" in (etree.QName(element).namespace or "")


def _parser() -> Any:
    return etree.XMLParser(encoding="utf-8", resolve_entities=False, no_network=True)


def _parsed(text: str, parser: Any) -> Any:
    # What no file can hold, half a letter, makes it XML that is not well-formed.
    return etree.fromstring(text.encode("utf-8", "surrogatepass"), parser)


def _mended(text: str, parser: Any) -> str:
    """Return a text with the parser's faults mended where possible."""
    faults = {fault.type_name for fault in parser.error_log}
    if "ERR_UNKNOWN_VERSION" in faults:
        return _VERSION.sub(r'\1"1.0"', text)
    if "ERR_HYPHEN_IN_COMMENT" in faults:
        return _COMMENT.sub(lambda match: f"<!--{_without_hyphens(match[1])}-->", text)
    if faults == {"NS_ERR_UNDEFINED_NAMESPACE"}:
        prefixes = dict.fromkeys(
            match[1] for fault in parser.error_log if (match := _PREFIX.search(fault.message))
        )
        declared = "".join(
            f' xmlns:{prefix}="{_XACRO if prefix == "xacro" else f"undeclared:{prefix}"}"'
            for prefix in prefixes
        )
        bare = _COMMENT.sub(lambda match: " " * len(match[0]), text)  # a root in a comment is none
        start = re.search(r"<[A-Za-z_][^\s/>]*", bare)
        if declared and start:
            return text[: start.end()] + declared + text[start.end() :]
    return text


def _without_hyphens(comment: str) -> str:
    spaced = re.sub(r"-(?=-)", "- ", comment)
    return f"{spaced} " if spaced.endswith("-") else spaced


def _without_namespace(robot: Any) -> Any:
    """Take the namespace that the root itself is in off all names."""
    own = etree.QName(robot).namespace
    if own:
        for element in robot.iter(etree.Element):
            if etree.QName(element).namespace == own:
                element.tag = etree.QName(element).localname
        etree.cleanup_namespaces(robot, keep_ns_prefixes=[prefix for prefix in robot.nsmap if prefix])
    return robot


# --- elements and attributes of the format ------------------------------------------------------------------

# Tag of a shape -> its attributes: how many numbers each holds.
SHAPES: dict[str, dict[str, int]] = {
    "box": {"size": 3},
    "cylinder": {"radius": 1, "length": 1},
    "sphere": {"radius": 1},
    "mesh": {},
}

# URDF wants limits of hinges and slides. These are none: nothing gets there.
NO_LIMIT = {"lower": "-1e9", "upper": "1e9", "effort": "1e9", "velocity": "1e9"}

MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


class Defined(NamedTuple):
    """Content of an element."""

    children: tuple[str, ...] = ()
    attributes: tuple[str, ...] = ()


FORMAT = {
    "robot": Defined(("link", "joint", "material"), ("name", "version")),
    "link": Defined(("inertial", "visual", "collision"), ("name",)),
    "joint": Defined(
        ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic"),
        ("name", "type"),
    ),
    "inertial": Defined(("origin", "mass", "inertia")),
    "visual": Defined(("origin", "geometry", "material"), ("name",)),
    "collision": Defined(("origin", "geometry"), ("name",)),
    "geometry": Defined(tuple(SHAPES)),
    "material": Defined(("color", "texture"), ("name",)),
    "origin": Defined((), ("xyz", "rpy")),
    "mass": Defined((), ("value",)),
    "inertia": Defined((), MOMENTS),
    "parent": Defined((), ("link",)),
    "child": Defined((), ("link",)),
    "axis": Defined((), ("xyz",)),
    "limit": Defined((), ("lower", "upper", "effort", "velocity")),
    "dynamics": Defined((), ("damping", "friction")),
    "mimic": Defined((), ("joint", "multiplier", "offset")),
    **{shape: Defined((), tuple(numbers)) for shape, numbers in SHAPES.items()},
    "mesh": Defined((), ("filename", "scale")),
    "color": Defined((), ("rgba",)),
    "texture": Defined((), ("filename",)),
}

# Looks, in which a slip changes no mechanism: it is passed over like all that means nothing.
_LOOKS = ("material",)

# Letters by which a name may differ from one of the format and still be a slip of it. Four of five slips are
# one wrong, missing, added or swapped letter (Damerau (1964), Commun. ACM 7(3), 171-176), and most others are
# two. Names of other tools are farther off: of 400 files of 20 packages the nearest one, gear_velocity of
# <limit>, by five letters.
_SLIP = 2

# Names that have a meaning elsewhere and are near by chance: a safety controller's, SDF's, MJCF's, a motor's.
_NO_SLIPS = ("k_velocity", "axis2", "limited", "power")


def numbers_in(text: str | None) -> tuple[float, ...] | None:
    """Return the numbers of an attribute's text, or None where it holds something else."""
    numbers = [decimal_in(word, infinite=True) for word in (text or "").split()]
    known = tuple(number for number in numbers if number is not None)
    return known if len(known) == len(numbers) else None


# Numbers of a joint that a scenario may give in its file's place: how many, and whether they may be infinite.
_OF_JOINTS = {
    "origin": (3, False),
    "axis": (3, False),
    "limit": (1, True),
    "dynamics": (1, False),
}


def broken_numbers(robot: Any, where: str) -> tuple[str, ...]:
    """Return a message for each attribute of a joint without valid numbers.

    Where it acts it is refused; what is left has been given another value, or has no meaning for its joint.
    """
    return tuple(
        f"{placed(element, where)}: <{element.tag}> {name}={element.get(name)!r} is no number and does not "
        "count; mend it, or remove it"
        for joint in robot.findall("joint")
        for element in joint
        if element.tag in _OF_JOINTS
        for name in FORMAT[element.tag].attributes
        if element.get(name) is not None and not _is_sound(element.get(name), *_OF_JOINTS[element.tag])
    )


def _is_sound(text: str, count: int, infinite: bool) -> bool:
    numbers = numbers_in(text) or ()
    known = not any(math.isnan(one) or (math.isinf(one) and not infinite) for one in numbers)
    return known and len(numbers) == count


def half_unit(text: str | None) -> float:
    """Return half a unit of a number's last decimal; zero for whole and invalid numbers."""
    try:
        number = Decimal((text or "").strip())
        last = number.as_tuple().exponent
    except InvalidOperation:
        return 0.0
    return 0.5 * 10.0**last if number and isinstance(last, int) and last < 0 else 0.0


def placed(element: Any, where: str) -> str:
    """Return file, line and the link or joint that an element belongs to."""
    owner = next(
        (e for e in (element, *element.iterancestors()) if e.tag in ("link", "joint") and e.get("name")), None
    )
    name = "" if owner is None else f": {owner.tag} {owner.get('name')!r}"
    line = f", line {element.sourceline}" if element.sourceline else ""  # none of what a change has made
    return f"{where}{line}{name}"


def check_names(element: Any, where: str) -> None:
    """Refuse names that are almost those of the format at their place.

    An attribute that is written as an element counts too, and an element as an attribute, and text that
    stands for attributes. Names with a prefix are other tools'.
    """
    defined = FORMAT[element.tag]
    if not defined.children and (text := text_in(element)):
        raise MechanismError(
            f"{placed(element, where)}: <{element.tag}> must hold no text, got {text!r}; "
            f"write it as attributes ({', '.join(defined.attributes)})"
        )
    for name in element.attrib:
        guess = _meant(name, defined.attributes, element)
        if guess is not None and not _repeats(element, name, guess):
            raise MechanismError(
                f"{placed(element, where)}: attribute {name} of <{element.tag}> is unknown; "
                f"did you mean {_called(guess, defined)}?"
            )
    for child in element.iterchildren(etree.Element):
        guess = _meant(child.tag, defined.children, element)
        if guess is not None:
            raise MechanismError(
                f"{placed(child, where)}: <{tag_of(child)}> in <{element.tag}> is unknown; "
                f"did you mean {_called(guess, defined)}?"
            )
        if child.tag in defined.children and child.tag not in _LOOKS:
            check_names(child, where)


def _meant(name: str, known: tuple[str, ...], element: Any) -> str | None:
    """Return the format's name that an unknown name misspells, preferably a missing one."""
    if name in known or name in _NO_SLIPS or name.startswith("{"):
        return None
    children, attributes = FORMAT[element.tag]
    names = [one for one in (*children, *attributes) if one not in _LOOKS]
    missing = [one for one in names if one not in element.attrib and element.find(one) is None]
    return nearest(name, missing, _SLIP) or nearest(name, names, _SLIP)


def _called(name: str, defined: Defined) -> str:
    return f"<{name}>" if name in defined.children else f"the attribute {name}"


def _repeats(element: Any, name: str, meant: str) -> bool:
    """Return whether an attribute repeats the intended one, as iyx beside ixy."""
    numbers = numbers_in(element.get(name))
    return (
        meant != name
        and meant in element.attrib
        and numbers is not None
        and numbers == numbers_in(element.get(meant))
    )


def text_in(element: Any) -> str:
    """Return the text of an element without that of its children."""
    return " ".join([element.text or "", *(child.tail or "" for child in element)]).strip()


# --- syntax -------------------------------------------------------------------------------------------------

JOINT_TYPES = ("continuous", "fixed", "floating", "planar", "prismatic", "revolute")

# Joints that turn or slide about an axis of their own, and those with bounds.
WITH_AXIS = ("continuous", "prismatic", "revolute")

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
    "mujoco": "MJCF, MuJoCo's format; convert it to URDF, or use its original URDF",
    "mujocoinclude": "a part of an MJCF, MuJoCo's format; use its original URDF",
    "sdf": "SDF, Gazebo's format; convert it to URDF, or use its original URDF or xacro",
    "gazebo": "SDF, Gazebo's format; convert it to URDF, or use its original URDF or xacro",
    "COLLADA": "COLLADA, a mesh; name the URDF that names it",
    "launch": "a launch file of ROS; name the URDF that it loads",
}


def read(text: str, where: str) -> Any:
    """Return the root element of a URDF with a valid outline, or refuse the text."""
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
    """Refuse invalid numbers of the mechanics, and names reserved by Pinocchio."""
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
        _numbers(_child(inertial, "mass", where), "value", 1, where)
        inertia = _child(inertial, "inertia", where)
        for moment in MOMENTS:
            _numbers(inertia, moment, 1, where)
    for joint in robot.findall("joint"):
        _check_joint(joint, where)


def _refuse_xacro(robot: Any, where: str) -> None:
    """Refuse xacro macros in links and joints; other elements are skipped.

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
        first, *others = element.findall(tag) or [None]
        if others:
            raise MechanismError(
                f"{placed(others[0], where)}: <{element.tag}> must have one <{tag}>, got {len(others) + 1}, "
                f"the first in line {first.sourceline}; remove the others"
            )


def _check_own_names(robot: Any, where: str) -> None:
    """Refuse missing and repeated names of links and joints."""
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
                _numbers(mimic, name, 1, where)
    axis_of(joint, where)
    check_dynamics(joint, where)
    limit = joint.find("limit")
    if limit is not None:
        for name in ("lower", "upper"):
            if name in limit.attrib:
                _numbers(limit, name, 1, where, infinite=True)


def check_dynamics(joint: Any, where: str) -> None:
    """Refuse damping and friction of a joint that are no numbers, or below zero."""
    _refuse_repeated(joint, ("dynamics",), where)
    dynamics = joint.find("dynamics")
    if dynamics is not None:
        for name in ("damping", "friction"):
            if name in dynamics.attrib and _numbers(dynamics, name, 1, where)[0] < 0.0:
                raise MechanismError(
                    f"{placed(dynamics, where)}: <dynamics> {name} must be zero or more, "
                    f"got {dynamics.get(name)!r}"
                )


def axis_of(joint: Any, where: str) -> tuple[float, ...]:
    """Return the written axis of a joint (3,) [-], by default URDF's x."""
    _refuse_repeated(joint, ("axis",), where)
    axis = joint.find("axis")
    if axis is None:
        return 1.0, 0.0, 0.0
    numbers = _numbers(axis, "xyz", 3, where, any_size=True)
    if not any(numbers):
        raise MechanismError(f"{placed(axis, where)}: axis must be nonzero, got {axis.get('xyz')!r}")
    return numbers


def check_origin(element: Any, where: str) -> tuple[float, ...]:
    """Return roll, pitch, yaw of an element's origin [rad], zeros without one."""
    origin = element.find("origin")
    if origin is None:
        return 0.0, 0.0, 0.0
    found = [_numbers(origin, name, 3, where) if name in origin.attrib else () for name in ("xyz", "rpy")]
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
    count: int,
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
    numbers = numbers_in(text) or ()
    if len(numbers) != count or not all(
        math.isfinite(number) or (infinite and not math.isnan(number)) for number in numbers
    ):
        got = "none" if text is None else repr(text)
        raise MechanismError(
            f"{placed(element, where)}: <{element.tag}> {name} must be {count} finite number(s), got {got}"
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
