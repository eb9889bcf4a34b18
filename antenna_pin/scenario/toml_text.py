"""TOML text read within bounds of time, depth and length."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from typing import Any

_DEEPEST = 32  # tables and arrays in each other; a scenario needs eight
_LONGEST_NUMBER = 4096  # bits of an integer; Python prints no much longer ones
_LONGEST_KEY = 200  # letters: names stand in messages, tables and the labels of a result


class NotTomlError(ValueError):
    """Reason why a text is not TOML, or beyond bounds."""


def read_toml_text(text: str) -> dict[str, Any]:
    """Return the contents of TOML text.

    Raises:
        NotTomlError: It is none, or beyond the bounds.
    """
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise NotTomlError(f"is not TOML: {error}") from None
    except RecursionError:
        raise NotTomlError(f"must be at most {_DEEPEST} tables and arrays deep") from None
    except ValueError as error:  # what Python says of an integer of thousands of digits, with its own way out
        raise NotTomlError(f"has a number that is too long: {str(error).partition(';')[0]}") from None
    problem = unbounded(document)
    if problem:
        raise NotTomlError(problem)
    return document


def quoted(text: str) -> str:
    """Return a text in quotes, as a string or a key of TOML."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def unbounded(document: object) -> str:
    """Return the reason why a value is too deep or long; "" if none."""
    level: list[object] = [document]
    for _ in range(_DEEPEST + 1):
        if not level:
            return ""
        below: list[object] = []
        for value in level:
            if isinstance(value, Mapping):
                longest = max((str(key) for key in value), key=len, default="")
                if len(longest) > _LONGEST_KEY:
                    return (
                        f"has a key of {len(longest)} letters, {longest[:20]!r}...; keys must have at most "
                        f"{_LONGEST_KEY}"
                    )
                below += value.values()
            elif isinstance(value, list | tuple):
                below += value
            elif isinstance(value, int) and value.bit_length() > _LONGEST_NUMBER:
                return f"has an integer of {value.bit_length()} bits; write a shorter number"
        level = below
    return f"must be at most {_DEEPEST} tables and arrays deep"
