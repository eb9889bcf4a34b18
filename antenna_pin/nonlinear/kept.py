"""Numbers that elements with modes keep of a change, and that their motion goes by from then on.

Where a joint has begun to stick, how fast it has come to a stop: a neighbour keeps its own, so that these are
coordinates of a state as long as they are gone by.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.state import State
from antenna_pin.dynamics import System, acting_in, kernels
from antenna_pin.elements import Modal, kind_of
from antenna_pin.elements import kernels as of_elements

__all__ = ["Kept", "Number"]

Array = NDArray[np.float64]


class Number(NamedTuple):
    """One of them.

    Attributes:
        place: Of the element.
        name: Its own.
        label: What messages call it.
        kind: Of the element.
        words: Where the element's record begins in a program.
        word: Where the number stands there.
        joint: Of the joint's axis in v.
        of_rate: Whether it is one of the joint's rate, else it is one of its way.
        turns: Whether the joint turns without end: whole turns of it act on nothing.
        modes: In which it is gone by.
    """

    place: str
    name: str
    label: str
    kind: int
    words: int
    word: int
    joint: int
    of_rate: bool
    turns: bool
    modes: tuple[int, ...]

    @property
    def key(self) -> str:
        """Where it stands among what was adjusted of a state."""
        return f"{self.place}.{self.name}"

    def holds(self, program: Array) -> bool:
        """Whether the element holds its joint there, by a row."""
        return bool(of_elements.hold(self.kind, program, self.words)[0])


class Kept:
    """All of them, of a system.

    Args:
        system: The system.

    Attributes:
        numbers: In the order of their elements.
        words: Where they stand in a program, (kept,).
        masses: Of each contact, whether it goes by the effective mass that it remembers.
    """

    def __init__(self, system: System) -> None:
        """Find them."""
        self.numbers = tuple(_numbers(system))
        self.words = np.array([one.word for one in self.numbers], dtype=int)
        self.masses = tuple(takes for joint in system.clearances for takes in joint.takes_mass)

    def __len__(self) -> int:
        """How many there are, gone by or not."""
        return len(self.numbers)

    def gone_by(self, program: Array) -> tuple[int, ...]:
        """Return which are gone by in the modes of a program."""
        found = [of_elements.mode(one.kind, program, one.words) in one.modes for one in self.numbers]
        return tuple(np.flatnonzero(found).tolist())

    def between(self, numbers: tuple[int, ...], here: State, there: State) -> Array:
        """Return by how much some of them differ from one state to another, (numbers,)."""
        first, then = (dict(state.adjusted) for state in (here, there))
        out = []
        for one in (self.numbers[k] for k in numbers):
            change = then.get(one.key, 0.0) - first.get(
                one.key, 0.0
            )  # nothing is kept as long as nothing was
            out.append(math.remainder(change, 2.0 * math.pi) if one.turns and not one.of_rate else change)
        return np.array(out)

    def units(self, ways: Array, rates: Array) -> Array:
        """Return what counts as one of each, (kept,), of units of ways and rates, (nv,) each."""
        return np.array([(rates if one.of_rate else ways)[one.joint] for one in self.numbers])


def _numbers(system: System) -> Iterator[Number]:
    for one in acting_in(system):
        element = one.element
        if not isinstance(element, Modal):
            continue
        words = one.block + int(kernels.PARAMETERS)
        head = system.program[one.block :][: kernels.PARAMETERS].view(kernels.ELEMENT)[0]
        joint = _axis(system, int(head["v"]), element.acts_at)
        for name, of in element.goes_by.items():
            at = _place_in_record(element, name)
            if at is not None:
                label, modes = f"{one.label} {name}", element.goes_by_in
                kind, of_rate, turns = kind_of(type(element)), of == "rate", int(head["turn"]) >= 0
                yield Number(one.place, name, label, kind, words, words + at, joint, of_rate, turns, modes)


def _axis(system: System, first: int, joint: str | None) -> int:
    """Return where in v a joint turns or slides about its axis, with that of a joint with play last."""
    return first if joint is None else system.mechanism.joint(joint).v.stop - 1


def _place_in_record(element: Modal, name: str) -> int | None:
    """Return at which word of its record an element has a number; None if it has no such part."""
    changes: dict[str, Any] = {name: getattr(element, name) + 1.0}
    other = dataclasses.replace(element, **changes).words_of_kernel()
    found = np.flatnonzero(other != element.words_of_kernel())
    return int(found[0]) if len(found) else None
