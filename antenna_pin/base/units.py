"""Quantities as people write them: a bare number is SI, a string carries its unit.

``quantity("0.2 mm", "m", place)`` is 0.0002. The dimension is checked, and so are angles: a frequency [Hz]
and an angular rate [rad/s] have the same dimension but differ by 2 pi, so neither is taken for the other.
Decimal text is converted exactly and rounded once: "9.8 mm" is the float 0.0098. Units may be those of data
sheets: mNm, gcm², in-lb. Pounds and ounces are weights where a force or a torque is requested; g is standard
gravity in what holds no mass.
"""

from __future__ import annotations

import decimal
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from numbers import Real
from typing import Any

from antenna_pin.base.lazy import take_back
from antenna_pin.base.readable import DECIMAL
from antenna_pin.errors import ScenarioError

# --- common units -------------------------------------------------------------------------------------------

#: Of the powers in a unit, their product.
LARGEST_POWER = 100.0

# Of SI, whose products are units without a factor: exponents of length, mass, time, radian, temperature. A
# test compares all of them with pint.
_COHERENT = {
    "1": (0, 0, 0, 0, 0),
    "rad": (0, 0, 0, 1, 0),
    "m": (1, 0, 0, 0, 0),
    "s": (0, 0, 1, 0, 0),
    "kg": (0, 1, 0, 0, 0),
    "N": (1, 1, -2, 0, 0),
    "J": (2, 1, -2, 0, 0),
    "W": (2, 1, -3, 0, 0),
    "Pa": (-1, 1, -2, 0, 0),
    "K": (0, 0, 0, 0, 1),
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
    """Return a common unit by name, or a product of SI units; None for others."""
    if name in _CYCLES:
        return Unit(_CYCLES[name], frozenset({("[time]", -1.0)}), 0.0, True)
    unit, factor = _SCALED.get(name, (name or "1", 1.0))
    if not _PRODUCT.fullmatch(unit):
        return None
    sums, largest = [0.0] * 5, 1.0
    for found in _FACTOR.finditer(unit):
        power = float(found[2] or 1.0)
        largest *= max(1.0, abs(power))
        sign = -power if unit[: found.start()].endswith("/") else power
        sums = [total + sign * one for total, one in zip(sums, _COHERENT[found[1]], strict=True)]
    if largest > LARGEST_POWER:
        return None
    bases = ("[length]", "[mass]", "[time]", "", "[temperature]")
    named = ((base, round(total, 12)) for base, total in zip(bases, sums, strict=True) if base)
    return Unit(factor, frozenset((base, power) for base, power in named if power), sums[3], False)


# --- spellings on data sheets -------------------------------------------------------------------------------

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
_GLUED_POWER = re.compile(r"(?<![\w.])((?:[kcdmuµ]?m|in|ft|[mu]?s|[km]?g|rad|deg|Hz))([2-4]|-[1-4])(?![\w.])")
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
    name = _GLUED_POWER.sub(r"\1**\2", _GLUED.sub(_apart, name))
    if not _WRITTEN_OUT.search(name):
        name = _BLANKS.sub("*", re.sub(r"\s*([*/^])\s*", r"\1", _BETWEEN.sub("*", name)))
    return _GLUED_POWER.sub(r"\1**\2", _GLUED.sub(_apart, name))


def _apart(match: re.Match[str]) -> str:
    first, second = next((match[k], match[k + 1]) for k in (1, 3, 5) if match[k] is not None)
    return f"{first}*{second}{'*s' if match[7] else ''}{'**' + match[8] if match[8] else ''}"


def with_weights(name: str) -> str:
    """Return a unit in which pounds and ounces are weights: ``oz*in`` is ``ozf*in``."""
    return _WEIGHTS.sub(r"\1f", name)


def without_weights(name: str) -> str:
    """Return a unit with kilograms and grams as weights (``kgf``, ``gf``)."""
    return _MASSES.sub(r"\1f", name)


def with_point(text: str) -> str | None:
    """Return a quantity with a decimal point for its comma; None if ambiguous.

    One comma is a decimal one unless exactly three digits are behind it, which may be thousands; ``0,125``
    is none of thousands.
    """
    match = _DECIMAL_COMMA.fullmatch(text)
    if match is None:
        return None
    sign, whole, behind, rest = match.groups()
    if len(behind) == 3 and whole.lstrip("0"):
        return None
    return f"{sign}{whole or '0'}.{behind}{rest}"


# --- quantities ---------------------------------------------------------------------------------------------

# Unit, name of its quantities, and examples of spellings; the first that fits names a quantity.
_KINDS = {
    "1": ("a pure number", ""),
    "rad": ("an angle", "rad, deg, arcmin"),
    "m": ("a length", "m, mm, um, in"),
    "m**2": ("an area", ""),
    "m**3": ("a volume", ""),
    "s": ("a time", "s, ms, min"),
    "kg": ("a mass", "kg, g, lb"),
    "m/s": ("a speed", "m/s, mm/s"),
    "m/s**2": ("an acceleration", "m/s^2, g"),
    "m**2/s**3": ("a spectral density of acceleration", "g^2/Hz, (m/s^2)^2/Hz"),
    "rad**2/s**3": ("a spectral density of angular acceleration", ""),
    "Hz": ("a frequency", "Hz, kHz"),
    "rad/s": ("an angular rate", "rad/s, deg/s, rpm"),
    "rad/s**2": ("an angular acceleration", ""),
    "N": ("a force", "N, kN, lbf, kgf"),
    "N*m": ("a torque", "N*m, mN*m, lbf*in, kgf*cm"),
    "N*m/rad": ("a torsional stiffness", "N*m/rad, N*m/deg, N*m/arcmin"),
    "N*m*s/rad": ("a torsional damping", "N*m*s/rad"),
    "N/m": ("a stiffness", "N/m, N/mm, lbf/in"),
    "N*s/m": ("a damping", "N*s/m"),
    "W": ("a power", ""),
    "Pa": ("a pressure", "Pa, MPa, psi"),
    "kg/m**3": ("a density", "kg/m^3, g/cm^3"),
    "K": ("a temperature", "K, degC, degF"),
    "1/K": ("a coefficient of thermal expansion", "1/K, um/m/K"),
    "kg*m**2": ("a moment of inertia", "kg*m^2, g*cm^2, lb*in^2"),
}
_PURE = ("1", "-", "")

_QUANTITY = re.compile(rf"({DECIMAL})\s*(.*)", re.DOTALL)
_THOUSANDS = re.compile(r"([+-]?[1-9][0-9]{0,2}),([0-9]{3})(?![0-9,.])")
_NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)\b.*", re.IGNORECASE | re.DOTALL)
_UNIT_CHARACTERS = re.compile(r"[\w\s*/^().+\-°]*|%")
_LONGEST = 100  # letters of a quantity
_LONGEST_INTEGER = 8192  # bits; Python refuses to print much longer ones
# An exponent is one number, or a fraction; a power of a power could grow for ever.
_EXPONENT = r"[+-]?(?:[0-9]{1,2}\.[0-9]*|[0-9]{1,2}(?:/[1-9][0-9]?)?)"
_POWER = re.compile(rf"\s*(?:\*\*|\^)\s*(?:({_EXPONENT})|\(({_EXPONENT})\))(?!\s*(?:\*\*|\^|[\w.]))")
# What is a gram elsewhere is standard gravity in what holds no mass, an acceleration or its spectral density.
_GRAVITY = re.compile(r"(?<![\w.])g(?!\w)")
# Nor is a unit a number, but for the 1 of "1/s".
_BARE_NUMBER = re.compile(r"(?<![\w.])(?!1(?![\w.]))[0-9.]")


class QuantityError(ScenarioError):
    """A value that is not a quantity of the unit asked for.

    Attributes:
        reason: The message without the place: rule, value seen, way out.
    """

    def __init__(self, place: str, reason: str) -> None:
        """Compose the one-line message."""
        super().__init__(f"{place} {reason}")
        self.reason = reason


def quantity(value: object, unit: str | tuple[str, ...], place: str) -> float:
    """Return a quantity as a float in SI units.

    Args:
        value: A number, taken to be SI, or text with a unit such as ``"0.2 mm"``. NaN, infinities, booleans,
            unknown units and units of another dimension are refused.
        unit: The SI unit, such as ``"N*m"``, ``"N/m**1.5"``, or ``"1"`` for a pure number; a tuple
            if any of several will do.
        place: Where the value stands, for the message.

    Raises:
        QuantityError: With one line such as
            ``my.toml: clearance.hinge.radial_clearance must be a length [m], got '0.2 N' (force)``.
    """
    units = (unit,) if isinstance(unit, str) else unit
    try:
        return _quantity(value, units)
    except _Refused as refusal:
        raise QuantityError(place, f"must be {describe_unit(unit)}, got {shown(value)}{refusal}") from None


def any_quantity(value: object) -> tuple[float, str] | None:
    """Return a number in SI units and its text's SI unit; None if invalid.

    For values whose meaning is known elsewhere: whoever uses the number checks its dimension, by the unit.
    """
    if isinstance(value, bool) or not isinstance(value, Real | str):
        return None
    if not isinstance(value, str):
        try:
            number = float(value)
        except OverflowError:  # a whole number of hundreds of digits
            return None
        return (number, "") if math.isfinite(number) else None
    match = _QUANTITY.fullmatch(_pointed(value)) if len(value) <= _LONGEST else None
    if match is not None and match.group(2) in _SCALES:
        return _kelvin(*match.groups()), "K"
    seen = None if match is None else _parse_unit(match.group(2))
    if match is None or seen is None:
        return None
    digits, name = match.groups()
    kind = "1" if name in _PURE else _kind_of(seen)
    if not kind:
        named = ((_kind_of(one), one) for one in _as_weights(name))
        kind, seen = next(((found, one) for found, one in named if found), ("", seen))
    number = scaled(digits, seen.factor)
    if not math.isfinite(number):
        return None
    if kind:
        return number, kind
    text = _base_units(name)
    known_text = _parse_unit(text)
    return (number, text) if known_text is not None and known_text.factor == 1.0 else None


def _kind_of(own: Unit) -> str:
    """Return the SI unit of a unit's named kind; "" for none."""
    for unit in _KINDS:
        known = _known_unit(unit)
        is_counted_alike = own.cycles == known.cycles or len(own.dimension) > 1  # Hz alone is no rad/s
        if (known.dimension, known.radian) == (own.dimension, own.radian) and is_counted_alike:
            return unit
    return ""


def matching_unit(value: object, units: tuple[str, ...]) -> str | None:
    """Return the first of ``units`` that a text's unit fits; None for bare numbers."""
    for unit in units if isinstance(value, str) else ():
        try:
            _quantity(value, (unit,))
        except _Refused:
            continue
        return unit
    return None


def unit_factor(name: str, unit: str | tuple[str, ...], place: str) -> float:
    """Return what one of a unit is in SI units.

    Args:
        name: Of the unit, as a file has it; "1", "-" and nothing are pure numbers.
        unit: SI unit of what it must be, as :func:`quantity` takes it.
        place: For messages.

    Raises:
        QuantityError: It is the unit of something else, or of nothing.
    """
    units = (unit,) if isinstance(unit, str) else unit
    units = tuple(one.replace("^", "**").replace(" ", "*") for one in units)
    try:
        return quantity("1" if name.strip() in _PURE else f"1 {name}", units, place)
    except QuantityError as error:
        rule, _, hint = error.reason.partition(", got ")
        hint = hint.partition("; ")[2]
        hint = hint if "(" in hint else hint.rstrip(")")
        said = f"{rule.replace('must be', 'must be that of')}, got {name!r}"
        raise QuantityError(place, f"{said}{'; ' if hint else ''}{hint}") from None


def describe_unit(unit: str | tuple[str, ...]) -> str:
    """Return the description of a quantity in an SI unit: ``a length [m]``."""
    units = (unit,) if isinstance(unit, str) else unit
    return " or ".join(_describe(one) for one in units)


def shown(value: object) -> str:
    """Return a value on one short line, as its author would recognise it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Mapping):
        return "a table"
    if isinstance(value, int) and value.bit_length() > _LONGEST_INTEGER:
        return f"an integer of {value.bit_length()} bits"
    try:
        text = repr(list(value)) if isinstance(value, tuple) else repr(value)
    except (ValueError, RecursionError):  # an integer as long in it, or a depth without end
        return f"a {type(value).__name__} too long to print"
    if len(text) > 60 or "\n" in text:
        kind = "an array" if isinstance(value, list | tuple) else f"{type(value).__name__} "
        return kind if kind == "an array" else f"{' '.join(text.split())[:57]}..."
    return text


class _Refused(Exception):  # noqa: N818 - never leaves this module
    """Why a value is not a quantity, as it reads after the value."""


def _quantity(value: object, units: tuple[str, ...]) -> float:
    if isinstance(value, bool) or not isinstance(value, Real | str):
        raise _Refused("")
    if isinstance(value, str):
        return _from_text(value, units)
    try:
        number = float(value)
    except OverflowError:
        raise _Refused(" (not finite)") from None
    if not math.isfinite(number):
        raise _Refused(" (not finite)")
    return number


def _pointed(text: str) -> str:
    """Return the text of a quantity with the signs that Python's numbers have."""
    text = text.strip().replace("\N{MINUS SIGN}", "-")
    return (with_point(text) or text) if "," in text else text


def _from_text(written: str, units: tuple[str, ...]) -> float:
    if len(written.strip()) > _LONGEST:
        raise _Refused(f" ({len(written.strip())} letters; a quantity has at most {_LONGEST})")
    text = _pointed(written)
    if _NOT_FINITE.fullmatch(text):
        raise _Refused(" (not finite)")
    if thousands := _THOUSANDS.match(text):
        whole, behind = thousands.groups()
        raise _Refused(f" (a comma of decimals or of thousands); write {whole}.{behind} or {whole}{behind}")
    match = _QUANTITY.fullmatch(text)
    if match is None:
        raise _Refused("; write a number" + ("" if units[0] in _PURE else f" and its unit: '1 {units[0]}'"))
    digits, name = match.groups()
    if "K" in units and name in _SCALES:
        return _kelvin(digits, name)
    seen = _parse_unit(name)
    if seen is None:
        raise _Refused(f" (unit {name!r} is unknown{_examples(units)})")
    if not _is_any(seen, units):
        seen = next((one for one in _as_weights(name) if _is_any(one, units)), seen)
    if not _is_any(seen, units):
        if name == "":
            raise _Refused(f" (no unit); write '{digits} {units[0]}'")
        weight = without_weights(with_signs(name))
        heavy = _parse_unit(weight) if weight != with_signs(name) else None
        hint = f"; a weight is '{weight}'" if heavy is not None and _is_any(heavy, units) else ""
        raise _Refused(f" ({_name_of(name, seen)}){hint}")
    number = scaled(digits, seen.factor)
    if not math.isfinite(number):
        raise _Refused(" (not finite)")
    return number


# Scales of temperature with another zero: kelvin of one degree, and of its zero.
_SCALES = {
    **dict.fromkeys(("degC", "°C", "celsius"), (Fraction(1), Fraction(27315, 100))),
    **dict.fromkeys(("degF", "°F", "fahrenheit"), (Fraction(5, 9), Fraction(45967, 180))),
}


def _kelvin(digits: str, scale: str) -> float:
    """Return a temperature on another scale in kelvin, rounded once."""
    number = float(digits)
    if not abs(number) < _HOTTEST:
        raise _Refused(f" (above {_HOTTEST:g} degrees in size)")
    degree, zero = _SCALES[scale]
    return float(Fraction(digits) * degree + zero)


# Degrees beyond which nothing is solid or liquid; exact fractions of larger numbers would be long.
_HOTTEST = 1e6


def _is_any(own: Unit, units: tuple[str, ...]) -> bool:
    return any(own.fits(_known_unit(unit)) for unit in units)


def _examples(units: tuple[str, ...]) -> str:
    known = [_KINDS[unit][1] for unit in units if unit in _KINDS and _KINDS[unit][1]]
    return f"; known are {', '.join(known)} and others" if known else ""


def _as_weights(name: str) -> Iterator[Unit]:
    """Yield readings of a unit with g as gravity and pounds as forces."""
    name = with_signs(name)
    for other in (_GRAVITY.sub("g_0", name), with_weights(name)):
        found = _parse_unit(other) if other != name else None
        massless = found is not None and all(base != "[mass]" for base, _ in found.dimension)
        if found is not None and (massless or "g_0" not in other):
            yield found


def scaled(digits: str, factor: float) -> float:
    """Return a number in decimal digits times a factor, rounded once."""
    number = float(digits)
    if number == 0.0 or not math.isfinite(number) or factor == 1.0:
        return number
    # In decimal, so that the one rounding is the last step: 9.8 * 0.001 is not 0.0098 in floats.
    with decimal.localcontext() as context:
        context.prec = 60
        return float(decimal.Decimal(digits) * decimal.Decimal(repr(factor)))


def _describe(unit: str) -> str:
    if unit in _PURE:
        return _KINDS["1"][0]
    if unit in _KINDS:
        return f"{_KINDS[unit][0]} [{unit}]"
    return f"a stiffness [{unit}]" if unit.startswith("N/m**") else f"a quantity [{unit}]"


def _name_of(name: str, own: Unit) -> str:
    for unit, (kind, _) in _KINDS.items():
        known = _known_unit(unit)
        if (known.dimension, known.radian) == (own.dimension, own.radian):
            return kind.split(" ", 1)[1]
    return _base_units(name)


def _base_units(name: str) -> str:
    return f"{_registry().get_base_units(with_signs(name))[1]:~C}"


def _known_unit(name: str) -> Unit:
    unit = _parse_unit("" if name in _PURE else name)
    if unit is None:
        raise ValueError(f"{name!r} is not a unit")
    return unit


@lru_cache(maxsize=1024)
def _parse_unit(name: str) -> Unit | None:
    """Return a unit by name; None for unknown units and offsets (dB, degC)."""
    return common_unit(name) or common_unit(with_signs(name)) or _parsed(with_signs(name))


def _parsed(name: str) -> Unit | None:
    base = _POWER.sub("", name)
    if not _UNIT_CHARACTERS.fullmatch(name) or "**" in base or "^" in base or _BARE_NUMBER.search(base):
        return None
    sizes = (max(1.0, float(abs(Fraction(a or b)))) for a, b in _POWER.findall(name))
    if math.prod(sizes) > LARGEST_POWER:
        return None
    registry = _registry()
    try:
        root = registry.get_base_units(registry.Unit(name))[1]
        origin, one = (registry.Quantity(at, name).to(root).magnitude for at in (0.0, 1.0))
        powers = {str(base): float(power) for base, power in registry.Quantity(1.0, root).unit_items()}
    except Exception:  # pint raises assertion, token, type and attribute errors on text that is no unit
        return None
    if origin != 0.0 or not 0.0 < one < math.inf:
        return None
    return Unit(
        factor=_short(float(one)),
        dimension=frozenset((base, round(float(n), 12)) for base, n in root.dimensionality.items()),
        radian=powers.get("radian", 0.0),
        cycles="hertz" in str(registry.Unit(name)),
    )


def _short(factor: float) -> float:
    """Return a factor rounded to a short decimal within round-off."""
    decimals = float(f"{factor:.12g}")
    return decimals if abs(decimals - factor) <= 1e-15 * factor else factor


@lru_cache(maxsize=1)
def _registry() -> Any:
    take_back("pint")  # the command goes without it
    import pint

    return pint.UnitRegistry()
