"""Reading of a URDF: removal of parts without mechanical meaning, checks of numbers and tree."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from lxml import etree

from antenna_pin.base.directions import unit
from antenna_pin.base.files import decoded
from antenna_pin.base.parameters import LARGEST, NO_BOUND
from antenna_pin.errors import MechanismError, UnknownNameError
from antenna_pin.mechanism import edits, urdf_xml
from antenna_pin.mechanism.inertia import check_masses
from antenna_pin.mechanism.robot import Robot, robot_of
from antenna_pin.mechanism.urdf_xml import (
    FORMAT,
    MOMENTS,
    NO_LIMIT,
    SHAPES,
    half_unit,
    name_of,
    numbers_in,
    tag_of,
    text_in,
)

# --- mechanics and visuals ----------------------------------------------------------------------------------
#
# The readers behind (yourdfpy, and Pinocchio's parser with urdfdom) judge more than they need: colours,
# the axis of a joint that has none, a mesh's name. They get a text of what counts alone.

_SHAPES = ("visual", "collision")

_BOUNDED = ("prismatic", "revolute")


@dataclass(frozen=True, slots=True)
class Findings:
    """Parts of a URDF left out when it was read.

    Attributes:
        passed_over: Lines of what means nothing to the mechanics, by what it is.
        unbounded: Revolute and prismatic joints whose ``<limit>`` leaves them no bounds, or that have none.
        rounding: By link, by how much the rounding of its moments can break the triangle rule [kg m^2].
        points: Links with a mass and no ``<inertia>``, which are taken as points.
        unlimited: Continuous joints whose ``<limit>`` states bounds, and those.
        undrawn: Link of each visual shape that cannot be drawn, and why.
    """

    passed_over: dict[str, list[int]] = field(default_factory=dict)
    unbounded: list[str] = field(default_factory=list)
    rounding: dict[str, float] = field(default_factory=dict)
    points: list[str] = field(default_factory=list)
    unlimited: list[tuple[str, str]] = field(default_factory=list)
    undrawn: list[tuple[str, str]] = field(default_factory=list)

    def pass_over(self, what: str, element: Any) -> None:
        """Record an element without meaning, with its line."""
        self.passed_over.setdefault(what, []).append(int(element.sourceline or 0))


def clean(robot: Any, name: str) -> Findings:
    """Remove parts without mechanical meaning from a URDF, in place.

    Returns:
        What it was, and where.
    """
    findings = Findings()
    etree.strip_tags(robot, etree.Comment, etree.ProcessingInstruction, etree.Entity)
    if not robot.get("name", "").strip():
        robot.set("name", name)
        findings.pass_over("<robot> without a name", robot)
    robot.attrib.pop("version", None)
    for inertial in robot.iterfind("link/inertial"):
        _complete(inertial, findings)
    _keep_read(robot, findings)
    _clean_materials(robot, findings)
    for link in robot.findall("link"):
        for inertial in link.findall("inertial"):
            if _is_of_zeros(inertial):
                findings.pass_over("<inertial> of zeros", inertial)
                link.remove(inertial)
            for inertia in inertial.findall("inertia"):
                findings.rounding[str(link.get("name"))] = _rounding(inertia)
        for shape in (shape for tag in _SHAPES for shape in link.findall(tag)):
            _clean_shape(shape, str(link.get("name")), findings)
    for joint in robot.findall("joint"):
        _clean_joint(joint, findings)
    return findings


def for_pinocchio(robot: Any) -> str:
    """Return a cleaned URDF for Pinocchio's parser: bodies and joints, without looks or bounds."""
    bare = etree.Element("robot", name=robot.get("name"))
    for link in robot.findall("link"):
        copy = etree.SubElement(bare, "link", name=link.get("name"))
        for inertial in link.findall("inertial"):
            _copied(copy, inertial, "origin", "mass", "inertia")
    for joint in robot.findall("joint"):
        copy = _copied(bare, joint, "parent", "child", "origin", "axis")
        for axis in copy.findall("axis"):
            _make_moderate(axis)
        if joint.get("type") in _BOUNDED:
            etree.SubElement(copy, "limit", NO_LIMIT)  # without, the parser takes 0
    return str(etree.tostring(bare, encoding="unicode"))


def _make_moderate(axis: Any) -> None:
    """Make an axis one of length 1 if Pinocchio's parser cannot square it."""
    numbers = numbers_in(axis.get("xyz")) or (1.0,)
    if not 1e-100 < max(map(abs, numbers)) < 1e100:
        axis.set("xyz", " ".join(map(repr, unit(numbers).tolist())))


def _copied(parent: Any, element: Any, *children: str) -> Any:
    copy = etree.SubElement(parent, element.tag, dict(element.attrib))
    for tag in children:
        for child in element.findall(tag):
            words = child.attrib.items()
            if tag not in ("parent", "child"):  # numbers, between which urdfdom takes no tab
                words = [(key, " ".join(value.split())) for key, value in words]
            etree.SubElement(copy, tag, dict(words))
    return copy


def _keep_read(element: Any, findings: Findings) -> None:
    """Remove children, attributes and text that the format does not define; shapes stay."""
    defined = FORMAT[element.tag]
    for key in list(element.attrib):
        if key not in defined.attributes:
            findings.pass_over(f"<{element.tag} {name_of(element, key)}>", element)
            element.attrib.pop(key)
    if text_in(element):
        findings.pass_over(f"text in <{element.tag}>", element)
    for child in list(element):
        if child.tag not in defined.children:
            findings.pass_over(f"<{tag_of(child)}>", child)
            element.remove(child)
        elif child.tag not in _SHAPES:
            _keep_read(child, findings)


def _complete(inertial: Any, findings: Findings) -> None:
    """Put into an inertial what it leaves out and the format takes for zero.

    A mass alone is a point at the inertial's origin, an inertial of nothing a frame. Moments need a mass, and
    so does what says something that is not read, a density.
    """
    given = {child.tag for child in inertial.iterchildren(etree.Element)}
    if "mass" in given and "inertia" not in given:
        etree.SubElement(inertial, "inertia", dict.fromkeys(MOMENTS, "0"))
        if not _is_of_zeros(inertial):
            findings.points.append(str(inertial.getparent().get("name")))
    elif "mass" not in given and given <= {"origin", "inertia"}:
        mass = etree.SubElement(inertial, "mass", value="0")
        if "inertia" not in given:
            etree.SubElement(inertial, "inertia", dict.fromkeys(MOMENTS, "0"))
        if not _is_of_zeros(inertial):
            inertial.remove(mass)


def _rounding(inertia: Any) -> float:
    r"""Return the largest violation of the triangle rule by rounding [kg m^2].

    The excess :math:`2 \lambda_{max}(I) - tr I` is not positive for a body and is subadditive. So that of
    :math:`I + E` is at most that of the rounding :math:`E`, by Gershgorin's discs the sum of its moments and
    twice the largest sum of products in a row.
    """
    xx, yy, zz, xy, xz, yz = (half_unit(inertia.get(moment)) for moment in MOMENTS)
    return xx + yy + zz + 2.0 * max(xy + xz, xy + yz, xz + yz)


def _is_of_zeros(inertial: Any) -> bool:
    """Return whether mass and moments are given and zero: the link is a frame."""
    mass, inertia = inertial.findall("mass"), inertial.findall("inertia")
    if len(mass) != 1 or len(inertia) != 1:
        return False
    texts = [mass[0].get("value"), *(inertia[0].get(moment) for moment in MOMENTS)]
    return all(numbers_in(text) == (0.0,) for text in texts)


# --- looks -------------------------------------------------------------------------------------------------


def _clean_materials(robot: Any, findings: Findings) -> None:
    """Keep of materials the first of each name."""
    names: set[str] = set()
    for material in robot.findall("material"):
        name = material.get("name", "")
        if not name.strip() or name in names:
            findings.pass_over(
                "<material> of a name that is taken" if name.strip() else "<material> without a name",
                material,
            )
            robot.remove(material)
            continue
        names.add(name)
        _clean_material(material, findings)


def _clean_material(material: Any, findings: Findings) -> None:
    colours = material.findall("color")
    for other in colours[1:]:
        findings.pass_over("<color> beside another", other)
        material.remove(other)
    for colour in colours[:1]:
        rgba = numbers_in(colour.get("rgba"))
        if rgba is None or len(rgba) not in (3, 4) or not all(map(math.isfinite, rgba)):
            findings.pass_over("<color> that is none", colour)
            material.remove(colour)
        elif len(rgba) == 3:
            findings.pass_over("<color> of three numbers", colour)
            colour.set("rgba", f"{colour.get('rgba')} 1")


def _clean_shape(shape: Any, link: str, findings: Findings) -> None:
    """Remove a shape that nothing can draw; leave one material of the others."""
    problem = _problem_of_shape(shape)
    if problem is not None:
        findings.pass_over(f"<{shape.tag}> that cannot be drawn", shape)
        if shape.tag == "visual":
            findings.undrawn.append((link, problem))
        shape.getparent().remove(shape)
        return
    _keep_read(shape, findings)
    first, *others = shape.findall("material") or [None]
    for other in others:
        findings.pass_over("<material> beside another", other)
        shape.remove(other)
    if first is not None:
        if not first.get("name", "").strip():
            findings.pass_over("<material> without a name", first)
            first.attrib.pop("name", None)
        _clean_material(first, findings)


def _problem_of_shape(shape: Any) -> str | None:
    """Return why a shape cannot be drawn, or None."""
    geometries, origins = shape.findall("geometry"), shape.findall("origin")
    if len(geometries) != 1 or len(origins) > 1:
        return f"a <{shape.tag}> must have one <geometry> and at most one <origin>"
    for origin in origins:
        for key in ("xyz", "rpy"):
            if key in origin.attrib and not _sound(origin.get(key), (3,)):
                return f"an <origin> with {key} {origin.get(key)!r}"
    kinds = [kind for kind in geometries[0] if kind.tag in SHAPES] or list(geometries[0])
    if len(kinds) != 1 or kinds[0].tag not in SHAPES:
        return f"a shape of {' and '.join(f'<{tag_of(kind)}>' for kind in kinds) or 'no kind'}"
    (kind,) = kinds
    for key, count in SHAPES[kind.tag].items():
        if not _sound(kind.get(key), (count,)) or not min(numbers_in(kind.get(key)) or (0.0,)) > 0.0:
            return f"a <{kind.tag}> with {key} {kind.get(key)!r}"
    if kind.tag == "mesh":
        if not kind.get("filename", "").strip():
            return "a <mesh> without a file name"
        if "scale" in kind.attrib and not _sound(kind.get("scale"), (1, 3)):
            return f"a <mesh> with scale {kind.get('scale')!r}"
    return None


def _sound(text: str | None, counts: tuple[int, ...]) -> bool:
    numbers = numbers_in(text)
    return numbers is not None and len(numbers) in counts and all(abs(each) <= LARGEST for each in numbers)


# --- joints ------------------------------------------------------------------------------------------------


def _clean_joint(joint: Any, findings: Findings) -> None:
    kind = joint.get("type")
    if kind in ("fixed", "floating"):
        for axis in joint.findall("axis"):
            numbers = numbers_in(axis.get("xyz")) or ()
            if len(numbers) != 3 or not all(map(math.isfinite, numbers)) or not any(numbers):
                findings.pass_over(f"<axis> of a {kind} joint", axis)
                joint.remove(axis)
    meaningless = {
        "fixed": ("limit", "dynamics", "mimic"),
        "floating": ("limit",),
        "planar": ("limit",),
    }
    for tag in meaningless.get(kind, ()):
        for element in joint.findall(tag):
            findings.pass_over(f"<{tag}> of a {kind} joint", element)
            joint.remove(element)
    limits = joint.findall("limit")
    if kind in (*_BOUNDED, "continuous"):
        for limit in limits:
            _clean_limit(limit, findings)
    if kind in _BOUNDED and len(limits) < 2:
        bounded = any(map(_leaves_a_way, limits))
        if not bounded:
            findings.unbounded.append(str(joint.get("name")))
        for limit in limits:
            for key in ("lower", "upper"):
                if bounded:
                    limit.set(key, limit.get(key, "0"))  # URDF's default
                else:
                    limit.attrib.pop(key, None)


def _clean_limit(limit: Any, findings: Findings) -> None:
    """Remove unused parts of a limit: effort, velocity, and bounds of unbounded joints."""
    for key in ("effort", "velocity"):
        numbers = numbers_in(limit.get(key))
        if numbers is None or len(numbers) != 1 or not 0.0 <= numbers[0] < math.inf:
            got = "without" if key not in limit.attrib else "with an unsound"
            findings.pass_over(f"<limit> {got} {key}", limit)
            limit.set(key, "0")
    joint = limit.getparent()
    if joint.get("type") == "continuous":
        if _leaves_a_way(limit):
            bounds = f"{limit.get('lower', '0')} to {limit.get('upper', '0')} rad"
            findings.unlimited.append((str(joint.get("name")), bounds))
        for key in ("lower", "upper"):
            limit.attrib.pop(key, None)
    for key in ("lower", "upper"):
        numbers = numbers_in(limit.get(key)) or ()
        if len(numbers) == 1 and NO_BOUND < abs(numbers[0]) < math.inf:
            limit.set(key, "inf" if numbers[0] > 0.0 else "-inf")


def _leaves_a_way(limit: Any) -> bool:
    """Return whether a limit has distinct bounds; broken numbers are judged elsewhere.

    One bound alone has URDF's default beside it, 0. None, 0 and 0 (SolidWorks' exporter) and infinite ones
    bound nothing.
    """
    if "lower" not in limit.attrib and "upper" not in limit.attrib:
        return False
    bounds: list[float] = []
    for key in ("lower", "upper"):
        numbers = numbers_in(limit.get(key, "0"))
        if numbers is None or len(numbers) != 1 or math.isnan(numbers[0]):
            return True
        bounds += numbers
    low, high = bounds
    return low < high and not (low < -NO_BOUND and high > NO_BOUND)


# --- damping and friction of joints -------------------------------------------------------------------------


def friction_of(robot: Any) -> dict[str, dict[str, float]]:
    """Return positive damping and friction of joints with an axis, by name."""
    found = {
        str(joint.get("name")): _numbers(joint)
        for joint in robot.findall("joint")
        if joint.get("type") in urdf_xml.WITH_AXIS
    }
    return {name: numbers for name, numbers in found.items() if numbers}


def left_out(robot: Any, where: str) -> tuple[str, ...]:
    """Return a message per damping or friction of a joint without an axis."""
    return tuple(
        f"{where}: joint {joint.get('name')!r}: <dynamics> {name}={value:g} is not simulated, for the "
        f"joint is {joint.get('type')} and has no axis; remove it"
        for joint in robot.findall("joint")
        if joint.get("type") in ("floating", "planar")
        for name, value in _numbers(joint).items()
    )


def _numbers(joint: Any) -> dict[str, float]:
    found = {}
    for dynamics in joint.findall("dynamics")[:1]:
        for name in ("damping", "friction"):
            numbers = numbers_in(dynamics.get(name))
            if numbers is not None and len(numbers) == 1 and numbers[0]:
                found[name] = numbers[0]
    return found


# --- tree of bodies -----------------------------------------------------------------------------------------


def check(robot: Robot, where: str, allow_impossible_inertia: Collection[str]) -> None:
    """Refuse a robot that is not a mechanism: tree, mimics, masses, allowed links."""
    links = [link.name for link in robot.links]
    for name in allow_impossible_inertia:
        if name not in links:
            raise UnknownNameError(f"{where}: allow_impossible_inertia", "link", name, links)
    _check_tree(robot, where)
    _check_mimics(robot, where)
    check_masses(robot, where)


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


# --- reading ------------------------------------------------------------------------------------------------


class Reading(NamedTuple):
    """A checked URDF for its readers: in numbers, and for Pinocchio's parser."""

    robot: Robot
    simulated: str  # for Pinocchio's parser
    findings: Findings


def text_of(path: str | Path) -> str:
    """Return the text of a URDF file, whatever its encoding.

    Raises:
        MechanismError: It cannot be read.
    """
    try:
        return decoded(Path(path).read_bytes())
    except OSError as error:
        raise MechanismError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise MechanismError(f"{path}: must be XML, got no text (byte {error.start})") from error


@lru_cache(maxsize=64)
def written(text: str, where: str) -> str:
    """Return a URDF's text as this package writes it."""
    return urdf_xml.write(urdf_xml.read(text, where))


@lru_cache(maxsize=64)  # every run of a study reads the same text again, some more than once
def checked(text: str, where: str, allow_impossible_inertia: tuple[str, ...]) -> Reading:
    """Return a checked URDF in numbers, not to be changed, and as Pinocchio reads it."""
    clean, findings = judged(urdf_xml.read(text, where), where)
    robot = robot_of(clean, urdf_xml.write(clean), where)
    check(robot, where, allow_impossible_inertia)
    return Reading(robot, for_pinocchio(clean), findings)


def judged(robot: Any, where: str) -> tuple[Any, Findings]:
    """Return a root element without meaningless parts, and these; refuse invalid numbers."""
    findings = clean(robot, Path(where).stem)
    urdf_xml.judge(robot, where)
    edits.turn_planes(robot, where)
    return robot, findings
