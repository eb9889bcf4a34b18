"""What closures and motions leave free to first order, and what their forces do as it moves."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.base.differences import gradient
from antenna_pin.dynamics import System, Workspace
from antenna_pin.linear.forces import Forces

__all__ = ["Held", "held_by_constraints"]

Array = NDArray[np.float64]

# Steps over the mechanism's length, of ways, and of turns [rad]: rows are smooth on these scales.
_STEPS = (1e-2, 1e-3)


class Held(NamedTuple):
    """What constraints do in a state, (rows,) equations of them, with J and its derivatives.

    Attributes:
        jacobian: J, (rows, nv); no rows where nothing is held.
        force: Derivative of J^T lambda over the configuration at constant multipliers, (nv, nv).
        speed: Derivative of J v over the configuration at constant v, (rows, nv).
        lack: Derivatives of J a - lack at constant a over configuration and velocity, (rows, nv) each.
        acceleration: Of the state, constraints held, (nv,).
    """

    jacobian: Array
    force: Array
    speed: Array
    lack: tuple[Array, Array]
    acceleration: Array


def held_by_constraints(system: System, time: float, y: Array, forces: Forces, *, rest: bool) -> Held:
    """Return what the constraints of a system do in a state, and its acceleration.

    Args:
        system: The system.
        time: Of the state [s].
        y: The state [q, v, x].
        forces: Of its elements, in that state.
        rest: Whether what would set it moving is taken to be held in balance.
    """
    nq, nv = system.model.nq, system.model.nv
    tau = forces.whole()
    workspace = Workspace(system)
    workspace.program[:] = forces.program
    constraints = workspace.constraints
    if constraints is None:
        none = np.zeros((0, nv))
        acceleration = pin.aba(system.model, workspace.data, y[:nq], y[nq : nq + nv], tau)
        return Held(none, np.zeros((nv, nv)), none, (none, none), np.array(acceleration))
    acceleration = workspace.acceleration(time, y, tau)
    multipliers = constraints.force.copy()
    v = y[nq : nq + nv]
    used = np.zeros(nv) if rest else acceleration

    def look(state: Array) -> Array:
        constraints.residuals(time, state, workspace.program)
        j = constraints.jacobian
        return np.concatenate([j.T @ multipliers, j @ v, j @ used - constraints.lack])

    look(y)
    jacobian = constraints.jacobian.copy()
    rows = constraints.rows
    by_place, by_speed = np.zeros((nv + 2 * rows, nv)), np.zeros((nv + 2 * rows, nv))
    if multipliers.any() or v.any() or used.any():
        every, zero = np.eye(nv), np.zeros(nv)
        by_place, _ = gradient(lambda step: look(forces.displaced(step)), every, _STEPS)
        by_speed, _ = gradient(lambda change: look(forces.displaced(zero, change)), every, _STEPS)
    return Held(
        jacobian,
        by_place[:nv],
        by_place[nv : nv + rows],
        (by_place[nv + rows :], by_speed[nv + rows :]),
        acceleration,
    )
