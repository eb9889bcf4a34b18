"""Force elements other than clearance joints: drives, springs and dampers at joints."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from antenna_pin.dynamics import _kernels
from antenna_pin.errors import InvalidParameterError

__all__ = ["CallableDrive", "ConstantDrive", "Drive", "JointSpring", "SineDrive", "TableDrive"]

Array = NDArray[np.float64]
DriveAxis = Literal["bearing", "journal"]


class _Drive:
    """What an integrator asks of every drive."""

    __slots__ = ()

    @property
    def instants(self) -> tuple[float, ...]:
        """Times at which steps must end, for the effort is not smooth there, or too curved between [s]."""
        return ()

    @property
    def longest_step(self) -> float:
        """Step that still resolves the effort, its work between the step's ends included [s]."""
        return math.inf


def _finite(element: object, *names: str) -> None:
    for name in names:
        if not math.isfinite(getattr(element, name)):
            raise InvalidParameterError(element, name, "finite")


def _check_axis(element: object, axis: str) -> None:
    if axis not in ("bearing", "journal"):
        raise InvalidParameterError(element, "axis", "bearing or journal")


@dataclass(frozen=True, slots=True, kw_only=True)
class ConstantDrive(_Drive):
    """A constant torque (a force at a prismatic joint).

    Attributes:
        joint: The URDF joint it drives; its reaction acts on the joint's parent.
        value: [N m], or [N] at a prismatic joint.
        axis: At a clearance joint: the axis of the torque, the bearing's or the journal's.
    """

    joint: str
    value: float
    axis: DriveAxis = "bearing"

    def __post_init__(self) -> None:
        """Check the value."""
        _finite(self, "value")
        _check_axis(self, self.axis)

    def code(self) -> tuple[float, Sequence[float]]:
        """Return kind and parameters for the fused kernel."""
        return _kernels.CONSTANT, (self.value,)


@dataclass(frozen=True, slots=True, kw_only=True)
class SineDrive(_Drive):
    r"""A torque :math:`A \sin(2 \pi f t + \varphi)`.

    Attributes:
        joint: The URDF joint it drives; its reaction acts on the joint's parent.
        amplitude: A [N m], or [N] at a prismatic joint.
        frequency: f [Hz].
        phase: phi [rad].
        axis: At a clearance joint: the axis of the torque, the bearing's or the journal's.
    """

    joint: str
    amplitude: float
    frequency: float
    phase: float = 0.0
    axis: DriveAxis = "bearing"

    def __post_init__(self) -> None:
        """Check the values."""
        _finite(self, "amplitude", "frequency", "phase")
        _check_axis(self, self.axis)

    def code(self) -> tuple[float, Sequence[float]]:
        """Return kind and parameters for the fused kernel."""
        return _kernels.SINE, (self.amplitude, 2.0 * math.pi * self.frequency, self.phase)

    @property
    def longest_step(self) -> float:
        """An eighth of the period [s]."""
        return 0.125 / abs(self.frequency) if self.frequency != 0.0 else math.inf


@dataclass(frozen=True, slots=True, kw_only=True)
class TableDrive(_Drive):
    """A torque from a table over time.

    Attributes:
        joint: The URDF joint it drives; its reaction acts on the joint's parent.
        times: Strictly increasing, at least two [s]. A run must lie within them.
        values: Torque at those times [N m], or [N] at a prismatic joint.
        interpolation: "linear", or "cubic" (monotone between points: no overshoot).
        axis: At a clearance joint: the axis of the torque, the bearing's or the journal's.
    """

    joint: str
    times: tuple[float, ...]
    values: tuple[float, ...]
    interpolation: Literal["linear", "cubic"] = "linear"
    axis: DriveAxis = "bearing"

    def __post_init__(self) -> None:
        """Check the table."""
        t, y = np.asarray(self.times, dtype=float), np.asarray(self.values, dtype=float)
        if t.ndim != 1 or t.size < 2 or not np.isfinite(t).all() or not (np.diff(t) > 0.0).all():
            raise InvalidParameterError(self, "times", "at least two finite, strictly increasing times")
        if y.shape != t.shape or not np.isfinite(y).all():
            raise InvalidParameterError(self, "values", f"{t.size} finite numbers, one for each time")
        if self.interpolation not in ("linear", "cubic"):
            raise InvalidParameterError(self, "interpolation", "linear or cubic")
        _check_axis(self, self.axis)

    @property
    def instants(self) -> tuple[float, ...]:
        """Its points; of cubics, whose work is of eighth degree, the middles between them too [s]."""
        if self.interpolation == "linear":
            return self.times
        middles = (0.5 * (a + b) for a, b in pairwise(self.times))
        return tuple(sorted((*self.times, *middles)))

    def code(self) -> tuple[float, Sequence[float]]:
        """Return kind and parameters for the fused kernel: knots and cubic coefficients."""
        t, y = np.asarray(self.times, dtype=float), np.asarray(self.values, dtype=float)
        if self.interpolation == "cubic":
            coefficients = PchipInterpolator(t, y).c.T
        else:
            coefficients = np.zeros((t.size - 1, 4))
            coefficients[:, 2] = np.diff(y) / np.diff(t)
            coefficients[:, 3] = y[:-1]
        return _kernels.TABLE, (float(t.size), *t.tolist(), *coefficients.ravel().tolist())


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CallableDrive(_Drive):
    """A torque from a Python function of time and motion, such as a controller; slower than the others.

    Attributes:
        joint: The URDF joint it drives; its reaction acts on the joint's parent.
        torque: ``(t [s], angle [rad], rate [rad/s]) -> [N m]``; of a clearance joint the motion angle and its
            rate. The angle counts whole turns.
        axis: At a clearance joint: the axis of the torque, the bearing's or the journal's.
    """

    joint: str
    torque: Callable[[float, float, float], float]
    axis: DriveAxis = "bearing"

    def __post_init__(self) -> None:
        """Check the axis."""
        _check_axis(self, self.axis)

    def code(self) -> tuple[float, Sequence[float]]:
        """Return kind and parameters for the fused kernel; the value is written before each evaluation."""
        return _kernels.GIVEN, (0.0,)


Drive = ConstantDrive | SineDrive | TableDrive | CallableDrive


@dataclass(frozen=True, slots=True, kw_only=True)
class JointSpring:
    r"""A linear spring and damper at a joint: :math:`\tau = -k (\phi - \phi_0) - c \dot\phi`.

    At a clearance joint phi is the motion angle and the generalized force is its exact gradient, so the
    spring conserves energy under tilt too. The angle counts whole turns: a spring wound by 200 degrees, or by
    three turns, unwinds.

    Attributes:
        joint: The URDF joint.
        stiffness: k, at least 0 [N m/rad], or [N/m] at a prismatic joint.
        damping: c, at least 0 [N m s/rad], or [N s/m].
        rest_angle: phi_0 [rad], or [m].
        shorter_way: Whether the deflection is taken the shorter way round instead, within half a turn, as of
            a magnet; it jumps from one side to the other at half a turn. Only of turning joints.
    """

    joint: str
    stiffness: float = 0.0
    damping: float = 0.0
    rest_angle: float = 0.0
    shorter_way: bool = False

    def __post_init__(self) -> None:
        """Check the values."""
        for name in ("stiffness", "damping"):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise InvalidParameterError(self, name, "zero or more, and finite")
        _finite(self, "rest_angle")

    def code(self) -> tuple[float, Sequence[float]]:
        """Return kind and parameters for the fused kernel."""
        return _kernels.SPRING, (self.stiffness, self.damping, self.rest_angle, float(self.shorter_way))
