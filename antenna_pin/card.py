"""A run at a glance, for notebooks: how it ended, key numbers, a sketch of the motion. Plain HTML and SVG."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from html import escape
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.readable import number, readable

__all__ = ["motion_sketch", "run_card"]

Array = NDArray[np.float64]

# Of Okabe and Ito, told apart by people with any of the common kinds of colour blindness.
_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
_WIDTH, _HEIGHT, _LEFT, _RIGHT, _TOP, _BOTTOM = 420, 150, 62, 8, 8, 22
_COLUMNS = 180  # of the sketch: in each, the least and the largest value are kept


def run_card(data: xr.Dataset, summary: Mapping[str, Any], completed: bool) -> str:
    """Return a run as HTML for a notebook.

    Args:
        data: Its samples.
        summary: What ``Trajectory.summary`` returns.
        completed: Whether it reached its end.
    """
    heading = " - ".join(str(summary[key]) for key in ("title", "case") if summary[key]) or "run"
    outcome = str(summary["outcome"]).lower().replace("_", " ")
    colour = "#009E73" if completed else "#B3261E"
    rows = "".join(
        f'<tr><td style="text-align:left">{escape(name)}</td><td>{escape(value)}</td></tr>'
        for name, value in _rows(summary)
    )
    return (
        '<div style="font-family:system-ui,sans-serif;max-width:60rem">'
        f'<div style="font-weight:600">{escape(heading)}</div>'
        f'<div style="border-left:.3rem solid {colour};padding:.1rem .5rem;margin:.3rem 0">'
        f"<b>{escape(outcome)}</b>: {escape(str(summary['message']))}</div>"
        '<div style="display:flex;flex-wrap:wrap;gap:1rem;align-items:flex-start">'
        f"<table>{rows}</table>{motion_sketch(data)}</div>"
        f"<details><summary>all data</summary>{data._repr_html_()}</details></div>"
    )


def _rows(summary: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    counts, kept = summary["counts"], summary["conservation"]
    yield "simulated time", readable(summary["time"], "s")
    yield "samples", str(summary["samples"])
    yield "steps", f"{counts['accepted']} in {readable(counts['wall_seconds'], 's', 3)}"
    for joint, motion in summary["motion"].items():
        yield f"{joint}, angle at the end", readable(motion["angle"], "rad")
        yield f"{joint}, largest acceleration", readable(motion["peak_acceleration"], "rad/s^2")
    contacts = summary["contacts"].values()
    if contacts:
        yield "contacts", str(sum(one["episodes"] for one in contacts))
        yield "largest normal force", readable(max(one["peak_force"] for one in contacts), "N")
        yield "greatest depth", readable(max(one["peak_depth"] for one in contacts), "m")
        yield "energy lost in contact", readable(sum(one["dissipated"] for one in contacts), "J")
    for key, name in (
        ("energy_error_relative", "energy balance error, relative"),
        ("linear_momentum_drift_relative", "linear momentum drift, relative"),
        ("angular_momentum_drift_relative", "angular momentum drift, relative"),
    ):
        if kept.get(key) is not None:
            yield name, number(kept[key], 2)


def motion_sketch(data: xr.Dataset) -> str:
    """Return the angles of a run's joints over time as inline SVG; nothing if there is nothing to draw."""
    if "time" not in data.coords:  # a result without series
        return ""
    time = np.asarray(data["time"].values, dtype=float)
    names = [str(name) for name in data["joint"].values] if "joint" in data.coords else []
    if not names or time.size < 2 or not time[-1] > time[0]:
        return ""
    angles = np.asarray(data["motion_angle"].values, dtype=float)
    if not np.isfinite(angles).any():
        return ""
    low, high = float(np.nanmin(angles)), float(np.nanmax(angles))
    span = high - low if high > low else max(abs(high), 1.0)
    right, bottom = _WIDTH - _RIGHT, _HEIGHT - _BOTTOM
    lines = "".join(
        f'<path d="{_path(time, angles[:, k], low, span)}" fill="none" '
        f'stroke="{_COLOURS[k % len(_COLOURS)]}" stroke-width="1.4"><title>{escape(name)}</title></path>'
        for k, name in enumerate(names)
    )
    keys = "".join(
        f'<span style="color:{_COLOURS[k % len(_COLOURS)]};margin-right:.8em">{escape(name)}</span>'
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
    return (
        f'<div><svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}" width="{_WIDTH}" '
        'style="max-width:100%;height:auto" role="img" aria-label="angles of the joints over time" '
        'font-size="11" fill="currentColor">'
        f'<path d="M{_LEFT},{_TOP}V{bottom}H{right}" fill="none" stroke="currentColor" stroke-width=".7"/>'
        f"{lines}{texts}</svg><div>{keys}<span>angle of the joint over time</span></div></div>"
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
