"""The file of a bifurcation diagram: which scenario, over which parameter, looked at where."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, Field, ValidationError

from antenna_pin.arguments import takes
from antenna_pin.capacity import check_count
from antenna_pin.errors import InvalidParameterError, ScenarioError, UnknownNameError
from antenna_pin.nonlinear.branches import Branch
from antenna_pin.nonlinear.surfaces import Section, section_of
from antenna_pin.numerals import bare, whole_in
from antenna_pin.scenario import Scenario, load_scenario, models_path
from antenna_pin.scenario.merge import merge, read_overrides
from antenna_pin.scenario.shipped import read_toml
from antenna_pin.scenario.spec import Count, Place, Spec, dotted, explained
from antenna_pin.sweep.study import nested
from antenna_pin.units import any_quantity

__all__ = ["DiagramPlan", "is_plan", "list_plans", "load_plan", "values_of"]

#: How the name of such a file ends.
SUFFIX = ".diagram.toml"


@takes()
def values_of(text: str) -> list[float | str]:
    """Return the values of a parameter that a text says: ``FIRST:LAST:COUNT``, or a list with commas.

    Raises:
        InvalidParameterError: It says none.
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


class DiagramPlan(Spec):
    """A bifurcation diagram that can be asked for by a file.

    Attributes:
        format: Version of the format of such files.
        title: In a few words.
        scenario: Name of a shipped scenario, or path of a scenario file, from this file's folder.
        case: Of the scenario; its default one if left out.
        set: What is set over scenario and case: dotted keys, or tables.
        parameter: Key of the scenario, with dots.
        values: Of it, in order: a list, or text as ``FIRST:LAST:COUNT``.
        section: Where the motion is looked at, as ``antenna-pin bifurcation --section`` has it.
        direction: Of passages of a surface.
        phase: Part of the period at which a stroboscope looks [-].
        quantities: What is noted.
        branches: ``fresh``, ``forward``, ``backward``.
        count: Points kept of each value [-].
        transient: Points cut before them; judged if left out [-].
        most: Points after which cutting is given up [-].
        tolerance: A drift below this part of a quantity's largest amount is none [-].
        name: Of the diagram: that of its file.
        folder: Of the file.
    """

    format: Literal[1] = 1
    title: str = ""
    scenario: str
    case: str | None = None
    set: dict[str, Any] = Field(default_factory=dict)
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

    carried: ClassVar[frozenset[str]] = frozenset({"name", "folder"})

    def base(self, settings: Sequence[str] = ()) -> Scenario:
        """Return the scenario that the parameter is laid over, with more settings over it."""
        beside = self.folder / os.path.expanduser(self.scenario)
        shipped = (models_path() / self.scenario).is_dir() or not beside.exists()
        scenario = load_scenario(self.scenario if shipped else beside, self.case, nested(self.set))
        return scenario.with_overrides(settings) if settings else scenario

    def given(self) -> list[float | str]:
        """Return the values, as :func:`antenna_pin.nonlinear.bifurcation` takes them."""
        return values_of(self.values) if isinstance(self.values, str) else list(self.values)

    def where(self) -> Section:
        """Return the section."""
        return section_of(self.section, self.direction, self.phase)


def list_plans() -> list[str]:
    """Return the names of the shipped diagrams, as ``chen2021/friction``."""
    root = models_path()
    return sorted(
        path.relative_to(root).as_posix().removesuffix(SUFFIX) for path in root.glob(f"*/*{SUFFIX}")
    )


@takes()
def load_plan(path: str | os.PathLike[str], settings: Mapping[str, Any] | None = None) -> DiagramPlan:
    """Return a diagram's file, complete and checked; its scenario is not read yet.

    Args:
        path: Of the file, or the name of a shipped one, as ``chen2021/friction``.
        settings: What takes the place of the file's keys.

    Raises:
        ScenarioError: With one line that gives file, place, rule, the value seen and a way out.
        UnknownNameError: There is no such diagram.
    """
    found, label = Path(os.path.expanduser(os.fspath(path))), str(path)
    if not found.is_file():
        shipped = models_path() / f"{label}{SUFFIX}"
        if not shipped.is_file():
            raise UnknownNameError("load_plan", "diagram file or shipped diagram", label, list_plans())
        found = shipped
    data = read_toml(found, label)
    for key in DiagramPlan.carried & data.keys():
        raise ScenarioError(f"{label}: {key} is unknown: a diagram's name and folder are those of its file")
    layer, _ = read_overrides(settings or {})
    name = found.name.removesuffix(SUFFIX).removesuffix(".toml")
    try:
        return DiagramPlan.validated(merge(data, layer) | {"name": name, "folder": found.parent.resolve()})
    except ValidationError as error:
        raise explained(error, lambda location: Place(f"{label}: {dotted(location)}".strip())) from None


def is_plan(name: str) -> bool:
    """Whether a name is that of a diagram's file or of a shipped diagram, not of a scenario."""
    return name.endswith(SUFFIX) or name in list_plans()
