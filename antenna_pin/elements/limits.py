"""Base of end stops: two sides, or one."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.element import packed
from antenna_pin.elements.modal import ModalElement
from antenna_pin.errors import InvalidParameterError

# Its modes: off both sides, on the lower one, on the upper one.
FREE, LOWER, UPPER = 0, 1, 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits(ModalElement):
    """Base of the end stops: between them, or on a side.

    Attributes:
        lower: Lower limit [rad] ([m]); with neither limit, those of the URDF.
        upper: Upper limit [rad] ([m]); None for no stop there.
    """

    modes: ClassVar[tuple[str, ...]] = ("free", "lower", "upper")
    sides: ClassVar[tuple[str, ...]] = ("lower", "upper")
    switches: ClassVar[int] = 3

    lower: float | None = parameter("rad", sliding="m", default=None)
    upper: float | None = parameter("rad", sliding="m", default=None)

    def __post_init__(self) -> None:
        """Check that there is a side, and a way between two."""
        ModalElement.__post_init__(self)
        if self.lower is None and self.upper is None:
            raise InvalidParameterError(self, "lower", "given, or upper, or both", said="neither")
        if not self.lowest < self.highest:
            rule = f"above lower, {self.lower:g}; the joint moves between them"
            raise InvalidParameterError(self, "upper", rule, self.upper)

    @packed
    def lowest(self) -> float:
        """Lower limit, or minus infinity."""
        return -math.inf if self.lower is None else self.lower

    @packed
    def highest(self) -> float:
        """Upper limit, or infinity."""
        return math.inf if self.upper is None else self.upper

    def said_by(self, name: str, side: int) -> str:
        """Return the name of a side's parameter: its own ``upper_`` one where given."""
        upper = f"upper_{name}"
        return upper if side == UPPER and getattr(self, upper, None) is not None else name

    def of_side(self, name: str, side: int) -> Any:
        """Return what a side has of a parameter in which the sides may differ."""
        return getattr(self, self.said_by(name, side))

    def differs(self, names: Iterable[str]) -> bool:
        """Return whether the upper side has a parameter of its own."""
        return any(self.said_by(name, UPPER) != name for name in names)

    def check_upper(self, names: Iterable[str]) -> None:
        """Refuse parameters of an upper side that is none."""
        for name in names if self.upper is None else ():
            own = self.said_by(name, UPPER)
            if own != name:
                rule = "left out where there is no upper limit; give upper"
                raise InvalidParameterError(self, own, rule, getattr(self, own))

    def words_of_limits(self, slides: bool) -> str:
        """Return the limits in words."""
        if self.lower is None or self.upper is None:
            return f"at {self.text_of('lower' if self.upper is None else 'upper', slides)}"
        return f"at {self.text_of('lower', slides)} and {self.text_of('upper', slides)}"

    def facts(self) -> dict[str, float]:
        """Return the limits that it has."""
        both = {"lower": self.lower, "upper": self.upper}
        return {name: float(limit) for name, limit in both.items() if limit is not None}

    def side_at(self, angle: float, rate: float) -> int:
        """Return the side that a joint is beyond, or at without leaving; 0 if none."""
        if angle < self.lowest or (angle == self.lowest and rate <= 0.0):
            return LOWER
        return UPPER if angle > self.highest or (angle == self.highest and rate >= 0.0) else FREE


@inlined
def beyond(lower: float, upper: float, mode: int, k: int, angle: float, rate: float) -> tuple[float, float]:
    """Return gap to, or depth in, side k (0 lower, 1 upper), and its rate."""
    side = LOWER if k == 0 else UPPER
    gap = angle - lower if k == 0 else upper - angle
    if math.isinf(gap) or (mode != FREE and mode != side):
        return 1.0, 0.0
    slope = rate if k == 0 else -rate
    return (gap, slope) if mode == FREE else (-gap, -slope)
