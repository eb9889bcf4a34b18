"""A material's elastic constants."""

from __future__ import annotations

from dataclasses import dataclass

from antenna_pin.base.parameters import check, parameter

__all__ = ["Material"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Material:
    """An isotropic linear-elastic material.

    Attributes:
        young: Young's modulus E [Pa].
        poisson: Poisson's ratio nu [-].
        density: Mass density [kg/m^3]; not needed for contact.
        source: Source of the numbers.
    """

    young: float = parameter("Pa", rule="positive")
    poisson: float = parameter("1", rule="above -1 and at most 0.5")
    density: float | None = parameter("kg/m**3", rule="positive", default=None)
    source: str = ""

    def __post_init__(self) -> None:
        """Check the constants."""
        check(self)
