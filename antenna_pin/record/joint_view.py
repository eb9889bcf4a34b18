"""One clearance joint close up: its bearing cut open, the play magnified, contacts coloured by their load."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.record.key_frames import Impacts, KeyFrames
from antenna_pin.record.magnified import MagnifiedBall, MagnifiedJournal, default_magnification
from antenna_pin.record.mechanism_view import camera, nice
from antenna_pin.record.scene import Scene, packed_doubles, packed_floats
from antenna_pin.record.shapes import Mesh, Sphere, lathe
from antenna_pin.trajectory import Trajectory

__all__ = ["joint_view"]

Array = NDArray[np.float64]

_BEARING = (0.34, 0.52, 0.74)
_REST = (0.34, 0.52, 0.74, 0.10)  # the half that is cut away
_JOURNAL = (0.78, 0.79, 0.81)
_MARK = (0.20, 0.22, 0.26)
_RIM = (0.16, 0.28, 0.45)
_TRACE = ("#0072B2", "#009E73")
#: Light to dark, even steps of lightness, so that it can be read without colour: cividis reversed, darkened.
LOAD_COLOURS = (
    (233, 203, 68),
    (200, 176, 92),
    (165, 153, 112),
    (124, 123, 120),
    (88, 98, 115),
    (50, 74, 110),
    (0, 32, 77),
)

# The bearing's axis lies across the picture: bearing x, y, z are drawn along y, z, x.
_TURN = np.array([[0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
_DIRECTION = (0.35, -1.0, 0.42)  # of the camera, drawn axes
_CUT = float(np.arctan2(_DIRECTION[2], _DIRECTION[1]))  # its direction about the bearing's axis [rad]


def joint_view(
    run: Trajectory,
    frames: KeyFrames,
    impacts: Impacts,
    places: dict[str, dict[str, Any]],
    joint: str | None = None,
    magnify: float | None = None,
) -> dict[str, Any]:
    """Return the data of a recording that depend on the view (see :class:`Recording`).

    Args:
        run: The run.
        frames: Its key frames.
        impacts: Contact episodes in the span.
        places: Shapes of the clearance joints (``antenna_pin.simulation.places.clearance_places``).
        joint: Name of the joint; the first one with clearance if left out.
        magnify: How many times wider gaps are drawn [-]; chosen from 100 to 1000 if left out.
    """
    if not places or "gap" not in run.data:
        raise InvalidParameterError(
            "recording",
            "view",
            "mechanism for a run without a clearance joint (its joints are ideal; there is no play to show)",
            "joint",
        )
    name = next(iter(places)) if joint is None else joint
    if name not in places:
        raise UnknownNameError("recording", "joint with clearance", name, places)
    if magnify is not None and not 0.0 < magnify < 1e9:
        raise InvalidParameterError("recording", "magnify", "a positive number", magnify)
    place = places[name]
    picture = _Ball if place["kind"] == "spherical" else _Journal
    return picture(run.data, frames, impacts, name, place, magnify).data()


class _Picture:
    """What all kinds of joints share: the recorded contacts, the colours, the page's facts."""

    radius: float  # of the bore or socket as drawn [m]
    clearance: float  # radial, as it is [m]

    def __init__(
        self,
        data: xr.Dataset,
        frames: KeyFrames,
        impacts: Impacts,
        name: str,
        place: dict[str, Any],
        magnify: float | None,
    ) -> None:
        self.name, self.place = name, place
        self.scene = Scene()
        self.scene.place("run", _TURN)
        self.warnings: list[str] = []
        chosen = data.isel(time=frames.indices)
        self.times = np.asarray(chosen["time"].values, dtype=float)
        names = [str(contact) for contact in data["contact"].values]
        mine = [k for k, contact in enumerate(names) if contact.rpartition(".")[0] == name]
        self.contacts = [names[k] for k in mine]
        self.gap = np.asarray(chosen["gap"].values, dtype=float)[:, mine]
        self.point = np.asarray(chosen["contact_point"].values, dtype=float)[:, mine]
        self.force = np.asarray(chosen["contact_force"].values, dtype=float)[:, mine]
        self.journal = chosen.sel(clearance_joint=name)
        here = np.isin(impacts.contacts, mine)
        self.largest = max(
            float(np.linalg.norm(self.force, axis=2).max(initial=0.0)),
            float(impacts.peaks[here].max(initial=0.0)),
        )
        self.spin = self._spin(chosen, name)
        self._build(place, magnify)

    def _build(self, place: dict[str, Any], magnify: float | None) -> None:
        raise NotImplementedError

    def _spin(self, chosen: xr.Dataset, name: str) -> Array:
        """Return the rotation about the bearing's axis (n,) [rad]."""
        if name in chosen["joint"].values:
            return np.asarray(chosen["motion_angle"].sel(joint=name).values, dtype=float)
        return np.zeros(len(self.times))

    def tracks(self) -> list[dict[str, Any]]:
        raise NotImplementedError

    def drawn_points(self) -> Array:
        """Return where the contacts are drawn, (n, contacts, 3) [m]."""
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
                    {
                        "name": name,
                        "path": "run",
                        "force": packed_floats(self.force[:, k]),
                        "point": packed_floats(points[:, k]),
                    }
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
        turned = self.extent() @ _TURN[:3, :3].T
        return {
            "commands": self.scene.packed(),
            "actors": [{"name": "run", "times": packed_doubles(self.times), "tracks": self.tracks()}],
            "contacts": contacts,
            "trails": self.trails(),
            "camera": camera(turned, _DIRECTION),
            "facts": facts,
            "warnings": self.warnings,
        }

    def cut_open(self, path: str, inner: Array, outer: Array) -> None:
        """Draw a hollow body of revolution: the half behind, and faintly the half before the cut."""
        quarter = 0.5 * np.pi
        self.scene.add(path, lathe(inner, outer, _CUT + quarter, _CUT + 3.0 * quarter), _BEARING)
        self.scene.add(f"{path} cut away", lathe(inner, outer, _CUT - quarter, _CUT + quarter), _REST)


class _Journal(_Picture):
    """A revolute or planar joint."""

    def _build(self, place: dict[str, Any], magnify: float | None) -> None:
        dimensions = place["dimensions"]
        journal = float(dimensions["journal_radius"])
        self.clearance = float(dimensions["bearing_radius"]) - journal
        factor = default_magnification(journal, self.clearance) if magnify is None else magnify
        shape = self.shape = MagnifiedJournal.of(place["kind"], dimensions, factor)
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
        self.cut_open("run/bearing", _line(shape.bore_radius, ends), _line(shape.outer_radius, ends))
        for end in ends:
            self.scene.add(f"run/rim {end:+.6f}", _ring(shape.bore_radius, end, 0.008 * self.radius), _RIM)
        # The shaft goes on behind one flange; the journal carries marks so that its spin is seen.
        self.reach = half + 2.0 * shape.flange_gap + shape.flange_thickness + 0.35 * shape.length
        start = self.start = -self.reach if not shape.flanges else -half - 1.02 * shape.flange_gap
        self.scene.add(
            "run/barrel/spin/body", lathe(*_solid(shape.journal_radius, start, self.reach)), _JOURNAL
        )
        for k in range(3):
            angle = 2.0 * np.pi * k / 3.0
            stripe = lathe(
                _line(0.9 * shape.journal_radius, np.array([start, self.reach])),
                _line(1.012 * shape.journal_radius, np.array([start, self.reach])),
                angle - 0.07,
                angle + 0.07,
                segments=4,
            )
            self.scene.add(f"run/barrel/spin/stripe{k}", stripe, _MARK)
        for k, sign in enumerate((1.0, -1.0) if shape.flanges else ()):
            low, high = sorted((0.0, sign * shape.flange_thickness))
            path = f"run/flange{k}/spin"
            self.scene.add(f"{path}/body", lathe(*_solid(shape.flange_radius, low, high)), (*_JOURNAL, 0.42))
            self.scene.add(f"{path}/rim", _ring(shape.flange_radius, 0.0, 0.006 * self.radius), _MARK)
            for i in range(3):
                angle = 2.0 * np.pi * i / 3.0
                edge = np.array([low - 1e-3 * self.radius, high + 1e-3 * self.radius])
                inner, outer = (
                    _line(0.93 * shape.flange_radius, edge),
                    _line(1.005 * shape.flange_radius, edge),
                )
                self.scene.add(
                    f"{path}/mark{i}", lathe(inner, outer, angle - 0.022, angle + 0.022, segments=4), _MARK
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
        ends = np.array([[0.0, 0.0, self.start, 1.0], [0.0, 0.0, 0.9 * self.reach, 1.0]]).T
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
                    "colour": _TRACE[k],
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
        line = f"radial play {_length(self.clearance)} drawn {_length(factor * self.clearance)}"
        if self.shape.flanges:
            gap = self.shape.flange_gap
            line += f", axial play {_length(gap / factor)} drawn {_length(gap)}"
        return [*lines, line]


class _Ball(_Picture):
    """A ball joint."""

    def _build(self, place: dict[str, Any], magnify: float | None) -> None:
        dimensions = place["dimensions"]
        ball = float(dimensions["ball_radius"])
        self.clearance = float(dimensions["socket_radius"]) - ball
        factor = default_magnification(ball, self.clearance) if magnify is None else magnify
        shape = self.shape = MagnifiedBall.of(dimensions, factor)
        self.radius = shape.socket_radius
        self.centre = shape.centre(
            self.gap[:, 0], np.asarray(self.journal["journal_position"].values, dtype=float)
        )
        self.cut_open("run/socket", _arc(shape.socket_radius), _arc(1.1 * shape.socket_radius))
        solid = _arc(shape.ball_radius)
        self.scene.add("run/ball/body", lathe(solid * [0.0, 1.0], solid), _JOURNAL)
        for k, turn in enumerate(("xyz", "yzx", "zxy")):
            ring = _ring(shape.ball_radius, 0.0, 0.02 * shape.ball_radius)
            order = ["xyz".index(axis) for axis in turn]
            self.scene.add(f"run/ball/ring{k}", Mesh(ring.vertices[:, order], ring.faces), _MARK)
        self.scene.add("run/ball/pole", Sphere(0.1 * shape.ball_radius), _MARK, _shifted(shape.ball_radius))

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
            f"play {_length(self.clearance)} drawn {_length(factor * self.clearance)}",
        ]


def _line(radius: float, ends: Array) -> Array:
    return np.stack([np.full(2, radius), ends], axis=1)


def _solid(radius: float, low: float, high: float) -> tuple[Array, Array]:
    ends = np.array([low, high])
    return _line(0.0, ends), _line(radius, ends)


def _arc(radius: float) -> Array:
    angle = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 49)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def _ring(radius: float, height: float, thick: float) -> Mesh:
    angle = np.linspace(0.0, np.pi, 9)
    across = np.stack([thick * np.cos(angle), thick * np.sin(angle)], axis=1)
    middle = np.array([radius, height])
    return lathe(middle + across[:, ::-1] * [-1.0, 1.0], middle + across[:, ::-1])


def _shifted(z: float) -> Array:
    result = np.eye(4)
    result[2, 3] = z
    return result


def _length(metres: float) -> str:
    for limit, unit in ((1e-3, "mm"), (1e-6, "µm")):
        if metres >= 0.9995 * limit:
            return f"{metres / limit:.3g} {unit}"
    return f"{metres * 1e9:.3g} nm"
