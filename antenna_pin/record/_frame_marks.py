"""Frames of the links: x red, y green, z blue, as in the corner."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from antenna_pin.record._marking import Mark, Marking, rgb
from antenna_pin.record.shapes import Cylinder

__all__ = ["mark_frames"]

_AXES = (("x", "#A02338", [0, 90, 0]), ("y", "#1B7837", [-90, 0, 0]), ("z", "#2F5FA8", [0, 0, 0]))
_AXIS = (0.0016, 0.06)  # radius and length, as shares of the mechanism's size


def mark_frames(marking: Marking) -> Mark | None:
    """Put its axes on each link; hidden at first.

    Args:
        marking: What it is made of.
    """
    radius, length = (share * marking.size for share in _AXIS)
    found = []
    for path in marking.paths.values():
        found.append(f"{path}/frame")
        for name, colour, turn in _AXES:
            place = np.eye(4)
            place[:3, :3] = Rotation.from_euler("xyz", turn, degrees=True).as_matrix()
            place[:3, 3] = 0.5 * length * place[:3, 2]
            marking.scene.add(
                f"{path}/frame/{name}",
                Cylinder(radius, length),
                rgb(colour),
                place,
                unlit=True,
                depthTest=False,
            )
    return Mark("frames of links: x red, y green, z blue", "#2F5FA8", tuple(found), shown=False)
