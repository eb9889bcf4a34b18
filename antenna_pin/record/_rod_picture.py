"""A round slider in its guide close up, drawn as :mod:`antenna_pin.record.magnified_slider` has it."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from antenna_pin.record._joint_picture import JOURNAL, MARK, RIM, TRACES, Array, JointPicture, length_text
from antenna_pin.record._profiles import line, ring, solid
from antenna_pin.record.magnified import default_magnification
from antenna_pin.record.scene import packed_doubles, packed_floats
from antenna_pin.record.shapes import lathe

_SIGNS = (1.0, -1.0)


class RodPicture(JointPicture):
    """A round slider in a round guide."""

    def _build(self, place: dict[str, Any], magnify: float | None) -> None:
        size = {name: float(value) for name, value in place["dimensions"].items()}
        self.rod = size["journal_radius"]
        self.clearance = size["bearing_radius"] - self.rod
        self.factor = default_magnification(self.rod, self.clearance) if magnify is None else magnify
        self.radius = self.rod + self.factor * self.clearance
        self.half = 0.5 * size["slider_length"]
        self.guide = size["guide_length"]
        self.reach = 0.5 * (self.guide or 1.5 * size["slider_length"])
        position, attitude = (
            np.asarray(self.journal[name].values, dtype=float)
            for name in ("journal_position", "journal_attitude")
        )
        self.turns = Rotation.from_quat(attitude).as_matrix()
        stretch = np.array([self.factor, self.factor, 1.0])
        # What only turns about the axis is not magnified.
        angle = 2.0 * np.arctan2(attitude[:, 2], attitude[:, 3])
        spun = Rotation.from_rotvec(np.outer(angle, [0.0, 0.0, 1.0])).as_matrix()
        lean = self.turns @ spun.transpose(0, 2, 1)
        self.matrix = (np.eye(3) + stretch[:, None] * (lean - np.eye(3))) @ spun
        self.shift = position * [self.factor, self.factor, 1.0 if self.guide else 0.0]
        self.position = position
        ends = np.array([-self.reach, self.reach])
        self.cut_open("run/guide", line(self.radius, ends), line(1.16 * self.radius, ends))
        for end in ends:
            self.scene.add(f"run/rim {end:+.6f}", ring(self.radius, end, 0.008 * self.radius), RIM)
        self.scene.add("run/rod/body", lathe(*solid(self.rod, -self.half, self.half)), JOURNAL)
        for k in range(3):
            angle_k = 2.0 * np.pi * k / 3.0
            along = np.array([-self.half, self.half])
            stripe = lathe(
                line(0.9 * self.rod, along), line(1.012 * self.rod, along), angle_k - 0.07, angle_k + 0.07,
                segments=4,
            )  # fmt: skip
            self.scene.add(f"run/rod/stripe{k}", stripe, MARK)

    def tracks(self) -> list[dict[str, Any]]:
        placed = np.concatenate([self.matrix, self.shift[:, :, None]], axis=2)
        data = packed_floats(placed.reshape(-1, 12))
        return [{"kind": "matrix", "name": "rod", "path": "run/rod", "data": data}]

    def drawn_points(self) -> Array:
        """Return contacts on the drawn guide, where the drawn slider comes nearest to it."""
        own = np.einsum("nji,nkj->nki", self.turns, self.point - self.position[:, None])
        drawn = np.einsum("nij,nkj->nki", self.matrix, own) + self.shift[:, None]
        across = np.linalg.norm(drawn[..., :2], axis=2, keepdims=True)
        drawn[..., :2] *= self.radius / np.where(across > 0.0, across, 1.0)
        return np.asarray(drawn)

    def extent(self) -> Array:
        angle = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
        circle = 1.16 * self.radius * np.stack([np.cos(angle), np.sin(angle)])
        long = max(self.reach, float(np.abs(self.shift[:, 2]).max()) + self.half)
        return np.concatenate([np.vstack([circle, np.full((1, 24), end)]).T for end in (-long, long)])

    def trails(self) -> list[dict[str, Any]]:
        """Return where the slider's axis went of late, at both of its ends."""
        return [
            {
                "path": "run",
                "times": packed_doubles(self.times),
                "points": packed_floats(self.shift + sign * self.half * self.matrix[:, :, 2]),
                "colour": colour,
                "radius": 0.006 * self.radius,
                "tail": 0.04 * float(self.times[-1] - self.times[0]),
                "above": True,
            }
            for sign, colour in zip(_SIGNS, TRACES, strict=True)
        ]

    def facts(self) -> list[str]:
        drawn = length_text(self.factor * self.clearance)
        return [
            f"{self.name}: play, eccentricity and tilt drawn {self.factor:g} times as large",
            "slider's size and turn about its axis as they are"
            + ("" if self.guide else "; the picture goes along with it"),
            f"radial play {length_text(self.clearance)} drawn {drawn}",
        ]
