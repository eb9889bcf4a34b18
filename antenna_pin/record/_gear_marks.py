"""Gears, racks, belts and cables, drawn at their joints: circles with a spoke, strands, coloured by contact.

A circle turns with the child of its joint. A gear's are in the ratio of the two, a belt's are its pulleys. Of
what is in contact or not there are two in one place, of which one is seen: a gear's circles in the colour of
rest or of teeth that mesh, a strand in that of a taut or of a slack one. Strands are straight from pulley to
pulley at every key frame, as the links stand then.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.mechanism import Mechanism, frame_aligning_z
from antenna_pin.record._marking import Mark, Marking, rgb
from antenna_pin.record._profiles import ring
from antenna_pin.record.bending import drawn_poses
from antenna_pin.record.scene import Scene, packed_floats
from antenna_pin.record.shapes import Box, Cylinder, Geometry
from antenna_pin.trajectory import elements_of

__all__ = ["mark_gears"]

Array = NDArray[np.float64]

APART, MESHING, SLACK = "#7A5C2E", "#E69F00", "#B8C4CE"

# As shares of the mechanism's size: radius of the larger of a gear's circles, of their wire, of a strand, of
# a rack's bar (length, thickness). The smaller circle is in ratio, but for one that could not be seen.
_GEAR, _WIRE, _STRAND = 0.07, 0.0025, 0.0018
_RACK = (0.3, 0.008)
_LEAST = 0.1
_SMALLEST = 1e-6  # a part that is not seen is so small; none at all would have no inverse


class _Joint(NamedTuple):
    """A joint of a gear: its frame with z along the axis, in its child and in its parent; radius [m]."""

    name: str
    child: str
    parent: str
    in_child: Array
    in_parent: Array
    radius: float
    slides: bool


def mark_gears(marking: Marking) -> Mark | None:
    """Put marks at joints with gears, belts or cables.

    Args:
        marking: What they are made of.
    """
    run, samples, scene, size = marking.run, marking.samples, marking.scene, marking.size
    every = {place: one for place, one in elements_of(run.data).items() if place.startswith("gears.")}
    if not every:
        return None
    poses = drawn_poses(run, samples, 1.0)
    found: list[str] = []
    tracks: list[dict[str, Any]] = []
    for place, one in every.items():
        name = place.replace("/", " ")
        mode = np.asarray(run.data["element_mode"].sel(element=place).values)[samples]
        ends = [_joint(marking.mechanism, joint, k, one, size) for k, joint in enumerate(one["joints"])]
        strands = one["kind"] in ("Belt", "Cable")
        meshes = (mode != 0) if "plus" in one["numbers"] and not strands else None
        for end in ends:
            for what, shape, seat in _parts(end, size):
                path = f"{marking.path(end.child)}/{name} {end.name} {what}"
                put = _put(scene, path, shape, end.in_child @ seat, meshes, what == "circle")
                found += [one_path for one_path, _ in put]
                tracks += [track for _, track in put if track is not None]
        if strands:
            for side, taut, beginning, ending in _strands(ends, one, mode, poses):
                for path, track in _strand(scene, f"gears/{name} {side}", taut, beginning, ending, size):
                    found.append(path)
                    tracks.append(track)
    words = "gears (in ratio, up to 10 : 1; orange: meshing), pulleys and strands (pale: slack)"
    return Mark(words, APART, tuple(found), tuple(tracks))


def _joint(mechanism: Mechanism, name: str, k: int, one: Mapping[str, Any], size: float) -> _Joint:
    """Return a joint of a gear, the first or the second."""
    joint = mechanism.urdf.joint(name)
    axis = np.eye(4)
    axis[:3, :3] = frame_aligning_z(np.asarray(mechanism.joint(name).axis, dtype=float))
    in_parent = np.asarray(mechanism.urdf.placement(name)) @ axis
    shares = abs(one["numbers"]["a"]), abs(one["numbers"]["b"])
    # In ways per angle a share is a radius; a gear's are as one to the other.
    radius = shares[k] if one["slides"] else _GEAR * size * max(shares[k] / max(shares), _LEAST)
    slides = bool(one["kind"] == "Rack" and k == 1)
    return _Joint(name, joint.child, joint.parent, axis, in_parent, radius, slides)


def _parts(end: _Joint, size: float) -> Iterator[tuple[str, Geometry, Array]]:
    """Yield what is drawn on a joint's child: name, shape, place in the frame of the axis."""
    seat = np.eye(4)
    if end.slides:
        yield "rack", Box((_RACK[1] * size, _RACK[1] * size, _RACK[0] * size)), seat
        return
    yield "circle", ring(end.radius, 0.0, _WIRE * size), seat
    seat[0, 3] = 0.5 * end.radius
    yield "spoke", Box((end.radius, _WIRE * size, _WIRE * size)), seat


def _put(
    scene: Scene, path: str, shape: Geometry, place: Array, meshes: NDArray[np.bool_] | None, changes: bool
) -> list[tuple[str, dict[str, Any] | None]]:
    """Draw a part that turns with a link; one that changes its colour twice, of which one is seen."""
    if meshes is None or not changes:
        scene.add(path, shape, rgb(APART), place)
        return [(path, None)]
    found: list[tuple[str, dict[str, Any] | None]] = []
    for colour, seen in ((APART, ~meshes), (MESHING, meshes)):
        own = f"{path} {colour[1:]}"
        scene.add(f"{own}/part", shape, rgb(colour))
        data = np.repeat(place[None, :3, :], len(seen), axis=0)
        data[:, :, :3] *= np.where(seen, 1.0, _SMALLEST)[:, None, None]
        found.append((own, _track(own, data)))
    return found


def _strands(
    ends: list[_Joint], one: Mapping[str, Any], mode: NDArray[Any], poses: Any
) -> Iterator[tuple[str, NDArray[np.bool_], Array, Array]]:
    """Yield the strands: side, whether it is taut, and its two ends in the world at each key frame."""
    numbers = one["numbers"]
    (first, second), (r, s) = (_places(end, poses) for end in ends), (end.radius for end in ends)
    axis = first[:, :3, 2]
    way = second[:, :3, 3] - first[:, :3, 3]
    way -= np.einsum("ti,ti->t", way, axis)[:, None] * axis
    far = np.linalg.norm(way, axis=1)
    # Axes that look the other way turn the pulley the other way.
    against = np.einsum("ti,ti->t", axis, second[:, :3, 2]) < 0.0
    sign = np.where(against ^ (numbers["b"] < 0.0), -1.0, 1.0)
    along = way / np.maximum(far, 1e-12)[:, None]
    across = np.cross(axis, along)
    sine = np.clip((r - sign * s) / np.maximum(far, 1e-12), -1.0, 1.0)
    cosine = np.sqrt(1.0 - sine**2)
    for bit, side, turn in ((1, "plus", 1.0), (2, "minus", -1.0)):
        if side in numbers:
            out = sine[:, None] * along + turn * cosine[:, None] * across
            begins = first[:, :3, 3] + r * out
            yield side, (mode & bit) != 0, begins, second[:, :3, 3] + (sign * s)[:, None] * out


def _places(end: _Joint, poses: Any) -> Array:
    """Return the frame of a joint on its parent in the world at each key frame, (n, 4, 4)."""
    k = [str(body) for body in poses["body"].values].index(end.parent)
    found = np.tile(np.eye(4), (poses.sizes["time"], 1, 1))
    found[:, :3, :3] = Rotation.from_quat(np.asarray(poses["attitude"].values)[:, k]).as_matrix()
    found[:, :3, 3] = np.asarray(poses["position"].values)[:, k]
    return found @ end.in_parent


def _strand(
    scene: Scene, path: str, taut: NDArray[np.bool_], begins: Array, ends: Array, size: float
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Draw a strand twice, taut and slack; yield paths and tracks."""
    way = ends - begins
    length = np.maximum(np.linalg.norm(way, axis=1), 1e-12)
    turned = np.stack([frame_aligning_z(one) for one in way / length[:, None]])
    turned[:, :, 2] *= length[:, None]
    for colour, seen in ((MESHING, taut), (SLACK, ~taut)):
        own = f"{path} {colour[1:]}"
        scene.add(f"{own}/part", Cylinder(_STRAND * size, 1.0), rgb(colour))
        data = np.empty((len(seen), 3, 4))
        data[:, :, :3] = turned * np.where(seen, 1.0, _SMALLEST)[:, None, None]
        data[:, :, 3] = 0.5 * (begins + ends)
        yield own, _track(own, data)


def _track(path: str, data: Array) -> dict[str, Any]:
    return {"kind": "matrix", "name": path.rpartition("/")[2], "path": path, "data": packed_floats(data)}
