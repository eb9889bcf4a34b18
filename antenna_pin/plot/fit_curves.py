"""A record against the fit of it: what was measured, the model with its band, and the residuals beneath."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import number
from antenna_pin.errors import UnknownNameError
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

__all__ = ["curves_of_fit", "figure_fit"]

_DATA, _MODEL, _NEW, _CURVE = "#555555", "C0", "#DCEAF3", "#9CC5DF"
# Rows from which on a record is a line, as dots would cover one another.
_DOTS = 400
#: Curves in one figure at most.
MOST = 4
# What an axis is along, by what is compared.
_ALONG = {
    "reading": ("time [s]", "linear"),
    "rms": ("time [s]", "linear"),
    "ln power": ("frequency [Hz]", "log"),
}


@takes()
def curves_of_fit(fit: xr.Dataset) -> list[str]:
    """Return the names of a fit's curves, ``record: column``, in order."""
    parts = zip(fit["record"].values, fit["column"].values, strict=True)
    return list(dict.fromkeys(f"{record}: {column}" for record, column in parts))


@takes()
@styled
def figure_fit(
    fit: xr.Dataset, curves: list[str] | None = None, *, bands: bool = True, width: Width = "page"
) -> Figure:
    """Return records against the fit of them, with residuals in standard deviations of the noise beneath.

    Dark bands are where the model's curve may be, light ones where a new measurement may be.

    Args:
        fit: Of :func:`antenna_pin.fit.open_fit`.
        curves: Of which records and columns, ``record: column``; the first four if left out.
        bands: Whether to draw bands, where the fit has them.
        width: "column" (88 mm) or "page" (180 mm).

    Raises:
        UnknownNameError: There is no such curve.
    """
    every = curves_of_fit(fit)
    for name in curves or ():
        if name not in every:
            raise UnknownNameError("figure", "curve", name, every)
    chosen = every[:MOST] if curves is None else curves
    names = np.array([f"{a}: {b}" for a, b in zip(fit["record"].values, fit["column"].values, strict=True)])
    figure = new_figure(width, 14.0 + 58.0 * len(chosen))
    panels: Any = figure.subplots(
        2 * len(chosen), 1, squeeze=False, gridspec_kw={"height_ratios": [3.0, 1.2] * len(chosen)}
    )
    for k, (letter, name) in enumerate(zip(letters(), chosen, strict=False)):
        above, below = panels[2 * k, 0], panels[2 * k + 1, 0]
        rows = fit.isel(row=np.flatnonzero(names == name))
        _curve(above, rows, bands and "band_low" in fit)
        spread = _residuals(below, rows)
        below.sharex(above)
        above.tick_params(labelbottom=False)
        panel_title(above, letter, name.replace("_", " "))
        above.set_title(f"residuals' rms {number(spread, 3)} sd", loc="right", fontsize=6.5)
        figure.align_ylabels([above, below])
    legend_above(figure, panels.ravel())
    left = len(every) - len(chosen)
    level = 100.0 * float(fit.attrs.get("level", 0.95))
    footnote(
        figure,
        f"bands: {level:g} %, point by point" if bands and "band_low" in fit else "",
        f"{left} more curve{'s' if left > 1 else ''} not drawn" if left > 0 and curves is None else "",
    )
    return figure


def _curve(axes: Axes, rows: xr.Dataset, bands: bool) -> None:
    at, data, model = (np.asarray(rows[name].values, dtype=float) for name in ("at", "data", "model"))
    measure = str(rows["measure"].values[0])
    unit = str(rows["unit"].values[0])
    largest = float(np.nanmax(np.abs([data, model]), initial=0.0))
    factor, printed = prefixed(unit, largest) if measure in ("reading", "rms") else (1.0, "")
    if bands:
        for low, high, colour, label in (
            ("new_low", "new_high", _NEW, "where a new measurement may be"),
            ("band_low", "band_high", _CURVE, "where the model may be"),
        ):
            one, other = (factor * np.asarray(rows[end].values, dtype=float) for end in (low, high))
            axes.fill_between(at, one, other, color=colour, linewidth=0.0, label=label, zorder=1.0)
    _marked(axes, at, factor * data, "measured")
    alone = len(at) == 1
    axes.plot(
        at,
        factor * model,
        color=_MODEL,
        linewidth=0.9,
        label="fitted model",
        zorder=3.0,
        marker="D" if alone else "",
        markersize=3.0,
    )
    axes.set_ylabel(f"{measure} [{printed or '-'}]")
    _scale(axes, measure)
    axes.margins(x=0.02, y=0.06)
    few_ticks(axes) if axes.get_xscale() == "linear" else None


def _marked(axes: Axes, at: Array, values: Array, label: str | None) -> None:
    """Draw what was measured: dots, or of very many rows a line."""
    if len(at) <= _DOTS:
        axes.plot(at, values, ".", color=_DATA, markersize=2.6, label=label, zorder=2.0)
    else:
        axes.plot(at, values, color=_DATA, linewidth=0.5, alpha=0.8, label=label, zorder=2.0)


def _residuals(axes: Axes, rows: xr.Dataset) -> float:
    """Draw residuals in standard deviations, and return their root mean square [-]."""
    at, values = (np.asarray(rows[name].values, dtype=float) for name in ("at", "model"))
    values = (values - rows["data"].values) / rows["noise"].values
    measure = str(rows["measure"].values[0])
    axes.axhspan(-1.96, 1.96, color="#EEEEEE", linewidth=0.0, zorder=0.5)
    axes.axhline(0.0, color="#999999", linewidth=0.6, zorder=0.8)
    _marked(axes, at, values, None)
    axes.set_ylabel("residual\n[sd]")
    axes.set_xlabel(_along(measure)[0])
    _scale(axes, measure)
    half = 1.1 * max(2.5, float(np.nanmax(np.abs(values), initial=0.0)))
    axes.set_ylim(-half, half)
    few_ticks(axes, y=3) if axes.get_xscale() == "linear" else None
    return float(np.sqrt(np.mean(values**2)))


def _along(measure: str) -> tuple[str, str]:
    return _ALONG.get(measure, ("middle of the bin [SI]", "log"))


def _scale(axes: Axes, measure: str) -> None:
    if _along(measure)[1] == "log":
        axes.set_xscale("log")
