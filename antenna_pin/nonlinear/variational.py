"""The variational equation: how a displacement of a state is carried along a run, through events too.

Between events displacements w go by ``w' = A(t) w``, with the derivative A of the rates. At an event, where
the function g passes zero, the rates jump from f- to f+ and the state may go through a map R. A neighbour
comes there later by ``dt = -(dg w) / g'``, and behind it is displaced by the *saltation*

    w+ = DR w + (DR f- + R_t - f+) dt

(Aizerman and Gantmakher 1958, J. Mech. Appl. Math. 11; Leine and Nijmeijer 2004, Dynamics and Bifurcations of
Non-Smooth Mechanical Systems, section 7.4). A contact's onset does more: the approach speed (and the
effective mass) that it remembers are those of the neighbour's own instant, ``log s+ = d(log s) w + (log s)'
dt``. A release lets them go.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from antenna_pin.dynamics import Workspace
from antenna_pin.integrate import NODES, Propagator, method_named
from antenna_pin.nonlinear.field import Field
from antenna_pin.nonlinear.frames import Frame
from antenna_pin.nonlinear.saltation import Carried, Onset, Saltation
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.quiet import stepper_of

__all__ = ["Carrier"]

Array = NDArray[np.float64]

# What a piece of a step may be wrong by, over the displacements and over the run's tolerance; and how often a
# step is halved for that.
_GOOD, _HALVINGS = 1e2, 30
# Power of what is integrated over that time goes with next to where a contact begins or ends.
_GRADE = 4


class Carrier:
    """Carries displacements along a run: what the run shows itself to between its steps.

    A contact's force counts from a depth of ten times what its onset is located to: up to there it is a step.
    So laws are taken whose derivative is without bounds where they begin, as Tsuji's is.

    Args:
        run: Before its first step; its steps are made one by one.
        first: Axes in its first state.
        ways: Displacements to carry, in coordinates along these, (size, k); all of them if left out.

    Attributes:
        carried: Displacements in the present state.
        field: The rates, with the contacts that count.
    """

    def __init__(self, run: Run, first: Frame, ways: Array | None = None) -> None:
        """Begin in the run's first state."""
        system, settings = run.system, run.settings
        self.field = Field(system, settings)
        workspace = self.field.workspace
        workspace.memory[:], workspace.program[:] = run.workspace.memory, run.workspace.program
        self._own = Workspace(system)
        self._dense = stepper_of(self._own, method_named(settings.method), run.stepper.scales, settings)
        self._saltation = Saltation(self.field, run)
        self._good = _GOOD * settings.rtol
        self._shallow = 10.0 * np.array(run.search.tolerances)
        self._coming: dict[int, Onset] = {}
        self._changed = False
        self._propagator = Propagator(0)
        self._take_over(run)
        size = self.field.lift(first, self._time, self._y).up.shape[1]
        start = np.eye(size) if ways is None else ways
        self.carried = Carried(start, start.copy(), first)

    def _take_over(self, run: Run) -> None:
        """Begin the next step where the run is."""
        self._time, self._y = run.stepper.t, run.here.copy()
        self._own.memory[:], self._own.program[:] = run.workspace.memory, run.workspace.program

    def look(self, run: Run) -> None:
        """Carry the displacements over the step and the changes since the last look."""
        touched, touching = self._own.memory["touching"], run.workspace.memory["touching"]
        flipped = np.flatnonzero(touched != touching).tolist()
        happened = self._saltation.has_happened(run)
        if run.stepper.t > self._time:
            self._step(run.stepper.t, run.stepper.h, bool(flipped) or happened)
        if happened:
            self.carried = self._saltation.through_events(run, self.carried, self._time, self._y)
        for c in flipped:
            if touching[c] != 0.0:
                now = self.carried, self._time, self._y
                self._coming[c] = self._saltation.onset(c, run.workspace.memory[c], *now)
            elif self._coming.pop(c, None) is None:
                self.carried = self._saltation.through_contact(c, None, self.carried, self._time, self._y)
        self._changed = self._changed or bool(flipped) or happened
        self._take_over(run)

    def end(self, run: Run) -> None:
        """Carry them to the end."""
        self.look(run)
        for c in list(self._coming):
            self._let_count(c, self._time, self._y)

    def _let_count(self, c: int, time: float, y: Array) -> None:
        """Let a contact that has begun count."""
        self.carried = self._saltation.through_contact(c, self._coming.pop(c), self.carried, time, y)

    def _step(self, end: float, size: float, ends_in_change: bool) -> None:
        """Carry the displacements over a step that the run has made.

        Args:
            end: When it ended [s].
            size: Its size [s].
            ends_in_change: Whether contacts or drives change there.
        """
        dense = self._dense
        dense.restart(self._time, self._y)
        dense.attempt(size)
        dense.prepare_dense()
        begin, begins = 0.0, self._changed
        for theta, c in sorted((self._counts_from(c), c) for c in self._coming):
            if theta > 1.0:
                break
            self._piece(begin, theta, False, False, _HALVINGS)
            self._let_count(c, self._time + theta * size, self._at(theta))
            begin, begins = theta, True
        middle = 0.5 * (begin + 1.0)
        if begins and ends_in_change:
            self._piece(begin, middle, True, False, _HALVINGS)
            begin, begins = middle, False
        self._piece(begin, 1.0, begins, ends_in_change, _HALVINGS)
        self._time, self._y, self._changed = end, self._at(1.0), False
        if self.field.workspace.constraints is not None:
            self.turn(self.field.frame(self._y))

    def _at(self, theta: float) -> Array:
        """Return the state at a fraction of the step."""
        y = np.zeros_like(self._y)
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
        field, old = self.field, self.carried
        turn = field.lift(frame, self._time, self._y).down @ field.lift(old.frame, self._time, self._y).up
        self.carried = Carried(turn @ old.matrix, turn @ old.other, frame)

    def _piece(self, a: float, b: float, graded: bool, falling: bool, halvings: int) -> None:
        """Carry the displacements over a part of the step.

        Behind an onset the derivative of a force that begins like depth^1.5 goes with the root of time, and
        likewise before a release: there time goes with the square of what is integrated over.

        Args:
            a: Where it begins, as a fraction of the step.
            b: Where it ends.
            graded: Whether the step begins where contacts or drives have changed.
            falling: Whether it ends there.
            halvings: How often it may be halved yet.
        """
        size = b - a
        if graded:
            thetas, slopes = a + size * NODES**_GRADE, _GRADE * NODES ** (_GRADE - 1)
        elif falling:
            thetas, slopes = b - size * (1.0 - NODES) ** _GRADE, _GRADE * (1.0 - NODES) ** (_GRADE - 1)
        else:
            thetas, slopes = a + size * NODES, np.ones(len(NODES))
        frame, start, whole = self.carried.frame, self._time, self._dense.h
        found = [self.field.matrix(frame, start + s * whole, self._at(s)) for s in thetas.tolist()]
        sixth, fourth = (np.array([f[k] * s for f, s in zip(found, slopes, strict=True)]) for k in (0, 1))
        if self._propagator.size != sixth.shape[1]:
            self._propagator = Propagator(sixth.shape[1])
        step = self._propagator.step(size * whole, sixth)
        if not step.off <= self._good and halvings > 0:
            middle = 0.5 * (a + b)
            self._piece(a, middle, graded, False, halvings - 1)
            self._piece(middle, b, False, falling, halvings - 1)
            return
        other = step.other + self._propagator.change(size * whole, fourth - sixth)
        old = self.carried
        self.carried = Carried(step.matrix @ old.matrix, other @ old.other, old.frame)
