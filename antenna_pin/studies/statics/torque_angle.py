"""Torque-angle loop of a joint: stiffness, lost motion, dead band, hysteresis."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import brief
from antenna_pin.dynamics import System
from antenna_pin.scenario import Scenario

__all__ = ["DEFINITIONS", "TorqueAngleLoop", "torque_angle_loop"]

Array = NDArray[np.float64]

DEFINITIONS: Mapping[str, str] = MappingProxyType(
    {
        "stiffness": "mean slope of the loaded branches, from half of the amplitude on",
        "lost_motion": "angle between the two senses of a small torque, each applied and taken back to zero",
        "dead_band": "part of a branch with less than a twentieth of the stiffness",
        "hysteresis": "width of the loop at zero torque",
        "area": "area of the loop, lost in a cycle",
        "friction": "half of the torque between the two branches at zero mean angle",
    }
)
"""Definitions of the measures of a loop, by name."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class TorqueAngleLoop:
    """Quasi-static loop of torque over angle.

    Attributes:
        angle: Of the joint from where it began, along the path, (n,) [rad] ([m]).
        torque: On the joint's child, (n,) [N*m] ([N]).
        cycle: Of each point, 0 for the first loading, (n,).
        joint: The joint's name.
        sliding: Whether it slides.
        amplitude: Largest torque either way [N*m] ([N]).
        small_torque: Torque by which the lost motion is determined [N*m] ([N]).
        stiffness: Mean slope of the loaded branches from half of the amplitude on [N*m/rad] ([N/m]).
        stiffness_up: The same of the branch under positive torque.
        stiffness_down: The same of the branch under negative torque.
        lost_motion: Angle between the two senses of the small torque, each taken back to zero [rad] ([m]).
        dead_band: Part of a branch with less than a twentieth of the stiffness [rad] ([m]).
        hysteresis: Width of the last loop at zero torque [rad] ([m]).
        area: Area of the last loop [J].
        friction: Half of the torque between the branches in the middle of the last loop [N*m] ([N]).
        residual: Largest force out of balance over the largest force [-].
        notes: Assumptions and limits, in sentences.
        scenario: Of the mechanism; None for a system built in Python.
    """

    __repr__ = brief

    angle: Array
    torque: Array
    cycle: NDArray[np.int64]
    joint: str
    sliding: bool
    amplitude: float
    small_torque: float
    stiffness: float
    stiffness_up: float
    stiffness_down: float
    lost_motion: float
    dead_band: float
    hysteresis: float
    area: float
    friction: float
    residual: float
    notes: tuple[str, ...] = ()
    scenario: Scenario | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return the loop in plain numbers, with the definition of each measure."""
        measures = {name: {"value": getattr(self, name), "definition": DEFINITIONS[name]} for name in DEFINITIONS}
        return {
            "joint": self.joint,
            "unit": "N" if self.sliding else "N*m",
            "amplitude": self.amplitude,
            "small_torque": self.small_torque,
            **measures,
            "angle": self.angle.tolist(),
            "torque": self.torque.tolist(),
            "cycle": self.cycle.tolist(),
            "residual": self.residual,
            "notes": list(self.notes),
        }


@takes()
def torque_angle_loop(
    model: Scenario | System | str | os.PathLike[str],
    joint: str,
    amplitude: float | str,
    *,
    cycles: int = 1,
    small_torque: float | str | None = None,
    hold: Sequence[str] = (),
) -> TorqueAngleLoop:
    """Return the quasi-static torque-angle loop of a joint about the start position."""
    raise NotImplementedError
