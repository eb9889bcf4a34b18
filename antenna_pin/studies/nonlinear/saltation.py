"""Saltation: tangents of a run across contacts that change and across events.

A tangent w of a state at equal times is ``w + f dt`` at the perturbed time of an event, later by dt. With
time as a coordinate beside the others it obeys the same equation, as does the flow f. Quantities integrated
along a run, b' = L, act on nothing: their tangent is propagated beside w and is ``B + L dt`` there.

See :mod:`antenna_pin.studies.nonlinear.variational` for the equations.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arrays import Array
from antenna_pin.base.records import MEMORY
from antenna_pin.dynamics import Workspace, acting_in, impulse, kernels, reduced_inertia
from antenna_pin.elements import Met
from antenna_pin.run.simulation import Jump, Moment, Set, Time
from antenna_pin.run.simulation.element_events import EventEffect, ImpulseEffect, ModeEffect, StruckElement
from antenna_pin.run.simulation.events import Switch
from antenna_pin.run.simulation.loop import Run
from antenna_pin.studies.nonlinear.coordinates import ElementMemory, Frame, configuration_difference
from antenna_pin.studies.nonlinear.perturbed_system import ParameterShift, StateFunction
from antenna_pin.studies.nonlinear.vector_field import VectorField

# --- tangents at equal times, and at the perturbed times of an event ----------------------------------------


class RunTangents(NamedTuple):
    """Tangents along a run, in coordinates along axes in the present state."""

    matrix: Array  # tangents, (size, k)
    other: Array  # the same by differences of another order and another rule: what is between tells the doubt
    frame: Frame  # axes of the coordinates
    integrals: Array  # tangents of integrals of the run, (nx, k)

    def mapped(self, function: Callable[[Array], Array]) -> RunTangents:
        """Return the tangents with a function applied to the columns of all arrays."""
        return RunTangents(function(self.matrix), function(self.other), self.frame, function(self.integrals))


def with_time(tangents: RunTangents) -> RunTangents:
    """Return tangents with time as a coordinate, from tangents at equal times."""
    frame = tangents.frame
    if frame.clock:
        return tangents
    matrix, other = (np.insert(one, 2 * frame.positions, 0.0, axis=0) for one in tangents[:2])
    return RunTangents(matrix, other, frame._replace(clock=True), tangents.integrals)


def at_equal_times(field: VectorField, tangents: RunTangents, time: float, y: Array) -> RunTangents:
    """Return tangents at equal times, without time as a coordinate."""
    if not tangents.frame.clock:
        return tangents
    frame, up = tangents.frame._replace(clock=False), field.lift(tangents.frame, time, y).up
    late = up[field.parts[-1].start]
    back = field.lift(frame, time, y).down @ (up - np.outer(field.flow(time, y), late))
    books = tangents.integrals - np.outer(field.integrands(time, y), late @ tangents.matrix)
    return RunTangents(back @ tangents.matrix, back @ tangents.other, frame, books)


# --- actions of elements, repeated on perturbed states ------------------------------------------------------


class ElementTransition(NamedTuple):
    """Change of mode of an element, with the effect of an impact."""

    place: str  # place of the element
    angle: float  # angle of the joint [rad] ([m])
    rate: float  # rate before the change [rad/s] ([m/s])
    rate_after: float  # rate after the change
    loss: float = 0.0  # energy loss [J]
    impulse: float = 0.0  # impulse on the child [N m s] ([N s])
    energy: float = 0.0  # of the joint's own motion before, of elements that weigh it, else 0 [J]


class ElementReplay:
    """Repetition of element actions on other states: impulses and element memory, in order.

    Decisions are those of the run.
    """

    def __init__(
        self, workspace: Workspace, element_memory: ElementMemory, numbers: ParameterShift | None = None
    ) -> None:
        self._workspace, self._kept, self._numbers = workspace, element_memory, numbers
        self._holds = [one.name for one in workspace.system.holds]
        #: Element transitions of the last call, in order.
        self.met: list[ElementTransition] = []
        self._blocks = {one.place: one.block for one in acting_in(workspace.system)}
        self._own: Mapping[str, list[int]] = {
            place: [k for k, one in enumerate(element_memory.numbers) if one.place == place]
            for place in self._blocks
        }

    def __call__(
        self, done: tuple[ModeEffect | ImpulseEffect, ...], time: float, y: Array, numbers: Array
    ) -> tuple[Array, Array]:
        """Return velocity, (nv,), and element memory, (memory,), behind the actions."""
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
        """Apply impulses, and record their effect on the elements struck."""
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
        """Return the restitution of an impact, shifted with the parameters."""
        assert one.restitution is not None
        return one.restitution + self._displaced(one.element).get("restitution", 0.0)

    def _displaced(self, place: str) -> Mapping[str, float]:
        """Return the parameter shifts of an element's numbers."""
        return {} if self._numbers is None else self._numbers.element_changes(place)

    def _turn(self, one: ModeEffect, time: float, state: Array, numbers: Array) -> None:
        """Update the memory of an element at a change of mode, in place."""
        own, nq = self._own[one.place], self._workspace.model.nq
        angle, rate, *_ = kernels.joint_motion(self._workspace.program, self._blocks[one.place], state, nq)
        inertia = (
            reduced_inertia(self._workspace, time, state, self._blocks[one.place])
            if one.before.weighs
            else 0.0
        )
        energy = 0.5 * inertia * float(rate) ** 2
        self.met.append(ElementTransition(one.place, float(angle), float(rate), float(rate), energy=energy))
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

# Relative size below which a tangent is lost but for round-off.
_LOST = 1e-13


class EventShift(NamedTuple):
    """Event, and the shifts of its time."""

    what: str  # ``onset``, ``release`` or ``event``
    name: str  # name of the event, or number of the contact
    time: float  # time of the event [s]
    late: Array  # delay with each tangent [s], (k,)


class _Crossing(NamedTuple):
    """Effect of the zero of an event function on perturbations."""

    # what they are of the state behind it, if a perturbed state came there at the same time, (perturbation,
    # size)
    moved: Array
    late: Array  # by how much a perturbed state comes later [s], (size,)
    going: Array  # what the flow before it makes of a state behind it, per second, (perturbation,)
    integrands: Array  # rates of what is integrated, before it, (nx,)


class Saltation:
    """Propagation of tangents across events of a run."""

    def __init__(self, field: VectorField, run: Run, count: int) -> None:
        self._field = field
        self._moment = Moment(field.workspace)
        self._replay = ElementReplay(field.workspace, field.memory, field.numbers)
        self._passages: list[EventEffect] = []
        run.actions.effects = self._passages
        #: Events so far.
        self.event_shifts: list[EventShift] = []
        #: Number of tangents, and of their directions left by mode changes.
        self.count = self.rank = count

    def event_times(self) -> set[float]:
        """Return the times of events and mode changes since the last call [s]."""
        return {one.time for one in self._passages}

    def across_events(self, tangents: RunTangents, time: float, y: Array) -> RunTangents:
        """Return tangents behind the events since the last call.

        The state y, before the events, is brought behind them in place.
        """
        for one in self._passages:
            tangents = self._event(one, tangents, time, y)
        self._passages.clear()
        return tangents

    def _note(self, what: str, name: str, time: float, late: Array) -> None:
        """Record the time shift of an event with each tangent."""
        self.event_shifts.append(EventShift(what, name, time, late[: self.count].copy()))

    # --- events ---------------------------------------------------------------------------------------------

    def _event(self, one: EventEffect, tangents: RunTangents, time: float, y: Array) -> RunTangents:
        """Return tangents behind an event."""
        event = one.event
        if not one.acts or not event.has(Set, Jump, Switch):
            return tangents
        field = self._field
        up = field.lift(tangents.frame, time, y).up

        def function(t: float, state: Array) -> Array:
            return np.array([event.when(self._moment.set(t, state))])

        clock = up[field.parts[-1].start]
        late = -clock
        if one.together:  # in perturbed states one comes before the other: what comes of it is not smooth
            late = np.full_like(clock, np.nan)
        elif not isinstance(event.when, Time):
            late = self._late(function, time, y, up, of_forces=True)
        self._note("event", one.event.name, time, (clock + late) @ tangents.matrix)
        passage = _Crossing(up, late, field.flow(time, y), field.integrands(time, y))
        if isinstance(event.action, Jump) or one.done:
            passage = self._jump(one, time, y, up, late)
        field.release_words(np.flatnonzero(field.workspace.program != one.program))
        field.workspace.program[:] = one.program
        return self._carry(passage, tangents, time, y)

    def _late(
        self, function: StateFunction, time: float, y: Array, up: Array, *, of_forces: bool = False
    ) -> Array:
        """Return the delay of a function's zero with each perturbation [s], (size,)."""
        rate = float(self._field.per_second(function, time, y, of_forces=of_forces)[0])
        slopes = self._field.along(function, time, y, up, of_forces=of_forces)[0]
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(-slopes / rate)

    def _jump(self, one: EventEffect, time: float, y: Array, up: Array, late: Array) -> _Crossing:
        """Return the crossing of a jump or of element actions, applied to the state."""
        field, action = self._field, one.event.action
        nq, nv = field.system.model.nq, field.system.model.nv
        words = field.memory.words

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
                way = configuration_difference(field.system, places, there) - configuration_difference(
                    field.system, y[:nq], state[:nq]
                )
            return np.concatenate([way, v - state[nq : nq + nv], numbers - field.workspace.program[words]])

        moved, going, kept = up.copy(), field.flow(time, y), field.parts[-2]
        booked = field.integrands(time, y)
        along, per_second = field.along(changes, time, y, up), field.per_second(changes, time, y)
        for one_of, more in ((moved, along), (going, per_second)):
            one_of[: 2 * nv] += more[: 2 * nv]
            one_of[kept] += more[2 * nv :]
        y[:nq], y[nq : nq + nv] = places, rates
        return _Crossing(moved, late, going, booked)

    def _carry(self, passage: _Crossing, tangents: RunTangents, time: float, y: Array) -> RunTangents:
        """Return tangents behind a crossing, with the field's contacts, program and state after it."""
        field = self._field
        frame = field.frame(y, tangents.frame.clock)
        down = field.lift(frame, time, y).down
        moved, jump = passage.moved, passage.going - field.flow(time, y)
        if jump.any():  # else it matters to none when it comes, as where a joint turns back in a stop
            moved = moved + np.outer(jump, passage.late)
        through, books = down @ moved, tangents.integrals
        if (change := passage.integrands - field.integrands(time, y)).any():
            books = books + np.outer(change, passage.late @ tangents.matrix)
        self._lose(through, tangents.matrix[:, : self.count])
        return RunTangents(through @ tangents.matrix, through @ tangents.other, frame, books)

    def _lose(self, through: Array, displacements: Array) -> None:
        """Update the rank of the tangents, which a crossing may reduce."""
        if self.rank and np.isfinite(through).all():
            among = np.linalg.svd(displacements, full_matrices=False)[0][:, : self.rank]
            sizes = np.linalg.svd(through @ among, compute_uv=False)
            self.rank = int(np.count_nonzero(sizes > _LOST * sizes.max(initial=0.0)))

    # --- contacts -------------------------------------------------------------------------------------------

    def onset(
        self, c: int, memory: NDArray[Any], tangents: RunTangents, time: float, y: Array
    ) -> RunTangents:
        """Return tangents at the perturbed onsets of a contact, which acts from now on.

        There its depth is the same in all of them; what they remember is of their own times, and bristles
        are straight.

        The memory is that of the contact in the unperturbed state; tangents have time as a coordinate.
        """
        field = self._field
        lift = field.lift(tangents.frame, time, y)
        opening, rate = field.gaps.opening(y, c, lift.up)
        with np.errstate(divide="ignore", invalid="ignore"):
            flow, late = lift.down @ field.flow(time, y), -opening / rate
        ways = [one + np.outer(flow, late @ one) for one in tangents[:2]]
        books = tangents.integrals + np.outer(field.integrands(time, y), late @ tangents.matrix)
        clock = lift.up[field.parts[-1].start]
        self._note("onset", str(c), time, clock @ ways[0])

        faster, heavier = field.gaps.impact(time, y, c, lift.up)
        slopes = {2: heavier}
        if memory["approach_speed"] > field.system.approach_speed_floors[c]:
            slopes[1] = faster / float(memory["approach_speed"])
        for one in ways:
            one[tangents.frame.first_bristle + field.contact_bristles(c)] = 0.0
        frame = self._let(c, memory, y)
        turn = field.lift(frame, time, y).down @ lift.up
        found = RunTangents(turn @ ways[0], turn @ ways[1], frame, books)
        for k, (contact, column) in enumerate(frame.contact_memory, len(turn) - len(frame.contact_memory)):
            if contact == c and column in slopes:
                for each, slope, one in zip(found[:2], slopes[column], ways, strict=True):
                    each[k] = slope @ one
        return found

    def release(self, c: int, flow: int, tangents: RunTangents, time: float, y: Array) -> RunTangents:
        """Return tangents at the perturbed releases of a contact, which no longer acts.

        Where a force begins and ends with its depth the derivative of the rates is unbounded. The propagation
        error due to it is the same in the flow as in tangents: at the perturbed releases, where depths are
        equal again, it cancels.

        The column ``flow`` holds the flow, propagated as tangents are.
        """
        field = self._field
        lift = field.lift(tangents.frame, time, y)
        opening, _ = field.gaps.opening(y, c, lift.up)
        ways, lates = [], []
        for one in tangents[:2]:
            with np.errstate(divide="ignore", invalid="ignore"):
                late = -(opening @ one) / (opening @ one[:, flow])
            late[flow] = 0.0
            ways.append(one + np.outer(one[:, flow], late))
            lates.append(late)
        books = tangents.integrals + np.outer(tangents.integrals[:, flow], lates[0])
        self._note("release", str(c), time, lift.up[field.parts[-1].start] @ ways[0])
        frame = self._let(c, np.zeros(1, MEMORY)[0], y)
        turn = field.lift(frame, time, y).down @ lift.up
        return RunTangents(turn @ ways[0], turn @ ways[1], frame, books)

    def _let(self, c: int, memory: Any, y: Array) -> Frame:
        """Set the memory of a contact, and return the axes then, with time."""
        self._field.workspace.memory[c] = memory
        return self._field.frame(y, clock=True)
