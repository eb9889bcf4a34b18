"""Spectra of runs, responses to a shaken base, and frequency responses."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, Literal, NamedTuple, get_args

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm

from antenna_pin.analysis import (
    LONG,
    base_motion,
    base_quantity,
    joint_loads,
    long_spectrogram,
    long_spectrum,
    power_density,
    quantity,
    shaken_target,
    shakes_of,
    shock_spectrum,
    spectrogram,
    swept_response,
)
from antenna_pin.base.readable import printed_unit
from antenna_pin.elements import density_at
from antenna_pin.errors import AntennaPinError, UnknownNameError
from antenna_pin.show.plot._compared import pick
from antenna_pin.show.plot._kinds import MOVING, RANDOM, SHAKEN, SWEPT, RunFigure, refusal
from antenna_pin.show.plot._runs import LabelledRun, Run, Runs, left_out, spectrum_of, too_short, unit_of
from antenna_pin.show.plot._style import COLOURS, SHADE, Array, Width
from antenna_pin.show.plot._thinned import telling
from antenna_pin.show.plot.grammar import (
    TIME,
    Axis,
    Band,
    ByHand,
    Ground,
    Panel,
    PlotCurve,
    PlotMark,
    Rule,
    Sheet,
    figure,
    in_rows,
)

Signal = Literal["acceleration", "base acceleration", "force"]
SIGNALS: tuple[Signal, ...] = get_args(Signal)
# Of each signal the variable with its unit.
_VARIABLES = {
    "acceleration": "motion_acceleration",
    "base acceleration": "slide_acceleration",
    "force": "joint_force",
}

# What is this much smaller than the largest is not drawn [decades of the density].
_SPECTRUM_DECADES = 8
_SPECTROGRAM_DECADES = 5
_DENSITY_DECADES = 7
_RESPONSE_DECADES = 8
# Above this share of the sample rate impacts are not resolved by the samples.
_RESOLVED = 0.2
_ABOVE = "above a fifth of the sample rate, impacts not resolved"
_FREQUENCY = Axis("frequency [Hz]", scale="log")


class _Density(NamedTuple):
    """Amplitude density of one signal of one run."""

    run: LabelledRun
    frequency: Array  # [Hz]
    density: Array  # [unit/sqrt(Hz)]
    rate: float  # [Hz]
    window: str = ""  # of a long run: which windows it is the mean over


@figure()
def figure_spectra(
    runs: Runs, *, joint: str | None = None, ideal: Run | None = None, width: Width = "page"
) -> Sheet:
    """Return amplitude densities of the joint's and base's acceleration, and of the joint's force.

    Of a vector, the root of the sum over its components. The mean over three windows, half of the run each;
    of a run of fewer than 32 samples one, all of it. Above a fifth of the sample rate, shaded, samples do not
    resolve impacts.
    """
    picked = pick(runs, ideal=ideal, joint=(MOVING, joint))
    looks = {run.label: look for run, look in picked.styled}
    found = {kind: _densities(picked.drawn, kind, picked.joint) for kind in SIGNALS}
    every = [one for of_kind in found.values() for one in of_kind]
    if not every:
        raise refusal("at least one run of 16 samples or more", picked.every)
    panels = []
    for kind, mine in found.items():
        if not mine:
            continue
        lines = [PlotCurve(one.run.legend, one.frequency, one.density, looks[one.run.label]) for one in mine]
        rate = max(one.rate for one in mine)
        top = 10.0 ** np.ceil(np.log10(1.2 * max(float(one.density.max()) for one in mine)))
        shade = Ground(_RESOLVED * rate, 0.5 * rate, {"facecolor": SHADE, "zorder": 0.5})
        x = replace(_FREQUENCY, limits=(min(float(one.frequency[0]) for one in mine), 0.5 * rate))
        y = Axis(_label(kind), limits=(top / 10.0**_SPECTRUM_DECADES, top), scale="log", ticks=6)
        panels.append(Panel(_words(kind, picked.joint), [*lines, shade], y, x))
    notes = (
        f"shaded: {_ABOVE}",
        "; ".join(dict.fromkeys(one.window for one in every if one.window)),
        too_short(picked.every),
        left_out(picked.every, [one.run for one in every], "no such signal or fewer than 16 samples"),
    )
    if width == "page":
        return Sheet([panels], width, 66.0, notes)
    return Sheet([[one] for one in panels], width, 12.0 + 46.0 * len(panels), notes)


@figure(
    signal='"acceleration" of the joint, "base acceleration", or "force" through the joint; if left out the '
    "acceleration, or the force of a joint that turns in no run about an axis, such as a ball's."
)
def figure_spectrogram(
    runs: Runs, signal: Signal | None = None, *, joint: str | None = None, width: Width = "page"
) -> Sheet:
    """Return the change of a signal's spectral density over each run with contact.

    Runs without any contact are drawn if there is no other. Frequencies above a fifth of the sample rate,
    where samples do not resolve impacts, are not drawn.
    """
    if signal is not None and signal not in SIGNALS:
        raise UnknownNameError("figure", "signal", signal, SIGNALS)
    picked = pick(runs, compared=False, joint=(MOVING, joint))
    name = picked.joint
    turns = any(name in run.joints for run in picked.every)
    kind = signal or ("acceleration" if turns else "force")
    candidates = [run for run in picked.drawn if not run.ideal] or picked.drawn
    drawn, maps, windows = [], [], []
    for run in candidates:
        shown, window = _map(run, kind, name)
        if shown is not None:
            drawn.append(run)
            maps.append(shown)
            windows.append(window)
    if not drawn:
        raise refusal(f"at least one of 64 samples or more with {_words(kind, name)}", picked.every)
    largest = max(float(density.max()) for _, _, density in maps) or 1.0
    norm = LogNorm(largest / 10.0**_SPECTROGRAM_DECADES, largest)
    colours = matplotlib.colormaps["Blues"]  # none is white, much is dark
    panels = []
    for run, (time, frequency, density) in zip(drawn, maps, strict=True):
        known = frequency <= 2.0 * _RESOLVED * frequency[-1]  # the last is half the sample rate
        resolved, values = frequency[known], np.maximum(density[known], float(norm.vmin or 0.0))

        def field(
            axes: Axes, *_: float, time: Array = time, up: Array = resolved, values: Array = values
        ) -> None:
            looks: dict[str, Any] = {"shading": "nearest", "rasterized": True}
            axes.pcolormesh(time, up, values, norm=norm, cmap=colours, **looks)
            axes.grid(visible=False)

        x = replace(TIME, limits=(time[0], time[-1]), shared="time")
        y = Axis("frequency [Hz]", limits=(0.0, resolved[-1]), shared="frequency")
        panels.append(Panel(f"{run.label}, {_words(kind, name)}", [ByHand(field)], y, x))
    rows = in_rows(panels, min(len(drawn), 3 if width == "page" else 1), alone=False)
    bar = (ScalarMappable(norm, colours), _label(kind), {"aspect": 30.0 * len(rows), "pad": 0.02})
    left = left_out(candidates, drawn, "no such signal or fewer than 64 samples")
    notes = (f"not drawn: {_ABOVE}", *windows, too_short(picked.every), left)
    return Sheet(rows, width, 8.0 + 52.0 * len(rows), notes, bar=bar)


def _map(run: LabelledRun, kind: Signal, joint: str) -> tuple[tuple[Array, Array, Array] | None, str]:
    """Return times, frequencies and densities (None without), and a note on windows."""
    if run.time.size > LONG:
        read = _reader(run, kind, joint)
        if read is None:
            return None, ""
        found = long_spectrogram(run.time, read)
        time, frequency = (found[name].values for name in ("time", "frequency"))
        return (time, frequency, np.sqrt(found["power"].values)), _windows(run, found, " around each instant")
    values = _signal(run, kind, joint)
    try:
        parts = [] if values is None else [_spectrogram(run, part) for part in values.T]
    except AntennaPinError:  # too few samples
        parts = []
    if not parts:
        return None, ""
    power = sum(np.asarray(part["power"].values) for part in parts)
    return (parts[0]["time"].values, parts[0]["frequency"].values, np.sqrt(power)), ""


def _spectrogram(run: LabelledRun, values: Array) -> xr.Dataset:
    """Return the spectrogram in windows of a fortieth of the run, or longer."""
    span = float(run.time[-1] - run.time[0])
    for share in (0.025, 0.05):
        with contextlib.suppress(AntennaPinError):
            return spectrogram(run.time, values, segment=share * span)
    return spectrogram(run.time, values, segment=0.25 * span)


def _label(kind: Signal) -> str:
    unit = printed_unit(unit_of(_VARIABLES[kind]))
    return f"density [({unit})/√Hz]" if "/" in unit else f"density [{unit}/√Hz]"


def _words(kind: Signal, joint: str) -> str:
    """Return the name of a signal."""
    name = joint.replace("_", " ")
    return {"acceleration": f"{name} acceleration", "force": f"force through {name}"}.get(kind, kind)


def _signal(run: LabelledRun, kind: Signal, joint: str) -> Array | None:
    """Return the values of a signal, (n, components); None if absent."""
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
    """Return the densities of a signal of long enough runs."""
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
            found = spectrum_of(run, values)
        except AntennaPinError:  # too few samples
            continue
        frequency = np.asarray(found["frequency"].values, dtype=float)
        density = np.sqrt(np.asarray(found["power"].values, dtype=float).sum(axis=1))
        keep = frequency > 0.0
        result.append(_Density(run, frequency[keep], density[keep], float(found.attrs["rate"])))
    return result


def _reader(run: LabelledRun, kind: Signal, joint: str) -> Callable[[int, int], Array] | None:
    """Return a reader of a long run's signal between samples, or None."""

    def read(begin: int, end: int) -> Array:
        found = _signal(replace(run, data=run.data.isel(time=slice(begin, end))), kind, joint)
        assert found is not None
        return found

    return None if _signal(replace(run, data=run.data.isel(time=[0])), kind, joint) is None else read


def _long_density(run: LabelledRun, result: xr.Dataset) -> list[_Density]:
    """Return a long run's density in a list, empty if it is zero throughout.

    In each of 4096 equal parts of the logarithmic axis the frequencies with the least and the
    largest density are stored: a line of more has no room.
    """
    frequency = np.asarray(result["frequency"].values, dtype=float)[1:]
    density = np.sqrt(np.asarray(result["power"].values, dtype=float).sum(axis=1))[1:]
    if not density.any():
        return []
    kept = telling(np.log(frequency), density)
    return [_Density(run, frequency[kept], density[kept], float(result.attrs["rate"]), _windows(run, result))]


def _windows(run: LabelledRun, result: xr.Dataset, where: str = "") -> str:
    """Return a note on the windows of a long run's spectrum."""
    segment, count = result.attrs["segment"], result.attrs["segments"]
    return f"{run.label}: mean over the windows of {segment:.3g} s{where}, {count} in all"


# --- a shaken base ---

_PLAIN = Axis("frequency [Hz]", scale="plain")
_GIVEN: dict[str, Any] = {"color": "#555555", "linestyle": ":", "linewidth": 1.0}
_TARGET = "Name of a quantity; the acceleration of the URDF's last link if left out."


@figure(
    target=_TARGET,
    linear="Response of small motions beside it (:func:`~antenna_pin.studies.linear.frequency_response`), "
    "of its first target.",
    periods="Length of the windows [periods].",
)
def figure_swept(
    runs: Runs,
    target: str | None = None,
    *,
    linear: xr.Dataset | None = None,
    periods: float = 10.0,
    width: Width = "page",
) -> Sheet:
    """Return gain and distortion over frequency on a swept base, a colour for each run.

    The way up is a full line, the way down a dashed one: where they differ, play or friction makes the answer
    depend on what was before.
    """
    picked = pick(runs, SWEPT, compared=False)
    name, unit = "", ""
    gains: list[PlotMark] = []
    distortions: list[PlotMark] = []
    for run, look in picked.styled:
        found = swept_response(run.data, target or shaken_target(run.data), periods=periods)
        name, unit = str(found.attrs["target"]), str(found["gain"].attrs["units"])
        ways = np.asarray(found["way"].values)
        for way, line in ((1, "-"), (-1, "--")):
            here = np.flatnonzero(ways == way)
            if not here.size:
                continue
            order = here[np.argsort(found["frequency"].values[here], kind="stable")]
            frequency, gain, distortion = (
                np.asarray(found[one].values)[order] for one in ("frequency", "gain", "distortion")
            )
            own = {**look, "linestyle": line}
            label = run.legend if way == 1 or not (ways == 1).any() else ""
            gains.append(PlotCurve(label, frequency, gain, own))
            distortions.append(PlotCurve("", frequency, 100.0 * distortion, own))
    if linear is not None:
        look = {"color": "#777777", "linewidth": 0.7, "zorder": 0.8}
        gain = np.abs(np.asarray(linear["response"].values[:, 0]))
        gains.append(PlotCurve("small motions", linear["frequency"].values, gain, look))
        name = name or str(linear["target"].values[0])
    unit = "" if unit == "(m/s^2)/(m/s^2)" else unit
    x = replace(_PLAIN, shared="frequency")
    title, y = (
        "what does not follow the sweep, over what does",
        Axis("distortion [%]", limits=(0.0, None), ticks=0),
    )
    panels = [
        Panel(name, gains, Axis(f"gain [{printed_unit(unit) or '-'}]", scale="plain"), x),
        Panel(title, distortions, y, x),
    ]
    notes = ("over the base's acceleration; full: swept up, dashed: down", *picked.notes)
    return Sheet([[one] for one in panels], width, 100.0, notes, heights=[1.6, 1.0])


@figure(target=_TARGET, segment="Length of a window [s]; an eighth of the run if left out.")
def figure_density(
    runs: Runs, target: str | None = None, *, segment: float | None = None, width: Width = "page"
) -> Sheet:
    """Return power spectral densities on a randomly shaken base, with 95 % confidence."""
    picked = pick(runs, RANDOM, compared=False)
    marks: list[PlotMark] = []
    top, name, unit = 0.0, "", ""
    for k, run in enumerate(picked.drawn):
        one = quantity(run.data, target or shaken_target(run.data))
        found = power_density(one.time, one.values, segment=segment, units=one.units)
        frequency, power, low, high = (
            np.asarray(found[key].values)[1:] for key in ("frequency", "power", "lower", "upper")
        )
        colour = COLOURS[k % len(COLOURS)]
        marks.append(Band(frequency, low, high, {"color": colour, "alpha": 0.2}))
        marks.append(PlotCurve(run.legend, frequency, power, {"color": colour, "linewidth": 0.8}))
        top, name, unit = max(top, float(high.max())), one.name, str(found["power"].attrs["units"])
    marks += _prescribed(picked.drawn[0])
    limits = top / 10.0**_DENSITY_DECADES, 2.0 * top
    y = Axis(f"density [{printed_unit(unit)}]", limits=limits, scale="log", ticks=0)
    notes = ("shaded: interval of 95 % confidence", *picked.notes)
    return Sheet([[Panel(name, marks, y, _PLAIN)]], width, 80.0, notes)


def _prescribed(run: LabelledRun) -> list[PlotCurve]:
    """Return the prescribed density of a run's base."""
    for one in shakes_of(run.data).values():
        about = one["shakes"]
        if "density" in about:
            at, given = tuple(about["frequency"]), tuple(about["density"])
            frequency = np.geomspace(at[0], at[-1], 200)
            frequency[0], frequency[-1] = at[0], at[-1]
            return [PlotCurve("specified for the base", frequency, density_at(frequency, at, given), _GIVEN)]
    return []


@figure(target=_TARGET, quality="Q of the oscillators.")
def figure_shock(
    runs: Runs, target: str | None = None, *, quality: float = 10.0, width: Width = "page"
) -> Sheet:
    """Return shock response spectra: an oscillator's largest acceleration over its frequency."""
    picked = pick(runs, SHAKEN, compared=False)
    every = [
        (run.legend, quantity(run.data, target or shaken_target(run.data)), look)
        for run, look in picked.styled
    ]
    _, last, _ = every[-1]
    base = quantity(picked.drawn[0].data, base_quantity(picked.drawn[0].data))
    if base.name != last.name:
        every.append(("base", base, _GIVEN))
    lines = []
    for label, one, look in every:
        found = shock_spectrum(one.time, one.values, quality=quality, units=one.units)
        lines.append(PlotCurve(label, found["frequency"].values, found["maximum"].values, look))
    y = Axis(f"largest acceleration [{printed_unit(last.units)}]", scale="log", ticks=0)
    x = replace(_PLAIN, label="natural frequency [Hz]")
    panel = Panel(f"{last.name}, Q = {quality:g}", lines, y, x)
    return Sheet([[panel]], width, 80.0, picked.notes)


# --- small motions ---


@figure(response="``response`` over ``frequency`` and ``target``, with ``unit`` of each target.")
def figure_response(response: xr.Dataset, *, width: Width = "page") -> Sheet:
    """Return magnitude and phase of :func:`~antenna_pin.studies.linear.frequency_response`.

    Targets of one unit share a panel of magnitudes; thin lines stand at the undamped natural frequencies.
    """
    frequency = np.asarray(response["frequency"].values)
    ends = float(frequency[0]), float(frequency[-1])
    marks = sorted({float(f) for f in response.attrs["resonances"] if ends[0] <= f <= ends[1]})
    thin = {"color": "#BBBBBB", "linewidth": 0.5, "zorder": 0.6}
    rules: list[PlotMark] = [Rule(mark, thin, "x") for mark in marks]
    x = replace(_PLAIN, limits=ends, shared="frequency")
    of_unit: dict[str, list[PlotCurve]] = {}
    phases = []
    for k, name in enumerate(str(name) for name in response["target"].values):
        values, look = response["response"].values[:, k], {"color": f"C{k}"}
        unit = str(response["unit"].values[k])
        of_unit.setdefault(unit, []).append(PlotCurve(name, frequency, np.abs(values), look))
        phases.append(PlotCurve(name, frequency, np.degrees(_wrapped(values)), look))
    panels = []
    for unit, lines in of_unit.items():
        largest = max(float(one.y.max(initial=0.0)) for one in lines)
        limits = None
        if largest > 0.0:
            lowest = min(float(one.y.min()) for one in lines if one.y.any())
            limits = max(0.5 * lowest, largest / 10.0**_RESPONSE_DECADES), 2.0 * largest
        y = Axis(f"magnitude [{printed_unit(unit)}]", limits=limits, scale="log", ticks=0)
        panels.append(Panel(f"over {response.attrs['source']}", [*lines, *rules], y, x))
    named = {float(n): f"{n}".replace("-", "\N{MINUS SIGN}") for n in (-180, -90, 0, 90, 180)}
    y = Axis("phase [deg]", limits=(-190.0, 190.0), named=named)
    panels.append(Panel("", [*phases, *rules], y, x, lettered=False))
    heights = [1.4] * len(of_unit) + [1.0]
    note = "thin lines: natural frequencies, undamped" if marks else ""
    height = 16.0 + 44.0 * len(of_unit) + 34.0
    return Sheet([[one] for one in panels], width, height, (note,), heights=heights)


def _wrapped(values: Array) -> Array:
    """Return phases in (-pi, pi] that do not join across the jump [rad]."""
    phase = np.angle(values)
    jumps = np.abs(np.diff(phase, prepend=phase[:1])) > np.pi
    return np.where(jumps, np.nan, phase)


FIGURES = (
    RunFigure("spectra", "Spectra, {joint}", figure_spectra, of=MOVING),
    RunFigure(
        "spectrogram", "Spectrogram, {joint}", figure_spectrogram, of=MOVING, compares=False, reported=False
    ),
    *(
        RunFigure(name, title, function, needs=needs, compares=False, standard=standard, reported=standard)
        for name, title, function, needs, standard in (
            ("swept_response", "Response to the swept base", figure_swept, SWEPT, True),
            ("random_density", "Power spectral density on the shaken base", figure_density, RANDOM, True),
            ("shock_spectrum", "Shock response spectrum on the shaken base", figure_shock, SHAKEN, False),
        )
    ),
)
