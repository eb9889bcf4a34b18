"""Readings of a mechanism in balance: efforts, shares of virtual work, reactions, contacts, stiffness."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.dynamics import JointMotion, acting_in, kernels, link_kernels
from antenna_pin.dynamics.constraints import force_kernels
from antenna_pin.elements import Element, Motion
from antenna_pin.errors import MechanismError
from antenna_pin.studies.statics.balance import Balance
from antenna_pin.studies.statics.result import StaticContact, StaticStability
from antenna_pin.studies.statics.solver import Rest

Array = NDArray[np.float64]

GRAVITY = "gravity"
# Eigenvalue of the stiffness over the largest, below which it counts as zero.
_NEUTRAL = 1e-7


def positions_of(balance: Balance, y: Array) -> dict[str, float]:
    """Return the positions of joints with an axis, by name [rad] ([m])."""
    found = {}
    for name in balance.system.mechanism.joints:
        try:
            motion = JointMotion(balance.system, name)
        except MechanismError:
            continue
        found[name] = motion(y)[0]
    return found


def sources_of(balance: Balance) -> list[str]:
    """Return the names of the sources of torque, in the order of :func:`components`."""
    static, system = balance.static, balance.system
    names = [GRAVITY] if np.any(system.model.gravity.linear) else []
    for joint in system.clearances:
        names.append(f"clearance.{joint.name}")
        if joint.name in static.contact_friction:
            names.append(f"clearance.{joint.name}.friction")
    own = [one for one in acting_in(system) if not isinstance(one.element, Motion)]
    names += [static.place(one.place) for one in own if static.place(one.place) not in static.play_friction]
    return names + list(static.play_friction)


def components(balance: Balance, y: Array, velocity: Array) -> dict[str, float]:
    """Return the generalized force of each source along a velocity, which constraints leave free.

    Args:
        balance: The mechanism.
        y: State in balance.
        velocity: (nv,); if a joint's rate in it is 1, the results are torques at that joint.
    """
    system, static = balance.system, balance.static
    model = balance.model
    y = y.copy()
    balance.forces(y)
    own = [one for one in acting_in(system) if not isinstance(one.element, Motion)]
    under_load = {
        one.place: balance.load(one.place) * float(velocity[_at(balance, one)])
        for one in own
        if one.element.under_load and getattr(one.element, "on", True)
    }
    found = dict.fromkeys(sources_of(balance), 0.0)
    if GRAVITY in found:
        weight = pin.computeGeneralizedGravity(model, model.createData(), y[: model.nq])
        found[GRAVITY] = -float(np.array(weight) @ velocity)
    with balance.alone() as (heads, on):
        tau = balance.exerted(y)
        for joint in system.clearances:
            v = system.mechanism.joint(joint.name).v
            found[f"clearance.{joint.name}"] = float(tau[v] @ velocity[v])
            if joint.name in static.contact_friction and balance.velocity.any():
                friction = balance.contact_friction(y, joint.name)
                found[f"clearance.{joint.name}.friction"] = float(friction @ velocity)
        for one in own:
            heads[one.place]["on"] = on[one.place]
            if on[one.place]:
                torque = float((balance.exerted(y) - tau) @ velocity)
                name = static.place(one.place)
                found[name] = found.get(name, 0.0) + torque + under_load.get(one.place, 0.0)
            heads[one.place]["on"] = 0.0
    for place in balance.meshes:
        found[place] += float(balance.mesh_friction(y, place) @ velocity)
    for place in static.play_friction:
        found[place] += float(balance.play_friction(y, place) @ velocity)
    return found


def _at(balance: Balance, one: Any) -> int:
    return int(balance.system.mechanism.joint(str(one.element.acts_at)).v.start)


def efforts_of(balance: Balance, y: Array) -> dict[str, float]:
    """Return the torque of each element at a joint, by place."""
    y = y.copy()
    balance.forces(y)
    found = {}
    for one in acting_in(balance.system):
        if not isinstance(one.element, Element) or isinstance(one.element, Motion):
            continue
        if one.element.about == "pose":
            continue
        effort = float(
            kernels.element_state(balance.program, one.block, balance.time, y, balance.model.nq)[0]
        )
        if one.element.under_load and getattr(one.element, "on", True):
            effort += balance.load(one.place)
        found[balance.static.place(one.place)] = effort
    return found


def holding_of(balance: Balance, y: Array) -> dict[str, float]:
    """Return the torques of motions, couplings and holding elements at their joints [N*m] ([N])."""
    system, constraints = balance.system, balance.workspace.constraints
    if system.plan is None or constraints is None:
        return {}
    balance.forces(y.copy())
    plan = system.plan
    joints = _closure_forces(balance)[1]
    names = [f"drives.{name}" for name in plan.motions] + [f"couplings.{name}" for name in plan.couplings]
    found = dict(zip([*names, *plan.holds], joints.tolist(), strict=True))
    return {name: value for name, value in found.items() if name not in plan.holds or value != 0.0}


def _closure_forces(balance: Balance) -> tuple[Array, Array, Array]:
    """Return wrenches of closures, forces of motions, couplings and holds, and multipliers."""
    constraints, plan = balance.workspace.constraints, balance.system.plan
    assert constraints is not None and plan is not None
    closures = np.zeros((len(plan.closures), 2, 3))
    joints = np.zeros(len(plan.motions) + len(plan.couplings) + len(plan.holds))
    force_kernels.write_holding(
        plan.words, constraints.work, constraints.least_room, constraints.least, closures, joints
    )
    return closures, joints, constraints.least


def reactions_of(balance: Balance, y: Array) -> dict[str, Array]:
    """Return force and moment on the child of each joint, by name, (6,) [N, N*m].

    World axes; the moment about the origin of the joint's frame on the child. Closures, whose wrench is that
    on their second link about its point, stand behind the joints.
    """
    system, model = balance.system, balance.model
    data = model.createData()
    y = y.copy()
    balance.forces(y)
    q = y[: model.nq]
    pin.forwardKinematics(model, data, q)
    outer = [np.zeros(6) for _ in range(model.njoints)]  # force, and moment about the world's origin
    found_closures = {}
    if system.plan is not None and system.plan.closures:
        wrenches, _, _ = _closure_forces(balance)
        for name, wrench in zip(system.plan.closures, wrenches, strict=True):
            found_closures[name] = _add_closure(balance, data, name, wrench, outer)
    bodies = balance.workspace.bodies
    if bodies is not None:
        places = balance.workspace._bodies[1]  # type: ignore[index]
        out = np.zeros(6 * len(bodies))
        link_kernels.write_wrenches(balance.program, places, out)
        for k, wrench in enumerate(out.reshape(-1, 6)):
            joint = _joint_of_body(balance, k)
            if joint > 0 and wrench.any():
                origin = data.oMi[joint].translation
                outer[joint] += np.append(wrench[:3], wrench[3:] + np.cross(origin, wrench[:3]))
    own = [place.actInv(pin.Force(wrench)) for place, wrench in zip(data.oMi, outer, strict=True)]
    zero = np.zeros(model.nv)
    pin.rnea(model, data, q, zero, zero, own)
    found = {}
    for name, slot in system.mechanism.joints.items():
        wrench = data.f[slot.joint_id]
        rotation = data.oMi[slot.joint_id].rotation
        found[name] = np.concatenate([rotation @ wrench.linear, rotation @ wrench.angular])
    return found | found_closures


def _add_closure(balance: Balance, data: Any, name: str, wrench: Array, outer: list[Array]) -> Array:
    """Add a closure's wrench to its bodies; return it in world axes."""
    closure, mechanism = balance.system.closures[name], balance.system.mechanism
    places, joints = [], []
    for side in (closure.first, closure.second):
        if side.link == "world":
            places.append(pin.SE3(np.asarray(side.rotation), np.asarray(side.origin)))
            joints.append(0)
            continue
        frame = balance.model.frames[mechanism.frame(side.link)]
        own = pin.SE3(np.asarray(side.rotation), np.asarray(side.origin))
        places.append(data.oMi[frame.parentJoint] * frame.placement * own)
        joints.append(int(frame.parentJoint))
    force, moment = (places[0].rotation @ one for one in wrench)
    about_origin = np.append(force, moment + np.cross(places[1].translation, force))
    outer[joints[1]] += about_origin
    outer[joints[0]] -= about_origin
    return np.append(force, moment)


def _joint_of_body(balance: Balance, body: int) -> int:
    """Return Pinocchio's joint of a body of the tree; 0 of the world."""
    tree = balance.workspace.bodies
    assert tree is not None
    v = int(tree["v"][body])
    for joint in list(balance.model.joints)[1:]:
        if joint.idx_v == v:
            return int(joint.id)
    return 0


def contacts_of(balance: Balance, y: Array) -> tuple[StaticContact, ...]:
    """Return the contacts that carry load."""
    if not balance.system.rows:
        return ()
    balance.forces(y.copy())
    table = balance.workspace.table
    return tuple(
        StaticContact(name, float(-table["gap"][row]), float(table["force"][row]))
        for row, name in enumerate(balance.system.contact_names)
        if table["force"][row] > 0.0
    )


def stiffness_of(balance: Balance, rest: Rest) -> tuple[Array, StaticStability]:
    """Return eigenvalues of the reduced tangent stiffness, rising, and the stability.

    Free motion of journals in their play makes no equilibrium neutral.
    """
    directions = rest.free.directions
    if directions.shape[1] == 0:
        return np.zeros(0), "held"
    _, triangle = np.linalg.qr(directions / balance.reach[:, None])
    inverse = np.linalg.inv(triangle)
    whole = directions.T @ rest.stiffness
    # Signs do not depend on scales: those in which each direction counts alike tell them best.
    balance.forces(rest.y.copy())
    size = balance.sizes(rest.y)
    work = (np.abs(directions) * size[:, None]).max(axis=0, initial=0.0)
    own = np.abs(np.diag(whole))
    zero = own <= _NEUTRAL * np.maximum(work, _NEUTRAL * own.max())
    moves_joint = np.array([not balance.in_play(rest.free, k) for k in range(directions.shape[1])])
    kept = ~zero
    whole = np.where(np.outer(kept, kept), whole, 0.0)
    values = np.sort(np.linalg.eigvals(inverse.T @ whole @ inverse).real)
    scaled = whole[np.ix_(kept, kept)] / np.sqrt(np.outer(own[kept], own[kept]))
    signs = np.linalg.eigvals(scaled).real  # friction makes it unsymmetric
    if (signs < -_NEUTRAL).any():
        return values, "unstable"
    if (zero & moves_joint).any() or (np.abs(signs) <= _NEUTRAL).any():
        return values, "neutral"
    return values, "stable"
