"""Angle, rate and acceleration of a joint against the ideal one.

As in the Figures 7 to 10 of Bai and Zhao (2020): the whole span, and a close view.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from antenna_pin.analysis import resampled
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.plot._compared import between_spikes
from antenna_pin.plot._kinds import SLIDING, TURNING, JointKind, choose_joint
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, long_enough, too_short, with_reference
from antenna_pin.plot._style import (
    COLOURS,
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

Quantity = Literal["angle", "rate", "acceleration", "position", "slide rate", "slide acceleration"]
_Span = tuple[float, float]


class _Quantity(NamedTuple):
    """A quantity of a joint's motion."""

    variable: str
    unit: str
    derivative: str | None
    of: JointKind
    # Largest half width of the zoom, as a share of the whole span.
    half_width: float = 0.05
    spiky: bool = False  # as accelerations are in contact: a strip each, and closer

    @property
    def dim(self) -> str:
        """Along which the joints are."""
        return "sliding_joint" if self.of is SLIDING else "joint"


MOTIONS: dict[Quantity, _Quantity] = {
    "angle": _Quantity("motion_angle", "rad", "motion_rate", TURNING),
    "rate": _Quantity("motion_rate", "rad/s", "motion_acceleration", TURNING),
    "acceleration": _Quantity("motion_acceleration", "rad/s^2", None, TURNING, 0.01, True),
    "position": _Quantity("slide_position", "m", "slide_rate", SLIDING),
    "slide rate": _Quantity("slide_rate", "m/s", "slide_acceleration", SLIDING),
    "slide acceleration": _Quantity("slide_acceleration", "m/s^2", None, SLIDING, 0.01, True),
}


#: Those of joints that turn.
QUANTITIES: tuple[Quantity, ...] = tuple(name for name, what in MOTIONS.items() if what.of is TURNING)


@dataclass(frozen=True, slots=True, eq=False)
class _Curve:
    """One run's line: times [s], values, and the deviation from the ideal run (None without one)."""

    label: str
    time: Array
    value: Array
    deviation: Array | None
    is_ideal: bool
    colour: str
    linewidth: float = 1.0


@styled
def figure_motion(
    runs: Iterable[Run],
    quantity: Quantity = "angle",
    *,
    joint: str | None = None,
    ideal: Run | None = None,
    zoom: _Span | None = None,
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
    drawn = long_enough(every)
    curves = _curves(drawn, reference, name, what)
    given = None if zoom is None else _check_zoom(zoom)
    unit = drawn[0].unit(what.variable, what.unit)
    label = f"{literal(name.replace('_', ' '))} {quantity.removeprefix('slide ')}"
    if what.spiky and any(not c.is_ideal for c in curves):
        windows = [given or _zoom([_from_rest(c)], what) for c in curves if not c.is_ideal]
        figure = _strips(curves, windows, label, unit, width)
    else:
        figure = _panels(curves, given or _zoom(curves, what), label, unit, width)
    footnote(figure, too_short(every))
    return figure


def _curves(
    runs: Sequence[LabelledRun], reference: LabelledRun | None, joint: str, what: _Quantity
) -> list[_Curve]:
    """Return what is to be drawn, the ideal run last so that it lies on top."""
    curves: list[_Curve] = []
    colours = iter(COLOURS * (1 + len(runs) // len(COLOURS)))
    for run in runs:
        if joint not in what.of.names(run):
            continue
        time, value = run.time, run.values(what.variable, **{what.dim: joint})
        is_ideal = run is reference
        deviation = None
        if reference is not None and not is_ideal and joint in what.of.names(reference):
            deviation = value - _resampled(reference, joint, what, time)
        colour = "black" if is_ideal else next(colours)
        curves.append(_Curve(run.legend if is_ideal else run.label, time, value, deviation, is_ideal, colour))
    return sorted(curves, key=lambda curve: curve.is_ideal)


def _resampled(run: LabelledRun, joint: str, what: _Quantity, time: Array) -> Array:
    """Return a smooth run's motion at other times; NaN outside its span."""
    place = {what.dim: joint}
    known = what.derivative is not None and what.derivative in run.data
    slope = run.values(what.derivative, **place) if known and what.derivative else None
    return resampled(run.time, run.values(what.variable, **place), time, slope)


def _from_rest(curve: _Curve) -> _Curve:
    """Return a curve with its deviation, from zero if there is no ideal run to deviate from."""
    return curve if curve.deviation is not None else dataclasses.replace(curve, deviation=curve.value)


def _check_zoom(zoom: _Span) -> _Span:
    if not zoom[0] < zoom[1]:
        raise InvalidParameterError("figure", "zoom", "a start before its end [s]", zoom)
    return float(zoom[0]), float(zoom[1])


def _zoom(curves: Sequence[_Curve], what: _Quantity) -> _Span | None:
    """Return the span around the largest deviation in which that deviation is a good part of the height."""
    spread = _spread(curves)
    if spread is None:
        return None
    curve, deviation = spread
    size = np.abs(np.where(np.isfinite(deviation), deviation, 0.0))
    at = int(np.argmax(size))
    if size[at] <= 0.0:
        return None
    start, end = float(curve.time[0]), float(curve.time[-1])
    half = what.half_width * (end - start)
    smallest = min(5.0 * float(np.median(np.diff(curve.time))), half)
    smooth = curve.value - np.where(np.isfinite(deviation), deviation, 0.0)
    while half > smallest:
        near = smooth[np.abs(curve.time - curve.time[at]) <= half]
        if np.ptp(near) <= 6.0 * size[at]:
            break
        half /= 1.25
    half = max(half, smallest)
    # The close view keeps its width at the ends of the span.
    centre = min(max(float(curve.time[at]), start + half), end - half)
    return centre - half, centre + half


def _spread(curves: Sequence[_Curve]) -> tuple[_Curve, Array] | None:
    """Return the curve that deviates most, and by how much: from the ideal run, else from the first run."""
    compared = [
        (c, c.deviation) for c in curves if c.deviation is not None and np.isfinite(c.deviation).any()
    ]
    if not compared and len(curves) > 1:
        first = curves[0]
        own, index = np.unique(first.time, return_index=True)
        for other in curves[1:]:
            base = np.interp(other.time, own, first.value[index], left=np.nan, right=np.nan)
            compared.append((other, other.value - base))
    if not compared:
        return None
    return max(compared, key=lambda pair: float(np.nanmax(np.abs(pair[1]), initial=0.0)))


def _draw(axes: Axes, curve: _Curve, values: Array, span: _Span | None = None, thin: bool = False) -> None:
    """Draw one curve, or the part of it in a span (with one sample more on either side)."""
    time = curve.time
    if span is not None:
        first = max(int(np.searchsorted(time, span[0])) - 1, 0)
        last = int(np.searchsorted(time, span[1], side="right")) + 1
        time, values = time[first:last], values[first:last]
    style = (
        IDEAL if curve.is_ideal else {"color": curve.colour, "linewidth": 0.6 if thin else curve.linewidth}
    )
    axes.plot(time, values, label=curve.label, rasterized=time.size > MANY, **style)


def _widened(curves: Sequence[_Curve]) -> list[_Curve]:
    """Return the curves, the ones below wider: of runs that nearly coincide, all are seen."""
    others = sum(not curve.is_ideal for curve in curves)
    return [
        curve if curve.is_ideal else dataclasses.replace(curve, linewidth=0.9 + 0.5 * (others - 1 - k))
        for k, curve in enumerate(curves)
    ]


def _panels(curves: Sequence[_Curve], window: _Span | None, label: str, unit: str, width: Width) -> Figure:
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
    curves: Sequence[_Curve], windows: Sequence[_Span | None], label: str, unit: str, width: Width
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


def _mark(axes: Axes, window: _Span) -> None:
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
