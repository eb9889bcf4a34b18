"""The search of a trial step for events of the user's, and what they remember."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from antenna_pin.dynamics import Workspace
from antenna_pin.integrate import Stepper
from antenna_pin.simulation.events import Event, Time
from antenna_pin.simulation.moment import Moment
from antenna_pin.state import EventMemory

__all__ = ["Crossing", "Watch"]

Array = NDArray[np.float64]

# Where in the first part of a step the side is looked up that an event is on after it has happened.
_PROBE = 1.0 / 64.0
# Of the largest value in a step: what a function may be off by where it is zero.
_ROUND_OFF = 16.0 * np.finfo(float).eps
_SLOPE_REACH = 2.0**-10  # of a step, to either side
# Of a step: dense output is better than this; a correction that is larger is none.
_LARGEST_CORRECTION = 1e-2
_SAME_INSTANT = 1e-13  # of a step


class Crossing(NamedTuple):
    """Where an event's function passes zero.

    Attributes:
        event: Number of the event.
        theta: At which fraction of the trial step.
        side: The sign that it has passed to, if it has done so already; 0 if it is zero there.
        slope: Of the function there, per second; 0 if it has none.
        noise: What it may be off by there.
    """

    event: int
    theta: float
    side: float = 0.0
    slope: float = 0.0
    noise: float = 0.0


class _Memory:
    """What one event remembers, in use (see :class:`EventMemory`)."""

    __slots__ = ("count", "last", "noise", "side")

    def __init__(self) -> None:
        self.count = 0
        self.last = -math.inf
        self.side = self.noise = 0.0

    def sign(self, value: float) -> float:
        """Return the side that a value tells of: 0 if none."""
        if not abs(value) > (self.noise if self.side == 0.0 else 0.0):  # nor does NaN
            return 0.0
        return math.copysign(1.0, value)


class Watch:
    """Looks for events inside trial steps.

    The sides on which the functions are change with their passages only, so that of two events at one instant
    the second is not lost when the first has ended the step.

    Args:
        events: What to look for.
        workspace: What the run works on.
        stepper: Whose steps.

    Attributes:
        instants: Times at which steps must end [s].
    """

    def __init__(self, events: Sequence[Event], workspace: Workspace, stepper: Stepper) -> None:
        """Begin with events that have never happened."""
        self.events = tuple(events)
        self.stepper = stepper
        self.moment = Moment(workspace)
        self._y = np.zeros(workspace.manifold.size)
        self._memories = [_Memory() for _ in events]
        self._values = [0.0] * len(self.events)
        self._times = [k for k, event in enumerate(self.events) if isinstance(event.when, Time)]
        self._functions = [k for k, event in enumerate(self.events) if not isinstance(event.when, Time)]
        asked = [event.asked() for event in self.events]
        self._whens, self._rates = [when for when, _ in asked], [rate for _, rate in asked]
        self.instants = sorted(
            {t for event in self.events if isinstance(event.when, Time) for t in event.when.instants}
        )

    def __bool__(self) -> bool:
        """Whether there is anything to look for."""
        return bool(self.events)

    # --- memory ---------------------------------------------------------------------------------------------

    def take_up(self, memories: Sequence[EventMemory], t: float) -> None:
        """Go on from what the events of another run remember, by their names, at time t [s]."""
        known = {one.name: one for one in memories}
        for k, event in enumerate(self.events):
            memory, one = self._memories[k], known.get(event.name)
            if one is not None:
                memory.count, memory.last, memory.side, memory.noise = (
                    one.count,
                    one.last,
                    one.side,
                    one.noise,
                )
            elif k in self._times:
                memory.last = t

    def side(self, k: int) -> float:
        """Return the side that event k was last seen on; 0 if that is not known."""
        return self._memories[k].side

    def value(self) -> tuple[EventMemory, ...]:
        """Return what the events remember."""
        return tuple(
            EventMemory(name=event.name, count=m.count, last=m.last, side=m.side, noise=m.noise)
            for event, m in zip(self.events, self._memories, strict=True)
        )

    def renew(self) -> None:
        """Look at the present state, after a step or a change: on which sides the functions are.

        One that has passed zero, and has not been counted yet, keeps its side: it will be found at once.
        """
        stepper = self.stepper
        if self._functions:
            self.moment.set(stepper.t, stepper.start[: self._y.size])
        for k in self._functions:
            memory, event = self._memories[k], self.events[k]
            self._values[k] = value = self._whens[k](self.moment)
            side = memory.sign(value)
            if side not in (0.0, memory.side) and (
                memory.side == 0.0 or not event.counts(side) or memory.last == stepper.t
            ):
                memory.side, memory.noise = side, 0.0

    def happen(self, crossing: Crossing) -> int:
        """Count an event that happens at the present state; return how often it has by now."""
        memory = self._memories[crossing.event]
        memory.count += 1
        memory.last = self.stepper.t
        memory.side, memory.noise = crossing.side, 0.0
        if crossing.side == 0.0:
            memory.noise = max(crossing.noise, 4.0 * abs(self._values[crossing.event]))
        return memory.count

    def due(self) -> list[Crossing]:
        """Return the events whose instants have come at the present time."""
        due = []
        for k in self._times:
            instants: tuple[float, ...] = self.events[k].when.instants  # type: ignore[attr-defined]
            due += [Crossing(k, 0.0) for t in instants if self._memories[k].last < t <= self.stepper.t]
        return due

    # --- search ---------------------------------------------------------------------------------------------

    def _at(self, theta: float) -> Moment:
        stepper = self.stepper
        stepper.interpolate(theta, self._y)
        return self.moment.set(stepper.t + theta * stepper.h, self._y)

    def first(self) -> list[Crossing]:
        """Return the first event in the trial step, and those at the same instant.

        The step's dense output must be there.
        """
        found = [crossing for k in self._functions if (crossing := self._crossing(k)) is not None]
        if not found:
            return found
        found.sort(key=lambda crossing: crossing.theta)
        return [crossing for crossing in found if crossing.theta - found[0].theta <= _SAME_INSTANT]

    def _crossing(self, k: int) -> Crossing | None:
        event, memory = self.events[k], self._memories[k]

        when = self._whens[k]

        def f(theta: float) -> float:
            return when(self._at(theta))

        side, a, fa = memory.side, 0.0, self._values[k]
        if side != 0.0 and memory.sign(fa) == -side:
            # Passed already: by a jump, or where another event has ended the step.
            return Crossing(k, 0.0, -side)
        rated = self._rates[k]

        def rate(theta: float) -> float:
            return 0.0 if rated is None else rated(self._at(theta))

        ra = rate(a)
        fresh = side == 0.0
        if fresh and ra != 0.0:
            # It is zero here, but for round-off, and moves to this side.
            side, fa = math.copysign(1.0, ra), 0.0
        elif fresh:
            probe = _PROBE / event.nodes
            value = f(probe)
            side = memory.sign(value)
            if side != 0.0:
                a, fa, ra, fresh = probe, value, rate(probe), False
        points = [(i + 1) / event.nodes for i in range(event.nodes)]
        values = [f(b) for b in points]
        noise = _ROUND_OFF * max(map(abs, (fa, *values)))
        for b, fb in zip(points, values, strict=True):
            rb = rate(b)
            new = memory.sign(fb) if side == 0.0 else (math.copysign(1.0, fb) if abs(fb) > 0.0 else 0.0)
            if side == 0.0:
                side = new
            elif new == -side:
                if fresh and ra * rb < 0.0:  # out, and back already
                    a = float(brentq(rate, a, b, xtol=1e-15))
                    fa = f(a)
                if event.counts(new) and (side * fa > 0.0 or not fresh):
                    return self._located(k, f, a, b, fa, fb, noise)
                side = new
            elif side * ra < 0.0 < side * rb:
                # It comes nearer to zero, then goes away: does it pass in between?
                m = float(brentq(rate, a, b, xtol=1e-15))
                fm = f(m)
                if side * fm < 0.0:
                    if event.counts(-side):
                        return self._located(k, f, a, m, fa, fm, noise)
                    return self._located(k, f, m, b, fm, fb, noise)
            a, fa, ra, fresh = b, fb, rb, False
        return None

    def _located(
        self, k: int, f: Callable[[float], float], a: float, b: float, fa: float, fb: float, noise: float
    ) -> Crossing:
        """Return the crossing between two fractions: its signs there differ, or it is zero at the first."""
        theta = a if fa * fb >= 0.0 else float(brentq(f, a, b, xtol=1e-15, rtol=4.0 * np.finfo(float).eps))
        low, high = max(theta - _SLOPE_REACH, 0.0), min(theta + _SLOPE_REACH, 1.0)
        slope = (f(high) - f(low)) / ((high - low) * self.stepper.h)
        return Crossing(k, theta, 0.0, slope if math.isfinite(slope) else 0.0, noise)

    def lack(self, crossing: Crossing) -> Callable[[], float]:
        """Return a function that tells how much longer the trial step should be to end at an event [s].

        Zero if it cannot be told better: within the round-off of time, or where corrections no longer shrink.
        """
        stepper = self.stepper
        longest = _LARGEST_CORRECTION * stepper.h

        def correction() -> float:
            nonlocal longest
            if crossing.slope == 0.0:
                return 0.0
            self.moment.set(stepper.t + stepper.h, stepper.y)
            size = -self._whens[crossing.event](self.moment) / crossing.slope
            if not 2.0 * math.ulp(stepper.t + stepper.h) < abs(size) < longest:
                return 0.0
            longest = 0.5 * abs(size)
            return size

        return correction
