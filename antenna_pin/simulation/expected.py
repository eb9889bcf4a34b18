"""How long a run will still take by its own pace, told of one that takes long; and what makes it slow."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.readable import lasting, number
from antenna_pin.base.settings import RunSettings
from antenna_pin.dynamics import Workspace
from antenna_pin.simulation.scales import scale_vector
from antenna_pin.simulation.stretches import Made

__all__ = ["Expected", "rough", "turning"]

Array = NDArray[np.float64]

_FIRST = 2.5  # [s] of wall time to the first look; from look to look as much again as there was before
_LONG = 60.0  # [s] of wall time that a run may still take without a word
# Trial steps, or [s] of wall time, on which a pace can rest: the first steps load what they call.
_STEPS, _PATIENCE = 100, 15.0
_OTHER = 4.0  # times longer, or shorter, than was told: it is told again
_ALIKE = 2.0  # times the least estimate up to which the greatest is no other
# Steps' share of their tolerance that round-off may have before it is what holds them.
_NOISE = 0.1
_TURN = 0.05  # [rad] that a joint turns in a step, and it is this that steps follow
_LAST_DIGIT = float(np.finfo(float).eps)
_TRIES = 4


class Expected:
    """Looks how long a run will still take, at its pace since the last look.

    The clock decides when, and nothing in the run hangs on it.

    Args:
        end: Of the run [s].

    Attributes:
        left: Wall time that the run will still take, as last told, by its pace since the last look [s]; NaN
            if nothing was told.
        range: The least and the greatest of that, by the fastest pace from look to look so far, by that since
            the last one, and in all.
        step: Way of the run for each trial step, at its present pace [s].
        rejected: Share of trial steps that were rejected, likewise [-].
        relocated: Share of those that were made to end where something happens, likewise [-].
    """

    def __init__(self, end: float) -> None:
        """Begin without a look."""
        self.left, self.step = math.nan, 0.0
        self.range = math.nan, math.nan
        self._best, self._tried = 0.0, 0
        self.rejected = self.relocated = 0.0
        self._end = end
        self._told = math.nan
        self._before = self._start = 0.0
        self._began = self._next = math.nan
        self._mark = 0.0, Made(0, 0, 0, 0, 0.0)

    def begin(self, t: float, made: Made) -> None:
        """Take the time from here on: at t [s], with what a run that goes on has made before."""
        self._mark, self._start = (t, made), t
        self._began, self._next, self._tried = made.wall, made.wall + _FIRST, made.tried

    def look(self, t: float, made: Made) -> bool:
        """Look at a run that has come to t [s], if it is time to; return whether it is to be told of."""
        if not made.wall >= self._next or self._end == math.inf:
            return False
        then, way = self._mark[1], self.measure(t, made)
        self._mark = t, made
        self._next = self._began + 2.0 * (made.wall - self._began)
        if then.wall == self._began:
            return False
        rests = made.tried - self._tried >= _STEPS or made.wall - self._began >= _PATIENCE
        left = self._left(t, way, made.wall - then.wall)
        # At two looks, or by the whole way so far: a burst of impacts or events is soon over.
        others = self._before, self._left(t, t - self._start, made.wall - self._began)
        sure = max(others) > _LONG
        self._best = max(self._best, way / (made.wall - then.wall))
        known = left, others[1], self._left(t, self._best, 1.0)
        self._before = left
        whole = made.wall + left
        if not (rests and sure and left > _LONG) or self._told / _OTHER <= whole <= self._told * _OTHER:
            return False
        self.left, self._told = left, whole
        self.range = min(known), max(known)
        return True

    def _left(self, t: float, way: float, wall: float) -> float:
        """Return what the run will take from t [s] on, if it makes such a way in so much wall time [s]."""
        return (self._end - t) * wall / way if way > 0.0 else math.inf

    def measure(self, t: float, made: Made) -> float:
        """Take the pace since the last look, of a run that has come to t [s]; return its way since [s]."""
        before, then = self._mark
        tried, way = max(made.tried - then.tried, 1), t - before
        self.step = way / tried
        self.rejected = (made.rejected - then.rejected) / tried
        self.relocated = (made.relocated - then.relocated) / tried
        return way

    def words(self, t: float) -> str:
        """Return how long the run will still take, at t [s]."""
        took = lasting(self._mark[1].wall - self._began)
        if math.isinf(self.left):
            return f"at t = {t:.9g} s of {self._end:g} s, after {took}, the run makes no way at all"
        least, most = self.range
        if most <= _ALIKE * least:
            how_long = f"{lasting(self.left)} at its present pace"
        elif math.isinf(most):
            how_long = f"{lasting(least)} or more, as its pace changes"
        else:
            how_long = f"{lasting(least)} to {lasting(most)}, as its pace changes"
        return (
            f"at t = {t:.9g} s of {self._end:g} s, after {took}, the run will take another {how_long}, with "
            f"steps of {number(self.step, 2)} s"
        )


def rough(run: Workspace, settings: RunSettings, t: float, y: Array, step: float) -> str:
    """Return in words that what moves a system is no better than noise; empty if it is.

    Where time and state change by their last digits, accelerations may change by so much that a step of a
    usual size cannot keep its tolerance.

    Args:
        run: What the run works on; not changed.
        settings: Of the run.
        t: Time [s].
        y: State [q, v, x].
        step: Size of the run's steps [s].
    """
    system = run.system
    workspace = Workspace(system, run.memory)
    workspace.program[:] = run.program
    nq, nv = workspace.model.nq, workspace.model.nv
    speeds = y[nq : nq + nv]
    scales = scale_vector(system, settings.scales)[nv : 2 * nv]
    rates = np.zeros((1 + _TRIES, nv + workspace.manifold.nx))
    workspace.derivative(t, y, rates[0])
    draw = np.random.default_rng(0)
    for row in rates[1:]:
        signs = draw.choice((-1.0, 1.0), 1 + len(y))
        workspace.derivative(t * (1.0 + signs[0] * _LAST_DIGIT), y * (1.0 + signs[1:] * _LAST_DIGIT), row)
    apart = np.abs(rates[1:, :nv] - rates[0, :nv]).max(axis=0)
    shares = step * apart / (settings.rtol * (scales + np.abs(speeds)))
    worst, fastest = int(np.argmax(shares)), int(np.argmax(np.abs(speeds)))
    if not shares[worst] > _NOISE:
        return ""
    return (
        f"no step keeps its tolerance: the acceleration of {system.names_v[worst]} changes by "
        f"{number(float(apart[worst]), 2)} where time and state change by their last digits; largest is the "
        f"velocity {system.names_v[fastest]} = {number(float(speeds[fastest]), 3)}: let the start be slower, "
        "or make laws and drives smooth"
    )


def turning(run: Workspace, y: Array, step: float) -> str:
    """Return in words that steps follow a joint that turns fast; empty if none does.

    Args:
        run: What the run works on.
        y: State [q, v, x].
        step: Size of the run's steps [s].
    """
    nq, system = run.model.nq, run.system
    rates = {
        name: float(np.abs(y[nq : nq + run.model.nv][slot.v]).max())
        for name, slot in system.mechanism.joints.items()
        if slot.kind in ("continuous", "revolute")
    }
    fastest = max(rates, key=rates.__getitem__, default="")
    if not fastest or not rates[fastest] * step > _TURN:
        return ""
    return (
        f"joint {fastest!r} turns at {number(rates[fastest], 3)} rad/s, and steps follow its turns, "
        f"{number(2.0 * math.pi / (rates[fastest] * step), 2)} for each"
    )
