"""What the motion is at each value of a bifurcation diagram, from its points."""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np
import xarray as xr

from antenna_pin.analysis.recurrence import RecurrenceKind, recurrence
from antenna_pin.base.arguments import takes

__all__ = ["Verdict", "diagram_verdicts", "said_of_verdicts"]

Verdict = str
"""What a motion is: "period 1", "period 2" and so on, "quasi-periodic", "chaotic", or "too short to say"."""

#: What is not any of these is "too short to say": of few points only periods can be told.
_UNDECIDED = RecurrenceKind.TOO_SHORT.value


# What is smaller than this part of the largest quantity of its unit is zero but for round-off.
_ZERO = 1e-6


@takes()
def diagram_verdicts(
    diagram: xr.Dataset,
    quantities: Sequence[str] | None = None,
    *,
    branch: str | None = None,
    vector: bool = False,
    tolerance: float = 1e-3,
) -> list[Verdict | None]:
    """Return what the motion is at each value of a diagram; None where its points have not settled.

    Points are the same that differ by less than the tolerance, over the largest amount of the quantity in the
    diagram: less than a dot in a figure of it.

    Args:
        diagram: As :func:`antenna_pin.nonlinear.bifurcation` returns it.
        quantities: Which of its quantities are looked at; all if left out.
        branch: Which of its branches; the first if left out.
        vector: Whether the quantities are components of one vector, whose largest amount counts for all.
        tolerance: Above what the accuracy of the runs leaves [-].
    """
    names = list(quantities or json.loads(diagram.attrs["quantities"]))
    whole = [np.asarray(diagram[name].values, dtype=float) for name in names]
    sizes = np.array([float(np.nanmax(np.abs(one), initial=0.0)) for one in whole])
    units = np.array([str(diagram[name].attrs.get("units", "1")) for name in names])
    largest = np.array([sizes[units == unit].max() for unit in units])
    scale = largest if vector else np.maximum(sizes, _ZERO * largest)
    scale[scale == 0.0] = 1.0
    place = 0 if branch is None else [str(one) for one in diagram["branch"].values].index(branch)
    found: list[Verdict | None] = []
    for k, settled in enumerate(np.asarray(diagram["settled"].values[place], dtype=bool)):
        points = np.stack([one[place, k] for one in whole], axis=-1)
        points = points[np.isfinite(points).all(axis=1)]
        if not settled or not len(points):
            found.append(None)
            continue
        recurs = recurrence(points, scale=scale, tolerance=tolerance)
        found.append(recurs.kind.value if recurs.period is None else f"period {recurs.period}")
    return found


@takes()
def said_of_verdicts(
    values: Sequence[float], verdicts: Sequence[Verdict | None], unit: str = ""
) -> list[str]:
    """Return lines as "period 1 at 12 values: 0.01 to 0.09, 0.11 mm", the most frequent verdict first.

    Args:
        values: Of the parameter, in order.
        verdicts: At each; None where it has not settled.
        unit: Of the values.
    """
    kinds = sorted(set(verdicts), key=lambda one: (one is None, -verdicts.count(one), str(one)))
    said = []
    for kind in kinds:
        words = "not settled" if kind is None else "no period told" if kind == _UNDECIDED else kind
        there = [k for k, one in enumerate(verdicts) if one == kind]
        noun = "value" if len(there) == 1 else "values"
        said.append(f"{words} at {len(there)} {noun}: {_spans(values, there)}" + (f" {unit}" if unit else ""))
    return said


def _spans(values: Sequence[float], there: Sequence[int]) -> str:
    """Return values as spans of neighbours, such as "0.01 to 0.05, 0.2"."""
    spans: list[list[int]] = []
    for k in there:
        if spans and k == spans[-1][-1] + 1:
            spans[-1].append(k)
        else:
            spans.append([k])
    ends = [(values[span[0]], values[span[-1]], len(span)) for span in spans]
    return ", ".join(f"{a:.3g}" if count == 1 else f"{a:.3g} to {b:.3g}" for a, b, count in ends)
