"""Tables of a scenario derived from classes, and chosen by a key."""

from __future__ import annotations

import dataclasses
import functools
import inspect
import types
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import MISSING
from functools import cache
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    ClassVar,
    Literal,
    Self,
    TypeVar,
    Union,
    get_args,
    get_type_hints,
)

from pydantic import Field, GetCoreSchemaHandler, create_model, model_validator
from pydantic.fields import FieldInfo
from pydantic_core import CoreSchema, PydanticKnownError, core_schema

from antenna_pin.base.lazy import Classes
from antenna_pin.base.parameters import parameters_of
from antenna_pin.base.units import matching_unit, shown
from antenna_pin.elements.control.registry import CONTROLLERS
from antenna_pin.errors import InvalidParameterError
from antenna_pin.scenario.spec import QuantityRule, Spec, Vector, read_count, refuse

_Spec = TypeVar("_Spec", bound="MadeSpec")


class MadeSpec(Spec):
    """A table derived from a class; see :func:`reads`."""

    # The class that it fills, and the field of each key where that has another name.
    fills: ClassVar[type[Any]]
    fields_of_keys: ClassVar[Mapping[str, str]] = {}

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...

    @classmethod
    def field_of(cls, key: str) -> str:
        """Return the name of a key's field."""
        return cls.fields_of_keys.get(key, key)

    def build(self, **more: Any) -> Any:
        """Return an object of the table's class; ``more`` are fields without keys."""
        given = {name: _built(getattr(self, key)) for key, name in _filled(type(self))}
        return self.fills(**given | more)

    @model_validator(mode="after")
    def _check_use(self) -> Self:
        """Refuse values that the class refuses, as of several numbers together."""
        try:
            self.build()
        except InvalidParameterError as error:
            keys = {name: key for key, name in self.fields_of_keys.items()}
            name, *indices = error.parameter.replace("]", "").split("[")
            refuse(error.reason, keys.get(name, name), *(int(index) for index in indices))
        return self


@cache
def _filled(table: type[MadeSpec]) -> tuple[tuple[str, str], ...]:
    """Return the keys of a table that are fields of its class, with field names."""
    names = {item.name for item in dataclasses.fields(table.fills)}
    return tuple((key, table.field_of(key)) for key in table.model_fields if table.field_of(key) in names)


def _built(value: Any) -> Any:
    if isinstance(value, MadeSpec):
        return value.build()
    if isinstance(value, tuple) and value and isinstance(value[0], MadeSpec):
        return tuple(one.build() for one in value)
    if isinstance(value, dict):
        return {name: _built(entry) for name, entry in value.items()}
    return value


def reads(
    cls: type[Any],
    *,
    only: tuple[str, ...] = (),
    without: tuple[str, ...] = (),
    renamed: Mapping[str, str] = types.MappingProxyType({}),
    **nested: Any,
) -> Callable[[type[_Spec]], type[_Spec]]:
    """Return a decorator that adds the fields of a class to a table as keys.

    The table's own docstring, fields and validators stay; without a docstring it gets that of the class.

    Args:
        cls: A frozen dataclass; units and rules are those that its fields declare
            (:func:`antenna_pin.base.parameters.parameter`).
        only: The fields that the table has, if not all.
        without: Fields that it does not have.
        renamed: The key of a field that has another name in the table.
        **nested: The type that the table has for a field, where that of the class is no table.
    """
    names = {item.name for item in dataclasses.fields(cls) if item.name in only or not only} - {*without}

    def with_keys(own: type[_Spec]) -> type[_Spec]:
        keys = {renamed.get(name, name): key for name, key in _keys(cls, names, nested).items()}
        table = _table(own.__name__, own, own.__doc__ or inspect.getdoc(cls), own.__module__, cls, keys)
        table.fields_of_keys = {key: name for name, key in renamed.items()}
        return table

    return with_keys


def _table(
    name: str, base: type[_Spec], doc: str | None, module: str, fills: type[Any], keys: dict[str, Any]
) -> type[_Spec]:
    table = create_model(name, __base__=base, __doc__=doc, __module__=module, **keys)
    table.fills = fills
    return table


def made_of(
    cls: type[Any],
    base: type[_Spec],
    kind: Any,
    module: str,
    without: tuple[str, ...],
    name: str = "",
    /,
    **nested: Any,
) -> type[_Spec]:
    """Return the table of a kind, derived from a class and named after it."""
    names = {item.name for item in dataclasses.fields(cls)} - {*without}
    keys = {"kind": kind, **_keys(cls, names, nested)}
    return _table(name or name_of_table(cls.__name__), base, cls.__doc__, module, cls, keys)


def name_of_table(name: str) -> str:
    """Return the name of a kind's table by the name of its class."""
    return f"{name.rpartition('.')[2].removeprefix('Joint')}Spec"


def _keys(cls: type[Any], names: Collection[str], nested: Mapping[str, Any]) -> dict[str, Any]:
    """Return type and pydantic's field of a class's fields, by name."""
    hints, parameters = get_type_hints(cls), parameters_of(cls)
    keys: dict[str, Any] = {}
    for item in dataclasses.fields(cls):
        if item.name not in names:
            continue
        hint = nested.get(item.name, hints[item.name])
        if item.name in parameters:
            hint = annotated(parameters[item.name], hint)
        given: Any = {"repr": item.repr}
        if item.name in nested and item.default_factory is not MISSING:
            given["default_factory"] = dict if item.default_factory is dict else hint
        elif item.default_factory is not MISSING:
            given["default_factory"] = item.default_factory
        elif item.default is not MISSING:
            given["default"] = item.default
        keys[item.name] = (hint, Field(**given))
    return keys


def annotated(parameter: Any, hint: Any) -> Any:
    """Return the annotation of a key that holds a parameter."""
    optional = type(None) in get_args(hint)
    kind: Any
    if parameter.sizes == (0,):
        # Where the joint decides on the unit, all numbers of a long table are in SI.
        unit = "1" if parameter.sliding else parameter.unit
        kind = Annotated[tuple[float, ...], Vector(unit, (), parameter.rule)]
    elif parameter.sizes:
        kind = Annotated[tuple[float, ...], Vector(parameter.unit, parameter.sizes, parameter.rule)]
    elif int in (hint, *get_args(hint)):
        kind = Annotated[int, read_count(parameter.rule)]
    else:
        kind = Annotated[float, QuantityRule(parameter.units, parameter.rule)]
    return Union[kind, None] if optional else kind  # noqa: UP007 - of values


class Tables(Mapping[str, type[Any]]):
    """Classes of tables by kind, each created at first use."""

    def __init__(self, kinds: Iterable[str], make: Callable[[str], type[Spec]]) -> None:
        """Store the kinds in order, and a function that creates a kind's class."""
        self._kinds = tuple(kinds)
        self._make = functools.cache(make)

    def __getitem__(self, kind: str) -> type[Any]:
        if kind not in self._kinds:
            raise KeyError(kind)
        return self._make(kind)

    def __contains__(self, kind: object) -> bool:
        return kind in self._kinds

    def __iter__(self) -> Iterator[str]:
        return iter(self._kinds)

    def __len__(self) -> int:
        return len(self._kinds)


class OneOf:
    """Annotation of a table that is one of several, by the value of a key."""

    def __init__(self, tables: Mapping[str, type[Any]], key: str = "kind") -> None:
        """Take the tables by the value of the key."""
        self.tables, self.key = tables, key

    def read(self, value: Any) -> Any:
        """Return a table as its class, or refuse it."""
        of_class = isinstance(value, Spec)
        if not of_class and not isinstance(value, Mapping):
            raise PydanticKnownError("model_type", {"class_name": "table"})
        kind = getattr(value, self.key, None) if of_class else value.get(self.key)
        if not isinstance(kind, str) or kind not in self.tables:
            refuse(f"must be one of {', '.join(self.tables)}, got {shown(kind)}", self.key, value=kind)
        # What is wrong in it pydantic puts below the place of this one.
        return self.tables[kind].validated(value)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)


Motion = Literal["rotation", "translation"]
_MOTIONS: tuple[Motion, ...] = get_args(Motion)
JOINTS = {"rotation": "turning", "translation": "sliding"}
"""What moves so, by the motion."""


def motion_of(value: object, units: str | tuple[str, ...]) -> Motion | None:
    """Return the motion implied by a text's unit; None if undecided."""
    if isinstance(units, str) or len(units) != len(_MOTIONS):
        return None
    unit = matching_unit(value, units)
    return None if unit is None else _MOTIONS[units.index(unit)]


class JointTable(Spec):
    """A table about a joint that turns or slides.

    Attributes:
        motion: What the units given say of the joint's motion; None if all numbers came without unit.
    """

    motion: Motion | None = None

    carried: ClassVar[frozenset[str]] = frozenset({"motion"})

    @model_validator(mode="before")
    @classmethod
    def _read_motion(cls, data: Any) -> Any:
        """Determine by the units whether the joint turns or slides, or refuse contradictions."""
        if not isinstance(data, Mapping):
            return data
        motion, first = data.get("motion"), "motion"
        for name, field in cls.model_fields.items():
            seen = motion_of(data.get(name), _either_unit(field))
            if seen is None:
                continue
            if motion in JOINTS and motion != seen:
                rule = f"must be for a {JOINTS[motion]} joint, as {first} is"
                refuse(f"{rule}, got {shown(data[name])} ({JOINTS[seen]})", name, value=data[name])
            motion, first = seen, first if motion is not None else name
        return data if motion is None else {**data, "motion": motion}


def _either_unit(field: FieldInfo) -> tuple[str, ...]:
    candidates = [*field.metadata, *(item for part in get_args(field.annotation) for item in get_args(part))]
    for item in candidates:
        if (
            isinstance(item, QuantityRule)
            and isinstance(item.unit, tuple)
            and len(item.unit) == len(_MOTIONS)
        ):
            return item.unit
    return ()


_ROOM = "antenna_pin.scenario"

COUPLING_SPECS = Classes(
    _ROOM,
    {
        "ratio": "closures.CouplingSpec",
        "differential": "closures.DifferentialSpec",
        "planetary": "closures.PlanetarySpec",
    },
)
"""Tables of couplings by their kind; the first is that of a table that does not say."""

FLEXIBLE_SPECS = Classes(
    _ROOM,
    {"modes": "flexible.ModesSpec", "petals": "flexible.PetalsSpec", "modal-data": "flexible.ModalDataSpec"},
)
"""Tables of flexible links by their kind."""

EVENT_SPECS = Classes(
    _ROOM,
    {
        "angle": "events.AngleEvent",
        "rate": "events.RateEvent",
        "time": "events.TimeEvent",
        "gap": "events.GapEvent",
        "force": "events.ForceEvent",
        "change": "events.ChangeEvent",
    },
)
"""Tables of events by their kind."""


def name_of_kind(kind: str) -> str:
    """Return the name of the table of a kind of controller: ``PidSpec`` of ``pid``."""
    return f"{kind.title().replace('-', '')}Spec"


CONTROLLER_SPECS = Classes(_ROOM, {kind: f"controllers.{name_of_kind(kind)}" for kind in CONTROLLERS})
"""Tables of controllers by their kind."""
