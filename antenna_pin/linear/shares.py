"""What moves in a mode, by body: motions, energies, and what of it the base feels."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.dynamics import System
from antenna_pin.linear.linearisation import Linearisation

__all__ = ["Bodies", "bodies_of", "kinetic_shares", "strain_shares"]

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


class Bodies(NamedTuple):
    """The bodies of a mechanism in one configuration, by linear maps.

    Attributes:
        motion: Generalized velocity to each body's twist at its mass centre in world axes, (bodies, 6, nv).
        inertia: Spatial inertia of each at its mass centre in world axes, (bodies, 6, 6).
        coupling: Generalized force of inertia under an acceleration of the root with all else at rest
            relative to it, (nv, 6); the root's origin and axes, those of the world with a fixed base.
        rigid: Inertia of the whole as one rigid body about that origin, (6, 6).
    """

    motion: Array
    inertia: Array
    coupling: Array
    rigid: Array


def bodies_of(system: System, q: Array) -> Bodies:
    """Return how bodies move with the coordinates of velocities in a configuration."""
    model = system.model
    data = model.createData()
    pin.computeJointJacobians(model, data, q)
    count = model.njoints - 1
    motion, inertia = np.zeros((count, 6, model.nv)), np.zeros((count, 6, 6))
    coupling, rigid = np.zeros((model.nv, 6)), np.zeros((6, 6))
    root = data.oMi[1] if system.mechanism.base == "free" else pin.SE3.Identity()
    for k in range(count):
        own = model.inertias[k + 1]
        at_centre = pin.SE3(np.eye(3), own.lever)
        world = data.oMi[k + 1] * at_centre
        turned = pin.SE3(world.rotation, np.zeros(3))
        local = np.array(pin.getJointJacobian(model, data, k + 1, pin.ReferenceFrame.LOCAL))
        local = local.reshape(6, model.nv)  # of one column Pinocchio makes a vector
        motion[k] = turned.toActionMatrix() @ at_centre.inverse().toActionMatrix() @ local
        about = pin.Inertia(own.mass, np.zeros(3), own.inertia)
        inertia[k] = turned.act(about).matrix()
        carried = turned.toActionMatrix() @ (world.inverse() * root).toActionMatrix()
        coupling += motion[k].T @ inertia[k] @ carried
        rigid += carried.T @ inertia[k] @ carried
    return Bodies(motion, inertia, coupling, rigid)


def kinetic_shares(bodies: Bodies, shapes: Complex) -> Array:
    """Return each body's share of a mode's kinetic energy, (modes, bodies) [-].

    Args:
        bodies: In the configuration of the modes.
        shapes: In the coordinates of velocities, (nv, modes).
    """
    moved = np.einsum("bik,km->bim", bodies.motion, shapes)
    energy = np.einsum("bim,bij,bjm->mb", moved.conj(), bodies.inertia, moved).real
    total = energy.sum(axis=1, keepdims=True)
    return np.asarray(energy / np.where(total > 0.0, total, 1.0))


def strain_shares(linear: Linearisation, shapes: Complex) -> tuple[list[str], Array]:
    """Return what stores a mode's potential energy, (modes, parts) [-], and the parts' names.

    Joints by name, for their drives, springs and contacts; ``springs between points``, or with forces
    ``elements on links``; and ``loops, gravity and loads``, for what constraint forces and accelerations
    store as what carries them turns. NaN where none is stored.
    """
    system = linear.system
    parts = linear.forces.parts
    names, energy = [], []
    of_joints = parts["joints"] @ shapes
    whole = linear.directions @ linear.stiffness
    reduced = np.linalg.lstsq(linear.directions, shapes, rcond=None)[0]
    total = np.einsum("km,km->m", shapes.conj(), whole @ reduced).real
    for name, slot in system.mechanism.joints.items():
        own = -np.einsum("km,km->m", shapes[slot.v].conj(), of_joints[slot.v]).real
        if np.any(parts["joints"][slot.v]):
            names.append(name)
            energy.append(own)
    if system.point_springs or system.forces:
        names.append("elements on links" if system.forces else "springs between points")
        energy.append(-np.einsum("km,km->m", shapes.conj(), parts["points"] @ shapes).real)
    rest = total - np.sum(energy, axis=0) if energy else total
    largest = np.abs(total).max(initial=0.0)
    if np.abs(rest).max(initial=0.0) > 1e-9 * largest:
        names.append("loops, gravity and loads")
        energy.append(rest)
    table = np.array(energy).reshape(len(names), len(total)).T
    shares = np.full_like(table, np.nan)
    stored = np.abs(total) > 1e-12 * largest
    shares[stored] = table[stored] / total[stored, None]
    return names, shares
