"""The file of a bifurcation diagram: scenario, parameter, section, quantities."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator

from antenna_pin.base.arguments import takes
from antenna_pin.base.capacity import check_count
from antenna_pin.base.readable import bare, whole_in
from antenna_pin.base.units import any_quantity
from antenna_pin.errors import InvalidParameterError
from antenna_pin.scenario.runs_file import RunsFile
from antenna_pin.scenario.spec import Count
from antenna_pin.studies.nonlinear.diagrams import Branch
from antenna_pin.studies.nonlinear.sections import Section, section_of


@takes()
def values_of(text: str) -> list[float | str]:
    """Return the parameter values of a text: ``FIRST:LAST:COUNT``, or a list with commas.

    Raises:
        InvalidParameterError: The text contains none.
    """
    rule = "FIRST:LAST:COUNT as '0 mm:0.9 mm:10', or values with commas between"
    parts = [part.strip() for part in text.split(":")]
    if len(parts) == 1:
        found = [bare(part.strip()) for part in text.split(",") if part.strip()]
        if any(any_quantity(value) is None for value in found):
            raise InvalidParameterError("bifurcation", "values", rule, text)
        return found
    ends = [any_quantity(bare(part)) for part in parts[:2]]
    count = whole_in(parts[2]) if len(parts) == 3 else None
    if count is None or count < 2 or None in ends:
        raise InvalidParameterError("bifurcation", "values", f"{rule}, COUNT 2 or more", text)
    check_count("bifurcation", "COUNT", count, 2)
    (first, one), (last, other) = (end for end in ends if end is not None)
    if one and other and one != other:
        raise InvalidParameterError("bifurcation", "values", "of one unit from first to last", text)
    unit = one or other
    suffix = f" {unit}" if unit not in ("", "1") else ""
    numbers = np.linspace(first, last, count).tolist()
    return [f"{number!r}{suffix}" if suffix else number for number in numbers]


class DiagramPlan(RunsFile):
    """Bifurcation diagram defined by a file.

    Attributes:
        parameter: Key of the scenario, with dots.
        values: Its values, in order: a list, or text as ``FIRST:LAST:COUNT``.
        section: Section of the motion, as in ``antenna-pin bifurcation --section``.
        direction: Direction of crossings of a surface.
        phase: Part of the period at which a stroboscope samples [-].
        quantities: Recorded quantities.
        branches: ``fresh``, ``forward``, ``backward``.
        count: Points kept of each value [-].
        transient: Points cut before them; judged if left out [-].
        most: Points after which cutting stops [-].
        tolerance: A drift below this part of a quantity's largest amount is none [-].
        name: Name of the diagram: that of its file.
        folder: Folder of the file.
    """

    suffix: ClassVar[str] = ".diagram.toml"
    word: ClassVar[str] = "diagram"

    parameter: str
    values: str | list[float | str]
    section: str = "period"
    direction: Literal["rising", "falling", "both"] = "rising"
    phase: float = 0.0
    quantities: list[str]
    branches: tuple[Branch, ...] = ("fresh",)
    count: Annotated[int, BeforeValidator(Count(32, 1_000_000).read)] = 100
    transient: Annotated[int, BeforeValidator(Count(0, 1_000_000).read)] | None = None
    most: Annotated[int, BeforeValidator(Count(32, 10_000_000).read)] | None = None
    tolerance: float = 1e-4
    name: str = "diagram"
    folder: Path = Path()

    def argument_values(self) -> list[float | str]:
        """Return the values, as arguments of :func:`antenna_pin.studies.nonlinear.bifurcation`."""
        return values_of(self.values) if isinstance(self.values, str) else list(self.values)

    def how(self) -> dict[str, Any]:
        """Return the other arguments of :func:`antenna_pin.studies.nonlinear.bifurcation`."""
        names = ("quantities", "branches", "count", "transient", "most", "tolerance")
        return {"parameter": self.parameter, "section": self.where()} | {
            name: getattr(self, name) for name in names
        }

    def where(self) -> Section:
        """Return the section."""
        return section_of(self.section, self.direction, self.phase)


def list_plans() -> list[str]:
    """Return the names of the shipped diagrams, as ``chen2021/friction``."""
    return DiagramPlan.shipped()


@takes()
def load_plan(path: str | os.PathLike[str], settings: Mapping[str, Any] | None = None) -> DiagramPlan:
    """Return a diagram's file, complete and checked; its scenario is not read yet.

    Args:
        path: Path of the file, or the name of a shipped one, as ``chen2021/friction``.
        settings: Settings in place of the file's keys.

    Raises:
        ScenarioError: With one line that gives file, place, rule, the value seen and a way out.
        UnknownNameError: There is no such diagram.
    """
    return DiagramPlan.loaded("load_plan", path, settings or {})


def is_plan(name: str) -> bool:
    """Return whether a name is that of a diagram's file or a shipped diagram."""
    return name.endswith(DiagramPlan.suffix) or name in list_plans()
