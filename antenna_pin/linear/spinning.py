"""Rotors on bearings, of which small motions are seen in axes that do not spin with them."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.dynamics import System

__all__ = ["rotors", "turning"]

Array = NDArray[np.float64]

# Of an inertia that is the same in all directions across an axis: round-off of written numbers.
_EVEN = 1e-9


def rotors(system: System, v: Array) -> dict[str, float]:
    """Return joints on bearings whose child spins and looks the same however far it has turned: their spin.

    Such a child is a body on which nothing else moves, with one moment of inertia in all directions across
    the axis. In its own axes the rest of the mechanism turns round; in axes that do not spin its equations
    stay what they are, whatever bearings and mechanism are.

    Args:
        system: The system.
        v: Velocity, (nv,).

    Returns:
        Spin about the joint's axis [rad/s] by the joint's name.
    """
    found = {}
    for name in system.on_bearings:
        slot = system.mechanism.joint(name)
        k = system.model.getJointId(name)
        spin = float(v[slot.v][3:] @ slot.axis)
        whole, about = np.array(system.model.inertias[k].matrix()), _about(slot.axis)
        even = np.abs(whole @ about - about @ whole).max() <= _EVEN * np.abs(whole).max()
        if spin != 0.0 and even and not len(system.model.children[k]):
            found[name] = spin
    return found


def turning(system: System, v: Array) -> Array:
    """Return how fast the axes of rotors' motions turn in the rotors' own, as a matrix, (nv, nv).

    With u = R(spin t) xi, u' = R xi' + turning u.
    """
    found = np.zeros((system.model.nv, system.model.nv))
    for name, spin in rotors(system, v).items():
        slot = system.mechanism.joint(name)
        found[slot.v, slot.v] = spin * _about(slot.axis)
    return found


def _about(axis: Array) -> Array:
    """Return how both parts of a twist turn about an axis, (6, 6)."""
    across = np.array(pin.skew(np.asarray(axis, dtype=float)))
    return np.kron(np.eye(2), across)
