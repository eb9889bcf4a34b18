"""Figures of a paper, of runs and of settled motions, and their equivalents."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from antenna_pin.analysis import RecurrenceKind, Verdict, diagram_verdicts, said_of_verdicts
from antenna_pin.errors import InvalidParameterError
from antenna_pin.show.plot._runs import Run, samples_of
from antenna_pin.show.plot._style import Width, prefixed, three_digits
from antenna_pin.show.plot.catalogue import run_figure
from antenna_pin.show.plot.periodic import figure_bifurcation
from antenna_pin.show.plot.phase import SAME, SEEN, Attractor, figure_attractors

T = TypeVar("T")
#: The runs of a figure by case, in its order.
Cases = dict[str, xr.Dataset]


def with_unit(value: float, unit: str) -> str:
    """Return a value with three digits and its unit."""
    factor, printed = prefixed(unit, abs(value))
    return f"{three_digits(factor * value)} {printed}"


def _chosen(figure: str, what: str, names: Iterable[str], known: Mapping[str, T]) -> dict[str, T]:
    """Return the known things of some names, or raise InvalidParameterError."""
    missing = [name for name in names if name not in known]
    if missing:
        rule = f"with {' and '.join(missing)} among them"
        raise InvalidParameterError(figure, what, rule, ", ".join(known) or "none")
    return {name: known[name] for name in names}


@dataclass(frozen=True, slots=True, kw_only=True)
class _Figure:
    """Name, number and content of a paper's figure.

    Attributes:
        name: File name without a format; it starts with the number in the paper.
        shows: Content of the paper's figure.
    """

    name: str
    shows: str

    @property
    def number(self) -> int:
        """Number in the paper."""
        return int(self.name.removeprefix("figure").split("-")[0])


@dataclass(frozen=True, slots=True, kw_only=True)
class PaperFigure(_Figure):
    """Figure of a paper.

    Attributes:
        cases: Cases of the model that it draws.
        figure: Name of the equivalent in the catalogue.
        finding: Returns the runs' result in numbers.
        joint: Joint of the figure; None for one of whole runs.
        close_view: Start and end of its close view, as shares of the last case's time; the figure's own
            choice if left out.
        options: Further arguments of the figure.
        agrees: Returns whether the runs show the paper's result; None where that is not judged.
    """

    cases: tuple[str, ...]
    figure: str
    finding: Callable[[Cases], str]
    joint: str | None = None
    close_view: tuple[float, float] | None = None
    options: Mapping[str, Any] = field(default_factory=dict)
    agrees: Callable[[Cases], bool] | None = None

    def draw(self, runs: Iterable[Run], *, width: Width = "page") -> Figure:
        """Return the figure.

        Args:
            runs: Trajectories, or pairs of a label and a dataset; other cases are ignored.
            width: "column" (88 mm) or "page" (180 mm).

        Raises:
            InvalidParameterError: A case is missing.
        """
        cases = self.picked(runs)
        options = dict(self.options)
        if self.close_view is not None:
            time = cases[self.cases[-1]]["time"].values
            options["zoom"] = tuple(
                float(time[0] + share * (time[-1] - time[0])) for share in self.close_view
            )
        figure = run_figure(self.figure)
        return figure.draw(list(cases.items()), joint=self.joint, width=width, **options)

    def describe(self, runs: Iterable[Run]) -> str:
        """Return the runs' result in one line of numbers."""
        return self.finding(self.picked(runs))

    def judge(self, runs: Iterable[Run]) -> bool | None:
        """Return whether runs show the paper's result; None if not judged."""
        return None if self.agrees is None else self.agrees(self.picked(runs))

    def picked(self, runs: Iterable[Run]) -> Cases:
        """Return the data of the figure's runs by case."""
        known: Cases = {}
        for run in runs:
            label, data = run[0] if isinstance(run, tuple) else "", samples_of(run)
            known.setdefault(str(data.attrs.get("case") or label), data)
        return _chosen(f"figure {self.number}", "runs", self.cases, known)


# --- of settled motions: attractors of some cases, and diagrams over a parameter ---


@dataclass(frozen=True, slots=True, kw_only=True)
class Diagram:
    """Shipped diagram of a model, and the paper's parameter.

    Attributes:
        name: Name of the shipped diagram, as ``chen2021/friction``.
        label: Name of the parameter in figures.
        zero: Value at zero there, in SI units.
    """

    name: str
    label: str
    zero: float = 0.0

    def relabelled(self, diagram: xr.Dataset) -> xr.Dataset:
        """Return a diagram over the figures' parameter, in a readable unit."""
        values = np.asarray(diagram["value"].values, dtype=float) - self.zero
        factor, unit = prefixed(str(diagram["value"].attrs.get("units", "")), float(np.abs(values).max()))
        return diagram.assign_coords(value=("value", factor * values, {"units": unit})).assign_attrs(
            parameter=self.label
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class AttractorFigure(_Figure):
    """Phase trajectories and Poincare maps at some values of a parameter.

    Attributes:
        over: Parameter.
        values: Values of the parameter, as text with a unit, each with its label.
        x: Name of the quantity across.
        y: Name of the quantity upward.
        there: The paper's verdict on the motion at each value.
    """

    over: Diagram
    values: Mapping[str, str]
    x: str
    y: str
    there: Mapping[str, Verdict]

    def draw(self, attractors: Mapping[str, Attractor], *, width: Width = "page") -> Figure:
        """Return the figure.

        Args:
            attractors: Motions by value; others are ignored.
            width: "column" (88 mm) or "page" (180 mm).

        Raises:
            InvalidParameterError: One is missing.
        """
        return figure_attractors(self._picked(attractors), self.x, self.y, width=width)

    def describe(self, attractors: Mapping[str, Attractor]) -> str:
        """Return the kinds of the motions in one line."""
        picked = self._picked(attractors)
        said = []
        for one in picked:
            small = one.settled and not one.words(self.x, self.y).startswith("period")
            small = small and one.spread(self.x, self.y) < SEEN
            words = " of the portrait: one dot" if small else ""
            said.append(f"{one.label}: {one.words(self.x, self.y)}{words}")
        return "; ".join(said)

    def judge(self, attractors: Mapping[str, Attractor]) -> bool:
        """Return whether each verdict agrees with the paper, by eye."""
        picked = self._picked(attractors)
        return all(
            one.settled and _verdict(one, self.x, self.y) == said
            for one, said in zip(picked, (self.there[value] for value in self.values), strict=True)
        )

    def _picked(self, attractors: Mapping[str, Attractor]) -> list[Attractor]:
        return [*_chosen(f"figure {self.number}", "attractors", self.values, attractors).values()]


def _verdict(one: Attractor, *names: str) -> Verdict:
    """Return the verdict by eye, or on a closer look without a period."""
    for tolerance in (SEEN, SAME):
        found = one.recurs(*names, tolerance=tolerance)
        if found.kind is RecurrenceKind.PERIODIC:
            return f"period {found.period}"
    return found.kind.value


@dataclass(frozen=True, slots=True, kw_only=True)
class DiagramFigure(_Figure):
    """Settled points of a motion over a parameter.

    Attributes:
        diagram: Diagram over the parameter.
        quantities: Its drawn quantities.
        agrees: Returns whether verdicts over the settled values are the paper's.
    """

    diagram: Diagram
    quantities: tuple[str, ...]
    agrees: Callable[[Sequence[float], Sequence[Verdict]], bool]

    def draw(self, diagram: xr.Dataset, *, width: Width = "page") -> Figure:
        """Return the figure of fresh starts (:func:`antenna_pin.studies.nonlinear.bifurcation`)."""
        return figure_bifurcation(self.diagram.relabelled(diagram), quantities=self.quantities, width=width)

    def describe(self, diagram: xr.Dataset) -> str:
        """Return the motions over the values, and the largest extents."""
        shown = self.diagram.relabelled(diagram)
        unit = str(shown["value"].attrs["units"])
        verdicts = diagram_verdicts(diagram, self.quantities, vector=True)
        said = said_of_verdicts(shown["value"].values.tolist(), verdicts, unit)
        widest = []
        for name in self.quantities:
            extent = np.nanmax(diagram[name].values, axis=-1) - np.nanmin(diagram[name].values, axis=-1)
            k = int(np.nanargmax(extent[0]))
            value = float(shown["value"].values[k])
            widest.append(
                f"{name} {with_unit(float(extent[0, k]), str(diagram[name].attrs['units']))}"
                f" at {f'{value:.3g} {unit}'.strip()}"
            )
        return "; ".join(said) + f". Points farthest apart: {', '.join(widest)}"

    def judge(self, diagram: xr.Dataset) -> bool | None:
        """Return whether motions agree; None if less than half has settled."""
        values, verdicts = self.verdicts(diagram)
        return self.agrees(values, verdicts) if 2 * len(values) >= diagram.sizes["value"] else None

    def verdicts(self, diagram: xr.Dataset) -> tuple[list[float], list[Verdict]]:
        """Return the settled values, as in figures, and their verdicts."""
        every = zip(
            self.diagram.relabelled(diagram)["value"].values.tolist(),
            diagram_verdicts(diagram, self.quantities, vector=True),
            strict=True,
        )
        known = [(float(value), verdict) for value, verdict in every if verdict is not None]
        return [value for value, _ in known], [verdict for _, verdict in known]
