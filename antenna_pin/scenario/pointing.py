"""Pointing of the antenna: boresight, target and orbit, for analysis, not for the motion."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import model_validator

from antenna_pin.base.directions import unit
from antenna_pin.base.units import shown
from antenna_pin.scenario.spec import (
    Direction,
    PositiveLength,
    PositiveTime,
    QuantityRule,
    Spec,
    Vector3,
    refuse,
)

# Directions that are to be perpendicular, and parallel ones that may not be, are told apart to this angle.
_ANGLE = 1e-6


class OrbitSpec(Spec):
    """A circular orbit by altitude, period or rate, and its axes.

    Attributes:
        altitude: Above the Earth's equatorial radius, 6378.137 km [m].
        period: Of one revolution [s].
        rate: Of the turn about the normal [rad/s].
        normal: Orbit's normal, along the orbital angular momentum, in world axes, any length [-].
        nadir: Direction to the Earth's centre at t = 0, in world axes, square to it [-].
    """

    altitude: PositiveLength | None = None
    period: PositiveTime | None = None
    rate: Annotated[float, QuantityRule("rad/s", "positive")] | None = None
    normal: Direction = (0.0, 1.0, 0.0)
    nadir: Direction = (0.0, 0.0, -1.0)

    @model_validator(mode="after")
    def _check_orbit(self) -> Self:
        given = [name for name in ("altitude", "period", "rate") if getattr(self, name) is not None]
        if len(given) != 1:
            refuse(f"must have one of altitude, period and rate, got {' and '.join(given) or 'none'}")
        if abs(math.pi / 2 - _angle(self.normal, self.nadir)) > _ANGLE:
            refuse(
                f"must be perpendicular to normal = {shown(self.normal)}, got {shown(self.nadir)}",
                "nadir",
                value=self.nadir,
            )
        return self


class PointingSpec(Spec):
    """Boresight and target of the antenna.

    Attributes:
        body: Link that looks.
        boresight: Axis it looks along, in the link's frame, any length [-].
        up: Second axis in the link's frame [-]; None for z, or x where the boresight lies within 26 deg of z.
        commanded: Reference: an ``ideal`` run, or a direction in the ``world`` or the
            ``orbit`` (z to nadir, y against the normal).
        direction: Commanded direction in those axes, any length [-].
        direction_up: Commanded direction of ``up`` [-]; None where turns about the boresight do not matter.
        orbit: The orbit; None where none is of interest.
    """

    body: str
    boresight: Direction
    up: Direction | None = None
    commanded: Literal["ideal", "world", "orbit"] = "ideal"
    direction: Direction | None = None
    direction_up: Direction | None = None
    orbit: OrbitSpec | None = None

    @model_validator(mode="after")
    def _check_axes(self) -> Self:
        _check_second(self.up, self.boresight, "up", "boresight")
        if self.commanded == "ideal":
            for name in ("direction", "direction_up"):
                if getattr(self, name) is not None:
                    text = 'must be left out where commanded is "ideal", got '
                    refuse(f"{text}{shown(getattr(self, name))}", name, value=getattr(self, name))
            return self
        if self.direction is None:
            refuse(f'is missing; give it where commanded is "{self.commanded}"', "direction")
        _check_second(self.direction_up, self.direction, "direction_up", "direction")
        if self.commanded == "orbit" and self.orbit is None:
            refuse('is missing; give it where commanded is "orbit"', "orbit")
        return self


def _angle(a: Vector3, b: Vector3) -> float:
    """Angle between two directions [rad]."""
    one, other = unit(a), unit(b)
    return math.atan2(float(np.linalg.norm(np.cross(one, other))), float(one @ other))


def _check_second(second: Vector3 | None, axis: Vector3, name: str, other: str) -> None:
    """Refuse a second axis parallel to the first."""
    if second is None:
        return
    angle = _angle(second, axis)
    if min(angle, math.pi - angle) <= _ANGLE:
        refuse(f"must not lie along {other} = {shown(axis)}, got {shown(second)}", name, value=second)
