"""From a scenario to a system: URDF variant, Pinocchio model, force elements, initial state."""

from typing import TYPE_CHECKING

from antenna_pin._lazy import loaded_when_used

if TYPE_CHECKING:
    from antenna_pin.assemble.build import build_system
    from antenna_pin.assemble.facts import scenario_facts
    from antenna_pin.assemble.initial import initial_angles, initial_state
    from antenna_pin.assemble.references import reference_for
    from antenna_pin.assemble.variant import as_written, urdf_variant

__all__ = [
    "as_written",
    "build_system",
    "initial_angles",
    "initial_state",
    "reference_for",
    "scenario_facts",
    "urdf_variant",
]

loaded_when_used(
    __name__,
    {
        "build": "build_system",
        "facts": "scenario_facts",
        "initial": "initial_angles initial_state",
        "references": "reference_for",
        "variant": "as_written urdf_variant",
    },
)
