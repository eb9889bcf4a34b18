"""Motion of the base and of all joints against the ideal run.

As in the Figures 8 to 16 of You, Pan and Zhao (2010).
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from scipy.spatial.transform import Rotation

from antenna_pin.analysis import base_motion, deviation_over_time
from antenna_pin.base.arguments import takes
from antenna_pin.errors import AntennaPinError, InvalidParameterError, UnknownNameError
from antenna_pin.plot._compared import Curve, Panel, above_round_off, panels_figure, with_differences
from antenna_pin.plot._kinds import FREE_BASE, none_with
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, left_out, long_enough, styles, too_short, with_reference
from antenna_pin.plot._style import Array, Width, footnote, styled
from antenna_pin.plot._thinned import thinned_beside, turning
from antenna_pin.plot.motion import QUANTITIES, Quantity

BaseQuantity = Literal[
    "position", "velocity", "acceleration", "attitude", "angular_velocity", "angular_acceleration"
]
BASE_QUANTITIES: tuple[BaseQuantity, ...] = (
    "position",
    "velocity",
    "acceleration",
    "attitude",
    "angular_velocity",
    "angular_acceleration",
)
_UNITS = {
    "position": "m",
    "velocity": "m/s",
    "acceleration": "m/s^2",
    "attitude": "rad",
    "angular_velocity": "rad/s",
    "angular_acceleration": "rad/s^2",
    "angle": "rad",
    "rate": "rad/s",
}
_COMPONENTS = ("x", "y", "z")
_ANGLES = ("roll about x", "pitch about y", "yaw about z")


@takes()
@styled
def figure_base(
    runs: Iterable[Run] | Run,
    quantity: BaseQuantity = "position",
    *,
    ideal: Run | None = None,
    width: Width = "page",
) -> Figure:
    """Return the motion of the base in all runs: three components, and the size of the deviation.

    World axes; of position and attitude, the change since the start. The attitude is in angles of yaw, pitch
    and roll about the base's own axes in turn; its deviation is the angle between the two attitudes.
    Accelerations with spikes have a scale that is linear as far as the motion between them reaches and
    logarithmic beyond.

    Args:
        runs: Trajectories, or pairs of a label and a dataset; of any lengths.
        quantity: "position", "velocity", "acceleration" of the base's origin, "attitude",
            "angular_velocity" or "angular_acceleration".
        ideal: The run to compare with; the first run without any contact if left out.
        width: "column" (88 mm) or "page" (180 mm).
    """
    if quantity not in BASE_QUANTITIES:
        raise UnknownNameError("figure", "quantity", quantity, BASE_QUANTITIES)
    every, reference = with_reference(runs, ideal)
    drawn = [run for run in long_enough(every) if FREE_BASE.holds(run)]
    if not drawn:
        raise none_with(FREE_BASE, every)
    drawn = _reference_last(drawn, reference)

    def columns(run: LabelledRun) -> list[Array]:
        motion = base_motion(run.data)
        if quantity != "attitude":
            return [np.asarray(motion[quantity].values), *_apart(run, reference, f"base_{quantity}")]
        angles = _components(motion, quantity)
        return [angles, *map(turning, angles.T), *_apart(run, reference, "base_attitude")]

    drawn, reference = thinned_beside(drawn, reference, columns)
    words = "base " + quantity.replace("_", " ")
    looks = dict(zip([run.label for run in drawn], styles(drawn, reference), strict=True))
    motions = [_components(base_motion(run.data), quantity) for run in drawn]
    panels = [
        Panel(
            f"{words}, {(_ANGLES if quantity == 'attitude' else _COMPONENTS)[axis]}",
            quantity.replace("_", " ") if quantity != "attitude" else "angle",
            _UNITS[quantity],
            [
                Curve(run.legend, run.time, motion[:, axis], looks[run.label], run is reference, run.many)
                for run, motion in zip(drawn, motions, strict=True)
            ],
        )
        for axis in range(3)
    ]
    apart = _deviations(drawn, reference, f"base_{quantity}")
    if apart:
        curves = [
            Curve(run.label, time, np.linalg.norm(values, axis=1), looks[run.label], many=run.many)
            for run, time, values in apart
        ]
        title = "size of the deviation from the ideal run"
        panels.append(Panel(title, "deviation", _UNITS[quantity], curves, True))
    else:
        panels = with_differences(panels)
    panels, zero = above_round_off(panels, drawn)
    figure = panels_figure(panels, width, 2, spikes=quantity.endswith("acceleration"))
    footnote(
        figure,
        "angles about the base's own axes in turn" if quantity == "attitude" else "world axes",
        zero,
        too_short(every),
        left_out(every, drawn, "fixed base"),
    )
    return figure


def _components(motion: xr.Dataset, quantity: BaseQuantity) -> Array:
    """Return a quantity over time and three components."""
    if quantity != "attitude":
        values = np.asarray(motion[quantity].values, dtype=float)
        return values - values[0] if quantity == "position" else values
    turn = Rotation.from_quat(motion["attitude"].values)
    yaw_pitch_roll = (turn[0].inv() * turn).as_euler("ZYX")
    return np.asarray(np.unwrap(yaw_pitch_roll, axis=0)[:, ::-1])


@takes()
@styled
def figure_joints(
    runs: Iterable[Run] | Run,
    quantity: Quantity = "angle",
    *,
    ideal: Run | None = None,
    width: Width = "page",
) -> Figure:
    """Return the motion of every joint in all runs, each with its deviation from the ideal run beside it.

    Args:
        runs: Trajectories, or pairs of a label and a dataset; of any lengths.
        quantity: "angle", "rate" or "acceleration" of the joints.
        ideal: The run to compare with; the first run without any contact if left out.
        width: "column" (88 mm) or "page" (180 mm).
    """
    if quantity not in QUANTITIES:
        raise UnknownNameError("figure", "quantity", quantity, QUANTITIES)
    every, reference = with_reference(runs, ideal)
    drawn = _reference_last([run for run in long_enough(every) if run.joints], reference)
    if not drawn:
        raise InvalidParameterError(
            "figure", "runs", "at least one run with a turning joint", ", ".join(run.label for run in every)
        )

    def columns(run: LabelledRun) -> list[Array]:
        return [run.values(f"motion_{quantity}"), *_apart(run, reference, quantity)]

    drawn, reference = thinned_beside(drawn, reference, columns)
    looks = dict(zip([run.label for run in drawn], styles(drawn, reference), strict=True))
    unit = drawn[0].unit(f"motion_{quantity}", _UNITS.get(quantity, "rad/s^2"))
    apart = _deviations(drawn, reference, quantity)
    panels = []
    for joint in dict.fromkeys(name for run in drawn for name in run.joints):
        words = f"{joint.replace('_', ' ')} {quantity}"
        curves = [
            Curve(
                run.legend,
                run.time,
                run.values(f"motion_{quantity}", joint=joint),
                looks[run.label],
                run is reference,
                run.many,
            )
            for run in drawn
            if joint in run.joints
        ]
        panels.append(Panel(words, words, unit, curves))
        curves = [
            Curve(run.label, time, values[:, run.joints.index(joint)], looks[run.label], many=run.many)
            for run, time, values in apart
            if joint in run.joints
        ]
        if curves:
            panels.append(Panel(f"{words}: deviation", "deviation", unit, curves, True))
    panels, zero = above_round_off(panels if apart else with_differences(panels), drawn)
    paired = any(panel.apart for panel in panels)
    figure = panels_figure(panels, width, 2 if paired else 1, spikes=quantity == "acceleration")
    footnote(figure, "deviation: from the ideal run" if apart else "", zero, too_short(every))
    return figure


def _reference_last(runs: list[LabelledRun], reference: LabelledRun | None) -> list[LabelledRun]:
    """Return the runs with the one to compare with last, so that it lies on top."""
    return sorted(runs, key=lambda run: run is reference)


def _deviations(
    runs: list[LabelledRun], reference: LabelledRun | None, name: str
) -> list[tuple[LabelledRun, Array, Array]]:
    """Return runs with times [s] and deviations from the ideal run; those that can be compared."""
    found = []
    for run in runs:
        if reference is None or not reference.ideal or run is reference:
            continue
        try:
            compared = deviation_over_time(run.data, reference.whole.data)
        except AntennaPinError:  # of another mechanism, or of another span of time
            continue
        if name in compared:
            found.append((run, np.asarray(compared["time"].values), np.asarray(compared[name].values)))
    return found


def _apart(run: LabelledRun, reference: LabelledRun | None, name: str) -> list[Array]:
    """Return the deviation of a part of a run from the ideal one, NaN where they cannot be compared.

    Of a vector its size.
    """
    if reference is None or run.source is reference.source:
        return []
    found = _deviations([run], reference, name)
    apart = np.full(run.time.size, np.nan)
    for _, time, values in found:
        first = int(np.searchsorted(run.time, time[0]))
        size = np.linalg.norm(values, axis=1) if name.startswith("base_") else values
        apart = np.full((run.time.size, *size.shape[1:]), np.nan)
        apart[first : first + time.size] = size
    return [apart]


_REPORTED = ("position", "attitude")

FIGURES = tuple(
    RunFigure(
        name=f"base_{quantity}",
        title=f"{quantity.replace('_', ' ').capitalize()} of the base",
        function=figure_base,
        options={"quantity": quantity},
        needs=FREE_BASE,
        reported=quantity in _REPORTED,
    )
    for quantity in BASE_QUANTITIES
) + tuple(
    RunFigure(
        name=f"joints_{quantity}",
        title=f"{quantity.capitalize()} of all joints",
        function=figure_joints,
        options={"quantity": quantity},
        standard=False,
        reported=False,
    )
    for quantity in QUANTITIES
)
