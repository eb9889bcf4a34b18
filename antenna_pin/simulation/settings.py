"""How a run is integrated and sampled."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import System
from antenna_pin.errors import InvalidParameterError
from antenna_pin.geometry import RevoluteClearance
from antenna_pin.integrate import method_named

__all__ = ["ErrorScales", "RunSettings"]


def _positive(owner: object, *names: str) -> None:
    for name in names:
        if not 0.0 < getattr(owner, name) < math.inf:
            raise InvalidParameterError(owner, name, "positive and finite")


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorScales:
    """What counts as one unit of each kind of quantity: a step's error is held below rtol (scale + |value|).

    A clearance of a fraction of a millimetre and a satellite of tonnes do not share a scale. At a clearance
    joint positions are measured in clearances. Scales of a free base are multiplied by ``base``; left out,
    that is the mass of the other bodies over the whole mass, so that errors weigh alike as momentum.

    Attributes:
        position: [m].
        angle: [rad].
        velocity: [m/s].
        angular_velocity: [rad/s].
        clearance: Position of a journal in its bearing, in multiples of the radial clearance [-]; the tilt's
            scale is that over half the bearing's length.
        clearance_velocity: Of a journal in its bearing [m/s]; over half the length for the tilt's rate.
        base: Factor on the scales of a free base [-], or None.
    """

    position: float = 1.0
    angle: float = 1.0
    velocity: float = 1.0
    angular_velocity: float = 1.0
    clearance: float = 1.0
    clearance_velocity: float = 0.01
    base: float | None = None

    def __post_init__(self) -> None:
        """Check the scales."""
        _positive(self, "position", "angle", "velocity", "angular_velocity")
        _positive(self, "clearance", "clearance_velocity")
        if self.base is not None and not 0.0 < self.base < math.inf:
            raise InvalidParameterError(self, "base", "positive and finite, or left out")

    def of(self, system: System) -> NDArray[np.float64]:
        """Return the scale of each component of [u, v, x], (2 nv + nx,); of x energies and bristles.

        That of works and losses is what the moving bodies have at a velocity of one unit of tolerance.
        """
        model = system.model
        position = np.full(model.nv, self.angle)
        velocity = np.full(model.nv, self.angular_velocity)
        for slot in system.mechanism.joints.values():
            start = slot.v.start
            linear = {"floating": 3, "planar": 2, "prismatic": 1}.get(slot.kind, 0)
            position[start : start + linear] = self.position
            velocity[start : start + linear] = self.velocity
        if system.mechanism.base == "free":
            masses = [inertia.mass for inertia in model.inertias]
            factor = self.base if self.base is not None else max(sum(masses[2:]) / sum(masses), 1e-6)
            position[:3] = factor * self.position
            position[3:6] = factor * self.angle
            velocity[:3] = factor * self.velocity
            velocity[3:6] = factor * self.angular_velocity
        for joint in system.clearances:
            slot = system.mechanism.joint(joint.name)
            play = self.clearance * joint.geometry.radial_clearance
            start = slot.v.start
            linear = 2 if joint.planar else 3
            position[start : start + linear] = play
            velocity[start : start + linear] = self.clearance_velocity
            if isinstance(joint.geometry, RevoluteClearance):
                half = 0.5 * joint.geometry.bearing_length
                # About the axis the motion angle, across it the tilt; in between, for an axis askew, the
                # finer.
                about = np.abs(slot.axis) > 1.0 - 1e-9
                position[start + 3 : start + 6] = np.where(about, self.angle, play / half)
                velocity[start + 3 : start + 6] = np.where(
                    about, self.angular_velocity, self.clearance_velocity / half
                )
        x = np.full(system.manifold.nx, math.inf)
        energies = (system.lost_normal_x, system.lost_friction_x, system.work_x, system.damper_x)
        moving = sum(i.mass for i in list(model.inertias)[2 if system.mechanism.base == "free" else 1 :])
        slow = self.clearance_velocity if system.clearances else self.velocity
        x[np.concatenate(energies)] = moving * slow**2
        x[system.bristle_x] = [
            scale
            for joint in system.clearances
            for _ in joint.contact_names
            for scale in getattr(joint.friction, "state_scales", ())
        ]
        return np.concatenate([position, velocity, x])


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSettings:
    """How a run is integrated and sampled.

    Attributes:
        method: One of ``antenna_pin.integrate.METHODS``.
        rtol: Relative tolerance of a step [-].
        scales: What the tolerance is relative to.
        step: Step of a fixed-step method [s].
        max_step: Longest step [s].
        min_step: A step below this ends the run [s].
        first_step: First trial step [s]; a small one that the control enlarges, if not given.
        max_steps: Trial steps in all after which a run ends [-]; None for no limit.
        max_wall_time: Wall time after which a run ends [s]; None for no limit.
        max_expected_steps: A run that at its present pace would need more trial steps than this to its end
            makes no way, and ends [-].
        output_rate: Samples per second besides those at events [Hz].
    """

    method: str = "dormand-prince-853"
    rtol: float = 1e-8
    scales: ErrorScales = field(default_factory=ErrorScales)
    step: float = 1e-5
    max_step: float = 1e-2
    min_step: float = 1e-14
    first_step: float | None = None
    max_steps: int | None = None
    max_wall_time: float | None = None
    max_expected_steps: float = 1e9
    output_rate: float = 1000.0

    def __post_init__(self) -> None:
        """Check the settings."""
        method_named(self.method)
        _positive(self, "rtol", "step", "max_step", "min_step", "max_expected_steps", "output_rate")
        for name in ("first_step", "max_steps", "max_wall_time"):
            if getattr(self, name) is not None:
                _positive(self, name)
