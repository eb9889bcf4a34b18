"""Derivatives of what a record's sensors read by the variational equation, along one run of each piece.

Fitted numbers of the scenario and coordinates of a piece's start are carried together along its run, through
onsets, releases and events (:mod:`antenna_pin.nonlinear.variational`). What sensors read of a state is then
differentiated along the displacement: states next to those of the run are read, none is run to. So filters,
which are linear, and whatever else a sensor makes of a motion are in it.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.differences import few
from antenna_pin.base.state import State
from antenna_pin.fit.bench import Bench
from antenna_pin.fit.pieces import from_origin, piece_start
from antenna_pin.fit.runs import (
    Asked,
    Readings,
    Rig,
    Slopes,
    bench_of,
    nothing,
    reason_of,
    rows_of,
    sensed,
    until_of,
)
from antenna_pin.fit.sensors import instants
from antenna_pin.nonlinear.chart import Chart, Displacer
from antenna_pin.nonlinear.coordinates import Lift, Units
from antenna_pin.nonlinear.perturbed_system import Numbers
from antenna_pin.nonlinear.variational import Carrier
from antenna_pin.sensitivity import GrazeError, SensitivityError
from antenna_pin.simulation.inputs import check_without_controllers
from antenna_pin.simulation.samples import Chunk

__all__ = ["with_slopes"]

Array = NDArray[np.float64]

# Step of differences of first states, in a number's size or in an error scale; and of what is read of states,
# in error scales of the displacement: a thousandth of the depth of a light contact, about.
_START, _READ = 1e-3, 1e-6
# Weights of differences of fourth order, of values at one and two steps ahead less those behind.
_FOURTH = np.array([8.0, -1.0]) / 12.0
# Step in time of what a clock's shift does, beside what is between two rows.
_TICK = 1e-4


class _Carried(NamedTuple):
    """States of one run, and how they are displaced with what is fitted.

    Attributes:
        chunk: The states, the last at the run's end.
        ways: Displacements, (n, displacement, fitted).
        words: Derivatives of the program there, (n, numbers, words).
    """

    chunk: Chunk
    ways: Array
    words: Array


def with_slopes(rig: Rig, asked: Asked) -> tuple[Readings, ...]:
    """Return what sensors read of some runs, with the derivatives; where there are none it is said why.

    Raises:
        KeyboardInterrupt: It was interrupted.
    """
    try:
        return _Equation(rig, asked).readings()
    except Exception as error:
        return tuple(nothing(reason_of(error)) for _ in asked.starts)


class _Equation:
    """A record's test at one set of values, beside its neighbours in each of its numbers."""

    def __init__(self, rig: Rig, asked: Asked) -> None:
        """Build the neighbours; differentiate what the system is made of."""
        self._rig, self._asked, self._at = rig, asked, functools.cache(self._neighbour)
        self._here = bench_of(rig, asked.values)
        check_without_controllers("fit: derivatives by the equation", self._here.scenario)
        system, self._count = self._here.system, len(asked.values)
        self._scales = np.fmax(np.abs(asked.values), rig.sizes)
        names = [keys[0] if keys else name for keys, name in zip(rig.keys, rig.names, strict=True)]
        builds = [functools.partial(self._system, k) for k in range(self._count)]
        self._next = Displacer(system, self._count)
        self._numbers = Numbers(system, builds, names)
        # A neighbour begins with its own numbers of elements; what these keep is displaced by itself.
        self._numbers.slopes["program"][:, self._next.kept.words] = 0.0

    def _neighbour(self, k: int, s: float) -> Bench:
        """Return the test with one of its numbers so many sizes farther."""
        if s == 0.0:
            return self._here
        values = list(self._asked.values)
        values[k] += s * float(self._scales[k])
        found = bench_of(self._rig, tuple(values))
        if found.scenario.events != self._here.scenario.events:
            raise SensitivityError(f"{self._rig.names[k]} is of an event, which only runs can tell")
        return found

    def _system(self, k: int, s: float) -> Any:
        return self._at(k, s).system

    # --- states ---------------------------------------------------------------------------------------------

    def _first(self, bench: Bench, piece: int, at: Array) -> State:
        if piece <= 0:
            return bench.first
        return piece_start(self._rig.begun, self._rig.origins[piece - 1], at, bench.system)

    def _neighbours(self, piece: int, at: Array) -> list[Callable[[float], State]]:
        """Return how the first state of a piece is found with each number, and coordinate, farther."""

        def of_number(k: int, s: float) -> State:
            return self._first(self._at(k, s), piece, at)

        def of_start(i: int, s: float) -> State:
            return self._first(self._here, piece, at + s * np.eye(len(at))[i])

        numbers = [functools.partial(of_number, k) for k in range(self._count)]
        return [*numbers, *(functools.partial(of_start, i) for i in range(len(at)))]

    def _apart(self, here: State, there: State) -> Array:
        """Return the displacement of a neighbour's first state, without that of a number itself."""
        found = self._next.between(here, there)
        if found is None:
            raise GrazeError("other contacts touch where a neighbour starts", here.time)
        return found

    def _carried(self, piece: int, at: Array, times: Array, until: float) -> tuple[_Carried, State]:
        """Return the states of a piece's run at times and at its end, displaced, and its first state."""
        first = self._first(self._here, piece, at)
        neighbours = self._neighbours(piece, at)

        def apart(there: Callable[[float], State], s: float) -> Array:
            return self._apart(first, there(s))

        columns = [_slope(functools.partial(apart, one)) for one in neighbours]
        # A start without anything that is fitted has no columns.
        ways = np.column_stack(columns) if columns else np.zeros((self._next.parts[-1].stop, 0))
        ways[self._next.parts[-3], : self._count] = np.eye(self._count)

        def start(lift: Lift) -> Array:
            return np.asarray(lift.down @ ways)

        seen: list[tuple[Any, ...]] = []

        def see(carrier: Carrier, time: float, y: Array, ways: Array) -> None:
            field = carrier.field
            if not np.isfinite(ways).all():
                when = max((one.time for one in carrier.passed if one.time <= time), default=time)
                said = (
                    "a contact or an event comes with no speed, or blows that feel each other come together"
                )
                raise GrazeError(f"at {when:.9g} s {said}", when)
            words = np.zeros((0, 0)) if field.numbers is None else field.numbers.program.copy()
            memory, program = field.workspace.memory.copy(), field.workspace.program.copy()
            seen.append((time, y.copy(), memory, program, ways.copy(), words))

        flow = self._here.flow
        frame = Chart(flow.system, first).frame
        looks = np.unique(np.append(times[times >= first.time], until)).tolist()
        flow.carry(first, until - first.time, frame, start, numbers=self._numbers, looks=looks, seen=see)
        when, states, memories, programs, found, words = zip(*seen, strict=True)
        chunk = Chunk(np.array(when), np.array(states), np.array(memories), list(programs))
        return _Carried(chunk, np.array(found), np.array(words)), first

    def _moved(self, carried: _Carried, column: int, s: float) -> Chunk:
        """Return states displaced along one of what is fitted so far."""
        number = column < self._count
        there = self._at(column, s).system if number else self._here.system
        words = s * carried.words[:, column] if number else np.zeros((1, 1))
        return self._next.states(carried.chunk, s * carried.ways[..., column], words, there)

    def _step(self, carried: _Carried, column: int) -> float:
        """Return a step of what is read along a displacement."""
        units = Units.of(self._here.system)
        way, rate = self._next.parts[:2]
        sizes = [
            np.abs(carried.ways[:, part, column]) / unit
            for part, unit in ((way, units.way), (rate, units.rate))
        ]
        return _READ / max(1.0, *(float(one.max(initial=0.0)) for one in sizes))

    # --- readings -------------------------------------------------------------------------------------------

    def readings(self) -> tuple[Readings, ...]:
        """Return what sensors read, with derivatives by numbers, by the clock's shift and by the start."""
        rig, asked, here = self._rig, self._asked, self._here
        rows = [rows_of(rig, asked.shift, piece) for piece, _ in asked.starts]
        made = []
        for own, (piece, at) in zip(rows, asked.starts, strict=True):
            wanted = [instants(column, own) for column in rig.columns.values()]
            until = until_of(rig, here, piece, own)
            made.append(self._carried(piece, np.array(at), np.unique(np.concatenate(wanted)), until))
        columns = sensed(rig, here, rows, [one.chunk for one, _ in made])
        fitted = [self._count + len(at) for _, at in asked.starts]
        tables = [[np.zeros((len(part), n)) for part in own] for own, n in zip(columns, fitted, strict=True)]
        ends = [np.zeros((len(self._end(k, one.chunk)), n)) for k, ((one, _), n) in self._each(made, fitted)]
        for column in range(max(fitted)):
            pieces = [k for k, n in enumerate(fitted) if column < n]
            steps = [self._step(made[k][0], column) for k in pieces]
            if column < self._count:  # all are read of one neighbour's system
                steps = [min(steps)] * len(steps)
            sides = [
                [self._moved(made[k][0], column, side * j * h) for k, h in zip(pieces, steps, strict=True)]
                for j in (1, 2)
                for side in (1, -1)
            ]
            read = self._read(pieces, rows, sides, column, steps)
            for n, (k, h) in enumerate(zip(pieces, steps, strict=True)):
                for c in range(len(rig.columns)):
                    values = [one[n][c] for one in read]
                    tables[k][c][:, column] = _fourth(values, h)
                ends[k][:, column] = _fourth([self._end(k, one[n]) for one in sides], h)
        found = []
        for k, (piece, at) in enumerate(asked.starts):
            lead, slopes = self._lead(piece, made[k][1], np.array(at))
            clock = self._clock(piece, np.array(at), rows[k]) if asked.clock else None
            sizes = np.concatenate([self._scales, np.ones(len(at))])
            slopes_of = Slopes(
                tuple(one / sizes for one in tables[k]), slopes / sizes, ends[k] / sizes, clock
            )
            found.append(Readings(tuple(columns[k]), lead, self._end(k, made[k][0].chunk), slopes=slopes_of))
        return tuple(found)

    def _each(self, made: Sequence[Any], fitted: Sequence[int]) -> Any:
        return enumerate(zip(made, fitted, strict=True))

    def _read(
        self,
        pieces: Sequence[int],
        rows: Sequence[Array],
        sides: Sequence[Sequence[Chunk]],
        column: int,
        steps: Sequence[float],
    ) -> list[list[list[Array]]]:
        """Return what sensors read of displaced states: by side, piece and sensor."""
        own = [rows[k] for k in pieces]
        if column >= self._count:
            read = sensed(self._rig, self._here, own * len(sides), [one for side in sides for one in side])
            return [read[i * len(pieces) : (i + 1) * len(pieces)] for i in range(len(sides))]
        signs = [side * j for j in (1, 2) for side in (1, -1)]
        return [
            sensed(self._rig, self._at(column, sign * steps[0]), own, list(chunks))
            for sign, chunks in zip(signs, sides, strict=True)
        ]

    def _end(self, k: int, chunk: Chunk) -> Array:
        """Return where a run ends, about the next piece's origin."""
        piece, model = self._asked.starts[k][0], self._here.system.model
        if not self._rig.pieces or piece >= len(self._rig.pieces) - 2:
            return np.zeros(0)
        q, v = np.split(chunk.states[-1][: model.nq + model.nv], [model.nq])
        return from_origin(self._rig.begun, self._rig.origins[piece], q, v)

    def _lead(self, piece: int, first: State, at: Array) -> tuple[Array, Array]:
        """Return where a piece starts, about its origin, and the derivatives of that."""
        if piece <= 0:
            return np.zeros(0), np.zeros((0, self._count + len(at)))
        begun, origin = self._rig.begun, self._rig.origins[piece - 1]

        def lead(there: Callable[[float], State], s: float) -> Array:
            found = there(s)
            return from_origin(begun, origin, found.q, found.v)

        columns = [_slope(functools.partial(lead, one)) for one in self._neighbours(piece, at)]
        return from_origin(begun, origin, first.q, first.v), np.column_stack(columns)

    def _clock(self, piece: int, at: Array, rows: Array) -> tuple[Array, ...]:
        """Return derivatives of what sensors read over time: of the run's own dense output."""
        rig, here = self._rig, self._here
        h = _TICK * float(np.median(np.diff(rig.time)))
        shifted = np.concatenate([rows + side * j * h for j in (1, 2) for side in (1, -1)])
        first = self._first(here, piece, at) if piece > 0 else None
        until = until_of(rig, here, piece, rows) + 2.0 * h
        wanted = np.unique(np.concatenate([instants(c, np.unique(shifted)) for c in rig.columns.values()]))
        ran = here.run(wanted[wanted >= 0.0], until, first)
        (read,) = sensed(rig, here, [shifted], [ran.chunk])
        return tuple(_fourth(np.split(one, 4), h) for one in read)


def _slope(function: Callable[[float], Array]) -> Array:
    """Return a derivative at zero, of sixth order or as good."""
    return few(lambda j: function(j * _START), _START)[0]


def _fourth(values: Sequence[Array], h: float) -> Array:
    """Return a derivative of fourth order from values at h, -h, 2 h and -2 h."""
    ahead, behind, farther, farthest = values
    return np.asarray((_FOURTH[0] * (ahead - behind) + _FOURTH[1] * (farther - farthest)) / h)
