"""Largest efforts of prescribed motions, located between the samples of a run.

About the samples that are larger than those beside them, the four of the highest parabolas, the run is
integrated again from the sample before, by its own method, and the largest size is searched in the dense
output. A top that samples give no sign of, at a rate below that of the effort itself, is not found.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Workspace, observed
from antenna_pin.errors import FunctionError
from antenna_pin.integrate import method_named
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.samples import Chunk
from antenna_pin.simulation.seen import Seen
from antenna_pin.simulation.stretches import stepper_of

__all__ = ["Tops"]

Array = NDArray[np.float64]

_MOST = 4  # places that are looked at, of one motion
_STEPS = 200  # that are tried from one sample to the next
_LOOKS = np.linspace(0.0, 1.0, 5)  # within a step, at first
_BESIDE = 0.1  # of the time between samples: a top so near to one is looked for on both its sides
_COARSE = 0.01  # of the top, by which it is above a sample beside it: parabolas say little of it then


class _Place(NamedTuple):
    """Three samples about which the largest size may be.

    Attributes:
        most: Largest size of the parabola through them [N m] ([N]).
        bound: As far above the middle one again: no more is expected; infinite if coarse [N m] ([N]).
        time: When the parabola is highest [s].
        samples: They.
    """

    most: float
    bound: float
    time: float
    samples: Chunk

    def sides(self, coarse: bool) -> list[Chunk]:
        """Return the pairs of samples between which its top may be, of coarse samples on both sides."""
        first, middle, last = self.samples.times.tolist()
        late = (self.time - middle) / (last - middle if self.time > middle else middle - first)
        sides = coarse or late < _BESIDE, coarse or late > -_BESIDE
        return [self.samples.part(k, k + 2) for k, may_be in enumerate(sides) if may_be]


class _Step(NamedTuple):
    """A step between two samples.

    Attributes:
        time: When it begins [s].
        state: There, [q, v, x].
        size: How long it is [s].
        sizes: Of efforts within it [N m] ([N]), (looks, motions).
    """

    time: float
    state: Array
    size: float
    sizes: Array


class Tops:
    """Largest sizes of efforts, of each motion of a run.

    Args:
        run: The run.
        motions: Of its drives, which are motions, (drives,).
        between: Whether its samples follow one another, so that there is something between them.
    """

    def __init__(self, run: Run, motions: NDArray[np.bool_], *, between: bool) -> None:
        """Begin before the first sample."""
        self._run, self._motions, self._between = run, motions, between
        count = int(np.count_nonzero(motions))
        self._largest, self._times = np.full(count, -np.inf), np.full(count, np.nan)
        self._places: list[list[_Place]] = [[] for _ in range(count)]
        self._before: tuple[Chunk, Array] | None = None

    def add(self, seen: Seen) -> None:
        """Take the samples of a block."""
        chunk = Chunk(seen.times, seen.states, seen.memories, list(seen.programs))
        sizes = np.abs(seen.found.effort["effort"][:, self._motions])
        if self._before is not None:
            chunk, sizes = (
                Chunk.joined([self._before[0], chunk]),
                np.concatenate([self._before[1], sizes]),
            )
        self._before = chunk.part(-2, None), sizes[-2:].copy()
        for m, size in enumerate(sizes.T):
            top = int(np.argmax(size))
            if size[top] > self._largest[m]:
                self._largest[m], self._times[m] = size[top], chunk.times[top]
            if not self._between:
                continue
            most, when = _vertices(chunk.times, size)
            here = np.argsort(-most, kind="stable")[:_MOST].tolist()
            coarse = most - np.minimum(size[:-2], size[2:]) > _COARSE * most
            bound = np.where(coarse, np.inf, 2.0 * most - size[1:-1])
            places = self._places[m] + [
                _Place(float(most[k]), float(bound[k]), float(when[k]), chunk.part(k, k + 3))
                for k in here
                if math.isfinite(most[k])
            ]
            self._places[m] = sorted(places, key=lambda one: -one.most)[:_MOST]

    def located(self) -> tuple[Array, Array]:
        """Return the largest size [N m] ([N]) and its time [s] of each motion, (motions,) each."""
        if any(self._places):
            again = _Again(self._run, self._motions)
            for m, places in enumerate(self._places):
                coarse = any(place.bound == math.inf for place in places)
                able = [place for place in places if coarse or place.bound > self._largest[m]]
                ends = [side for place in able for side in place.sides(coarse)]
                size, time = again.largest(m, ends)
                if size > self._largest[m]:
                    self._largest[m], self._times[m] = size, time
            self._places = [[] for _ in self._places]
        return self._largest.copy(), self._times.copy()


class _Again:
    """A run integrated again between two of its samples.

    Args:
        run: The run.
        motions: Of its drives, which are motions, (drives,).
    """

    def __init__(self, run: Run, motions: NDArray[np.bool_]) -> None:
        """Allocate once."""
        self._system, self._motions = run.system, motions
        self._workspace, settings = Workspace(run.system), run.settings
        method = method_named(settings.method)
        self._stepper = stepper_of(self._workspace, method, run.stepper.scales, settings)
        self._made: dict[float, list[_Step]] = {}

    def largest(self, m: int, between: Sequence[Chunk]) -> tuple[float, float]:
        """Return the largest size of a motion's effort between some pairs of samples, and when.

        Minus infinity where something changes between all of them.
        """
        tops = []
        for begin, ends in {float(ends.times[0]): ends for ends in between}.items():
            if begin not in self._made:
                self._made[begin] = self._steps(ends)
            tops += [(float(step.sizes[:, m].max()), step, ends) for step in self._made[begin]]
        best = -math.inf, 0.0
        for _, step, ends in sorted(tops, key=lambda one: -one[0])[:2]:
            best = max(best, self._in_step(m, step, ends))
            looks = step.sizes[:, m]
            rises = _vertices(_LOOKS, looks)[0] - looks[1:-1]
            if np.all(rises <= _COARSE * looks.max()) and 0 < int(np.argmax(looks)) < len(_LOOKS) - 1:
                break  # else another may be higher, or its top in the step beside
        return best

    def _steps(self, ends: Chunk) -> list[_Step]:
        """Return the steps from one sample to the next; none where something changes there."""
        (begin, end), (before, after), stepper = ends.times, ends.programs, self._stepper
        if not (
            begin < end
            and np.array_equal(before.view(np.int64), after.view(np.int64))
            and np.array_equal(*ends.memories["touching"])
        ):
            return []
        made: list[tuple[float, Array, float]] = []
        self._take_up(ends)
        times, states = [], []
        try:
            stepper.restart(begin, ends.states[0])
            h = end - begin
            for _ in range(_STEPS):
                h = min(h, end - stepper.t)
                error = stepper.attempt(h)
                if error < 1.0:
                    stepper.prepare_dense()
                    made.append((stepper.t, stepper.start[: ends.states.shape[1]].copy(), h))
                    own = self._states(_LOOKS)
                    times.append(own[0])
                    states.append(own[1])
                    stepper.accept()
                    if end - stepper.t <= 4.0 * math.ulp(end):
                        break
                h *= min(4.0, 0.9 * max(error, 1e-6) ** -0.25) if error < 1e4 else 0.1  # not a number, too
            else:
                return []  # steps that come to nothing
        except FunctionError:
            return []  # of a function of the user's, which has answers at the samples
        sizes = self._sizes(np.concatenate(times), np.concatenate(states), ends)
        return [
            _Step(*one, own) for one, own in zip(made, sizes.reshape(len(made), len(_LOOKS), -1), strict=True)
        ]

    def _take_up(self, ends: Chunk) -> None:
        self._workspace.program[:], self._workspace.memory[:] = ends.programs[0], ends.memories[0]

    def _states(self, fractions: Array) -> tuple[Array, Array]:
        """Return times [s] and states within the trial step that stands, on what its program holds."""
        stepper, program = self._stepper, self._workspace.program
        times = stepper.t + stepper.h * fractions
        states = np.zeros((len(fractions), self._system.manifold.size))
        for state, theta, t in zip(states, fractions.tolist(), times.tolist(), strict=True):
            stepper.interpolate(theta, state)
            if self._workspace.constraints is not None:
                self._workspace.hold(t, state, program)
        return times, states

    def _sizes(self, times: Array, states: Array, ends: Chunk) -> Array:
        """Return sizes of efforts, (n, motions); minus infinity where there is none."""
        count = len(times)
        memories, programs = ends.memories[:1].repeat(count, axis=0), [ends.programs[0]] * count
        efforts = observed(self._system, times, states, memories, programs).effort["effort"]
        sizes = np.abs(efforts[:, self._motions])
        return np.where(np.isfinite(sizes), sizes, -np.inf)

    def _in_step(self, m: int, step: _Step, ends: Chunk) -> tuple[float, float]:
        """Return the largest size in a step, and when."""
        self._take_up(ends)
        self._stepper.restart(step.time, step.state)
        self._stepper.attempt(step.size)
        self._stepper.prepare_dense()
        top = int(np.argmax(step.sizes[:, m]))
        fractions = np.linspace(_LOOKS[max(top - 1, 0)], _LOOKS[min(top + 1, len(_LOOKS) - 1)], 9)
        times, states = self._states(fractions)
        sizes = self._sizes(times, states, ends)[:, m]
        k = int(np.argmax(sizes))
        best = float(sizes[k]), float(times[k])
        _, tops = _vertices(fractions, sizes)
        if 0 < k < len(fractions) - 1 and math.isfinite(tops[k - 1]):
            times, states = self._states(tops[k - 1 : k])
            best = max(best, (float(self._sizes(times, states, ends)[0, m]), float(times[0])))
        return best


def _vertices(times: Array, sizes: Array) -> tuple[Array, Array]:
    """Return value and time of the top of the parabola through each three that follow one another, (n - 2,).

    Minus infinity where it has no top among them.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        back, on = times[:-2] - times[1:-1], times[2:] - times[1:-1]
        left, right = ((sizes[k : len(sizes) - 2 + k] - sizes[1:-1]) / d for k, d in ((0, back), (2, on)))
        bend = (right - left) / (on - back)
        slope = left - bend * back
        top = -0.5 * slope / bend
        value = sizes[1:-1] - 0.25 * slope**2 / bend
    inside = (bend < 0.0) & (back < top) & (top < on) & np.isfinite(value)
    return np.where(inside, value, -np.inf), np.where(inside, times[1:-1] + top, -np.inf)
