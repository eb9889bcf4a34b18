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

from antenna_pin.base.differences import WEIGHTS
from antenna_pin.dynamics import observed
from antenna_pin.nonlinear.perturbed_system import Near
from antenna_pin.sensitivity.along import Displaced
from antenna_pin.sensitivity.of_states import SIDES, OfStates, Row, beside_one_another
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
        told: What is said of states.
        displaced: The samples.
    """

    def __init__(self, told: OfStates, displaced: Displaced) -> None:
        """Take the samples."""
        self._told, self._all = told, displaced
        self._rates: dict[tuple[int, float], dict[str, tuple[Array, Array]]] = {}

    def forces(self, places: NDArray[np.int_], contacts: NDArray[np.int_], long: Array) -> Bend:
        """Return how normal forces of contacts go on.

        Args:
            places: Which samples, (n,).
            contacts: The contact at each, (n,).
            long: How long each contact lasts [s].
        """
        told, part, n = self._told, self._part(places), len(places)

        def force(chunk: Chunk, near: Near) -> Array:
            """Return forces in states that stand sample by sample, (n, states of each)."""
            seen = observed(near.system, chunk.times, chunk.states, chunk.memories, chunk.programs)
            found = np.asarray(seen.contact["normal_force"]).reshape(n, -1, seen.contact.shape[-1])
            return found[np.arange(n), :, contacts]

        def rate(chunk: Chunk, near: Near) -> Array:
            """Return rates of forces likewise, by the steps that are best for the run's own."""
            lines, count = _lines(chunk, near), len(chunk.times) // n
            far = np.repeat(step, count)
            ahead_and_behind = force(lines(far[:, None] * SIDES), near).reshape(n, count, len(SIDES))
            return _orders(ahead_and_behind)[0] / step[:, None]

        with told.beside.at(0, 0.0) as own:
            lines, most = _lines(part.chunk, own), force(part.chunk, own)[:, 0]
            noise = _ROUND_OFF * np.abs(most)
            here, doubt, step = _best(lambda h: force(lines(h), own), long, _STEPS, noise)
            bend, off, _ = _best(lambda h: rate(lines(h), own), long, _STEPS[:3], doubt)
        count = len(told.scales)
        over, rest = np.zeros((n, count)), np.full((n, count), np.inf)
        for far in _ALONG:
            wanted = [Row(k, one) for k in range(count) for one in (SIDES * far).tolist()]
            rates = np.zeros((n, len(wanted)))
            for numbers, near, chunks in told.neighbours(part, wanted):
                rates[:, numbers] = rate(beside_one_another(chunks), near)
            sixth, apart = _orders(rates.reshape(n, count, len(SIDES)))
            value, other = sixth / far, (apart + doubt[:, None]) / far
            over, rest = np.where(other < rest, value, over), np.fmin(other, rest)
        return Bend(most, here, bend, over, off, rest)

    def series(self, place: int, long: float) -> dict[str, tuple[Array, Array]]:
        """Return the rates of all series at a sample and their doubts, by name.

        Args:
            place: Which.
            long: How long what passes there takes [s].
        """
        if (place, long) not in self._rates:
            self._rates[place, long] = self._series(place, long)
        return self._rates[place, long]

    def _series(self, place: int, long: float) -> dict[str, tuple[Array, Array]]:
        chunk = self._part(np.array([place])).chunk
        with self._told.beside.at(0, 0.0) as near:
            lines = _lines(chunk, near)
        here = self._told.seen(chunk)
        steps = np.array(_STEPS) * long
        told = self._told.seen(lines(np.outer(steps, SIDES).reshape(1, -1)))
        best: dict[str, tuple[Array, Array]] = {}
        for name in (one for one, value in here.items() if value.dtype.kind == "f" and one != "time"):
            values = np.moveaxis(told[name].reshape(len(steps), len(SIDES), *here[name].shape[1:]), 1, -1)
            noise = _ROUND_OFF * np.abs(here[name][0]).max(initial=0.0)
            for h, (sixth, apart) in zip(steps.tolist(), zip(*_orders(values), strict=True), strict=True):
                rest = (apart + noise) / h
                if name not in best or rest.max(initial=0.0) < best[name][1].max(initial=0.0):
                    best[name] = sixth / h, rest
        return best

    def _part(self, places: NDArray[np.int_]) -> Displaced:
        """Return some of the samples."""
        every = self._all
        old = every.chunk
        programs = [old.programs[k] for k in places.tolist()]
        chunk = Chunk(old.times[places], old.states[places], old.memories[places], programs)
        return Displaced(chunk, *(one[places] for one in every[1:]))


def _lines(chunk: Chunk, near: Near) -> Callable[[Array], Chunk]:
    """Return what gives states as far along the flows of others as it is told, (n, of each) [s]."""
    system = near.system
    nq, nv = system.model.nq, system.model.nv
    flows = []
    for time, state, memory, program in zip(
        chunk.times.tolist(), chunk.states, chunk.memories, chunk.programs, strict=True
    ):
        near.workspace.memory[:], near.workspace.program[:] = memory, program
        flows.append(near.rates(time, np.ascontiguousarray(state)).copy())

    def line(h: Array) -> Chunk:
        count = h.shape[1]
        states = np.repeat(chunk.states, count, axis=0)
        for i, (y, s) in enumerate(zip(states, h.reshape(-1).tolist(), strict=True)):
            way = s * y[nq : nq + nv]
            near.workspace.retract(y, way)
            y[nq:] += s * flows[i // count]
            system.turn_on(y)
        times = np.repeat(chunk.times, count) + h.reshape(-1)
        programs = [program for program in chunk.programs for _ in range(count)]
        return Chunk(times, states, np.repeat(chunk.memories, count, axis=0), programs)

    return line


def _orders(values: Array) -> tuple[Array, Array]:
    """Return differences of sixth order, and by how much those of fourth are off them, of SIDES last."""
    sixth, fourth = ((values[..., :3] - values[..., 3:]) @ one for one in WEIGHTS)
    return sixth, np.abs(sixth - fourth)


def _best(
    function: Callable[[Array], Array], sizes: Array, steps: tuple[float, ...], noise: Array
) -> tuple[Array, Array, Array]:
    """Return derivatives at zero, their doubts and steps, (n,) each: those at which two orders agree best.

    Args:
        function: Of arguments of each of its values, (n, of each).
        sizes: What steps are a part of, (n,).
        steps: These parts.
        noise: What values are in doubt by, (n,).
    """
    best, doubt, used = np.zeros_like(sizes), np.full_like(sizes, np.inf), sizes.copy()
    for h in (step * sizes for step in steps):
        sixth, apart = _orders(function(h[:, None] * SIDES))
        rest = (apart + noise) / h
        better = rest < doubt
        best, used = np.where(better, sixth / h, best), np.where(better, h, used)
        doubt = np.where(better, rest, doubt)
    return best, doubt, used
