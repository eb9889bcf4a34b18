"""The springs of elastic parts among those of a system."""

from __future__ import annotations

from collections.abc import Mapping

from antenna_pin.elements import ForceElement, JointSpring
from antenna_pin.errors import InvalidParameterError
from antenna_pin.flexible import ElasticPart

__all__ = ["springs_and_parts"]


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
