"""Lyapunov exponents: how they converge, and how well they are known."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from antenna_pin.base.arguments import takes
from antenna_pin.plot._style import Width, few_ticks, footnote, legend_above, new_figure, styled

_NAMED = 6  # exponents that have a colour and an entry of their own


@takes()
@styled
def figure_exponents(exponents: xr.Dataset, *, width: Width = "page") -> Figure:
    """Return Lyapunov exponents as they were after each interval, and at the end with a standard error.

    Args:
        exponents: Of :func:`antenna_pin.nonlinear.exponents_table`.
        width: "column" (88 mm) or "page" (180 mm).
    """
    time = np.asarray(exponents["time"].values, dtype=float)
    running = np.asarray(exponents["running"].values, dtype=float)
    values = np.asarray(exponents["value"].values, dtype=float)
    errors = np.asarray(exponents["error"].values, dtype=float)
    figure = new_figure(width, 78.0)
    axes = figure.add_subplot()
    axes.axhline(0.0, color="#999999", linewidth=0.6, zorder=0.8)
    end = float(time[-1])
    for k, (value, error) in enumerate(zip(values, errors, strict=True)):
        colour = f"C{k}" if k < _NAMED else "#999999"
        known = np.isfinite(error)
        spread = f" ± {error:.2g}" if known else ", error unknown"
        label = f"{value:.4g}{spread} 1/s" if k < _NAMED else "others"
        axes.plot(time, running[:, k], color=colour, linewidth=0.8, label=label)
        # Side by side, as errors of exponents that are alike would cover one another.
        place = end * (1.015 + 0.012 * k)
        axes.errorbar(
            [place],
            [value],
            yerr=[[error], [error]] if known else None,
            color=colour,
            marker="o",
            markersize=2.6,
            capsize=2.0,
            elinewidth=0.8,
            zorder=4,
        )
    axes.set_xlim(0.0, end * (1.03 + 0.012 * len(values)))
    axes.set_ylim(*_range(running, values, np.where(np.isfinite(errors), errors, 0.0)))
    axes.set_xlabel("time behind the transient [s]")
    axes.set_ylabel("Lyapunov exponent [1/s]")
    few_ticks(axes)
    legend_above(figure, [axes])
    intervals = f"{len(time)} intervals of {float(exponents.attrs['interval']):.6g} s"
    footnote(figure, str(exponents.attrs["verdict"]), intervals, "bars: one standard error")
    return figure


def _range(running: np.ndarray, values: np.ndarray, errors: np.ndarray) -> tuple[float, float]:
    """Return limits that show where exponents go to; the first tenth of their way may leave them."""
    later = running[len(running) // 10 :]
    low = min(float(later.min()), float((values - errors).min()), 0.0)
    high = max(float(later.max()), float((values + errors).max()), 0.0)
    margin = 0.08 * (high - low) or 1.0
    return low - margin, high + margin
