"""Parameters declared once: unit, rule, default and meaning of each field of a frozen dataclass.

A class that people set the numbers of says of each field what it is, by :func:`parameter`, and checks itself
by :func:`check`. Whatever reads it from elsewhere, a scenario's table, a list of laws, a page of
documentation, takes all of that from the class (:func:`parameters_of`)::

    @dataclass(frozen=True, slots=True, kw_only=True)
    class Spring:
        stiffness: float = parameter("N*m/rad", rule="zero or more", default=0.0)

        def __post_init__(self) -> None:
            check(self)
"""

from __future__ import annotations

import dataclasses
import math
import re
import types
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING, dataclass, field
from functools import cache
from typing import Any, Literal, get_args, get_origin, get_type_hints

import numpy as np

from antenna_pin.base.arguments import fits, in_si, is_number, rule_of, takes, unknown_type
from antenna_pin.base.directions import direction
from antenna_pin.base.readable import alternatives, decimal_in
from antenna_pin.base.rules import A_DIRECTION, finite_too, obeys
from antenna_pin.base.units import matching_unit
from antenna_pin.errors import InvalidParameterError

#: Sizes beyond which a number is refused, lest what is made of it (k = m w^2) be no number any more.
LARGEST, LEAST = 1e100, 1e-100

#: Bound of a joint beyond which it is none [rad], [m]: programs write 1e16, or the largest number they have.
NO_BOUND = 1e9

#: Size beyond which a double does not tell places and angles apart to a millionth [m], [rad].
FARTHEST = 2.0**33


@takes()
@dataclass(frozen=True, slots=True)
class Parameter:
    """Parameter of a class.

    Attributes:
        unit: Its SI unit, "1" for a pure number; ``N/m**exponent`` depends on another parameter, of the name.
        required: Whether the class has no default for it.
        default: The default; None if there is none, or if leaving it out has a meaning of its own.
        doc: What it is.
        from_joint: Whether a scenario may leave it out, as it follows from the joint: its dimensions and
            materials, or the mass at each contact.
        sliding: Its unit where the joint that it belongs to slides, if that is another.
        rule: A rule for numbers (:mod:`antenna_pin.base.rules`).
        sizes: How many numbers it may have; none for a single number.
    """

    unit: str
    required: bool
    default: Any
    doc: str
    from_joint: bool = False
    sliding: str = ""
    rule: str = ""
    sizes: tuple[int, ...] = ()

    @property
    def units(self) -> str | tuple[str, ...]:
        """The unit, or both where that of a sliding joint is another."""
        return (self.unit, self.sliding) if self.sliding else self.unit


def parameter(
    unit: str = "1",
    *,
    sliding: str = "",
    rule: str = "",
    sizes: tuple[int, ...] = (),
    default: Any = MISSING,
    repr: bool = True,
    from_joint: bool = False,
    more: Mapping[str, Any] = types.MappingProxyType({}),
) -> Any:
    """Return a dataclass field that holds a number, or several, with a unit.

    Its meaning is what the class's docstring says of it under ``Attributes``. A field whose type allows None
    may be left out.

    Args:
        unit: SI unit, "1" for a pure number.
        sliding: SI unit where the joint that it belongs to slides, if that is another.
        rule: A rule for numbers (:mod:`antenna_pin.base.rules`).
        sizes: How many numbers, of a tuple; ``(0,)`` for any number of them.
        default: The default; required if not given.
        repr: Whether the field is shown.
        from_joint: Whether a scenario may leave it out, as it follows from the joint.
        more: Further declarations of the class, by name.
    """
    metadata = {"unit": unit, "sliding": sliding, "rule": rule, "sizes": sizes, "from_joint": from_joint}
    return field(default=default, metadata={**metadata, **more}, repr=repr)


def parameters_of(cls: type[Any]) -> dict[str, Parameter]:
    """Return the parameters of a class by name, in the order of fields."""
    owner: Any = cls
    return dict(_parameters_of(owner))


@cache
def _parameters_of(cls: type[Any]) -> dict[str, Parameter]:
    docs = attribute_docs(cls)
    found = {}
    for item in dataclasses.fields(cls):
        if "unit" not in item.metadata:
            continue
        required = item.default is MISSING
        found[item.name] = Parameter(
            required=required,
            default=None if required else item.default,
            **{"doc": docs.get(item.name, "")}
            | {name: value for name, value in item.metadata.items() if name in Parameter.__slots__},
        )
    return found


def attribute_docs(cls: type[Any]) -> dict[str, str]:
    """Return the descriptions of attributes in docstrings of a class and its bases."""
    found: dict[str, str] = {}
    for base in reversed(cls.__mro__):
        _, _, section = (base.__doc__ or "").partition("Attributes:\n")
        for entry in re.split(r"\n {4,8}(?=\w+: )", "\n" + section):
            name, _, text = entry.strip().partition(": ")
            if name.isidentifier():
                found[name] = " ".join(text.split("\n\n")[0].split())
    return found


def choices_of(hint: Any) -> tuple[str, ...]:
    """Return the texts that an annotation, as ``Literal["a"] | None``, allows; () for any."""
    if get_origin(hint) is Literal:
        return tuple(choice for choice in get_args(hint) if isinstance(choice, str))
    return tuple(choice for part in get_args(hint) for choice in choices_of(part))


def check(owner: Any) -> None:
    """Check the fields of a frozen dataclass by their declarations; convert to SI.

    Text with a unit becomes the number in SI units. A field whose unit depends on the joint takes either; all
    fields of an object must be for one motion.

    Raises:
        InvalidParameterError: The first that breaks its rule.
    """
    cls: Any = type(owner)
    motions: dict[str, str] = {}
    for name, optional, whole, hint, choices, declared in _declared(cls):
        value = getattr(owner, name)
        if value is None and optional:
            continue
        if "unit" in declared:
            if declared["sliding"]:
                _check_motion(owner, name, value, declared, motions)
            if declared.get("sizes"):
                value = _in_si(owner, name, value, declared)
                numbers = _numbers(owner, name, value, declared)
                object.__setattr__(owner, name, numbers)
            else:
                if isinstance(value, str):
                    value = _in_si(owner, name, value, declared)
                    object.__setattr__(owner, name, value)
                _number(owner, name, value, declared)
                if whole and value != int(value):
                    raise InvalidParameterError(owner, name, "a whole number", value)
        elif not choices and not fits(value, hint):
            raise InvalidParameterError(owner, name, rule_of(hint), said=unknown_type(value))
        elif choices and (not isinstance(value, str) or value not in choices):
            raise InvalidParameterError(owner, name, alternatives(choices), value)


_Declared = tuple[str, bool, bool, Any, tuple[str, ...], Mapping[Any, Any]]


@cache
def _declared(cls: type[Any]) -> tuple[_Declared, ...]:
    """Return of each field: name, optional, whole, type, choices, declaration."""
    hints, found = get_type_hints(cls), []
    for item in dataclasses.fields(cls):
        hint = hints[item.name]
        parts = get_args(hint)
        optional, whole = type(None) in parts, int in (hint, *parts)
        found.append((item.name, optional, whole, hint, choices_of(hint), item.metadata))
    return tuple(found)


def holds(value: object, rule: str) -> bool:
    """Return whether a value is a finite number that obeys a rule."""
    if not is_number(value):
        return False
    try:
        number = float(value)  # type: ignore[arg-type]
    except OverflowError:
        return False
    return math.isfinite(number) and obeys(number, rule)


def _in_si(owner: object, name: str, value: Any, declared: Mapping[Any, Any]) -> Any:
    """Return a value, or several, in SI units; the unit may depend on another field."""
    unit = declared["unit"]
    for other in re.findall(r"(?<=\*\*)[a-z]\w*", unit):
        unit = unit.replace(f"**{other}", f"**{getattr(owner, other)!r}")
    return in_si(owner, name, value, (unit, declared["sliding"]) if declared["sliding"] else unit)


def _check_motion(
    owner: object, name: str, value: Any, declared: Mapping[Any, Any], motions: dict[str, str]
) -> None:
    """Refuse units of a sliding joint beside those of a turning joint."""
    units = _units(declared)
    for one in value if isinstance(value, list | tuple) else (value,):
        unit = matching_unit(one, units)
        if unit is None or decimal_in(one) is not None:
            continue
        own = ("turning", "sliding")[units.index(unit)]
        first = next(iter(motions), name)
        if motions.setdefault(first, own) != own:
            rule = f"for a {motions[first]} joint, as {first} is"
            raise InvalidParameterError(owner, name, rule, said=f"{one!r} ({own})")


def beyond(numbers: Iterable[float], units: str | tuple[str, ...], rule: str = "") -> str:
    """Return the size limit that numbers exceed, as it reads after "must be"."""
    if rule == A_DIRECTION:
        return ""
    sizes = [abs(float(number)) for number in numbers]
    unit = units if isinstance(units, str) else next((one for one in units if one in ("m", "rad")), "")
    # A place or an angle; what must be positive is a length or a scale, which does no harm.
    if unit in ("m", "rad") and not rule and max(sizes, default=0.0) > FARTHEST:
        return f"at most {FARTHEST:.2g} {unit} in size, up to where a double holds it to a millionth"
    if max(sizes, default=0.0) > LARGEST:
        return f"at most {LARGEST:g} in size"
    return f"{LEAST:g} or more" if rule == "positive" and min(sizes, default=1.0) < LEAST else ""


def _number(owner: object, name: str, value: Any, declared: Mapping[Any, Any]) -> None:
    rule = declared["rule"]
    said = beyond([value], _units(declared), rule) if holds(value, rule) else finite_too(rule)
    if said:
        raise InvalidParameterError(owner, name, said, value)


def _units(declared: Mapping[Any, Any]) -> tuple[str, ...]:
    return declared["unit"], declared["sliding"]


def _numbers(owner: object, name: str, value: object, declared: Mapping[Any, Any]) -> tuple[float, ...]:
    sizes, rule = declared["sizes"], declared["rule"]
    if rule == A_DIRECTION:
        direction(value, owner, name)  # type: ignore[arg-type]
    count = "" if sizes == (0,) else f"{' or '.join(str(size) for size in sizes)} "
    said = f"{count}{rule or 'finite'} numbers"
    try:
        entries: tuple[Any, ...] = tuple(value)  # type: ignore[arg-type]
    except TypeError:
        raise InvalidParameterError(owner, name, said, value) from None
    ends = _ends(entries)
    if (sizes != (0,) and len(entries) not in sizes) or not all(holds(entry, rule) for entry in ends):
        raise InvalidParameterError(owner, name, said, value)
    too_far = beyond(ends, _units(declared), rule)
    if too_far:
        raise InvalidParameterError(owner, name, f"{count}numbers {too_far}", value)
    return tuple(float(entry) for entry in entries)


def _are_floats(values: Sequence[Any]) -> bool:
    return set(map(type, values)) == {float}


def _ends(values: tuple[Any, ...]) -> Sequence[Any]:
    """Return the extremes of floats, NaN included; they decide an interval rule."""
    return [float(np.min(values)), float(np.max(values))] if _are_floats(values) else values
