"""Spellings of quantities on data sheets, rewritten as products and powers of units."""

from __future__ import annotations

import re

__all__ = ["with_point", "with_signs", "with_weights", "without_weights"]

# Signs of other alphabets and keyboards: products, minus, micro, ohm.
_SIGNS = str.maketrans({"·": "*", "⋅": "*", "∙": "*", "×": "*", "•": "*", "−": "-", "μ": "µ", "\u2126": "Ω"})
_RAISED = "⁰¹²³⁴⁵⁶⁷⁸⁹"
_LOWERED = str.maketrans(_RAISED + "⁻⁺", "0123456789-+")
_SUPERSCRIPT = re.compile(rf"[⁻⁺]?[{_RAISED}]+")

# Words for units that are known by another: kp is a German kilopond, a mil a thousandth of an inch.
_OTHER_NAMES = {
    "mil": "thou",
    "mils": "thou",
    "lbm": "pound",
    "kp": "kgf",
    "Msi": "Mpsi",
    "rev": "revolution",
    "revs": "revolution",
    "RPM": "rpm",
    "r/min": "rpm",
    "U/min": "rpm",
}
_OTHER = re.compile(rf"(?<![\w.])({'|'.join(sorted(_OTHER_NAMES, key=len, reverse=True))})(?!\w)")
# Units that are written without a sign between them (mNm, gcm2, ftlb), and with their power behind (cm2).
_SHORT = "mm|cm|dm|m|in|ft"
_GLUED = re.compile(
    rf"(?<![\w.])(?:([kMmcuµ]?N|kgf|k?gf|lbf|ozf)({_SHORT})|(m?g|kg|lb|oz)({_SHORT})|(in|ft)(lbf?|ozf?))"
    r"(s?)([2-4]?)(?!\w)"
)
_POWER = re.compile(r"(?<![\w.])((?:[kcdmuµ]?m|in|ft|[mu]?s|[km]?g|rad|deg|Hz))([2-4]|-[1-4])(?![\w.])")
_BETWEEN = re.compile(r"(?<=[A-Za-zµ°Ω)])\s*[-.]\s*(?=[A-Za-zµ°Ω(])|(?<=[0-9])[-.](?=[A-Za-zµ°Ω(])")
_BLANKS = re.compile(r"(?<=[\w)°%])\s+(?=[A-Za-zµ°Ω(])")
_WRITTEN_OUT = re.compile(r"\b(?:per|square|cubic|sq|cu|squared|cubed)\b")

# Units of mass that are weights in a force, a torque or a pressure, and those that are not taken for weights.
_WEIGHTS = re.compile(r"(?<![\w.])(lb|oz)s?(?!\w)")
_MASSES = re.compile(r"(?<![\w.])(k?g)(?!\w)")
_DECIMAL_COMMA = re.compile(r"([+-]?)([0-9]*),([0-9]+)([^0-9.,].*|)", re.DOTALL)


def with_signs(name: str) -> str:
    """Return a unit with the products and powers that its spelling means: ``gcm²`` is ``g*cm**2``.

    Args:
        name: As data sheets, spreadsheets and drawings spell it; a unit that is spelled out is left as it is.
    """
    name = _SUPERSCRIPT.sub(lambda match: f"**{match[0].translate(_LOWERED)}", name).translate(_SIGNS).strip()
    name = _OTHER.sub(lambda match: _OTHER_NAMES[match[0]], name)
    name = _POWER.sub(r"\1**\2", _GLUED.sub(_apart, name))
    if not _WRITTEN_OUT.search(name):
        name = _BLANKS.sub("*", re.sub(r"\s*([*/^])\s*", r"\1", _BETWEEN.sub("*", name)))
    return _POWER.sub(r"\1**\2", _GLUED.sub(_apart, name))


def _apart(match: re.Match[str]) -> str:
    first, second = next((match[k], match[k + 1]) for k in (1, 3, 5) if match[k] is not None)
    return f"{first}*{second}{'*s' if match[7] else ''}{'**' + match[8] if match[8] else ''}"


def with_weights(name: str) -> str:
    """Return a unit in which pounds and ounces are weights: ``oz*in`` is ``ozf*in``."""
    return _WEIGHTS.sub(r"\1f", name)


def without_weights(name: str) -> str:
    """Return a unit in which kilograms and grams are weights; whoever means them writes ``kgf``, ``gf``."""
    return _MASSES.sub(r"\1f", name)


def with_point(text: str) -> str | None:
    """Return a quantity whose number has a decimal comma with a point; None where a comma may be another.

    One comma is a decimal one unless exactly three digits are behind it, which may be thousands; ``0,125``
    is none of thousands.

    Args:
        text: A number with its unit, such as ``0,2 mm``.
    """
    match = _DECIMAL_COMMA.fullmatch(text)
    if match is None:
        return None
    sign, whole, behind, rest = match.groups()
    if len(behind) == 3 and whole.lstrip("0"):
        return None
    return f"{sign}{whole or '0'}.{behind}{rest}"
