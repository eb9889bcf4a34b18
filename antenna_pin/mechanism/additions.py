"""Bodies and joints added to a URDF: rotors of motors, and a shaken base.

A motor's rotor sits on one of a joint's links, turns about the joint's axis ``ratio`` times as fast as the
joint, and has a moment of inertia there. It is a body of its own, held to the joint as ``<mimic>`` holds a
follower, so that all of it is exact: what the joint feels (ratio^2 inertia), what a link that turns about the
axis feels of it and the joint of that (ratio inertia), the gyroscopic torque on a link that turns about
another axis, energy and momenta. Its mass, and its inertia about other axes, belong to the link that carries
it: in the URDF they are that link's, without the moment about the axis.

As plain armature (:func:`antenna_pin.mechanism.build_mechanism`) there is no body: the joint's own entry of
the mass matrix has ratio^2 inertia more, and nothing else.

A mechanism on a fixed base stands in the world by its root. Shaken, it is carried by one joint for each
motion, one on another, those that slide nearest to the world: a direction in the world stays one. The links
between have no mass. What does not move is a link named ``world`` in front of all.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from lxml import etree

from antenna_pin.base.arguments import takes
from antenna_pin.base.changes import Rotor
from antenna_pin.elements import Shake
from antenna_pin.errors import MechanismError
from antenna_pin.mechanism import urdf_xml
from antenna_pin.mechanism.edits import (
    body_name,
    element_named,
    insert_behind,
    moments_of,
    new_joint,
    origin_at,
    refuse_taken,
    text_of,
)
from antenna_pin.mechanism.inertia import rigid_groups
from antenna_pin.mechanism.urdf import Urdf

# --- rotors -------------------------------------------------------------------------------------------------

_HINGES = ("revolute", "continuous")


@takes()
def rotor_joint(name: str) -> str:
    """Return the name of the joint that a rotor turns on; its link is ``<joint>_body``."""
    return f"{name}_rotor"


@takes()
def check_turns(urdf: Urdf, name: str, rotor: Rotor) -> None:
    """Refuse a rotor at a joint without a rotation axis of its own.

    Raises:
        UnknownNameError: There is no such joint.
        MechanismError: The joint is of another kind.
    """
    joint = urdf.joint(rotor.joint)
    if joint.type not in _HINGES:
        raise MechanismError(
            f"{urdf.where}: rotor {name!r}: joint {rotor.joint!r} must be revolute or continuous, without "
            f"play, got {joint.type}; put the rotor at a joint that turns"
        )


@takes()
def with_rotor(urdf: Urdf, name: str, rotor: Rotor) -> Urdf:
    """Return a copy with a rotor on the joint ``<name>_rotor``, coupled to the rotor's joint.

    Raises:
        UnknownNameError: There is no such joint.
        MechanismError: The joint does not turn about an axis of its own, or a name is taken.
    """
    check_turns(urdf, name, rotor)
    joint = urdf.joint(rotor.joint)
    own = rotor_joint(name)
    robot = urdf_xml.parsed(urdf.text)
    purpose = f"for rotor {name!r}; rename yours, or the rotor"
    refuse_taken(robot, own, body_name(own), urdf.where, purpose)
    axis = urdf.axis(rotor.joint)
    written = element_named(robot, "joint", rotor.joint, urdf.where)
    origin = written.find("origin") if rotor.carrier == "parent" else None
    carrier = joint.parent if rotor.carrier == "parent" else joint.child
    attributes = None if origin is None else origin.attrib
    turning = new_joint(own, "continuous", carrier, body_name(own), attributes, axis)
    etree.SubElement(turning, "mimic", joint=rotor.joint, multiplier=repr(float(rotor.ratio)))
    insert_behind(written, turning, _body(body_name(own), axis, rotor.inertia))
    allowed = (*urdf.allow_impossible_inertia, body_name(own))
    return replace(urdf, text=urdf_xml.write(robot), allow_impossible_inertia=allowed)


def _body(name: str, axis: Any, moment: float) -> Any:
    """Return a link with a moment of inertia about an axis, and nothing else."""
    link = etree.Element("link", name=name)
    inertial = etree.SubElement(link, "inertial")
    etree.SubElement(inertial, "mass", value="0")
    unit = np.asarray(axis) / np.linalg.norm(axis)
    moments = moments_of(moment * np.outer(unit, unit))
    etree.SubElement(inertial, "inertia", {key: text_of(value or ()) for key, value in moments.items()})
    return link


# --- shaken base --------------------------------------------------------------------------------------------

_WORLD = "world"
# Least share of a direction that the others must leave.
_INDEPENDENT = 1e-6


@takes()
def with_shaken_base(urdf: Urdf, shakes: Mapping[str, Shake]) -> Urdf:
    """Return a copy with a joint below the base for each motion, by its name.

    Raises:
        MechanismError: A name is taken, the base has no mass, or one motion does what others do.
    """
    if not shakes:
        return urdf
    _check(urdf, shakes)
    ordered = sorted(shakes.values(), key=lambda one: not one.slides)
    robot, base = urdf_xml.parsed(urdf.text), urdf.root
    added: list[Any] = [etree.Element("link", name=_WORLD)]
    parent = _WORLD
    for k, shake in enumerate(ordered):
        last = k == len(ordered) - 1
        child = base if last and shake.slides else body_name(shake.joint)
        kind, axis = ("prismatic", shake.direction) if shake.slides else ("revolute", shake.axis)
        point = np.array(shake.point or (0.0, 0.0, 0.0))
        added.append(_joint(shake.joint, kind, parent, child, point, axis))
        if child != base:
            added.append(etree.Element("link", name=child))
        parent = child
        if not shake.slides:
            mount = f"{shake.joint}_mount"
            child = base if last else f"{mount}_body"
            added.append(_joint(mount, "fixed", parent, child, -point, None))
            if not last:
                added.append(etree.Element("link", name=child))
            parent = child
    for k, element in enumerate(added):
        etree.indent(element, level=1)
        element.tail = "\n\n  "
        robot.insert(k, element)
    return replace(urdf, text=urdf_xml.write(robot))


def _joint(name: str, kind: str, parent: str, child: str, place: Any, axis: Any) -> Any:
    joint = new_joint(name, kind, parent, child, origin_at(place) if np.any(place) else None, axis)
    if axis is not None:
        etree.SubElement(joint, "limit", urdf_xml.NO_LIMIT)
    return joint


def _check(urdf: Urdf, shakes: Mapping[str, Shake]) -> None:
    """Refuse duplicate names, the world as base, a massless base, and dependent motions."""
    place = urdf.where
    if urdf.root == _WORLD:
        raise MechanismError(
            f"{place}: a base that is shaken must have another name than {_WORLD!r}, which is what does not "
            "move; rename the root link"
        )
    group = rigid_groups(urdf.robot)[urdf.root]
    if not group.composite()[0] > 0.0:
        raise MechanismError(
            f"{place}: a base that is shaken must have a mass, got none at {urdf.root!r}; give it the "
            f"fixture's by mechanism.links.{urdf.root}.mass and inertia: the base's force counts it"
        )
    names = {one.name for one in urdf.robot.links} | {one.name for one in urdf.robot.joints}
    for name, shake in shakes.items():
        for own in (shake.joint, body_name(shake.joint), f"{shake.joint}_mount"):
            if own in names:
                raise MechanismError(
                    f"{place}: name {own!r} is needed to shake the base by {name!r}, and the URDF has it; "
                    "rename the motion"
                )
            names.add(own)
    for slides, what in ((True, "directions"), (False, "axes")):
        ways = [one.direction if slides else one.axis for one in shakes.values() if one.slides == slides]
        if not ways:
            continue
        unit = np.array(ways, dtype=float)
        unit /= np.linalg.norm(unit, axis=1)[:, None]
        least = np.linalg.svd(unit, compute_uv=False)[-1] if len(unit) <= 3 else 0.0
        if not least > _INDEPENDENT:
            those = ", ".join(name for name, one in shakes.items() if one.slides == slides)
            raise MechanismError(
                f"{place}: {what} in which a base is shaken must be independent, which those of {those} are "
                "not; make one motion of those that go the same way"
            )
