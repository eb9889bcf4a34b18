"""A controller that follows a reference."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.base.parameters import check, parameter
from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.course import Course
from antenna_pin.elements.curve import Interpolation
from antenna_pin.elements.element import Drive, packed
from antenna_pin.elements.reference import Reference
from antenna_pin.elements.term_kernels import course
from antenna_pin.errors import InvalidParameterError


@dataclass(frozen=True, slots=True, kw_only=True)
class PDController(Course, Drive):
    r"""A controller of angle and rate, or of position and speed, by a reference.

    .. math:: \tau = k_p (\phi_r - \phi) + k_d (\dot\phi_r - \dot\phi), \quad |\tau| \le \tau_{max}

    .. math:: \phi_r = \phi_0 + \omega t + A \sin(2 \pi f t + \varphi) + \text{table}(t) + \text{reference}(t)

    Angles count whole turns; at a joint with play phi is the motion angle. Where the torque meets its limit
    steps end. It may measure another joint than the one that it drives: the angle behind a gear.

    Attributes:
        measures: The joint whose angle phi it measures; None for the one that it drives.
        kp: Proportional gain [N*m/rad] ([N/m]).
        kd: Derivative gain [N*m*s/rad] ([N*s/m]).
        limit: Largest torque either way [N*m] ([N]); None for no limit.
        follows: A reference, such as a slew; None for none.
        angle: Constant part of the reference, phi_0 [rad] ([m]).
        rate: Of the part that grows with time, omega [rad/s] ([m/s]).
        amplitude: Of the part that swings, A [rad] ([m]).
        frequency: Of the part that swings, f [Hz]; None where nothing swings.
        phase: Of the part that swings, varphi, at t = 0 [rad].
        file: Where the part that is a table came from, relative to the scenario's folder; None if there is no
            such part, or it is given as numbers.
        time: Of the table, strictly increasing, at least two [s]. A run must lie within them.
        reference: Of the table, joined by monotone cubics [rad] ([m]).
    """

    kernels: ClassVar[str] = __name__
    constant: ClassVar[str] = "angle"
    columns: ClassVar[tuple[str, str]] = ("time", "reference")
    joined: ClassVar[Interpolation] = "cubic"
    senses: ClassVar[bool] = True
    tracks: ClassVar[bool] = True

    measures: str | None = None
    kp: float = parameter("N*m/rad", sliding="N/m", rule="zero or more", default=0.0)
    kd: float = parameter("N*m*s/rad", sliding="N*s/m", rule="zero or more", default=0.0)
    limit: float | None = parameter("N*m", sliding="N", rule="positive", default=None)
    follows: Reference | None = None
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
        self.check_course()

    @property
    def measured(self) -> str:
        """The joint whose motion it sees."""
        return self.joint if self.measures is None else self.measures

    def check_measured(self, place: str, slides: bool, measured: bool) -> None:
        """Refuse a measured joint that moves otherwise: gains would have no unit."""
        if slides != measured:
            which = "slides" if slides else "turns"
            rule = f"a joint that {which}, as {self.joint!r} does"
            raise InvalidParameterError(place, "measures", rule, self.measures)

    @packed
    def largest(self) -> float:
        """Largest torque either way, infinity without a limit [N*m] ([N])."""
        return math.inf if self.limit is None else self.limit

    @property
    def has_kinks(self) -> bool:
        """Return whether the torque has a limit."""
        return self.limit is not None

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        kp, kd = (self.text_of(name, slides) for name in ("kp", "kd"))
        of = "" if self.measured == self.joint else f" of {self.measured}"
        text = f"controller{of}, kp {kp}, kd {kd}, reference {self.course_words(slides) or '0'}"
        return text if self.limit is None else f"{text}, at most {self.text_of('limit', slides)}"


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def reference(pd: PDController, tail: Floats, t: float) -> tuple[float, float]:
    """Angle to be followed and its rate."""
    omega = pd.angular_frequency
    turned = omega * t + pd.phase
    angle = pd.angle + pd.rate * t + pd.amplitude * math.sin(turned)
    rate = pd.rate + pd.amplitude * omega * math.cos(turned)
    if pd.course_length > 0:
        own = course(tail, 0, pd.course_length, t)
        angle += own[0]
        rate += own[1]
    return angle, rate


@inlined
def demand(pd: PDController, tail: Floats, t: float, angle: float, rate: float) -> float:
    """Torque that it would give without a limit [N m], or force [N]."""
    wanted, wanted_rate = reference(pd, tail, t)
    return float(pd.kp * (wanted - angle) + pd.kd * (wanted_rate - rate))


@inlined
def effort(pd: PDController, tail: Floats, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    return min(max(demand(pd, tail, t, angle, rate), -pd.largest), pd.largest)


@inlined
def kink(pd: PDController, tail: Floats, t: float, angle: float, rate: float) -> float:
    """Return the demand's excess over the limit; the effort has a kink at its zero."""
    return abs(demand(pd, tail, t, angle, rate)) - pd.largest
