"""Messages of pydantic in one line: file, dotted key, rule, value seen."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from pydantic import ValidationError

from antenna_pin.base.units import shown
from antenna_pin.errors import AntennaPinError, ScenarioError, UnknownNameError, nearest
from antenna_pin.scenario.toml_text import quoted

__all__ = [
    "Line",
    "Location",
    "Place",
    "dotted",
    "explained",
    "explained_line",
    "located_lines",
]

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


class Place(NamedTuple):
    """Place of a value, for a message.

    Attributes:
        text: File and dotted place, such as ``my.toml: integrator.rtol``.
        note: What is to be said of its origin after the message, or "".
        stale: What is to be said, too, of a key that its table does not have, or "".
    """

    text: str
    note: str = ""
    stale: str = ""


Line = tuple[Location, Mapping[str, Any]]
"""One thing that pydantic found: its location, as the user writes it, and its details."""


def explained(error: ValidationError, place: Callable[[Location], Place]) -> AntennaPinError:
    """Return the first thing that pydantic found as an error of one line."""
    return explained_line(located_lines(error)[0], place)


def explained_line(line: Line, place: Callable[[Location], Place]) -> AntennaPinError:
    """Return one thing that pydantic found as an error of one line.

    Args:
        line: What it found.
        place: Returns the place of a location.
    """
    location, detail = line
    where, note, stale = place(location)
    context = detail.get("ctx", {})
    if detail["type"] == "unknown_name":
        return UnknownNameError(where, context["what"], context["name"], context["known"])
    stale = stale if detail["type"] == "unknown_key" else ""
    return ScenarioError(f"{where} {_message(detail, context)}{stale}{note}")


def located_lines(error: ValidationError) -> list[Line]:
    """Return all that pydantic found."""
    lines: list[Line] = []
    for detail in error.errors(include_url=False):
        location = tuple(item for item in detail["loc"] if item != "[key]")
        lines.append((location, detail))
    return lines


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
