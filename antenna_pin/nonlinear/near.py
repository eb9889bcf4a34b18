"""A system's rates, and other functions of its state, in neighbours of a state: displaced ones."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.differences import WEIGHTS
from antenna_pin.base.settings import RunSettings
from antenna_pin.dynamics import System, Workspace
from antenna_pin.engine import Carrying, SystemSlopes, Tangents, moves_rows
from antenna_pin.integrate import method_named
from antenna_pin.nonlinear.frames import Units, parts_of
from antenna_pin.nonlinear.kept import Kept
from antenna_pin.nonlinear.numbers import InPlace, Numbers
from antenna_pin.simulation.steps import scale_vector, stepper_of

__all__ = ["STEP", "Function", "Near"]

Array = NDArray[np.float64]
Function = Callable[[float, Array], Array]

#: Steps of differences, in error scales. At joints with play, where scales are a clearance and 0.01 m/s, they
#: are finer, to be small beside the kinks of laws, but large beside the round-off of places: where a kink is
#: nearer, or a contact is shallow, they are made finer yet.
STEP = 1e-4
_IN_PLAY = 1e-5


class Near:
    """Evaluates functions of time and state at displaced states.

    Args:
        system: The system.
        settings: Of the run whose engine evaluates its rates.
        numbers: Parameters of the system that displacements have, too; none if left out.
        whole: Whether they displace all that others take from the system, too.

    Attributes:
        system: The system; of a copy of its own if parameters displace it.
        workspace: Its contact memory and program are those of the moment.
        stepper: Whose rates they are.
        kept: What elements keep.
        bristles: Where these stand in x, (bristles,).
        parts: Of a displacement.
        numbers: The system's numbers, if parameters displace them.
    """

    def __init__(
        self, system: System, settings: RunSettings, numbers: Numbers | None = None, *, whole: bool = False
    ) -> None:
        """Allocate once."""
        self.system = system = system if numbers is None else numbers.own_system()
        self.workspace, self.kept = Workspace(system), Kept(system)
        scales = scale_vector(system, settings.scales)
        self.stepper = stepper_of(self.workspace, method_named(settings.method), scales, settings)
        self.bristles = np.asarray(system.bristle_x, dtype=int)
        self.parts = parts_of(system, len(self.kept), 0 if numbers is None else numbers.count)
        self.numbers = (
            None if numbers is None else InPlace(numbers, self.workspace, self.stepper, whole=whole)
        )
        self._of_rows: list[int] = []  # numbers that constraints go with
        self._y, self._memory = np.zeros(system.manifold.size), self.workspace.memory.copy()

    def rates(self, time: float, y: Array) -> Array:
        """Return [acceleration (nv), rate of x (nx)] with contacts and program of the moment."""
        return self.stepper.rates(time, y)

    def flow(self, time: float, y: Array) -> Array:
        """Return the displacement per second that the system itself makes, (displacement,)."""
        nq, nv = self.system.model.nq, self.system.model.nv
        way, rate, bristles, *_, clock = self.parts
        rates, out = self.rates(time, y), np.zeros(clock.stop)
        out[way], out[rate], out[bristles] = y[nq : nq + nv], rates[:nv], rates[nv + self.bristles]
        out[clock] = 1.0
        return out

    def tangents(self, units: Units) -> Tangents | None:
        """Return derivatives put together from parts, of what is met at onsets at least; or None."""
        if not Tangents.knows_contacts(self.system):
            return None
        return Tangents(self.system, self.stepper, np.concatenate(units), WEIGHTS)

    def carrying(self, tangents: Tangents | None, coarse: Array) -> Carrying | None:
        """Return what carries displacements by the stages of the run's method; None where nothing does.

        Args:
            tangents: Derivatives of the rates, which know the system's numbers; None if there are none.
            coarse: :meth:`coarseness`.
        """
        if tangents is None or not Carrying.takes(self.stepper):
            return None
        steps = coarse.copy()
        steps[self.parts[-1]] = 1.0 / STEP
        return Carrying(self.stepper, tangents, steps)

    def follows(self, tangents: Tangents | None, units: Units) -> bool:
        """Let derivatives know the system's numbers and what elements keep; return whether they can."""
        own, numbers = self.stepper.numbers, self.numbers
        tree = own.tree.view(np.float64).reshape(-1)
        if numbers is not None and self.system.plan is not None:
            moved = moves_rows(self.system, numbers.program, numbers.plan)
            self._of_rows = np.flatnonzero(moved).tolist()
        program, bodies, plan, gravity = (
            np.zeros((0, size)) for size in (len(own.program), len(tree), len(own.plan), 3)
        )
        if numbers is not None:
            program, bodies, plan, gravity = numbers.program, numbers.tree, numbers.plan, numbers.gravity
        kept = self.kept.words, self.kept.units(units.way, units.rate)
        return tangents is not None and tangents.follow(SystemSlopes(program, bodies, plan, gravity, *kept))

    def coarseness(self, units: Units, in_play: float | None = None) -> Array:
        """Return over what a step of each part of a displacement must be one at most, (displacement,).

        Args:
            units: Of displacements.
            in_play: Steps at joints with play, over their units; those of forces if left out.
        """
        way, rate, bristles, *_, numbers, kept, _ = self.parts
        out = np.zeros(self.parts[-1].stop)
        out[way], out[rate], out[bristles] = 1.0 / units.way, 1.0 / units.rate, 1.0 / units.bristle
        out[kept] = 1.0 / (STEP * self.kept.units(units.way, units.rate))
        steps, finer = np.full(self.system.model.nv, STEP), _IN_PLAY if in_play is None else in_play
        for joint in self.system.clearances:
            steps[self.system.mechanism.joint(joint.name).v] = finer
        out[way] /= steps
        out[rate] /= steps
        out[bristles] /= finer
        out[numbers] = 1.0 / STEP
        return out

    def at(self, function: Function, time: float, y: Array, displacement: Array) -> Array:
        """Return a function's value at a neighbour."""
        nq, nv = self.system.model.nq, self.system.model.nv
        way, rate, bristles, speeds, masses, numbers, own, clock = (displacement[one] for one in self.parts)
        memory, kept, program = self.workspace.memory, self._memory, self.workspace.program
        back = self.numbers.displace(numbers) if self.numbers is not None and numbers.any() else None
        words = program[self.kept.words]
        self._y[:] = y
        self.workspace.retract(self._y, way)
        self._y[nq : nq + nv] += rate
        self._y[nq + nv + self.bristles] += bristles
        kept[:] = memory
        memory["approach_speed"] *= np.exp(speeds)
        memory["effective_mass"] *= np.exp(masses)
        program[self.kept.words] += own
        try:
            return np.array(function(time + float(clock[0]), self._y))
        finally:
            memory[:], program[self.kept.words] = kept, words
            if back is not None:
                back()

    def over(self, function: Function, time: float, y: Array, way: Array, step: float) -> Array:
        """Return the derivative of a function along a displacement, of sixth and fourth order, (2, ...)."""
        ahead, behind = (
            np.array([self.at(function, time, y, side * point * step * way) for point in (1, 2, 3)])
            for side in (1, -1)
        )
        return np.asarray(WEIGHTS @ (ahead - behind) / step)

    def over_numbers(self, time: float, y: Array, way: Array, step: float) -> Array:
        """Return derivatives of the rates over the system's numbers, as :meth:`over`."""
        assert self.numbers is not None
        found = []
        for point in (1.0, 2.0, 3.0, -1.0, -2.0, -3.0):
            back = self.numbers.displace(point * step * way)
            try:
                found.append(self.rates(time, y).copy())
            finally:
                back()
        values = np.array(found)
        return np.asarray(WEIGHTS @ (values[:3] - values[3:]) / step)

    def rows_over_numbers(self, time: float, y: Array) -> Array:
        """Return how far and how fast constraints are violated per number, (2, rows, numbers)."""
        workspace, numbers, constraints = self.workspace, self.numbers, self.workspace.constraints
        assert constraints is not None
        count = 0 if numbers is None else numbers.count
        out = np.zeros((2, len(constraints.every_gap), count))
        if numbers is None:
            return out
        for k in self._of_rows:
            found, way = [], np.zeros(count)
            for point in (1.0, 2.0, 3.0, -1.0, -2.0, -3.0):
                way[k] = point * STEP
                back = numbers.displace(way)
                try:
                    workspace.prepare_motions(time, y)
                    constraints.residuals(time, y, workspace.program)
                    found.append([constraints.every_gap.copy(), constraints.every_speed.copy()])
                finally:
                    back()
            values = np.array(found)
            out[:, :, k] = np.tensordot(WEIGHTS[0], values[:3] - values[3:], 1) / STEP
        return out
