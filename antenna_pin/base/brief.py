"""Short representation of results and models in a shell: arrays and tables by their sizes."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

__all__ = ["brief", "of_size"]

_LONGEST = 60
_SEVERAL = 4


def brief(self: object) -> str:
    """Return a dataclass, or what is given of a scenario's table, on one line; what is long by kind and size.

    For use as ``__repr__ = brief`` in the class.
    """
    if dataclasses.is_dataclass(self):
        names = [item.name for item in dataclasses.fields(self) if item.repr]
    else:
        given: Any = self
        names = [n for n, f in type(given).model_fields.items() if f.repr and n in given.model_fields_set]
    said = ", ".join(f"{name}={of_size(getattr(self, name))}" for name in names)
    return f"{type(self).__name__}({said})"


def of_size(value: Any) -> str:
    """Return a value as Python shows it, or its kind and size where that is long."""
    kind = type(value).__name__
    if hasattr(value, "data_vars"):
        sizes = ", ".join(f"{size} {name}" for name, size in list(value.sizes.items())[:_SEVERAL])
        return f"<{kind}: {sizes}{', ...' if len(value.sizes) > _SEVERAL else ''}>"
    if hasattr(value, "shape") and value.shape != ():
        return f"<{kind} {' x '.join(map(str, value.shape))}>"
    if isinstance(value, Mapping):
        names = ", ".join(map(str, list(value)[:_SEVERAL]))
        return f"<{len(value)}: {names}{', ...' if len(value) > _SEVERAL else ''}>" if value else "{}"
    if isinstance(value, list | tuple) and value and not isinstance(value[0], str | int | float):
        return f"<{len(value)} of {type(value[0]).__name__}>"
    text = repr(value)
    if len(text) <= _LONGEST and "\n" not in text:
        return text
    if isinstance(value, str):
        return repr(f"{' '.join(value[: _LONGEST - 3].split())}...")
    return f"<{len(value)} of {type(value[0]).__name__}>" if isinstance(value, list | tuple) else f"<{kind}>"
