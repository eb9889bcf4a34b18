"""Names of coordinates of configuration and velocity, and their counts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from antenna_pin.mechanism import Mechanism

_DOF_NAMES = {
    "floating": ("x", "y", "z", "qx", "qy", "qz", "qw"),
    "planar": ("x", "y", "cos", "sin"),
    "continuous": ("cos", "sin"),
    "spherical": ("qx", "qy", "qz", "qw"),
}
_RATE_NAMES = {
    "floating": ("vx", "vy", "vz", "wx", "wy", "wz"),
    "planar": ("vx", "vy", "wz"),
    "spherical": ("wx", "wy", "wz"),
}


def coordinate_names(mechanism: Mechanism) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the names of the numbers of q and of v."""
    configuration: list[str] = []
    velocity: list[str] = []
    if mechanism.base == "free":
        configuration += [f"base.{name}" for name in _DOF_NAMES["floating"]]
        velocity += [f"base.{name}" for name in _RATE_NAMES["floating"]]
    for slot in mechanism.joints.values():
        for target, names in ((configuration, _DOF_NAMES), (velocity, _RATE_NAMES)):
            parts = names.get(slot.kind)
            target += [slot.name] if parts is None else [f"{slot.name}.{part}" for part in parts]
    return tuple(configuration), tuple(velocity)


def reach_of(mechanism: Mechanism, length: float) -> NDArray[np.float64]:
    """Return what equals a 1 rad turn in each direction, (nv,): ``length`` [m], or 1."""
    reach = np.ones(mechanism.model.nv)
    if mechanism.base == "free":
        reach[:3] = length
    for slot in mechanism.joints.values():
        reach[slot.ways] = length
    return reach
