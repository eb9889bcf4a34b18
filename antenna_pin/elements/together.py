"""Rules of stops and latches at one joint."""

from __future__ import annotations

from collections.abc import Mapping

from antenna_pin.elements.capture import Capture
from antenna_pin.elements.element import ForceElement
from antenna_pin.elements.rigid_stop import RigidStop
from antenna_pin.errors import MechanismError, UnknownNameError


def check_together(families: Mapping[str, Mapping[str, ForceElement]]) -> None:
    """Refuse latches beyond a stop, and latches with overlapping windows.

    Args:
        families: All elements of a system, by family and then by name.

    Raises:
        MechanismError: The first such latch.
        UnknownNameError: A latch switches off an unknown element, or one without a switch.
    """
    elements = {f"{table}.{name}": one for table, named in families.items() for name, one in named.items()}
    latches = {place: one for place, one in elements.items() if isinstance(one, Capture)}
    for place, latch in latches.items():
        for name in latch.switches_off:
            if not hasattr(elements.get(name), "on"):
                known = [one for one, element in elements.items() if hasattr(element, "on") and one != place]
                raise UnknownNameError(place, "element in switches_off", name, known)
        first, last = latch.window
        for other, stop in elements.items():
            if isinstance(stop, RigidStop) and stop.joint == latch.joint:  # into others a joint is pressed
                if last < stop.lowest or first > stop.highest:
                    raise MechanismError(
                        f"{place}: its window, {first:g} to {last:g}, must be within the stop {other}, "
                        f"{stop.lowest:g} to {stop.highest:g}: joint {latch.joint!r} does not get there"
                    )
        for other, one in latches.items():
            if other == place:
                break
            begin, end = one.window
            if one.joint == latch.joint and first < end and begin < last:
                raise MechanismError(
                    f"{place}: its window, {first:g} to {last:g}, must be apart from that of {other}, "
                    f"{begin:g} to {end:g}, at joint {latch.joint!r} too: only one can capture it"
                )
