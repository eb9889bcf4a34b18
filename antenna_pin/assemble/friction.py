"""Friction of joints themselves: what the URDF's ``<dynamics>`` says and the scenario changes."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import NamedTuple

from antenna_pin.assemble.places import check_motion, slides, where
from antenna_pin.assemble.variant import as_written
from antenna_pin.base.readable import readable
from antenna_pin.elements import JointFriction, StickingFriction
from antenna_pin.errors import ScenarioError
from antenna_pin.mechanism import Mechanism
from antenna_pin.scenario import Scenario, moved_joints

__all__ = ["Frictions", "frictions_of"]

# Of its limit: the load by which the creep of a friction that is rounded off is described.
_LOAD = 0.5


class Frictions(NamedTuple):
    """Friction of joints themselves.

    Attributes:
        smooth: That which is rounded off at rest, by name.
        sticking: That which sticks, by name.
        left_out: Lines on what is not simulated.
        assumed: Lines on what is rounded off though nothing says so.
    """

    smooth: dict[str, JointFriction]
    sticking: dict[str, StickingFriction]
    left_out: tuple[str, ...]
    assumed: tuple[str, ...]


def frictions_of(scenario: Scenario, mechanism: Mechanism, others: Collection[str]) -> Frictions:
    """Return the friction of each joint that has some, as ``JOINT.dynamics``.

    That of a joint with play acts about its axis, beside the friction of its contacts.

    Args:
        scenario: Its ``mechanism.joints`` go before the URDF.
        mechanism: The mechanism, with the freedoms that joints have in this case.
        others: Names of springs and frictions, which these must differ from.

    Raises:
        ScenarioError: Units of another motion, a speed without friction, or a spring of that name.
    """
    urdf = as_written(scenario)
    types = {name: joint.type for name, joint in urdf.joints.items()}
    numbers = {name: dict(given) for name, given in urdf.joint_friction.items()}
    for name, change in scenario.mechanism.joints.items():
        for key in ("damping", "friction"):
            if (value := getattr(change, key)) is not None:
                numbers.setdefault(name, {})[key] = value
        place = where(scenario, "mechanism", "joints", name)
        for key in ("regularisation_speed", "sticks"):
            if getattr(change, key) is not None and not numbers.get(name, {}).get("friction"):
                raise ScenarioError(
                    f"{place}.{key}: must be left out of a joint without friction; give it friction, here or "
                    "in the URDF"
                )
        if change.regularisation_speed is not None:
            if change.sticks:
                raise ScenarioError(
                    f"{place}.regularisation_speed: must be left out of a joint whose friction sticks, for "
                    "that is not rounded off; leave out one of the two"
                )
            numbers[name]["regularisation_speed"] = change.regularisation_speed
    # Those have an axis though they are free.
    with_axis = {*scenario.clearance, *(one.joint for one in scenario.families.get("bearings", {}).values())}
    moved = moved_joints(scenario.model_dump(include={"drives", "couplings"}, exclude_none=True))
    found: dict[str, JointFriction] = {}
    sticking: dict[str, StickingFriction] = {}
    assumed: list[str] = []
    left_out = list(urdf.not_simulated)
    for name, given in numbers.items():
        if name not in mechanism.joints or not (given.get("damping") or given.get("friction")):
            continue
        slot = mechanism.joint(name)
        if name in scenario.mechanism.joints:
            check_motion(scenario, slot, scenario.mechanism.joints[name].motion, "mechanism", "joints", name)
        if slot.kind in ("floating", "planar") and name not in with_axis:
            left_out.append(
                f"{urdf.where}: joint {name!r}: its damping and friction are not simulated, for it is made "
                f"{slot.kind} from {types[name]} and has no axis"
            )
            continue
        own = f"{name}.dynamics"
        if own in others:
            family = "springs" if own in scenario.springs else "frictions"
            raise ScenarioError(
                f"{where(scenario, family, own)}: must have another name, which that of the joint's own "
                "friction bears"
            )
        dry, wet = given.get("friction", 0.0), given.get("damping", 0.0)
        spec = scenario.mechanism.joints.get(name)
        sticks = None if spec is None else spec.sticks
        can_stick = slot.kind not in ("floating", "planar") and name not in moved
        if sticks or (sticks is None and can_stick and dry > 0.0 and "regularisation_speed" not in given):
            sticking[own] = StickingFriction(joint=name, coulomb=dry, viscous=wet)
            continue
        found[own] = JointFriction(joint=name, **given)  # type: ignore[arg-type]  # of numbers only
        if dry > 0.0 and name not in moved:
            assumed.append(_said_of_creep(found[own], slides(scenario, slot), can_stick))
    return Frictions(found, sticking, tuple(left_out), tuple(assumed))


def _said_of_creep(friction: JointFriction, slid: bool, can_stick: bool) -> str:
    """Return by how much a joint creeps under a load that its friction should hold."""
    rate = friction.regularisation_speed * _LOAD / math.sqrt(1.0 - _LOAD**2)
    units = ("N", "m/s") if slid else ("N m", "rad/s")
    limit, creep = readable(friction.friction, units[0], 3), readable(rate, units[1], 3)
    way_out = (
        f"mechanism.joints.{friction.joint}.sticks = true holds it"
        if can_stick
        else "only a joint without play can stick; a lower regularisation_speed creeps less"
    )
    return (
        f"{friction.joint}: its friction of {limit} is rounded off at rest and does not stick: under half "
        f"that load it creeps at {creep}; {way_out}"
    )
