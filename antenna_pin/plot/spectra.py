"""What frequencies the accelerations and the joint's force hold, over all the run and as it goes on."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Literal, NamedTuple

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, NullLocator

from antenna_pin.analysis import (
    LONG,
    base_motion,
    joint_loads,
    long_spectrogram,
    long_spectrum,
    spectrogram,
    spectrum,
)
from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import printed_unit
from antenna_pin.errors import AntennaPinError, InvalidParameterError, UnknownNameError
from antenna_pin.plot._kinds import MOVING, choose_joint
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import (
    LabelledRun,
    Run,
    labelled,
    left_out,
    long_enough,
    styles,
    too_short,
    with_reference,
)
from antenna_pin.plot._style import (
    SHADE,
    Array,
    Width,
    few_ticks,
    footnote,
    legend_above,
    letters,
    new_figure,
    panel_title,
    styled,
)
from antenna_pin.plot._thinned import telling

Signal = Literal["acceleration", "base acceleration", "force"]
SIGNALS: tuple[Signal, ...] = ("acceleration", "base acceleration", "force")
_UNITS = {"acceleration": "rad/s^2", "base acceleration": "m/s^2", "force": "N"}

# What is this much smaller than the largest is not drawn [decades of the density].
_SPECTRUM_DECADES = 8
_SPECTROGRAM_DECADES = 5
# Above this share of the sample rate impacts are not resolved by the samples.
_RESOLVED = 0.2
_ABOVE = "above a fifth of the sample rate, impacts not resolved"


class _Density(NamedTuple):
    """Amplitude density of one signal of one run."""

    run: LabelledRun
    frequency: Array  # [Hz]
    density: Array  # [unit/sqrt(Hz)]
    rate: float  # [Hz]
    window: str = ""  # of a long run: which windows it is the mean over


@takes()
@styled
def figure_spectra(
    runs: Iterable[Run] | Run,
    *,
    joint: str | None = None,
    ideal: Run | None = None,
    width: Width = "page",
) -> Figure:
    """Return the amplitude densities of the joint's and the base's acceleration and of the joint's force.

    Of a vector, the root of the sum over its components. The mean over three windows, half of the run each;
    of a run of fewer than 32 samples one, all of it. Above a fifth of the sample rate, shaded, samples do not
    resolve impacts.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        joint: Name of the joint; the first one with clearance if left out.
        ideal: The run whose line is black and dashed; the first without any contact if left out.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every, reference = with_reference(runs, ideal)
    joint = choose_joint(MOVING, every, joint)
    drawn = sorted(long_enough(every), key=lambda run: run is reference)
    looks = dict(zip([run.label for run in drawn], styles(drawn, reference), strict=True))
    found = {kind: _densities(drawn, kind, joint) for kind in SIGNALS}
    kinds = [kind for kind in SIGNALS if found[kind]]
    if not kinds:
        raise InvalidParameterError(
            "figure", "runs", "at least one run of 16 samples or more", ", ".join(run.label for run in every)
        )
    page = width == "page"
    figure = new_figure(width, 66.0 if page else 12.0 + 46.0 * len(kinds))
    panels = figure.subplots(1 if page else len(kinds), len(kinds) if page else 1, squeeze=False).ravel()
    for letter, axes, kind in zip(letters(), panels, kinds, strict=False):
        largest = max(float(each.density.max()) for each in found[kind])
        for each in found[kind]:
            axes.plot(each.frequency, each.density, label=each.run.legend, **looks[each.run.label])
        rate = max(each.rate for each in found[kind])
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlim(min(float(each.frequency[0]) for each in found[kind]), 0.5 * rate)
        top = 10.0 ** np.ceil(np.log10(1.2 * largest))
        axes.set_ylim(top / 10.0**_SPECTRUM_DECADES, top)
        axes.yaxis.set_major_locator(LogLocator(numticks=6))
        axes.yaxis.set_minor_locator(NullLocator())
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.axvspan(_RESOLVED * rate, 0.5 * rate, facecolor=SHADE, zorder=0.5)
        panel_title(axes, letter if len(kinds) > 1 else "", _words(kind, joint))
        axes.set_ylabel(_label(kind))
        if page or axes is panels[-1]:
            axes.set_xlabel("frequency [Hz]")
    legend_above(figure, panels)
    drawn_ones = [each.run for kind in kinds for each in found[kind]]
    footnote(
        figure,
        f"shaded: {_ABOVE}",
        "; ".join(dict.fromkeys(each.window for kind in kinds for each in found[kind] if each.window)),
        too_short(every),
        left_out(every, drawn_ones, "no such signal or fewer than 16 samples"),
    )
    return figure


@takes()
@styled
def figure_spectrogram(
    runs: Iterable[Run] | Run,
    signal: Signal | None = None,
    *,
    joint: str | None = None,
    width: Width = "page",
) -> Figure:
    """Return how the spectral density of a signal changes over the run, one panel per run with contact.

    Runs without any contact are drawn if there is no other. What samples do not resolve of impacts, above a
    fifth of the sample rate, is not drawn.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        signal: "acceleration" of the joint, "base acceleration", or "force" through the joint; if left out
            the acceleration, or the force of a joint that turns in no run about an axis, such as a ball's.
        joint: Name of the joint; the first one with clearance if left out.
        width: "column" (88 mm) or "page" (180 mm).
    """
    if signal is not None and signal not in SIGNALS:
        raise UnknownNameError("figure", "signal", signal, SIGNALS)
    every = labelled(runs)
    joint = choose_joint(MOVING, every, joint)
    if signal is None:
        signal = "acceleration" if any(joint in run.joints for run in every) else "force"
    candidates = [run for run in long_enough(every) if not run.ideal] or long_enough(every)
    drawn, maps, windows = [], [], []
    for run in candidates:
        if run.time.size > LONG:
            read = _reader(run, signal, joint)
            if read is None:
                continue
            of_long = long_spectrogram(run.time, read)
            drawn.append(run)
            maps.append(
                (*(of_long[name].values for name in ("time", "frequency")), np.sqrt(of_long["power"].values))
            )
            windows.append(_windows(run, of_long, " around each instant"))
            continue
        values = _signal(run, signal, joint)
        try:
            parts = [] if values is None else [_spectrogram(run, part) for part in values.T]
        except AntennaPinError:  # too few samples
            parts = []
        if parts:
            drawn.append(run)
            power = sum(np.asarray(part["power"].values) for part in parts)
            maps.append((parts[0]["time"].values, parts[0]["frequency"].values, np.sqrt(power)))
    if not drawn:
        rule = f"at least one of 64 samples or more with {_words(signal, joint)}"
        raise InvalidParameterError("figure", "runs", rule, ", ".join(run.label for run in every))
    columns = min(len(drawn), 3 if width == "page" else 1)
    rows = -(-len(drawn) // columns)
    figure = new_figure(width, 8.0 + rows * 52.0)
    panels = list(figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).ravel())
    for axes in panels[len(drawn) :]:
        axes.remove()
    largest = max(float(density.max()) for _, _, density in maps) or 1.0
    norm = LogNorm(largest / 10.0**_SPECTROGRAM_DECADES, largest)
    colours = matplotlib.colormaps["Blues"]  # none is white, much is dark
    for letter, axes, run, (time, frequency, density) in zip(letters(), panels, drawn, maps, strict=False):
        known = frequency <= 2.0 * _RESOLVED * frequency[-1]  # the last is half the sample rate
        frequency, shown = frequency[known], np.maximum(density[known], float(norm.vmin or 0.0))
        axes.set_ylim(0.0, frequency[-1])
        axes.pcolormesh(time, frequency, shown, norm=norm, cmap=colours, shading="nearest", rasterized=True)
        axes.grid(visible=False)
        axes.set_xlim(time[0], time[-1])
        few_ticks(axes, 5)
        panel_title(axes, letter if len(drawn) > 1 else "", f"{run.label}, {_words(signal, joint)}")
        place = axes.get_subplotspec()
        if place is not None and place.is_first_col():
            axes.set_ylabel("frequency [Hz]")
        if panels.index(axes) + columns >= len(drawn):
            axes.set_xlabel("time [s]")
            axes.tick_params(labelbottom=True)
    bar = figure.colorbar(
        ScalarMappable(norm, colours),
        ax=panels[: len(drawn)],
        label=_label(signal),
        aspect=30.0 * rows,
        pad=0.02,
    )
    bar.outline.set_linewidth(0.4)
    footnote(
        figure,
        f"not drawn: {_ABOVE}",
        *windows,
        too_short(every),
        left_out(candidates, drawn, "no such signal or fewer than 64 samples"),
    )
    return figure


def _spectrum(run: LabelledRun, values: Array) -> xr.Dataset:
    """Return the spectrum of a signal, of a short run in one window."""
    try:
        return spectrum(run.time, values, segment=0.5 * float(run.time[-1] - run.time[0]))
    except AntennaPinError:
        return spectrum(run.time, values)


def _spectrogram(run: LabelledRun, values: Array) -> xr.Dataset:
    """Return the spectrogram of a signal, in windows of a fortieth of the run; of a short run in longer."""
    span = float(run.time[-1] - run.time[0])
    for share in (0.025, 0.05):
        with contextlib.suppress(AntennaPinError):
            return spectrogram(run.time, values, segment=share * span)
    return spectrogram(run.time, values, segment=0.25 * span)


def _label(kind: Signal) -> str:
    unit = printed_unit(_UNITS[kind])
    return f"density [({unit})/√Hz]" if "/" in unit else f"density [{unit}/√Hz]"


def _words(kind: Signal, joint: str) -> str:
    """Return what a signal is called."""
    name = joint.replace("_", " ")
    return {"acceleration": f"{name} acceleration", "force": f"force through {name}"}.get(kind, kind)


def _signal(run: LabelledRun, kind: Signal, joint: str) -> Array | None:
    """Return the values of a signal, (n, components); None if the run does not have it."""
    if kind == "acceleration":
        if joint not in run.joints:
            return None
        return run.values("motion_acceleration", joint=joint)[:, None]
    if kind == "base acceleration":
        if "base_position" not in run.data:
            return None
        return np.asarray(base_motion(run.data)["acceleration"].values, dtype=float)
    loads = joint_loads(run.data)["force"]
    if joint not in loads["moving_joint"]:
        return None
    return np.asarray(loads.sel(moving_joint=joint).values, dtype=float)


def _densities(runs: Sequence[LabelledRun], kind: Signal, joint: str) -> list[_Density]:
    """Return the densities of a signal of the runs that have it and are long enough."""
    result = []
    for run in runs:
        if run.time.size > LONG:
            read = _reader(run, kind, joint)
            if read is not None:
                result += _long_density(run, long_spectrum(run.time, read))
            continue
        values = _signal(run, kind, joint)
        if values is None or not np.any(values):
            continue
        try:
            found = _spectrum(run, values)
        except AntennaPinError:  # too few samples
            continue
        frequency = np.asarray(found["frequency"].values, dtype=float)
        density = np.sqrt(np.asarray(found["power"].values, dtype=float).sum(axis=1))
        keep = frequency > 0.0
        result.append(_Density(run, frequency[keep], density[keep], float(found.attrs["rate"])))
    return result


def _reader(run: LabelledRun, kind: Signal, joint: str) -> Callable[[int, int], Array] | None:
    """Return what reads a signal of a long run from one sample up to another; None if it has no such."""

    def read(first: int, last: int) -> Array:
        found = _signal(replace(run, data=run.data.isel(time=slice(first, last))), kind, joint)
        assert found is not None
        return found

    return None if _signal(replace(run, data=run.data.isel(time=[0])), kind, joint) is None else read


def _long_density(run: LabelledRun, found: xr.Dataset) -> list[_Density]:
    """Return the density of a long run as a list of one; of none if it is zero throughout.

    Of the frequencies in each of 4096 equal parts of the logarithmic axis those with the least and the
    largest density are kept: a line of more has no room.
    """
    frequency = np.asarray(found["frequency"].values, dtype=float)[1:]
    density = np.sqrt(np.asarray(found["power"].values, dtype=float).sum(axis=1))[1:]
    if not density.any():
        return []
    kept = telling(np.log(frequency), density)
    return [_Density(run, frequency[kept], density[kept], float(found.attrs["rate"]), _windows(run, found))]


def _windows(run: LabelledRun, found: xr.Dataset, where: str = "") -> str:
    """Return a note on the windows of a long run's spectrum."""
    segment, count = found.attrs["segment"], found.attrs["segments"]
    return f"{run.label}: mean over the windows of {segment:.3g} s{where}, {count} in all"


FIGURES = (
    RunFigure(name="spectra", title="Spectra, {joint}", function=figure_spectra, of=MOVING),
    RunFigure(
        name="spectrogram",
        title="Spectrogram, {joint}",
        function=figure_spectrogram,
        of=MOVING,
        compares=False,
        reported=False,
    ),
)
