"""The drives and springs of a system, one after another."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from antenna_pin.dynamics.system import System
from antenna_pin.elements import ForceElement

__all__ = ["Acting", "acting_in"]


class Acting(NamedTuple):
    """A drive or a spring of a system.

    Attributes:
        family: ``drive`` or ``spring``.
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
        return f"{self.family} {self.name!r}"

    @property
    def place(self) -> str:
        """Where it stands in a scenario."""
        return f"{self.family}s.{self.name}"


def acting_in(system: System) -> Iterator[Acting]:
    """Yield the drives, then the springs of a system."""
    for family, elements, blocks in (
        ("drive", system.drives, system.drive_blocks),
        ("spring", system.springs, system.spring_blocks),
    ):
        for name, element in elements.items():
            yield Acting(family, name, element, blocks[name])
