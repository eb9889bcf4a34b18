"""What elements with modes did at an instant of a run, done again to the state of a neighbour."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Workspace, acting_in, impulse, kernels
from antenna_pin.elements import Met
from antenna_pin.nonlinear.kept import Kept
from antenna_pin.nonlinear.numbers import InPlace
from antenna_pin.simulation.passages import Blow, Turned

__all__ = ["Replay"]

Array = NDArray[np.float64]


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
        self._blocks = {one.place: one.block for one in acting_in(workspace.system)}
        self._own: Mapping[str, list[int]] = {
            place: [k for k, one in enumerate(kept.numbers) if one.place == place] for place in self._blocks
        }

    def __call__(
        self, done: tuple[Turned | Blow, ...], time: float, y: Array, numbers: Array
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
        try:
            for one in done:
                if isinstance(one, Blow):
                    program[:] = one.program
                    if self._numbers is not None:
                        program += self._numbers.present @ self._numbers.program
                    rate = kernels.joint_motion(program, one.block, state, nq)[1]
                    wanted = {} if one.restitution is None else {one.place: -self._back(one) * float(rate)}
                    state[nq : nq + nv] = impulse(self._workspace, time, state, wanted)[0]
                else:
                    self._turn(one, time, state, numbers)
        finally:
            program[:] = present
        return state[nq : nq + nv], numbers

    def _back(self, one: Blow) -> float:
        """Return the restitution of a blow, in a neighbour by its own number."""
        assert one.restitution is not None
        place = next(place for place, block in self._blocks.items() if block == one.block)
        return one.restitution + self._displaced(place).get("restitution", 0.0)

    def _displaced(self, place: str) -> Mapping[str, float]:
        """Return by how much a neighbour's numbers of an element differ."""
        return {} if self._numbers is None else self._numbers.of_element(place)

    def _turn(self, one: Turned, time: float, state: Array, numbers: Array) -> None:
        """Let an element keep what it keeps of a change, in place."""
        own, nq = self._own[one.place], self._workspace.model.nq
        if not own:
            return
        angle, rate, *_ = kernels.joint_motion(self._workspace.program, self._blocks[one.place], state, nq)
        before: dict[str, Any] = {
            name: getattr(one.before, name) + change for name, change in self._displaced(one.place).items()
        }
        before |= {self._kept.numbers[k].name: float(numbers[k]) for k in own}
        met = Met(time, float(angle), float(rate), 0.0, (0.0,) * len(one.before.integrals))
        change = one.change(dataclasses.replace(one.before, **before), met)
        memory = {} if change is None else change.memory
        for k in own:
            numbers[k] = memory.get(self._kept.numbers[k].name, numbers[k])
