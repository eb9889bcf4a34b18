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

from antenna_pin.mechanism import frame_aligning_z
from antenna_pin.record._marking import Mark, Marking, rgb
from antenna_pin.record.scene import packed_doubles
from antenna_pin.record.shapes import Box, Cylinder, Geometry
from antenna_pin.trajectory import elements_of

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


def mark_stops(marking: Marking) -> Mark | None:
    """Put marks at joints with stops or latches.

    Args:
        marking: What they are made of.
    """
    run = marking.run
    found: list[str] = []
    tracks: list[dict[str, Any]] = []
    pointed: set[str] = set()
    for place, one in elements_of(run.data).items():
        joint = one["joint"]
        if not place.startswith(("stops.", "latches.")) or joint not in marking.mechanism.joints:
            continue
        marks = _Marks(marking, joint, bool(one["slides"]))
        mode = np.asarray(run.data["element_mode"].sel(element=place).values)[marking.samples]
        name = place.replace("/", " ")
        if joint not in pointed:
            pointed.add(joint)
            found.append(marks.pointer(f"pointer {joint}"))
        for what, seat, shape, colours, active in _parts(place, one, marking.size, mode):
            path = f"{marks.parent}/{name} {what}"
            found.append(path)
            for colour, seen in zip(colours, (~active, active), strict=True):
                tracks.append(marks.put(f"{path}/{colour[1:]}", seat, shape, colour, seen))
    if not found:
        return None
    words = "stops (orange: touched) and latches (green: holding)"
    return Mark(words, STOP, tuple(found), tuple(tracks))


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

    def __init__(self, marking: Marking, joint: str, slides: bool) -> None:
        self.scene, self.size, self.slides = marking.scene, marking.size, slides
        self.times = marking.times
        self.parent, self.in_parent = marking.seat(joint)
        self.in_child = np.eye(4)
        self.in_child[:3, :3] = frame_aligning_z(np.asarray(marking.mechanism.joint(joint).axis, dtype=float))
        self.child = marking.path(marking.mechanism.urdf.joint(joint).child)

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
        self.scene.add(path, bar, rgb(_POINTER), self.in_child @ middle)
        return path

    def put(
        self, path: str, way: float, shape: Geometry, colour: str, seen: NDArray[np.bool_]
    ) -> dict[str, Any]:
        """Draw a part on the parent; return the track by which it is seen or not."""
        self.scene.add(path, shape, rgb(colour), self.in_parent @ self._seat(way))
        changes = self.times[np.flatnonzero(np.diff(seen, prepend=False))]
        return {
            "kind": "shown",
            "name": path.rpartition("/")[0],
            "path": path,
            "data": packed_doubles(changes),
        }
