"""Tables that are one of several classes by the value of a key: each class is made when it is first met.

Of some sixty kinds of tables a file has a handful. Making the class of one, and what pydantic checks it by,
takes a millisecond or two: all of them together take longer than everything else that is done with a file.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, PydanticKnownError, core_schema

from antenna_pin.base.units import shown
from antenna_pin.scenario._base import Spec, refuse

__all__ = ["OneOf", "Tables"]


class Tables(Mapping[str, type[Any]]):
    """Classes of tables by their kind, each made when it is first asked for."""

    def __init__(self, kinds: Iterable[str], make: Callable[[str], type[Spec]]) -> None:
        """Take what makes them.

        Args:
            kinds: The kinds that there are, in the order in which they are told.
            make: Returns the class of a kind; asked once for each.
        """
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
