"""The elements of a system, family by family."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from antenna_pin.dynamics.system import System
from antenna_pin.elements import FAMILIES, ForceElement

__all__ = ["Acting", "acting_in"]


class Acting(NamedTuple):
    """An element of a system.

    Attributes:
        family: The table that a scenario has for it, such as ``drives``.
        name: Its own.
        element: What it is.
        block: Where its block stands in a program.
    """

    family: str
    name: str
    element: ForceElement
    block: int

    @property
    def label(self) -> str:
        """What messages call it."""
        return f"{FAMILIES[self.family].word} {self.name!r}"

    @property
    def place(self) -> str:
        """Where it stands in a scenario."""
        return f"{self.family}.{self.name}"


def acting_in(system: System) -> Iterator[Acting]:
    """Yield the drives, then the springs of a system, then those of further families."""
    for family, elements in system.families.items():
        for name, element in elements.items():
            yield Acting(family, name, element, system.element_blocks[family][name])
