"""What is looked at of controllers before a run begins."""

from __future__ import annotations

from collections.abc import Mapping

from antenna_pin.control import Controller, check_controller, measures_of
from antenna_pin.dynamics import JointMotion, System, actuators_of, settled
from antenna_pin.errors import InvalidParameterError, UnknownNameError

__all__ = ["check_controllers"]


def check_controllers(controllers: Mapping[str, Controller], system: System) -> None:
    """Refuse controllers that do not fit a system, or each other.

    Raises:
        AntennaPinError: What they command or measure is not there, or two command one thing.
    """
    places = actuators_of(system)
    taken: dict[str, str] = {}
    for name, one in controllers.items():
        check_controller(name, one)
        for command in one.commands:
            if command not in places:
                raise UnknownNameError(f"controller {name!r}", "actuator", command, places)
            if places[command] in taken:
                rule = f"of another actuator than controller {taken[places[command]]!r}"
                raise InvalidParameterError(f"controller {name!r}", "commands", rule, command)
            taken[places[command]] = name
    for name, one in settled(controllers, system).items():
        for measure in measures_of(one):
            place = f"controller {name!r}: measures {str(measure)!r}"
            if measure.of == "joint":
                if measure.name not in system.mechanism.joints:
                    raise UnknownNameError(place, "joint", measure.name, system.mechanism.joints)
                JointMotion(system, measure.name)
            elif measure.of == "contact" and measure.name not in system.contact_names:
                raise UnknownNameError(place, "contact", measure.name, system.contact_names)
            elif measure.of == "actuator" and measure.name not in places:
                raise UnknownNameError(place, "actuator", measure.name, places)
            elif measure.of == "axis" and system.mechanism.base != "free":
                rule = "of a joint where mechanism.base is fixed"
                raise InvalidParameterError(f"controller {name!r}", "measures", rule, str(measure))
