"""Normal contact laws: force over penetration depth, penetration rate and approach speed.

A law is a small frozen dataclass over the compiled kernels. What a law needs to be run at full speed is its
``code()``, a flat array; a user's own law without one (:class:`CustomNormal`, or any object that fulfils
:class:`NormalLaw`) runs on a slower path, one Python call per touching contact and evaluation.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from antenna_pin.contact import _kernels
from antenna_pin.errors import InvalidParameterError

__all__ = ["CompiledNormalLaw", "CustomNormal", "Hertz", "LankaraniNikravesh", "NormalLaw"]

_STIFFNESS = {"unit": "N/m**exponent", "doc": "K, force at unit depth"}
_EXPONENT = {"unit": "1", "doc": "n of K depth^n; 3/2 for Hertz"}
_RESTITUTION = {"unit": "1", "doc": "coefficient of restitution asked for, in [0, 1]"}


@runtime_checkable
class NormalLaw(Protocol):
    """What a normal law must offer; :class:`CustomNormal` makes one from functions."""

    def force(self, depth: float, rate: float, approach_speed: float) -> float:
        """Return the normal force on the journal [N], zero in free flight."""

    def elastic_force(self, depth: float) -> float:
        """Return the part of the force that derives from a potential [N]."""

    def elastic_energy(self, depth: float) -> float:
        """Return the energy stored at ``depth`` [J]."""


class CompiledNormalLaw:
    """The shared face of the laws whose arithmetic is a compiled kernel."""

    __slots__ = ()

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (16,), for the fused kernels."""
        raise NotImplementedError

    def force(self, depth: float, rate: float, approach_speed: float) -> float:
        """Return the normal force on the journal [N], never negative.

        Args:
            depth: Penetration depth [m]; zero or less is free flight.
            rate: Penetration rate [m/s], positive while closing.
            approach_speed: Rate at first touch of this contact [m/s], positive.
        """
        if depth <= 0.0:
            return 0.0
        return float(_kernels.normal_force(self.code(), depth, rate, approach_speed))

    def elastic_force(self, depth: float) -> float:
        """Return the part of the force that derives from a potential [N]."""
        return float(_kernels.elastic_force(self.code(), depth)) if depth > 0.0 else 0.0

    def elastic_energy(self, depth: float) -> float:
        """Return the energy stored at ``depth`` [J]: the integral of the elastic force from 0."""
        return float(_kernels.elastic_energy(self.code(), depth))


def _check_power_law(law: Hertz | LankaraniNikravesh) -> None:
    # Written so that NaN fails too.
    if not 0.0 < law.stiffness < np.inf:
        raise InvalidParameterError(law, "stiffness", "positive and finite")
    if not 1.0 <= law.exponent <= 4.0:
        raise InvalidParameterError(law, "exponent", "in [1, 4]")


def _code(elastic: float, dissipation: float, *parameters: float, chi: float = 0.0) -> NDArray[np.float64]:
    code = np.zeros(_kernels.NORMAL_SIZE)
    code[_kernels.ELASTIC] = elastic
    code[_kernels.DISSIPATION] = dissipation
    start = _kernels.ELASTIC_PARAMETERS
    code[start : start + len(parameters)] = parameters
    code[_kernels.DISSIPATION_PARAMETERS] = chi
    return code


@dataclass(frozen=True, slots=True, kw_only=True)
class Hertz(CompiledNormalLaw):
    r"""Elastic contact without dissipation.

    .. math:: f = K \delta^n

    Holds for elastic bodies whose contact patch is small against their radii. With n = 3/2 it is the contact
    of two spheres; for a journal in a bore it is used with the internal radius
    :math:`R_i R_j / (R_i - R_j)` (see :mod:`antenna_pin.contact.stiffness`). Delivers a restitution of 1.

    Attributes:
        stiffness: K [N/m^n].
        exponent: n [-]; 3/2 for Hertz contact.

    References:
        Hertz (1881), J. reine angew. Math. 92, 156-171.
    """

    stiffness: float = field(metadata=_STIFFNESS)
    exponent: float = field(default=1.5, metadata=_EXPONENT)

    def __post_init__(self) -> None:
        """Check the parameters."""
        _check_power_law(self)

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (16,)."""
        return _code(_kernels.POWER, _kernels.CONSERVATIVE, self.stiffness, self.exponent)


@dataclass(frozen=True, slots=True, kw_only=True)
class LankaraniNikravesh(CompiledNormalLaw):
    r"""Hertzian spring with hysteresis damping set by the restitution.

    .. math:: f = K \delta^n \left[1 + \tfrac34 (1 - c_r^2)\,
              \dot\delta / \dot\delta_0\right], \quad f \ge 0

    Derived for restitution near 1: asked 0.9 it yields 0.913, asked 0.5, 0.73. A law of this form delivers
    the restitution :math:`c` that solves :math:`\chi (1 + c) = \ln[(1 + \chi) / (1 - \chi c)]`,
    :math:`\chi = \tfrac34 (1 - c_r^2)`, whatever the mass, the stiffness, the exponent and the speed.

    Attributes:
        stiffness: K [N/m^n].
        restitution: c_r, in [0, 1] [-].
        exponent: n [-]; 3/2 for Hertz contact.

    References:
        Lankarani and Nikravesh (1990), J. Mech. Des. 112(3), 369-376.
    """

    stiffness: float = field(metadata=_STIFFNESS)
    restitution: float = field(metadata=_RESTITUTION)
    exponent: float = field(default=1.5, metadata=_EXPONENT)

    def __post_init__(self) -> None:
        """Check the parameters."""
        _check_power_law(self)
        if not 0.0 <= self.restitution <= 1.0:
            raise InvalidParameterError(self, "restitution", "in [0, 1]")

    @property
    def hysteresis(self) -> float:
        """Hysteresis damping factor chi of ``1 + chi rate / approach_speed`` [-]."""
        return 0.75 * (1.0 - self.restitution**2)

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (16,)."""
        return _code(_kernels.POWER, _kernels.HYSTERETIC, self.stiffness, self.exponent, chi=self.hysteresis)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CustomNormal:
    """A user's own normal law from plain or ``numba.njit`` functions; slower than the built-in laws.

    Attributes:
        force: ``(depth [m], rate [m/s], approach_speed [m/s]) -> [N]``, called at positive depth only.
        elastic_force: ``depth [m] -> [N]``, the part of the force with a potential; what ``force`` adds to it
            counts as dissipation in the energy ledger.
        elastic_energy: ``depth [m] -> [J]``, the integral of ``elastic_force`` from 0.
    """

    force: Callable[[float, float, float], float]
    elastic_force: Callable[[float], float]
    elastic_energy: Callable[[float], float]
