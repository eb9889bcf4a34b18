"""What a joint carries, with clearance and without."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from matplotlib.figure import Figure

from antenna_pin.analysis import joint_loads
from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError
from antenna_pin.plot._kinds import LOOPED, MOVING, choose_joint
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, long_enough, styles, too_short, with_reference
from antenna_pin.plot._style import (
    MANY,
    SHADE,
    Array,
    Width,
    few_ticks,
    footnote,
    legend_above,
    literal,
    new_figure,
    panel_title,
    prefixed,
    styled,
)
from antenna_pin.plot._thinned import closer, thinned_beside

_DECADES = 5


@takes()
@styled
def figure_joint_load(
    runs: Iterable[Run] | Run,
    *,
    joint: str | None = None,
    ideal: Run | None = None,
    zoom: tuple[float, float] | None = None,
    width: Width = "page",
) -> Figure:
    """Return the size of the force through a joint in all runs, on a logarithmic scale.

    The force is that of inverse dynamics of the recorded motion, so that an ideal joint has one as well. A
    run with clearance is sampled at the largest force of every contact, so its peaks are there. In free
    flight the force is zero and the line leaves the panel. The close view lies around the largest force.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        joint: Name of the joint; the first one with clearance if left out.
        ideal: The run to compare with; the first run without any contact if left out.
        zoom: Start and end of the close view [s].
        width: "column" (88 mm) or "page" (180 mm).
    """
    every, reference = with_reference(runs, ideal)
    joint, drawn, forces, reference = _forces(every, reference, joint)
    largest = [float(np.nanmax(force, initial=0.0)) for force in forces]
    overall = max(largest)
    if not overall > 0.0:
        rule = f"at least one in which a force goes through {joint}"
        raise InvalidParameterError("figure", "runs", rule, said="0 N in all of them")
    factor, printed = prefixed("N", overall)
    page = width == "page"
    figure = new_figure(width, 66.0 if page else 110.0)
    whole, near = figure.subplots(1 if page else 2, 2 if page else 1, squeeze=False).ravel()
    hardest = int(np.argmax(largest))
    window = zoom or _around(drawn[hardest].time, forces[hardest])
    looks = styles(drawn, reference)
    ratios = _ratios(drawn, largest, reference)
    drawn, forces = _seen_closer(drawn, forces, window, joint)
    for run, force, style in zip(drawn, forces, looks, strict=True):
        for axes in (whole, near):
            axes.plot(run.time, factor * force, label=run.legend, rasterized=run.many, **style)
    whole.set_xlim(min(run.time[0] for run in drawn), max(run.time[-1] for run in drawn))
    near.set_xlim(window)
    whole.axvspan(*window, facecolor=SHADE, edgecolor="#888888", linewidth=0.5, zorder=0.5)
    for letter, axes, title in zip(
        "ab", (whole, near), ("whole span", "close view of the shaded span"), strict=True
    ):
        axes.set_yscale("log", nonpositive="clip")
        top = 10.0 ** np.ceil(np.log10(1.05 * factor * overall))
        axes.set_ylim(top / 10.0**_DECADES, top)
        few_ticks(axes, 5)
        panel_title(axes, letter, title)
        axes.set_xlabel("time [s]")
        axes.set_ylabel(f"force through {literal(joint.replace('_', ' '))} [{printed}]")
    legend_above(figure, [whole])
    footnote(figure, ratios, too_short(every))
    return figure


@takes()
@styled
def figure_steady_force(
    runs: Iterable[Run] | Run,
    *,
    joint: str | None = None,
    ideal: Run | None = None,
    zoom: tuple[float, float] | None = None,
    width: Width = "page",
) -> Figure:
    """Return the size of the force through a joint in the second half of all runs, on a linear scale.

    When the impacts of the start have died away; the force is that of inverse dynamics of the recorded
    motion, as in :func:`figure_joint_load`.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        joint: Name of the joint; the first one with clearance if left out.
        ideal: The run to compare with; the first run without any contact if left out.
        zoom: Start and end of the close view [s]; around the largest force of that half if left out.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every, reference = with_reference(runs, ideal)
    joint, drawn, forces, reference = _forces(every, reference, joint)
    start, end = min(run.time[0] for run in drawn), max(run.time[-1] for run in drawn)
    middle = 0.5 * (start + end)
    figure = new_figure(width, 110.0)
    panels = figure.subplots(2, 1)
    held = [np.where(run.time >= middle, force, 0.0) for run, force in zip(drawn, forces, strict=True)]
    hardest = max(range(len(drawn)), key=lambda k: float(np.nanmax(held[k])))
    peak = float(drawn[hardest].time[int(np.nanargmax(held[hardest]))])
    half = 0.02 * (end - start)
    centre = min(max(peak, middle + half), end - half)
    window = zoom or (centre - half, centre + half)
    factor, printed = prefixed("N", float(np.nanmax(held[hardest])))
    spans = ((middle, end), window)
    looks = styles(drawn, reference)
    drawn, forces = _seen_closer(drawn, forces, window, joint)
    for axes, span, letter, title in zip(
        panels, spans, "ab", ("second half of the run", "close view of the shaded span"), strict=True
    ):
        for run, force, style in zip(drawn, forces, looks, strict=True):
            shown = (run.time >= span[0]) & (run.time <= span[1])
            many = np.count_nonzero(shown) > MANY or run.kept is not None
            axes.plot(run.time[shown], factor * force[shown], label=run.legend, rasterized=many, **style)
        axes.set_xlim(span)
        few_ticks(axes, 6)
        panel_title(axes, letter, title)
        axes.set_xlabel("time [s]")
        axes.set_ylabel(f"force through {literal(joint.replace('_', ' '))} [{printed}]")
    panels[0].axvspan(*window, facecolor=SHADE, edgecolor="#888888", linewidth=0.5, zorder=0.5)
    legend_above(figure, [panels[0]])
    footnote(figure, too_short(every))
    return figure


def _forces(
    every: list[LabelledRun], reference: LabelledRun | None, joint: str | None
) -> tuple[str, list[LabelledRun], list[Array], LabelledRun | None]:
    """Return the joint to draw, the runs that have it, the ideal one last, the sizes of its force [N]."""
    long = long_enough(every)
    known = [joint_loads(run.data, [0])["moving_joint"].values for run in long]
    joint = choose_joint(MOVING, every, joint)
    drawn = [run for run, names in zip(long, known, strict=True) if joint in names]
    drawn.sort(key=lambda run: run is reference)
    drawn, reference = thinned_beside(drawn, reference, lambda part: [_force(part, joint)])
    return joint, drawn, [_force(run, joint) for run in drawn], reference


def _seen_closer(
    runs: list[LabelledRun], forces: list[Array], window: tuple[float, float], joint: str
) -> tuple[list[LabelledRun], list[Array]]:
    """Return runs and sizes of the force with all samples in a close view, in the order of the runs."""
    near = [closer(run, window, lambda part: [_force(part, joint)]) for run in runs]
    pairs = zip(runs, near, forces, strict=True)
    return near, [force if seen is run else _force(seen, joint) for run, seen, force in pairs]


def _force(run: LabelledRun, joint: str) -> Array:
    """Return the size of the force through a joint [N], (n,)."""
    force = joint_loads(run.data)["force"].sel(moving_joint=joint)
    return np.asarray(np.linalg.norm(np.asarray(force.values, dtype=float), axis=1))


def _around(time: Array, force: Array) -> tuple[float, float]:
    """Return the hundredth of the run around the largest force."""
    start, end = float(time[0]), float(time[-1])
    half = 0.005 * (end - start)
    centre = min(max(float(time[int(np.nanargmax(force))]), start + half), end - half)
    return centre - half, centre + half


def _ratios(runs: list[LabelledRun], largest: list[float], reference: LabelledRun | None) -> str:
    """Return how many times the ideal joint's largest force each run reaches."""
    if reference is None or reference not in runs:
        return ""
    base = largest[runs.index(reference)]
    parts = [
        f"{run.label} {size / base:.3g}"
        for run, size in zip(runs, largest, strict=True)
        if run is not reference and base > 0.0
    ]
    words = f"largest force of the whole run over that of {reference.label}"
    return f"{words}: {', '.join(parts)}" if parts else ""


FIGURES = (
    RunFigure(name="joint_load", title="Force through {joint}", function=figure_joint_load, of=MOVING),
    RunFigure(
        name="steady_force",
        title="Force through {joint} in the second half of the run",
        function=figure_steady_force,
        of=LOOPED,
        reported=False,
    ),
)
