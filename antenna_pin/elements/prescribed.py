"""Prescribed motions of joints: position, rate and acceleration as functions of time."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.parameters import check, parameter
from antenna_pin.base.readable import GIVEN, number
from antenna_pin.base.records import words_of
from antenna_pin.elements import term_kernels as kernels
from antenna_pin.elements.course import Course, Swing
from antenna_pin.elements.element import GROSS_WORK, WORK, Element, Integral
from antenna_pin.elements.reference import Reference
from antenna_pin.errors import InvalidParameterError

__all__ = [
    "CallableMotion",
    "continued",
    "DistanceMotion",
    "jumps",
    "Motion",
    "PrescribedMotion",
    "TermJump",
]

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

Numbers3 = tuple[float, float, float]


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
        motion, words = self.compiled().motion, self.words_of_kernel()
        return lambda t: motion(words, 0, t)


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
        rate_jumps: What a jump of the rate is, by the reference or by a number that is set: an ``impulse`` of
            the motion, whose work is the drive's, or ``refused``. A jump of the position is always refused.
        offset: By how much events that set the rate have moved phi_0, so that the motion goes on from where
            it is [rad] ([m]).
    """

    kernels: ClassVar[str] = "motion_kernels"
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

    def derived(self) -> dict[str, Any]:
        """Return the packed parameters that are no fields of the element."""
        own = {"powers": len(self.coefficients), "position": self.position + self.offset}
        return own | Course.derived(self)

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


@dataclass(frozen=True, slots=True, kw_only=True)
class DistanceMotion(Swing, Motion):
    r"""A sliding joint held to the distance of a fixed and a moving point.

    That is the length of a leg from a base joint to a joint of a platform that moves without turning:

    .. math:: h(t) = | r + s + u t + A \sin(2 \pi f t + \varphi) |

    with a sine for each component, and with its exact derivatives.

    Attributes:
        offset: r, from the fixed point to the moving one while the path is at its origin, (3,) [m].
        mean: s, of the path, (3,) [m].
        velocity: u, of the path, (3,) [m/s].
        amplitude: A, of the path's swing along each axis, (3,) [m].
        frequency: f, of the path's swing [Hz]; None where nothing swings.
        phase: varphi, of each component at t = 0, (3,) [rad].
    """

    kernels: ClassVar[str] = "distance_kernels"

    offset: Numbers3 = parameter("m", sizes=(3,))
    mean: Numbers3 = parameter("m", sizes=(3,), default=(0.0, 0.0, 0.0))
    velocity: Numbers3 = parameter("m/s", sizes=(3,), default=(0.0, 0.0, 0.0))
    amplitude: Numbers3 = parameter("m", sizes=(3,), default=(0.0, 0.0, 0.0))
    frequency: float | None = parameter("Hz", rule="positive", default=None)
    phase: Numbers3 = parameter("rad", sizes=(3,), default=(0.0, 0.0, 0.0))

    def __post_init__(self) -> None:
        """Check the parts."""
        check(self)
        self.check_frequency(any(self.amplitude))

    def check_joint(self, place: str, slides: bool) -> None:
        """Refuse a joint that turns."""
        if not slides:
            raise InvalidParameterError(place, "joint", "one that slides: it follows a distance", self.joint)

    def derived(self) -> dict[str, Any]:
        """Return the packed parameters that are no fields of the element."""
        centre = [a + b for a, b in zip(self.offset, self.mean, strict=True)]
        return {"centre": centre, "speed": self.velocity}

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        swing = "" if self.frequency is None else f" that swings at {number(self.frequency, GIVEN)} Hz"
        return f"motion: distance to a point on a path{swing}"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CallableMotion(Motion):
    """A joint's position from functions of time; slower than the others unless all are compiled.

    They must answer equal questions equally, as a :class:`CallableDrive` must.

    Attributes:
        position: ``t [s] -> [rad]`` ([m]).
        velocity: Its exact first derivative [rad/s] ([m/s]).
        acceleration: Its exact second derivative [rad/s^2] ([m/s^2]).
    """

    kernels: ClassVar[str] = "given_motion_kernels"

    position: Callable[[float], float]
    velocity: Callable[[float], float]
    acceleration: Callable[[float], float]

    @property
    def called(self) -> bool:
        """Return whether kernels call the functions."""
        from antenna_pin.compiled.given_functions import is_compiled

        return is_compiled(self.position, self.velocity, self.acceleration)

    @property
    def in_python(self) -> bool:  # type: ignore[override]
        """Return whether Python calls the functions, before each evaluation."""
        return not self.called

    def derived(self) -> dict[str, Any]:
        """Return the packed parameters; those of plain functions are written before each evaluation."""
        numbers = {"position": 0.0, "rate": 0.0, "acceleration": 0.0}
        if not self.called:
            return {**numbers, "first": 0.0, "second": 0.0, "third": 0.0}
        from antenna_pin.compiled.given_functions import address_of

        functions = zip(("first", "second", "third"), ("position", "velocity", "acceleration"), strict=True)
        place = type(self).__name__
        return numbers | {one: address_of(place, name, getattr(self, name), 1) for one, name in functions}

    @property
    def functions(self) -> tuple[tuple[str, Callable[..., float], int], ...]:
        """Its three functions, of time."""
        return tuple((name, getattr(self, name), 1) for name in ("position", "velocity", "acceleration"))

    def record_numbers(
        self, functions: Sequence[Callable[..., float]], t: float, angle: float, rate: float
    ) -> tuple[float, ...]:
        """Return the numbers of its record at time t [s]."""
        return (*(function(t) for function in functions), 0.0, 0.0, 0.0)

    def profile(self) -> Callable[[float], tuple[float, float, float]]:
        """Return position, rate and acceleration as a function of time."""
        position, velocity, acceleration = self.callbacks(f"motion of joint {self.joint!r}", False)
        return lambda t: (position(t), velocity(t), acceleration(t))

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        return "motion: compiled functions" if self.called else "motion: functions in Python"
