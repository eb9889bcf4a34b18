"""All of the motion of one joint: angle, rate, acceleration, each with its deviation from the ideal run."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from matplotlib.figure import Figure

from antenna_pin.base.arguments import takes
from antenna_pin.plot._compared import Curve, Panel, above_round_off, panels_figure, with_differences
from antenna_pin.plot._kinds import GUIDED, PLAYLESS, SLIDING, choose_joint
from antenna_pin.plot._motion_curves import MotionCurve, curves_of, drawn_columns
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, left_out, long_enough, styles, too_short, with_reference
from antenna_pin.plot._style import Array, Width, footnote, styled
from antenna_pin.plot._thinned import thinned_beside
from antenna_pin.plot.motion import MOTIONS, Quantity

__all__ = ["FIGURES", "figure_joint"]


@takes()
@styled
def figure_joint(
    runs: Iterable[Run] | Run, *, joint: str | None = None, ideal: Run | None = None, width: Width = "page"
) -> Figure:
    """Return angle, rate, acceleration of one joint in all runs, each with its deviation from the ideal run.

    Of a joint that slides, its position and the like. Without an ideal run, of runs that coincide what they
    are less the first. What is zero to round-off is said below. Accelerations with spikes have a scale that
    is linear as far as the motion between them reaches and logarithmic beyond.

    Args:
        runs: Trajectories, or pairs of a label and a dataset; of any lengths.
        joint: Name of the joint; the first one with clearance if left out.
        ideal: The run to compare with; the first run without any contact if left out.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every, reference = with_reference(runs, ideal)
    name = choose_joint(GUIDED, every, joint)
    quantities = _quantities(every, name)
    drawn = [run for run in long_enough(every) if name in MOTIONS[quantities[0]].of.names(run)]
    drawn.sort(key=lambda run: run is reference)

    def columns(run: LabelledRun) -> list[Array]:
        return [one for q in quantities for one in drawn_columns(reference, name, MOTIONS[q])(run)]

    drawn, reference = thinned_beside(drawn, reference, columns)
    looks = dict(zip([run.label for run in drawn], styles(drawn, reference), strict=True))
    panels: list[Panel] = []
    for quantity in quantities:
        what = MOTIONS[quantity]
        words = f"{name.replace('_', ' ')} {quantity.removeprefix('slide ')}"
        unit = drawn[0].unit(what.variable, what.unit)
        found = curves_of(drawn, reference, name, what)
        by_run = dict(zip((run.label for run in drawn), found, strict=True))
        panels.append(Panel(words, words, unit, [_curve(run, by_run, looks) for run in drawn]))
        apart = [_apart(run, by_run, looks) for run in drawn if by_run[run.label].deviation is not None]
        if apart:
            panels.append(Panel(f"{words}: deviation", "deviation", unit, apart, True))
    compared = any(panel.apart for panel in panels)
    panels, zero = above_round_off(panels if compared else with_differences(panels), drawn)
    paired = any(panel.apart for panel in panels)
    figure = panels_figure(panels, width, 2 if paired else min(len(panels), 3), spikes=True)
    footnote(
        figure,
        "deviation: from the ideal run" if compared and paired else "",
        zero,
        too_short(every),
        left_out(every, drawn, "without this joint"),
    )
    return figure


def _quantities(runs: Sequence[LabelledRun], joint: str) -> list[Quantity]:
    """Return the quantities of a joint's motion."""
    slides = any(joint in run.sliding_joints for run in runs)
    return [quantity for quantity, what in MOTIONS.items() if (what.of is SLIDING) == slides]


def _curve(run: LabelledRun, found: dict[str, MotionCurve], looks: dict[str, dict[str, object]]) -> Curve:
    one = found[run.label]
    return Curve(run.legend, one.time, one.value, looks[run.label], one.is_ideal, one.many)


def _apart(run: LabelledRun, found: dict[str, MotionCurve], looks: dict[str, dict[str, object]]) -> Curve:
    one = found[run.label]
    assert one.deviation is not None
    return Curve(run.label, one.time, one.deviation, looks[run.label], many=one.many)


FIGURES = (
    RunFigure(
        name="joint_motion",
        title="Motion of {joint}",
        function=figure_joint,
        of=PLAYLESS,
        reported=False,
    ),
)
