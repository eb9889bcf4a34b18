"""Places in a scenario for messages, and checks of names."""

from __future__ import annotations

from collections.abc import Collection

from antenna_pin.base.arguments import takes
from antenna_pin.errors import ScenarioError, UnknownNameError
from antenna_pin.mechanism import JointSlot, WrittenUrdf
from antenna_pin.scenario import Scenario


def where(scenario: Scenario, *keys: str) -> str:
    """Return the place of a key of a scenario, for a message."""
    return f"{scenario.name or 'scenario'}: {'.'.join(keys)}"


def check_known(
    scenario: Scenario, names: Collection[str], what: str, known: Collection[str], *place: str
) -> None:
    """Refuse a name that is not among those known."""
    for name in names:
        if name not in known:
            raise UnknownNameError(where(scenario, *place), what, name, known)


def unchanged_joint_types(scenario: Scenario) -> dict[str, str]:
    """Return the joint types of the unchanged URDF, by name."""
    if not any(spec.model == "constraint" for spec in scenario.clearance.values()):
        return {}
    return {name: joint.type for name, joint in as_written(scenario).joints.items()}


@takes()
def as_written(scenario: Scenario) -> WrittenUrdf:
    """Return a scenario's unchanged URDF, its mechanics not yet checked."""
    return WrittenUrdf(
        text=scenario.urdf_text,
        where=str(scenario.urdf_path),
        folder=scenario.urdf_path.parent,
        package_path=tuple(scenario.folder / root for root in scenario.mechanism.package_path),
        allow_impossible_inertia=scenario.mechanism.allow_impossible_inertia,
    )


def slides(scenario: Scenario, slot: JointSlot) -> bool:
    """Return true for a joint that slides along its axis, however it is modelled."""
    play = scenario.clearance.get(slot.name)
    if slot.slides or slot.kind != "floating" or play is None:
        return slot.slides
    return play.slides or (
        play.model == "constraint" and unchanged_joint_types(scenario).get(slot.name) == "prismatic"
    )


def check_motion(scenario: Scenario, slot: JointSlot, motion: str | None, *place: str) -> None:
    """Refuse units of a sliding joint at a turning one, and the other way round."""
    actual = "translation" if slides(scenario, slot) else "rotation"
    if motion not in (None, actual):
        raise ScenarioError(
            f"{where(scenario, *place)}: units must be those of a {actual}, "
            f"for joint {slot.name!r} is {slot.kind}, got units of a {motion}"
        )
