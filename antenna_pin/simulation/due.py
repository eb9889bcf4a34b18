"""Functions of elements that pass at one instant: those that the search has located, and others by logic.

A function that is zero but for round-off passes where its rate is negative, or, if that is zero too, by the
next derivative; one of a load passes where it is negative.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Adjustments, Workspace, kernels
from antenna_pin.dynamics.acting import Acting
from antenna_pin.elements import Change, Met, Modal
from antenna_pin.simulation.moment import Moment
from antenna_pin.simulation.own_actions import GRAZE, Switch
from antenna_pin.simulation.switches import hold_of

__all__ = ["ZERO", "Due", "Passing", "Pending", "met_at"]

Array = NDArray[np.float64]

# Of a function of angles and rates: what round-off leaves of it where it is zero.
ZERO = 1e-11


class Pending(NamedTuple):
    """A function that was located at this instant: of which element in which mode, and its value there."""

    place: str
    number: int
    mode: int
    value: float


class Passing(NamedTuple):
    """A function that passes: of which element, how that meets its joint, and what changes by it."""

    place: str
    number: int
    met: Met
    change: Change


def met_at(workspace: Workspace, one: Acting, t: float, y: Array) -> Met:
    """Return where an element finds its joint, and at what rate."""
    angle, rate, _, _ = kernels.joint_motion(workspace.program, one.block, y, workspace.model.nq)
    return Met(t, float(angle), float(rate), 0.0)


class Due:
    """Finds what passes at a state.

    Args:
        workspace: What a run works on.
        adjustments: Its elements as they are.
        acting: Elements with modes, by place.
    """

    def __init__(self, workspace: Workspace, adjustments: Adjustments, acting: Mapping[str, Acting]) -> None:
        """Allocate once."""
        self._workspace, self._adjustments, self._acting = workspace, adjustments, acting
        self._moment = Moment(workspace)
        self._holds = [one.name for one in workspace.system.holds]
        self._rates = np.zeros(workspace.model.nv + workspace.manifold.nx)

    def _element(self, place: str) -> Modal:
        element = self._adjustments.elements[place]
        assert isinstance(element, Modal)
        return element

    def met(self, place: str, t: float, y: Array) -> Met:
        """Return how an element meets its joint."""
        met, nq = met_at(self._workspace, self._acting[place], t, y), self._workspace.model.nq
        load = 0.0
        if self._element(place).holds:
            load = self._moment.set(t, y).load(self._holds.index(place))
        head = self._workspace.program[self._acting[place].block :][: kernels.PARAMETERS]
        first = nq + self._workspace.model.nv + int(head.view(kernels.ELEMENT)[0]["x"])
        own = tuple(float(y[first + k]) for k in range(len(self._element(place).integrals)))
        inertia = 0.0
        if self._element(place).weighs:
            inertia = self._moment.set(t, y).inertia(self._acting[place].block)
        return met._replace(load=load, integrals=own, inertia=inertia)

    def pending(self, one: Switch, t: float, y: Array) -> Pending:
        """Return a function that was located, as it is."""
        self._moment.set(t, y)
        return Pending(one.place, one.number, self._element(one.place).mode, self.value(one)[0])

    def is_past(self, one: Switch, t: float, y: Array) -> bool:
        """Return whether a function, but of a load, is negative by more than round-off."""
        self._moment.set(t, y)
        if hold_of(self._element(one.place), one.place, one.number, self._holds) >= 0:
            return False
        return self.value(one)[0] < -ZERO

    def value(self, one: Switch | Pending) -> tuple[float, float]:
        """Return a function and its rate at the moment's state."""
        hold = hold_of(self._element(one.place), one.place, one.number, self._holds)
        return self._moment.switch(self._acting[one.place].block, one.number, hold)

    def grazes(self, one: Switch | Pending, t: float, y: Array) -> bool:
        """Return whether a function that is about zero goes back from there, by its next derivative.

        The search finds zeros in the dense output, which is off by more than a step's end is. A function f
        with rate f' < 0 and f'' > 0 comes down to f - f'^2 / (2 f''): where that is above zero but for
        round-off nothing passes.
        """
        value, slope = self.value(one)
        if slope == 0.0 or value < -GRAZE:
            return False
        nq, nv = self._workspace.model.nq, self._workspace.model.nv
        self._workspace.derivative(t, y, self._rates)
        faster = y.copy()
        faster[nq : nq + nv] += self._rates[:nv]
        self._moment.set(t, faster)
        bend = self.value(one)[1] - slope
        self._moment.set(t, y)
        return bend > 0.0 and (slope > 0.0 or value - 0.5 * slope * slope / bend > -GRAZE)

    def passing(
        self, t: float, y: Array, pending: Sequence[Pending], decided: Callable[[str, int], bool]
    ) -> list[Passing]:
        """Return what passes at this state, of each element what comes first."""
        known = {(one.place, one.number) for one in pending}
        self._moment.set(t, y)
        found = []
        for place in self._acting:
            element = self._element(place)
            numbers = [
                k
                for k in range(element.switches)
                if not decided(place, k)
                and ((place, k) in known or self._passes(Switch(place, k), bool(known), t, y))
            ]
            if not numbers:
                continue
            met = self.met(place, t, y)
            self._moment.set(t, y)
            changes = [
                Passing(place, k, met, change)
                for k in numbers
                if (change := element.passed(k, met)) is not None
            ]
            found += [min(changes, key=lambda one: one.change.phase)] if changes else []
        return found

    def _passes(self, one: Switch, first: bool, t: float, y: Array) -> bool:
        """Return whether a function that was not located passes; loads count behind the first round."""
        loaded = hold_of(self._element(one.place), one.place, one.number, self._holds) >= 0
        if loaded and first:
            return False
        value, slope = self.value(one)
        if loaded or abs(value) > ZERO:
            return value < 0.0
        return slope < -ZERO and not self.grazes(one, t, y)

    def still(
        self,
        pending: Sequence[Pending],
        before: Mapping[str, object],
        decided: Callable[[str, int], bool],
        t: float,
        y: Array,
    ) -> list[Pending]:
        """Return which of the located functions still pass behind changes."""
        self._moment.set(t, y)
        found = []
        for one in pending:
            if decided(one.place, one.number) or self._adjustments.elements[one.place] is before[one.place]:
                value, slope = self.value(one)
                if abs(value - one.value) <= ZERO * max(1.0, abs(one.value)) and slope <= 0.0:
                    found.append(one)
        return found
