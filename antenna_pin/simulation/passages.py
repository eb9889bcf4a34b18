"""What happens at an instant of a run, kept so that it can be done again to the states of neighbours."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.elements import Change, Met, Modal
from antenna_pin.simulation.events import Event

__all__ = ["Blow", "Passage", "Turned"]

Array = NDArray[np.float64]


class Turned(NamedTuple):
    """An element that has changed its mode.

    Attributes:
        place: Of it.
        before: As it was.
        change: What it does where it meets its joint.
    """

    place: str
    before: Modal
    change: Callable[[Modal, Met], Change | None]


class Blow(NamedTuple):
    """An impulse.

    Attributes:
        program: Of the elements as they are in it.
        place: In v of the joint that is struck.
        block: Of the element in the program, to tell the joint's rate.
        restitution: Of that joint; None where it, or what is held besides, comes to rest by its row.
    """

    program: Array
    place: int
    block: int
    restitution: float | None


class Passage(NamedTuple):
    """What has happened at an instant, by an event.

    Attributes:
        time: When [s].
        event: By which.
        acts: Whether it did what it is there for.
        done: What elements did, in order.
        program: Behind it.
    """

    time: float
    event: Event
    acts: bool
    done: tuple[Turned | Blow, ...]
    program: Array
