"""Shaken base: joints between the world and the root of a URDF, with prescribed motions.

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
from antenna_pin.elements import Shake
from antenna_pin.errors import MechanismError
from antenna_pin.mechanism import urdf_xml
from antenna_pin.mechanism.edits import body_name, text_of
from antenna_pin.mechanism.inertia import rigid_groups
from antenna_pin.mechanism.urdf import Urdf

__all__ = ["with_shaken_base"]

_WORLD = "world"
# URDF wants limits. These are none: nothing gets there.
_NO_LIMIT = {"lower": "-1e9", "upper": "1e9", "effort": "1e9", "velocity": "1e9"}
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
    made: list[Any] = [etree.Element("link", name=_WORLD)]
    parent = _WORLD
    for k, shake in enumerate(ordered):
        last = k == len(ordered) - 1
        child = base if last and shake.slides else body_name(shake.joint)
        kind, way = ("prismatic", shake.direction) if shake.slides else ("revolute", shake.axis)
        point = np.array(shake.point or (0.0, 0.0, 0.0))
        made.append(_joint(shake.joint, kind, parent, child, point, way))
        if child != base:
            made.append(etree.Element("link", name=child))
        parent = child
        if not shake.slides:
            mount = f"{shake.joint}_mount"
            child = base if last else f"{mount}_body"
            made.append(_joint(mount, "fixed", parent, child, -point, None))
            if not last:
                made.append(etree.Element("link", name=child))
            parent = child
    for k, element in enumerate(made):
        etree.indent(element, level=1)
        element.tail = "\n\n  "
        robot.insert(k, element)
    return replace(urdf, text=urdf_xml.write(robot))


def _joint(name: str, kind: str, parent: str, child: str, place: Any, way: Any) -> Any:
    """Return a joint of a URDF."""
    made = etree.Element("joint", name=name, type=kind)
    etree.SubElement(made, "parent", link=parent)
    etree.SubElement(made, "child", link=child)
    if np.any(place):
        etree.SubElement(made, "origin", xyz=text_of(place), rpy=text_of((0.0, 0.0, 0.0)))
    if way is not None:
        etree.SubElement(made, "axis", xyz=text_of(way))
        etree.SubElement(made, "limit", **_NO_LIMIT)
    return made


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
    taken = {one.name for one in urdf.robot.links} | {one.name for one in urdf.robot.joints}
    for name, shake in shakes.items():
        for own in (shake.joint, body_name(shake.joint), f"{shake.joint}_mount"):
            if own in taken:
                raise MechanismError(
                    f"{place}: name {own!r} is needed to shake the base by {name!r}, and the URDF has it; "
                    "rename the motion"
                )
            taken.add(own)
    for slides, what in ((True, "directions"), (False, "axes")):
        ways = [one.direction if slides else one.axis for one in shakes.values() if one.slides == slides]
        if not ways:
            continue
        unit = np.array(ways, dtype=float)
        unit /= np.linalg.norm(unit, axis=1)[:, None]
        least = np.linalg.svd(unit, compute_uv=False)[-1] if len(unit) <= 3 else 0.0
        if not least > _INDEPENDENT:
            names = ", ".join(name for name, one in shakes.items() if one.slides == slides)
            raise MechanismError(
                f"{place}: {what} in which a base is shaken must be independent, which those of {names} are "
                "not; make one motion of those that go the same way"
            )
