"""Random URDFs as exporters write them, each beside its plain twin: the same mechanism, and nothing odd.

A mechanism is drawn first: a tree of bodies with turned frames, oblique axes, products of inertia. Its plain
twin is written from its numbers. The odd one is the same tree with what the exporters of the field add, which
must mean nothing: of a deck of oddities (:data:`ODDITIES`) each file gets some, dealt so that a few dozen
files hold all. A number follows from a seed and a place alone.

Files with one slip each (:func:`draw_slip`) must be refused: a name that mechanics or shapes are read by is
written almost right.

To add an oddity is one function with ``@oddity``: it gets the elements of a file, the drawn mechanism and a
random generator, and changes the elements. What is a change of the text (encodings, what stands before the
declaration) is one with ``@written``.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from lxml import etree

Random = np.random.Generator

#: How many of the oddities each file has.
DEALT = 7

_TYPES = ("revolute", "continuous", "prismatic", "fixed", "fixed", "floating")


@dataclass(frozen=True)
class OddUrdf:
    """A URDF as an exporter might write it, and its plain twin."""

    name: str  # of the file, without suffix
    odd: bytes  # its bytes
    plain: str  # the text of the twin
    oddities: tuple[str, ...]  # what is odd about it, by the names of :data:`ODDITIES`


@dataclass(frozen=True)
class SlippedUrdf:
    """A URDF in which one name is written almost right."""

    name: str  # of the file, without suffix
    text: str  # its XML
    written: str  # the name with the slip
    meant: str  # the name of the format


ODDITIES: dict[str, Callable[[Any, Random], None]] = {}
_WRITTEN: dict[str, Callable[[str], bytes]] = {}


def oddity(change: Callable[[Any, Random], None]) -> Callable[[Any, Random], None]:
    """Add a change of the elements to the deck."""
    ODDITIES[change.__name__] = change
    return change


def written(change: Callable[[str], bytes]) -> Callable[[str], bytes]:
    """Add a way to write the text to the deck; a file has one."""
    _WRITTEN[change.__name__] = change
    return change


def draw_urdf(seed: int, number: int) -> OddUrdf:
    """Return the URDF of a number."""
    rng = np.random.default_rng([seed, number])
    robot = _mechanism(rng)
    plain = etree.tostring(robot, encoding="unicode")
    names = list(ODDITIES)
    start = number * DEALT
    chosen = [names[k % len(names)] for k in range(start, start + DEALT)]
    for name in chosen:
        ODDITIES[name](robot, rng)
    way = list(_WRITTEN)[number % len(_WRITTEN)]
    etree.indent(robot)
    odd = _WRITTEN[way](etree.tostring(robot, encoding="unicode"))
    return OddUrdf(f"odd_{seed}_{number}", odd, plain, (*chosen, way))


def draw_slip(seed: int, number: int) -> SlippedUrdf:
    """Return the URDF with a slip of a number: in turn each element and attribute is written almost right."""
    rng = np.random.default_rng([seed, number, 1])
    robot = _mechanism(rng)
    for joint in _of_type(robot, "revolute", "continuous", "prismatic"):
        etree.SubElement(joint, "dynamics", damping="0.1", friction="0.2")
        if joint.get("name") != "joint1":
            etree.SubElement(joint, "mimic", joint="joint1", multiplier="2", offset="0.1")
    for shape, numbers in _SHAPES.items():
        visual = _shape(robot.find("link"), "visual", shape, **numbers)
        etree.SubElement(visual, "origin", xyz="0 0 1", rpy="0 0 0")
    places = {
        (element.tag, key): element
        for element in robot.iter()
        if element is not robot
        for key in (None, *element.attrib)
    }
    tag, key = sorted(places, key=str)[number % len(places)]
    element, meant = places[tag, key], key or tag
    slip = _slip(meant, rng)
    if key is None:
        element.tag = slip
    else:
        text = element.attrib.pop(key)
        element.set(slip, text)
    etree.indent(robot)
    return SlippedUrdf(f"slip_{seed}_{number}", etree.tostring(robot, encoding="unicode"), slip, meant)


_SHAPES = {
    "box": {"size": "1 1 1"},
    "cylinder": {"radius": "0.1", "length": "1"},
    "sphere": {"radius": "1"},
    "mesh": {"filename": "part.stl", "scale": "1 1 1"},
}


def _slip(name: str, rng: Random) -> str:
    """Return a name with a slip in it; some long names have one in either half."""
    while True:
        half = len(name) // 2
        twice = half > 2 and rng.random() < 0.3
        slip = _slipped(name[:half], rng) + _slipped(name[half:], rng) if twice else _slipped(name, rng)
        if slip != name and slip.lower() not in _NAMES - {name}:
            return slip


# Lest a slip be another name of the format.
_NAMES = {"link", "joint", "inertia", "inertial", "ixx", "iyy", "izz", "ixy", "ixz", "iyz", "xyz", "rpy"}


def _slipped(word: str, rng: Random) -> str:
    """Return a word of which a letter is swapped, lost, doubled, mistaken, added or in the other case."""
    at, letter = int(rng.integers(len(word))), chr(97 + int(rng.integers(26)))
    before, here, after = word[:at], word[at], word[at + 1 :]
    choices = (
        before + after[:1] + here + after[1:],
        before + after,
        before + here + here + after,
        before + letter + after,
        before + letter + here + after,
        before + here.upper() + after,
    )
    return choices[int(rng.integers(len(choices)))]


# --- the mechanism -----------------------------------------------------------------------------------------


def _text(values: Any) -> str:
    return " ".join(repr(float(value)) for value in np.atleast_1d(values))


def _mechanism(rng: Random) -> Any:
    robot = etree.Element("robot", name="odd")
    names = [f"link{k}" for k in range(int(rng.integers(3, 8)))]
    for name in names:
        link = etree.SubElement(robot, "link", name=name)
        inertial = etree.SubElement(link, "inertial")
        etree.SubElement(inertial, "origin", xyz=_text(rng.normal(size=3)), rpy=_text(rng.uniform(-3, 3, 3)))
        mass = rng.uniform(0.5, 5.0)
        etree.SubElement(inertial, "mass", value=_text(mass))
        # Second moments about three axes give an inertia that a body can have, in any axes.
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        second = turn @ np.diag(mass * rng.uniform(0.01, 0.2, 3)) @ turn.T
        inertia = np.trace(second) * np.eye(3) - second
        etree.SubElement(
            inertial,
            "inertia",
            {f"i{a}{b}": _text(inertia["xyz".index(a), "xyz".index(b)]) for a, b in _PAIRS},
        )
    for k, child in enumerate(names[1:], 1):
        # The first joint turns, so that something moves.
        kind = "revolute" if k == 1 else str(rng.choice(_TYPES))
        joint = etree.SubElement(robot, "joint", name=f"joint{k}", type=kind)
        etree.SubElement(joint, "origin", xyz=_text(rng.normal(size=3)), rpy=_text(rng.uniform(-3, 3, 3)))
        etree.SubElement(joint, "parent", link=str(rng.choice(names[:k])))
        etree.SubElement(joint, "child", link=child)
        if kind not in ("fixed", "floating"):
            etree.SubElement(joint, "axis", xyz=_text(rng.normal(size=3)))
        if kind in ("revolute", "prismatic"):
            etree.SubElement(joint, "limit", lower="-2", upper="2", effort="1", velocity="1")
    return robot


_PAIRS = ("xx", "yy", "zz", "xy", "xz", "yz")


# --- joints ------------------------------------------------------------------------------------------------


def _of_type(robot: Any, *types: str) -> list[Any]:
    return [joint for joint in robot.findall("joint") if joint.get("type") in types]


@oddity
def axes_without_meaning(robot: Any, rng: Random) -> None:
    """As SolidWorks and Onshape write them, of no length or without numbers."""
    for joint in _of_type(robot, "fixed", "floating"):
        etree.SubElement(joint, "axis", {} if rng.random() < 0.3 else {"xyz": "0 0 0"})


@oddity
def limits_without_bounds(robot: Any, rng: Random) -> None:
    """As onshape-to-robot and SolidWorks write them: effort and velocity, 0 and 0, infinite, or none."""
    for joint in _of_type(robot, "revolute", "prismatic"):
        joint.remove(joint.find("limit"))
        choice = int(rng.integers(4))
        if choice == 0:
            etree.SubElement(joint, "limit", effort="1", velocity="20")
        elif choice == 1:
            etree.SubElement(joint, "limit", lower="0", upper="0", effort="0", velocity="0")
        elif choice == 2:
            etree.SubElement(joint, "limit", lower="-inf", upper="inf", effort="inf", velocity="inf")


@oddity
def limits_in_part(robot: Any, rng: Random) -> None:
    """Bounds without effort and velocity, an upper one alone, a negative effort."""
    for joint, limit in [(each, each.find("limit")) for each in _of_type(robot, "revolute", "prismatic")]:
        if limit is None:
            continue
        if rng.random() < 0.5:
            limit.attrib.pop("effort", None)
        else:
            limit.set("velocity", "-1")
        if joint.get("type") == "revolute" and "upper" in limit.attrib:
            limit.attrib.pop("lower", None)


@oddity
def limits_of_fixed_joints(robot: Any, rng: Random) -> None:
    """As SolidWorks writes them, with dynamics, and a mimic that was left behind."""
    for joint in _of_type(robot, "fixed"):
        etree.SubElement(joint, "limit", lower="0", upper="0")
        etree.SubElement(joint, "dynamics", damping="", friction="none")
        if rng.random() < 0.5:
            etree.SubElement(joint, "mimic", joint="joint1", multiplier="-1")


@oddity
def calibrations(robot: Any, rng: Random) -> None:
    """Calibration and safety, whatever they say."""
    for joint in robot.findall("joint"):
        etree.SubElement(joint, "calibration", rising="soon")
        etree.SubElement(joint, "safety_controller", k_velocity="10", soft_lower_limit="")


@oddity
def gears(robot: Any, rng: Random) -> None:
    """Joints that mimic the first: a constraint, which leaves the tree as it is."""
    for joint in _of_type(robot, "revolute", "continuous", "prismatic"):
        if joint.get("name") != "joint1" and rng.random() < 0.5:
            etree.SubElement(joint, "mimic", joint="joint1", multiplier="-0.5", offset="0.1")


# --- bodies ------------------------------------------------------------------------------------------------


@oddity
def frames_of_no_mass(robot: Any, rng: Random) -> None:
    """As of UR and Franka: links fixed to others with an inertial of zeros, or none."""
    for link in robot.findall("link"):
        name = f"{link.get('name')}_tool0"
        frame = etree.SubElement(robot, "link", name=name)
        if rng.random() < 0.8:
            inertial = etree.SubElement(frame, "inertial")
            etree.SubElement(inertial, "mass", value="0.0")
            etree.SubElement(inertial, "inertia", {f"i{pair}": "0" for pair in _PAIRS})
        joint = etree.SubElement(robot, "joint", name=f"{name}_joint", type="fixed")
        etree.SubElement(joint, "origin", xyz=_text(rng.normal(size=3)), rpy="0 0 1.5")
        etree.SubElement(joint, "parent", link=link.get("name"))
        etree.SubElement(joint, "child", link=name)


# --- what other tools read ---------------------------------------------------------------------------------


@oddity
def gazebo(robot: Any, rng: Random) -> None:
    """Colours, plugins and sensors of Gazebo, with elements that are called as URDF's."""
    for link in robot.findall("link"):
        tag = etree.SubElement(robot, "gazebo", reference=link.get("name"))
        etree.SubElement(tag, "material").text = "Gazebo/Black"
        sensor = etree.SubElement(tag, "sensor", name="imu")
        for name in ("origin", "color", "link", "joint", "inertial"):
            etree.SubElement(sensor, name).text = "0 0 0"


@oddity
def transmissions(robot: Any, rng: Random) -> None:
    """Transmissions with joints and actuators in them, ros2_control, sensors."""
    for joint in _of_type(robot, "revolute"):
        tag = etree.SubElement(robot, "transmission", name=f"{joint.get('name')}_trans")
        etree.SubElement(tag, "type").text = "transmission_interface/SimpleTransmission"
        inside = etree.SubElement(tag, "joint", name=joint.get("name"))
        etree.SubElement(inside, "hardwareInterface").text = "EffortJointInterface"
        actuator = etree.SubElement(tag, "actuator", name="motor")
        etree.SubElement(actuator, "mechanicalReduction").text = "1:100"
    control = etree.SubElement(robot, "ros2_control", name="arm", type="system")
    inside = etree.SubElement(control, "joint", name="joint1")
    etree.SubElement(etree.SubElement(inside, "command_interface", name="effort"), "limit").text = "1"
    sensor = etree.SubElement(robot, "sensor", name="camera")
    etree.SubElement(sensor, "parent", link="nowhere")


@oddity
def other_tools(robot: Any, rng: Random) -> None:
    """Elements of MuJoCo, Bullet, phobos and of nobody."""
    compiler = etree.SubElement(robot, "mujoco")
    etree.SubElement(compiler, "compiler", meshdir="meshes", discardvisual="false")
    etree.SubElement(robot, "motor", name="m", joint="joint1")
    for link in robot.findall("link"):
        contact = etree.SubElement(link, "contact")
        etree.SubElement(contact, "lateral_friction", value="1")
        etree.SubElement(link, "self_collision_checking")
        for inertial in link.findall("inertial"):
            etree.SubElement(inertial, "density", value="7800")
    for joint in robot.findall("joint"):
        etree.SubElement(joint, "hardwareInterface").text = "PositionJointInterface"


@oddity
def foreign_attributes(robot: Any, rng: Random) -> None:
    """As of iCub, ANYmal and SolidWorks' exporter, where mechanics is read; and text between elements."""
    for joint in robot.findall("joint"):
        joint.set("dont_collapse", "true")
        for axis in joint.findall("axis"):
            axis.set("rpy", "0 0 1")
        for limit in joint.findall("limit"):
            limit.attrib.update({"gear_velocity": "10", "acceleration": "5", "jerk": "1", "soft_lower": "-1"})
        joint.find("child").tail = "?>"
    for inertia in robot.iterfind("link/inertial/inertia"):  # the other half, which says the same
        inertia.attrib.update({f"i{b}{a}": inertia.get(f"i{a}{b}") for a, b in ("xy", "xz", "yz")})


@oddity
def drake_prefixes(robot: Any, rng: Random) -> None:
    """Elements and attributes with a prefix that nothing declares once the text is written."""
    space = "undeclared:drake"
    etree.SubElement(robot, f"{{{space}}}collision_filter_group", name="g", nsmap={"drake": space})
    for limit in robot.iterfind("joint/limit"):
        limit.set(f"{{{space}}}acceleration", "10")


# --- looks -------------------------------------------------------------------------------------------------


def _shape(link: Any, tag: str, shape: str, **attributes: str) -> Any:
    visual = etree.SubElement(link, tag)
    etree.SubElement(etree.SubElement(visual, "geometry"), shape, attributes)
    return visual


@oddity
def materials(robot: Any, rng: Random) -> None:
    """Without a name, with an empty one, of three numbers, twice, of a name that is taken."""
    for link in robot.findall("link"):
        visual = _shape(link, "visual", "sphere", radius="0.1")
        for attributes in ({}, {"name": ""}, {"name": "paint"}):
            material = etree.SubElement(visual, "material", attributes)
            etree.SubElement(material, "color", rgba=str(rng.choice(["1 0 0", "0 1 0 1", "red", ""])))
    for rgba in ("0.1 0.2 0.3", "0.4 0.5 0.6 1"):
        etree.SubElement(etree.SubElement(robot, "material", name="paint"), "color", rgba=rgba)
    etree.SubElement(robot, "material")


@oddity
def shapes(robot: Any, rng: Random) -> None:
    """Capsules, planes, flat boxes, words for numbers, no geometry, meshes that are not there."""
    for link in robot.findall("link"):
        for tag in ("visual", "collision"):
            _shape(link, tag, "capsule", radius="0.1", length="1")
            _shape(link, tag, "plane", normal="0 0 1")
            _shape(link, tag, "box", size="0 0 0")
            _shape(link, tag, "cylinder", radius="thick", length="${l}")
            _shape(
                link, tag, "mesh", filename="package://nowhere/meshes/part.STL", scale="0.001 0.001 -0.001"
            )
            etree.SubElement(link, tag)
            etree.SubElement(_shape(link, tag, "sphere", radius="1"), "origin", xyz="here")
            etree.SubElement(_shape(link, tag, "sphere", radius="1"), "verbose", value="1")


# --- numbers and names -------------------------------------------------------------------------------------


@oddity
def numbers(robot: Any, rng: Random) -> None:
    """With signs, tabs and line ends, in powers of ten: the same to the last bit."""
    for element in (*robot.iterfind("joint/*"), *robot.iterfind("link/inertial/*")):
        for key in ("xyz", "rpy", "value", "ixx", "ixy"):
            if key in element.attrib:
                words = [f"{float(word):+.17e}" for word in element.get(key).split()]
                element.set(key, " \t " + " \n ".join(words) + "  ")


@oddity
def no_name(robot: Any, rng: Random) -> None:
    """A robot without a name, and of a version."""
    robot.attrib.pop("name", None)
    robot.set("version", "2.1")


@oddity
def a_frame_at_the_end(robot: Any, rng: Random) -> None:
    """Joints before their links."""
    for joint in robot.findall("joint"):
        robot.insert(0, joint)


@oddity
def default_namespace(robot: Any, rng: Random) -> None:
    """What a tool of XML declares for all names; xacro's own besides, of which nothing is left."""
    robot.set("xmlns_", "http://www.ros.org")  # lxml cannot change an element's: put in place when written
    robot.set("xmlns_xacro", "http://www.ros.org/wiki/xacro")


@oddity
def comments(robot: Any, rng: Random) -> None:
    """Between numbers' elements, with hyphens once the text is written."""
    for element in list(robot.iter("inertial", "joint", "link", "geometry")):
        element.insert(0, etree.Comment(" = = note = = "))
    robot.append(etree.ProcessingInstruction("exporter", "version 1"))


def _finished(text: str) -> str:
    """Return a text as tools write it that do not look at what is well-formed."""
    text = text.replace(' xmlns:drake="undeclared:drake"', "").replace("= =", "--")
    return re.sub(r" xmlns_(\w*)=", lambda found: f" xmlns{':' if found[1] else ''}{found[1]}=", text)


@written
def as_it_is(text: str) -> bytes:
    """Without a declaration."""
    return _finished(text).encode()


@written
def with_a_mark(text: str) -> bytes:
    """A byte order mark, line ends of DOS."""
    return b"\xef\xbb\xbf" + ('<?xml version="1.0"?>\n' + _finished(text)).replace("\n", "\r\n").encode()


@written
def behind_a_comment(text: str) -> bytes:
    """The declaration is not the first thing."""
    return ("\n<!-- made by -- an exporter -->\n<?xml version='1.0'?>\n" + _finished(text)).encode()


@written
def in_latin(text: str) -> bytes:
    """Letters of Latin-1 that no declaration tells of."""
    return _finished(text).replace("<link", "<!-- Gr\u00f6\u00dfe --><link", 1).encode("latin-1")


@written
def in_utf_16(text: str) -> bytes:
    """As some tools of Windows write."""
    return ('<?xml version="1.0" encoding="utf-16"?>\n' + _finished(text)).encode("utf-16")


@written
def of_another_encoding(text: str) -> bytes:
    """UTF-8 that calls itself UTF-16, with a DOCTYPE that declares nothing."""
    return ('<?xml version="1.0" encoding="utf-16"?>\n<!DOCTYPE robot>\n' + _finished(text)).encode()


@written
def of_no_version(text: str) -> bytes:
    """As many files that come with PyBullet."""
    return ('<?xml version="0.0" ?>\n' + _finished(text)).encode()
