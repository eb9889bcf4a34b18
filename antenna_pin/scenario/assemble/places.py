"""Places in a scenario for messages, and checks of names."""

from __future__ import annotations

from collections.abc import Collection

from antenna_pin.errors import ScenarioError, UnknownNameError
from antenna_pin.mechanism import JointSlot
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


def slides(scenario: Scenario, slot: JointSlot) -> bool:
    """Return true for a joint that slides along its axis, with play or without."""
    play = scenario.clearance.get(slot.name)
    return slot.slides or (slot.kind == "floating" and play is not None and play.slides)


def check_motion(scenario: Scenario, slot: JointSlot, motion: str | None, *place: str) -> None:
    """Refuse units of a sliding joint at a turning one, and the other way round."""
    actual = "translation" if slides(scenario, slot) else "rotation"
    if motion not in (None, actual):
        raise ScenarioError(
            f"{where(scenario, *place)}: units must be those of a {actual}, "
            f"for joint {slot.name!r} is {slot.kind}, got units of a {motion}"
        )
