"""A ball in a socket close up."""

from __future__ import annotations

from typing import Any

import numpy as np

from antenna_pin.record._joint_picture import JOURNAL, MARK, Array, JointPicture, length_text
from antenna_pin.record._profiles import arc, ring
from antenna_pin.record.magnified import MagnifiedBall, default_magnification
from antenna_pin.record.scene import packed_floats
from antenna_pin.record.shapes import Mesh, Sphere, lathe


class BallPicture(JointPicture):
    """A ball joint."""

    def _build(self, place: dict[str, Any], magnify: float | None) -> None:
        dimensions = place["dimensions"]
        ball = float(dimensions["ball_radius"])
        self.clearance = float(dimensions["socket_radius"]) - ball
        factor = self.factor = default_magnification(ball, self.clearance) if magnify is None else magnify
        shape = self.shape = MagnifiedBall.of(dimensions, factor)
        self.radius = shape.socket_radius
        self.centre = shape.centre(
            self.gap[:, 0], np.asarray(self.journal["journal_position"].values, dtype=float)
        )
        self.cut_open("run/socket", arc(shape.socket_radius), arc(1.1 * shape.socket_radius))
        solid = arc(shape.ball_radius)
        self.scene.add("run/ball/body", lathe(solid * [0.0, 1.0], solid), JOURNAL)
        for k, turn in enumerate(("xyz", "yzx", "zxy")):
            hoop = ring(shape.ball_radius, 0.0, 0.02 * shape.ball_radius)
            order = ["xyz".index(axis) for axis in turn]
            self.scene.add(f"run/ball/ring{k}", Mesh(hoop.vertices[:, order], hoop.faces), MARK)
        self.scene.add("run/ball/pole", Sphere(0.1 * shape.ball_radius), MARK, _shifted(shape.ball_radius))

    def tracks(self) -> list[dict[str, Any]]:
        attitude = np.asarray(self.journal["journal_attitude"].values, dtype=float)
        data = packed_floats(np.hstack([self.centre, attitude]))
        return [{"kind": "pose", "name": "ball", "path": "run/ball", "data": data}]

    def drawn_points(self) -> Array:
        return self.shape.points(self.point[:, 0])[:, None]

    def extent(self) -> Array:
        r = 1.1 * self.radius
        k = np.arange(64)
        z, phi = 1.0 - (2.0 * k + 1.0) / 64.0, 2.4 * k
        return r * np.stack([np.sqrt(1 - z * z) * np.cos(phi), np.sqrt(1 - z * z) * np.sin(phi), z], axis=1)

    def facts(self) -> list[str]:
        factor = self.shape.factor
        return [
            f"{self.name}: play and eccentricity drawn {factor:g} times as large",
            "ball's radius and rotation as they are",
            f"play {length_text(self.clearance)} drawn {length_text(factor * self.clearance)}",
        ]


def _shifted(z: float) -> Array:
    result = np.eye(4)
    result[2, 3] = z
    return result
