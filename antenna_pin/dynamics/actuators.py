"""What takes commands while it runs: by name, and where the number stands that is set."""

from __future__ import annotations

from collections.abc import Mapping

from antenna_pin.control import Controller
from antenna_pin.dynamics.acting import acting_in
from antenna_pin.dynamics.system import System

__all__ = ["actuators_of", "settled"]


def actuators_of(system: System) -> Mapping[str, str]:
    """Return the places that take commands, ``drives.motor.value``, by all names that they have.

    These are ``motor``, if no other is called so, ``drives.motor`` and the place itself.
    """
    found: dict[str, str] = {}
    twice = set()
    for one in acting_in(system):
        if one.element.commanded:
            place = f"{one.place}.{one.element.commanded}"
            if one.name in found:
                twice.add(one.name)
            found |= {one.name: place, one.place: place, place: place}
    return {name: place for name, place in found.items() if name not in twice}


def settled(controllers: Mapping[str, Controller], system: System) -> dict[str, Controller]:
    """Return controllers with what they take from the system that they command."""
    places = actuators_of(system)
    elements = {one.place: one.element for one in acting_in(system)}
    found = {}
    for name, one in controllers.items():
        joints = {command: elements[places[command].rpartition(".")[0]].acts_at for command in one.commands}
        at = getattr(one, "at", None)
        found[name] = one if at is None else at(joints)
    return found
