"""Frequency responses: magnitude and phase over frequency."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import printed_unit
from antenna_pin.plot._style import Width, footnote, legend_above, letters, new_figure, panel_title, styled

# Magnitudes this much below the largest are cut off [decades].
_DECADES = 8


@takes()
@styled
def figure_response(response: xr.Dataset, *, width: Width = "page") -> Figure:
    """Return magnitude and phase of a frequency response (:func:`antenna_pin.linear.frequency_response`).

    Targets of one unit share a panel of magnitudes; thin lines stand at the undamped natural frequencies.

    Args:
        response: ``response`` over ``frequency`` and ``target``, with ``unit`` of each target.
        width: "column" (88 mm) or "page" (180 mm).
    """
    units = list(dict.fromkeys(str(unit) for unit in response["unit"].values))
    figure = new_figure(width, 16.0 + 44.0 * len(units) + 34.0)
    panels = figure.subplots(
        len(units) + 1, 1, sharex=True, squeeze=False, height_ratios=[1.4] * len(units) + [1.0]
    ).ravel()
    frequency = np.asarray(response["frequency"].values)
    marks = sorted({float(f) for f in response.attrs["resonances"] if frequency[0] <= f <= frequency[-1]})
    phases = panels[-1]
    names = [str(name) for name in response["target"].values]
    for letter, axes, unit in zip(letters(), panels, units, strict=False):
        largest = 0.0
        for k, name in enumerate(names):
            if str(response["unit"].values[k]) == unit:
                gain = np.abs(response["response"].values[:, k])
                axes.plot(frequency, gain, color=f"C{k}", label=name)
                largest = max(largest, float(gain.max(initial=0.0)))
        axes.set_yscale("log")
        axes.yaxis.set_minor_locator(NullLocator())
        if largest > 0.0:
            lowest = min(
                float(np.abs(response["response"].values[:, k]).min())
                for k in range(len(names))
                if str(response["unit"].values[k]) == unit and response["response"].values[:, k].any()
            )
            axes.set_ylim(max(0.5 * lowest, largest / 10.0**_DECADES), 2.0 * largest)
        axes.set_ylabel(f"magnitude [{printed_unit(unit)}]")
        panel_title(axes, letter, f"over {response.attrs['source']}")
    for k, name in enumerate(names):
        phases.plot(
            frequency, np.degrees(_wrapped(response["response"].values[:, k])), color=f"C{k}", label=name
        )
    phases.set_ylim(-190.0, 190.0)
    phases.set_yticks([-180.0, -90.0, 0.0, 90.0, 180.0])
    phases.set_ylabel("phase [deg]")
    phases.set_xlabel("frequency [Hz]")
    for axes in panels:
        for mark in marks:
            axes.axvline(mark, color="#BBBBBB", linewidth=0.5, zorder=0.6)
    phases.set_xscale("log")
    phases.set_xlim(float(frequency[0]), float(frequency[-1]))
    phases.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    phases.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    phases.xaxis.set_minor_locator(NullLocator())
    legend_above(figure, panels)
    footnote(figure, "thin lines: natural frequencies, undamped" if marks else "")
    return figure


def _wrapped(values: np.ndarray) -> np.ndarray:
    """Return phases in (-pi, pi] that do not join across the jump [rad]."""
    phase = np.angle(values)
    jumps = np.abs(np.diff(phase, prepend=phase[:1])) > np.pi
    return np.where(jumps, np.nan, phase)
