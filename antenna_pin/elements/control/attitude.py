"""Sampled control of the base's attitude by wheels."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import check_takes, takes
from antenna_pin.base.parameters import check, parameter
from antenna_pin.elements.control.controller import Now, SampledController, limited
from antenna_pin.elements.control.measurement import Measure
from antenna_pin.elements.control.pid import Course
from antenna_pin.errors import InvalidParameterError

Array = NDArray[np.float64]

# --- quaternions xyzw of attitudes: products, turns from one to another ---


def quaternion_of(turn: Array) -> Array:
    """Return the quaternion of a rotation vector [rad]."""
    size = float(np.linalg.norm(turn))
    half = 0.5 * size
    return np.append(turn * (0.5 if size == 0.0 else math.sin(half) / size), math.cos(half))


def product_of(first: Array, second: Array) -> Array:
    """Return the quaternion of one rotation followed by another in its axes."""
    a, b = first[:3], second[:3]
    return np.append(first[3] * b + second[3] * a + np.cross(a, b), first[3] * second[3] - a @ b)


def between_quaternions(first: Array, second: Array) -> Array:
    """Return the shorter rotation between two attitudes, in axes of the first."""
    found = product_of(np.append(-first[:3], first[3]), second)
    return found if found[3] >= 0.0 else -found


def turned_back(quaternion: Array, vector: Array) -> Array:
    """Return a vector in axes rotated by a quaternion."""
    a, w = -quaternion[:3], quaternion[3]
    across = 2.0 * np.cross(a, vector)
    return np.asarray(vector + w * across + np.cross(a, across))


@takes()
@dataclass(frozen=True, kw_only=True)
class AttitudeFeedback(SampledController):
    r"""Feedback of the base's quaternion and rate, by wheels.

    .. math:: T = -2 K_p \, \mathrm{sgn}(\eta) \, \epsilon - K_d (\omega - \omega_t)
        + J \alpha_t + \omega_t \times J \omega_t, \quad (\epsilon, \eta) = q_t^{-1} q

    T is the torque that the base is to feel and omega its angular velocity, both in its own axes, and
    (epsilon, eta) the quaternion of its attitude from the target's. Of small errors :math:`2 \epsilon` is the
    angle. The sign turns it the shorter way. A target that slews goes from ``begin`` to ``target`` about the
    one axis that leads there, by the share of the angle that ``share`` gives over time: omega_t and alpha_t
    are its rate and acceleration, and J the inertia that is fed forward.

    Wheels with axes w in base axes, whose drives are commanded with torques u on the wheels, give
    :math:`-\sum w u`: u is the least that gives T. Where one would be beyond its limit, all are made smaller
    alike, so that the torque keeps its direction.

    Attributes:
        acts_on: Drives of the wheels.
        kp: K_p, about the base's axes [N*m/rad].
        kd: K_d, likewise [N*m*s/rad].
        target: Attitude to be held or slewed to, a rotation vector in the world [rad].
        begin: Attitude from which it slews, likewise [rad].
        share: Of the way to the target, 1 behind it; in Python also a function of time that gives value, rate
            and acceleration [-].
        inertia: J, about the base's axes: of all that turns with it [kg*m^2].
        axes: Of the wheels, base axes, three numbers each [-]; if left out, those of their joints at the
            start.
        limit: Largest torque of a wheel [N*m]; none if not given.
    """

    acts_on: tuple[str, ...]
    kp: tuple[float, float, float] = parameter("N*m/rad", sizes=(3,), rule="zero or more")
    kd: tuple[float, float, float] = parameter("N*m*s/rad", sizes=(3,), rule="zero or more")
    target: tuple[float, float, float] = parameter("rad", sizes=(3,), default=(0.0, 0.0, 0.0))
    begin: tuple[float, float, float] = parameter("rad", sizes=(3,), default=(0.0, 0.0, 0.0))
    share: float | Course = 1.0
    inertia: tuple[float, float, float] = parameter(
        "kg*m^2", sizes=(3,), rule="zero or more", default=(0.0, 0.0, 0.0)
    )
    axes: tuple[float, ...] | None = parameter(sizes=(0,), default=None)
    limit: float | None = parameter("N*m", rule="positive", default=None)

    signals = ("error", "torque_x", "torque_y", "torque_z", "saturated")

    def __post_init__(self) -> None:
        """Check the parameters together."""
        check(self)
        if callable(self.share):
            check_takes(self, "share", self.share, "t")
        elif not 0.0 <= self.share <= 1.0:
            raise InvalidParameterError(self, "share", "from 0 to 1", self.share)
        if not self.acts_on:
            raise InvalidParameterError(self, "acts_on", "one drive or more", ())
        if self.axes is not None and len(self.axes) != 3 * len(self.acts_on):
            rule = f"three numbers for each of {len(self.acts_on)} wheels"
            raise InvalidParameterError(self, "axes", rule, self.axes)

    @property
    def measured(self) -> tuple[Measure, ...]:
        """Measured quantities."""
        return tuple(Measure(kind, axis) for kind in ("base-rotation", "base-rate") for axis in "xyz")

    def placed(self, joints: Mapping[str, str | None], axes: Mapping[str, Array | None]) -> AttitudeFeedback:
        """Return the controller with its wheels' axes in base axes, by command."""
        if self.axes is not None:
            return self
        found: list[float] = []
        for name in self.acts_on:
            axis = axes[name]
            if axis is None:
                rule = f"given: {name} acts at no joint that the base itself carries"
                raise InvalidParameterError(self, "axes", rule, None)
            found += axis.tolist()
        return dataclasses.replace(self, axes=tuple(found))

    @cached_property
    def _slew(self) -> tuple[Array, Array]:
        """Quaternion at the begin, and rotation vector to the target in base axes."""
        first, last = quaternion_of(np.array(self.begin)), quaternion_of(np.array(self.target))
        between = between_quaternions(first, last)
        sine = float(np.linalg.norm(between[:3]))
        angle = 2.0 * math.atan2(sine, float(between[3]))
        return first, between[:3] * (2.0 if sine == 0.0 else angle / sine)

    def aim(self, t: float) -> tuple[Array, Array, Array]:
        """Return the target at a time [s]: quaternion xyzw, rate, acceleration in its axes."""
        share, rate, acceleration = self.share(t) if callable(self.share) else (self.share, 0.0, 0.0)
        first, way = self._slew
        return product_of(first, quaternion_of(share * way)), rate * way, acceleration * way

    def update(self, now: Now) -> Mapping[str, float]:
        """Return the torques of the wheels from now on."""
        aim, rate, acceleration = self.aim(now.time)
        off = between_quaternions(aim, np.asarray(now.base_quaternion()))
        error, inertia = off[:3], np.array(self.inertia)
        # What the target turns by, in axes of the base: those of the target turned by the error.
        own = turned_back(off, rate)
        torque = -2.0 * np.array(self.kp) * error - np.array(self.kd) * (np.asarray(now.base_rate()) - own)
        torque += inertia * turned_back(off, acceleration) + np.cross(own, inertia * own)
        wheels = np.array(self.axes).reshape(-1, 3).T
        wished = -np.linalg.pinv(wheels) @ torque
        share = 1.0
        if self.limit is not None and np.abs(wished).max() > 0.0:
            share = limited(self.limit / float(np.abs(wished).max()), 0.0, None, (None, 1.0))
        angle = 2.0 * math.asin(min(1.0, float(np.linalg.norm(error))))
        named = dict(zip(self.signals[1:4], torque.tolist(), strict=True))
        now.note(error=angle, **named, saturated=float(share < 1.0))
        return dict(zip(self.acts_on, (share * wished).tolist(), strict=True))

    def words(self) -> str:
        """Return a description."""
        return f"attitude of the base by {', '.join(self.acts_on)}"
