"""Force elements and references: tables of all families."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Field, create_model, model_validator

from antenna_pin.base.parameters import parameters_of
from antenna_pin.elements import (
    FAMILIES,
    REFERENCES,
    AtPoint,
    BetweenJoints,
    BetweenPoints,
    Family,
    ForceElement,
    OnLinks,
)
from antenna_pin.scenario._class_tables import JointTable, MadeSpec, OneOf, Tables, made_of, name_of_table
from antenna_pin.scenario.closures import LinkPlaceSpec, PlaceSpec
from antenna_pin.scenario.spec import Spec, refuse, refuse_name


class _ForceSpec(MadeSpec):
    """A table of a force element."""

    def build(self, **more: Any) -> Any:
        """Return the element; the reference that it ``follows`` has to be given."""
        return super().build(**({"follows": None} if "follows" in type(self).model_fields else {}) | more)

    @model_validator(mode="before")
    @classmethod
    def _check_given(cls, data: Any) -> Any:
        """Refuse a table with neither the numbers that it needs nor a file of them."""
        columns = getattr(cls.fills, "columns", ())
        needed = [name for name in columns if cls.model_fields[name].is_required()]
        if needed and isinstance(data, Mapping) and not data.keys() & {"file", *needed}:
            refuse(f"must have either file, or {', '.join(needed[:-1])} and {needed[-1]}, got neither")
        return data

    @model_validator(mode="after")
    def _check_something(self) -> Self:
        """Refuse an element that does nothing."""
        names = self.fills.one_above_zero
        if names and not any(getattr(self, name, None) for name in (*names, "bearing")):
            refuse(f"must have a {' or a '.join(names)} above zero, got {'neither' if names[1:] else 'none'}")
        return self


class ElementSpec(JointTable, _ForceSpec):
    """A table of a force element at a joint."""


class JointsSpec(_ForceSpec):
    """A table of a force element between two joints, ``input`` and ``output``."""


class PointsSpec(_ForceSpec):
    """A table of a force element between points of links or world.

    Attributes:
        first: One end.
        second: The other, on another link.
    """

    first: PlaceSpec = Field(...)
    second: PlaceSpec = Field(...)

    def build(self, **more: Any) -> Any:
        """Return the element; ends that are frames have to be given."""
        said = {
            name: (side.link or side.frame, side.point or (0.0, 0.0, 0.0))
            for name, side in (("first", self.first), ("second", self.second))
        }
        return super().build(**said | more)

    @model_validator(mode="after")
    def _check_sides(self) -> Self:
        for key in ("link", "frame"):
            name = getattr(self.first, key)
            if name is not None and name == getattr(self.second, key):
                refuse(f"must be on another link than first, got {name!r}", "second", key)
        return self


class AllLinksSpec(_ForceSpec):
    """A table of a force element that acts on all links."""


class AtPointSpec(AllLinksSpec):
    """A table of a force element that acts on a link at a point.

    Attributes:
        at: Where it acts; of a torque alone a link is enough.
    """

    at: LinkPlaceSpec = Field(...)

    @model_validator(mode="after")
    def _check_point(self) -> Self:
        """Refuse a force without the point that it acts at."""
        torque = getattr(self, "torque", None)
        if torque is None or any(getattr(self, "force", ())):
            self.at.check_point("at")
        return self

    def build(self, **more: Any) -> Any:
        """Return the element; a place that is a frame has to be given."""
        said = {"at": (self.at.link or self.at.frame, self.at.point or (0.0, 0.0, 0.0))}
        return super().build(**said | more)


# What tables of elements are, by what these are; the first that fits.
_BASES: tuple[tuple[type[ForceElement], type[_ForceSpec], tuple[str, ...]], ...] = (
    (BetweenPoints, PointsSpec, ("first", "second")),
    (AtPoint, AtPointSpec, ("at",)),
    (OnLinks, AllLinksSpec, ()),
    (BetweenJoints, JointsSpec, ()),
    (ForceElement, ElementSpec, ()),
)


def _specs(family: Family) -> Tables:
    """Return the tables of a family's kinds, with or without a default kind."""

    def table(kind: str) -> type[_ForceSpec]:
        cls = family.kinds[kind]
        key: Any = (Literal[kind], kind if family.default is not None else ...)
        base, places = next((spec, places) for of, spec, places in _BASES if issubclass(cls, of))
        named: dict[str, Any] = {"follows": str | None} if "follows" in cls.__dataclass_fields__ else {}
        return made_of(cls, base, key, __name__, (*places, *cls.own_keys()), **named)

    return Tables(family.kinds, table)


FAMILY_SPECS = {table: _specs(family) for table, family in FAMILIES.items()}
"""The tables of each family by their kind."""

DRIVE_SPECS = FAMILY_SPECS["drives"]
"""The tables of drives by their kind."""

SPRING_SPECS = FAMILY_SPECS["springs"]
"""The tables of springs by their kind."""


class ReferenceSpec(JointTable, MadeSpec):
    """A table of a reference."""

    def build(self, **more: Any) -> Any:
        """Return the reference; of a sum its ``parts`` have to be given."""
        if "parts" in type(self).model_fields and "parts" not in more:
            return None
        return super().build(**more)


def _reference_table(kind: str) -> type[ReferenceSpec]:
    cls, key = REFERENCES[kind], (Literal[kind], ...)
    names: dict[str, Any] = {"parts": tuple[str, ...]} if "parts" in cls.__dataclass_fields__ else {}
    return made_of(cls, ReferenceSpec, key, __name__, (), **names)


REFERENCE_SPECS = Tables(REFERENCES, _reference_table)
"""The tables of references by their kind."""


def __getattr__(name: str) -> Any:
    """Return a table's class by name, as a pickled scenario refers to it."""
    kinds = {table: family.kinds for table, family in FAMILIES.items()} | {"references": REFERENCES}
    for table, classes in kinds.items():
        for kind, place in classes.places.items():
            if name_of_table(place) == name:
                return (REFERENCE_SPECS if table == "references" else FAMILY_SPECS[table])[kind]
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


DriveSpec = ElementSpec
"""A drive; ``kind`` says which class it is."""

AnySpring = ElementSpec | PointsSpec
"""A spring; ``kind`` says which class it is."""


if TYPE_CHECKING:

    class FamilyTables(Spec):
        """The further families of a scenario."""

else:
    FamilyTables = create_model(
        "FamilyTables",
        __base__=Spec,
        __doc__="The further families of a scenario, each a field: tables by name.",
        __module__=__name__,
        **{
            table: (
                dict[str, Annotated[_ForceSpec, OneOf(specs)]],
                Field(default_factory=dict),
            )
            for table, specs in FAMILY_SPECS.items()
            if table not in ("drives", "springs")
        },
    )


WITH_FILES = (*FAMILIES, "references")
"""The tables of a scenario in which numbers may come from files."""


def kind_in(family: str, table: Mapping[str, Any]) -> str | None:
    """Return the kind of a table without one: between points, or the default."""
    between = FAMILIES[family].between
    if between is not None and not {"first", "second"}.isdisjoint(table):
        return between
    return FAMILIES[family].default


def is_at_joint(family: str, kind: object) -> bool:
    """Return whether elements of a kind act at one joint, which may name their table."""
    return not isinstance(kind, str) or issubclass(FAMILY_SPECS[family].get(kind, ElementSpec), ElementSpec)


def is_between_points(family: str, kind: object) -> bool:
    """Return whether elements of a kind act between points rather than at a joint."""
    return isinstance(kind, str) and issubclass(FAMILY_SPECS[family].get(kind, ElementSpec), PointsSpec)


def file_columns(table: object, family: str) -> tuple[str, ...] | None:
    """Return the columns of the file that a table may name; None if none."""
    return getattr(_class_of(table, family), "columns", None)


def file_units(table: Mapping[str, Any], family: str) -> tuple[str | tuple[str, ...], ...]:
    """Return the SI units of :func:`file_columns`, or those of both motions."""
    cls = _class_of(table, family)
    units = {name: parameter.units for name, parameter in parameters_of(cls).items()}
    if hasattr(cls, "units_of_columns"):
        units |= cls.units_of_columns(table)
    return tuple(units[name] for name in cls.columns)


def _class_of(table: object, family: str) -> Any:
    """Return the class of an element or reference; None for unknown kinds."""
    if not isinstance(table, Mapping) or not isinstance(table.get("kind"), str):
        return None
    return (REFERENCES if family == "references" else FAMILIES[family].kinds).get(table["kind"])


def check_references(references: Mapping[str, Any], names: Mapping[tuple[str, ...], str]) -> None:
    """Refuse references to unknown references, or to themselves."""
    for place, name in names.items():
        if name not in references:
            refuse_name("reference", name, sorted(references), *place)
    for name in references:
        for other in _parts(references, name, (name,)):
            if other not in references:
                refuse_name("reference", other, sorted(references), "references", name, "parts")


def _parts(references: Mapping[str, Any], name: str, above: tuple[str, ...]) -> Iterator[str]:
    for other in getattr(references[name], "parts", ()):
        yield other
        if other in above:
            refuse(f"must not lead back to {other!r}", "references", name, "parts")
        if other in references:
            yield from _parts(references, other, (*above, other))
