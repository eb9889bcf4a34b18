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

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from antenna_pin.integrate import NODES, Propagator
from antenna_pin.nonlinear.along import AlongStages
from antenna_pin.nonlinear.breaks import BETWEEN, left_over
from antenna_pin.nonlinear.field import Field
from antenna_pin.nonlinear.frames import Frame, Lift
from antenna_pin.nonlinear.instants import Carried, at_equal_times, with_time, wrong_by
from antenna_pin.nonlinear.missed import Kink, Missed, StepAnew
from antenna_pin.nonlinear.numbers import Numbers
from antenna_pin.nonlinear.pieces import HALVINGS, Piece
from antenna_pin.nonlinear.saltation import Passed, Saltation
from antenna_pin.nonlinear.within import Within, kink_in
from antenna_pin.simulation.loop import Run

__all__ = ["Carrier"]

Array = NDArray[np.float64]

# What a piece of a step may be wrong by, over the displacements and over the run's tolerance; and how often a
# step is halved to find where it breaks: what is wrong then is in the doubt.
_GOOD, _SEARCHES = 1e2, 8
# How often a step is halved along which the run's own stages carry displacements, until whole matrices are
# looked at for what breaks there.
_TRIES = 4
# What stages may be wrong by, over that: their estimate is that of a lower order.
_BY_STAGES = 10.0
# In how many steps the round-off of rates is looked at once, where nothing changes.
_LOOKS = 8
# In parts of a step, what counts as the same instant.
_AT_ONCE = 1e-12
# How often round-off may be what a piece's derivatives are off by.
_NOISY = 30.0
# From which depth on a contact is deep, over what its onset is located to.
_DEEP = 1e6


class Carrier:
    """Carries displacements along a run: what the run shows itself to between its steps.

    Args:
        run: Before its first step; its steps are made one by one.
        first: Axes in its first state.
        ways: Displacements to carry, in coordinates along these, (size, k), or what makes them of these; all
            of them if left out.
        numbers: Parameters of the system that are coordinates too; none if left out.
        looks: When to be shown to ``seen`` within steps, ascending [s].

    Attributes:
        field: The rates, with the contacts that count.
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
        self._within = within = Within(run)
        self._at = within.at
        self._again = StepAnew(self.field, settings, run.stepper.scales, within.workspace)
        self._good = _GOOD * settings.rtol
        carrying, moving = self.field.carrying(), slice(self.field.parts[2].stop)
        #: What carries displacements by the run's own stages; None where nothing does.
        self.stages = None if carrying is None else AlongStages(carrying, moving)
        self._deep = _DEEP * np.array(run.search.tolerances)
        self._young: set[int] = set()
        self._changed = self._broken = False
        self._looked_at = self._made = 0
        self._unseen: tuple[float, Array] | None = self._take_over(run)
        self.matrices = 0  #: Over how many parts of steps whole matrices have carried them.
        self._left_over, self._looks = 0.0, list(looks)
        self._way: tuple[Frame, Array, Array] | None = None
        self._propagator = Propagator(0)
        self._opening: Array | None = None
        #: Told of each look: ``(time, y, displacements)``, the last (displacement, k).
        self.seen: Callable[[float, Array, Array], None] | None = None
        lift = self.field.lift(first, self._time, self._y)
        start = np.eye(lift.up.shape[1]) if ways is None else ways(lift) if callable(ways) else ways
        self._saltation = Saltation(self.field, run, start.shape[1])
        self._missed = Missed(start.shape[1], settings.rtol)
        start = self._missed.begin(start)
        self._all = Carried(start, start.copy(), first)

    @property
    def carried(self) -> Carried:
        """Displacements in the present state, at equal times."""
        return self._missed.own(at_equal_times(self.field, self._all, *self._here))

    @property
    def passed(self) -> tuple[Passed, ...]:
        """When contacts have begun and ended and events happened, and how their instants are displaced."""
        return tuple(self._saltation.passed)

    @property
    def rank(self) -> int:
        """How many directions of the displacements are left: where a joint comes to rest one is lost."""
        return self._saltation.rank

    def _take_over(self, run: Run) -> tuple[float, Array]:
        """Begin the next step where the run is; return where that is."""
        self._time, self._y = self._here = run.stepper.t, run.here.copy()
        self._within.take_over(run)
        return self._time, self._y

    def look(self, run: Run) -> None:
        """Carry the displacements over the step and the changes since the last look."""
        touched, touching = self._within.touching, run.workspace.memory["touching"]
        flipped = np.flatnonzero(touched != touching).tolist()
        happened = self._saltation.has_happened()
        broken = any(one.last == run.stepper.t for one in run.watch.value())
        if run.stepper.t > self._time:  # behind an event the state may be another than the step has led to
            end = None if happened else run.here.copy()
            self._within.begin(self._time, self._y, run.stepper.h, end)
            parting = [c for c in flipped if touching[c] == 0.0]
            self._step(run.stepper.t, run.stepper.h, bool(flipped) or happened, broken, parting)
            for c in parting:
                self._all = self._saltation.release(c, self._missed.flow, self._all, self._time, self._y)
            for one in self._all[:2]:
                one[:, self._missed.flow] = 0.0
        if happened:
            self._all = self._saltation.through_events(self._all, self._time, self._y)
        for c in flipped:
            if touching[c] != 0.0:
                self._all = with_time(self._all)
                now = self._all, self._time, self._y
                self._all = self._saltation.onset(c, run.workspace.memory[c], *now)
        self._changed = self._changed or bool(flipped) or happened
        if self._changed and self.stages is not None:
            self.stages.since = run.stepper.t
        self._take_over(run)
        self._young = {c for c in {*self._young, *flipped} if touching[c] != 0.0 and self._is_shallow(c)}
        if not self._young:
            self._all = at_equal_times(self.field, self._all, *self._here)

    def end(self, run: Run) -> None:
        """Carry them to the end."""
        self.look(run)

    def _is_shallow(self, c: int) -> bool:
        """Whether a contact has just begun."""
        return self.field.workspace.along_normal(self._y, c)[1] > -float(self._deep[c])

    def _step(
        self, end: float, size: float, ends_in_change: bool, ends_in_break: bool, parting: Sequence[int]
    ) -> None:
        """Carry the displacements over a step that the run has made.

        Args:
            end: When it ended [s].
            size: Its size [s].
            ends_in_change: Whether contacts or drives change there.
            ends_in_break: Whether an event or a kink that is told of is there.
            parting: Contacts that end there.
        """
        self._again.begin(self._time, self._y)
        self._made += 1
        if self._changed or self._young or self._made > self._looked_at + _LOOKS:
            self._unseen = self._time, self._y
        begin, begins, broken = 0.0, self._changed, self._changed or self._broken
        last = ends_in_change or ends_in_break
        if begins and ends_in_change:
            middle = 0.5 * (begin + 1.0)
            self._part(Piece(begin, middle, True, False, (broken, False)))
            begin, begins, broken = middle, False, False
        whole = self._at(1.0)
        if parting:
            self._carry_flow(begin)
            up = self.field.lift(self._all.frame, end, whole).up
            self._opening = self.field.depths.opening(whole, parting[0], up)[0]
        self._part(Piece(begin, 1.0, begins, ends_in_change, (broken, last)))
        self._opening = None
        off = self._again.off(end, whole)
        if off.any():
            self._all = self._missed.off(self._all, self._down(end, whole) @ off)
        self._all = self._missed.merged(self._all)
        self._time, self._y, self._changed, self._broken = end, whole, False, ends_in_break
        self._here = end, whole
        if self.field.workspace.constraints is not None:
            self.turn(self.field.frame(self._y, self._all.frame.clock))

    def _carry_flow(self, theta: float) -> None:
        """Begin to carry the flow beside displacements, from a fraction of the step on."""
        self._all = with_time(self._all)
        time, y = self._time + theta * self._within.size, self._at(theta)
        flow = self._down(time, y) @ self.field.flow(time, y)
        for one in self._all[:2]:
            one[:, self._missed.flow] = flow

    def _part(self, piece: Piece) -> None:
        """Carry the displacements over a part of a step, and show them where they are to be looked at."""
        size = self._within.size
        while self._looks and (theta := (self._looks[0] - self._time) / size) < piece.b - _AT_ONCE:
            if theta > piece.a + _AT_ONCE:
                before, piece = piece.cut(theta, False)
                self._piece(before)
            self._show(piece.a)
        self._piece(piece)
        while self._looks and (self._looks[0] - self._time) / size < piece.b + _AT_ONCE:
            self._show(piece.b)

    def _show(self, theta: float) -> None:
        """Show the displacements at a fraction of the step."""
        time, y = self._here = self._looks.pop(0), self._at(theta)
        if self.seen is not None:
            matrix, _, frame = self.carried
            self.seen(time, y, self.field.lift(frame, time, y).up @ matrix)

    def _down(self, time: float, y: Array) -> Array:
        """Return what makes coordinates of displacements."""
        return self.field.lift(self._all.frame, time, y).down

    def turn(self, frame: Frame) -> None:
        """Take other axes in the present state.

        Args:
            frame: The axes; of the contacts that count.
        """
        if not frame.clock:
            self._all = at_equal_times(self.field, self._all, *self._here)
        field, old = self.field, self._all
        turn = field.lift(frame, self._time, self._y).down @ field.lift(old.frame, self._time, self._y).up
        self._all = Carried(turn @ old.matrix, turn @ old.other, frame)

    def _along(self) -> tuple[Array, Array]:
        """Return the displacement along which breaks are looked for, some of every state, and its parts."""
        frame = self._all.frame
        if self._way is None or self._way[0] is not frame:
            up = self.field.lift(frame, self._time, self._y).up
            some = np.asarray(np.random.default_rng(0).standard_normal(up.shape[1]))
            *_, numbers, _, clock = self.field.parts
            some[up[numbers].any(axis=0) | up[clock].any(axis=0)] = 0.0  # what breaks does so in states
            unit = np.asarray(some / np.linalg.norm(some))
            self._way = frame, up @ unit, unit
        return self._way[1:]

    def _piece(self, piece: Piece) -> None:
        """Carry the displacements over a part of the step, by the run's own stages where these can."""
        found = self._by_stages(piece, self._all)
        if found is None:
            self._by_matrices(piece)
        else:
            self._all = found

    def _by_stages(self, piece: Piece, carried: Carried) -> Carried | None:
        """Return displacements behind a part of the step by the run's own stages; None where these cannot."""
        if self.stages is None or all(piece.known):
            return None
        start, end = (self._time, self._within.size, self._at(piece.a)), self._at(piece.b)
        if self.field.lets_go(self._time + piece.b * self._within.size, end):
            return None
        lift = self.field.lift(carried.frame, self._time + piece.a * self._within.size, start[2])
        found = self.stages.over(piece, start, lift, carried, _BY_STAGES * self._good)
        if found is None and piece.halvings > HALVINGS - _TRIES:
            found = carried
            for half in piece.cut(0.5 * (piece.a + piece.b), False):
                found = None if found is None else self._by_stages(half, found)
        return found

    def _by_matrices(self, piece: Piece) -> None:
        """Carry the displacements over a part of the step, cut where it breaks and as short as it must be."""
        self.matrices += 1
        if self._unseen is not None:
            self.field.look_at(*self._unseen, self._along()[0])
            self._unseen, self._looked_at = None, self._made
        field, start, whole = self.field, self._time, self._within.size
        frame, length, way = self._all.frame, (piece.b - piece.a) * whole, self._along()[0]
        thetas, slopes = piece.at(NODES)
        found = [field.matrix(frame, start + s * whole, self._at(s), way) for s in thetas.tolist()]
        sixth, fourth = (np.array([f[k] * s for f, s in zip(found, slopes, strict=True)]) for k in (0, 1))
        if self._propagator.size != sixth.shape[1]:
            self._propagator = Propagator(sixth.shape[1])
        step = self._propagator.step(length, sixth)
        # What breaks at a place between the nodes, or behind the last, neither method sees.
        seen = [(f.along * s, f.noise * s) for f, s in zip(found, slopes.tolist(), strict=True)]
        for s, slope in zip(*(one.tolist() for one in piece.at(BETWEEN)), strict=True):
            value, noise = field.along_way(start + s * whole, self._at(s), way)
            seen.append((value * slope, noise * slope))
        rest, (low, high) = left_over(np.array([value for value, _ in seen]), piece.known)
        noise = _NOISY * length * max(one for _, one in seen)
        off = length * rest if length * rest <= self._good else max(length * rest - noise, 0.0)
        found_break = None
        if off > self._good:
            by = field, frame, way, self._along()[1]
            found_break = kink_in(piece, (low, high), seen, self._within, by)
        searching = off > self._good and piece.halvings > HALVINGS - _SEARCHES
        rough = not wrong_by(piece, step, self._all, self._missed.flow, self._opening) <= self._good
        if piece.halvings > 0 and (found_break is not None or searching or rough):
            cut = 0.5 * (piece.a + piece.b) if found_break is None else found_break[0]
            before, behind = piece.cut(cut, found_break is not None)
            self._by_matrices(before)
            if found_break is not None:
                self._pass(*found_break)
            self._by_matrices(behind)
            return
        other = step.other + self._propagator.change(length, fourth - sixth)
        old = self._all
        self._left_over += off
        self._all = Carried(step.matrix @ old.matrix, other @ old.other, old.frame)

    def _pass(self, theta: float, kink: Kink) -> None:
        """Count what displacements miss of a kink at a fraction of the step."""
        time, y = self._time + theta * self._within.size, self._at(theta)
        self._again.to(time)
        error = self._missed.error(self._all) + self._down(time, y) @ self._again.off(time, y)
        self._all = self._missed.passed(kink, error, self._all)

    @property
    def doubt(self) -> Array:
        """By how much the displacements are in doubt, of each, (k,)."""
        matrix, other, _ = self.carried
        missed = self._missed.sizes(at_equal_times(self.field, self._all, *self._here))
        left_over = self._left_over * np.linalg.norm(matrix, axis=0)
        return np.asarray(np.linalg.norm(matrix - other, axis=0) + left_over + missed)
