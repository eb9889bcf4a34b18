"""Single numbers of a scenario by key: value, unit, replacement."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, NamedTuple, get_args

from antenna_pin.base.arguments import takes
from antenna_pin.base.units import any_quantity, shown
from antenna_pin.errors import ScenarioError, UnknownNameError
from antenna_pin.scenario._clearance import law_tables
from antenna_pin.scenario.merge import key_of, key_parts
from antenna_pin.scenario.scenario import Scenario
from antenna_pin.scenario.spec import QuantityRule, Vector

_INDEXED = re.compile(r"(.*)\[([0-9]{1,9})\]")


class Number(NamedTuple):
    """A number of a scenario.

    Attributes:
        key: Where it stands, with dots, as in ``--set``; ``mechanism.gravity[2]`` for one of an array.
        value: In SI units.
        unit: Its SI unit, "1" if it has none; "" where that depends on what else stands there.
    """

    key: str
    value: float
    unit: str


@takes()
def number_of(scenario: Scenario, key: str, place: str) -> Number:
    """Return the number that stands at a key.

    Args:
        scenario: The scenario.
        key: With dots, as in ``--set``; ``mechanism.gravity[2]`` for one number of an array.
        place: Name of the caller, for messages.

    Raises:
        UnknownNameError: There is no such key, or the scenario leaves it out.
        ScenarioError: What stands there is no number.
    """
    name, index = _parted(key)
    unit = ""
    below: Any = _tables(scenario)
    spec: Any = scenario
    parts = key_parts(name)
    for level, part in enumerate(parts):
        if not isinstance(below, Mapping) or part not in below:
            others = below if isinstance(below, Mapping) else ()
            known = [key_of([*parts[:level], str(one)]) for one in others]
            raise UnknownNameError(
                place, "number of the scenario (set it first, if it is left out)", key, known
            )
        unit = _unit(spec, part) or unit
        spec = spec.get(part) if isinstance(spec, Mapping) else getattr(spec, part, None)
        below = below[part]
    if index is not None:
        if not isinstance(below, list | tuple) or index >= len(below):
            count = len(below) if isinstance(below, list | tuple) else 0
            raise ScenarioError(f"{place}: {key} must be one of {count} numbers of an array, from [0] on")
        below = below[index]
    read = any_quantity(below)
    if read is None or isinstance(below, int) and not isinstance(below, float) and unit == "":
        raise ScenarioError(f"{place}: {key} must be a number that may differ by little, got {shown(below)}")
    return Number(key, read[0], read[1] or unit)


@takes()
def with_number(scenario: Scenario, key: str, value: float) -> Scenario:
    """Return a scenario with another number at a key, in SI units, as ``with_overrides`` would.

    The other numbers of a law stay the same in SI units, also where an exponent is in these.
    """
    name, index = _parted(key)
    if index is None:
        return scenario.with_overrides({**_other_numbers(scenario, key_parts(key)), key: value})
    below: Any = scenario.model_dump()
    for part in key_parts(name):
        below = below[part]
    return scenario.with_overrides({name: [value if i == index else old for i, old in enumerate(below)]})


def _other_numbers(scenario: Scenario, parts: list[str]) -> dict[str, float]:
    """Return the other numbers of a law's table by key; none for other keys."""
    if len(parts) != 4 or parts[0] != "clearance" or parts[1] not in scenario.clearance:
        return {}
    *table, own = parts
    numbers = law_tables(scenario.clearance[parts[1]]).get(parts[2], {})
    read = {name: any_quantity(one) for name, one in numbers.items() if name != own}
    return {key_of([*table, name]): one[0] for name, one in read.items() if one is not None}


def _parted(key: str) -> tuple[str, int | None]:
    """Return a key without its index, and this."""
    indexed = _INDEXED.fullmatch(key)
    return (key, None) if indexed is None else (indexed[1], int(indexed[2]))


def _tables(scenario: Scenario) -> dict[str, Any]:
    """Return a scenario's tables in the form of a file, with units of laws."""
    data = scenario.model_dump(exclude_none=True)
    for joint, clearance in scenario.clearance.items():
        data["clearance"][joint].update(law_tables(clearance))
    return data


def _unit(spec: Any, part: str) -> str:
    """Return the unit of a table's field; "" without one, or with several."""
    field = getattr(type(spec), "model_fields", {}).get(part)
    for item in () if field is None else (*field.metadata, *_annotations(field.annotation)):
        if isinstance(item, QuantityRule | Vector):
            return item.unit if isinstance(item.unit, str) else ""
    return ""


def _annotations(item: Any) -> list[Any]:
    return [item, *(one for part in get_args(item) for one in _annotations(part))]
