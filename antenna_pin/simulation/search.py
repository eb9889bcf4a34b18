"""What is looked for at the contacts of a run's steps, in numbers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Workspace, inspect_kernels, peak_kernels, trial_kernels
from antenna_pin.engine import CompiledStepper
from antenna_pin.simulation.episodes import Episodes

__all__ = ["ContactSearch"]

Array = NDArray[np.float64]


class ContactSearch:
    """Looks at the contacts inside trial steps.

    Args:
        workspace: What the run works on.
        stepper: Whose steps.
        episodes: The contacts' record.

    Attributes:
        ignore: Of each contact, how often it has changed at this very instant, (contacts,).
        limits: Depths at which a run ends, (contacts,) [m].
        trial: The trial step as it is looked at.
        compared: Contacts whose gaps coal measures, as 1, (contacts,); nobody's: (0,).
        difference: Largest difference so far of such a gap and the closed form, (1,) [m].
    """

    def __init__(self, workspace: Workspace, stepper: CompiledStepper, episodes: Episodes) -> None:
        """Allocate once."""
        self.system = system = workspace.system
        self._workspace = workspace
        self._stepper = stepper
        contacts = len(system.contact_names)
        manifold, numbers = system.manifold, stepper.numbers
        self.ignore = np.zeros(contacts, dtype=np.int64)
        self.table = numbers.table
        self.nodes = np.zeros((inspect_kernels.NODE_SIZE, peak_kernels.NODES + 1, contacts))
        self.limits = np.array([limit for j in system.clearances for limit in j.depth_limits])
        self.reasons = [reason for j in system.clearances for reason in j.limit_reasons]
        self.tolerances = episodes.book.places["tolerance"].tolist()
        of_coal = [int(j.backend == "coal") for j in system.clearances for _ in j.contact_names]
        self.compared = np.array(of_coal if any(of_coal) else [], dtype=np.int64)
        self.difference = np.zeros(1)
        factors = [system.mechanism.joint(j.name).joint_id - 1 for j in system.clearances]
        self.trial = trial_kernels.Trial(
            layout=manifold.part(factors),
            dense=stepper.dense,
            work=stepper.work,
            start=stepper.start_row,
            program=workspace.program,
            memory=workspace.memory,
            out=np.zeros((2, manifold.size)),
            pose=numbers.pose,
            table=numbers.table,
            own=numbers.own,
            rates=np.zeros(manifold.nv + manifold.nx),
            outside=numbers.outside,
        )

    @property
    def gap_difference(self) -> float:
        """Largest difference so far between coal's gaps and the closed form, of contacts that touch [m]."""
        return float(self.difference[0])

    @gap_difference.setter
    def gap_difference(self, difference: float) -> None:
        self.difference[0] = difference

    def measure(self, y: Array) -> None:
        """Fill the search's own contact table for a state, by what locates changes of contact."""
        self._workspace.locate(y, self.table)

    def words(self, c: int) -> str:
        """Return how deep a contact is at the present state, and how deep it may be."""
        self.measure(self._stepper.start)
        depth, limit = -float(self.table[c].gap), self.limits[c]
        name = self.system.contact_names[c]
        return f"contact {name} ({depth:.3g} m, limit {limit:.3g} m: {self.reasons[c]})"
