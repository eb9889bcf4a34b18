"""The motion of flexible links to first order, from M, delta and omega or from Pinocchio's mass matrix."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.linalg import eigh

from antenna_pin.dynamics import System
from antenna_pin.mechanism.flexible import ElasticPart, MassProperties

Array = NDArray[np.float64]


def spatial(body: MassProperties) -> Array:
    """The inertia of a body about the origin, of velocity and angular velocity, (6, 6)."""
    return np.array(pin.Inertia(body.mass, body.centre, body.inertia).matrix())


def frequencies(parts: list[ElasticPart], hub: Array | None = None) -> Array:
    """Natural frequencies [rad/s] of parts on a hub: a generalized eigenvalue problem written here anew.

    Args:
        parts: The parts.
        hub: (6, 6) inertia of all else about the origin.
    """
    n = len(parts)
    factors = np.array([part.participation(np.zeros(3)) for part in parts])
    stiff = np.diag([(2.0 * np.pi * part.frequency) ** 2 for part in parts])
    if hub is None:
        return np.sqrt(eigh(stiff, np.eye(n), eigvals_only=True))
    mass = np.block([[hub, factors.T], [factors, np.eye(n)]])
    full = np.zeros((6 + n, 6 + n))
    full[6:, 6:] = stiff
    return np.sqrt(np.maximum(eigh(full, mass, eigvals_only=True), 0.0))[6:]


def linear_frequencies(system: System, held: tuple[str, ...] = ()) -> Array:
    """Natural frequencies [rad/s] of a system about its neutral pose by Pinocchio's mass matrix.

    Args:
        system: Of joints with one coordinate, and springs at joints.
        held: Joints that do not move.
    """
    model = system.model
    data = model.createData()
    mass = np.array(pin.crba(model, data, pin.neutral(model)))
    mass = np.triu(mass) + np.triu(mass, 1).T
    stiff = np.zeros(model.nv)
    for spring in system.springs.values():
        stiff[system.mechanism.joint(spring.joint).v] = spring.stiffness
    kept = np.ones(model.nv, dtype=bool)
    for name in held:
        kept[system.mechanism.base_v if name == "base" else system.mechanism.joint(name).v] = False
    values = eigh(np.diag(stiff[kept]), mass[np.ix_(kept, kept)], eigvals_only=True)
    return np.sqrt(np.maximum(values, 0.0))
