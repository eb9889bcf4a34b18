"""How the elastic parts of flexible links swing, and with which frequencies."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, NullLocator

from antenna_pin.analysis import elastic_parts_of, spectrum
from antenna_pin.base.arguments import takes
from antenna_pin.errors import AntennaPinError
from antenna_pin.plot._kinds import FLEXIBLE, none_with
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, labelled, left_out, long_enough, styles, too_short
from antenna_pin.plot._style import (
    Array,
    Width,
    few_ticks,
    footnote,
    legend_above,
    letters,
    new_figure,
    panel_title,
    prefixed,
    styled,
)
from antenna_pin.plot._thinned import thinned_beside

# Parts that a figure shows, those with the largest deflections of their unit; decades of a spectrum.
_MOST = {"page": 4, "column": 3}
_DECADES = 6


@takes()
@styled
def figure_deflection(runs: Iterable[Run] | Run, *, width: Width = "page") -> Figure:
    """Return the deflections of elastic parts in all runs that have them, and their amplitude densities.

    Where there are many parts, those that deflect most. A dotted line marks the natural frequency with the
    hub held. The densities are means over three windows, half of the run each, of a short run one.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every = labelled(runs)
    drawn = [run for run in long_enough(every) if FLEXIBLE.holds(run)]
    if not drawn:
        raise none_with(FLEXIBLE, every)
    reference = next((run for run in drawn if run.ideal), None)
    drawn.sort(key=lambda run: run is reference)  # it lies on top
    parts, count = _largest(drawn, _MOST[width])
    drawn, reference = thinned_beside(drawn, reference, lambda run: _deflections(run, parts))
    page = width == "page"
    figure = new_figure(width, 12.0 + 44.0 * len(parts) * (1 if page else 2))
    grid = figure.subplots(len(parts) * (1 if page else 2), 2 if page else 1, squeeze=False)
    pairs = grid if page else grid.reshape(len(parts), 2)
    letter = letters()
    for (motion, density), part in zip(pairs, parts, strict=True):
        mine = [run for run in drawn if part in elastic_parts_of(run.data)]
        about = elastic_parts_of(mine[0].data)[part]
        looks = [look for run, look in zip(drawn, styles(drawn, reference), strict=True) if run in mine]
        _motion(motion, mine, looks, part, about["slides"])
        _spectra(density, mine, looks, part, [elastic_parts_of(run.data)[part]["frequency"] for run in mine])
        panel_title(motion, next(letter), part.replace("_", " "))
        panel_title(density, next(letter), "its amplitude density")
    for axes in pairs[-1] if page else [pairs[-1][1]]:
        axes.set_xlabel("time [s]" if page and axes is pairs[-1][0] else "frequency [Hz]")
    if not page:
        for motion, density in pairs:
            motion.set_xlabel("time [s]")
            density.set_xlabel("frequency [Hz]")
    legend_above(figure, [axes for axes, _ in pairs])
    more = f"the {len(parts)} of {count} elastic parts that deflect most" if count > len(parts) else ""
    footnote(
        figure,
        "dotted: natural frequency with the hub held",
        more,
        too_short(every),
        left_out(every, drawn, "without flexible links"),
    )
    return figure


def _largest(runs: Sequence[LabelledRun], most: int) -> tuple[list[str], int]:
    """Return the parts that deflect most, sliding and turning ones in turn, and how many there are."""
    peaks: dict[bool, dict[str, float]] = {True: {}, False: {}}
    for run in runs:
        found = np.asarray(run.data["peak_deflection"].values, dtype=float)
        for (name, one), peak in zip(elastic_parts_of(run.data).items(), found, strict=True):
            kind = peaks[bool(one["slides"])]
            kind[name] = max(kind.get(name, 0.0), float(peak))
    ranked = [sorted(kind, key=lambda name, kind=kind: -kind[name]) for kind in peaks.values()]  # type: ignore[misc]
    chosen: list[str] = []
    for place in range(max(map(len, ranked))):
        chosen += [kind[place] for kind in ranked if place < len(kind)]
    order = list(dict.fromkeys(name for run in runs for name in elastic_parts_of(run.data)))
    return sorted(chosen[:most], key=order.index), len(order)


def _deflections(run: LabelledRun, parts: Sequence[str]) -> list[Array]:
    return [_deflection(run, part) for part in parts if part in elastic_parts_of(run.data)]


def _deflection(run: LabelledRun, part: str) -> Array:
    return run.values("deflection", elastic_part=part)


def _motion(
    axes: Axes, runs: Sequence[LabelledRun], looks: Sequence[dict[str, Any]], part: str, slides: bool
) -> None:
    """Draw deflections over time."""
    largest = max(float(np.abs(_deflection(run, part)).max()) for run in runs)
    factor, printed = prefixed("m" if slides else "rad", largest)
    for run, look in zip(runs, looks, strict=True):
        deflection = factor * _deflection(run, part)
        axes.plot(run.time, deflection, label=run.legend, rasterized=run.many, **look)
    axes.set_ylabel(f"deflection [{printed}]")
    few_ticks(axes, 5)


def _spectra(
    axes: Axes,
    runs: Sequence[LabelledRun],
    looks: Sequence[dict[str, Any]],
    part: str,
    frequencies: Sequence[float],
) -> None:
    """Draw amplitude densities of deflections, and natural frequencies."""
    top, ends = 0.0, []
    for run, look in zip(runs, looks, strict=True):
        found = _density(run, part)
        if found is None:
            continue
        frequency, density = found
        axes.plot(frequency, density, **look)
        top = max(top, float(density.max(initial=0.0)))
        ends.append((float(frequency[0]), float(frequency[-1])))
    for own in sorted(set(frequencies)):
        axes.axvline(own, color="#666666", linewidth=0.7, linestyle=":")
    axes.set_xscale("log")
    axes.set_yscale("log")
    if top > 0.0:
        high = 10.0 ** np.ceil(np.log10(1.2 * top))
        axes.set_ylim(high / 10.0**_DECADES, high)
        # Up to ten times the frequency: what is above moves the part no more.
        last = min(max(end for _, end in ends), 10.0 * max(frequencies))
        axes.set_xlim(min(start for start, _ in ends), max(last, 2.0 * min(start for start, _ in ends)))
    else:
        axes.text(0.5, 0.5, "no motion, or fewer than 16 samples", transform=axes.transAxes, ha="center")
    axes.yaxis.set_major_locator(LogLocator(numticks=5))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_minor_formatter(NullFormatter())
    slides = elastic_parts_of(runs[0].data)[part]["slides"]
    axes.set_ylabel(f"density [{'m' if slides else 'rad'}/√Hz]")


def _density(run: LabelledRun, part: str) -> tuple[Array, Array] | None:
    """Return frequencies [Hz] and amplitude densities of a part's deflection; None of too few samples."""
    run = run.whole
    values = _deflection(run, part)
    for segment in (0.5 * float(run.time[-1] - run.time[0]), None):
        try:
            found = spectrum(run.time, values, segment=segment)
        except AntennaPinError:  # too few samples
            continue
        frequency = np.asarray(found["frequency"].values, dtype=float)
        density = np.asarray(found["density"].values, dtype=float)
        return frequency[frequency > 0.0], density[frequency > 0.0]
    return None


FIGURES = (
    RunFigure(
        name="deflection",
        title="Deflections of flexible links",
        function=figure_deflection,
        needs=FLEXIBLE,
    ),
)
