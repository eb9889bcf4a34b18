"""Quantity of a requirement: number of a run or of a scenario."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

from antenna_pin.errors import ScenarioError, UnknownNameError
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.requirements import OPTIONS, RequirementSpec
from antenna_pin.trajectory import Trajectory

Analysis = Literal[
    "functional",
    "motorization",
    "loads",
    "shocks",
    "disturbance",
    "preload",
    "stress",
    "control",
    "integrity",
]

#: Analyses of a report, and their titles.
ANALYSES: dict[str, str] = {
    "functional": "Functional performance",
    "motorization": "Motorization and statics",
    "loads": "Loads",
    "shocks": "Shocks",
    "disturbance": "Disturbance and vibration",
    "preload": "Preload and tolerances",
    "stress": "Contact stress",
    "control": "Control",
    "integrity": "Integrity of the runs",
}


@dataclass
class Case:
    """Scenario at one point of its uncertain numbers, with what has been computed of it.

    Attributes:
        scenario: The scenario.
        make: Returns its run, once.
        reference: Returns the run of the reference, once.
        sources: Texts of the files of functions, by name.
        memo: Results of analyses that several quantities share.
    """

    scenario: Scenario
    make: Callable[[], Trajectory]
    reference: Callable[[], Trajectory | None] = lambda: None
    sources: Mapping[str, str] = field(default_factory=dict)
    memo: dict[str, Any] = field(default_factory=dict)

    @cached_property
    def run(self) -> Trajectory:
        """The run."""
        return self.make()

    @property
    def has_run(self) -> bool:
        """True once the run has been made."""
        return "run" in self.__dict__


#: Value of a quantity in SI units, with its unit where its object decides that.
Value = float | tuple[float, str]
Find = Callable[[Case, RequirementSpec], Value]


@dataclass(frozen=True, slots=True)
class VerifiedQuantity:
    """Quantity that a requirement may bound.

    Attributes:
        name: Name in files.
        units: Unit, behind a bar that of what slides; "" where it depends on the object.
        meaning: Description.
        analysis: Analysis of the report that it belongs to.
        of: Kind of its objects; "" for the whole.
        find: Returns its value in SI units.
        options: Keys of a requirement that it takes.
        needs_run: True for a number of a run, False for one of the scenario alone.
        needs_series: True if a lean result does not have it.
        compares: True if it needs the reference.
    """

    name: str
    units: str
    meaning: str
    analysis: Analysis
    of: str
    find: Find
    options: tuple[str, ...] = ()
    needs_run: bool = True
    needs_series: bool = False
    compares: bool = False

    def refuse_options(self, place: str, spec: RequirementSpec) -> None:
        """Refuse keys that the quantity does not take.

        Raises:
            ScenarioError: A key is given in vain.
        """
        taken = {*self.options} | ({"of"} if self.of else set())
        for key in (*OPTIONS, "of"):
            if key in spec.options and key not in taken:
                known = f"; it takes {', '.join(sorted(taken))}" if taken else ""
                raise ScenarioError(f"{place}.{key} must be left out: {self.name} has none{known}")


def chosen(name: str, what: str, of: str | None, values_by_name: Mapping[str, float]) -> float:
    """Return the number of one object, or the worst of all."""
    if of is None and values_by_name:
        values = list(values_by_name.values())
        if any(math.isnan(one) for one in values):
            return math.nan
        return min(values) if name == "held_at_end" else max(values)
    exact = [key for key in values_by_name if of in (key, key.partition(".")[2])]
    if len(exact) != 1:
        raise UnknownNameError(name, what, of or "any", values_by_name)
    return values_by_name[exact[0]]
