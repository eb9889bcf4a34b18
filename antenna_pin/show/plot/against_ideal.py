"""Motion of joints, base, bodies and boresight, with deviations from the ideal run.

As in the Figures 11 and 12 of Bai and Zhao (2020), 8 to 16 of You, Pan and Zhao (2010), and 5 to 7 of Chen
and Cui (2021): the whole, and an enlarged view of what clearance does.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Literal, get_args

import numpy as np
import xarray as xr
from scipy.spatial.transform import Rotation

from antenna_pin.analysis import (
    base_motion,
    body_deviation,
    body_motion,
    boresight,
    deviation_over_time,
    moved_body,
    pointing_error,
    samples_around,
)
from antenna_pin.errors import AntennaPinError, UnknownNameError
from antenna_pin.show.plot._compared import (
    Picked,
    above_round_off,
    panels_sheet,
    pick,
    straight,
    with_differences,
)
from antenna_pin.show.plot._kinds import (
    FREE_BASE,
    GUIDED,
    LOOPED,
    MOVING,
    PLAYLESS,
    POINTED,
    SLIDING,
    TURNING,
    RunFigure,
    refusal,
)
from antenna_pin.show.plot._runs import LabelledRun, Run, Runs, left_out, too_short, unit_of
from antenna_pin.show.plot._style import Array, Width
from antenna_pin.show.plot._thinned import turning
from antenna_pin.show.plot.grammar import Axis, Panel, PlotCurve, Sheet, figure
from antenna_pin.show.plot.motion import (
    MOTIONS,
    QUANTITIES,
    MotionQuantity,
    Quantity,
    deviation_of,
    drawn_columns,
)

BodyQuantity = Literal["position", "velocity", "acceleration"]
BODY_QUANTITIES: tuple[BodyQuantity, ...] = get_args(BodyQuantity)
BaseQuantity = Literal[
    "position", "velocity", "acceleration", "attitude", "angular_velocity", "angular_acceleration"
]
BASE_QUANTITIES: tuple[BaseQuantity, ...] = get_args(BaseQuantity)
_UNITS = {
    "position": "m",
    "velocity": "m/s",
    "acceleration": "m/s^2",
    "attitude": "rad",
    "angular_velocity": "rad/s",
    "angular_acceleration": "rad/s^2",
}
_FROM_IDEAL = "deviation: from the ideal run"

# --- one joint ---


@figure()
def figure_joint(
    runs: Runs, *, joint: str | None = None, ideal: Run | None = None, width: Width = "page"
) -> Sheet:
    """Return angle, rate and acceleration of one joint, with deviations from the ideal run.

    A joint that slides has its position and the like. Without an ideal run, runs that coincide have their
    differences from the first. Quantities that are zero to round-off are named below. Accelerations with
    spikes have a scale that is linear as far as the motion between spikes reaches, and logarithmic beyond.
    """
    picked = pick(runs, ideal=ideal, joint=(GUIDED, joint), why="without this joint")
    name = picked.joint
    slides = any(name in run.sliding_joints for run in picked.every)
    motions = {quantity: what for quantity, what in MOTIONS.items() if (what.of is SLIDING) == slides}
    names = SLIDING.names if slides else TURNING.names
    picked = replace(picked, drawn=[run for run in picked.drawn if name in names(run)])
    whole = picked.reference

    def columns(run: LabelledRun) -> list[Array]:
        return [one for what in motions.values() for one in drawn_columns(whole, name, what)(run)]

    picked = picked.thinned(columns)
    reference = picked.reference
    panels: list[Panel] = []
    for quantity, what in motions.items():
        words = f"{name.replace('_', ' ')} {quantity.removeprefix('slide ')}"
        unit = picked.drawn[0].unit(what.variable)

        def apart(run: LabelledRun, what: MotionQuantity = what) -> tuple[Array, Array] | None:
            found = deviation_of(run, what.values(run, name), reference, name, what)
            return None if found is None else (run.time, found)

        panels.append(Panel(words, picked.curves(partial(what.values, joint=name)), Axis(words, unit)))
        panels += _deviation(f"{words}: deviation", picked.deviations(apart), unit)
    return _compared(panels, picked, width, _FROM_IDEAL, spikes=True, columns=0)


def _deviation(title: str, curves: Sequence[PlotCurve], unit: str) -> list[Panel]:
    """Return the panel of deviations, if there are any."""
    return [Panel(title, curves, Axis("deviation", unit), apart=True)] if curves else []


def _compared(
    panels: Sequence[Panel], picked: Picked, width: Width, note: str, *, spikes: bool, columns: int = 1
) -> Sheet:
    """Return panels in pairs with their deviations, or with differences of runs that coincide.

    A note on deviations is drawn where there are any only. ``columns`` is the number of panels in a row of a
    page without deviations; 0 stands for as many as there are, at most three.
    """
    compared = any(panel.apart for panel in panels)
    shown, zero = above_round_off(panels if compared else with_differences(panels), picked.drawn)
    paired = any(panel.apart for panel in shown)
    if note is _FROM_IDEAL and not (compared and (paired or columns)):
        note = ""
    columns = 2 if paired else columns or min(len(shown), 3)
    return panels_sheet(shown, width, columns, (note, zero, *picked.notes), spikes=spikes)


@figure(
    quantity='"angle" or "rate" of a joint that turns.',
    base="Label of the run that those behind it are compared with; the first but the ideal one if left out.",
)
def figure_between(
    runs: Runs,
    quantity: Quantity = "angle",
    *,
    joint: str | None = None,
    ideal: Run | None = None,
    base: str | None = None,
    width: Width = "page",
) -> Sheet:
    """Return the motion of one joint less the ideal run's and another run's."""
    what = MOTIONS[quantity]
    picked = pick(runs, ideal=ideal, joint=(what.of, joint))
    name = picked.joint
    picked = replace(picked, drawn=[run for run in picked.drawn if name in what.of.names(run)])

    def first_of(picked: Picked) -> LabelledRun | None:
        others = (run for run in picked.drawn if run is not picked.reference)
        return next((run for run in others if base in (None, run.label)), None)

    bases = [run for run in (picked.reference, first_of(picked)) if run is not None and run in picked.drawn]

    def value(run: LabelledRun) -> Array:
        return what.values(run, name)

    def less(run: LabelledRun, other: LabelledRun) -> Array:
        return value(run) - _at(other.whole, what, name, run.time)

    def columns(run: LabelledRun) -> list[Array]:
        return [value(run), *(less(run, one) for one in bases if one.source is not run.source)]

    picked = picked.thinned(columns)
    reference, drawn, first = picked.reference, picked.drawn, first_of(picked)
    others = [run for run in drawn if run is not reference]
    if base is not None and first is None:
        raise UnknownNameError("figure", "run", base, [run.label for run in others])
    words = f"{name.replace('_', ' ')} {quantity}"
    unit = drawn[0].unit(what.variable) if drawn else unit_of(what.variable)
    panels = [Panel(words, picked.curves(value), Axis(words, unit))]
    if reference is not None and reference in drawn:
        ideal_one = reference
        curves = picked.curves(lambda run: None if run is ideal_one else less(run, ideal_one))
        panels += _deviation("less that of the ideal run", curves, unit)
    if first is not None:
        other, later = first, others[others.index(first) + 1 :]
        curves = picked.curves(lambda run: less(run, other) if run in later else None)
        if curves:
            title = f"less that of {first.label}"
            panels.append(Panel(title, curves, Axis("difference", unit), apart=True))
    shown, zero = above_round_off(panels, drawn)
    return panels_sheet(shown, width, 2, (zero, *picked.notes))


def _at(run: LabelledRun, what: MotionQuantity, joint: str, time: Array) -> Array:
    """Return a run's motion at other times, straight between samples because of impacts."""
    found = np.empty(time.size)
    for some, data in samples_around(run.data, time):
        part = replace(run, data=data)
        found[some] = straight(time[some], part.time, what.values(part, joint))
    return found


# --- base, all joints, bodies ---

_Compare = Callable[[xr.Dataset, xr.Dataset], xr.Dataset]


def _apart(
    run: LabelledRun, reference: LabelledRun | None, compare: _Compare, name: str
) -> tuple[Array, Array] | None:
    """Return times [s] and deviations from the ideal run; None if not comparable."""
    if reference is None or not reference.ideal:
        return None
    found = _or_none(compare, run.data, reference.whole.data)  # None of another mechanism or span of time
    if found is None or name not in found:
        return None
    return np.asarray(found["time"].values), np.asarray(found[name].values)


def _columns_apart(
    run: LabelledRun, reference: LabelledRun | None, compare: _Compare, name: str, size: bool = False
) -> list[Array]:
    """Return the deviation of a run's part, or its size; NaN if not comparable."""
    if reference is None or run.source is reference.source:
        return []
    time, values = _apart(run, reference, compare, name) or (run.time, np.full(run.time.size, np.nan))
    values = np.linalg.norm(values, axis=1) if size and values.ndim > 1 else values
    apart = np.full((run.time.size, *values.shape[1:]), np.nan)
    first = int(np.searchsorted(run.time, time[0]))
    apart[first : first + time.size] = values
    return [apart]


@figure(
    quantity='"position", "velocity", "acceleration" of the base\'s origin, "attitude", "angular_velocity" '
    'or "angular_acceleration".'
)
def figure_base(
    runs: Runs, quantity: BaseQuantity = "position", *, ideal: Run | None = None, width: Width = "page"
) -> Sheet:
    """Return the motion of the base: three components, and the size of the deviation.

    World axes; of position and attitude, the change since the start. The attitude is in angles of yaw, pitch
    and roll about the base's own axes in turn; its deviation is the angle between the two attitudes.
    Accelerations with spikes have a scale that is linear as far as the motion between spikes reaches, and
    logarithmic beyond.
    """
    if quantity not in BASE_QUANTITIES:
        raise UnknownNameError("figure", "quantity", quantity, BASE_QUANTITIES)
    turns, name = quantity == "attitude", f"base_{quantity}"
    picked = pick(runs, FREE_BASE, ideal, why="fixed base")
    whole = picked.reference

    def columns(run: LabelledRun) -> list[Array]:
        apart = _columns_apart(run, whole, deviation_over_time, name, True)
        if not turns:
            return [np.asarray(base_motion(run.data)[quantity].values), *apart]
        angles = _of_base(run, quantity)
        return [angles, *map(turning, angles.T), *apart]

    picked = picked.thinned(columns)
    reference = picked.reference
    motions = {run.label: _of_base(run, quantity) for run in picked.drawn}
    words, unit = quantity.replace("_", " "), _UNITS[quantity]
    axes = ("roll about x", "pitch about y", "yaw about z") if turns else ("x", "y", "z")
    panels = [
        Panel(
            f"base {words}, {axis}",
            picked.curves(lambda run, k=k: motions[run.label][:, k]),  # type: ignore[misc]
            Axis("angle" if turns else words, unit),
        )
        for k, axis in enumerate(axes)
    ]
    apart = picked.deviations(lambda run: _apart(run, reference, deviation_over_time, name))
    apart = [replace(one, y=np.linalg.norm(one.y, axis=1)) for one in apart]
    panels += _deviation("size of the deviation from the ideal run", apart, unit)
    note = "angles about the base's own axes in turn" if turns else "world axes"
    return _compared(panels, picked, width, note, spikes=quantity.endswith("acceleration"), columns=2)


def _of_base(run: LabelledRun, quantity: BaseQuantity) -> Array:
    """Return a quantity of the base over time and three components."""
    motion = base_motion(run.data)
    if quantity != "attitude":
        values = np.asarray(motion[quantity].values, dtype=float)
        return values - values[0] if quantity == "position" else values
    turn = Rotation.from_quat(motion["attitude"].values)
    yaw_pitch_roll = (turn[0].inv() * turn).as_euler("ZYX")
    return np.asarray(np.unwrap(yaw_pitch_roll, axis=0)[:, ::-1])


@figure(quantity='"angle", "rate" or "acceleration" of the joints.')
def figure_joints(
    runs: Runs, quantity: Quantity = "angle", *, ideal: Run | None = None, width: Width = "page"
) -> Sheet:
    """Return the motion of every joint beside its deviation from the ideal run."""
    if quantity not in QUANTITIES:
        raise UnknownNameError("figure", "quantity", quantity, QUANTITIES)
    picked = pick(runs, lambda run: bool(run.joints), ideal)
    if not picked.drawn:
        raise refusal("at least one run with a turning joint", picked.every)
    variable, whole = f"motion_{quantity}", picked.reference
    picked = picked.thinned(
        lambda run: [run.values(variable), *_columns_apart(run, whole, deviation_over_time, quantity)]
    )
    reference = picked.reference
    unit = picked.drawn[0].unit(variable)
    apart = {run.label: _apart(run, reference, deviation_over_time, quantity) for run in picked.drawn}
    panels = []
    for joint in dict.fromkeys(name for run in picked.drawn for name in run.joints):
        words = f"{joint.replace('_', ' ')} {quantity}"

        def value(run: LabelledRun, joint: str = joint) -> Array | None:
            return run.values(variable, joint=joint) if joint in run.joints else None

        def away(run: LabelledRun, joint: str = joint) -> tuple[Array, Array] | None:
            found = apart[run.label] if joint in run.joints else None
            return None if found is None else (found[0], found[1][:, run.joints.index(joint)])

        panels.append(Panel(words, picked.curves(value), Axis(words, unit)))
        panels += _deviation(f"{words}: deviation", picked.deviations(away), unit)
    return _compared(panels, picked, width, _FROM_IDEAL, spikes=quantity == "acceleration")


@figure(quantity='"position", "velocity" or "acceleration" of the frame\'s origin.')
def figure_body(
    runs: Runs,
    quantity: BodyQuantity = "position",
    *,
    joint: str | None = None,
    ideal: Run | None = None,
    width: Width = "page",
) -> Sheet:
    """Return the motion of the body that a joint moves, with each component's deviation.

    World axes, without components that are zero to round-off; of the body's frame as the URDF has it. The
    deviation is from the ideal run. Accelerations with spikes have a scale that is linear as far as the ideal
    run reaches and logarithmic beyond.
    """
    if quantity not in BODY_QUANTITIES:
        raise UnknownNameError("figure", "quantity", quantity, BODY_QUANTITIES)
    picked = pick(runs, ideal=ideal, joint=(MOVING, joint))
    body = moved_body(picked.drawn[0].data, picked.joint)
    compare = partial(body_deviation, body=body)
    whole = picked.reference

    def motion(run: LabelledRun) -> Array:
        return np.asarray(body_motion(run.data, body)[quantity].values, dtype=float)

    picked = picked.thinned(lambda run: [motion(run), *_columns_apart(run, whole, compare, quantity)])
    reference, unit = picked.reference, _UNITS[quantity]
    curves = picked.curves(motion)
    apart = picked.deviations(lambda run: _apart(run, reference, compare, quantity))
    panels = []
    for k, axis in enumerate("xyz"):
        words = f"{body.replace('_', ' ')} {quantity}, {axis}"
        mine, away = ([replace(one, y=one.y[:, k]) for one in every] for every in (curves, apart))
        panels.append(Panel(words, mine, Axis(f"{axis} {quantity}", unit)))
        panels += _deviation(f"deviation along {axis} from the ideal run", away, unit)
    return _compared(panels, picked, width, "world axes", spikes=quantity == "acceleration")


# --- the boresight ---

# Between two samples that are drawn an angle that goes on turns by less [rad]; through a pole it jumps by pi.
_JUMP = 2.5


@figure()
def figure_pointing(runs: Runs, *, ideal: Run | None = None, width: Width = "page") -> Sheet:
    """Return the boresight's azimuth and elevation, and the pointing error, over time.

    The error is that against the ideal run, or against the commanded direction where the scenario names one
    and no ideal run is among them: turns of the boresight about the antenna's ``cross`` and ``up`` axes, and
    the half-cone angle between both boresights. The scenario of a run must have a table ``[pointing]``.
    """
    picked = pick(runs, ideal=ideal)
    whole = picked.reference
    picked = picked.thinned(lambda run: _pointing_columns(run, whole))
    looks = {run.label: _or_none(boresight, run.data) for run in picked.drawn}
    drawn = [run for run in picked.drawn if looks[run.label] is not None]
    if not drawn:
        raise refusal("at least one whose scenario has a table [pointing]", picked.every)
    errors = {
        run.label: None if run is picked.reference else _pointing_error(run, picked.reference)
        for run in drawn
    }

    def of(table: dict[str, xr.Dataset | None], name: str, **place: str) -> list[PlotCurve]:
        def value(run: LabelledRun) -> Array | None:
            found = table.get(run.label)
            return None if found is None else np.asarray(found[name].sel(place).values, dtype=float)

        return picked.curves(value)

    panels = [
        Panel(f"{name} of the boresight in the world", [*map(_broken, of(looks, name))], Axis(name, "rad"))
        for name in ("azimuth", "elevation")
    ]
    known = {label: one for label, one in errors.items() if one is not None}
    for title, curves in (
        ("turn of the boresight about cross", of(errors, "boresight_error", cross_axis="cross")),
        ("turn of the boresight about up", of(errors, "boresight_error", cross_axis="up")),
        ("half-cone error", of(errors, "half_cone")),
    ):
        if curves:
            named = [replace(one, label=run) for one, run in zip(curves, known, strict=True)]
            panels.append(Panel(title, named, Axis("error", "rad"), apart=True))
    against = ", ".join(dict.fromkeys(str(one.attrs["against"]) for one in known.values()))
    jumps = any(np.isnan(curve.y).any() for curve in panels[0].curves)
    notes = (
        f"error against the {against}" if against else "",
        "azimuth jumps where the boresight passes straight up or down" if jumps else "",
        too_short(picked.every),
        left_out(picked.every, drawn, "scenario without pointing"),
    )
    return panels_sheet(panels, width, 2, notes)


def _or_none(function: Callable[..., xr.Dataset], *arguments: Any) -> xr.Dataset | None:
    """Return a function's value, or None where runs do not have it."""
    try:
        return function(*arguments)
    except AntennaPinError:
        return None


def _pointing_error(run: LabelledRun, reference: LabelledRun | None) -> xr.Dataset | None:
    return _or_none(pointing_error, run.data, None if reference is None else reference.whole.data)


def _broken(curve: PlotCurve) -> PlotCurve:
    """Return an angle with gaps where it jumps, as an azimuth at the pole."""
    jumps = np.flatnonzero(np.abs(np.diff(curve.y)) > _JUMP) + 1
    return replace(curve, x=np.insert(curve.x, jumps, curve.x[jumps]), y=np.insert(curve.y, jumps, np.nan))


def _pointing_columns(run: LabelledRun, reference: LabelledRun | None) -> list[Array]:
    """Return the lines of a part of a run; none without a boresight."""
    looks = _or_none(boresight, run.data)
    if looks is None:
        return []
    found = [np.asarray(looks[name].values) for name in ("azimuth", "elevation")]
    found.append(turning(found[0]))
    error = None
    if reference is None or run.source is not reference.source:
        error = _pointing_error(run, reference)
    more = ("boresight_error", "half_cone") if error is not None else ()
    return found + [np.asarray(error[name].values) for name in more if error is not None]


JOINT_FIGURES = (
    RunFigure("joint_motion", "Motion of {joint}", figure_joint, of=PLAYLESS, reported=False),
    *(
        RunFigure(
            f"{quantity}_between_runs",
            f"{quantity.capitalize()} of {{joint}}, runs less one another",
            figure_between,
            {"quantity": quantity},
            TURNING,
            standard=False,
            reported=False,
        )
        for quantity in ("angle", "rate")
    ),
)

FIGURES = (
    *(
        RunFigure(
            f"base_{quantity}",
            f"{quantity.replace('_', ' ').capitalize()} of the base",
            figure_base,
            {"quantity": quantity},
            needs=FREE_BASE,
            reported=quantity in ("position", "attitude"),
        )
        for quantity in BASE_QUANTITIES
    ),
    *(
        RunFigure(
            f"joints_{quantity}",
            f"{quantity.capitalize()} of all joints",
            figure_joints,
            {"quantity": quantity},
            standard=False,
            reported=False,
        )
        for quantity in QUANTITIES
    ),
    *(
        RunFigure(
            f"body_{quantity}",
            f"{quantity.capitalize()} of the body that {{joint}} moves",
            figure_body,
            {"quantity": quantity},
            LOOPED,
            reported=quantity == "position",
        )
        for quantity in BODY_QUANTITIES
    ),
    RunFigure("pointing", "Boresight and pointing error", figure_pointing, needs=POINTED),
)
