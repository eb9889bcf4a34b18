"""One figure of a paper: what it shows there, and what shows the same here."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import xarray as xr
from matplotlib.figure import Figure

from antenna_pin.errors import InvalidParameterError
from antenna_pin.plot._runs import Run
from antenna_pin.plot._style import Width

__all__ = ["Cases", "PaperFigure", "Picked"]

#: The runs of a figure by case, in its order.
Cases = dict[str, xr.Dataset]

#: A case and its run.
Picked = tuple[str, xr.Dataset]


@dataclass(frozen=True, slots=True, kw_only=True)
class PaperFigure:
    """One figure of a paper.

    Attributes:
        number: Number in the paper.
        name: File name without a format.
        cases: Cases of the model that it draws.
        shows: What the paper's figure shows.
        drawing: Draws the runs of the cases at a width.
        finding: Says in numbers what the runs show.
    """

    number: int
    name: str
    cases: tuple[str, ...]
    shows: str
    drawing: Callable[[list[Picked], Width], Figure]
    finding: Callable[[Cases], str]

    def draw(self, runs: Iterable[Run], *, width: Width = "page") -> Figure:
        """Return the figure.

        Args:
            runs: Trajectories, or pairs of a label and a dataset; those whose case it does not take are left
                aside.
            width: "column" (88 mm) or "page" (180 mm).

        Raises:
            InvalidParameterError: A case is missing.
        """
        return self.drawing(list(self.picked(runs).items()), width)

    def describe(self, runs: Iterable[Run]) -> str:
        """Return in one line what the runs show, in numbers."""
        return self.finding(self.picked(runs))

    def picked(self, runs: Iterable[Run]) -> Cases:
        """Return the data of the runs it takes, by case."""
        known: Cases = {}
        for run in runs:
            label, data = run if isinstance(run, tuple) else ("", run.data)
            known.setdefault(str(data.attrs.get("case") or label), data)
        missing = [case for case in self.cases if case not in known]
        if missing:
            rule = f"with {' and '.join(missing)} among them"
            raise InvalidParameterError(f"figure {self.number}", "runs", rule, ", ".join(known) or "none")
        return {case: known[case] for case in self.cases}
