"""A journal in a bore close up, with or without flanges: a revolute or a planar joint."""

from __future__ import annotations

from typing import Any

import numpy as np

from antenna_pin.record._joint_picture import JOURNAL, MARK, RIM, TRACES, Array, JointPicture, length_text
from antenna_pin.record._profiles import line, ring, solid
from antenna_pin.record.magnified import MagnifiedJournal, default_magnification
from antenna_pin.record.scene import packed_doubles, packed_floats
from antenna_pin.record.shapes import lathe


class JournalPicture(JointPicture):
    """A revolute or planar joint."""

    def _build(self, place: dict[str, Any], magnify: float | None) -> None:
        dimensions = place["dimensions"]
        journal = float(dimensions["journal_radius"])
        self.clearance = float(dimensions["bearing_radius"]) - journal
        factor = self.factor = default_magnification(journal, self.clearance) if magnify is None else magnify
        shape = self.shape = MagnifiedJournal.of(dimensions, factor)
        self.radius = shape.bore_radius
        radial = 2 if shape.flanges else 1
        self.centres = shape.eccentricity(self.gap[:, :radial], self.point[:, :radial])
        half = 0.5 * shape.length
        self.flange: list[Array] = []
        if shape.flanges:
            self.tilt = self._tilt()
            self.flange = [
                shape.flange(sign, self.gap[:, 2 + k], self.tilt, self.centres)
                for k, sign in enumerate((1.0, -1.0))
            ]
            self.shift = 0.5 * (self.flange[0][:, 2, 3] + self.flange[1][:, 2, 3])
        else:
            self.shift = np.zeros(len(self.times))
        self.barrel = shape.barrel(self.centres, self.shift)
        ends = np.array([-half, half])
        self.cut_open("run/bearing", line(shape.bore_radius, ends), line(shape.outer_radius, ends))
        for end in ends:
            self.scene.add(f"run/rim {end:+.6f}", ring(shape.bore_radius, end, 0.008 * self.radius), RIM)
        # The shaft goes on behind one flange; the journal carries marks so that its spin is seen.
        self.reach = (
            half
            + 2.0 * shape.flange_gap
            + shape.flange_thickness
            + min(0.35 * shape.length, shape.bore_radius)
        )
        start = self.start = -self.reach if not shape.flanges else -half - 1.02 * shape.flange_gap
        self.scene.add(
            "run/barrel/spin/body", lathe(*solid(shape.journal_radius, start, self.reach)), JOURNAL
        )
        for k in range(3):
            angle = 2.0 * np.pi * k / 3.0
            stripe = lathe(
                line(0.9 * shape.journal_radius, np.array([start, self.reach])),
                line(1.012 * shape.journal_radius, np.array([start, self.reach])),
                angle - 0.07,
                angle + 0.07,
                segments=4,
            )
            self.scene.add(f"run/barrel/spin/stripe{k}", stripe, MARK)
        for k, sign in enumerate((1.0, -1.0) if shape.flanges else ()):
            low, high = sorted((0.0, sign * shape.flange_thickness))
            path = f"run/flange{k}/spin"
            self.scene.add(f"{path}/body", lathe(*solid(shape.flange_radius, low, high)), (*JOURNAL, 0.42))
            self.scene.add(f"{path}/rim", ring(shape.flange_radius, 0.0, 0.006 * self.radius), MARK)
            for i in range(3):
                angle = 2.0 * np.pi * i / 3.0
                edge = np.array([low - 1e-3 * self.radius, high + 1e-3 * self.radius])
                inner, outer = (
                    line(0.93 * shape.flange_radius, edge),
                    line(1.005 * shape.flange_radius, edge),
                )
                self.scene.add(
                    f"{path}/mark{i}", lathe(inner, outer, angle - 0.022, angle + 0.022, segments=4), MARK
                )

    def _tilt(self) -> Array:
        """Return x and y of the journal's axis in bearing axes (n, 2) [-]."""
        x, y, z, w = np.asarray(self.journal["journal_attitude"].values, dtype=float).T
        return np.stack([2.0 * (x * z + w * y), 2.0 * (y * z - w * x)], axis=1)

    def tracks(self) -> list[dict[str, Any]]:
        parts = {"run/barrel": self.barrel}
        if self.shape.flanges:
            parts |= {f"run/flange{k}": placement for k, placement in enumerate(self.flange)}
        spin = np.zeros((len(self.times), 7))
        spin[:, 5], spin[:, 6] = np.sin(0.5 * self.spin), np.cos(0.5 * self.spin)
        packed = packed_floats(spin)
        tracks = []
        for path, placement in parts.items():
            name = path.removeprefix("run/")
            data = packed_floats(placement.reshape(-1, 12))
            tracks.append({"kind": "matrix", "name": name, "path": path, "data": data})
            tracks.append({"kind": "pose", "name": f"{name} spin", "path": f"{path}/spin", "data": packed})
        return tracks

    def drawn_points(self) -> Array:
        shape = self.shape
        if not shape.flanges:
            return shape.radial_points(0.0, self.point[:, 0])[:, None]
        found = [shape.radial_points(sign, self.point[:, k]) for k, sign in enumerate((1.0, -1.0))]
        found += [
            shape.axial_points(sign, self.point[:, 2 + k], self.flange[k])
            for k, sign in enumerate((1.0, -1.0))
        ]
        return np.stack(found, axis=1)

    def extent(self) -> Array:
        shape = self.shape
        half = 0.5 * shape.length
        angle = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
        circle = np.stack([np.cos(angle), np.sin(angle)])
        bearing = [np.vstack([shape.outer_radius * circle, np.full((1, 24), end)]).T for end in (-half, half)]
        some = np.unique(np.linspace(0, len(self.times) - 1, min(200, len(self.times))).astype(int))
        rim = np.vstack([shape.flange_radius * circle, np.zeros((1, 24)), np.ones((1, 24))])
        moving = [(placement[some] @ rim).transpose(0, 2, 1).reshape(-1, 3) for placement in self.flange]
        ends = np.vstack(
            [
                np.tile(shape.journal_radius * circle, 2),
                np.repeat([self.start, self.reach], 24),
                np.ones(48),
            ]
        )
        moving.append((self.barrel[some] @ ends).transpose(0, 2, 1).reshape(-1, 3))
        return np.concatenate([*bearing, *moving])

    def trails(self) -> list[dict[str, Any]]:
        """Return where the journal's axis went of late, in the planes of the bore's ends."""
        found = []
        signs = (1.0, -1.0) if self.shape.flanges else (0.0,)
        tail = 0.04 * float(self.times[-1] - self.times[0])
        for k, sign in enumerate(signs):
            at = np.full((len(self.times), 1), 0.5 * sign * self.shape.length)
            found.append(
                {
                    "path": "run",
                    "times": packed_doubles(self.times),
                    "points": packed_floats(np.hstack([self.centres[:, k], at])),
                    "colour": TRACES[k],
                    "radius": 0.006 * self.radius,
                    "tail": tail,
                    "above": True,
                }
            )
        return found

    def facts(self) -> list[str]:
        factor = self.shape.factor
        if self.shape.flanges:
            what, true = "play, eccentricity and tilt", "journal's radius, bearing's length and spin"
        else:
            what, true = "play and eccentricity", "journal's radius and spin"
        lines = [f"{self.name}: {what} drawn {factor:g} times as large", f"{true} as they are"]
        if self.shape.shortened > 1.0:
            real = self.shape.shortened * self.shape.length
            drawn = f"length {length_text(real)} drawn {length_text(self.shape.length)}"
            lines[1] = f"journal's radius and spin as they are; {drawn}"
        line = f"radial play {length_text(self.clearance)} drawn {length_text(factor * self.clearance)}"
        if self.shape.flanges:
            gap = self.shape.flange_gap
            line += f", axial play {length_text(gap / factor)} drawn {length_text(gap)}"
        return [*lines, line]
