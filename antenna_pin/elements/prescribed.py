"""Prescribed motions of joints: position, rate and acceleration as functions of time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, Literal

from antenna_pin.base.parameters import check, parameter
from antenna_pin.base.readable import GIVEN, number
from antenna_pin.elements.course import Course, Swing
from antenna_pin.elements.element import GROSS_WORK, WORK, Element, Integral
from antenna_pin.elements.reference import Reference
from antenna_pin.elements.term_jumps import TermJump, jumps
from antenna_pin.errors import InvalidParameterError

__all__ = ["CallableMotion", "DistanceMotion", "Motion", "PrescribedMotion"]

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
    r"""A joint's position as a function of time, to which the joint is held; the sum of what is given.

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

    def values(self) -> dict[str, Any]:
        """Return its numbers, by the names that its record has for them."""
        course = Course.values(self)
        return {"powers": len(self.coefficients), **course, "position": self.position + self.offset}

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

    def words(self, slides: bool) -> str:
        """Return what it is in words."""
        powers = [f"{number(c, GIVEN)} · t^{k}" for k, c in enumerate(self.coefficients, start=2) if c]
        return f"motion {self.course_words(slides, powers) or 'held at 0'}"


@dataclass(frozen=True, slots=True, kw_only=True)
class DistanceMotion(Swing, Motion):
    r"""A sliding joint held to the distance between a fixed point and one that moves along a path.

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

    def values(self) -> dict[str, Any]:
        """Return its numbers, by the names that its record has for them."""
        return {
            "centre": [a + b for a, b in zip(self.offset, self.mean, strict=True)],
            "speed": self.velocity,
            "amplitude": self.amplitude,
            "phase": self.phase,
            "angular_frequency": self.angular_frequency,
        }

    def words(self, slides: bool) -> str:
        """Return what it is in words."""
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
        """Whether kernels call its functions."""
        from antenna_pin.compiled.given_functions import is_compiled

        return is_compiled(self.position, self.velocity, self.acceleration)

    @property
    def in_python(self) -> bool:  # type: ignore[override]
        """Whether Python calls its functions, before each evaluation."""
        return not self.called

    def values(self) -> dict[str, Any]:
        """Return its numbers; those of plain functions are written before each evaluation."""
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

    def given(
        self, functions: Sequence[Callable[..., float]], t: float, angle: float, rate: float
    ) -> tuple[float, ...]:
        """Return the numbers of its record at time t [s]."""
        return (*(function(t) for function in functions), 0.0, 0.0, 0.0)

    def profile(self) -> Callable[[float], tuple[float, float, float]]:
        """Return position, rate and acceleration as a function of time."""
        position, velocity, acceleration = self.asked(f"motion of joint {self.joint!r}", False)
        return lambda t: (position(t), velocity(t), acceleration(t))

    def words(self, slides: bool) -> str:
        """Return what it is in words."""
        return "motion: compiled functions" if self.called else "motion: functions in Python"
