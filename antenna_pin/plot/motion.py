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
from antenna_pin.base.arguments import takes
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
    less_the_first,
    seen_from_near_only,
    zoom_of,
)
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import Run, long_enough, too_short, with_reference
from antenna_pin.plot._style import (
    IDEAL,
    MANY,
    SHADE,
    Array,
    Width,
    explain_linear,
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

    The close view lies around the largest deviation from the ideal run, if the whole span does not show it.
    What runs that coincide are less the first of them has a panel of its own. For the acceleration, whose
    contact spikes dwarf the ideal curve, each run has a strip of its own with a scale that is linear as far
    as the motion between spikes reaches and logarithmic beyond, and the deviation is left out.

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
        scales = round_off_scales(*(run.whole.data for run in drawn)) if len(drawn) > 1 else {}
        plain, still = _without_round_off(curves, unit, scales)
        window = given or (zoom_of(plain, what) if not still and seen_from_near_only(plain) else None)
        shown, _ = _without_round_off(seen([window]), unit, scales)
        first, less = less_the_first(shown)
        if less and is_round_off(max(map(_size, less)), unit, scales):
            less, still = [], "; ".join(filter(None, (still, f"less that of {first}: zero to round-off")))
        figure = _panels(shown, window, label, unit, width, (first, less))
    footnote(figure, still, too_short(every))
    return figure


def _size(curve: MotionCurve) -> float:
    return float(np.nanmax(np.abs(curve.value), initial=0.0))


def _without_round_off(
    curves: Sequence[MotionCurve], unit: str, scales: dict[str, float]
) -> tuple[list[MotionCurve], str]:
    """Return curves without deviations that are zero to round-off in all runs, and that in words."""
    sizes = [float(np.nanmax(np.abs(c.deviation), initial=0.0)) for c in curves if c.deviation is not None]
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
    style = IDEAL if curve.is_ideal else {**curve.look, "linewidth": 0.6 if thin else curve.linewidth}
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
    curves: Sequence[MotionCurve],
    window: Span | None,
    label: str,
    unit: str,
    width: Width,
    differences: tuple[str, Sequence[MotionCurve]],
) -> Figure:
    """Draw the whole span, the close view, the deviation, and what runs that coincide are less the first."""
    deviating = [curve for curve in curves if curve.deviation is not None]
    first, less = differences
    count = 1 + (window is not None) + bool(deviating) + bool(less)
    figure, whole, rest = _places(width, count)
    largest = max(map(_size, curves), default=0.0)
    factor, printed = prefixed(unit, largest)
    for curve in _widened(curves):
        _draw(whole, curve, factor * curve.value)
    panel_title(whole, "a" if rest else "", "whole span")
    whole.set_ylabel(f"{label} [{printed}]")
    few_ticks(whole, 10 if width == "page" else 6)
    panels = zip(rest, "bcd", strict=False)
    if window is not None:
        near, letter = next(panels)
        for curve in _widened(curves):
            _draw(near, curve, factor * curve.value, window)
        near.set_xlim(window)
        _mark(whole, window)
        panel_title(near, letter, "close view of the shaded span")
        near.set_ylabel(f"{label} [{printed}]")
        few_ticks(near, 5)
    if deviating:
        axes, letter = next(panels)
        shown = [dataclasses.replace(c, value=_known(c.deviation)) for c in _widened(deviating)]
        _apart(axes, shown, "deviation", unit)
        panel_title(axes, letter, "deviation from the ideal joint")
    if less:
        axes, letter = next(panels)
        _apart(axes, less, "difference", unit)
        panel_title(axes, letter, f"less that of {first}")
    for axes in (whole, *rest) if width == "column" or not rest else rest:
        axes.set_xlabel("time [s]")
    legend_above(figure, [whole])
    return figure


def _known(values: Array | None) -> Array:
    assert values is not None
    return values


def _places(width: Width, count: int) -> tuple[Figure, Axes, list[Axes]]:
    """Return a figure, its first panel and the others: of a page the first has a row to itself."""
    if width == "page" and count > 1:
        figure = new_figure(width, 108.0)
        grid = figure.add_gridspec(2, count - 1)
        return (
            figure,
            figure.add_subplot(grid[0, :]),
            [figure.add_subplot(grid[1, i]) for i in range(count - 1)],
        )
    figure = new_figure(width, 12.0 + 46.0 * count)
    whole, *rest = figure.subplots(count, 1, squeeze=False)[:, 0]
    return figure, whole, rest


def _apart(axes: Axes, curves: Sequence[MotionCurve], label: str, unit: str) -> None:
    """Draw how far lines are from another, on a scale of their own."""
    largest = max(map(_size, curves))
    factor, printed = prefixed(unit, largest)
    for curve in curves:
        _draw(axes, curve, factor * curve.value, thin=len(curves) < 2)
    axes.axhline(0.0, **{**IDEAL, "linewidth": 0.6})
    axes.set_ylabel(f"{label} [{printed}]")
    few_ticks(axes, 5)


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
    largest = max(map(_size, others))
    core = max(between_spikes(c.time, c.value) for c in others)
    if ideal is not None:
        core = max(core, _size(ideal))
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
    figure.supylabel(f"{label} [{printed}]", fontsize=7.5)
    if limit is not None:
        explain_linear(figure)
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
