"""The flexible links of a scenario: their parts in the URDF."""

from __future__ import annotations

from collections.abc import Iterable

from antenna_pin.assemble.places import check_known, where
from antenna_pin.errors import ScenarioError
from antenna_pin.flexible import ElasticPart, split
from antenna_pin.mechanism import Urdf, check_size
from antenna_pin.scenario import Scenario

__all__ = ["by_name", "with_flexible_links"]


def with_flexible_links(scenario: Scenario, urdf: Urdf) -> tuple[Urdf, tuple[ElasticPart, ...]]:
    """Return a URDF whose flexible links are hubs with elastic parts, and these parts.

    Raises:
        AntennaPinError: A link or shape that there is not, or one that a part asks too much of.
    """
    found: list[ElasticPart] = []
    freedoms = len(urdf.robot.joints)
    for name, spec in scenario.flexible.items():
        links = {link.name for link in urdf.robot.links}
        check_known(scenario, [spec.link], "link", links, "flexible", name, "link")
        kind, place = spec.build(), where(scenario, "flexible", name)
        freedoms += len(kind.frequencies)
        check_size(place, freedoms, "take the modes of lowest frequency, or those of largest effective mass")
        made = split(kind, name, urdf.mass_properties(spec.link), place)
        urdf = urdf.with_parts(spec.link, made)
        found += made.parts
    return urdf, tuple(found)


def by_name(scenario: Scenario, parts: Iterable[ElasticPart]) -> dict[str, ElasticPart]:
    """Return elastic parts by name, which is also that of their joint and their spring.

    Raises:
        ScenarioError: A spring of the scenario has the name of a part.
    """
    found = {part.name: part for part in parts}
    for name in scenario.springs:
        if name in found:
            raise ScenarioError(
                f"{where(scenario, 'springs', name)}: must have another name than an elastic part of a "
                "flexible link, whose own spring bears it"
            )
    return found
