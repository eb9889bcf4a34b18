"""Coordinates of perturbed states: their axes in a state, and as perturbations."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Collection, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.base.arrays import Array
from antenna_pin.base.settings import ErrorScales
from antenna_pin.base.state import State
from antenna_pin.dynamics import System, Workspace, acting_in, kernels
from antenna_pin.dynamics.constraints import directions
from antenna_pin.dynamics.mode_kernels import is_held, mode_of
from antenna_pin.elements import Modal, kind_of
from antenna_pin.integrate import KINDS
from antenna_pin.run.simulation.steps import scale_vector

# --- memory of elements with modes --------------------------------------------------------------------------


class _MemoryNumber(NamedTuple):
    """Number that an element with modes stores at a change of mode."""

    place: str  # place of the element
    name: str  # name in the element
    label: str  # name in messages
    kind: int  # kind of the element
    words: int  # start of the element's record in a program
    word: int  # place of the number in a program
    joint: int  # index of the joint's axis in v
    of_rate: bool  # whether it is a rate of the joint, else a position
    turns: bool  # whether the joint turns without end, so that whole turns have no effect
    modes: tuple[int, ...]  # modes in which the number is active

    @property
    def key(self) -> str:
        """Key among the adjusted numbers of a state."""
        return f"{self.place}.{self.name}"

    def holds(self, program: Array) -> bool:
        """Return whether the element holds its joint, by a row."""
        return bool(is_held(self.kind, program, self.words))


class ElementMemory:
    """Numbers that the elements of a system store at changes of mode."""

    def __init__(self, system: System) -> None:
        self.numbers = tuple(_memory_numbers(system))
        self.words = np.array([one.word for one in self.numbers], dtype=int)
        self.masses = tuple(takes for joint in system.clearances for takes in joint.takes_mass)

    def __len__(self) -> int:
        """Return how many there are, active or not."""
        return len(self.numbers)

    def active_in(self, program: Array) -> tuple[int, ...]:
        """Return the numbers that act in the modes of a program."""
        found = [mode_of(one.kind, program, one.words) in one.modes for one in self.numbers]
        return tuple(np.flatnonzero(found).tolist())

    def between(self, numbers: tuple[int, ...], here: State, there: State) -> Array:
        """Return the differences of some numbers from one state to another, (numbers,)."""
        first, then = (dict(state.adjusted) for state in (here, there))
        out = []
        for one in (self.numbers[k] for k in numbers):
            change = then.get(one.key, 0.0) - first.get(one.key, 0.0)  # zero before the first change of mode
            out.append(math.remainder(change, 2.0 * math.pi) if one.turns and not one.of_rate else change)
        return np.array(out)

    def units(self, ways: Array, rates: Array) -> Array:
        """Return the unit of each number, (memory,), of units of positions and rates, (nv,) each."""
        return np.array([(rates if one.of_rate else ways)[one.joint] for one in self.numbers])


def _memory_numbers(system: System) -> Iterator[_MemoryNumber]:
    for one in acting_in(system):
        element = one.element
        if not isinstance(element, Modal):
            continue
        words = one.block + int(kernels.PARAMETERS)
        head = system.program[one.block :][: kernels.PARAMETERS].view(kernels.ELEMENT)[0]
        joint = _axis(system, int(head["v"]), element.acts_at)
        for name, of in element.goes_by.items():
            at = _word_of(element, name)
            if at is not None:
                label, modes = f"{one.label} {name}", element.goes_by_in
                kind, of_rate, turns = kind_of(type(element)), of == "rate", int(head["turn"]) >= 0
                yield _MemoryNumber(
                    one.place, name, label, kind, words, words + at, joint, of_rate, turns, modes
                )


def _axis(system: System, start: int, joint: str | None) -> int:
    """Return the index in v of a joint's axis; with play, the last."""
    return start if joint is None else system.mechanism.joint(joint).v.stop - 1


def _word_of(element: Modal, name: str) -> int | None:
    """Return the word of an element's record that holds a number, or None."""
    changes: dict[str, Any] = {name: getattr(element, name) + 1.0}
    other = dataclasses.replace(element, **changes).words_of_kernel()
    found = np.flatnonzero(other != element.words_of_kernel())
    return int(found[0]) if len(found) else None


# --- axes of coordinates in a state -------------------------------------------------------------------------

#: Columns of contact memory besides touching.
CONTACT_MEMORY = {1: "approach speed", 2: "effective mass"}
#: Unit of time as a coordinate [s].
TIME_UNIT = 1e-2


class Units(NamedTuple):
    """Units of a perturbation: the run's error scales."""

    position: Array  # units of the configuration, (nv,)
    rate: Array  # units of the velocity, (nv,)
    bristle: Array  # units of bristles, (bristles,)

    @classmethod
    def of(cls, system: System, scales: ErrorScales | None = None) -> Units:
        """Return the units of a system."""
        nv, every = system.model.nv, scale_vector(system, scales or ErrorScales())
        return cls(every[:nv], every[nv : 2 * nv], every[2 * nv + np.asarray(system.bristle_x, dtype=int)])


class Frame(NamedTuple):
    """Axes of coordinates in a state."""

    free: Array  # freedoms under closures and motions, in units, by columns, (nv, positions)
    bound: Array  # their orthogonal complement, (nv, nv - positions)
    contact_memory: tuple[tuple[int, int], ...]  # contact and column of each coordinate of contact memory
    element_memory: tuple[int, ...] = ()  # numbers of element memory that are coordinates
    # whether time is a coordinate, behind positions and rates: the delay of the perturbed state
    clock: bool = False

    @property
    def positions(self) -> int:
        """Number of coordinates of positions, as many as of rates."""
        return int(self.free.shape[1])

    @property
    def first_bristle(self) -> int:
        """Index of the first coordinate of a bristle."""
        return 2 * self.positions + int(self.clock)


class Lift(NamedTuple):
    """Coordinates about a state as perturbations, and back.

    A perturbation, (2 nv + bristles + 2 contacts + parameters + kept + 1,), consists of changes of the
    configuration in the coordinates of velocities, of the velocity, of bristles, of the logarithms of
    approach speeds and of effective masses, of parameters of the system in their scales, of element memory,
    of time. Coordinates are positions, rates, time if included, bristles, parameters, element memory, contact
    memory.
    """

    up: Array  # perturbation of each coordinate, by columns, (perturbation, size)
    down: Array  # coordinates of a perturbation, (size, perturbation)


class RateJacobian(NamedTuple):
    """Jacobian of the rates in a state."""

    # of the coordinates' rates over the coordinates, by differences of sixth order, (size, size)
    sixth: Array
    fourth: Array  # the same by differences of fourth order
    along: Array  # derivative of rates along one perturbation, in units, (nv + bristles,)
    noise: float  # round-off of ``along``
    integrals: Array  # of the rates of what is integrated over the coordinates, (nx, size)


def perturbation_slices(system: System, memory: int, parameters: int = 0) -> tuple[slice, ...]:
    """Return the slices of a perturbation.

    They are displacement, rate, bristles, approach speeds, masses, parameters, stored numbers, time.
    """
    nv, contacts = system.model.nv, len(system.contact_names)
    sizes = [nv, nv, len(system.bristle_x), contacts, contacts, parameters, memory, 1]
    ends = np.cumsum(sizes).tolist()
    return tuple(slice(end - size, end) for end, size in zip(ends, sizes, strict=True))


def own_coordinates(
    frame: Frame, size: int, lasting: Collection[int], constant: Collection[int] = ()
) -> NDArray[np.bool_]:
    """Return which coordinates belong to a perturbed state alone, (size,).

    The memory of a contact is constant while it lasts: over that time it is a parameter of the motion, common
    to perturbed states. The same holds for constant element memory.
    """
    own = np.ones(size, dtype=bool)
    remembered = size - len(frame.contact_memory)
    for k, (contact, _) in enumerate(frame.contact_memory, remembered):
        own[k] = contact not in lasting
    for k, number in enumerate(frame.element_memory, remembered - len(frame.element_memory)):
        own[k] = number not in constant
    return own


def _contact_memory(masses: Sequence[bool], touching: Array) -> tuple[tuple[int, int], ...]:
    """Return contact and column of the contact memory that forces depend on."""
    touch = np.flatnonzero(touching).tolist()
    return tuple((c, column) for c in touch for column in ((1, 2) if masses[c] else (1,)))


def frame_at(
    workspace: Workspace, units: Units, y: Array, touching: Array, element_memory: ElementMemory
) -> Frame:
    """Return the axes of coordinates in a state."""
    system, constraints = workspace.system, workspace.constraints
    memories, nv = _contact_memory(element_memory.masses, touching), system.model.nv
    numbers = element_memory.active_in(workspace.program)
    if constraints is None:
        return Frame(np.eye(nv), np.zeros((nv, 0)), memories, numbers)
    left = directions(constraints, y, workspace.program, motions=True, holds=True)
    free = left.shape[1]
    # Without holding elements the axes are those of the joints.
    ways = np.eye(nv) if free == nv else np.linalg.svd(left / units.position[:, None])[0]
    return Frame(
        np.ascontiguousarray(ways[:, :free]), np.ascontiguousarray(ways[:, free:]), memories, numbers
    )


def configuration_difference(system: System, here: Array, there: Array) -> Array:
    """Return the tangent vector from one configuration to another, (nv,).

    Pinocchio's own loses rotations of 1e-8 rad and less of joints without limits or in a plane, and in a
    plane has positions by 1 - cos of the angle.
    """
    way: Array = pin.difference(system.model, here, there)
    i = j = 0
    for kind in system.manifold.kinds:
        _, nq, nv = KINDS[kind]
        if kind in ("circle", "plane"):
            (c, s), (cosine, sine) = here[i + nq - 2 : i + nq], there[i + nq - 2 : i + nq]
            turn = math.atan2(c * sine - s * cosine, c * cosine + s * sine)
            way[j + nv - 1] = turn
            if kind == "plane":
                x, y = there[i] - here[i], there[i + 1] - here[i + 1]
                x, y = c * x + s * y, c * y - s * x
                half = 0.5 * turn
                share = half / math.tan(half) if half != 0.0 else 1.0
                way[j : j + 2] = share * x + half * y, share * y - half * x
        i, j = i + nq, j + nv
    return way


# --- coordinates as perturbations, on what constraints hold -------------------------------------------------

_CACHED = 2  # of states and of axes: where a step begins and ends, and old and new axes there
_FAINT = 1e-10  # of what rows of constraints do, over the most: less is what round-off has left


class _CachedLift(NamedTuple):
    """Lift in a cache."""

    frame: Frame  # axes of the lift
    lift: Lift  # the lift
    tilt: float  # by how much the axes are off what constraints leave, as the tangent of an angle, in units


class _ConstraintsAt(NamedTuple):
    """Constraints in a state."""

    key: tuple[float, bytes, bytes]  # time, state and program
    time: float  # time [s]
    y: Array  # state
    rows: Array  # rows of constraints, (rows, nv)
    over_time: Array  # explicit time derivative of constraints, (rows,)
    over_numbers: Array  # derivatives of gaps and speeds over system numbers, (2, rows, numbers)
    lifts: list[_CachedLift]  # lifts in this state


class Lifts:
    """Lifts of coordinates to perturbations, with a cache.

    ``speeds(time, y, positions) -> (rows, k)`` are derivatives of constraint velocities along perturbations,
    at constant numbers of the system; ``over_numbers(time, y) -> (2, rows, numbers)`` those of residuals and
    velocities over these.
    """

    def __init__(
        self,
        workspace: Workspace,
        units: Units,
        element_memory: ElementMemory,
        parts: tuple[slice, ...],
        speeds: Callable[[float, Array, Array], Array],
        over_numbers: Callable[[float, Array], Array],
    ) -> None:
        self._workspace, self._units, self._kept, self._parts = workspace, units, element_memory, parts
        self._kept_units = element_memory.units(units.position, units.rate)
        self._speeds, self._over_numbers = speeds, over_numbers
        self._states: list[_ConstraintsAt] = []
        self._free: list[_CachedLift] = []  # without constraints they are the same in every state

    def lift(self, frame: Frame, time: float, y: Array) -> Lift:
        """Return the coordinates of a frame as perturbations of a state near its own.

        Closures and motions hold in perturbed states, to first order: they determine a perturbation across
        the axes.
        """
        return self._at(frame, time, y).lift

    def tilt(self, frame: Frame, time: float, y: Array) -> float:
        """Return the angle between a frame's axes and the constraints' freedoms, as a tangent."""
        return self._at(frame, time, y).tilt

    def _at(self, frame: Frame, time: float, y: Array) -> _CachedLift:
        held = None if self._workspace.constraints is None else self._held_at(time, y)
        lifts = self._free if held is None else held.lifts
        for one in lifts:
            if one.frame is frame:
                return one
        units, (way, rate, bristles, *remembered, numbers, _, clock) = self._units, self._parts
        n, nb, nk, nm = (
            frame.positions,
            len(self._units.bristle),
            len(frame.element_memory),
            len(frame.contact_memory),
        )
        count, first = numbers.stop - numbers.start, frame.first_bristle
        size = first + nb + count + nk + nm
        up, down = np.zeros((self._parts[-1].stop, size)), np.zeros((size, self._parts[-1].stop))
        ways, rates, own = slice(n), slice(n, 2 * n), slice(first, first + nb)
        up[way, ways], down[ways, way] = units.position[:, None] * frame.free, frame.free.T / units.position
        up[rate, rates], down[rates, rate] = units.rate[:, None] * frame.free, frame.free.T / units.rate
        up[bristles, own], down[own, bristles] = np.diag(units.bristle), np.diag(1.0 / units.bristle)
        up[clock, 2 * n : first], down[2 * n : first, clock] = TIME_UNIT, 1.0 / TIME_UNIT
        parameters = slice(own.stop, own.stop + count)
        up[numbers, parameters] = down[parameters, numbers] = np.eye(count)
        for k, number in enumerate(frame.element_memory, parameters.stop):
            at, unit = self._parts[-2].start + number, self._kept_units[number]
            up[at, k], down[k, at] = unit, 1.0 / unit
        for k, (contact, column) in enumerate(frame.contact_memory, parameters.stop + nk):
            at = remembered[column - 1].start + contact
            up[at, k] = down[k, at] = 1.0
        tilt = 0.0 if held is None else self._hold(up, frame, held)
        made = _CachedLift(frame, Lift(up, down), tilt)
        lifts.insert(0, made)
        del lifts[_CACHED:]
        return made

    def _held_at(self, time: float, y: Array) -> _ConstraintsAt:
        """Return the constraints in a state."""
        constraints, program = self._workspace.constraints, self._workspace.program
        assert constraints is not None
        key = time, y.tobytes(), program.tobytes()
        for one in self._states:
            if one.key == key:
                return one
        nq, nv = self._workspace.model.nq, self._workspace.model.nv
        self._workspace.prepare_motions(time, y)
        constraints.residuals(time, y, program)
        rows = constraints.every_row.copy()
        # At fixed state gaps change at the prescribed rates.
        over_time = constraints.every_speed - rows @ y[nq : nq + nv]
        over = self._over_numbers(time, y)
        found = _ConstraintsAt(key, time, y.copy(), rows, over_time, over, [])
        self._states = [found, *self._states[: _CACHED - 1]]
        return found

    def _hold(self, up: Array, frame: Frame, constraints: _ConstraintsAt) -> float:
        """Make perturbations hold closures and motions, in place; return the tilt of axes."""
        way, rate, *_, numbers, _, _ = self._parts
        n, clock = frame.positions, list(range(2 * frame.positions, frame.first_bristle))
        rows, over = constraints.rows, constraints.over_numbers
        across = self._units.position[:, None] * frame.bound
        first = frame.first_bristle + len(self._units.bristle)
        last = first + numbers.stop - numbers.start
        # Constraints depend on the configuration, on time, and on numbers of the system and its elements.
        places = [*range(n), *clock, *range(first, last + len(frame.element_memory))]
        gaps = [
            np.outer(constraints.over_time, up[-1, clock]),
            over[0],
            self._gaps_over_kept(frame, constraints),
        ]
        off = np.hstack([rows @ up[way, :n], *gaps])
        back = np.linalg.lstsq(rows @ across, off, rcond=_FAINT)[0]
        up[way, places] -= across @ back
        moved = up[:, places]
        turned = self._speeds(constraints.time, constraints.y, moved) + over[1] @ moved[numbers]
        across = self._units.rate[:, None] * frame.bound
        off = np.hstack([turned, rows @ up[rate, n : 2 * n]])
        up[rate, [*places, *range(n, 2 * n)]] -= across @ np.linalg.lstsq(rows @ across, off, rcond=_FAINT)[0]
        return float(np.abs(back[:, :n]).max(initial=0.0))

    def _gaps_over_kept(self, frame: Frame, state: _ConstraintsAt) -> Array:
        """Return the derivatives of constraints over element memory, in its units, (rows, k).

        A row that holds a joint goes with its place, linearly.
        """
        constraints, program = self._workspace.constraints, self._workspace.program
        assert constraints is not None
        columns = [np.zeros((len(constraints.every_row), 0))]
        for number in frame.element_memory:
            word, step = self._kept.words[number], float(self._kept_units[number])
            kept, found = program[word], []
            for side in (0.5, -0.5):
                program[word] = kept + side * step
                constraints.residuals(state.time, state.y, program)
                found.append(constraints.every_gap.copy())
            program[word] = kept
            columns.append((found[0] - found[1])[:, None])
        return np.hstack(columns)
