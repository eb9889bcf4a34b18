"""What is refused of elements with modes: derivatives of a flow across their changes are not there."""

from __future__ import annotations

from antenna_pin.dynamics import System, acting_in
from antenna_pin.elements import Modal, OnLinks
from antenna_pin.errors import InvalidParameterError

__all__ = ["check_no_modes"]


def check_no_modes(place: str, system: System) -> None:
    """Refuse a system with an element that changes its mode.

    Raises:
        InvalidParameterError: It names the element.
    """
    for one in acting_in(system):
        pulsed = isinstance(one.element, OnLinks) and one.element.edges
        if isinstance(one.element, Modal) or pulsed:
            rule = "without elements that change their mode: runs, sections and diagrams know them"
            raise InvalidParameterError(place, "system", rule, said=one.label)
