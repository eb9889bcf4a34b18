"""Figures of a verification: margins, effects of uncertain numbers, sampled loops, interface densities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from antenna_pin.base.readable import number, printed_unit
from antenna_pin.show.plot._style import COLOURS, Array, Width, literal
from antenna_pin.show.plot.grammar import Axis, ByHand, Panel, PlotCurve, PlotMark, Rule, Sheet, figure

__all__ = [
    "figure_effects",
    "figure_interface",
    "figure_loop",
    "figure_margins",
    "figure_spectrum",
]

_THIN = {"color": "#999999", "linewidth": 0.6, "zorder": 0.8}
_GOOD, _BAD = COLOURS[0], "#B3261E"
_ROW = 7.0  # height of a bar [mm]


@figure(requirements="Requirements of a verification, as its JSON file has them.")
def figure_margins(requirements: Sequence[Mapping[str, Any]], *, width: Width = "page") -> Sheet:
    """Return the margins of all requirements as shares of their bounds."""
    known = [(str(one["requirement"]), _share(one)) for one in requirements]
    shown = [(name, share) for name, share in known if share is not None]
    names, shares = [name for name, _ in shown], np.array([share for _, share in shown])
    limit = 1.5

    def draw(axes: Axes, *_: float) -> None:
        clipped = np.clip(shares, -limit, limit)
        colours = [_GOOD if share >= 0.0 else _BAD for share in shares]
        axes.barh(np.arange(len(names)), 100.0 * clipped, 0.6, color=colours)
        for k, share in enumerate(shares):
            text = f" {number(100.0 * share, 3)} % " if abs(share) < 100.0 else " beyond 100 times "
            axes.text(
                100.0 * float(np.clip(share, 0.0, limit)),
                k,
                text,
                va="center",
                fontsize="small",
                clip_on=False,
            )

    def finish(axes: Axes) -> None:
        axes.invert_yaxis()
        axes.grid(axis="y", visible=False)
        axes.set_xlim(100.0 * max(min(float(shares.min(initial=0.0)), 0.0), -limit) - 2.0, 190.0)

    y = Axis(named={float(k): literal(name) for k, name in enumerate(names)})
    x = Axis("margin, of the bound [%]", ticks=0)
    panel = Panel("", [ByHand(draw), Rule(0.0, _THIN, "x")], y, x, finish=finish, lettered=False)
    note = "bars end at 150 %; a probability's is that of what its bound allows"
    if len(shown) < len(known):
        note += "; without a bar: bound of zero, or no result"
    return Sheet([[panel]], width, 24.0 + _ROW * max(len(names), 1), (note,))


def _share(one: Mapping[str, Any]) -> float | None:
    """Return a requirement's margin as a share of its nearer bound."""
    margin, chance = one.get("margin"), one.get("probability")
    if margin is None:
        return None
    if chance is not None:
        return float(margin) / float(chance["allowed"])
    bounds = [bound for bound in (one.get("at_least"), one.get("at_most")) if bound is not None]
    result = one.get("result")
    if result is None or not bounds:
        return None
    nearest = min(bounds, key=lambda bound: abs(bound - result))
    size = abs(nearest) or max(map(abs, bounds))
    return float(margin) / size if size else None


@figure(
    effects="Effects of uncertain numbers on one requirement, as the JSON file of a verification has them.",
    units="Unit of the requirement's quantity.",
)
def figure_effects(
    effects: Sequence[Mapping[str, Any]], units: str = "1", *, width: Width = "column"
) -> Sheet:
    """Return the change of a requirement's quantity from each uncertain number's nominal to its limits."""
    known = [one for one in effects if one["change"] is not None and one["nominal"] is not None]
    order = sorted(known, key=lambda one: -abs(one["change"]))
    names = [literal(str(one["number"])) for one in order]
    low, high = (
        np.array([one[end] - one["nominal"] if one[end] is not None else 0.0 for one in order], dtype=float)
        for end in ("low", "high")
    )

    def draw(axes: Axes, across: float, _: float) -> None:
        places = np.arange(len(names))
        axes.barh(places - 0.18, across * low, 0.34, color=COLOURS[0], label="at the lower limit")
        axes.barh(places + 0.18, across * high, 0.34, color=COLOURS[1], label="at the upper limit")

    def finish(axes: Axes) -> None:
        axes.margins(x=0.06)
        axes.invert_yaxis()
        axes.grid(axis="y", visible=False)

    unit = printed_unit(units)
    x = Axis(f"change [{unit or '-'}]", ticks=0)
    y = Axis(named={float(k): name for k, name in enumerate(names)})
    panel = Panel("", [ByHand(draw), Rule(0.0, _THIN, "x")], y, x, finish=finish, lettered=False)
    return Sheet([[panel]], width, 26.0 + 1.3 * _ROW * max(len(names), 1))


@figure(
    frequency="Frequencies, rising, (n,) [Hz].",
    responses="Open loop's responses by name, complex, (n,) [-].",
)
def figure_loop(frequency: Array, responses: Mapping[str, Any], *, width: Width = "page") -> Sheet:
    """Return gain and phase of sampled loops, opened at the command."""
    gains: list[PlotMark] = [Rule(1.0, _THIN)]
    phases: list[PlotMark] = [Rule(-180.0, _THIN)]
    for k, (name, values) in enumerate(responses.items()):
        look = {"color": COLOURS[k % len(COLOURS)], "linewidth": 1.0}
        gains.append(PlotCurve(name, frequency, np.abs(values), look))
        phase = np.degrees(np.unwrap(np.angle(values)))
        # The loop begins with the lag of its integrators, not a turn beside it.
        phase -= 360.0 * np.round((phase[0] + 180.0) / 360.0)
        phases.append(PlotCurve("", frequency, phase, look))
    x = Axis("frequency [Hz]", scale="log", shared="frequency", ticks=0)
    sizes = np.concatenate([np.abs(values) for values in responses.values()])
    top = float(min(sizes.max(), 1e4))
    y = Axis("loop gain [-]", scale="log", limits=(max(float(sizes.min()), 1e-4), 2.0 * top), ticks=0)
    named = {float(n): f"{n}".replace("-", "\N{MINUS SIGN}") for n in (-360, -270, -180, -90, 0)}
    turn = Axis("phase [deg]", limits=(-400.0, 20.0), named=named)
    panels = [Panel("", gains, y, x, lettered=False), Panel("", phases, turn, x, lettered=False)]
    return Sheet([[one] for one in panels], width, 110.0, heights=[1.3, 1.0])


@figure(densities="``force`` and ``moment``: power spectral densities over ``frequency`` and ``axis``.")
def figure_interface(densities: xr.Dataset, *, width: Width = "page") -> Sheet:
    """Return amplitude densities of force and moment at the interface, six axes."""
    frequency = np.asarray(densities["frequency"].values)
    panels = []
    for column, unit in (("force", "N"), ("moment", "N m")):
        marks: list[PlotMark] = []
        values = np.sqrt(np.asarray(densities[column].values))
        for k, axis in enumerate(densities["axis"].values):
            look = {"color": COLOURS[k], "linewidth": 0.9}
            marks.append(
                PlotCurve(str(axis) if column == "force" else "", frequency[1:], values[1:, k], look)
            )
        top = float(values[1:].max(initial=0.0)) or 1.0
        y = Axis(f"{column} [{unit}/√Hz]", scale="log", limits=(1e-6 * top, 2.0 * top), ticks=0)
        x = Axis("frequency [Hz]", scale="log", shared="frequency", ticks=0)
        panels.append(Panel(f"{column} on the base", marks, y, x))
    return Sheet([[one] for one in panels], width, 120.0)


@figure(
    frequency="Frequencies, rising, (n,) [Hz].",
    lines="Values over them by name, (n,).",
    label="Label of the values, with their unit.",
    across="Label of the frequencies.",
)
def figure_spectrum(
    frequency: Array,
    lines: Mapping[str, Any],
    label: str,
    across: str = "frequency [Hz]",
    *,
    width: Width = "page",
) -> Sheet:
    """Return spectra over the frequency, both logarithmic."""
    marks = [
        PlotCurve(name, np.asarray(frequency), np.asarray(values), {"color": COLOURS[k % len(COLOURS)]})
        for k, (name, values) in enumerate(lines.items())
    ]
    y, x = Axis(label, scale="log", ticks=0), Axis(across, scale="plain", ticks=0)
    return Sheet([[Panel("", marks, y, x, lettered=False)]], width, 80.0)
