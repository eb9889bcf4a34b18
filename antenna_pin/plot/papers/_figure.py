"""One figure of a paper: what it shows there, and which of the catalogue shows the same here."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from antenna_pin.errors import InvalidParameterError
from antenna_pin.plot._runs import Run, samples_of
from antenna_pin.plot._style import Width
from antenna_pin.plot.catalogue import run_figure

__all__ = ["Cases", "PaperFigure"]

#: The runs of a figure by case, in its order.
Cases = dict[str, xr.Dataset]


@dataclass(frozen=True, slots=True, kw_only=True)
class PaperFigure:
    """One figure of a paper.

    Attributes:
        number: Number in the paper.
        name: File name without a format.
        cases: Cases of the model that it draws.
        shows: What the paper's figure shows.
        figure: What shows the same here: its name in the catalogue.
        finding: Says in numbers what the runs show.
        joint: Joint that it is of; None for one of whole runs.
        close_view: Start and end of its close view, as shares of the last case's time; the figure's own
            choice if left out.
        options: Further arguments of the figure.
        agrees: Whether the runs show what the paper's figure is said to show; None where that is not judged.
    """

    number: int
    name: str
    cases: tuple[str, ...]
    shows: str
    figure: str
    finding: Callable[[Cases], str]
    joint: str | None = None
    close_view: tuple[float, float] | None = None
    options: Mapping[str, Any] = field(default_factory=dict)
    agrees: Callable[[Cases], bool] | None = None

    def draw(self, runs: Iterable[Run], *, width: Width = "page") -> Figure:
        """Return the figure.

        Args:
            runs: Trajectories, or pairs of a label and a dataset; those whose case it does not take are left
                aside.
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
        """Return in one line what the runs show, in numbers."""
        return self.finding(self.picked(runs))

    def judge(self, runs: Iterable[Run]) -> bool | None:
        """Return whether the runs show what the paper's figure shows; None if that is not judged."""
        return None if self.agrees is None else self.agrees(self.picked(runs))

    def picked(self, runs: Iterable[Run]) -> Cases:
        """Return the data of the runs it takes, by case."""
        known: Cases = {}
        for run in runs:
            label, data = run[0] if isinstance(run, tuple) else "", samples_of(run)
            known.setdefault(str(data.attrs.get("case") or label), data)
        missing = [case for case in self.cases if case not in known]
        if missing:
            rule = f"with {' and '.join(missing)} among them"
            raise InvalidParameterError(f"figure {self.number}", "runs", rule, ", ".join(known) or "none")
        return {case: known[case] for case in self.cases}
