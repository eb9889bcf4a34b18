"""A state in the middle of a run, as a function of the user's sees it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import PROGRAM, memory_numbers
from antenna_pin.dynamics import JointMotion, System, Workspace, kernels, reduced_inertia
from antenna_pin.engine.watch_kernels import WEIGHED
from antenna_pin.errors import UnknownNameError

__all__ = ["Moment"]

Array = NDArray[np.float64]


class Moment:
    """Time and state, and what follows from them; valid while the function that gets it runs.

    Arrays are copies.

    Args:
        workspace: What the run works on.

    Attributes:
        time: [s].
        system: The system.
    """

    def __init__(self, workspace: Workspace) -> None:
        """Make it once; ``set`` gives it its state."""
        self.time = 0.0
        self.system: System = workspace.system
        self._workspace = workspace
        self._nq, self._nv = workspace.model.nq, workspace.model.nv
        self._y = np.zeros(workspace.manifold.size)
        self._rates = np.zeros(self._nv + workspace.manifold.nx)
        self._motions: dict[str, JointMotion] = {}
        self._found: dict[str, tuple[float, float]] = {}  # at the present time and state
        self._loads: list[float] = []  # of the elements that hold, at the present time and state
        self._contacts: Mapping[str, int] = {name: c for c, name in enumerate(self.system.contact_names)}
        self._measured = self._evaluated = False

    def set(self, time: float, y: Array) -> Moment:
        """Bring it to another time and state; return it."""
        self.time = time
        self._y[:] = y
        self._found.clear()
        self._loads = []
        self._measured = self._evaluated = False
        return self

    def acts(self, block: int) -> bool:
        """Return whether the element at a place in the program is on."""
        return bool(self._workspace.program[block:][: kernels.PARAMETERS].view(kernels.ELEMENT)[0]["on"])

    def kink(self, block: int, number: int) -> float:
        """Return how far the effort of an element, by its place in the program, is past one of its kinks."""
        if block >= int(self._workspace.program[: kernels.HEADER].view(PROGRAM)["points"][0]):
            return self._workspace.kink_on_links(block, self.time, self._y)
        return float(kernels.element_kink(self._workspace.program, block, number, self.time, self._y))

    def load(self, hold: int) -> float:
        """Return the torque [N m] (force [N]) that an element carries that holds its joint, by its number."""
        if not self._loads:
            self._workspace.derivative(self.time, self._y, self._rates)
            self._evaluated, self._measured = True, False
            assert self._workspace.constraints is not None
            self._loads = self._workspace.constraints.loads().tolist()
        return float(self._loads[hold])

    def inertia(self, block: int) -> float:
        """Return the reduced inertia of the joint of an element, by its place in the program [kg m^2]."""
        return reduced_inertia(self._workspace, self.time, self._y, block)

    def switch(self, block: int, number: int, hold: int) -> tuple[float, float]:
        """Return a function of an element, by its place in the program, and its rate (0: not known)."""
        if hold == WEIGHED:
            load = self.inertia(block)
        else:
            load = self.load(hold) if hold >= 0 else 0.0
        return kernels.element_switch(self._workspace.program, block, number, self.time, self._y, load)

    @property
    def q(self) -> Array:
        """Configuration, (nq,)."""
        return self._y[: self._nq].copy()

    @property
    def v(self) -> Array:
        """Velocity, (nv,)."""
        return self._y[self._nq : self._nq + self._nv].copy()

    @property
    def x(self) -> Array:
        """Plain numbers: turned angles, integrals, bristles, (nx,)."""
        return self._y[self._nq + self._nv :].copy()

    @property
    def memory(self) -> Array:
        """Contact memory: touching, approach speed [m/s], effective mass [kg], (contacts, 3)."""
        return memory_numbers(self._workspace.memory)

    def angle(self, joint: str) -> float:
        """Return the angle of a joint, with its whole turns [rad]; of a sliding one its position [m]."""
        return self._motion(joint)[0]

    def rate(self, joint: str) -> float:
        """Return the rate of :meth:`angle` [rad/s] or [m/s]."""
        return self._motion(joint)[1]

    def _motion(self, joint: str) -> tuple[float, float]:
        found = self._found.get(joint)
        if found is None:
            if joint not in self._motions:
                self._motions[joint] = JointMotion(self.system, joint)
            self._found[joint] = found = self._motions[joint](self._y)
        return found

    def contact_number(self, contact: str) -> int:
        """Return the number of a contact.

        Raises:
            UnknownNameError: There is none of that name.
        """
        if contact not in self._contacts:
            raise UnknownNameError("event", "contact", contact, self._contacts)
        return self._contacts[contact]

    def gap(self, contact: str) -> float:
        """Return the distance of the surfaces at a contact, negative in contact [m]."""
        return self._measure(contact, "gap")

    def depth_rate(self, contact: str) -> float:
        """Return the rate of penetration at a contact, positive closing [m/s]."""
        return self._measure(contact, "rate")

    def _measure(self, contact: str, field: str) -> float:
        c = self.contact_number(contact)
        if not self._measured:
            self._workspace.measure(self._y)
            self._measured = True
        return float(self._workspace.table[field][c])

    def touching(self, contact: str) -> bool:
        """Return whether a contact touches."""
        return bool(self._workspace.memory["touching"][self.contact_number(contact)])

    def force(self, contact: str) -> float:
        """Return the normal force at a contact [N]; zero if it does not touch."""
        c = self.contact_number(contact)
        if not self._workspace.memory[c].touching:
            return 0.0
        if not self._evaluated:
            self._workspace.apply_elements(self.time, self._y, self._rates)
            self._evaluated, self._measured = True, False
        return max(0.0, float(self._workspace.table[c].force))
