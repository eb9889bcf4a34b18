"""What a mechanism in maximal coordinates is made of: bodies, joints, motions, springs. SI units."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

WORLD = "world"


@dataclass(frozen=True, kw_only=True)
class Body:
    """A rigid body, and where it starts.

    Attributes:
        mass: [kg].
        inertia: (3, 3) about the mass centre in the body's axes [kg m^2], or its diagonal.
        centre: Mass centre in the body's frame [m].
        position: Origin of the body's frame in the world at the start [m].
        attitude: (3, 3) rotation from the body to the world at the start [-].
    """

    mass: float
    inertia: object
    centre: Sequence[float] = (0.0, 0.0, 0.0)
    position: Sequence[float] = (0.0, 0.0, 0.0)
    attitude: object = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

    @property
    def moments(self) -> np.ndarray:
        """(3, 3) inertia [kg m^2]."""
        inertia = np.array(self.inertia, dtype=float)
        return np.diag(inertia) if inertia.ndim == 1 else inertia


@dataclass(frozen=True)
class Side:
    """Where a joint sits on a body: point [m], axis (z) and direction across it (x), in the body's frame."""

    body: str
    point: Sequence[float]
    axis: Sequence[float] = (0.0, 0.0, 1.0)
    across: Sequence[float] | None = None

    @property
    def frame(self) -> np.ndarray:
        """(3, 3), columns x, y, z; without ``across`` by the shortest rotation that takes z to the axis."""
        z = np.array(self.axis, dtype=float) / np.linalg.norm(self.axis)
        if self.across is None:
            return Rotation.from_rotvec(_from_z(z)).as_matrix()
        x = np.array(self.across, dtype=float)
        x = x - (x @ z) * z
        x /= np.linalg.norm(x)
        return np.column_stack([x, np.cross(z, x), z])


@dataclass(frozen=True)
class Joint:
    """A joint of one of the kinds of :data:`ROWS`, between a side on each of two bodies or the world."""

    kind: str
    first: Side
    second: Side


# Per kind: axes of frame A along which the points coincide; pairs of axes of A and B that stay perpendicular.
ROWS: dict[str, tuple[str, tuple[str, ...]]] = {
    "spherical": ("xyz", ()),
    "revolute": ("xyz", ("xz", "yz")),
    "universal": ("xyz", ("zz",)),
    "fixed": ("xyz", ("xz", "yz", "xy")),
    "prismatic": ("xy", ("xz", "yz", "xy")),
    "cylindrical": ("xy", ("xz", "yz")),
    "planar": ("z", ("xz", "yz")),
}


@dataclass(frozen=True)
class Motion:
    """Prescribed angle of a revolute joint, from x of A to x of B [rad], or way along a prismatic one [m]."""

    joint: str
    position: Callable[[float], float]
    velocity: Callable[[float], float]
    acceleration: Callable[[float], float]


@dataclass(frozen=True, kw_only=True)
class Spring:
    """A spring and damper from point to point: length at rest [m], stiffness [N/m], damping [N s/m]."""

    first: Side
    second: Side
    length: float
    stiffness: float = 0.0
    damping: float = 0.0


def _from_z(axis: np.ndarray) -> np.ndarray:
    """Return the rotation vector that takes z to a unit axis the shortest way; about x if it is -z."""
    normal = np.array([-axis[1], axis[0], 0.0])
    sine = float(np.linalg.norm(normal))
    angle = np.arctan2(sine, axis[2])
    return normal * (angle / sine) if sine > 0.0 else np.array([angle, 0.0, 0.0])
