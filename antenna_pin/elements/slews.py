"""Slews: from one value to another, from rest to rest, within limits."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from antenna_pin.base.parameters import parameter
from antenna_pin.elements import term_kernels as kernels
from antenna_pin.elements.reference import Reference, pieces, term


@dataclass(frozen=True, slots=True, kw_only=True)
class Slew(Reference):
    """Base of the slews: from one value to another, from rest to rest.

    Attributes:
        begin: Value before it [rad] ([m]).
        end: Value behind it, held from then on [rad] ([m]).
        start: Begin [s].
    """

    begin: float = parameter("rad", sliding="m", default=0.0)
    end: float = parameter("rad", sliding="m")
    start: float = parameter("s", default=0.0)

    @property
    def way(self) -> float:
        """From its begin to its end, with its sign."""
        return self.end - self.begin

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return sum(span for span, _ in self.phases())

    @property
    def instants(self) -> tuple[float, ...]:
        """Times at which a derivative jumps [s]."""
        found, t = [self.start], self.start
        for span, _ in self.phases():
            t += span
            found.append(t)
        return tuple(found)

    def phases(self) -> list[tuple[float, float]]:
        """Return duration [s] and highest nonzero derivative of each part, without sign.

        The derivative is the acceleration, or with a jerk the jerk.
        """
        raise NotImplementedError

    def _pieces(self, order: int) -> tuple[float, ...]:
        """Return parts with a constant derivative of an order (2 or 3)."""
        sign, t = math.copysign(1.0, self.way), self.start
        state = [self.begin, 0.0, 0.0]
        times, rows = [t], []
        for span, highest in self.phases():
            own = [state[0], state[1], (sign * highest if order == 2 else state[2]) / 2.0]
            if order == 3:
                own.append(sign * highest / 6.0)
            rows.append(own)
            value = rate = acceleration = 0.0
            for coefficient in reversed(own):
                acceleration = acceleration * span + 2.0 * rate
                rate, value = rate * span + value, value * span + coefficient
            state = [value, rate, acceleration]
            t += span
            times.append(t)
        # Held from there on, exactly where it is to end.
        return pieces([*times, math.inf], [*rows, [self.end]])

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        when = f" at {self.text_of('start', slides)}" if self.start else ""
        return f"{self._kind()} from {self.text_of('begin', slides)} to {self.text_of('end', slides)}{when}"

    def _kind(self) -> str:
        raise NotImplementedError


@dataclass(frozen=True, slots=True, kw_only=True)
class Trapezoid(Slew):
    """A slew with a trapezoidal rate; a triangle where the angle is too small.

    Attributes:
        rate: Largest rate [rad/s] ([m/s]).
        acceleration: In its first part [rad/s^2] ([m/s^2]).
        deceleration: In its last part; that of the first if not given [rad/s^2] ([m/s^2]).
    """

    rate: float = parameter("rad/s", sliding="m/s", rule="positive")
    acceleration: float = parameter("rad/s^2", sliding="m/s^2", rule="positive")
    deceleration: float | None = parameter("rad/s^2", sliding="m/s^2", rule="positive", default=None)

    def phases(self) -> list[tuple[float, float]]:
        """Return duration [s] and acceleration of each part."""
        way, up = abs(self.way), self.acceleration
        down = up if self.deceleration is None else self.deceleration
        fastest = min(self.rate, math.sqrt(2.0 * way * up * down / (up + down)))
        if fastest == 0.0:
            return []
        cruise = (way - 0.5 * fastest**2 * (1.0 / up + 1.0 / down)) / fastest
        parts = [(fastest / up, up), (max(cruise, 0.0), 0.0), (fastest / down, -down)]
        return [part for part in parts if part[0] > 0.0]

    def terms(self) -> tuple[float, ...]:
        """Return it for kernels."""
        return self._pieces(2)

    def _kind(self) -> str:
        return "a trapezoidal slew"


@dataclass(frozen=True, slots=True, kw_only=True)
class SCurve(Slew):
    """A slew with a limited jerk, of up to seven parts.

    Attributes:
        rate: Largest rate [rad/s] ([m/s]).
        acceleration: Largest acceleration, both ways [rad/s^2] ([m/s^2]).
        jerk: Largest rate of the acceleration [rad/s^3] ([m/s^3]).
    """

    rate: float = parameter("rad/s", sliding="m/s", rule="positive")
    acceleration: float = parameter("rad/s^2", sliding="m/s^2", rule="positive")
    jerk: float = parameter("rad/s^3", sliding="m/s^3", rule="positive")

    def phases(self) -> list[tuple[float, float]]:
        """Return duration [s] and jerk of each part.

        With ``j`` for the time in which the acceleration is built up, and ``a`` for that of the whole
        speeding up, to a rate ``v = jerk j (a - j)``, half the way of a slew without cruise is ``v a / 2``.
        """
        way, v, a_max, jerk = abs(self.way), self.rate, self.acceleration, self.jerk
        if way == 0.0:
            return []
        build = min(a_max / jerk, math.sqrt(v / jerk))
        speed_up = build + v / (jerk * build)
        if way < v * speed_up:  # the rate is not reached
            build = min(a_max / jerk, (0.5 * way / jerk) ** (1.0 / 3.0))
            # jerk build (a - build) a = way
            speed_up = 0.5 * (build + math.sqrt(build**2 + 4.0 * way / (jerk * build)))
            v = jerk * build * (speed_up - build)
        level, cruise = speed_up - 2.0 * build, way / v - speed_up
        up = [(build, jerk), (level, 0.0), (build, -jerk)]
        down = [(build, -jerk), (level, 0.0), (build, jerk)]
        least = 1e-14 * speed_up  # round-off of a part that is not there
        return [part for part in (*up, (cruise, 0.0), *down) if part[0] > least]

    def terms(self) -> tuple[float, ...]:
        """Return it for kernels."""
        return self._pieces(3)

    def _kind(self) -> str:
        return "an S-curve slew"


# Coefficients of s^0, s^1, ... of the unit slews that are polynomials; s is the share of the time.
_SHAPES = {
    "cubic": (0.0, 0.0, 3.0, -2.0),
    "quintic": (0.0, 0.0, 0.0, 10.0, -15.0, 6.0),
    "septic": (0.0, 0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class RestToRest(Slew):
    r"""A slew of given duration: a polynomial or a cycloid.

    The cycloid is :math:`s - \sin(2 \pi s) / 2 \pi`.

    At both ends the rate is zero, of all but ``cubic`` the acceleration too, of ``septic`` also the jerk.

    Attributes:
        duration: Duration [s].
        shape: Shape of the course.
    """

    duration: float = parameter("s", rule="positive")
    shape: Literal["cubic", "quintic", "septic", "cycloid"] = "quintic"

    @property
    def instants(self) -> tuple[float, ...]:
        """Its ends, and quarters between them [s]."""
        return tuple(self.start + 0.25 * k * self.duration for k in range(5))

    def terms(self) -> tuple[float, ...]:
        """Return it for kernels."""
        if self.shape == "cycloid":
            own = term(kernels.CYCLOID, begin=self.start, span=self.duration, amount=self.way)
            return (*pieces([self.start, math.inf], [[self.begin]]), *own)
        unit = [self.way * c / self.duration**k for k, c in enumerate(_SHAPES[self.shape])]
        times = [self.start, self.start + self.duration, math.inf]
        return pieces(times, [[self.begin + unit[0], *unit[1:]], [self.end]])

    def _kind(self) -> str:
        return f"a {self.shape} slew of {self.text_of('duration', False)}"
