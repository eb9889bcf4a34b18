"""Marks at joints in a recording: pins, stops, latches, gears, belts."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.mechanism import Mechanism, frame_aligning_z, frames_aligning_z
from antenna_pin.show.record.bending import drawn_poses
from antenna_pin.show.record.scene import Scene, packed_doubles, track
from antenna_pin.show.record.shapes import Box, Cylinder, Geometry, Sphere, ring
from antenna_pin.trajectory import Trajectory, elements_of

# --- parts --------------------------------------------------------------------------------------------------

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Marking:
    """Data for marks."""

    run: Trajectory
    mechanism: Mechanism
    samples: NDArray[np.intp]  # samples of the run that are key frames, (frames,)
    scene: Scene  # scene of the marks
    paths: Mapping[str, str]  # paths of the links in the scene, by name; things below one move with it
    position: Array  # of the links at the key frames, (frames, links, 3) [m]
    attitude: Array  # likewise, quaternions xyzw, (frames, links, 4) [-]; links in the order of ``paths``
    size: float  # of the mechanism [m]

    @property
    def times(self) -> Array:
        """Times of the key frames, (frames,) [s]."""
        return np.asarray(self.run.data["time"].values, dtype=float)[self.samples]

    def path(self, link: str) -> str:
        """Return the path of things on a link, or in the world."""
        return self.paths.get(link, "world")

    def seat(self, joint: str) -> tuple[str, Array]:
        """Return the path of a joint's parent, and the joint's placement, z along its axis."""
        urdf = self.mechanism.urdf
        return self.path(urdf.joint(joint).parent), np.asarray(urdf.placement(joint)) @ self.axis(joint)

    def axis(self, joint: str) -> Array:
        """Return the placement in a joint's frame with z along its axis, (4, 4) [-]."""
        found = np.eye(4)
        found[:3, :3] = frame_aligning_z(np.asarray(self.mechanism.joint(joint).axis, dtype=float))
        return found


@dataclass(frozen=True, slots=True)
class Label:
    """Name in the picture, at a point in the frame of a path, (3,) [m]."""

    text: str
    path: str
    at: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class SceneMark:
    """Group of things in the scene with common visibility."""

    text: str  # name in the page
    colour: str  # colour beside it, ``#RRGGBB``
    paths: tuple[str, ...]  # paths of the things
    # Their motion beside their links, as tracks of an actor of the recording.
    tracks: tuple[dict[str, Any], ...] = ()
    shown: bool = True  # whether they are visible at first
    labels: tuple[Label, ...] = ()  # their names

    def listed(self) -> dict[str, Any]:
        """Return the mark in the page's format."""
        found: dict[str, Any] = {"text": self.text, "colour": self.colour, "paths": list(self.paths)}
        if not self.shown:
            found["shown"] = False
        if self.labels:
            found["labels"] = [{**asdict(label), "at": list(label.at)} for label in self.labels]
        return found


def rgb(colour: str) -> tuple[float, float, float]:
    """Return red, green and blue, 0 to 1 [-], of ``#RRGGBB``."""
    red, green, blue = (int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5))
    return red, green, blue


# --- pins ---------------------------------------------------------------------------------------------------

JOINT, PLAY = "#3B4552", "#CC3311"

# As shares of the mechanism's size: a pin's radius and length, the radius of a ball.
_PIN = (0.0025, 0.07)
_BALL = 0.007


def mark_joints(marking: Marking) -> SceneMark | None:
    """Draw a pin on each moving joint, or a ball, over all else."""
    places = json.loads(marking.run.data.attrs.get("clearance_joints", "{}"))
    found, labels = [], []
    for name in marking.mechanism.joints:
        on, place = marking.seat(name)
        ball = places.get(name, {}).get("kind") == "spherical"
        radius, length = (share * marking.size for share in _PIN)
        shape: Geometry = Sphere(_BALL * marking.size) if ball else Cylinder(radius, length)
        colour = PLAY if name in places else JOINT
        found.append(f"{on}/joint {name}".replace("//", "/"))
        marking.scene.add(found[-1], shape, (*rgb(colour), 0.9), place, unlit=True, depthTest=False)
        x, y, z = map(float, place[:3, 3])
        labels.append(Label(name, on, (x, y, z)))
    if not found:
        return None
    words = "joints, their axes (red: with play)" if places else "joints, their axes"
    return SceneMark(words, JOINT, tuple(found), shown=False, labels=tuple(labels))


# --- stops and latches --------------------------------------------------------------------------------------
#
# A wedge stands on the joint's parent where a pointer on the child comes to it at the limit, a pin where the
# latch holds. Of each there are two in one place: one in the colour of rest, one in that of a stop that is
# touched or a latch that holds; which of them is seen moves with the run.

STOP, TOUCHED = "#4D5866", "#D55E00"
LATCH, HELD = "#56B4E9", "#009E73"
_POINTER = "#2B3440"

# As shares of the mechanism's size: where pointer and stops are from the axis, sizes of a wedge (across the
# way, along the axis, along the way), of the pointer, and of a pin (radius, length).
_REACH = 0.07
_WEDGE = (0.035, 0.02, 0.008)
_THIN = 0.006
_LATCH_PIN = (0.006, 0.03)
_HELD_MODE = 2  # of a latch


def mark_stops(marking: Marking) -> SceneMark | None:
    """Draw marks at joints with stops or latches."""
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
        for what, seat, shape, colours, active in _modal_parts(place, one, marking.size, mode):
            path = f"{marks.parent}/{name} {what}"
            found.append(path)
            for colour, visible in zip(colours, (~active, active), strict=True):
                tracks.append(marks.put(f"{path}/{colour[1:]}", seat, shape, colour, visible))
    if not found:
        return None
    words = "stops (orange: touched) and latches (green: holding)"
    return SceneMark(words, STOP, tuple(found), tuple(tracks))


def _modal_parts(
    place: str, one: Mapping[str, Any], size: float, mode: NDArray[Any]
) -> list[tuple[str, float, Geometry, tuple[str, str], NDArray[np.bool_]]]:
    """Return name, place, shape, colours and activity of an element's parts."""
    numbers = one["numbers"]
    if place.startswith("latches."):
        pin = Cylinder(_LATCH_PIN[0] * size, _LATCH_PIN[1] * size)
        return [("pin", numbers["angle"], pin, (LATCH, HELD), mode == _HELD_MODE)]
    wedge = Box(tuple(share * size for share in _WEDGE))  # type: ignore[arg-type]
    return [
        (side, numbers[side], wedge, (STOP, TOUCHED), mode == number)
        for number, side in ((1, "lower"), (2, "upper"))
        if side in numbers
    ]


class _Marks:
    """Place of the marks of one joint."""

    def __init__(self, marking: Marking, joint: str, slides: bool) -> None:
        self.scene, self.size, self.slides = marking.scene, marking.size, slides
        self.times = marking.times
        self.parent, self.in_parent = marking.seat(joint)
        self.in_child = marking.axis(joint)
        self.child = marking.path(marking.mechanism.urdf.joint(joint).child)

    def _seat(self, way: float) -> Array:
        """Return the placement at an angle (or displacement) in the axis' frame."""
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
        self, path: str, way: float, shape: Geometry, colour: str, visible: NDArray[np.bool_]
    ) -> dict[str, Any]:
        """Draw a part on the parent; return the track of its visibility."""
        self.scene.add(path, shape, rgb(colour), self.in_parent @ self._seat(way))
        changes = self.times[np.flatnonzero(np.diff(visible, prepend=False))]
        name = path.rpartition("/")[0]
        return {"kind": "shown", "name": name, "path": path, "data": packed_doubles(changes)}


# --- gears, racks, belts and cables -------------------------------------------------------------------------
#
# A circle turns with the child of its joint. A gear's are in the ratio of the two, a belt's are its
# pulleys. Of what is in contact or not there are two in one place, of which one is seen: a gear's circles
# in the colour of rest or of teeth that mesh, a strand in that of a taut or of a slack one. Strands are
# straight from pulley to pulley at every key frame, as the links stand then.

APART, MESHING, SLACK = "#7A5C2E", "#E69F00", "#B8C4CE"

# As shares of the mechanism's size: radius of the larger of a gear's circles, of their wire, of a strand, of
# a rack's bar (length, thickness). The smaller circle is in ratio, but for one that could not be seen.
_GEAR, _WIRE, _STRAND = 0.07, 0.0025, 0.0018
_RACK = (0.3, 0.008)
_LEAST = 0.1
_SMALLEST = 1e-6  # a part that is not seen is so small; none at all would have no inverse


class _Joint(NamedTuple):
    """Joint of a gear: axis frames in child and parent; radius [m]."""

    name: str
    child: str
    parent: str
    in_child: Array
    in_parent: Array
    radius: float
    slides: bool


def mark_gears(marking: Marking) -> SceneMark | None:
    """Draw marks at joints with gears, belts or cables."""
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
        ends = [_joint(marking, joint, k, one) for k, joint in enumerate(one["joints"])]
        strands = one["kind"] in ("Belt", "Cable")
        meshes = (mode != 0) if "plus" in one["numbers"] and not strands else None
        for end in ends:
            for what, shape, seat in _meshing_parts(end, size):
                path = f"{marking.path(end.child)}/{name} {end.name} {what}"
                put = _put(scene, path, shape, end.in_child @ seat, meshes, what == "circle")
                found += [one_path for one_path, _ in put]
                tracks += [motion for _, motion in put if motion is not None]
        if strands:
            for side, taut, beginning, ending in _strands(ends, one, mode, poses):
                for path, motion in _strand(scene, f"gears/{name} {side}", taut, beginning, ending, size):
                    found.append(path)
                    tracks.append(motion)
    words = "gears (in ratio, up to 10 : 1; orange: meshing), pulleys and strands (pale: slack)"
    return SceneMark(words, APART, tuple(found), tuple(tracks))


def _joint(marking: Marking, name: str, k: int, one: Mapping[str, Any]) -> _Joint:
    """Return a joint of a gear, the first or the second."""
    joint = marking.mechanism.urdf.joint(name)
    shares = abs(one["numbers"]["a"]), abs(one["numbers"]["b"])
    # In ways per angle a share is a radius; a gear's are as one to the other.
    radius = shares[k] if one["slides"] else _GEAR * marking.size * max(shares[k] / max(shares), _LEAST)
    slides = bool(one["kind"] == "Rack" and k == 1)
    in_child, in_parent = marking.axis(name), marking.seat(name)[1]
    return _Joint(name, joint.child, joint.parent, in_child, in_parent, radius, slides)


def _meshing_parts(end: _Joint, size: float) -> Iterator[tuple[str, Geometry, Array]]:
    """Yield name, shape and placement of parts on a joint's child."""
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
    """Draw a part on a link, in both colours if these change."""
    if meshes is None or not changes:
        scene.add(path, shape, rgb(APART), place)
        return [(path, None)]
    found: list[tuple[str, dict[str, Any] | None]] = []
    for colour, seen in ((APART, ~meshes), (MESHING, meshes)):
        own = f"{path} {colour[1:]}"
        scene.add(f"{own}/part", shape, rgb(colour))
        data = np.repeat(place[None, :3, :], len(seen), axis=0)
        data[:, :, :3] *= np.where(seen, 1.0, _SMALLEST)[:, None, None]
        found.append((own, track(own, data)))
    return found


def _strands(
    ends: list[_Joint], one: Mapping[str, Any], mode: NDArray[Any], poses: Any
) -> Iterator[tuple[str, NDArray[np.bool_], Array, Array]]:
    """Yield side, tautness and both ends in the world of each strand."""
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
    """Return a joint's frame on its parent in the world, (n, 4, 4)."""
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
    turned = frames_aligning_z(way / length[:, None])
    turned[:, :, 2] *= length[:, None]
    for colour, seen in ((MESHING, taut), (SLACK, ~taut)):
        own = f"{path} {colour[1:]}"
        scene.add(f"{own}/part", Cylinder(_STRAND * size, 1.0), rgb(colour))
        data = np.empty((len(seen), 3, 4))
        data[:, :, :3] = turned * np.where(seen, 1.0, _SMALLEST)[:, None, None]
        data[:, :, 3] = 0.5 * (begins + ends)
        yield own, track(own, data)
