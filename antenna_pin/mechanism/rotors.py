"""Rotors of motors: bodies with an inertia about their axis, geared to a joint.

A motor's rotor sits on one of a joint's links, turns about the joint's axis ``ratio`` times as fast as the
joint, and has a moment of inertia there. It is a body of its own, held to the joint as ``<mimic>`` holds a
follower, so that all of it is exact: what the joint feels (ratio^2 inertia), what a link that turns about the
axis feels of it and the joint of that (ratio inertia), the gyroscopic torque on a link that turns about
another axis, energy and momenta. Its mass, and its inertia about other axes, belong to the link that carries
it: in the URDF they are that link's, without the moment about the axis.

As plain armature (:func:`antenna_pin.mechanism.build_mechanism`) there is no body: the joint's own entry of
the mass matrix has ratio^2 inertia more, and nothing else.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from lxml import etree

from antenna_pin.base.arguments import takes
from antenna_pin.base.changes import Rotor
from antenna_pin.errors import MechanismError
from antenna_pin.mechanism import urdf_xml
from antenna_pin.mechanism.edits import body_name, named, text_of
from antenna_pin.mechanism.urdf import Urdf

__all__ = ["check_turns", "rotor_joint", "with_rotor"]

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
    for kind, taken in (("joint", own), ("link", body_name(own))):
        if any(element.get("name") == taken for element in robot.findall(kind)):
            raise MechanismError(
                f"{urdf.where}: {kind} name {taken!r} is needed for rotor {name!r}; rename yours, or "
                "the rotor"
            )
    axis = urdf.axis(rotor.joint)
    written = named(robot, "joint", rotor.joint)
    made = etree.Element("joint", name=own, type="continuous")
    etree.SubElement(made, "parent", link=joint.parent if rotor.carrier == "parent" else joint.child)
    etree.SubElement(made, "child", link=body_name(own))
    origin = written.find("origin")
    if rotor.carrier == "parent" and origin is not None:
        etree.SubElement(made, "origin", **dict(origin.attrib))
    etree.SubElement(made, "axis", xyz=text_of(axis))
    etree.SubElement(made, "mimic", joint=rotor.joint, multiplier=repr(float(rotor.ratio)))
    last = written
    for element in (made, _body(body_name(own), axis, rotor.inertia)):
        element.tail, last.tail = last.tail, "\n\n  "
        last.addnext(element)
        last = element
    allowed = (*urdf.allow_impossible_inertia, body_name(own))
    return replace(urdf, text=urdf_xml.write(robot), allow_impossible_inertia=allowed)


def _body(name: str, axis: Any, moment: float) -> Any:
    """Return a link with a moment of inertia about an axis, and nothing else."""
    link = etree.Element("link", name=name)
    inertial = etree.SubElement(link, "inertial")
    etree.SubElement(inertial, "mass", value="0")
    unit = np.asarray(axis) / np.linalg.norm(axis)
    inertia = moment * np.outer(unit, unit)
    places = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    etree.SubElement(
        inertial, "inertia", **{key: repr(float(inertia[place])) for key, place in places.items()}
    )
    return link
