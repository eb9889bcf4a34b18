"""A shaken base: base class, sine, and swept sine with its pieces."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.directions import A_DIRECTION
from antenna_pin.base.parameters import check, parameter
from antenna_pin.base.readable import GIVEN, number, readable
from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.curve import SweptPiece, sines_of
from antenna_pin.elements.element import packed
from antenna_pin.elements.prescribed import Motion
from antenna_pin.elements.reference import swept
from antenna_pin.elements.term_kernels import course
from antenna_pin.errors import InvalidParameterError

_MINUTE, _LEAST_CYCLES = 60.0, 10
# The power of the angular frequency by which amplitudes are those of a displacement.
_POWERS = {"displacement": 0, "velocity": 1, "acceleration": 2}


@dataclass(frozen=True, slots=True, kw_only=True)
class Shake(Motion):
    """Base of the motions of a shaken base, along a direction or about an axis.

    A mechanism whose base stands still is carried by a joint more, which bears the motion's name and follows
    it exactly (:func:`antenna_pin.mechanism.with_shaken_base`). The force that this takes is the motion's
    torque in a result, its work stands in the ledger.

    Attributes:
        joint: Name of the joint that carries the base, which is made; in a scenario the table's.
        direction: Along which the base moves, in world axes; only its ratio counts [-].
        axis: About which the base turns instead, in world axes [-].
        point: Through which that axis goes, in the world; its origin if left out [m].
        fade_in: Time in which it grows from nothing, by a factor whose second derivative is continuous [s].
    """

    kernels: ClassVar[str] = __name__

    direction: tuple[float, ...] | None = parameter("1", rule=A_DIRECTION, sizes=(3,), default=None)
    axis: tuple[float, ...] | None = parameter("1", rule=A_DIRECTION, sizes=(3,), default=None)
    point: tuple[float, ...] | None = parameter("m", sizes=(3,), default=None)
    fade_in: float = parameter("s", rule="zero or more", default=0.0)

    def __post_init__(self) -> None:
        """Check the parameters."""
        check(self)
        if (self.direction is None) == (self.axis is None):
            said = "neither" if self.axis is None else "both"
            raise InvalidParameterError(self, "direction", "given, or an axis to turn about", said=said)
        if self.point is not None and self.axis is None:
            raise InvalidParameterError(self, "point", "left out where the base moves along a direction")

    @property
    def slides(self) -> bool:
        """Return whether the base moves along a direction rather than turning."""
        return self.direction is not None

    def check_joint(self, place: str, slides: bool) -> None:
        """Refuse a joint that moves in another way than the motion."""
        if slides != self.slides:
            rule = f"one that {'slides' if self.slides else 'turns'}, as the motion says"
            raise InvalidParameterError(place, "joint", rule, self.joint)

    def terms(self) -> tuple[float, ...]:
        """Return its course for kernels (:mod:`antenna_pin.elements.term_kernels`), before it fades in."""
        raise NotImplementedError

    @packed
    def course_length(self) -> int:
        """Number of words of its course."""
        return len(self.terms())

    def tail(self) -> tuple[float, ...]:
        """Return its course."""
        return self.terms()

    @property
    def faded(self) -> tuple[float, ...]:
        """End of the fade-in, if any [s]."""
        return (self.fade_in,) if self.fade_in else ()

    def said_fade(self) -> str:
        """Return how it fades in, in words."""
        return f", fades in within {readable(self.fade_in, 's', GIVEN)}" if self.fade_in else ""

    def carried(self) -> dict[str, Any]:
        """Return the facts about the shaken base that a result carries."""
        return {"along": list(self.direction)} if self.direction else {"about": list(self.axis or ())}

    def way(self) -> str:
        """Return along which direction, or about which axis, in words."""
        given = self.direction if self.direction is not None else self.axis
        assert given is not None
        text = f"({', '.join(number(one, GIVEN) for one in given)})"
        return f"base shaken {'along' if self.slides else 'about'} {text}"

    def said_in_own(self, name: str) -> str:
        """Return a parameter with its unit along a direction or about an axis."""
        return self.text_of(name, self.slides)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Swept(Shake):
    """Base of the sines: amplitudes of displacement, velocity and acceleration, of which the least counts."""

    at_start: ClassVar[tuple[str, ...]] = (
        "displacement",
        "velocity",
        "acceleration",
        "frequency",
        "phase",
        "fade_in",
        "start_frequency",
        "end_frequency",
        "octaves_per_minute",
        "hertz_per_second",
        "dwell",
    )

    def pieces(self) -> tuple[SweptPiece, ...]:
        """Return the stretches of time that it is made of."""
        raise NotImplementedError

    def carried(self) -> dict[str, Any]:
        """Return what a result carries of it: its pieces too."""
        return Shake.carried(self) | {"pieces": [list(piece) for piece in self.pieces()]}

    def amplitudes(self) -> dict[str, float]:
        """Return the amplitudes that are given, by what they are of."""
        return {name: value for name in _POWERS if (value := getattr(self, name)) is not None}

    def check_amplitudes(self) -> None:
        """Refuse a sine without an amplitude."""
        if not self.amplitudes():
            rule = "given, or the amplitude of velocity or displacement"
            raise InvalidParameterError(self, "acceleration", rule, said="none")

    def least(self, omega: float) -> tuple[float, int]:
        """Return height and power of the amplitude that counts at an angular frequency [rad/s]."""
        given = self.amplitudes()
        name = min(given, key=lambda one: given[one] / omega ** _POWERS[one])
        return given[name], _POWERS[name]

    def terms(self) -> tuple[float, ...]:
        """Return its pieces for kernels."""
        return swept(self.pieces())

    @property
    def instants(self) -> tuple[float, ...]:
        """Times at which it goes over into another piece, or has faded in [s]."""
        return tuple(sorted({*(piece.start for piece in self.pieces()[1:]), *self.faded}))

    def sines(self, time: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return frequency [Hz] and phase [rad] of the sine at times [s], (n,) each."""
        return sines_of(self.pieces(), time)

    def said_amplitudes(self) -> str:
        """Return the amplitudes in words."""
        said = [f"{self.said_in_own(name)} of {name}" for name in self.amplitudes()]
        return f"{'the least of ' if len(said) > 1 else ''}{' and '.join(said)}"


@dataclass(frozen=True, slots=True, kw_only=True)
class SineShake(_Swept):
    r"""The base swings as a sine.

    .. math:: x = D \sin(2 \pi f t + \varphi)

    Amplitudes of velocity and acceleration stand for D by :math:`V / \omega` and :math:`A / \omega^2`; the
    least D counts. It starts in motion unless it fades in.

    Attributes:
        displacement: Amplitude [rad] ([m]).
        velocity: Amplitude [rad/s] ([m/s]).
        acceleration: Amplitude; in g where it is an acceleration [rad/s^2] ([m/s^2]).
        frequency: f [Hz].
        phase: varphi [rad].
    """

    displacement: float | None = parameter("rad", sliding="m", rule="positive", default=None)
    velocity: float | None = parameter("rad/s", sliding="m/s", rule="positive", default=None)
    acceleration: float | None = parameter("rad/s^2", sliding="m/s^2", rule="positive", default=None)
    frequency: float = parameter("Hz", rule="positive")
    phase: float = parameter("rad", default=0.0)

    def __post_init__(self) -> None:
        """Check the parts."""
        Shake.__post_init__(self)
        self.check_amplitudes()

    @property
    def longest_step(self) -> float:
        """An eighth of the period [s]."""
        return 0.125 / self.frequency

    def pieces(self) -> tuple[SweptPiece, ...]:
        """Return the one stretch that it is made of."""
        omega = 2.0 * math.pi * self.frequency
        return (SweptPiece(0.0, omega, 0.0, 0, self.phase, *self.least(omega)),)

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        phase = f", phase {self.text_of('phase', slides)}" if self.phase else ""
        swing = f"sine of {self.text_of('frequency', slides)}{phase}, {self.said_amplitudes()}"
        return f"{self.way()}: {swing}{self.said_fade()}"


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepShake(_Swept):
    r"""Base motion by a sine of swept frequency, and back if wanted.

    The displacement is :math:`D(\omega) \sin \varphi(t)` with :math:`\dot\varphi = \omega`, D as of a sine,
    and exact derivatives. Where one amplitude takes over from another, and at the end, the displacement
    passes zero, so that velocity has no jump: its rate is rounded to a whole number of half periods. Then it
    stays at the last frequency.

    Attributes:
        displacement: Amplitude [rad] ([m]).
        velocity: Amplitude [rad/s] ([m/s]).
        acceleration: Amplitude; in g where it is an acceleration [rad/s^2] ([m/s^2]).
        start_frequency: At t = 0 [Hz].
        end_frequency: To which it is swept; below the first of a sweep down [Hz].
        octaves_per_minute: Rate of a logarithmic sweep [-].
        hertz_per_second: Rate of a linear sweep, in place of the former [-].
        dwell: Time at the end frequency before the way back, in whole half periods [s].
        back: Whether it goes back to the first frequency.
    """

    displacement: float | None = parameter("rad", sliding="m", rule="positive", default=None)
    velocity: float | None = parameter("rad/s", sliding="m/s", rule="positive", default=None)
    acceleration: float | None = parameter("rad/s^2", sliding="m/s^2", rule="positive", default=None)
    start_frequency: float = parameter("Hz", rule="positive")
    end_frequency: float = parameter("Hz", rule="positive")
    octaves_per_minute: float | None = parameter("1", rule="positive", default=None)
    hertz_per_second: float | None = parameter("1", rule="positive", default=None)
    dwell: float = parameter("s", rule="zero or more", default=0.0)
    back: bool = False

    def __post_init__(self) -> None:
        """Check the parts."""
        Shake.__post_init__(self)
        self.check_amplitudes()
        if (self.octaves_per_minute is None) == (self.hertz_per_second is None):
            said = "neither" if self.hertz_per_second is None else "both"
            rule = "given, or hertz_per_second"
            raise InvalidParameterError(self, "octaves_per_minute", rule, said=said)
        if self.start_frequency == self.end_frequency:
            rule = "another than start_frequency; a sine of one frequency is kind = 'sine'"
            raise InvalidParameterError(self, "end_frequency", rule)
        if self.dwell and not self.back:
            rule = "left out where the sweep does not go back: it stays at the end frequency anyhow"
            raise InvalidParameterError(self, "dwell", rule)
        cycles = self._half_turns(*self._ends) / 2.0
        if not cycles >= _LEAST_CYCLES * (1.0 - 1e-9):
            name = "octaves_per_minute" if self.octaves_per_minute is not None else "hertz_per_second"
            rule = f"so slow that the sweep has {_LEAST_CYCLES} periods or more (it has {cycles:.3g})"
            raise InvalidParameterError(self, name, rule)

    @property
    def _ends(self) -> tuple[float, float]:
        return 2.0 * math.pi * self.start_frequency, 2.0 * math.pi * self.end_frequency

    @property
    def longest_step(self) -> float:
        """An eighth of the shortest period [s]."""
        return 0.125 / max(self.start_frequency, self.end_frequency)

    @property
    def length(self) -> float:
        """Time that the sweep takes, with what it dwells and goes back [s]."""
        return self.pieces()[-1].start

    def _half_turns(self, low: float, last: float) -> float:
        """Return the number of half periods between two angular frequencies."""
        if self.octaves_per_minute is not None:
            return abs(last - low) / (math.log(2.0) * self.octaves_per_minute / _MINUTE) / math.pi
        assert self.hertz_per_second is not None
        return abs(last**2 - low**2) / (4.0 * math.pi * self.hertz_per_second) / math.pi

    def _corners(self) -> list[float]:
        """Return the angular frequencies between which one amplitude counts, from the first to the last."""
        first, last = self._ends
        given = [(value, _POWERS[name]) for name, value in self.amplitudes().items()]
        meets = {(b / a) ** (1.0 / (n - m)) for a, m in given for b, n in given if n > m}  # a / w^m = b / w^n
        inside = sorted(w for w in meets if min(first, last) < w < max(first, last))
        kept = [w for w in inside if self.least(w * (1.0 - 1e-9)) != self.least(w * (1.0 + 1e-9))]
        return [first, *(kept if last > first else kept[::-1]), last]

    def pieces(self) -> tuple[SweptPiece, ...]:
        """Return the pieces of the sweep; the last one has no end."""
        corners = self._corners()
        found: list[SweptPiece] = []
        start = half_turns = 0.0

        def stay(omega: float) -> SweptPiece:
            return SweptPiece(start, omega, 0.0, 0, math.pi * (half_turns % 2.0), *self.least(omega))

        for way in (corners, corners[::-1]) if self.back else (corners,):
            if found and self.dwell:
                found.append(stay(way[0]))
                halves = float(math.ceil(self.dwell * way[0] / math.pi))
                start, half_turns = start + halves * math.pi / way[0], half_turns + halves
            for first, last in zip(way[:-1], way[1:], strict=True):
                halves = max(1.0, float(round(self._half_turns(first, last))))
                if self.octaves_per_minute is not None:
                    growth = (last - first) / (halves * math.pi)
                    lasts = math.log(last / first) / growth
                else:
                    growth = (last**2 - first**2) / (2.0 * halves * math.pi)
                    lasts = (last - first) / growth
                shape = self.least(math.sqrt(first * last))
                octaves = int(self.octaves_per_minute is not None)
                found.append(SweptPiece(start, first, growth, octaves, math.pi * (half_turns % 2.0), *shape))
                start, half_turns = start + lasts, half_turns + halves
        return (*found, stay(way[-1]))

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        rate = (
            f"{number(self.octaves_per_minute, GIVEN)} octaves/min"
            if self.octaves_per_minute is not None
            else f"{number(self.hertz_per_second or 0.0, GIVEN)} Hz/s"
        )
        back = " and back" if self.back else ""
        stays = f", {self.text_of('dwell', slides)} at the end" if self.dwell else ""
        start, end = (self.text_of(f"{word}_frequency", slides) for word in ("start", "end"))
        span = f"from {start} to {end}{back}"
        takes = f"takes {readable(self.length, 's')}"
        return (
            f"{self.way()}: sweep {span}, {rate}, {self.said_amplitudes()}{stays}{self.said_fade()}, {takes}"
        )


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def fade(t: float, length: float) -> tuple[float, float, float]:
    """Return the factor at time t [s] with its first two derivatives.

    The factor is 10 u^3 - 15 u^4 + 6 u^5 of u = t / length.

    Its first two derivatives are zero at both ends, so that acceleration begins without a jump.
    """
    if t >= length:
        return 1.0, 0.0, 0.0
    u = t / length
    rest = 1.0 - u
    value = u * u * u * (10.0 + u * (6.0 * u - 15.0))
    return value, 30.0 * u * u * rest * rest / length, 60.0 * u * rest * (rest - u) / (length * length)


@inlined
def faded(swing: tuple[float, float, float], t: float, length: float) -> tuple[float, float, float]:
    """Position, rate and acceleration of a motion, given with both derivatives, that fades in."""
    x, v, a = swing
    w, slope, bend = fade(t, length)
    return w * x, w * v + slope * x, w * a + 2.0 * slope * v + bend * x


@inlined
def motion(m: Shake, tail: Floats, t: float) -> tuple[float, float, float]:
    """Position, its rate and its acceleration at time t [s]: all exact of one another."""
    return faded(course(tail, 0, m.course_length, t), t, m.fade_in)
