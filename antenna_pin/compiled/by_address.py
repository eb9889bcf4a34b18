"""Named tuples that compiled code passes by address instead of word by word.

An array is five to nine words to compiled code, and what a step works on is forty arrays: written for each
call, and read again by who is called, they take as long as the arithmetic. Of a tuple that is handed on by
its address the words are laid out once, when Python calls, and nobody changes them from there on.
"""

from __future__ import annotations

from typing import Any, TypeVar

__all__ = ["by_address", "is_by_address"]

_Class = TypeVar("_Class", bound=type)
_classes: set[type] = set()


def by_address(cls: _Class) -> _Class:
    """Mark a named tuple class for passing by address, read-only in compiled code."""
    _classes.add(cls)
    return cls


def is_by_address(value: Any) -> bool:
    """Return whether a value is of a class marked by :func:`by_address`."""
    return type(value) in _classes
