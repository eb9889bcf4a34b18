"""A spring and damper between two points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.points import BetweenPoints
from antenna_pin.errors import InvalidParameterError


@dataclass(frozen=True, slots=True, kw_only=True)
class PointSpring(BetweenPoints):
    r"""A linear spring and damper between points of two links, or the world.

    Along the line between the points, a distance l apart, it draws them together by

    .. math:: F = k (l - l_0) + c \dot l

    Without free length the force is k times the way, smooth through zero. Where the points coincide the
    direction is that in which they move apart: a damper's force is continuous there, that of a spring with a
    free length jumps to the other side.

    Attributes:
        first: A link, or ``world``, and a point in its frame [m].
        second: Another link and a point in its frame [m].
        free_length: Distance of the points at which the spring is at rest [m].
        stiffness: [N/m].
        damping: [N*s/m].
    """

    kernels: ClassVar[str] = __name__
    one_above_zero: ClassVar[tuple[str, ...]] = ("stiffness", "damping")

    free_length: float = parameter("m", rule="zero or more")
    stiffness: float = parameter("N/m", rule="zero or more", default=0.0)
    damping: float = parameter("N*s/m", rule="zero or more", default=0.0)
    on: bool = True

    def check_length(self, place: str, length: float) -> None:
        """Refuse a start in which its points coincide while it is compressed."""
        if length == 0.0 and self.on and self.free_length > 0.0 and self.stiffness > 0.0:
            raise InvalidParameterError(
                place,
                "length at the start",
                "above zero, or its force has no direction; start with its points apart, or give it no free "
                "length",
                0.0,
                said="0 m",
            )

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        said = {"free_length": "free length", "stiffness": "stiffness", "damping": "damping"}
        return f"from {self.first[0]} to {self.second[0]}, {', '.join(self.said_of(said, slides))}"


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def tension(spring: PointSpring, length: float, rate: float) -> float:
    """Return the force that draws the points together [N], of distance [m] and rate [m/s]."""
    return float(spring.stiffness * (length - spring.free_length) + spring.damping * rate)


@inlined
def loss(spring: PointSpring, rate: float) -> float:
    """Power that the damper takes [W]."""
    return float(spring.damping * rate * rate)


@inlined
def stored(spring: PointSpring, length: float) -> float:
    """Energy stored [J]."""
    stretch = length - spring.free_length
    return float(0.5 * spring.stiffness * stretch * stretch)
