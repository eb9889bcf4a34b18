"""The variational equation: how a displacement of a state is carried along a run, through events too.

Between events displacements w go by ``w' = A(t) w``, with the derivative A of the rates. At an event, where
the function g passes zero, the rates jump from f- to f+ and the state may go through a map R. A neighbour
comes there later by ``dt = -(dg w) / g'``, and behind it is displaced by the *saltation*

    w+ = DR w + (DR f- + R_t - f+) dt

(Aizerman and Gantmakher 1958, J. Mech. Appl. Math. 11; Leine and Nijmeijer 2004, Dynamics and Bifurcations of
Non-Smooth Mechanical Systems, section 7.4).

Where contacts begin and end the derivative of a force over the depth may have no bounds. So from an onset on
displacements are those at equal times since the neighbours' own, ``w + f dt``, with time as one more
coordinate: they go by the same equation, their depth begins at zero, and what there is without bounds is
multiplied by that. What is remembered of the onset is of the same instant. Deep in the contact, or behind it,
they are brought back to equal times. To a release the flow is carried beside them, which goes by their
equation too: the two, put together so that the depth vanishes there, are free of what carrying is off by on
the way (:meth:`antenna_pin.nonlinear.saltation.Saltation.release`).

Where a force has a kink, A jumps: displacements go on as they are, but the step must be cut there. Where one
is told of, the run's own steps end; others are found (:mod:`antenna_pin.nonlinear.breaks`), and what the run
itself is off by for them is in the doubt (:mod:`antenna_pin.nonlinear.missed`).
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from antenna_pin.nonlinear.along import AlongStages, Step
from antenna_pin.nonlinear.by_matrices import ByMatrices
from antenna_pin.nonlinear.field import Field
from antenna_pin.nonlinear.frames import Frame, Lift
from antenna_pin.nonlinear.instants import Carried, at_equal_times, with_time
from antenna_pin.nonlinear.missed import Missed, StepAnew
from antenna_pin.nonlinear.numbers import Numbers
from antenna_pin.nonlinear.pieces import Piece, at_once
from antenna_pin.nonlinear.saltation import Passed, Saltation
from antenna_pin.nonlinear.within import Within
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.steps import LoggedStep

__all__ = ["Carrier"]


# What gross works and works differ by in a step that no work turns back in, over their sizes; in how many
# parts of a step the sign of a power is looked at.
_ROUND_OFF, _PARTS = 16.0 * float(np.finfo(float).eps), 16


# --- steps cut where works turn back: there the rate of a gross work, the size of a power, has a kink ---
#
# What it integrates to has none, so that its derivative is the integral of ``sgn(P) dP``, with no jump: it is
# enough that no part of a step has both signs of the power in it.


def cut_at_turns(step: Step, within: Within, field: Field) -> list[Step]:
    """Return the parts of a step in which works go one way each, where numbers displace what is booked.

    Args:
        step: The step.
        within: States within it.
        field: The rates.
    """
    works = field.works
    if field.numbers is None or not len(works):
        return [step]
    places = works + field.system.model.nq + field.system.model.nv
    gone = np.abs(step.end[places] - step.y[places])
    turn = gone[:, 1] - gone[:, 0] > _ROUND_OFF * np.abs(step.end[places]).sum(axis=1)
    if not turn.any():
        return [step]
    within.begin(step.time, step.y, step.size, step.end)
    thetas = np.unique([0.0, *_turns(works[turn, 0], step, within, field), 1.0]).tolist()
    instants = [*(step.time + theta * step.size for theta in thetas[:-1]), step.until]
    states = [step.y, *(within.at(theta) for theta in thetas[1:-1]), step.end]
    last, parts = len(thetas) - 2, []
    for k in range(last + 1):
        ends = k == 0, k == last
        changes = ends[0] and step.changes[0], ends[1] and step.changes[1]
        known = not ends[0] or step.known[0], not ends[1] or step.known[1]
        size = (thetas[k + 1] - thetas[k]) * step.size
        parts.append(Step(instants[k], size, states[k], instants[k + 1], states[k + 1], changes, known))
    return parts


def _turns(works: NDArray[np.int_], step: Step, within: Within, field: Field) -> list[float]:
    """Return at which fractions of a step some works turn back."""

    def power(theta: float, x: int) -> float:
        return float(field.booked(step.time + theta * step.size, within.at(theta))[x])

    found = []
    for x in works.tolist():
        values = np.array([power(k / _PARTS, x) for k in range(_PARTS + 1)])
        for k in np.flatnonzero(values[1:] * values[:-1] < 0.0).tolist():
            low, high = k / _PARTS, (k + 1) / _PARTS
            found.append(float(brentq(power, low, high, args=(x,), xtol=1e-15)))
    return found


Array = NDArray[np.float64]

# What a piece of a step may be wrong by, over the displacements and over the run's tolerance; what stages may
# be, over that: their estimate is that of a lower order.
_GOOD, _BY_STAGES = 1e2, 10.0
# From which depth on a contact is deep, over what its onset is located to: derivatives over a clearance are
# off by 3e-5 (Tsuji's law) if it is at once, by 7e-12 from 1 on, by 1e-13 from 1e4 on; a hundred times that.
_DEEP = 1e6
# How many steps wait at most to be carried along together.
_TOGETHER = 64


class Carrier:
    """Carries displacements along a run: what the run shows itself to where something changes.

    Args:
        run: Before its first step; its steps are logged.
        first: Axes in its first state.
        ways: Displacements to carry, in coordinates along these, (size, k), or what makes them of these; all
            of them if left out.
        numbers: Parameters of the system that are coordinates too; none if left out.
        looks: When to be shown to ``seen`` within steps, ascending [s].

    Attributes:
        field: The rates, with the contacts that count.
        within: States within the steps, before what changes behind them.
    """

    def __init__(
        self,
        run: Run,
        first: Frame,
        ways: Array | Callable[[Lift], Array] | None = None,
        numbers: Numbers | None = None,
        looks: Sequence[float] = (),
    ) -> None:
        """Begin in the run's first state."""
        settings = run.settings
        self.field = Field(run.system, settings, numbers)
        workspace = self.field.workspace
        workspace.memory[:], workspace.program[:] = run.workspace.memory, run.workspace.program
        self.within = within = Within(run)
        self._again = StepAnew(self.field, settings, run.stepper.scales, within.workspace)
        self._good = _GOOD * settings.rtol
        carrying, moving = self.field.carrying(), slice(self.field.parts[2].stop)
        #: What carries displacements by the run's own stages; None where nothing does.
        self.stages = None if carrying is None else AlongStages(carrying, moving)
        self._deep = _DEEP * np.array(run.search.tolerances)
        self._young: set[int] = set()
        self._take_over(run)
        self._begins = False, False
        self._waiting: list[Step] = []
        self._looks = list(looks)
        #: Told of looks and before changes: ``(time, y, displacements)``, the last (displacement, k).
        self.seen: Callable[[float, Array, Array], None] | None = None
        self.before: Callable[[float, Array, Array], None] | None = None
        lift = self.field.lift(first, self._time, self._y)
        start = np.eye(lift.up.shape[1]) if ways is None else ways(lift) if callable(ways) else ways
        self._saltation = Saltation(self.field, run, start.shape[1])
        self._missed = Missed(start.shape[1], settings.rtol)
        self._matrices = ByMatrices(self.field, within, self._again, self._missed, self._good)
        self._matrices.begin(self._time, self._y, True)
        start = self._missed.begin(start)
        self._all = Carried(start, start.copy(), first, np.zeros((run.system.manifold.nx, start.shape[1])))

    @property
    def carried(self) -> Carried:
        """Displacements in the present state, at equal times."""
        self._go_along()
        return self._missed.own(at_equal_times(self.field, self._all, *self._here))

    @property
    def passed(self) -> tuple[Passed, ...]:
        """When contacts have begun and ended and events happened, and how their instants are displaced."""
        return tuple(self._saltation.passed)

    @property
    def matrices(self) -> int:
        """Over how many parts of steps whole matrices have carried them."""
        return self._matrices.made

    @property
    def rank(self) -> int:
        """How many directions of the displacements are left: where a joint comes to rest one is lost."""
        return self._saltation.rank

    def _take_over(self, run: Run) -> None:
        """Begin the next step where the run is."""
        self._time, self._y = self._here = run.stepper.t, run.here.copy()
        self.within.take_over(run)

    def observe(self, run: Run) -> None:
        """Carry the displacements over the steps since the last look, and over what changes behind them."""
        touching, steps = run.workspace.memory["touching"], run.steps.log.steps
        flipped = np.flatnonzero(self.within.touching != touching).tolist()
        happened, breaks = self._saltation.happened(), {one.last for one in run.watch.value()}
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
        """Carry the displacements over a step, now or with those that follow.

        Args:
            one: The step.
            ends: Whether anything changes where it ends, and whether rates break there.
            parting: Contacts that end there.
        """
        whole = Step(*one, (self._begins[0], ends[0]), (any(self._begins), any(ends)))
        for step in cut_at_turns(whole, self.within, self.field):
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
        """Begin the next step: whether anything has changed there, and whether rates break."""
        self._begins = begins
        if begins[0] and self.stages is not None:
            self.stages.since = self._time

    def _change(self, memory: NDArray[Any], flipped: list[int], moved: bool) -> None:
        """Carry the displacements over what changes in the present state.

        Args:
            memory: What contacts remember behind it.
            flipped: Contacts that begin or end.
            moved: Whether a step has led there, along which the flow is carried to contacts that end.
        """
        self._go_along()
        here, ending = (self._time, self._y), [c for c in flipped if memory["touching"][c] == 0.0]
        if not moved:
            self._tell(self.before)
            self._begin((True, False))
        for c in ending:
            if not moved:
                self._set_flow(*here)
            self._all = self._saltation.release(c, self._missed.flow, self._all, *here)
        if ending:
            for one in (self._all.matrix, self._all.other, self._all.books):
                one[:, self._missed.flow] = 0.0
        self._all = self._saltation.through_events(self._all, *here)
        for c in [c for c in flipped if c not in ending]:
            self._all = self._saltation.onset(c, memory[c], with_time(self._all), *here)

    def _settle(self) -> None:
        """Bring displacements back to equal times, where no contact has just begun any more."""
        places = self.field.workspace.along_normal
        self._young = {c for c in self._young if places(self._y, c)[1] > -float(self._deep[c])}
        if not self._young and self._all.frame.clock:
            self._go_along()
            self._all = at_equal_times(self.field, self._all, *self._here)

    def look_at(self, time: float) -> None:
        """Be shown to ``seen`` at one more instant that is to come [s]."""
        place = bisect_left(self._looks, time)
        if time not in self._looks[place : place + 1]:
            self._looks.insert(place, time)

    def book(self, place: int, more: Array) -> None:
        """Take something to what is integrated along the run, by how much more of each displacement, (k,)."""
        self._go_along()
        self._all.books[place, : len(more)] += more

    def end(self, run: Run) -> None:
        """Carry them to the end."""
        self.observe(run)
        self._go_along()

    def _goes_along(self, step: Step) -> bool:
        """Whether displacements may go along a step together with others.

        Nothing is to be seen within it, or changes at its end, and axes stay as they are.
        """
        if self.stages is None or self.field.workspace.constraints is not None:
            return False
        seen = self._looks and self._looks[0] < step.time + (1.0 + at_once(step.time, step.size)) * step.size
        return not (step.changes[1] or step.known[1] or seen)

    def _go_along(self, until: float = np.inf) -> None:
        """Carry the displacements along the steps that wait, to when a contact ends behind them [s]."""
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

    def _step(self, step: Step, parting: Sequence[int]) -> None:
        """Carry the displacements over a step.

        Args:
            step: The step.
            parting: Contacts that end there.
        """
        self._time, self._y = step.time, step.y
        self.within.begin(step.time, step.y, step.size, step.end)
        self._again.begin(step.time, step.y)
        (begins, ends), known, end = step.changes, step.known, step.until
        self._matrices.begin(step.time, step.y, begins or bool(self._young))
        rest = step.piece
        if all(known):
            self._part(Piece(0.0, 0.5, begins, False, (True, False)))
            rest = Piece(0.5, 1.0, False, ends, (False, True))
        whole = self.within.at(1.0)
        if parting:
            self._set_flow(self._time + rest.a * self.within.size, self.within.at(rest.a))
            up = self.field.lift(self._all.frame, end, whole).up
            self._matrices.opening = self.field.depths.opening(whole, parting[0], up)[0]
        self._part(rest)
        self._matrices.opening = None
        off = self._again.off(end, whole)
        if off.any():
            self._all = self._missed.off(self._all, self._down(end, whole) @ off)
        self._all = self._missed.merged(self._all)
        self._time, self._y = self._here = end, whole
        if self.field.is_off(self._all.frame, end, whole):
            self.turn(self.field.frame(self._y, self._all.frame.clock))
        if ends:
            self._tell(self.before)

    def _set_flow(self, time: float, y: Array) -> None:
        """Write the flow of a state beside displacements."""
        self._all = with_time(self._all)
        flow = self._down(time, y) @ self.field.flow(time, y)
        for one in self._all[:2]:
            one[:, self._missed.flow] = flow
        self._all.books[:, self._missed.flow] = self.field.booked(time, y)

    def _part(self, piece: Piece) -> None:
        """Carry the displacements over a part of a step, and show them where they are to be looked at."""
        near = at_once(self._time, size := self.within.size)
        while self._looks and (theta := (self._looks[0] - self._time) / size) < piece.b - near:
            if theta > piece.a + near:
                before, piece = piece.cut(theta, False)
                self._piece(before)
            self._show(piece.a)
        self._piece(piece)
        while self._looks and (self._looks[0] - self._time) / size < piece.b + near:
            self._show(piece.b)

    def _show(self, theta: float) -> None:
        """Show the displacements at a fraction of the step."""
        self._here = self._looks.pop(0), self.within.at(theta)
        self._tell(self.seen)

    def _tell(self, told: Callable[[float, Array, Array], None] | None) -> None:
        """Tell of displacements in the present state."""
        if told is not None:
            carried, (time, y) = self.carried, self._here
            told(time, y, self.field.lift(carried.frame, time, y).up @ carried.matrix)

    def _down(self, time: float, y: Array) -> Array:
        """Return what makes coordinates of displacements."""
        return self.field.lift(self._all.frame, time, y).down

    def turn(self, frame: Frame) -> None:
        """Take other axes in the present state.

        Args:
            frame: The axes; of the contacts that count.
        """
        self._go_along()
        if not frame.clock:
            self._all = at_equal_times(self.field, self._all, *self._here)
        field, old = self.field, self._all
        turn = field.lift(frame, self._time, self._y).down @ field.lift(old.frame, self._time, self._y).up
        self._all = Carried(turn @ old.matrix, turn @ old.other, frame, old.books)

    def _piece(self, piece: Piece) -> None:
        """Carry the displacements over a part of the step, by the run's own stages where these can."""
        by = self.within, self.field.lift, self._all, _BY_STAGES * self._good
        found = None if self.stages is None else self.stages.in_halves(piece, *by)
        self._all = self._matrices.over(piece, self._all) if found is None else found

    @property
    def doubt(self) -> Array:
        """By how much the displacements are in doubt, of each, (k,)."""
        matrix, other, *_ = self.carried
        missed = self._missed.sizes(at_equal_times(self.field, self._all, *self._here))
        left_over = self._matrices.left_over * np.linalg.norm(matrix, axis=0)
        return np.asarray(np.linalg.norm(matrix - other, axis=0) + left_over + missed)
