"""Kinks of rates within steps, and tangents by the full Jacobian between them.

A step of an equation ``w' = A(t) w`` has the order of its quadrature where A is smooth, and none where A
jumps between two of the nodes or behind the last of them. So A is also evaluated along one direction, at more
places than the nodes and at both ends: the remainder of a polynomial fit is no larger than a step's error, or
there is a jump, which is bracketed, or the step is too long. Near a kink central differences ramp from one
derivative to the other, odd about the kink, so that the middle of the ramp is the time of the kink to the
square of their step.

A run whose step passes over a kink of a force is wrong by more than its error estimate, by thousands of its
tolerances at worst. The error is found by repeating the step cut at the kink; it is a perturbation,
propagated as all tangents are. A run that is off by e reaches a kink with the passing direction n later by
``dt = -(n e) / g'``. For that time the derivative of the rates is that of the other side, ``b n'`` from its
own, and tangents W miss ``b (n' W) dt``: a column that is propagated from there, with its share in each
tangent.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from antenna_pin.base.arrays import Array
from antenna_pin.base.calculus import WEIGHTS
from antenna_pin.base.settings import RunSettings
from antenna_pin.dynamics import Workspace
from antenna_pin.integrate import NODES, Propagated, Propagator, Stepper, method_named
from antenna_pin.run.simulation.loop import Run
from antenna_pin.run.simulation.steps import stepper_of
from antenna_pin.studies.nonlinear.coordinates import Frame, configuration_difference
from antenna_pin.studies.nonlinear.saltation import RunTangents
from antenna_pin.studies.nonlinear.vector_field import VectorField

# --- parts of a step ----------------------------------------------------------------------------------------

# Bisections of a step; exponent of the time transformation near onsets and releases.
_HALVINGS, _GRADE = 30, 4
# Coincidence as a fraction of a step, and in ulp of its time.
_AT_ONCE, _ULPS = 1e-12, 4.0


class StepPart(NamedTuple):
    """Part of a step, as fractions from 0 to 1."""

    a: float  # begin
    b: float  # end
    graded: bool = False  # whether contacts or drives change at the step's begin
    falling: bool = False  # whether contacts or drives change at the step's end
    known: tuple[bool, bool] = (False, False)  # whether begin and end are known breaks
    halvings: int = _HALVINGS  # remaining number of cuts

    def at(self, places: Array) -> tuple[Array, Array]:
        """Return fractions of the step and their slopes over places from 0 to 1.

        Behind an onset the derivative of a force that begins like depth^1.5 goes with the root of time, and
        likewise before a release: there time goes with a power of what is integrated over.
        """
        size = self.b - self.a
        if self.graded:
            return self.a + size * places**_GRADE, _GRADE * places ** (_GRADE - 1)
        if self.falling:
            rest = 1.0 - places
            return self.b - size * rest**_GRADE, _GRADE * rest ** (_GRADE - 1)
        return self.a + size * places, np.ones(len(places))

    def cut(self, at: float, known: bool) -> tuple[StepPart, StepPart]:
        """Return the two parts before and behind a fraction, which may be a known kink."""
        first, last = self.known
        less = self.halvings - 1
        return (
            self._replace(b=at, falling=False, known=(first, known), halvings=less),
            self._replace(a=at, graded=False, known=(known, last), halvings=less),
        )


def coincidence(time: float, size: float) -> float:
    """Return the fraction of a step, from ``time`` [s], that counts as one time."""
    return max(_AT_ONCE, _ULPS * float(np.spacing(time)) / size)


# --- jumps of a derivative within a step --------------------------------------------------------------------

# Distance of the end samples from the ends of a step, as a fraction: a jump beyond adds as much of itself.
_EDGE = 1.0 - float(NODES[-1])
#: Samples of a step besides its nodes: the largest gap is a sixth of the step.
_BETWEEN = np.array([_EDGE, 0.02, 0.2, 0.5, 0.8, 0.98])
#: All samples, the nodes first.
_SAMPLES = np.concatenate([NODES, _BETWEEN])
#: Indices of the samples at the step's ends: first and last.
_ENDS = len(NODES), len(NODES) - 1
# Degree of the polynomial.
_DEGREE = 6
# Share of a jump, and slope of the ramp of sixth-order differences in its middle, per step.
_QUARTER, _RISE = 0.25, float(WEIGHTS[0].sum())
# Half width of the part of a bracket, and share of the change within it, of a jump.
_NARROW, _CHANGE_OF_JUMP = 0.05, 0.5


class _Jump(NamedTuple):
    """Jump of a derivative."""

    place: float  # place of the jump
    beside: tuple[float, float]  # places before and behind it, near but separate
    later: float  # delay of a perturbed state one step of the ramps away


def _remainder_matrix(places: Array) -> Array:
    """Return the projection that removes the fitted polynomial, (places, places)."""
    basis = np.linalg.qr(np.polynomial.legendre.legvander(2.0 * places - 1.0, _DEGREE))[0]
    return np.asarray(np.eye(len(places)) - basis @ basis.T)


def _sample_order(known: tuple[bool, bool]) -> NDArray[np.intp]:
    """Return the samples that count, in the order of their places."""
    left_out = {end for end, is_known in zip(_ENDS, known, strict=True) if is_known}
    return np.array([k for k in np.argsort(_SAMPLES).tolist() if k not in left_out])


_SAMPLE_ORDER = {
    (one, other): _sample_order((one, other)) for one in (False, True) for other in (False, True)
}
_REST = {known: _remainder_matrix(_SAMPLES[kept]) for known, kept in _SAMPLE_ORDER.items()}


def _polynomial_remainder(values: Array, known: tuple[bool, bool]) -> tuple[float, tuple[int, int]]:
    """Return the remainder of a polynomial fit, and the two samples of its largest jump."""
    kept = _SAMPLE_ORDER[known]
    rest = _REST[known] @ values[kept]
    worst = int(np.argmax(np.linalg.norm(np.diff(rest, axis=0), axis=1)))
    return float(np.linalg.norm(rest, axis=1).max()), (int(kept[worst]), int(kept[worst + 1]))


def _locate_jump(
    ramps: Callable[[float], Array],
    jumps: Callable[[float], Array],
    low: float,
    high: float,
    before: Array,
    after: Array,
) -> _Jump | None:
    """Return the jump of a function of one number between two places, or None.

    Values ``ramps(place)`` are by equal steps, ``jumps(place)`` by steps that straddle no kink; ``before``
    and ``after`` are those at ``low`` and ``high``.
    """
    change = after - before
    size = float(change @ change)

    def past(function: Callable[[float], Array], place: float) -> float:
        return float((function(place) - before) @ change) / size - 0.5

    if not size > 0.0 or not past(ramps, low) < 0.0 < past(ramps, high):
        return None
    place = float(brentq(lambda there: past(ramps, there), low, high, xtol=1e-15, rtol=1e-15))
    near = _NARROW * (high - low)
    beside = max(place - near, low), min(place + near, high)
    if not past(jumps, beside[1]) - past(jumps, beside[0]) > _CHANGE_OF_JUMP:
        return None
    # The slope of the ramp is the delay of a perturbed state at the kink.
    there, rise = high, past(ramps, high)
    if rise > _QUARTER > past(ramps, place):
        there = float(brentq(lambda at: past(ramps, at) - _QUARTER, place, high, xtol=1e-15, rtol=1e-6))
        rise = _QUARTER
    return _Jump(place, beside, (there - place) / (rise / _RISE))


# --- errors of a run at kinks -------------------------------------------------------------------------------

# Default error of a run in units, over its tolerance.
_OFF = 10.0
# Most columns of defects; beyond, the two oldest are merged.
_MOST_DEFECTS = 16


class _Kink(NamedTuple):
    """Passing of a kink."""

    force: Array  # b, a direction of the coordinates, (size,)
    passing: Array  # n, likewise; the derivative of rates jumps by ``b n'`` [1/s]
    later: float  # by how much later a perturbed state comes there that is off by n over its own square [s]

    @classmethod
    def of(cls, jump: Array, way: Array, later: float) -> _Kink:
        """Return the kink with a jump of the Jacobian."""
        forces, sizes, passings = np.linalg.svd(jump)
        passing = sizes[0] * passings[0]
        along = float(passing @ way)
        return cls(forces[:, 0], passing, abs(later / along) if along != 0.0 else 0.0)


class KinkDefects:
    """Defects of tangents at kinks: columns behind them, with the run's error and the flow.

    The columns are tangents, what the run is off by, the flow, what is missed.
    """

    def __init__(self, count: int, rtol: float) -> None:
        self._count, self._least = count, _OFF * rtol
        self._parts: list[Array] = []

    def begin(self, ways: Array) -> Array:
        """Return tangents, (size, count), with the additional columns, zero."""
        return np.hstack([ways, np.zeros((len(ways), 2))])

    @property
    def flow_column(self) -> int:
        """Column of the flow; zero where the flow is not propagated."""
        return self._count + 1

    def without_defects(self, tangents: RunTangents) -> RunTangents:
        """Return the tangents alone."""
        return tangents.mapped(lambda columns: columns[:, : self._count])

    def run_error(self, tangents: RunTangents) -> Array:
        """Return the error of the run as a perturbation, (size,)."""
        return np.asarray(tangents.matrix[:, self._count])

    def with_run_error(self, tangents: RunTangents, more: Array) -> RunTangents:
        """Return tangents with a further error of the run, (size,)."""
        both = tangents.matrix.copy(), tangents.other.copy()
        for one in both:
            one[:, self._count] += more
        return RunTangents(*both, tangents.frame, tangents.integrals)

    def with_kink(self, kink: _Kink, error: Array, tangents: RunTangents) -> RunTangents:
        """Return tangents with their defect at a kink that a run with an error passes."""
        size = float(np.linalg.norm(kink.passing))
        late = kink.later * (abs(float(kink.passing @ error)) + size * self._least)
        self._parts.append(np.abs(kink.passing @ tangents.matrix[:, : self._count]) * late)
        column = kink.force[:, None]
        matrix, other = (np.hstack([one, column]) for one in tangents[:2])
        return RunTangents(matrix, other, tangents.frame, np.pad(tangents.integrals, ((0, 0), (0, 1))))

    def merge(self, tangents: RunTangents) -> RunTangents:
        """Return tangents with the two oldest defects merged where there are too many."""
        while len(self._parts) > _MOST_DEFECTS:
            first = self._count + 2
            sizes = np.linalg.norm(tangents.matrix[:, first : first + 2], axis=0)
            kept = int(np.argmax(sizes))
            if sizes[kept] > 0.0:
                self._parts[1 - kept] = self._parts[1 - kept] * (sizes[1 - kept] / sizes[kept])
            self._parts[:2] = [self._parts[0] + self._parts[1]]
            lost = first + 1 - kept
            tangents = tangents.mapped(lambda columns, lost=lost: np.delete(columns, lost, axis=1))  # type: ignore[misc]
        return tangents

    def sizes(self, tangents: RunTangents) -> Array:
        """Return the size of each tangent's defects, (count,)."""
        matrix = tangents.matrix
        error = float(np.linalg.norm(self.run_error(tangents)))
        out = np.linalg.norm(matrix[:, : self._count], axis=0) * error
        for column, parts in zip(matrix.T[self._count + 2 :], self._parts, strict=True):
            out += float(np.linalg.norm(column)) * parts
        return np.asarray(out)


class CutStep:
    """Repetition of a run's step, cut at kinks, for the error of the run's own.

    Contact memory and program of ``source`` are those of the step.
    """

    def __init__(self, field: VectorField, settings: RunSettings, scales: Array, source: Workspace) -> None:
        """Allocate nothing: most runs have no kink."""
        self._field, self._settings, self._scales, self._source = field, settings, scales, source
        self._made: tuple[Workspace, Stepper] | None = None
        self._begun = False

    def begin(self, time: float, y: Array) -> None:
        """Begin a step in a state."""
        self._start = time, y.copy()
        self._begun = False

    def to(self, time: float) -> Array:
        """Return the state at a time within the step, to which it is cut [s]."""
        workspace, stepper = self._made = self._made or self._make()
        if not self._begun:
            workspace.memory[:], workspace.program[:] = self._source.memory, self._source.program
            stepper.restart(*self._start)
            self._begun = True
        if time > stepper.t:
            stepper.attempt(time - stepper.t)
            stepper.restart(time, stepper.y.copy())
        return np.array(stepper.start)

    def _make(self) -> tuple[Workspace, Stepper]:
        workspace, method = Workspace(self._field.system), method_named(self._settings.method)
        return workspace, stepper_of(workspace, method, self._scales, self._settings)

    def off(self, time: float, y: Array) -> Array:
        """Return the error of a state as a perturbation; zero where nothing was cut."""
        out = np.zeros(self._field.displacement)
        if not self._begun:
            return out
        nq, nv = self._field.system.model.nq, self._field.system.model.nv
        there = self.to(time)
        way, rate, bristles, *_ = self._field.parts
        out[way] = configuration_difference(self._field.system, there[:nq], y[:nq])
        out[rate] = y[nq : nq + nv] - there[nq : nq + nv]
        out[bristles] = (y - there)[nq + nv + self._field.bristles]
        return out


# --- states within a step -----------------------------------------------------------------------------------


class StepStates:
    """States within a step of a run, which is repeated on demand."""

    def __init__(self, run: Run) -> None:
        self.workspace = Workspace(run.system)
        method = method_named(run.settings.method)
        self._dense = stepper_of(self.workspace, method, run.stepper.scales, run.settings)
        self.time, self.size = run.stepper.t, 0.0
        self._first = run.here.copy()
        self._end: Array | None = None
        self._made = False

    @property
    def touching(self) -> NDArray[Any]:
        """Contacts that touch in the step, 0 or not, (contacts,)."""
        return np.asarray(self.workspace.memory["touching"])

    def take_over(self, run: Run) -> None:
        """Copy contact memory and program of a run, for the step that follows."""
        memory, program = run.workspace.memory, run.workspace.program
        self.workspace.memory[:], self.workspace.program[:] = memory, program

    def begin(self, time: float, y: Array, size: float, end: Array | None) -> None:
        """Begin a step.

        The state at the end is None where only the step itself determines it.
        """
        self.time, self._first, self.size, self._end = time, y, size, end
        self._made = False

    def at(self, theta: float) -> Array:
        """Return the state at a fraction of the step."""
        if theta == 0.0:
            return self._first
        if theta == 1.0 and self._end is not None:
            return self._end
        if not self._made:
            self._dense.restart(self.time, self._first)
            self._dense.attempt(self.size)
            self._dense.prepare_dense()
            self._made = True
        y = np.zeros_like(self._first)
        self._dense.interpolate(theta, y)
        return y


def _locate_kink(
    part: StepPart,
    between: tuple[int, int],
    samples: list[tuple[Array, float]],
    states: StepStates,
    by: tuple[VectorField, Frame, Array, Array],
) -> tuple[float, _Kink] | None:
    """Return fraction of the step and kink between two samples of a part, or None.

    ``between`` are two indices of ``_SAMPLES``, ``samples`` the rates along the tangent there; ``by`` are the
    field, the axes, the tangent and its coordinates.
    """
    field, frame, way, unit = by

    def looked(place: float, look: Callable[[float, Array, Array], tuple[Array, float]]) -> Array:
        (theta,), (slope,) = part.at(np.array([place]))
        there = states.time + float(theta) * states.size, states.at(float(theta))
        return float(slope) * look(*there, way)[0]

    low, high = between
    found = _locate_jump(
        lambda place: looked(place, field.across_kinks),
        lambda place: looked(place, field.directional),
        float(_SAMPLES[low]),
        float(_SAMPLES[high]),
        samples[low][0],
        samples[high][0],
    )
    if found is None:
        return None
    (cut, before, behind), (slope, *_) = part.at(np.array([found.place, *found.beside]))
    one, other = (
        field.matrix(frame, states.time + s * states.size, states.at(s), way).sixth
        for s in (float(before), float(behind))
    )
    step = field.across_kinks(states.time + cut * states.size, states.at(float(cut)), way)[1]
    later = found.later * slope * (part.b - part.a) * states.size / step
    return float(cut), _Kink.of(other - one, unit, later)


# --- tangents with the full Jacobian ------------------------------------------------------------------------

# Bisections in search of a kink: beyond, the remainder enters the error estimate.
_SEARCHES = 8
# Steps between two estimates of the round-off of rates, where nothing changes.
_LOOKS = 8
# Multiple of round-off that a part's derivatives may deviate by.
_NOISY = 30.0


class JacobianPropagation:
    """Propagation of tangents with the full Jacobian, over parts as short as necessary.

    A part's error over the tangents may reach ``good``.

    Attributes:
        made: Parts over which tangents were carried.
        left_over: What is wrong by breaks that were not found, over the tangents.
        opening: At the step's end the derivative of the gap of a contact that ends there over coordinates,
            (size,); None if there is none.
    """

    def __init__(
        self, field: VectorField, states: StepStates, cut_step: CutStep, defects: KinkDefects, good: float
    ) -> None:
        self._field, self._states, self._cut_step, self._defects = field, states, cut_step, defects
        self._good, self.made, self.left_over = good, 0, 0.0
        self.opening: Array | None = None
        self._looked_at = self._steps = 0
        self._unseen: tuple[float, Array] | None = None
        self._way: tuple[Frame, Array, Array] | None = None
        self._propagator = Propagator(0)

    def begin(self, time: float, y: Array, reordered: bool) -> None:
        """Begin a step in a state."""
        self._steps += 1
        if reordered or self._steps > self._looked_at + _LOOKS:
            self._unseen = time, y

    def _along(self, frame: Frame) -> tuple[Array, Array]:
        """Return a random perturbation of the state along which kinks are sought, and its coordinates."""
        if self._way is None or self._way[0] is not frame:
            states = self._states
            up = self._field.lift(frame, states.time, states.at(0.0)).up
            some = np.asarray(np.random.default_rng(0).standard_normal(up.shape[1]))
            *_, numbers, _, clock = self._field.parts
            some[up[numbers].any(axis=0) | up[clock].any(axis=0)] = 0.0  # what breaks does so in states
            unit = np.asarray(some / np.linalg.norm(some))
            self._way = frame, up @ unit, unit
        return self._way[1:]

    def over(self, part: StepPart, tangents: RunTangents) -> RunTangents:
        """Return tangents behind a part of the step."""
        self.made += 1
        frame, (way, unit) = tangents.frame, self._along(tangents.frame)
        if self._unseen is not None:
            self._field.estimate_round_off(*self._unseen, way)
            self._unseen, self._looked_at = None, self._steps
        field, states, at = self._field, self._states, self._states.at
        start, whole = states.time, states.size
        length = (part.b - part.a) * whole
        thetas, slopes = part.at(NODES)
        found = [field.matrix(frame, start + s * whole, at(s), way) for s in thetas.tolist()]
        sixth, fourth, books = (
            np.array([one * s for one, s in zip(each, slopes, strict=True)])
            for each in ([f.sixth for f in found], [f.fourth for f in found], [f.integrals for f in found])
        )
        if self._propagator.size != sixth.shape[1]:
            self._propagator = Propagator(sixth.shape[1])
        step = self._propagator.step(length, sixth)
        # Neither method detects a jump between the nodes, or behind the last.
        seen = [(f.along * s, f.noise * s) for f, s in zip(found, slopes.tolist(), strict=True)]
        for s, slope in zip(*(one.tolist() for one in part.at(_BETWEEN)), strict=True):
            value, noise = field.directional(start + s * whole, at(s), way)
            seen.append((value * slope, noise * slope))
        rest, (low, high) = _polynomial_remainder(np.array([value for value, _ in seen]), part.known)
        noise = _NOISY * length * max(one for _, one in seen)
        off = length * rest if length * rest <= self._good else max(length * rest - noise, 0.0)
        found_break = None
        if off > self._good:
            by = field, frame, way, unit
            found_break = _locate_kink(part, (low, high), seen, states, by)
        searching = off > self._good and part.halvings > _HALVINGS - _SEARCHES
        rough = (
            not _relative_error(part, step, tangents, self._defects.flow_column, self.opening) <= self._good
        )
        if part.halvings > 0 and (found_break is not None or searching or rough):
            cut = 0.5 * (part.a + part.b) if found_break is None else found_break[0]
            before, behind = part.cut(cut, found_break is not None)
            tangents = self.over(before, tangents)
            if found_break is not None:
                tangents = self._pass(*found_break, tangents)
            return self.over(behind, tangents)
        self.left_over += off
        other = step.other + self._propagator.change(length, fourth - sixth)
        booked = tangents.integrals + self._propagator.integral(length, books) @ tangents.matrix
        return RunTangents(step.matrix @ tangents.matrix, other @ tangents.other, frame, booked)

    def _pass(self, theta: float, kink: _Kink, tangents: RunTangents) -> RunTangents:
        """Add the defect of tangents at a kink at a fraction of the step."""
        time, y = self._states.time + theta * self._states.size, self._states.at(theta)
        self._cut_step.to(time)
        down = self._field.lift(tangents.frame, time, y).down
        error = self._defects.run_error(tangents) + down @ self._cut_step.off(time, y)
        return self._defects.with_kink(kink, error, tangents)


def _relative_error(
    part: StepPart, step: Propagated, tangents: RunTangents, flow: int, opening: Array | None
) -> float:
    """Return the error of a step of a part, over its size [-].

    Near onsets and releases it is that of the tangents at the perturbed onsets and releases.
    """
    if not (part.graded or part.falling) or not tangents.frame.clock:
        return step.off
    ends, wrong = step.matrix @ tangents.matrix, (step.matrix - step.other) @ tangents.matrix
    if part.falling and opening is not None:
        late = (opening @ ends) / (opening @ ends[:, flow])
        late[flow] = 0.0
        ends, wrong = (one - np.outer(one[:, flow], late) for one in (ends, wrong))
        ends[:, flow] = 0.0
    sizes = np.linalg.norm(ends, axis=0)
    counts = sizes > 0.0
    return float((np.linalg.norm(wrong, axis=0)[counts] / sizes[counts]).max(initial=0.0))
