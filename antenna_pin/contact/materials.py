"""Bearing materials and pairs of them: elastic constants, density, typical restitution and friction.

The tables are short on purpose, and every entry says where it comes from. Elastic constants of one alloy
differ by a few per cent between sources; restitution and friction are no constants of a pair at all (they
change with speed, finish, film and vacuum), so that their numbers are a place to start from. A scenario
brings its own materials under ``[materials.NAME]``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from antenna_pin.base.arguments import takes
from antenna_pin.base.material import Material
from antenna_pin.errors import InvalidParameterError

__all__ = ["MATERIALS", "MATERIAL_PAIRS", "Material", "MaterialPair", "material_pairs"]


@takes()
@dataclass(frozen=True, slots=True, kw_only=True)
class MaterialPair:
    """Typical restitution and friction of two materials in one condition; NaN where no source was found.

    Attributes:
        first: Name of a material.
        second: Name of a material.
        condition: Of the surfaces.
        source: Where the numbers come from.
        restitution: Coefficient of restitution [-].
        static: Coefficient of static friction [-].
        dynamic: Coefficient of dynamic friction [-].
    """

    first: str
    second: str
    condition: str
    source: str
    restitution: float = math.nan
    static: float = math.nan
    dynamic: float = math.nan

    def __post_init__(self) -> None:
        """Check what is given."""
        if self.restitution < 0.0 or self.restitution > 1.0:
            raise InvalidParameterError(self, "restitution", "in [0, 1]")
        for name in ("static", "dynamic"):
            if getattr(self, name) < 0.0:
                raise InvalidParameterError(self, name, "zero or more")


_DELFT = "table of the course AEASM1x, Introduction to Aerospace Structures and Materials, TU Delft"

MATERIALS: Mapping[str, Material] = MappingProxyType(
    {
        "steel": Material(
            young=207e9,
            poisson=0.3,
            density=7800.0,
            source="assumed: usual in the literature on clearance joints; Bai and Zhao 2020 give none",
        ),
        "steel-52100": Material(
            young=203e9,
            poisson=0.3,
            density=7830.0,
            source="data sheet of AISI 52100 bearing balls (29.5e6 psi, 0.283 lb/in^3); poisson assumed",
        ),
        "steel-440c": Material(
            young=200e9,
            poisson=0.28,
            density=7700.0,
            source="makeitfrom.com, annealed AISI 440C; 7650 kg/m^3 elsewhere",
        ),
        "steel-301": Material(young=193e9, poisson=0.3, density=8000.0, source=f"{_DELFT}, AISI 301"),
        "aluminium-2024-t3": Material(
            young=72e9, poisson=0.33, density=2780.0, source=f"{_DELFT}, AA 2024-T3"
        ),
        "titanium-6al-4v": Material(young=114e9, poisson=0.34, density=4430.0, source=f"{_DELFT}, Ti6Al-4V"),
        "brass": Material(
            young=101e9,
            poisson=0.35,
            density=8490.0,
            source="Dowling, Mechanical Behavior of Materials, table 5.2 (70Cu-30Zn); density: middle of the "
            "520 to 540 lb/ft^3 of Gere, Mechanics of Materials",
        ),
        "bronze": Material(
            young=104e9,
            poisson=0.34,
            density=8490.0,
            source="Gere, Mechanics of Materials: 96 to 120 GPa, 510 to 550 lb/ft^3, a middle taken; 104 GPa "
            "in teaching tables",
        ),
        "silicon-nitride": Material(
            young=310e9,
            poisson=0.27,
            density=3290.0,
            source="Lily Bearing, ceramic materials and their properties, HP-Si3N4",
        ),
        "nylon-66": Material(
            young=2.7e9,
            poisson=0.41,
            density=1130.0,
            source="Dowling, Mechanical Behavior of Materials, table 5.2 (dry); density: middle of 1.10 to "
            "1.15 g/cm^3, finemech.com",
        ),
    }
)

_TRIBONET = "tribonet.org, friction coefficient tables in air and vacuum"

MATERIAL_PAIRS: tuple[MaterialPair, ...] = (
    MaterialPair(
        first="steel",
        second="steel",
        condition="as simulated in the literature on clearance joints",
        restitution=0.9,
        static=0.15,
        dynamic=0.10,
        source="Bai and Zhao 2020, Int. J. Aerospace Eng. 8846177, table 2",
    ),
    MaterialPair(
        first="steel-52100",
        second="steel-52100",
        condition="dry, in air and in vacuum",
        dynamic=0.5,
        source=f"{_TRIBONET}: chromium steel",
    ),
    MaterialPair(
        first="steel-52100",
        second="steel-52100",
        condition="film of MoS2, in vacuum",
        dynamic=0.06,
        source=f"{_TRIBONET}: chromium steel on MoS2",
    ),
    MaterialPair(
        first="steel-301",
        second="steel-301",
        condition="dry, in air",
        dynamic=0.5,
        source=f"{_TRIBONET}: stainless steel",
    ),
    MaterialPair(
        first="steel-301",
        second="steel-301",
        condition="dry, in vacuum",
        dynamic=2.9,
        source=f"{_TRIBONET}: stainless steel; it seizes",
    ),
    MaterialPair(
        first="steel",
        second="bronze",
        condition="dry, in air",
        static=0.35,
        source=f"{_TRIBONET}: steel on phosphor bronze",
    ),
    MaterialPair(
        first="steel",
        second="brass",
        condition="dry, in air",
        static=0.35,
        source=f"{_TRIBONET}: steel on brass; 0.51 for mild steel",
    ),
    MaterialPair(
        first="steel",
        second="aluminium-2024-t3",
        condition="dry, in air",
        static=0.61,
        dynamic=0.47,
        source="A. J. DeMello, coefficient of friction tables, Lawrence Berkeley National Laboratory: mild "
        "steel on aluminium",
    ),
)


@takes()
def material_pairs(first: str, second: str) -> tuple[MaterialPair, ...]:
    """Return what is known of two materials, by name in either order; empty if nothing is."""
    return tuple(pair for pair in MATERIAL_PAIRS if {pair.first, pair.second} == {first, second})
