"""A sketch of a run's motion for notebooks, in plain SVG."""

from __future__ import annotations

from html import escape

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.base.readable import readable

__all__ = ["motion_sketch"]

Array = NDArray[np.float64]

# Variables of the card's style, which has a colour for light and for dark pages.
_COLOURS = tuple(f"var(--line-{k})" for k in range(1, 7))
_WIDTH, _HEIGHT, _LEFT, _RIGHT, _TOP, _BOTTOM = 420, 150, 62, 8, 8, 22
_COLUMNS = 120  # of the sketch: in each, the least and the largest value are kept


def motion_sketch(data: xr.Dataset) -> str:
    """Return the angles of a run's joints over time as inline SVG; nothing if there is nothing to draw."""
    if "time" not in data.coords:  # a result without series
        return ""
    time = np.asarray(data["time"].values, dtype=float)
    every = [str(name) for name in data["joint"].values] if "joint" in data.coords else []
    names = every[: len(_COLOURS)]
    if not names or time.size < 2 or not time[-1] > time[0]:
        return ""
    angles = np.asarray(data["motion_angle"].values, dtype=float)[:, : len(names)]
    if not np.isfinite(angles).any():
        return ""
    low, high = float(np.nanmin(angles)), float(np.nanmax(angles))
    span = high - low if high > low else max(abs(high), 1.0)
    right, bottom = _WIDTH - _RIGHT, _HEIGHT - _BOTTOM
    lines = "".join(
        f'<path d="{_path(time, angles[:, k], low, span)}" fill="none" '
        f'style="stroke:{_COLOURS[k]}" stroke-width="1.4"><title>{escape(name)}</title></path>'
        for k, name in enumerate(names)
    )
    keys = "".join(
        f'<span style="color:{_COLOURS[k]};margin-right:.8em">{escape(name)}</span>'
        for k, name in enumerate(names)
    )
    texts = "".join(
        f'<text x="{x}" y="{y}" text-anchor="{anchor}">{escape(text)}</text>'
        for x, y, anchor, text in (
            (_LEFT - 6, _TOP + 10, "end", readable(high, "rad", 3)),
            (_LEFT - 6, bottom, "end", readable(low, "rad", 3)),
            (_LEFT, _HEIGHT - 5, "start", readable(float(time[0]), "s", 3)),
            (right, _HEIGHT - 5, "end", readable(float(time[-1]), "s", 3)),
        )
    )
    left = f" (and {len(every) - len(names)} joints more)" if len(every) > len(names) else ""
    return (
        f'<div><svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}" width="{_WIDTH}" '
        'style="max-width:100%;height:auto" role="img" aria-label="angles of the joints over time" '
        'font-size="11" fill="currentColor">'
        f'<path d="M{_LEFT},{_TOP}V{bottom}H{right}" fill="none" stroke="currentColor" stroke-width=".7"/>'
        f"{lines}{texts}</svg><div>{keys}<span>angle over time{left}</span></div></div>"
    )


def _path(time: Array, values: Array, low: float, span: float) -> str:
    """Return the line as an SVG path, thinned to what a screen can show, peaks kept."""
    # Columns of equal time, not of equal number of samples: these crowd at impacts.
    column = np.minimum(((time - time[0]) / (time[-1] - time[0]) * _COLUMNS).astype(int), _COLUMNS - 1)
    starts = np.flatnonzero(np.diff(column, prepend=-1))
    kept: set[int] = {0, time.size - 1}
    for first, last in zip(starts, [*starts[1:], time.size], strict=True):
        part = values[first:last]
        if np.isfinite(part).any():
            kept |= {int(first + np.nanargmin(part)), int(first + np.nanargmax(part))}
    picked = np.array(sorted(kept))
    picked = picked[np.isfinite(values[picked])]
    wide, high = _WIDTH - _LEFT - _RIGHT, _HEIGHT - _TOP - _BOTTOM
    x = _LEFT + wide * (time[picked] - time[0]) / (time[-1] - time[0])
    y = _TOP + high * (1.0 - (values[picked] - low) / span)
    return "M" + "L".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
