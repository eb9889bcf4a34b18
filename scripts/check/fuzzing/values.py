"""Values for what is declared: sound ones, ones at the edge, and ones that must be refused."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from random import Random
from typing import Any

from antenna_pin.base.parameters import RULES
from antenna_pin.base.units import QuantityError, quantity
from fuzzing.declared import (
    Choice,
    Declared,
    Flag,
    Law,
    Named,
    Number,
    Numbers,
    Several,
    Shape,
    Table,
    Text,
    Whole,
    declared,
)
from fuzzing.odd import Raw, odd_value

__all__ = ["Names", "admits", "name_for", "sound_value", "toml"]


Names = Mapping[str, Sequence[str]]
"""Names that there are, by what they are of: ``joint``, ``link``, ``material``; all under ""."""

# Texts that scale a unit.
_PREFIXES = ("", "m", "u", "k")


# --- what a shape admits -----------------------------------------------------------------------------------


def admits(what: Declared, value: Any) -> bool:
    """Return whether a value may be taken; False only if it must be refused."""
    if isinstance(value, Raw):
        return True
    return not what.shapes or any(_admits(shape, value) for shape in what.shapes)


def _admits(shape: Shape, value: Any) -> bool:
    match shape:
        case Number():
            return _is_number(shape, value)
        case Whole():
            if not _is_number(Number(("1",)), value):
                return False
            number = quantity(value, "1", "")
            fits = shape.least <= number <= shape.most
            return fits and number == number // 1 and not (shape.even and number % 2)
        case Numbers():
            if not isinstance(value, list):
                return _is_number(shape.of, value)  # one may stand for several
            fits = not shape.sizes or len(value) in shape.sizes
            return fits and all(_is_number(shape.of, one) for one in value)
        case Choice():
            return isinstance(value, str) and value in shape.texts
        case Flag():
            return isinstance(value, bool)
        case Text():
            return isinstance(value, str)
        case Several():
            return not isinstance(value, Mapping)
        case _:
            return isinstance(value, Mapping)


def _is_number(number: Number, value: Any) -> bool:
    try:
        read = quantity(value, number.units, "")
    except QuantityError:
        return False
    return RULES[number.rule](read)


# --- sound values ------------------------------------------------------------------------------------------


def sound_value(chance: Random, what: Declared, names: Names) -> Any:
    """Return a value that a key may hold, by what is declared of it."""
    return _sound(chance, chance.choice(what.shapes), names) if what.shapes else odd_value(chance)


def _sound(chance: Random, shape: Shape, names: Names) -> Any:
    match shape:
        case Number():
            return _number(chance, shape)
        case Whole():
            most = min(shape.most, max(shape.least + 40, 40))
            found = chance.choice((shape.least, chance.randint(shape.least, most), most))
            return found + found % 2 if shape.even else found
        case Numbers():
            size = chance.choice(shape.sizes) if shape.sizes and shape.sizes != (0,) else chance.randrange(5)
            found = [_number(chance, shape.of) for _ in range(size)]
            plain = [one for one in found if not isinstance(one, str)]
            return sorted(plain) if chance.random() < 0.5 else found
        case Choice():
            return chance.choice(shape.texts)
        case Flag():
            return chance.random() < 0.5
        case Text():
            return name_for(chance, shape.doc, names)
        case Several():
            return [
                _sound(chance, chance.choice(shape.of), names) if shape.of else 1
                for _ in range(chance.randrange(4))
            ]
        case Law():
            return _law(chance, shape)
        case Table():
            return table_of(chance, chance.choice(shape.classes), names)
        case Named():
            count = chance.randrange(3)
            return {
                name_for(chance, "", names): _sound(chance, chance.choice(shape.of), names) if shape.of else 1
                for _ in range(count)
            }
    raise TypeError(f"{shape} has no value")


def _number(chance: Random, number: Number) -> float | str:
    size = chance.choice((0.0, 1.0, 10.0 ** chance.uniform(-6, 3), 10.0 ** chance.uniform(-3, 0)))
    read = size if chance.random() < 0.7 else -size
    if not RULES[number.rule](read):
        read = next((one for one in (abs(read), 0.5, 1.0) if RULES[number.rule](one)), 0.3)
    unit = chance.choice(number.units)
    if unit == "1" or chance.random() < 0.4:
        return read
    if (
        chance.random() < 0.5
        and unit[0].isalpha()
        and unit.split("*")[0].split("/")[0] in ("m", "s", "N", "Pa", "Hz")
    ):
        return f"{read!r} {chance.choice(_PREFIXES)}{unit}"
    return f"{read!r} {unit}"


def name_for(chance: Random, doc: str, names: Names) -> str:
    """Return a name, of the kind that a key's meaning speaks of where it does."""
    words = doc.lower().split()
    kinds = [kind for kind in names if kind and (kind in words or f"{kind}s" in words)]
    pool = names[chance.choice(kinds)] if kinds and chance.random() < 0.8 else names[""]
    return chance.choice(list(pool) or ["x"])


def _law(chance: Random, shape: Law) -> dict[str, Any]:
    law = chance.choice(list(shape.laws))
    parameters = shape.parameters(law)
    table: dict[str, Any] = {"law": law}
    for name, number in parameters.items():
        if chance.random() < (0.9 if shape.family == "friction" else 0.3):
            table[name] = _number(chance, number)
    return table


def table_of(chance: Random, cls: Any, names: Names, most: float = 0.4) -> dict[str, Any]:
    """Return a table of a class: what is required, and some of the rest."""
    return {
        key: sound_value(chance, what, names)
        for key, what in declared(cls).items()
        if what.required or chance.random() < most
    }


# --- TOML --------------------------------------------------------------------------------------------------


def toml(value: Any) -> str:
    """Return a value as TOML text."""
    if isinstance(value, Raw):
        return value.text
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return hex(value) if abs(value) > 10**4000 and value > 0 else str(value)
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, str):
        return '"' + "".join(_escaped(letter) for letter in value) + '"'
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{toml(str(key))} = {toml(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(toml, value)) + "]"
    return value.isoformat() if hasattr(value, "isoformat") else str(value)


def _escaped(letter: str) -> str:
    if letter in '"\\':
        return f"\\{letter}"
    return letter if letter.isprintable() else f"\\U{ord(letter):08x}"
