"""The elements of a system, family by family."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import kernels
from antenna_pin.dynamics.system import System
from antenna_pin.elements import FAMILIES, ForceElement

__all__ = ["Acting", "acting_in", "check_begins"]


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


def check_begins(system: System, y: NDArray[np.float64]) -> None:
    """Refuse a start [q, v, x] outside the range of an element that is on."""
    for one in acting_in(system):
        if one.element.acts and one.element.acts_at is not None and one.element.ends:
            angle, _, _, _ = kernels.joint_motion(system.program, one.block, y, system.model.nq)
            one.element.check_begin(one.label, float(angle))


def acting_in(system: System) -> Iterator[Acting]:
    """Yield the drives, then the springs of a system, then those of further families."""
    for family, elements in system.families.items():
        for name, element in elements.items():
            yield Acting(family, name, element, system.element_blocks[family][name])
