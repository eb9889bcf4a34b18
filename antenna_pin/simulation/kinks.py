"""Where an element's effort has a kink: steps end there, so that they stay smooth inside."""

from __future__ import annotations

from dataclasses import dataclass

from antenna_pin.dynamics import System, acting_in
from antenna_pin.simulation.events import Angle, Event, Rate, Stop, Time
from antenna_pin.simulation.moment import Moment
from antenna_pin.simulation.own_actions import Edge, Kink

__all__ = ["Passing", "edges_of", "ends_of", "kinks_of"]


@dataclass(frozen=True, slots=True)
class Passing:
    """The function of an element that is zero where its effort has a kink.

    Attributes:
        block: Place of the element in the program.
        number: Of the function.
    """

    block: int
    number: int = 0

    def __call__(self, moment: Moment) -> float:
        """Return how far it is past the kink."""
        return moment.kink(self.block, self.number)


@dataclass(frozen=True, slots=True)
class End(Angle):
    """End of the range of an element; its joint may lie beyond while the element is off.

    Attributes:
        block: Place of the element in the program.
        side: Of the range: -1 below the end, +1 above it.
    """

    block: int
    side: float

    def __call__(self, moment: Moment) -> float:
        """Return the distance of the joint past the end; the side of the range while the element is off."""
        return Angle.__call__(self, moment) if moment.acts(self.block) else self.side


def ends_of(system: System) -> tuple[Event, ...]:
    """Return the events at which a run ends, for an element knows nothing of what is beyond."""
    return tuple(
        Event(
            name=f"{one.label} has no torque beyond {end:g}",
            when=End(joint, end, one.block, 1.0 if end == min(one.element.ends) else -1.0),
            action=Stop(),
        )
        for one in acting_in(system)
        if (joint := one.element.acts_at) is not None
        for end in one.element.ends
    )


def edges_of(system: System) -> tuple[Event, ...]:
    """Return the events at which elements change by themselves: pulses begin and end, motions jump."""
    return tuple(
        Event(name=f"{one.label} changes", when=Time(*edges), action=Edge(one.place))
        for one in acting_in(system)
        if (edges := one.element.edges)
    )


def kinks_of(system: System) -> tuple[Event, ...]:
    """Return the events at which steps end for the sake of elements whose effort has kinks.

    Names are unique, for a run that continues another finds the memory of an event by its name.
    """
    kinks = [
        Event(
            name=f"{one.label} has a kink{f' ({k + 1})' if k else ''}",
            when=Passing(one.block, k),
            action=Kink(),
        )
        for one in acting_in(system)
        for k in range(one.element.kinks)
    ]
    reversals = [
        Event(name=f"{one.label} has a kink where {joint!r} turns back", when=Rate(joint), action=Kink())
        for one in acting_in(system)
        for joint in one.element.reversals
    ]
    return (*kinks, *reversals)
