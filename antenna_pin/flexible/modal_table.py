"""Modes of a structure from a file, and what they must be whichever way the file has them."""

from __future__ import annotations

from dataclasses import dataclass

from antenna_pin.errors import FileFormatError

__all__ = ["FACTORS", "BadModalTableError", "ModalTable", "checked_factors", "checked_frequency"]

#: Names of the participation factors of a mode: translation, then rotation.
FACTORS = ("tx", "ty", "tz", "rx", "ry", "rz")


class BadModalTableError(FileFormatError):
    """Modal data that cannot be read, with the line."""


@dataclass(frozen=True, slots=True)
class ModalTable:
    """Modal data as a file gives them.

    Attributes:
        frequency: Of each mode [Hz].
        participation: Six numbers for each mode, one mode after the other [sqrt(kg)], [sqrt(kg) m].
        damping_ratio: Of each mode [-]; None where the file does not say.
        lines: Of each mode's factors in the file, from 1.
        reading: Headings and lines that the numbers were taken from, as text.
    """

    frequency: tuple[float, ...]
    participation: tuple[float, ...]
    damping_ratio: tuple[float, ...] | None
    lines: tuple[int, ...]
    reading: str


def checked_factors(numbers: list[float], place: str) -> list[float]:
    """Return the six factors of a mode, or refuse a mode that no hub feels."""
    if not any(numbers):
        raise BadModalTableError(
            f"{place}: {FACTORS[0]} to {FACTORS[-1]} must be other than six zeros, which no hub feels; "
            "leave the mode out"
        )
    return numbers


def checked_frequency(frequency: float, place: str) -> float:
    """Return the frequency of a mode [Hz], or refuse one that does not swing."""
    if not frequency > 0.0:
        raise BadModalTableError(
            f"{place}: frequency must be positive, got {frequency:g} Hz; "
            "a mode without one is a motion of the whole, which the link's joint has: hold the root"
        )
    return frequency
