"""Tables of a file: frozen, no unknown keys, quantities with units, errors of one line."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, NoReturn, Self, get_args

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    GetCoreSchemaHandler,
    PlainSerializer,
    ValidationError,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic_core import CoreSchema, InitErrorDetails, PydanticCustomError, core_schema

from antenna_pin.base.arguments import fits
from antenna_pin.base.files import path_as_text, path_of_text
from antenna_pin.base.parameters import beyond
from antenna_pin.base.rules import A_DIRECTION, obeys
from antenna_pin.base.units import QuantityError, describe_unit, quantity, shown
from antenna_pin.errors import (
    AntennaPinError,
    InvalidParameterError,
    ScenarioError,
    UnknownNameError,
    nearest,
)
from antenna_pin.scenario.toml_text import quoted

Folder = Annotated[
    Path,
    AfterValidator(path_of_text),
    PlainSerializer(path_as_text, when_used="json"),
]
"""The folder of a file, whatever bytes its name has."""


def refuse(text: str, *location: str | int, value: object = None) -> NoReturn:
    """Refuse a value from inside a validator.

    Args:
        text: The message without the place: rule, value seen, way out.
        *location: Place of the value, below the table being validated.
        value: The value seen.
    """
    _raise(PydanticCustomError("refused", "{text}", {"text": text}), location, value)


def refuse_key(text: str, *location: str | int) -> NoReturn:
    """Refuse a key that a table does not have, from inside a validator."""
    _raise(PydanticCustomError("unknown_key", "{text}", {"text": text}), location, None)


def refuse_name(what: str, name: str, known: Collection[str], *location: str | int) -> NoReturn:
    """Refuse a name that is not among those known, from inside a validator."""
    context = {"what": what, "name": name, "known": tuple(known)}
    _raise(PydanticCustomError("unknown_name", "unknown {what}", context), location, name)


def _raise(error: PydanticCustomError, location: Location, value: object) -> NoReturn:
    # pydantic merges the lines of a ValidationError raised in a validator, and completes their locations.
    raise ValidationError.from_exception_data(
        "scenario", [InitErrorDetails(type=error, loc=location, input=value)]
    )


def unknown_key(known: Collection[str], name: str) -> str:
    """Return the message for a key that a table does not have, without the place."""
    if name == "replace":
        return "must be true or false, and belongs in a table of a case or an override"
    guess = nearest(name, known)
    return f"is unknown; did you mean {guess}?" if guess else f"is unknown; known here: {', '.join(known)}"


class _Annotation:
    """Annotation of a field by which its value is read from a file."""

    __slots__ = ()

    def read(self, value: object) -> object:
        """Return the value in SI units, or refuse it."""
        raise NotImplementedError

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self.read, handler(source))


@dataclass(frozen=True, slots=True)
class QuantityRule(_Annotation):
    """Annotation of a float: SI unit and rule.

    Attributes:
        unit: SI unit, or several of which one must fit.
        rule: A rule for numbers (:mod:`antenna_pin.base.rules`).
    """

    unit: str | tuple[str, ...]
    rule: str = ""

    def read(self, value: object) -> float:
        """Return the value in SI units, or refuse it."""
        return read_quantity(value, self.unit, self.rule)

    def __str__(self) -> str:
        return describe_unit(self.unit)


def read_quantity(value: object, unit: str | tuple[str, ...], rule: str, *location: str | int) -> float:
    """Return a value in SI units, or refuse it, from inside a validator."""
    try:
        number = quantity(value, unit, "")
    except QuantityError as error:
        refuse(error.reason, *location, value=value)
    broken = beyond([number], unit, rule) if obeys(number, rule) else rule
    if broken:
        refuse(f"must be {broken}, got {shown(value)}", *location, value=value)
    return number


def read_count(rule: str) -> BeforeValidator:
    """Return the annotation of a whole number with a rule for numbers."""

    def read(value: object) -> int:
        number = read_quantity(value, "1", rule)
        if number != int(number):
            refuse(f"must be a whole number, got {shown(value)}", value=value)
        return int(number)

    return BeforeValidator(read)


@dataclass(frozen=True, slots=True)
class Vector(_Annotation):
    """Annotation of a tuple of floats.

    Attributes:
        unit: SI unit that its entries are read in.
        sizes: How many there may be; () for any number.
        rule: What each must be, or all of them, a rule for numbers or a direction's.
    """

    unit: str
    sizes: tuple[int, ...] = (3,)
    rule: str = ""

    def read(self, value: object) -> tuple[float, ...]:
        """Return the entries in SI units, or refuse them."""
        if hasattr(value, "tolist"):  # a NumPy array
            value = value.tolist()
        if not isinstance(value, list | tuple) or (self.sizes and len(value) not in self.sizes):
            refuse(f"must be {self}, got {shown(value)}", value=value)
        own = A_DIRECTION if self.rule == A_DIRECTION else ""  # other rules are told of all together
        numbers = tuple(read_quantity(entry, self.unit, own, i) for i, entry in enumerate(value))
        broken = not all(obeys(number, self.rule) for number in numbers)
        if broken or (self.rule == A_DIRECTION and not any(numbers)):
            refuse(f"must be {self.rule}, got {shown(numbers)}", value=value)
        return numbers

    def __str__(self) -> str:
        sizes = " or ".join(str(size) for size in self.sizes) + " " if self.sizes else ""
        return f"an array of {sizes}numbers" + ("" if self.unit == "1" else f" [{self.unit}]")


@dataclass(frozen=True, slots=True)
class Count(_Annotation):
    """Annotation of a whole number.

    Attributes:
        least: The smallest that it may be.
        most: The largest.
        even: Whether it must be even.
        power: Whether it must be a power of two.
    """

    least: int
    most: int
    even: bool = False
    power: bool = False

    def read(self, value: object) -> int:
        """Return the number, or refuse it."""
        whole = isinstance(value, int | float) and not isinstance(value, bool) and value == value // 1
        if not whole or not self.least <= value <= self.most or (self.even and value % 2):  # type: ignore
            refuse(f"must be {self}, got {shown(value)}", value=value)
        number: int = int(value)  # type: ignore[call-overload]
        if self.power and number & (number - 1):
            refuse(f"must be {self}, got {number}", value=value)
        return number

    def __str__(self) -> str:
        kind = "a power of two" if self.power else f"{'an even' if self.even else 'a'} whole number"
        return f"{kind} from {self.least} to {self.most}"


Vector3 = tuple[float, float, float]

Length = Annotated[float, QuantityRule("m")]
PositiveLength = Annotated[float, QuantityRule("m", "positive")]
PositiveTime = Annotated[float, QuantityRule("s", "positive")]
PositiveSpeed = Annotated[float, QuantityRule("m/s", "positive")]
Position = Annotated[Vector3, Vector("m")]
Velocity = Annotated[Vector3, Vector("m/s")]
Direction = Annotated[Vector3, Vector("1", rule=A_DIRECTION)]
Rotation = Annotated[Vector3, Vector("rad")]
AngularVelocity = Annotated[Vector3, Vector("rad/s")]


def _is_one(value: object) -> object:
    """Refuse what counts as 1 in Python only."""
    if value is True:
        refuse("must be 1, got true", value=value)
    return value


Version = Annotated[Literal[1], BeforeValidator(_is_one)]
"""Version of the format of a file."""


_OF_BASE = frozenset(dir(BaseModel))


class Spec(BaseModel):
    """Base of all tables of a scenario.

    Values are read as a scenario file gives them (text with units is converted to SI), so that
    ``OutputSpec(rate="1 kHz")`` works from Python too. What is wrong is refused with one line.
    """

    # Built when it is used: of most tables of a file there is none, and what is in one is built with it.
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, defer_build=True)

    # Fields that no file gives: what the loader adds.
    carried: ClassVar[frozenset[str]] = frozenset()

    def __init__(self, /, **data: Any) -> None:
        """Validate the fields."""
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise explained(error, _by_class(type(self))) from None

    # Keeps pydantic from calling __init__ for nested tables, where an error would lose its place.
    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]

    def __setattr__(self, name: str, value: Any) -> None:
        """Refuse any change in place."""
        made = "with_overrides({...})" if hasattr(self, "with_overrides") else "a table with other values"
        rule = f"left as it is: a table is immutable; create a new one with {made}"
        raise InvalidParameterError(type(self).__name__, name, rule, said=shown(value))

    def __delattr__(self, name: str) -> None:
        """Refuse any change in place."""
        rule = "left as it is: a table does not change once it is read"
        raise InvalidParameterError(type(self).__name__, name, rule, said="del")

    def __dir__(self) -> list[str]:
        """Return names for completion: own keys and functions, not pydantic's."""
        return [name for name in super().__dir__() if name.startswith("_") or name not in _OF_BASE]

    @classmethod
    def model_validate(cls, obj: Any, **options: Any) -> Self:
        """Validate a dictionary; as in pydantic, but an error is one line."""
        try:
            return super().model_validate(obj, **options)
        except ValidationError as error:
            raise explained(error, _by_class(cls)) from None

    @classmethod
    def model_validate_json(cls, json_data: str | bytes | bytearray, **options: Any) -> Self:
        """Validate JSON text; as in pydantic, but an error is one line."""
        try:
            return super().model_validate_json(json_data, **options)
        except ValidationError as error:
            raise explained(error, _by_class(cls)) from None

    @classmethod
    def validated(cls, data: Mapping[str, Any]) -> Self:
        """Validate a dictionary; what is wrong is left as pydantic's own error, for ``explained``."""
        return super().model_validate(data)

    @classmethod
    def keys(cls) -> list[str]:
        """Return the keys that a file may have, in the order of messages."""
        return [name for name in cls.model_fields if name not in cls.carried]

    @model_validator(mode="before")
    @classmethod
    def _check_keys(cls, data: Any) -> Any:
        if not isinstance(data, Mapping):
            return data
        for key in data:
            if key not in cls.model_fields:
                refuse_key(unknown_key(cls.keys(), str(key)), str(key))
        for name, field in cls.model_fields.items():
            if field.is_required() and name not in data:
                refuse(f"is missing{_wanted(field)}", name)
        given = {key: value.item() if _is_of_numpy(value) else value for key, value in data.items()}
        return given | {name: _read_plain(given[name], kind, name) for name, kind in _plain(cls, given)}


def _is_of_numpy(value: Any) -> bool:
    """Return whether a value is a NumPy scalar."""
    return hasattr(value, "item") and getattr(value, "ndim", None) == 0


def _plain(cls: type[Spec], data: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yield given keys with plain types bool or float, and the type."""
    for name, field in cls.model_fields.items():
        kinds = [kind for kind in get_args(field.annotation) or (field.annotation,) if kind is not type(None)]
        if kinds in ([bool], [float]) and not field.metadata and data.get(name) is not None:
            yield name, kinds[0]


def _read_plain(value: Any, kind: Any, name: str) -> Any:
    # Of itself pydantic takes "no", 0 and "off" for false, true for 1 and "1_0" for 10.
    if kind is float:
        return read_quantity(value, "1", "", name)
    if not fits(value, bool):
        refuse(f"must be true or false, got {shown(value)}", name, value=value)
    return bool(value)


def _wanted(field: FieldInfo) -> str:
    for item in field.metadata:
        if isinstance(item, QuantityRule | Vector):
            return f"; give {item}"
    return ""


def _by_class(cls: type[Spec]) -> Callable[[Location], ValuePlace]:
    return lambda location: ValuePlace(f"{cls.__name__}: {dotted(location)}".strip())


Location = tuple[str | int, ...]
"""Where a value stands: the keys and indices that lead to it."""

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


def dotted(location: Location) -> str:
    """Return a location as it is written with dots: ``mechanism.gravity[2]``."""
    text = ""
    for item in location:
        if isinstance(item, int):
            text += f"[{item}]"
        else:
            text += ("." if text else "") + (item if _BARE_KEY.fullmatch(item) else quoted(item))
    return text


class ValuePlace(NamedTuple):
    """Place of a value, for a message.

    Attributes:
        text: File and dotted place, such as ``my.toml: integrator.rtol``.
        note: Text on its origin after the message, or "".
        stale: Further text on a key that its table does not have, or "".
    """

    text: str
    note: str = ""
    stale: str = ""


Line = tuple[Location, Mapping[str, Any]]
"""One thing that pydantic found: its location, as the user writes it, and its details."""


def explained(error: ValidationError, place: Callable[[Location], ValuePlace]) -> AntennaPinError:
    """Return the first fault found by pydantic as an error of one line."""
    return explained_line(located_lines(error)[0], place)


def explained_line(line: Line, place: Callable[[Location], ValuePlace]) -> AntennaPinError:
    """Return a fault found by pydantic as an error of one line."""
    location, detail = line
    where, note, stale = place(location)
    context = detail.get("ctx", {})
    if detail["type"] == "unknown_name":
        return UnknownNameError(where, context["what"], context["name"], context["known"])
    stale = stale if detail["type"] == "unknown_key" else ""
    return ScenarioError(f"{where} {_message(detail, context)}{stale}{note}")


def located_lines(error: ValidationError) -> list[Line]:
    """Return all faults that pydantic found."""
    return [
        (tuple(item for item in detail["loc"] if item != "[key]"), detail)
        for detail in error.errors(include_url=False)
    ]


# What pydantic's own checks ask for, as it reads after "must be".
_RULES = {
    "string_type": "text",
    "bool_type": "true or false",
    "dict_type": "a table",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "tuple_type": "an array",
    "path_type": "a path",
    "finite_number": "finite",
}


def _message(detail: Mapping[str, Any], context: Mapping[str, Any]) -> str:
    kind, value = detail["type"], detail["input"]
    if kind in ("refused", "unknown_key"):
        return str(context["text"])
    if kind == "literal_error":
        guess = nearest(str(value), re.findall(r"'([^']*)'", context["expected"]))
        return f"must be {context['expected']}, got {shown(value)}" + (
            f"; did you mean {guess}?" if guess else ""
        )
    if kind == "json_invalid":
        return f"is not JSON: {context['error']}"
    if kind in _RULES:
        return f"must be {_RULES[kind]}, got {shown(value)}"
    return f"is not valid: {detail['msg']}, got {shown(value)}"
