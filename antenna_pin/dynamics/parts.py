"""The elements of a system: its springs with those of elastic parts, and all by family."""

from __future__ import annotations

from collections.abc import Mapping

from antenna_pin.elements import FAMILIES, Element, ForceElement, JointSpring, check_together
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.flexible import ElasticPart

__all__ = ["families_of", "springs_and_parts"]


def springs_and_parts(
    springs: Mapping[str, ForceElement], elastic: Mapping[str, ElasticPart]
) -> dict[str, ForceElement]:
    """Return springs and, behind them, those of elastic parts, by name.

    Raises:
        InvalidParameterError: A spring has the name of a part, or a part another name than its own.
    """
    found = dict(springs)
    for name, part in elastic.items():
        if name in springs:
            rule = "of another name than an elastic part's, whose own spring bears it"
            raise InvalidParameterError("System", f"springs[{name!r}]", rule, name)
        if name != part.name:
            raise InvalidParameterError("System", f"elastic[{name!r}]", "by the part's name", part.name)
        found[name] = JointSpring(joint=name, stiffness=part.stiffness, damping=part.damping)
    return found


def families_of(
    drives: Mapping[str, Element],
    springs: Mapping[str, ForceElement],
    others: Mapping[str, Mapping[str, ForceElement]],
) -> dict[str, dict[str, ForceElement]]:
    """Return all elements by family, in the families' order; of further families those that there are.

    Raises:
        UnknownNameError: There is no such family.
        MechanismError: Stops and latches do not go together.
        InvalidParameterError: One of them has an argument of its own, or an element acts elsewhere.
    """
    own: dict[str, dict[str, ForceElement]] = {"drives": dict(drives), "springs": dict(springs)}
    for table, elements in others.items():
        if table not in FAMILIES:
            raise UnknownNameError("System", "family of elements", table, FAMILIES)
        given = FAMILIES[table].among or table
        if given in own:
            rule = f"left out: it is given as {given}="
            raise InvalidParameterError("System", f"elements[{table!r}]", rule, [*elements])
        for name, element in elements.items():
            if not FAMILIES[table].has(element):
                kinds = (*FAMILIES[table].kinds.values(), *FAMILIES[table].in_python.values())
                rule = f"one of {', '.join(cls.__name__ for cls in kinds)}"
                place = f"elements[{table!r}][{name!r}]"
                raise InvalidParameterError("System", place, rule, said=type(element).__name__)
    found = own | {table: dict(others[table]) for table in FAMILIES if others.get(table)}
    check_together(found)
    return found
