"""What a shaken base makes of what it carries: responses to sweeps, densities, shock spectra."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullLocator

from antenna_pin.analysis import (
    base_quantity,
    power_density,
    quantity,
    shaken_target,
    shakes_of,
    shock_spectrum,
    swept_response,
)
from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import printed_unit
from antenna_pin.elements import density_at
from antenna_pin.plot._kinds import RANDOM, SHAKEN, SWEPT, RunKind, none_with
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, labelled, left_out, long_enough, styles, too_short
from antenna_pin.plot._style import (
    COLOURS,
    Width,
    footnote,
    legend_above,
    letters,
    new_figure,
    panel_title,
    styled,
)

__all__ = ["FIGURES", "figure_density", "figure_shock", "figure_swept"]

# What is this much smaller than the largest is not drawn [decades].
_DECADES = 7


def _drawn(runs: Iterable[Run] | Run, kind: RunKind) -> tuple[list[LabelledRun], list[LabelledRun]]:
    """Return all runs, and those of a kind."""
    every = labelled(runs)
    drawn = [run for run in long_enough(every) if kind.holds(run)]
    if not drawn:
        raise none_with(kind, every)
    return every, drawn


@takes()
@styled
def figure_swept(
    runs: Iterable[Run] | Run,
    target: str | None = None,
    *,
    linear: xr.Dataset | None = None,
    periods: float = 10.0,
    width: Width = "page",
) -> Figure:
    """Return gain and distortion over frequency of what a swept base makes, a colour for each run.

    The way up is a full line, the way down a dashed one: where they differ, play or friction makes the answer
    depend on what was before.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        target: Name of a quantity; the acceleration of the URDF's last link if left out.
        linear: Response of small motions beside it (:func:`antenna_pin.linear.frequency_response`), of its
            first target.
        periods: Length of the windows [periods].
        width: "column" (88 mm) or "page" (180 mm).
    """
    every, drawn = _drawn(runs, SWEPT)
    figure = new_figure(width, 100.0)
    panels = figure.subplots(2, 1, sharex=True, height_ratios=[1.6, 1.0])
    name, unit = "", ""
    for run, look in zip(drawn, styles(drawn, None), strict=True):
        found = swept_response(run.data, target or shaken_target(run.data), periods=periods)
        name, unit = str(found.attrs["target"]), str(found["gain"].attrs["units"])
        _lines(panels, found, run, look)
    if linear is not None:
        gain = np.abs(np.asarray(linear["response"].values[:, 0]))
        look = {"color": "#777777", "linewidth": 0.7, "zorder": 0.8}
        panels[0].plot(linear["frequency"].values, gain, label="small motions", **look)
        name = name or str(linear["target"].values[0])
    panels[0].set_yscale("log")
    _plain(panels[0].yaxis)
    panels[0].set_ylabel(f"gain [{printed_unit(_ratio(unit)) or '-'}]")
    panels[1].set_ylabel("distortion [%]")
    panels[1].set_ylim(bottom=0.0)
    _frequencies(panels[1])
    letter = letters()
    panel_title(panels[0], next(letter), name)
    panel_title(panels[1], next(letter), "what does not follow the sweep, over what does")
    legend_above(figure, panels)
    footnote(
        figure,
        "over the base's acceleration; full: swept up, dashed: down",
        too_short(every),
        left_out(every, drawn, f"without {SWEPT.words}"),
    )
    return figure


def _lines(panels: Sequence[Axes], found: xr.Dataset, run: LabelledRun, look: dict[str, Any]) -> None:
    """Draw the ways up and down of one response."""
    for way, line in ((1, "-"), (-1, "--")):
        here = np.asarray(found["way"].values) == way
        if not here.any():
            continue
        order = np.argsort(found["frequency"].values[here], kind="stable")
        frequency = np.asarray(found["frequency"].values)[here][order]
        label = run.legend if way == 1 or not (found["way"].values == 1).any() else None
        own = {**look, "linestyle": line}
        panels[0].plot(frequency, np.asarray(found["gain"].values)[here][order], label=label, **own)
        panels[1].plot(frequency, 100.0 * np.asarray(found["distortion"].values)[here][order], **own)


def _ratio(unit: str) -> str:
    """Return the unit of a ratio; none of two accelerations."""
    return "" if unit == "(m/s^2)/(m/s^2)" else unit


def _frequencies(axes: Axes) -> None:
    axes.set_xscale("log")
    axes.set_xlabel("frequency [Hz]")
    _plain(axes.xaxis)


def _plain(axis: Axis) -> None:
    """Let a logarithmic axis have plain numbers: 1, 2 and 5 of decades, or even ones of less than one."""
    low, high = axis.get_view_interval()
    decade = high > 10.0 * low > 0.0
    axis.set_major_locator(
        LogLocator(subs=(1.0, 2.0, 5.0)) if decade else MaxNLocator(7, steps=[1, 2, 5, 10])
    )
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_locator(NullLocator())


@takes()
@styled
def figure_density(
    runs: Iterable[Run] | Run,
    target: str | None = None,
    *,
    segment: float | None = None,
    width: Width = "page",
) -> Figure:
    """Return power spectral densities of what a base shaken at random makes, with 95 % confidence.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        target: Name of a quantity; the acceleration of the URDF's last link if left out.
        segment: Length of a window [s]; an eighth of the run if left out.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every, drawn = _drawn(runs, RANDOM)
    figure = new_figure(width, 80.0)
    axes = figure.add_subplot()
    top, name, unit = 0.0, "", ""
    for k, run in enumerate(drawn):
        one = quantity(run.data, target or shaken_target(run.data))
        found = power_density(one.time, one.values, segment=segment, units=one.units)
        frequency, power, low, high = (
            np.asarray(found[key].values)[1:] for key in ("frequency", "power", "lower", "upper")
        )
        colour = COLOURS[k % len(COLOURS)]
        axes.fill_between(frequency, low, high, color=colour, alpha=0.2, linewidth=0.0)
        axes.plot(frequency, power, color=colour, linewidth=0.8, label=run.legend)
        top, name, unit = max(top, float(high.max())), one.name, str(found["power"].attrs["units"])
    _prescribed(axes, drawn[0])
    axes.set_yscale("log")
    axes.set_ylim(top / 10.0**_DECADES, 2.0 * top)
    axes.set_ylabel(f"density [{printed_unit(unit)}]")
    _frequencies(axes)
    panel_title(axes, "", name)
    legend_above(figure, [axes])
    footnote(
        figure,
        "shaded: interval of 95 % confidence",
        too_short(every),
        left_out(every, drawn, f"without {RANDOM.words}"),
    )
    return figure


def _prescribed(axes: Axes, run: LabelledRun) -> None:
    """Draw the density that the base of a run was asked for."""
    for one in shakes_of(run.data).values():
        about = one["shakes"]
        if "density" in about:
            at, given = tuple(about["frequency"]), tuple(about["density"])
            frequency = np.geomspace(at[0], at[-1], 200)
            frequency[0], frequency[-1] = at[0], at[-1]
            look: dict[str, Any] = {"color": "#555555", "linestyle": ":", "linewidth": 1.0}
            axes.plot(frequency, density_at(frequency, at, given), label="asked of the base", **look)
            return


@takes()
@styled
def figure_shock(
    runs: Iterable[Run] | Run,
    target: str | None = None,
    *,
    quality: float = 10.0,
    width: Width = "page",
) -> Figure:
    """Return shock response spectra of an acceleration: the largest of an oscillator, over its frequency.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        target: Name of a quantity; the acceleration of the URDF's last link if left out.
        quality: Q of the oscillators.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every, drawn = _drawn(runs, SHAKEN)
    figure = new_figure(width, 80.0)
    axes = figure.add_subplot()
    name, unit = "", ""
    for run, look in zip(drawn, styles(drawn, None), strict=True):
        one = quantity(run.data, target or shaken_target(run.data))
        found = shock_spectrum(one.time, one.values, quality=quality, units=one.units)
        axes.plot(found["frequency"].values, found["maximum"].values, label=run.legend, **look)
        name, unit = one.name, one.units
    base = quantity(drawn[0].data, base_quantity(drawn[0].data))
    if base.name != name:
        found = shock_spectrum(base.time, base.values, quality=quality, units=base.units)
        look = {"color": "#555555", "linestyle": ":", "linewidth": 1.0}
        axes.plot(found["frequency"].values, found["maximum"].values, label="base", **look)
    axes.set_yscale("log")
    axes.set_ylabel(f"largest acceleration [{printed_unit(unit)}]")
    _frequencies(axes)
    axes.set_xlabel("natural frequency [Hz]")
    panel_title(axes, "", f"{name}, Q = {quality:g}")
    legend_above(figure, [axes])
    footnote(figure, too_short(every), left_out(every, drawn, f"without {SHAKEN.words}"))
    return figure


FIGURES = (
    RunFigure(
        name="swept_response",
        title="Response to the swept base",
        function=figure_swept,
        needs=SWEPT,
        compares=False,
    ),
    RunFigure(
        name="random_density",
        title="Power spectral density on the shaken base",
        function=figure_density,
        needs=RANDOM,
        compares=False,
    ),
    RunFigure(
        name="shock_spectrum",
        title="Shock response spectrum on the shaken base",
        function=figure_shock,
        needs=SHAKEN,
        compares=False,
        standard=False,
        reported=False,
    ),
)
