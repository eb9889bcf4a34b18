"""A system's rates as a vector field, and their derivatives along perturbations of a state."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arrays import Array
from antenna_pin.base.calculus import WEIGHTS, roughness
from antenna_pin.base.records import CONTACT
from antenna_pin.base.settings import RunSettings
from antenna_pin.dynamics import System, works_in_x
from antenna_pin.run.engine import Carrying, Slopes, Tangents
from antenna_pin.studies.nonlinear.coordinates import (
    TIME_UNIT,
    Frame,
    Lift,
    Lifts,
    RateJacobian,
    Units,
    frame_at,
)
from antenna_pin.studies.nonlinear.perturbed_system import (
    STEP,
    ParameterSlopes,
    PerturbedSystem,
    StateFunction,
)

# --- gaps along perturbations -------------------------------------------------------------------------------

# Difference steps over the scale of a play, and over a parameter's.
_GAP_STEP, _OF_NUMBERS = 1e-3, 1e-2
# Where the scale is finer, as of a tilt near zero: refinement factor, most refinements, and difference of two
# orders over the largest derivative.
_GAP_FINER, _GAP_TRIES, _PART = 10.0, 3, 1e-8
_ROUND_OFF = 4.0 * float(np.finfo(float).eps)
# Share of a row's largest number that must remain beside those before, for new information.
_NEW = 1e-3


class _GapSlopes:
    """Derivatives of functions of poses in joints' play, with steps far coarser than forces'."""

    def __init__(self, perturbed: PerturbedSystem, units: Units) -> None:
        self._near, self._coarse = perturbed, perturbed.coarseness(units, _GAP_STEP)
        *_, speeds, masses, _, _, clock = perturbed.parts
        self._coarse[speeds] = self._coarse[masses] = 1.0 / STEP
        self._coarse[clock] = 1.0 / (STEP * TIME_UNIT)
        self._table = np.zeros(len(perturbed.workspace.table), CONTACT)
        self.tangents: Tangents | None = None
        joints = perturbed.system.clearances
        self._of_points = [joint.load == "point" for joint in joints for _ in joint.contact_names]
        self._over_numbers = np.eye(len(self._coarse))[:, perturbed.parts[-3]]

    def tangents_at(self, c: int) -> Tangents | None:
        """Return the analytic derivatives at a contact; None for distributed load."""
        return self.tangents if self._of_points[c] else None

    def along(self, function: StateFunction, time: float, y: Array, ways: Array) -> Array:
        """Return the derivatives of a function along perturbations of any size, (values, k)."""
        return np.asarray(self.with_steps(function, time, y, ways, self.steps(ways))[0])

    def both_orders(self, function: StateFunction, time: float, y: Array, ways: Array) -> Array:
        """Return derivatives of two orders, of a function that may need finer steps.

        As :meth:`along`; (2, values, k).
        """
        steps, noise = self.steps(ways), _ROUND_OFF * np.abs(function(time, y))[:, None]
        found = self.with_steps(function, time, y, ways, steps)
        off, rough = np.abs(found[0] - found[1]), np.arange(len(steps))
        good = _PART * np.abs(found[0]).max(axis=1, keepdims=True, initial=0.0)
        for _ in range(_GAP_TRIES):
            # Finer steps help where the orders differ by more than round-off.
            rough = rough[(off > np.maximum(good, noise * _GAP_FINER / steps))[:, rough].any(axis=0)]
            if not len(rough):
                break
            steps[rough] /= _GAP_FINER
            again = self.with_steps(function, time, y, ways[:, rough], steps[rough])
            rest = np.abs(again[0] - again[1])
            better = rest < off[:, rough] / _GAP_FINER**2  # which round-off that is there by chance is hardly
            found[:, :, rough] = np.where(better, again, found[:, :, rough])
            off[:, rough] = np.minimum(rest, off[:, rough])
        return found

    def steps(self, ways: Array) -> Array:
        """Return the difference steps, (k,)."""
        sizes = np.abs(self._coarse[:, None] * ways).max(axis=0, initial=0.0)
        return np.asarray(1.0 / np.where(sizes > 0.0, sizes, 1.0))

    def with_steps(self, function: StateFunction, time: float, y: Array, ways: Array, steps: Array) -> Array:
        """Return derivatives of sixth and fourth order by given steps, (2, values, k)."""
        out = np.zeros((len(WEIGHTS), len(function(time, y)), ways.shape[1]))
        for k, (way, step) in enumerate(zip(ways.T, steps.tolist(), strict=True)):
            if way.any():
                out[:, :, k] = self._near.over(function, time, y, way, step)
        return out

    def over_numbers(self, y: Array, c: int) -> Array:
        """Return the derivative of a contact's gap over each parameter, (parameters,) [m]."""
        near, numbers = self._near, self._near.numbers
        assert numbers is not None
        if (known := self.tangents_at(c)) is not None:
            return known.opening(y, c, self._over_numbers)

        def gap(displaced: Array) -> float:
            with numbers.shifted(displaced):
                return near.workspace.along_normal(y, c)[1]

        here, out = near.workspace.along_normal(y, c)[1], np.zeros(numbers.count)
        for k, way in enumerate(_OF_NUMBERS * np.eye(numbers.count)):
            far = gap(3.0 * way)
            if far == here:
                continue  # most numbers are none of a contact's geometry, and do not move it by a bit
            ahead = np.array([gap(way), gap(2.0 * way), far])
            behind = np.array([gap(-j * way) for j in (1.0, 2.0, 3.0)])
            out[k] = WEIGHTS[0] @ (ahead - behind) / _OF_NUMBERS
        return out

    def opening(self, y: Array, c: int, ways: Array) -> tuple[Array, float]:
        """Return the derivative of a contact's gap along perturbations, (k,), and its rate."""
        near = self._near
        normal, _ = near.workspace.along_normal(y, c)
        own = normal @ ways[near.parts[0]]
        if near.numbers is not None:
            own = own + self.over_numbers(y, c) @ ways[near.parts[-3]]
        nq = near.system.model.nq
        return own, float(normal @ y[nq : nq + near.system.model.nv])

    def impact(self, time: float, y: Array, c: int, ways: Array) -> tuple[Array, Array]:
        """Return derivatives of approach speed and log effective mass at an onset, (2, k) each.

        That is the approach speed [m/s], and the logarithm of the effective mass; by what parts the two rows
        of each it is uncertain.
        """
        if (known := self.tangents_at(c)) is not None:
            faster, heavier = known.impact(y, c, ways)
            return np.array([faster, faster]), np.array([heavier, heavier])
        workspace, (_, rate, *_) = self._near.workspace, self._near.parts
        own = slice(rate.start, self._near.parts[4].stop)
        # Masses do not depend on velocities, and rates do by the normal: no differences are needed.
        placed = ways.copy()
        placed[own] = 0.0

        def met(_: float, state: Array) -> Array:
            workspace.locate(state, self._table)
            return np.array([self._table["rate"][c], np.log(workspace.effective_mass(state, c))])

        faster, heavier = self.both_orders(met, time, y, placed).transpose(1, 0, 2)
        return faster - workspace.along_normal(y, c)[0] @ ways[rate], heavier

    def level(self, frame: Frame, y: Array, up: Array) -> Array | None:
        """Return the basis for differences near onsets and releases, (size, size), or None."""
        workspace = self._near.workspace
        touching = np.flatnonzero(workspace.memory["touching"]).tolist()
        if not (frame.clock and touching):
            return None
        gaps = [(-workspace.along_normal(y, c)[1], c) for c in touching]
        return _gap_basis([self.opening(y, c, up)[0] for _, c in sorted(gaps)], frame.positions)


def _gap_basis(rows: Sequence[Array], ways: int) -> Array:
    """Return the basis, by columns, (size, size).

    Rows are derivatives of gaps over coordinates, the shallowest first; a pivot that changes the gap is
    sought among the first ``ways`` coordinates.
    """
    basis = np.eye(len(rows[0]))
    taken: list[int] = []
    for row in rows:
        here = row @ basis
        among = np.abs(here[:ways])
        among[taken] = 0.0
        one = int(np.argmax(among))
        if among[one] <= _NEW * np.abs(row[:ways]).max():
            continue
        share = here / here[one]
        share[one] = 0.0
        basis -= np.outer(basis[:, one], share)
        taken.append(one)
    return basis


# --- rates along perturbations ------------------------------------------------------------------------------

# Largest difference step of forces over a contact's depth, and least over the default: a force like depth^1.5
# is smooth on no other scale.
_SHARE, _FINEST = 0.02, 1e-6
# Relative difference of two orders across a kink; refinement factor and most refinements; multiple of
# round-off.
_STRADDLES, _FINER, _OFTEN, _NOISY = 1e-8, 8.0, 8, 10.0
# Samples for the round-off of rates, in steps.
_MINUTE, _BESIDE = 1e-3, range(-6, 7)
_SHALLOW = 0.1  # part of their size to which a depth cuts steps where kinks are looked for no more
_OFF = 0.3  # tangent of an angle, in units, by which axes may be off
_OF_ROWS = 1e-3  # step of differences of constraints, in rad and over lengths, on whose scale they are smooth
_LOCATING = 0.01  # over a step of differences, that with which a kink is located: to the square of it


class VectorField:
    """Rates of a system near states of one run, which it belongs to.

    Perturbations include the parameters ``numbers``, if given.

    ``round_off`` is that of the rates where it was last estimated, in units per second.
    """

    def __init__(self, system: System, settings: RunSettings, numbers: ParameterSlopes | None = None) -> None:
        self._near = near = PerturbedSystem(system, settings, numbers)
        self.system, self.workspace, self._stepper = near.system, near.workspace, near.stepper
        self.memory, self.numbers = near.memory, near.numbers
        self.bristles, self.parts = near.bristles, near.parts
        self.units = Units.of(near.system)
        self._slopes = Slopes(self._stepper, self.bristles, WEIGHTS)
        self._met = near.tangents(self.units)
        self._tangents = self._met if Tangents.takes(near.system) else None
        self.displacement = self.parts[-1].stop  #: Size of a perturbation.
        self.works = works_in_x(near.system)  #: Where works and gross works stand in x, (n, 2).
        self._coarse, self.gaps = near.coarseness(self.units), _GapSlopes(near, self.units)
        self._follow()
        self._opened: dict[int, Array] = {}
        self._measured = any(joint.backend != "closed-form" for joint in self.system.clearances)
        self.round_off = 0.0
        over = self._speeds, near.constraint_slopes
        self._lifts = Lifts(self.workspace, self.units, self.memory, self.parts, *over)
        self._rows = np.concatenate([np.arange(system.model.nv), system.model.nv + self.bristles])
        self._weights = 1.0 / np.concatenate([self.units.rate, self.units.bristle])[:, None]

    def stage_propagation(self) -> Carrying | None:
        """Return the propagation of tangents by the integrator's stages, or None."""
        return self._near.stage_propagation(self._tangents if self._by_parts else None, self._coarse)

    def release_words(self, words: NDArray[np.int_]) -> None:
        """Detach words of the program from parameters: an event has set them."""
        if self.numbers is not None and len(words):
            self.numbers.release_words(words)
            self._follow()

    def _follow(self) -> None:
        """Pass parameter slopes to the analytic derivatives, where these accept them."""
        known = self._near.link_parameters(self._met, self.units)
        self._by_parts = known and self._tangents is not None
        self.gaps.tangents = self._met if known else None

    def rates(self, time: float, y: Array) -> Array:
        """Return [acceleration (nv), rate of x (nx)] with contacts and program of the moment."""
        return self._near.rates(time, y)

    def flow(self, time: float, y: Array) -> Array:
        """Return the perturbation per second along the flow, (perturbation,)."""
        return self._near.flow(time, y)

    def integrands(self, time: float, y: Array) -> Array:
        """Return the rates of the integrals of a run, (nx,)."""
        return self._near.rates(time, y)[self.system.model.nv :].copy()

    def frame(self, y: Array, clock: bool = False) -> Frame:
        """Return the axes of coordinates in a state, with the contacts of the moment."""
        frame = frame_at(self.workspace, self.units, y, self.workspace.memory["touching"], self.memory)
        return frame._replace(clock=clock)

    def contact_bristles(self, c: int) -> NDArray[np.int_]:
        """Return the bristles of a contact."""
        strides = [joint.stride for joint in self.system.clearances for _ in joint.contact_names]
        first = self.system.impulse_x[c]
        return np.flatnonzero((self.bristles >= first) & (self.bristles < first + strides[c]))

    # --- derivatives ----------------------------------------------------------------------------------------

    def along(
        self, function: StateFunction, time: float, y: Array, ways: Array, *, of_forces: bool = False
    ) -> Array:
        """Return the derivatives of a function of time and state along perturbations, (values, k).

        Perturbations, (perturbation, k), are of any size. Forces are smooth on the scale of depths only: if
        the function may depend on them, of long and short steps those count that are less uncertain.
        """
        clock = np.zeros_like(ways)  # time is of no size that those of ways would tell, nor they of its
        clock[self.parts[-1]] = ways[self.parts[-1]]
        if (clock.any(axis=0) & (ways != clock).any(axis=0)).any():
            found = self.along(function, time, y, np.hstack([ways - clock, clock]), of_forces=of_forces)
            return np.asarray(found[:, : ways.shape[1]] + found[:, ways.shape[1] :])
        if not of_forces:
            return self.gaps.along(function, time, y, ways)
        size, best, least = np.abs(function(time, y))[:, None], None, np.array(math.inf)
        coarse = self.gaps.steps(ways)
        for steps in (coarse, self._steps(y, ways * coarse / STEP, True) * coarse / STEP):
            sixth, fourth = self.gaps.with_steps(function, time, y, ways, steps)
            doubt = np.abs(sixth - fourth) + _ROUND_OFF * size / steps
            best = sixth if best is None else np.where(doubt < least, sixth, best)
            least = np.minimum(doubt, least)
        return np.asarray(best)

    def slopes(
        self, time: float, y: Array, ways: Array, chosen_steps: Array | None = None
    ) -> tuple[Array, Array, Array]:
        """Return the derivatives of the rates along perturbations, and the steps used.

        Of a tree they are put together from its parts (:class:`antenna_pin.run.engine.Tangents`). Steps of
        differences of the whole are made finer where the two orders part: there they straddle a kink.

        Perturbations, (perturbation, k), are of a size of about 1 in units; the steps, (k,), may be given.

        Returns:
            By differences of sixth and of fourth order, (nv + nx, k) each; and steps, (k,).
        """
        steps = self._steps(y, ways, True) if chosen_steps is None else chosen_steps.copy()
        found = self._differences(time, y, ways, steps, self._tangents or self._slopes)
        off, noise = self._sizes(found[0] - found[1]), _NOISY * self.round_off
        largest = self._sizes(found[0]).max(initial=0.0)
        least = np.maximum(_STRADDLES * largest, noise / steps)
        whole = self._goes_by_more(ways) if self._tangents is not None else np.ones(len(steps), dtype=bool)
        rough, finer = np.flatnonzero(whole & (off > least)), steps.copy()
        rough = rough[~self._shallow(y, ways, steps)[rough]] if len(rough) else rough
        for _ in range(_OFTEN):
            if not len(rough):
                break
            finer[rough] /= _FINER
            again = self._differences(time, y, ways[:, rough], finer[rough])
            rest = self._sizes(again[0] - again[1])
            # Near a kink the orders differ more before steps are so short that they agree.
            enough = np.maximum(least[rough], noise / finer[rough])
            better = (rest < off[rough]) | (rest <= enough)
            taken = rough[better]
            found[:, :, taken], steps[taken], off[taken] = again[:, :, better], finer[taken], rest[better]
            # At a kink they may agree by chance on the mean of two derivatives.
            off[rough] = np.maximum(off[rough], rest)
            rough = rough[rest > enough]
        return found[0], found[1], steps

    def _shallow(self, y: Array, ways: Array, steps: Array) -> NDArray[np.bool_]:
        """Return which steps are too short for a contact's depth to gain accuracy, (k,)."""
        if not self.workspace.memory["touching"].any():
            return np.zeros(len(steps), dtype=bool)
        if self._measured:  # gaps that are measured have a round-off of their own
            return np.ones(len(steps), dtype=bool)
        return np.asarray(steps < _SHALLOW * self._steps(y, ways, False))

    def _differences(
        self, time: float, y: Array, ways: Array, steps: Array, by: Slopes | Tangents | None = None
    ) -> Array:
        """Return derivatives of the rates of sixth and fourth order, (2, nv + nx, k).

        They are of the rates as a whole, or by what is given.
        """
        found = np.array((by or self._slopes).rates(time, y, np.ascontiguousarray(ways), steps))
        if by is self._tangents and self._by_parts:
            return found
        # Compiled differences omit element memory and parameters; what rows hold does not affect rates.
        displaced = ways[self.parts[-3]]
        alone = np.count_nonzero(ways, axis=0) == np.count_nonzero(displaced, axis=0)
        for k in np.flatnonzero(self._goes_by_more(ways)).tolist():
            if alone[k]:
                found[:, :, k] = self._near.over_numbers(time, y, displaced[:, k], float(steps[k]))
            else:
                found[:, :, k] = self._near.over(self.rates, time, y, ways[:, k], float(steps[k]))
        return found

    def _goes_by_more(self, ways: Array) -> NDArray[np.bool_]:
        """Return which perturbations lack compiled derivatives, (k,)."""
        if self._by_parts:
            return np.zeros(ways.shape[1], dtype=bool)
        own = [k for k, one in enumerate(self.memory.numbers) if not one.holds(self.workspace.program)]
        return np.asarray(ways[self.parts[-2]][own].any(axis=0) | ways[self.parts[-3]].any(axis=0))

    def _weighed(self, rates: Array) -> Array:
        """Return derivatives of velocities and bristles in units, from (nv + nx, k)."""
        return np.asarray(rates[self._rows] * self._weights)

    def _sizes(self, rates: Array) -> Array:
        """Return the largest of derivatives in units, (k,)."""
        return np.asarray(np.abs(self._weighed(rates)).max(axis=0, initial=0.0))

    def estimate_round_off(self, time: float, y: Array, way: Array) -> None:
        """Estimate the round-off of rates near a state, along a perturbation."""
        step = _MINUTE * float(self._steps(y, way[:, None], True)[0])
        found = [self._near.at(self.rates, time, y, k * step * way) for k in _BESIDE]
        beside = self._weighed(np.array(found).T)
        least = _ROUND_OFF * float(np.abs(beside).max(initial=0.0))
        self.round_off = max(float(roughness(beside.T).max(initial=0.0)), least)

    def directional(self, time: float, y: Array, way: Array) -> tuple[Array, float]:
        """Return the derivative of the rates along a perturbation, in units, and its round-off."""
        sixth, _, steps = self.slopes(time, y, way[:, None])
        return self._weighed(sixth)[:, 0], self._noise(way[:, None], steps)

    def _noise(self, ways: Array, steps: Array) -> float:
        """Return the round-off of derivatives along a perturbation; infinite for measured gaps."""
        parts = self._tangents is not None and not self._goes_by_more(ways).any()
        unsure = not parts and self._measured and self.workspace.memory["touching"].any()
        return math.inf if unsure else self.round_off / float(steps[0])

    def across_kinks(self, time: float, y: Array, way: Array) -> tuple[Array, float]:
        """Return the derivative along a perturbation by a step across kinks, and that step."""
        ways = way[:, None]
        steps = _LOCATING * self._steps(y, ways, True)
        return self._weighed(self._differences(time, y, ways, steps)[0])[:, 0], float(steps[0])

    def _steps(self, y: Array, ways: Array, of_forces: bool) -> Array:
        """Return the difference steps along perturbations, (k,)."""
        steps = 1.0 / np.maximum(1.0 / STEP, np.abs(self._coarse[:, None] * ways).max(axis=0))
        if not of_forces:
            return np.asarray(steps)
        finest: Array = _FINEST * steps
        for number, change in zip(self.memory.numbers, np.abs(ways[self.parts[-2]]), strict=True):
            rate = abs(float(self.workspace.program[number.word]))
            if number.of_rate and rate > 0.0:  # laws divide by it
                steps = np.minimum(steps, _SHARE * rate / np.maximum(change, 1e-300))
        for c in np.flatnonzero(self.workspace.memory["touching"]).tolist():
            normal, gap = self.workspace.along_normal(y, c)
            opening = np.abs(normal @ ways[self.parts[0]] + self._opening(y, c) @ ways[self.parts[-3]])
            if gap < 0.0:
                steps = np.minimum(steps, -_SHARE * gap / np.maximum(opening, 1e-300))
        return np.asarray(np.maximum(steps, finest))

    def per_second(self, function: StateFunction, time: float, y: Array, *, of_forces: bool = False) -> Array:
        """Return the rate of a function of time and state along the flow, (values,)."""
        flow = self.flow(time, y)
        apart = np.zeros((len(flow), len(self.parts)))  # of which each has a size of its own
        for k, part in enumerate(self.parts):
            apart[part, k] = flow[part]
        return np.asarray(self.along(function, time, y, apart, of_forces=of_forces).sum(axis=1))

    # --- coordinates ----------------------------------------------------------------------------------------

    def lift(self, frame: Frame, time: float, y: Array) -> Lift:
        """Return coordinates as perturbations."""
        return self._lifts.lift(frame, time, y)

    def is_tilted(self, frame: Frame, time: float, y: Array) -> bool:
        """Return whether a frame's axes deviate too far from the constraints' freedoms."""
        return self._lifts.tilt(frame, time, y) > _OFF

    def _speeds(self, time: float, y: Array, ways: Array) -> Array:
        """Return derivatives of constraint rates along perturbations, (rows, k).

        Numbers of the system are left as they are.
        """
        assert self.system.plan is not None
        far = np.abs(ways[self.parts[0]]).max(axis=0) / (_OF_ROWS * min(self.system.plan.length, 1.0))
        sizes = np.maximum(far, np.abs(ways[-1]) / (STEP * TIME_UNIT))
        return np.asarray(self._slopes.speeds(time, y, ways, 1.0 / np.where(sizes > 0.0, sizes, 1.0))[0])

    def _opening(self, y: Array, c: int) -> Array:
        """Return the approximate derivative of a contact's gap over parameters, (parameters,) [m]."""
        if self.numbers is None:
            return np.zeros(0)
        if c not in self._opened:  # it hardly changes while a contact lasts
            lasting = self.workspace.memory["touching"]
            self._opened = {k: one for k, one in self._opened.items() if lasting[k]}
            self._opened[c] = self.gaps.over_numbers(y, c)
        return self._opened[c]

    def matrix(self, frame: Frame, time: float, y: Array, way: Array) -> RateJacobian:
        """Return the Jacobian of the coordinates' rates, along axes at rest.

        The rates are also evaluated along the perturbation ``way``.
        """
        lift = self.lift(frame, time, y)
        nq, nv = self.system.model.nq, self.system.model.nv
        own, rate, bristles, *_ = self.parts
        v, count = y[nq : nq + nv], lift.up.shape[1]
        basis = self.gaps.level(frame, y, lift.up)
        ways = np.column_stack([lift.up if basis is None else lift.up @ basis, way])
        sixth, fourth, steps = self.slopes(time, y, ways)
        both, over = [], [sixth[:, :count], fourth[:, :count]]
        if basis is not None:
            over = [one @ np.linalg.inv(basis) for one in over]
        for found in over:
            change = np.zeros((self.displacement, count))
            change[own] = lift.up[rate] - self.system.manifold.bracket(v, lift.up[own])
            change[rate], change[bristles] = found[:nv], found[nv + self.bristles]
            both.append(lift.down @ change)
        return RateJacobian(
            both[0],
            both[1],
            self._weighed(sixth[:, count:])[:, 0],
            self._noise(way[:, None], steps[count:]),
            over[0][nv:],
        )
