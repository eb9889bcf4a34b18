"""What a run works on: buffers, the contact memory of the moment, Pinocchio's data and coal's objects."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from antenna_pin.dynamics import _inspect, _kernels
from antenna_pin.dynamics.hinge import constrained_acceleration
from antenna_pin.dynamics.system import System
from antenna_pin.joints import PythonPath
from antenna_pin.joints._kernels import unit_normal_force
from antenna_pin.joints._layout_kernels import JOINT, JOINT_WORDS
from antenna_pin.joints._pose_kernels import place_journal
from antenna_pin.records import CONTACT, MEMORY, POSE, memory_records, words_of

__all__ = ["Workspace"]

Array = NDArray[np.float64]

ON_SURFACE = 1e-15  # [m]: a starting gap this small is a gap of zero


class Workspace:
    """A place to evaluate a system's equations of motion; one for each run, for it is written to.

    As with Pinocchio's ``model, data`` two workspaces of one system do not see each other.

    Args:
        system: The system.
        memory: Contact memory, (contacts, 3); nothing touches if not given (see
            :func:`antenna_pin.dynamics.contact_memory`).

    Attributes:
        memory: The contact memory that the derivative uses, :data:`antenna_pin.records.MEMORY`, (contacts,);
            to be written to.
        table: Contact table of the last evaluation, :data:`antenna_pin.records.CONTACT`, (rows,).
        tau: Generalized force of the elements at the last evaluation, (nv,).
        paths: What happens in Python, of the joints of which anything does.
        program: The system's program, with the values of drives in Python of the last evaluation.
    """

    def __init__(self, system: System, memory: ArrayLike | None = None) -> None:
        """Allocate everything once."""
        self.system = system
        self.model = system.model
        self.manifold = system.manifold
        self.data = system.model.createData()
        self.program = system.program.copy()
        nv, contacts = self.model.nv, len(system.contact_names)
        first = nv + words_of(POSE)
        table = first + words_of(MEMORY) * contacts
        self._work = np.zeros(table + system.rows * words_of(CONTACT))
        self.tau = self._work[:nv]
        self._pose = self._work[nv:first].view(POSE)
        self.memory = self._work[first:table].view(MEMORY)
        self.table = self._work[table:].view(CONTACT)
        if memory is not None:
            self.memory[:] = memory_records(memory)
        self.paths: list[PythonPath] = []
        for joint in system.clearances:
            start = system.clearance_blocks[joint.name]
            head = self.program[start : start + JOINT_WORDS].view(JOINT)
            block = self.program[start : start + int(head["length"][0])]
            path = joint.python_path(block, self.memory, self.table, self.model.nq)
            if path is not None:
                self.paths.append(path)
        #: Those whose gaps are what a backend measures and nothing else.
        self.measured = [path for path in self.paths if path.measured]
        #: Whether each drive in Python is on at present.
        self._on = [
            self.program[block : block + _kernels.PARAMETERS].view(_kernels.ELEMENT)["on"]
            for block, _, _ in system.callables
        ]
        self._accelerate: Callable[[Array, Array, Array], Array] = (
            constrained_acceleration(system.mechanism, self.data, system.hinges)
            if system.hinges
            else partial(pin.aba, self.model, self.data)
        )

    @property
    def work(self) -> Array:
        """The array that ``tau``, a pose, ``memory`` and ``table`` are parts of, as the kernels take it."""
        return self._work

    def acceleration(self, q: Array, v: Array, tau: Array) -> Array:
        """Return the generalized acceleration under a generalized force, ideal hinges held, (nv,)."""
        return self._accelerate(q, v, tau)

    def locate(self, y: Array, table: NDArray[Any]) -> None:
        """Fill gap, normal, point, rate and slip of all contacts in a table, by what locates their changes.

        That is the closed form where there is one, coal's gaps being those; else it is the backend.
        """
        _inspect.contacts_in(y, self.program, self._pose, table)
        for path in self.measured:
            path.locate(y, table)

    def measure(self, y: Array) -> None:
        """Bring all rows of ``table`` up to date for a state: gap, normal, point, rates of every contact.

        The derivative itself updates the touching contacts only. Coal's gaps are asked for where it is the
        backend.
        """
        _inspect.contacts_in(y, self.program, self._pose, self.table)
        for path in self.paths:
            path.prepare(y, everything=True)

    def apply_elements(self, t: float, y: Array, rates: Array) -> None:
        """Evaluate the elements: ``tau``, the contacts' ``table``, and x rates behind rates[nv]."""
        for path in self.paths:
            path.prepare(y)
        for on, (block, slot, drive) in zip(self._on, self.system.callables, strict=True):
            if on[0] == 0.0:
                continue
            angle, rate, _, _ = _kernels.joint_motion(self.program, block, y, self.model.nq)
            self.program[slot] = drive.torque(t, angle, rate)
        _kernels.evaluate(t, y, self.program, self._work, rates)

    def bind(self, y: Array, rates: Array) -> Callable[[float], None]:
        """Return the derivative of a state held in an array, as a function of time alone.

        What an integrator calls: the arrays are looked at once, and no attribute is looked up (which would
        cost a tenth of an ABA).

        Args:
            y: State [q, v, x], contiguous; read at each call.
            rates: Output [acceleration (nv), rate of x (nx)], written at each call.
        """
        nq, nv = self.model.nq, self.model.nv
        q, v, out = y[:nq], y[nq : nq + nv], rates[:nv]
        program, work, tau = self.program, self._work, self.tau
        evaluate, model, data, aba = _kernels.evaluate, self.model, self.data, pin.aba
        if self.paths or self.system.callables or self.system.hinges:
            elements, acceleration = self.apply_elements, self._accelerate

            def general(t: float) -> None:
                elements(t, y, rates)
                out[:] = acceleration(q, v, tau)

            return general

        def fused(t: float) -> None:
            evaluate(t, y, program, work, rates)
            out[:] = aba(model, data, q, v, tau)

        return fused

    def derivative(self, t: float, y: Array, rates: Array) -> None:
        """Write [acceleration (nv), rate of x (nx)] at time t [s] and state y into rates."""
        self.bind(y, rates)(t)

    def first_memory(self, y: Array) -> NDArray[Any]:
        """Return the memory of a state without one (:func:`antenna_pin.dynamics.contact_memory`)."""
        table = np.zeros_like(self.table)
        self.locate(y, table)
        memory = np.zeros_like(self.memory)
        for c, floor in enumerate(self.system.approach_speed_floors):
            if table[c].gap <= ON_SURFACE:
                memory[c] = 1.0, max(float(table[c].rate), floor), self.effective_mass(y, c)
        return memory

    def effective_mass(self, y: Array, contact: int) -> float:
        """Return the mass that an impact along a contact's normal sees there and then [kg].

        With the normal's direction n in the space of generalized velocities, of the material points at the
        contact, it is ``(n^T M^-1 n)^-1``: the acceleration along n under a unit force gives it, constraints
        included.

        Args:
            y: State [q, v, x].
            contact: Number of the contact.
        """
        nq, nv = self.model.nq, self.model.nv
        pose, table = np.zeros(1, POSE), np.zeros_like(self.table)
        self.locate(y, table)
        block = self.system.block_of_contact[contact]
        place_journal(self.program, block, y, nq, pose)
        direction, rest = np.zeros(nv), np.zeros(nv)
        unit_normal_force(self.program, block, pose, table, contact, direction)
        free = np.array(self._accelerate(y[:nq], rest, rest))
        return float(1.0 / (direction @ (self._accelerate(y[:nq], rest, direction) - free)))
