"""What every element between two joints is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.elements.element import IMPULSE, LOSS, ForceElement, Integral
from antenna_pin.errors import InvalidParameterError

__all__ = ["BetweenJoints"]


@dataclass(frozen=True, slots=True, kw_only=True)
class BetweenJoints(ForceElement):
    """Base of the elements that act at two joints: on a deflection that is a function of their positions.

    Such an element is one at a joint whose angle is its deflection, ``x(input, output)``: its kernels
    ``effort``, ``stored`` and ``kink`` are given x and its rate. The effort is along x: at each joint it acts
    times the derivative of x over that joint's position, with the reaction on the joint's own parent.
    Besides there are

    - ``between(words, at, angle, rate, other, other_rate)``: x, its rate, and its derivatives over the
      positions of the input and of the output;
    - ``dissipation(words, at, x, rate)``: the power that it takes by its deflection [W];
    - if there is friction beside it ``drag(words, at, torque, rate)``: the torque on the input, against its
      rate, where the element gives it a torque.

    Attributes:
        input: Name of the joint on the driving side.
        output: Name of the joint on the driven side.
    """

    integrals: ClassVar[tuple[Integral, ...]] = (LOSS, IMPULSE)
    # Whether its deflection is a way [m] and its effort a force [N]; else they are an angle and a torque.
    along: ClassVar[bool] = False
    # Whether its input and its output are to slide; what else to take where they do not as they are to.
    slide: ClassVar[tuple[bool, bool]] = (False, False)
    instead: ClassVar[str] = 'kind "rack" from a pinion to what it moves, or a coupling'

    input: str
    output: str

    def __post_init__(self) -> None:
        """Check the parameters, and that there are two joints."""
        ForceElement.__post_init__(self)
        if self.input == self.output:
            raise InvalidParameterError(self, "output", "another joint than the input", self.output)

    def between_said(self) -> str:
        """Return between which joints it is, in words."""
        return f"from {self.input} to {self.output}"

    def check_joints(self, place: str, slides: tuple[bool, bool]) -> None:
        """Refuse joints between which it cannot act.

        Args:
            place: Its name, for the message.
            slides: Whether input and output slide along their axes rather than turning about them.
        """
        for key, name, seen, wanted in zip(
            ("input", "output"), (self.input, self.output), slides, self.slide, strict=True
        ):
            if seen != wanted:
                does, is_to = ("slides", "turns") if seen else ("turns", "slides")
                rule = f"a joint that {is_to}, and {name!r} {does}; take {self.instead}"
                raise InvalidParameterError(place, key, rule, name)
