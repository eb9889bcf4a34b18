"""What a free-floating mechanism must keep: energy and momentum, measured from a state."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.dynamics import _kernels
from antenna_pin.dynamics.workspace import Workspace
from antenna_pin.joints import _kernels as _joint

__all__ = ["Audit", "audit"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Audit:
    """Energies and momenta of one state.

    Attributes:
        kinetic: [J].
        gravity: Potential of gravity [J].
        contacts: Stored in touching contacts [J].
        springs: Stored in joint springs [J].
        linear: Total linear momentum, world axes, (3,) [kg m/s].
        angular: Total angular momentum about the mass centre, world axes, (3,) [kg m^2/s].
        linear_scale: Sum of the magnitudes of the linear momenta of the bodies other than the base [kg m/s].
        angular_scale: The same of the angular momenta about the common mass centre [kg m^2/s].
    """

    kinetic: float
    gravity: float
    contacts: float
    springs: float
    linear: Array
    angular: Array
    linear_scale: float
    angular_scale: float

    @property
    def energy(self) -> float:
        """All that is stored [J]."""
        return self.kinetic + self.gravity + self.contacts + self.springs


def audit(workspace: Workspace, y: Array) -> Audit:
    """Return energies and momenta of a state.

    Args:
        workspace: Its contact table and memory must be those of this state, as after ``measure(y)``.
        y: State [q, v, x].
    """
    system, model, data = workspace.system, workspace.model, workspace.data
    memory, table = workspace.memory, workspace.table
    q, v = y[: model.nq], y[model.nq : model.nq + model.nv]
    pin.computeCentroidalMomentum(model, data, q, v)
    kinetic = pin.computeKineticEnergy(model, data)
    gravity = pin.computePotentialEnergy(model, data, q)
    contacts, springs = _kernels.stored_energy(y, workspace.program, memory, table)
    for path in workspace.paths:
        if not path.joint.compiled:
            for r, law in enumerate(path.laws, path.row):
                depth = -float(table[r, 0])
                if memory[r, _joint.TOUCHING] != 0.0 and depth > 0.0:
                    contacts += law.energy(depth)
    linear_scale = angular_scale = 0.0
    cx, cy, cz = data.com[0].tolist()
    first = 2 if system.mechanism.base == "free" else 1
    for i in range(first, model.njoints):
        momentum = data.oMi[i].act(model.inertias[i] * data.v[i])
        px, py, pz, lx, ly, lz = momentum.vector.tolist()
        linear_scale += math.sqrt(px * px + py * py + pz * pz)
        lx -= cy * pz - cz * py
        ly -= cz * px - cx * pz
        lz -= cx * py - cy * px
        angular_scale += math.sqrt(lx * lx + ly * ly + lz * lz)
    return Audit(
        kinetic=float(kinetic),
        gravity=float(gravity),
        contacts=contacts,
        springs=springs,
        linear=np.array(data.hg.linear),
        angular=np.array(data.hg.angular),
        linear_scale=linear_scale,
        angular_scale=angular_scale,
    )
