"""Runs of a figure, their curves over time, and panels that compare them."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from antenna_pin.analysis import is_round_off, round_off_scales
from antenna_pin.show.plot._kinds import TOUCHING, JointKind, RunKind, choose_joint, none_with
from antenna_pin.show.plot._runs import (
    LabelledRun,
    Run,
    Runs,
    labelled,
    left_out,
    long_enough,
    styles,
    too_short,
    with_reference,
)
from antenna_pin.show.plot._style import Array, Width
from antenna_pin.show.plot._thinned import Columns, closer, thinned
from antenna_pin.show.plot.grammar import Axis, Panel, PlotCurve, Sheet, in_rows, size_of
from antenna_pin.trajectory import names_along

#: Share of a panel's height within which lines are indistinguishable [-].
COINCIDE = 0.01
# More rows than these are folded into half as many: panels that are lower, and twice as many in a row.
_TALL = 4


@dataclass(frozen=True, slots=True, eq=False)
class Picked:
    """Runs of a figure."""

    every: list[LabelledRun]  # all given runs
    drawn: list[LabelledRun]  # runs in the figure, the reference last, so that it lies on top
    reference: LabelledRun | None = None  # run to compare with, if there is one
    why: str = ""  # reason given for runs that are not drawn
    joint: str = ""  # joint of the figure

    @property
    def styled(self) -> list[tuple[LabelledRun, dict[str, Any]]]:
        """The runs with the looks of their lines."""
        return list(zip(self.drawn, styles(self.drawn, self.reference), strict=True))

    @property
    def notes(self) -> tuple[str, str]:
        """Notes on the runs that are not drawn."""
        return too_short(self.every), left_out(self.every, self.drawn, self.why) if self.why else ""

    def names(self, dimension: str) -> list[str]:
        """Return the names along a dimension in the runs."""
        return list(dict.fromkeys(name for run in self.drawn for name in names_along(run.data, dimension)))

    def thinned(self, columns: Columns) -> Picked:
        """Return the runs with as few samples as show what is drawn of them."""
        return self._changed([thinned(run, columns) for run in self.drawn])

    def closer(self, window: tuple[float, float] | None, columns: Columns) -> Picked:
        """Return the runs with all samples of a close view."""
        return self._changed([closer(run, window, columns) for run in self.drawn])

    def _changed(self, drawn: list[LabelledRun]) -> Picked:
        """Return the runs with other samples, the reference among them."""
        same = [new for new, old in zip(drawn, self.drawn, strict=True) if old is self.reference]
        return replace(self, drawn=drawn, reference=same[0] if same else self.reference)

    def curves(self, values: Callable[[LabelledRun], Array | None]) -> list[PlotCurve]:
        """Return a quantity of the runs that have it over time."""
        found = ((run, look, values(run)) for run, look in self.styled)
        return [
            PlotCurve(run.legend, run.time, one, look, run is self.reference, run.many)
            for run, look, one in found
            if one is not None
        ]

    def deviations(self, of: Callable[[LabelledRun], tuple[Array, Array] | None]) -> list[PlotCurve]:
        """Return the deviations of comparable runs from the ideal run over time."""
        looks = {run.label: (run, look) for run, look in self.styled}
        found = [(run, look, of(run)) for run, look in looks.values() if run is not self.reference]
        return [
            PlotCurve(run.label, *one, look, many=run.many) for run, look, one in found if one is not None
        ]


def pick(
    runs: Runs,
    kind: RunKind | Callable[[LabelledRun], bool] | None = None,
    ideal: Run | None = None,
    *,
    compared: bool = True,
    joint: tuple[JointKind, str | None] | None = None,
    why: str = "",
) -> Picked:
    """Return the runs to draw.

    Args:
        runs: Runs as given to the figure.
        kind: Kind of the drawn runs; all if left out.
        ideal: Reference as given to the figure.
        compared: Whether one run is the reference.
        joint: Kind and name of the figure's joint.
        why: Reason given for runs that are not drawn; the kind's own if left out.

    Raises:
        InvalidParameterError: No run is of the kind.
    """
    every, reference = with_reference(runs, ideal) if compared else (labelled(runs), None)
    name = choose_joint(joint[0], every, joint[1]) if joint is not None else ""
    holds = kind.holds if isinstance(kind, RunKind) else kind
    drawn = [run for run in long_enough(every) if holds is None or holds(run)]
    if isinstance(kind, RunKind):
        why = why or f"without {kind.words}"
        if not drawn:
            raise none_with(kind, every)
    return Picked(every, sorted(drawn, key=lambda run: run is reference), reference, why, name)


def pick_touching(runs: Runs, joint: str | None) -> Picked:
    """Return the runs that have play in a joint, and that joint."""
    every = labelled(runs)
    name = choose_joint(TOUCHING, every, joint)
    drawn = [run for run in long_enough(every) if name in run.clearance_joints]
    return Picked(every, drawn, None, "no clearance in this joint", name)


# --- panels ---


def above_round_off(panels: Sequence[Panel], runs: Iterable[LabelledRun]) -> tuple[list[Panel], str]:
    """Return panels above round-off, and a note on the others.

    All panels are returned where none is above round-off by the runs' own scales.
    """
    scales = round_off_scales(*(run.whole.data for run in runs))
    sizes = ((panel, panel.largest, panel.y.unit or "") for panel in panels)
    shown = [panel for panel, size, unit in sizes if size != 0.0 and not is_round_off(size, unit, scales)]
    if not shown:
        return list(panels), "zero to round-off"
    left = dict.fromkeys(panel.title for panel in panels if panel not in shown)
    return shown, f"zero to round-off: {', '.join(left)}" if left else ""


def with_differences(panels: Sequence[Panel]) -> list[Panel]:
    """Return panels, each followed by its differences where all its lines coincide.

    Lines coincide within a hundredth of the height. Between its samples the first line is straight, for
    across impacts no curve is better.
    """
    return [one for panel in panels for one in (panel, _less_the_first(panel)) if one is not None]


def _less_the_first(panel: Panel) -> Panel | None:
    """Return the lines of a panel less the first; None where they are distinguishable."""
    if panel.apart or len(panel.curves) < 2:
        return None
    first, *others = panel.curves
    less = [replace(one, y=one.y - straight(one.x, first.x, first.y)) for one in others]
    values = np.concatenate([one.y[np.isfinite(one.y)] for one in panel.curves])
    seen = COINCIDE * float(np.ptp(values)) if values.size else 0.0
    if not 0.0 < max(size_of(one.y) for one in less) < seen:
        return None
    title = f"{panel.title}: less that of {first.label}"
    return Panel(title, less, Axis("difference", panel.y.unit), apart=True)


def straight(places: Array, x: Array, y: Array) -> Array:
    """Return a line through points at other places, NaN beyond its ends."""
    own, index = np.unique(x, return_index=True)
    return np.asarray(np.interp(places, own, y[index], left=np.nan, right=np.nan))


def panels_sheet(
    panels: Sequence[Panel], width: Width, columns: int, notes: Sequence[str] = (), *, spikes: bool = False
) -> Sheet:
    """Return panels over time row by row, with one unit where sizes are comparable.

    A column of print has one panel in a row. More than four rows are folded into half as many. With
    ``spikes`` scales are linear as far as smooth lines reach, and logarithmic beyond.
    """
    columns = columns if width == "page" else 1
    small = -(-len(panels) // columns) > _TALL
    overall = max((panel.largest for panel in panels if not panel.apart), default=0.0)
    shown = []
    for panel in panels:
        alone = panel.apart or panel.largest < 1e-2 * overall
        # As long as a panel is high; of many small ones the titles say what they show.
        y = replace(panel.y, largest=panel.largest if alone else overall)
        y = replace(y, label="", ticks=4) if small else replace(y, wrap=22)
        title = textwrap.fill(panel.title, 19, initial_indent="(a) ")[4:] if small else panel.title
        shown.append(
            replace(panel, title=title, y=y, x=replace(panel.x, ticks=4 if small else 6), spiky=spikes)
        )
    rows = in_rows(shown, 2 * columns if small else columns)
    return Sheet(rows, width, 12.0 + (34.0 if small else 42.0) * len(rows), notes)
