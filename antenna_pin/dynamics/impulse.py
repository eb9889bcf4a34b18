r"""Impulses at joints: velocities that jump while all that is held stays held.

Of rows J that hold, with their wanted rates s after the jump, the velocity after it is

.. math:: v^+ = v^- + M^{-1} J^T \Lambda, \qquad J v^+ = s

the nearest to that before in kinetic energy. The impulses are inner ones of the mechanism, so all
momentum stays.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.constraints.factor_kernels import NOTHING
from antenna_pin.dynamics import kernels
from antenna_pin.dynamics.workspace import Workspace

__all__ = ["Struck", "impulse", "impulse_of_motions", "reduced_inertia"]

Array = NDArray[np.float64]

# Of the largest impulse, or of the largest change of a rate: what round-off leaves of none.
_ROUND_OFF = 1e-9
# Of the length of the mechanism: a change of rates that is round-off [1/s].
_STILL = 1e-12


class Struck(NamedTuple):
    """An impulse of motions whose rates jump.

    Attributes:
        velocity: After it, (nv,).
        held: Impulses of the rows of elements that hold, on the child, (holds,) [N m s] ([N s]).
        works: Of the motions, (motions,) [J].
        met: Whether all rows have the rates that are wanted.
    """

    velocity: Array
    held: Array
    works: Array
    met: bool


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
    nq, nv = workspace.model.nq, workspace.model.nv
    v = y[nq : nq + nv]
    rows, lacks, held = _held_rows(workspace, t, y)
    for at, rate in wanted.items():
        row = np.zeros(nv)
        row[at] = 1.0
        rows.append(row)
        lacks.append(rate - v[at])
    change, forces = _nearest(workspace, y, rows, lacks)
    end = len(rows) - len(wanted)
    own = forces[end - held : end] * _lengths(workspace, held)
    return v + change, own, forces[end:]


def impulse_of_motions(workspace: Workspace, t: float, y: Array) -> Struck:
    r"""Return the impulse that gives joints the rates of their motions, with all rows that hold held.

    The work of a motion is its impulse times the mean of the rates before and after it; the sum of all is
    the change of kinetic energy, for the rows that hold have no rate.

    Args:
        workspace: The system, with the motions that it has from now on.
        t: Time [s].
        y: State before [q, v, x].
    """
    nq, nv = workspace.model.nq, workspace.model.nv
    v = y[nq : nq + nv]
    rows, lacks, held = _held_rows(workspace, t, y)
    motions = len(workspace.system.motions)
    assert workspace.constraints is not None
    if not np.abs(lacks).max() > _STILL * workspace.constraints.plan.length:
        return Struck(v.copy(), np.zeros(held), np.zeros(motions), True)
    change, forces = _nearest(workspace, y, rows, lacks)
    met = np.abs(np.array(rows) @ change - lacks).max() <= _ROUND_OFF * np.abs(lacks).max()
    works = forces[:motions] * (np.array(rows[:motions]) @ (v + 0.5 * change))
    own = forces[len(rows) - held :]
    own = np.where(np.abs(own) > _ROUND_OFF * np.abs(forces).max(), own, 0.0)
    return Struck(v + change, own * _lengths(workspace, held), works, bool(met))


def reduced_inertia(workspace: Workspace, t: float, y: Array, block: int) -> float:
    r"""Return the reduced inertia of an element's joint, with all rows that hold held [kg m^2] ([kg]).

    .. math:: I_r = \Lambda, \qquad \text{where } r \cdot (v^+ - v^-) = 1

    with the slopes r of the joint's rate over velocities. It is the impulse at the joint, on both sides, that
    changes its rate by one.

    Args:
        workspace: The system, with the modes that its elements have.
        t: Time [s].
        y: State [q, v, x].
        block: Place of the element in the program.

    Returns:
        It; infinite where the joint cannot move.
    """
    nq, nv = workspace.model.nq, workspace.model.nv
    alone = y.copy()
    row = np.zeros(nv)
    for k in range(nv):
        alone[nq : nq + nv] = 0.0
        alone[nq + k] = 1.0
        row[k] = kernels.joint_motion(workspace.program, block, alone, nq)[1]
    rows, lacks, _ = _held_rows(workspace, t, y)
    change, forces = _nearest(workspace, y, [*rows, row], [*(0.0 * np.array(lacks)), 1.0])
    # What is held has no motion in common with the row: the nearest change has none of its rate.
    return float(forces[-1]) if float(row @ change) > 0.5 else math.inf


def _held_rows(workspace: Workspace, t: float, y: Array) -> tuple[list[Array], list[float], int]:
    """Return the rows that hold, what their rates lack, and how many of them are elements'."""
    constraints = workspace.constraints
    if constraints is None:
        return [], [], 0
    workspace.prepare_motions(t, y)
    constraints.residuals(t, y, workspace.program)
    some = np.abs(constraints.every_row).max(axis=1) > NOTHING * constraints.plan.length
    rows = list(np.where(some[:, None], constraints.every_row, 0.0))
    lacks = list(np.where(some, -constraints.every_speed, 0.0))
    return rows, lacks, len(constraints.loads())


def _nearest(workspace: Workspace, y: Array, rows: list[Array], lacks: list[float]) -> tuple[Array, Array]:
    """Return the change of velocity nearest in kinetic energy that rows lack, and their impulses."""
    model = workspace.model
    mass: Any = pin.crba(model, workspace.data, y[: model.nq])
    mass = np.triu(mass) + np.triu(mass, 1).T
    root = np.linalg.cholesky(mass)
    # In z = L^T v the kinetic energy is the sum of squares: the least change is the nearest velocity.
    reduced = np.linalg.solve(root, np.array(rows).T).T
    lengths = np.linalg.norm(reduced, axis=1)
    lengths[lengths == 0.0] = 1.0
    unit = reduced / lengths[:, None]
    change = np.linalg.lstsq(unit, np.array(lacks) / lengths, rcond=1e-11)[0]
    # Multipliers of least norm that make this change.
    forces = np.linalg.lstsq(unit.T, change, rcond=1e-11)[0] / lengths
    return np.linalg.solve(root.T, change), forces


def _lengths(workspace: Workspace, held: int) -> Array:
    """Return by what the rows of elements that hold are multiplied, (holds,)."""
    plan = workspace.system.plan
    slots = [workspace.system.mechanism.joint(one.joint) for one in workspace.system.holds]
    assert plan is not None or not held
    return np.array([1.0 if slot.kind == "prismatic" or plan is None else plan.length for slot in slots])
