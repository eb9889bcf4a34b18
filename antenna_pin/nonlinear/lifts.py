"""Coordinates about a state as displacements of one, on what closures, motions and elements hold."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Workspace
from antenna_pin.nonlinear.frames import CLOCK, Frame, Lift, Units
from antenna_pin.nonlinear.kept import Kept

__all__ = ["Lifts"]

Array = NDArray[np.float64]

_KEPT = 2  # of states and of axes: where a step begins and ends, and old and new axes there
_FAINT = 1e-10  # of what rows of constraints do, over the most: less is what round-off has left


class _Made(NamedTuple):
    """A lift that was made.

    Attributes:
        frame: Of which axes.
        lift: The lift.
        tilt: By how much the axes are off what constraints leave, as the tangent of an angle, in units.
    """

    frame: Frame
    lift: Lift
    tilt: float


class _Held(NamedTuple):
    """What is held in a state.

    Attributes:
        key: Time, state, and what elements hold there.
        time: When [s].
        y: State.
        rows: Of constraints, (rows, nv).
        over_time: By how much they are violated per second, (rows,).
        over_numbers: How far and how fast over numbers of the system, (2, rows, numbers).
        lifts: Those that were made there.
    """

    key: tuple[float, bytes, bytes]
    time: float
    y: Array
    rows: Array
    over_time: Array
    over_numbers: Array
    lifts: list[_Made]


class Lifts:
    """Makes displacements of coordinates.

    Args:
        workspace: Its program is that of the moment.
        units: Of displacements.
        kept: What elements keep.
        parts: Of a displacement.
        speeds: ``(time, y, ways) -> (rows, k)``: the derivatives along displacements of how fast constraints
            are violated, numbers of the system left as they are.
        over_numbers: ``(time, y) -> (2, rows, numbers)``: how far and how fast they are over these.
    """

    def __init__(
        self,
        workspace: Workspace,
        units: Units,
        kept: Kept,
        parts: tuple[slice, ...],
        speeds: Callable[[float, Array, Array], Array],
        over_numbers: Callable[[float, Array], Array],
    ) -> None:
        """Begin with none."""
        self._workspace, self._units, self._kept, self._parts = workspace, units, kept, parts
        self._kept_units = kept.units(units.way, units.rate)
        self._speeds, self._over_numbers = speeds, over_numbers
        self._states: list[_Held] = []
        self._free: list[_Made] = []  # without constraints they are the same in every state

    def lift(self, frame: Frame, time: float, y: Array) -> Lift:
        """Return the coordinates along a frame's axes as displacements of a state near the frame's own.

        Closures and motions hold in displaced states, to first order: across the axes a displacement is what
        they want it to be.
        """
        return self._made(frame, time, y).lift

    def tilt(self, frame: Frame, time: float, y: Array) -> float:
        """Return by how much axes are off what constraints leave in a state, as the tangent of an angle."""
        return self._made(frame, time, y).tilt

    def _made(self, frame: Frame, time: float, y: Array) -> _Made:
        held = None if self._workspace.constraints is None else self._held_at(time, y)
        lifts = self._free if held is None else held.lifts
        for one in lifts:
            if one.frame is frame:
                return one
        units, (way, rate, bristles, *remembered, numbers, _, clock) = self._units, self._parts
        n, nb, nk, nm = frame.ways, len(self._units.bristle), len(frame.kept), len(frame.remembered)
        count, first = numbers.stop - numbers.start, frame.first_bristle
        size = first + nb + count + nk + nm
        up, down = np.zeros((self._parts[-1].stop, size)), np.zeros((size, self._parts[-1].stop))
        ways, rates, own = slice(n), slice(n, 2 * n), slice(first, first + nb)
        up[way, ways], down[ways, way] = units.way[:, None] * frame.free, frame.free.T / units.way
        up[rate, rates], down[rates, rate] = units.rate[:, None] * frame.free, frame.free.T / units.rate
        up[bristles, own], down[own, bristles] = np.diag(units.bristle), np.diag(1.0 / units.bristle)
        up[clock, 2 * n : first], down[2 * n : first, clock] = CLOCK, 1.0 / CLOCK
        parameters = slice(own.stop, own.stop + count)
        up[numbers, parameters] = down[parameters, numbers] = np.eye(count)
        for k, number in enumerate(frame.kept, parameters.stop):
            at, unit = self._parts[-2].start + number, self._kept_units[number]
            up[at, k], down[k, at] = unit, 1.0 / unit
        for k, (contact, column) in enumerate(frame.remembered, parameters.stop + nk):
            at = remembered[column - 1].start + contact
            up[at, k] = down[k, at] = 1.0
        tilt = 0.0 if held is None else self._hold(up, frame, held)
        made = _Made(frame, Lift(up, down), tilt)
        lifts.insert(0, made)
        del lifts[_KEPT:]
        return made

    def _held_at(self, time: float, y: Array) -> _Held:
        """Return what is held in a state."""
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
        # Over time alone places that are wanted go with the rates that are.
        over_time = constraints.every_speed - rows @ y[nq : nq + nv]
        over = self._over_numbers(time, y)
        found = _Held(key, time, y.copy(), rows, over_time, over, [])
        self._states = [found, *self._states[: _KEPT - 1]]
        return found

    def _hold(self, up: Array, frame: Frame, held: _Held) -> float:
        """Let closures and motions hold in displacements, in place; return the tilt of axes."""
        way, rate, *_, numbers, _, _ = self._parts
        n, clock = frame.ways, list(range(2 * frame.ways, frame.first_bristle))
        rows, over = held.rows, held.over_numbers
        across = self._units.way[:, None] * frame.bound
        first = frame.first_bristle + len(self._units.bristle)
        last = first + numbers.stop - numbers.start
        # What constraints know of besides the configuration: time, numbers of the system and of elements.
        places = [*range(n), *clock, *range(first, last + len(frame.kept))]
        gaps = [np.outer(held.over_time, up[-1, clock]), over[0], self._gaps_over_kept(frame, held)]
        off = np.hstack([rows @ up[way, :n], *gaps])
        back = np.linalg.lstsq(rows @ across, off, rcond=_FAINT)[0]
        up[way, places] -= across @ back
        moved = up[:, places]
        turned = self._speeds(held.time, held.y, moved) + over[1] @ moved[numbers]
        across = self._units.rate[:, None] * frame.bound
        off = np.hstack([turned, rows @ up[rate, n : 2 * n]])
        up[rate, [*places, *range(n, 2 * n)]] -= across @ np.linalg.lstsq(rows @ across, off, rcond=_FAINT)[0]
        return float(np.abs(back[:, :n]).max(initial=0.0))

    def _gaps_over_kept(self, frame: Frame, held: _Held) -> Array:
        """Return by how much constraints are violated per unit of each number that elements keep, (rows, k).

        A row that holds a joint goes with its place, linearly.
        """
        constraints, program = self._workspace.constraints, self._workspace.program
        assert constraints is not None
        columns = [np.zeros((len(constraints.every_row), 0))]
        for number in frame.kept:
            word, step = self._kept.words[number], float(self._kept_units[number])
            kept, found = program[word], []
            for side in (0.5, -0.5):
                program[word] = kept + side * step
                constraints.residuals(held.time, held.y, program)
                found.append(constraints.every_gap.copy())
            program[word] = kept
            columns.append((found[0] - found[1])[:, None])
        return np.hstack(columns)
