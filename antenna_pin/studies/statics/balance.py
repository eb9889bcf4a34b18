"""Forces out of balance of a mechanism at rest, and their tangent stiffness."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.base.records import CONTACT, POSE, words_of
from antenna_pin.compiled.decorators import in_python, record
from antenna_pin.contact.onset import NO_APPROACH
from antenna_pin.dynamics import Adjustments, JointMotion, Workspace, acting_in, first_modes, kernels
from antenna_pin.dynamics.coordinates import reach_of
from antenna_pin.elements import (
    Change,
    EndStop,
    MaxwellSlip,
    Met,
    Motion,
    Motor,
    PrescribedMotion,
    RigidStop,
    StickingFriction,
)
from antenna_pin.elements.sticking_friction import (
    BACKWARD,
    FORWARD,
    PULLED,
    PUSHED,
    STUCK,
    UNDECIDED,
)
from antenna_pin.errors import MechanismError
from antenna_pin.joints.kernels import unit_normal_force
from antenna_pin.joints.pose_kernels import place_journal
from antenna_pin.mechanism.inertia import mass_matrix
from antenna_pin.studies.statics.hysteresis import hysteretic_states
from antenna_pin.studies.statics.static_system import DRIVING, StaticSystem

Array = NDArray[np.float64]

# Steps that move a joint by no more than this are trusted [rad, or lengths of the mechanism]; the same of a
# journal in its play, over the clearance.
_TRUSTED, _TRUSTED_IN_PLAY = 0.2, 0.3
# Steps of differences, of what is trusted; in a contact over its depth.
_STEP, _STEP_IN_DEPTH = 1e-4, 0.02
# A direction that moves a journal by less, of what is trusted, does not move it.
_PURE = 1e-6
# Turn of a joint at once by which whole turns are counted [rad].
_TURNED = 1.0
# Below this, over the largest, a row or a singular value counts as zero.
_DEPENDENT = 1e-9
# Acceleration of the whole mass by a force that counts as none [m/s^2].
_NOTHING = 1e-6
# Rate far above those below which friction of gears is rounded off [rad/s].
_FAST = 1e9
# Anchor of a spring that slips, of one that is bent as far as it reaches [rad] ([m]).
_FAR = 1e9


class Free(NamedTuple):
    """Directions that constraints leave in a state.

    Steps of size 1 in any of them have the trusted length.
    """

    directions: Array  # N, (nv, k)
    steps: Array  # of differences, (k,)
    scale: Array  # S, of which S d is a step over what is trusted, (nv, nv)
    fine: NDArray[np.bool_]  # rows of S that are of journals in their play, (nv,)


class Balance:
    """Mechanism at rest with its forces out of balance and its history.

    Friction of joints acts by senses: 0 off, 1 or -1 in full against a motion up or down, None for a joint
    that sticks.

    Attributes:
        y: The last accepted state [q, v, x].
        senses: Senses of dry friction, by place.
        velocity: Direction in which contacts slip, (nv,); zero without friction of contacts.
        saturated: Whether slipping friction acts with its static limit.
    """

    def __init__(self, static: StaticSystem, y: Array, time: float) -> None:
        """Take a system in a state, with friction off."""
        self.static, self.system, self.time = static, static.system, time
        self.workspace = Workspace(self.system)
        self.model = self.system.model
        self._data = self.model.createData()
        self.program = self.workspace.program
        self.adjustments = Adjustments(self.system, self.program)
        for place, value in first_modes(self.system, y, time):
            self.adjustments.set(place, bool(value) if place.endswith(".on") else value)
        self._heads = {
            one.place: self.program[one.block : one.block + kernels.PARAMETERS].view(kernels.ELEMENT)
            for one in acting_in(self.system)
            if not isinstance(one.element, Motion)
        }
        self._rates = np.zeros(self.model.nv + self.system.manifold.nx)
        self.y = y.copy()
        own = list(acting_in(self.system))
        on = [one for one in own if getattr(self.adjustments.elements[one.place], "on", True)]
        self.frictions = {one.place: one for one in on if isinstance(one.element, StickingFriction)}
        self.slipping = {one.place: one for one in on if isinstance(one.element, MaxwellSlip)}
        self._stops = [one for one in on if isinstance(one.element, EndStop)]
        self.rigid = {one.place: one for one in on if isinstance(one.element, RigidStop)}
        self._motors = [one for one in on if isinstance(one.element, Motor) and one.element.inductance > 0.0]
        self.states = hysteretic_states(self.system)
        self.senses: dict[str, float | None] = {}
        self.saturated = False
        self.velocity = np.zeros(self.model.nv)
        length = 1.0 if self.system.plan is None else self.system.plan.length
        if self.system.plan is None:
            reaches = [float(np.linalg.norm(one.translation)) for one in list(self.model.jointPlacements)[1:]]
            length = max(reaches, default=1.0) or 1.0
        #: Force that counts as none [N].
        self.nothing = _NOTHING * (float(sum(one.mass for one in self.model.inertias)) or 1.0)
        self.reach = reach_of(self.system.mechanism, length)
        self.length = length
        self.play_motions = {
            place: (JointMotion(self.system, joint), self.system.mechanism.joint(joint).v, torque)
            for place, (joint, torque) in static.play_friction.items()
        }
        self._rows = self._rows_of_joints()
        for place in self.frictions:
            self.set_sense(place, 0.0)
        self.meshes = {
            one.place: one
            for one in on
            if not 1.0
            == getattr(one.element, "efficiency", 1.0)
            == getattr(one.element, "efficiency_back", 1.0)
        }
        for place in (*self.play_motions, *self.meshes):
            self.senses[place] = 0.0

    # --- what the mechanism remembers ---

    def set_sense(self, place: str, sense: float | None) -> None:
        """Set the sense of dry friction: 1, -1, 0 for off, None for sticking."""
        self.senses[place] = sense
        if place not in self.frictions:
            return
        one = self.frictions[place]
        if sense is None:
            angle = float(kernels.joint_motion(self.program, one.block, self.y, self.model.nq)[0])
            self.adjustments.change(place, Change(STUCK, memory={"where": angle}))
        elif sense == 0.0:
            self.adjustments.change(place, Change(UNDECIDED))
        elif self.saturated:
            self.adjustments.change(place, Change(PUSHED if sense > 0.0 else PULLED))
        else:
            self.adjustments.change(place, Change(FORWARD if sense > 0.0 else BACKWARD))

    def release(self) -> None:
        """Release sticking joints, until their senses are set again."""
        for place, sense in self.senses.items():
            if sense is None:
                self.adjustments.change(place, Change(UNDECIDED))

    def develop(self, senses: Mapping[str, float]) -> None:
        """Bring hysteretic states to their limits, as after a long displacement.

        Args:
            senses: Senses of the displacements, by joint.
        """
        elements = self.adjustments.elements
        for one in self.states:
            sense = senses.get(str(elements[one.place].acts_at), 0.0)
            if sense:
                self.y[one.x] = one.developed(sense)
        for place, acting in self.slipping.items():
            sense = senses.get(str(acting.element.acts_at), 0.0)
            if sense:
                element: Any = acting.element
                names = [f"anchor_{k}" for k in range(1, len(element.slip) + 1)]
                self.adjustments.change(place, Change(0, memory=dict.fromkeys(names, -sense * _FAR)))

    def drive_to(self, position: float) -> None:
        """Set the position of the driven joint [rad] ([m])."""
        layout = PrescribedMotion.layout()
        first = self.system.drive_blocks[DRIVING] + int(kernels.PARAMETERS)
        self.program[first : first + layout.itemsize // 8].view(layout)["position"] = position

    def accept(self, y: Array) -> None:
        """Make a state the present one; hysteresis continues from it."""
        for place, one in self.slipping.items():
            element = self.adjustments.elements[place]
            assert isinstance(element, MaxwellSlip)
            angle = float(kernels.joint_motion(self.program, one.block, y, self.model.nq)[0])
            reaches = zip(element.anchors, element.reaches, strict=True)
            memory = {
                f"anchor_{k}": angle - min(max(angle - anchor, -reach), reach)
                for k, (anchor, reach) in enumerate(reaches, 1)
            }
            self.adjustments.change(place, Change(0, memory=memory))
        self.y = y.copy()
        self.system.turn_on(self.y)

    def snapshot(self) -> tuple[Any, ...]:
        """Return a snapshot of the present state."""
        return self.adjustments.snapshot(), self.y.copy(), dict(self.senses), self.velocity.copy()

    def restore(self, snapshot: tuple[Any, ...]) -> None:
        """Restore a state."""
        adjustments, y, senses, velocity = snapshot
        self.adjustments.go_back(adjustments)
        self.y, self.senses, self.velocity = y.copy(), dict(senses), velocity.copy()

    # --- forces ---

    def forces(self, y: Array) -> Array:
        """Return forces out of balance, (nv,); writes states to y.

        Under constraints they are those that accelerate: no force of constraint is in them along the
        directions that are free.
        """
        tau = self.applied(y)
        q = y[: self.model.nq]
        weight = np.array(pin.computeGeneralizedGravity(self.model, self._data, q))
        constraints = self.workspace.constraints
        if constraints is None:
            return np.asarray(tau - weight)
        constraints.accelerate(self.time, y, self.program, tau, self._rates)
        acceleration = self._rates[: self.model.nv]
        if not np.isfinite(acceleration).all():
            names = ", ".join(self.static.place(one) for one in self.frictions) or "none"
            raise MechanismError(
                f"statics: friction under load must have a solution, got none: the joint jams ({names}); "
                "lower its coefficient, or move the joint the other way"
            )
        return np.asarray(mass_matrix(self.model, self._data, q) @ acceleration)

    def sizes(self, y: Array) -> Array:
        """Return the sum of the sizes of all forces of the last evaluation, (nv,)."""
        size = np.abs(np.array(pin.computeGeneralizedGravity(self.model, self._data, y[: self.model.nq])))
        constraints = self.workspace.constraints
        if constraints is not None:
            size += np.abs(constraints.jacobian).T @ np.abs(constraints.force)
        for joint in self.system.clearances:
            v = self.system.mechanism.joint(joint.name).v
            whole = float(np.abs(self.workspace.table["force"][self._rows[joint.name]]).sum())
            ways = 2 if joint.planar else 3
            size[v.start : v.start + ways] += whole
            size[v.start + ways : v.stop] += whole * (
                joint.geometry.half_length or joint.geometry.section_radius
            )
        with self.alone() as (heads, on):
            rest = self.exerted(y)
            for place, head in heads.items():
                if on[place]:
                    head["on"] = on[place]
                    size += np.abs(self.exerted(y) - rest)
                    head["on"] = 0.0
        return np.asarray(size)

    @contextmanager
    def alone(self) -> Iterator[tuple[dict[str, Any], dict[str, float]]]:
        """Switch all elements off; yield their heads and whether they were on."""
        on = {place: float(head["on"][0]) for place, head in self._heads.items()}
        for head in self._heads.values():
            head["on"] = 0.0
        try:
            yield self._heads, on
        finally:
            for place, head in self._heads.items():
                head["on"] = on[place]

    def exerted(self, y: Array) -> Array:
        """Return the generalized force of the elements that are on, and of contacts, (nv,)."""
        self.workspace.apply_elements(self.time, y, self._rates)
        return np.array(self.workspace.tau)

    def applied(self, y: Array) -> Array:
        """Return the generalized force of all elements and of friction of contacts, (nv,)."""
        self._prepare(y)
        self.workspace.apply_elements(self.time, y, self._rates)
        tau = np.array(self.workspace.tau)
        if self.static.contact_friction and self.velocity.any():
            tau += self.contact_friction(y)
        if self.meshes:
            tau += self.mesh_friction(y)
        return np.asarray(tau + self.play_friction(y))

    def mesh_friction(self, y: Array, place: str | None = None) -> Array:
        """Return the generalized force of friction in gears on their inputs, by their senses, (nv,)."""
        tau = np.zeros(self.model.nv)
        nq = self.model.nq
        spare = np.zeros(len(self._rates))
        for own, one in self.meshes.items():
            sense = self.senses[own]
            if not sense or place not in (None, own):
                continue
            element: Any = one.element
            partner = int(record(self.program[one.block :][: kernels.PARAMETERS], kernels.ELEMENT).partner)
            angle = kernels.own_motion(self.program, one.block, y, nq)[0]
            other = kernels.own_motion(self.program, one.block + partner, y, nq)[0]
            seen = (float(angle), 0.0, float(other), 0.0)
            torque, _ = kernels.efforts_between(self.program, one.block, self.time, seen, spare, 0)
            at = one.block + int(kernels.PARAMETERS)
            mesh = record(self.program[at : at + words_of(element.layout())], element.layout())
            drag = in_python(element.hook("drag"))(mesh, torque, sense * _FAST)
            motion = JointMotion(self.system, element.input)
            v = self.system.mechanism.joint(element.input).v
            tau += float(drag) * self.slope(motion, v, y)
        return tau

    def _prepare(self, y: Array) -> None:
        workspace, nq = self.workspace, self.model.nq
        if self.system.rows:
            workspace.locate(y, workspace.table)
            touching = workspace.table["gap"][: len(workspace.memory)] <= 0.0
            workspace.memory["touching"] = touching
            workspace.memory["approach_speed"] = self.system.approach_speed_floors
            workspace.memory["effective_mass"] = 1.0
        for state in self.states:
            before = float(kernels.joint_motion(self.program, state.block, self.y, nq)[0])
            after = float(kernels.joint_motion(self.program, state.block, y, nq)[0])
            y[state.x] = state.advanced(float(self.y[state.x]), after - before)
        for one in self._stops:
            element: Any = one.element
            layout = element.layout()
            first = one.block + int(kernels.PARAMETERS)
            words = self.program[first : first + words_of(layout)].view(layout)
            angle = float(kernels.joint_motion(self.program, one.block, y, nq)[0])
            words["mode"], words["approach"] = element.side_at(angle, 0.0), NO_APPROACH
        for one in self._motors:
            self._set_current(one, y)

    def _set_current(self, one: Any, y: Array) -> None:
        """Write the current of a winding at rest, U / R."""
        motor = one.element
        head = self.program[one.block : one.block + kernels.PARAMETERS].view(kernels.ELEMENT)[0]
        limit = math.inf if motor.voltage_limit is None else motor.voltage_limit
        voltage = min(max(motor.value, -limit), limit)
        most = math.inf if motor.current_limit is None else motor.current_limit
        at = self.model.nq + self.model.nv + int(head["x"]) + len(motor.integrals) - 1
        y[at] = min(max(voltage / motor.resistance, -most), most)

    def contact_friction(self, y: Array, joint: str | None = None) -> Array:
        """Return the generalized force of friction in contacts against the velocity, (nv,).

        Args:
            y: State whose contacts were evaluated last.
            joint: Of one joint only; None for all.
        """
        nq, nv = self.model.nq, self.model.nv
        tau = np.zeros(nv)
        force = self.workspace.table["force"].copy()
        moving = y.copy()
        moving[nq : nq + nv] = self.velocity
        table = np.zeros(self.system.rows, CONTACT)
        self.workspace.locate(moving, table)
        for name, coefficient in self.static.contact_friction.items():
            if joint not in (None, name):
                continue
            for row in self._rows[name]:
                slip = table["slip"][row]
                speed = float(np.linalg.norm(slip))
                if force[row] <= 0.0 or speed == 0.0:
                    continue
                own = -coefficient * force[row] / speed * slip
                tau += self._on_journal(y, name, own, table["point"][row])
        return tau

    def play_friction(self, y: Array, place: str | None = None) -> Array:
        """Return the generalized force of dry friction at joints with play, (nv,)."""
        tau = np.zeros(self.model.nv)
        for own, (motion, v, torque) in self.play_motions.items():
            sense = self.senses[own]
            if sense and place in (None, own):
                tau[v] -= sense * torque * self.slope(motion, v, y)[v]
        return tau

    def slope(self, motion: JointMotion, v: slice, y: Array) -> Array:
        """Return the derivative of a joint's position along generalized directions, (nv,)."""
        found = np.zeros(self.model.nv)
        for k in range(v.start, v.stop):
            moving = y.copy()
            moving[self.model.nq + k] = 1.0
            found[k] = motion(moving)[1]
        return found

    def _on_journal(self, y: Array, joint: str, force: Array, point: Array) -> Array:
        """Return the generalized force of a force on a journal, in bearing axes, (nv,)."""
        block = self.system.clearance_blocks[joint]
        pose, row = np.zeros(1, POSE), np.zeros(1, CONTACT)
        place_journal(self.program, block, y, self.model.nq, pose)
        row["normal"], row["point"] = force, point
        tau = np.zeros(self.model.nv)
        unit_normal_force(self.program, block, pose, row, 0, tau)
        return tau

    def _rows_of_joints(self) -> dict[str, list[int]]:
        blocks = {block: name for name, block in self.system.clearance_blocks.items()}
        rows: dict[str, list[int]] = {one.name: [] for one in self.system.clearances}
        for row, block in enumerate(self.system.block_of_contact):
            rows[blocks[block]].append(row)
        return rows

    # --- what is free ---

    def move(self, y: Array, step: Array) -> None:
        """Move a state by a tangent step of any length, (nv,), in place, turns counted."""
        parts = max(1, math.ceil(float(np.abs(step / self.reach).max(initial=0.0)) / _TURNED))
        for _ in range(parts):
            self.workspace.retract(y, step / parts)
            self.system.turn_on(y)

    def displaced(self, y: Array, step: Array) -> Array:
        """Return a state moved by a tangent step, (nv,), turns counted, constraints held.

        Raises:
            MechanismError: Loops cannot be closed there.
        """
        moved = y.copy()
        self.move(moved, step)
        return self.projected(moved)

    def projected(self, y: Array) -> Array:
        """Bring a state onto the constraints, in place, and return it."""
        constraints = self.workspace.constraints
        if constraints is not None:
            self.workspace.prepare_motions(self.time, y)
            nq, nv = self.model.nq, self.model.nv
            if not constraints.project(self.time, y, self.program, self.workspace.retract):
                raise NotClosedError("statics: loops must stay closed along the travel, got none that closes")
            y[nq : nq + nv] = 0.0
        return y

    def rows(self, y: Array, *, driven: bool = True) -> Array:
        """Return the active constraint rows of a state, a free base included, (rows, nv)."""
        rows = [np.zeros((0, self.model.nv))]
        constraints = self.workspace.constraints
        if constraints is not None:
            constraints.residuals(self.time, y, self.program)
            every = constraints.every_row.copy()
            motions = list(constraints.plan.motions)
            if not driven and DRIVING in motions:
                every = np.delete(every, motions.index(DRIVING), axis=0)
            moved = np.linalg.norm(every * self.reach, axis=1)
            rows.append(every[moved > _DEPENDENT * self.length])
        if self.system.mechanism.base == "free":
            rows.append(np.eye(self.model.nv)[self.system.mechanism.base_v])
        return np.vstack(rows)

    def free(self, y: Array) -> Free:
        """Return the directions that are free in a state, journals' apart from all others."""
        scale, fine, depths = self._scale(y)
        inverse = np.linalg.inv(scale)
        rows = self.rows(y) @ inverse
        lengths = np.linalg.norm(rows, axis=1)
        rows = rows[lengths > 0.0] / lengths[lengths > 0.0, None]
        if len(rows):
            _, values, right = np.linalg.svd(rows)
            basis = right[int(np.count_nonzero(values > _DEPENDENT)) :].T
        else:
            basis = np.eye(self.model.nv)
        steps = np.full(basis.shape[1], _STEP)
        if fine.any() and basis.shape[1]:
            _, _, turned = np.linalg.svd(basis[fine])
            basis = basis @ turned.T
            for k, column in enumerate(basis.T):
                moved = np.abs(column[fine])
                if moved.max() > _PURE:
                    steps[k] = min(_STEP, _STEP_IN_DEPTH * float((depths / np.maximum(moved, _PURE)).min()))
        return Free(inverse @ basis, steps, scale, fine)

    def in_play(self, free: Free, k: int) -> bool:
        """Return whether a free direction mainly moves journals in their play."""
        moved = np.abs(free.scale @ free.directions[:, k])
        return bool(moved[free.fine].max(initial=0.0) > moved[~free.fine].max(initial=0.0))

    def scale(self, y: Array) -> Array:
        """Return S, which gives a step d in trusted lengths, S d, (nv, nv)."""
        return self._scale(y)[0]

    def _scale(self, y: Array) -> tuple[Array, NDArray[np.bool_], Array]:
        """Return S, its rows of journals in their play, and their relative depths.

        S d is a step d in trusted lengths.
        """
        nv = self.model.nv
        scale = np.diag(1.0 / (_TRUSTED * self.reach))
        fine = np.zeros(nv, dtype=bool)
        depths = np.full(nv, np.inf)
        for joint in self.system.clearances:
            v = self.system.mechanism.joint(joint.name).v
            geometry = joint.geometry
            plays = [geometry.radial_clearance, joint.axial_clearance or 0.0]
            least = min((one for one in plays if one > 0.0), default=0.01 * max(joint.depth_limits))
            trusted = _TRUSTED_IN_PLAY * least
            lever = geometry.half_length or geometry.section_radius
            depth = self._depth(y, joint.name)
            share = 1.0 if depth is None else depth / trusted
            ways = 2 if joint.planar else 3
            turned = np.eye(v.stop - v.start)
            small = np.zeros(v.stop - v.start, dtype=bool)
            small[:ways] = True
            sizes = np.full(v.stop - v.start, _TRUSTED)
            sizes[:ways] = trusted
            if not joint.planar:
                axes = np.array(self._axes(joint.name))
                turned[:3, :3] = turned[3:, 3:] = axes.T
                if geometry.motion == "slide":
                    small[2], sizes[2] = False, _TRUSTED * self.length
                    small[3:], sizes[3:] = True, trusted / lever
                elif geometry.motion == "turn":
                    small[3:5], sizes[3:5] = True, trusted / lever
            scale[v, v] = turned / sizes[:, None]
            fine[v] = small
            depths[v] = share
        for name in self.system.on_bearings:
            v = self.system.mechanism.joint(name).v
            fine[v.start : v.stop] = False
        return scale, fine, depths[fine]

    def _axes(self, joint: str) -> Array:
        from antenna_pin.joints.layout_kernels import JOINT, JOINT_WORDS

        start = self.system.clearance_blocks[joint]
        return np.asarray(self.program[start : start + JOINT_WORDS].view(JOINT)["axes"][0])

    def _depth(self, y: Array, joint: str) -> float | None:
        """Return the least depth of a joint's contacts [m]; None without contact."""
        table = np.zeros(self.system.rows, CONTACT)
        self.workspace.locate(y, table)
        gaps = table["gap"][self._rows[joint]]
        return float(-gaps[gaps < 0.0].max()) if (gaps < 0.0).any() else None

    def stiffness(self, y: Array, free: Free) -> Array:
        """Return minus the derivative of the forces along free directions, (nv, k)."""
        return (
            -np.array(
                [self.along(y, way, step) for way, step in zip(free.directions.T, free.steps, strict=True)]
            )
            .reshape(free.directions.shape[1], self.model.nv)
            .T
        )

    def along(self, y: Array, way: Array, step: float) -> Array:
        """Return the derivative of the forces along a direction by central differences, (nv,)."""
        ahead = self.forces(self.displaced(y, step * way))
        behind = self.forces(self.displaced(y, -step * way))
        return (ahead - behind) / (2.0 * step)

    def met(self, acting: Any, y: Array) -> Met:
        """Return the motion of an element's joint in a state."""
        angle = float(kernels.joint_motion(self.program, acting.block, y, self.model.nq)[0])
        return Met(self.time, angle, 0.0, 0.0)

    def load(self, place: str) -> float:
        """Return the load of a holding element by the last forces [N*m] ([N])."""
        constraints = self.workspace.constraints
        assert constraints is not None and self.system.plan is not None
        return float(constraints.loads()[self.system.plan.holds.index(place)])


class NotClosedError(MechanismError):
    """Loops that cannot be closed in a pose."""
