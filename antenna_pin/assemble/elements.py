"""The force elements of a scenario."""

from __future__ import annotations

from typing import Any

from antenna_pin.assemble.closures import link_of
from antenna_pin.assemble.places import check_known, check_motion
from antenna_pin.assemble.references import reference_for
from antenna_pin.mechanism import JointSlot, Mechanism
from antenna_pin.scenario import AllLinksSpec, AtPointSpec, JointsSpec, PointsSpec, Scenario

__all__ = ["elements_of"]


def elements_of(scenario: Scenario, mechanism: Mechanism, family: str) -> dict[str, Any]:
    """Return the elements of one family of a scenario by name.

    Raises:
        AntennaPinError: A joint, link or frame that there is not, or units of another motion.
    """
    found: dict[str, Any] = {}
    for name, spec in scenario.families.get(family, {}).items():
        if isinstance(spec, PointsSpec):
            ends = {}
            for side in ("first", "second"):
                end = getattr(spec, side)
                link, _ = link_of(scenario, mechanism, end, family, name, side)
                ends[side] = link, end.point or (0.0, 0.0, 0.0)
            found[name] = spec.build(**ends)
        elif isinstance(spec, AtPointSpec):
            link, _ = link_of(scenario, mechanism, spec.at, family, name, "at")
            found[name] = spec.build(
                at=(link, spec.at.point or (0.0, 0.0, 0.0)), **_followed(scenario, spec, None)
            )
        elif isinstance(spec, AllLinksSpec):
            found[name] = spec.build()
        elif isinstance(spec, JointsSpec):
            for side in ("input", "output"):
                joint = getattr(spec, side)
                check_known(scenario, [joint], "moving joint", mechanism.joints, family, name, side)
            found[name] = spec.build()
        else:
            place = (family, name)
            check_known(scenario, [spec.joint], "moving joint", mechanism.joints, *place, "joint")
            slot = mechanism.joint(spec.joint)
            check_motion(scenario, slot, spec.motion, *place)
            if (other := getattr(spec, "measures", None)) is not None:
                check_known(scenario, [other], "moving joint", mechanism.joints, *place, "measures")
            found[name] = spec.build(**_followed(scenario, spec, slot))
    return found


def _followed(scenario: Scenario, spec: Any, slot: JointSlot | None) -> dict[str, Any]:
    """Return the reference that a table follows, at a joint or elsewhere, if it names one."""
    follows = getattr(spec, "follows", None)
    return {} if follows is None else {"follows": reference_for(scenario, follows, slot, slot is None)}
