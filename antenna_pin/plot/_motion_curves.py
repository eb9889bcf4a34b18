"""Lines of a joint's motion in several runs, how far they are from the ideal one, and where that is most."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from antenna_pin.analysis import LONG, beside, resampled
from antenna_pin.plot._compared import COINCIDE
from antenna_pin.plot._kinds import SLIDING, JointKind
from antenna_pin.plot._runs import LabelledRun
from antenna_pin.plot._style import Array, distinct
from antenna_pin.plot._thinned import Columns

__all__ = [
    "MotionCurve",
    "MotionQuantity",
    "Span",
    "curves_of",
    "drawn_columns",
    "from_rest",
    "less_the_first",
    "seen_from_near_only",
    "zoom_of",
]

Span = tuple[float, float]

# Share of the height from which on a deviation is seen without a close view [-].
_SEEN = 0.05


class MotionQuantity(NamedTuple):
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


@dataclass(frozen=True, slots=True, eq=False)
class MotionCurve:
    """One run's line: times [s], values, and the deviation from the ideal run (None without one)."""

    label: str
    time: Array
    value: Array
    deviation: Array | None
    is_ideal: bool
    look: dict[str, Any]  # colour and dashes; the ideal run has its own
    spacing: float  # the run's commonest one of samples [s]
    many: bool = False
    linewidth: float = 1.0


def curves_of(
    runs: Sequence[LabelledRun], reference: LabelledRun | None, joint: str, what: MotionQuantity
) -> list[MotionCurve]:
    """Return what is to be drawn, the ideal run last so that it lies on top."""
    curves: list[MotionCurve] = []
    numbers = itertools.count()
    for run in runs:
        if joint not in what.of.names(run):
            continue
        is_ideal = _is(run, reference)
        value = run.values(what.variable, **{what.dim: joint})
        look = {} if is_ideal else distinct(next(numbers))
        curves.append(
            MotionCurve(
                run.legend if is_ideal else run.label,
                run.time,
                value,
                _deviation(run, value, reference, joint, what),
                is_ideal,
                look,
                # Of a long run that of its first samples.
                float(np.median(np.diff(run.whole.time[:LONG]))),
                run.many,
            )
        )
    return sorted(curves, key=lambda curve: curve.is_ideal)


def drawn_columns(reference: LabelledRun | None, joint: str, what: MotionQuantity) -> Columns:
    """Return what is drawn of a run: its motion, its deviation, and the motion less that."""

    def columns(run: LabelledRun) -> list[Array]:
        if joint not in what.of.names(run):
            return []
        value = run.values(what.variable, **{what.dim: joint})
        deviation = _deviation(run, value, reference, joint, what)
        return [value] if deviation is None else [value, deviation, value - deviation]

    return columns


def _is(run: LabelledRun, reference: LabelledRun | None) -> bool:
    return reference is not None and run.source is reference.source


def _deviation(
    run: LabelledRun, value: Array, reference: LabelledRun | None, joint: str, what: MotionQuantity
) -> Array | None:
    """Return a run's motion less that of the smooth one, NaN outside its span; None if there is no such."""
    if reference is None or _is(run, reference) or joint not in what.of.names(reference):
        return None
    place, smooth, time = {what.dim: joint}, reference.whole, run.time
    known = what.derivative is not None and what.derivative in smooth.data
    base = np.empty_like(value)
    for some, data in beside(smooth.data, time):
        part = dataclasses.replace(smooth, data=data)
        slope = part.values(what.derivative, **place) if known and what.derivative else None
        base[some] = resampled(part.time, part.values(what.variable, **place), time[some], slope)
    return value - base


def from_rest(curve: MotionCurve) -> MotionCurve:
    """Return a curve with its deviation, from zero if there is no ideal run to deviate from."""
    return curve if curve.deviation is not None else dataclasses.replace(curve, deviation=curve.value)


def zoom_of(curves: Sequence[MotionCurve], what: MotionQuantity) -> Span | None:
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
    smallest = min(5.0 * curve.spacing, half)
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


def seen_from_near_only(curves: Sequence[MotionCurve]) -> bool:
    """Whether the largest deviation is less than a twentieth of the height: a close view tells more."""
    spread = _spread(curves)
    if spread is None:
        return False
    values = [curve.value[np.isfinite(curve.value)] for curve in curves]
    height = max(float(v.max()) for v in values) - min(float(v.min()) for v in values)
    return float(np.nanmax(np.abs(spread[1]), initial=0.0)) < _SEEN * height


def less_the_first(curves: Sequence[MotionCurve]) -> tuple[str, list[MotionCurve]]:
    """Return runs with play less the first of them, and its name; none where they can be told apart.

    They are told apart by their deviations from the ideal run where there is one.
    """
    others = [curve for curve in curves if not curve.is_ideal]
    if len(others) < 2:
        return "", []
    values = [curve.value if curve.deviation is None else curve.deviation for curve in others]
    height = max(float(np.ptp(v[np.isfinite(v)])) if np.isfinite(v).any() else 0.0 for v in values)
    first, *rest = others
    own, index = np.unique(first.time, return_index=True)
    less = [
        dataclasses.replace(
            one, value=one.value - np.interp(one.time, own, first.value[index], left=np.nan, right=np.nan)
        )
        for one in rest
    ]
    largest = max(float(np.nanmax(np.abs(one.value), initial=0.0)) for one in less)
    return first.label, less if 0.0 < largest < COINCIDE * height else []


def _spread(curves: Sequence[MotionCurve]) -> tuple[MotionCurve, Array] | None:
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
