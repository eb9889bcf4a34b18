"""A controller that follows a reference."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from antenna_pin.elements.curve import check_course, check_covers, course_words, cubics, points_and_middles
from antenna_pin.elements.element import Drive
from antenna_pin.errors import InvalidParameterError
from antenna_pin.parameters import check, parameter
from antenna_pin.readable import GIVEN, readable

__all__ = ["PDController"]


@dataclass(frozen=True, slots=True, kw_only=True)
class PDController(Drive):
    r"""A controller of angle and rate, or of way and speed at a sliding joint: it follows a reference.

    .. math:: \tau = k_p (\phi_r - \phi) + k_d (\dot\phi_r - \dot\phi), \quad |\tau| \le \tau_{max}

    .. math:: \phi_r = \phi_0 + \omega t + A \sin(2 \pi f t + \varphi) + \text{table}(t)

    with the reference's exact derivative. At a joint with play phi is the motion angle. Angles count whole
    turns. Where the torque reaches its limit or leaves it, it has a kink; steps end there.

    Attributes:
        kp: Proportional gain [N*m/rad] ([N/m]).
        kd: Derivative gain [N*m*s/rad] ([N*s/m]).
        limit: Largest torque either way [N*m] ([N]); None for no limit.
        angle: Constant part of the reference, phi_0 [rad] ([m]).
        rate: Of the part that grows with time, omega [rad/s] ([m/s]).
        amplitude: Of the part that swings, A [rad] ([m]).
        frequency: Of the part that swings, f [Hz]; None where nothing swings.
        phase: Of the part that swings, varphi, at t = 0 [rad].
        file: Where the part that is a table came from, relative to the scenario's folder; None if there is no
            such part, or it is given as numbers.
        time: Of the table, strictly increasing, at least two [s]. A run must lie within them.
        reference: Of the table, one for each time, joined by monotone cubics of continuous slope [rad] ([m]).
    """

    kernels: ClassVar[str] = "pd_kernels"
    columns: ClassVar[tuple[str, str]] = ("time", "reference")
    senses: ClassVar[bool] = True
    tracks: ClassVar[bool] = True

    kp: float = parameter("N*m/rad", sliding="N/m", rule="zero or more", default=0.0)
    kd: float = parameter("N*m*s/rad", sliding="N*s/m", rule="zero or more", default=0.0)
    limit: float | None = parameter("N*m", sliding="N", rule="positive", default=None)
    angle: float = parameter("rad", sliding="m", default=0.0)
    rate: float = parameter("rad/s", sliding="m/s", default=0.0)
    amplitude: float = parameter("rad", sliding="m", default=0.0)
    frequency: float | None = parameter("Hz", rule="positive", default=None)
    phase: float = parameter("rad", default=0.0)
    file: str | None = None
    time: tuple[float, ...] | None = parameter("s", sizes=(0,), default=None, repr=False)
    reference: tuple[float, ...] | None = parameter("rad", sliding="m", sizes=(0,), default=None, repr=False)

    def __post_init__(self) -> None:
        """Check gains and reference."""
        check(self)
        if self.kp == self.kd == 0.0:
            raise InvalidParameterError(self, "kp", "above zero, or kd", said="neither")
        check_course(self, "reference")

    @property
    def has_kinks(self) -> bool:
        """Whether the torque has a limit."""
        return self.limit is not None

    @property
    def instants(self) -> tuple[float, ...]:
        """Points of the reference's table, where its acceleration jumps, and the middles between them [s]."""
        return () if self.time is None else points_and_middles(self.time)

    @property
    def longest_step(self) -> float:
        """An eighth of the reference's period [s]."""
        return math.inf if self.frequency is None else 0.125 / self.frequency

    def values(self) -> dict[str, Any]:
        """Return its numbers, by the names that its record has for them."""
        return {
            "kp": self.kp,
            "kd": self.kd,
            "limit": math.inf if self.limit is None else self.limit,
            "angle": self.angle,
            "rate": self.rate,
            "amplitude": self.amplitude,
            "angular_frequency": 2.0 * math.pi * (self.frequency or 0.0),
            "phase": self.phase,
            "points": 0 if self.time is None else len(self.time),
        }

    def tail(self) -> tuple[float, ...]:
        """Return the curve through the points of the reference's table."""
        if self.time is None or self.reference is None:
            return ()
        return cubics(self.time, self.reference, "cubic")

    def check_span(self, place: str, begin: float, end: float) -> None:
        """Refuse a run that the reference's table does not cover."""
        if self.time is not None:
            check_covers(self.time, place, begin, end)

    def words(self, slides: bool) -> str:
        """Return what it is in words."""

        def said(name: str) -> str:
            return readable(getattr(self, name), self.unit(name, slides), GIVEN)

        parts = course_words(self, "angle", [], slides)
        text = f"controller, kp {said('kp')}, kd {said('kd')}, reference {' + '.join(parts) or '0'}"
        return text if self.limit is None else f"{text}, at most {said('limit')}"
