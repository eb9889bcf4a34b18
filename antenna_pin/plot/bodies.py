"""Path of the body that a joint moves, component by component, with its deviation from the ideal run.

As in the Figures 5 to 7 of Chen and Cui (2021): the whole, and an enlarged view of what clearance does.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, get_args

import numpy as np
from matplotlib.figure import Figure

from antenna_pin.analysis import body_deviation, body_motion, moved_body
from antenna_pin.base.arguments import takes
from antenna_pin.errors import AntennaPinError, UnknownNameError
from antenna_pin.plot._compared import Curve, Panel, above_round_off, panels_figure, with_differences
from antenna_pin.plot._kinds import LOOPED, MOVING, choose_joint
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, long_enough, styles, too_short, with_reference
from antenna_pin.plot._style import Array, Width, footnote, styled
from antenna_pin.plot._thinned import thinned_beside

BodyQuantity = Literal["position", "velocity", "acceleration"]
BODY_QUANTITIES: tuple[BodyQuantity, ...] = get_args(BodyQuantity)
_UNITS = {"position": "m", "velocity": "m/s", "acceleration": "m/s^2"}


@takes()
@styled
def figure_body(
    runs: Iterable[Run] | Run,
    quantity: BodyQuantity = "position",
    *,
    joint: str | None = None,
    ideal: Run | None = None,
    width: Width = "page",
) -> Figure:
    """Return the motion of the body that a joint moves in all runs, each component with its deviation.

    World axes, without components that are zero to round-off; of the body's frame as the URDF has it. The
    deviation is from the ideal run. Accelerations with spikes have a scale that is linear as far as the ideal
    run reaches and logarithmic beyond.

    Args:
        runs: Trajectories, or pairs of a label and a dataset; of any lengths.
        quantity: "position", "velocity" or "acceleration" of the frame's origin.
        joint: Name of the joint; the first one with clearance if left out.
        ideal: The run to compare with; the first run without any contact if left out.
        width: "column" (88 mm) or "page" (180 mm).
    """
    if quantity not in BODY_QUANTITIES:
        raise UnknownNameError("figure", "quantity", quantity, BODY_QUANTITIES)
    every, reference = with_reference(runs, ideal)
    joint = choose_joint(MOVING, every, joint)
    drawn = sorted(long_enough(every), key=lambda run: run is reference)
    body = moved_body(drawn[0].data, joint)

    def columns(run: LabelledRun) -> list[Array]:
        return [
            np.asarray(body_motion(run.data, body)[quantity].values),
            *_apart(run, reference, body, quantity),
        ]

    drawn, reference = thinned_beside(drawn, reference, columns)
    looks = dict(zip([run.label for run in drawn], styles(drawn, reference), strict=True))
    motions = [np.asarray(body_motion(run.data, body)[quantity].values, dtype=float) for run in drawn]
    apart = _deviations(drawn, reference, body, quantity)
    panels = []
    for axis, component in enumerate("xyz"):
        words = f"{body.replace('_', ' ')} {quantity}, {component}"
        curves = [
            Curve(run.legend, run.time, motion[:, axis], looks[run.label], run is reference, run.many)
            for run, motion in zip(drawn, motions, strict=True)
        ]
        panels.append(Panel(words, f"{component} {quantity}", _UNITS[quantity], curves))
        curves = [
            Curve(run.label, time, values[:, axis], looks[run.label], many=run.many)
            for run, time, values in apart
        ]
        if curves:
            title = f"deviation along {component} from the ideal run"
            panels.append(Panel(title, "deviation", _UNITS[quantity], curves, True))
    panels, zero = above_round_off(panels if apart else with_differences(panels), drawn)
    paired = any(panel.apart for panel in panels)
    figure = panels_figure(panels, width, 2 if paired else 1, spikes=quantity == "acceleration")
    footnote(figure, "world axes", zero, too_short(every))
    return figure


def _deviations(
    runs: list[LabelledRun], reference: LabelledRun | None, body: str, quantity: str
) -> list[tuple[LabelledRun, Array, Array]]:
    """Return runs with times [s] and deviations from the ideal run; those that can be compared."""
    found = []
    for run in runs:
        if reference is None or not reference.ideal or run is reference:
            continue
        try:
            compared = body_deviation(run.data, reference.whole.data, body)
        except AntennaPinError:  # of another mechanism, or of another span of time
            continue
        found.append((run, np.asarray(compared["time"].values), np.asarray(compared[quantity].values)))
    return found


def _apart(run: LabelledRun, reference: LabelledRun | None, body: str, quantity: str) -> list[Array]:
    """Return the deviation of a part of a run from the ideal one, NaN where they cannot be compared."""
    if reference is None or run.source is reference.source:
        return []
    apart = np.full((run.time.size, 3), np.nan)
    for _, time, values in _deviations([run], reference, body, quantity):
        first = int(np.searchsorted(run.time, time[0]))
        apart[first : first + time.size] = values
    return [apart]


FIGURES = tuple(
    RunFigure(
        name=f"body_{quantity}",
        title=f"{quantity.capitalize()} of the body that {{joint}} moves",
        function=figure_body,
        options={"quantity": quantity},
        of=LOOPED,
        reported=quantity == "position",
    )
    for quantity in BODY_QUANTITIES
)
