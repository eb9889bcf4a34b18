"""The modes of elements in a state: which they are, and whether those of two states are the same."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from antenna_pin.base.state import State
from antenna_pin.dynamics import Adjustments, System, Workspace, acting_in
from antenna_pin.elements import Modal
from antenna_pin.errors import InvalidParameterError

__all__ = ["ModeNow", "NotAlikeError", "check_modes_alike", "modes_of", "take_up_modes"]


class NotAlikeError(InvalidParameterError):
    """Two states whose distance is none of numbers: other contacts touch, or elements are in other modes."""


class ModeNow(NamedTuple):
    """The mode of an element in a state.

    Attributes:
        label: What messages call the element.
        number: Of the mode.
        word: For it.
    """

    label: str
    number: int
    word: str


def modes_of(system: System, state: State) -> Mapping[str, ModeNow]:
    """Return the modes of elements in a state, by their places.

    Raises:
        InvalidParameterError: Events have changed more of it than modes.
    """
    acting = {one.place: one for one in acting_in(system)}
    modal = {place: one for place, one in acting.items() if isinstance(one.element, Modal)}
    numbers = {place: one.element.mode for place, one in modal.items()}  # type: ignore[attr-defined]
    for key, value in state.adjusted:
        place, _, name = key.rpartition(".")
        if place in modal and name in modal[place].element.own_keys():
            if name == "mode":
                numbers[place] = int(value)
        elif value != (own := float(getattr(acting[place].element, name))):
            rule = (
                f"one in which no event has left {key} at another value than its own, {own:g}, and no latch "
                "has switched anything off; begin at another instant"
            )
            raise InvalidParameterError("chart", "state", rule, value)
    return {
        place: ModeNow(one.label, numbers[place], one.element.modes[numbers[place]])  # type: ignore[attr-defined]
        for place, one in modal.items()
    }


def take_up_modes(workspace: Workspace, state: State) -> None:
    """Give a workspace's program the modes of a state."""
    if state.adjusted:
        adjustments = Adjustments(workspace.system, workspace.program)
        for place, value in state.adjusted:
            adjustments.set(place, value)


def check_modes_alike(origin: Mapping[str, ModeNow], other: Mapping[str, ModeNow]) -> None:
    """Refuse modes that are not those of the origin.

    Raises:
        NotAlikeError: It names the element.
    """
    for place, one in origin.items():
        if other[place].number != one.number:
            rule = (
                f"{one.word!r} as at the origin; begin at another instant, or, if it changes once and for "
                "good as a latch does, behind that"
            )
            raise NotAlikeError("chart", one.label, rule, other[place].word)
