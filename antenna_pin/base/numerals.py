"""Numbers as text has them: one reading for files, tables and options, with units or without.

Python's own ``float`` takes more than a number that somebody has written: ``1_0`` is 10 to it, so are digits
of other scripts, and ``infinity`` and ``nan`` are numbers. Pinocchio's parser, TOML and a spreadsheet each
read another part of that. Here a number is what all of them take it for.
"""

from __future__ import annotations

import math
import re

__all__ = ["DECIMAL", "bare", "decimal_in", "whole_in"]

#: A number in decimal digits, as a regular expression.
DECIMAL = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"

_DECIMAL = re.compile(DECIMAL)
_WHOLE = re.compile(r"[+-]?[0-9]+")
_INFINITE = re.compile(r"([+-]?)inf(?:inity)?", re.IGNORECASE)
_BLANKS = " \t\r\n"
_LONGEST = 1000  # letters of a number; Python refuses to read whole ones of some thousand


def decimal_in(text: str, *, infinite: bool = False) -> float | None:
    """Return the finite number that a text is, blanks around it left out; None if it is none.

    Args:
        text: ASCII digits, with sign, point and exponent or without.
        infinite: Whether ``inf`` and what is too large for a double are numbers too.
    """
    word = text.strip(_BLANKS)
    if len(word) > _LONGEST:
        return None
    if _DECIMAL.fullmatch(word):
        number = float(word)
        return number if infinite or math.isfinite(number) else None
    endless = _INFINITE.fullmatch(word) if infinite else None
    return None if endless is None else float(f"{endless[1]}inf")


def whole_in(text: str) -> int | None:
    """Return the whole number that a text is, blanks around it left out; None if it is none."""
    word = text.strip(_BLANKS)
    return int(word) if len(word) <= _LONGEST and _WHOLE.fullmatch(word) else None


def bare(text: str) -> str | float:
    """Return the number that a text is, in SI units then; else the text, which may carry a unit."""
    number = decimal_in(text)
    return text.strip() if number is None else number
