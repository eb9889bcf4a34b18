"""All changes of a variant, made on the XML in their order, before anything judges its mechanics."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from antenna_pin.base.changes import JOINT_VARIANTS, JointChange, JointVariant, LinkChange
from antenna_pin.base.directions import unit
from antenna_pin.errors import UnknownNameError
from antenna_pin.mechanism import _edits, _xml
from antenna_pin.mechanism._plain import WITH_AXIS
from antenna_pin.mechanism.frames import of_roll_pitch_yaw

__all__ = ["edited", "turn_planes"]


def edited(
    text: str,
    where: str,
    joints: Mapping[str, JointVariant] | None = None,
    links: Mapping[str, LinkChange] | None = None,
    origins: Mapping[str, JointChange] | None = None,
) -> Any:
    """Return the root element of a URDF with changes made; elements know their lines in the text.

    Args:
        text: The XML.
        where: Name of the file, for messages.
        joints: What to make of joints, by name.
        links: New inertial properties and shapes, by link.
        origins: New places, axes and bounds of joints, applied before ``joints``.

    Raises:
        MechanismError: The text is no URDF, or a change makes no sense.
        UnknownNameError: A link or joint that it does not have.
    """
    robot = _xml.read(text, where)
    for name, link_change in (links or {}).items():
        _check_known(robot, where, "link", name)
        _edits.change_link(robot, name, link_change, where)
    for name, joint_change in (origins or {}).items():
        _check_known(robot, where, "joint", name)
        _edits.change_joint(robot, name, joint_change, where)
    for name, kind in (joints or {}).items():
        _check_known(robot, where, "joint", name)
        if kind not in JOINT_VARIANTS:
            raise UnknownNameError(f"{where}: joint {name!r}", "kind", str(kind), JOINT_VARIANTS)
        axis, turn = np.array([1.0, 0.0, 0.0]), np.eye(3)
        joint = _edits.named(robot, "joint", name)
        if kind in ("free", "planar") and joint.get("type") in WITH_AXIS:
            # Axis and friction are those of a bearing from here on, and the joint has none to be judged by.
            axis = unit(_xml.axis_of(joint, where))
            _xml.check_dynamics(joint, where)
            turn = of_roll_pitch_yaw(*_xml.check_origin(joint, where))
        _edits.vary_joint(robot, name, kind, axis, turn, where)
    return robot


def turn_planes(robot: Any, where: str) -> None:
    """Give planar joints of which the normal is not their frame's z a frame of which it is.

    Pinocchio takes z, whatever the axis says.

    Args:
        robot: Root element, changed in place; its numbers have been judged.
        where: Name of the file, for messages.
    """
    for joint in robot.findall("joint"):
        if joint.get("type") == "planar":
            axis = unit(_xml.axis_of(joint, where))
            if np.any(axis[:2] != 0.0) or axis[2] < 0.0:
                turn = of_roll_pitch_yaw(*_xml.check_origin(joint, where))
                _edits.make_planar(robot, joint, axis, turn, where)


def _check_known(robot: Any, where: str, kind: str, name: str) -> None:
    known = [str(element.get("name")) for element in robot.findall(kind)]
    if name not in known:
        raise UnknownNameError(where, kind, name, known)
