"""A meshcat scene as the commands that build it, packed as meshcat's own viewer takes them."""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
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

from antenna_pin.record import shapes

__all__ = ["Scene", "packed_counts", "packed_doubles", "packed_floats", "viewer_licences", "viewer_script"]

Array = NDArray[np.float64]

_TOP, _BOTTOM = [0.97, 0.98, 0.99], [0.86, 0.89, 0.93]
# meshcat's cylinders lie along y.
_CYLINDER = np.eye(4)
_CYLINDER[:3, :3] = Rotation.from_euler("x", 90.0, degrees=True).as_matrix()


def packed_floats(values: ArrayLike) -> str:
    """Return numbers as little-endian 32-bit floats in base64."""
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode()


def packed_doubles(values: ArrayLike) -> str:
    """Return numbers as little-endian 64-bit floats in base64."""
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f8").tobytes()).decode()


def packed_counts(values: ArrayLike) -> str:
    """Return counts as little-endian 32-bit integers in base64."""
    return base64.b64encode(np.ascontiguousarray(values, dtype="<u4").tobytes()).decode()


def _viewer_folder() -> Path:
    return Path(meshcat.__file__).parent / "viewer"


def viewer_script() -> str:
    """Return meshcat's viewer, the script of the installed package."""
    return (_viewer_folder() / "dist" / "main.min.js").read_text(encoding="utf-8")


def viewer_licences() -> str:
    """Return the licences of meshcat's viewer and of what is in it; copies must carry them."""
    folder = _viewer_folder()
    parts = json.loads(
        (folder / "dist" / "main.min.js.THIRD_PARTY_LICENSES.json").read_text(encoding="utf-8")
    )
    texts = [("meshcat viewer", (folder / "LICENSE").read_text(encoding="utf-8"))]
    texts += [(f"{part['name']} {part['version']}", part["licenseText"] or part["license"]) for part in parts]
    return "\n\n".join(f"{name}\n{text.strip()}" for name, text in texts)


class Scene:
    """Collects the commands that build a scene; things are named by paths such as ``run/base``."""

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
            path: Its name; what is before the last stroke is what it moves with.
            geometry: What it is.
            colour: Red, green, blue and, if it is not opaque, opacity, 0 to 1 [-].
            placement: In the frame it moves with, (4, 4) [-, m].
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
        """Place something in the frame it moves with, (4, 4) [-, m]."""
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
        sphere = meshes.Sphere(geometry.radius)
        return sphere
    return meshes.TriangularMeshGeometry(geometry.vertices, geometry.faces)


def _plain(value: Any) -> Any:
    """Return a command with numpy's numbers made Python's, which is what msgpack takes."""
    if isinstance(value, dict):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [_plain(entry) for entry in value]
    return value.item() if isinstance(value, np.generic) else value
