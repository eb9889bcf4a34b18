"""Contents of a file's tables as their classes declare them: units, rules, choices, tables.

Of each shape there are values that it admits, and sound ones to draw.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from random import Random
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from antenna_pin.base.parameters import attribute_docs
from antenna_pin.base.rules import obeys
from antenna_pin.base.units import QuantityError, quantity
from antenna_pin.contact import DISSIPATIONS, FRICTION_LAWS, NORMAL_LAWS, law_parameters
from antenna_pin.scenario._class_tables import OneOf
from antenna_pin.scenario.laws import LawChange, LawSpec
from antenna_pin.scenario.spec import Count, QuantityRule, Spec, Vector
from fuzzing.odd import Raw, odd_value

Names = Mapping[str, Sequence[str]]
"""Names that there are, by what they are of: ``joint``, ``link``, ``material``; all under ""."""

#: Stands in a path for a name that is not there yet.
NEW = "*"

# Texts that scale a unit, and the units that they may stand before.
_PREFIXES, _SCALED = ("", "m", "u", "k"), ("m", "s", "N", "Pa", "Hz")


# --- shapes ------------------------------------------------------------------------------------------------


class Shape:
    """Values that a key may hold, tables by default; each kind draws sound ones, too."""

    def _admits(self, value: Any) -> bool:
        return isinstance(value, Mapping)

    def _sound(self, chance: Random, names: Names) -> Any:
        raise NotImplementedError


@dataclass(frozen=True)
class Number(Shape):
    """A number in one of some units, that obeys a rule."""

    units: tuple[str, ...]
    rule: str = ""

    def _admits(self, value: Any) -> bool:
        try:
            return obeys(quantity(value, self.units, ""), self.rule)
        except QuantityError:
            return False

    def _sound(self, chance: Random, names: Names = {}) -> float | str:  # noqa: B006
        size = chance.choice((0.0, 1.0, 10.0 ** chance.uniform(-6, 3), 10.0 ** chance.uniform(-3, 0)))
        read = size if chance.random() < 0.7 else -size
        if not obeys(read, self.rule):
            read = next((one for one in (abs(read), 0.5, 1.0) if obeys(one, self.rule)), 0.3)
        unit = chance.choice(self.units)
        if unit == "1" or chance.random() < 0.4:
            return read
        scaled = chance.random() < 0.5 and unit.split("*")[0].split("/")[0] in _SCALED
        return f"{read!r} {chance.choice(_PREFIXES) if scaled else ''}{unit}"


@dataclass(frozen=True)
class Whole(Shape):
    """A whole number between two."""

    least: int
    most: int
    even: bool = False

    def _admits(self, value: Any) -> bool:
        if not Number(("1",))._admits(value):
            return False
        number = quantity(value, "1", "")
        return self.least <= number <= self.most and number == number // 1 and not (self.even and number % 2)

    def _sound(self, chance: Random, names: Names) -> int:
        most = min(self.most, max(self.least + 40, 40))
        number = chance.choice((self.least, chance.randint(self.least, most), most))
        return number + number % 2 if self.even else number


@dataclass(frozen=True)
class Numbers(Shape):
    """So many numbers; any number of them if no size is given."""

    of: Number
    sizes: tuple[int, ...]

    def _admits(self, value: Any) -> bool:
        if not isinstance(value, list):
            return self.of._admits(value)  # one may stand for several
        return (not self.sizes or len(value) in self.sizes) and all(map(self.of._admits, value))

    def _sound(self, chance: Random, names: Names) -> list[Any]:
        size = chance.choice(self.sizes) if self.sizes and self.sizes != (0,) else chance.randrange(5)
        numbers = [self.of._sound(chance) for _ in range(size)]
        plain = [one for one in numbers if not isinstance(one, str)]
        return sorted(plain) if chance.random() < 0.5 else numbers


@dataclass(frozen=True)
class Plain(Shape):
    """True or false, or text: one of some, or any; ``doc`` says of what."""

    type: type
    texts: tuple[str, ...] = ()
    doc: str = ""

    def _admits(self, value: Any) -> bool:
        return isinstance(value, self.type) and (not self.texts or value in self.texts)

    def _sound(self, chance: Random, names: Names) -> bool | str:
        if self.type is bool:
            return chance.random() < 0.5
        return chance.choice(self.texts) if self.texts else name_for(chance, self.doc, names)


@dataclass(frozen=True)
class Several(Shape):
    """An array of things of a shape, or of anything."""

    of: tuple[Shape, ...]

    def _admits(self, value: Any) -> bool:
        return not isinstance(value, Mapping)

    def _sound(self, chance: Random, names: Names) -> list[Any]:
        return [self._one(chance, names) for _ in range(chance.randrange(4))]

    def _one(self, chance: Random, names: Names) -> Any:
        return chance.choice(self.of)._sound(chance, names) if self.of else 1


@dataclass(frozen=True)
class Law(Shape):
    """The flat table of a law, with the parameters that laws of a family declare."""

    family: str

    @property
    def laws(self) -> Mapping[str, type[Any]]:
        """The laws by name."""
        return FRICTION_LAWS if self.family == "friction" else NORMAL_LAWS

    def parameters(self, law: str | None) -> dict[str, Number]:
        """Return the parameters of a law, or of all of the family."""
        classes = [self.laws[law]] if law in self.laws else list(self.laws.values())
        if self.family != "friction":
            classes += DISSIPATIONS.values()
        declarations = {name: each for cls in classes for name, each in law_parameters(cls).items()}
        return {
            name: Number((each.unit.replace("**exponent", "**1.5"),), each.rule)
            for name, each in declarations.items()
        }

    def _sound(self, chance: Random, names: Names) -> dict[str, Any]:
        law, often = chance.choice(list(self.laws)), 0.9 if self.family == "friction" else 0.3
        parameters = self.parameters(law).items()
        return {"law": law} | {key: of._sound(chance) for key, of in parameters if chance.random() < often}


@dataclass(frozen=True)
class Table(Shape):
    """A table of one of some classes."""

    classes: tuple[type[Spec], ...]

    def _sound(self, chance: Random, names: Names) -> dict[str, Any]:
        keys = declared(chance.choice(self.classes)).items()
        return {key: of.sound(chance, names) for key, of in keys if of.required or chance.random() < 0.4}


@dataclass(frozen=True)
class Named(Shape):
    """Tables of some shape by name, or anything by name."""

    of: tuple[Shape, ...]

    def _sound(self, chance: Random, names: Names) -> dict[str, Any]:
        several = Several(self.of)
        return {name_for(chance, "", names): several._one(chance, names) for _ in range(chance.randrange(3))}


def name_for(chance: Random, doc: str, names: Names) -> str:
    """Return a name, of the kind that a key's meaning speaks of where it does."""
    words = doc.lower().split()
    kinds = [kind for kind in names if kind and (kind in words or f"{kind}s" in words)]
    pool = names[chance.choice(kinds)] if kinds and chance.random() < 0.8 else names[""]
    return chance.choice(list(pool) or ["x"])


# --- keys of a class ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Declared:
    """A key of a table: what it may hold; nothing is known of it if there are no shapes."""

    shapes: tuple[Shape, ...]  # what it may hold
    required: bool  # whether it must be there

    def admits(self, value: Any) -> bool:
        """Return whether a value may be taken; False only if it must be refused."""
        return isinstance(value, Raw) or not self.shapes or any(one._admits(value) for one in self.shapes)

    def sound(self, chance: Random, names: Names) -> Any:
        """Return a value that the key may hold."""
        return chance.choice(self.shapes)._sound(chance, names) if self.shapes else odd_value(chance)


@functools.cache
def declared(cls: type[Spec]) -> dict[str, Declared]:
    """Return what the keys of a table may hold, those apart that no file gives."""
    docs = attribute_docs(cls)
    return {
        key: Declared(tuple(_shapes(field.annotation, field, key, docs.get(key, ""))), field.is_required())
        for key, field in cls.model_fields.items()
        if key not in cls.carried
    }


def _shapes(hint: Any, field: FieldInfo | None, key: str, doc: str) -> Iterator[Shape]:
    metadata = list(field.metadata) if field is not None else []
    if get_origin(hint) is Annotated:
        hint, *more = get_args(hint)
        metadata += more
    for item in metadata:
        # A validator is bound to the annotation that it belongs to.
        match getattr(getattr(item, "func", None), "__self__", item):
            case OneOf() as one:
                yield Table(tuple(one.tables.values()))
            case QuantityRule() as one:
                yield Number(one.unit if isinstance(one.unit, tuple) else (one.unit,), one.rule)
            case Vector() as one:
                yield Numbers(Number((one.unit,), one.rule), one.sizes)
            case Count() as one:
                yield Whole(one.least, one.most, one.even)
            case _:
                continue
        return
    origin, parts = get_origin(hint), get_args(hint)
    if origin in (Union, UnionType):
        tables = [part for part in parts if isinstance(part, type) and issubclass(part, Spec)]
        if tables:
            yield Table(tuple(tables))
        for part in parts:
            if part not in tables and part is not NoneType:
                yield from _shapes(part, None, key, doc)
    elif origin is Literal and isinstance(parts[0], str):
        yield Plain(str, tuple(part for part in parts if isinstance(part, str)))
    elif origin is Literal:
        yield Whole(parts[0], parts[-1])
    elif origin is dict:
        yield Named(tuple(_shapes(parts[1], None, key, doc)))
    elif origin in (tuple, list):
        yield Several(tuple(_shapes(parts[0], None, key, doc)))
    elif hint in (bool, int, float, str):
        plain = {bool: Plain(bool), int: Whole(0, 10**100), float: Number(("1",)), str: Plain(str, (), doc)}
        yield plain[hint]
    elif hint in (LawSpec, LawChange):
        yield Law("friction" if key == "friction" else "normal")
    elif isinstance(hint, type) and issubclass(hint, Spec):
        yield Table((hint,))


# --- places of a document ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Place:
    """A key of a table of a document, whether it is there or not."""

    path: tuple[str, ...]  # the keys that lead to it
    what: Declared  # what it may hold
    there: bool  # whether it is there


def class_of(table: Mapping[str, Any], classes: tuple[type[Spec], ...]) -> type[Spec]:
    """Return which of some classes a table is of, by the value of a key that tells."""
    for cls in classes:
        for key in ("kind", "model"):
            shapes = declared(cls)[key].shapes if key in declared(cls) else ()
            if any(isinstance(shape, Plain) and table.get(key) in shape.texts for shape in shapes):
                return cls
    return classes[0]


def places_of(cls: type[Spec], table: Mapping[str, Any], path: tuple[str, ...] = ()) -> Iterator[Place]:
    """Yield every key that a document has or may have, of the tables that are there."""
    for key, what in declared(cls).items():
        here = (*path, key)
        yield Place(here, what, key in table)
        if key in table:
            yield from _within(what.shapes, table[key], here)


def _within(shapes: tuple[Shape, ...], value: Any, path: tuple[str, ...]) -> Iterator[Place]:
    if not isinstance(value, Mapping):
        return
    for shape in shapes:
        if isinstance(shape, Table):
            yield from places_of(class_of(value, shape.classes), value, path)
        elif isinstance(shape, Law):
            kinds = [("law", shape.laws, True), ("dissipation", DISSIPATIONS, False)]
            for key, texts, required in kinds[: 1 if shape.family == "friction" else 2]:
                yield Place((*path, key), Declared((Plain(str, tuple(texts)),), required), key in value)
            for name, number in shape.parameters(value.get("law")).items():
                yield Place((*path, name), Declared((number,), False), name in value)
        elif isinstance(shape, Named) and shape.of:
            for name, entry in value.items():
                yield Place((*path, name), Declared(shape.of, False), True)
                yield from _within(shape.of, entry, (*path, name))
            yield Place((*path, NEW), Declared(shape.of, False), False)
