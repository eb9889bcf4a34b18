"""Prescribed motions of joints: position, rate and acceleration as functions of time."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.parameters import check, parameter
from antenna_pin.base.readable import GIVEN, number
from antenna_pin.base.records import Floats, words_of
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements import term_kernels as kernels
from antenna_pin.elements.course import Course
from antenna_pin.elements.element import GROSS_WORK, WORK, Element, Integral, packed
from antenna_pin.elements.reference import Reference

# --- jumps of courses ---------------------------------------------------------------------------------------
#
# The terms are those of :mod:`antenna_pin.elements.term_kernels`. Only pieces of polynomials and swept sines
# can jump, where one piece ends and the next begins.

Array = NDArray[np.float64]

# Of the size of the numbers that make up a value or a rate: a difference that is round-off.
_ROUND_OFF = 1e-9
# Times that are nearer than that are one: sums of a start and a duration, written down apart.
_ULPS = 8
_SWEPT_WORDS = words_of(kernels.SWEPT_PIECE)


class TermJump(NamedTuple):
    """A jump of a course.

    Attributes:
        time: When; of a course that comes again, the first time [s].
        begin: The same, or earlier by the round-off of times where several pieces end and begin [s].
        value: By how much the value jumps [rad] ([m]).
        rate: By how much the rate jumps [rad/s] ([m/s]).
        again: After what time it comes again [s]; 0: never.
    """

    time: float
    begin: float
    value: float
    rate: float
    again: float


@lru_cache(maxsize=8)
def jumps(terms: tuple[float, ...]) -> tuple[TermJump, ...]:
    """Return the jumps of a sum of terms beyond round-off, in order of time.

    Args:
        terms: As :meth:`antenna_pin.elements.reference.Reference.terms` returns them.
    """
    words = np.array(terms, dtype=float)
    parts: list[Array] = [np.zeros((6, 0))]
    for own, record in _terms(words):
        if record["kind"] == kernels.PIECES:
            rows = _between_pieces(own, record)
            parts.append(np.vstack([np.full(rows.shape[1], record["span"]), rows]))
        elif record["kind"] == kernels.SWEPT:
            rows = _between_sweeps(own)
            parts.append(np.vstack([np.zeros(rows.shape[1]), rows]))
    found = np.hstack(parts)
    found = found[:, np.lexsort((found[1], found[0]))]
    if not found.size:
        return ()
    again, time = found[:2]
    new = (np.diff(again) != 0.0) | (np.diff(time) > _ULPS * np.spacing(np.abs(time[1:])))
    firsts = np.flatnonzero(np.append(True, new))
    lasts = np.append(firsts[1:], found.shape[1]) - 1
    value, rate, size, speed = np.add.reduceat(found[2:], firsts, axis=1)
    value = np.where(np.abs(value) > _ROUND_OFF * size, value, 0.0)
    rate = np.where(np.abs(rate) > _ROUND_OFF * speed, rate, 0.0)
    rows = np.array([time[lasts], time[firsts], value, rate, again[firsts]])
    return tuple(sorted(TermJump(*row) for row in rows[:, (value != 0.0) | (rate != 0.0)].T.tolist()))


def continued(terms: ArrayLike, until: float) -> Array:
    """Return terms of a course that continues smoothly from a time on [s], (words,)."""
    words = np.array(terms, dtype=float)
    for own, record in _terms(words):
        n = int(record["count"])
        if record["kind"] == kernels.PIECES and record["span"] == 0.0:
            times, rows = _pieces(own, record)
            if times[0] >= until:  # not yet begun: it stands at its first value
                rows[0, 1:] = 0.0
                times[1:] = math.inf
            times[1:][times[1:] >= until] = math.inf
        elif record["kind"] == kernels.SWEPT:
            pieces = own[kernels.SIZE :][: n * _SWEPT_WORDS].view(kernels.SWEPT_PIECE)
            starts = pieces["start"][1:]
            starts[starts >= until] = math.inf
    return words


def _terms(words: Array) -> Iterator[tuple[Array, Any]]:
    """Yield the words of each term, a view, with its record."""
    at = 0
    while at < len(words):
        record = words[at : at + kernels.SIZE].view(kernels.TERM)[0]
        yield words[at : at + int(record["length"])], record
        at += int(record["length"])


def _pieces(own: Array, record: Any) -> tuple[Array, Array]:
    """Return times and coefficients of pieces of polynomials, as views."""
    n, powers = int(record["count"]), int(record["powers"])
    times = own[kernels.SIZE :][: n + 1]
    return times, own[kernels.SIZE + n + 1 :][: n * powers].reshape(n, powers)


def _between_pieces(own: Array, record: Any) -> Array:
    """Return time, jumps and sizes at all ends of pieces, (5, ends)."""
    times, rows = _pieces(own, record)
    n, powers = rows.shape
    ends = np.isfinite(times[1:])
    lengths = np.where(ends, times[1:], times[:-1]) - times[:-1]
    k = np.arange(powers)
    reached = rows * lengths[:, None] ** k
    faster = rows[:, 1:] * k[1:] * lengths[:, None] ** k[:-1]
    slope = rows[:, 1] if powers > 1 else np.zeros(n)
    # Before the first piece and behind the last the value is held.
    before = np.array([[rows[0, 0], *reached.sum(axis=1)], [0.0, *faster.sum(axis=1)]])
    behind = np.array([[*rows[:, 0], reached[-1].sum()], [*slope, 0.0]])
    sizes = np.array([np.abs(reached).sum(axis=1), np.abs(faster).sum(axis=1)])
    around = np.maximum(np.insert(sizes, 0, 0.0, axis=1), np.append(sizes, np.zeros((2, 1)), axis=1))
    around = np.maximum(around, np.abs(behind))
    kept = np.append(True, ends)
    if record["span"] > 0.0:  # the first piece follows the last
        behind[:, -1] = behind[:, 0]
        around[:, -1] = np.maximum(around[:, -1], around[:, 0])
        kept[0] = False
    return np.vstack([times, behind - before, around])[:, kept]


def _between_sweeps(own: Array) -> Array:
    """Return the same of a swept sine, between its pieces."""
    own = own.copy()
    pieces = own[kernels.SIZE :].view(kernels.SWEPT_PIECE)
    times = pieces["start"][1:].copy()
    found = np.zeros((5, len(times)))
    for k, time in enumerate(times.tolist()):
        sides = []
        for j in (k, k + 1):
            one = np.concatenate([own[: kernels.SIZE], pieces[j : j + 1].view(np.float64)])
            head: Any = one[: kernels.SIZE].view(kernels.TERM)
            head["length"], head["count"] = len(one), 1
            sides.append(kernels.course(one, 0, len(one), time))
        height = [abs(float(pieces[j]["height"])) / _power(pieces[j], time) for j in (k, k + 1)]
        speed = [h * _omega(pieces[j], time) for h, j in zip(height, (k, k + 1), strict=True)]
        found[:, k] = time, sides[1][0] - sides[0][0], sides[1][1] - sides[0][1], max(height), max(speed)
    return found


def _omega(piece: Any, time: float) -> float:
    """Return the angular frequency of a piece of a swept sine at a time [rad/s]."""
    s = time - float(piece["start"])
    if piece["octaves"]:
        return float(piece["begin"] * math.exp(piece["growth"] * s))
    return float(piece["begin"] + piece["growth"] * s)


def _power(piece: Any, time: float) -> float:
    return float(_omega(piece, time) ** piece["power"]) if piece["power"] else 1.0


# --- prescribed motions -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion(Element):
    """Base of the motions that a joint is made to follow, exactly.

    What holds it there is a force of constraint, which stands among the drives' in a result, with its work.
    """

    integrals: ClassVar[tuple[Integral, ...]] = (WORK, GROSS_WORK)

    def at(self, t: float) -> tuple[float, float, float]:
        """Return position, rate and acceleration at time t [s]."""
        return self.profile()(t)

    def profile(self) -> Callable[[float], tuple[float, float, float]]:
        """Return position, rate and acceleration as a function of time, for many times."""
        return self.own_kernel("motion")


@dataclass(frozen=True, slots=True, kw_only=True)
class PrescribedMotion(Course, Motion):
    r"""A joint's position as a function of time, the sum of its parts.

    .. math::

        \phi(t) = \phi_0 + \omega t + \sum_k c_k t^{k + 2} + A \sin(2 \pi f t + \varphi) + \text{table}(t)
            + \text{reference}(t)

    Attributes:
        follows: A reference, such as a slew; None for none.
        position: Constant part, phi_0 [rad] ([m]).
        rate: Of the part that grows with time, omega [rad/s] ([m/s]).
        coefficients: Of t^2, t^3 and so on, c_k, in SI units [rad/s^2, ...] ([m/s^2, ...]).
        amplitude: Of the part that swings, A [rad] ([m]).
        frequency: Of the part that swings, f [Hz]; None where nothing swings.
        phase: Of the part that swings, varphi, at t = 0 [rad].
        file: Where the part that is a table came from, relative to the scenario's folder; None if there is no
            such part, or it is given as numbers.
        time: Of the table, strictly increasing, at least two [s]. A run must lie within them.
        positions: Of the table, joined by cubics of continuous second derivative [rad] ([m]).
        rate_jumps: A jump of the rate, by the reference or by a number that is set: an ``impulse`` of
            the motion, whose work is the drive's, or ``refused``. A jump of the position is always refused.
        offset: Displacement of phi_0 by events that set the rate, so that the motion continues from its
            position [rad] ([m]).
    """

    kernels: ClassVar[str] = __name__
    constant: ClassVar[str] = "position"
    columns: ClassVar[tuple[str, str]] = ("time", "positions")
    joined: ClassVar[Literal["smooth"]] = "smooth"

    follows: Reference | None = None
    position: float = parameter("rad", sliding="m", default=0.0)
    rate: float = parameter("rad/s", sliding="m/s", default=0.0)
    coefficients: tuple[float, ...] = parameter("1", sizes=(0,), default=())
    amplitude: float = parameter("rad", sliding="m", default=0.0)
    frequency: float | None = parameter("Hz", rule="positive", default=None)
    phase: float = parameter("rad", default=0.0)
    file: str | None = None
    time: tuple[float, ...] | None = parameter("s", sizes=(0,), default=None, repr=False)
    positions: tuple[float, ...] | None = parameter("rad", sliding="m", sizes=(0,), default=None, repr=False)
    rate_jumps: Literal["impulse", "refused"] = "impulse"
    offset: float = field(default=0.0, repr=False)

    def __post_init__(self) -> None:
        """Check the parts."""
        check(self)
        self.check_course()

    @packed
    def powers(self) -> int:
        """Number of coefficients of the polynomial."""
        return len(self.coefficients)

    def tail(self) -> tuple[float, ...]:
        """Return the polynomial's coefficients, and the terms of what it follows and of the table."""
        return (*self.coefficients, *Course.tail(self))

    @property
    def jumps(self) -> tuple[TermJump, ...]:
        """Jumps of what it follows, in the order of time."""
        return () if self.follows is None else jumps(self.follows.terms())

    @property
    def edges(self) -> tuple[float, ...]:
        """Times at which its rate jumps, later than zero [s]."""
        return tuple(sorted({one.time for one in self.jumps if one.time > 0.0}))

    @classmethod
    def own_keys(cls) -> tuple[str, ...]:
        """Return the field that events write."""
        return ("offset",)

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        powers = [f"{number(c, GIVEN)} · t^{k}" for k, c in enumerate(self.coefficients, start=2) if c]
        return f"motion {self.course_words(slides, powers) or 'held at 0'}"


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def motion(m: PrescribedMotion, tail: Floats, t: float) -> tuple[float, float, float]:
    """Position, its rate and its acceleration at time t [s]."""
    turned = m.angular_frequency * t + m.phase
    sine, cosine = m.amplitude * math.sin(turned), m.amplitude * math.cos(turned)
    value = slope = bend = 0.0
    for k in range(m.powers - 1, -1, -1):
        # Horner's rule for the polynomial of t that stands behind t^2, with its first two derivatives.
        bend = bend * t + 2.0 * slope
        slope = slope * t + value
        value = value * t + tail[k]
    position = m.position + m.offset + m.rate * t + value * t * t + sine
    rate = m.rate + (slope * t + 2.0 * value) * t + m.angular_frequency * cosine
    acceleration = (bend * t + 4.0 * slope) * t + 2.0 * value - m.angular_frequency**2 * sine
    if m.course_length > 0:
        own = kernels.course(tail, m.powers, m.powers + m.course_length, t)
        position += own[0]
        rate += own[1]
        acceleration += own[2]
    return position, rate, acceleration
