"""Coordinates about a state as displacements of one, on what closures, motions and elements hold."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Workspace
from antenna_pin.nonlinear.frames import CLOCK, Frame, Lift, Units
from antenna_pin.nonlinear.kept import Kept

__all__ = ["Lifts"]

Array = NDArray[np.float64]

_FAINT = 1e-10  # of what rows of constraints do, over the most: less is what round-off has left


class Lifts:
    """Makes displacements of coordinates.

    Args:
        workspace: Its program is that of the moment.
        units: Of displacements.
        kept: What elements keep.
        parts: Of a displacement.
        speeds: ``(time, y, ways) -> (rows, k)``: the derivatives along displacements of how fast constraints
            are violated.
        gaps: ``(time, y, ways) -> (rows, k)``: the same of how far they are, over numbers of the system.
    """

    def __init__(
        self,
        workspace: Workspace,
        units: Units,
        kept: Kept,
        parts: tuple[slice, ...],
        speeds: Callable[[float, Array, Array], Array],
        gaps: Callable[[float, Array, Array], Array],
    ) -> None:
        """Begin with none."""
        self._workspace, self._units, self._kept, self._parts = workspace, units, kept, parts
        self._kept_units = kept.units(units.way, units.rate)
        self._speeds, self._gaps = speeds, gaps
        self._lifted: tuple[Frame, Lift] | None = None

    def lift(self, frame: Frame, time: float, y: Array) -> Lift:
        """Return the coordinates along a frame's axes as displacements of a state near the frame's own.

        Closures and motions hold in displaced states, to first order: across the axes a displacement is what
        they want it to be.
        """
        if self._lifted is not None and self._lifted[0] is frame:
            return self._lifted[1]
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
        lift = Lift(up, down)
        if self._workspace.constraints is None:
            self._lifted = frame, lift  # the same in every state
        else:
            self._hold(up, frame, time, y)
        return lift

    def _hold(self, up: Array, frame: Frame, time: float, y: Array) -> None:
        """Let closures and motions hold in displacements, in place."""
        constraints, program = self._workspace.constraints, self._workspace.program
        assert constraints is not None
        way, rate, *_, numbers, _, _ = self._parts
        n, clock = frame.ways, list(range(2 * frame.ways, frame.first_bristle))
        nq, nv = self._workspace.model.nq, self._workspace.model.nv

        self._workspace.prepare_motions(time, y)
        constraints.residuals(time, y, program)
        rows = constraints.every_row.copy()
        # Over time alone places wanted go with rates wanted.
        over_time = constraints.every_speed - rows @ y[nq : nq + nv]
        across = self._units.way[:, None] * frame.bound
        first = frame.first_bristle + len(self._units.bristle)
        last = first + numbers.stop - numbers.start
        # What constraints know of besides the configuration: time, numbers of the system and of elements.
        places = [*range(n), *clock, *range(first, last + len(frame.kept))]
        gaps = [np.outer(over_time, up[-1, clock]), self._gaps(time, y, up[:, first:last])]
        off = np.hstack([rows @ up[way, :n], *gaps, self._gaps_over_kept(frame, time, y)])
        up[way, places] -= across @ np.linalg.lstsq(rows @ across, off, rcond=_FAINT)[0]
        moved = up[:, places]
        turned = self._speeds(time, y, moved)
        across = self._units.rate[:, None] * frame.bound
        off = np.hstack([turned, rows @ up[rate, n : 2 * n]])
        up[rate, [*places, *range(n, 2 * n)]] -= across @ np.linalg.lstsq(rows @ across, off, rcond=_FAINT)[0]

    def _gaps_over_kept(self, frame: Frame, time: float, y: Array) -> Array:
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
                constraints.residuals(time, y, program)
                found.append(constraints.every_gap.copy())
            program[word] = kept
            columns.append((found[0] - found[1])[:, None])
        return np.hstack(columns)
