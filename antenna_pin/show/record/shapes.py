"""Shapes to draw: visuals of a URDF, and bodies of revolution."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import trimesh
from numpy.typing import ArrayLike, NDArray

from antenna_pin.mechanism import Urdf

Array = NDArray[np.float64]

# Of links without a colour: people who see no red or no green tell them apart too, and none is near that of a
# force, a boresight or a ghost; darker from the second round on.
_PALETTE = (
    (0.74, 0.76, 0.79),  # grey
    (0.60, 0.87, 1.00),  # light blue
    (0.93, 0.87, 0.53),  # sand
    (0.27, 0.73, 0.60),  # teal
    (0.55, 0.34, 0.29),  # brown
    (0.67, 0.67, 0.00),  # olive
    (0.16, 0.28, 0.35),  # slate
    (0.96, 0.94, 0.88),  # cream
)
_DARKER = 0.75
_SMOOTH = np.radians(35.0)  # edges sharper than that stay edges
_FEWEST_POINTS, _MOST_POINTS = 20, 20_000  # on the surface of a shape
_FARTHEST = 1e9  # of a vertex [m]; pictures are drawn in single precision, where squares must not overflow


@dataclass(frozen=True, slots=True)
class Box:
    """Box about its centre, of lengths along x, y, z, (3,) [m]."""

    size: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Cylinder:
    """Cylinder about its centre, along z [m]."""

    radius: float
    length: float


@dataclass(frozen=True, slots=True)
class Sphere:
    """Ball about its centre [m]."""

    radius: float


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Triangles (m, 3) of vertices (n, 3) [m], shared where the surface is smooth."""

    vertices: Array
    faces: NDArray[np.int64]


Geometry: TypeAlias = Box | Cylinder | Sphere | Mesh


@dataclass(frozen=True, slots=True, eq=False)
class BodyShape:
    """Shape on a body: placement in the link's frame, (4, 4), and colour with opacity."""

    body: str
    geometry: Geometry
    placement: Array
    colour: tuple[float, float, float, float]


def visual_shapes(urdf: Urdf) -> tuple[list[BodyShape], list[str]]:
    """Return the visual shapes of all links, and a line for each failure.

    Links without a colour of their own get a distinct one.
    """
    colours = {
        material.name: tuple(map(float, material.color.rgba))
        for material in urdf.robot.materials
        if material.color is not None
    }
    # A name stands for a colour wherever in the file it is given, in a link too.
    for link in urdf.robot.links:
        for visual in link.visuals:
            if visual.material is not None and visual.material.name and visual.material.color is not None:
                colours.setdefault(visual.material.name, tuple(map(float, visual.material.color.rgba)))
    shapes: list[BodyShape] = []
    warnings = [f"{link}: {problem}; not drawn" for link, problem in urdf.undrawn]
    missing: list[str] = []
    bare = 0
    for link in urdf.robot.links:
        own, plain = _palette_colour(bare), [_colour(one.material, colours) is None for one in link.visuals]
        bare += any(plain)
        for visual in link.visuals:
            try:
                geometry = _geometry(visual.geometry, urdf)
            except _MissingError as error:
                missing.append(f"{link.name}: {error}; not drawn")
                continue
            except _NotDrawnError as error:
                warnings.append(f"{link.name}: {error}; not drawn")
                continue
            placement = np.eye(4) if visual.origin is None else np.array(visual.origin, dtype=float)
            colour = _colour(visual.material, colours) or own
            shapes.append(BodyShape(link.name, geometry, placement, colour))
    if len(missing) > 1:  # one line of all
        missing = [f"{len(missing)} mesh files are missing and not drawn, such as that of {missing[0]}"]
    return shapes, missing + warnings


class _NotDrawnError(Exception):
    """Reason why a shape cannot be drawn."""


class _MissingError(Exception):
    """Warning of a missing mesh."""


def _geometry(geometry: Any, urdf: Urdf) -> Geometry:
    if geometry.box is not None:
        x, y, z = map(float, geometry.box.size)
        return Box((x, y, z))
    if geometry.cylinder is not None:
        return Cylinder(float(geometry.cylinder.radius), float(geometry.cylinder.length))
    if geometry.sphere is not None:
        return Sphere(float(geometry.sphere.radius))
    if geometry.mesh is None:
        raise _NotDrawnError("a shape of an unknown kind")
    scale = 1.0 if geometry.mesh.scale is None else np.asarray(geometry.mesh.scale, dtype=float)
    name = str(geometry.mesh.filename)
    mesh = _read_mesh(name, urdf)
    with np.errstate(over="ignore", invalid="ignore"):
        vertices = mesh.vertices * scale
    farthest = np.abs(vertices).max()
    if not farthest <= _FARTHEST:
        raise _NotDrawnError(
            f"mesh file {name!r} must have its vertices within {_FARTHEST:g} m, got {farthest:.3g} m "
            "(a mesh's scale makes metres of other units)"
        )
    return Mesh(vertices, mesh.faces)


def _read_mesh(name: str, urdf: Urdf) -> Mesh:
    path = urdf.mesh_file(name)
    if path is None:
        raise _MissingError(f"mesh file {name!r} is missing")
    try:
        with np.errstate(all="ignore"):  # of vertices too far away, which are refused
            loaded: Any = trimesh.load(path, force="mesh", process=True)
            smooth = trimesh.graph.smooth_shade(loaded, angle=_SMOOTH)
    except Exception as error:  # trimesh lets through whatever its readers raise
        raise _NotDrawnError(f"mesh file {name!r} cannot be read ({error})") from None
    if not len(smooth.faces):
        raise _NotDrawnError(f"mesh file {name!r} has no faces")
    return Mesh(np.asarray(smooth.vertices, dtype=float), np.asarray(smooth.faces, dtype=np.int64))


def _palette_colour(number: int) -> tuple[float, float, float, float]:
    """Return the colour of the link ``number`` without its own."""
    dark = _DARKER ** (number // len(_PALETTE))
    red, green, blue = (dark * part for part in _PALETTE[number % len(_PALETTE)])
    return red, green, blue, 1.0


def _colour(material: Any, known: dict[str, tuple[float, ...]]) -> tuple[float, float, float, float] | None:
    """Return red, green, blue and opacity of a URDF's material, or None."""
    rgba = None
    if material is not None:
        rgba = material.color.rgba if material.color is not None else known.get(material.name)
    if rgba is None:
        return None
    red, green, blue, alpha = (float(np.clip(value, 0.0, 1.0)) for value in rgba)
    return red, green, blue, alpha


def corners(geometry: Geometry) -> Array:
    """Return the corners of a shape's box in its own frame, (8, 3) [m]."""
    if isinstance(geometry, Mesh):
        low, high = geometry.vertices.min(axis=0), geometry.vertices.max(axis=0)
    else:
        if isinstance(geometry, Box):
            high = 0.5 * np.array(geometry.size)
        elif isinstance(geometry, Cylinder):
            high = np.array([geometry.radius, geometry.radius, 0.5 * geometry.length])
        else:
            high = np.full(3, geometry.radius)
        low = -high
    return np.array(list(itertools.product(*zip(low, high, strict=True))))


def surface(geometry: Geometry, size: float) -> Array:
    """Return points spread over a shape's surface in its own frame, (n, 3) [m].

    They are the same each time: a square of a fortieth of ``size``, of the whole mechanism [m], has about
    two.
    """
    if isinstance(geometry, Mesh):
        mesh = trimesh.Trimesh(geometry.vertices, geometry.faces, process=False)
    elif isinstance(geometry, Box):
        mesh = trimesh.creation.box(geometry.size)
    elif isinstance(geometry, Cylinder):
        mesh = trimesh.creation.cylinder(geometry.radius, geometry.length, sections=24)
    else:
        mesh = trimesh.creation.icosphere(2, geometry.radius)
    area = np.cumsum(mesh.area_faces)
    if not area[-1] > 0.0:
        return np.asarray(mesh.vertices, dtype=float)
    count = int(np.clip(2.0 * area[-1] / (size / 40.0) ** 2, _FEWEST_POINTS, _MOST_POINTS))
    # Even steps of area, and within triangles an even sequence of two dimensions (Roberts).
    k = np.arange(count) + 0.5
    triangles = mesh.triangles[np.searchsorted(area, k / count * area[-1])]
    u, v = (0.7548776662466927 * k) % 1.0, (0.5698402909980532 * k) % 1.0
    u, v = np.where(u + v > 1.0, 1.0 - u, u), np.where(u + v > 1.0, 1.0 - v, v)
    weights = np.stack([1.0 - u - v, u, v], axis=1)
    return np.asarray(np.einsum("nk,nki->ni", weights, triangles))


def lathe(
    inner: ArrayLike, outer: ArrayLike, start: float = 0.0, end: float = 2.0 * np.pi, segments: int = 96
) -> Mesh:
    """Return a body of revolution about z from ``start`` to ``end`` [rad], its cuts closed.

    Inner and outer surface are lines of radius and z from low to high, (n, 2) [m]; the inner one is smooth
    between its two ends.
    """
    inside, outside = np.asarray(inner, dtype=float), np.asarray(outer, dtype=float)
    angles = np.linspace(start, end, segments + 1)
    parts: list[Mesh] = [_turned(inside[::-1], angles), _turned(outside, angles)]
    for k in (0, -1):  # the ends, where inner and outer surface do not meet there
        if not np.allclose(inside[k], outside[k]):
            rim = np.array([inside[k], outside[k]])
            parts.append(_turned(rim if k == 0 else rim[::-1], angles))
    if end - start < 2.0 * np.pi - 1e-9:
        parts += [_cut(inside, outside, angle, first) for angle, first in ((start, True), (end, False))]
    counts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    return Mesh(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.faces + count for part, count in zip(parts, counts, strict=False)]),
    )


def _turned(line: Array, angles: Array) -> Mesh:
    """Return the surface swept by a line (n, 2), facing to its right."""
    n, m = len(line), len(angles)
    x = np.cos(angles)[:, None] * line[:, 0]
    y = np.sin(angles)[:, None] * line[:, 0]
    vertices = np.stack([x, y, np.broadcast_to(line[:, 1], (m, n))], axis=2).reshape(-1, 3)
    return Mesh(vertices, grid(m, n))


def _cut(inner: Array, outer: Array, angle: float, begins: bool) -> Mesh:
    lines = np.stack([inner, outer] if begins else [outer, inner])
    x, y = lines[..., 0] * np.cos(angle), lines[..., 0] * np.sin(angle)
    vertices = np.stack([x, y, lines[..., 1]], axis=2).reshape(-1, 3)
    return Mesh(vertices, grid(2, lines.shape[1]))


def grid(rows: int, columns: int) -> NDArray[np.int64]:
    """Return the triangles of a grid of vertices, row by row, (m, 3)."""
    i, k = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a = (i * columns + k).ravel()
    b = a + columns
    return np.concatenate([np.stack([a, b, b + 1], axis=1), np.stack([a, b + 1, a + 1], axis=1)])


# --- profiles of bodies of revolution -----------------------------------------------------------------------


def line(radius: float, ends: Array) -> Array:
    """Return the profile of a cylinder between two heights, (2, 2) [m]."""
    return np.stack([np.full(2, radius), ends], axis=1)


def solid(radius: float, low: float, high: float) -> tuple[Array, Array]:
    """Return the inner and outer profile of a solid cylinder, (2, 2) each [m]."""
    ends = np.array([low, high])
    return line(0.0, ends), line(radius, ends)


def arc(radius: float) -> Array:
    """Return the profile of a sphere, (49, 2) [m]."""
    angle = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 49)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def ring(radius: float, height: float, thick: float) -> Mesh:
    """Return a thin ring about the axis, of wire of radius ``thick`` [m]."""
    angle = np.linspace(0.0, np.pi, 9)
    across = np.stack([thick * np.cos(angle), thick * np.sin(angle)], axis=1)
    middle = np.array([radius, height])
    return lathe(middle + across[:, ::-1] * [-1.0, 1.0], middle + across[:, ::-1])
