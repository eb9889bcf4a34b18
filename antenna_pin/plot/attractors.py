"""Attractors side by side: the line of a settled motion in two quantities, and its points in a section."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from antenna_pin.analysis import Recurrence, RecurrenceKind, quantity, recurrence
from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError
from antenna_pin.plot._style import (
    Array,
    Width,
    few_ticks,
    footnote,
    letters,
    new_figure,
    panel_title,
    prefixed,
    styled,
)
from antenna_pin.trajectory import Trajectory

__all__ = ["SAME", "SEEN", "Attractor", "figure_attractors"]

#: Share of the range of a motion below which points are the same [-]: far above the noise of runs of an
#: accuracy of 1e-5, which is 3e-8 for the parallel mechanism, and below what anybody would see.
SAME = 1e-6
#: Share of a portrait that one dot in it covers, and the eye takes for one place [-].
SEEN = 5e-3
# Of these the words say more than the kind: the period, and how many bands of chaos there are.
_IN_FULL = (RecurrenceKind.PERIODIC, RecurrenceKind.CHAOTIC)
# Points are not looked at from nearer than this part of the line's range: what is nearer is one point.
_NEAREST = 1e-2


@dataclass(frozen=True, slots=True, eq=False)
class Attractor:
    """A settled motion.

    Attributes:
        label: What it is called.
        section: Its points (:func:`antenna_pin.nonlinear.poincare`).
        run: A stretch of it.
    """

    label: str
    section: xr.Dataset
    run: Trajectory | xr.Dataset

    @property
    def settled(self) -> bool:
        """Whether its points have settled."""
        return bool(self.section["settled"].item())

    def points(self, *names: str) -> Array:
        """Return its points in some quantities, (n, len(names)).

        Raises:
            InvalidParameterError: The section has not all of them.
        """
        missing = [name for name in names if name not in self.section]
        if missing:
            rule = f"one that holds {' and '.join(missing)}"
            raise InvalidParameterError("attractor", "section", rule, ", ".join(map(str, self.section)))
        return np.column_stack([np.asarray(self.section[name].values, dtype=float) for name in names])

    def ranges(self, *names: str) -> Array:
        """Return from end to end how far the motion goes in some quantities, on the section and off it."""
        lines = [quantity(self.run, name).values for name in names]
        ends = zip(lines, self.points(*names).T, strict=True)
        return np.array([np.ptp(np.concatenate([line, column])) for line, column in ends])

    def recurs(self, *names: str, tolerance: float = SAME) -> Recurrence:
        """Return how its points recur, by the range of the motion in each quantity.

        Args:
            names: The quantities.
            tolerance: Share of the range below which points are the same [-]: above the error of the run.
        """
        span = self.ranges(*names)
        points, scale = self.points(*names), np.where(span > 0.0, span, 1.0)
        found = recurrence(points, scale=scale, tolerance=tolerance)
        if found.period in (None, 1):
            return found
        # A period among points that are hardly farther apart than the tolerance is none yet.
        return recurrence(points, scale=scale, tolerance=min(tolerance, 1e-2 * self.spread(*names)))

    def spread(self, *names: str) -> float:
        """Return the largest extent of its points, as a share of that of the motion [-]."""
        span = self.ranges(*names)
        return float((np.ptp(self.points(*names), axis=0) / np.where(span > 0.0, span, 1.0)).max())

    def words(self, *names: str, tolerance: float = SAME) -> str:
        """Say how it recurs; of what is not periodic, over what share of the range its points lie as well."""
        if not self.settled:
            return "not settled"
        found = self.recurs(*names, tolerance=tolerance)
        said = found.words if found.kind in _IN_FULL else found.kind.value
        return said if found.period is not None else f"{said}, over {self.spread(*names):.1g}"


@takes()
@styled
def figure_attractors(
    attractors: Sequence[Attractor],
    x: str,
    y: str,
    *,
    tolerance: float = SAME,
    width: Width = "page",
) -> Figure:
    """Return phase trajectories and Poincare maps of settled motions in two quantities, a row for each.

    A map is drawn as near as its points lie, but no nearer than a hundredth of the trajectory's range.

    Args:
        attractors: One or more.
        x: Name of the quantity across, as :func:`antenna_pin.analysis.quantity` has it.
        y: Of the quantity upward.
        tolerance: Share of the range below which points are the same [-].
        width: "column" (88 mm) or "page" (180 mm).
    """
    if not attractors:
        raise InvalidParameterError("figure", "attractors", "one or more", said="none")
    figure = new_figure(width, 12.0 + (50.0 if width == "page" else 38.0) * len(attractors))
    panels = figure.subplots(len(attractors), 2, squeeze=False)
    letter = letters()
    for row, one in zip(panels, attractors, strict=True):
        lines = [quantity(one.run, name) for name in (x, y)]
        span = one.ranges(x, y)
        scale = [prefixed(line.units, float(np.abs(line.values).max())) for line in lines]
        row[0].plot(*(f * line.values for (f, _), line in zip(scale, lines, strict=True)), linewidth=0.5)
        near = np.maximum(span * _NEAREST, 1.1 * np.ptp(one.points(x, y), axis=0))
        _map(row[1], one, (x, y), scale, near)
        for axes, title in zip(row, (one.label, one.words(x, y, tolerance=tolerance)), strict=True):
            axes.set(xlabel=f"{x} [{scale[0][1]}]", ylabel=f"{y} [{scale[1][1]}]")
            few_ticks(axes)
            panel_title(axes, next(letter), title)
    periods = {float(one.section.attrs["period"]) for one in attractors}
    said = f"{attractors[0].section.attrs['section']}; " if len(periods) == 1 else ""
    footnote(figure, said + f"points within {tolerance:.0e} of the trajectory's range are the same")
    return figure


def _map(
    axes: Axes, one: Attractor, names: tuple[str, str], scale: list[tuple[float, str]], near: Array
) -> None:
    """Draw the points of a section in a window of a size, about their middle."""
    columns = [f * column for (f, _), column in zip(scale, one.points(*names).T, strict=True)]
    axes.plot(*columns, linestyle="none", marker=".", markersize=2.5, markeredgewidth=0.0, color="#D55E00")
    limits = []
    for (f, _), column, size in zip(scale, columns, near, strict=True):
        middle, half = 0.5 * (column.min() + column.max()), 0.5 * f * (size or 1.0)
        limits.append((middle - half, middle + half))
    axes.set(xlim=limits[0], ylim=limits[1])
