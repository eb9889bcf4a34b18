"""Angle, rate and acceleration of a joint against the ideal one.

As in the Figures 7 to 10 of Bai and Zhao (2020): the whole span, and a close view.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

import numpy as np
from matplotlib.axes import Axes

from antenna_pin.analysis import LONG, is_round_off, resampled, round_off_scales, samples_around
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.show.plot._compared import COINCIDE, pick, straight
from antenna_pin.show.plot._kinds import SLIDING, TURNING, JointKind, RunFigure
from antenna_pin.show.plot._runs import LabelledRun, Run, too_short
from antenna_pin.show.plot._style import IDEAL, Array, Width, distinct, prefixed
from antenna_pin.show.plot._thinned import Columns, between_spikes
from antenna_pin.show.plot.grammar import ZERO, Axis, Panel, PlotCurve, Sheet, close_view, figure, size_of

Quantity = Literal["angle", "rate", "acceleration", "position", "slide rate", "slide acceleration"]
Span = tuple[float, float]

# Share of the height from which on a deviation is seen without a close view [-].
_SEEN = 0.05


class MotionQuantity(NamedTuple):
    """A quantity of a joint's motion."""

    variable: str
    derivative: str | None
    of: JointKind
    # Largest half width of the zoom, as a share of the whole span.
    half_width: float = 0.05
    spiky: bool = False  # as accelerations are in contact: a strip each, and closer

    @property
    def dim(self) -> str:
        """Dimension of the joints."""
        return "sliding_joint" if self.of is SLIDING else "joint"

    def values(self, run: LabelledRun, joint: str) -> Array:
        """Return the quantity of a joint of a run, (n,)."""
        return run.values(self.variable, **{self.dim: joint})


MOTIONS: dict[Quantity, MotionQuantity] = {
    "angle": MotionQuantity("motion_angle", "motion_rate", TURNING),
    "rate": MotionQuantity("motion_rate", "motion_acceleration", TURNING),
    "acceleration": MotionQuantity("motion_acceleration", None, TURNING, 0.01, True),
    "position": MotionQuantity("slide_position", "slide_rate", SLIDING),
    "slide rate": MotionQuantity("slide_rate", "slide_acceleration", SLIDING),
    "slide acceleration": MotionQuantity("slide_acceleration", None, SLIDING, 0.01, True),
}

#: Those of joints that turn.
QUANTITIES: tuple[Quantity, ...] = tuple(name for name, what in MOTIONS.items() if what.of is TURNING)


@figure(
    quantity='"angle", "rate" or "acceleration" of a joint that turns; "position", "slide rate" or "slide '
    'acceleration" of one that slides.'
)
def figure_motion(
    runs: Iterable[Run],
    quantity: Quantity = "angle",
    *,
    joint: str | None = None,
    ideal: Run | None = None,
    zoom: Span | None = None,
    width: Width = "page",
) -> Sheet:
    """Return the motion of one joint: whole span, close view, deviation from the ideal joint.

    The close view lies around the largest deviation from the ideal run, if the whole span does not show it.
    Differences of runs that coincide from the first have a panel of their own. For the acceleration, whose
    contact spikes dwarf the ideal curve, each run has a strip of its own with a scale that is linear as far
    as the motion between spikes reaches and logarithmic beyond, and the deviation is left out.
    """
    if quantity not in MOTIONS:
        raise UnknownNameError("figure", "quantity", quantity, MOTIONS)
    what = MOTIONS[quantity]
    picked = pick(runs, ideal=ideal, joint=(what.of, joint))
    if zoom is not None and not zoom[0] < zoom[1]:
        raise InvalidParameterError("figure", "zoom", "a start before its end [s]", zoom)
    columns = drawn_columns(picked.reference, picked.joint, what)
    picked = picked.thinned(columns)
    drawn, reference, name = picked.drawn, picked.reference, picked.joint
    curves = _curves_of(drawn, reference, name, what)

    def with_close_views(windows: Sequence[Span | None]) -> list[_MotionCurve]:
        """Return the curves with all samples in close views."""
        if all(run.kept is None for run in drawn):
            return curves
        near = picked
        for window in windows:
            near = replace(near.closer(window, columns), reference=reference)
        return _curves_of(near.drawn, reference, name, what)

    unit = drawn[0].unit(what.variable)
    label = f"{name.replace('_', ' ')} {quantity.removeprefix('slide ')}"
    short = too_short(picked.every)
    if what.spiky and any(not c.is_ideal for c in curves):
        windows = [zoom or _zoom_of([_from_rest(c)], what) for c in curves if not c.is_ideal]
        return _strips(
            with_close_views(windows), windows, f"{label} [{prefixed(unit, 1.0)[1]}]", width, short
        )
    scales = round_off_scales(*(run.whole.data for run in drawn)) if len(drawn) > 1 else {}
    plain, still = _without_round_off(curves, unit, scales)
    window = zoom or (_zoom_of(plain, what) if not still and _seen_from_near_only(plain) else None)
    shown, _ = _without_round_off(with_close_views([window]), unit, scales)
    first, less = _less_the_first(shown)
    if less and is_round_off(max(size_of(one.value) for one in less), unit, scales):
        less, still = [], "; ".join(filter(None, (still, f"less that of {first}: zero to round-off")))
    panels = _panels(shown, window, Axis(label, unit), width, (first, less))
    whole, *rest = panels
    if width == "page" and rest:  # the first has a row to itself
        return Sheet([[whole], rest], width, 108.0, (still, short))
    return Sheet([[one] for one in panels], width, 12.0 + 46.0 * len(panels), (still, short), every=True)


def _panels(
    curves: Sequence[_MotionCurve],
    window: Span | None,
    y: Axis,
    width: Width,
    differences: tuple[str, Sequence[_MotionCurve]],
) -> list[Panel]:
    """Return whole span, close view, deviation, and differences of runs that coincide."""
    others = sum(not curve.is_ideal for curve in curves)
    # Those below are wider: of runs that nearly coincide, all are seen.
    wide = {curve.label: 0.9 + 0.5 * (others - 1 - k) for k, curve in enumerate(curves)}
    y = replace(y, largest=max((size_of(curve.value) for curve in curves), default=0.0))
    shades = [close_view(window)] if window is not None else []
    lines = [curve.line(curve.value, wide[curve.label]) for curve in curves]
    deviating = [(c, c.deviation) for c in curves if c.deviation is not None]
    first, less = differences
    long = Axis("time [s]", ticks=10 if width == "page" else 6)
    if width == "page" and (window is not None or deviating or less):
        long = replace(long, labelled=False)
    panels = [Panel("whole span", [*lines, *shades], y, long)]
    if window is not None:
        near = [curve.line(curve.value, wide[curve.label], window) for curve in curves]
        panels.append(Panel("close view of the shaded span", near, y, Axis("time [s]", limits=window)))
    if deviating:
        thin = len(deviating) < 2
        apart = [curve.line(d, 0.6 if thin else wide[curve.label]) for curve, d in deviating]
        panels.append(Panel("deviation from the ideal joint", [*apart, ZERO], Axis("deviation", y.unit)))
    if less:
        apart = [curve.line(curve.value, 0.6 if len(less) < 2 else 1.0) for curve in less]
        panels.append(Panel(f"less that of {first}", [*apart, ZERO], Axis("difference", y.unit)))
    return panels


def _strips(
    curves: Sequence[_MotionCurve], windows: Sequence[Span | None], label: str, width: Width, note: str
) -> Sheet:
    """Return one strip per run with the ideal run on top."""
    ideal = [curve for curve in curves if curve.is_ideal][:1]
    others = [curve for curve in curves if not curve.is_ideal]
    columns, page = 1 if all(window is None for window in windows) else 2, width == "page"
    core = max(between_spikes(c.time, c.value) for c in others)
    core = max([core, *(size_of(one.value) for one in ideal)])
    span = core, max(size_of(one.value) for one in others)
    # Times of a close view have more digits.
    ticks = (3, 2) if columns == 2 and not page else (5, 5)

    def finish(axes: Axes) -> None:
        if not page:
            axes.tick_params(axis="x", labelsize=6.0)

    rows: list[list[Panel]] = []
    for curve, window in zip(others, windows, strict=True):
        marked = window is not None and columns == 2
        rows.append([])
        for part, title, count in zip(
            (None, window)[:columns],
            (curve.label, "close view" + " of the shaded span" * page),
            ticks,
            strict=False,
        ):
            lines = [
                curve.line(curve.value, 0.6 if part is None else 1.0, part),
                *(one.line(one.value, 1.0, part) for one in ideal),
            ]
            shades = [close_view(window)] if marked and window and not rows[-1] else []
            x = Axis("time [s]", ticks=count, limits=part)
            y = Axis(shared="all", labelled=False)
            panel = Panel(title, [*lines, *shades], y, x, span=span, named=not rows[-1])
            rows[-1].append(panel if not rows[-1] else replace(panel, finish=finish))
    height = 20.0 + (34.0 if len(others) > 1 else 58.0) * len(others)
    return Sheet(rows, width, height, (note,), [1.5, 1.0][:columns] if page else None, label=label)


# --- curves ---


@dataclass(frozen=True, slots=True, eq=False)
class _MotionCurve:
    """Line of a run: times [s], values, deviation from the ideal run (None without)."""

    label: str
    time: Array
    value: Array
    deviation: Array | None
    is_ideal: bool
    look: dict[str, Any]  # colour and dashes; the ideal run has its own
    spacing: float  # the run's commonest one of samples [s]
    many: bool = False

    def line(self, values: Array, linewidth: float, span: Span | None = None) -> PlotCurve:
        """Return the line of some values, or its part in a span."""
        time, many = self.time, self.many
        if span is not None:
            first = max(int(np.searchsorted(time, span[0])) - 1, 0)
            last = int(np.searchsorted(time, span[1], side="right")) + 1
            time, values, many = time[first:last], values[first:last], False
        look = IDEAL if self.is_ideal else {**self.look, "linewidth": linewidth}
        return PlotCurve(self.label, time, values, look, self.is_ideal, many)


def _curves_of(
    runs: Sequence[LabelledRun], reference: LabelledRun | None, joint: str, what: MotionQuantity
) -> list[_MotionCurve]:
    """Return the drawn curves, the ideal run's last, on top."""
    curves: list[_MotionCurve] = []
    numbers = itertools.count()
    for run in runs:
        if joint not in what.of.names(run):
            continue
        is_ideal = _is(run, reference)
        value = what.values(run, joint)
        label, look = (run.legend, {}) if is_ideal else (run.label, distinct(next(numbers)))
        spacing = float(np.median(np.diff(run.whole.time[:LONG])))  # of a long run that of its first samples
        deviation = deviation_of(run, value, reference, joint, what)
        curves.append(_MotionCurve(label, run.time, value, deviation, is_ideal, look, spacing, run.many))
    return sorted(curves, key=lambda curve: curve.is_ideal)


def drawn_columns(reference: LabelledRun | None, joint: str, what: MotionQuantity) -> Columns:
    """Return a reader of drawn columns: motion, deviation, and their difference."""

    def columns(run: LabelledRun) -> list[Array]:
        if joint not in what.of.names(run):
            return []
        value = what.values(run, joint)
        deviation = deviation_of(run, value, reference, joint, what)
        return [value] if deviation is None else [value, deviation, value - deviation]

    return columns


def _is(run: LabelledRun, reference: LabelledRun | None) -> bool:
    return reference is not None and run.source is reference.source


def deviation_of(
    run: LabelledRun, value: Array, reference: LabelledRun | None, joint: str, what: MotionQuantity
) -> Array | None:
    """Return the deviation from the smooth run, NaN outside its span, or None."""
    if reference is None or _is(run, reference) or joint not in what.of.names(reference):
        return None
    place, smooth, time = {what.dim: joint}, reference.whole, run.time
    known = what.derivative is not None and what.derivative in smooth.data
    base = np.empty_like(value)
    for some, data in samples_around(smooth.data, time):
        part = replace(smooth, data=data)
        slope = part.values(what.derivative, **place) if known and what.derivative else None
        base[some] = resampled(part.time, part.values(what.variable, **place), time[some], slope)
    return value - base


def _without_round_off(
    curves: Sequence[_MotionCurve], unit: str, scales: dict[str, float]
) -> tuple[list[_MotionCurve], str]:
    """Return curves without deviations that are round-off, and a note on these."""
    sizes = [size_of(c.deviation) for c in curves if c.deviation is not None]
    if not sizes or not is_round_off(max(sizes), unit, scales):
        return list(curves), ""
    bare = [replace(curve, deviation=None) for curve in curves]
    return bare, "deviation from the ideal joint: zero to round-off"


def _from_rest(curve: _MotionCurve) -> _MotionCurve:
    """Return a curve with its deviation, by default from zero."""
    return curve if curve.deviation is not None else replace(curve, deviation=curve.value)


def _zoom_of(curves: Sequence[_MotionCurve], what: MotionQuantity) -> Span | None:
    """Return a span in which the largest deviation fills much of the height."""
    spread = _spread(curves)
    if spread is None:
        return None
    curve, deviation = spread
    known = np.where(np.isfinite(deviation), deviation, 0.0)
    size = np.abs(known)
    at = int(np.argmax(size))
    if size[at] <= 0.0:
        return None
    start, end = float(curve.time[0]), float(curve.time[-1])
    half = what.half_width * (end - start)
    smallest = min(5.0 * curve.spacing, half)
    smooth = curve.value - known
    while half > smallest:
        near = smooth[np.abs(curve.time - curve.time[at]) <= half]
        if np.ptp(near) <= 6.0 * size[at]:
            break
        half /= 1.25
    half = max(half, smallest)
    # The close view keeps its width at the ends of the span.
    centre = min(max(float(curve.time[at]), start + half), end - half)
    return centre - half, centre + half


def _seen_from_near_only(curves: Sequence[_MotionCurve]) -> bool:
    """Return whether the largest deviation is below a twentieth of the height."""
    spread = _spread(curves)
    if spread is None:
        return False
    values = [curve.value[np.isfinite(curve.value)] for curve in curves]
    height = max(float(v.max()) for v in values) - min(float(v.min()) for v in values)
    return size_of(spread[1]) < _SEEN * height


def _less(one: _MotionCurve, other: _MotionCurve) -> Array:
    """Return the motion of a run less that of another, at its own times."""
    return one.value - straight(one.time, other.time, other.value)


def _less_the_first(curves: Sequence[_MotionCurve]) -> tuple[str, list[_MotionCurve]]:
    """Return the differences from the first run with play, and its name, where runs coincide.

    Runs are distinguished by their deviations from the ideal run where there is one.
    """
    others = [curve for curve in curves if not curve.is_ideal]
    if len(others) < 2:
        return "", []
    values = [curve.value if curve.deviation is None else curve.deviation for curve in others]
    height = max(float(np.ptp(v[np.isfinite(v)])) if np.isfinite(v).any() else 0.0 for v in values)
    first, *rest = others
    less = [replace(one, value=_less(one, first)) for one in rest]
    largest = max(size_of(one.value) for one in less)
    return first.label, less if 0.0 < largest < COINCIDE * height else []


def _spread(curves: Sequence[_MotionCurve]) -> tuple[_MotionCurve, Array] | None:
    """Return the curve with the largest deviation from the ideal or first run."""
    compared = [
        (c, c.deviation) for c in curves if c.deviation is not None and np.isfinite(c.deviation).any()
    ]
    if not compared:
        compared = [(other, _less(other, curves[0])) for other in curves[1:]]
    return max(compared, key=lambda pair: size_of(pair[1])) if compared else None


FIGURES = tuple(
    RunFigure(
        what.variable,
        f"{quantity.removeprefix('slide ').capitalize()} of {{joint}}",
        figure_motion,
        {"quantity": quantity},
        what.of,
    )
    for quantity, what in MOTIONS.items()
)
