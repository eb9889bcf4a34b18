"""Energy and momentum audits of runs, and one small overview picture."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from antenna_pin.show.plot._compared import Picked, pick
from antenna_pin.show.plot._kinds import FREE_BASE, TOUCHING, RunFigure, choose_joint, none_with
from antenna_pin.show.plot._runs import (
    LabelledRun,
    Run,
    Runs,
    labelled,
    long_enough,
    too_short,
    unit_of,
    with_reference,
)
from antenna_pin.show.plot._style import COLOURS, IDEAL, MANY, Array, Width, distinct
from antenna_pin.show.plot._thinned import Columns, thinned
from antenna_pin.show.plot.grammar import (
    TIME,
    Axis,
    ByHand,
    Panel,
    PlotCurve,
    Sheet,
    figure,
    in_blocks,
    largest_of,
    size_of,
)
from antenna_pin.show.plot.motion import MOTIONS, Quantity

# Below this an error is round-off of round-off; the logarithmic scale ends there.
_FLOOR = 1e-18

_STORED = (
    ("drive_work", "work of the drives", "black"),
    ("force_work", "work of forces", COLOURS[1]),
    ("kinetic_energy", "kinetic energy", COLOURS[0]),
    ("gravity_energy", "gravity, from the start", COLOURS[2]),
    ("spring_energy", "springs", COLOURS[4]),
    ("contact_energy", "elastic energy of the contacts", COLOURS[5]),
    ("elastic_energy", "elastic energy of flexible links", COLOURS[3]),
)
_LOST = (
    ("dissipation_normal", "lost in normal contact", COLOURS[1]),
    ("dissipation_friction", "lost in friction", COLOURS[3]),
    ("dissipation_damper", "lost in dampers and friction of joints", "#7F7F7F"),
    ("dissipation_elastic", "lost in flexible links", COLOURS[5]),
    ("element_loss", "lost in stops, latches and the like", COLOURS[4]),
    ("force_loss", "lost in elements on links", COLOURS[2]),
)

_DRIVES: dict[str, Any] = {**IDEAL, "zorder": 3}

_MOMENTA = (("linear_momentum", "momentum_scale"), ("angular_momentum", "angular_momentum_scale"))


@figure()
def figure_energy(runs: Runs, *, width: Width = "page") -> Sheet:
    """Return the energy ledger of each run: stored energy, losses, and error of balance.

    Gravity's energy is drawn from its start, since its zero is a matter of choice. The error is the largest
    so far, relative to the drives' gross work over the run, the integral of the absolute power.
    """
    every = labelled(runs)
    drawn = [thinned(run, _ledger) for run in long_enough(every)]
    rows: list[list[Panel | None]] = []
    notes: list[str] = []
    for title, parts in (("energy", _STORED), ("losses", _LOST)):
        books = [{name: _total(run, name) for name, _, _ in parts} for run in drawn]
        for book in books:
            if "gravity_energy" in book:
                book["gravity_energy"] = book["gravity_energy"] - book["gravity_energy"][0]
        y = Axis("energy", "J", largest_of([v for book in books for v in book.values()]), shared=title)
        rows.append([])
        for run, book in zip(drawn, books, strict=True):
            lines = [
                PlotCurve(label, run.time, book[name], _DRIVES if colour == "black" else {"color": colour})
                for name, label, colour in parts
                if np.any(book[name])
            ]
            x = replace(TIME, limits=(float(run.time[0]), float(run.time[-1])))
            rows[-1].append(Panel(f"{run.label}, {title}", lines, y, x) if lines else None)
        none = [run.label for run, one in zip(drawn, rows[-1], strict=True) if one is None]
        notes += [f"no {title}: {', '.join(none)}"] if none else []
    errors = []
    for run in drawn:
        # A run without drives has its largest energy as the measure.
        gross = sum(float(_total(run, name)[-1]) for name in ("drive_gross_work", "force_gross_work"))
        measure = gross if gross > 0.0 else size_of(_total(run, "kinetic_energy"))
        error = np.abs(run.values("energy_error")) / (measure or 1.0)
        line = _so_far("", run, error, {"linewidth": 0.7, "color": COLOURS[0]})
        y = Axis("error / gross work [-]" if gross > 0.0 else "error / largest energy [-]", shared="error")
        errors.append(Panel(f"{run.label}, largest error so far", [line], y))
    rows.append([*_in_decades(errors)])
    sheet = in_blocks(rows, width)
    return Sheet(sheet, width, 12.0 + 38.0 * len(sheet), (*notes, too_short(every)))


@figure()
def figure_momentum(runs: Runs, *, width: Width = "page") -> Sheet:
    """Return the drift of linear and angular momentum of all runs with a free base.

    The drift is the largest change so far, relative to the largest sum, over the run, of the momentum
    magnitudes of the bodies other than the base: the whole system's own momentum may be zero. Impulses of
    forces on links are subtracted.
    """
    every = labelled(runs)
    drawn = [thinned(run, _drifting(run)) for run in long_enough(every) if FREE_BASE.holds(run)]
    if not drawn:
        raise none_with(FREE_BASE, every)
    numbers = itertools.count()
    looks = [IDEAL if run.ideal else {**distinct(next(numbers)), "linewidth": 0.7} for run in drawn]
    panels = []
    for name, scale_name in _MOMENTA:
        lines = []
        for run, look in zip(drawn, looks, strict=True):
            momentum = _without_impulses(run, name)
            scale = size_of(run.values(scale_name))
            drift = np.linalg.norm(momentum - momentum[0], axis=1) / (scale or 1.0)
            lines.append(_so_far(run.legend, run, drift, look))
        y = Axis("largest relative drift so far [-]", shared="drift")
        panels.append(Panel(name.replace("_", " "), lines, y, replace(TIME, ticks=6)))
    panels = _in_decades(panels)
    fixed = [run.label for run in every if not FREE_BASE.holds(run)]
    notes = (too_short(every), f"fixed base, momentum not conserved: {', '.join(fixed)}" if fixed else "")
    page = width == "page"
    rows = [panels] if page else [[one] for one in panels]
    return Sheet(rows, width, 66.0 if page else 110.0, notes, every=True)


def _without_impulses(run: LabelledRun, name: str) -> Array:
    """Return a momentum less the impulses of forces on links, (n, 3)."""
    impulse = {"linear_momentum": "force_impulse", "angular_momentum": "force_central_impulse"}[name]
    momentum = run.values(name)
    return momentum - run.values(impulse).sum(axis=1) if impulse in run.data else momentum


def _drifting(run: LabelledRun) -> Columns:
    """Return the deviation of momenta from those at a run's start."""
    start = replace(run, data=run.data.isel(time=slice(0, 1)))

    def columns(part: LabelledRun) -> list[Array]:
        found = []
        for name, scale in _MOMENTA:
            found += [
                np.linalg.norm(_without_impulses(part, name) - _without_impulses(start, name), axis=1),
                part.values(scale),
            ]
        return found

    return columns


def _ledger(run: LabelledRun) -> list[Array]:
    """Return all entries of the energy ledger, and the size of its error [J]."""
    entries = [_total(run, name) for name, _, _ in (*_STORED, *_LOST)]
    return [*entries, np.abs(run.values("energy_error"))]


def _total(run: LabelledRun, name: str) -> Array:
    """Return the total of a ledger entry over time [J]; zeros if absent."""
    if name not in run.data:
        return np.zeros(run.time.size)
    values = run.values(name)
    return values if values.ndim == 1 else np.asarray(values.sum(axis=1), dtype=float)


def _so_far(label: str, run: LabelledRun, value: Array, look: dict[str, Any]) -> PlotCurve:
    """Return the largest values so far, exact zeros on the logarithmic scale's floor."""
    so_far = np.fmax.accumulate(np.maximum(value, _FLOOR))
    return PlotCurve(label, run.time, so_far, look, many=run.many)


def _in_decades(panels: Sequence[Panel]) -> list[Panel]:
    """Return logarithmic panels over the same decades, with seven ticks at most."""
    values = np.concatenate([line.y for panel in panels for line in panel.curves])
    values = values[np.isfinite(values) & (values > _FLOOR)]
    limits = None
    if values.size:
        low = max(int(np.floor(np.log10(np.quantile(values, 0.02)))), -18)
        high = int(np.floor(np.log10(values.max()))) + 1
        limits = 10.0 ** min(low, high - 2), 10.0**high
    return [replace(one, y=replace(one.y, scale="log", limits=limits, ticks=7)) for one in panels]


# --- at a glance ---


@figure()
def figure_glance(runs: Iterable[Run], *, joint: str | None = None) -> Sheet:
    """Return the position of a joint and, with play, the peak force of every contact.

    It is of a column's width (88 mm), for the head of a page. A ball joint has no position, but peaks.
    """
    every, reference = with_reference(runs, None)
    if joint is not None and not any(joint in (*run.joints, *run.sliding_joints) for run in every):
        name = choose_joint(TOUCHING, every, joint)
        drawn = [run for run in long_enough(every) if _peaks(run, name)[0].size]
        if not drawn:
            raise none_with(TOUCHING, every)
        ends = min(run.time[0] for run in drawn), max(run.time[-1] for run in drawn)
        blows = _blows(Picked(every, drawn, reference, joint=name))
        return Sheet([[replace(blows, x=replace(blows.x, limits=ends))]], "column", 44.0)
    turns = any(run.joints for run in every) if joint is None else False
    slides = any(joint in run.sliding_joints for run in every) if joint is not None else not turns
    word: Quantity = "position" if slides else "angle"
    what = MOTIONS[word]
    picked = pick(runs, joint=(what.of, joint))
    name, value = picked.joint, partial(what.values, joint=picked.joint)
    picked = replace(picked, drawn=[run for run in picked.drawn if name in what.of.names(run)])
    picked = picked.thinned(lambda run: [value(run)])
    x, unit = replace(TIME, ticks=6, shared="time"), unit_of(what.variable)
    y = Axis(word, unit, ticks=3) if slides else Axis(f"{word} [{unit}]", ticks=3)
    panels = [Panel(f"{name}, {word}", picked.curves(value), y, x)]
    struck = any(_peaks(run, name)[0].size for run in picked.drawn)
    if struck:
        panels.append(replace(_blows(picked), x=x, named=False))
    return Sheet([[one] for one in panels], "column", 58.0 if struck else 44.0, letters=False)


def _blows(picked: Picked) -> Panel:
    """Return the peak of every contact in a joint as a line from zero."""
    peaks = [(*_peaks(run, picked.joint), run, look) for run, look in picked.styled]

    def stems(axes: Any, _: float, up: float) -> None:
        for time, force, run, look in peaks:
            looks = {"colors": look["color"], "linewidth": 0.6, "rasterized": time.size > MANY}
            axes.vlines(time, 0.0, up * force, label=run.legend, **looks)

    y = Axis("force", "N", largest_of([force for _, force, _, _ in peaks]), (0.0, None), ticks=3)
    x = replace(TIME, ticks=6)
    return Panel(f"{picked.joint}, peak of every contact", [ByHand(stems)], y, x)


def _peaks(run: LabelledRun, joint: str) -> tuple[Array, Array]:
    """Return times [s] and sizes [N] of the peaks of the contacts in a joint."""
    if joint not in run.clearance_joints or run.whole.data.sizes.get("episode", 0) == 0:
        return np.empty(0), np.empty(0)
    mine = [run.contacts.index(name) for name in run.contacts_of(joint)]
    its = np.isin(run.values("episode_contact").astype(int), mine)
    time, force = run.values("peak_time")[its], run.values("peak_force")[its]
    known = np.isfinite(time) & np.isfinite(force)
    return time[known], force[known]


FIGURES = (
    RunFigure("energy", "Energy: work, storage and losses", figure_energy, compares=False),
    RunFigure("momentum", "Drift of momentum", figure_momentum, needs=FREE_BASE),
)
