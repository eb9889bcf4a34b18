"""Where the antenna looks, and by how much it misses."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from matplotlib.figure import Figure

from antenna_pin.analysis import boresight, pointing_error
from antenna_pin.base.arguments import takes
from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.plot._compared import Curve, Panel, panels_figure
from antenna_pin.plot._kinds import POINTED
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, left_out, long_enough, styles, too_short, with_reference
from antenna_pin.plot._style import Array, Width, footnote, styled
from antenna_pin.plot._thinned import thinned_beside, turning

_CROSS = ("cross", "up")
# Between two samples that are drawn an angle that goes on turns by less [rad]; through a pole it jumps by pi.
_JUMP = 2.5
_AT_A_POLE = "azimuth jumps where the boresight passes straight up or down"


@takes()
@styled
def figure_pointing(runs: Iterable[Run] | Run, *, ideal: Run | None = None, width: Width = "page") -> Figure:
    """Return the boresight's azimuth and elevation, and the pointing error, over time.

    The error is that against the ideal run, or against the commanded direction where the scenario names one
    and no ideal run is among them: turns of the boresight about the antenna's ``cross`` and ``up`` axes, and
    the half-cone angle between both boresights.

    Args:
        runs: Trajectories, or pairs of a label and a dataset, whose scenario has a table ``[pointing]``.
        ideal: The run to compare with; the first run without any contact if left out.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every, reference = with_reference(runs, ideal)
    long = sorted(long_enough(every), key=lambda run: run is reference)
    long, reference = thinned_beside(long, reference, lambda run: _columns(run, reference))
    looks = dict(zip([run.label for run in long], styles(long, reference), strict=True))
    directions, errors = {}, {}
    drawn: list[LabelledRun] = []
    for run in long:
        try:
            directions[run.label] = boresight(run.data)
        except AntennaPinError:  # its scenario does not say what looks where
            continue
        drawn.append(run)
        if run is not reference:
            try:
                errors[run.label] = pointing_error(
                    run.data, None if reference is None else reference.whole.data
                )
            except AntennaPinError:  # nothing to compare with
                continue
    if not drawn:
        raise InvalidParameterError(
            "figure",
            "runs",
            "at least one whose scenario has a table [pointing]",
            ", ".join(run.label for run in every),
        )
    panels = [
        Panel(
            f"{name} of the boresight in the world",
            name,
            "rad",
            [
                Curve(
                    run.legend,
                    *_broken(run.time, np.asarray(directions[run.label][name].values, dtype=float)),
                    looks[run.label],
                    run is reference,
                    run.many,
                )
                for run in drawn
            ],
        )
        for name in ("azimuth", "elevation")
    ]
    missed = [run for run in drawn if run.label in errors]
    for axis in _CROSS if missed else ():
        panels.append(
            Panel(
                f"turn of the boresight about {axis}",
                "error",
                "rad",
                [
                    Curve(
                        run.label,
                        run.time,
                        np.asarray(errors[run.label]["boresight_error"].sel(cross_axis=axis).values),
                        looks[run.label],
                        many=run.many,
                    )
                    for run in missed
                ],
                True,
            )
        )
    if missed:
        cones = [
            Curve(
                run.label,
                run.time,
                np.asarray(errors[run.label]["half_cone"].values),
                looks[run.label],
                many=run.many,
            )
            for run in missed
        ]
        panels.append(Panel("half-cone error", "error", "rad", cones, True))
    figure = panels_figure(panels, width, 2)
    against = dict.fromkeys(str(errors[run.label].attrs["against"]) for run in missed)
    footnote(
        figure,
        f"error against the {', '.join(against)}" if against else "",
        _AT_A_POLE if any(np.isnan(curve.value).any() for curve in panels[0].curves) else "",
        too_short(every),
        left_out(every, drawn, "scenario without pointing"),
    )
    return figure


def _broken(time: Array, angle: Array) -> tuple[Array, Array]:
    """Return an angle over time with a gap where it jumps: an azimuth, as the boresight passes the pole."""
    jumps = np.flatnonzero(np.abs(np.diff(angle)) > _JUMP) + 1
    return np.insert(time, jumps, time[jumps]), np.insert(angle, jumps, np.nan)


def _columns(run: LabelledRun, reference: LabelledRun | None) -> list[Array]:
    """Return all that is drawn of a part of a run; nothing where it does not say what looks where."""
    try:
        looks = boresight(run.data)
    except AntennaPinError:
        return []
    found = [np.asarray(looks[name].values) for name in ("azimuth", "elevation")]
    found.append(turning(found[0]))
    if reference is None or run.source is not reference.source:
        try:
            error = pointing_error(run.data, None if reference is None else reference.whole.data)
        except AntennaPinError:
            return found
        found += [np.asarray(error[name].values) for name in ("boresight_error", "half_cone")]
    return found


FIGURES = (
    RunFigure(name="pointing", title="Boresight and pointing error", function=figure_pointing, needs=POINTED),
)
