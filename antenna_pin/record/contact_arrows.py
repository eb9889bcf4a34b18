"""Forces on journals and links as arrows in the player's format."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.record.key_frames import Impacts
from antenna_pin.record.marks import Marking
from antenna_pin.record.scene import nice, packed_counts, packed_floats
from antenna_pin.trajectory import contact_joints

Array = NDArray[np.float64]

FORCE, APPLIED = "#D55E00", "#009E73"
_FRAMED = 300  # arrows that are framed, of each contact


def sparse(force: Array, point: Array) -> dict[str, str]:
    """Return a contact's forces and points, (frames, 3) each, at loaded key frames."""
    some = np.flatnonzero(np.any(force != 0.0, axis=1))
    return {
        "frames": packed_counts(some),
        "force": packed_floats(force[some]),
        "point": packed_floats(point[some]),
    }


def contact_arrows(
    marking: Marking, impacts: Impacts, places: Mapping[str, Mapping[str, Any]]
) -> tuple[dict[str, Any] | None, Array]:
    """Return contact forces in the player's format, and arrow tips, (n, 3) [m].

    ``places`` are the bearings (the run's attribute ``clearance_joints``).
    """
    data, size = marking.run.data, marking.size
    nothing = np.zeros((0, 3))
    if "contact_force" not in data or not places:
        return None, nothing
    force = np.asarray(data["contact_force"].isel(time=marking.samples).values, dtype=float)
    point = np.asarray(data["contact_point"].isel(time=marking.samples).values, dtype=float)
    largest = max(float(np.linalg.norm(force, axis=2).max()), float(impacts.peaks.max(initial=0.0)))
    if largest == 0.0:
        return None, nothing
    reference, length = _scale(largest, size)
    items, tips = [], []
    for k, (name, joint) in enumerate(contact_joints(data).items()):
        place = places[joint]
        body = place["bearing_body"]
        path = f"{marking.paths[body]}/bearing {joint}".replace("//", "/")
        bearing = placement_of(place["bearing_placement"])
        marking.scene.place(path, bearing)
        tips.append(_tips(force[:, k], point[:, k], reference, length, bearing, marking, body))
        items.append({"name": name, "path": path, **sparse(force[:, k], point[:, k])})
    return _arrows(items, FORCE, (reference, length), size), np.concatenate(tips)


def applied_arrows(marking: Marking) -> tuple[dict[str, Any] | None, Array]:
    """Return forces on links in the player's format, and arrow tips, (n, 3) [m]."""
    data, size = marking.run.data, marking.size
    about, names = json.loads(data.attrs.get("force_places", "{}")), list(marking.paths)
    if not about or "applied_force" not in data:
        return None, np.zeros((0, 3))
    force = np.asarray(data["applied_force"].isel(time=marking.samples).values, dtype=float)
    largest = float(np.linalg.norm(force, axis=2).max(initial=0.0))
    drawn = [(k, name, one) for k, (name, one) in enumerate(about.items()) if one["link"] in names]
    if largest == 0.0 or not drawn:
        return None, np.zeros((0, 3))
    reference, length = _scale(largest, size)
    items, tips = [], []
    for k, name, one in drawn:
        link = one["link"]
        path = f"{marking.paths[link]}/force {name}"
        marking.scene.place(path, np.eye(4))
        own = Rotation.from_quat(marking.attitude[:, names.index(link)]).inv().apply(force[:, k])
        point = np.tile(np.array(one["point"], dtype=float), (len(own), 1))
        tips.append(_tips(own, point, reference, length, np.eye(4), marking, link))
        items.append({"name": name, "path": path, **sparse(own, point)})
    return _arrows(items, APPLIED, (reference, length), size), np.concatenate(tips)


def _scale(largest: float, size: float) -> tuple[float, float]:
    """Return a force [N] and the length that it is drawn with [m]."""
    reference = nice(largest)
    return reference, nice(0.3 * size * np.sqrt(reference / largest))


def _arrows(
    items: list[dict[str, Any]], colour: str, scale: tuple[float, float], size: float
) -> dict[str, Any]:
    return {
        "items": items,
        "colour": colour,
        "above": True,
        "map": None,
        "size": 0.004 * size,
        "power": 0.5,
        "reference": list(scale),
    }


def _tips(
    force: Array, point: Array, reference: float, length: float, bearing: Array, marking: Marking, body: str
) -> Array:
    """Return the tips of a contact's longest arrows in the world, (n, 3) [m]."""
    size = np.linalg.norm(force, axis=1)
    some = np.argsort(-size, kind="stable")[:_FRAMED]
    some = some[size[some] > 0.0]
    tips = point[some] + length * force[some] / np.sqrt(reference * size[some, None])
    k = list(marking.paths).index(body)
    turn = Rotation.from_quat(marking.attitude[some, k]) if len(some) else Rotation.identity()
    return np.asarray(turn.apply(tips @ bearing[:3, :3].T + bearing[:3, 3]) + marking.position[some, k])


def force_scale(arrows: Mapping[str, Any], what: str) -> str:
    """Return a note on the lengths of arrows."""
    force, length = arrows["reference"]
    hundredth = f"{0.01 * force:g} N {0.1 * length:g} m"
    return f"{what}: {force:g} N drawn {length:g} m, {hundredth} (square root)"


def placement_of(seven: ArrayLike) -> Array:
    """Return a position and a quaternion xyzw, (7,), as a placement, (4, 4)."""
    numbers = np.asarray(seven, dtype=float)
    result = np.eye(4)
    result[:3, :3] = Rotation.from_quat(numbers[3:]).as_matrix()
    result[:3, 3] = numbers[:3]
    return result
