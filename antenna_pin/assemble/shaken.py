"""The shaken base of a scenario: joints between the world and the root of its URDF."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from antenna_pin.assemble.places import where
from antenna_pin.elements import FAMILIES
from antenna_pin.errors import MechanismError, ScenarioError
from antenna_pin.mechanism import Urdf, with_shaken_base
from antenna_pin.scenario import Scenario

__all__ = ["among_others", "with_shaken"]


def with_shaken(scenario: Scenario, urdf: Urdf) -> Urdf:
    """Return a URDF whose base is carried by the joints of a scenario's motions of it.

    Raises:
        AntennaPinError: The base floats, or cannot be shaken so.
    """
    shakes = scenario.families.get("shake", {})
    for name, spec in shakes.items():
        place = where(scenario, "shake", name)
        if scenario.mechanism.base != "fixed":
            raise ScenarioError(
                f'{place}: mechanism.base must be "fixed" for a base that is shaken, got '
                f"{scenario.mechanism.base!r}; a free base is moved by forces"
            )
        actual = "translation" if spec.build().slides else "rotation"
        if spec.motion not in (None, actual):
            raise ScenarioError(
                f"{place}: units must be those of a {actual}, for the base is shaken "
                f"{'along a direction' if actual == 'translation' else 'about an axis'}, got units of a "
                f"{spec.motion}"
            )
    try:
        return with_shaken_base(urdf, {name: spec.build() for name, spec in shakes.items()})
    except MechanismError as error:
        raise MechanismError(f"{where(scenario, 'shake')}: {error}") from None


def among_others(scenario: Scenario, found: dict[str, dict[str, Any]]) -> Mapping[str, dict[str, Any]]:
    """Return elements by the families that a system has them in, whatever table they stand in.

    Raises:
        ScenarioError: Two of one family have one name.
    """
    kept: dict[str, dict[str, Any]] = {}
    for table, elements in found.items():
        own = FAMILIES[table].among or table
        for name in elements.keys() & kept.get(own, {}).keys():
            raise ScenarioError(
                f"{where(scenario, table, name)}: must have another name than {own}.{name}, as both are "
                f"{own} of a system; rename one"
            )
        kept[own] = {**kept.get(own, {}), **elements}
    return kept
