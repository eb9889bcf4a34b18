"""A scenario as the text of a file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from antenna_pin.base.arguments import takes
from antenna_pin.scenario._explained import dotted
from antenna_pin.scenario.drives import WITH_FILES
from antenna_pin.scenario.merge import toml_value
from antenna_pin.scenario.scenario import Scenario

__all__ = ["found_from", "scenario_toml"]


@takes()
def scenario_toml(scenario: Scenario) -> str:
    """Return a scenario as the text of a scenario file: its case and overrides laid in, numbers in SI units.

    Everything that counts is written, defaults too; tables and an appendage's modes with their numbers
    instead of their file. Put beside the URDF that it names, it loads as the same scenario, without
    cases.
    """
    data = scenario.model_dump(mode="json", exclude_none=True, exclude=set(Scenario.carried))
    for one in (one for family in (*WITH_FILES, "flexible") for one in data.get(family, {}).values()):
        for key in ("file", "places", "reading"):
            one.pop(key, None)
    return "\n".join(_lines(data, ())).strip() + "\n"


def _lines(table: Mapping[str, Any], path: tuple[str, ...]) -> Iterator[str]:
    plain = {key: value for key, value in table.items() if not isinstance(value, Mapping)}
    if path and plain:
        yield f"\n[{dotted(path)}]"
    for key, value in plain.items():
        yield f"{dotted((key,))} = {toml_value(value)}"
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from _lines(value, (*path, key))


@takes()
def found_from(scenario: Scenario, folder: Path) -> Scenario:
    """Return a scenario whose URDF and packages are found from another folder than its own.

    Args:
        scenario: The scenario.
        folder: In which its file is to stand, without links.
    """

    def there(name: str) -> str:
        path = (scenario.folder / name).resolve()
        return str(path.relative_to(folder)) if path.is_relative_to(folder) else str(path)

    mechanism = scenario.mechanism.model_copy(
        update={
            "urdf": there(scenario.mechanism.urdf),
            "package_path": tuple(there(name) for name in scenario.mechanism.package_path),
        }
    )
    return scenario.model_copy(update={"mechanism": mechanism, "folder": folder})
