"""Coordinates about a state of states near it, and states of other systems."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.records import memory_records
from antenna_pin.base.settings import ErrorScales, RunSettings
from antenna_pin.base.state import OpenContact, State
from antenna_pin.dynamics import Adjustments, System, Workspace, acting_in, modes_in_another, modes_kept
from antenna_pin.dynamics.constraints import Constraints, directions
from antenna_pin.elements import Modal
from antenna_pin.errors import InvalidParameterError
from antenna_pin.run.simulation.inputs import check_sizes
from antenna_pin.run.simulation.loop import Run
from antenna_pin.run.simulation.samples import Chunk
from antenna_pin.studies.nonlinear.coordinates import (
    CONTACT_MEMORY,
    ElementMemory,
    Units,
    configuration_difference,
    frame_at,
    perturbation_slices,
)

# --- modes of elements in a state ---------------------------------------------------------------------------


class NotAlikeError(InvalidParameterError):
    """Two states without a numerical distance: contacts that touch or modes of elements differ."""


class _ElementMode(NamedTuple):
    """Mode of an element in a state."""

    label: str  # name in messages
    number: int  # number of the mode
    word: str  # name of the mode


def _element_modes(system: System, state: State) -> Mapping[str, _ElementMode]:
    """Return the modes of elements in a state, by their places."""
    acting = {one.place: one for one in acting_in(system)}
    modal = {place: one for place, one in acting.items() if isinstance(one.element, Modal)}
    numbers = {place: one.element.mode for place, one in modal.items()}  # type: ignore[attr-defined]
    for key, value in state.adjusted:
        place, _, name = key.rpartition(".")
        if place in modal and name in modal[place].element.own_keys():
            if name == "mode":
                numbers[place] = int(value)
        elif value != (own := float(getattr(acting[place].element, name))):
            rule = (
                f"one in which no event has left {key} at another value than its own, {own:g}, and no latch "
                "has switched anything off; begin at another instant"
            )
            raise InvalidParameterError("chart", "state", rule, value)
    return {
        place: _ElementMode(one.label, numbers[place], one.element.modes[numbers[place]])  # type: ignore[attr-defined]
        for place, one in modal.items()
    }


def set_modes(workspace: Workspace, state: State) -> None:
    """Set the modes of a state in a workspace's program."""
    if state.adjusted:
        adjustments = Adjustments(workspace.system, workspace.program)
        for place, value in state.adjusted:
            adjustments.set(place, value)


def _check_same_modes(origin: Mapping[str, _ElementMode], other: Mapping[str, _ElementMode]) -> None:
    """Refuse modes that differ from those of the origin."""
    for place, one in origin.items():
        if other[place].number != one.number:
            rule = (
                f"{one.word!r} as at the origin; begin at another instant, or, if it changes once and for "
                "good as a latch does, behind that"
            )
            raise NotAlikeError("chart", one.label, rule, other[place].word)


# Newton's iterations onto closures; residuals over the plan's length of convergence, and of closed states,
# as in a run's corrections.
_ROUNDS, _CLOSED, _OPEN = 25, 1e-14, 1e-11
# Relative singular values of constraint rows below which they are redundant but for round-off.
_FAINT = 1e-10


class OutOfReachError(InvalidParameterError):
    """Coordinates at which closures cannot hold, or at which Newton's method fails."""


class Chart:
    """Coordinates of states near an origin, (size,).

    They are the freedoms under closures and motions, in units of the run's error scales: positions, then
    their rates; bristles; element memory, such as the place at which a joint began to stick; and for each
    touching contact the logarithm of its approach speed, which is discrete state too. Integrals without
    feedback (works, impulses) and whole turns are excluded.

    Coordinates are components along the freedoms, of the displacement from the origin and of the change of
    velocity. The remaining components of a state follow from closures and motions: a tangent-space
    parametrisation of the constraint manifold (Potra and Yen 1991, Mechanics of Structures and Machines 19,
    77-98).

    Args:
        system: System of the state.
        state: The origin.
        scales: Unit of each kind of quantity.

    Attributes:
        names: Names of the coordinates.
        frame: Their axes.
        units: Their units.
    """

    def __init__(self, system: System, state: State, scales: ErrorScales | None = None) -> None:
        self.system, self.origin = system, state
        self.units = Units.of(system, scales)
        self._workspace, self._kept = Workspace(system), ElementMemory(system)
        self._modes = _element_modes(system, state)
        set_modes(self._workspace, state)
        self.frame = frame_at(self._workspace, self.units, state.y, state.memory[:, 0], self._kept)
        self._own = np.array(self.frame.element_memory, dtype=int)
        self._own_units = self._kept.units(self.units.position, self.units.rate)[self._own]
        self._bristles = np.asarray(system.bristle_x, dtype=int)
        self._remembered = tuple(np.array(self.frame.contact_memory, dtype=int).reshape(-1, 2).T)
        contacts = system.contact_names
        self.names = (
            *self._names("way"),
            *self._names("rate"),
            *(f"bristle {k + 1}" for k in range(len(self._bristles))),
            *(self._kept.numbers[k].label for k in self.frame.element_memory),
            *(f"{contacts[c]} {CONTACT_MEMORY[column]}" for c, column in self.frame.contact_memory),
        )

    @property
    def positions(self) -> int:
        """Number of coordinates of positions, as many as of rates."""
        return self.frame.positions

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return len(self.names)

    @property
    def held_directions(self) -> int:
        """Number of directions removed by elements that hold their joints."""
        constraints, program = self._workspace.constraints, self._workspace.program
        if constraints is None:
            return 0
        free = int(directions(constraints, self.origin.y, program, motions=True).shape[1])
        places = sum(self._kept.numbers[k].holds(program) for k in self.frame.element_memory)
        return max(2 * (free - self.positions) - places, 0)

    @property
    def of_rates(self) -> tuple[int, ...]:
        """Numbers of element memory that are rates, such as an approach speed."""
        return tuple(k for k in self.frame.element_memory if self._kept.numbers[k].of_rate)

    def _names(self, what: str) -> list[str]:
        model, free = self.system.model, self.frame.free
        if free.shape[1] < model.nv:
            return [f"{what} {k + 1}" for k in range(free.shape[1])]
        names = []
        for j in range(1, model.njoints):
            joint = model.joints[j]
            names += [
                f"{model.names[j]} {what}" + (f" {k + 1}" if joint.nv > 1 else "") for k in range(joint.nv)
            ]
        return names

    def state(self, z: Array, system: System | None = None) -> State:
        """Return the state at coordinates z, (size,): on the constraints, at the origin's time.

        Args:
            z: Coordinates.
            system: System of closures and motions, by default the chart's own: another of the same shape, so
                that states of systems that differ by a parameter have coordinates in one chart.

        Raises:
            OutOfReachError: Closures cannot hold there.
            InvalidParameterError: The system is of another shape.
        """
        model, origin = self.system.model, self.origin
        n, nq, nv = self.positions, model.nq, model.nv
        y = origin.y
        way = self.frame.free @ z[:n]
        self._workspace.retract(y, self.units.position * way)
        y[nq : nq + nv] += self.units.rate * (self.frame.free @ z[n : 2 * n])
        bristles = 2 * n + len(self._bristles)
        y[nq + nv + self._bristles] += self.units.bristle * z[2 * n : bristles]
        numbers = bristles + len(self._own)
        adjusted = self._with_kept(self._own_units * z[bristles:numbers])
        workspace = self._workspace
        if system is not None and system is not self.system:
            check_sizes(system, origin)
            workspace = Workspace(system)
        if workspace.constraints is not None:
            set_modes(workspace, dataclasses.replace(origin, adjusted=adjusted))
            self._close(workspace, workspace.constraints, y, way)
        memory = origin.memory.copy()
        memory[self._remembered] *= np.exp(z[numbers:])
        contacts = tuple(
            dataclasses.replace(
                one,
                approach_speed=float(memory[one.contact, 1]),
                effective_mass=float(memory[one.contact, 2]),
            )
            for one in origin.contacts
        )
        return dataclasses.replace(
            origin,
            reached=origin.time,
            q=y[:nq].copy(),
            v=y[nq : nq + nv].copy(),
            x=y[nq + nv :].copy(),
            memory=memory,
            contacts=contacts,
            adjusted=adjusted,
        )

    def _with_kept(self, changes: Array) -> tuple[tuple[str, float], ...]:
        """Return the adjusted numbers of the origin with perturbed element memory."""
        values = dict(self.origin.adjusted)
        for k, change in zip(self.frame.element_memory, changes.tolist(), strict=True):
            values[self._kept.numbers[k].key] += change
        return tuple(values.items())

    def _close(self, workspace: Workspace, constraints: Constraints, y: Array, way: Array) -> None:
        """Bring a state onto constraints in place, across the freedoms only."""
        model, time, length = self.system.model, self.origin.time, constraints.plan.length
        nq, nv, bound = model.nq, model.nv, self.frame.bound
        last = math.inf
        for _ in range(_ROUNDS):
            workspace.prepare_motions(time, y)
            found = constraints.residuals(time, y, workspace.program)
            now = max(found.gap, found.turn * length)
            # Converged to round-off. Without convergence the next step may lead anywhere, such as to another
            # closure of the loop.
            if now <= _CLOSED * length or not now < last:
                break
            last = now
            moved = pin.dIntegrate(model, self.origin.q, self.units.position * way, pin.ArgumentPosition.ARG1)
            rows = constraints.every_row @ moved @ (self.units.position[:, None] * bound)
            way = way - bound @ np.linalg.lstsq(rows, constraints.every_gap, rcond=_FAINT)[0]
            y[:nq] = self.origin.q
            workspace.retract(y, self.units.position * way)
        if not now <= _OPEN * length:
            rule = "so near that closures hold there; take a smaller step"
            raise OutOfReachError("chart", "coordinates", rule, said=f"{now:.1g} m off them")
        rows = constraints.every_row @ (self.units.rate[:, None] * bound)
        v = np.linalg.lstsq(rows, constraints.every_speed, rcond=_FAINT)[0]
        y[nq : nq + nv] -= self.units.rate * (bound @ v)

    def transported(self, z: Array, other: Chart) -> Array:
        """Return a direction of another chart, (its size,), in this chart, (size,).

        The axes of freedoms differ from state to state. Both charts are of one system or of systems of the
        same shape, with the same touching contacts.
        """
        n = other.positions
        way = other.units.position * (other.frame.free @ z[:n]) / self.units.position
        rate = other.units.rate * (other.frame.free @ z[n : 2 * n]) / self.units.rate
        return np.concatenate([self.frame.free.T @ way, self.frame.free.T @ rate, z[2 * n :]])

    def directions(self, v: Array, a: Array) -> Array:
        """Return a velocity and an acceleration, (nv,) each, as a direction in coordinates, (size,)."""
        rest = np.zeros(self.size - 2 * self.positions)
        free = self.frame.free.T
        return np.concatenate([free @ (v / self.units.position), free @ (a / self.units.rate), rest])

    def coordinates(self, state: State) -> Array:
        """Return the coordinates of a state near the origin, (size,), whatever its time.

        Raises:
            NotAlikeError: Other contacts touch in it, or elements are in other modes.
        """
        origin = self.origin
        if not np.array_equal(state.memory[:, 0] != 0.0, origin.memory[:, 0] != 0.0):
            names = np.array(self.system.contact_names)
            touching = ", ".join(names[state.memory[:, 0] != 0.0]) or "none"
            here = ", ".join(names[origin.memory[:, 0] != 0.0]) or "none"
            raise NotAlikeError("chart", "contacts that touch", f"those of the origin ({here})", touching)
        _check_same_modes(self._modes, _element_modes(self.system, state))
        ways = self.frame.free.T @ (
            configuration_difference(self.system, origin.q, state.q) / self.units.position
        )
        rates = self.frame.free.T @ ((state.v - origin.v) / self.units.rate)
        bristles = (state.x - origin.x)[self._bristles] / self.units.bristle
        numbers = self._kept.between(self.frame.element_memory, origin, state) / self._own_units
        memories = np.log(state.memory[self._remembered] / origin.memory[self._remembered])
        return np.concatenate([ways, rates, bristles, numbers, memories])


# --- a state as the start of another system -----------------------------------------------------------------


@takes()
def carried(state: State, system: System, *, scale: float = 1.0) -> State:
    """Return a state as a start of another system of the same shape.

    Positions, velocities, integrals and time are taken over, except for values impossible in the other
    system: they are projected onto its closures and motions, a contact touches if its gap is closed there,
    and the memory of contacts that touch on both sides is retained. Elements continue in their modes, joints
    are held at their present places, and a compliant stop touches if the joint is beyond it. Step sizes start
    again.

    Args:
        state: State left by a run of the one system.
        system: The other.
        scale: Factor on time [-]: the new period of a drive over its old one, so that its phase is retained.

    Raises:
        InvalidParameterError: The state is not as large as one of the other system, or has a joint beyond a
            rigid stop of it.
    """
    check_sizes(system, state)
    time = state.time * scale
    shift = time - state.time
    y = state.y
    workspace, kept = Workspace(system), modes_kept(system, state.adjusted)
    adjustments = Adjustments(system, workspace.program)
    for place, value in kept:
        adjustments.set(place, value)
    if workspace.constraints is not None:
        workspace.hold(time, y, workspace.program)
    system.turn_on(y)
    adjusted = modes_in_another(system, y, time, kept)
    nq, nv = system.model.nq, system.model.nv
    moved = dataclasses.replace(
        state,
        time=time,
        reached=state.reached + shift,
        q=y[:nq].copy(),
        v=y[nq : nq + nv].copy(),
        x=y[nq + nv :].copy(),
        sizes=(),
        error=0.0,
        changed=tuple(0 for _ in state.changed),
        # Events of the other system start anew; their sides are evaluated there.
        events=(),
        adjusted=adjusted,
        contacts=tuple(_shifted(one, shift) for one in state.contacts),
    )
    if not len(state.memory):
        return moved
    # Contacts touch by the rule of all starts.
    begun = Run(system, y, max(1.0, time), RunSettings()).present()
    old = state.memory[:, 0] != 0.0
    new = begun.memory[:, 0] != 0.0
    memory = np.where((old & new)[:, None], state.memory, begun.memory)
    going_on = {one.contact: one for one in moved.contacts if new[one.contact]}
    fresh = {
        one.contact: dataclasses.replace(one, onset=time, peak=(one.peak[0], time, one.peak[2]))
        for one in begun.contacts
    }
    contacts = tuple((fresh | going_on)[c] for c in sorted(fresh | going_on))
    return dataclasses.replace(moved, memory=memory, contacts=contacts)


def _shifted(contact: OpenContact, shift: float) -> OpenContact:
    """Return an open contact with its times [s] shifted."""
    force, when, depth = contact.peak
    return dataclasses.replace(contact, onset=contact.onset + shift, peak=(force, when + shift, depth))


# --- perturbations of whole states, with discrete state -----------------------------------------------------


class StatePerturbation:
    """Perturbations between states of a system, and perturbed states."""

    def __init__(self, system: System, numbers: int) -> None:
        self._system, self.memory = system, ElementMemory(system)
        self.parts = perturbation_slices(system, len(self.memory), numbers)
        self._bristles = np.asarray(system.bristle_x, dtype=int)
        self._workspace = Workspace(system)

    def between(self, here: State, there: State) -> Array | None:
        """Return the perturbation from one state to another, (perturbation,), without that of parameters.

        None if other contacts touch in the other state.
        """
        system = self._system
        ours, theirs = (memory_records(one.memory) for one in (here, there))
        if not np.array_equal(ours["touching"], theirs["touching"]):
            return None
        way, rate, bristles, speeds, masses, _, kept, _ = self.parts
        out = np.zeros(self.parts[-1].stop)
        out[way], out[rate] = configuration_difference(system, here.q, there.q), there.v - here.v
        out[bristles] = there.x[self._bristles] - here.x[self._bristles]
        touch = ours["touching"] != 0.0
        for part, name in ((speeds, "approach_speed"), (masses, "effective_mass")):
            with np.errstate(divide="ignore", invalid="ignore"):
                logs = np.log(theirs[name] / ours[name])
            out[part] = np.where(touch & np.isfinite(logs), logs, 0.0)
        out[kept] = self.memory.between(tuple(range(len(self.memory))), here, there)
        return out

    def states(
        self, chunk: Chunk, moves: Array, words: Array, there: System, books: Array | None = None
    ) -> Chunk:
        """Return perturbed states.

        Args:
            chunk: The states.
            moves: Their perturbations, (n, perturbation).
            words: Further changes of words of the program, (n, words) or zero, (1, 1).
            there: Target system, which selects its numbers with the state.
            books: Changes of the run's integrals, (n, nx); its bristles are in ``moves``.
        """
        system = self._system
        first = system.model.nq + system.model.nv
        way, rate, bristles, speeds, masses, _, kept, _ = self.parts
        states, memories, programs = chunk.states.copy(), chunk.memories.copy(), []
        at = first + self._bristles
        more = np.broadcast_to(words, (len(states), words.shape[1]))
        for i, (y, move) in enumerate(zip(states, moves, strict=True)):
            self._workspace.retract(y, move[way])
            y[system.model.nq : first] += move[rate]
            if books is not None:
                y[first:] += books[i]
            y[at] = chunk.states[i, at] + move[bristles]
            memories[i]["approach_speed"] *= np.exp(move[speeds])
            memories[i]["effective_mass"] *= np.exp(move[masses])
            program = chunk.programs[i] + more[i]
            program[self.memory.words] += move[kept]
            programs.append(program)
            there.turn_on(y)
        return Chunk(chunk.times, states, memories, programs)
