"""The references of a scenario."""

from __future__ import annotations

from antenna_pin.assemble.places import check_motion, where
from antenna_pin.base.arguments import takes
from antenna_pin.elements import Reference
from antenna_pin.errors import InvalidParameterError, ScenarioError
from antenna_pin.mechanism import JointSlot
from antenna_pin.scenario import Scenario

__all__ = ["reference_for"]


@takes()
def reference_for(scenario: Scenario, name: str, slot: JointSlot | None, pure: bool = False) -> Reference:
    """Return a reference of a scenario by name.

    Args:
        scenario: The scenario.
        name: Of the reference.
        slot: The joint that is to follow it; None if it is no joint that does.
        pure: Whether its values are to be pure numbers, by which something is multiplied.

    Raises:
        ScenarioError: Its units are those of another motion.
    """
    spec = scenario.references[name]
    if slot is not None:
        check_motion(scenario, slot, spec.motion, "references", name)
    if pure and spec.motion is not None:
        raise ScenarioError(
            f"{where(scenario, 'references', name)}: values must be pure numbers, for they multiply a force "
            f"that follows them, got units of a {spec.motion}; write bare numbers"
        )
    parts = getattr(spec, "parts", None)
    more = (
        {} if parts is None else {"parts": tuple(reference_for(scenario, one, slot, pure) for one in parts)}
    )
    try:
        found: Reference = spec.build(**more)
    except InvalidParameterError as error:
        raise ScenarioError(f"references.{name}.{error.parameter} {error.reason}") from None
    return found
