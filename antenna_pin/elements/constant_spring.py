"""A spring of constant torque: a tape, a clock's spring."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.elements.element import LOSS, Element, Integral
from antenna_pin.errors import InvalidParameterError

__all__ = ["ConstantSpring"]


@dataclass(frozen=True, slots=True, kw_only=True)
class ConstantSpring(Element):
    r"""A spring of constant torque: a tape spring, a clock's spring.

    It acts between two angles, or all the way. Outside there is no torque; between an end and ``ramp`` beyond
    it the torque falls to none in proportion, for one that jumps would have no place where it lies at rest.
    Stored is what the torque gives on the way to where that ends (without such an end, what it gives on the
    way to the angle zero, which may be less than nothing).

    Attributes:
        torque: On the child, about the joint's axis [N*m] ([N]).
        lower: Where it begins to act [rad] ([m]); None for no end there.
        upper: Where it ceases to act [rad] ([m]); None for no end there.
        ramp: Angle in which it ceases, beyond an end [rad] ([m]).
    """

    kernels: ClassVar[str] = "constant_spring_kernels"
    traced: ClassVar[bool] = True
    senses: ClassVar[bool] = True
    integrals: ClassVar[tuple[Integral, ...]] = (LOSS,)

    torque: float = parameter("N*m", sliding="N")
    lower: float | None = parameter("rad", sliding="m", default=None)
    upper: float | None = parameter("rad", sliding="m", default=None)
    ramp: float = parameter("rad", sliding="m", rule="positive", default=1e-3)
    on: bool = True

    def __post_init__(self) -> None:
        """Check the parameters together."""
        Element.__post_init__(self)
        if self.lower is not None and self.upper is not None and not self.lower < self.upper:
            raise InvalidParameterError(self, "upper", f"above lower = {self.lower:g}", self.upper)

    @property
    def has_kinks(self) -> bool:
        """Return the number of kinks: ends of a ramp."""
        return self.lower is not None or self.upper is not None

    def derived(self) -> dict[str, Any]:
        """Return the packed parameters that are no fields of the element."""
        return {"lower": -math.inf if self.lower is None else self.lower}

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        ends = [
            f"{word} {self.text_of(name, slides)}"
            for name, word in (("lower", "from"), ("upper", "to"))
            if getattr(self, name) is not None
        ]
        where = f", {' '.join(ends)}, ceases within {self.text_of('ramp', slides)}" if ends else ""
        return f"constant {self.text_of('torque', slides)}{where}"
