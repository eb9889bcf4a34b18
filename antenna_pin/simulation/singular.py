"""Positions in which closures and motions lose an equation: found between the steps of a run, and named."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.base.roots import least_between
from antenna_pin.constraints import least_row
from antenna_pin.dynamics import Workspace

__all__ = ["Singular", "Singularities"]

Array = NDArray[np.float64]

# Of the largest share so far: what counts as a singular position, and what is looked at more closely.
_SINGULAR = 1e-3
_SUSPECT = 0.5
# The same of a state from which a run cannot go on: it comes near as the root of the way that is left.
_NEAR = 0.05
# How far a mechanism moves from one look to the next, of what is left of the share: angles in rad, ways in
# its lengths. Shares are sines of angles between its parts: they pass no zero unseen in that.
_STRIDE = 0.02
_REMEMBERED = ("most", "rank", "apart", "time", "way")
_AT_MOST = 100  # to be named: a mechanism that stays singular is one sentence too


class Singular(NamedTuple):
    """A singular position.

    Attributes:
        time: When it is passed [s].
        share: How much of the least independent equation is left there, of the most in this run [-].
    """

    time: float
    share: float


class Singularities:
    """Watches the share that is left of the least independent equation (``FOUND.least``).

    Where it passes zero, the loops could go on in more ways than one, and forces are not determined. A step
    may jump over the place, so that the share dips between two states that are looked at: it is looked at
    between them too, in a state that was passed over or on the cubic through both, and minimised where it
    dips.

    Args:
        workspace: A workspace of its own: nothing of the run's is to change.
    """

    def __init__(self, workspace: Workspace) -> None:
        """Begin."""
        self._workspace = workspace
        self._model = workspace.model
        self._last: list[tuple[float, Array, float]] = []
        self._most = 0.0
        self._rank = 0
        self._apart = True  # whether the way since the last place has led away from it
        constraints = workspace.constraints
        assert constraints is not None
        self._weights = np.ones(self._model.nv)
        for slot in workspace.system.mechanism.joints.values():
            self._weights[slot.ways] = 1.0 / constraints.plan.length
        self._passed: tuple[float, Array] | None = None  # a state since, that was not looked at
        self._middle: tuple[float, Array] | None = None  # one half way to the next that will be
        self._time = self._way = 0.0
        self.found: list[Singular] = []

    def look(self, t: float, y: Array) -> None:
        """Look at the way from the state before to this one, if it is not next to nothing.

        Args:
            t: Time [s].
            y: State [q, v, x].
        """
        self.look_along(np.array([t]), y[np.newaxis])

    def look_along(self, times: Array, states: Array) -> None:
        """Look at the way along states, (n,) [s] and (n, size)."""
        nq, nv = self._model.nq, self._model.nv
        if not len(times):
            return
        speeds = np.abs(states[:, nq : nq + nv] * self._weights).max(axis=1)
        ways = np.diff(times, prepend=self._time if self._last else times[0]) * speeds
        # One after the other, not summed up at once: however the states come in portions, the same are looked
        # at to the last bit.
        for k, way in enumerate(ways.tolist()):
            self._way += way
            stride = _STRIDE * self._last[-1][2] / self._most if self._last else 0.0
            if self._way < stride:
                if self._middle is None and self._way > 0.5 * stride:
                    self._middle = float(times[k]), states[k].copy()
                continue
            self._look(float(times[k]), states[k], self._middle)
            self._way, self._middle = 0.0, None
        self._time = float(times[-1])
        self._passed = (self._time, states[-1].copy()) if self._way > 0.0 else None

    # --- as a value -----------------------------------------------------------------------------------------

    def value(self) -> dict[str, Any]:
        """Return all that it remembers, in lists and numbers."""
        return {
            "last": [(t, y.tolist(), share) for t, y, share in self._last],
            "passed": None if self._passed is None else (self._passed[0], self._passed[1].tolist()),
            "middle": None if self._middle is None else (self._middle[0], self._middle[1].tolist()),
            "found": [tuple(one) for one in self.found],
            **{name: getattr(self, f"_{name}") for name in _REMEMBERED},
        }

    def take_up(self, value: dict[str, Any]) -> None:
        """Go on with what another has left."""
        self._last = [(t, np.array(y), share) for t, y, share in value["last"]]
        for name in ("passed", "middle"):
            one = value[name]
            setattr(self, f"_{name}", None if one is None else (one[0], np.array(one[1])))
        self.found = [Singular(*one) for one in value["found"]]
        for name in _REMEMBERED:
            setattr(self, f"_{name}", value[name])

    def _look(self, t: float, y: Array, between: tuple[float, Array] | None = None) -> None:
        here = (t, y.copy(), self._share(t, y))
        self._most = max(self._most, here[2])
        states = self._last
        if states and t > states[-1][0]:
            before = states[-1]
            middle = self._between(before, here, 0.5) if between is None else self._share(*between)
            lower = min(before[2], here[2])
            if middle < _SUSPECT * lower:
                self._locate(before, here)
            elif len(states) == 2 and before[2] < min(states[0][2], here[2], _SUSPECT * self._most):
                self._locate(states[0], before)
                self._locate(before, here)
        self._apart |= here[2] > 10.0 * _SINGULAR * self._most
        self._last = [*states[-1:], here]

    @property
    def near(self) -> str:
        """What is nearly lost in the last state, for a message; empty if nothing is."""
        self.finish()
        if not self._last or not self._last[-1][2] < _NEAR * self._most:
            return ""
        t, y, _ = self._last[-1]
        self._share(t, y)
        assert self._workspace.constraints is not None
        return f", {least_row(self._workspace.constraints)}"

    def finish(self) -> None:
        """Look at the last state, if it was passed over."""
        if self._passed is not None:
            self._look(*self._passed)
            self._passed, self._middle, self._way = None, None, 0.0

    def _share(self, t: float, y: Array) -> float:
        constraints = self._workspace.constraints
        assert constraints is not None
        self._workspace.prepare_motions(t, y)
        constraints.residuals(t, y, self._workspace.program)
        constraints.factorize(y[: self._model.nq])
        found = constraints.found
        self._rank = max(self._rank, found.rank)
        return found.least if found.rank == self._rank else found.most

    def _between(
        self, one: tuple[float, Array, float], other: tuple[float, Array, float], theta: float
    ) -> float:
        """Return the share on the cubic through two states with their velocities."""
        nq, nv = self._model.nq, self._model.nv
        h = other[0] - one[0]
        start, end = one[1], other[1]
        way = pin.difference(self._model, start[:nq], end[:nq])
        first, last = h * start[nq : nq + nv], h * end[nq : nq + nv]
        step = theta * first + theta**2 * (3.0 * way - 2.0 * first - last)
        step += theta**3 * (first + last - 2.0 * way)
        y = start + theta * (end - start)
        y[:nq] = pin.integrate(self._model, start[:nq], step)
        return self._share(one[0] + theta * h, y)

    def _locate(self, one: tuple[float, Array, float], other: tuple[float, Array, float]) -> None:
        """Find the least share between two states, and name it if it is next to nothing."""
        theta, least = least_between(lambda theta: self._between(one, other, theta), 0.0, 1.0, absolute=1e-9)
        time, share = one[0] + theta * (other[0] - one[0]), least / self._most
        if not share < _SINGULAR:
            return
        # A place at the end of a step is found from both sides; short steps find several dips near it.
        if self.found and (not self._apart or abs(time - self.found[-1].time) <= other[0] - one[0]):
            self.found[-1] = min(self.found[-1], Singular(time, share), key=lambda place: place.share)
        elif len(self.found) < _AT_MOST:
            self.found.append(Singular(time, share))
        self._apart = False

    def words(self) -> str:
        """Return what is to be said of them, for the end of a run; empty if there are none."""
        self.finish()
        if not self.found:
            return ""
        times = ", ".join(f"{found.time:.6g}" for found in self.found[:3])
        more = f" and {len(self.found) - 3} more" if len(self.found) > 3 else ""
        place = "a singular position" if len(self.found) == 1 else "singular positions"
        return f"; passed {place} at t = {times}{more} s, where the loops could go on in more ways than one"
