"""Units as FMI has them: products of powers of SI units."""

from __future__ import annotations

import re

__all__ = ["powers_of"]

# Those that stand in results and scenarios beside the base units.
_DERIVED = {
    "N": {"kg": 1, "m": 1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "Hz": {"s": -1},
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "H": {"kg": 1, "m": 2, "s": -2, "A": -2},
    "ohm": {"kg": 1, "m": 2, "s": -3, "A": -2},
    **{base: {base: 1} for base in ("kg", "m", "s", "A", "K", "rad")},
}
_PART = re.compile(r"([A-Za-z]+)(?:(?:\^|\*\*)(-?\d+))?")


def powers_of(unit: str) -> dict[str, int] | None:
    """Return the powers of SI units in a unit such as ``N m/rad``; None where there are no whole ones.

    Whatever stands behind the first stroke divides.
    """
    found: dict[str, int] = {}
    for side, parts in enumerate(unit.split("/")):
        for part in parts.replace("**", "^").replace("*", " ").replace("(", " ").replace(")", " ").split():
            match = _PART.fullmatch(part)
            if match is None or match[1] not in _DERIVED:
                if part == "1" and side == 0:
                    continue
                return None
            power = int(match[2] or 1) * (-1 if side else 1)
            for base, one in _DERIVED[match[1]].items():
                found[base] = found.get(base, 0) + power * one
    return {base: power for base, power in found.items() if power} or None
