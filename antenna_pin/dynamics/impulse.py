r"""Impulses at joints: velocity jumps under constraints.

With active rows J and their rates s after the jump, the velocity after it is

.. math:: v^+ = v^- + M^{-1} J^T \Lambda, \qquad J v^+ = s

the nearest to that before in kinetic energy. The impulses are internal, so all momentum is conserved.

Stops that are struck at one instant, or that joints rest on, push only. With u their rates off the stops and
p their impulses they obey Newton's law in Moreau's form,

.. math:: 0 \le p_i \quad \perp \quad u_i^+ - b_i \ge 0, \qquad b_i = e_i\, |u_i^-|, \quad u_i^- \le 0

a complementarity problem whose velocity is the nearest one that satisfies the inequalities: it is unique, and
independent of the order. Its impulses are found by the finite method of Lawson and Hanson for least
distances. As no pushing row was leaving its stop, stops take

.. math:: -\tfrac12 \sum_i p_i (u_i^+ + u_i^-) = \tfrac12 \sum_i p_i (1 - e_i) |u_i^-| \ge 0

for any restitution of each: no combination gains energy.

References:
    Moreau (1988), Unilateral contact and dry friction in finite freedom dynamics, CISM 302.
    Lawson and Hanson (1974), Solving Least Squares Problems, chapter 23.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import kernels
from antenna_pin.dynamics.adjust import Adjustments, acting_in
from antenna_pin.dynamics.constraints import motions_that_prescribe
from antenna_pin.dynamics.constraints.factor_kernels import NOTHING
from antenna_pin.dynamics.system import System
from antenna_pin.dynamics.workspace import Workspace
from antenna_pin.elements import Modal
from antenna_pin.errors import MechanismError
from antenna_pin.mechanism.inertia import mass_matrix

# --- impulses -----------------------------------------------------------------------------------------------

Array = NDArray[np.float64]

# Remainder of a row that the others imply, relative to its length; round-off of rates.
_HELD, _ROUND_OFF = 1e-9, 1e-11
# Error of a satisfied row, relative to the largest required change of a rate.
_MET = 1e-9


class Push(NamedTuple):
    """A stop that a joint strikes, or rests on.

    Attributes:
        at: Place of the joint in v.
        way: +1 of a stop that pushes the joint up, -1 of one that pushes it down.
        restitution: Restitution of the blow; zero of a stop that the joint rests on, or comes to rest on.
    """

    at: int
    way: float
    restitution: float


class Pushed(NamedTuple):
    """The impulses of one instant, and what they do."""

    velocity: Array  # velocity after the impulses, (nv,)
    pushes: Array  # impulses of the stops, zero or more, (pushes,) [N m s] ([N s])
    rates: Array  # rates of the joints off their stops after them, (pushes,) [rad/s] ([m/s])
    holds: Array  # impulses on the child of the rows of elements that hold, (holds,) [N m s] ([N s])
    lost: Array  # energy lost by these, (holds,) [J]
    works: Array  # work of the prescribed motions, (motions,) [J]
    met: bool  # whether all active rows have their rates


def impulse(
    workspace: Workspace, t: float, y: Array, wanted: Mapping[int, float]
) -> tuple[Array, Array, Array]:
    """Return the velocity after an impulse with prescribed joint rates and active rows.

    Args:
        workspace: Workspace of the system, with the modes of elements after the impulse.
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
    rows += [_of_joint(at, 1.0, nv) for at in wanted]
    lacks += [rate - v[at] for at, rate in wanted.items()]
    change, forces = _nearest(_root(workspace, y), rows, lacks)
    end = len(rows) - len(wanted)
    own = forces[end - held : end] * _lengths(workspace, held)
    return v + change, own, forces[end:]


def push_apart(
    workspace: Workspace, t: float, y: Array, pushes: Sequence[Push], free: Collection[int] = ()
) -> Pushed:
    """Solve for simultaneous impulses of active rows, and of stops that push only.

    Args:
        workspace: Workspace of the system, with the modes of elements after the impulses.
        t: Time [s].
        y: State before [q, v, x].
        pushes: Stops that are struck or rested on; none that its joint is leaving.
        free: Numbers of elements' holds whose rows bear no impulse, or whose stops are among the pushes.

    Raises:
        MechanismError: The constraints admit no velocity with which joints stay out of their stops.
    """
    nq, nv = workspace.model.nq, workspace.model.nv
    v = y[nq : nq + nv]
    rows, lacks, held = _held_rows(workspace, t, y, free)
    root, end = _root(workspace, y), len(rows)
    own = [_of_joint(one.at, one.way, nv) for one in pushes]
    before = np.array([row @ v for row in own])
    least = np.array([one.restitution for one in pushes]) * np.maximum(-before, 0.0)
    some = _pushing(root, v, rows, lacks, own, least) if own else []
    change, forces = _nearest(
        root, rows + [own[k] for k, _ in some], lacks + [least[k] - before[k] for k, _ in some]
    )
    sizes = np.zeros(len(own))
    for (k, found), force in zip(some, forces[end:], strict=True):
        # If stops share a push in several ways, the least shares may pull: then the first solution is used.
        sizes[k] = force if np.all(forces[end:] >= 0.0) else found
    velocity = v + change
    length = 1.0 if workspace.system.plan is None else workspace.system.plan.length
    near = _MET * float(np.abs(lacks).max(initial=0.0)) + _ROUND_OFF * length
    work = 0.5 * forces[:end] * np.array([row @ (velocity + v) for row in rows])
    return Pushed(
        velocity=velocity,
        pushes=sizes,
        rates=np.array([row @ velocity for row in own]),
        holds=forces[end - held : end] * _lengths(workspace, held),
        lost=-work[end - held : end],
        works=work[: len(workspace.system.motions)],
        met=all(abs(row @ change - lack) <= near for row, lack in zip(rows, lacks, strict=True)),
    )


def _pushing(
    root: Array, v: Array, rows: list[Array], lacks: list[float], own: list[Array], least: Array
) -> list[tuple[int, float]]:
    """Return pushing stops and impulses for given least rates off the stops."""
    from scipy.optimize import nnls

    change, _ = _nearest(root, rows, lacks)
    needed = least - np.array([row @ (v + change) for row in own])
    reduced = np.linalg.solve(root, np.array(own).T).T
    lengths = np.linalg.norm(reduced, axis=1)
    unit, needed = reduced / lengths[:, None], needed / lengths
    size = float(np.linalg.norm(root.T @ v))
    unit = _left_of(unit, root, rows)
    moves = np.linalg.norm(unit, axis=1) > _HELD
    # A joint held by others stays, unless that would move it into the stop.
    if np.any(needed[~moves] - least[~moves] / lengths[~moves] > _ROUND_OFF * size):
        raise MechanismError(
            "impulse: a constraint drives a joint into its rigid stop; remove one of the two"
        )
    some = np.flatnonzero(moves)
    most = float(needed[some].max(initial=0.0))
    if most <= 0.0:
        return []
    # The least change of velocity with unit @ change >= needed, from non-negative least squares.
    table = np.vstack([unit[some].T, needed[some] / most])
    found, _ = nnls(table, np.append(np.zeros(len(v)), 1.0))
    left = 1.0 - float(table[-1] @ found)
    if left <= _ROUND_OFF:
        raise MechanismError(
            "impulse: the constraints admit no velocity that keeps joints out of their rigid stops"
        )
    return [
        (int(k), float(one) * most / left / lengths[k])
        for k, one in zip(some, found, strict=True)
        if one > 0.0
    ]


def apart(workspace: Workspace, t: float, y: Array, joints: Sequence[int], free: Collection[int]) -> bool:
    """Return whether impulses at some joints change none of the others' rates.

    Args:
        workspace: Workspace of the system, with the modes of its elements.
        t: Time [s].
        y: State [q, v, x].
        joints: Their places in v.
        free: Numbers of elements' holds whose rows do not count.
    """
    root = _root(workspace, y)
    rows, _, _ = _held_rows(workspace, t, y, free)
    own = np.linalg.solve(root, np.array([_of_joint(at, 1.0, len(root)) for at in joints]).T).T
    left = _left_of(own / np.linalg.norm(own, axis=1)[:, None], root, rows)
    among = left @ left.T
    return bool(np.abs(among - np.diag(np.diag(among))).max() < _HELD)


def _left_of(unit: Array, root: Array, rows: Sequence[Array]) -> Array:
    """Return what of rows, over their lengths, moves where other rows hold."""
    fixed = np.linalg.solve(root, np.array(rows).reshape(-1, len(root)).T).T
    lengths = np.linalg.norm(fixed, axis=1)
    if not lengths.any():
        return unit
    _, values, basis = np.linalg.svd(fixed[lengths > 0.0] / lengths[lengths > 0.0, None], full_matrices=False)
    basis = basis[values > _ROUND_OFF]
    return np.asarray(unit - (unit @ basis.T) @ basis)


def _of_joint(at: int, way: float, nv: int) -> Array:
    row = np.zeros(nv)
    row[at] = way
    return row


def reduced_inertia(workspace: Workspace, t: float, y: Array, block: int) -> float:
    r"""Return the reduced inertia of an element's joint under active rows [kg m^2] ([kg]).

    .. math:: I_r = \Lambda, \qquad \text{where } r \cdot (v^+ - v^-) = 1

    with the slopes r of the joint's rate over velocities. It is the impulse at the joint, on both sides, that
    changes its rate by one.

    Args:
        workspace: Workspace of the system, with the modes of its elements.
        t: Time [s].
        y: State [q, v, x].
        block: Place of the element in the program.

    Returns:
        Reduced inertia; infinite if the joint cannot move.
    """
    nq, nv = workspace.model.nq, workspace.model.nv
    alone = y.copy()
    row = np.zeros(nv)
    for k in range(nv):
        alone[nq : nq + nv] = 0.0
        alone[nq + k] = 1.0
        row[k] = kernels.joint_motion(workspace.program, block, alone, nq)[1]
    rows, lacks, _ = _held_rows(workspace, t, y)
    change, forces = _nearest(_root(workspace, y), [*rows, row], [*(0.0 * np.array(lacks)), 1.0])
    # The constrained motions have no component along the row: the nearest change leaves its rate.
    return float(forces[-1]) if float(row @ change) > 0.5 else math.inf


def _held_rows(
    workspace: Workspace, t: float, y: Array, free: Collection[int] = ()
) -> tuple[list[Array], list[float], int]:
    """Return rows active without ``free`` holds, rate residuals, number of element rows."""
    constraints = workspace.constraints
    if constraints is None:
        return [], [], 0
    workspace.prepare_motions(t, y)
    constraints.residuals(t, y, workspace.program)
    held = len(constraints.loads())
    some = np.abs(constraints.every_row).max(axis=1) > NOTHING * constraints.plan.length
    some[[len(some) - held + k for k in free]] = False
    rows = list(np.where(some[:, None], constraints.every_row, 0.0))
    lacks = list(np.where(some, -constraints.every_speed, 0.0))
    return rows, lacks, held


def _root(workspace: Workspace, y: Array) -> Array:
    """Return L of the mass matrix M = L L^T, (nv, nv)."""
    q, constraints = y[: workspace.model.nq], workspace.constraints
    if constraints is not None:
        return np.asarray(np.linalg.cholesky(constraints.mass(q)))
    return np.asarray(np.linalg.cholesky(mass_matrix(workspace.model, workspace.data, q)))


def _nearest(root: Array, rows: list[Array], lacks: list[float]) -> tuple[Array, Array]:
    """Return the change of velocity nearest in kinetic energy that rows lack, and their impulses."""
    if not rows:
        return np.zeros(len(root)), np.zeros(0)
    # In z = L^T v the kinetic energy is the sum of squares: the least change is the nearest velocity.
    reduced = np.linalg.solve(root, np.array(rows).T).T
    lengths = np.linalg.norm(reduced, axis=1)
    lengths[lengths == 0.0] = 1.0
    unit = reduced / lengths[:, None]
    change = np.linalg.lstsq(unit, np.array(lacks) / lengths, rcond=1e-11)[0]
    # Multipliers of least norm that make this change.
    forces = np.linalg.lstsq(unit.T, change, rcond=1e-11)[0] / lengths
    return np.asarray(np.linalg.solve(root.T, change)), np.asarray(forces)


def _lengths(workspace: Workspace, element_rows: int) -> Array:
    """Return by what the rows of elements that hold are multiplied, (holds,)."""
    plan = workspace.system.plan
    slots = [workspace.system.mechanism.joint(one.joint) for one in workspace.system.holds]
    assert plan is not None or not element_rows
    return np.array([1.0 if slot.slides or plan is None else plan.length for slot in slots])


# --- joints held where motions move them --------------------------------------------------------------------


class NotFollowedError(MechanismError):
    """Motion that cannot be followed: impossible rates, or its joint is held."""


def prescribing(
    workspace: Workspace, adjustments: Adjustments, t: float, y: Array, at: int, holds: Collection[str] = ()
) -> tuple[str, ...]:
    """Return the motions that prescribe the rate of a joint.

    Args:
        workspace: Workspace of the system.
        adjustments: Its present elements.
        t: Time [s].
        y: State [q, v, x].
        at: Place of the joint in v.
        holds: Places of elements that count too, where they hold their joints.
    """
    constraints = workspace.constraints
    if constraints is None or not constraints.plan.motions:
        return ()
    workspace.prepare_motions(t, y)
    constraints.residuals(t, y, workspace.program)
    held = [k for k, name in enumerate(constraints.plan.holds) if name in holds and adjustments.holds(name)]
    return motions_that_prescribe(constraints, at, held)


def check_restraint(
    workspace: Workspace,
    adjustments: Adjustments,
    t: float,
    y: Array,
    place: str,
    holds: Collection[str] = (),
) -> None:
    """Refuse an element that would hold a joint with prescribed motion.

    Args:
        workspace: Workspace of the system.
        adjustments: Its present elements.
        t: Time [s].
        y: State [q, v, x].
        place: Place of the element.
        holds: Places of other elements that count too, where they hold their joints.

    Raises:
        NotFollowedError: Motions move its joint.
    """
    system = workspace.system
    one = next((one for one in acting_in(system) if one.place == place), None)
    if one is None or not system.motions or not is_rigid(one.element):
        return
    joint = str(one.element.acts_at)
    at = system.mechanism.joint(joint).v.start
    motions = prescribing(workspace, adjustments, t, y, at, [name for name in holds if name != place])
    if motions:
        drives = f"drive{'s' if len(motions) > 1 else ''} {', '.join(map(repr, motions))}"
        raise NotFollowedError(
            f"{one.label}: its joint {joint!r} is held to a motion by {drives}; remove one of them, follow "
            f"the reference with a pd drive, or use a compliant element"
        )


def check_restraints(system: System, y: Array, t: float = 0.0) -> None:
    """Refuse rigid stops and latches at joints with prescribed motion, at the start.

    Raises:
        NotFollowedError: There is one.
    """
    rigid = [one for one in acting_in(system) if is_rigid(one.element) and one.element.acts]
    if not rigid or not system.motions:
        return
    workspace = Workspace(system)
    adjustments = Adjustments(system, workspace.program)
    for one in rigid:
        check_restraint(workspace, adjustments, t, y, one.place)


def is_rigid(element: object) -> bool:
    """Return whether an element may hold its joint against any load."""
    return isinstance(element, Modal) and element.holds and not element.together
