"""Worst case of a margin: corners of given ranges, and a search within them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.readable import number
from antenna_pin.base.units import any_quantity, quantity
from antenna_pin.errors import AntennaPinError, InvalidParameterError, MechanismError
from antenna_pin.scenario import Scenario, number_of, with_number
from antenna_pin.studies.margins.result import MarginCase
from antenna_pin.studies.sweep.box_search import corners_of, worst_case

Array = NDArray[np.float64]

# Most ranges whose corners are all evaluated; evaluations of a search for each.
_MOST, _SEARCH_PER_RANGE = 10, 100


class _Range(NamedTuple):
    """Least and greatest value of a number of a scenario, in SI units."""

    key: str
    low: float
    high: float


class Extremes:
    """Cases and ranges of a scenario.

    Args:
        scenario: The nominal scenario.
        cases: Overrides by name.
        ranges: Least and greatest value by key, numbers in SI units or text with units.
    """

    def __init__(
        self, scenario: Scenario, cases: Mapping[str, Mapping[str, Any]], ranges: Mapping[str, Sequence[Any]]
    ) -> None:
        """Read the ranges."""
        self._scenario = scenario
        self.cases: dict[str, Mapping[str, Any]] = dict(cases) or {"": {}}
        self.ranges = [self._range(key, pair) for key, pair in ranges.items()]
        if len(self.ranges) > _MOST:
            rule = f"at most {_MOST}, as all their corners are evaluated; leave out those that matter least"
            raise InvalidParameterError("margin", "ranges", rule, said=f"{len(self.ranges)}")

    def _range(self, key: str, pair: Sequence[Any]) -> _Range:
        own = number_of(self._scenario, key, "margin: ranges")
        if isinstance(pair, str) or len(pair) != 2:
            raise InvalidParameterError(
                "margin: ranges", key, "two numbers, least and greatest", said=str(pair)
            )
        low, high = (_number(one, own.unit, key) for one in pair)
        if not low < high:
            raise InvalidParameterError("margin: ranges", key, "two numbers that rise", said=str(pair))
        return _Range(key, low, high)

    def at(self, case: str, shares: Sequence[float]) -> dict[str, Any]:
        """Return the overrides of a case at shares of the ranges, from 0 to 1."""
        values = {
            one.key: one.low + share * (one.high - one.low)
            for one, share in zip(self.ranges, shares, strict=True)
        }
        return {**self.cases[case], **values}

    def scenario(self, case: MarginCase) -> Scenario:
        """Return the scenario of a combination of extremes."""
        return self.with_values(case.overrides)

    def with_values(self, overrides: Mapping[str, Any]) -> Scenario:
        """Return the scenario with overrides, numbers of ranges in SI units."""
        keys = {one.key for one in self.ranges}
        others = {key: value for key, value in overrides.items() if key not in keys}
        found = self._scenario.with_overrides(others) if others else self._scenario
        for key in keys & overrides.keys():
            found = with_number(found, key, float(overrides[key]))
        return found


def _number(value: Any, unit: str, key: str) -> float:
    """Return a number in SI units, of text with a unit too."""
    if unit:
        return quantity(value, unit, key)
    read = any_quantity(value)  # whose unit depends on what else stands there
    if read is None:
        raise InvalidParameterError("margin: ranges", key, "numbers", said=str(value))
    return read[0]


def worst_cases(
    extremes: Extremes, margin_of: Callable[[Scenario], tuple[float, float]], *, search: bool
) -> list[MarginCase]:
    """Return the margins of all corners, and of the points of a search.

    The search (:func:`antenna_pin.studies.sweep.box_search.worst_case`) is in the case of the smallest
    margin; a monotone margin keeps its corner.

    Args:
        extremes: Cases and ranges.
        margin_of: Smallest margin of a scenario, and its position.
        search: Whether to search within the ranges.

    Raises:
        MechanismError: A combination has no margin, with the reason.
    """
    found: list[MarginCase] = []

    def evaluate(case: str, shares: Sequence[float], origin: str) -> MarginCase:
        overrides = extremes.at(case, shares)
        words = [case] if case else []
        words += [f"{one.key}={number(overrides[one.key], 6)}" for one in extremes.ranges]
        name = ", ".join(words)
        try:
            margin, position = margin_of(extremes.with_values(overrides))
        except AntennaPinError as error:
            raise MechanismError(f"margin: case {name}: {error}") from None
        found.append(MarginCase(name, overrides, margin, position, origin))
        return found[-1]

    count = len(extremes.ranges)
    ends = corners_of(np.full(count, 2, dtype=int))
    origin = "corner" if count else "case"
    margins = {
        case: np.array([evaluate(case, shares, origin).margin for shares in ends.tolist()])
        for case in extremes.cases
    }
    if search and count:
        case = min(margins, key=lambda name: margins[name].min())
        known = dict(zip(map(tuple, ends.tolist()), -margins[case], strict=True))

        def worse(points: Array) -> Array:
            return np.array(
                [
                    known[tuple(at)] if tuple(at) in known else -evaluate(case, at, "search").margin
                    for at in points.tolist()
                ]
            )

        worst_case(worse, count, runs=_SEARCH_PER_RANGE * count)
    return found
