"""Numbers as people read them: a sensible number of digits, prefixed units, powers of ten.

``readable(0.0002, "m")`` is "0.2 mm". Units are written as variables of a run have them (``rad/s^2``,
``N m``) and printed as rad/s² and N m. A row of a table takes one prefix for all its numbers
(:func:`prefixed`), so that they compare at a glance.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from decimal import Decimal

__all__ = ["GIVEN", "lasting", "number", "prefixed", "printed_unit", "readable"]

MISSING = "–"

GIVEN = 10
"""Digits of what people gave: as many as they wrote."""

# Size, prefix, and from where on it is taken: 1500 N reads better than 1.5 kN, and 0.25 rad than 250 mrad.
_PREFIXES = (
    (1e9, "G", 1e9),
    (1e6, "M", 1e6),
    (1e3, "k", 1e4),
    (1.0, "", 0.1),
    (1e-3, "m", 1e-4),
    (1e-6, "µ", 1e-7),
    (1e-9, "n", 1e-10),
)
# Units that take a prefix; a power on the first of a product would take it, too, and none with kg in front.
_TAKES_PREFIX = re.compile(r"(m|s|N|Hz|Pa|J|W|rad)(?![\^\w*])")
_LARGE_PREFIX = re.compile(r"(N|Hz|Pa|J|W)(?![\^\w*])")
_SUPERSCRIPTS = str.maketrans("-0123456789.", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹·")
_POWER = re.compile(r"\^(-?[\d.]+)")


def printed_unit(unit: str) -> str:
    """Return a unit as it is printed: ``rad/s**2`` is rad/s², ``N*m`` is N m, ``1`` is nothing."""
    text = unit.replace("**", "^").replace("*", " ").strip()
    return "" if text in ("1", "-") else _POWER.sub(lambda power: power[1].translate(_SUPERSCRIPTS), text)


def number(value: float | None, digits: int = 4) -> str:
    """Return a number with so many significant digits, as a power of ten where it is far from one.

    Args:
        value: The number; None and NaN give a dash.
        digits: Significant digits; zeros at the end are left out.
    """
    if value is None or math.isnan(value):
        return MISSING
    if math.isinf(value):
        return "∞" if value > 0.0 else "\N{MINUS SIGN}∞"
    rounded = Decimal(f"{value:.{digits - 1}e}")
    if rounded == 0:
        return "0"
    exponent = rounded.adjusted()
    sign = "\N{MINUS SIGN}" if rounded < 0 else ""
    if -4 <= exponent < max(digits, 5):
        text = f"{abs(rounded):f}"
        return sign + (text.rstrip("0").rstrip(".") if "." in text else text)
    mantissa = f"{abs(rounded).scaleb(-exponent).normalize():f}"
    return f"{sign}{mantissa}×10{str(exponent).translate(_SUPERSCRIPTS)}"


def prefixed(unit: str, values: Iterable[float | None]) -> tuple[float, str]:
    """Return the factor and the printed unit that bring some values into a readable range.

    The middle one by size decides. Where the smallest would then need a power of ten all the same, no prefix
    is taken.

    Args:
        unit: SI unit of the values; one with another SI unit in front than m, s, N, Hz, Pa, J, W or rad, or a
            power of one, stays as it is.
        values: The values; None, zero and what is not finite do not count.
    """
    plain = printed_unit(unit)
    written = unit.replace("**", "^").replace("*", " ")
    sizes = sorted(abs(value) for value in values if value and math.isfinite(value))
    if not sizes or not _TAKES_PREFIX.match(written):
        return 1.0, plain
    middle = sizes[len(sizes) // 2]
    for size, prefix, least in _PREFIXES:
        if middle >= least * (1.0 - 1e-12) and (size <= 1.0 or _LARGE_PREFIX.match(written)):
            return (1.0, plain) if sizes[0] < 1e-4 * size else (1.0 / size, prefix + plain)
    return 1.0, plain


def readable(value: float | None, unit: str = "1", digits: int = 4) -> str:
    """Return a quantity with its unit, which no line break parts from it: "0.2 mm"."""
    factor, printed = prefixed(unit, [value])
    text = number(None if value is None else value * factor, digits)
    return text if not printed or text == MISSING else f"{text}\N{NO-BREAK SPACE}{printed}"


def lasting(seconds: float) -> str:
    """Return a time that somebody waits, in the largest unit of which it has one or more: "3.5 h"."""
    for size, unit in ((365.25 * 86400.0, "years"), (86400.0, "days"), (3600.0, "h"), (60.0, "min")):
        if seconds >= size:
            return f"{number(seconds / size, 2)} {unit}"
    return f"{number(seconds, 2)} s"
