"""Elastic parts of a link, written into the XML of a URDF."""

from __future__ import annotations

import copy
from collections.abc import Iterable
from typing import Any

import numpy as np
from lxml import etree

from antenna_pin.base.units import shown
from antenna_pin.errors import MechanismError, UnknownNameError
from antenna_pin.flexible import (
    BoxShape,
    CylinderShape,
    Drawn,
    ElasticPart,
    MassProperties,
    MeshShape,
    SphereShape,
    SplitLink,
    Takes,
)
from antenna_pin.mechanism._edits import child_of, named, remove, set_numbers, text_of
from antenna_pin.mechanism._format import MOMENTS, numbers_in
from antenna_pin.mechanism.frames import roll_pitch_yaw

__all__ = ["add_parts", "body_name"]

# URDF wants limits of hinges and slides. These are none: nothing gets there.
_NO_LIMIT = {"lower": "-1e9", "upper": "1e9", "effort": "1e9", "velocity": "1e9"}


def body_name(part: str) -> str:
    """Return the name of the link that an elastic part is."""
    return f"{part}_body"


def add_parts(robot: Any, link_name: str, split: SplitLink, where: str) -> None:
    """Make of a link its hub, and hang its elastic parts on it.

    Args:
        robot: Root element, changed in place.
        link_name: The link.
        split: Its hub and parts.
        where: Name of the file, for messages.
    """
    link = named(robot, "link", link_name)
    _write_hub(link, split.hub)
    replaced = [element for shape in split.removes for element in _shapes(link, shape, where)]
    material = _material(replaced or link.findall("visual"))
    for element in replaced:
        remove(element)
    for k, drawn in enumerate(split.hub_shapes):
        _draw(link, drawn, f"hub{k + 1}", np.zeros(3), material)
    last = link
    taken: set[str] = set()  # a shape that several parts move is on the first
    for part in split.parts:
        for kind, name in (("joint", part.name), ("link", body_name(part.name))):
            if any(element.get("name") == name for element in robot.findall(kind)):
                raise MechanismError(
                    f"{where}: {kind} name {name!r} is needed for an elastic part of link {link_name!r}; "
                    "rename yours, or the part"
                )
        joint, body = _joint(part, link_name), _body(part, link, material, taken, where)
        for element in (joint, body):
            element.tail, last.tail = last.tail, "\n\n  "
            last.addnext(element)
            last = element


def _write_hub(link: Any, hub: MassProperties) -> None:
    inertial = child_of(link, "inertial")
    set_numbers(child_of(inertial, "origin"), {"xyz": hub.centre, "rpy": (0.0, 0.0, 0.0)})
    set_numbers(child_of(inertial, "mass"), {"value": (hub.mass,)})
    set_numbers(child_of(inertial, "inertia"), _moments(hub))


def _moments(body: MassProperties) -> dict[str, Iterable[float] | None]:
    inertia = body.inertia
    values = (*np.diag(inertia), inertia[0, 1], inertia[0, 2], inertia[1, 2])
    return {key: (float(value),) for key, value in zip(MOMENTS, values, strict=True)}


def _joint(part: ElasticPart, parent: str) -> Any:
    joint = etree.Element("joint", name=part.name, type="prismatic" if part.slides else "revolute")
    per = ("N/m", "N s/m") if part.slides else ("N m/rad", "N m s/rad")
    joint.append(
        etree.Comment(
            f" antenna_pin: held at zero by a spring of {part.stiffness!r} {per[0]}, "
            f"with a damper of {part.damping!r} {per[1]} "
        )
    )
    etree.SubElement(joint, "parent", link=parent)
    etree.SubElement(joint, "child", link=body_name(part.name))
    etree.SubElement(joint, "origin", xyz=text_of(part.origin), rpy=text_of((0.0, 0.0, 0.0)))
    etree.SubElement(joint, "axis", xyz=text_of(part.axis))
    etree.SubElement(joint, "limit", _NO_LIMIT)
    etree.indent(joint, level=1)
    return joint


def _body(part: ElasticPart, link: Any, material: Any, taken: set[str], where: str) -> Any:
    body = etree.Element("link", name=body_name(part.name))
    inertial = etree.SubElement(body, "inertial")
    etree.SubElement(inertial, "origin", xyz=text_of(part.body.centre - part.origin), rpy="0 0 0")
    etree.SubElement(inertial, "mass", value=text_of((part.body.mass,)))
    moments = {key: text_of(values or ()) for key, values in _moments(part.body).items()}
    etree.SubElement(inertial, "inertia", moments)
    for k, drawn in enumerate(part.drawn):
        if isinstance(drawn, Takes):
            if drawn.shape in taken:
                continue
            taken.add(drawn.shape)
            for element in _shapes(link, drawn.shape, where):
                _shift(element, -part.origin, f"{where}: shape {drawn.shape!r} of link {link.get('name')!r}")
                element.getparent().remove(element)
                body.append(element)
        else:
            _draw(body, drawn, f"part{k + 1}", part.origin, material)
    etree.indent(body, level=1)
    return body


def _shapes(link: Any, name: str, where: str) -> list[Any]:
    """Return the visual and collision shapes of a link that have a name."""
    shapes = [shape for tag in ("visual", "collision") for shape in link.findall(tag)]
    found = [shape for shape in shapes if shape.get("name") == name]
    if not found:
        known = {shape.get("name") for shape in shapes if shape.get("name")}
        raise UnknownNameError(f"{where}: link {link.get('name')!r}", "shape", name, known)
    return found


def _shift(shape: Any, by: np.ndarray, where: str) -> None:
    origin = child_of(shape, "origin")
    text = origin.get("xyz", "0 0 0")
    place = numbers_in(text) or ()
    if len(place) != len(by) or not np.isfinite(place).all():
        raise MechanismError(f"{where}: <origin xyz> must be three finite numbers, got {shown(text)}")
    origin.set("xyz", text_of(np.array(place) + by))


def _material(shapes: Iterable[Any]) -> Any:
    """Return the material of the first shape that has one."""
    found = (shape.find("material") for shape in shapes)
    return next((material for material in found if material is not None), None)


def _draw(link: Any, drawn: Drawn, name: str, origin: np.ndarray, material: Any) -> None:
    """Add a shape, placed in the frame of the split link, to a link whose frame is at an origin there."""
    assert not isinstance(drawn, Takes)
    visual = etree.SubElement(link, "visual", name=name)
    turn = drawn.placement[:3, :3]
    etree.SubElement(
        visual,
        "origin",
        xyz=text_of(drawn.placement[:3, 3] - origin),
        rpy=text_of(roll_pitch_yaw(turn)),
    )
    geometry = etree.SubElement(visual, "geometry")
    if isinstance(drawn, SphereShape):
        etree.SubElement(geometry, "sphere", radius=text_of((drawn.radius,)))
    elif isinstance(drawn, CylinderShape):
        numbers = {"radius": text_of((drawn.radius,)), "length": text_of((drawn.length,))}
        etree.SubElement(geometry, "cylinder", numbers)
    elif isinstance(drawn, BoxShape):
        etree.SubElement(geometry, "box", size=text_of(drawn.size))
    elif isinstance(drawn, MeshShape):
        etree.SubElement(geometry, "mesh", filename=drawn.filename)
    if material is not None:
        name = material.get("name", "")
        visual.append(etree.Element("material", name=name) if name.strip() else copy.deepcopy(material))
        visual[-1].tail = None
