"""Springs: a coil about the axis of each joint that has one, and one between two points that follows them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.record._marking import Label, Mark, Marking, rgb
from antenna_pin.record.scene import packed_floats
from antenna_pin.record.shapes import Mesh, grid

__all__ = ["SPRING", "mark_springs"]

Array = NDArray[np.float64]

SPRING = "#117733"

# As shares of the mechanism's size: radius and length of a coil about a joint, radius of one between points,
# radius of the wire.
_COIL = (0.012, 0.03)
_ASIDE = 0.045  # along the axis, from the joint, where stops and latches are
_BETWEEN = 0.009
_WIRE = 0.0018
_TURNS, _STEPS, _SIDES = 4, 24, 6  # of a coil; of each of its turns; of the wire
_NO_SPRINGS = ("friction",)  # kinds that stand among the springs of a scenario


def mark_springs(marking: Marking) -> Mark | None:
    """Draw the springs of the run's scenario; a run of a system built in Python does not say which it has.

    Args:
        marking: What it is made of.
    """
    springs: dict[str, Any] = getattr(marking.run.scenario, "springs", None) or {}
    size = marking.size
    found, tracks, labels = [], [], []
    for name, spring in springs.items():
        if getattr(spring, "kind", "") in _NO_SPRINGS:
            continue
        joint = getattr(spring, "joint", None) or name
        if joint in marking.mechanism.joints:
            on, place = marking.seat(joint)
            found.append(f"{on}/spring {name}")
            aside = place.copy()
            aside[:3, 3] += _ASIDE * size * place[:3, 2]
            shape = coil(_COIL[0] * size, _COIL[1] * size, _WIRE * size)
            marking.scene.add(found[-1], shape, rgb(SPRING), aside)
            continue
        first, second = (_places(marking, getattr(spring, side, None)) for side in ("first", "second"))
        if first is None or second is None:
            continue
        found.append(f"world/spring {name}")
        marking.scene.add(f"{found[-1]}/coil", coil(_BETWEEN * size, 1.0, _WIRE * size), rgb(SPRING))
        data = packed_floats(_between(first, second).reshape(-1, 12))
        tracks.append({"kind": "matrix", "name": f"spring {name}", "path": found[-1], "data": data})
        labels.append(Label(name, found[-1], (0.0, 0.0, 0.5)))
    if not found:
        return None
    return Mark("springs", SPRING, tuple(found), tuple(tracks), labels=tuple(labels))


def _places(marking: Marking, side: Any) -> Array | None:
    """Return where one end of a spring is at the key frames, (frames, 3) [m]; None if not known."""
    link = getattr(side, "link", None) or getattr(side, "frame", None)
    if link is None:
        return None
    point = np.asarray(side.point if side.point is not None else (0.0, 0.0, 0.0), dtype=float)
    if link == "world":
        return np.broadcast_to(point, (len(marking.samples), 3))
    if link not in marking.paths:
        return None
    k = list(marking.paths).index(link)
    turned = Rotation.from_quat(marking.attitude[:, k]).apply(point)
    return np.asarray(marking.position[:, k] + turned)


def _between(first: Array, second: Array) -> Array:
    """Return the placements that lay z from 0 to 1 along lines between points, (n, 3, 4)."""
    along = second - first
    level = np.abs(along[:, :1]) < 0.9 * np.linalg.norm(along, axis=1)[:, None]
    helper = np.where(level, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    x = np.cross(helper, along)
    x /= np.maximum(np.linalg.norm(x, axis=1), 1e-300)[:, None]
    y = np.cross(along, x)
    y /= np.maximum(np.linalg.norm(y, axis=1), 1e-300)[:, None]
    return np.stack([x, y, along, first], axis=2)


def coil(radius: float, length: float, wire: float) -> Mesh:
    """Return a coil about z, from z = 0 to its length if that is 1, else about the middle.

    Args:
        radius: Of its turns [m].
        length: Along the axis [m].
        wire: Radius of its wire [m].
    """
    turn = np.linspace(0.0, 2.0 * np.pi * _TURNS, _TURNS * _STEPS + 1)
    share = turn / turn[-1] - (0.0 if length == 1.0 else 0.5)
    around = np.linspace(0.0, 2.0 * np.pi, _SIDES + 1)
    out = radius + wire * np.cos(around)
    # A unit of z is a metre, or the distance of two points; the wire is round in the first case only.
    thick = wire * np.sin(around) if length != 1.0 else np.zeros_like(around)
    x = np.cos(turn)[:, None] * out
    y = np.sin(turn)[:, None] * out
    z = length * share[:, None] + thick
    return Mesh(np.stack([x, y, z], axis=2).reshape(-1, 3), grid(len(turn), len(around)))
