"""Forces as arrows in a recording of the whole mechanism: those of contacts, those on links."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.record.key_frames import Impacts, KeyFrames
from antenna_pin.record.scene import Scene, packed_floats
from antenna_pin.trajectory import contact_joints

__all__ = ["FRAMED", "applied_arrows", "contact_arrows", "nice", "placement_of", "said_of_scale"]

Array = NDArray[np.float64]

FORCE = "#D55E00"
APPLIED = "#009E73"
FRAMED = 300  # key frames looked at to frame the motion


def contact_arrows(
    data: xr.Dataset,
    frames: KeyFrames,
    impacts: Impacts,
    places: dict[str, dict[str, Any]],
    motion: Any,
    scene: Scene,
) -> tuple[dict[str, Any] | None, Array]:
    """Return the contact forces as the player takes them, and tips of their arrows, (n, 3) [m]."""
    nothing = np.zeros((0, 3))
    if "contact_force" not in data or not places:
        return None, nothing
    force = np.asarray(data["contact_force"].isel(time=frames.indices).values, dtype=float)
    point = np.asarray(data["contact_point"].isel(time=frames.indices).values, dtype=float)
    largest = max(float(np.linalg.norm(force, axis=2).max()), float(impacts.peaks.max(initial=0.0)))
    if largest == 0.0:
        return None, nothing
    reference, length = _scale(largest, motion.size)
    items, tips = [], []
    for k, (name, joint) in enumerate(contact_joints(data).items()):
        place = places[joint]
        path = f"{motion.paths[place['bearing_body']]}/bearing {joint}".replace("//", "/")
        bearing = placement_of(place["bearing_placement"])
        scene.place(path, bearing)
        tips.append(
            _arrow_tips(force[:, k], point[:, k], reference, length, bearing, motion, place["bearing_body"])
        )
        items.append(
            {
                "name": name,
                "path": path,
                "force": packed_floats(force[:, k]),
                "point": packed_floats(point[:, k]),
            }
        )
    return _arrows(items, FORCE, reference, length, motion.size), np.concatenate(tips)


def applied_arrows(
    data: xr.Dataset, frames: KeyFrames, motion: Any, scene: Scene
) -> tuple[dict[str, Any] | None, Array]:
    """Return the forces on links as the player takes them, and tips of their arrows, (n, 3) [m]."""
    about = json.loads(data.attrs.get("force_places", "{}"))
    if not about or "applied_force" not in data:
        return None, np.zeros((0, 3))
    force = np.asarray(data["applied_force"].isel(time=frames.indices).values, dtype=float)
    largest = float(np.linalg.norm(force, axis=2).max(initial=0.0))
    drawn = [(k, name, one) for k, (name, one) in enumerate(about.items()) if one["link"] in motion.names]
    if largest == 0.0 or not drawn:
        return None, np.zeros((0, 3))
    reference, length = _scale(largest, motion.size)
    items, tips = [], []
    for k, name, one in drawn:
        path = f"{motion.paths[one['link']]}/force {name}"
        scene.place(path, np.eye(4))
        turn = Rotation.from_quat(motion.attitude[:, motion.names.index(one["link"])])
        own = turn.inv().apply(force[:, k])
        point = np.tile(np.array(one["point"], dtype=float), (len(own), 1))
        tips.append(_arrow_tips(own, point, reference, length, np.eye(4), motion, one["link"]))
        items.append({"name": name, "path": path, "force": packed_floats(own), "point": packed_floats(point)})
    return _arrows(items, APPLIED, reference, length, motion.size), np.concatenate(tips)


def _scale(largest: float, size: float) -> tuple[float, float]:
    """Return a force [N] and the length that it is drawn with [m]."""
    reference = nice(largest)
    return reference, nice(0.3 * size * np.sqrt(reference / largest))


def _arrows(
    items: list[dict[str, Any]], colour: str, reference: float, length: float, size: float
) -> dict[str, Any]:
    return {
        "items": items,
        "colour": colour,
        "above": True,
        "map": None,
        "size": 0.004 * size,
        "power": 0.5,
        "reference": [reference, length],
    }


def _arrow_tips(
    force: Array, point: Array, reference: float, length: float, bearing: Array, motion: Any, body: str
) -> Array:
    """Return the tips of a contact's longest arrows in the world, (n, 3) [m]."""
    size = np.linalg.norm(force, axis=1)
    some = np.argsort(-size, kind="stable")[:FRAMED]
    some = some[size[some] > 0.0]
    tips = point[some] + length * force[some] / np.sqrt(reference * size[some, None])
    k = motion.names.index(body)
    turn = Rotation.from_quat(motion.attitude[some, k]) if len(some) else Rotation.identity()
    return np.asarray(turn.apply(tips @ bearing[:3, :3].T + bearing[:3, 3]) + motion.position[some, k])


def said_of_scale(arrows: dict[str, Any], what: str) -> str:
    """Return in words how long arrows are drawn."""
    force, length = arrows["reference"]
    hundredth = f"{0.01 * force:g} N {0.1 * length:g} m"
    return f"{what}: {force:g} N drawn {length:g} m, {hundredth} (square root)"


def placement_of(seven: ArrayLike) -> Array:
    """Return a position and a quaternion xyzw, (7,) [m, -], as a placement, (4, 4)."""
    numbers = np.asarray(seven, dtype=float)
    result = np.eye(4)
    result[:3, :3] = Rotation.from_quat(numbers[3:]).as_matrix()
    result[:3, 3] = numbers[:3]
    return result


def nice(value: float) -> float:
    """Return the largest 1, 2 or 5 times a power of ten that is not above a positive value."""
    power = 10.0 ** np.floor(np.log10(value))
    digit = max(step for step in (1.0, 2.0, 5.0) if step * power <= value * (1.0 + 1e-12))
    return float(f"{digit * power:.1g}")
