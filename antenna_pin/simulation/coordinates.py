"""What the numbers of a configuration and of a velocity are called."""

from __future__ import annotations

from antenna_pin.dynamics import System

__all__ = ["coordinate_names"]

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


def coordinate_names(system: System) -> tuple[list[str], list[str]]:
    """Return the names of the numbers of q and of v."""
    configuration, velocity = [], []
    if system.mechanism.base == "free":
        configuration += [f"base.{name}" for name in _DOF_NAMES["floating"]]
        velocity += [f"base.{name}" for name in _RATE_NAMES["floating"]]
    for slot in system.mechanism.joints.values():
        for target, names in ((configuration, _DOF_NAMES), (velocity, _RATE_NAMES)):
            parts = names.get(slot.kind)
            target += [slot.name] if parts is None else [f"{slot.name}.{part}" for part in parts]
    return configuration, velocity
