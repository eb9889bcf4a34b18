"""Elastic constants of bearing materials.

The shipped table is short on purpose: each entry is one that a source paper of the shipped models names or
assumes. A scenario brings its own under ``[materials.NAME]``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from antenna_pin.errors import InvalidParameterError

__all__ = ["MATERIALS", "Material"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Material:
    """An isotropic linear-elastic material.

    Attributes:
        young: Young's modulus E [Pa].
        poisson: Poisson's ratio nu, in (-1, 0.5] [-].
        density: Mass density [kg/m^3]; not needed for contact.
        source: Where the numbers come from.
    """

    young: float
    poisson: float
    density: float = math.nan
    source: str = ""

    def __post_init__(self) -> None:
        """Check the constants."""
        if not 0.0 < self.young < math.inf:
            raise InvalidParameterError(self, "young", "positive and finite [Pa]")
        if not -1.0 < self.poisson <= 0.5:
            raise InvalidParameterError(self, "poisson", "in (-1, 0.5]")


MATERIALS: Mapping[str, Material] = MappingProxyType(
    {
        "steel": Material(
            young=207e9,
            poisson=0.3,
            density=7800.0,
            source="assumed: usual in the literature on clearance joints; Bai and Zhao 2020 give none",
        ),
    }
)
