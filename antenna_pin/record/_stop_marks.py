"""Stops and latches, drawn at their joints: wedges at the limits, a pin in the window, coloured by mode.

A wedge stands on the joint's parent where a pointer on the child comes to it at the limit, a pin where the
latch holds. Of each there are two in one place: one in the colour of rest, one in that of a stop that is
touched or a latch that holds; which of them is seen moves with the run.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.analysis import mechanism_of
from antenna_pin.mechanism import frame_aligning_z
from antenna_pin.record.scene import Scene, packed_floats
from antenna_pin.record.shapes import Box, Cylinder, Geometry
from antenna_pin.trajectory import Trajectory, elements_of

__all__ = ["mark_stops"]

Array = NDArray[np.float64]

STOP, TOUCHED = "#4D5866", "#D55E00"
LATCH, HELD = "#56B4E9", "#009E73"
_POINTER = "#2B3440"

# As shares of the mechanism's size: where pointer and stops are from the axis, sizes of a wedge (across the
# way, along the axis, along the way), of the pointer, and of a pin (radius, length).
_REACH = 0.07
_WEDGE = (0.035, 0.02, 0.008)
_THIN = 0.006
_PIN = (0.006, 0.03)
_HELD_MODE = 2  # of a latch
_SMALLEST = 1e-6  # a part that is not seen is so small; none at all would have no inverse


def mark_stops(
    run: Trajectory, samples: NDArray[np.intp], scene: Scene, paths: Mapping[str, str], size: float
) -> tuple[dict[str, Any] | None, list[dict[str, Any]]]:
    """Put marks at joints with stops or latches; return what the player lists of them, and their tracks.

    Args:
        run: The run.
        samples: Those that are key frames.
        scene: What they are put into.
        paths: Of the links in the scene, by name.
        size: Of the mechanism [m].
    """
    found: list[str] = []
    tracks: list[dict[str, Any]] = []
    pointed: set[str] = set()
    joints = mechanism_of(run).joints
    for place, one in elements_of(run.data).items():
        if not place.startswith(("stops.", "latches.")) or one["joint"] not in joints:
            continue
        marks = _Marks(run, one, scene, paths, size)
        mode = np.asarray(run.data["element_mode"].sel(element=place).values)[samples]
        name = place.replace("/", " ")
        if one["joint"] not in pointed:
            pointed.add(one["joint"])
            found.append(marks.pointer(f"pointer {one['joint']}"))
        for what, seat, shape, colours, active in _parts(place, one, size, mode):
            for colour, seen in zip(colours, (~active, active), strict=True):
                path, track = marks.put(f"{name} {what} {colour[1:]}", seat, shape, colour, seen)
                found.append(path)
                tracks.append(track)
    if not found:
        return None, []
    words = "stops (orange: touched) and latches (green: holding)"
    return {"text": words, "colour": STOP, "paths": found}, tracks


def _parts(
    place: str, one: Mapping[str, Any], size: float, mode: NDArray[Any]
) -> list[tuple[str, float, Geometry, tuple[str, str], NDArray[np.bool_]]]:
    """Return of each part: its name, where it is, its shape, its colours, and when it is touched or holds."""
    numbers = one["numbers"]
    if place.startswith("latches."):
        pin = Cylinder(_PIN[0] * size, _PIN[1] * size)
        return [("pin", numbers["angle"], pin, (LATCH, HELD), mode == _HELD_MODE)]
    wedge = Box(tuple(share * size for share in _WEDGE))  # type: ignore[arg-type]
    return [
        (side, numbers[side], wedge, (STOP, TOUCHED), mode == number)
        for number, side in ((1, "lower"), (2, "upper"))
        if side in numbers
    ]


class _Marks:
    """Where the marks of one joint go."""

    def __init__(
        self, run: Trajectory, one: Mapping[str, Any], scene: Scene, paths: Mapping[str, str], size: float
    ) -> None:
        mechanism = mechanism_of(run)
        joint = mechanism.urdf.joint(one["joint"])
        self.scene, self.size, self.slides = scene, size, bool(one["slides"])
        axis = np.eye(4)
        axis[:3, :3] = frame_aligning_z(np.asarray(mechanism.joint(one["joint"]).axis, dtype=float))
        self.in_child = axis
        self.in_parent: Array = np.asarray(mechanism.urdf.placement(one["joint"])) @ axis
        self.parent = paths.get(joint.parent, "stops")
        self.child = paths.get(joint.child, "stops")

    def _seat(self, way: float) -> Array:
        """Return where something sits at an angle (or a way) of the joint, in the frame of its axis."""
        found = np.eye(4)
        reach = np.array([_REACH * self.size, 0.0, 0.0])
        if self.slides:
            found[:3, 3] = reach + np.array([0.0, 0.0, way])
            return found
        found[:3, :3] = Rotation.from_rotvec([0.0, 0.0, way]).as_matrix()
        found[:3, 3] = found[:3, :3] @ reach
        return found

    def pointer(self, name: str) -> str:
        """Draw a bar on the child, from the axis to the stops; return its path."""
        path = f"{self.child}/{name}"
        middle = np.eye(4)
        middle[0, 3] = 0.5 * _REACH * self.size
        bar = Box((_REACH * self.size, _THIN * self.size, _THIN * self.size))
        self.scene.add(path, bar, _rgb(_POINTER), self.in_child @ middle)
        return path

    def put(
        self, name: str, way: float, shape: Geometry, colour: str, seen: NDArray[np.bool_]
    ) -> tuple[str, dict[str, Any]]:
        """Draw a part on the parent; return its path, and the track by which it is seen or not."""
        path = f"{self.parent}/{name}"
        place = self.in_parent @ self._seat(way)
        self.scene.add(f"{path}/part", shape, _rgb(colour))
        scale = np.where(seen, 1.0, _SMALLEST)
        data = np.empty((len(seen), 3, 4))
        data[:, :, :3] = scale[:, None, None] * place[None, :3, :3]
        data[:, :, 3] = place[None, :3, 3]
        return path, {"kind": "matrix", "name": name, "path": path, "data": packed_floats(data)}


def _rgb(colour: str) -> tuple[float, float, float]:
    red, green, blue = (int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5))
    return red, green, blue
