"""The samples of a run, and what its system is there: where all variables of a result come from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import (
    Deflections,
    Observed,
    System,
    deflections,
    joint_motion,
    journal_attitudes,
    sliding_motion,
)
from antenna_pin.elements import Motor
from antenna_pin.simulation.loop import Run

__all__ = ["Seen"]

Array = NDArray[np.float64]

# Variables of the ledger, by the places in x where a system integrates them; what of it enters the balance.
_LEDGER = {
    "drive_work": "work_x",
    "drive_gross_work": "gross_work_x",
    "dissipation_normal": "lost_normal_x",
    "dissipation_friction": "lost_friction_x",
    "normal_impulse": "impulse_x",
    "dissipation_damper": "damper_x",
    "dissipation_elastic": "damper_x",
    "element_loss": "element_x",
}
# Of forces by what is integrated of them.
_OF_FORCES = {
    "force_work": "work",
    "force_gross_work": "gross_work",
    "force_loss": "loss",
    "force_impulse": "impulse",
    "force_angular_impulse": "angular_impulse",
    "force_central_impulse": "central_impulse",
}
_BALANCE = {
    "drive_work": -1.0,
    "dissipation_normal": 1.0,
    "dissipation_friction": 1.0,
    "dissipation_damper": 1.0,
    "dissipation_elastic": 1.0,
    "element_loss": 1.0,
    "force_work": -1.0,
    "force_loss": 1.0,
}


@dataclass(frozen=True, slots=True, eq=False)
class Edge:
    """What is needed of the samples before a block.

    Attributes:
        first: [q, v, x] of the run's first sample.
        stored: All that was stored then [J].
        state: [q, v, x] at this edge of the block.
        attitudes: Of the journals there, (joints, 4).
    """

    first: Array
    stored: float
    state: Array
    attitudes: Array


@dataclass(eq=False)
class Seen:
    """Samples of a run that follow one another, and what the system is there.

    Attributes:
        run: The run.
        times: (n,) [s].
        states: [q, v, x], (n, nq + nv + nx).
        memories: Contact memory, MEMORY, (n, contacts).
        programs: Program of force elements at each.
        found: What the equations of motion give.
        before: The end of the samples before these; None where these are the first.
    """

    run: Run
    times: Array
    states: Array
    memories: NDArray[Any]
    programs: Sequence[Array]
    found: Observed
    before: Edge | None = None

    @property
    def start(self) -> Edge:
        """The run's first sample; of a start that takes impulses with what was there before them."""
        if self.before is None:
            first, stored = self.states[0].copy(), float(self.found.energy[0])
            for x, loss in self.run.actions.modes.lost_at_start() if self.times[0] == 0.0 else ():
                first[x] -= loss
                stored += loss
            return self._edge(0, first, stored)
        return Edge(self.before.first, self.before.stored, self.before.first, np.zeros((0, 4)))

    @property
    def end(self) -> Edge:
        """The last of these."""
        return self._edge(-1, self.start.first, self.start.stored)

    def _edge(self, place: int, first: Array, stored: float) -> Edge:
        return Edge(first.copy(), stored, self.states[place].copy(), self.attitudes[place].copy())

    @cached_property
    def attitudes(self) -> Array:
        """Of the journals in their bearings, quaternions without jumps in sign, (n, joints, 4)."""
        before = None if self.before is None else (self.before.state, self.before.attitudes)
        return journal_attitudes(self.system, self.states, self.programs, before)

    @property
    def system(self) -> System:
        """The system."""
        return self.run.system

    @property
    def q(self) -> Array:
        """Configurations, (n, nq)."""
        return self.states[:, : self.system.model.nq]

    @property
    def v(self) -> Array:
        """Generalized velocities, (n, nv)."""
        nq = self.system.model.nq
        return self.states[:, nq : nq + self.system.model.nv]

    @cached_property
    def ledger(self) -> dict[str, Array]:
        """What the elements have integrated since the first sample: a run that goes on has its own ledger."""
        behind = self.system.model.nq + self.system.model.nv
        grown = self.states[:, behind:] - self.start.first[behind:]
        grown = np.column_stack([grown, np.zeros(len(grown))])  # the last for those that integrate nothing
        places = {name: getattr(self.system, place) for name, place in _LEDGER.items()}
        others = len(self.system.springs) - len(self.system.elastic)  # those of parts stand behind them
        places["dissipation_damper"] = places["dissipation_damper"][:others]
        places["dissipation_elastic"] = places["dissipation_elastic"][others:]
        places |= {name: self.system.force_x[of] for name, of in _OF_FORCES.items()}
        return {name: grown[:, columns] for name, columns in places.items()}

    @cached_property
    def joints(self) -> tuple[list[str], Array]:
        """Names and motion of the joints that turn."""
        return joint_motion(self.system, self.states, self.found.acceleration, self.programs)

    @cached_property
    def slides(self) -> tuple[list[str], Array]:
        """Names and motion of the joints that slide."""
        return sliding_motion(self.system, self.states, self.found, self.programs)

    @cached_property
    def elastic(self) -> Deflections:
        """Motion and energy of the elastic parts."""
        return deflections(self.system, self.states, self.found.acceleration, self.programs)

    @cached_property
    def spring_energy(self) -> Array:
        """Stored in springs but those of elastic parts, and in the cogging of motors, (n,) [J]."""
        cogs = any(isinstance(one, Motor) and one.cogging > 0.0 for one in self.system.drives.values())
        if len(self.system.springs) == len(self.system.elastic) and not cogs:
            return np.zeros(len(self.times))  # not the round-off of a difference
        others = self.elastic.energy.sum(axis=1) + self.found.kept.sum(axis=1)
        return np.asarray(self.found.audit["springs"] - others)

    def kept_momentum(self, name: str) -> Array:
        """Return what must stay of the ``linear`` or ``angular`` momentum: without what forces brought in."""
        impulse = self.ledger[{"linear": "force_impulse", "angular": "force_central_impulse"}[name]]
        return np.asarray(self.found.audit[name] - impulse.sum(axis=1))

    @cached_property
    def energy_error(self) -> Array:
        """Error of the energy balance [J]."""
        stored = self.found.energy
        error = stored - self.start.stored
        for happening in self.run.actions.happened:
            error[self.times >= happening.time] -= happening.energy
        for name, sign in _BALANCE.items():
            error += sign * self.ledger[name].sum(axis=1)
        return np.asarray(error)
