"""Run with tangents: samples, events, contacts, element transitions and integrals.

The loss of an impact is a function of the state before it, at the perturbed time; the integrals between
events are propagated with the tangents (:mod:`antenna_pin.studies.nonlinear.variational`). An event at which
g passes zero comes later by ``-(dg w) / g'``. Its energy is what is stored after it, at the perturbed time,
less what was stored before, and the losses of impacts. An element reports its integrals since its last
change: a loss, an impulse. Perturbed integrals are those at the perturbed times, ``B + L dt`` of the
integrals at a rate L and perturbed by B at equal times.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from antenna_pin.base.arrays import Array
from antenna_pin.base.calculus import root_between
from antenna_pin.base.records import CONTACT
from antenna_pin.dynamics import System, Workspace, acting_in, audit, kernels
from antenna_pin.elements import LOSS, Change, Met
from antenna_pin.run.simulation.element_events import EventEffect, ImpulseEffect, ModeEffect
from antenna_pin.run.simulation.events import Jump, Moment, Set, Switch, Time
from antenna_pin.run.simulation.loop import Run
from antenna_pin.run.simulation.samples import Chunk
from antenna_pin.run.simulation.steps import LoggedStep
from antenna_pin.studies.nonlinear.coordinates import ElementMemory
from antenna_pin.studies.nonlinear.kinks import StepStates
from antenna_pin.studies.nonlinear.perturbed_system import ParameterSlopes
from antenna_pin.studies.nonlinear.saltation import ElementReplay, ElementTransition, EventShift
from antenna_pin.studies.nonlinear.variational import TangentPropagation
from antenna_pin.studies.nonlinear.vector_field import VectorField
from antenna_pin.studies.sensitivity.parameters import GrazeError

# --- integrals of elements between two changes --------------------------------------------------------------


class _ElementIntegrals:
    """Derivatives of the integrals that elements report at changes."""

    def __init__(self, system: System) -> None:
        self._first = {
            one.place: int(system.program[one.block :][: kernels.PARAMETERS].view(kernels.ELEMENT)[0]["x"])
            for one in acting_in(system)
        }
        #: Perturbed integrals at the last change of each element, (integrals, parameters).
        self._kept: dict[str, Array] = {}

    def of(self, one: ModeEffect, met: ElementTransition, time: float, x: Array, books: Array) -> Array:
        """Return the derivatives of loss and impulse of a change, (2, parameters)."""
        first, count = self._first[one.place], len(one.before.integrals)
        here = slice(first, first + count)

        def changed(more: Array) -> Change | None:
            own = tuple((x[here] + more).tolist())
            return one.change(one.before, Met(time, met.angle, met.rate, 0.0, own))

        out, base = np.zeros((2, books.shape[1])), changed(np.zeros(count))
        if base is None:
            return out
        for k, more in enumerate(np.eye(count)):
            other = changed(more)  # all of it is linear in integrals
            if other is None:
                continue
            if other.memory != base.memory:
                self._kept[one.place] = books[here]
            kept = self._kept.get(one.place, np.zeros((count, books.shape[1])))
            for row, name in zip(out, ("loss", "impulse"), strict=True):
                row += (getattr(other, name) - getattr(base, name)) * (books[here] - kept)[k]
        return out


# --- times and energies of events ---------------------------------------------------------------------------


class _EventSensitivity(NamedTuple):
    """Derivatives of an event."""

    name: str
    time: float  # of the event [s]
    late: Array  # delay, (parameters,) [s]
    energy: Array  # change of the energy added, (parameters,) [J]


class _EventDerivatives:
    """Differentiation of event times and energies, with contacts and program before an event."""

    def __init__(self, field: VectorField, replay: ElementReplay) -> None:
        self._field, self._replay, self._moment = field, replay, Moment(field.workspace)

    def of(self, one: EventEffect, time: float, y: Array, ways: Array, late: Array) -> _EventSensitivity:
        """Return the derivatives of an event."""
        field, name = self._field, one.event.name
        if not one.acts or not one.event.has(Set, Jump, Switch):  # noted, or the run's end
            return _EventSensitivity(name, time, self._late(one, time, y, ways), np.zeros_like(late))
        if isinstance(one.event.action, Jump):  # a function of the user's, which knows states only
            return _EventSensitivity(name, time, late, np.full_like(late, np.nan))
        there = ways + np.outer(field.flow(time, y), late)
        base = field.workspace.program.copy()

        def brought(t: float, state: Array) -> Array:
            return np.array([self._brought(one, base, t, state)])

        return _EventSensitivity(name, time, late, field.along(brought, time, y, there)[0])

    def _late(self, one: EventEffect, time: float, y: Array, ways: Array) -> Array:
        """Return the delay of an event that changes nothing [s]."""
        if isinstance(one.event.when, Time):
            return np.zeros(ways.shape[1])

        def function(t: float, state: Array) -> Array:
            return np.array([one.event.when(self._moment.set(t, state))])

        rate = float(self._field.per_second(function, time, y, of_forces=True)[0])
        slopes = self._field.along(function, time, y, ways, of_forces=True)[0]
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(np.isfinite(slopes / rate), -slopes / rate, np.nan)

    def _brought(self, one: EventEffect, base: Array, time: float, y: Array) -> float:
        """Return the energy added by an event, from the state before it [J]."""
        workspace, kept = self._field.workspace, self._field.memory.words
        numbers, present = self._field.numbers, workspace.program.copy()
        before = _stored_energy(workspace, y)
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
            return _stored_energy(workspace, behind) - before + lost
        finally:
            workspace.program[:] = present


def _stored_energy(workspace: Workspace, y: Array) -> float:
    """Return kinetic and spring energy: all that an event may change [J]."""
    workspace.measure(y)
    found = audit(workspace, y)
    return found.kinetic + found.springs


# --- maxima of contact depths -------------------------------------------------------------------------------


class _DepthMaxima:
    """Search for maxima of contact depths within steps."""

    def __init__(self, states: StepStates) -> None:
        self._within = states
        self._table = np.zeros(len(states.workspace.table), CONTACT)
        self.found: list[tuple[int, float]] = []

    def look(self, steps: Sequence[LoggedStep]) -> list[float]:
        """Return the depth maxima within consecutive steps [s]."""
        touching = np.flatnonzero(self._within.touching)
        if not steps or not len(touching):
            return []
        rates = np.array([self._rates(y)[touching] for y in (steps[0].y, *(one.end for one in steps))])
        new: list[tuple[float, int]] = []
        for k, j in zip(*np.nonzero((rates[:-1] > 0.0) & (rates[1:] <= 0.0)), strict=True):
            one, c = steps[k], int(touching[j])
            self._within.begin(one.time, one.y, one.size, one.end)
            ends = float(rates[k, j]), float(rates[k + 1, j])
            theta = root_between(partial(self._rate, c), 0.0, 1.0, absolute=1e-15, ends=ends)
            new.append((one.time + theta * one.size, c))
        new.sort()
        self.found += [(c, time) for time, c in new]
        return [time for time, _ in new]

    def _rate(self, c: int, theta: float) -> float:
        """Return the rate of a contact's depth at a fraction of the step [m/s]."""
        return float(self._rates(self._within.at(theta))[c])

    def _rates(self, y: Array) -> Array:
        """Return the rates of depths in a state, (contacts,) [m/s]."""
        self._within.workspace.locate(y, self._table)
        return self._table["rate"].copy()


class PerturbedSamples(NamedTuple):
    """Samples of a run with their perturbations by each parameter."""

    chunk: Chunk  # states, with discrete states
    perturbations: Array  # (n, perturbation, parameters)
    integrals: Array  # derivatives of the integrals, (n, nx, parameters)
    doubts: Array  # error estimates of perturbations over their sizes, (n, parameters)
    program_slopes: Array  # derivatives of the program, (n, parameters, words)


class _TransitionShift(NamedTuple):
    """Derivatives of an element's change of mode."""

    place: str  # of the element
    time: float  # of the change [s]
    angle: float  # of the joint [rad] ([m])
    late: Array  # delay, (parameters,) [s]
    slopes: Array  # of angle, rate before and after, loss, impulse and energy, (6, parameters)


class ContactShift(NamedTuple):
    """Derivatives of a contact from onset to release."""

    contact: int  # index of the contact
    onset: float  # time; minus infinity if it touched at the start [s]
    late: tuple[Array, Array]  # delays of onset and release, (parameters,) each [s]
    memory: tuple[Array, Array]  # of logarithms of approach speed and effective mass, (parameters,) each
    # at onset and release, (nx, parameters) each; the latter None while it lasts
    integrals: tuple[Array, Array | None]


class _BeforeChange(NamedTuple):
    """Perturbations before a change."""

    time: float  # of the change [s]
    y: Array
    ways: Array  # perturbations, (perturbation, parameters)
    integrals: Array  # derivatives of the integrals, (nx, parameters)


class TangentRecord:
    """Observer that records the tangents of a run: samples, contacts, events, transitions.

    Depth maxima are recorded from the time ``begin`` on [s].
    """

    def __init__(
        self, run: Run, carrier: TangentPropagation, numbers: ParameterSlopes, begin: float, count: int
    ) -> None:
        system = run.system
        self.carrier, self._begin, self._count = carrier, begin, count
        self._deepest = _DepthMaxima(carrier.states)
        self._field = VectorField(system, run.settings, numbers)
        workspace = self._field.workspace
        self._replay = ElementReplay(workspace, ElementMemory(system), self._field.numbers)
        self._losses = _losses(system)
        # Data of :class:`PerturbedSamples`, sample by sample.
        self._seen: list[tuple[Any, ...]] = []
        self._table, self._gaps = np.zeros(len(workspace.table), CONTACT), list[Array]()
        self._marks: dict[float, _BeforeChange] = {}
        self.transitions: list[_TransitionShift] = []
        self.events: list[_EventSensitivity] = []
        self._happenings, self._taken = (
            _EventDerivatives(self._field, self._replay),
            _ElementIntegrals(system),
        )
        self.contacts: list[ContactShift] = []
        self._open: dict[int, int] = {}
        carrier.on_look, carrier.on_change = self._see, self._mark
        self._take_over(run)
        nothing = np.zeros(count)
        for c in np.flatnonzero(run.workspace.memory["touching"]).tolist():
            self._open[c] = len(self.contacts)
            same = nothing, nothing
            self.contacts.append(ContactShift(c, -math.inf, same, same, (self.integrals, None)))

    @property
    def integrals(self) -> Array:
        """Derivatives of the integrals so far, (nx, parameters)."""
        return self.carrier.tangents.integrals.copy()

    @property
    def samples(self) -> PerturbedSamples:
        """Perturbed samples."""
        at, states, memories, programs, ways, books, doubts, words = zip(*self._seen, strict=True)
        chunk = Chunk(np.array(at), np.array(states), np.array(memories), list(programs))
        return PerturbedSamples(chunk, *(np.array(one) for one in (ways, books, doubts, words)))

    @property
    def depth_maxima(self) -> list[tuple[int, float]]:
        """Contacts with the times of their largest depths [s], in order."""
        return self._deepest.found

    @property
    def depths(self) -> Array:
        """Contact depths at the samples, (n, contacts) [m]."""
        return -np.array(self._gaps)

    @property
    def event_shifts(self) -> tuple[EventShift, ...]:
        """Onsets, releases and events so far, with the shifts of their times."""
        return self.carrier.event_shifts

    def _take_over(self, run: Run) -> None:
        self._memory, self._program = run.workspace.memory.copy(), run.workspace.program.copy()

    # --- observer -------------------------------------------------------------------------------------------

    def observe(self, run: Run) -> None:
        """Propagate tangents over the last steps, and record changes."""
        self._go(run, self.carrier.observe)

    def end(self, run: Run) -> None:
        """Propagate and record to the end."""
        self._go(run, self.carrier.end)

    def _go(self, run: Run, carry: Callable[[Run], None]) -> None:
        passages, noted = list(run.actions.effects or ()), len(self.carrier.event_shifts)
        words = self.carrier.field.numbers.program.copy() if passages and self.carrier.field.numbers else None
        for time in self._deepest.look(run.steps.log):
            if time >= self._begin:
                self.carrier.add_look(time)
        carry(run)
        new = self.carrier.event_shifts[noted:]
        touching, touched = run.workspace.memory["touching"], self._memory["touching"]
        flipped = np.flatnonzero(touching != touched).tolist()
        if new:
            check_finite(self.carrier, run.stepper.t, self.carrier.tangents.matrix)
        for mark in self._marks.values():
            there = [one for one in passages if one.time == mark.time]
            if there:
                self._meet_all(mark, there, [one for one in new if one.time == mark.time], words)
        for c in flipped:
            late = next(
                (p.late for p in new if p.what != "event" and p.name == str(c)), np.zeros(self._count)
            )
            self._flip(c, bool(touching[c]), run.stepper.t, late)
        self._marks.clear()
        self._take_over(run)

    def _flip(self, c: int, begins: bool, time: float, late: Array) -> None:
        """Record an onset or release: integrands of a contact vanish before and behind."""
        nothing = np.zeros(self._count)
        if begins:
            books = self._marks[time].integrals if time in self._marks else self.integrals
            self._open[c] = len(self.contacts)
            self.contacts.append(ContactShift(c, time, (late, nothing), (nothing, nothing), (books, None)))
        elif c in self._open:
            k = self._open.pop(c)
            one = self.contacts[k]
            self.contacts[k] = one._replace(
                late=(one.late[0], late), integrals=(one.integrals[0], self.integrals)
            )

    # --- between changes ------------------------------------------------------------------------------------

    def _see(self, time: float, y: Array, ways: Array) -> None:
        """Record perturbations at a sample."""
        carrier = self.carrier
        check_finite(self.carrier, time, ways)
        self._remember(ways)
        field, carried = carrier.field, carrier.tangents
        assert field.numbers is not None
        here = y.copy(), field.workspace.memory.copy(), field.workspace.program.copy(), ways.copy()
        words = field.numbers.program.copy()
        field.workspace.locate(y, self._table)
        self._gaps.append(self._table["gap"].copy())
        doubts = carrier.doubt / np.linalg.norm(carried.matrix, axis=0)
        self._seen.append((time, *here, carried.integrals.copy(), doubts, words))

    def _mark(self, time: float, y: Array, ways: Array) -> None:
        """Record perturbations before a change."""
        check_finite(self.carrier, time, ways)
        self._remember(ways)
        self._marks[time] = _BeforeChange(time, y.copy(), ways.copy(), self.integrals)

    def _remember(self, ways: Array) -> None:
        """Record the perturbed memory of lasting contacts."""
        speeds, masses = self.carrier.field.parts[3:5]
        for c, k in self._open.items():
            if self.carrier.field.workspace.memory["touching"][c]:
                pair = ways[speeds][c].copy(), ways[masses][c].copy()
                self.contacts[k] = self.contacts[k]._replace(memory=pair)

    # --- at changes -----------------------------------------------------------------------------------------

    def _meet_all(
        self, mark: _BeforeChange, effects: list[EventEffect], new: list[EventShift], words: Array | None
    ) -> None:
        """Record the events and transitions at a time."""
        time, y, ways, books = mark
        late = next((one.late for one in new), np.zeros(self._count))
        field = self._field
        field.workspace.memory[:], field.workspace.program[:] = self._memory, self._program
        if field.numbers is not None and words is not None:
            field.numbers.program[:] = words
        there = ways + np.outer(field.flow(time, y), late)
        for one in effects:
            own = (p.late for p in new if p.what == "event" and p.name == one.event.name)
            self.events.append(self._happenings.of(one, time, y, ways, next(own, late)))
            if one.acts and one.done:
                self._meet(one, time, y, there, late, books)

    def _meet(self, one: EventEffect, time: float, y: Array, there: Array, late: Array, books: Array) -> None:
        """Record element transitions, and add the losses of impacts."""
        field = self._field
        kept = field.memory.words

        def met(t: float, state: Array) -> Array:
            self._replay(one.done, t, state.copy(), field.workspace.program[kept].copy())
            return np.array([found[1:] for found in self._replay.met]).reshape(-1)

        met(time, y)
        elements = list(self._replay.met)
        if not elements:
            return
        turned = [step for step in one.done if isinstance(step, ModeEffect)]
        own = books + np.outer(field.integrands(time, y), late)
        slopes = field.along(met, time, y, there).reshape(len(elements), 6, -1)
        # An impact of rigid parts takes no time: rates before it are continuous at perturbed times.
        struck = sum(isinstance(step, ImpulseEffect) for step in one.done)
        for found, step, slope in zip(elements, turned, slopes, strict=True):
            self.transitions.append(_TransitionShift(found.place, time, found.angle, late.copy(), slope))
            if struck and found.place in self._losses:
                self.carrier.add_integral(self._losses[found.place], slope[3])
            slope[3:5] += self._taken.of(step, found, time, y[-len(own) :], own)


def check_finite(carrier: TangentPropagation, time: float, ways: Array) -> None:
    """Refuse tangents at a time [s] that are not finite."""
    if not np.isfinite(ways).all():
        when = max((one.time for one in carrier.event_shifts if one.time <= time), default=time)
        raise GrazeError(
            f"sensitivities: at {when:.9g} s a contact or an event comes with no speed, or coupled blows "
            "come together: there is no derivative behind that; take other values, or a span that ends "
            "before",
            when,
        )


def _losses(system: System) -> dict[str, int]:
    """Return the indices in x of elements' losses, by place."""
    found = {}
    for one in acting_in(system):
        names = [*one.element.integrals]
        if LOSS in names:
            head = system.program[one.block :][: kernels.PARAMETERS].view(kernels.ELEMENT)[0]
            found[one.place] = int(head["x"]) + names.index(LOSS)
    return found
