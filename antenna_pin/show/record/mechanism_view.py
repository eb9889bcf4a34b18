"""View of the mechanism in the world: bodies, forces, boresight, and an ideal ghost."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.analysis import closures_of, mechanism_of
from antenna_pin.base.directions import direction
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.mechanism import Mechanism, Urdf, frame_aligning_z
from antenna_pin.show.record.bending import bending_note, check_bending, drawn_poses
from antenna_pin.show.record.contact_arrows import applied_arrows, contact_arrows, force_scale, placement_of
from antenna_pin.show.record.key_frames import Impacts, KeyFrames
from antenna_pin.show.record.marks import Label, Marking, SceneMark, mark_gears, mark_joints, mark_stops, rgb
from antenna_pin.show.record.scene import Scene, camera, clearest, packed_doubles, packed_floats, track, triad
from antenna_pin.show.record.shapes import (
    BodyShape,
    Cylinder,
    Geometry,
    Mesh,
    Sphere,
    corners,
    grid,
    surface,
    visual_shapes,
)
from antenna_pin.trajectory import Trajectory

Array = NDArray[np.float64]


# --- springs: a coil about the axis of a joint that has one, and one between two points ---

SPRING = "#117733"

# As shares of the mechanism's size: radius and length of a coil about a joint, radius of one between points,
# radius of the wire.
_COIL = (0.012, 0.03)
_ASIDE = 0.045  # along the axis, from the joint, where stops and latches are
_BETWEEN = 0.009
_WIRE = 0.0018
_TURNS, _STEPS, _SIDES = 4, 24, 6  # of a coil; of each of its turns; of the wire
_NO_SPRINGS = ("friction",)  # kinds that stand among the springs of a scenario


def mark_springs(marking: Marking) -> SceneMark | None:
    """Draw the springs of the run's scenario; systems built in Python have none."""
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
        tracks.append(track(found[-1], _between(first, second), f"spring {name}"))
        labels.append(Label(name, found[-1], (0.0, 0.0, 0.5)))
    if not found:
        return None
    return SceneMark("springs", SPRING, tuple(found), tuple(tracks), labels=tuple(labels))


def _places(marking: Marking, side: Any) -> Array | None:
    """Return the points of one end of a spring, (frames, 3) [m], or None."""
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


def _between(begins: Array, ends: Array) -> Array:
    """Return placements with z from 0 to 1 between points, (n, 3, 4)."""
    along = ends - begins
    level = np.abs(along[:, :1]) < 0.9 * np.linalg.norm(along, axis=1)[:, None]
    helper = np.where(level, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    x = np.cross(helper, along)
    x /= np.maximum(np.linalg.norm(x, axis=1), 1e-300)[:, None]
    y = np.cross(along, x)
    y /= np.maximum(np.linalg.norm(y, axis=1), 1e-300)[:, None]
    return np.stack([x, y, along, begins], axis=2)


def coil(radius: float, length: float, wire: float) -> Mesh:
    """Return a coil about z [m], from 0 for length 1, else about the middle."""
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


# --- frames of the links: x red, y green, z blue, as in the corner ---

_AXES = (("x", "#A02338", [0, 90, 0]), ("y", "#1B7837", [-90, 0, 0]), ("z", "#2F5FA8", [0, 0, 0]))
_AXIS = (0.0016, 0.06)  # radius and length, as shares of the mechanism's size


def mark_frames(marking: Marking) -> SceneMark | None:
    """Draw the axes of each link; hidden at first."""
    radius, length = (share * marking.size for share in _AXIS)
    found = []
    for path in marking.paths.values():
        found.append(f"{path}/frame")
        for name, colour, turn in _AXES:
            place = np.eye(4)
            place[:3, :3] = Rotation.from_euler("xyz", turn, degrees=True).as_matrix()
            place[:3, 3] = 0.5 * length * place[:3, 2]
            axis, looks = Cylinder(radius, length), {"unlit": True, "depthTest": False}
            marking.scene.add(f"{path}/frame/{name}", axis, rgb(colour), place, **looks)
    return SceneMark("frames of links: x red, y green, z blue", "#2F5FA8", tuple(found), shown=False)


# --- where loops are closed, drawn as small marks on the links: a pin along the axis, or a ball ---

CLOSURE = "#8C8C1E"

# Of a mark, as shares of the mechanism's size: a pin's radius and length, a ball's radius.
_PIN = (0.003, 0.06)
_BALL = 0.006


def mark_closures(marking: Marking) -> SceneMark | None:
    """Draw a mark on each closure of a loop.

    A mark moves with the second side's link, or with the first where that is the world; both sides coincide.
    Closures that hold a joint of the tree close no loop of their own, and have no mark.
    """
    size = marking.size
    found, labels = [], []
    for name, closure in closures_of(marking.run).items():
        if name in marking.mechanism.joints:
            continue
        side = "second" if closure["second_body"] in marking.paths else "first"
        on = marking.path(closure[f"{side}_body"])
        place = placement_of(closure[f"{side}_placement"])
        pin = closure["axis"] and closure["kind"] != "universal"
        shape: Geometry = Cylinder(_PIN[0] * size, _PIN[1] * size) if pin else Sphere(_BALL * size)
        found.append(f"{on}/closure {name}")
        x, y, z = map(float, place[:3, 3])
        labels.append(Label(name, on, (x, y, z)))
        marking.scene.add(found[-1], shape, (*rgb(CLOSURE), 0.85), place, unlit=True, depthTest=False)
    if not found:
        return None
    words = "closure of a loop" if len(found) == 1 else f"{len(found)} closures of loops"
    return SceneMark(words, CLOSURE, tuple(found), labels=tuple(labels))


#: Marks beside a mechanism's bodies in the order of a page; each function returns None without its kind.
MARKS: tuple[Callable[[Marking], SceneMark | None], ...] = (
    mark_closures,
    mark_stops,
    mark_gears,
    mark_springs,
    mark_joints,
    mark_frames,
)


BORESIGHT = "#0072B2"
GHOST = "#AA4499"
_CLEAR = 0.32  # opacity of the ghost
_OPAQUE = 0.9  # what is less so hides nothing
_TRAIL = 1500  # points of a trace
_FRAMED = 300  # key frames by which the motion is framed
_COMPARED = 7  # key frames at which bodies are compared for hiding one another
_DIRECTION = (1.0, -0.75, 0.55)  # of the camera


class Boresight:
    """Line along an axis (3,) [-] of a link, drawn with its trace."""

    def __init__(self, body: str, axis: ArrayLike, bodies: list[str]) -> None:
        """Check the body, one of ``bodies``, and the axis."""
        if body not in bodies:
            raise UnknownNameError("recording", "body", body, bodies)
        self.body = body
        self.axis = direction(axis, "recording", "boresight")


def mechanism_view(
    run: Trajectory,
    frames: KeyFrames,
    impacts: Impacts,
    places: dict[str, dict[str, Any]],
    ideal: tuple[Trajectory, KeyFrames] | None = None,
    boresight: tuple[str, ArrayLike] | None = None,
    magnify: float | None = None,
) -> dict[str, Any]:
    """Return the data of a recording that depend on the view (see :class:`Recording`)."""
    scene = Scene()
    factor = check_bending(run, magnify)
    motion = _Body(run, frames, "run", scene, magnify=factor)
    line = None if boresight is None else Boresight(boresight[0], boresight[1], motion.names)
    size = motion.size
    reach = 0.55 * size
    facts: list[dict[str, Any]] = []
    if bent := bending_note(run, factor):
        facts.append({"text": bent})
    trails = []
    extent = [motion.extent]
    if line is not None:
        paths = [motion.trace, *(f"{motion.paths[line.body]}/{part}" for part in ("line", "tip"))]
        text = f"boresight of {line.body} and its trace"
        facts.append({"text": text, "colour": BORESIGHT, "paths": paths})
        trails.append(motion.draw_boresight(line, reach, BORESIGHT, size))
        extent.append(motion.tips)
    actors = [motion.actor()]
    if ideal is not None:
        ghost = _Body(*ideal, "ideal", scene, (*rgb(GHOST), _CLEAR), factor)
        if not (set(ghost.names) <= set(motion.names) or set(motion.names) <= set(ghost.names)):
            raise InvalidParameterError(
                "recording", "ideal", "a run of the same mechanism", f"one of {', '.join(ghost.names)}"
            )
        actors.append(ghost.actor())
        names = ideal[0].data.attrs
        text = f"ideal run ({names.get('case') or names.get('title') or 'ideal'}), translucent"
        facts.append({"text": text, "colour": GHOST, "paths": [ghost.run]})
        if line is not None and line.body in ghost.names:
            trails.append(ghost.draw_boresight(line, reach, GHOST, size))
            extent.append(ghost.tips)
        motion.warnings += [text for text in ghost.warnings if text not in motion.warnings]
        extent.append(ghost.extent)
    marking = Marking(
        run=run,
        mechanism=mechanism_of(run),
        samples=frames.indices,
        scene=scene,
        paths=motion.paths,
        position=motion.position,
        attitude=motion.attitude,
        size=size,
    )
    for mark in filter(None, (make(marking) for make in MARKS)):
        facts.append(mark.listed())
        actors[0]["tracks"] += mark.tracks
    contacts, arrow_tips = contact_arrows(marking, impacts, places)
    applied, applied_tips = applied_arrows(marking)
    for arrows, tips, what in (
        (applied, applied_tips, "force on a link"),
        (contacts, arrow_tips, "contact force on the journal"),
    ):
        if arrows is not None:
            extent.append(tips)
            paths = sorted({item["path"] for item in arrows["items"]})
            facts.insert(0, {"text": force_scale(arrows, what), "colour": arrows["colour"], "paths": paths})
    upright = _upright(marking.mechanism)
    way = clearest(motion.surfaces(), _DIRECTION, upright)
    return {
        "commands": scene.packed(),
        "actors": actors,
        "contacts": contacts,
        "applied": applied,
        "trails": trails,
        "camera": camera(np.concatenate(extent), way, upright),
        "triad": triad("axes of the world", np.eye(3), marking.mechanism.model.gravity.linear),
        "bodies": motion.listed(marking.mechanism.urdf),
        "facts": facts,
        "warnings": motion.warnings,
    }


class _Body:
    """Bodies of a run: shapes in a scene, poses at the key frames."""

    def __init__(
        self,
        run: Trajectory,
        frames: KeyFrames,
        name: str,
        scene: Scene,
        ghost: tuple[float, float, float, float] | None = None,
        magnify: float = 1.0,
    ) -> None:
        poses = drawn_poses(run, frames.indices, magnify)
        self.run = name
        self.trace = f"{name}/trace"
        self.scene = scene
        self.ghost = ghost
        self.times = np.asarray(poses["time"].values, dtype=float)
        self.names = [str(body) for body in poses["body"].values]
        self.position = np.asarray(poses["position"].values, dtype=float)
        self.attitude = np.asarray(poses["attitude"].values, dtype=float)
        self.shapes, self.warnings = visual_shapes(mechanism_of(run).urdf)
        self.paths = {body: f"{name}/{k}" for k, body in enumerate(self.names)}
        self.tips: Array = np.zeros((0, 3))
        if not self.shapes:
            self.warnings.append("the URDF has no shapes to draw; only frames' motion is recorded")
        for k, shape in enumerate(self.shapes):
            self._draw(k, shape)
        self.extent = self._extent()
        span = np.ptp(self.extent, axis=0)
        self.size = float(np.linalg.norm(span)) or 1.0

    def _draw(self, k: int, shape: BodyShape) -> None:
        path = f"{self.paths[shape.body]}/{k}"
        # Pushed back a little, so that the ghost does not show where it coincides with the body itself.
        back = {"polygonOffset": True, "polygonOffsetFactor": 1.0, "polygonOffsetUnits": 1.0}
        looks: dict[str, Any] = {} if self.ghost is None else back
        self.scene.add(path, shape.geometry, self.ghost or shape.colour, shape.placement, **looks)

    def _extent(self) -> Array:
        """Return corners of all shapes at some key frames, (n, 3) [m]."""
        points = [self._points(body, corners) or [np.zeros((1, 3))] for body in self.names]
        return np.concatenate([one.reshape(-1, 3) for one in self._in_world(points, _FRAMED)])

    def surfaces(self) -> list[Array]:
        """Return surface points of each body at some key frames, in the world [m]."""
        spread = partial(surface, size=self.size)
        points = [[np.zeros((0, 3)), *self._points(body, spread, _OPAQUE)] for body in self.names]
        return self._in_world(points, _COMPARED)

    def _points(self, body: str, of: Callable[[Geometry], Array], opacity: float = -1.0) -> list[Array]:
        """Return points of a body's shapes above an opacity, (n, 3) [m] each."""
        mine = (one for one in self.shapes if one.body == body and one.colour[3] > opacity)
        return [of(one.geometry) @ one.placement[:3, :3].T + one.placement[:3, 3] for one in mine]

    def _in_world(self, points: list[list[Array]], most: int) -> list[Array]:
        """Return points on bodies at some key frames in the world [m]."""
        some = self._some(most)
        turns = (Rotation.from_quat(self.attitude[some, k]).as_matrix() for k in range(len(points)))
        return [
            np.einsum("tij,pj->tpi", turn, np.concatenate(local)) + self.position[some, k, None]
            for k, (turn, local) in enumerate(zip(turns, points, strict=True))
        ]

    def _some(self, most: int) -> NDArray[np.int_]:
        """Return evenly spaced key frames."""
        return np.unique(np.linspace(0, len(self.times) - 1, min(most, len(self.times))).astype(int))

    def listed(self, urdf: Urdf) -> list[dict[str, Any]]:
        """Return links with parents and shapes in the player's format."""
        parents = {joint.child: joint.parent for joint in urdf.robot.joints}
        return [
            {
                "name": body,
                "path": self.paths[body],
                "parent": parents.get(body),
                "shapes": [
                    f"{self.paths[body]}/{k}" for k, shape in enumerate(self.shapes) if shape.body == body
                ],
            }
            for body in self.names
        ]

    def actor(self) -> dict[str, Any]:
        """Return the poses in the player's format."""
        return {
            "name": self.run,
            "times": packed_doubles(self.times),
            "tracks": [
                track(
                    self.paths[body],
                    np.hstack([self.position[:, k], self.attitude[:, k]]),
                    body if self.ghost is None else f"ideal {body}",
                )
                for k, body in enumerate(self.names)
            ],
        }

    def draw_boresight(self, line: Boresight, reach: float, colour: str, size: float) -> dict[str, Any]:
        """Draw the line and its tip on its body; return the tip's trace."""
        k = self.names.index(line.body)
        path = self.paths[line.body]
        placement = np.eye(4)
        placement[:3, :3] = Rotation.align_vectors([line.axis], [[0.0, 0.0, 1.0]])[0].as_matrix()
        placement[:3, 3] = 0.5 * reach * line.axis
        thin = 0.0016 * size
        self.scene.add(f"{path}/line", Cylinder(thin, reach), rgb(colour), placement, unlit=True)
        placement[:3, 3] = reach * line.axis
        self.scene.add(f"{path}/tip", Sphere(5.0 * thin), rgb(colour), placement, unlit=True)
        turn = Rotation.from_quat(self.attitude[:, k])
        self.tips = self.position[:, k] + turn.apply(reach * line.axis)
        some = self._some(_TRAIL)
        return {
            "path": self.trace,
            "times": packed_doubles(self.times[some]),
            "points": packed_floats(self.tips[some]),
            "colour": colour,
            "radius": 1.3 * thin,
            "tail": None,
        }


def _upright(mechanism: Mechanism) -> Array:
    """Return the rotation (3, 3) from the world to axes against gravity."""
    gravity = np.array(mechanism.model.gravity.linear)
    return frame_aligning_z(-gravity).T if gravity.any() else np.eye(3)
