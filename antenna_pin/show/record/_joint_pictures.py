"""Pictures of clearance joints close up: contacts coloured by load, facts for the page."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.show.record.contact_arrows import sparse
from antenna_pin.show.record.key_frames import Impacts, KeyFrames
from antenna_pin.show.record.magnified import (
    MagnifiedBall,
    MagnifiedJournal,
    MagnifiedSlider,
    default_magnification,
)
from antenna_pin.show.record.scene import Scene, camera, nice, packed_doubles, packed_floats, track
from antenna_pin.show.record.shapes import Box, Mesh, Sphere, arc, lathe, line, ring, solid
from antenna_pin.trajectory import contacts_of

# --- all kinds ----------------------------------------------------------------------------------------------

Array = NDArray[np.float64]

BEARING = (0.34, 0.52, 0.74)
REST = (0.34, 0.52, 0.74, 0.10)  # the half that is cut away
JOURNAL = (0.78, 0.79, 0.81)
MARK = (0.20, 0.22, 0.26)
SIGNS = (1.0, -1.0)  # of ends at +z and -z
TRACES = ("#0072B2", "#009E73")  # of the journal's axis at the +z and -z end
RIM = (0.16, 0.28, 0.45)
#: Light to dark, even steps of lightness, so that it can be read without colour; no step of it is the colour
#: of a bearing or a journal.
LOAD_COLOURS = (
    (254, 193, 93),
    (253, 152, 65),
    (252, 102, 49),
    (237, 48, 34),
    (200, 7, 35),
    (155, 0, 38),
    (111, 0, 33),
)

DIRECTION = (0.35, -1.0, 0.42)  # of the camera, drawn axes
_LEVEL = 0.1  # sine of an axis' inclination up to which it counts as level; one that stands is drawn so


def drawn_axes(up: Array | None) -> Array:
    """Return the rotation (3, 3) from bearing axes to drawn ones, z pointing up.

    The bearing's axis lies across the picture, to the right, unless it stands upright. Without ``up``, the
    unit vector against gravity in bearing axes, bearing y is drawn upwards.
    """
    z = np.array([0.0, 1.0, 0.0]) if up is None else up
    along = np.array([0.0, 0.0, 1.0])
    if np.linalg.norm(np.cross(along, z)) < _LEVEL:
        along = np.array([1.0, 0.0, 0.0])
    x = along - (along @ z) * z
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z])


class JointPicture:
    """Picture of a clearance joint; each kind defines its drawing."""

    radius: float  # of the bore or socket as drawn [m]
    factor: float  # magnification of gaps [-]
    clearance: float  # radial, as it is [m]

    def __init__(
        self,
        data: xr.Dataset,
        frames: KeyFrames,
        impacts: Impacts,
        name: str,
        place: dict[str, Any],
        magnify: float | None,
        up: Array | None = None,
    ) -> None:
        self.name, self.place = name, place
        self.scene = Scene()
        self.turn = drawn_axes(up)
        placement = np.eye(4)
        placement[:3, :3] = self.turn
        self.scene.place("run", placement)
        #: From the bearing to the camera, bearing axes.
        self.camera: Array = np.array(DIRECTION) @ self.turn
        self.warnings: list[str] = []
        chosen = data.isel(time=frames.indices)
        self.times = np.asarray(chosen["time"].values, dtype=float)
        names = [str(contact) for contact in data["contact"].values]
        self.contacts = contacts_of(data, name)
        mine = [names.index(contact) for contact in self.contacts]
        self.gap = np.asarray(chosen["gap"].values, dtype=float)[:, mine]
        self.point = np.asarray(chosen["contact_point"].values, dtype=float)[:, mine]
        self.force = np.asarray(chosen["contact_force"].values, dtype=float)[:, mine]
        self.journal = chosen.sel(clearance_joint=name)
        here = np.isin(impacts.contacts, mine)
        self.largest = max(
            float(np.linalg.norm(self.force, axis=2).max(initial=0.0)),
            float(impacts.peaks[here].max(initial=0.0)),
        )
        self.poster = impacts.only(np.flatnonzero(here)).hardest(0.5 * float(self.times[0] + self.times[-1]))
        self.spin = self._spin(chosen, name)
        self._build(place, magnify)

    def _build(self, place: dict[str, Any], magnify: float | None) -> None:
        raise NotImplementedError

    def _spin(self, chosen: xr.Dataset, name: str) -> Array:
        """Return the journal's rotation about the bearing's axis (n,) [rad]."""
        if name in chosen["joint"].values:
            angle = np.asarray(chosen["motion_angle"].sel(joint=name).values, dtype=float)
            return -angle if self.place.get("bearing_on") == "child" else angle
        return np.zeros(len(self.times))

    def tracks(self) -> list[dict[str, Any]]:
        raise NotImplementedError

    def drawn_points(self) -> Array:
        """Return the drawn contacts, (n, contacts, 3) [m]."""
        raise NotImplementedError

    def extent(self) -> Array:
        """Return points around all that is drawn, bearing axes, (n, 3) [m]."""
        raise NotImplementedError

    def facts(self) -> list[str]:
        raise NotImplementedError

    def trails(self) -> list[dict[str, Any]]:
        return []

    def data(self) -> dict[str, Any]:
        points = self.drawn_points()
        contacts, facts = None, [{"text": text} for text in self.facts()]
        if self.largest > 0.0:
            top = nice(self.largest)
            top = top if top >= self.largest else nice(self.largest * 2.5)
            length = 0.9 * self.radius
            contacts = {
                "items": [
                    {"name": name, "path": "run", **sparse(self.force[:, k], points[:, k])}
                    for k, name in enumerate(self.contacts)
                ],
                "colour": "#222222",
                "above": True,
                "size": 0.022 * self.radius,
                "power": 0.5,
                "reference": [top, length],
                "map": {
                    "label": "contact force on the journal",
                    "low": 1e-3 * top,
                    "high": top,
                    "colours": [list(colour) for colour in LOAD_COLOURS],
                    "ball": 0.05 * self.radius,
                },
            }
            facts.append({"text": "arrows: contact force, length by its square root"})
        turned = self.extent() @ self.turn.T
        return {
            "commands": self.scene.packed(),
            "actors": [{"name": "run", "times": packed_doubles(self.times), "tracks": self.tracks()}],
            "contacts": contacts,
            "trails": self.trails(),
            "camera": camera(turned, DIRECTION),
            "facts": facts,
            "poster": self.poster,
            "warnings": self.warnings,
        }

    def cut_open(self, path: str, inner: Array, outer: Array) -> None:
        """Draw a hollow body of revolution, its front half faintly."""
        quarter = 0.5 * np.pi
        cut = float(np.arctan2(self.camera[1], self.camera[0]))  # the camera's [rad]
        self.scene.add(path, lathe(inner, outer, cut + quarter, cut + 3.0 * quarter), BEARING)
        self.scene.add(f"{path} cut away", lathe(inner, outer, cut - quarter, cut + quarter), REST)

    def draw_shaft(self, path: str, radius: float, ends: Array) -> None:
        """Draw a cylinder between two heights, with three stripes that make its spin visible."""
        self.scene.add(f"{path}/body", lathe(*solid(radius, *ends)), JOURNAL)
        for k in range(3):
            angle = 2.0 * np.pi * k / 3.0
            inner, outer = line(0.9 * radius, ends), line(1.012 * radius, ends)
            part = lathe(inner, outer, angle - 0.07, angle + 0.07, segments=4)
            self.scene.add(f"{path}/stripe{k}", part, MARK)

    def draw_rims(self, ends: Array) -> None:
        """Draw the edges of a bore."""
        for end in ends:
            self.scene.add(f"run/rim {end:+.6f}", ring(self.radius, end, 0.008 * self.radius), RIM)

    def trail(self, points: Array, colour: str) -> dict[str, Any]:
        """Return the recent path of a point, (n, 3) [m], as the player draws it."""
        return {
            "path": "run",
            "times": packed_doubles(self.times),
            "points": packed_floats(points),
            "colour": colour,
            "radius": 0.006 * self.radius,
            "tail": 0.04 * float(self.times[-1] - self.times[0]),
            "above": True,
        }


def circle() -> Array:
    """Return points of the unit circle, (2, 24)."""
    angle = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    return np.stack([np.cos(angle), np.sin(angle)])


def length_text(metres: float) -> str:
    """Return a length [m] with three digits and the unit that suits it."""
    for limit, unit in ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm")):
        if metres >= 0.9995 * limit:
            return f"{metres / limit:.3g} {unit}"
    return f"{metres * 1e9:.3g} nm"


# --- journal in a bore --------------------------------------------------------------------------------------


class JournalPicture(JointPicture):
    """Picture of a revolute or planar joint."""

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
                for k, sign in enumerate(SIGNS)
            ]
            self.shift = 0.5 * (self.flange[0][:, 2, 3] + self.flange[1][:, 2, 3])
        else:
            self.shift = np.zeros(len(self.times))
        self.barrel = shape.barrel(self.centres, self.shift)
        ends = np.array([-half, half])
        self.cut_open("run/bearing", line(shape.bore_radius, ends), line(shape.outer_radius, ends))
        self.draw_rims(ends)
        # The shaft goes on behind one flange; the journal carries marks so that its spin is seen.
        self.reach = (
            half
            + 2.0 * shape.flange_gap
            + shape.flange_thickness
            + min(0.35 * shape.length, shape.bore_radius)
        )
        start = self.start = -self.reach if not shape.flanges else -half - 1.02 * shape.flange_gap
        shaft = np.array([start, self.reach])
        self.draw_shaft("run/barrel/spin", shape.journal_radius, shaft)
        for k, sign in enumerate(SIGNS if shape.flanges else ()):
            low, high = sorted((0.0, sign * shape.flange_thickness))
            path = f"run/flange{k}/spin"
            self.scene.add(f"{path}/body", lathe(*solid(shape.flange_radius, low, high)), (*JOURNAL, 0.42))
            self.scene.add(f"{path}/rim", ring(shape.flange_radius, 0.0, 0.006 * self.radius), MARK)
            for i in range(3):
                angle = 2.0 * np.pi * i / 3.0
                edge = np.array([low - 1e-3 * self.radius, high + 1e-3 * self.radius])
                inner, outer = (line(share * shape.flange_radius, edge) for share in (0.93, 1.005))
                part = lathe(inner, outer, angle - 0.022, angle + 0.022, segments=4)
                self.scene.add(f"{path}/mark{i}", part, MARK)

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
        tracks = []
        for path, placement in parts.items():
            tracks += [
                track(path, placement),
                track(f"{path}/spin", spin, f"{path.removeprefix('run/')} spin"),
            ]
        return tracks

    def drawn_points(self) -> Array:
        shape = self.shape
        if not shape.flanges:
            return shape.radial_points(0.0, self.point[:, 0])[:, None]
        found = [shape.radial_points(sign, self.point[:, k]) for k, sign in enumerate(SIGNS)]
        found += [
            shape.axial_points(sign, self.point[:, 2 + k], self.flange[k]) for k, sign in enumerate(SIGNS)
        ]
        return np.stack(found, axis=1)

    def extent(self) -> Array:
        shape = self.shape
        half = 0.5 * shape.length
        unit = circle()
        bearing = [np.vstack([shape.outer_radius * unit, np.full((1, 24), end)]).T for end in (-half, half)]
        some = np.unique(np.linspace(0, len(self.times) - 1, min(200, len(self.times))).astype(int))
        rim = np.vstack([shape.flange_radius * unit, np.zeros((1, 24)), np.ones((1, 24))])
        moving = [(placement[some] @ rim).transpose(0, 2, 1).reshape(-1, 3) for placement in self.flange]
        heights = np.repeat([self.start, self.reach], 24)
        ends = np.vstack([np.tile(shape.journal_radius * unit, 2), heights, np.ones(48)])
        moving.append((self.barrel[some] @ ends).transpose(0, 2, 1).reshape(-1, 3))
        return np.concatenate([*bearing, *moving])

    def trails(self) -> list[dict[str, Any]]:
        """Return recent paths of the journal's axis in the bore's end planes."""
        found = []
        for k, sign in enumerate(SIGNS if self.shape.flanges else (0.0,)):
            at = np.full((len(self.times), 1), 0.5 * sign * self.shape.length)
            found.append(self.trail(np.hstack([self.centres[:, k], at]), TRACES[k]))
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


# --- slider in a guide --------------------------------------------------------------------------------------


class SliderPicture(JointPicture):
    """Picture of a slider in a guide, whose front walls are faint."""

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
        for axis, sign in itertools.product((0, 1), SIGNS):
            centre, size = np.zeros(3), np.full(3, self.length)
            centre[axis] = sign * (half[axis] + 0.5 * thick)
            size[axis], size[1 - axis] = thick, 2.0 * (half[1 - axis] + thick * axis)
            before = sign * camera[axis] > 0.0
            self._box(f"run/wall {'xy'[axis]}{sign:+.0f}", size, centre, REST if before else BEARING)
        for end, axis, sign in itertools.product(SIGNS, (0, 1), SIGNS):
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
            for signs in itertools.product(SIGNS, SIGNS):
                centre, long = np.zeros(3), np.full(3, thin)
                centre[others] = 0.5 * size[others] * signs - 0.49 * thin * np.array(signs)
                long[axis] = size[axis] * 1.002
                self._box("run/slider/edge {}{:+.0f}{:+.0f}".format(axis, *signs), long, centre, MARK)

    def _box(self, path: str, size: Array, centre: Array, colour: tuple[float, ...]) -> None:
        """Draw a box given in the section's axes."""
        placement = np.eye(4)
        placement[:3, :3] = self.shape.turn
        placement[:3, 3] = self.shape.turn @ centre
        width, height, length = map(float, size)
        self.scene.add(path, Box((width, height, length)), colour, placement)

    def tracks(self) -> list[dict[str, Any]]:
        return [track("run/slider", self.placed)]

    def drawn_points(self) -> Array:
        return np.stack([self.shape.point(end, self.position, self.attitude) for end in self.ends], axis=1)

    def extent(self) -> Array:
        long = 0.5 * self.length
        if self.shape.length:
            long = max(long, float(np.abs(self.placed[:, 2, 3]).max()) + 0.5 * float(self.shape.size[2]))
        half = np.append(0.5 * self.shape.guide + 0.12 * self.radius, long)
        signs = np.array(list(itertools.product(SIGNS, repeat=3)))
        return np.asarray((signs * half) @ self.shape.turn.T)

    def trails(self) -> list[dict[str, Any]]:
        """Return recent paths of both ends of the slider's axis."""
        ends = (self.shape.axis(self.position, self.attitude, sign) for sign in SIGNS)
        return [self.trail(end, colour) for end, colour in zip(ends, TRACES, strict=True)]

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


# --- round slider in a guide -----------------------------------------------------------------------------


class RodPicture(JointPicture):
    """Picture of a round slider in a round guide."""

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
        self.draw_rims(ends)
        self.draw_shaft("run/rod", self.rod, np.array([-self.half, self.half]))

    def tracks(self) -> list[dict[str, Any]]:
        placed = np.concatenate([self.matrix, self.shift[:, :, None]], axis=2)
        return [track("run/rod", placed)]

    def drawn_points(self) -> Array:
        """Return contacts on the drawn guide, where the drawn slider is nearest."""
        own = np.einsum("nji,nkj->nki", self.turns, self.point - self.position[:, None])
        drawn = np.einsum("nij,nkj->nki", self.matrix, own) + self.shift[:, None]
        across = np.linalg.norm(drawn[..., :2], axis=2, keepdims=True)
        drawn[..., :2] *= self.radius / np.where(across > 0.0, across, 1.0)
        return np.asarray(drawn)

    def extent(self) -> Array:
        outside = 1.16 * self.radius * circle()
        long = max(self.reach, float(np.abs(self.shift[:, 2]).max()) + self.half)
        return np.concatenate([np.vstack([outside, np.full((1, 24), end)]).T for end in (-long, long)])

    def trails(self) -> list[dict[str, Any]]:
        """Return recent paths of both ends of the slider's axis."""
        ends = (self.shift + sign * self.half * self.matrix[:, :, 2] for sign in SIGNS)
        return [self.trail(end, colour) for end, colour in zip(ends, TRACES, strict=True)]

    def facts(self) -> list[str]:
        drawn = length_text(self.factor * self.clearance)
        return [
            f"{self.name}: play, eccentricity and tilt drawn {self.factor:g} times as large",
            "slider's size and turn about its axis as they are"
            + ("" if self.guide else "; the picture goes along with it"),
            f"radial play {length_text(self.clearance)} drawn {drawn}",
        ]


# --- ball in a socket ------------------------------------------------------------------------------------


class BallPicture(JointPicture):
    """Picture of a ball joint."""

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
        pole = np.eye(4)
        pole[2, 3] = shape.ball_radius
        self.scene.add("run/ball/pole", Sphere(0.1 * shape.ball_radius), MARK, pole)

    def tracks(self) -> list[dict[str, Any]]:
        attitude = np.asarray(self.journal["journal_attitude"].values, dtype=float)
        return [track("run/ball", np.hstack([self.centre, attitude]))]

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


#: The close-ups that kinds of clearance joints name (:class:`antenna_pin.joints.geometry.Look`).
PICTURES: dict[str, type[JointPicture]] = {
    "journal": JournalPicture,
    "ball": BallPicture,
    "slider": SliderPicture,
    "rod": RodPicture,
}
