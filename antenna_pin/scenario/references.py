"""References: courses over time that motions and controllers follow by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Literal

from antenna_pin.elements import REFERENCES
from antenna_pin.scenario._base import refuse, refuse_name
from antenna_pin.scenario._joint import JointTable
from antenna_pin.scenario._kinds import Tables
from antenna_pin.scenario._made import MadeSpec, made_of, name_of_table

__all__ = ["REFERENCE_SPECS", "ReferenceSpec", "check_references"]


class ReferenceSpec(JointTable, MadeSpec):
    """A table of a reference."""

    def build(self, **more: Any) -> Any:
        """Return the reference; of a sum its ``parts`` have to be given."""
        if "parts" in type(self).model_fields and "parts" not in more:
            return None
        return super().build(**more)


def _spec(kind: str) -> type[ReferenceSpec]:
    cls, key = REFERENCES[kind], (Literal[kind], ...)
    names: dict[str, Any] = {"parts": tuple[str, ...]} if "parts" in cls.__dataclass_fields__ else {}
    return made_of(cls, ReferenceSpec, key, __name__, (), **names)


REFERENCE_SPECS = Tables(REFERENCES, _spec)
"""The tables of references by their kind."""


def __getattr__(name: str) -> Any:
    """Return the class of a table by its name, by which a scenario that is pickled finds it again."""
    for kind, place in REFERENCES.places.items():
        if name_of_table(place) == name:
            return REFERENCE_SPECS[kind]
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


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
