"""Angle, rate and acceleration of a joint against the ideal one.

As in the Figures 7 to 10 of Bai and Zhao (2020): the whole span, and a close view.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Sequence
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from antenna_pin.analysis import is_round_off, round_off_scales
from antenna_pin.arguments import takes
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.plot._compared import between_spikes
from antenna_pin.plot._kinds import SLIDING, TURNING, choose_joint
from antenna_pin.plot._motion_curves import (
    MotionCurve,
    MotionQuantity,
    Span,
    curves_of,
    drawn_columns,
    from_rest,
    zoom_of,
)
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, long_enough, too_short, with_reference
from antenna_pin.plot._style import (
    IDEAL,
    MANY,
    SHADE,
    Array,
    Width,
    few_ticks,
    footnote,
    legend_above,
    letters,
    linear_then_log,
    literal,
    new_figure,
    panel_title,
    prefixed,
    styled,
)
from antenna_pin.plot._thinned import closer, thinned_beside

Quantity = Literal["angle", "rate", "acceleration", "position", "slide rate", "slide acceleration"]

MOTIONS: dict[Quantity, MotionQuantity] = {
    "angle": MotionQuantity("motion_angle", "rad", "motion_rate", TURNING),
    "rate": MotionQuantity("motion_rate", "rad/s", "motion_acceleration", TURNING),
    "acceleration": MotionQuantity("motion_acceleration", "rad/s^2", None, TURNING, 0.01, True),
    "position": MotionQuantity("slide_position", "m", "slide_rate", SLIDING),
    "slide rate": MotionQuantity("slide_rate", "m/s", "slide_acceleration", SLIDING),
    "slide acceleration": MotionQuantity("slide_acceleration", "m/s^2", None, SLIDING, 0.01, True),
}


#: Those of joints that turn.
QUANTITIES: tuple[Quantity, ...] = tuple(name for name, what in MOTIONS.items() if what.of is TURNING)


@takes()
@styled
def figure_motion(
    runs: Iterable[Run],
    quantity: Quantity = "angle",
    *,
    joint: str | None = None,
    ideal: Run | None = None,
    zoom: Span | None = None,
    width: Width = "page",
) -> Figure:
    """Return the motion of one joint in all runs: whole span, close view, deviation from the ideal joint.

    The close view lies around the largest deviation from the ideal run. For the acceleration, whose contact
    spikes dwarf the ideal curve, each run has a strip of its own with a scale that is linear as far as the
    motion between spikes reaches and logarithmic beyond, and the deviation is left out.

    Args:
        runs: Trajectories, or pairs of a label and a dataset; of any lengths.
        quantity: "angle", "rate" or "acceleration" of a joint that turns; "position", "slide rate" or "slide
            acceleration" of one that slides.
        joint: Name of the joint; the first one with clearance if left out.
        ideal: The run to compare with; the first run without any contact if left out.
        zoom: Start and end of the close view [s].
        width: "column" (88 mm) or "page" (180 mm).
    """
    if quantity not in MOTIONS:
        raise UnknownNameError("figure", "quantity", quantity, MOTIONS)
    every, reference = with_reference(runs, ideal)
    what = MOTIONS[quantity]
    name = choose_joint(what.of, every, joint)
    given = None if zoom is None else _check_zoom(zoom)
    columns = drawn_columns(reference, name, what)
    drawn, reference = thinned_beside(long_enough(every), reference, columns)
    curves = curves_of(drawn, reference, name, what)

    def seen(windows: Sequence[Span | None]) -> list[MotionCurve]:
        """Return the curves with all samples in close views."""
        if all(run.kept is None for run in drawn):
            return curves
        near = drawn
        for window in windows:
            near = [closer(run, window, columns) for run in near]
        return curves_of(near, reference, name, what)

    unit = drawn[0].unit(what.variable, what.unit)
    label = f"{literal(name.replace('_', ' '))} {quantity.removeprefix('slide ')}"
    if what.spiky and any(not c.is_ideal for c in curves):
        windows = [given or zoom_of([from_rest(c)], what) for c in curves if not c.is_ideal]
        figure, still = _strips(seen(windows), windows, label, unit, width), ""
    else:
        window = given or zoom_of(curves, what)
        shown, still = _without_round_off(seen([window]), drawn, unit)
        figure = _panels(shown, window, label, unit, width)
    footnote(figure, still, too_short(every))
    return figure


def _without_round_off(
    curves: Sequence[MotionCurve], runs: Sequence[LabelledRun], unit: str
) -> tuple[list[MotionCurve], str]:
    """Return curves without deviations that are zero to round-off in all runs, and that in words."""
    sizes = [float(np.nanmax(np.abs(c.deviation), initial=0.0)) for c in curves if c.deviation is not None]
    scales = round_off_scales(*(run.whole.data for run in runs)) if sizes else {}
    if not sizes or not is_round_off(max(sizes), unit, scales):
        return list(curves), ""
    bare = [dataclasses.replace(curve, deviation=None) for curve in curves]
    return bare, "deviation from the ideal joint: zero to round-off"


def _check_zoom(zoom: Span) -> Span:
    if not zoom[0] < zoom[1]:
        raise InvalidParameterError("figure", "zoom", "a start before its end [s]", zoom)
    return float(zoom[0]), float(zoom[1])


def _draw(
    axes: Axes, curve: MotionCurve, values: Array, span: Span | None = None, thin: bool = False
) -> None:
    """Draw one curve, or the part of it in a span (with one sample more on either side)."""
    time = curve.time
    if span is not None:
        first = max(int(np.searchsorted(time, span[0])) - 1, 0)
        last = int(np.searchsorted(time, span[1], side="right")) + 1
        time, values = time[first:last], values[first:last]
    style = (
        IDEAL if curve.is_ideal else {"color": curve.colour, "linewidth": 0.6 if thin else curve.linewidth}
    )
    many = time.size > MANY or (span is None and curve.many)
    axes.plot(time, values, label=curve.label, rasterized=many, **style)


def _widened(curves: Sequence[MotionCurve]) -> list[MotionCurve]:
    """Return the curves, the ones below wider: of runs that nearly coincide, all are seen."""
    others = sum(not curve.is_ideal for curve in curves)
    return [
        curve if curve.is_ideal else dataclasses.replace(curve, linewidth=0.9 + 0.5 * (others - 1 - k))
        for k, curve in enumerate(curves)
    ]


def _panels(
    curves: Sequence[MotionCurve], window: Span | None, label: str, unit: str, width: Width
) -> Figure:
    """Draw the whole span, the close view and the deviation."""
    count = 1 + (window is not None) + any(curve.deviation is not None for curve in curves)
    if width == "page" and count > 1:
        figure = new_figure(width, 108.0)
        grid = figure.add_gridspec(2, 2)
        whole = figure.add_subplot(grid[0, :])
        rest = (
            [figure.add_subplot(grid[1, i]) for i in range(2)]
            if count == 3
            else [figure.add_subplot(grid[1, :])]
        )
    else:
        figure = new_figure(width, 12.0 + 46.0 * count)
        whole, *rest = figure.subplots(count, 1, squeeze=False)[:, 0]
    largest = max((float(np.nanmax(np.abs(c.value), initial=0.0)) for c in curves), default=0.0)
    factor, printed = prefixed(unit, largest)
    curves = _widened(curves)
    deviating = [curve for curve in curves if curve.deviation is not None]
    for curve in curves:
        _draw(whole, curve, factor * curve.value)
    panel_title(whole, "a" if rest else "", "whole span")
    whole.set_ylabel(f"{label} [{printed}]")
    few_ticks(whole, 10 if width == "page" else 6)
    panels = iter(rest)
    if window is not None:
        near = next(panels)
        for curve in curves:
            _draw(near, curve, factor * curve.value, window)
        near.set_xlim(window)
        _mark(whole, window)
        panel_title(near, "b", "close view of the shaded span")
        near.set_ylabel(f"{label} [{printed}]")
        few_ticks(near, 5)
    if deviating:
        apart = next(panels)
        largest = max(float(np.nanmax(np.abs(c.deviation), initial=0.0)) for c in deviating)  # type: ignore[arg-type]
        factor, printed = prefixed(unit, largest)
        for curve in deviating:
            assert curve.deviation is not None
            _draw(apart, curve, factor * curve.deviation, thin=len(deviating) < 2)
        apart.axhline(0.0, **{**IDEAL, "linewidth": 0.6})
        panel_title(apart, "c" if window is not None else "b", "deviation from the ideal joint")
        apart.set_ylabel(f"deviation [{printed}]")
        few_ticks(apart, 6)
    for axes in (whole, *rest) if width == "column" or not rest else rest:
        axes.set_xlabel("time [s]")
    legend_above(figure, [whole])
    return figure


def _strips(
    curves: Sequence[MotionCurve], windows: Sequence[Span | None], label: str, unit: str, width: Width
) -> Figure:
    """Draw one strip per run with the ideal run on top: spikes of several runs would hide each other."""
    ideal = next((curve for curve in curves if curve.is_ideal), None)
    others = [curve for curve in curves if not curve.is_ideal]
    columns = 1 if all(window is None for window in windows) else 2
    height = 34.0 if len(others) > 1 else 58.0
    figure = new_figure(width, 20.0 + height * len(others))
    panels = figure.subplots(
        len(others),
        columns,
        squeeze=False,
        sharey=True,
        width_ratios=[1.5, 1.0][:columns] if width == "page" else None,
    )
    largest = max(float(np.nanmax(np.abs(c.value), initial=0.0)) for c in others)
    core = max(between_spikes(c.time, c.value) for c in others)
    if ideal is not None:
        core = max(core, float(np.nanmax(np.abs(ideal.value), initial=0.0)))
    limit = linear_then_log(list(panels.flat), core, largest)
    letter = letters()
    for row, curve, window in zip(panels, others, windows, strict=True):
        for axes, span in zip(row, (None, window), strict=False):
            _draw(axes, curve, curve.value, span, thin=span is None)
            if ideal is not None:
                _draw(axes, ideal, ideal.value, span)
        if window is not None and columns == 2:
            row[1].set_xlim(window)
            _mark(row[0], window)
        panel_title(row[0], next(letter) if len(panels.flat) > 1 else "", curve.label)
        if columns == 2:
            panel_title(row[1], next(letter), "close view" + " of the shaded span" * (width == "page"))
    for axes in panels[-1]:
        axes.set_xlabel("time [s]")
    for axes in panels.flat:
        few_ticks(axes, 5)
    if width == "column" and columns == 2:
        # Times of a close view have more digits.
        for whole, near in panels:
            few_ticks(whole, 3)
            few_ticks(near, 2)
            near.tick_params(axis="x", labelsize=6.0)
    _, printed = prefixed(unit, 1.0)
    scale = f"\nlinear within ±{limit:g}, logarithmic beyond" if limit is not None else ""
    figure.supylabel(f"{label} [{printed}]{scale}", fontsize=7.5, multialignment="center")
    legend_above(figure, panels[:, 0])
    return figure


def _mark(axes: Axes, window: Span) -> None:
    """Shade the span that the close view shows; its edges keep a narrow one visible."""
    axes.axvspan(*window, facecolor=SHADE, edgecolor="#888888", linewidth=0.5, zorder=0.5)


FIGURES = tuple(
    RunFigure(
        name=what.variable,
        title=f"{quantity.removeprefix('slide ').capitalize()} of {{joint}}",
        function=figure_motion,
        options={"quantity": quantity},
        of=what.of,
    )
    for quantity, what in MOTIONS.items()
)
