"""What loops, couplings, motions and forces on links exert: sizes of forces, torques, efforts of drives."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence

import numpy as np
from matplotlib.figure import Figure

from antenna_pin.analysis import closures_of, couplings_of, drive_power, drives_of, effort_unit
from antenna_pin.base.arguments import takes
from antenna_pin.plot._compared import Curve, Panel, above_round_off, panels_figure
from antenna_pin.plot._kinds import CLOSED, COUPLED, FORCED, PRESCRIBED, RunKind, none_with
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, left_out, long_enough, styles, too_short, with_reference
from antenna_pin.plot._style import Array, Width, footnote, styled
from antenna_pin.plot._thinned import thinned_beside
from antenna_pin.trajectory import names_along

_OF_CLOSURES = {"force": "N", "moment": "N m"}
_OF_FORCES = {"force": "N", "torque": "N m"}
_Pick = Callable[[LabelledRun], Array | None]


@takes()
@styled
def figure_closure_forces(
    runs: Iterable[Run] | Run, *, ideal: Run | None = None, width: Width = "page"
) -> Figure:
    """Return the sizes of the force and the moment of every closure in all runs.

    The moment is that about the closure's point. Where equations of closures are redundant, the loads are the
    least that do. A closure's moment that is zero to round-off in all runs has no panel. Scales are linear as
    far as the ideal run reaches and logarithmic beyond, where contacts make spikes.

    Args:
        runs: Trajectories, or pairs of a label and a dataset; of any lengths.
        ideal: The run to compare with; the first run without any contact if left out.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every, drawn, reference, names = _along(
        CLOSED, "closure", lambda name: [_size(name, what) for what in _OF_CLOSURES], runs, ideal
    )
    panels: list[Panel] = []
    for name in names:
        kind = next(closures_of(run.data)[name]["kind"] for run in drawn if name in closures_of(run.data))
        for what, unit in _OF_CLOSURES.items():
            panel = _panel(f"{name} ({kind}), {what}", what, unit, drawn, reference, _size(name, what))
            if what == "force" or panel.largest > 0.0:
                panels.append(panel)
    panels, zero = above_round_off(panels, drawn)
    figure = panels_figure(panels, width, 2, spikes=True)
    counts = [json.loads(run.data.attrs["constraints"]) for run in drawn]
    redundant = any(one["closure_equations"] > one["closure_rank"] for one in counts)
    footnote(
        figure,
        "of redundant equations, the least loads that hold the loops" if redundant else "",
        zero,
        too_short(every),
        left_out(every, drawn, "without a closure"),
    )
    return figure


@takes()
@styled
def figure_coupling_torques(
    runs: Iterable[Run] | Run, *, ideal: Run | None = None, width: Width = "page"
) -> Figure:
    """Return the torque of every coupling on its follower in all runs; a force if it slides.

    Scales are linear as far as the ideal run reaches and logarithmic beyond, where contacts make spikes.

    Args:
        runs: Trajectories, or pairs of a label and a dataset; of any lengths.
        ideal: The run to compare with; the first run without any contact if left out.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every, drawn, reference, names = _along(COUPLED, "coupling", lambda name: [_torque(name)], runs, ideal)
    panels: list[Panel] = []
    for name in names:
        one = next(couplings_of(run.data)[name] for run in drawn if name in couplings_of(run.data))
        what, unit = ("force", "N") if one["slides"] else ("torque", "N m")
        title = f"{name}, {what} on {one['follower']}"
        panels.append(_panel(title, what, unit, drawn, reference, _torque(name)))
    figure = panels_figure(panels, width, 2, spikes=True)
    footnote(figure, too_short(every), left_out(every, drawn, "without a coupling"))
    return figure


@takes()
@styled
def figure_drive_efforts(
    runs: Iterable[Run] | Run, *, ideal: Run | None = None, width: Width = "page"
) -> Figure:
    """Return what every drive exerts in all runs, and its power beside it; of a motion, what holds it.

    Scales are linear as far as the ideal run reaches and logarithmic beyond, where contacts make spikes.

    Args:
        runs: Trajectories, or pairs of a label and a dataset; of any lengths.
        ideal: The run to compare with; the first run without any contact if left out.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every, drawn, reference, names = _along(
        PRESCRIBED, "drive", lambda name: [_effort(name), _power(name)], runs, ideal
    )
    panels: list[Panel] = []
    for name in names:
        unit = next(effort_unit(run.data, name) for run in drawn if name in names_along(run.data, "drive"))
        motion = any(drives_of(run.data).get(name, {}).get("motion") for run in drawn)
        what = "force" if unit == "N" else "torque"
        of = f"{'motion' if motion else 'drive'} {name}"
        panels.append(_panel(f"{of}, {what}", what, unit, drawn, reference, _effort(name)))
        panels.append(_panel(f"{of}, power", "power", "W", drawn, reference, _power(name)))
    panels, zero = above_round_off([panel for panel in panels if panel.curves], drawn)
    figure = panels_figure(panels, width, 2, spikes=True)
    footnote(figure, zero, too_short(every), left_out(every, drawn, "without a prescribed motion"))
    return figure


@takes()
@styled
def figure_applied_forces(
    runs: Iterable[Run] | Run, *, ideal: Run | None = None, width: Width = "page"
) -> Figure:
    """Return the sizes of the force and of the torque at every place where forces on links act, in all runs.

    What is zero to round-off in all runs has no panel. Scales are linear as far as the ideal run reaches and
    logarithmic beyond, where there are spikes.

    Args:
        runs: Trajectories, or pairs of a label and a dataset; of any lengths.
        ideal: The run to compare with; the first run without any contact if left out.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every, drawn, reference, names = _along(
        FORCED, "force_place", lambda name: [_applied(name, what) for what in _OF_FORCES], runs, ideal
    )
    panels = [
        _panel(f"{name}, {what}", what, unit, drawn, reference, _applied(name, what))
        for name in names
        for what, unit in _OF_FORCES.items()
    ]
    panels = [panel for panel in panels if panel.largest > 0.0] or panels[:1]
    panels, zero = above_round_off(panels, drawn)
    figure = panels_figure(panels, width, 2, spikes=True)
    footnote(figure, zero, too_short(every), left_out(every, drawn, f"without {FORCED.words}"))
    return figure


def _along(
    kind: RunKind,
    dimension: str,
    picks: Callable[[str], Sequence[_Pick]],
    runs: Iterable[Run] | Run,
    ideal: Run | None,
) -> tuple[list[LabelledRun], list[LabelledRun], LabelledRun | None, list[str]]:
    """Return all runs, those to be drawn, the one to compare with, and the names along a dimension in them.

    The one to compare with is drawn last, so that it lies on top; all are thinned to what can be seen.

    Args:
        kind: Of the runs to be drawn.
        dimension: Of the result.
        picks: What is drawn of a name.
        runs: As a figure is given them.
        ideal: As a figure is given it.
    """
    every, reference = with_reference(runs, ideal)
    drawn = [run for run in long_enough(every) if kind.holds(run)]
    if not drawn:
        raise none_with(kind, every)
    drawn.sort(key=lambda run: run is reference)

    def columns(run: LabelledRun) -> list[Array]:
        found = (pick(run) for name in names_along(run.data, dimension) for pick in picks(name))
        return [one for one in found if one is not None]

    drawn, reference = thinned_beside(drawn, reference, columns)
    names = list(dict.fromkeys(name for run in drawn for name in names_along(run.data, dimension)))
    return every, drawn, reference, names


def _panel(
    title: str,
    label: str,
    unit: str,
    runs: Sequence[LabelledRun],
    reference: LabelledRun | None,
    pick: _Pick,
) -> Panel:
    curves = []
    for run, style in zip(runs, styles(runs, reference), strict=True):
        values = pick(run)
        if values is not None:
            curves.append(Curve(run.legend, run.time, values, style, run is reference, run.many))
    return Panel(title, label, unit, curves, apart=True)


def _picked(dimension: str, name: str, values: _Pick) -> _Pick:
    """Return what gives values of a name in a run that has it."""
    return lambda run: values(run) if name in names_along(run.data, dimension) else None


def _size(name: str, what: str) -> _Pick:
    def size(run: LabelledRun) -> Array:
        return np.asarray(np.linalg.norm(run.values(f"closure_{what}", closure=name), axis=1))

    return _picked("closure", name, size)


def _applied(name: str, what: str) -> _Pick:
    def size(run: LabelledRun) -> Array:
        return np.asarray(np.linalg.norm(run.values(f"applied_{what}", force_place=name), axis=1))

    return _picked("force_place", name, size)


def _torque(name: str) -> _Pick:
    return _picked("coupling", name, lambda run: run.values("coupling_torque", coupling=name))


def _effort(name: str) -> _Pick:
    return _picked("drive", name, lambda run: run.values("drive_torque", drive=name))


def _power(name: str) -> _Pick:
    return _picked("drive", name, lambda run: drive_power(run.data, name))


FIGURES = (
    RunFigure(
        name="closure_forces",
        title="Forces of the closures",
        function=figure_closure_forces,
        needs=CLOSED,
    ),
    RunFigure(
        name="coupling_torques",
        title="Torques of the couplings",
        function=figure_coupling_torques,
        needs=COUPLED,
    ),
    RunFigure(
        name="drive_efforts",
        title="What the drives exert",
        function=figure_drive_efforts,
        needs=PRESCRIBED,
    ),
    RunFigure(
        name="applied_forces",
        title="Forces on links",
        function=figure_applied_forces,
        needs=FORCED,
    ),
)
