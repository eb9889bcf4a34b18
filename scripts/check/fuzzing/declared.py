"""What the tables of a file may hold, as their classes declare it: units, rules, choices, tables."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from antenna_pin.base.parameters import attribute_docs
from antenna_pin.contact import DISSIPATIONS, FRICTION_LAWS, NORMAL_LAWS, law_parameters
from antenna_pin.scenario._base import Count, Quantity, Spec, Vector
from antenna_pin.scenario._kinds import OneOf
from antenna_pin.scenario.laws import LawChange, LawSpec

__all__ = [
    "NEW",
    "Choice",
    "Declared",
    "Flag",
    "Law",
    "Named",
    "Number",
    "Numbers",
    "Place",
    "Several",
    "Shape",
    "Table",
    "Text",
    "Whole",
    "class_of",
    "declared",
    "places_of",
]


#: Stands in a path for a name that is not there yet.
NEW = "*"


@dataclass(frozen=True)
class Number:
    """A number in one of some units, that obeys a rule."""

    units: tuple[str, ...]
    rule: str = ""


@dataclass(frozen=True)
class Whole:
    """A whole number between two."""

    least: int
    most: int
    even: bool = False


@dataclass(frozen=True)
class Numbers:
    """So many numbers; any number of them if no size is given."""

    of: Number
    sizes: tuple[int, ...]


@dataclass(frozen=True)
class Choice:
    """One of some texts."""

    texts: tuple[str, ...]


@dataclass(frozen=True)
class Flag:
    """True or false."""


@dataclass(frozen=True)
class Text:
    """Text of any kind; ``doc`` says of what."""

    doc: str = ""


@dataclass(frozen=True)
class Several:
    """An array of things of a shape, or of anything."""

    of: tuple[Shape, ...]


@dataclass(frozen=True)
class Law:
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
        found = {name: each for cls in classes for name, each in law_parameters(cls).items()}
        return {
            name: Number((each.unit.replace("**exponent", "**1.5"),), each.rule)
            for name, each in found.items()
        }


@dataclass(frozen=True)
class Table:
    """A table of one of some classes."""

    classes: tuple[type[Spec], ...]


@dataclass(frozen=True)
class Named:
    """Tables of some shape by name, or anything by name."""

    of: tuple[Shape, ...]


Shape = Number | Whole | Numbers | Choice | Flag | Text | Several | Law | Table | Named


@dataclass(frozen=True)
class Declared:
    """A key of a table: what it may hold; nothing is known of it if there are no shapes.

    Attributes:
        shapes: What it may hold.
        required: Whether it must be there.
    """

    shapes: tuple[Shape, ...]
    required: bool


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
        # Of a validator the annotation is asked that it belongs to.
        item = getattr(getattr(item, "func", None), "__self__", item)
        if isinstance(item, OneOf):
            yield Table(tuple(item.tables.values()))
            return
        if isinstance(item, Quantity):
            units = item.unit if isinstance(item.unit, tuple) else (item.unit,)
            yield Number(units, item.rule)
            return
        if isinstance(item, Vector):
            yield Numbers(Number((item.unit,), item.rule), item.sizes)
            return
        if isinstance(item, Count):
            yield Whole(item.least, item.most, item.even)
            return
    origin, parts = get_origin(hint), get_args(hint)
    if origin in (Union, UnionType):
        tables = [part for part in parts if isinstance(part, type) and issubclass(part, Spec)]
        if tables:
            yield Table(tuple(tables))
        for part in parts:
            if part not in tables and part is not NoneType:
                yield from _shapes(part, None, key, doc)
    elif origin is Literal:
        yield (
            Choice(tuple(part for part in parts if isinstance(part, str)))
            if isinstance(parts[0], str)
            else Whole(parts[0], parts[-1])
        )
    elif origin is dict:
        yield Named(tuple(_shapes(parts[1], None, key, doc)))
    elif origin in (tuple, list):
        yield Several(tuple(_shapes(parts[0], None, key, doc)))
    elif hint is bool:
        yield Flag()
    elif hint is int:
        yield Whole(0, 10**100)
    elif hint is float:
        yield Number(("1",))
    elif hint is str:
        yield Text(doc)
    elif hint in (LawSpec, LawChange):
        yield Law("friction" if key == "friction" else "normal")
    elif isinstance(hint, type) and issubclass(hint, Spec):
        yield Table((hint,))


@dataclass(frozen=True)
class Place:
    """A key of a table of a document, whether it is there or not.

    Attributes:
        path: The keys that lead to it.
        what: What it may hold.
        there: Whether it is there.
    """

    path: tuple[str, ...]
    what: Declared
    there: bool


def class_of(table: Mapping[str, Any], classes: tuple[type[Spec], ...]) -> type[Spec]:
    """Return which of some classes a table is of, by the value of a key that tells."""
    for cls in classes:
        for what in ((key, shape) for key, of in declared(cls).items() for shape in of.shapes):
            key, shape = what
            if key in ("kind", "model") and isinstance(shape, Choice) and table.get(key) in shape.texts:
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
            yield Place((*path, "law"), Declared((Choice(tuple(shape.laws)),), True), "law" in value)
            if shape.family != "friction":
                texts = Declared((Choice(tuple(DISSIPATIONS)),), False)
                yield Place((*path, "dissipation"), texts, "dissipation" in value)
            for name, number in shape.parameters(value.get("law")).items():
                yield Place((*path, name), Declared((number,), False), name in value)
        elif isinstance(shape, Named) and shape.of:
            for name, entry in value.items():
                yield Place((*path, name), Declared(shape.of, False), True)
                yield from _within(shape.of, entry, (*path, name))
            yield Place((*path, NEW), Declared(shape.of, False), False)
