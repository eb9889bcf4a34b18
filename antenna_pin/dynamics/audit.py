"""Audit of a state: energy and momentum, which a free-floating mechanism conserves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import audit_kernels as _bodies
from antenna_pin.dynamics import kernels, link_kernels
from antenna_pin.dynamics.workspace import Workspace
from antenna_pin.mechanism import PLACE, body_tree

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Audit:
    """Energies and momenta of one state.

    Attributes:
        kinetic: [J].
        gravity: Potential of gravity [J].
        contacts: Stored in touching contacts [J].
        springs: Stored in springs at joints and between points [J].
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


def energy_of_python_laws(workspace: Workspace) -> float:
    """Return the energy of touching contacts with laws in Python [J]."""
    energy = 0.0
    for path in workspace.paths:
        if not path.compiled:
            for r, law in enumerate(path.laws, path.row):
                depth = -float(workspace.table[r].gap)
                if workspace.memory[r].touching != 0.0 and depth > 0.0:
                    energy += law.energy(depth)
    return energy


def audit(workspace: Workspace, y: Array) -> Audit:
    """Return energies and momenta of a state.

    Args:
        workspace: Workspace with contact table and memory of this state, as after ``measure(y)``.
        y: State [q, v, x].
    """
    model = workspace.model
    tree = body_tree(workspace.system.mechanism)
    audits = np.zeros(1, _bodies.AUDIT)
    places = np.zeros(len(tree) + 1, PLACE)
    _bodies.audit_state(y, model.nq, tree, np.array(model.gravity.linear), places, audits)
    found: Any = audits[0]
    workspace.tell_energies(y)
    contacts, springs = kernels.stored_energy(y, workspace.program, workspace.memory, workspace.table)
    if workspace.bodies is not None:
        springs += link_kernels.stored(y, workspace.program, places)
    return Audit(
        kinetic=float(found.kinetic),
        gravity=float(found.gravity),
        contacts=contacts + energy_of_python_laws(workspace),
        springs=springs,
        linear=found.linear,
        angular=found.angular,
        linear_scale=float(found.linear_scale),
        angular_scale=float(found.angular_scale),
    )
