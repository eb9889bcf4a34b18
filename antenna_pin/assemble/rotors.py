"""The rotors of a scenario: bodies in the URDF, geared to their joints, or armature at these."""

from __future__ import annotations

from antenna_pin.assemble.places import check_known, where
from antenna_pin.errors import MechanismError
from antenna_pin.mechanism import Urdf, check_turns, with_rotor
from antenna_pin.scenario import Scenario

__all__ = ["armature_of", "with_rotors"]


def with_rotors(scenario: Scenario, urdf: Urdf) -> Urdf:
    """Return a URDF with the rotors of a scenario that are bodies; all are checked.

    Raises:
        AntennaPinError: A joint that there is not, or that does not turn about an axis of its own.
    """
    for name, spec in scenario.rotors.items():
        joints = [joint.name for joint in urdf.robot.joints]
        check_known(scenario, [spec.joint], "joint", joints, "rotors", name, "joint")
        try:
            rotor = spec.build()
            if rotor.kind == "exact":
                urdf = with_rotor(urdf, name, rotor)
            else:
                check_turns(urdf, name, rotor)
        except MechanismError as error:
            raise MechanismError(f"{where(scenario, 'rotors', name)}: {error}") from None
    return urdf


def armature_of(scenario: Scenario) -> dict[str, float]:
    """Return what joints feel of the rotors that are plain armature, by the names of joints [kg m^2]."""
    found: dict[str, float] = {}
    for spec in scenario.rotors.values():
        if spec.kind == "armature":
            found[spec.joint] = found.get(spec.joint, 0.0) + spec.ratio**2 * spec.inertia
    return found
