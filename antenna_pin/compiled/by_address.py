"""Named tuples that compiled code passes by address instead of word by word.

An array is five to nine words in compiled code, and a step works on forty arrays: writing them for each call,
and reading them again in the callee, takes as long as the arithmetic. A tuple passed by address is laid out
once, when Python calls; nothing changes the words afterwards.
"""

from __future__ import annotations

from typing import Any, TypeVar

_Class = TypeVar("_Class", bound=type)
_classes: set[type] = set()


def by_address(cls: _Class) -> _Class:
    """Mark a named tuple class for passing by address, read-only in compiled code."""
    _classes.add(cls)
    return cls


def is_by_address(value: Any) -> bool:
    """Return whether a value is of a class marked by :func:`by_address`."""
    return type(value) in _classes
