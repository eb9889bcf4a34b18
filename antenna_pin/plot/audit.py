"""Energy and momentum audits of runs: where the work went, and by how little the books fail to close."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from antenna_pin.base.arguments import takes
from antenna_pin.plot._kinds import FREE_BASE, none_with
from antenna_pin.plot._layout import blocks, without_empty
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, labelled, too_short
from antenna_pin.plot._style import (
    COLOURS,
    IDEAL,
    Array,
    Width,
    distinct,
    few_ticks,
    footnote,
    legend_above,
    new_figure,
    panel_title,
    prefixed,
    styled,
)
from antenna_pin.plot._thinned import Columns, thinned

# Below this an error is round-off of round-off; the logarithmic scale ends there.
_FLOOR = 1e-18

_STORED = (
    ("drive_work", "work of the drives", "black"),
    ("force_work", "work of forces", COLOURS[1]),
    ("kinetic_energy", "kinetic energy", COLOURS[0]),
    ("gravity_energy", "gravity, from the start", COLOURS[2]),
    ("spring_energy", "springs", COLOURS[4]),
    ("contact_energy", "elastic energy of the contacts", COLOURS[5]),
    ("elastic_energy", "elastic energy of flexible links", COLOURS[3]),
)
_LOST = (
    ("dissipation_normal", "lost in normal contact", COLOURS[1]),
    ("dissipation_friction", "lost in friction", COLOURS[3]),
    ("dissipation_damper", "lost in dampers and friction of joints", "#7F7F7F"),
    ("dissipation_elastic", "lost in flexible links", COLOURS[5]),
    ("element_loss", "lost in stops, latches and the like", COLOURS[4]),
    ("force_loss", "lost in elements on links", COLOURS[2]),
)

_MOMENTA = (("linear_momentum", "momentum_scale"), ("angular_momentum", "angular_momentum_scale"))


@takes()
@styled
def figure_energy(runs: Iterable[Run] | Run, *, width: Width = "page") -> Figure:
    """Return the energy ledger of each run: work and stored energy, losses, and the error of their balance.

    Gravity's energy is drawn from its start, since its zero is a matter of choice. Of the error, the largest
    so far is drawn, relative to the drives' gross work over the run, the integral of the
    absolute power.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every = labelled(runs)
    drawn = [thinned(run, _ledger) for run in every if run.time.size > 1]
    figure, grid, letter = blocks(len(drawn), [True] * 3, width, 38.0)
    titles = ("energy", "losses", "largest error so far")
    none: dict[str, list[str]] = {}
    for row, parts in enumerate((_STORED, _LOST)):
        books = [{entry[0]: _total(run, entry[0]) for entry in parts} for run in drawn]
        for book in books:
            if "gravity_energy" in book:
                book["gravity_energy"] = book["gravity_energy"] - book["gravity_energy"][0]
        largest = max(float(np.nanmax(np.abs(v), initial=0.0)) for book in books for v in book.values())
        factor, printed = prefixed("J", largest)
        for axes, run, book in zip(grid[row], drawn, books, strict=True):
            if axes.get_subplotspec().is_first_col():  # type: ignore[union-attr]
                axes.set_ylabel(f"energy [{printed}]")
            for name, label, colour in parts:
                if np.any(book[name]):
                    style = {**IDEAL, "zorder": 3} if colour == "black" else {"color": colour}
                    axes.plot(run.time, factor * book[name], label=label, **style)
            if not any(np.any(v) for v in book.values()):
                none.setdefault(titles[row], []).append(run.label)
                continue
            axes.set_xlim(run.time[0], run.time[-1])
            few_ticks(axes, 5)
    for axes, run in zip(grid[2], drawn, strict=True):
        # A run without drives has its largest energy as the measure.
        gross = sum(float(_total(run, name)[-1]) for name in ("drive_gross_work", "force_gross_work"))
        reference = gross if gross > 0.0 else float(np.nanmax(_total(run, "kinetic_energy"), initial=0.0))
        error = np.abs(run.values("energy_error")) / (reference or 1.0)
        _log_line(axes, run, error, {"linewidth": 0.7, "color": COLOURS[0]}, "")
        if axes.get_subplotspec().is_first_col():  # type: ignore[union-attr]
            axes.set_ylabel("error / gross work [-]" if gross > 0.0 else "error / largest energy [-]")
        axes.set_xlabel("time [s]")
        few_ticks(axes, 5)
    _share_decades(grid[2])
    for panels, title in zip(grid, titles, strict=True):
        for axes, run in zip(panels, drawn, strict=True):
            if axes.lines:
                panel_title(axes, letter[axes], f"{run.label}, {title}")
    without_empty(figure)
    figure.align_ylabels()
    legend_above(figure, figure.axes)
    footnote(figure, *(f"no {what}: {', '.join(names)}" for what, names in none.items()), too_short(every))
    return figure


@takes()
@styled
def figure_momentum(runs: Iterable[Run] | Run, *, width: Width = "page") -> Figure:
    """Return the drift of linear and angular momentum of all runs with a free base.

    Drawn is the largest change so far, relative to the largest sum, over the run, of the momentum magnitudes
    of the bodies other than the base: the whole system's own momentum may be zero. What forces on links have
    brought in, by their impulses, is taken off.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every = labelled(runs)
    drawn = [
        thinned(run, _drifting(run)) for run in every if run.time.size > 1 and "base_position" in run.data
    ]
    if not drawn:
        raise none_with(FREE_BASE, every)
    page = width == "page"
    figure = new_figure(width, 66.0 if page else 110.0)
    panels = figure.subplots(1 if page else 2, 2 if page else 1, sharey=True, squeeze=False).ravel()
    for letter, axes, (name, scale_name) in zip("ab", panels, _MOMENTA, strict=True):
        for run, look in zip(drawn, _looks(drawn), strict=True):
            momentum = _kept(run, name)
            scale = float(np.nanmax(run.values(scale_name), initial=0.0))
            drift = np.linalg.norm(momentum - momentum[0], axis=1) / (scale or 1.0)
            _log_line(axes, run, drift, look, run.legend)
        panel_title(axes, letter, name.replace("_", " "))
        axes.set_xlabel("time [s]")
        few_ticks(axes, 6)
    for axes in panels[:1] if page else panels:
        axes.set_ylabel("largest relative drift so far [-]")
    _share_decades(list(panels))
    legend_above(figure, figure.axes)
    fixed = [run.label for run in every if "base_position" not in run.data]
    footnote(
        figure,
        too_short(every),
        f"fixed base, momentum not conserved: {', '.join(fixed)}" if fixed else "",
    )
    return figure


def _kept(run: LabelledRun, name: str) -> Array:
    """Return a momentum without what forces on links have brought in, (n, 3)."""
    impulse = {"linear_momentum": "force_impulse", "angular_momentum": "force_central_impulse"}[name]
    momentum = run.values(name)
    return momentum - run.values(impulse).sum(axis=1) if impulse in run.data else momentum


def _drifting(run: LabelledRun) -> Columns:
    """Return what tells how far momenta have come from those at a run's start."""
    start = replace(run, data=run.data.isel(time=slice(0, 1)))

    def columns(part: LabelledRun) -> list[Array]:
        found = []
        for name, scale in _MOMENTA:
            found += [np.linalg.norm(_kept(part, name) - _kept(start, name), axis=1), part.values(scale)]
        return found

    return columns


def _ledger(run: LabelledRun) -> list[Array]:
    """Return all entries of the energy ledger, and the size of its error [J]."""
    entries = [_total(run, name) for name, _, _ in (*_STORED, *_LOST)]
    return [*entries, np.abs(run.values("energy_error"))]


def _total(run: LabelledRun, name: str) -> Array:
    """Return a ledger entry over time [J], summed over drives, springs or contacts; zeros if absent."""
    if name not in run.data:
        return np.zeros(run.time.size)
    values = run.values(name)
    return values if values.ndim == 1 else np.asarray(values.sum(axis=1), dtype=float)


def _log_line(axes: Axes, run: LabelledRun, value: Array, style: dict[str, Any], label: str) -> None:
    """Draw the largest of the values so far on a logarithmic scale; exact zeros lie on its floor."""
    many = run.many
    so_far = np.fmax.accumulate(np.maximum(value, _FLOOR))
    axes.plot(run.time, so_far, label=label or None, rasterized=many, **style)
    axes.set_yscale("log")


def _share_decades(panels: list[Axes]) -> None:
    """Give logarithmic panels the same whole decades, at most some seven of them with a tick."""
    values = np.concatenate([np.asarray(line.get_ydata()) for axes in panels for line in axes.lines])
    values = values[np.isfinite(values) & (values > _FLOOR)]
    if not values.size:
        return
    low = max(int(np.floor(np.log10(np.quantile(values, 0.02)))), -18)
    high = int(np.floor(np.log10(values.max()))) + 1
    for axes in panels:
        axes.set_ylim(10.0 ** min(low, high - 2), 10.0**high)
        axes.yaxis.set_major_locator(LogLocator(numticks=7))
        axes.yaxis.set_minor_locator(NullLocator())


def _looks(runs: list[LabelledRun]) -> list[dict[str, Any]]:
    """Return the look of each run's line: that of ideal runs for all that are."""
    numbers = itertools.count()
    return [IDEAL if run.ideal else {**distinct(next(numbers)), "linewidth": 0.7} for run in runs]


FIGURES = (
    RunFigure(
        name="energy", title="Energy: work, storage and losses", function=figure_energy, compares=False
    ),
    RunFigure(name="momentum", title="Drift of momentum", function=figure_momentum, needs=FREE_BASE),
)
