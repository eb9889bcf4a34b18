"""A prescribed length: a leg to a point that moves along a path."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.base.parameters import check, parameter
from antenna_pin.base.readable import GIVEN, number
from antenna_pin.base.records import Triple
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.course import Swing
from antenna_pin.elements.element import packed
from antenna_pin.elements.prescribed import Motion
from antenna_pin.errors import InvalidParameterError


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

    kernels: ClassVar[str] = __name__
    unpacked: ClassVar[tuple[str, ...]] = ("mean",)

    offset: Triple = parameter("m", sizes=(3,))
    mean: Triple = parameter("m", sizes=(3,), default=(0.0, 0.0, 0.0))
    velocity: Triple = parameter("m/s", sizes=(3,), default=(0.0, 0.0, 0.0))
    amplitude: Triple = parameter("m", sizes=(3,), default=(0.0, 0.0, 0.0))
    frequency: float | None = parameter("Hz", rule="positive", default=None)
    phase: Triple = parameter("rad", sizes=(3,), default=(0.0, 0.0, 0.0))

    def __post_init__(self) -> None:
        """Check the parts."""
        check(self)
        self.check_frequency(any(self.amplitude))

    def check_joint(self, place: str, slides: bool) -> None:
        """Refuse a joint that turns."""
        if not slides:
            raise InvalidParameterError(place, "joint", "one that slides: it follows a distance", self.joint)

    @packed
    def centre(self) -> Triple:
        """Place on the path at its origin, from the fixed point [m]."""
        (x, y, z), (a, b, c) = self.offset, self.mean
        return x + a, y + b, z + c

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        swing = "" if self.frequency is None else f" that swings at {number(self.frequency, GIVEN)} Hz"
        return f"motion: distance to a point on a path{swing}"


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def motion(m: DistanceMotion, t: float) -> tuple[float, float, float]:
    """Distance, its rate and its acceleration at time t [s]."""
    omega = m.angular_frequency
    # r.r, r.r', r'.r' + r.r''.
    square = along = bend = 0.0
    for k in range(3):
        turned = omega * t + m.phase[k]
        sine, cosine = m.amplitude[k] * math.sin(turned), m.amplitude[k] * math.cos(turned)
        way = m.centre[k] + m.velocity[k] * t + sine
        rate = m.velocity[k] + omega * cosine
        square += way * way
        along += way * rate
        bend += rate * rate - way * omega * omega * sine
    distance = math.sqrt(square)
    speed = along / distance
    return distance, speed, (bend - speed * speed) / distance
