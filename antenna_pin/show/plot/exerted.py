"""Forces through joints, of closures, couplings, drives, and on links, in all runs."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from antenna_pin.analysis import closures_of, couplings_of, drive_power, drives_of, effort_unit, joint_loads
from antenna_pin.errors import InvalidParameterError
from antenna_pin.show.plot._compared import Picked, above_round_off, panels_sheet, pick
from antenna_pin.show.plot._kinds import CLOSED, COUPLED, FORCED, LOOPED, MOVING, PRESCRIBED, RunFigure
from antenna_pin.show.plot._runs import LabelledRun, Run, Runs, unit_of
from antenna_pin.show.plot._style import Array, Width, prefixed
from antenna_pin.show.plot.grammar import Axis, Panel, PlotCurve, Sheet, close_view, figure, in_rows, size_of
from antenna_pin.trajectory import names_along

# --- through a joint ---

_DECADES = 5
_Span = tuple[float, float]


@figure()
def figure_joint_load(
    runs: Runs,
    *,
    joint: str | None = None,
    ideal: Run | None = None,
    zoom: _Span | None = None,
    width: Width = "page",
) -> Sheet:
    """Return the size of the force through a joint on a logarithmic scale.

    The force is that of inverse dynamics of the recorded motion, so that an ideal joint has one as well. A
    run with clearance is sampled at the largest force of every contact, so its peaks are there. In free
    flight the force is zero and the line leaves the panel. The close view lies around the largest force.
    """
    picked, curves = _forces(runs, ideal, joint)
    largest = [size_of(curve.y) for curve in curves]
    overall = max(largest)
    if not overall > 0.0:
        rule = f"at least one in which a force goes through {picked.joint}"
        raise InvalidParameterError("figure", "runs", rule, said="0 N in all of them")
    hardest = curves[int(np.argmax(largest))]
    start, end = float(hardest.x[0]), float(hardest.x[-1])
    window = zoom or _around(hardest, start, end, 0.005 * (end - start))
    curves = _closer(picked, curves, window)
    factor, printed = prefixed("N", overall)
    top = 10.0 ** np.ceil(np.log10(1.05 * factor * overall)) / factor
    whole = min(one.x[0] for one in curves), max(one.x[-1] for one in curves)
    y = Axis(_words(picked.joint), "N", overall, (top / 10.0**_DECADES, top), "log", 0)
    ratios = _ratios(picked, largest)
    return _with_close_view(curves, y, (whole, window), "whole span", width, (ratios, *picked.notes))


@figure()
def figure_steady_force(
    runs: Runs,
    *,
    joint: str | None = None,
    ideal: Run | None = None,
    zoom: _Span | None = None,
    width: Width = "page",
) -> Sheet:
    """Return the size of the force through a joint in the run's second half.

    The impacts of the start have died away then, and the scale is linear; the force is that of inverse
    dynamics of the recorded motion, as in :func:`figure_joint_load`. The close view lies around the largest
    force of that half.
    """
    picked, curves = _forces(runs, ideal, joint)
    start, end = min(one.x[0] for one in curves), max(one.x[-1] for one in curves)
    middle = 0.5 * (start + end)
    held = [replace(one, y=np.where(one.x >= middle, one.y, 0.0)) for one in curves]
    hardest = max(held, key=lambda one: float(np.nanmax(one.y)))
    half = 0.02 * (end - start)
    window = zoom or _around(hardest, middle, end, half)
    curves = _closer(picked, curves, window)
    y = Axis(_words(picked.joint), "N", size_of(hardest.y))
    spans = ((middle, end), window)
    return _with_close_view(curves, y, spans, "second half of the run", width, picked.notes)


def _words(joint: str) -> str:
    return f"force through {joint.replace('_', ' ')}"


def _with_close_view(
    curves: Sequence[PlotCurve],
    y: Axis,
    spans: tuple[_Span, _Span],
    title: str,
    width: Width,
    notes: Sequence[str],
) -> Sheet:
    """Return curves over a span and in a close view."""
    linear = y.scale == "linear"
    panels: list[Panel] = []
    for words, span in zip((title, "close view of the shaded span"), spans, strict=True):
        seen = [(one, (one.x >= span[0]) & (one.x <= span[1])) for one in curves] if linear else []
        shown = [replace(one, x=one.x[mine], y=one.y[mine]) for one, mine in seen] or list(curves)
        shades = [] if panels else [close_view(spans[1])]
        x = Axis("time [s]", limits=span, ticks=6 if linear else 5)
        panels.append(Panel(words, [*shown, *shades], y, x))
    if linear or width == "column":
        return Sheet([[one] for one in panels], width, 110.0, notes, every=True)
    return Sheet(in_rows(panels, 2), width, 66.0, notes)


def _forces(runs: Runs, ideal: Run | None, joint: str | None) -> tuple[Picked, list[PlotCurve]]:
    """Return the runs that have the joint, and the sizes of its force [N]."""
    picked = pick(runs, ideal=ideal, joint=(MOVING, joint))
    known = [joint_loads(run.data, [0])["moving_joint"].values for run in picked.drawn]
    has = [run for run, names in zip(picked.drawn, known, strict=True) if picked.joint in names]
    picked = replace(picked, drawn=has).thinned(lambda part: [_force(part, picked.joint)])
    return picked, picked.curves(lambda run: _force(run, picked.joint))


def _closer(picked: Picked, curves: list[PlotCurve], window: _Span) -> list[PlotCurve]:
    """Return sizes of the force with all samples in a close view."""
    if all(run.kept is None for run in picked.drawn):
        return curves
    near = picked.closer(window, lambda part: [_force(part, picked.joint)])
    return near.curves(lambda run: _force(run, picked.joint))


def _force(run: LabelledRun, joint: str) -> Array:
    """Return the size of the force through a joint [N], (n,)."""
    force = joint_loads(run.data)["force"].sel(moving_joint=joint)
    return np.asarray(np.linalg.norm(np.asarray(force.values, dtype=float), axis=1))


def _around(curve: PlotCurve, start: float, end: float, half: float) -> _Span:
    """Return the span of a half width around the largest force."""
    centre = min(max(float(curve.x[int(np.nanargmax(curve.y))]), start + half), end - half)
    return centre - half, centre + half


def _ratios(picked: Picked, largest: list[float]) -> str:
    """Return each run's largest force over that of the ideal joint."""
    reference = picked.reference
    if reference is None or reference not in picked.drawn:
        return ""
    base = largest[picked.drawn.index(reference)]
    parts = [
        f"{run.label} {size / base:.3g}"
        for run, size in zip(picked.drawn, largest, strict=True)
        if run is not reference and base > 0.0
    ]
    words = f"largest force of the whole run over that of {reference.label}"
    return f"{words}: {', '.join(parts)}" if parts else ""


# --- of elements: a panel for each in all runs ---

_Pick = Callable[[LabelledRun], Array | None]
#: What is drawn of an element: title and value axis of a panel, and what gives the values.
_Drawn = tuple[str, Axis, _Pick]


def _read(dimension: str, name: str, variable: str, what: str) -> tuple[Axis, _Pick]:
    """Return axis and reader of an element's variable, or of its size."""

    def values(run: LabelledRun) -> Array | None:
        if name not in names_along(run.data, dimension):
            return None
        found = run.values(variable, **{dimension: name})
        return found if found.ndim == 1 else np.asarray(np.linalg.norm(found, axis=1))

    return Axis(what, unit_of(variable, what == "force")), values


def _panels(
    picked: Picked, dimension: str, drawn: Callable[[str], Sequence[_Drawn]]
) -> tuple[Picked, list[Panel]]:
    """Return runs, thinned, and the panels of every element along a dimension."""
    by_name = {name: drawn(name) for name in picked.names(dimension)}
    every = [one for of_name in by_name.values() for one in of_name]

    def columns(run: LabelledRun) -> list[Array]:
        return [values for *_, pick_one in every if (values := pick_one(run)) is not None]

    picked = picked.thinned(columns)
    return picked, [Panel(title, picked.curves(one), y, apart=True) for title, y, one in every]


def _sheet(panels: Sequence[Panel], picked: Picked, width: Width, note: str = "") -> Sheet:
    shown, zero = above_round_off(panels, picked.drawn)
    return panels_sheet(shown, width, 2, (note, zero, *picked.notes), spikes=True)


@figure()
def figure_closure_forces(runs: Runs, *, ideal: Run | None = None, width: Width = "page") -> Sheet:
    """Return the sizes of the force and the moment of every closure in all runs.

    The moment is that about the closure's point. Where equations of closures are redundant, the loads are the
    least that do. A closure's moment that is zero to round-off in all runs has no panel. Scales are linear as
    far as the ideal run reaches and logarithmic beyond, where contacts make spikes.
    """
    picked = pick(runs, CLOSED, ideal)

    def drawn(name: str) -> list[_Drawn]:
        every = (closures_of(run.data) for run in picked.drawn)
        title = f"{name} ({next(one[name]['kind'] for one in every if name in one)})"
        return [
            (f"{title}, {what}", *_read("closure", name, f"closure_{what}", what))
            for what in ("force", "moment")
        ]

    picked, panels = _panels(picked, "closure", drawn)
    panels = [one for one in panels if one.y.unit == "N" or one.largest > 0.0]
    counts = [json.loads(run.data.attrs["constraints"]) for run in picked.drawn]
    redundant = any(one["closure_equations"] > one["closure_rank"] for one in counts)
    note = "of redundant equations, the least loads that hold the loops" if redundant else ""
    return _sheet(panels, picked, width, note)


@figure()
def figure_coupling_torques(runs: Runs, *, ideal: Run | None = None, width: Width = "page") -> Sheet:
    """Return the torque (a force if it slides) of every coupling on its follower.

    Scales are linear as far as the ideal run reaches and logarithmic beyond, where contacts make spikes.
    """
    picked = pick(runs, COUPLED, ideal)

    def drawn(name: str) -> list[_Drawn]:
        one = next(found[name] for run in picked.drawn if name in (found := couplings_of(run.data)))
        what = "force" if one["slides"] else "torque"
        title = f"{name}, {what} on {one['follower']}"
        return [(title, *_read("coupling", name, "coupling_torque", what))]

    picked, panels = _panels(picked, "coupling", drawn)
    return panels_sheet(panels, width, 2, picked.notes, spikes=True)


@figure()
def figure_drive_efforts(runs: Runs, *, ideal: Run | None = None, width: Width = "page") -> Sheet:
    """Return the effort of every drive or prescribed motion, and its power.

    Scales are linear as far as the ideal run reaches and logarithmic beyond, where contacts make spikes.
    """
    picked = pick(runs, PRESCRIBED, ideal)

    def drawn(name: str) -> list[_Drawn]:
        def power(run: LabelledRun) -> Array | None:
            return drive_power(run.data, name) if name in names_along(run.data, "drive") else None

        has = (run for run in picked.drawn if name in names_along(run.data, "drive"))
        what = "force" if next(effort_unit(run.data, name) for run in has) == "N" else "torque"
        motion = any(drives_of(run.data).get(name, {}).get("motion") for run in picked.drawn)
        title = f"{'motion' if motion else 'drive'} {name}"
        effort = (f"{title}, {what}", *_read("drive", name, "drive_torque", what))
        return [effort, (f"{title}, power", Axis("power", "W"), power)]

    picked, panels = _panels(picked, "drive", drawn)
    return _sheet(panels, picked, width)


@figure()
def figure_applied_forces(runs: Runs, *, ideal: Run | None = None, width: Width = "page") -> Sheet:
    """Return the sizes of force and torque at every place of forces on links.

    Loads that are zero to round-off in all runs have no panel. Scales are linear as far as the ideal run
    reaches and logarithmic beyond, where there are spikes.
    """

    def drawn(name: str) -> list[_Drawn]:
        return [
            (f"{name}, {what}", *_read("force_place", name, f"applied_{what}", what))
            for what in ("force", "torque")
        ]

    picked, panels = _panels(pick(runs, FORCED, ideal), "force_place", drawn)
    return _sheet([panel for panel in panels if panel.largest > 0.0] or panels[:1], picked, width)


FIGURES = (
    RunFigure("joint_load", "Force through {joint}", figure_joint_load, of=MOVING),
    RunFigure(
        "steady_force",
        "Force through {joint} in the second half of the run",
        figure_steady_force,
        of=LOOPED,
        reported=False,
    ),
    RunFigure("closure_forces", "Forces of the closures", figure_closure_forces, needs=CLOSED),
    RunFigure("coupling_torques", "Torques of the couplings", figure_coupling_torques, needs=COUPLED),
    RunFigure("drive_efforts", "What the drives exert", figure_drive_efforts, needs=PRESCRIBED),
    RunFigure("applied_forces", "Forces on links", figure_applied_forces, needs=FORCED),
)
