"""What tells runs with play apart that nearly coincide: their motion less that of one of them.

As in the Figures 11 and 12 of Bai and Zhao (2020), where only the axial clearance differs.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

from antenna_pin.analysis import beside
from antenna_pin.errors import UnknownNameError
from antenna_pin.plot._compared import Curve, Panel, above_round_off, panels_figure
from antenna_pin.plot._kinds import TURNING, choose_joint
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, long_enough, styles, too_short, with_reference
from antenna_pin.plot._style import Array, Width, footnote, styled
from antenna_pin.plot._thinned import thinned_beside
from antenna_pin.plot.motion import MOTIONS, Quantity

__all__ = ["FIGURES", "figure_between"]


@styled
def figure_between(
    runs: Iterable[Run] | Run,
    quantity: Quantity = "angle",
    *,
    joint: str | None = None,
    ideal: Run | None = None,
    base: str | None = None,
    width: Width = "page",
) -> Figure:
    """Return the motion of one joint in all runs, less that of the ideal run, and less that of another run.

    Args:
        runs: Trajectories, or pairs of a label and a dataset; of any lengths.
        quantity: "angle" or "rate" of a joint that turns.
        joint: Name of the joint; the first one with clearance if left out.
        ideal: The run to compare with; the first run without any contact if left out.
        base: Label of the run that those behind it are compared with; the first but the ideal one if left
            out.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every, reference = with_reference(runs, ideal)
    what = MOTIONS[quantity]
    name = choose_joint(what.of, every, joint)
    drawn = [run for run in long_enough(every) if name in what.of.names(run)]
    plain = next((run for run in drawn if run is not reference and base in (None, run.label)), None)
    bases = [run for run in (reference, plain) if run is not None and run in drawn]

    def less_that_of(run: LabelledRun, other: LabelledRun) -> Array:
        value = run.values(what.variable, joint=name)
        return value - _at(other.whole, what.variable, name, run.time)

    def columns(run: LabelledRun) -> list[Array]:
        compared = [less_that_of(run, one) for one in bases if one.source is not run.source]
        return [run.values(what.variable, joint=name), *compared]

    drawn, reference = thinned_beside(drawn, reference, columns)
    others = [run for run in drawn if run is not reference]
    looks = dict(zip([run.label for run in drawn], styles(drawn, reference), strict=True))
    if base is not None and base not in [run.label for run in others]:
        raise UnknownNameError("figure", "run", base, [run.label for run in others])
    first = next((run for run in others if base in (None, run.label)), None)
    words = f"{name.replace('_', ' ')} {quantity}"
    unit = drawn[0].unit(what.variable, what.unit) if drawn else what.unit

    def curves(shown: list[LabelledRun], less: LabelledRun | None) -> list[Curve]:
        found = []
        for run in shown:
            value = run.values(what.variable, joint=name) if less is None else less_that_of(run, less)
            smooth = run is reference
            found.append(Curve(run.legend, run.time, value, looks[run.label], smooth, run.many))
        return found

    ordered = [*others, *(run for run in drawn if run is reference)]
    panels = [Panel(words, words, unit, curves(ordered, None))]
    if reference is not None and reference in drawn and others:
        panels.append(Panel("less that of the ideal run", "deviation", unit, curves(others, reference), True))
    later = others[others.index(first) + 1 :] if first is not None else []
    if first is not None and later:
        title = f"less that of {first.label}"
        panels.append(Panel(title, "difference", unit, curves(later, first), True))
    panels, zero = above_round_off(panels, drawn)
    figure = panels_figure(panels, width, 2)
    footnote(figure, zero, too_short(every))
    return figure


def _at(run: LabelledRun, variable: str, joint: str, time: Array) -> Array:
    """Return the motion of a run at other times, along straight lines: across impacts no curve is better."""
    found = np.empty(time.size)
    for some, data in beside(run.data, time):
        part = replace(run, data=data)
        own, index = np.unique(part.time, return_index=True)
        values = part.values(variable, joint=joint)[index]
        found[some] = np.interp(time[some], own, values, left=np.nan, right=np.nan)
    return found


FIGURES = tuple(
    RunFigure(
        name=f"{quantity}_between_runs",
        title=f"{quantity.capitalize()} of {{joint}}, runs less one another",
        function=figure_between,
        options={"quantity": quantity},
        of=TURNING,
        standard=False,
        reported=False,
    )
    for quantity in ("angle", "rate")
)
