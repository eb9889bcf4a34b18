"""Where loops are closed, drawn as small marks on the links: a pin along the axis, or a ball."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.analysis import closures_of
from antenna_pin.record._marking import Label, Mark, Marking, rgb
from antenna_pin.record.shapes import Cylinder, Geometry, Sphere

__all__ = ["CLOSURE", "mark_closures"]

CLOSURE = "#8C8C1E"

# Of a mark, as shares of the mechanism's size: a pin's radius and length, a ball's radius.
_PIN = (0.003, 0.06)
_BALL = 0.006


def mark_closures(marking: Marking) -> Mark | None:
    """Put a mark on each closure of a loop.

    A mark moves with the second side's link, or stands where that is the world; both sides are in one place.
    Closures that hold a joint of the tree close no loop of their own, and have no mark.

    Args:
        marking: What it is made of.
    """
    size = marking.size
    found, labels = [], []
    for name, closure in closures_of(marking.run).items():
        if name in marking.mechanism.joints:
            continue
        side = "second" if closure["second_body"] in marking.paths else "first"
        on = marking.path(closure[f"{side}_body"])
        place: NDArray[np.float64] = np.eye(4)
        seven = np.array(closure[f"{side}_placement"], dtype=float)
        place[:3, 3], place[:3, :3] = seven[:3], Rotation.from_quat(seven[3:]).as_matrix()
        pin = closure["axis"] and closure["kind"] != "universal"
        shape: Geometry = Cylinder(_PIN[0] * size, _PIN[1] * size) if pin else Sphere(_BALL * size)
        found.append(f"{on}/closure {name}")
        x, y, z = map(float, seven[:3])
        labels.append(Label(name, on, (x, y, z)))
        marking.scene.add(found[-1], shape, (*rgb(CLOSURE), 0.85), place, unlit=True, depthTest=False)
    if not found:
        return None
    words = "closure of a loop" if len(found) == 1 else f"{len(found)} closures of loops"
    return Mark(words, CLOSURE, tuple(found), labels=tuple(labels))
