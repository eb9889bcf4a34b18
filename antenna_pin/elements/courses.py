"""References by formulas: constant, ramp, polynomial, sine, chirp, sum of sines."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from antenna_pin.base.parameters import check, parameter
from antenna_pin.base.readable import GIVEN, number
from antenna_pin.elements import term_kernels as kernels
from antenna_pin.elements.curve import SweptPiece, check_as_many
from antenna_pin.elements.reference import Reference, pieces, swept, term
from antenna_pin.errors import InvalidParameterError

_TURN = 2.0 * math.pi


@dataclass(frozen=True, slots=True, kw_only=True)
class Constant(Reference):
    """A value that stays.

    Attributes:
        value: [rad] ([m]).
    """

    value: float = parameter("rad", sliding="m")

    def terms(self) -> tuple[float, ...]:
        """Return it for kernels."""
        return pieces([0.0, math.inf], [[self.value]])

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        return self.text_of("value", slides)


@dataclass(frozen=True, slots=True, kw_only=True)
class Ramp(Reference):
    """A value that grows at a constant rate from a time on.

    Its rate jumps where it starts and ends: an impulse of a motion that follows it.

    Attributes:
        begin: Value before it [rad] ([m]).
        rate: [rad/s] ([m/s]).
        start: Begin [s].
        duration: Duration of the growth [s]; unlimited if not given.
    """

    begin: float = parameter("rad", sliding="m", default=0.0)
    rate: float = parameter("rad/s", sliding="m/s")
    start: float = parameter("s", default=0.0)
    duration: float | None = parameter("s", rule="positive", default=None)

    @property
    def instants(self) -> tuple[float, ...]:
        """Begin and end of the ramp [s]."""
        return (self.start,) if self.duration is None else (self.start, self.start + self.duration)

    def terms(self) -> tuple[float, ...]:
        """Return it for kernels."""
        grows = [self.begin, self.rate]
        if self.duration is None:
            return pieces([self.start, math.inf], [grows])
        times = [self.start, self.start + self.duration, math.inf]
        return pieces(times, [grows, [self.begin + self.rate * self.duration]])

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        until = "" if self.duration is None else f" for {self.text_of('duration', slides)}"
        when = f" from {self.text_of('start', slides)} on" if self.start else ""
        return f"{self.text_of('begin', slides)} + a ramp of {self.text_of('rate', slides)}{when}{until}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Polynomial(Reference):
    """A polynomial of the time since ``start``.

    Attributes:
        coefficients: Of the powers 0, 1, 2 and so on, up to eight, in SI units [rad, rad/s, ...] ([m, ...]).
        start: Begin; before, its first value holds [s].
    """

    coefficients: tuple[float, ...] = parameter("1", sizes=(0,))
    start: float = parameter("s", default=0.0)

    def __post_init__(self) -> None:
        """Check how many there are."""
        check(self)
        if not 1 <= len(self.coefficients) <= kernels.POWERS:
            rule = f"1 to {kernels.POWERS} numbers"
            raise InvalidParameterError(self, "coefficients", rule, said=f"{len(self.coefficients)}")

    @property
    def instants(self) -> tuple[float, ...]:
        """Begin of the course [s]."""
        return (self.start,)

    def terms(self) -> tuple[float, ...]:
        """Return it for kernels."""
        return pieces([self.start, math.inf], [self.coefficients])

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        parts = [
            f"{number(c, GIVEN)}{f' · t^{k}' if k else ''}" for k, c in enumerate(self.coefficients) if c
        ]
        return " + ".join(parts) or "0"


@dataclass(frozen=True, slots=True, kw_only=True)
class Sine(Reference):
    """``mean + amplitude sin(2 pi frequency t + phase)``.

    Attributes:
        mean: [rad] ([m]).
        amplitude: [rad] ([m]).
        frequency: [Hz].
        phase: At t = 0 [rad].
    """

    mean: float = parameter("rad", sliding="m", default=0.0)
    amplitude: float = parameter("rad", sliding="m")
    frequency: float = parameter("Hz", rule="positive")
    phase: float = parameter("rad", default=0.0)

    @property
    def longest_step(self) -> float:
        """An eighth of the period [s]."""
        return 0.125 / self.frequency

    def terms(self) -> tuple[float, ...]:
        """Return it for kernels."""
        own = term(kernels.SINE, amount=self.amplitude, omega=_TURN * self.frequency, phase=self.phase)
        return (*pieces([0.0, math.inf], [[self.mean]]), *own) if self.mean else own

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        mean = f"{self.text_of('mean', slides)} + " if self.mean else ""
        return f"{mean}a sine of {self.text_of('amplitude', slides)} at {self.text_of('frequency', slides)}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Chirp(Reference):
    r"""A sine of swept frequency; its phase is the exact integral of 2 pi f.

    .. math:: f = f_0 + (f_1 - f_0) s / T \quad\text{or}\quad f = f_0 (f_1 / f_0)^{s / T}

    with s the time since ``start``. Before, it has its first value; afterwards, it continues at ``last``.

    Attributes:
        mean: [rad] ([m]).
        amplitude: [rad] ([m]).
        first: Frequency it begins with, f_0 [Hz].
        last: Frequency it ends with, f_1 [Hz].
        duration: Duration, T [s].
        spacing: By equal steps, or by equal factors (octaves a minute).
        start: Begin [s].
        phase: Of the sine at its begin [rad].
    """

    mean: float = parameter("rad", sliding="m", default=0.0)
    amplitude: float = parameter("rad", sliding="m")
    first: float = parameter("Hz", rule="positive")
    last: float = parameter("Hz", rule="positive")
    duration: float = parameter("s", rule="positive")
    spacing: Literal["linear", "logarithmic"] = "linear"
    start: float = parameter("s", default=0.0)
    phase: float = parameter("rad", default=0.0)

    @property
    def octaves_a_minute(self) -> float:
        """Mean rate of growth of the frequency [1/min]."""
        return 60.0 * math.log2(self.last / self.first) / self.duration

    @property
    def instants(self) -> tuple[float, ...]:
        """Begin and end of the sweep [s]."""
        return self.start, self.start + self.duration

    @property
    def longest_step(self) -> float:
        """An eighth of the shortest period [s]."""
        return 0.125 / max(self.first, self.last)

    def terms(self) -> tuple[float, ...]:
        """Return it for kernels."""
        # By factors of one the frequency stays, as it does by steps of none.
        linear = self.spacing == "linear" or self.last == self.first
        growth = (
            _TURN * (self.last - self.first) / self.duration
            if linear
            else math.log(self.last / self.first) / self.duration
        )
        size = (self.amplitude, 0)
        goes = SweptPiece(self.start, _TURN * self.first, growth, int(not linear), self.phase, *size)
        end = self.start + self.duration
        omega, phase = (float(of(end)) for of in (goes.omega, goes.turned))
        own = swept(
            (
                SweptPiece(self.start, 0.0, 0.0, 0, self.phase, *size),
                goes,
                SweptPiece(end, omega, 0.0, 0, phase, *size),
            )
        )
        return (*pieces([0.0, math.inf], [[self.mean]]), *own) if self.mean else own

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        ends = f"{self.text_of('first', slides)} to {self.text_of('last', slides)}"
        return (
            f"a {self.spacing} chirp of {self.text_of('amplitude', slides)} from {ends} in "
            f"{self.text_of('duration', slides)}"
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Sines(Reference):
    """A sum of many sines, as of a random vibration.

    Attributes:
        amplitudes: In SI units [rad] ([m]).
        frequencies: One for each [Hz].
        phases: One for each, at t = 0 [rad].
    """

    amplitudes: tuple[float, ...] = parameter("rad", sliding="m", sizes=(0,), repr=False)
    frequencies: tuple[float, ...] = parameter("Hz", rule="positive", sizes=(0,), repr=False)
    phases: tuple[float, ...] = parameter("rad", sizes=(0,), repr=False)

    def __post_init__(self) -> None:
        """Check that there are as many of each."""
        check(self)
        if not self.amplitudes:
            raise InvalidParameterError(self, "amplitudes", "at least 1 number", said="none")
        check_as_many(self, "amplitudes", "frequencies", "phases")

    @property
    def longest_step(self) -> float:
        """An eighth of the shortest period [s]."""
        return 0.125 / max(self.frequencies)

    def terms(self) -> tuple[float, ...]:
        """Return it for kernels."""
        rows = zip(self.amplitudes, self.frequencies, self.phases, strict=True)
        own = [number for a, f, p in rows for number in (a, _TURN * f, p)]
        return term(kernels.SINES, own, count=len(self.amplitudes))

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        low, high = (number(f(self.frequencies), 4) for f in (min, max))
        return f"a sum of {len(self.amplitudes)} sines from {low} to {high} Hz"
