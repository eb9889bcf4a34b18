"""What contacts that change and events do to displacements of a state: their saltation.

See :mod:`antenna_pin.nonlinear.variational` for the equations.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Adjustments
from antenna_pin.nonlinear.field import Field, Function
from antenna_pin.nonlinear.frames import MEMORIES, Frame, way_between
from antenna_pin.records import CONTACT, MEMORY
from antenna_pin.simulation import Event, Jump, Moment, Set, Time
from antenna_pin.simulation.loop import Run

__all__ = ["Carried", "Onset", "Saltation"]

Array = NDArray[np.float64]


class Carried(NamedTuple):
    """Displacements carried along a run, in coordinates along axes in the present state.

    Attributes:
        matrix: (size, k).
        other: The same by differences of another order and another rule: what is between tells the doubt.
        frame: The axes.
    """

    matrix: Array
    other: Array
    frame: Frame


class Onset(NamedTuple):
    """What is remembered of a contact's onset.

    Attributes:
        memory: By the state itself, MEMORY.
        rows: By its neighbours, of each column of contact memory by how much in logarithms, (k,), twice, as
            for :class:`Carried`.
    """

    memory: NDArray[Any]
    rows: dict[int, tuple[Array, Array]]


class _Passage(NamedTuple):
    """What happens to displacements as a function passes zero.

    Attributes:
        moved: What they are of the state behind it, if a neighbour came there at the same instant,
            (displacement, size).
        late: By how much a neighbour comes later [s], (size,).
        going: What the flow before it makes of a state behind it, per second, (displacement,).
    """

    moved: Array
    late: Array
    going: Array


class Saltation:
    """Carries displacements through what happens at an instant of a run.

    Args:
        field: The system's rates; its contacts and program are those before.
        run: The run.
    """

    def __init__(self, field: Field, run: Run) -> None:
        """Begin with nothing that has happened."""
        self._field = field
        self._moment = Moment(field.workspace)
        self._adjustments = Adjustments(field.system, field.workspace.program)
        for place, value in run.actions.adjustments.values.items():
            self._adjustments.set(place, value)
        self._events = {event.name: event for event in run.events}
        self._seen = len(run.actions.happened)
        self._table = np.zeros(len(field.workspace.table), CONTACT)

    def has_happened(self, run: Run) -> bool:
        """Whether an event has happened since the last time."""
        return len(run.actions.happened) > self._seen

    def through_events(self, run: Run, carried: Carried, time: float, y: Array) -> Carried:
        """Return displacements behind the events that have happened since the last time.

        Args:
            run: The run, behind them.
            carried: Displacements before them.
            time: When [s].
            y: State before them; brought behind them, in place.
        """
        counts = {one.name: one.count for one in run.watch.value()}
        new, self._seen = run.actions.happened[self._seen :], len(run.actions.happened)
        for one in new:
            event = self._events[one.name]
            carried = self._event(event, counts[one.name] >= event.after, carried, time, y)
        return carried

    # --- events ---------------------------------------------------------------------------------------------

    def _event(self, event: Event, acts: bool, carried: Carried, time: float, y: Array) -> Carried:
        """Carry displacements through an event."""
        action = event.action
        if not acts or not isinstance(action, Set | Jump):
            return carried
        field = self._field
        up = field.lift(carried.frame, time, y).up

        def function(t: float, state: Array) -> Array:
            return np.array([event.when(self._moment.set(t, state))])

        late = np.zeros(up.shape[1])
        if not isinstance(event.when, Time):
            late = self._late(function, time, y, up, of_forces=True)
        if isinstance(action, Set):
            passage = _Passage(up, late, field.flow(time, y))
            self._adjustments.set(action.place, action.value)
        else:
            passage = self._jump(event.name, action, time, y, up, late)
        return self._carry(passage, carried, time, y)

    def _late(
        self, function: Function, time: float, y: Array, up: Array, *, of_forces: bool = False
    ) -> Array:
        """Return by how much neighbours come later to where a function is zero [s], (size,)."""
        rate = float(self._field.per_second(function, time, y, of_forces=of_forces)[0])
        slopes = self._field.along(function, time, y, up, of_forces=of_forces)[0][0]
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(-slopes / rate)

    def _jump(self, event: str, action: Jump, time: float, y: Array, up: Array, late: Array) -> _Passage:
        """Return what a jump does, and let the state jump, in place."""
        field = self._field
        nq, nv = field.system.model.nq, field.system.model.nv

        def jumped(t: float, state: Array) -> Array:
            return action.state_after(event, self._moment.set(t, state))[: nq + nv]

        behind = jumped(time, y)

        def displaced(t: float, state: Array) -> Array:
            there = jumped(t, state)
            return np.concatenate([way_between(field.system, behind[:nq], there[:nq]), (there - behind)[nq:]])

        moved, going = up.copy(), field.flow(time, y)
        moved[: 2 * nv] = field.along(displaced, time, y, up)[0]
        going[: 2 * nv] = field.per_second(displaced, time, y)
        y[: nq + nv] = behind
        return _Passage(moved, late, going)

    def _carry(self, passage: _Passage, carried: Carried, time: float, y: Array) -> Carried:
        """Return displacements behind a passage, whose contacts, program and state are the field's now."""
        field = self._field
        frame = field.frame(y)
        down = field.lift(frame, time, y).down
        through = down @ (passage.moved + np.outer(passage.going - field.flow(time, y), passage.late))
        return Carried(through @ carried.matrix, through @ carried.other, frame)

    # --- contacts -------------------------------------------------------------------------------------------

    def onset(self, c: int, memory: NDArray[Any], carried: Carried, time: float, y: Array) -> Onset:
        """Return what neighbours will remember of a contact that begins: of their own instants.

        Args:
            c: Which.
            memory: What the state itself remembers.
            carried: Displacements.
            time: When [s].
            y: State.
        """
        field = self._field
        up = field.lift(carried.frame, time, y).up
        late = self._late(self._located("gap", c), time, y, up)

        def mass(_: float, state: Array) -> Array:
            return np.array([field.workspace.effective_mass(state, c)])

        kept: dict[int, tuple[Function, float]] = {2: (mass, float(memory["effective_mass"]))}
        if memory["approach_speed"] > field.system.approach_speed_floors[c]:
            kept[1] = self._located("rate", c), float(memory["approach_speed"])
        nothing = np.zeros(carried.matrix.shape[1])
        rows = dict.fromkeys(MEMORIES, (nothing, nothing))
        for column, (function, value) in kept.items():
            rate = float(field.per_second(function, time, y)[0])
            own = (field.along(function, time, y, up)[0][0] + rate * late) / value
            rows[column] = own @ carried.matrix, own @ carried.other
        return Onset(memory.copy(), rows)

    def _located(self, name: str, c: int) -> Function:
        """Return a number of a contact's table as a function of the state."""

        def function(_: float, state: Array) -> Array:
            self._field.workspace.locate(state, self._table)
            return np.array([self._table[name][c]])

        return function

    def through_contact(
        self, c: int, onset: Onset | None, carried: Carried, time: float, y: Array
    ) -> Carried:
        """Return displacements behind where a contact begins to count, or where it parts.

        Args:
            c: Which.
            onset: What is remembered of the onset; None where it parts.
            carried: Displacements before it.
            time: When [s].
            y: State.
        """
        field = self._field
        up = field.lift(carried.frame, time, y).up
        late = self._late(self._located("gap", c), time, y, up)
        passage = _Passage(up, late, field.flow(time, y))
        field.workspace.memory[c] = np.zeros(1, MEMORY)[0] if onset is None else onset.memory
        found = self._carry(passage, carried, time, y)
        if onset is not None:
            first = len(found.matrix) - len(found.frame.remembered)
            for k, (contact, column) in enumerate(found.frame.remembered, first):
                if contact == c:
                    # What was missed since the onset is not remembered of it.
                    for rows, row in zip(found[:2], onset.rows[column], strict=True):
                        rows[k], rows[k, : len(row)] = 0.0, row
        return found
