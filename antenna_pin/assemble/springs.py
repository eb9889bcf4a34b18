"""The springs of a scenario."""

from __future__ import annotations

from antenna_pin.assemble.closures import link_of
from antenna_pin.assemble.places import check_known, check_motion
from antenna_pin.elements import ForceElement
from antenna_pin.mechanism import Mechanism
from antenna_pin.scenario import PointsSpec, Scenario

__all__ = ["springs_of"]


def springs_of(scenario: Scenario, mechanism: Mechanism) -> dict[str, ForceElement]:
    """Return the springs of a scenario by name.

    Raises:
        AntennaPinError: A joint, link or frame that there is not, or units of another motion.
    """
    found: dict[str, ForceElement] = {}
    for name, spec in scenario.springs.items():
        if isinstance(spec, PointsSpec):
            ends = {}
            for side in ("first", "second"):
                end = getattr(spec, side)
                link, _ = link_of(scenario, mechanism, end, "springs", name, side)
                ends[side] = link, end.point or (0.0, 0.0, 0.0)
            found[name] = spec.build(**ends)
        else:
            place = ("springs", name)
            check_known(scenario, [spec.joint], "moving joint", mechanism.joints, *place, "joint")
            check_motion(scenario, mechanism.joint(spec.joint), spec.motion, *place)
            found[name] = spec.build()
    return found
