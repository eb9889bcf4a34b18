"""From a URDF and its variants to a Pinocchio model."""

from typing import TYPE_CHECKING

from antenna_pin._lazy import loaded_when_used
from antenna_pin.changes import JOINT_VARIANTS, JointChange, JointVariant, LinkChange, Rotor, ShapeChange

if TYPE_CHECKING:
    from antenna_pin.mechanism._size import check_size
    from antenna_pin.mechanism.dynamics import CHANGE, LANES, ROOM, TreeDynamics
    from antenna_pin.mechanism.frames import (
        frame_aligning_z,
        quaternion,
        quaternions,
        roll_pitch_yaw,
        rotation,
    )
    from antenna_pin.mechanism.kinematics import link_motion, link_poses, link_twists
    from antenna_pin.mechanism.loads import transmitted_wrenches
    from antenna_pin.mechanism.model import WORLD, Base, JointKind, JointSlot, Mechanism, build_mechanism
    from antenna_pin.mechanism.rotors import check_turns, rotor_joint, with_rotor
    from antenna_pin.mechanism.shaken import with_shaken_base
    from antenna_pin.mechanism.tree import BODY, PLACE, body_tree, freedoms_below
    from antenna_pin.mechanism.urdf import Urdf
    from antenna_pin.mechanism.written import PassedOver, WrittenJoint, WrittenUrdf

__all__ = [
    "BODY",
    "CHANGE",
    "JOINT_VARIANTS",
    "Base",
    "JointChange",
    "JointKind",
    "JointSlot",
    "JointVariant",
    "LANES",
    "LinkChange",
    "Mechanism",
    "PLACE",
    "PassedOver",
    "ROOM",
    "Rotor",
    "ShapeChange",
    "TreeDynamics",
    "Urdf",
    "WORLD",
    "WrittenJoint",
    "WrittenUrdf",
    "body_tree",
    "build_mechanism",
    "check_size",
    "check_turns",
    "frame_aligning_z",
    "freedoms_below",
    "link_motion",
    "link_poses",
    "link_twists",
    "quaternion",
    "quaternions",
    "roll_pitch_yaw",
    "rotation",
    "rotor_joint",
    "transmitted_wrenches",
    "with_rotor",
    "with_shaken_base",
]

loaded_when_used(
    __name__,
    {
        "_size": "check_size",
        "dynamics": "CHANGE LANES ROOM TreeDynamics",
        "frames": "frame_aligning_z quaternion quaternions roll_pitch_yaw rotation",
        "kinematics": "link_motion link_poses link_twists",
        "loads": "transmitted_wrenches",
        "model": "WORLD Base JointKind JointSlot Mechanism build_mechanism",
        "rotors": "check_turns rotor_joint with_rotor",
        "shaken": "with_shaken_base",
        "tree": "BODY PLACE body_tree freedoms_below",
        "urdf": "Urdf",
        "written": "PassedOver WrittenJoint WrittenUrdf",
    },
)
