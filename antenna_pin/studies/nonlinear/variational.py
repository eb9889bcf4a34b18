"""The variational equation: tangents of a state propagated along a run, through events too.

Between events tangents w obey ``w' = A(t) w``, with the Jacobian A of the rates. At an event, where the
function g passes zero, the rates jump from f- to f+ and the state may go through a map R. A perturbed state
reaches it later by ``dt = -(dg w) / g'``, and its tangent behind it is, by the saltation matrix,

    w+ = DR w + (DR f- + R_t - f+) dt

(Aizerman and Gantmakher 1958, J. Mech. Appl. Math. 11; Leine and Nijmeijer 2004, Dynamics and Bifurcations of
Non-Smooth Mechanical Systems, section 7.4).

Where contacts begin and end the derivative of a force over the depth may be unbounded. So from an onset on
tangents are those at equal times since the perturbed onsets, ``w + f dt``, with time as one more coordinate:
they obey the same equation, their depth begins at zero, and the unbounded derivative is multiplied by that.
The discrete state of the onset is of the same time. Deep in the contact, or behind it, tangents return to
equal times. To a release the flow is propagated beside them by the same equation: combined so that the depth
vanishes there, the two are free of the propagation error on the way
(:meth:`antenna_pin.studies.nonlinear.saltation.Saltation.release`).

Where a force has a kink, A jumps: tangents are continuous, but the step must be cut there. At declared kinks
the run's own steps end; others are found (:mod:`antenna_pin.studies.nonlinear.kinks`), and the error of the
run there enters the error estimate.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from antenna_pin.base.arrays import Array
from antenna_pin.run.engine import Carrying, Steps
from antenna_pin.run.simulation.loop import Run
from antenna_pin.run.simulation.steps import LoggedStep
from antenna_pin.studies.nonlinear.coordinates import Frame, Lift
from antenna_pin.studies.nonlinear.kinks import (
    CutStep,
    JacobianPropagation,
    KinkDefects,
    StepPart,
    StepStates,
    coincidence,
)
from antenna_pin.studies.nonlinear.perturbed_system import ParameterSlopes
from antenna_pin.studies.nonlinear.saltation import (
    EventShift,
    RunTangents,
    Saltation,
    at_equal_times,
    with_time,
)
from antenna_pin.studies.nonlinear.vector_field import VectorField

# --- tangents by the stages of the integrator ---------------------------------------------------------------

# Most parts of a step tried by stages before the full Jacobian is used.
_TRIES = 48
# Factor from the estimate to the error of a step over a kink: of order 8(5,3) enough in nine of ten cases.
_OVER_KINKS = 13.0


class _TangentStep(NamedTuple):
    """A step of a run."""

    time: float  # begin [s]
    size: float  # size [s]
    y: Array  # state at the begin
    until: float  # end [s]
    end: Array  # state at the end, before its changes
    changes: tuple[bool, bool]  # whether contacts or drives change at begin and end
    known: tuple[bool, bool]  # whether begin and end are known breaks

    @property
    def part(self) -> StepPart:
        """The whole step."""
        return StepPart(0.0, 1.0, *self.changes, self.known)


class _StagePropagation:
    """Propagation of tangents along parts of a step by the integrator's stages.

    Ways, rates and bristles, ``moving``, are the parts of a tangent that change between events.
    """

    def __init__(self, carrying: Carrying, moving: slice) -> None:
        self._carrying, self._moving = carrying, moving
        self.since = -math.inf
        self.made = 0

    def _since(self, known: bool, time: float) -> float:
        """Return the last change of the rates before a part of a step [s]."""
        return time if known else self.since

    def over(
        self,
        part: StepPart,
        start: tuple[float, float, Array],
        lift: Lift,
        tangents: RunTangents,
        good: float,
    ) -> RunTangents | None:
        """Return tangents behind a part of a step, or None where they are too inaccurate.

        ``start`` is the step's time [s], its size [s] and the state at the part's beginning. Errors of the
        method and of differences, whose orders differ near a kink of a force, may reach ``good`` over a
        tangent.
        """
        time, whole, y = start
        matrix, off = tangents.matrix, tangents.other - tangents.matrix
        there, behind = (np.flatnonzero(one.any(axis=0)) for one in (matrix, off))
        begin, size = time + part.a * whole, (part.b - part.a) * whole
        # A part has no known kink at both ends.
        falling = (part.falling or part.known[1]) and not part.known[0]
        found = self._carrying.along(
            (begin, size, y),
            lift.up @ matrix[:, there],
            lift.up @ off[:, behind],
            until=begin + size if falling else math.inf,
            since=self._since(part.known[0], begin),
        )
        down, moved = lift.down, lift.down @ found.ways
        count = len(there)
        sizes = np.linalg.norm(moved[:, :count], axis=0)
        if not (found.sizes * [[_OVER_KINKS], [1.0]] <= good * sizes).all():
            return None
        self.made += 1
        ends, rests = np.zeros_like(matrix), np.zeros_like(matrix)
        ends[:, there], rests[:, behind] = moved[:, :count], moved[:, count:]
        rests[:, there] += down[:, self._moving] @ (_OVER_KINKS * found.errors + found.rough)
        books = tangents.integrals.copy()
        books[:, there] += found.books
        return RunTangents(ends, ends + rests, tangents.frame, books)

    def in_halves(
        self,
        part: StepPart,
        states: StepStates,
        lift: Callable[[Frame, float, Array], Lift],
        tangents: RunTangents,
        good: float,
    ) -> RunTangents | None:
        """Return tangents behind a part of a step, halved where necessary, or None."""
        tries = _TRIES

        def along(part: StepPart, tangents: RunTangents) -> RunTangents | None:
            nonlocal tries
            if all(part.known) or tries == 0:
                return None
            tries -= 1
            y = states.at(part.a)
            here = lift(tangents.frame, states.time + part.a * states.size, y)
            found = self.over(part, (states.time, states.size, y), here, tangents, good)
            if found is None and part.halvings > 0:
                found = tangents
                for half in part.cut(0.5 * (part.a + part.b), False):
                    found = None if found is None else along(half, found)
            return found

        return along(part, tangents)

    def over_steps(
        self, steps: Sequence[_TangentStep], lift: Lift, tangents: RunTangents, good: float, until: float
    ) -> tuple[int, RunTangents]:
        """Return the number of steps with accurate tangents, and the tangents behind them."""
        matrix, off = tangents.matrix, tangents.other - tangents.matrix
        there = np.flatnonzero((matrix != 0.0).any(axis=0) | (off != 0.0).any(axis=0))
        every = Steps(
            np.array([one.time for one in steps]),
            np.array([one.size for one in steps]),
            np.array([self._since(one.known[0], one.time) for one in steps]),
            np.array([until]),
            np.array([one.y for one in steps]),
        )
        # Each part of a perturbation is one coordinate, or none.
        scales = np.abs(lift.down).sum(axis=0)
        before = lift.up @ matrix[:, there], lift.up @ off[:, there]
        done, ways, rest, booked = self._carrying.along_all(every, *before, scales, good)
        self.made += done
        if not done:
            return 0, tangents
        ends, rests, books = np.zeros_like(matrix), np.zeros_like(matrix), tangents.integrals.copy()
        ends[:, there], rests[:, there] = lift.down @ ways, lift.down @ rest
        books[:, there] += booked
        return done, RunTangents(ends, ends + rests, tangents.frame, books)


# Relative difference of work and gross work without reversal; samples of a step for the sign of a power.
_ROUND_OFF, _PARTS = 16.0 * float(np.finfo(float).eps), 16


# --- steps cut at reversals of work, where the rate of gross work has a kink --------------------------------
#
# The integral of that rate has none: its derivative is that of ``sgn(P) dP``, without a jump. It suffices
# that no part of a step has both signs of the power in it.


def _cut_at_reversals(step: _TangentStep, states: StepStates, field: VectorField) -> list[_TangentStep]:
    """Return the parts of a step between reversals of work, where parameters need them."""
    works = field.works
    if field.numbers is None or not len(works):
        return [step]
    places = works + field.system.model.nq + field.system.model.nv
    gone = np.abs(step.end[places] - step.y[places])
    turn = gone[:, 1] - gone[:, 0] > _ROUND_OFF * np.abs(step.end[places]).sum(axis=1)
    if not turn.any():
        return [step]
    states.begin(step.time, step.y, step.size, step.end)
    thetas = np.unique([0.0, *_reversals(works[turn, 0], step, states, field), 1.0]).tolist()
    instants = [*(step.time + theta * step.size for theta in thetas[:-1]), step.until]
    ys = [step.y, *(states.at(theta) for theta in thetas[1:-1]), step.end]
    last, parts = len(thetas) - 2, []
    for k in range(last + 1):
        ends = k == 0, k == last
        changes = ends[0] and step.changes[0], ends[1] and step.changes[1]
        known = not ends[0] or step.known[0], not ends[1] or step.known[1]
        size = (thetas[k + 1] - thetas[k]) * step.size
        parts.append(_TangentStep(instants[k], size, ys[k], instants[k + 1], ys[k + 1], changes, known))
    return parts


def _reversals(
    works: NDArray[np.int_], step: _TangentStep, states: StepStates, field: VectorField
) -> list[float]:
    """Return the fractions of a step at which works reverse."""

    def power(theta: float, x: int) -> float:
        return float(field.integrands(step.time + theta * step.size, states.at(theta))[x])

    found = []
    for x in works.tolist():
        values = np.array([power(k / _PARTS, x) for k in range(_PARTS + 1)])
        for k in np.flatnonzero(values[1:] * values[:-1] < 0.0).tolist():
            low, high = k / _PARTS, (k + 1) / _PARTS
            found.append(float(brentq(power, low, high, args=(x,), xtol=1e-15)))
    return found


# Relative error of a part of a step over the run's tolerance; factor for stages, whose estimate is of a lower
# order.
_GOOD, _BY_STAGES = 1e2, 10.0
# Depth of a contact that is no longer young, over the tolerance of its onset: derivatives over a clearance
# are off by 3e-5 (Tsuji's law) at once, by 7e-12 from 1 on, by 1e-13 from 1e4 on; a hundred times that.
_DEEP = 1e6
# Most steps that wait to be propagated together.
_TOGETHER = 64


class TangentPropagation:
    """Observer of a run that propagates tangents along it.

    Tangents ``ways``, (size, k), are in coordinates along the axes of the first state, or a function of
    these; all by default. ``looks`` are rising times of ``on_look`` [s].
    """

    def __init__(
        self,
        run: Run,
        frame: Frame,
        ways: Array | Callable[[Lift], Array] | None = None,
        numbers: ParameterSlopes | None = None,
        looks: Sequence[float] = (),
    ) -> None:
        """Begin in the run's first state."""
        settings = run.settings
        self.field = VectorField(run.system, settings, numbers)
        workspace = self.field.workspace
        workspace.memory[:], workspace.program[:] = run.workspace.memory, run.workspace.program
        self.states = states = StepStates(run)
        self._cut_step = CutStep(self.field, settings, run.stepper.scales, states.workspace)
        self._good = _GOOD * settings.rtol
        carrying, moving = self.field.stage_propagation(), slice(self.field.parts[2].stop)
        #: Propagation by the run's own stages, or None.
        self.stages = None if carrying is None else _StagePropagation(carrying, moving)
        self._deep = _DEEP * np.array(run.search.tolerances)
        self._young: set[int] = set()
        self._take_over(run)
        self._begins = False, False
        self._waiting: list[_TangentStep] = []
        self._looks = list(looks)
        #: Callbacks at looks and before changes: ``(time, y, perturbations)``, the last (perturbation, k).
        self.on_look: Callable[[float, Array, Array], None] | None = None
        self.on_change: Callable[[float, Array, Array], None] | None = None
        lift = self.field.lift(frame, self._time, self._y)
        start = np.eye(lift.up.shape[1]) if ways is None else ways(lift) if callable(ways) else ways
        self._saltation = Saltation(self.field, run, start.shape[1])
        self._defects = KinkDefects(start.shape[1], settings.rtol)
        self._matrices = JacobianPropagation(self.field, states, self._cut_step, self._defects, self._good)
        self._matrices.begin(self._time, self._y, True)
        start = self._defects.begin(start)
        self._all = RunTangents(
            start, start.copy(), frame, np.zeros((run.system.manifold.nx, start.shape[1]))
        )

    @property
    def tangents(self) -> RunTangents:
        """Tangents in the present state, at equal times."""
        self._go_along()
        return self._defects.without_defects(at_equal_times(self.field, self._all, *self._here))

    @property
    def event_shifts(self) -> tuple[EventShift, ...]:
        """Onsets, releases and events so far, with the shifts of their times."""
        return tuple(self._saltation.event_shifts)

    @property
    def matrices(self) -> int:
        """Number of parts of steps propagated with the full Jacobian."""
        return self._matrices.made

    @property
    def rank(self) -> int:
        """Number of directions left: where a joint comes to rest one is lost."""
        return self._saltation.rank

    def _take_over(self, run: Run) -> None:
        """Begin the next step at the run's present state."""
        self._time, self._y = self._here = run.stepper.t, run.here.copy()
        self.states.take_over(run)

    def observe(self, run: Run) -> None:
        """Propagate tangents over the steps since the last call, and over the changes behind them."""
        touching, steps = run.workspace.memory["touching"], run.steps.log
        flipped = np.flatnonzero(self.states.touching != touching).tolist()
        happened, breaks = self._saltation.event_times(), {one.last for one in run.watch.value()}
        for one in steps:
            changing = flipped if one is steps[-1] else []
            ends = bool(changing) or one.until in happened, one.until in breaks
            self._over(one, ends, [c for c in changing if touching[c] == 0.0])
        if flipped or happened:
            self._change(run.workspace.memory, flipped, bool(steps))
        self._take_over(run)
        if flipped or happened:
            self._young = {c for c in {*self._young, *flipped} if touching[c] != 0.0}
            self._settle()

    def _over(self, one: LoggedStep, ends: tuple[bool, bool], parting: Sequence[int]) -> None:
        """Propagate tangents over a step, now or with those that follow."""
        whole = _TangentStep(*one, (self._begins[0], ends[0]), (any(self._begins), any(ends)))
        for step in _cut_at_reversals(whole, self.states, self.field):
            own, along = parting if step.until == one.until else (), self._goes_along(step)
            if along:
                self._waiting.append(step)
            if not along or len(self._waiting) >= _TOGETHER:
                self._go_along(step.until if own else np.inf)
            if not along:
                self._step(step, own)
        self._time, self._y = self._here = one.until, one.end
        self._begin(ends)
        if not ends[0]:
            self._settle()

    def _begin(self, begins: tuple[bool, bool]) -> None:
        """Begin the next step, with changes or breaks of the rates at its start."""
        self._begins = begins
        if begins[0] and self.stages is not None:
            self.stages.since = self._time

    def _change(self, memory: NDArray[Any], flipped: list[int], moved: bool) -> None:
        """Propagate tangents over the changes in the present state.

        If ``moved``, a step has led there, along which the flow is propagated to contacts that end.
        """
        self._go_along()
        here, ending = (self._time, self._y), [c for c in flipped if memory["touching"][c] == 0.0]
        if not moved:
            self._tell(self.on_change)
            self._begin((True, False))
        for c in ending:
            if not moved:
                self._set_flow(*here)
            self._all = self._saltation.release(c, self._defects.flow_column, self._all, *here)
        if ending:
            for one in (self._all.matrix, self._all.other, self._all.integrals):
                one[:, self._defects.flow_column] = 0.0
        self._all = self._saltation.across_events(self._all, *here)
        for c in [c for c in flipped if c not in ending]:
            self._all = self._saltation.onset(c, memory[c], with_time(self._all), *here)

    def _settle(self) -> None:
        """Bring tangents back to equal times, where no contact is young any more."""
        places = self.field.workspace.along_normal
        self._young = {c for c in self._young if places(self._y, c)[1] > -float(self._deep[c])}
        if not self._young and self._all.frame.clock:
            self._go_along()
            self._all = at_equal_times(self.field, self._all, *self._here)

    def add_look(self, time: float) -> None:
        """Add a later time at which ``on_look`` is called [s]."""
        place = bisect_left(self._looks, time)
        if time not in self._looks[place : place + 1]:
            self._looks.insert(place, time)

    def add_integral(self, place: int, more: Array) -> None:
        """Add the change of each tangent, (k,), of an integral of the run."""
        self._go_along()
        self._all.integrals[place, : len(more)] += more

    def end(self, run: Run) -> None:
        """Propagate tangents to the end."""
        self.observe(run)
        self._go_along()

    def _goes_along(self, step: _TangentStep) -> bool:
        """Return whether a step can be propagated together with others.

        Nothing is to be seen within it, or changes at its end, and axes stay as they are.
        """
        if self.stages is None or self.field.workspace.constraints is not None:
            return False
        seen = (
            self._looks and self._looks[0] < step.time + (1.0 + coincidence(step.time, step.size)) * step.size
        )
        return not (step.changes[1] or step.known[1] or seen)

    def _go_along(self, until: float = np.inf) -> None:
        """Propagate tangents over the waiting steps, up to the next release [s]."""
        steps, self._waiting, here = self._waiting, [], (self._time, self._y, self._here)
        while steps:
            assert self.stages is not None
            lift = self.field.lift(self._all.frame, steps[0].time, steps[0].y)
            done, self._all = self.stages.over_steps(steps, lift, self._all, _BY_STAGES * self._good, until)
            for one in steps[:done]:
                self._matrices.begin(one.time, one.y, one.changes[0] or bool(self._young))
            if done < len(steps):
                self._step(steps[done], ())
            steps = steps[done + 1 :]
        self._time, self._y, self._here = here

    def _step(self, step: _TangentStep, parting: Sequence[int]) -> None:
        """Propagate tangents over a step."""
        self._time, self._y = step.time, step.y
        self.states.begin(step.time, step.y, step.size, step.end)
        self._cut_step.begin(step.time, step.y)
        (begins, ends), known, end = step.changes, step.known, step.until
        self._matrices.begin(step.time, step.y, begins or bool(self._young))
        rest = step.part
        if all(known):
            self._part(StepPart(0.0, 0.5, begins, False, (True, False)))
            rest = StepPart(0.5, 1.0, False, ends, (False, True))
        whole = self.states.at(1.0)
        if parting:
            self._set_flow(self._time + rest.a * self.states.size, self.states.at(rest.a))
            up = self.field.lift(self._all.frame, end, whole).up
            self._matrices.opening = self.field.gaps.opening(whole, parting[0], up)[0]
        self._part(rest)
        self._matrices.opening = None
        off = self._cut_step.off(end, whole)
        if off.any():
            self._all = self._defects.with_run_error(self._all, self._down(end, whole) @ off)
        self._all = self._defects.merge(self._all)
        self._time, self._y = self._here = end, whole
        if self.field.is_tilted(self._all.frame, end, whole):
            self.turn(self.field.frame(self._y, self._all.frame.clock))
        if ends:
            self._tell(self.on_change)

    def _set_flow(self, time: float, y: Array) -> None:
        """Write the flow of a state into its column."""
        self._all = with_time(self._all)
        flow = self._down(time, y) @ self.field.flow(time, y)
        for one in self._all[:2]:
            one[:, self._defects.flow_column] = flow
        self._all.integrals[:, self._defects.flow_column] = self.field.integrands(time, y)

    def _part(self, part: StepPart) -> None:
        """Propagate tangents over a part of a step, with calls of ``on_look`` on the way."""
        near = coincidence(self._time, size := self.states.size)
        while self._looks and (theta := (self._looks[0] - self._time) / size) < part.b - near:
            if theta > part.a + near:
                before, part = part.cut(theta, False)
                self._piece(before)
            self._show(part.a)
        self._piece(part)
        while self._looks and (self._looks[0] - self._time) / size < part.b + near:
            self._show(part.b)

    def _show(self, theta: float) -> None:
        """Call ``on_look`` at a fraction of the step."""
        self._here = self._looks.pop(0), self.states.at(theta)
        self._tell(self.on_look)

    def _tell(self, callback: Callable[[float, Array, Array], None] | None) -> None:
        """Call a callback with the perturbations in the present state."""
        if callback is not None:
            tangents, (time, y) = self.tangents, self._here
            callback(time, y, self.field.lift(tangents.frame, time, y).up @ tangents.matrix)

    def _down(self, time: float, y: Array) -> Array:
        """Return the map from perturbations to coordinates."""
        return self.field.lift(self._all.frame, time, y).down

    def turn(self, frame: Frame) -> None:
        """Change the axes in the present state."""
        self._go_along()
        if not frame.clock:
            self._all = at_equal_times(self.field, self._all, *self._here)
        field, old = self.field, self._all
        turn = field.lift(frame, self._time, self._y).down @ field.lift(old.frame, self._time, self._y).up
        self._all = RunTangents(turn @ old.matrix, turn @ old.other, frame, old.integrals)

    def _piece(self, part: StepPart) -> None:
        """Propagate tangents over a part of the step, by the run's own stages where possible."""
        by = self.states, self.field.lift, self._all, _BY_STAGES * self._good
        found = None if self.stages is None else self.stages.in_halves(part, *by)
        self._all = self._matrices.over(part, self._all) if found is None else found

    @property
    def doubt(self) -> Array:
        """Error estimate of each tangent, (k,)."""
        matrix, other, *_ = self.tangents
        defects = self._defects.sizes(at_equal_times(self.field, self._all, *self._here))
        left_over = self._matrices.left_over * np.linalg.norm(matrix, axis=0)
        return np.asarray(np.linalg.norm(matrix - other, axis=0) + left_over + defects)
