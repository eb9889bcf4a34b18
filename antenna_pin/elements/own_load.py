"""The load of joint friction by the joint's own forces and moments.

Names as those of joint friction in Adams and MotionSolve: F radial and axial, a bending arm.
"""

from __future__ import annotations

from typing import Any

from antenna_pin.errors import InvalidParameterError

_OF_TURNING = ("radius", "axial_radius")
NUMBERS_OF_LOAD = ("radius", "axial_radius", "bending_arm", "middle")
LABELS_OF_LOAD = {"radius": "at radius", "axial_radius": "at axial radius", "bending_arm": "bending arm"}


def check_unloaded(element: Any, *names: str) -> None:
    """Refuse numbers of the load of an element without friction under load."""
    for name in names:
        if getattr(element, name) is not None:
            rule = "left out without a coefficient of friction under load"
            raise InvalidParameterError(element, name, rule, getattr(element, name))


def check_load(element: Any, place: str, slides: bool) -> None:
    """Refuse numbers of a load that a joint of this kind has not, or lacks.

    Args:
        element: The friction.
        place: Its name, for the message.
        slides: Whether its joint slides along its axis rather than turning about it.
    """
    if slides:
        for name in _OF_TURNING:
            if getattr(element, name) is not None:
                rule = f"left out: joint {element.joint!r} slides"
                raise InvalidParameterError(place, name, rule, getattr(element, name))
    elif element.under_load and element.radius is None and element.axial_radius is None:
        rule = f"given, or axial_radius: joint {element.joint!r} turns, and has friction under load"
        raise InvalidParameterError(place, "radius", rule, None)
    elif element.bending_arm is not None and element.radius is None:
        raise InvalidParameterError(place, "radius", "given with a bending_arm", None)


def numbers_of_load(element: Any) -> tuple[float, float, float, float]:
    """Return what hook ``bearing`` returns; zero without load."""
    # A sliding joint has neither radius: there a force presses by itself.
    slides = element.radius is None and element.axial_radius is None
    radial = 1.0 if slides else element.radius or 0.0
    bending = radial / element.bending_arm if element.under_load and element.bending_arm else 0.0
    own = radial if element.under_load else 0.0
    return own, element.axial_radius or 0.0, bending, element.middle or 0.0
