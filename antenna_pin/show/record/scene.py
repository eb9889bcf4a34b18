"""Scene of meshcat as commands for its viewer, axes, and first view."""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import meshcat
import numpy as np
import umsgpack
from meshcat import geometry as meshes
from meshcat.commands import SetObject, SetProperty, SetTransform
from meshcat.path import Path as ScenePath
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.show.record import shapes

# --- scene --------------------------------------------------------------------------------------------------

Array = NDArray[np.float64]

_TOP, _BOTTOM = [0.97, 0.98, 0.99], [0.86, 0.89, 0.93]
# meshcat's cylinders lie along y.
_CYLINDER = np.eye(4)
_CYLINDER[:3, :3] = Rotation.from_euler("x", 90.0, degrees=True).as_matrix()


def _packed(kind: str, values: ArrayLike) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode()


#: Numbers in base64, little-endian: 32-bit floats, 64-bit floats, 32-bit counts.
packed_floats, packed_doubles, packed_counts = (partial(_packed, kind) for kind in ("<f4", "<f8", "<u4"))


def track(path: str, data: Array, name: str | None = None) -> dict[str, Any]:
    """Return the motion of a path by placements (n, 3, 4) or poses (n, 7)."""
    return {
        "kind": "pose" if data.ndim == 2 else "matrix",
        "name": path.rpartition("/")[2] if name is None else name,
        "path": path,
        "data": packed_floats(data),
    }


def _viewer_folder() -> Path:
    return Path(meshcat.__file__).parent / "viewer"


def viewer_script() -> str:
    """Return meshcat's viewer, the script of the installed package."""
    return (_viewer_folder() / "dist" / "main.min.js").read_text(encoding="utf-8")


def viewer_licences() -> str:
    """Return the licences of meshcat's viewer and its parts, for its copies."""
    folder = _viewer_folder()
    parts = json.loads(
        (folder / "dist" / "main.min.js.THIRD_PARTY_LICENSES.json").read_text(encoding="utf-8")
    )
    texts = [("meshcat viewer", (folder / "LICENSE").read_text(encoding="utf-8"))]
    texts += [(f"{part['name']} {part['version']}", part["licenseText"] or part["license"]) for part in parts]
    return "\n\n".join(f"{name}\n{text.strip()}" for name, text in texts)


class Scene:
    """Commands that build a scene of things at paths such as ``run/base``."""

    def __init__(self) -> None:
        """Begin with an empty scene before a light background."""
        self._commands: list[dict[str, Any]] = []
        self._count = 0
        for name in ("Grid", "Axes"):
            self._set(name, "visible", False)
        self._set("Background", "top_color", _TOP)
        self._set("Background", "bottom_color", _BOTTOM)

    def _set(self, path: str, name: str, value: Any) -> None:
        self._commands.append(SetProperty(name, value, _path(path)).lower())

    def add(
        self,
        path: str,
        geometry: shapes.Geometry,
        colour: Sequence[float],
        placement: ArrayLike | None = None,
        **material: Any,
    ) -> None:
        """Add a shape.

        Args:
            path: Name; it moves with the path before the last stroke.
            geometry: Shape.
            colour: Red, green, blue and, if it is not opaque, opacity, 0 to 1 [-].
            placement: Placement in the frame that it moves with, (4, 4) [-, m].
            material: Properties of the viewer's material, such as ``depthWrite=False``.
        """
        red, green, blue, *alpha = colour
        opacity = alpha[0] if alpha else 1.0
        properties: dict[str, Any] = {"side": 2 if isinstance(geometry, shapes.Mesh) else 0, "shininess": 25}
        if opacity < 1.0:
            properties["depthWrite"] = False
        code = sum(round(255 * value) << shift for value, shift in ((red, 16), (green, 8), (blue, 0)))
        kind = meshes.MeshBasicMaterial if material.pop("unlit", False) else meshes.MeshPhongMaterial
        drawn = meshes.Mesh(_geometry(geometry), kind(color=code, opacity=opacity, **(properties | material)))
        # meshcat names things by clock and network card: neither belongs into a file.
        for part, what in ((drawn.geometry, "geometry"), (drawn.material, "material"), (drawn, "object")):
            part.uuid = f"{what}-{self._count}"
        self._count += 1
        self._commands.append(SetObject(drawn, path=_path(path)).lower())
        matrix = np.eye(4) if placement is None else np.asarray(placement, dtype=float)
        if isinstance(geometry, shapes.Cylinder):
            matrix = matrix @ _CYLINDER
        self.place(path, matrix)

    def place(self, path: str, placement: ArrayLike) -> None:
        """Place a thing in the frame that it moves with, (4, 4) [-, m]."""
        matrix = np.asarray(placement, dtype=float)
        self._commands.append(SetTransform(matrix, _path(path)).lower())

    def packed(self) -> list[str]:
        """Return the commands in order, each as base64 of msgpack."""
        return [base64.b64encode(umsgpack.packb(_plain(command))).decode() for command in self._commands]


def _path(text: str) -> Any:
    return ScenePath(tuple(text.split("/")))


def _geometry(geometry: shapes.Geometry) -> Any:
    if isinstance(geometry, shapes.Box):
        return meshes.Box(list(geometry.size))
    if isinstance(geometry, shapes.Cylinder):
        return meshes.Cylinder(geometry.length, geometry.radius)
    if isinstance(geometry, shapes.Sphere):
        return meshes.Sphere(geometry.radius)
    return meshes.TriangularMeshGeometry(geometry.vertices, geometry.faces)


def _plain(value: Any) -> Any:
    """Return a command with numpy's numbers as Python's, for msgpack."""
    if isinstance(value, dict):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [_plain(entry) for entry in value]
    return value.item() if isinstance(value, np.generic) else value


# --- axes ---------------------------------------------------------------------------------------------------


def triad(
    label: str, axes: ArrayLike, gravity: ArrayLike | None = None, times: ArrayLike = (0.0,)
) -> dict[str, Any]:
    """Return a triad in the player's format, all in the axes of the scene.

    Args:
        label: Name of the axes.
        axes: Unit vectors x, y and z, (3, 3), a row each [-].
        gravity: Direction over time, (n, 3), any length [-]; None or zero without gravity.
        times: Times of these directions, (n,) [s].
    """
    pull = np.zeros((1, 3)) if gravity is None else np.atleast_2d(np.asarray(gravity, dtype=float))
    moments = np.asarray(times, dtype=float)
    if np.ptp(pull, axis=0).max() <= 1e-6 * np.abs(pull).max():
        pull, moments = pull[:1], moments[:1]  # it does not turn
    return {
        "label": label,
        "axes": np.asarray(axes, dtype=float).tolist(),
        "gravity": packed_floats(pull) if pull.any() else None,
        "times": packed_doubles(moments),
    }


# --- first view ---------------------------------------------------------------------------------------------

# Views that are compared: so many around, at these heights over the horizon [rad]. The first is kept unless
# another shows so much more [-].
_AROUND = 12
_HEIGHTS = (0.41, 0.75)
_BETTER = 0.1
_CELLS = 48  # over the greatest way of all that moves, by which it is counted who hides whom


def nice(value: float) -> float:
    """Return the next 1, 2 or 5 times a power of ten, not above."""
    power = 10.0 ** np.floor(np.log10(value))
    digit = max(step for step in (1.0, 2.0, 5.0) if step * power <= value * (1.0 + 1e-12))
    return float(f"{digit * power:.1g}")


def camera(points: Array, direction: ArrayLike, upright: ArrayLike | None = None) -> dict[str, Any]:
    """Return the outermost of points (n, 3) [m], their middle, and the camera's direction.

    ``direction`` points from the middle to the camera, (3,) [-], in axes of which z points up; ``upright`` is
    the rotation from the points' axes to those, (3, 3) [-].
    """
    k = np.arange(256)
    z = 1.0 - (2.0 * k + 1.0) / len(k)
    phi = np.pi * (3.0 - np.sqrt(5.0)) * k
    sphere = np.stack([np.sqrt(1.0 - z * z) * np.cos(phi), np.sqrt(1.0 - z * z) * np.sin(phi), z], axis=1)
    outermost = np.unique([int(np.argmax(points @ direction)) for direction in sphere])
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    return {
        "points": packed_floats(points[outermost]),
        "target": middle.tolist(),
        "direction": np.asarray(direction, dtype=float).tolist(),
        "upright": np.asarray(np.eye(3) if upright is None else upright, dtype=float).tolist(),
    }


def clearest(places: Sequence[Array], default: ArrayLike, upright: Array) -> Array:
    """Return the direction in which bodies hide one another least, (3,) [-].

    For each direction and some instants, the cells of a coarse picture with a body in front are counted, as a
    share of the body's most over the directions. The mean of the shares' square roots counts: a body that is
    hidden weighs more than a tenth of many that is hidden.

    Args:
        places: Points of the surface of each body at the instants, (instants, points, 3) each [m].
        default: Default direction, (3,) [-]; as the result, in axes of which z points up.
        upright: Rotation from the points' axes to those, (3, 3) [-].
    """
    some = [points @ upright.T for points in places if points.size]
    start: Array = np.asarray(default, dtype=float) / np.linalg.norm(default)
    if len(some) < 2:
        return start
    azimuth = np.arctan2(start[1], start[0])
    ways = [start] + [
        np.array([np.cos(height) * np.cos(phi), np.cos(height) * np.sin(phi), np.sin(height)])
        for height in _HEIGHTS
        for phi in azimuth + 2.0 * np.pi * np.arange(_AROUND) / _AROUND
    ]
    every = np.concatenate([points.reshape(-1, 3) for points in some])
    step = max(float(np.ptp(every, axis=0).max()), 1e-300) / _CELLS
    seen = np.array([_in_front(some, way, step) for way in ways])  # (ways, instants, bodies)
    most = seen.max(axis=0)
    counted = most > 0.0
    score = np.sqrt(seen / np.where(counted, most, 1.0)).sum(axis=(1, 2)) / max(counted.sum(), 1)
    best = int(np.argmax(score))
    chosen: Array = ways[best] if score[best] > score[0] + _BETTER else start
    return chosen


def _in_front(places: Sequence[Array], way: Array, step: float) -> Array:
    """Return the number of picture cells with each body in front, (instants, bodies)."""
    right = np.cross([0.0, 0.0, 1.0], way)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(way, right), way])
    seen = [points @ axes.T for points in places]  # right, up, towards who looks
    count = np.zeros((seen[0].shape[0], len(seen)))
    owner = np.repeat(np.arange(len(seen)), [points.shape[1] for points in seen])
    for k in range(count.shape[0]):
        points = np.concatenate([one[k] for one in seen])
        low = points[:, :2].min(axis=0)
        column, row = np.floor((points[:, :2] - low) / step).astype(int).T
        cell = row * (2 * _CELLS) + column
        order = np.lexsort((points[:, 2], cell))  # of each cell the foremost comes last
        last = np.flatnonzero(np.diff(cell[order], append=-1))
        count[k] = np.bincount(owner[order[last]], minlength=len(seen))
    return count
