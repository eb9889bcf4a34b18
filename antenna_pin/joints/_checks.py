"""Checks of a joint with play, beyond those of its parts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from antenna_pin.base.arguments import check_takes
from antenna_pin.compiled.decorators import record
from antenna_pin.contact.friction import check_at_rest
from antenna_pin.contact.normal import CompiledNormalLaw, normal_questions
from antenna_pin.contact.records import NORMAL_LAW, number_of
from antenna_pin.errors import InvalidParameterError
from antenna_pin.joints.geometry import ClearanceGeometry

__all__ = ["check_asked", "check_friction", "check_load"]

_ROOM = "antenna_pin.contact."


def _check_kinds(place: str, law: CompiledNormalLaw) -> None:
    """Refuse a law with a code that kernels do not support."""
    kinds = record(law.code(), NORMAL_LAW)
    for what, part in (("elastic", law.parts.elastic), ("dissipation", law.parts.dissipation)):
        own = getattr(part, "kernel", None)
        if own is None or not own.__module__.startswith(_ROOM) or kinds[what] != number_of(own):
            rule = "that of a kernel of antenna_pin.contact; or give it no code()"
            raise InvalidParameterError(
                f"{place}: {type(law).__name__}", f"{what} kind", rule, float(kinds[what])
            )


def check_asked(place: str, normal_laws: Sequence[Any], friction: Any, backend: object) -> None:
    """Refuse laws and a backend that a run cannot use.

    Args:
        place: The joint, for the message.
        normal_laws: Normal laws of its contacts.
        friction: Its friction law.
        backend: Backend of its gaps, or its name.
    """
    if backend not in ("coal", "closed-form") and not hasattr(backend, "query"):
        raise InvalidParameterError(place, "backend", "coal, closed-form or an object with query()", backend)
    for law in normal_laws:
        if isinstance(law, CompiledNormalLaw):
            _check_kinds(place, law)
        elif not hasattr(law, "code"):
            for name, function, words in normal_questions(law):
                check_takes(f"{place}: {type(law).__name__}", name, function, *(word for word, _ in words))
    if not hasattr(friction, "code"):
        law = f"{place}: {type(friction).__name__}"
        check_takes(law, "coefficient", friction.coefficient, "slip speed")
    if not isinstance(backend, str):
        query: Any = getattr(backend, "query", None)
        check_takes(f"{place}: {type(backend).__name__}", "query", query, "pose", "table", "row", "wanted")


def check_friction(place: str, law: Any, compiled: bool) -> None:
    """Refuse friction that jumps at rest, or bristles beside Python laws.

    Args:
        place: The joint, for the messages.
        law: The law.
        compiled: Whether all normal laws run compiled.
    """
    if not hasattr(law, "code") and hasattr(law, "coefficient"):
        check_at_rest(f"{place}: {type(law).__name__}", law.coefficient)
    if getattr(law, "states", 0) and not compiled:
        rule = "a law of the slip speed beside a normal law in Python (bristles need compiled laws)"
        raise InvalidParameterError(place, "friction", rule, law)


def check_load(
    place: str,
    load: str,
    *,
    geometry: ClearanceGeometry,
    backend: object,
    strips: int,
    sectors: int,
    compiled: bool,
    bristles: bool,
) -> None:
    """Refuse a kind of load, or combinations that distributed load excludes.

    Args:
        place: The joint, for the message.
        load: "point" or "distributed".
        geometry: Shape of the joint.
        backend: Backend of its gaps.
        strips: Number of strips of the bore.
        sectors: Number of sectors of a flange.
        compiled: Whether all laws run compiled.
        bristles: Whether the friction law has states.
    """
    if load not in ("point", "distributed"):
        raise InvalidParameterError(place, "load", "point or distributed", load)
    if load == "point":
        return
    if geometry.patch_radius is None:
        raise InvalidParameterError(
            place, "load", "point where the joint is not one of journal, bore and flanges", load
        )
    if not isinstance(backend, str):
        raise InvalidParameterError(
            place, "load", "point with a backend of one's own; distributed takes coal or closed-form", load
        )
    if strips < 2 or strips % 2:
        raise InvalidParameterError(place, "strips", "an even number of 2 or more", strips)
    if sectors < 3:
        raise InvalidParameterError(place, "sectors", "3 or more", sectors)
    if not compiled:
        raise InvalidParameterError(
            place, "load", "point with laws in Python; distributed takes built-in laws", load
        )
    if bristles:
        raise InvalidParameterError(
            place, "load", "point with a bristle friction law (it has one state per contact)", load
        )
