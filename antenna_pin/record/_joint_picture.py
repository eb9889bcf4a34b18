"""What pictures of all kinds of clearance joints share: contacts coloured by their load, the page's facts."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.record._force_arrows import nice
from antenna_pin.record.key_frames import Impacts, KeyFrames
from antenna_pin.record.mechanism_view import camera
from antenna_pin.record.scene import Scene, packed_doubles, packed_floats
from antenna_pin.record.shapes import lathe
from antenna_pin.trajectory import contacts_of

Array = NDArray[np.float64]

BEARING = (0.34, 0.52, 0.74)
REST = (0.34, 0.52, 0.74, 0.10)  # the half that is cut away
JOURNAL = (0.78, 0.79, 0.81)
MARK = (0.20, 0.22, 0.26)
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
    """Return the rotation (3, 3) from bearing axes to those drawn, of which z points up in the picture.

    The bearing's axis lies across the picture, to the right, unless it stands upright.

    Args:
        up: Against gravity, bearing axes, unit vector (3,) [-]; without it bearing y is drawn upwards.
    """
    z = np.array([0.0, 1.0, 0.0]) if up is None else up
    along = np.array([0.0, 0.0, 1.0])
    if np.linalg.norm(np.cross(along, z)) < _LEVEL:
        along = np.array([1.0, 0.0, 0.0])
    x = along - (along @ z) * z
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z])


class JointPicture:
    """One clearance joint; each kind says what it draws.

    Attributes:
        radius: Of the bore or socket as drawn [m].
        clearance: Radial, as it is [m].
    """

    radius: float
    clearance: float

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
        self.spin = self._spin(chosen, name)
        self._build(place, magnify)

    def _build(self, place: dict[str, Any], magnify: float | None) -> None:
        raise NotImplementedError

    def _spin(self, chosen: xr.Dataset, name: str) -> Array:
        """Return the journal's rotation about the bearing's axis (n,) [rad]; the joint's is its child's."""
        if name in chosen["joint"].values:
            angle = np.asarray(chosen["motion_angle"].sel(joint=name).values, dtype=float)
            return -angle if self.place.get("bearing_on") == "child" else angle
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
        turned = self.extent() @ self.turn.T
        return {
            "commands": self.scene.packed(),
            "actors": [{"name": "run", "times": packed_doubles(self.times), "tracks": self.tracks()}],
            "contacts": contacts,
            "trails": self.trails(),
            "camera": camera(turned, DIRECTION),
            "facts": facts,
            "warnings": self.warnings,
        }

    def cut_open(self, path: str, inner: Array, outer: Array) -> None:
        """Draw a hollow body of revolution: the half behind, and faintly the half before the cut."""
        quarter = 0.5 * np.pi
        cut = float(np.arctan2(self.camera[1], self.camera[0]))  # the camera's [rad]
        self.scene.add(path, lathe(inner, outer, cut + quarter, cut + 3.0 * quarter), BEARING)
        self.scene.add(f"{path} cut away", lathe(inner, outer, cut - quarter, cut + quarter), REST)


def length_text(metres: float) -> str:
    """Return a length [m] with three digits and the unit that suits it."""
    for limit, unit in ((1e-3, "mm"), (1e-6, "µm")):
        if metres >= 0.9995 * limit:
            return f"{metres / limit:.3g} {unit}"
    return f"{metres * 1e9:.3g} nm"
