"""The mechanism as a result carries it: its URDF, and where bearings and journals sit on its links.

With it a reader needs neither the scenario nor the files it came from, meshes excepted.
"""

from __future__ import annotations

import dataclasses
import json
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.dynamics import System
from antenna_pin.geometry import PlanarClearance, RevoluteClearance, SphericalClearance
from antenna_pin.joints import ClearanceJoint
from antenna_pin.mechanism import frame_aligning_z

__all__ = ["clearance_places", "mechanism_attributes"]

_KINDS = {RevoluteClearance: "revolute", PlanarClearance: "planar", SphericalClearance: "spherical"}


def mechanism_attributes(system: System) -> dict[str, str]:
    """Return the attributes of a dataset that describe the mechanism.

    ``urdf`` is the text of the variant that was simulated, ``urdf_folder`` the folder of its meshes (empty if
    unknown), ``mechanism`` its base and gravity [m/s^2] and what may have an impossible inertia (JSON), and
    ``clearance_geometry`` what :func:`clearance_places` tells (JSON).
    """
    mechanism = system.mechanism
    return {
        "urdf": mechanism.urdf.to_xml(),
        "urdf_folder": "" if mechanism.urdf.folder is None else str(mechanism.urdf.folder),
        "mechanism": json.dumps(
            {
                "base": mechanism.base,
                "gravity": [float(g) for g in mechanism.model.gravity.linear],
                "allow_impossible_inertia": list(mechanism.urdf.allow_impossible_inertia),
            }
        ),
        "clearance_geometry": json.dumps(clearance_places(system)),
    }


def clearance_places(system: System) -> dict[str, dict[str, Any]]:
    """Return shape and place of every clearance joint, by name.

    Each has ``kind`` (revolute, planar or spherical), ``dimensions`` of its shape [m], ``bearing_body`` and
    ``journal_body`` (links), and ``bearing_placement`` and ``journal_placement``: seven numbers, the frame's
    position [m] and attitude (quaternion xyzw) in that link's frame.
    """
    return {joint.name: _place(system, joint) for joint in system.clearances}


def _place(system: System, joint: ClearanceJoint) -> dict[str, Any]:
    urdf = system.mechanism.urdf
    slot = system.mechanism.joint(joint.name)
    own = np.eye(4)
    if not joint.planar:
        own[:3, :3] = frame_aligning_z(slot.axis)
        own[:3, 3] = joint.offset * own[:3, 2]
    in_child, child = own, urdf.joint(joint.name).child
    links = {link.name: link for link in urdf.robot.links}
    # The massless link of a planar joint carries no shape: what is mounted on it is the journal's body.
    mounts = [other for other in urdf.robot.joints if other.parent == child and other.type == "fixed"]
    if links[child].inertial is None and len(mounts) == 1:
        in_child, child = np.linalg.inv(urdf.placement(mounts[0].name)) @ own, mounts[0].child
    return {
        "kind": _KINDS[type(joint.geometry)],
        "dimensions": dataclasses.asdict(joint.geometry),
        "bearing_body": urdf.joint(joint.name).parent,
        "bearing_placement": _seven(urdf.placement(joint.name) @ own),
        "journal_body": child,
        "journal_placement": _seven(in_child),
    }


def _seven(placement: NDArray[np.float64]) -> list[float]:
    quaternion = Rotation.from_matrix(placement[:3, :3]).as_quat()
    return [*map(float, placement[:3, 3]), *map(float, quaternion)]
