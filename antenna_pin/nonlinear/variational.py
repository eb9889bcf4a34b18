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

__all__ = ["Carrier"]

Array = NDArray[np.float64]

# What a piece of a step may be wrong by, over the displacements and over the run's tolerance.
_GOOD = 1e2
# How often at most the run's own stages are tried along halves of a step, those next to a kink as short as it
# matters, until whole matrices are looked at for what breaks there.
_TRIES = 48
# What stages may be wrong by, over that: their estimate is that of a lower order.
_BY_STAGES = 10.0
# From which depth on a contact is deep, over what its onset is located to.
_DEEP = 1e6
# How many steps wait at most to be carried along together.
_TOGETHER = 64


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
        self._tries = 0
        self._take_over(run)
        self._waiting: list[Step] = []
        self._looks = list(looks)
        #: Told of each look: ``(time, y, displacements)``, the last (displacement, k).
        self.seen: Callable[[float, Array, Array], None] | None = None
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
        self._within.take_over(run)

    def look(self, run: Run) -> None:
        """Carry the displacements over the step and the changes since the last look."""
        touched, touching = self._within.touching, run.workspace.memory["touching"]
        flipped = np.flatnonzero(touched != touching).tolist()
        happened = self._saltation.has_happened()
        broken = any(one.last == run.stepper.t for one in run.watch.value())
        flipped = self._at_once(run, flipped)
        if run.stepper.t > self._time:  # behind an event the state may be another than the step has led to
            end, ends = None if happened else run.here.copy(), bool(flipped) or happened
            changes, known = (self._changed, ends), (self._changed or self._broken, ends or broken)
            step = Step(self._time, run.stepper.h, self._y, run.stepper.t, end, changes, known)
            parting = [c for c in flipped if touching[c] == 0.0]
            if self._goes_along(step):
                self._waiting.append(step)
            else:
                self._go_along()
                self._step(step, parting)
            self._changed, self._broken = False, broken
            for c in parting:
                self._all = self._saltation.release(c, self._missed.flow, self._all, self._time, self._y)
            if parting:
                self._drop_flow()
        if flipped or happened or len(self._waiting) >= _TOGETHER:
            self._go_along()
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
        if not self._young and self._all.frame.clock:
            self._go_along()
            self._all = at_equal_times(self.field, self._all, *self._here)

    def _at_once(self, run: Run, flipped: list[int]) -> list[int]:
        """Let contacts change that did so where the step begins, together with another; return the rest."""
        if not flipped or run.stepper.t == self._time:
            return flipped
        memory, own, rest = run.workspace.memory, self._within.workspace.memory, []
        last = {int(one["contact"]): one for one in run.episodes}
        for c in flipped:
            begins, here = memory["touching"][c] != 0.0, (self._time, self._y)
            if c not in last or last[c]["onset" if begins else "release"] != self._time:
                rest.append(c)
                continue
            self._go_along()
            if begins:
                self._all = self._saltation.onset(c, memory[c], with_time(self._all), *here)
                self._young.add(c)
            else:
                self._set_flow(*here)
                self._all = self._saltation.release(c, self._missed.flow, self._all, *here)
                self._drop_flow()
            own[c], self._changed = memory[c], True
        return rest

    def _drop_flow(self) -> None:
        """Carry no flow beside displacements any more."""
        for one in (self._all.matrix, self._all.other, self._all.books):
            one[:, self._missed.flow] = 0.0

    def book(self, place: int, more: Array) -> None:
        """Take something to what is integrated along the run, by how much more of each displacement, (k,)."""
        self._go_along()
        self._all.books[place, : len(more)] += more

    def end(self, run: Run) -> None:
        """Carry them to the end."""
        self.look(run)
        self._go_along()

    def _is_shallow(self, c: int) -> bool:
        """Whether a contact has just begun."""
        return self.field.workspace.along_normal(self._y, c)[1] > -float(self._deep[c])

    def _goes_along(self, step: Step) -> bool:
        """Whether displacements may go along a step together with others.

        Nothing is to be seen within it, or changes at its end, and axes stay as they are.
        """
        if self.stages is None or self.field.workspace.constraints is not None:
            return False
        seen = self._looks and self._looks[0] < step.time + (1.0 + at_once(step.time, step.size)) * step.size
        return not (step.changes[1] or step.known[1] or seen)

    def _go_along(self) -> None:
        """Carry the displacements along the steps that wait."""
        steps, self._waiting, here = self._waiting, [], (self._time, self._y, self._here)
        while steps:
            assert self.stages is not None
            lift = self.field.lift(self._all.frame, steps[0].time, steps[0].y)
            done, self._all = self.stages.over_steps(steps, lift, self._all, _BY_STAGES * self._good)
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
        self._within.begin(step.time, step.y, step.size, step.end)
        self._again.begin(step.time, step.y)
        (begins, ends), known, end = step.changes, step.known, step.until
        self._matrices.begin(step.time, step.y, begins or bool(self._young))
        rest = step.piece
        if begins and ends:
            self._part(Piece(0.0, 0.5, True, False, (known[0], False)))
            rest = Piece(0.5, 1.0, False, True, (False, known[1]))
        whole = self._at(1.0)
        if parting:
            self._set_flow(self._time + rest.a * self._within.size, self._at(rest.a))
            up = self.field.lift(self._all.frame, end, whole).up
            self._matrices.opening = self.field.depths.opening(whole, parting[0], up)[0]
        self._part(rest)
        self._matrices.opening = None
        off = self._again.off(end, whole)
        if off.any():
            self._all = self._missed.off(self._all, self._down(end, whole) @ off)
        self._all = self._missed.merged(self._all)
        self._time, self._y = self._here = end, whole
        if self.field.workspace.constraints is not None:
            self.turn(self.field.frame(self._y, self._all.frame.clock))

    def _set_flow(self, time: float, y: Array) -> None:
        """Write the flow of a state beside displacements."""
        self._all = with_time(self._all)
        flow = self._down(time, y) @ self.field.flow(time, y)
        for one in self._all[:2]:
            one[:, self._missed.flow] = flow
        self._all.books[:, self._missed.flow] = self.field.booked(time, y)

    def _part(self, piece: Piece) -> None:
        """Carry the displacements over a part of a step, and show them where they are to be looked at."""
        size = self._within.size
        near = at_once(self._time, size)
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
        time, y = self._here = self._looks.pop(0), self._at(theta)
        if self.seen is not None:
            matrix, frame = (carried := self.carried).matrix, carried.frame
            self.seen(time, y, self.field.lift(frame, time, y).up @ matrix)

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
        self._tries = _TRIES
        found = self._by_stages(piece, self._all)
        self._all = self._matrices.over(piece, self._all) if found is None else found

    def _by_stages(self, piece: Piece, carried: Carried) -> Carried | None:
        """Return displacements behind a part of the step by the run's own stages; None where these cannot."""
        if self.stages is None or all(piece.known) or self._tries == 0:
            return None
        self._tries -= 1
        start = self._time, self._within.size, self._at(piece.a)
        # Of constraints displacements are those where the piece begins.
        lift = self.field.lift(carried.frame, self._time + piece.a * self._within.size, start[2])
        found = self.stages.over(piece, start, lift, carried, _BY_STAGES * self._good)
        if found is None and piece.halvings > 0:
            found = carried
            for half in piece.cut(0.5 * (piece.a + piece.b), False):
                found = None if found is None else self._by_stages(half, found)
        return found

    @property
    def doubt(self) -> Array:
        """By how much the displacements are in doubt, of each, (k,)."""
        matrix, other, *_ = self.carried
        missed = self._missed.sizes(at_equal_times(self.field, self._all, *self._here))
        left_over = self._matrices.left_over * np.linalg.norm(matrix, axis=0)
        return np.asarray(np.linalg.norm(matrix - other, axis=0) + left_over + missed)
