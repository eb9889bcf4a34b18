"""Links and joints of a URDF in numbers; visuals are read by yourdfpy on demand.

Loading yourdfpy, and trimesh with it, takes longer than all else that leads to a short run.
"""

from __future__ import annotations

import io
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.errors import MechanismError
from antenna_pin.mechanism.frames import of_roll_pitch_yaw

Array = NDArray[np.float64]


class _Looks:
    """Robot as read by yourdfpy, at first use."""

    def __init__(self, text: str, where: str) -> None:
        self._text, self._where = text, where

    @cached_property
    def read(self) -> Any:
        """The ``yourdfpy.Robot``."""
        import yourdfpy

        try:
            file = io.BytesIO(self._text.encode())
            return yourdfpy.URDF.load(file, build_scene_graph=False, load_meshes=False).robot
        except Exception as error:  # yourdfpy lets through whatever its converters raise
            raise MechanismError(f"{self._where}: yourdfpy cannot read this URDF: {error}") from error

    def of(self, link: str) -> Any:
        """Return a link as ``yourdfpy.Link``."""
        return next(one for one in self.read.links if one.name == link)


@dataclass(frozen=True, slots=True, eq=False)
class Inertial:
    """Mass of a link and how it is spread.

    Attributes:
        mass: [kg].
        origin: Placement (4, 4) of the inertial frame in the link's [-, m]; None if none is written.
        inertia: (3, 3) about the origin, in the inertial frame's axes [kg m^2].
    """

    mass: float
    origin: Array | None
    inertia: Array


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """A link.

    Attributes:
        name: Its name.
        inertial: What it weighs; None if nothing is written.
    """

    name: str
    inertial: Inertial | None
    _looks: _Looks = field(repr=False)

    @property
    def visuals(self) -> list[Any]:
        """Shapes of the link: ``yourdfpy.Visual``, each."""
        return list(self._looks.of(self.name).visuals)

    @property
    def collisions(self) -> list[Any]:
        """Its solid shapes: ``yourdfpy.Collision``, each."""
        return list(self._looks.of(self.name).collisions)


@dataclass(frozen=True, slots=True)
class Limit:
    """Bounds of a joint [rad, m; N m, N; rad/s, m/s], None for missing ones."""

    lower: float | None
    upper: float | None
    effort: float | None
    velocity: float | None


class Mimic(NamedTuple):
    """Coupling of a joint: ``joint``, times ``multiplier``, plus ``offset`` [rad or m]."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True, slots=True, eq=False)
class Joint:
    """A joint.

    Attributes:
        name: Its name.
        type: Of URDF's.
        parent: Link that it is on.
        child: Link that it moves.
        origin: Placement (4, 4) of its frame in the parent's [-, m]; None if none is written.
        axis: (3,), as written, in its own frame [-]; URDF's x where nothing is.
        limit: Its bounds, if any are written.
        mimic: What it follows, if anything.
    """

    name: str
    type: str
    parent: str
    child: str
    origin: Array | None
    axis: Array
    limit: Limit | None
    mimic: Mimic | None


@dataclass(frozen=True, slots=True, eq=False)
class Robot:
    """Mechanism of a URDF: name, links and joints, in the file's order."""

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    _looks: _Looks = field(repr=False)

    @property
    def materials(self) -> list[Any]:
        """Materials beside the links: ``yourdfpy.Material``, each."""
        return list(self._looks.read.materials)


def robot_of(element: Any, text: str, where: str) -> Robot:
    """Return a URDF in numbers, from its checked root element and the same as text."""
    looks = _Looks(text, where)
    return Robot(
        str(element.get("name")),
        tuple(Link(str(one.get("name")), _inertial(one), looks) for one in element.findall("link")),
        tuple(map(_joint, element.findall("joint"))),
        looks,
    )


def _inertial(link: Any) -> Inertial | None:
    found = link.find("inertial")
    if found is None:
        return None
    mass, moments = found.find("mass"), found.find("inertia")
    xx, xy, xz, yy, yz, zz = (
        float(moments.get(key, 0.0)) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    )
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return Inertial(float(mass.get("value", 0.0)), _origin(found), inertia)


def _joint(joint: Any) -> Joint:
    axis, limit, mimic = (joint.find(tag) for tag in ("axis", "limit", "mimic"))
    return Joint(
        name=str(joint.get("name")),
        type=joint.get("type"),
        parent=joint.find("parent").get("link"),
        child=joint.find("child").get("link"),
        origin=_origin(joint),
        axis=np.array(
            _numbers(axis, "xyz") if axis is not None and "xyz" in axis.attrib else (1.0, 0.0, 0.0)
        ),
        limit=None if limit is None else Limit(*(_number(limit, name) for name in Limit.__slots__)),
        mimic=None
        if mimic is None
        else Mimic(mimic.get("joint"), _number(mimic, "multiplier", 1.0), _number(mimic, "offset", 0.0)),
    )


def _origin(element: Any) -> Array | None:
    origin = element.find("origin")
    if origin is None:
        return None
    place = np.eye(4)
    place[:3, :3] = of_roll_pitch_yaw(*_numbers(origin, "rpy"))
    place[:3, 3] = _numbers(origin, "xyz")
    return place


def _numbers(element: Any, name: str) -> list[float]:
    return [float(word) for word in element.get(name, "0 0 0").split()]


def _number(element: Any, name: str, default: float | None = None) -> Any:
    text = element.get(name)
    return default if text is None else float(text)
