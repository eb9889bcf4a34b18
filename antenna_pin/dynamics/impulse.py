r"""Impulses at joints: velocities that jump while all that is held stays held.

Of rows J that hold, with their wanted rates s after the jump, the velocity after it is

.. math:: v^+ = v^- + M^{-1} J^T \Lambda, \qquad J v^+ = s

the nearest to that before in kinetic energy. The impulses are inner ones of the mechanism, so all
momentum stays.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.constraints.factor_kernels import NOTHING
from antenna_pin.dynamics.workspace import Workspace

__all__ = ["impulse"]

Array = NDArray[np.float64]


def impulse(
    workspace: Workspace, t: float, y: Array, wanted: Mapping[int, float]
) -> tuple[Array, Array, Array]:
    """Return the velocity after an impulse that gives joints rates, with all rows that hold held.

    Args:
        workspace: The system, with the modes that its elements have from now on.
        t: Time [s].
        y: State before [q, v, x].
        wanted: Rates after it, by the joint's place in v [rad/s] ([m/s]).

    Returns:
        The velocity after it, (nv,); the impulses of the rows of elements that hold, (holds,), and those of
        ``wanted`` in its order [N m s] ([N s]), on the child.
    """
    model = workspace.model
    nq, nv = model.nq, model.nv
    v = y[nq : nq + nv]
    rows: list[Array] = []
    lacks: list[float] = []
    held = 0
    constraints = workspace.constraints
    if constraints is not None:
        workspace.prepare_motions(t, y)
        constraints.residuals(t, y, workspace.program)
        some = np.abs(constraints.every_row).max(axis=1) > NOTHING * constraints.plan.length
        rows += list(np.where(some[:, None], constraints.every_row, 0.0))
        lacks += list(np.where(some, -constraints.every_speed, 0.0))
        held = len(constraints.loads())
    for at, rate in wanted.items():
        row = np.zeros(nv)
        row[at] = 1.0
        rows.append(row)
        lacks.append(rate - v[at])
    mass: Any = pin.crba(model, workspace.data, y[:nq])
    mass = np.triu(mass) + np.triu(mass, 1).T
    root = np.linalg.cholesky(mass)
    # In z = L^T v the kinetic energy is the sum of squares: the least change is the nearest velocity.
    reduced = np.linalg.solve(root, np.array(rows).T).T
    lengths = np.linalg.norm(reduced, axis=1)
    lengths[lengths == 0.0] = 1.0
    unit = reduced / lengths[:, None]
    change = np.linalg.lstsq(unit, np.array(lacks) / lengths, rcond=1e-11)[0]
    after = v + np.linalg.solve(root.T, change)
    # Multipliers of least norm that make this change.
    forces = np.linalg.lstsq(unit.T, change, rcond=1e-11)[0] / lengths
    end = len(rows) - len(wanted)
    own = forces[end - held : end] * _lengths(workspace, held)
    return after, own, forces[end:]


def _lengths(workspace: Workspace, held: int) -> Array:
    """Return by what the rows of elements that hold are multiplied, (holds,)."""
    plan = workspace.system.plan
    slots = [workspace.system.mechanism.joint(one.joint) for one in workspace.system.holds]
    assert plan is not None or not held
    return np.array([1.0 if slot.kind == "prismatic" or plan is None else plan.length for slot in slots])
