"""Figures of statics: torque over a travel, torque-angle loops, motorization margins."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from antenna_pin.errors import InvalidParameterError
from antenna_pin.show.plot._style import IDEAL, PEAK, Width, distinct
from antenna_pin.show.plot.grammar import (
    ZERO,
    Axis,
    Panel,
    PlotCurve,
    PlotMark,
    Points,
    Sheet,
    figure,
)

# Share of the largest torque below which a source is not drawn, and how many are at most.
_NOTHING, _MOST = 1e-9, 10
_BACK = (0, (3, 1.5))


def _position_axis(data: xr.Dataset) -> Axis:
    unit = str(data["position"].attrs["units"])
    label = "position" if unit == "m" else "angle"
    return Axis(f"{label} of {data.attrs['joint']}", unit=unit, shared="position")


def _torque_axis(data: xr.Dataset, name: str) -> Axis:
    unit = str(data[name].attrs["units"])
    return Axis("force" if unit == "N" else "torque", unit=unit)


def _sources(values: np.ndarray, names: np.ndarray) -> list[tuple[int, str]]:
    """Return index and name of the sources that count, the largest first, at most ten."""
    sizes = np.abs(values).reshape(-1, len(names)).max(axis=0, initial=0.0)
    order = [k for k in np.argsort(-sizes) if sizes[k] > _NOTHING * sizes.max(initial=0.0)]
    return [(int(k), str(names[k])) for k in sorted(order[:_MOST])]


@figure(travel="Dataset of :class:`antenna_pin.studies.statics.QuasiStaticTravel`.")
def figure_travel(travel: xr.Dataset, *, width: Width = "page") -> Sheet:
    """Return the torque that a joint needs along its travel, by source."""
    x = np.asarray(travel["position"].values, dtype=float)
    senses = [str(one) for one in travel["sense"].values]
    needed: list[PlotMark] = [ZERO]
    parts: list[PlotMark] = [ZERO]
    names = travel["source"].values
    chosen = _sources(np.asarray(travel["component"].values), names)
    for sense in senses:
        one, back = travel.sel(sense=sense), sense == "back"
        look: dict[str, Any] = {"color": "black", "linestyle": _BACK if back else "-", "linewidth": 1.1}
        needed.append(PlotCurve("needed, back" if back else "needed, out", x, one["torque"].values, look))
        for n, (k, name) in enumerate(chosen):
            look = {**distinct(n), **({"linestyle": _BACK} if back else {})}
            values = np.asarray(one["component"].values[:, k])
            parts.append(PlotCurve("" if back else name, x, values, look))
    across, up = _position_axis(travel), _torque_axis(travel, "torque")
    rows = [[Panel("needed at the joint", needed, up, across)]]
    if chosen:
        rows.append([Panel("exerted along the motion, reduced to the joint", parts, up, across)])
    notes = ("dashed: on the way back",) if len(senses) > 1 else ()
    return Sheet(rows, width, 20.0 + 52.0 * len(rows), notes)


@figure(loop="Dataset of :class:`antenna_pin.studies.statics.TorqueAngleLoop`.")
def figure_torque_angle(loop: xr.Dataset, *, width: Width = "column") -> Sheet:
    """Return the torque-angle loop of a joint with its measures."""
    angle, torque = (np.asarray(loop[name].values, dtype=float) for name in ("angle", "torque"))
    cycle = np.asarray(loop["cycle"].values)
    last = cycle == cycle.max()
    marks: list[PlotMark] = [ZERO]
    if not last.all():
        marks.append(PlotCurve("first loading", angle[~last], torque[~last], {**IDEAL, "zorder": 3}))
    marks.append(PlotCurve("last cycle", angle[last], torque[last], {"color": "C0", "linewidth": 1.1}))
    sliding = str(loop["torque"].attrs["units"]) == "N"
    x = Axis(
        f"{'position' if sliding else 'angle'} of {loop.attrs['joint']}",
        unit=str(loop["angle"].attrs["units"]),
    )
    notes = tuple(str(one) for one in loop.attrs["measures"])
    panel = Panel("", marks, _torque_axis(loop, "torque"), x, margins=(0.03, 0.05))
    return Sheet([[panel]], width, 88.0, notes)


@figure(margin="Dataset of :class:`antenna_pin.studies.margins.MotorizationMargin`.")
def figure_margin(margin: xr.Dataset, *, width: Width = "page") -> Sheet:
    """Return the motorization margin over a travel, and the resistances and drives that make it."""
    x = np.asarray(margin["position"].values, dtype=float)
    values = np.asarray(margin["margin"].values, dtype=float)
    if not np.isfinite(values).any():
        rule = "with a resistance somewhere, or there is no margin to draw"
        raise InvalidParameterError("plot", "margin", rule, said="none")
    worst = int(np.nanargmin(values))
    names = margin["source"].values
    resistance = np.asarray(margin["resistance"].values)
    factored = resistance * np.asarray(margin["resistance_factor"].values)
    parts: list[PlotMark] = [ZERO]
    for n, (k, name) in enumerate(_sources(factored, names)):
        symbol = str(margin["symbol"].values[k])
        factor = float(margin["resistance_factor"].values[k])
        parts.append(PlotCurve(f"{symbol}: {name} × {factor:g}", x, factored[:, k], distinct(n)))
    balance: list[PlotMark] = [ZERO]
    balance.append(PlotCurve("actuation", x, margin["actuation"].values, {"color": "C2", "linewidth": 1.1}))
    balance.append(PlotCurve("least actuation", x, margin["minimum_torque"].values, {"color": "black"}))
    curve: list[PlotMark] = [
        ZERO,
        PlotCurve("", x, values, {"color": "C0", "linewidth": 1.1}),
        Points(np.array([[x[worst], values[worst]]]), {"color": PEAK, "clip_on": False}),
    ]
    across = _position_axis(margin)
    rows = [
        [Panel("margin", curve, Axis("margin [-]"), across, named=False, margins=(0.0, 0.08))],
        [Panel("actuation and what it must be", balance, _torque_axis(margin, "actuation"), across)],
    ]
    if len(parts) > 1:
        rows.append(
            [Panel("resistances with their factors", parts, _torque_axis(margin, "resistance"), across)]
        )
    source, clause = margin.attrs["source"], margin.attrs["clause"]
    notes = (f"factors: {source}, {clause}; no claim of compliance", f"smallest margin {values[worst]:.4g}")
    return Sheet(rows, width, 24.0 + 46.0 * len(rows), notes)
