"""Damping as a multiple of the elastic force and of the rate, which does not know the approach speed."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from antenna_pin.contact import damping_kernels as kernels
from antenna_pin.contact.normal import Dissipation, ElasticLaw
from antenna_pin.errors import InvalidParameterError

__all__ = ["MarhefkaOrinDamping"]

SLOPE = {"unit": "s/m", "doc": "alpha, loss of restitution over impact speed"}


@dataclass(frozen=True, slots=True, kw_only=True)
class MarhefkaOrinDamping(Dissipation):
    r"""Hunt and Crossley's damping with a restitution that falls with the speed.

    .. math:: f = f_e(\delta) \left(1 + \tfrac32 \alpha\, \dot\delta\right)

    which asks for :math:`c_r = 1 - \alpha v_0`, as metals have it at moderate speeds. The damping does not
    know the approach speed, so that the law has no memory; :math:`\chi` is :math:`\tfrac32 \alpha v_0`.

    Attributes:
        slope: alpha, loss of restitution over impact speed [s/m].

    References:
        Marhefka and Orin (1999), IEEE Trans. Syst. Man Cybern. A 29(6), 566-572.
    """

    slope: float = field(metadata=SLOPE)

    @classmethod
    def check(cls, law: Any) -> None:
        """Refuse a negative slope."""
        if not 0.0 <= law.slope < math.inf:
            raise InvalidParameterError(law, "slope", "zero or more, and finite [s/m]")

    def code(self, elastic: ElasticLaw) -> tuple[float, dict[str, float]]:
        """Return its kind and chi over the approach speed."""
        return kernels.PROPORTIONAL, {"hysteresis_over_speed": 1.5 * self.slope}
