"""Numbers as people read them: a sensible number of digits, prefixed units, powers of ten.

``readable(0.0002, "m")`` is "0.2 mm". Units are written as variables of a run have them (``rad/s^2``,
``N m``) and printed as rad/s² and N m. A row of a table takes one prefix for all its numbers
(:func:`prefixed`), so that they compare at a glance.
"""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Iterable, Mapping
from decimal import Decimal
from typing import Any

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
    """Return a unit in print: ``rad/s**2`` is rad/s², ``N*m`` is N m, ``1`` nothing."""
    text = unit.replace("**", "^").replace("*", " ").strip()
    return "" if text in ("1", "-") else _POWER.sub(lambda power: power[1].translate(_SUPERSCRIPTS), text)


def number(value: float | None, digits: int = 4) -> str:
    """Return a number with given significant digits, if need be a power of ten.

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


def alternatives(names: Iterable[str]) -> str:
    """Return names as a choice: "a, b or c"."""
    *others, last = names
    return f"{', '.join(others)} or {last}" if others else last


def lasting(seconds: float) -> str:
    """Return a waiting time in the largest fitting unit: "3.5 h"."""
    for size, unit in ((365.25 * 86400.0, "years"), (86400.0, "days"), (3600.0, "h"), (60.0, "min")):
        if seconds >= size:
            return f"{number(seconds / size, 2)} {unit}"
    return f"{number(seconds, 2)} s"


# --- short representation in a shell ------------------------------------------------------------------------

_LONGEST = 60
_SEVERAL = 4


def brief(self: object) -> str:
    """Return a dataclass, or a scenario's table, on one line, for ``__repr__ = brief``."""
    if dataclasses.is_dataclass(self):
        names = [item.name for item in dataclasses.fields(self) if item.repr]
    else:
        given: Any = self
        names = [n for n, f in type(given).model_fields.items() if f.repr and n in given.model_fields_set]
    said = ", ".join(f"{name}={of_size(getattr(self, name))}" for name in names)
    return f"{type(self).__name__}({said})"


def of_size(value: Any) -> str:
    """Return a value's representation, or kind and size if that is long."""
    kind = type(value).__name__
    if hasattr(value, "data_vars"):
        sizes = ", ".join(f"{size} {name}" for name, size in list(value.sizes.items())[:_SEVERAL])
        return f"<{kind}: {sizes}{', ...' if len(value.sizes) > _SEVERAL else ''}>"
    if hasattr(value, "shape") and value.shape != ():
        return f"<{kind} {' x '.join(map(str, value.shape))}>"
    if isinstance(value, Mapping):
        names = ", ".join(map(str, list(value)[:_SEVERAL]))
        return f"<{len(value)}: {names}{', ...' if len(value) > _SEVERAL else ''}>" if value else "{}"
    if isinstance(value, list | tuple) and value and not isinstance(value[0], str | int | float):
        return f"<{len(value)} of {type(value[0]).__name__}>"
    text = repr(value)
    if len(text) <= _LONGEST and "\n" not in text:
        return text
    if isinstance(value, str):
        return repr(f"{' '.join(value[: _LONGEST - 3].split())}...")
    return f"<{len(value)} of {type(value[0]).__name__}>" if isinstance(value, list | tuple) else f"<{kind}>"


# --- numbers in text ----------------------------------------------------------------------------------------
#
# Python's own ``float`` takes more than a number that somebody has written: ``1_0`` is 10 to it, so are
# digits of other scripts, and ``infinity`` and ``nan`` are numbers. Pinocchio's parser, TOML and a
# spreadsheet each read another part of that. Here a number is what all of them take it for.

#: A number in decimal digits, as a regular expression.
DECIMAL = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"

_DECIMAL = re.compile(DECIMAL)
_WHOLE = re.compile(r"[+-]?[0-9]+")
_INFINITE = re.compile(r"([+-]?)inf(?:inity)?", re.IGNORECASE)
_BLANKS = " \t\r\n"
_MOST_LETTERS = 1000  # letters of a number; Python refuses to read whole ones of some thousand


def decimal_in(text: str, *, infinite: bool = False) -> float | None:
    """Return the finite number in a text, without surrounding blanks; None if invalid.

    Args:
        text: ASCII digits, with sign, point and exponent or without.
        infinite: Whether ``inf`` and what is too large for a double are numbers too.
    """
    word = text.strip(_BLANKS)
    if len(word) > _MOST_LETTERS:
        return None
    if _DECIMAL.fullmatch(word):
        number = float(word)
        return number if infinite or math.isfinite(number) else None
    endless = _INFINITE.fullmatch(word) if infinite else None
    return None if endless is None else float(f"{endless[1]}inf")


def whole_in(text: str) -> int | None:
    """Return the whole number in a text, without surrounding blanks; None if invalid."""
    word = text.strip(_BLANKS)
    return int(word) if len(word) <= _MOST_LETTERS and _WHOLE.fullmatch(word) else None


def bare(text: str) -> str | float:
    """Return the number in a text, in SI units; else the text itself."""
    number = decimal_in(text)
    return text.strip() if number is None else number
