"""Forces on journals and links as arrows in the player's format."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.show.record.key_frames import Impacts
from antenna_pin.show.record.marks import Marking
from antenna_pin.show.record.scene import nice, packed_counts, packed_floats
from antenna_pin.trajectory import contact_joints

Array = NDArray[np.float64]

FORCE, APPLIED = "#D55E00", "#009E73"
_FRAMED = 300  # arrows that are framed, of each contact
_NONE: Array = np.zeros((0, 3))


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
    data = marking.run.data
    if "contact_force" not in data or not places:
        return None, _NONE
    chosen = data.isel(time=marking.samples)
    force, point = (np.asarray(chosen[f"contact_{one}"].values, dtype=float) for one in ("force", "point"))
    items = []
    for k, (name, joint) in enumerate(contact_joints(data).items()):
        body = places[joint]["bearing_body"]
        path = f"{marking.paths[body]}/bearing {joint}".replace("//", "/")
        bearing = placement_of(places[joint]["bearing_placement"])
        items.append(_Arrows(name, path, body, bearing, force[:, k], point[:, k]))
    largest = max(float(np.linalg.norm(force, axis=2).max()), float(impacts.peaks.max(initial=0.0)))
    return _drawn(marking, items, FORCE, largest)


def applied_arrows(marking: Marking) -> tuple[dict[str, Any] | None, Array]:
    """Return forces on links in the player's format, and arrow tips, (n, 3) [m]."""
    data, names = marking.run.data, list(marking.paths)
    about = json.loads(data.attrs.get("force_places", "{}"))
    if not about or "applied_force" not in data:
        return None, _NONE
    force = np.asarray(data["applied_force"].isel(time=marking.samples).values, dtype=float)
    items = []
    for k, (name, one) in enumerate(about.items()):
        link = one["link"]
        if link in names:
            own = Rotation.from_quat(marking.attitude[:, names.index(link)]).inv().apply(force[:, k])
            point = np.tile(np.array(one["point"], dtype=float), (len(own), 1))
            path = f"{marking.paths[link]}/force {name}"
            items.append(_Arrows(name, path, link, np.eye(4), own, point))
    return _drawn(marking, items, APPLIED, float(np.linalg.norm(force, axis=2).max(initial=0.0)))


class _Arrows(NamedTuple):
    """Forces (frames, 3) [N] at points [m] in a frame on a body."""

    name: str
    path: str
    body: str
    frame: Array
    force: Array
    point: Array


def _drawn(
    marking: Marking, items: list[_Arrows], colour: str, largest: float
) -> tuple[dict[str, Any] | None, Array]:
    """Place the frames of arrows; return these in the player's format, and their tips."""
    if largest == 0.0 or not items:
        return None, _NONE
    reference = nice(largest)  # a force [N], and the length that it is drawn with [m]
    length = nice(0.3 * marking.size * np.sqrt(reference / largest))
    for one in items:
        marking.scene.place(one.path, one.frame)
    arrows = {
        "items": [{"name": one.name, "path": one.path, **sparse(one.force, one.point)} for one in items],
        "colour": colour,
        "above": True,
        "map": None,
        "size": 0.004 * marking.size,
        "power": 0.5,
        "reference": [reference, length],
    }
    return arrows, np.concatenate([_tips(one, reference, length, marking) for one in items])


def _tips(arrows: _Arrows, reference: float, length: float, marking: Marking) -> Array:
    """Return the tips of the longest arrows in the world, (n, 3) [m]."""
    size = np.linalg.norm(arrows.force, axis=1)
    some = np.argsort(-size, kind="stable")[:_FRAMED]
    some = some[size[some] > 0.0]
    tips = arrows.point[some] + length * arrows.force[some] / np.sqrt(reference * size[some, None])
    k = list(marking.paths).index(arrows.body)
    turn = Rotation.from_quat(marking.attitude[some, k]) if len(some) else Rotation.identity()
    frame = arrows.frame
    return np.asarray(turn.apply(tips @ frame[:3, :3].T + frame[:3, 3]) + marking.position[some, k])


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
