"""References: courses over time that motions and controllers follow by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Literal, Union

from antenna_pin.elements import REFERENCES, Reference
from antenna_pin.elements import Sum as SumOfReferences
from antenna_pin.scenario._base import refuse, refuse_name
from antenna_pin.scenario._joint import JointTable
from antenna_pin.scenario._made import MadeSpec, made_of

__all__ = ["REFERENCE_SPECS", "AnyReference", "ReferenceSpec", "check_references", "reference_file_columns"]


class ReferenceSpec(JointTable, MadeSpec):
    """A table of a reference."""

    def build(self, **more: Any) -> Any:
        """Return the reference; of a sum its ``parts`` have to be given."""
        if "parts" in type(self).model_fields and "parts" not in more:
            return None
        return super().build(**more)


def _specs() -> dict[str, type[ReferenceSpec]]:
    found = {}
    for kind, cls in REFERENCES.items():
        key: Any = (Literal[kind], ...)
        names: dict[str, Any] = {"parts": tuple[str, ...]} if cls is SumOfReferences else {}
        found[kind] = made_of(cls, ReferenceSpec, key, __name__, (), **names)
    return found


REFERENCE_SPECS = _specs()
"""The tables of references by their kind."""

# A scenario that is pickled names its classes as this module does.
globals().update({spec.__name__: spec for spec in REFERENCE_SPECS.values()})

if TYPE_CHECKING:
    AnyReference = ReferenceSpec
else:
    AnyReference = Union[tuple(REFERENCE_SPECS.values())]  # noqa: UP007 - of values
    """A reference; ``kind`` says which class it is."""


def reference_file_columns(kind: object) -> tuple[str, ...] | None:
    """Return the columns of the file that a kind of reference may name instead of numbers; None if none."""
    cls: type[Reference] | None = REFERENCES.get(kind) if isinstance(kind, str) else None
    return getattr(cls, "columns", None)


def check_references(references: Mapping[str, Any], followed: Mapping[tuple[str, ...], str]) -> None:
    """Refuse references that name others that there are not, or themselves.

    Args:
        references: Tables by name.
        followed: Names that are followed, by the place of the key.
    """
    for place, name in followed.items():
        if name not in references:
            refuse_name("reference", name, sorted(references), *place)
    for name in references:
        for other in _parts(references, name, (name,)):
            if other not in references:
                refuse_name("reference", other, sorted(references), "references", name, "parts")


def _parts(references: Mapping[str, Any], name: str, above: tuple[str, ...]) -> Iterator[str]:
    for other in getattr(references[name], "parts", ()):
        yield other
        if other in above:
            refuse(f"must not lead back to {other!r}", "references", name, "parts")
        if other in references:
            yield from _parts(references, other, (*above, other))
