"""Readings of a system in one state, or at samples: angles, deflections, attitudes, loads, counts."""

from __future__ import annotations

import operator
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import compress, pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.records import POSE, memory_numbers, memory_records
from antenna_pin.dynamics import kernels
from antenna_pin.dynamics.bearing_load_kernels import BEARING_LOAD, look_at_bearings
from antenna_pin.dynamics.blocks import bearings_in, element_block
from antenna_pin.dynamics.constraints import Mobility, mobility, redundancies
from antenna_pin.dynamics.system import System
from antenna_pin.dynamics.workspace import Workspace
from antenna_pin.elements import ConstantDrive, JointSpring, Motion
from antenna_pin.joints.layout_kernels import JOINT
from antenna_pin.mechanism import link_twists

# --- parts of a run with the same elements ------------------------------------------------------------------


def program_parts(programs: Sequence[NDArray[np.float64]]) -> Iterator[tuple[int, int]]:
    """Yield ranges of samples, [start, stop), over which the program is constant.

    Successive programs are one and the same array unless elements have changed.
    """
    n = len(programs)
    return pairwise([0, *compress(range(1, n), map(operator.is_not, programs[1:], programs)), n])


def records_at(programs: Sequence[NDArray[np.float64]], place: int, layout: np.dtype[Any]) -> NDArray[Any]:
    """Return the program's records at a place at each sample.

    Args:
        programs: Force elements at each sample: the same array from one to the next unless they changed.
        place: Start of the record in a program.
        layout: Layout of the record.
    """
    found = np.zeros(len(programs), layout)
    for first, last in program_parts(programs):
        found[first:last] = programs[first][place : place + layout.itemsize // 8].view(layout)[0]
    return found


# --- one state ----------------------------------------------------------------------------------------------

Array = NDArray[np.float64]


def contact_memory(system: System, y: Array) -> Array:
    """Return the contact memory of a state without one, (contacts, 3).

    Contacts with a gap of zero or less touch, with the present effective mass. At the surface the approach
    speed is the present depth rate, at least the floor; at larger depths there is none
    (:func:`antenna_pin.contact.onset.approach_speed_in_contact`).

    Args:
        system: The system.
        y: State [q, v, x].
    """
    return memory_numbers(Workspace(system).first_memory(y))


def acceleration(
    system: System, t: float, q: ArrayLike, v: ArrayLike, memory: ArrayLike | None = None
) -> Array:
    """Return the generalized acceleration in a state, (nv,).

    Args:
        system: The system.
        t: Time [s].
        q: Configuration, (nq,).
        v: Velocity, (nv,).
        memory: Of the contacts, (contacts, 3); by the rule of :func:`contact_memory` if not given.
    """
    y = system.state(q, v)
    workspace = Workspace(system)
    workspace.memory[:] = workspace.first_memory(y) if memory is None else memory_records(memory)
    rates = np.zeros(system.model.nv + system.manifold.nx)
    workspace.derivative(t, y, rates)
    return rates[: system.model.nv].copy()


# --- angle of a joint ---------------------------------------------------------------------------------------


def motion_block(system: System, joint: str) -> Array:
    """Return the block of a joint's motion angle for kernels.

    Raises:
        AntennaPinError: There is no such joint, or it has no axis.
    """
    return element_block(system, f"motion of {joint!r}", ConstantDrive(joint=joint, value=0.0), 0)


class JointMotion:
    """Angle and rate of a single-axis joint: ideal, by constraint, or with play.

    Args:
        system: The system.
        joint: Name of the joint.

    Raises:
        AntennaPinError: There is no such joint, or it has no axis.
    """

    def __init__(self, system: System, joint: str) -> None:
        """Lay out the numbers of the joint for the kernel."""
        self._program = np.concatenate([system.program, motion_block(system, joint)])
        self._block = system.program.size
        self._nq = system.model.nq

    def __call__(self, y: Array) -> tuple[float, float]:
        """Return angle [rad] (or position [m]) and rate in a state [q, v, x]."""
        angle, rate, _, _ = kernels.joint_motion(self._program, self._block, y, self._nq)
        return float(angle), float(rate)


# --- deflections of elastic parts ---------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class Deflections:
    """The elastic parts of a system at n samples.

    Attributes:
        motion: Deflection from rest [rad] or [m], its rate and its acceleration, (n, parts, 3).
        energy: Stored in their springs, (n, parts) [J].
        spin: Angular speed of their hubs, (n, parts) [rad/s].
    """

    motion: Array
    energy: Array
    spin: Array


def deflections(
    system: System, states: Array, accelerations: Array, programs: Sequence[Array]
) -> Deflections:
    """Evaluate the elastic parts of a system at samples.

    Args:
        system: The system.
        states: [q, v, x] of each, (n, nq + nv + nx).
        accelerations: Generalized, (n, nv).
        programs: Force elements at each: the same array from one to the next where nothing was changed.
    """
    n, parts = len(states), len(system.elastic)
    motion, energy, spin = np.zeros((n, parts, 3)), np.zeros((n, parts)), np.zeros((n, parts))
    if not parts:
        return Deflections(motion, energy, spin)
    nq, nv = system.model.nq, system.model.nv
    q, v = states[:, :nq], states[:, nq : nq + nv]
    urdf = system.mechanism.urdf
    hubs = list(dict.fromkeys(urdf.joint(name).parent for name in system.elastic))
    turning = np.linalg.norm(link_twists(system.mechanism, q, v, hubs)[..., 3:], axis=2)
    for k, name in enumerate(system.elastic):
        slot = system.mechanism.joint(name)
        motion[:, k, 0] = q[:, slot.q.start]
        motion[:, k, 1] = v[:, slot.v.start]
        motion[:, k, 2] = accelerations[:, slot.v.start]
        spin[:, k] = turning[:, hubs.index(urdf.joint(name).parent)]
        at = system.spring_blocks[name]
        on = records_at(programs, at, kernels.ELEMENT)["on"]
        spring = records_at(programs, at + int(kernels.PARAMETERS), JointSpring.layout())
        energy[:, k] = 0.5 * on * spring["stiffness"] * (motion[:, k, 0] - spring["rest_angle"]) ** 2
    return Deflections(motion, energy, spin)


# --- attitudes of journals ----------------------------------------------------------------------------------


def journal_attitudes(
    system: System,
    states: Array,
    programs: Sequence[Array],
    before: tuple[Array, Array] | None = None,
) -> Array:
    """Return the attitudes of journals in their bearings, as quaternions of continuous sign.

    Args:
        system: The system.
        states: (n, nq + nv + nx).
        programs: Force elements at each: the same array from one to the next where nothing was changed.
        before: The state before the first of these, and its attitudes, (joints, 4), whose signs continue.

    Returns:
        (n, joints, 4), xyzw.
    """
    if before is not None:
        states, programs = np.concatenate([before[0][np.newaxis], states]), [programs[0], *programs]
    result = np.zeros((len(states), len(system.clearances), 4))
    for k, joint in enumerate(system.clearances):
        slot = system.mechanism.joint(joint.name)
        q, found = states[:, slot.q], result[:, k]
        if slot.kind == "planar":
            half = 0.5 * np.arctan2(q[:, 3], q[:, 2])
            found[:, 2], found[:, 3] = np.sin(half), np.cos(half)
        else:
            axes = records_at(programs, system.clearance_blocks[joint.name], JOINT)["axes"]
            # Number by number, so that a sample's values do not depend on other samples.
            found[:, :3] = sum(q[:, 3 + i, np.newaxis] * axes[:, i] for i in range(3))
            found[:, 3] = q[:, 6]
        if joint.bearing_on == "child":
            found[:, :3] *= -1.0
        largest = found[0, np.argmax(np.abs(found[0]))]
        sign = np.sign(largest) if before is None else np.sign(found[0] @ before[1][k])
        jumps = np.cumsum(np.sum(found[1:] * found[:-1], axis=1) < 0.0) % 2 == 1
        found[0] *= sign
        found[1:] *= np.where(jumps, -sign, sign)[:, None]
    return result if before is None else result[1:]


# --- loads of bearings --------------------------------------------------------------------------------------


def bearing_names(system: System) -> list[str]:
    """Return the names of a system's bearings and preloads."""
    return [name for _, name, _ in bearings_in(system.families)]


def bearing_loads(system: System, states: Array, programs: Sequence[Array]) -> NDArray[Any]:
    """Return place, tilt, force and moment of each bearing, ``BEARING_LOAD``, (n, bearings).

    Args:
        system: The system.
        states: [q, v, x] of each sample, (n, nq + nv + nx).
        programs: Force elements at each: the same array from one to the next where nothing was changed.
    """
    blocks = [system.element_blocks[table][name] for table, name, _ in bearings_in(system.families)]
    found = np.zeros((len(states), len(blocks)), BEARING_LOAD)
    if not blocks:
        return found
    pose = np.zeros(1, POSE)
    for first, last in program_parts(programs):
        look_at_bearings(programs[first], states[first:last], np.array(blocks), pose, found[first:last])
    return found


# --- counts of equations and freedoms -----------------------------------------------------------------------


def mobility_of(system: System, y: Array) -> Mobility:
    """Return how a system with constraints can move in a state [q, v, x]."""
    workspace = Workspace(system)
    assert workspace.constraints is not None
    workspace.prepare_motions(0.0, y)
    return mobility(workspace.constraints, 0.0, y, workspace.program)


def constraint_counts(system: System, y: Array) -> dict[str, Any]:
    """Return the number of constraint equations of a state, and the remaining freedoms.

    ``closure_equations`` of closures and couplings, the number of ``couplings`` among these, if any,
    ``closure_rank`` (independent ones), ``motions``, ``rank`` (of all), ``freedoms`` of the tree,
    ``mobility`` (left by closures and couplings), ``freedoms_left`` (left by all), ``moving``: of each joint
    (and the ``base``) that moves without a motion of its own its ``rate`` and the ``unit`` of that, and
    ``redundant``: of each closure or coupling with implied equations the number of ``equations``, and
    ``among`` which.
    """
    if system.plan is None or system.plan.count == 0:  # elements that may hold do not close loops
        nv = system.model.nv
        zero = dict.fromkeys(("closure_equations", "closure_rank", "motions", "rank"), 0)
        return {**zero, "freedoms": nv, "mobility": nv, "freedoms_left": nv, "moving": {}, "redundant": {}}
    count = mobility_of(system, y)
    found = {}
    if count.redundant:
        workspace = Workspace(system)
        assert workspace.constraints is not None
        workspace.prepare_motions(0.0, y)
        found = redundancies(workspace.constraints, 0.0, y, workspace.program)
    return {
        "closure_equations": count.closed,
        **({"couplings": len(system.couplings)} if system.couplings else {}),
        "closure_rank": count.closed_rank,
        "motions": count.driven,
        "rank": count.rank,
        "freedoms": count.freedoms,
        "mobility": count.free,
        "freedoms_left": count.left,
        "moving": _moving(system, y),
        "redundant": {
            name: {"equations": one.equations, "among": list(one.among)} for name, one in found.items()
        },
    }


def _moving(system: System, y: Array) -> dict[str, dict[str, Any]]:
    """Return the rates of moving joints without prescribed motion, by name."""
    nq, mechanism, found = system.model.nq, system.mechanism, {}
    slots = {name: (slot.ways, slot.v) for name, slot in mechanism.joints.items()}
    if mechanism.base == "free":
        slots["base"] = slice(0, 3), mechanism.base_v
    moved = {one.joint for one in system.drives.values() if isinstance(one, Motion)}
    for name, (ways, own) in slots.items():
        rate = y[nq + own.start : nq + own.stop]
        turns = rate[ways.stop - ways.start :]
        if rate.any() and name not in moved:
            size = float(rate[0]) if len(rate) == 1 else float(np.linalg.norm(turns if turns.any() else rate))
            found[name] = {"rate": size, "unit": "rad/s" if turns.any() else "m/s"}
    return found
