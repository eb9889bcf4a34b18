#!/usr/bin/env python3
"""Write the mesh of a paraboloid dish: a closed shell of constant thickness, as a Wavefront OBJ in metres.

The middle surface is x = r^2 / (4 f): vertex at the origin, opening to +x. Without options it writes the
reflector of models/bai2020, whose README says where rim radius, focal length and thickness come from.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import numpy as np
import numpy.typing as npt

# Of a petal's grid: along the radius, around the axis.
_ROWS, _COLUMNS = 13, 9

DEFAULT_OUT = Path(__file__).resolve().parents[1] / "models" / "bai2020" / "dish.obj"


def petal(
    inner: float, rim_radius: float, focal_length: float, thickness: float, half_angle: float
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
    """Return vertices [m] and triangles of a sector of that shell, over the y axis and closed all round.

    Args:
        inner: Least radius [m].
        rim_radius: Largest radius [m].
        focal_length: f [m].
        thickness: Along the normal, half of it to either side [m].
        half_angle: Half of the angle that it spans [rad].
    """
    radius, angle = np.linspace(inner, rim_radius, _ROWS), np.linspace(-half_angle, half_angle, _COLUMNS)
    slope = radius / (2.0 * focal_length)
    normal = np.stack([np.ones(_ROWS), -slope]) / np.sqrt(1.0 + slope**2)
    surfaces = []
    for side in (0.5, -0.5):
        x, r = np.stack([radius**2 / (4.0 * focal_length), radius]) + side * thickness * normal
        surfaces.append(
            np.stack(
                [
                    np.repeat(x, _COLUMNS),
                    np.outer(r, np.cos(angle)).ravel(),
                    np.outer(r, np.sin(angle)).ravel(),
                ],
                axis=1,
            )
        )
    place = np.arange(_ROWS * _COLUMNS).reshape(_ROWS, _COLUMNS)
    corners = [place[:-1, :-1], place[1:, :-1], place[1:, 1:], place[:-1, 1:]]
    a, b, c, d = (one.ravel() for one in corners)
    hollow = np.vstack([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    back = hollow[:, ::-1] + place.size
    # Around the edge, from hollow side to back: counterclockwise as seen from the hollow side.
    edge = np.concatenate([place[:-1, 0], place[-1, :-1], place[:0:-1, -1], place[0, :0:-1]])
    after = np.roll(edge, -1)
    side_faces = np.vstack(
        [
            np.stack([edge, edge + place.size, after + place.size], axis=1),
            np.stack([edge, after + place.size, after], axis=1),
        ]
    )
    return np.vstack(surfaces), np.vstack([hollow, back, side_faces])


def dish(
    rim_radius: float, focal_length: float, thickness: float, rings: int, sectors: int
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
    """Return vertices [m] and triangles (outward by the right-hand rule, from 0) of a paraboloid shell.

    Args:
        rim_radius: Of the middle surface [m].
        focal_length: f [m].
        thickness: Along the normal, half of it to either side [m].
        rings: Circles of vertices from the vertex to the rim [-].
        sectors: Vertices per circle [-].
    """
    radius = rim_radius * np.arange(1, rings + 1) / rings
    slope = np.concatenate(([0.0], radius)) / (2.0 * focal_length)
    middle = np.stack(
        [np.concatenate(([0.0], radius)) ** 2 / (4.0 * focal_length), np.concatenate(([0.0], radius))]
    )
    normal = np.stack([np.ones(rings + 1), -slope]) / np.sqrt(1.0 + slope**2)  # to the hollow side

    angle = 2.0 * math.pi * np.arange(sectors) / sectors
    surfaces = []
    for side in (0.5, -0.5):
        x, r = middle + side * thickness * normal
        circles = np.stack(
            [
                np.repeat(x[1:], sectors),
                np.outer(r[1:], np.cos(angle)).ravel(),
                np.outer(r[1:], np.sin(angle)).ravel(),
            ],
            axis=1,
        )
        surfaces.append(np.vstack([[x[0], 0.0, 0.0], circles]))
    count = 1 + rings * sectors

    triangles: list[tuple[int, int, int]] = []
    for k in range(sectors):
        n = (k + 1) % sectors
        triangles.append((0, 1 + k, 1 + n))
        for ring in range(rings - 1):
            inner, outer = 1 + ring * sectors, 1 + (ring + 1) * sectors
            triangles += [(inner + k, outer + k, outer + n), (inner + k, outer + n, inner + n)]
    hollow = np.array(triangles)
    back = hollow[:, ::-1] + count
    last = 1 + (rings - 1) * sectors
    k = np.arange(sectors)
    n = (k + 1) % sectors
    rim = np.vstack(
        [
            np.stack([last + k, count + last + k, count + last + n], axis=1),
            np.stack([last + k, count + last + n, last + n], axis=1),
        ]
    )
    return np.vstack(surfaces), np.vstack([hollow, back, rim])


def obj(vertices: npt.NDArray[np.float64], triangles: npt.NDArray[np.int64], title: str) -> str:
    """Return a mesh as Wavefront OBJ text, coordinates to a micrometre."""
    lines = [f"# {title}", "o dish"]
    lines += ["v {:.6f} {:.6f} {:.6f}".format(*(vertex + 0.0)) for vertex in np.round(vertices, 6)]
    lines += ["f {} {} {}".format(*(triangle + 1)) for triangle in triangles]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Read the options and write the file."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rim-radius", type=float, default=0.486, help="m (default: %(default)s)")
    parser.add_argument("--focal-length", type=float, default=0.120, help="m (default: %(default)s)")
    parser.add_argument("--thickness", type=float, default=0.0052, help="m (default: %(default)s)")
    parser.add_argument("--rings", type=int, default=16, help="(default: %(default)s)")
    parser.add_argument("--sectors", type=int, default=48, help="(default: %(default)s)")
    parser.add_argument("--out", type=Path, default=DEFAULT_OUT, help="(default: models/bai2020/dish.obj)")
    parser.add_argument("--petals", type=int, help="write one petal of so many, from --hub-radius on")
    parser.add_argument("--hub-radius", type=float, default=0.1, help="m (default: %(default)s)")
    options = parser.parse_args()
    if not min(options.rim_radius, options.focal_length, options.thickness) > 0.0:
        parser.error("rim radius, focal length and thickness must be positive")
    if options.rings < 2 or options.sectors < 3:
        parser.error("a dish needs at least 2 rings and 3 sectors")
    shape = (options.rim_radius, options.focal_length, options.thickness)
    title = (
        "paraboloid dish, m: rim radius {:g}, focal length {:g}, thickness {:g}; scripts/make_dish.py".format(
            *shape
        )
    )
    if options.petals is not None:
        if options.petals < 2 or not 0.0 < options.hub_radius < options.rim_radius:
            parser.error("a dish has 2 petals or more, and they begin inside the rim")
        # A gap of 2 % between petals, to see them apart.
        made = petal(options.hub_radius, *shape, 0.98 * math.pi / options.petals)
        title = f"one of {options.petals} petals of a {title}, from {options.hub_radius:g}"
        options.out.write_text(obj(*made, title), encoding="ascii")
        return
    options.out.write_text(obj(*dish(*shape, options.rings, options.sectors), title), encoding="ascii")


if __name__ == "__main__":
    main()
