"""Saltation: tangents of a run across contacts that change and across events.

A tangent w of a state at equal times is ``w + f dt`` at the perturbed time of an event, later by dt. With
time as a coordinate beside the others it obeys the same equation, as does the flow f. Quantities integrated
along a run, b' = L, act on nothing: their tangent is propagated beside w and is ``B + L dt`` there.

See :mod:`antenna_pin.nonlinear.variational` for the equations.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import MEMORY
from antenna_pin.dynamics import Workspace, acting_in, impulse, kernels, reduced_inertia
from antenna_pin.elements import Met
from antenna_pin.nonlinear.coordinates import Frame, Kept, way_between
from antenna_pin.nonlinear.perturbed_system import Function, InPlace
from antenna_pin.nonlinear.vector_field import Field
from antenna_pin.simulation import Jump, Moment, Set, Time
from antenna_pin.simulation.element_events import EventEffect, ImpulseEffect, ModeEffect, StruckElement
from antenna_pin.simulation.events import Switch
from antenna_pin.simulation.loop import Run

__all__ = ["Carried", "Meeting", "Passed", "Replay", "Saltation", "at_equal_times", "with_time"]

Array = NDArray[np.float64]

# --- tangents at equal times, and at the perturbed times of an event ----------------------------------------


class Carried(NamedTuple):
    """Displacements carried along a run, in coordinates along axes in the present state.

    Attributes:
        matrix: (size, k).
        other: The same by differences of another order and another rule: what is between tells the doubt.
        frame: The axes.
        books: Displacements of what is integrated along the run, (nx, k).
    """

    matrix: Array
    other: Array
    frame: Frame
    books: Array


def with_time(carried: Carried) -> Carried:
    """Return displacements with time as a coordinate; they are at equal times if it was none."""
    frame = carried.frame
    if frame.clock:
        return carried
    matrix, other = (np.insert(one, 2 * frame.ways, 0.0, axis=0) for one in carried[:2])
    return Carried(matrix, other, frame._replace(clock=True), carried.books)


def at_equal_times(field: Field, carried: Carried, time: float, y: Array) -> Carried:
    """Return displacements at equal times, without time as a coordinate.

    Args:
        field: The rates, with the contacts and the program of the moment.
        carried: Displacements.
        time: When [s].
        y: State.
    """
    if not carried.frame.clock:
        return carried
    frame, up = carried.frame._replace(clock=False), field.lift(carried.frame, time, y).up
    late = up[field.parts[-1].start]
    back = field.lift(frame, time, y).down @ (up - np.outer(field.flow(time, y), late))
    books = carried.books - np.outer(field.booked(time, y), late @ carried.matrix)
    return Carried(back @ carried.matrix, back @ carried.other, frame, books)


# --- actions of elements, repeated on perturbed states ------------------------------------------------------


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


# --- tangents across events ---------------------------------------------------------------------------------

# Of the largest displacement behind a passage: what round-off leaves of one that is lost there.
_LOST = 1e-13


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
        booked: Rates of what is integrated, before it, (nx,).
    """

    moved: Array
    late: Array
    going: Array
    booked: Array


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
        self._passages: list[EventEffect] = []
        run.actions.effects = self._passages
        #: What has happened so far.
        self.passed: list[Passed] = []
        #: How many displacements there are, and how many directions changes of mode have left of them.
        self.count = self.rank = count

    def happened(self) -> set[float]:
        """Return when events have happened, or elements have changed their modes, since the last time [s]."""
        return {one.time for one in self._passages}

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

    def _note(self, what: str, name: str, time: float, late: Array) -> None:
        """Note by how much an instant is displaced by each displacement that is carried."""
        self.passed.append(Passed(what, name, time, late[: self.count].copy()))

    # --- events ---------------------------------------------------------------------------------------------

    def _event(self, one: EventEffect, carried: Carried, time: float, y: Array) -> Carried:
        """Carry displacements through an event."""
        event = one.event
        if not one.acts or not event.has(Set, Jump, Switch):
            return carried
        field = self._field
        up = field.lift(carried.frame, time, y).up

        def function(t: float, state: Array) -> Array:
            return np.array([event.when(self._moment.set(t, state))])

        clock = up[field.parts[-1].start]
        late = -clock
        if one.together:  # in neighbours one comes before the other: what comes of it is not smooth
            late = np.full_like(clock, np.nan)
        elif not isinstance(event.when, Time):
            late = self._late(function, time, y, up, of_forces=True)
        self._note("event", one.event.name, time, (clock + late) @ carried.matrix)
        passage = _Way(up, late, field.flow(time, y), field.booked(time, y))
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
        slopes = self._field.along(function, time, y, up, of_forces=of_forces)[0]
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(-slopes / rate)

    def _jump(self, one: EventEffect, time: float, y: Array, up: Array, late: Array) -> _Way:
        """Return what a jump does, or what elements do, and let the state jump, in place."""
        field, action = self._field, one.event.action
        nq, nv = field.system.model.nq, field.system.model.nv
        words = field.kept.words

        def jumped(t: float, state: Array) -> tuple[Array, Array, Array]:
            there = state.copy()
            if isinstance(action, Jump):
                there[: nq + nv] = action.state_after(one.event.name, self._moment.set(t, state))[: nq + nv]
            return there[:nq], *self._replay(one.done, t, there, field.workspace.program[words])

        places, rates, _ = jumped(time, y)

        def changes(t: float, state: Array) -> Array:  # of what stays as it is derivatives are known
            there, v, numbers = jumped(t, state)
            way = np.zeros(nv)
            if isinstance(action, Jump):
                way = way_between(field.system, places, there) - way_between(field.system, y[:nq], state[:nq])
            return np.concatenate([way, v - state[nq : nq + nv], numbers - field.workspace.program[words]])

        moved, going, kept = up.copy(), field.flow(time, y), field.parts[-2]
        booked = field.booked(time, y)
        along, per_second = field.along(changes, time, y, up), field.per_second(changes, time, y)
        for one_of, more in ((moved, along), (going, per_second)):
            one_of[: 2 * nv] += more[: 2 * nv]
            one_of[kept] += more[2 * nv :]
        y[:nq], y[nq : nq + nv] = places, rates
        return _Way(moved, late, going, booked)

    def _carry(self, passage: _Way, carried: Carried, time: float, y: Array) -> Carried:
        """Return displacements behind a passage, whose contacts, program and state are the field's now."""
        field = self._field
        frame = field.frame(y, carried.frame.clock)
        down = field.lift(frame, time, y).down
        moved, jump = passage.moved, passage.going - field.flow(time, y)
        if jump.any():  # else it matters to none when it comes, as where a joint turns back in a stop
            moved = moved + np.outer(jump, passage.late)
        through, books = down @ moved, carried.books
        if (change := passage.booked - field.booked(time, y)).any():
            books = books + np.outer(change, passage.late @ carried.matrix)
        self._lose(through, carried.matrix[:, : self.count])
        return Carried(through @ carried.matrix, through @ carried.other, frame, books)

    def _lose(self, through: Array, displacements: Array) -> None:
        """Count the directions that are left, where what is passed may take some away."""
        if self.rank and np.isfinite(through).all():
            among = np.linalg.svd(displacements, full_matrices=False)[0][:, : self.rank]
            sizes = np.linalg.svd(through @ among, compute_uv=False)
            self.rank = int(np.count_nonzero(sizes > _LOST * sizes.max(initial=0.0)))

    # --- contacts -------------------------------------------------------------------------------------------

    def onset(self, c: int, memory: NDArray[Any], carried: Carried, time: float, y: Array) -> Carried:
        """Return displacements at the neighbours' own onsets of a contact, which counts from now on.

        There its depth is the same in all of them; what they remember is of their own instants, and bristles
        are straight.

        Args:
            c: Which.
            memory: What the state itself remembers.
            carried: Displacements, with time.
            time: When [s].
            y: State.
        """
        field = self._field
        lift = field.lift(carried.frame, time, y)
        opening, rate = field.depths.opening(y, c, lift.up)
        with np.errstate(divide="ignore", invalid="ignore"):
            flow, late = lift.down @ field.flow(time, y), -opening / rate
        ways = [one + np.outer(flow, late @ one) for one in carried[:2]]
        books = carried.books + np.outer(field.booked(time, y), late @ carried.matrix)
        clock = lift.up[field.parts[-1].start]
        self._note("onset", str(c), time, clock @ ways[0])

        faster, heavier = field.depths.impact(time, y, c, lift.up)
        slopes = {2: heavier}
        if memory["approach_speed"] > field.system.approach_speed_floors[c]:
            slopes[1] = faster / float(memory["approach_speed"])
        for one in ways:
            one[carried.frame.first_bristle + field.bristles_of(c)] = 0.0
        frame = self._let(c, memory, y)
        turn = field.lift(frame, time, y).down @ lift.up
        found = Carried(turn @ ways[0], turn @ ways[1], frame, books)
        for k, (contact, column) in enumerate(frame.remembered, len(turn) - len(frame.remembered)):
            if contact == c and column in slopes:
                for each, slope, one in zip(found[:2], slopes[column], ways, strict=True):
                    each[k] = slope @ one
        return found

    def release(self, c: int, flow: int, carried: Carried, time: float, y: Array) -> Carried:
        """Return displacements at the neighbours' own releases of a contact, which counts no more.

        Where a force begins and ends with its depth the derivative of rates has no bounds. What carrying was
        off by for it is in the flow, carried alike, as in displacements: to neighbours' own releases, where
        depths are the same again, it goes out.

        Args:
            c: Which.
            flow: In which column the flow is, carried up to here as displacements are.
            carried: Displacements, with time.
            time: When [s].
            y: State.
        """
        field = self._field
        lift = field.lift(carried.frame, time, y)
        opening, _ = field.depths.opening(y, c, lift.up)
        ways, lates = [], []
        for one in carried[:2]:
            with np.errstate(divide="ignore", invalid="ignore"):
                late = -(opening @ one) / (opening @ one[:, flow])
            late[flow] = 0.0
            ways.append(one + np.outer(one[:, flow], late))
            lates.append(late)
        books = carried.books + np.outer(carried.books[:, flow], lates[0])
        self._note("release", str(c), time, lift.up[field.parts[-1].start] @ ways[0])
        frame = self._let(c, np.zeros(1, MEMORY)[0], y)
        turn = field.lift(frame, time, y).down @ lift.up
        return Carried(turn @ ways[0], turn @ ways[1], frame, books)

    def _let(self, c: int, memory: Any, y: Array) -> Frame:
        """Let a contact remember something from now on; return the axes then, with time."""
        self._field.workspace.memory[c] = memory
        return self._field.frame(y, clock=True)
