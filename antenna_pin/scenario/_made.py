"""Tables of a scenario made of the classes that they fill: keys, units, rules and defaults from there.

::

    @reads(ErrorScales)
    class ScalesSpec(MadeSpec): ...

has a key for each field of ``ErrorScales``, refuses what that class refuses, and ``spec.build()`` is one.
"""

from __future__ import annotations

import dataclasses
import inspect
import types
from collections.abc import Callable, Collection, Mapping
from dataclasses import MISSING
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self, TypeVar, Union, get_args, get_type_hints

from pydantic import BeforeValidator, Field, create_model, model_validator

from antenna_pin.base.parameters import parameters_of
from antenna_pin.errors import InvalidParameterError
from antenna_pin.scenario._base import Quantity, Spec, Vector, read_quantity, refuse

__all__ = ["MadeSpec", "made_of", "name_of_table", "reads"]

_Spec = TypeVar("_Spec", bound="MadeSpec")


class MadeSpec(Spec):
    """A table that fills a class; see :func:`reads`."""

    # The class that it fills, and the field of each key where that has another name.
    fills: ClassVar[type[Any]]
    fields_of_keys: ClassVar[Mapping[str, str]] = {}

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...

    @classmethod
    def field_of(cls, key: str) -> str:
        """Return the name that a key has as a field of the class."""
        return cls.fields_of_keys.get(key, key)

    def build(self, **more: Any) -> Any:
        """Return an object of the class that the table fills.

        Args:
            **more: Fields of the class that the table has no keys for.
        """
        given = {name: _built(getattr(self, key)) for key, name in _filled(type(self))}
        return self.fills(**given | more)

    @model_validator(mode="after")
    def _check_use(self) -> Self:
        """Refuse what the class refuses, of several numbers together for instance."""
        try:
            self.build()
        except InvalidParameterError as error:
            keys = {name: key for key, name in self.fields_of_keys.items()}
            name, *indices = error.parameter.replace("]", "").split("[")
            refuse(error.reason, keys.get(name, name), *(int(index) for index in indices))
        return self


@cache
def _filled(table: type[MadeSpec]) -> tuple[tuple[str, str], ...]:
    """Return the keys of a table that are fields of its class, each with the field's name."""
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
    """Return a decorator that gives a table the keys of a class.

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

    def made(own: type[_Spec]) -> type[_Spec]:
        table = create_model(
            own.__name__,
            __base__=own,
            __doc__=own.__doc__ if "__doc__" in vars(own) and own.__doc__ else inspect.getdoc(cls),
            __module__=own.__module__,
            **{renamed.get(name, name): key for name, key in _keys(cls, names, nested).items()},
        )
        table.fills = cls
        table.fields_of_keys = {key: name for name, key in renamed.items()}
        return table

    return made


def made_of(
    cls: type[Any], base: type[_Spec], kind: Any, module: str, without: tuple[str, ...], **nested: Any
) -> type[_Spec]:
    """Return the table of one of many kinds: what :func:`reads` makes of a class without a body, in one step.

    Args:
        cls: The class that it fills, as there; also its docstring.
        base: What all of these tables are.
        kind: The key ``kind``, as pydantic takes a field.
        module: Of the table.
        without: Fields of the class that it does not have.
        **nested: The type that the table has for a field.
    """
    names = {item.name for item in dataclasses.fields(cls)} - {*without}
    table = create_model(
        name_of_table(cls.__name__),
        __base__=base,
        __doc__=cls.__doc__,
        __module__=module,
        kind=kind,
        **_keys(cls, names, nested),
    )
    table.fills = cls
    return table


def name_of_table(name: str) -> str:
    """Return what the table of one of many kinds is called, by the name of the class that it fills."""
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
            hint = _annotated(parameters[item.name], hint)
        given: Any = {"repr": item.repr}
        if item.name in nested and item.default_factory is not MISSING:
            given["default_factory"] = dict if item.default_factory is dict else hint
        elif item.default_factory is not MISSING:
            given["default_factory"] = item.default_factory
        elif item.default is not MISSING:
            given["default"] = item.default
        keys[item.name] = (hint, Field(**given))
    return keys


def _annotated(parameter: Any, hint: Any) -> Any:
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
        kind = Annotated[int, BeforeValidator(_count(parameter.rule))]
    else:
        kind = Annotated[float, Quantity(parameter.units, parameter.rule)]
    return Union[kind, None] if optional else kind  # noqa: UP007 - of values


def _count(rule: str) -> Callable[[object], int]:
    def read(value: object) -> int:
        number = read_quantity(value, "1", rule)
        if number != int(number):
            refuse(f"must be a whole number, got {value!r}", value=value)
        return int(number)

    return read
