"""The rotors of a scenario: bodies in the URDF, geared to their joints."""

from __future__ import annotations

from antenna_pin.assemble.places import check_known, where
from antenna_pin.errors import MechanismError
from antenna_pin.mechanism import Urdf, with_rotor
from antenna_pin.scenario import Scenario

__all__ = ["with_rotors"]


def with_rotors(scenario: Scenario, urdf: Urdf) -> Urdf:
    """Return a URDF with the rotors of a scenario.

    Raises:
        AntennaPinError: A joint that there is not, or that does not turn about an axis of its own.
    """
    for name, spec in scenario.rotors.items():
        joints = [joint.name for joint in urdf.robot.joints]
        check_known(scenario, [spec.joint], "joint", joints, "rotors", name, "joint")
        try:
            urdf = with_rotor(urdf, name, spec.build())
        except MechanismError as error:
            raise MechanismError(f"{where(scenario, 'rotors', name)}: {error}") from None
    return urdf
