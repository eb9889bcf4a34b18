"""The variational equation: how a displacement of a state is carried along a run, through events too.

Between events displacements w go by ``w' = A(t) w``, with the derivative A of the rates. At an event, where
the function g passes zero, the rates jump from f- to f+ and the state may go through a map R. A neighbour
comes there later by ``dt = -(dg w) / g'``, and behind it is displaced by the *saltation*

    w+ = DR w + (DR f- + R_t - f+) dt

(Aizerman and Gantmakher 1958, J. Mech. Appl. Math. 11; Leine and Nijmeijer 2004, Dynamics and Bifurcations of
Non-Smooth Mechanical Systems, section 7.4). A contact's onset does more: the approach speed (and the
effective mass) that it remembers are those of the neighbour's own instant, ``log s+ = d(log s) w + (log s)'
dt``. A release lets them go.

Where a force has a kink, A jumps: displacements go on as they are, but the step must be cut there. Where one
is told of, the run's own steps end; others are found (:mod:`antenna_pin.nonlinear.breaks`), and what the run
itself is off by for them is in the doubt (:mod:`antenna_pin.nonlinear.missed`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from antenna_pin.dynamics import Workspace
from antenna_pin.integrate import NODES, Propagator, method_named
from antenna_pin.nonlinear.along import AlongStages
from antenna_pin.nonlinear.breaks import BETWEEN, SAMPLES, left_over, located
from antenna_pin.nonlinear.field import Field
from antenna_pin.nonlinear.frames import Frame, Lift
from antenna_pin.nonlinear.missed import Kink, Missed, StepAnew
from antenna_pin.nonlinear.numbers import Numbers
from antenna_pin.nonlinear.pieces import HALVINGS, Piece
from antenna_pin.nonlinear.saltation import Carried, Onset, Passed, Saltation
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.stretches import stepper_of

__all__ = ["Carrier"]

Array = NDArray[np.float64]

# What a piece of a step may be wrong by, over the displacements and over the run's tolerance; and how often a
# step is halved to find where it breaks: what is wrong then is in the doubt.
_GOOD, _SEARCHES = 1e2, 8
# How often a step is halved along which the run's own stages carry displacements, until whole matrices are
# looked at for what breaks there.
_TRIES = 4
GOODS = 10.0
# In how many steps the round-off of rates is looked at once, where nothing changes.
_LOOKS = 8
# In parts of a step, what counts as the same instant.
_AT_ONCE = 1e-12
# How often round-off may be what a piece's derivatives are off by.
_NOISY = 30.0


class Carrier:
    """Carries displacements along a run: what the run shows itself to between its steps.

    A contact's force counts from a depth of ten times what its onset is located to: up to there it is a step.
    So laws are taken whose derivative is without bounds where they begin, as Tsuji's is.

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
        system, settings = run.system, run.settings
        self.field = Field(system, settings, numbers)
        workspace = self.field.workspace
        workspace.memory[:], workspace.program[:] = run.workspace.memory, run.workspace.program
        self._own = Workspace(system)
        self._dense = stepper_of(self._own, method_named(settings.method), run.stepper.scales, settings)
        self._again = StepAnew(self.field, settings, run.stepper.scales, self._own)
        self._good = _GOOD * settings.rtol
        carrying, bristles = self.field.carrying(), self.field.parts[2]
        #: What carries displacements by the run's own stages; None where nothing does.
        self.stages = None if carrying is None else AlongStages(carrying, slice(bristles.stop))
        self._shallow = 10.0 * np.array(run.search.tolerances)
        self._coming: dict[int, Onset] = {}
        self._changed = False
        self._broken = False
        self._looked_at = self._made = 0
        # Where round-off is to be looked at before it is asked for.
        self._unseen: tuple[float, Array] | None = self._take_over(run)
        self._left_over = 0.0
        self._way: tuple[Frame, Array, Array] | None = None
        self._propagator = Propagator(0)
        self._looks = list(looks)
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
        """Displacements in the present state."""
        return self._missed.own(self._all)

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
        self._time, self._y = run.stepper.t, run.here.copy()
        self._own.memory[:], self._own.program[:] = run.workspace.memory, run.workspace.program
        return self._time, self._y

    def look(self, run: Run) -> None:
        """Carry the displacements over the step and the changes since the last look."""
        touched, touching = self._own.memory["touching"], run.workspace.memory["touching"]
        flipped = np.flatnonzero(touched != touching).tolist()
        happened = self._saltation.has_happened()
        broken = any(one.last == run.stepper.t for one in run.watch.value())
        if run.stepper.t > self._time:
            self._end = None if happened else run.here.copy()
            self._step(run.stepper.t, run.stepper.h, bool(flipped) or happened, broken)
        if happened:
            self._all = self._saltation.through_events(self._all, self._time, self._y)
        for c in flipped:
            if touching[c] != 0.0:
                now = self._all, self._time, self._y
                self._coming[c] = self._saltation.onset(c, run.workspace.memory[c], *now)
            elif self._coming.pop(c, None) is None:
                self._all = self._saltation.through_contact(c, None, self._all, self._time, self._y)
        self._changed = self._changed or bool(flipped) or happened
        if self._changed and self.stages is not None:
            self.stages.since = run.stepper.t
        self._take_over(run)

    def end(self, run: Run) -> None:
        """Carry them to the end."""
        self.look(run)
        for c in list(self._coming):
            self._let_count(c, self._time, self._y)

    def _let_count(self, c: int, time: float, y: Array) -> None:
        """Let a contact that has begun count."""
        self._all = self._saltation.through_contact(c, self._coming.pop(c), self._all, time, y)

    def _step(self, end: float, size: float, ends_in_change: bool, ends_in_break: bool) -> None:
        """Carry the displacements over a step that the run has made.

        Args:
            end: When it ended [s].
            size: Its size [s].
            ends_in_change: Whether contacts or drives change there.
            ends_in_break: Whether an event or a kink that is told of is there.
        """
        self._size, self._has_dense = size, False
        self._again.begin(self._time, self._y)
        self._made += 1
        if self._changed or self._made > self._looked_at + _LOOKS:
            self._unseen = self._time, self._y
        begin, begins, broken = 0.0, self._changed, self._changed or self._broken
        for theta, c in sorted((self._counts_from(c), c) for c in self._coming):
            if theta > 1.0:
                break
            if theta > begin:
                self._part(Piece(begin, theta, known=(broken, True)))
            self._let_count(c, self._time + theta * size, self._at(theta))
            self._unseen = self._time + theta * size, self._at(theta)
            begin, begins, broken = theta, True, True
        last = ends_in_change or ends_in_break
        if begins and ends_in_change:
            middle = 0.5 * (begin + 1.0)
            self._part(Piece(begin, middle, True, False, (broken, False)))
            begin, begins, broken = middle, False, False
        self._part(Piece(begin, 1.0, begins, ends_in_change, (broken, last)))
        whole = self._at(1.0)
        off = self._again.off(end, whole)
        if off.any():
            self._all = self._missed.off(self._all, self._down(end, whole) @ off)
        if not self._coming:
            self._all = self._missed.merged(self._all)
        self._time, self._y, self._changed, self._broken = end, whole, False, ends_in_break
        if self.field.workspace.constraints is not None:
            self.turn(self.field.frame(self._y))

    def _part(self, piece: Piece) -> None:
        """Carry the displacements over a part of a step, and show them where they are to be looked at."""
        while self._looks and (theta := (self._looks[0] - self._time) / self._size) < piece.b - _AT_ONCE:
            if theta > piece.a + _AT_ONCE:
                before, piece = piece.cut(theta, False)
                self._piece(before)
            self._show(piece.a)
        self._piece(piece)
        while self._looks and (self._looks[0] - self._time) / self._size < piece.b + _AT_ONCE:
            self._show(piece.b)

    def _show(self, theta: float) -> None:
        """Show the displacements at a fraction of the step."""
        time, y = self._looks.pop(0), self._at(theta)
        if self.seen is not None:
            matrix, _, frame = self.carried
            self.seen(time, y, self.field.lift(frame, time, y).up @ matrix)

    def _down(self, time: float, y: Array) -> Array:
        """Return what makes coordinates of displacements."""
        return self.field.lift(self._all.frame, time, y).down

    def _at(self, theta: float) -> Array:
        """Return the state at a fraction of the step."""
        if theta == 0.0:
            return self._y
        if theta == 1.0 and self._end is not None:
            return self._end
        y = np.zeros_like(self._y)
        if not self._has_dense:
            self._dense.restart(self._time, self._y)
            self._dense.attempt(self._size)
            self._dense.prepare_dense()
            self._has_dense = True
        self._dense.interpolate(theta, y)
        return y

    def _counts_from(self, c: int) -> float:
        """Return the fraction of the step from which a contact that has begun counts, or 2."""

        def lacking(theta: float) -> float:
            return self.field.workspace.along_normal(self._at(theta), c)[1] + float(self._shallow[c])

        if lacking(1.0) > 0.0:
            return 2.0
        return 0.0 if lacking(0.0) <= 0.0 else float(brentq(lacking, 0.0, 1.0, xtol=1e-15))

    def turn(self, frame: Frame) -> None:
        """Take other axes in the present state.

        Args:
            frame: The axes; of the contacts that count.
        """
        field, old = self.field, self._all
        turn = field.lift(frame, self._time, self._y).down @ field.lift(old.frame, self._time, self._y).up
        self._all = Carried(turn @ old.matrix, turn @ old.other, frame)

    def _along(self) -> tuple[Array, Array]:
        """Return the displacement along which breaks are looked for, some of every coordinate, and these."""
        frame = self._all.frame
        if self._way is None or self._way[0] is not frame:
            up = self.field.lift(frame, self._time, self._y).up
            some = np.random.default_rng(0).standard_normal(up.shape[1])
            unit = np.asarray(some / np.linalg.norm(some))
            self._way = frame, up @ unit, unit
        return self._way[1:]

    def _piece(self, piece: Piece) -> None:
        """Carry the displacements over a part of the step, by the run's own stages where these can."""
        if self.stages is None:
            self._by_matrices(piece)
            return
        start, lift = (self._time, self._size, self._at(piece.a)), self._lift()
        found = self.stages.over(piece, start, lift, self._all, GOODS * self._good)
        if found is not None:
            self._all = found
        elif piece.halvings > HALVINGS - _TRIES:
            for half in piece.cut(0.5 * (piece.a + piece.b), False):
                self._piece(half)
        else:
            self.stages.left += 1
            self._by_matrices(piece)

    def _lift(self) -> Lift:
        """Return the coordinates of the moment as displacements."""
        return self.field.lift(self._all.frame, self._time, self._y)

    def _by_matrices(self, piece: Piece) -> None:
        """Carry the displacements over a part of the step, cut where it breaks and as short as it must be."""
        if self._unseen is not None:
            self.field.look_at(*self._unseen, self._along()[0])
            self._unseen, self._looked_at = None, self._made
        field, start, whole = self.field, self._time, self._size
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
        found_break = self._break(piece, way, low, high, seen) if off > self._good else None
        searching = off > self._good and piece.halvings > HALVINGS - _SEARCHES
        if piece.halvings > 0 and (found_break is not None or searching or not step.off <= self._good):
            cut = 0.5 * (piece.a + piece.b) if found_break is None else found_break[0]
            before, behind = piece.cut(cut, found_break is not None)
            self._piece(before)
            if found_break is not None:
                self._pass(*found_break)
            self._piece(behind)
            return
        other = step.other + self._propagator.change(length, fourth - sixth)
        old = self._all
        self._left_over += off
        self._all = Carried(step.matrix @ old.matrix, other @ old.other, old.frame)

    def _break(
        self, piece: Piece, way: Array, low: int, high: int, seen: list[tuple[Array, float]]
    ) -> tuple[float, Kink] | None:
        """Return where rates break between two samples of a piece, as a fraction of the step, or None."""
        field = self.field

        def ramps(place: float) -> Array:
            return self._looked(piece, place, lambda time, y: field.across_kinks(time, y, way)[0])

        def jumps(place: float) -> Array:
            return self._looked(piece, place, lambda time, y: field.along_way(time, y, way)[0])

        places = float(SAMPLES[low]), float(SAMPLES[high])
        found = located(ramps, jumps, *places, seen[low][0], seen[high][0])
        if found is None:
            return None
        (cut, before, behind), (slope, *_) = piece.at(np.array([found.place, *found.beside]))
        one, other = (
            field.matrix(self._all.frame, self._time + s * self._size, self._at(s), way).sixth
            for s in (float(before), float(behind))
        )
        step = field.across_kinks(self._time + cut * self._size, self._at(float(cut)), way)[1]
        later = found.later * slope * (piece.b - piece.a) * self._size / step
        return float(cut), Kink.of(other - one, self._along()[1], later)

    def _pass(self, theta: float, kink: Kink) -> None:
        """Count what displacements miss of a kink at a fraction of the step."""
        time, y = self._time + theta * self._size, self._at(theta)
        self._again.to(time)
        error = self._missed.error(self._all) + self._down(time, y) @ self._again.off(time, y)
        self._all = self._missed.passed(kink, error, self._all)

    def _looked(self, piece: Piece, place: float, look: Callable[[float, Array], Array]) -> Array:
        """Return what a look at a place of a piece shows, per what is integrated over."""
        (theta,), (slope,) = piece.at(np.array([place]))
        return float(slope) * look(self._time + float(theta) * self._size, self._at(float(theta)))

    @property
    def doubt(self) -> Array:
        """By how much the displacements are in doubt, of each, (k,)."""
        matrix, other, _ = self.carried
        left_over = self._left_over * np.linalg.norm(matrix, axis=0)
        return np.asarray(np.linalg.norm(matrix - other, axis=0) + left_over + self._missed.sizes(self._all))
