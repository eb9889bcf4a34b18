"""Where loops are closed, drawn as small marks on the links: a pin along the axis, or a ball."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.analysis import closures_of
from antenna_pin.record.scene import Scene
from antenna_pin.record.shapes import Cylinder, Geometry, Sphere
from antenna_pin.trajectory import Trajectory

__all__ = ["CLOSURE", "mark_closures"]

CLOSURE = "#7A3E9D"

# Of a mark, as shares of the mechanism's size: a pin's radius and length, a ball's radius.
_PIN = (0.003, 0.06)
_BALL = 0.006


def mark_closures(
    run: Trajectory, scene: Scene, paths: Mapping[str, str], joints: Mapping[str, Any], size: float
) -> dict[str, Any] | None:
    """Put a mark on each closure of a loop; return what the player lists of them, None without one.

    A mark moves with the second side's link, or stands where that is the world; both sides are in one place.
    Closures that hold a joint of the tree close no loop of their own, and have no mark.

    Args:
        run: The run.
        scene: What they are put into.
        paths: Of the links in the scene, by name.
        joints: Of the tree, by name.
        size: Of the mechanism [m].
    """
    colour = tuple(int(CLOSURE[k : k + 2], 16) / 255 for k in (1, 3, 5))
    found = []
    for name, closure in closures_of(run).items():
        if name in joints:
            continue
        side = "second" if closure["second_body"] in paths else "first"
        on = paths.get(closure[f"{side}_body"], "closures")
        place: NDArray[np.float64] = np.eye(4)
        seven = np.array(closure[f"{side}_placement"], dtype=float)
        place[:3, 3], place[:3, :3] = seven[:3], Rotation.from_quat(seven[3:]).as_matrix()
        pin = closure["axis"] and closure["kind"] != "universal"
        shape: Geometry = Cylinder(_PIN[0] * size, _PIN[1] * size) if pin else Sphere(_BALL * size)
        found.append(f"{on}/closure {name}")
        scene.add(found[-1], shape, (*colour, 0.85), place, unlit=True, depthTest=False)
    if not found:
        return None
    words = "closure of a loop" if len(found) == 1 else f"{len(found)} closures of loops"
    return {"text": words, "colour": CLOSURE, "paths": found}
