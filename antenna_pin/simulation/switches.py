"""Functions of elements at which their modes change, and the record of a change."""

from __future__ import annotations

import math
from dataclasses import dataclass

from antenna_pin.dynamics import System, acting_in
from antenna_pin.elements import Modal
from antenna_pin.engine.watch_kernels import WEIGHED
from antenna_pin.simulation.events import Event
from antenna_pin.simulation.kinks import edges_of, ends_of, kinks_of
from antenna_pin.simulation.moment import Moment
from antenna_pin.simulation.own_actions import Switch

__all__ = ["Changed", "Switching", "hold_of", "own_events", "switches_of"]


@dataclass(frozen=True, slots=True)
class Switching:
    """The function of an element that is positive while its mode stays.

    Attributes:
        place: Of the element.
        block: Place of the element in the program.
        number: Of the function.
        hold: Of the hold whose load it asks for, or -1; WEIGHED if for its joint's reduced inertia.
    """

    place: str
    block: int
    number: int
    hold: int

    def __call__(self, moment: Moment) -> float:
        """Return its value."""
        return moment.switch(self.block, self.number, self.hold)[0]

    def rate(self, moment: Moment) -> float:
        """Return its rate, 0 where that is not known."""
        return moment.switch(self.block, self.number, self.hold)[1]


@dataclass(frozen=True, slots=True)
class Changed:
    """A change of mode that has happened.

    Attributes:
        name: What it is, such as ``stop hinge: upper: on``.
        element: Place of the element.
        what: The change in words, such as ``upper: on``.
        time: When [s].
        mode: The next one, in a word.
        angle: Of the joint [rad] ([m]).
        rate: Before it [rad/s] ([m/s]), ``rate_after`` it.
        rate_after: See there.
        loss: Energy lost in the impulse [J].
        impulse: On the child [N m s] ([N s]).
        energy: Of the joint's own motion before, of elements that weigh it [J]; NaN of others.
    """

    name: str
    element: str
    what: str
    time: float
    mode: str
    angle: float
    rate: float
    rate_after: float
    loss: float
    impulse: float
    energy: float = math.nan


def switches_of(system: System) -> tuple[Event, ...]:
    """Return the events at which elements may change their mode."""
    holds = [one.name for one in system.holds]
    return tuple(
        Event(
            name=f"{one.label} switches by {k}",
            when=Switching(one.place, one.block, k, hold_of(one.element, one.place, k, holds)),
            direction=-1,
            action=Switch(one.place, k),
        )
        for one in acting_in(system)
        if isinstance(one.element, Modal) and one.element.ever_changes
        for k in range(one.element.switches)
    )


def hold_of(element: Modal, place: str, k: int, holds: list[str]) -> int:
    """Return what function k of an element asks for: the number of its hold, WEIGHED, or -1 for nothing."""
    if k in element.weighed:
        return WEIGHED
    return holds.index(place) if k in element.loaded else -1


def own_events(system: System) -> tuple[Event, ...]:
    """Return what every run of a system looks for itself."""
    return (*ends_of(system), *kinks_of(system), *edges_of(system), *switches_of(system))
