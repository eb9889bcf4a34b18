r"""Motions from a user's functions: whether position, velocity and acceleration belong together.

A motion holds its joint whatever the functions give: a position that jumps would move what hangs on it
without any work, a velocity that jumps would do work that no ledger has. Over each piece of time h between
two looks

.. math:: p_1 - p_0 = \tfrac h2 (v_0 + v_1) - \tfrac{h^2}{12} (a_1 - a_0) + O(h^5), \qquad
          v_1 - v_0 = \tfrac h2 (a_0 + a_1) + O(h^3)

and where these do not hold, the worse half of the piece is halved until they do or what jumps is found.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

from antenna_pin.base.readable import number
from antenna_pin.dynamics import Workspace, acting_in
from antenna_pin.elements import CallableMotion

__all__ = ["GivenCourses"]

_HOLDS = 1e-6  # of the sizes of the terms: a piece on which both equations hold
_PIECES = 64  # at most, from one look to the next
_HALVINGS, _RESOLVED = 26, 6  # at most; so many resolve what is only steep
_JUMP = 1e-7  # of the size of position or velocity: steps of single precision are none
_WRONG = 1e-2  # of a derivative: by what it is none
_ROUND_OFF = 1e-14  # of what functions give
_FLOOR = 1e-15  # below it nothing is told apart [rad, m, rad/s, m/s]


class _Point(NamedTuple):
    """Time [s], position [rad] or [m], its rate and its acceleration."""

    t: float
    p: float
    v: float
    a: float


class _Course:
    """One motion, looked at as far as the run has come."""

    def __init__(self, label: str, unit: str, course: Callable[[float], tuple[float, float, float]]) -> None:
        self._label, self._unit, self._course = label, unit, course
        self._last: _Point | None = None

    def look(self, t: float, pieces: int) -> str:
        """Return what is wrong up to a time [s], in words; empty if nothing."""
        begin, self._last = self._last, self._at(t)
        if begin is None or t <= begin.t:
            return ""
        step = (t - begin.t) / pieces
        for k in range(1, pieces + 1):
            end = self._last if k == pieces else self._at(begin.t + step)
            words = "" if _lack(begin, end) <= _HOLDS else self._found(begin, end)
            if words:
                return f", {self._label}: {words}"
            begin = end
        return ""

    def _at(self, t: float) -> _Point:
        return _Point(t, *self._course(t))

    def _found(self, one: _Point, other: _Point) -> str:
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
                words = self._underived(one, other)
                underived = underived if words is None else words
        return self._jump(one, other) or underived

    def _jump(self, one: _Point, other: _Point) -> str:
        """Return which number jumps on a piece that is next to nothing, in words; empty if none."""
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
        """Return which function is not the derivative of the other, in words; None if round-off hides it."""
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
        """Return whether a change, of position or of velocity, is as large over a quarter of the piece."""
        step = 0.25 * (other.t - one.t)
        ends = [self._at(one.t + k * step)[which] for k in range(5)]
        return max(abs(b - a) for a, b in pairwise(ends)) > 0.5 * abs(other[which] - one[which])


def _lack(one: _Point, other: _Point) -> float:
    """Return by how much the equations do not hold on a piece, over the sizes of their terms."""
    h = other.t - one.t
    place, speed = other.p - one.p, other.v - one.v
    rates, rises = h * (abs(one.v) + abs(other.v)), h * (abs(one.a) + abs(other.a))
    change = 0.5 * h * (one.v + other.v) - h * h / 12.0 * (other.a - one.a)
    lack = abs(place - change) - _ROUND_OFF * (abs(one.p) + abs(other.p)) - _FLOOR
    found = max(0.0, lack) / (rates + h * rises + abs(place) + _FLOOR)
    lack = abs(speed - 0.5 * h * (one.a + other.a)) - _ROUND_OFF * (abs(one.v) + abs(other.v)) - _FLOOR
    return max(found, max(0.0, lack) / (rises + abs(speed) + _FLOOR))


class GivenCourses:
    """The motions of a run that a user's functions give.

    Args:
        workspace: What the run works on.
    """

    def __init__(self, workspace: Workspace) -> None:
        """Begin without a look."""
        system = workspace.system
        self._courses = [
            _Course(one.label, "m" if system.slides(one.element.joint) else "rad", one.element.profile())
            for one in acting_in(system)
            if isinstance(one.element, CallableMotion)
        ]
        self._tried = 0

    def look(self, t: float, tried: int) -> str:
        """Return what is wrong up to a time [s] after so many steps, in words; empty if nothing."""
        if not self._courses:
            return ""
        pieces = min(max(tried - self._tried, 1), _PIECES)
        self._tried = tried
        return next((words for one in self._courses if (words := one.look(t, pieces))), "")
