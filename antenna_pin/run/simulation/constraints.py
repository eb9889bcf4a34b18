"""Constraints in a run: prescribed motions with jumps, motions given by functions, singular positions."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.base.calculus import least_between
from antenna_pin.base.parameters import parameters_of
from antenna_pin.base.readable import number
from antenna_pin.dynamics import Adjustments, System, Workspace, acting_in, check_restraint, kernels
from antenna_pin.dynamics.constraints import least_row
from antenna_pin.elements import CallableMotion, Motion, PrescribedMotion
from antenna_pin.elements.prescribed import continued
from antenna_pin.errors import InvalidParameterError
from antenna_pin.run.simulation.events import Event, Set, Time

Array = NDArray[np.float64]

# --- prescribed motions whose rate jumps --------------------------------------------------------------------

# Jump of a position that is round-off of located times, relative to the amplitude.
_ROUND_OFF = 1e-9


class _JumpCourse(NamedTuple):
    """Course with jumps, in a program."""

    places: slice  # places of the terms in the program
    terms: Array  # terms of the whole course
    times: Array  # times of the jumps [s]
    begins: Array  # these times less the round-off of times [s]


def check_sets(events: Sequence[Event], system: System, y: Array) -> None:
    """Refuse events that set a number no motion can follow, where known before a run.

    Known are the numbers that an event sets at its times, if no other event sets a number of the same motion;
    a position, at any time; and an element switched on at a joint that motions move at the start.

    Raises:
        InvalidParameterError: A motion would jump.
        NotFollowedError: A joint would be held where motions move it.
    """
    workspace = Workspace(system)
    adjustments = Adjustments(system, workspace.program)
    motions = Motions(workspace, adjustments)
    sets = [(event, one) for event in events for one in event.actions if isinstance(one, Set)]
    places = [action.place.rpartition(".")[::2] for _, action in sets]
    for (event, action), (element, key) in zip(sets, places, strict=True):
        if not motions.is_one(element):
            if key == "on" and action.value:
                check_restraint(workspace, adjustments, 0.0, y, element)
            continue
        alone = [one for one, _ in places].count(element) == 1
        times = event.when.instants[event.after - 1 :][:1] if alone and isinstance(event.when, Time) else ()
        for t in times or ((0.0,) if key == "position" else ()):
            motions.goes_on(action.place, action.value, t, f"event {event.name!r}")


class Motions:
    r"""Prescribed motions of a run, with impulses where a rate jumps.

    Up to a jump the program has the course continued from before it, so that the steps that end there and
    their dense output are smooth. At the jump

    .. math:: J v^+ = s^+, \qquad W = \Lambda\, \tfrac12 (s^- + s^+)

    with the rates s of all motions and their work W; other constraints are kept
    (:class:`antenna_pin.run.simulation.mode_changes.ImpactSolver`).
    """

    def __init__(self, workspace: Workspace, adjustments: Adjustments) -> None:
        """Find the motions whose rate jumps, and the places of works in the state."""
        self._workspace, self._adjustments = workspace, adjustments
        acting = [one for one in acting_in(workspace.system) if isinstance(one.element, Motion)]
        self._labels = {one.place: one.label for one in acting}
        self._courses: list[_JumpCourse] = []
        for one in acting:
            if not isinstance(one.element, PrescribedMotion) or not one.element.edges:
                continue
            terms = np.array(one.element.follows.terms() if one.element.follows else ())
            first = one.block + int(kernels.PARAMETERS) + len(one.element.words_of_kernel())
            first -= len(one.element.tail()) - len(one.element.coefficients)
            jumps = [jump for jump in one.element.jumps if jump.time > 0.0]
            times, begins = ([getattr(jump, name) for jump in jumps] for name in ("time", "begin"))
            places = slice(first, first + len(terms))
            self._courses.append(_JumpCourse(places, terms, np.array(times), np.array(begins)))

    def is_one(self, place: str) -> bool:
        """Return whether an element, by its place, is a motion."""
        return place in self._labels

    # --- courses that jump ----------------------------------------------------------------------------------

    def renew(self, t: float) -> None:
        """Write the courses, each continued from before its next jump, into the program."""
        for places, terms, times, begins in self._courses:
            k = int(np.searchsorted(times, t, side="right"))
            self._workspace.program[places] = continued(terms, begins[k]) if k < len(times) else terms

    def whole(self) -> Array:
        """Return a copy of the program with whole courses, valid for samples at any time."""
        program = self._workspace.program.copy()
        for places, terms, _, _ in self._courses:
            program[places] = terms
        return program

    # --- numbers that are set -------------------------------------------------------------------------------

    def goes_on(self, place: str, value: float, t: float, who: str = "Set") -> dict[str, float]:
        """Return the numbers to set, by place, for a motion to continue from its position.

        Raises:
            InvalidParameterError: The position would jump, or the rate, where refused.
        """
        name, _, key = place.rpartition(".")
        motion = self._adjustments.elements[name]
        trial: dict[str, Any] = {key: value}
        assert isinstance(motion, Motion)
        found = parameters_of(type(motion)).get(key)
        if key not in motion.own_keys() and (found is None or found.sizes):
            return {place: value}  # refused where it is set
        if key == "rate" and isinstance(motion, PrescribedMotion):
            trial["offset"] = motion.offset + (motion.rate - value) * t
        changed = dataclasses.replace(motion, **trial)
        before, after = motion.at(t), changed.at(t)
        jump, unit = after[0] - before[0], self._unit(motion)
        size = sum(float(np.abs(getattr(one, "amplitude", 0.0)).sum()) for one in (motion, changed))
        if key != "rate" and abs(jump) > _ROUND_OFF * size:
            way = "set its rate, which continues from the present position, or "
            rule = (
                f"left as it is: the motion would jump; {way if isinstance(motion, PrescribedMotion) else ''}"
                "have a pd drive follow the course"
            )
            raise InvalidParameterError(who, place, rule, said=f"{number(jump)} {unit} at t = {t:.9g} s")
        if after[1] != before[1] and getattr(motion, "rate_jumps", "") == "refused":
            rule = "left as it is: the motion's rate would jump; take rate_jumps = 'impulse'"
            jump = after[1] - before[1]
            raise InvalidParameterError(who, place, rule, said=f"{number(jump)} {unit}/s at t = {t:.9g} s")
        return {f"{name}.{one}": float(number_of) for one, number_of in trial.items()}

    def _unit(self, motion: Motion) -> str:
        return "m" if self._workspace.system.slides(motion.joint) else "rad"


# --- motions given by functions -----------------------------------------------------------------------------

_HOLDS = 1e-6  # of the sizes of the terms: a piece on which both equations hold
_PIECES = 64  # at most, between two checks
_HALVINGS, _RESOLVED = 26, 6  # at most; halvings that resolve steep but smooth functions
_JUMP = 1e-7  # of the size of position or velocity: steps of single precision are none
_WRONG = 1e-2  # relative error beyond which a function is no derivative
_COURSE_ROUND_OFF = 1e-14  # of the functions' values
_FLOOR = 1e-15  # resolution of differences [rad, m, rad/s, m/s]


class _Point(NamedTuple):
    """Time [s], position [rad] or [m], rate and acceleration."""

    t: float
    p: float
    v: float
    a: float


class _CourseCheck:
    """Check of one motion, up to the time that the run has reached."""

    def __init__(self, label: str, unit: str, course: Callable[[float], tuple[float, float, float]]) -> None:
        self._label, self._unit, self._course = label, unit, course
        self._last: _Point | None = None

    def check(self, t: float, pieces: int) -> str:
        """Return the inconsistency found up to a time [s], as text; empty if none."""
        begin, self._last = self._last, self._at(t)
        if begin is None or t <= begin.t:
            return ""
        step = (t - begin.t) / pieces
        for k in range(1, pieces + 1):
            end = self._last if k == pieces else self._at(begin.t + step)
            text = "" if _lack(begin, end) <= _HOLDS else self._inconsistency(begin, end)
            if text:
                return f", {self._label}: {text}"
            begin = end
        return ""

    def _at(self, t: float) -> _Point:
        return _Point(t, *self._course(t))

    def _inconsistency(self, one: _Point, other: _Point) -> str:
        underived = ""
        for level in range(_HALVINGS):
            middle = self._at(0.5 * (one.t + other.t))
            if not one.t < middle.t < other.t:
                break
            halves = (one, middle), (middle, other)
            one, other = max(halves, key=lambda half: _lack(*half))
            if _lack(one, other) <= _HOLDS:
                return ""
            if level >= _RESOLVED:
                text = self._underived(one, other)
                underived = underived if text is None else text
        return self._jump(one, other) or underived

    def _jump(self, one: _Point, other: _Point) -> str:
        """Return the number that jumps on a vanishing piece, as text; empty if none."""
        h, place, speed = other.t - one.t, other.p - one.p, other.v - one.v
        largest, fastest = max(abs(one.p), abs(other.p)), max(abs(one.v), abs(other.v))
        most, when = max(abs(one.a), abs(other.a)), f"at t = {one.t:.9g} s"
        if abs(place) > _FLOOR + _JUMP * largest + 4.0 * h * fastest and self._stays(one, other, 1):
            jump = f"{number(place)} {self._unit}"
            return f"its position jumps by {jump} {when}: have a pd drive follow the course"
        if abs(speed) > _FLOOR + _JUMP * fastest + 4.0 * h * most and self._stays(one, other, 2):
            jump = f"{number(speed)} {self._unit}/s"
            way = "a PrescribedMotion that follows a reference takes that as an impulse"
            return f"its velocity jumps by {jump} {when}: {way}"
        return ""

    def _underived(self, one: _Point, other: _Point) -> str | None:
        """Return the function that is no derivative, as text; None if round-off hides it."""
        h, when = other.t - one.t, f"at t = {one.t:.9g} s"
        hidden = False
        for of, by, at, unit in (("position", "velocity", 1, "/s"), ("velocity", "acceleration", 2, "/s²")):
            value, rate = (one[at], other[at]), (one[at + 1], other[at + 1])
            slope, most = (value[1] - value[0]) / h, max(map(abs, rate))
            if (_JUMP * max(map(abs, value)) + _FLOOR) / h > _WRONG * max(most, abs(slope)):
                hidden = True
            elif abs(slope - 0.5 * sum(rate)) > 0.5 * abs(rate[1] - rate[0]) + _WRONG * most:
                told = f"{by} gives {number(rate[0])} {self._unit}{unit} {when}"
                return f"{told}, where {of} changes by {number(slope)} {self._unit}{unit}"
        return None if hidden else ""

    def _stays(self, one: _Point, other: _Point, which: int) -> bool:
        """Return whether a change is as large over a quarter of the piece."""
        step = 0.25 * (other.t - one.t)
        ends = [self._at(one.t + k * step)[which] for k in range(5)]
        return max(abs(b - a) for a, b in pairwise(ends)) > 0.5 * abs(other[which] - one[which])


def _lack(one: _Point, other: _Point) -> float:
    """Return the residual of the equations on a piece, relative to their terms."""
    h = other.t - one.t
    place, speed = other.p - one.p, other.v - one.v
    rates, rises = h * (abs(one.v) + abs(other.v)), h * (abs(one.a) + abs(other.a))
    change = 0.5 * h * (one.v + other.v) - h * h / 12.0 * (other.a - one.a)
    lack = abs(place - change) - _COURSE_ROUND_OFF * (abs(one.p) + abs(other.p)) - _FLOOR
    found = max(0.0, lack) / (rates + h * rises + abs(place) + _FLOOR)
    lack = abs(speed - 0.5 * h * (one.a + other.a)) - _COURSE_ROUND_OFF * (abs(one.v) + abs(other.v)) - _FLOOR
    return max(found, max(0.0, lack) / (rises + abs(speed) + _FLOOR))


class CourseChecks:
    r"""Consistency checks of the motions that a user's functions give.

    A motion holds its joint whatever the functions give: a jump of the position would move the joint without
    work, a jump of the velocity would do work that no ledger has. Over each piece of time h between checks

    .. math:: p_1 - p_0 = \tfrac h2 (v_0 + v_1) - \tfrac{h^2}{12} (a_1 - a_0) + O(h^5), \qquad
              v_1 - v_0 = \tfrac h2 (a_0 + a_1) + O(h^3)

    Where these equations do not hold, the worse half of the piece is halved until they hold or the jump is
    found.
    """

    def __init__(self, workspace: Workspace) -> None:
        """Begin without a check."""
        system = workspace.system
        self._courses = [
            _CourseCheck(one.label, "m" if system.slides(one.element.joint) else "rad", one.element.profile())
            for one in acting_in(system)
            if isinstance(one.element, CallableMotion)
        ]
        self._tried = 0

    def check(self, t: float, tried: int) -> str:
        """Return the inconsistency found up to a time [s], as text; empty if none."""
        if not self._courses:
            return ""
        pieces = min(max(tried - self._tried, 1), _PIECES)
        self._tried = tried
        return next((text for one in self._courses if (text := one.check(t, pieces))), "")


# --- singular positions -------------------------------------------------------------------------------------

# Relative to the largest share so far: a singular position, and a dip to be located.
_SINGULAR = 1e-3
_SUSPECT = 0.5
# The same for a state from which a run cannot continue: the share falls as the root of the path left.
_NEAR = 0.05
# Motion between two inspected states, relative to the share left: angles in rad, displacements in
# lengths of the mechanism. Shares are sines of angles between its parts: they miss no zero in that.
_STRIDE = 0.02
_REMEMBERED = ("most", "rank", "apart", "time", "way")
_AT_MOST = 100  # recorded positions, for a mechanism that stays singular


class SingularPosition(NamedTuple):
    """Position in which closures and motions lose an equation."""

    time: float  # time [s]
    share: float  # share left of the least independent equation, relative to the largest in this run [-]


class Singularities:
    """Search for singular positions: the share left of the least independent equation.

    Where the share (``FOUND.least``) passes zero, the loops may continue in several ways, and forces are not
    determined. A step may jump over the position, so that the share dips between two inspected states: it is
    also inspected between them, in a skipped state or on the cubic through both, and minimised where it dips.

    Args:
        workspace: Workspace of its own: the run's is not changed.
    """

    def __init__(self, workspace: Workspace) -> None:
        """Begin without a state."""
        self._workspace = workspace
        self._model = workspace.model
        self._last: list[tuple[float, Array, float]] = []
        self._most = 0.0
        self._rank = 0
        self._apart = True  # whether the path since the last position has left it
        constraints = workspace.constraints
        assert constraints is not None
        self._weights = np.ones(self._model.nv)
        for slot in workspace.system.mechanism.joints.values():
            self._weights[slot.ways] = 1.0 / constraints.plan.length
        self._passed: tuple[float, Array] | None = None  # last skipped state
        self._middle: tuple[float, Array] | None = None  # skipped state half way to the next inspected one
        self._time = self._way = 0.0
        self.found: list[SingularPosition] = []

    def inspect_along(self, times: Array, states: Array) -> None:
        """Inspect the path along states, (n,) [s] and (n, size)."""
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
            self._inspect(float(times[k]), states[k], self._middle)
            self._way, self._middle = 0.0, None
        self._time = float(times[-1])
        self._passed = (self._time, states[-1].copy()) if self._way > 0.0 else None

    # --- as a value -----------------------------------------------------------------------------------------

    def value(self) -> dict[str, Any]:
        """Return the data of the search, in lists and numbers."""
        return {
            "last": [(t, y.tolist(), share) for t, y, share in self._last],
            "passed": None if self._passed is None else (self._passed[0], self._passed[1].tolist()),
            "middle": None if self._middle is None else (self._middle[0], self._middle[1].tolist()),
            "found": [tuple(one) for one in self.found],
            **{name: getattr(self, f"_{name}") for name in _REMEMBERED},
        }

    def take_up(self, value: dict[str, Any]) -> None:
        """Continue from the data of another search."""
        self._last = [(t, np.array(y), share) for t, y, share in value["last"]]
        for name in ("passed", "middle"):
            one = value[name]
            setattr(self, f"_{name}", None if one is None else (one[0], np.array(one[1])))
        self.found = [SingularPosition(*one) for one in value["found"]]
        for name in _REMEMBERED:
            setattr(self, f"_{name}", value[name])

    def _inspect(self, t: float, y: Array, between: tuple[float, Array] | None = None) -> None:
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
    def nearly_lost(self) -> str:
        """Equation nearly lost in the last state, for a message; empty if none."""
        self.finish()
        if not self._last or not self._last[-1][2] < _NEAR * self._most:
            return ""
        t, y, _ = self._last[-1]
        self._share(t, y)
        assert self._workspace.constraints is not None
        return f", {least_row(self._workspace.constraints)}"

    def finish(self) -> None:
        """Inspect the last state, if it was skipped."""
        if self._passed is not None:
            self._inspect(*self._passed)
            self._passed, self._middle, self._way = None, None, 0.0

    def _share(self, t: float, y: Array) -> float:
        constraints = self._workspace.constraints
        assert constraints is not None
        self._workspace.prepare_motions(t, y)
        constraints.residuals(t, y, self._workspace.program)
        constraints.factorize(y[: self._model.nq])
        found = constraints.solution
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
        """Locate the least share between two states, and record it if it nearly vanishes."""
        theta, least = least_between(lambda theta: self._between(one, other, theta), 0.0, 1.0, absolute=1e-9)
        time, share = one[0] + theta * (other[0] - one[0]), least / self._most
        if not share < _SINGULAR:
            return
        # A place at the end of a step is found from both sides; short steps find several dips near it.
        if self.found and (not self._apart or abs(time - self.found[-1].time) <= other[0] - one[0]):
            self.found[-1] = min(self.found[-1], SingularPosition(time, share), key=lambda place: place.share)
        elif len(self.found) < _AT_MOST:
            self.found.append(SingularPosition(time, share))
        self._apart = False

    def text(self) -> str:
        """Return the singular positions passed, for the end of a message; empty if none."""
        self.finish()
        if not self.found:
            return ""
        times = ", ".join(f"{found.time:.6g}" for found in self.found[:3])
        more = f" and {len(self.found) - 3} more" if len(self.found) > 3 else ""
        place = "a singular position" if len(self.found) == 1 else "singular positions"
        return f"; passed {place} at t = {times}{more} s, where the motion of the loops is not unique"
