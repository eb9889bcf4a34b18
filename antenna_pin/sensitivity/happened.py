"""What events of a run come to in neighbours: when they happen, and the energy that they bring in.

An event at which g passes zero comes later by ``-(dg w) / g'``. The energy that it brings in is what is
stored behind it, at the neighbour's own instant, less what was stored before, and what blows have taken.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Workspace, audit
from antenna_pin.nonlinear.field import Field
from antenna_pin.nonlinear.replay import Replay
from antenna_pin.simulation.events import Jump, Set, Time
from antenna_pin.simulation.moment import Moment
from antenna_pin.simulation.own_actions import Switch
from antenna_pin.simulation.passages import Passage

__all__ = ["Happened", "Happenings"]

Array = NDArray[np.float64]


class Happened(NamedTuple):
    """How an event is displaced.

    Attributes:
        name: Of the event.
        time: When [s].
        late: By how much later it comes, (parameters,) [s].
        energy: By how much more it brings in, (parameters,) [J].
    """

    name: str
    time: float
    late: Array
    energy: Array


class Happenings:
    """Differentiates what events come to.

    Args:
        field: The system's rates; its contacts and program are those before an event.
        replay: Does to states what elements did.
    """

    def __init__(self, field: Field, replay: Replay) -> None:
        """Allocate once."""
        self._field, self._replay, self._moment = field, replay, Moment(field.workspace)

    def of(self, one: Passage, time: float, y: Array, ways: Array, late: Array) -> Happened:
        """Return how an event is displaced.

        Args:
            one: What has happened.
            time: When [s].
            y: State before it.
            ways: Displacements at equal times, (displacement, parameters).
            late: By how much later it comes, of one that acts.
        """
        field, name = self._field, one.event.name
        if not one.acts or not one.event.has(Set, Jump, Switch):  # noted, or the run's end
            return Happened(name, time, self._late(one, time, y, ways), np.zeros_like(late))
        if isinstance(one.event.action, Jump):  # a function of the user's, which knows states only
            return Happened(name, time, late, np.full_like(late, np.nan))
        there = ways + np.outer(field.flow(time, y), late)
        base = field.workspace.program.copy()

        def brought(t: float, state: Array) -> Array:
            return np.array([self._brought(one, base, t, state)])

        return Happened(name, time, late, field.along(brought, time, y, there)[0])

    def _late(self, one: Passage, time: float, y: Array, ways: Array) -> Array:
        """Return by how much later an event comes that changes nothing [s]."""
        if isinstance(one.event.when, Time):
            return np.zeros(ways.shape[1])

        def function(t: float, state: Array) -> Array:
            return np.array([one.event.when(self._moment.set(t, state))])

        rate = float(self._field.per_second(function, time, y, of_forces=True)[0])
        slopes = self._field.along(function, time, y, ways, of_forces=True)[0]
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(np.isfinite(slopes / rate), -slopes / rate, np.nan)

    def _brought(self, one: Passage, base: Array, time: float, y: Array) -> float:
        """Return the energy that an event brings in, of a state before it [J]."""
        workspace, kept = self._field.workspace, self._field.kept.words
        numbers, present = self._field.numbers, workspace.program.copy()
        before = _stored(workspace, y)
        velocity, own = self._replay(one.done, time, y.copy(), present[kept])
        lost = sum(found.loss for found in self._replay.met)
        behind: Any = y.copy()
        nq, nv = workspace.model.nq, workspace.model.nv
        behind[nq : nq + nv] = velocity
        try:
            workspace.program[:] = one.program
            if numbers is not None:  # what an event sets goes with parameters no more
                workspace.program += numbers.present @ np.where(one.program == base, numbers.program, 0.0)
            if one.done:
                workspace.program[kept] = own
            return _stored(workspace, behind) - before + lost
        finally:
            workspace.program[:] = present


def _stored(workspace: Workspace, y: Array) -> float:
    """Return what bodies have by moving and springs by being bent: all that an event may change [J]."""
    workspace.measure(y)
    found = audit(workspace, y)
    return found.kinetic + found.springs
