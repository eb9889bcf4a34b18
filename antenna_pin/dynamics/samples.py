"""Evaluation of the equations of motion at samples: forces, contacts, energies, accelerations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.base.records import CONTACT, POSE
from antenna_pin.dynamics import (
    audit_kernels,
    link_kernels,
    point_kernels,
    sample_kernels,
)
from antenna_pin.dynamics.audit import energy_of_python_laws
from antenna_pin.dynamics.readings import program_parts, records_at
from antenna_pin.dynamics.system import System
from antenna_pin.dynamics.workspace import Workspace
from antenna_pin.errors import FunctionError
from antenna_pin.joints.layout_kernels import JOINT
from antenna_pin.mechanism import PLACE, ROOM, JointSlot, body_tree

Array = NDArray[np.float64]


# --- constraint forces of a system at the samples of a run ---


def held_samples(
    workspace: Workspace,
    samples: sample_kernels.SampleArrays,
    whole: sample_kernels.SystemArrays,
    sights: sample_kernels.Sights,
    programs: Sequence[Array],
    done: NDArray[Any],
    failures: dict[int, FunctionError],
) -> tuple[Array, Array, Array, Array]:
    """Return accelerations, closures' wrenches, couplings' forces, residuals at samples.

    Mass matrix and bias are the tree's own. Forces of motions are added to efforts in ``sights``, those of
    elements that hold to ``done``; for samples in ``failures`` all are NaN, and samples whose motions fail
    are added there.
    """
    system, constraints = workspace.system, workspace.constraints
    assert constraints is not None
    plan, n, nv = constraints.plan, len(samples.times), system.model.nv
    own, holds = len(plan.motions) + len(plan.couplings), plan.holds
    out = sample_kernels.Holding(
        rates=np.zeros((n, nv + system.manifold.nx)),
        closures=np.zeros((n, len(plan.closures), 2, 3)),
        joints=np.zeros((n, own + len(holds))),
        residuals=np.zeros((n, 4)),
    )
    held = sample_kernels.ConstraintArrays(
        plan=plan.words,
        work=constraints.work,
        mass=np.zeros((nv, nv)),
        bias=np.zeros(nv),
        room=np.zeros(len(whole.tree) + 1, ROOM),
        least=constraints.least_room,
        multipliers=constraints.least,
        applied=sights.wrenches,
    )
    for first, last in _parts(programs, one_by_one=bool(system.callables or failures)):
        workspace.program[:] = programs[first]
        try:
            workspace.prepare_motions(samples.times[first], samples.states[first])
        except FunctionError as error:
            failures[first] = error
        if first in failures:
            for part in out:
                part[first] = np.nan
            continue
        sample_kernels.observe_held(first, last, samples, whole, held, sights.forces, out)
    names = plan.motions
    drives = list(system.drives)
    efforts: NDArray[Any] = sights.efforts
    efforts["effort"][:, [drives.index(name) for name in names]] = out.joints[:, : len(names)]
    others = [f"{table}.{name}" for table in system.others for name in system.families[table]]
    done["effort"][:, [others.index(name) for name in holds]] += out.joints[:, own:]
    return out.rates[:, :nv], out.closures, out.joints[:, len(names) : own], out.residuals


def _parts(programs: Sequence[Array], one_by_one: bool) -> Iterator[tuple[int, int]]:
    """Yield first and last of samples with one program, or of each sample."""
    return ((i, i + 1) for i in range(len(programs))) if one_by_one else program_parts(programs)


_AT_ONCE = 256


@dataclass(frozen=True, slots=True, eq=False)
class Observed:
    """A system at n samples.

    Attributes:
        acceleration: Generalized, (n, nv).
        contact: Quantities of each contact, ``SEEN`` with the names of a result's variables, (n, contacts).
        pose: Journals in their bearings, with force and moment of the contacts on them about their centres,
            bearing axes, POSE, (n, joints).
        scenario: Contact scenario, radial and axial, (n, joints, 2).
        effort: Drives: ``effort`` [N m], ``reference`` and ``error`` [rad], both NaN without a reference,
            ``EFFORT``, (n, drives).
        audit: Energies and momenta, with the names and units of :class:`antenna_pin.dynamics.Audit`, AUDIT,
            (n,).
        done: Elements of further families, in order, ``DONE``, (n, elements).
        traced: Springs whose torque is reported, likewise.
        stretch: Springs between points: ``length`` [m], ``tension`` that draws the points together [N] and
            ``force`` on the second one's link, world axes [N], ``STRETCH``, (n, springs).
        applied: Points of application: ``force`` [N], and ``torque`` about the point [N m], in world axes,
            ``APPLIED``, (n, places).
        kept: Energies stored by forces, (n, forces) [J].
        closure: Force [N] and moment [N m] of each closure (n, closures, 2, 3), by
            :meth:`antenna_pin.dynamics.constraints.Constraints.wrenches`; the least ones if some are
            redundant.
        coupling: Force [N] or torque [N m] of each coupling on its follower, (n, couplings).
        residual: Largest of closures, couplings and motions, of positions [m] and angles [rad] and of their
            rates [m/s], [rad/s], (n, 4).
        failures: Descriptions of failed functions of the user's, by sample; their numbers are NaN.
    """

    acceleration: Array
    contact: NDArray[Any]
    pose: NDArray[Any]
    scenario: NDArray[np.int8]
    effort: NDArray[Any]
    audit: NDArray[Any]
    done: NDArray[Any]
    traced: NDArray[Any]
    stretch: NDArray[Any]
    applied: NDArray[Any]
    kept: Array
    closure: Array
    coupling: Array
    residual: Array
    failures: Mapping[int, FunctionError]

    @property
    def energy(self) -> Array:
        """All that is stored, (n,) [J]."""
        audit = self.audit
        total: Array = audit["kinetic"] + audit["contacts"] + audit["springs"] + audit["gravity"]
        return total


def observed(
    system: System, times: Array, states: Array, memories: NDArray[Any], programs: Sequence[Array]
) -> Observed:
    """Evaluate a system at samples.

    Args:
        system: The system.
        times: (n,) [s].
        states: [q, v, x] of each, (n, nq + nv + nx).
        memories: Contact memory of each, MEMORY, (n, contacts).
        programs: Force elements at each: the same array from one to the next where nothing was changed.
    """
    n, model, workspace = len(times), system.model, Workspace(system)
    whole = _whole(system, workspace)
    samples = sample_kernels.SampleArrays(np.ascontiguousarray(times, dtype=float), states, memories)
    sights = _unseen(workspace, n)
    failures: dict[int, FunctionError] = {}
    if workspace.python_paths or system.callables:
        for i in range(n):
            workspace.program[:] = programs[i]
            workspace.memory[:] = memories[i]
            try:
                workspace.measure(states[i])
                workspace.apply_elements(times[i], states[i], whole.rates)
                sample_kernels.observe(i, i + 1, True, samples, whole, sights)
                sights.audits[i]["contacts"] += energy_of_python_laws(workspace)
            except FunctionError as error:
                failures[i] = error
                _leave_out(sights, i)
    else:
        for first, last in program_parts(programs):
            workspace.program[:] = programs[first]
            i = sample_kernels.observe(first, last, False, samples, whole, sights)
            while i < last:
                failures[i] = workspace.failed_query()
                _leave_out(sights, i)
                i = sample_kernels.observe(i + 1, last, False, samples, whole, sights)
    others = [place for table in system.others for place in system.element_blocks[table].values()]
    traced = [system.spring_blocks[name] for name in system.traced]
    done, told = (_done(workspace, samples, programs, whole, blocks) for blocks in (others, traced))
    if workspace.constraints is None:
        free = system.mechanism.base == "free"
        accelerations, closure = _accelerations(model, states, sights.forces, free), np.zeros((n, 0, 2, 3))
        coupling, residual = np.zeros((n, 0)), np.zeros((n, 4))
    else:
        accelerations, closure, coupling, residual = held_samples(
            workspace, samples, whole, sights, programs, done, failures
        )
    return Observed(
        acceleration=accelerations,
        contact=sights.contacts,
        pose=sights.poses,
        scenario=sights.scenarios,
        effort=sights.efforts,
        audit=sights.audits,
        done=done,
        traced=told,
        stretch=sights.stretches,
        applied=sights.applied,
        kept=sights.kept,
        closure=closure,
        coupling=coupling,
        residual=residual,
        failures=failures,
    )


def _leave_out(sights: sample_kernels.Sights, i: int) -> None:
    """Write not-a-number for a sample at which something has no answer."""
    for part in sights:
        if part is not sights.scenarios:
            part[i : i + 1].view(np.float64)[:] = np.nan


def _whole(system: System, workspace: Workspace) -> sample_kernels.SystemArrays:
    """Return a system's arrays for evaluation."""
    tree = body_tree(system.mechanism)
    blocks = [system.clearance_blocks[joint.name] for joint in system.clearances]
    return sample_kernels.SystemArrays(
        program=workspace.program,
        work=workspace.work,
        table=workspace.table,
        rates=np.zeros(system.model.nv + system.manifold.nx),
        blocks=np.array(blocks, dtype=np.int64),
        drives=np.array(list(system.drive_blocks.values()), dtype=np.int64),
        tree=tree,
        gravity=np.array(system.model.gravity.linear),
        places=np.zeros(len(tree) + 1, PLACE),
        scratch=np.zeros(5, CONTACT),
    )


def _unseen(workspace: Workspace, n: int) -> sample_kernels.Sights:
    """Return arrays for the results at n samples."""
    system, constraints = workspace.system, workspace.constraints
    joints = len(system.clearances)
    return sample_kernels.Sights(
        forces=np.zeros((n, system.model.nv)),
        contacts=np.zeros((n, len(system.contact_names)), sample_kernels.SEEN),
        poses=np.zeros((n, joints), POSE),
        scenarios=np.zeros((n, joints, 2), np.int8),
        efforts=np.zeros((n, len(system.drives)), sample_kernels.EFFORT),
        audits=np.zeros(n, audit_kernels.AUDIT),
        stretches=np.zeros((n, len(system.point_springs)), point_kernels.STRETCH),
        applied=np.zeros((n, len(system.force_places)), link_kernels.APPLIED),
        kept=np.zeros((n, len(system.forces))),
        wrenches=np.zeros((n, 0 if constraints is None else len(constraints.applied))),
    )


def _done(
    workspace: Workspace,
    samples: sample_kernels.SampleArrays,
    programs: Sequence[Array],
    whole: sample_kernels.SystemArrays,
    blocks: Sequence[int],
) -> NDArray[Any]:
    """Return what elements do whose blocks stand at these places, ``DONE``, (n, elements)."""
    found = np.zeros((len(samples.times), len(blocks)), sample_kernels.DONE)
    if blocks:
        for first, last in program_parts(programs):
            workspace.program[:] = programs[first]
            sample_kernels.look_at_elements(first, last, samples, np.array(blocks), whole, found)
    return found


def _accelerations(model: Any, states: Array, forces: Array, free_base: bool) -> Array:
    """Turn generalized forces into the accelerations of a tree under them, in place, (n, nv)."""
    q, v = states[:, : model.nq], states[:, model.nq : model.nq + model.nv]
    if free_base:
        # Pinocchio's call for many samples works about the world's origin, and loses the square of the
        # distance of the mechanism; the place of its base makes no difference.
        q = q.copy()
        q[:, :3] = 0.0
    # A call for many samples takes half of the time, for a number that fits into the processor's cache;
    # Pinocchio without OpenMP does not have it.
    if hasattr(pin, "abaInParallel"):
        pool = pin.ModelPool(model, 1)
        columns = [np.zeros((array.shape[1], _AT_ONCE), order="F") for array in (q, v, forces)]
        for first in range(0, len(states), _AT_ONCE):
            part = slice(first, min(first + _AT_ONCE, len(states)))
            given = [column[:, : part.stop - first] for column in columns]
            for column, array in zip(given, (q, v, forces), strict=True):
                column[:] = array[part].T
            pin.abaInParallel(1, pool, *given, forces.T[:, part])
        return forces
    data = model.createData()
    for i, sample in enumerate(zip(q, v, forces, strict=True)):
        forces[i] = pin.aba(model, data, *sample)
    return forces


def joint_motion(
    system: System, states: Array, accelerations: Array, programs: Sequence[Array]
) -> tuple[list[str], Array]:
    """Return the joints that turn about an axis, and their motion; angles with whole turns.

    Not those of elastic parts, whose motion is a deflection (:func:`antenna_pin.dynamics.deflections`).

    Args:
        system: The system.
        states: (n, nq + nv + nx).
        accelerations: Generalized, (n, nv).
        programs: Force elements at each, as of :func:`observed`.

    Returns:
        Names, and angle, rate and acceleration of each, (joints, n, 3) [rad, rad/s, rad/s^2]. A ball joint
        has no axis.
    """
    nq, nv = system.model.nq, system.model.nv
    names, motions = [], []
    for slot in _between_links(system):
        motion = np.zeros((len(states), 3))
        block = system.clearance_blocks.get(slot.name, -1)
        if block >= 0 and slot.name in system.turn_x:
            for first, last in program_parts(programs):
                own = (one[first:last] for one in (states, accelerations, motion))
                sample_kernels.clearance_motion(programs[first], block, *own)
        elif block < 0 and slot.turns:
            motion[:, 0] = states[:, slot.q.start]
            if slot.kind == "continuous":
                turned = nq + nv + system.turn_x[slot.name]
                sample_kernels.turned_angles(states, slot.q.start, turned, motion[:, 0])
            motion[:, 1] = states[:, nq + slot.v.start]
            motion[:, 2] = accelerations[:, slot.v.start]
        else:
            continue
        names.append(slot.name)
        motions.append(motion)
    return names, np.array(motions).reshape(len(names), len(states), 3)


def _between_links(system: System) -> list[JointSlot]:
    """Return the joints of the tree but those of elastic parts."""
    return [slot for name, slot in system.mechanism.joints.items() if name not in system.elastic]


def sliding_motion(
    system: System, states: Array, observation: Observed, programs: Sequence[Array]
) -> tuple[list[str], Array]:
    """Return the sliding joints and their motion, without those of elastic parts.

    Args:
        system: The system.
        states: (n, nq + nv + nx).
        observation: Results of the equations of motion there.
        programs: Force elements at each, as of :func:`observed`.

    Returns:
        Names, and displacement, rate and acceleration of each, (joints, n, 3) [m, m/s, m/s^2]; with play
        those of the journal's centre along the bearing's axis, or its opposite with the bearing on the child.
    """
    guided = {joint.name: k for k, joint in enumerate(system.clearances) if joint.geometry.motion == "slide"}
    names, motions = [], []
    for slot in _between_links(system):
        v = states[:, system.model.nq :][:, slot.v]
        a = observation.acceleration[:, slot.v]
        if slot.name in guided:
            k = guided[slot.name]
            block = records_at(programs, system.clearance_blocks[slot.name], JOINT)
            pose, axes, centre = observation.pose[:, k], block["axes"], block["centre"]
            # In the child's own axes: the bearing's axis, the journal's centre, and its velocity relative to
            # the parent, or to the child with the bearing.
            if system.clearances[k].bearing_on == "child":
                sign, bearing = -1.0, axes[:, :, 2]
                centre = centre + _turned(axes, pose["centre"])
                velocity = _turned(axes, pose["velocity"])
            else:
                sign, bearing = 1.0, pose["rotation"][:, 2, :]
                velocity = v[:, :3] + np.cross(v[:, 3:], centre)
            at_centre = a[:, :3] + np.cross(a[:, 3:], centre) + np.cross(v[:, 3:], velocity)
            along = np.einsum("ij,ij->i", bearing, at_centre)
            motion = np.column_stack([sign * pose["centre"][:, 2], sign * pose["velocity"][:, 2], along])
        elif slot.slides:
            motion = np.column_stack([states[:, slot.q], v, a])
        else:
            continue
        names.append(slot.name)
        motions.append(motion)
    return names, np.array(motions).reshape(len(names), len(states), 3)


def _turned(axes: Array, vectors: Array) -> Array:
    """Return vectors in the axes of given rotations, bitwise independent of the batch."""
    return np.asarray(sum(axes[:, :, i] * vectors[:, i, np.newaxis] for i in range(3)))
