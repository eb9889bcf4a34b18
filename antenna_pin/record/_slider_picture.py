"""A slider in its guide close up: a prismatic joint."""

from __future__ import annotations

from typing import Any

import numpy as np

from antenna_pin.record._joint_picture import (
    BEARING,
    JOURNAL,
    MARK,
    REST,
    RIM,
    TRACES,
    Array,
    JointPicture,
    length_text,
)
from antenna_pin.record.magnified import default_magnification
from antenna_pin.record.magnified_slider import MagnifiedSlider
from antenna_pin.record.scene import packed_doubles, packed_floats
from antenna_pin.record.shapes import Box

_SIGNS = (1.0, -1.0)


class SliderPicture(JointPicture):
    """A slider in a guide; the guide's walls before it are drawn faintly."""

    def _build(self, place: dict[str, Any], magnify: float | None) -> None:
        dimensions = place["dimensions"]
        slider, guide = (
            np.array([float(dimensions[f"{part}_{side}"]) for side in ("width", "height")])
            for part in ("slider", "guide")
        )
        self.play = 0.5 * (guide - slider)
        self.clearance = float(self.play.min())
        half = 0.5 * float(slider.min())
        factor = self.factor = default_magnification(half, self.clearance) if magnify is None else magnify
        shape = self.shape = MagnifiedSlider.of(dimensions, factor)
        self.radius = 0.5 * float(shape.guide.min())
        self.position, self.attitude = (
            np.asarray(self.journal[name].values, dtype=float)
            for name in ("journal_position", "journal_attitude")
        )
        self.ends = [place["contacts"][name]["end"] for name in self.contacts]
        self.placed = shape.slider(self.position, self.attitude)
        self.length = shape.length or 1.5 * float(shape.size[2])
        self._draw_guide()
        self._draw_slider()

    def _draw_guide(self) -> None:
        shape = self.shape
        thick, thin = 0.12 * self.radius, 0.012 * self.radius
        half = 0.5 * shape.guide
        camera = self.camera @ shape.turn  # section axes
        for axis in (0, 1):
            for sign in _SIGNS:
                centre, size = np.zeros(3), np.full(3, self.length)
                centre[axis] = sign * (half[axis] + 0.5 * thick)
                size[axis], size[1 - axis] = thick, 2.0 * (half[1 - axis] + thick * axis)
                before = sign * camera[axis] > 0.0
                self._box(f"run/wall {'xy'[axis]}{sign:+.0f}", size, centre, REST if before else BEARING)
        for end in _SIGNS:
            for axis in (0, 1):
                for sign in _SIGNS:
                    centre, size = np.zeros(3), np.full(3, thin)
                    centre[axis], centre[2] = sign * half[axis], 0.5 * end * self.length
                    size[1 - axis] = 2.0 * half[1 - axis]
                    self._box(f"run/rim {'xy'[axis]}{sign:+.0f}{end:+.0f}", size, centre, RIM)

    def _draw_slider(self) -> None:
        size = self.shape.size
        self._box("run/slider/body", size, np.zeros(3), JOURNAL)
        thin = 0.02 * self.radius
        for axis in range(3):  # its edges, so that tilt and turn are seen
            others = [k for k in range(3) if k != axis]
            for first in _SIGNS:
                for second in _SIGNS:
                    centre, long = np.zeros(3), np.full(3, thin)
                    centre[others] = 0.5 * size[others] * [first, second] - 0.49 * thin * np.array(
                        [first, second]
                    )
                    long[axis] = size[axis] * 1.002
                    self._box(f"run/slider/edge {axis}{first:+.0f}{second:+.0f}", long, centre, MARK)

    def _box(self, path: str, size: Array, centre: Array, colour: tuple[float, ...]) -> None:
        """Draw a box given in the section's axes."""
        placement = np.eye(4)
        placement[:3, :3] = self.shape.turn
        placement[:3, 3] = self.shape.turn @ centre
        width, height, length = map(float, size)
        self.scene.add(path, Box((width, height, length)), colour, placement)

    def tracks(self) -> list[dict[str, Any]]:
        data = packed_floats(self.placed.reshape(-1, 12))
        return [{"kind": "matrix", "name": "slider", "path": "run/slider", "data": data}]

    def drawn_points(self) -> Array:
        return np.stack([self.shape.point(end, self.position, self.attitude) for end in self.ends], axis=1)

    def extent(self) -> Array:
        long = 0.5 * self.length
        if self.shape.length:
            long = max(long, float(np.abs(self.placed[:, 2, 3]).max()) + 0.5 * float(self.shape.size[2]))
        half = np.append(0.5 * self.shape.guide + 0.12 * self.radius, long)
        signs = np.array([[x, y, z] for x in _SIGNS for y in _SIGNS for z in _SIGNS])
        return np.asarray((signs * half) @ self.shape.turn.T)

    def trails(self) -> list[dict[str, Any]]:
        """Return where the slider's axis went of late, at both of its ends."""
        tail = 0.04 * float(self.times[-1] - self.times[0])
        return [
            {
                "path": "run",
                "times": packed_doubles(self.times),
                "points": packed_floats(self.shape.axis(self.position, self.attitude, sign)),
                "colour": colour,
                "radius": 0.006 * self.radius,
                "tail": tail,
                "above": True,
            }
            for sign, colour in zip(_SIGNS, TRACES, strict=True)
        ]

    def facts(self) -> list[str]:
        factor = self.shape.factor
        width, height = (
            f"{length_text(play)} drawn {length_text(factor * play)}" for play in self.play.tolist()
        )
        return [
            f"{self.name}: play, displacement, tilt and turn drawn {factor:g} times as large",
            "slider's size as it is" + ("" if self.shape.length else "; the picture goes along with it"),
            f"play to each side: along the width {width}, along the height {height}",
        ]
