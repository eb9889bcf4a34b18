"""What happens at an instant of a run, kept so that it can be done again to the states of neighbours."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Workspace, acting_in, kernels
from antenna_pin.dynamics.acting import Acting
from antenna_pin.elements import Change, Met, Modal
from antenna_pin.simulation.events import Event
from antenna_pin.simulation.own_actions import Switch

__all__ = ["Blow", "Passage", "Struck", "Turned", "passages_of"]

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


class Struck(NamedTuple):
    """An element that an impulse is of.

    Attributes:
        element: Place of the element.
        at: Place in v of its joint.
        block: Of the element in the program, to tell the joint's rate.
        restitution: Of the joint; None where its row brings it to rest.
    """

    element: str
    at: int
    block: int
    restitution: float | None


class Blow(NamedTuple):
    """The impulses of one instant.

    Attributes:
        program: Of the elements as they are behind them.
        struck: Elements that they are of; those that hold besides have rows in the program.
        apart: Whether none of them changes the rates of the other joints.
    """

    program: Array
    struck: tuple[Struck, ...]
    apart: bool


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

    @property
    def together(self) -> bool:
        """Return whether several blows of it feel each other: in which order they come then decides."""
        return any(isinstance(one, Blow) and len(one.struck) > 1 for one in self.done)


def passages_of(
    done: Sequence[Turned | Blow], events: Sequence[Event], program: Array, workspace: Workspace, t: float
) -> list[Passage]:
    """Return what elements did at an instant, each with the event at which it was located.

    Blows that do not feel each other are each of its own event; those that do, with what they are of, belong
    to the last, and so does what is of none.

    Args:
        done: What they did, in order.
        events: At which their functions passed.
        program: Before it.
        workspace: The run's, with its program behind it.
        t: When [s].
    """
    ranges = {one.place: _words_of(one) for one in acting_in(workspace.system)}
    left, found, before = _apart(done), list[Passage](), program
    coupled = {
        struck.element
        for one in left
        if isinstance(one, Blow) and len(one.struck) > 1
        for struck in one.struck
    }
    for k, event in enumerate(events):
        place = event.action.place if isinstance(event.action, Switch) else ""
        place = "" if place in coupled else place
        last = k + 1 == len(events)
        own = [one for one in left if last or _is_of(one, place)]
        left = [one for one in left if not (last or _is_of(one, place))]
        behind = workspace.program.copy()
        if not last:
            behind[:] = before
            for one in own:
                if isinstance(one, Turned):
                    behind[ranges[one.place]] = workspace.program[ranges[one.place]]
        own = [one._replace(program=behind) if isinstance(one, Blow) and not last else one for one in own]
        found.append(Passage(t, event, True, tuple(own), behind))
        before = behind
    return found


def _words_of(one: Acting) -> slice:
    return slice(one.block, one.block + int(kernels.PARAMETERS) + len(one.element.words_of_kernel()))


def _is_of(one: Turned | Blow, place: str) -> bool:
    if isinstance(one, Turned):
        return one.place == place
    return len(one.struck) == 1 and one.struck[0].element == place


def _apart(done: Sequence[Turned | Blow]) -> list[Turned | Blow]:
    """Return what was done with blows that do not feel each other one by one."""
    found: list[Turned | Blow] = []
    for one in done:
        if isinstance(one, Turned) or len(one.struck) < 2 or not one.apart:
            found.append(one)
        else:
            found += [one._replace(struck=(struck,)) for struck in one.struck]
    return found
