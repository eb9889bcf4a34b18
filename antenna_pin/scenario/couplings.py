"""Joints that follow others."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import model_validator

from antenna_pin.base.units import matching_unit
from antenna_pin.scenario._class_tables import JointTable
from antenna_pin.scenario.spec import QuantityRule, Spec, refuse

__all__ = ["AnyCoupling", "CouplingSpec", "DifferentialSpec", "PlanetarySpec"]

_RATIOS = ("1", "m/rad", "rad/m")


class CouplingSpec(JointTable):
    """A joint held to a multiple of another's position, or of two others'.

    Attributes:
        kind: Which of the tables it is.
        follower: Name of the joint that follows.
        leader: Name of the joint that it follows.
        multiplier: Angle or way of the follower for one of the leader, negative the other way [-].
        offset: The follower's position where those of the leaders are zero [rad] ([m]).
        second: Name of a second joint that it follows, times its own multiplier.
        second_multiplier: Angle or way of the follower for one of the second joint, in SI units [-].
        conversion: What the unit of the multiplier says; None if it came without one.
    """

    # The key of each joint, by the name that it has in a coupling.
    roles: ClassVar[Mapping[str, str]] = {"follower": "follower", "leader": "leader", "second": "second"}

    kind: Literal["ratio"] = "ratio"
    follower: str
    leader: str
    multiplier: Annotated[float, QuantityRule(_RATIOS)] = 1.0
    offset: Annotated[float, QuantityRule(("rad", "m"))] = 0.0
    second: str | None = None
    second_multiplier: Annotated[float, QuantityRule("1")] = 1.0
    conversion: Literal["m/rad", "rad/m"] | None = None

    @model_validator(mode="before")
    @classmethod
    def _read_conversion(cls, data: Any) -> Any:
        unit = matching_unit(data.get("multiplier"), _RATIOS[1:]) if isinstance(data, Mapping) else None
        return data if unit is None else {**data, "conversion": unit}

    @model_validator(mode="after")
    def _check_joints(self) -> Self:
        if self.leader == self.follower:
            refuse(f"must be another joint than the follower, got {self.leader!r}", "leader")
        if self.second in (self.follower, self.leader):
            refuse(f"must be a third joint, got {self.second!r}", "second")
        return self


class DifferentialSpec(Spec):
    """A differential: its carrier turns by the mean of what its two sides turn by.

    Attributes:
        kind: Which of the tables it is.
        carrier: Name of the joint of the carrier.
        first: Name of the joint of one side.
        second: Name of the joint of the other side.
    """

    roles: ClassVar[Mapping[str, str]] = {"follower": "carrier", "leader": "first", "second": "second"}

    kind: Literal["differential"]
    carrier: str
    first: str
    second: str


class PlanetarySpec(Spec):
    """A planetary gear, (1 + ratio) carrier = sun + ratio ring.

    Attributes:
        kind: Which of the tables it is.
        carrier: Name of the joint of the planets' carrier.
        sun: Name of the joint of the sun.
        ring: Name of the joint of the ring.
        ratio: Teeth of the ring over those of the sun, above 1.
    """

    roles: ClassVar[Mapping[str, str]] = {"follower": "carrier", "leader": "sun", "second": "ring"}

    kind: Literal["planetary"]
    carrier: str
    sun: str
    ring: str
    ratio: Annotated[float, QuantityRule("1")]


AnyCoupling = CouplingSpec | DifferentialSpec | PlanetarySpec
"""A coupling; ``kind`` says which class it is."""
