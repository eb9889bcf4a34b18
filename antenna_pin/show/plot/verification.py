"""Figures of a verification: margins, effects, tolerance chains, sampled loops, interface densities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from antenna_pin.base.readable import number, printed_unit, readable
from antenna_pin.base.tolerance_chain import ToleranceChain
from antenna_pin.errors import InvalidParameterError
from antenna_pin.show.plot._style import COLOURS, Array, Width, literal
from antenna_pin.show.plot.grammar import Axis, Band, ByHand, Panel, PlotCurve, PlotMark, Rule, Sheet, figure

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
    chain="Chain of tolerances.",
    least="Least permitted sum [m]; None without.",
    most="Largest permitted sum [m]; None without.",
)
def figure_chain(
    chain: ToleranceChain, least: float | None = None, most: float | None = None, *, width: Width = "page"
) -> Sheet:
    """Return zones of a chain's dimensions, and the distribution of their sum with limits."""
    if not chain.tolerance > 0.0:
        raise InvalidParameterError(
            "plot", "chain", "with a tolerance, or its sum is one number", said="none"
        )
    low, high = chain.worst_case
    around = chain.root_sum_square
    rows = [
        (f"{one.name}, {100.0 * chain.shares[one.name]:.3g} %", 0.5 * abs(one.coefficient) * one.tolerance)
        for one in chain.dimensions
    ]
    rows += [("root sum square", 0.5 * (around[1] - around[0])), ("worst case", 0.5 * (high - low))]
    halves = np.array([half for _, half in rows])
    colours = [COLOURS[0]] * len(chain.dimensions) + [COLOURS[2], COLOURS[1]]

    def draw(axes: Axes, across: float, _: float) -> None:
        axes.barh(np.arange(len(rows)), 2.0 * across * halves, 0.6, -across * halves, color=colours)

    def finish(axes: Axes) -> None:
        axes.invert_yaxis()
        axes.grid(axis="y", visible=False)

    parts = Panel(
        "zone of each dimension in the sum, and its share in the variance",
        [ByHand(draw), Rule(0.0, _THIN, "x")],
        Axis(named={float(k): literal(name) for k, (name, _) in enumerate(rows)}),
        Axis("from the middle of the zone", unit="m", largest=float(halves.max()), ticks=0),
        margins=(0.03, 0.05),
        finish=finish,
    )
    places, density = chain.density
    ends = [limit for limit in (least, most) if limit is not None]
    marks: list[PlotMark] = [
        Band(places, np.zeros_like(density), density, {"color": COLOURS[0], "alpha": 0.25})
    ]
    marks.append(PlotCurve("distribution", places, density, {"color": COLOURS[0], "linewidth": 1.1}))
    top = np.array([0.0, 1.05 * float(density.max())])
    for name, pair, look in (
        ("worst case", (low, high), {"color": COLOURS[1]}),
        ("root sum square", around, {"color": COLOURS[2], "linestyle": (0, (3, 1.5))}),
        ("permitted", ends, {"color": _BAD, "linewidth": 1.6}),
    ):
        marks += [PlotCurve(name if k == 0 else "", np.full(2, at), top, look) for k, at in enumerate(pair)]
    largest = max(abs(one) for one in (low, high, *ends))
    total = Panel(
        f"sum {chain.name}",
        marks,
        Axis("probability density [1/m]", labelled=False, named={}, ticks=0),
        Axis("sum", unit="m", largest=largest, ticks=0),
        margins=(0.05, 0.0),
    )
    low_, high_ = (readable(chain.quantile(share), "m") for share in (0.00135, 0.99865))
    note = f"99.73 % lie between {low_} and {high_}, standard deviation {readable(chain.sigma, 'm')}"
    height = _ROW * len(rows)
    return Sheet([[parts], [total]], width, 90.0 + height, (note,), heights=(14.0 + height, 60.0), every=True)


@figure(
    frequency="Frequencies, rising, (n,) [Hz].",
    responses="Open loop's responses by name, complex, (n,) [-].",
    points="Frequencies [Hz] and responses [-] measured in runs, by amplitude.",
)
def figure_loop(
    frequency: Array,
    responses: Mapping[str, Any],
    points: Mapping[str, tuple[Any, Any]] | None = None,
    *,
    width: Width = "page",
) -> Sheet:
    """Return gain and phase of sampled loops, opened at the command, with their margins."""
    gains: list[PlotMark] = [Rule(1.0, _THIN)]
    phases: list[PlotMark] = [Rule(-180.0, _THIN)]
    lines = [(name, np.asarray(frequency), np.asarray(one), "-") for name, one in responses.items()]
    lines += [
        (name, np.asarray(where), np.asarray(one), "o:") for name, (where, one) in (points or {}).items()
    ]
    for k, (name, where, values, style) in enumerate(lines):
        look = {"color": COLOURS[k % len(COLOURS)], "linewidth": 1.0, "markersize": 3.0}
        look |= {"linestyle": style[-1], "marker": "o" if style[0] == "o" else ""}
        gains.append(PlotCurve(name, where, np.abs(values), look))
        phase = np.degrees(np.unwrap(np.angle(values)))
        # The loop begins with the lag of its integrators, not a turn beside it.
        phase -= 360.0 * np.round((phase[0] + 180.0) / 360.0)
        phases.append(PlotCurve("", where, phase, look))
        for marks, ends in zip((gains, phases), _margin_lines(where, np.abs(values), phase), strict=True):
            marks += [PlotCurve("", *one, {"color": look["color"], "linewidth": 2.2}) for one in ends]
    x = Axis("frequency [Hz]", scale="log", shared="frequency", ticks=0)
    sizes = np.concatenate([np.abs(values) for values in responses.values()])
    top = float(min(sizes.max(), 1e4))
    y = Axis("loop gain [-]", scale="log", limits=(max(float(sizes.min()), 1e-4), 2.0 * top), ticks=0)
    named = {float(n): f"{n}".replace("-", "\N{MINUS SIGN}") for n in (-360, -270, -180, -90, 0)}
    turn = Axis("phase [deg]", limits=(-400.0, 20.0), named=named)
    panels = [Panel("", gains, y, x, lettered=False), Panel("", phases, turn, x, lettered=False)]
    return Sheet([[one] for one in panels], width, 110.0, heights=[1.3, 1.0])


def _margin_lines(
    frequency: Array, gain: Array, phase: Array
) -> tuple[list[tuple[Array, Array]], list[tuple[Array, Array]]]:
    """Return upright lines of the gain margin and of the phase margin."""
    found: list[list[tuple[Array, Array]]] = [[], []]
    for kind, (falling, other, level) in enumerate(
        ((phase + 180.0, np.log(gain), 0.0), (np.log(gain), phase, -180.0))
    ):
        for k in np.flatnonzero((falling[:-1] >= 0.0) & (falling[1:] < 0.0))[-1:]:
            share = falling[k] / (falling[k] - falling[k + 1])
            where = frequency[k] * (frequency[k + 1] / frequency[k]) ** share
            ends = np.array([other[k] + share * (other[k + 1] - other[k]), level])
            found[kind].append((np.array([where, where]), np.exp(ends) if kind == 0 else ends))
    return found[0], found[1]


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


@figure(orders="Orders of a wheel, as :func:`antenna_pin.analysis.wheel_orders` returns them.")
def figure_orders(orders: xr.Dataset, *, width: Width = "page") -> Sheet:
    """Return amplitudes of a wheel's orders over its speed, forces and moments, resonances marked."""
    speed = np.asarray(orders["speed"].values)
    fine = np.linspace(0.0, float(speed[-1]), 101)
    panels = []
    for name, unit, begin in (("force", "N", "f"), ("moment", "N m", "m")):
        axes = [str(axis) for axis in orders["axis"].values if str(axis).startswith(begin)]
        marks: list[PlotMark] = []
        top = 0.0
        for order in orders["order"].values:
            for axis in axes:
                one = orders.sel(order=order, axis=axis)
                amplitude = np.asarray(one["amplitude"].values)
                if not amplitude.any():
                    continue
                look = {"color": COLOURS[len(marks) // 3 % len(COLOURS)]}
                label = f"{axis}, order {order:.4g}"
                # Rings of two sizes: two radial axes of a wheel are alike.
                small = {"markersize": 3.0 + len(marks) // 3 % 2 * 3.0, "markerfacecolor": "none"}
                flagged = np.where(one["resonant"].values, amplitude, np.nan)
                fitted = float(one["coefficient"]) * fine**2
                marks += [
                    PlotCurve(label, speed, amplitude, look | {"linestyle": "none", "marker": "o", **small}),
                    PlotCurve("", fine, fitted, look | {"linewidth": 0.8}),
                    PlotCurve("", speed, flagged, {"color": _BAD, "linestyle": "none", "marker": "x"}),
                ]
                top = max(top, float(amplitude.max()))
        x = Axis("speed [rad/s]", shared="speed", ticks=0)
        y = Axis(f"amplitude [{unit}]", limits=(0.0, 1.1 * top or 1.0), ticks=0)
        panels.append(Panel(f"{name} on the base", marks, y, x))
    note = "lines: C times the speed squared; crosses: resonances, which do not count"
    return Sheet([[one] for one in panels], width, 120.0, (note,))


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
