"""Search of trial steps for events, discrete states, table for the compiled loop."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.calculus import least_between, root_between
from antenna_pin.base.state import EventMemory
from antenna_pin.dynamics import Workspace, motion_block
from antenna_pin.elements import ForceElement
from antenna_pin.integrate import Stepper
from antenna_pin.run.engine import watch_kernels as kernels
from antenna_pin.run.engine.watch_kernels import CHECK_POINT, FIRST_POINT, SECOND_POINT, THIRD_POINT
from antenna_pin.run.simulation.element_events import KinkFunction, ModeFunction
from antenna_pin.run.simulation.events import (
    GRAZE,
    STILL,
    Angle,
    ElementChange,
    Event,
    Force,
    Gap,
    Moment,
    Rate,
    Switch,
    Time,
)

Array = NDArray[np.float64]

# --- zero crossings -----------------------------------------------------------------------------------------


class ZeroCrossing(NamedTuple):
    """Zero crossing of an event's function."""

    event: int  # number of the event
    theta: float  # fraction of the trial step
    side: float = 0.0  # new sign of a function that has passed already; 0 if it is zero there
    slope: float = 0.0  # rate of the function there, per second; 0 if undefined
    noise: float = 0.0  # round-off of the function there
    until: float = math.inf  # fraction up to which the event does not occur again


class Bracket(NamedTuple):
    """Bracket of a zero crossing: two fractions of a trial step, with the values there.

    Further round-off, fraction up to which the event does not occur again, and side of a function that has
    passed already.
    """

    event: int
    a: float
    b: float
    fa: float
    fb: float
    noise: float
    until: float
    side: float = 0.0

    @property
    def guess(self) -> float:
        """Fraction of the step by linear interpolation."""
        return (
            self.a + (self.b - self.a) * self.fa / (self.fa - self.fb) if self.fa * self.fb < 0.0 else self.a
        )


class StepScan(NamedTuple):
    """Values and rates of a function at some fractions of a trial step."""

    thetas: list[float]
    values: list[float]
    rates: list[float]

    def stays(self, i: int, side: float) -> float:
        """Return the fraction up to which the function has its side of part i."""
        for j in range(i + 1, len(self.thetas)):
            back = side * self.rates[j - 1] < 0.0 < side * self.rates[j]
            if not side * self.values[j] > 0.0 or back:
                return self.thetas[j - 1]
        return math.inf


class WatchMemory:
    """Discrete state of one event, in use (:class:`EventMemory`)."""

    __slots__ = ("count", "last", "noise", "side")

    def __init__(self) -> None:
        """Begin with an event that has never occurred."""
        self.count = 0
        self.last = -math.inf
        self.side = self.noise = 0.0

    def sign(self, value: float) -> float:
        """Return the side of a value, 0 if it is zero but for noise."""
        if not abs(value) > (self.noise if self.side == 0.0 else 0.0):  # nor does NaN
            return 0.0
        return math.copysign(1.0, value)


# --- search of trial steps ----------------------------------------------------------------------------------

# Permitted error of an interpolation, relative to the spread of values, and largest number of points.
_OFF, _MOST = 0.01, 512


def with_least_values(f: Callable[[float], float], look: StepScan) -> StepScan:
    """Return a scan refined until it shows the least values of a function without rate.

    Points are doubled until a cubic spline through them predicts the values between; then each minimum among
    the points is located.

    Args:
        f: Function of a fraction of the step.
        look: Scan at known points, the step's ends among them.
    """
    from scipy.interpolate import CubicSpline

    if max(look.values) == min(look.values):
        return look
    thetas = np.array([0.0, FIRST_POINT, SECOND_POINT, CHECK_POINT, THIRD_POINT, 1.0])
    values = np.array([look.values[0], *map(f, thetas[1:-1].tolist()), look.values[-1]])
    while len(thetas) < _MOST:
        between = 0.5 * (thetas[1:] + thetas[:-1])
        found = np.array([f(theta) for theta in between.tolist()])
        off = np.abs(found - CubicSpline(thetas, values)(between)).max()
        thetas = np.insert(thetas, range(1, len(thetas)), between)
        values = np.insert(values, range(1, len(values)), found)
        if off <= _OFF * np.ptp(values):
            break
    beside = np.concatenate([[np.inf], values, [np.inf]])
    for i in np.flatnonzero((values < beside[:-2]) & (values <= beside[2:]))[::-1].tolist():
        first, last = float(thetas[max(i - 1, 0)]), float(thetas[min(i + 1, len(thetas) - 1)])
        low, value = least_between(f, first, last, absolute=1e-12)
        if value < values[i]:
            at = int(np.searchsorted(thetas, low))
            thetas, values = np.insert(thetas, at, low), np.insert(values, at, value)
    return StepScan(thetas.tolist(), values.tolist(), [0.0] * len(thetas))


# Place in the first part of a step at which the side of an event is evaluated after its occurrence.
_PROBE = 1.0 / 64.0
# Round-off of a function at its zero, relative to its largest value in a step.
_ROUND_OFF = 16.0 * np.finfo(float).eps
_SLOPE_REACH = 2.0**-10  # of a step, to either side
# Of a step: dense output is better than this; a correction that is larger is none.
_LARGEST_CORRECTION = 1e-2
_SAME_INSTANT = 1e-13  # of a step
# Smallest round-off of an element's function at its zero, and number of halvings of a part of
# a step in search of a positive value.
_LEAST, _HALVINGS = 1e-16, 40
_NEAR = 1e-6  # of a step: a zero nearer than this by the slope is located


class EventWatch:
    """Search of trial steps for zero crossings of events' functions.

    The side of a function changes with its crossings only, so that of two coincident events
    the second is not lost when the first has ended the step.

    Attributes:
        instants: Times at which steps must end [s].
        tick: Next sample time of the run's controllers, infinity after the last one [s]; None in a run
            without controllers.
    """

    def __init__(self, events: Sequence[Event], workspace: Workspace, stepper: Stepper) -> None:
        """Begin with events that have never occurred."""
        self.events = tuple(events)
        self.stepper = stepper
        self.tick: float | None = None
        self.moment = Moment(workspace)
        self._y = np.zeros(workspace.manifold.size)
        self._theta = math.nan  # the fraction of the trial step that the moment is at, if any
        self._memories = [WatchMemory() for _ in events]
        self._values = [0.0] * len(self.events)
        self._times = [k for k, event in enumerate(self.events) if isinstance(event.when, Time)]
        self._on_changes = [k for k, event in enumerate(self.events) if isinstance(event.when, ElementChange)]
        others = {*self._times, *self._on_changes}
        self._functions = [k for k in range(len(self.events)) if k not in others]
        asked = [event.functions() for event in self.events]
        self._whens, self._rates = [when for when, _ in asked], [rate for _, rate in asked]
        self.instants = sorted(
            {t for event in self.events if isinstance(event.when, Time) for t in event.when.instants}
        )

    def __bool__(self) -> bool:
        """Return whether there are events."""
        return bool(self.events)

    # --- discrete state -------------------------------------------------------------------------------------

    def take_up(self, memories: Sequence[EventMemory], t: float) -> None:
        """Continue from the discrete states of another run's events, by name, at t [s]."""
        known = {one.name: one for one in memories}
        for k, event in enumerate(self.events):
            memory, one = self._memories[k], known.get(event.name)
            if one is not None:
                for name in WatchMemory.__slots__:
                    setattr(memory, name, getattr(one, name))
            elif k in self._times:
                memory.last = t

    def side(self, k: int) -> float:
        """Return the last known side of event k; 0 if unknown."""
        return self._memories[k].side

    def value(self) -> tuple[EventMemory, ...]:
        """Return the discrete states of the events."""
        return tuple(
            EventMemory(name=event.name, count=m.count, last=m.last, side=m.side, noise=m.noise)
            for event, m in zip(self.events, self._memories, strict=True)
        )

    def renew(self) -> None:
        """Update the sides of the functions at the present state.

        A function that has passed zero, and has not been counted yet, keeps its side, to be found at once.
        """
        if self._functions:
            self._set_here()
        for k in self._functions:
            self._renew(k)

    def _set_here(self) -> None:
        self._theta = math.nan
        self.moment.set(self.stepper.t, self.stepper.start[: self._y.size])

    def _renew(self, k: int) -> None:
        """Update the side of a function at the moment's state."""
        memory, event = self._memories[k], self.events[k]
        self._values[k] = value = self._whens[k](self.moment)
        side = memory.sign(value)
        if side not in (0.0, memory.side) and (
            memory.side == 0.0 or not event.counts(side) or memory.last == self.stepper.t
        ):
            memory.side, memory.noise = side, 0.0
        if isinstance(event.action, Switch) and memory.side < 0.0:
            memory.side = 1.0  # a function that is negative already passes at once

    def logical(self, noise: float, grazed: Collection[tuple[str, int]] = ()) -> None:
        """Reset the sides of elements' functions after changes of mode, by logic at zero.

        Args:
            noise: Size up to which a function counts as zero.
            grazed: Functions that stay positive: of elements by place, and their numbers.
        """
        self._set_here()
        for k in self._functions:
            event, memory = self.events[k], self._memories[k]
            if isinstance(event.action, Switch):
                value = abs(self._whens[k](self.moment))
                own = max(_LEAST, 4.0 * value) if value <= noise else 0.0
                loaded = event.when.hold >= 0 and value > noise  # type: ignore[attr-defined]
                stays = loaded or (event.action.place, event.action.number) in grazed
                memory.side, memory.noise = (1.0, 0.0) if stays else (0.0, own)
                self._renew(k)

    def count(self, crossing: ZeroCrossing) -> int:
        """Count an event at the present state; return the count."""
        k = crossing.event
        memory, watched = self._memories[k], k in self._functions
        if watched:
            self._set_here()
            self._values[k] = self._whens[k](self.moment)
        memory.count += 1
        memory.last = self.stepper.t
        memory.side, memory.noise = crossing.side, 0.0
        if crossing.side == 0.0:
            memory.noise = max(crossing.noise, 4.0 * abs(self._values[k]))
        if watched:
            self._renew(k)
        return memory.count

    def due(self) -> list[ZeroCrossing]:
        """Return the events whose times have come."""
        due = []
        for k in self._times:
            instants: tuple[float, ...] = self.events[k].when.instants  # type: ignore[attr-defined]
            due += [ZeroCrossing(k, 0.0) for t in instants if self._memories[k].last < t <= self.stepper.t]
        return due

    def on_changes(
        self, elements: Mapping[str, ForceElement], changed: Iterable[tuple[str, str]]
    ) -> list[ZeroCrossing]:
        """Return the events on elements' changes recorded at the present time."""
        made = tuple(changed)
        whens = {k: self.events[k].when for k in self._on_changes if self._memories[k].last != self.stepper.t}
        return [
            ZeroCrossing(k, 0.0)
            for k, when in whens.items()
            if isinstance(when, ElementChange) and any(when.is_met(elements, *one) for one in made)
        ]

    # --- search ---------------------------------------------------------------------------------------------

    def _at(self, theta: float) -> Moment:
        if theta == self._theta:
            return self.moment
        stepper, self._theta = self.stepper, theta
        if theta == 0.0:  # the state itself, which dense output is but for round-off
            self._y[:] = stepper.start[: self._y.size]
        else:
            stepper.interpolate(theta, self._y)
        return self.moment.set(stepper.t + theta * stepper.h, self._y)

    def _value(self, k: int, theta: float) -> float:
        return self._whens[k](self._at(theta))

    def ahead(self) -> list[list[ZeroCrossing]]:
        """Return the events in the trial step in order of time, coincident ones together.

        The dense output of the step must be prepared. Only the first ones are certain: none after an event
        that changes the system, or after a possible second occurrence of a located event.
        """
        self._theta = math.nan
        looks: dict[int, StepScan] = {}
        for nodes in dict.fromkeys(self.events[k].nodes for k in self._functions):
            self._look(nodes, looks)
        for k in self._functions:
            look = looks[k]
            if isinstance(self.events[k].action, Switch) and not any(look.rates):
                looks[k] = with_least_values(partial(self._value, k), look)
        brackets = [bracket for k in self._functions if (bracket := self._bracket(k, looks[k])) is not None]
        brackets.sort(key=lambda bracket: bracket.guess)
        found: list[ZeroCrossing] = []
        later: list[Bracket] = []
        for bracket in brackets:
            if found and self._comes_after(bracket, found[0].theta):
                later.append(bracket)
            else:
                found.append(self._located(bracket))
                found.sort(key=_order)
        if not found:
            return []
        first = [one for one in found if one.theta - found[0].theta <= _SAME_INSTANT]
        if any(self.events[one.event].changes for one in first):
            return [first]
        found = sorted([*found, *map(self._located, later)], key=_order)
        until = min(one.until for one in found)
        groups = [[found[0]]]
        for one in found[1:]:
            if one.theta - groups[-1][0].theta <= _SAME_INSTANT:
                groups[-1].append(one)
            else:
                groups.append([one])
        return [groups[0], *(group for group in groups[1:] if group[-1].theta < until)]

    def _comes_after(self, one: Bracket, theta: float) -> bool:
        """Return whether a function certainly passes zero later than a fraction."""
        if one.a >= theta or one.a == one.b:
            return one.a > theta + _SAME_INSTANT
        value = self._value(one.event, theta)
        return value * one.fa > 0.0 and abs(value) > _NEAR * abs(one.fb - one.fa) / (one.b - one.a)

    def _look(self, nodes: int, looks: dict[int, StepScan]) -> None:
        """Evaluate the functions with this number of nodes at the nodes."""
        mine = [k for k in self._functions if self.events[k].nodes == nodes]
        for k in mine:
            looks[k] = StepScan([0.0], [self._values[k]], [])
        for i in range(nodes + 1):
            moment = self._at(i / nodes)
            for k in mine:
                rated, look = self._rates[k], looks[k]
                if i > 0:
                    look.thetas.append(i / nodes)
                    look.values.append(self._whens[k](moment))
                look.rates.append(0.0 if rated is None else rated(moment))

    def _bracket(self, k: int, look: StepScan) -> Bracket | None:
        """Return the first bracket of an event's function in the trial step, or None."""
        event, memory = self.events[k], self._memories[k]
        switches = isinstance(event.action, Switch)
        least = -GRAZE if switches else 0.0  # above it a function of an element has not passed
        side, a, fa, ra = memory.side, 0.0, look.values[0], look.rates[0]
        if switches and abs(ra) < STILL:
            ra = 0.0
        if side != 0.0 and memory.sign(fa) == -side and side * fa < least:
            # Passed already: by a jump, or at the end of a step by another event.
            return Bracket(k, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -side)
        rated = self._rates[k]

        def rate(theta: float) -> float:
            return 0.0 if rated is None else rated(self._at(theta))

        fresh = side == 0.0
        if fresh and ra != 0.0:
            # Zero here, but for round-off, and moving to this side.
            side, fa = math.copysign(1.0, ra), 0.0
        elif fresh:
            probe = _PROBE / event.nodes
            value = self._value(k, probe)
            side = memory.sign(value)
            if side != 0.0:
                a, fa, ra, fresh = probe, value, rate(probe), False
        if switches and side < 0.0:
            return self._out_and_back(k, a, fa)
        noise = _ROUND_OFF * max(map(abs, (fa, *look.values[1:])))
        for i in range(1, len(look.thetas)):
            b, fb, rb = look.thetas[i], look.values[i], look.rates[i]
            new = memory.sign(fb) if side == 0.0 else (math.copysign(1.0, fb) if abs(fb) > 0.0 else 0.0)
            if new == -side and side * fb >= least:
                new = 0.0
            if side == 0.0:
                if switches and new < 0.0:
                    return self._out_and_back(k, b, fb)
                side = new
            elif new == -side:
                if fresh and ra * rb < 0.0:  # out, and back already
                    a = root_between(rate, a, b, absolute=1e-15, ends=(ra, rb))
                    fa = self._value(k, a)
                if switches and least <= fa <= 0.0 and not fresh:
                    return self._leaves(k, (a, fa), (b, fb))
                if event.counts(new) and (side * fa > 0.0 or not fresh):
                    return Bracket(k, a, b, fa, fb, noise, look.stays(i, new))
                if switches and new < 0.0:
                    return self._out_and_back(k, b, fb)
                side = new
            elif side * ra < 0.0 < side * rb:
                # The function approaches zero, then recedes: it may pass twice in between.
                m = root_between(rate, a, b, absolute=1e-15, ends=(ra, rb))
                fm = self._value(k, m)
                if side * fm < least:
                    # Twice: the search is repeated after the first of them.
                    if event.counts(-side):
                        return Bracket(k, a, m, fa, fm, noise, a)
                    return Bracket(k, m, b, fm, fb, noise, m)
            a, fa, ra, fresh = b, fb, rb, False
        return None

    def _out_and_back(self, k: int, b: float, fb: float) -> Bracket:
        """Return the bracket of an element's function, zero at the start and negative at b.

        The function may have been positive between, which halving shows; otherwise it passes at once.
        """
        for _ in range(_HALVINGS if b > 0.0 else 0):
            value = self._value(k, 0.5 * b)
            if value > 0.0:
                return Bracket(k, 0.5 * b, b, value, fb, 0.0, 0.5 * b)
            b, fb = 0.5 * b, value
        return Bracket(k, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0)

    def _leaves(self, k: int, zero: tuple[float, float], below: tuple[float, float]) -> Bracket:
        """Return the bracket at which an element's function falls below round-off."""
        (a, fa), (b, fb) = zero, below
        at = root_between(
            lambda x: self._value(k, x) + GRAZE, a, b, absolute=1e-15, ends=(fa + GRAZE, fb + GRAZE)
        )
        return Bracket(k, at, at, 0.0, 0.0, 0.0, at, -1.0)

    def _located(self, one: Bracket) -> ZeroCrossing:
        """Return the crossing in a bracket, or the zero at its first end."""
        if one.side != 0.0:
            return ZeroCrossing(one.event, one.a, one.side, until=one.until)
        f, (a, b, fa, fb) = partial(self._value, one.event), one[1:5]
        theta = root_between(f, a, b, absolute=1e-15, ends=(fa, fb)) if fa * fb < 0.0 else a
        low, high = max(theta - _SLOPE_REACH, 0.0), min(theta + _SLOPE_REACH, 1.0)
        slope = (f(high) - f(low)) / ((high - low) * self.stepper.h)
        return ZeroCrossing(
            one.event, theta, 0.0, slope if math.isfinite(slope) else 0.0, one.noise, one.until
        )

    def lack(self, crossing: ZeroCrossing) -> Callable[[], float]:
        """Return a function for the Newton correction of the step size to an event [s].

        Zero within the round-off of time, or if corrections no longer shrink.
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


def _order(crossing: ZeroCrossing) -> tuple[float, int]:
    return crossing.theta, crossing.event


# --- table for the compiled loop ----------------------------------------------------------------------------


def is_known(event: Event) -> bool:
    """Return whether compiled code evaluates an event's function."""
    return isinstance(
        event.when, Angle | Rate | Gap | Force | Time | ElementChange | KinkFunction | ModeFunction
    )


class WatchTable:
    """Events of a run as the compiled loop reads them.

    Attributes:
        numbers: Table for kernels.
    """

    def __init__(self, watch: EventWatch) -> None:
        """Fill the table."""
        system = watch.moment.system
        self._watch = watch
        known = [k for k, event in enumerate(watch.events) if is_known(event)]
        self._places = [k for k in known if not isinstance(watch.events[k].when, Time | ElementChange)]
        functions = np.zeros(len(self._places), kernels.WATCHED)
        blocks = [system.program]
        for row, k in zip(functions, self._places, strict=True):
            event = watch.events[k]
            when = event.when
            row["parts"] = event.nodes
            if isinstance(when, KinkFunction):
                row["what"], row["where"], row["number"] = kernels.KINK, when.block, when.number
            elif isinstance(when, ModeFunction):
                row["what"], row["where"] = kernels.SWITCH, when.block
                row["number"], row["hold"] = when.number, when.hold
            elif isinstance(when, Angle | Rate):
                row["what"] = kernels.ANGLE if isinstance(when, Angle) else kernels.RATE
                row["where"], row["value"] = sum(map(len, blocks)), when.value
                blocks.append(motion_block(system, when.joint))
            elif isinstance(when, Gap | Force):
                row["what"] = kernels.GAP if isinstance(when, Gap) else kernels.FORCE
                row["where"], row["value"] = watch.moment.contact_number(when.contact), when.value
        self.numbers = kernels.Watched(
            functions=functions,
            program=np.concatenate(blocks),
            rates=np.zeros(system.model.nv + system.manifold.nx),
            instants=np.array([*watch.instants, *[np.inf] * (watch.tick is not None)], dtype=float),
            values=np.zeros(2),
            dips=np.zeros(6),
            unknown=len(watch.events) - len(known),
        )

    def renew(self) -> None:
        """Update the sides of the functions, and the controllers' next sample time."""
        if self._watch.tick is not None:
            self.numbers.instants[-1] = self._watch.tick
        for row, k in zip(self.numbers.functions, self._places, strict=True):
            row["side"] = self._watch.side(k)
