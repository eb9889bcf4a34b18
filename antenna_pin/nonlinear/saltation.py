"""What contacts that change and events do to displacements of a state: their saltation.

See :mod:`antenna_pin.nonlinear.variational` for the equations.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.nonlinear.field import Field
from antenna_pin.nonlinear.frames import MEMORIES, Frame, way_between
from antenna_pin.nonlinear.near import Function
from antenna_pin.nonlinear.replay import Replay
from antenna_pin.records import CONTACT, MEMORY
from antenna_pin.simulation import Jump, Moment, Set, Time
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.own_actions import Switch
from antenna_pin.simulation.passages import Passage

__all__ = ["Carried", "Onset", "Passed", "Saltation"]

Array = NDArray[np.float64]

# Of the largest displacement behind a passage: what round-off leaves of one that is lost there.
_LOST = 1e-13


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


class Passed(NamedTuple):
    """An instant at which something happened.

    Attributes:
        what: ``onset``, ``release`` or ``event``.
        name: Of the event; of a contact its number.
        time: When [s].
        late: By how much later it is for each displacement [s], (k,).
    """

    what: str
    name: str
    time: float
    late: Array


class _Way(NamedTuple):
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
        count: How many displacements are carried.
    """

    def __init__(self, field: Field, run: Run, count: int) -> None:
        """Begin with nothing that has happened."""
        self._field = field
        self._moment = Moment(field.workspace)
        self._replay = Replay(field.workspace, field.kept, field.numbers)
        self._passages: list[Passage] = []
        run.actions.passages = self._passages
        self._table = np.zeros(len(field.workspace.table), CONTACT)
        #: What has happened so far.
        self.passed: list[Passed] = []
        #: How many displacements there are, and how many directions changes of mode have left of them.
        self.count = self.rank = count

    def has_happened(self) -> bool:
        """Whether an event has happened since the last time, or an element has changed its mode."""
        return bool(self._passages)

    def through_events(self, carried: Carried, time: float, y: Array) -> Carried:
        """Return displacements behind what has happened since the last time.

        Args:
            carried: Displacements before it.
            time: When [s].
            y: State before it; brought behind it, in place.
        """
        for one in self._passages:
            carried = self._event(one, carried, time, y)
        self._passages.clear()
        return carried

    def _note(self, what: str, name: str, time: float, late: Array, carried: Carried) -> None:
        """Note by how much an instant is displaced."""
        self.passed.append(Passed(what, name, time, late @ carried.matrix[:, : self.count]))

    # --- events ---------------------------------------------------------------------------------------------

    def _event(self, one: Passage, carried: Carried, time: float, y: Array) -> Carried:
        """Carry displacements through an event."""
        event = one.event
        if not one.acts or not isinstance(event.action, Set | Jump | Switch):
            return carried
        field = self._field
        up = field.lift(carried.frame, time, y).up

        def function(t: float, state: Array) -> Array:
            return np.array([event.when(self._moment.set(t, state))])

        late = np.zeros(up.shape[1])
        if not isinstance(event.when, Time):
            late = self._late(function, time, y, up, of_forces=True)
        self._note("event", one.event.name, time, late, carried)
        passage = _Way(up, late, field.flow(time, y))
        if isinstance(event.action, Jump) or one.done:
            passage = self._jump(one, time, y, up, late)
        field.let_go(np.flatnonzero(field.workspace.program != one.program))
        field.workspace.program[:] = one.program
        return self._carry(passage, carried, time, y)

    def _late(
        self, function: Function, time: float, y: Array, up: Array, *, of_forces: bool = False
    ) -> Array:
        """Return by how much neighbours come later to where a function is zero [s], (size,)."""
        rate = float(self._field.per_second(function, time, y, of_forces=of_forces)[0])
        slopes = self._field.along(function, time, y, up, of_forces=of_forces)[0][0]
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(-slopes / rate)

    def _jump(self, one: Passage, time: float, y: Array, up: Array, late: Array) -> _Way:
        """Return what a jump does, or what elements do, and let the state jump, in place."""
        field, action = self._field, one.event.action
        nq, nv = field.system.model.nq, field.system.model.nv
        words = field.kept.words

        def jumped(t: float, state: Array) -> Array:
            there = state.copy()
            if isinstance(action, Jump):
                there[: nq + nv] = action.state_after(one.event.name, self._moment.set(t, state))[: nq + nv]
            v, numbers = self._replay(one.done, t, there, field.workspace.program[words])
            return np.concatenate([there[:nq], v, numbers])

        behind = jumped(time, y)

        def displaced(t: float, state: Array) -> Array:
            there = jumped(t, state)
            return np.concatenate([way_between(field.system, behind[:nq], there[:nq]), (there - behind)[nq:]])

        moved, going, kept = up.copy(), field.flow(time, y), field.parts[-2]
        along, per_second = field.along(displaced, time, y, up)[0], field.per_second(displaced, time, y)
        moved[: 2 * nv], moved[kept] = along[: 2 * nv], along[2 * nv :]
        going[: 2 * nv], going[kept] = per_second[: 2 * nv], per_second[2 * nv :]
        y[: nq + nv] = behind[: nq + nv]
        return _Way(moved, late, going)

    def _carry(self, passage: _Way, carried: Carried, time: float, y: Array) -> Carried:
        """Return displacements behind a passage, whose contacts, program and state are the field's now."""
        field = self._field
        frame = field.frame(y)
        down = field.lift(frame, time, y).down
        moved, jump = passage.moved, passage.going - field.flow(time, y)
        if jump.any():  # else it matters to none when it comes, as where a joint turns back in a stop
            moved = moved + np.outer(jump, passage.late)
        through = down @ moved
        self._lose(through, carried.matrix[:, : self.count])
        return Carried(through @ carried.matrix, through @ carried.other, frame)

    def _lose(self, through: Array, displacements: Array) -> None:
        """Count the directions that are left, where what is passed may take some away."""
        if self.rank and np.isfinite(through).all():
            among = np.linalg.svd(displacements, full_matrices=False)[0][:, : self.rank]
            sizes = np.linalg.svd(through @ among, compute_uv=False)
            self.rank = int(np.count_nonzero(sizes > _LOST * sizes.max(initial=0.0)))

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
        self._note("onset", str(c), time, late, carried)
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
        if onset is None:
            self._note("release", str(c), time, late, carried)
        passage = _Way(up, late, field.flow(time, y))
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
