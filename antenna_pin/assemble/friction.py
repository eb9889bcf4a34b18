"""Friction of joints themselves: what the URDF's ``<dynamics>`` says and the scenario changes."""

from __future__ import annotations

from collections.abc import Collection

from antenna_pin.assemble.places import check_motion, where
from antenna_pin.assemble.variant import as_written
from antenna_pin.elements import JointFriction, StickingFriction
from antenna_pin.errors import ScenarioError
from antenna_pin.mechanism import Mechanism
from antenna_pin.scenario import Scenario

__all__ = ["frictions_of"]


def frictions_of(
    scenario: Scenario, mechanism: Mechanism, others: Collection[str]
) -> tuple[dict[str, JointFriction], dict[str, StickingFriction], tuple[str, ...]]:
    """Return the friction of each joint that has some, as ``JOINT.dynamics``, and lines on what is left out.

    First that which is rounded off at rest, then that which sticks.

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
    found: dict[str, JointFriction] = {}
    sticking: dict[str, StickingFriction] = {}
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
        if name in scenario.mechanism.joints and scenario.mechanism.joints[name].sticks:
            dry, wet = given.get("friction", 0.0), given.get("damping", 0.0)
            sticking[own] = StickingFriction(joint=name, coulomb=dry, viscous=wet)
        else:
            found[own] = JointFriction(joint=name, **given)  # type: ignore[arg-type]  # of numbers only
    return found, sticking, tuple(left_out)
