"""Generalized force of a system's elements near a state, and its derivatives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.base.arrays import Array
from antenna_pin.base.calculus import STEPS, gradient
from antenna_pin.base.records import CONTACT, POSE
from antenna_pin.dynamics import Adjustments, System, Workspace
from antenna_pin.dynamics import kernels as _program
from antenna_pin.dynamics.blocks import bearings_in
from antenna_pin.joints.kernels import unit_normal_force
from antenna_pin.joints.pose_kernels import place_journal

_Loads = Mapping[str, Array]

# Steps in a contact's depth, as shares of it: a force that starts like depth^1.5 is smooth on no other scale.
_SHARES = (0.02, 0.005)
# Step of velocities at a contact [m/s]: far below those that friction laws tell sticking from sliding by.
_SPEED = 1e-7
# Step of bristles [m]: their forces are linear in them, but for what leads them to their limits.
_BRISTLE = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class ForceDerivatives:
    """Derivatives of the generalized force of all elements, in velocity coordinates."""

    position: Array  # derivatives over the configuration, of joints and of contacts, (nv, nv)
    rate: Array  # derivatives over the velocity, (nv, nv)
    bristle: Array  # derivatives over the bristles of friction, (nv, bristles)
    # derivatives of the bristles' rates over configuration, velocity and bristles: (bristles, nv) twice,
    # (bristles, bristles)
    bristle_rates: tuple[Array, Array, Array]
    # ``position`` by source: ``joints`` (drives, springs at joints, contacts) and ``points`` (springs between
    # points)
    parts: dict[str, Array] = field(default_factory=dict)
    rough: tuple[str, ...] = ()  # names of joints with a kink of a force too near for a derivative


class Forces:
    """Force of a system's elements near a state: contacts, and all others separately.

    Contacts have scales of micrometres, all else those of the mechanism: each is differentiated with its own
    steps.

    Args:
        system: The system.
        time: Time of the state [s].
        y: The state [q, v, x].
        memory: Contact memory, with the closed contacts.
        loads: Forces on journals, constant in the bearing's axes, by joint, (3,) [N].
        adjusted: Numbers of drives and springs that events have changed: (place, value).
    """

    def __init__(
        self,
        system: System,
        time: float,
        y: Array,
        memory: NDArray[Any],
        loads: _Loads,
        adjusted: Sequence[tuple[str, float]] = (),
    ) -> None:
        self.system, self.time, self.loads = system, time, dict(loads)
        self._y = y.copy()
        self._rates = np.zeros(system.model.nv + system.manifold.nx)
        self._elements, self._contacts = Workspace(system), Workspace(system)
        for workspace in (self._elements, self._contacts):
            adjustments = Adjustments(system, workspace.program)
            for place, value in adjusted:
                adjustments.set(place, bool(value) if place.endswith(".on") else value)
        for block in (block for blocks in system.element_blocks.values() for block in blocks.values()):
            self._contacts.program[block : block + _program.PARAMETERS].view(_program.ELEMENT)["on"] = 0.0
        self._contacts.memory[:] = memory
        on_links = [system.spring_blocks[name] for name in system.point_springs]
        on_links += system.element_blocks.get("forces", {}).values()
        self._points = [
            self._elements.program[block : block + _program.PARAMETERS].view(_program.ELEMENT)
            for block in on_links
        ]
        self._points_on = [float(head["on"][0]) for head in self._points]

    @property
    def program(self) -> Array:
        """Program of the elements in the state."""
        return self._elements.program

    @property
    def memory(self) -> NDArray[Any]:
        """The contact memory."""
        return self._contacts.memory

    def displaced(self, step: Array, change: Array | None = None, bristles: Array | None = None) -> Array:
        """Return the state after a tangent step and a change of velocity."""
        nq, nv = self.system.model.nq, self.system.model.nv
        y = self._y.copy()
        y[:nq] = pin.integrate(self.system.model, self._y[:nq], step)
        if change is not None:
            y[nq : nq + nv] += change
        if bristles is not None:
            y[nq + nv + self.system.bristle_x] += bristles
        return y

    def elements(self, y: Array) -> Array:
        """Return the generalized force of drives and springs, (nv,)."""
        self._elements.apply_elements(self.time, y, self._rates)
        return np.array(self._elements.tau)

    def contacts(self, y: Array) -> tuple[Array, Array]:
        """Return the generalized force of contacts and loads, (nv,), and the rates of bristles."""
        self._contacts.apply_elements(self.time, y, self._rates)
        tau = np.array(self._contacts.tau)
        for joint, load in self.loads.items():
            tau += self.load_force(y, joint, load)
        return tau, np.array(self._rates[self.system.model.nv + self.system.bristle_x])

    def load_force(self, y: Array, joint: str, load: Array) -> Array:
        """Return the generalized force of a load on a journal, in bearing axes, (nv,)."""
        block = self.system.clearance_blocks[joint]
        pose, row = np.zeros(1, POSE), np.zeros(1, CONTACT)
        place_journal(self.system.program, block, y, self.system.model.nq, pose)
        row["normal"], row["point"] = load, pose["centre"]
        tau = np.zeros(self.system.model.nv)
        unit_normal_force(self.system.program, block, pose, row, 0, tau)
        return tau

    def whole(self) -> Array:
        """Return the generalized force of all elements in the state itself, (nv,)."""
        return np.asarray(self.elements(self._y) + self.contacts(self._y)[0])

    # --- derivatives ---

    def derivatives(self) -> ForceDerivatives:
        """Return the derivatives of all forces in the state."""
        nv, bristles = self.system.model.nv, len(self.system.bristle_x)
        zero = np.zeros(nv)
        rough: set[str] = set()
        position, rate = self._of_elements(rough)
        points = np.zeros((nv, nv))
        if self._points:
            self._switch_points(False)
            points = position - self._of_elements(set())[0]
            self._switch_points(True)
        of_bristles = np.zeros((bristles, nv)), np.zeros((bristles, nv))
        for joint in self.system.clearances:
            scale = self._contact_scale(joint.name)
            if scale is None:
                continue
            depth, lever = scale
            v = self.system.mechanism.joint(joint.name).v
            sizes = np.ones(v.stop - v.start)
            sizes[2 if joint.planar else 3 :] = 1.0 / lever
            ways = np.eye(nv)[:, v] * sizes
            for k, (look, steps) in enumerate(
                ((self._at, [share * depth for share in _SHARES]), (self._moving, [_SPEED]))
            ):
                own, kinks = gradient(look, ways, steps)
                (position, rate)[k][:, v] += own[:nv] / sizes
                of_bristles[k][:, v] += own[nv:] / sizes
                rough |= {joint.name} if kinks.any() else set()

        by_bristle, _ = gradient(
            lambda change: np.concatenate(self.contacts(self.displaced(zero, None, change))),
            np.eye(bristles),
            [_BRISTLE],
        )
        self._add_states(by_bristle, of_bristles)
        return ForceDerivatives(
            position=position,
            rate=rate,
            bristle=by_bristle[:nv],
            bristle_rates=(*of_bristles, by_bristle[nv:]),
            parts={"joints": position - points, "points": points},
            rough=tuple(sorted(rough)),
        )

    def _add_states(self, by_bristle: Array, of_bristles: tuple[Array, Array]) -> None:
        """Add unit rates and effects of the states of elements.

        At a joint at rest the slopes of both senses differ: their mean is taken.
        """
        nv, zero = self.system.model.nv, np.zeros(self.system.model.nv)
        own = [i for i, at in enumerate(self.system.bristle_x) if at in self.system.state_x]
        if not own:
            return
        every = np.eye(nv)
        ways = np.eye(len(self.system.bristle_x))[:, own]

        def evaluate(y: Array) -> Array:
            self._elements.apply_elements(self.time, y, self._rates)
            rates = self._rates[nv + self.system.bristle_x]
            return np.concatenate([self._elements.tau, rates])

        found, _ = gradient(lambda change: evaluate(self.displaced(zero, None, change)), ways, STEPS)
        by_bristle[:, own] = found
        at, _ = gradient(lambda step: evaluate(self.displaced(step)), every, STEPS)
        moving, _ = gradient(lambda change: evaluate(self.displaced(zero, change)), every, STEPS)
        for whole, part in zip(of_bristles, (at, moving), strict=True):
            whole[own] = part[nv:][own]

    def _at(self, step: Array) -> Array:
        return np.concatenate(self.contacts(self.displaced(step)))

    def _moving(self, change: Array) -> Array:
        return np.concatenate(self.contacts(self.displaced(np.zeros_like(change), change)))

    def _of_elements(self, rough: set[str]) -> tuple[Array, Array]:
        """Return the derivatives of drives and springs over configuration and velocity, (nv, nv) each."""
        every = np.eye(self.system.model.nv)
        names = self._names()
        place, bent = gradient(lambda step: self.elements(self.displaced(step)), every, STEPS)
        speed, kinked = gradient(
            lambda change: self.elements(self.displaced(np.zeros_like(change), change)), every, STEPS
        )
        for joint, depth, lever in self._fine():
            v = self.system.mechanism.joint(joint).v
            sizes = np.repeat([1.0, 1.0 / lever], 3)
            steps = [share * depth for share in _SHARES]
            look = (lambda step: self.elements(self.displaced(step)), every[:, v] * sizes, steps)
            place[:, v], bent[v] = gradient(*look)
            place[:, v] /= sizes
        rough |= {names[k] for k in np.flatnonzero(bent | kinked)}
        return place, speed

    def _fine(self) -> list[tuple[str, float, float]]:
        """Return joints on bearings with stiffness variable over small distances, and levers [m]."""
        found = []
        for _, _, one in bearings_in(self.system.families):
            if one.scale is not None:
                depth, lever = one.scale
                found.append((one.joint, depth, lever))
        return found

    def _switch_points(self, on: bool) -> None:
        for head, own in zip(self._points, self._points_on, strict=True):
            head["on"] = own if on else 0.0

    def _names(self) -> list[str]:
        """Return the joint of each velocity coordinate."""
        names = ["base"] * self.system.model.nv
        for name, slot in self.system.mechanism.joints.items():
            names[slot.v] = [name] * (slot.v.stop - slot.v.start)
        return names

    def _contact_scale(self, joint: str) -> tuple[float, float] | None:
        """Return least depth and lever of a joint's contacts [m]; None without contact."""
        table = np.zeros(self.system.rows, CONTACT)
        self._contacts.locate(self._y, table)
        rows = [
            row
            for row, name in enumerate(self.system.contact_names)
            if self.system.block_of_contact[row] == self.system.clearance_blocks[joint]
            and self.memory["touching"][row] != 0.0
        ]
        if not rows:
            return None
        depth = -table["gap"][rows]
        part = next(one for one in self.system.clearances if one.name == joint)
        lever = part.geometry.section_radius + abs(part.offset)
        lever += float(np.linalg.norm(table["point"][rows], axis=1).max())
        positive = depth[depth > 0.0]
        return (float(positive.min()) if len(positive) else 1e-9), lever
