"""Quantities on the command line: numbers are SI, text carries its unit."""

from __future__ import annotations

import re

from antenna_pin.base.numerals import DECIMAL, bare, decimal_in
from antenna_pin.cli._tables import length_text
from antenna_pin.errors import InvalidParameterError


def positive_quantity(text: str, unit: str, option: str, place: str = "contact") -> float:
    """Return what an option says in SI units, or refuse what is not positive."""
    from antenna_pin.base.units import quantity

    value = quantity(bare(text), unit, option)
    if not value > 0.0:
        raise InvalidParameterError(place, option, "positive", text)
    return value


def clearance_of(text: str, bearing_radius: float, place: str) -> float:
    """Return the radial clearance [m], or refuse what is not positive and below the bearing's radius [m]."""
    value = positive_quantity(text, "m", "--radial-clearance")
    if not value < bearing_radius:
        raise InvalidParameterError(
            place, "--radial-clearance", f"below the bearing's radius, {length_text(bearing_radius)}", text
        )
    return value


def vector_in(text: str) -> tuple[float, float, float] | None:
    """Return the three numbers of ``X,Y,Z``; None if the text is something else."""
    numbers = [decimal_in(part) for part in text.split(",")]
    x, y, z = numbers if len(numbers) == 3 else (None, None, None)
    return None if x is None or y is None or z is None else (x, y, z)


def list_of(text: str, unit: str, option: str, positive: bool = True) -> tuple[float, ...]:
    """Return the quantities of a list; one unit at its end counts for all, as in ``0.1,1,5 um``."""
    from antenna_pin.base.units import quantity

    parts = [part.strip() for part in text.split(",") if part.strip()]
    if not parts:
        raise InvalidParameterError("contact", option, "one value or more, separated by commas", text)
    shared = re.fullmatch(rf"{DECIMAL}\s*([a-zA-Zµμ].*)", parts[-1])
    if (
        shared
        and isinstance(bare(parts[-1]), str)
        and all(isinstance(bare(part), float) for part in parts[:-1])
    ):
        parts[:-1] = [f"{part} {shared.group(1)}" for part in parts[:-1]]
    if positive:
        return tuple(positive_quantity(part, unit, option) for part in parts)
    return tuple(quantity(bare(part), unit, option) for part in parts)
