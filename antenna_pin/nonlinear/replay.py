"""What elements with modes did at an instant of a run, done again to the state of a neighbour."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Workspace, acting_in, impulse, kernels, reduced_inertia
from antenna_pin.elements import Met
from antenna_pin.nonlinear.kept import Kept
from antenna_pin.nonlinear.numbers import InPlace
from antenna_pin.simulation.element_events import ImpulseEffect, ModeEffect, StruckElement

__all__ = ["Meeting", "Replay"]

Array = NDArray[np.float64]


class Meeting(NamedTuple):
    """How an element met its joint, and what a blow there has done.

    Attributes:
        place: Of the element.
        angle: Of the joint [rad] ([m]).
        rate: Before it [rad/s] ([m/s]), ``rate_after`` it.
        rate_after: See there.
        loss: Energy lost in it [J].
        impulse: On the child [N m s] ([N s]).
        energy: Of the joint's own motion before, of elements that weigh it, else 0 [J].
    """

    place: str
    angle: float
    rate: float
    rate_after: float
    loss: float = 0.0
    impulse: float = 0.0
    energy: float = 0.0


class Replay:
    """Does to states what elements did, in the same order: impulses, and what elements keep of the instant.

    What is decided stays as it was decided in the run: of that a neighbour has no choice.

    Args:
        workspace: The system's.
        kept: What its elements keep.
        numbers: The system's, if parameters displace them.
    """

    def __init__(self, workspace: Workspace, kept: Kept, numbers: InPlace | None = None) -> None:
        """Find the elements."""
        self._workspace, self._kept, self._numbers = workspace, kept, numbers
        self._holds = [one.name for one in workspace.system.holds]
        #: Of each element that met its joint in the last call, in order: what :class:`Meeting` tells.
        self.met: list[Meeting] = []
        self._blocks = {one.place: one.block for one in acting_in(workspace.system)}
        self._own: Mapping[str, list[int]] = {
            place: [k for k, one in enumerate(kept.numbers) if one.place == place] for place in self._blocks
        }

    def __call__(
        self, done: tuple[ModeEffect | ImpulseEffect, ...], time: float, y: Array, numbers: Array
    ) -> tuple[Array, Array]:
        """Return velocity, (nv,), and what elements keep, (kept,), behind what was done.

        Args:
            done: In order.
            time: When [s].
            y: State before.
            numbers: What elements kept before.
        """
        nq, nv = self._workspace.model.nq, self._workspace.model.nv
        state, numbers, program = y.copy(), numbers.copy(), self._workspace.program
        present = program.copy()
        self.met.clear()
        try:
            for one in done:
                if isinstance(one, ImpulseEffect):
                    program[:] = one.program
                    if self._numbers is not None:
                        program += self._numbers.present @ self._numbers.program
                    self._strike(one, time, state)
                else:
                    self._turn(one, time, state, numbers)
        finally:
            program[:] = present
        return state[nq : nq + nv], numbers

    def _strike(self, blow: ImpulseEffect, time: float, state: Array) -> None:
        """Make impulses, and note what they do to the elements that they are of."""
        nq, nv = self._workspace.model.nq, self._workspace.model.nv

        def rates() -> list[float]:
            program = self._workspace.program
            return [float(kernels.joint_motion(program, one.block, state, nq)[1]) for one in blow.struck]

        before = rates()
        wanted = {
            one.at: -self._back(one) * rate
            for one, rate in zip(blow.struck, before, strict=True)
            if one.restitution is not None
        }
        after, held, own = impulse(self._workspace, time, state, wanted)
        state[nq : nq + nv] = after
        bounced = dict(zip(wanted, own.tolist(), strict=True))
        for one, rate, next_rate in zip(blow.struck, before, rates(), strict=True):
            size = bounced[one.at] if one.at in bounced else float(held[self._holds.index(one.element)])
            k = max(k for k, met in enumerate(self.met) if met.place == one.element)
            loss = -0.5 * size * (rate + next_rate)
            self.met[k] = self.met[k]._replace(rate_after=next_rate, loss=loss, impulse=size)

    def _back(self, one: StruckElement) -> float:
        """Return the restitution of a blow, in a neighbour by its own number."""
        assert one.restitution is not None
        return one.restitution + self._displaced(one.element).get("restitution", 0.0)

    def _displaced(self, place: str) -> Mapping[str, float]:
        """Return by how much a neighbour's numbers of an element differ."""
        return {} if self._numbers is None else self._numbers.of_element(place)

    def _turn(self, one: ModeEffect, time: float, state: Array, numbers: Array) -> None:
        """Let an element keep what it keeps of a change, in place."""
        own, nq = self._own[one.place], self._workspace.model.nq
        angle, rate, *_ = kernels.joint_motion(self._workspace.program, self._blocks[one.place], state, nq)
        inertia = (
            reduced_inertia(self._workspace, time, state, self._blocks[one.place])
            if one.before.weighs
            else 0.0
        )
        energy = 0.5 * inertia * float(rate) ** 2
        self.met.append(Meeting(one.place, float(angle), float(rate), float(rate), energy=energy))
        if not own:
            return
        before: dict[str, Any] = {
            name: getattr(one.before, name) + change for name, change in self._displaced(one.place).items()
        }
        before |= {self._kept.numbers[k].name: float(numbers[k]) for k in own}
        met = Met(time, float(angle), float(rate), 0.0, (0.0,) * len(one.before.integrals))
        change = one.change(dataclasses.replace(one.before, **before), met)
        memory = {} if change is None else change.memory
        for k in own:
            numbers[k] = memory.get(self._kept.numbers[k].name, numbers[k])
