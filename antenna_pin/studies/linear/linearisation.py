"""Linearised equations of motion of a system: mass, damping and stiffness under its constraints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from scipy.linalg import block_diag

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.calculus import gradient
from antenna_pin.base.readable import brief
from antenna_pin.dynamics import System, Workspace, acting_in
from antenna_pin.dynamics.constraints import directions
from antenna_pin.elements import Modal
from antenna_pin.errors import MechanismError
from antenna_pin.mechanism.inertia import mass_matrix
from antenna_pin.studies.linear.force_derivatives import ForceDerivatives, Forces
from antenna_pin.studies.linear.operating_point import At

# --- rotors on bearings, in axes that do not spin with them -------------------------------------------------

# Of an inertia that is the same in all directions across an axis: round-off of written numbers.
_EVEN = 1e-9


def rotors(system: System, v: Array) -> dict[str, float]:
    """Return the spin of axisymmetric rotors on bearings, by joint.

    Such a child carries no moving body and has one moment of inertia in all directions across the axis. In
    axes that do not spin its equations have constant coefficients.

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


def _axis_rates(system: System, v: Array) -> Array:
    """Return the rates of the rotors' motion axes in their own frames, (nv, nv).

    With u = R(spin t) xi, u' = R xi' + turning u.
    """
    found = np.zeros((system.model.nv, system.model.nv))
    for name, spin in rotors(system, v).items():
        slot = system.mechanism.joint(name)
        found[slot.v, slot.v] = spin * _about(slot.axis)
    return found


def _about(axis: Array) -> Array:
    """Return the rotation of both parts of a twist about an axis, (6, 6)."""
    across = np.array(pin.skew(np.asarray(axis, dtype=float)))
    return np.kron(np.eye(2), across)


# --- equations of small motions -----------------------------------------------------------------------------

# --- what closures and motions leave free to first order, and what their forces do as it moves ---

# Steps over the mechanism's length, of ways, and of turns [rad]: rows are smooth on these scales.
_STEPS = (1e-2, 1e-3)


class _ConstraintTerms(NamedTuple):
    """Constraints in a state, (rows,) equations, with J and its derivatives."""

    jacobian: Array  # J, (rows, nv); no rows where nothing is held
    force: Array  # derivative of J^T lambda over the configuration at constant multipliers, (nv, nv)
    speed: Array  # derivative of J v over the configuration at constant v, (rows, nv)
    # derivatives of J a - lack at constant a over configuration and velocity, (rows, nv) each
    lack: tuple[Array, Array]
    acceleration: Array  # of the state, constraints held, (nv,)


def _constraint_terms(
    system: System, time: float, y: Array, forces: Forces, *, rest: bool
) -> _ConstraintTerms:
    """Return the constraint terms of a system in a state, and its acceleration."""
    nq, nv = system.model.nq, system.model.nv
    tau = forces.whole()
    workspace = Workspace(system)
    workspace.program[:] = forces.program
    constraints = workspace.constraints
    if constraints is None:
        none = np.zeros((0, nv))
        acceleration = pin.aba(system.model, workspace.data, y[:nq], y[nq : nq + nv], tau)
        return _ConstraintTerms(none, np.zeros((nv, nv)), none, (none, none), np.array(acceleration))
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
    return _ConstraintTerms(
        jacobian,
        by_place[:nv],
        by_place[nv : nv + rows],
        (by_place[nv + rows :], by_speed[nv + rows :]),
        acceleration,
    )


# Sine of an angle below which a direction counts as one that is left free.
_PARALLEL = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Linearisation:
    r"""Equations of small motions about a state.

    A configuration near that of the state is :math:`q \circ \exp(N s)`, its velocity :math:`v + N w + Y s`
    in the coordinates of velocities, with the k directions N left free by closures, motions and held joints:

    .. math:: \dot s = w - D s, \qquad
              \tilde M \dot w + \tilde C w + \tilde K s = N^T f + \tilde F z, \qquad
              \dot z = B_s s + B_w w + B_z z

    z are bristles of friction, if any. About a state at rest D and Y are zero, and these are the equations
    of vibration. Geometric stiffness, of constraint forces and of accelerations, is part of K.
    """

    __repr__ = brief

    at: At  # the operating point
    directions: Array  # N, (nv, k)
    shift: Array  # Y, (nv, k)
    drift: Array  # D, (k, k)
    mass: Array  # mass matrix, (k, k)
    damping: Array  # damping matrix with gyroscopic terms, (k, k)
    gyroscopic: Array  # the same without dampers, (k, k)
    stiffness: Array  # stiffness matrix, (k, k)
    bristles: tuple[Array, Array, Array, Array]  # F, B_s, B_w, B_z
    forces: ForceDerivatives  # derivatives of the elements' forces in all coordinates
    acceleration: Array  # acceleration in the state, (nv,)
    # N^T times mass, damping and stiffness in all coordinates, (k, nv) each: the effect of a change of a
    # prescribed motion, about a state at rest
    beside: tuple[Array, Array, Array]
    # the six rigid-body directions of a mechanism with a free base, as columns of s, (k, 6); (k, 0) if
    # something holds it
    rigid: Array

    @property
    def system(self) -> System:
        """The system."""
        return self.at.system

    @property
    def still(self) -> bool:
        """Return whether the state is at rest."""
        return not self.at.v.any()

    @property
    def state_matrix(self) -> Array:
        """State matrix A: x' = A x + B f, x = [s, w, z]."""
        return self._matrix(self.damping, damped=True)

    @property
    def undamped_matrix(self) -> Array:
        """State matrix without dampers and friction, stuck bristles as springs, (2 k, 2 k)."""
        return self._matrix(self.gyroscopic, damped=False)

    @property
    def undamped_stiffness(self) -> Array:
        """Stiffness with that of stuck bristles, (k, k)."""
        to_force, _, by_speed, _ = self.bristles
        return np.asarray(self.stiffness - to_force @ by_speed)

    @property
    def input_matrix(self) -> Array:
        """B, by which a generalized force, (nv,), enters the whole linear system."""
        k, bristles = len(self.mass), self.bristles[0].shape[1]
        found = np.zeros((2 * k + bristles, self.directions.shape[0]))
        found[k : 2 * k] = np.linalg.solve(self.mass, self.directions.T)
        return found

    def _matrix(self, damping: Array, *, damped: bool) -> Array:
        k = len(self.mass)
        to_force, by_place, by_speed, by_bristle = self.bristles
        bristles = to_force.shape[1] if damped else 0
        found = np.zeros((2 * k + bristles, 2 * k + bristles))
        found[:k, :k], found[:k, k : 2 * k] = -self.drift, np.eye(k)
        stiffness = self.stiffness if damped else self.undamped_stiffness
        right = np.hstack([-stiffness, -damping, to_force[:, :bristles]])
        found[k : 2 * k] = np.linalg.solve(self.mass, right)
        if bristles:
            found[2 * k :] = np.hstack([by_place, by_speed, by_bristle])
        return found


@takes()
def linearise(at: At) -> Linearisation:
    """Return the equations of small motions about a state.

    The derivatives of inverse dynamics are Pinocchio's (Carpentier and Mansard 2018, RSS), those of forward
    dynamics being the same times the inverse of the mass matrix; those of contacts, drives and springs, and
    of the forces of constraints, are differences of the compiled functions that a run calls.

    Raises:
        MechanismError: Nothing is free to move, or a joint has no inertia in this pose.
    """
    system, y = at.system, at.y
    model = system.model
    nq, nv = model.nq, model.nv
    system.check_pose(y[:nq], "linearise")
    _check_loads(system, at.rest)
    forces = Forces(system, at.time, y, at.memory, at.loads, at.adjusted)
    derived = forces.derivatives()
    held = _constraint_terms(system, at.time, y, forces, rest=at.rest)
    acceleration = held.acceleration.copy()
    weightless = _is_free_floating(system)
    if weightless:
        # What falls freely does not feel it: gravity moves all alike.
        base = pin.XYZQUATToSE3(y[:7])
        acceleration[:3] -= base.rotation.T @ model.gravity.linear
        model = model.copy()
        model.gravity = pin.Motion.Zero()
    v = y[nq : nq + nv]
    data = model.createData()
    used = np.zeros(nv) if at.rest else acceleration
    pin.computeRNEADerivatives(model, data, y[:nq], v, used)
    by_place, by_speed = (np.array(one).reshape(nv, nv) for one in (data.dtau_dq, data.dtau_dv))
    mass = mass_matrix(model, data, y[:nq])
    n, rigid = _free_directions(at, weightless)
    if n.shape[1] == 0:
        names = ", ".join(at.hold) or "none"
        raise MechanismError(
            f"modes: something must be left free to move, but closures, motions and hold = {names} hold "
            "everything; hold fewer joints, drive a joint by a torque instead of a motion, or use "
            "friction that does not stick"
        )
    # What velocities and accelerations must do as the directions turn, in the complement of N.
    shift, shift_place, shift_speed = np.zeros_like(n), np.zeros_like(n), np.zeros_like(n)
    if len(held.jacobian):
        back = -np.linalg.pinv(held.jacobian, rcond=1e-9)
        rest = np.eye(nv) - n @ n.T
        shift = rest @ back @ held.speed @ n
        lack_place, lack_speed = held.lack
        shift_place = rest @ back @ (lack_place @ n + lack_speed @ shift)
        shift_speed = rest @ back @ lack_speed @ n
    # Rotors in axes that do not spin: one and the same turning of places and of velocities.
    turned = n.T @ _axis_rates(system, v) @ n
    brackets = n.T @ _twist_brackets(system, v) @ n - turned
    stiff = by_place - derived.position - held.force
    gyroscopic = n.T @ (by_speed @ n + mass @ shift_speed) - n.T @ mass @ n @ turned
    stiffness = n.T @ (stiff @ n + (by_speed - derived.rate) @ shift + mass @ shift_place)
    to_bristles = derived.bristle_rates
    return Linearisation(
        at=at,
        directions=n,
        shift=shift,
        drift=np.asarray(brackets),
        mass=n.T @ mass @ n,
        damping=gyroscopic - n.T @ derived.rate @ n,
        gyroscopic=gyroscopic,
        stiffness=stiffness,
        bristles=(
            n.T @ derived.bristle,
            to_bristles[0] @ n + to_bristles[1] @ shift,
            to_bristles[1] @ n,
            to_bristles[2],
        ),
        forces=derived,
        acceleration=acceleration,
        beside=(n.T @ mass, n.T @ (by_speed - derived.rate), n.T @ stiff),
        rigid=rigid,
    )


def _check_loads(system: System, rest: bool) -> None:
    """Refuse load-dependent friction that slips or has bristles: its derivatives are unknown."""
    for one in acting_in(system):
        if not one.element.under_load:
            continue
        if not isinstance(one.element, Modal):
            raise MechanismError(
                f"modes: {one.label}: friction with bristles by a joint's own load is not linearised; leave "
                f"out its coefficient, and use Coulomb friction and stiffness for the present load"
            )
        if not rest:
            raise MechanismError(
                f"modes: {one.label}: friction by a joint's own load is not linearised about a state that "
                "moves; take the state at rest (moving = False), or friction that no load makes"
            )


def _is_free_floating(system: System) -> bool:
    """Return whether gravity is the only external force on a system."""
    tied = system.closed_to_world or system.sprung_to_world
    return (
        system.mechanism.base == "free" and not tied and all(one.internal for one in system.forces.values())
    )


def _free_directions(at: At, floating: bool) -> tuple[Array, Array]:
    """Return orthonormal free directions, and the rigid motions among them.

    Returns:
        N, (nv, k), and (k, 6) or (k, 0). Those of a free base come first.
    """
    system, nv = at.system, at.system.model.nv
    base_too = floating and "base" not in at.hold
    allowed = at.allowed()
    if base_too:
        allowed = allowed[:, 6:]
    workspace = Workspace(system)
    if workspace.constraints is not None:
        workspace.prepare_motions(at.time, at.y)
        left = directions(workspace.constraints, at.y, workspace.program, motions=True)
        outside = allowed - left @ (left.T @ allowed)
        _, sines, right = np.linalg.svd(outside)
        allowed = allowed @ right[int(np.count_nonzero(sines > _PARALLEL)) :].T
    if not base_too:
        return allowed, np.zeros((allowed.shape[1], 0))
    n = np.hstack([np.eye(nv)[:, :6], allowed])
    return n, np.eye(n.shape[1])[:, :6]


def _twist_brackets(system: System, v: Array) -> Array:
    """Return the matrix of xi -> [v, xi], joint by joint, (nv, nv).

    With q(t) o exp(xi) near q(t), the velocity is v + xi' + [v, xi].
    """
    blocks: list[Any] = []
    for joint in list(system.model.joints)[1:]:
        own = v[joint.idx_v : joint.idx_v + joint.nv]
        name = joint.shortname()
        if name == "JointModelFreeFlyer":
            blocks.append(np.array(pin.Motion(own).action))
        elif name == "JointModelSpherical":
            blocks.append(np.array(pin.skew(own)))
        elif name == "JointModelPlanar":
            six = np.array(pin.Motion(np.array([own[0], own[1], 0.0, 0.0, 0.0, own[2]])).action)
            blocks.append(six[np.ix_((0, 1, 5), (0, 1, 5))])
        else:
            blocks.append(np.zeros((joint.nv, joint.nv)))
    return np.asarray(block_diag(*blocks))
