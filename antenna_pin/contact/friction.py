r"""Friction laws: force on the journal over normal force and slip velocity.

Every law opposes the slip: with slip velocity :math:`v` of the journal's material point over the bearing's,
:math:`F_t = -\mu(|v|) F_n v / |v|`. Laws with a state of their own (bristles) set ``states`` to the number
of integrated values per contact; the state lives in the integrator's state vector.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from antenna_pin.contact import _kernels
from antenna_pin.errors import InvalidParameterError

__all__ = [
    "Ambrosio",
    "CompiledFrictionLaw",
    "CustomFriction",
    "FrictionLaw",
    "NoFriction",
    "Tanh",
    "VelocityBased",
]


@runtime_checkable
class FrictionLaw(Protocol):
    """What a friction law of the slip speed must offer."""

    def coefficient(self, speed: float) -> float:
        """Return the friction coefficient mu at a slip speed [m/s] >= 0; at least 0 [-]."""


class CompiledFrictionLaw:
    """The shared face of the laws whose arithmetic is a compiled kernel."""

    __slots__ = ()

    @property
    def states(self) -> int:
        """Integrated values per contact that the law carries [-]."""
        return _kernels.BRISTLE_SIZE if self.code()[0] >= _kernels.BRISTLE else 0

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (12,), for the fused kernels."""
        raise NotImplementedError

    def coefficient(self, speed: float) -> float:
        """Return the friction coefficient at a slip speed [m/s] >= 0; at least 0 [-]."""
        return float(_kernels.friction_ratio(self.code(), speed) * speed)


def _code(kind: float, *parameters: float) -> NDArray[np.float64]:
    code = np.zeros(_kernels.FRICTION_SIZE)
    code[0] = kind
    code[1 : 1 + len(parameters)] = parameters
    return code


def _check_coefficient(law: object, name: str) -> None:
    if not 0.0 <= getattr(law, name) < np.inf:
        raise InvalidParameterError(law, name, "zero or more, and finite")


@dataclass(frozen=True, slots=True, kw_only=True)
class NoFriction(CompiledFrictionLaw):
    """No friction at all."""

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (12,)."""
        return _code(_kernels.FRICTIONLESS)


@dataclass(frozen=True, slots=True, kw_only=True)
class VelocityBased(CompiledFrictionLaw):
    r"""Velocity-based ("modified Coulomb") friction of ADAMS type, as Bai and Zhao use it, corrected.

    With :math:`y = |v| / v_s` and :math:`x = (v_d - |v|) / (v_d - v_s)`

    .. math:: \mu = \begin{cases}
        \mu_s\, y (3 - y^2) / 2 & |v| < v_s \\
        \mu_d + (\mu_s - \mu_d)\, x^2 (3 - 2x) & v_s \le |v| < v_d \\
        \mu_d & v_d \le |v| \end{cases}

    continuous with its slope. Near rest it is viscous, with slope :math:`1.5 \mu_s / v_s`: it has no
    stiction. Equation (14) of the paper has the argument of the second branch reversed, so that friction
    jumps at both ends and rises in between; and (13) applies the sign of the slip a second time. Both are put
    right here.

    Attributes:
        static: mu_s, reached at ``static_speed`` [-].
        dynamic: mu_d, from ``dynamic_speed`` on [-].
        static_speed: v_s [m/s].
        dynamic_speed: v_d, above v_s [m/s].

    References:
        Bai and Zhao (2020), Int. J. Aerospace Eng., 8846177, equations (13), (14), Table 2.
    """

    static: float = field(metadata={"unit": "1", "doc": "mu_s, at static_speed"})
    dynamic: float = field(metadata={"unit": "1", "doc": "mu_d, from dynamic_speed on"})
    static_speed: float = field(metadata={"unit": "m/s", "doc": "v_s"})
    dynamic_speed: float = field(metadata={"unit": "m/s", "doc": "v_d, above v_s"})

    def __post_init__(self) -> None:
        """Check the parameters."""
        _check_coefficient(self, "static")
        _check_coefficient(self, "dynamic")
        if not 0.0 < self.static_speed < np.inf:
            raise InvalidParameterError(self, "static_speed", "positive and finite")
        if not self.static_speed < self.dynamic_speed < np.inf:
            raise InvalidParameterError(self, "dynamic_speed", f"above static_speed = {self.static_speed}")

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (12,)."""
        return _code(
            _kernels.VELOCITY_BASED, self.static, self.dynamic, self.static_speed, self.dynamic_speed
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Ambrosio(CompiledFrictionLaw):
    r"""Coulomb friction with a linear ramp between two speeds.

    .. math:: \mu(|v|) = \mu\, c_d, \qquad
              c_d = \min\{1, \max[0, (|v| - v_0) / (v_1 - v_0)]\}

    Zero below :math:`v_0`: a joint creeps under a static load.

    Attributes:
        coefficient_of_friction: mu, from ``upper_speed`` on [-].
        lower_speed: v_0, at least 0 [m/s].
        upper_speed: v_1, above v_0 [m/s].

    References:
        Ambrosio (2003), in Virtual Nonlinear Multibody Systems, 57-81; Chen and Cui (2021), equation (19).
    """

    coefficient_of_friction: float = field(metadata={"unit": "1", "doc": "mu, from upper_speed on"})
    lower_speed: float = field(default=1e-4, metadata={"unit": "m/s", "doc": "v_0, no friction below"})
    upper_speed: float = field(default=1e-3, metadata={"unit": "m/s", "doc": "v_1, full friction above"})

    def __post_init__(self) -> None:
        """Check the parameters."""
        _check_coefficient(self, "coefficient_of_friction")
        if not 0.0 <= self.lower_speed < np.inf:
            raise InvalidParameterError(self, "lower_speed", "zero or more, and finite")
        if not self.lower_speed < self.upper_speed < np.inf:
            raise InvalidParameterError(self, "upper_speed", f"above lower_speed = {self.lower_speed}")

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (12,)."""
        return _code(_kernels.AMBROSIO, self.coefficient_of_friction, self.lower_speed, self.upper_speed)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tanh(CompiledFrictionLaw):
    r"""Coulomb friction smoothed by a hyperbolic tangent.

    .. math:: \mu(|v|) = \mu \tanh(|v| / v_t)

    Infinitely differentiable in the slip *speed's* sign change; viscous near rest with slope mu / v_t.

    Attributes:
        coefficient_of_friction: mu [-].
        transition_speed: v_t [m/s].
    """

    coefficient_of_friction: float = field(metadata={"unit": "1", "doc": "mu at high speed"})
    transition_speed: float = field(metadata={"unit": "m/s", "doc": "v_t, where mu is 76 % of its limit"})

    def __post_init__(self) -> None:
        """Check the parameters."""
        _check_coefficient(self, "coefficient_of_friction")
        if not 0.0 < self.transition_speed < np.inf:
            raise InvalidParameterError(self, "transition_speed", "positive and finite")

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (12,)."""
        return _code(_kernels.TANH, self.coefficient_of_friction, self.transition_speed)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CustomFriction:
    """A user's own friction coefficient over slip speed; slower than the built-in laws.

    Attributes:
        coefficient: ``speed [m/s] -> mu [-]``, at least 0.
    """

    coefficient: Callable[[float], float]
