"""Units of nearly all scenarios, as pint has them, without the third of a second that it takes to load."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

__all__ = ["LARGEST_POWER", "Unit", "common_unit"]

#: Of the powers in a unit, their product.
LARGEST_POWER = 100.0

# Of SI, whose products are units without a factor: exponents of length, mass, time, radian. A test compares
# all of them with pint.
_COHERENT = {
    "1": (0, 0, 0, 0),
    "rad": (0, 0, 0, 1),
    "m": (1, 0, 0, 0),
    "s": (0, 0, 1, 0),
    "kg": (0, 1, 0, 0),
    "N": (1, 1, -2, 0),
    "J": (2, 1, -2, 0),
    "W": (2, 1, -3, 0),
    "Pa": (-1, 1, -2, 0),
}
# A unit of SI, and how often it has one that is written.
_SCALED = {
    "%": ("1", 0.01),
    "deg": ("rad", math.pi / 180.0),
    "mrad": ("rad", 1e-3),
    "km": ("m", 1e3),
    "cm": ("m", 1e-2),
    "mm": ("m", 1e-3),
    "um": ("m", 1e-6),
    "µm": ("m", 1e-6),
    "nm": ("m", 1e-9),
    "day": ("s", 86400.0),
    "h": ("s", 3600.0),
    "min": ("s", 60.0),
    "ms": ("s", 1e-3),
    "us": ("s", 1e-6),
    "g": ("kg", 1e-3),
    "cm/s": ("m/s", 1e-2),
    "mm/s": ("m/s", 1e-3),
    "um/s": ("m/s", 1e-6),
    "deg/s": ("rad/s", math.pi / 180.0),
    "rpm": ("rad/s", math.pi / 30.0),
    "deg/s**2": ("rad/s**2", math.pi / 180.0),
    "kN": ("N", 1e3),
    "mN": ("N", 1e-3),
    "N*mm": ("N*m", 1e-3),
    "mN*m": ("N*m", 1e-3),
    "N/mm": ("N/m", 1e3),
    "kN/m": ("N/m", 1e3),
    "MN/m": ("N/m", 1e6),
    "N*m/deg": ("N*m/rad", 180.0 / math.pi),
    "kW": ("W", 1e3),
    "kPa": ("Pa", 1e3),
    "MPa": ("Pa", 1e6),
    "GPa": ("Pa", 1e9),
    "kg*mm**2": ("kg*m**2", 1e-6),
}
_CYCLES = {"Hz": 1.0, "kHz": 1e3}
_NAMES = "|".join(sorted(_COHERENT, key=len, reverse=True))
_FACTOR = re.compile(rf"({_NAMES})(?:\*\*(-?[0-9]+(?:\.[0-9]+)?))?")
_PRODUCT = re.compile(rf"{_FACTOR.pattern}(?:[*/]{_FACTOR.pattern})*")


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit as SI sees it.

    Attributes:
        factor: How much of SI's it is [-].
        dimension: Base quantities and their exponents.
        radian: Exponent of the radian.
        cycles: Whether it counts cycles, as Hz.
    """

    factor: float
    dimension: frozenset[tuple[str, float]]
    radian: float
    cycles: bool

    def fits(self, wanted: Unit) -> bool:
        """Return whether a unit converts to the wanted SI unit by a factor."""
        if self.dimension != wanted.dimension:
            return False
        if wanted.radian == 2.0 and self.radian == 2.0:  # a density: Hz is what it is over, no angle
            return True
        if wanted.radian != 0.0:  # 1/s will do for rad/s, Hz will not: it is short of 2 pi
            return self.radian in (0.0, wanted.radian) and not self.cycles
        return self.radian == 0.0


def common_unit(name: str) -> Unit | None:
    """Return one of the units above, or a product of those of SI; None for another."""
    if name in _CYCLES:
        return Unit(_CYCLES[name], frozenset({("[time]", -1.0)}), 0.0, True)
    unit, factor = _SCALED.get(name, (name or "1", 1.0))
    if not _PRODUCT.fullmatch(unit):
        return None
    sums, largest = [0.0, 0.0, 0.0, 0.0], 1.0
    for found in _FACTOR.finditer(unit):
        power = float(found[2] or 1.0)
        largest *= max(1.0, abs(power))
        sign = -power if unit[: found.start()].endswith("/") else power
        sums = [total + sign * one for total, one in zip(sums, _COHERENT[found[1]], strict=True)]
    if largest > LARGEST_POWER:
        return None
    named = zip(("[length]", "[mass]", "[time]"), (round(total, 12) for total in sums[:3]), strict=True)
    return Unit(factor, frozenset((base, power) for base, power in named if power), sums[3], False)
