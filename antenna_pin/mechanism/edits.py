"""Changes to the XML of a URDF in place; comments and foreign tags stay."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from lxml import etree

from antenna_pin.base.changes import JOINT_VARIANTS, JointChange, JointVariant, LinkChange, ShapeChange
from antenna_pin.base.directions import unit
from antenna_pin.base.readable import alternatives
from antenna_pin.base.units import shown
from antenna_pin.errors import MechanismError, UnknownNameError
from antenna_pin.mechanism import urdf_xml
from antenna_pin.mechanism.flexible import (
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
from antenna_pin.mechanism.frames import Matrix3, Vector3, frame_aligning_z, of_roll_pitch_yaw, roll_pitch_yaw
from antenna_pin.mechanism.urdf_xml import MOMENTS, SHAPES, numbers_in

# --- single changes -----------------------------------------------------------------------------------------
#
# A comment right behind an element, on its line, says where its numbers come from. It goes when they go,
# and a changed element says what it was.

_HINGES = ("revolute", "continuous")


def plane_names(joint: str) -> tuple[str, str]:
    """Return the names of the massless link and the fixed joint behind a planar joint."""
    return f"{joint}_plane", f"{joint}_plane_mount"


def change_link(robot: Any, name: str, change: LinkChange, where: str) -> None:
    """Write new inertial properties and dimensions into a link."""
    link = element_named(robot, "link", name, where)
    if (change.mass, change.inertia, change.centre_of_mass) != (None, None, None):
        _change_inertial(link, change, where)
    for shape_name, shape_change in change.shapes.items():
        for shape in _shapes(link, shape_name, where):
            _change_shape(shape, shape_change, f"{where}: link {name!r}: shape {shape_name!r}")


def change_joint(robot: Any, name: str, change: JointChange, where: str) -> None:
    """Change origin, axis, bounds and ``<dynamics>`` of a joint, or remove its ``<mimic>``."""
    joint = element_named(robot, "joint", name, where)
    if change.mimic is not None:
        mimic = joint.find("mimic")
        if change.mimic or mimic is None:
            rule = "must be false" if change.mimic else "must be left out, because there is none"
            raise MechanismError(
                f"{where}: joint {name!r}: mimic {rule}, got {str(change.mimic).lower()}; "
                "couple joints by [couplings]"
            )
        remove(mimic)
    origin = {"xyz": change.origin_xyz, "rpy": change.origin_rpy}
    if any(origin.values()):
        set_numbers(child_of(joint, "origin"), origin)
    if change.axis is not None:
        if joint.get("type") == "fixed":
            raise MechanismError(
                f"{where}: joint {name!r} is fixed and has no axis to change, got {change.axis}"
            )
        set_numbers(child_of(joint, "axis"), {"xyz": change.axis})
    _change_bounds(joint, name, change, where)
    dynamics = {
        key: (value,)
        for key, value in (("damping", change.damping), ("friction", change.friction))
        if value is not None
    }
    if dynamics:
        if joint.get("type") not in (*_HINGES, "prismatic"):
            raise MechanismError(
                f"{where}: joint {name!r} is {joint.get('type')} and has no axis for "
                f"{' and '.join(dynamics)}; leave it out"
            )
        set_numbers(child_of(joint, "dynamics"), dynamics)


def _change_bounds(joint: Any, name: str, change: JointChange, where: str) -> None:
    """Write new bounds into ``<limit>``, created where it is missing."""
    if change.lower is None and change.upper is None:
        return
    kind = joint.get("type")
    if kind not in ("revolute", "prismatic"):
        raise MechanismError(
            f"{where}: joint {name!r} is {kind} and has no bounds to change; leave out lower and upper"
        )
    limit = child_of(joint, "limit")
    if not limit.attrib:
        limit.attrib.update(effort="1e9", velocity="1e9")  # of none: other readers want some
    new = {"lower": change.lower, "upper": change.upper}
    kept = {key: numbers_in(limit.get(key)) for key in new}
    both = [kept[key] if value is None else (value,) for key, value in new.items()]
    if not all(both):
        raise MechanismError(
            f"{where}: joint {name!r} has no other bound: lower and upper must be given together"
        )
    low, high = (numbers[0] for numbers in both if numbers)
    if not low < high:
        raise MechanismError(
            f"{where}: joint {name!r}: lower must be below upper, got {low:g} and {high:g}; change both"
        )
    set_numbers(limit, {key: None if value is None else (value,) for key, value in new.items()})


def vary_joint(
    robot: Any, joint: Any, variant: JointVariant, axis: Vector3, origin: Matrix3, where: str
) -> None:
    """Make a joint ideal, free, locked or planar, by axis (3,) and rotation (3, 3)."""
    name, kind = joint.get("name"), joint.get("type")
    if variant == "ideal":
        if kind in ("floating", "planar"):
            raise MechanismError(
                f"{where}: joint {name!r} is {kind} and has no ideal form; start from a URDF where it is a "
                f"hinge"
            )
        return
    allowed = {"planar": _HINGES, "free": (*_HINGES, "prismatic")}.get(variant)
    if allowed is not None and kind not in allowed:
        raise MechanismError(
            f"{where}: joint {name!r} is {kind}; only a {alternatives(allowed)} joint can become {variant}, "
            f"because its axis is the bearing's"
        )
    tags = ("limit", "dynamics", "safety_controller", "calibration")
    for tag in (*tags, "mimic") if variant == "locked" else tags:
        for element in joint.findall(tag):
            remove(element)
    if variant == "locked":
        joint.set("type", "fixed")
    elif variant == "free":
        joint.set("type", "floating")  # keeps <axis>, which says where the bearing's axis is
    else:
        make_planar(robot, joint, axis, origin, where)
    if kind != joint.get("type"):
        note = etree.Comment(f" antenna_pin: {variant}; was {kind} ")
        note.tail = joint.text
        joint.insert(0, note)


def relocate_meshes(robot: Any, resolve: Any) -> None:
    """Rename the files of all meshes by ``resolve(filename) -> str``."""
    for mesh in meshes(robot):
        mesh.set("filename", resolve(mesh.get("filename")))


def meshes(robot: Any) -> list[Any]:
    """Return the meshes of all shapes that have a file name."""
    return [mesh for mesh in robot.iterfind("link/*/geometry/mesh") if mesh.get("filename", "").strip()]


def make_planar(robot: Any, joint: Any, axis: Vector3, origin: Matrix3, where: str) -> None:
    """Align a joint frame's z with its axis, and align back behind a massless link.

    The fixed joint keeps the axis as it was, in the axes of the frame as it was: a reader finds both again.
    """
    link_name, mount_name = plane_names(joint.get("name"))
    refuse_taken(robot, mount_name, link_name, where, "to make a joint planar; rename yours")
    rotation = frame_aligning_z(axis)
    child = joint.find("child").get("link")
    joint.set("type", "planar")
    joint.find("child").set("link", link_name)
    set_numbers(child_of(joint, "origin"), {"rpy": roll_pitch_yaw(origin @ rotation)})
    set_numbers(child_of(joint, "axis"), {"xyz": (0.0, 0.0, 1.0)})
    link = etree.Element("link", name=link_name)
    origin_of_mount = origin_at((0.0, 0.0, 0.0), roll_pitch_yaw(rotation.T))
    mount = new_joint(mount_name, "fixed", link_name, child, origin_of_mount, axis)
    etree.indent(mount, level=1)
    for element in (mount, link):
        element.tail = joint.tail
        joint.addnext(element)


def _change_inertial(link: Any, change: LinkChange, where: str) -> None:
    inertial = link.find("inertial")
    if inertial is None:
        if change.mass is None or change.inertia is None:
            raise MechanismError(
                f"{where}: link {link.get('name')!r} has no <inertial>: "
                "an override must give both mass and inertia"
            )
        inertial = child_of(link, "inertial")
    if change.centre_of_mass is not None:
        set_numbers(child_of(inertial, "origin"), {"xyz": change.centre_of_mass})
    if change.mass is not None:
        set_numbers(child_of(inertial, "mass"), {"value": (change.mass,)})
    if change.inertia is not None:
        values = (*change.inertia, 0.0, 0.0, 0.0)
        set_numbers(
            child_of(inertial, "inertia"),
            {key: (value,) for key, value in zip(MOMENTS, values, strict=False)},
        )


def _change_shape(shape: Any, change: ShapeChange, place: str) -> None:
    geometry = next(iter(shape.iterfind("geometry/*")), None)
    if geometry is None or geometry.tag not in SHAPES:
        got = "none" if geometry is None else f"<{geometry.tag}>"
        raise MechanismError(f"{place} must hold one of {', '.join(SHAPES)}, got {got}")
    known = SHAPES[geometry.tag]
    new: dict[str, Iterable[float] | None] = {"size": change.size}
    for key, value in (("radius", change.radius), ("length", change.length)):
        new[key] = None if value is None else (value,)
    for key in new:
        if new[key] is not None and key not in known:
            has = ", ".join(known) or "only its file; make another one"
            raise MechanismError(f"{place}: a {geometry.tag} has no {key} to change; it has {has}")
    set_numbers(geometry, new)


def element_named(robot: Any, kind: str, name: str, where: str) -> Any:
    """Return a link or joint by name, or refuse an unknown name."""
    known = {str(element.get("name")): element for element in robot.findall(kind)}
    if name not in known:
        raise UnknownNameError(where, kind, name, known)
    return known[name]


def refuse_taken(robot: Any, joint: str, link: str, where: str, purpose: str) -> None:
    """Refuse names of a new joint and a new link that the URDF has already."""
    for kind, name in (("link", link), ("joint", joint)):
        if any(element.get("name") == name for element in robot.findall(kind)):
            raise MechanismError(f"{where}: {kind} name {name!r} is needed {purpose}")


def origin_at(xyz: Iterable[float], rpy: Iterable[float] = (0.0, 0.0, 0.0)) -> dict[str, str]:
    """Return the attributes of an origin [m], [rad]."""
    return {"xyz": text_of(xyz), "rpy": text_of(rpy)}


def new_joint(
    name: str, kind: str, parent: str, child: str, origin: Mapping[str, str] | None, axis: Any
) -> Any:
    """Return a joint with attributes of an origin and an axis (3,), None for none."""
    joint = etree.Element("joint", name=name, type=kind)
    etree.SubElement(joint, "parent", link=parent)
    etree.SubElement(joint, "child", link=child)
    if origin is not None:
        etree.SubElement(joint, "origin", dict(origin))
    if axis is not None:
        etree.SubElement(joint, "axis", xyz=text_of(axis))
    return joint


def insert_behind(element: Any, *others: Any) -> Any:
    """Insert elements behind an element, each after an empty line; return the last."""
    for other in others:
        other.tail, element.tail = element.tail, "\n\n  "
        element.addnext(other)
        element = other
    return element


def child_of(element: Any, tag: str) -> Any:
    """Return the child with a tag, created where it is missing."""
    child = element.find(tag)
    if child is None:
        child = etree.SubElement(element, tag)
        before = child.getprevious()
        if before is not None:  # keep the text as it was laid out
            child.tail, before.tail = before.tail, element.text
    return child


def set_numbers(element: Any, new: Mapping[str, Iterable[float] | None]) -> None:
    """Write numbers into attributes, and the old ones into the comment behind."""
    was = []
    for key, values in new.items():
        if values is not None:
            was.append(f'{key}="{element.get(key)}"' if key in element.attrib else f"without {key}")
            element.set(key, text_of(values))
    if was:
        _remove_remark(element)
        remark = etree.Comment(f" antenna_pin: was {' '.join(was)} ")
        remark.tail, element.tail = element.tail, " "
        element.addnext(remark)


def _remove_remark(element: Any) -> None:
    """Remove the comment behind an element on its line."""
    after = element.getnext()
    if after is not None and after.tag is etree.Comment and "\n" not in (element.tail or ""):
        element.tail = after.tail
        after.tail = None
        element.getparent().remove(after)


def remove(element: Any) -> None:
    """Remove an element and its remark without change of the text's layout."""
    _remove_remark(element)
    before, parent = element.getprevious(), element.getparent()
    if before is not None:
        before.tail = element.tail
    else:
        parent.text = element.tail
    parent.remove(element)


def text_of(values: Iterable[float] | Vector3) -> str:
    """Return numbers as text that reads back to the same bits."""
    return " ".join(repr(float(value)) for value in np.asarray(tuple(values), dtype=np.float64) + 0.0)


# --- elastic parts of links ---------------------------------------------------------------------------------


def body_name(part: str) -> str:
    """Return the name of the link that an elastic part is."""
    return f"{part}_body"


def add_parts(robot: Any, link_name: str, split: SplitLink, where: str) -> None:
    """Reduce a link to its hub, and attach its elastic parts, each with a joint."""
    link = element_named(robot, "link", link_name, where)
    _write_hub(link, split.hub)
    replaced = [element for shape in split.removes for element in _shapes(link, shape, where)]
    material = _material(replaced or link.findall("visual"))
    for element in replaced:
        remove(element)
    for k, drawn in enumerate(split.hub_shapes):
        _draw(link, drawn, f"hub{k + 1}", np.zeros(3), material)
    last = link
    moved: set[str] = set()  # a shape that several parts move is on the first
    purpose = f"for an elastic part of link {link_name!r}; rename yours, or the part"
    for part in split.parts:
        refuse_taken(robot, part.name, body_name(part.name), where, purpose)
        body = _body(part, link, material, moved, where)
        last = insert_behind(last, _joint(part, link_name), body)


def _write_hub(link: Any, hub: MassProperties) -> None:
    inertial = child_of(link, "inertial")
    set_numbers(child_of(inertial, "origin"), {"xyz": hub.centre, "rpy": (0.0, 0.0, 0.0)})
    set_numbers(child_of(inertial, "mass"), {"value": (hub.mass,)})
    set_numbers(child_of(inertial, "inertia"), moments_of(hub.inertia))


def moments_of(inertia: np.ndarray) -> dict[str, Iterable[float] | None]:
    """Return the moments of an inertia (3, 3), by the attributes of URDF."""
    values = (*np.diag(inertia), inertia[0, 1], inertia[0, 2], inertia[1, 2])
    return {key: (float(value),) for key, value in zip(MOMENTS, values, strict=True)}


def _joint(part: ElasticPart, parent: str) -> Any:
    kind, per = ("prismatic", ("N/m", "N s/m")) if part.slides else ("revolute", ("N m/rad", "N m s/rad"))
    joint = new_joint(part.name, kind, parent, body_name(part.name), origin_at(part.origin), part.axis)
    note = (
        f" antenna_pin: held at zero by a spring of {part.stiffness!r} {per[0]}, "
        f"with a damper of {part.damping!r} {per[1]} "
    )
    joint.insert(0, etree.Comment(note))
    etree.SubElement(joint, "limit", urdf_xml.NO_LIMIT)
    etree.indent(joint, level=1)
    return joint


def _body(part: ElasticPart, link: Any, material: Any, moved: set[str], where: str) -> Any:
    body = etree.Element("link", name=body_name(part.name))
    inertial = etree.SubElement(body, "inertial")
    etree.SubElement(inertial, "origin", xyz=text_of(part.body.centre - part.origin), rpy="0 0 0")
    etree.SubElement(inertial, "mass", value=text_of((part.body.mass,)))
    moments = {key: text_of(values or ()) for key, values in moments_of(part.body.inertia).items()}
    etree.SubElement(inertial, "inertia", moments)
    for k, drawn in enumerate(part.drawn):
        if isinstance(drawn, Takes):
            if drawn.shape in moved:
                continue
            moved.add(drawn.shape)
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
    """Add a shape, placed in the split link's frame, to a part at an origin."""
    assert not isinstance(drawn, Takes)
    visual = etree.SubElement(link, "visual", name=name)
    turn = drawn.placement[:3, :3]
    etree.SubElement(visual, "origin", origin_at(drawn.placement[:3, 3] - origin, roll_pitch_yaw(turn)))
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


# --- variants -----------------------------------------------------------------------------------------------


def edited(
    text: str,
    where: str,
    joints: Mapping[str, JointVariant] | None = None,
    links: Mapping[str, LinkChange] | None = None,
    origins: Mapping[str, JointChange] | None = None,
) -> Any:
    """Return the root element of a changed URDF, with line numbers of the text.

    Raises:
        MechanismError: The text is no URDF, or a change makes no sense.
        UnknownNameError: A link or joint that it does not have.
    """
    robot = urdf_xml.read(text, where)
    for name, link_change in (links or {}).items():
        change_link(robot, name, link_change, where)
    for name, joint_change in (origins or {}).items():
        change_joint(robot, name, joint_change, where)
    for name, kind in (joints or {}).items():
        joint = element_named(robot, "joint", name, where)
        if kind not in JOINT_VARIANTS:
            raise UnknownNameError(f"{where}: joint {name!r}", "kind", str(kind), JOINT_VARIANTS)
        axis, turn = np.array([1.0, 0.0, 0.0]), np.eye(3)
        if kind in ("free", "planar") and joint.get("type") in urdf_xml.WITH_AXIS:
            # Axis and friction are those of a bearing from here on, and the joint has none to be judged by.
            axis = unit(urdf_xml.axis_of(joint, where))
            urdf_xml.check_dynamics(joint, where)
            turn = of_roll_pitch_yaw(*urdf_xml.check_origin(joint, where))
        vary_joint(robot, joint, kind, axis, turn, where)
    return robot


def turn_planes(robot: Any, where: str) -> None:
    """Turn frames of planar joints so that z, which Pinocchio takes, is the normal."""
    for joint in robot.findall("joint"):
        if joint.get("type") == "planar":
            axis = unit(urdf_xml.axis_of(joint, where))
            if np.any(axis[:2] != 0.0) or axis[2] < 0.0:
                turn = of_roll_pitch_yaw(*urdf_xml.check_origin(joint, where))
                make_planar(robot, joint, axis, turn, where)
