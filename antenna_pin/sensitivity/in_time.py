"""How what a run shows goes on in time at its samples, and in neighbours: of states alone, without a step.

A state y goes on along its flow f(t, y), so that the rate of any function g of it is the derivative of
``g(t + s, y + s f)`` over s, along a straight line. The rate of a neighbour's is that of its own flow; the
derivative of both over a parameter is the mixed one, by which largest values come later.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.differences import WEIGHTS
from antenna_pin.dynamics import System, observed
from antenna_pin.nonlinear.near import Near
from antenna_pin.sensitivity.along import Displaced
from antenna_pin.sensitivity.by_equation import ByEquation
from antenna_pin.simulation.samples import Chunk

__all__ = ["Bend", "InTime"]

Array = NDArray[np.float64]

# Steps of differences in time, over how long what is looked at takes, the largest first; those along a
# parameter, in its scale.
_STEPS, _ALONG = (3e-2, 1e-2, 3e-3, 1e-3, 1e-4, 1e-5), (1e-3, 1e-4, 1e-5)
# Round-off of what is differentiated, over its size.
_ROUND_OFF = 1e-15


class Bend(NamedTuple):
    """How forces of contacts go on in time at samples, (n,), and over parameters, (n, parameters).

    Attributes:
        force: Of each [N].
        rate: Of it [N/s].
        bend: Of that [N/s^2].
        over: Of the rate over each parameter, in its scale, at equal times.
        bend_doubt: By how much it is in doubt.
        over_doubt: Likewise.
    """

    force: Array
    rate: Array
    bend: Array
    over: Array
    bend_doubt: Array
    over_doubt: Array

    def of(self, n: int) -> Bend:
        """Return what is told of one sample, (1,)."""
        return Bend(*(one[n : n + 1] for one in self))

    def is_a_top(self, found: float) -> bool:
        """Whether one force is largest here, but for so much of the time that it takes to bend."""
        force, rate, bend = (float(one[0]) for one in self[:3])
        return bend < 0.0 and rate**2 < found**2 * force * -bend

    def later(self, known: Array) -> tuple[Array, Array, Array]:
        """Return by how much later one force is largest [s], the doubt of it, and a correction of the force.

        The correction is what the force changes more where it is largest than here, where that was found.

        Args:
            known: To which share displacements are known, (parameters,).
        """
        (force,), (rate,), (bend,), (over,), (rough,), (rest,) = self
        late, off = -over / bend, -rate / bend
        slow = np.sqrt(-force / bend)  # what it takes to bend
        doubt = rest / abs(bend) + np.abs(late) * (known + rough / abs(bend) + abs(off) / slow)
        return late, doubt, over * off


class InTime:
    """Differentiates what samples of a displaced run show over time.

    Args:
        equation: Knows the run's neighbours.
        displaced: The samples.
    """

    def __init__(self, equation: ByEquation, displaced: Displaced) -> None:
        """Take the samples."""
        self._equation, self._all = equation, displaced

    def forces(self, places: NDArray[np.int_], contacts: NDArray[np.int_], long: Array) -> Bend:
        """Return how normal forces of contacts go on.

        Args:
            places: Which samples, (n,).
            contacts: The contact at each, (n,).
            long: How long each contact lasts [s].
        """
        equation, part = self._equation, self._part(places)
        count = len(equation.parameters)

        def force(chunk: Chunk, system: System) -> Array:
            seen = observed(system, chunk.times, chunk.states, chunk.memories, chunk.programs)
            return np.asarray(seen.contact["normal_force"])[np.arange(len(places)), contacts]

        def rate(chunk: Chunk, near: Near) -> Array:
            """Return the rate of a neighbour's force, by the steps that are best for the run's own."""
            lines = _lines(chunk, near)
            return _sixth(lambda h: force(lines(h), near.system), step)[0]

        with equation.beside.at(0, 0.0) as own:
            lines, most = _lines(part.chunk, own), force(part.chunk, own.system)
            here, doubt, step = _best(lambda h: force(lines(h), own.system), long, _STEPS)
            bend, off, _ = _best(lambda h: rate(lines(h), own), long, _STEPS[:3], doubt)
        over, rest = np.zeros((2, len(places), count))
        for k in range(count):

            def along(s: Array, k: int = k) -> Array:
                far = float(s[0])
                with equation.beside.at(k, far) as near:
                    return rate(equation.moved(part, k, far, near.system), near)

            over[:, k], rest[:, k], _ = _best(along, np.ones(len(places)), _ALONG, doubt)
        return Bend(most, here, bend, over, off, rest)

    def series(self, place: int, long: float) -> dict[str, tuple[Array, Array]]:
        """Return the rates of all series at a sample and their doubts, by name.

        Args:
            place: Which.
            long: How long what passes there takes [s].
        """
        chunk = self._part(np.array([place])).chunk
        with self._equation.beside.at(0, 0.0) as near:
            lines = _lines(chunk, near)
        best: dict[str, tuple[Array, Array]] = {}
        here = self._equation.seen(chunk)
        for step in _STEPS:
            h = np.array([step * long])
            ahead, behind = (
                [self._equation.seen(lines(side * j * h)) for j in (1, 2, 3)] for side in (1, -1)
            )
            for name in (one for one, value in here.items() if value.dtype.kind == "f" and one != "time"):
                odd = np.array([one[name][0] for one in ahead]) - np.array([one[name][0] for one in behind])
                sixth, fourth = np.tensordot(WEIGHTS, odd, 1) / h[0]
                rest = np.abs(sixth - fourth) + _ROUND_OFF * np.abs(here[name][0]).max(initial=0.0) / h[0]
                if name not in best or rest.max(initial=0.0) < best[name][1].max(initial=0.0):
                    best[name] = sixth, rest
        return best

    def _part(self, places: NDArray[np.int_]) -> Displaced:
        """Return some of the samples."""
        every = self._all
        old = every.chunk
        programs = [old.programs[k] for k in places.tolist()]
        chunk = Chunk(old.times[places], old.states[places], old.memories[places], programs)
        return Displaced(chunk, *(one[places] for one in every[1:]))


def _lines(chunk: Chunk, near: Near) -> Callable[[Array], Chunk]:
    """Return what gives states as far along their flows as each is told, (n,) [s]."""
    system = near.system
    nq, nv = system.model.nq, system.model.nv
    flows = []
    for time, state, memory, program in zip(
        chunk.times.tolist(), chunk.states, chunk.memories, chunk.programs, strict=True
    ):
        near.workspace.memory[:], near.workspace.program[:] = memory, program
        flows.append(near.rates(time, np.ascontiguousarray(state)).copy())

    def line(h: Array) -> Chunk:
        states = chunk.states.copy()
        for y, flow, s in zip(states, flows, h.tolist(), strict=True):
            way = s * y[nq : nq + nv]
            near.workspace.retract(y, way)
            y[nq:] += s * flow
            system.turn_on(y)
        return Chunk(chunk.times + h, states, chunk.memories, chunk.programs)

    return line


def _sixth(function: Callable[[Array], Array], h: Array) -> tuple[Array, Array]:
    """Return derivatives at zero by differences of sixth order, and those of fourth less them, (n,) each."""
    ahead, behind = (np.array([function(side * j * h) for j in (1, 2, 3)]) for side in (1, -1))
    sixth, fourth = WEIGHTS @ (ahead - behind) / h
    return sixth, np.abs(sixth - fourth)


def _best(
    function: Callable[[Array], Array], sizes: Array, steps: tuple[float, ...], noise: Array | None = None
) -> tuple[Array, Array, Array]:
    """Return derivatives at zero, their doubts and steps, (n,) each: those at which two orders agree best.

    Args:
        function: Of arguments, (n,), each of which moves one of its values.
        sizes: What steps are a part of, (n,).
        steps: These parts.
        noise: What values are in doubt by besides round-off, (n,).
    """
    least = _ROUND_OFF * np.abs(function(np.zeros_like(sizes))) if noise is None else noise
    best, doubt, used = np.zeros_like(sizes), np.full_like(sizes, np.inf), sizes.copy()
    for step in steps:
        value, rest = _sixth(function, step * sizes)
        rest = rest + least / (step * sizes)
        better = rest < doubt
        best, used = np.where(better, value, best), np.where(better, step * sizes, used)
        doubt = np.where(better, rest, doubt)
    return best, doubt, used
