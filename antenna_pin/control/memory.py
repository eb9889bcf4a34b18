"""What a controller remembers, as text that is exact to the last bit, and back."""

from __future__ import annotations

import copy
import dataclasses
import json
from typing import Any

import numpy as np

from antenna_pin.errors import InvalidParameterError

__all__ = ["kept", "remembered"]

# What stands for what JSON has not; a table of the user's with one of these keys is a list of pairs.
_ARRAY, _TUPLE, _FIELDS, _PAIRS, _GENERATOR = "array", "tuple", "fields", "pairs", "generator"


def kept(state: Any) -> str:
    """Return a state as text.

    Raises:
        TypeError: Something in it cannot be kept.
    """
    return json.dumps(_plain(state))


def remembered(text: str, like: Any) -> Any:
    """Return the state that :func:`kept` has made text of.

    Args:
        text: It.
        like: A state of the same class: what is no dataclass needs none.
    """
    return _made(json.loads(text), like)


def check_kept(place: str, state: Any) -> None:
    """Refuse a state that cannot be kept.

    Raises:
        InvalidParameterError: It cannot.
    """
    try:
        remembered(kept(state), state)
    except (TypeError, ValueError, AttributeError) as error:
        rule = "numbers, texts, arrays, generators of NumPy, dataclasses of these, lists, tuples, tables"
        raise InvalidParameterError(place, "state", rule, said=" ".join(str(error).split())) from None


def _plain(value: Any) -> Any:
    if value is None or type(value) in (bool, int, float, str):
        return value
    if isinstance(value, np.ndarray) and value.dtype.kind in "biufU":
        return {_ARRAY: value.tolist(), "type": value.dtype.str, "shape": list(value.shape)}
    if isinstance(value, np.generic) and value.dtype.kind in "biuf":
        return {_ARRAY: value.item(), "type": value.dtype.str, "shape": []}
    if isinstance(value, np.random.Generator):
        state = value.bit_generator.state
        return {_GENERATOR: type(value.bit_generator).__name__, "state": _plain(dict(state))}
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {_FIELDS: {one.name: _plain(getattr(value, one.name)) for one in dataclasses.fields(value)}}
    if type(value) is list:
        return [_plain(one) for one in value]
    if type(value) is tuple:
        return {_TUPLE: [_plain(one) for one in value]}
    if type(value) is dict:
        return {_PAIRS: [[_plain(key), _plain(one)] for key, one in value.items()]}
    raise TypeError(f"a {type(value).__name__}")


def _made(content: Any, like: Any = None) -> Any:
    if isinstance(content, list):
        known = like if isinstance(like, list) and len(like) == len(content) else [None] * len(content)
        return [_made(one, hint) for one, hint in zip(content, known, strict=True)]
    if not isinstance(content, dict):
        return content
    if _ARRAY in content:
        array = np.array(content[_ARRAY], dtype=content["type"]).reshape(content["shape"])
        return array if content["shape"] or isinstance(like, np.ndarray) else array[()]
    hints: Any
    if _TUPLE in content:
        hints = like if isinstance(like, tuple) and len(like) == len(content[_TUPLE]) else ()
        return tuple(_made(content[_TUPLE], list(hints) or None))
    if _PAIRS in content:
        hints = like if isinstance(like, dict) else {}
        pairs = ((_made(key), one) for key, one in content[_PAIRS])
        return {key: _made(one, hints.get(key)) for key, one in pairs}
    if _GENERATOR in content:
        bits = getattr(np.random, content[_GENERATOR])()
        bits.state = _made(content["state"])
        return np.random.Generator(bits)
    made = copy.copy(like)
    if not dataclasses.is_dataclass(made):
        raise TypeError("a dataclass that did not stand there at the start")
    for name, one in content[_FIELDS].items():
        object.__setattr__(made, name, _made(one, getattr(like, name)))
    return made
