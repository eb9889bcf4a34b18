"""A material's elastic constants, strength, hardness and thermal expansion."""

from __future__ import annotations

from dataclasses import dataclass

from antenna_pin.base.parameters import check, parameter
from antenna_pin.errors import InvalidParameterError


@dataclass(frozen=True, slots=True, kw_only=True)
class Material:
    """An isotropic linear-elastic material.

    Motions need the elastic constants only. Strengths bound contact stress, expansion decides dimensions over
    temperature; a value that is not known is None, and is never guessed.

    Attributes:
        young: Young's modulus E [Pa].
        poisson: Poisson's ratio nu [-].
        density: Mass density [kg/m^3]; not needed for contact.
        yield_strength: Yield limit in tension, 0.2 % proof stress [Pa]; None if unknown.
        ultimate_strength: Ultimate tensile strength [Pa]; None if unknown.
        hardness: Indentation hardness, 9.807 MPa for a Brinell or Vickers number of 1 [Pa]; None if unknown.
        expansion: Coefficient of thermal expansion, the mean from 20 degC [1/K]; None if unknown.
        source: Source of the numbers; of strengths, hardness and expansion unless these have their own.
        strength_source: Source of yield and ultimate strength.
        hardness_source: Source of the hardness.
        expansion_source: Source of the expansion.
    """

    young: float = parameter("Pa", rule="positive")
    poisson: float = parameter("1", rule="above -1 and at most 0.5")
    density: float | None = parameter("kg/m**3", rule="positive", default=None)
    yield_strength: float | None = parameter("Pa", rule="positive", default=None)
    ultimate_strength: float | None = parameter("Pa", rule="positive", default=None)
    hardness: float | None = parameter("Pa", rule="positive", default=None)
    expansion: float | None = parameter("1/K", default=None)
    source: str = ""
    strength_source: str = ""
    hardness_source: str = ""
    expansion_source: str = ""

    def __post_init__(self) -> None:
        """Check the constants."""
        check(self)
        lower, upper = self.yield_strength, self.ultimate_strength
        if lower is not None and upper is not None and not lower <= upper:
            raise InvalidParameterError(
                self, "yield_strength", f"at most ultimate_strength = {upper:g} Pa", lower
            )

    def source_of(self, name: str) -> str:
        """Return the source of one of its numbers; "" if unknown.

        Args:
            name: Of the number, such as ``yield_strength``.
        """
        own = {
            "yield_strength": self.strength_source,
            "ultimate_strength": self.strength_source,
            "hardness": self.hardness_source,
            "expansion": self.expansion_source,
        }
        return own.get(name, "") or self.source
