"""What takes commands while it runs: by name, and where the number stands that is set."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from antenna_pin.control import AttitudeFeedback, Controller, Pid
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
    """Return controllers with what they take from the system that they command: joints, and their axes."""
    places = actuators_of(system)
    elements = {one.place: one.element for one in acting_in(system)}
    found: dict[str, Controller] = {}
    for name, one in controllers.items():
        joints = {command: elements[places[command].rpartition(".")[0]].acts_at for command in one.commands}
        if isinstance(one, Pid):
            found[name] = one.at(joints)
        elif isinstance(one, AttitudeFeedback):
            axes = {command: _axis_in_base(system, joint) for command, joint in joints.items()}
            found[name] = one.about(axes)
        else:
            found[name] = one
    return found


def _axis_in_base(system: System, joint: str | None) -> NDArray[np.float64] | None:
    """Return the axis of a joint in the axes of a free base that carries it, (3,); None of others."""
    mechanism = system.mechanism
    if joint is None or mechanism.base != "free":
        return None
    slot = mechanism.joint(joint)
    if mechanism.model.parents[slot.joint_id] != 1:
        return None
    turned = mechanism.model.jointPlacements[slot.joint_id].rotation @ slot.frame_rotation.T
    return np.asarray(turned @ slot.axis)
