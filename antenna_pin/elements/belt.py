"""Belts and cables between two pulleys: strands that pull and never push."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.elements.flanks import TWO, Flanks
from antenna_pin.errors import InvalidParameterError


@dataclass(frozen=True, slots=True, kw_only=True)
class Strands(Flanks):
    """Base of what pulls along between two pulleys.

    Attributes:
        input_radius: Of the pulley on the input's child [m].
        output_radius: Of that on the output's child [m].
        crossed: Whether the pulleys turn opposite ways.
        stiffness: Of each strand [N/m].
        damping: Of each strand, while it is taut [N*s/m].
        pretension: Of each strand where both angles are zero [N].
        slack: Of each strand there, if it has no pretension [m].
    """

    along: ClassVar[bool] = True
    modes: ClassVar[tuple[str, ...]] = ("slack", "plus", "minus", "taut")
    said_of_change: ClassVar[tuple[str, str]] = ("taut", "slack")
    labels: ClassVar[Mapping[str, str]] = {
        "stiffness": "stiffness",
        "damping": "damping",
        "pretension": "pretension",
        "slack": "slack",
    }

    input_radius: float = parameter("m", rule="positive")
    output_radius: float = parameter("m", rule="positive")
    crossed: bool = False
    stiffness: float = parameter("N/m", rule="positive")
    damping: float = parameter("N*s/m", rule="zero or more", default=0.0)
    pretension: float = parameter("N", rule="zero or more", default=0.0)
    slack: float = parameter("m", rule="zero or more", default=0.0)
    on: bool = True

    def __post_init__(self) -> None:
        """Check the numbers: what is slack has no tension."""
        Flanks.__post_init__(self)
        if self.slack > 0.0 and self.pretension > 0.0:
            raise InvalidParameterError(self, "slack", "zero beside a pretension", self.slack)

    @property
    def has_kinks(self) -> bool:
        """Return whether a taut strand has a damper, with a limit."""
        return self.damping > 0.0

    @property
    def room(self) -> float:
        """By how much strands are stretched without deflection."""
        return self.pretension / self.stiffness - self.slack

    @property
    def shares(self) -> tuple[float, float]:
        """Derivatives a and -b of the deflection over the positions: the radii."""
        return self.input_radius, -self.output_radius if self.crossed else self.output_radius

    def between_said(self) -> str:
        """Return the joints, and how the pulleys are connected, as text."""
        crossed = ", crossed" if self.crossed else ""
        radii = f"radii {self.text_of('input_radius', False)} and {self.text_of('output_radius', False)}"
        return f"{Flanks.between_said(self)}{crossed}, {radii}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Belt(Strands):
    r"""An open or crossed belt without slip: two strands, each taut or slack.

    With the way :math:`u = r_\text{in} \phi_\text{in} - r_\text{out} \phi_\text{out}` that the input is ahead
    the strand behind it is longer by u, the other one shorter. A taut strand pulls by its pretension,
    :math:`k u`, and a damping force of at most as much.
    """

    @property
    def springs(self) -> int:
        """Number of strands: 2."""
        return TWO


@dataclass(frozen=True, slots=True, kw_only=True)
class Cable(Strands):
    r"""A cable between two drums: one strand, taut where the input is ahead.

    It is taut where :math:`r_\text{in} \phi_\text{in} - r_\text{out} \phi_\text{out}` is above its slack (or
    above minus what its pretension has stretched it by); otherwise as a strand of :class:`Belt`.
    """

    @property
    def springs(self) -> int:
        """Number of strands: 1."""
        return 1
