"""Sensitivities of a scenario's results by runs, by the variational equation, and over pieces."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Literal

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.settings import RunSettings
from antenna_pin.base.state import State
from antenna_pin.errors import InvalidParameterError
from antenna_pin.run.simulation.inputs import check_without_controllers, events_of, settings_of
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.assemble import build_system, initial_angles, initial_state
from antenna_pin.studies.nonlinear import Flow
from antenna_pin.studies.sensitivity.finite_differences import FiniteDifferences, VariableDerivatives
from antenna_pin.studies.sensitivity.forward_sensitivity import (
    ForwardSensitivity,
    maximum_times,
    named_derivatives,
)
from antenna_pin.studies.sensitivity.parameters import (
    GrazeError,
    Parameter,
    SensitivityError,
    check_start_keys,
    parameters_of,
)
from antenna_pin.studies.sensitivity.result import Sensitivities, dataset_of

# Shortest piece over the whole; relative round-off of equal times.
_SHORTEST, _ONE = 1e-6, 1e-12


# --- derivatives over pieces of a run, each from the run's own state ----------------------------------------
#
# Over a long run derivatives grow with the divergence of perturbed runs, until they are useless. Over a piece
# they do not: its end depends on its own start, held fixed, and on the parameters. Multiple shooting needs
# just that.


def _piece_borders(length: float, begin: float, span: float) -> Array:
    """Return the times at which pieces of a length [s] begin, and the last ends."""
    if not _SHORTEST * span <= length <= span:
        rule = f"at most the run's {span:g} s, and at least a millionth of it"
        raise InvalidParameterError("sensitivities", "pieces", rule, length)
    count = max(int(np.ceil(span / length * (1.0 - 1e-9))), 1)
    return np.append(begin + length * np.arange(count), begin + span)


def _over_pieces(
    flow: Flow,
    state: State,
    borders: Array,
    times: Array,
    derive: Callable[[State, Array, float], Sensitivities],
) -> Sensitivities:
    """Return derivatives at times and at the ends of pieces, each over its own piece."""
    parts: list[tuple[float, Sensitivities]] = []
    refused: list[dict[str, float | str]] = []
    start = state
    for begin, end in zip(borders[:-1].tolist(), borders[1:].tolist(), strict=True):
        at = np.append(times[(times > begin * (1.0 + _ONE)) & (times < end * (1.0 - _ONE))], end)
        try:
            parts.append((begin, derive(start, at, end - begin)))
        except GrazeError as error:
            refused.append({"begin": begin, "end": end, "why": str(error)})
        start = flow.after(start, end - start.time)
    if not parts:
        raise GrazeError(f"sensitivities: no piece has derivatives; the first: {refused[0]['why']}")
    data = xr.concat(list(_series(parts)), dim="time", combine_attrs="override")
    data.attrs["refused"] = json.dumps(refused)
    return Sensitivities(parts[0][1].run, parts[0][1].parameters, data)


def _series(parts: list[tuple[float, Sensitivities]]) -> Iterator[xr.Dataset]:
    """Yield the series of each piece, with the time at which it began."""
    for begin, one in parts:
        names = [name for name, column in one.data.data_vars.items() if "time" in column.dims]
        part = one.data[names]
        yield part.assign_coords(piece_begin=("time", np.full(part.sizes["time"], begin)))


# Default tolerance of runs that are differentiated.
_RTOL = 1e-12
# Largest deviation of the equation from second-order differences, over the larger of a number's size and its
# change per scale.
_APART = 1e-4
# Variables of the motion, whose contradiction refuses the equation.
_MOTION = ("q", "v", "onset_time", "release_time", "event_time")

Method = Literal["runs", "quick-runs", "equation"]
"""How results are differentiated."""


@takes(duration="s", pieces="s")
def sensitivities(
    scenario: Scenario,
    keys: Sequence[str] | Mapping[str, float | str | None],
    times: ArrayLike | None = None,
    *,
    duration: float | str | None = None,
    settings: RunSettings | None = None,
    start: State | None = None,
    method: Method = "runs",
    pieces: float | str | None = None,
    processes: int = 1,
) -> Sensitivities:
    """Return the derivatives of a scenario's results over some of its numbers.

    By ``runs`` all numbers of the result have them: samples at given times, times and peaks of contacts,
    impulses, losses, and all others of the schema. They are differences of sixth order of six runs a
    parameter, each of which locates its own contacts and events; the error estimate is the difference from
    fourth order plus the runs' own error. ``quick-runs`` are of second order, of two runs.

    The ``equation`` propagates tangents along one run, through events by their saltation
    (:mod:`antenna_pin.studies.nonlinear.variational`), and the integrals by the integral of their rates'
    derivatives. Numbers that it does not determine, such as a largest force at a contact's onset, are NaN. It
    takes more time, and allows perturbed runs with other events: so it is compared with two runs a parameter,
    and refused where they contradict.

    Args:
        scenario: The scenario.
        keys: Keys of its numbers, as in ``--set``; ``mechanism.gravity[2]`` for one of an array. A mapping
            gives each a scale, relative to which changes are small, a number or text with a unit: the size of
            its value if None; required where that is 0.
        times: Sample times, ascending [s]; the scenario's output by default.
        duration: Duration of the run [s]; the scenario's by default, or up to the last of ``times``.
        settings: Settings of the integration; the scenario's engine, order 8(5,3) and 1e-12 by default.
        start: State from which the run continues, the ``end`` of another; the scenario's start by default.
            Keys of ``initial`` then are perturbations of this state.
        method: ``runs``, ``quick-runs`` or ``equation``.
        pieces: Length of pieces, each from the run's own state at its start, which is held: for motions whose
            derivatives grow too far [s]. Samples and the ends of pieces have derivatives; pieces without
            derivatives are left out, with the reason in ``data.attrs["refused"]``. The ``run`` is the first
            piece.
        processes: Number of processes that make runs.

    Raises:
        GrazeError: A contact or an event appears or vanishes with the smallest change: there is no
            derivative.
        SensitivityError: A run does not complete, or a number has no perturbed runs.
        AntennaPinError: The input is not valid.
    """
    place = "sensitivities"
    assert not isinstance(duration, str)
    parameters = parameters_of(scenario, keys, place)
    begin = 0.0 if start is None else start.reached
    used, at, span = _sampled(scenario, times, duration, settings, begin)
    system = build_system(scenario)
    if start is not None or pieces is not None:
        check_start_keys(tuple(one.key for one in parameters), system)
    if pieces is None:
        return _one_run(scenario, parameters, used, at, span, start, method, processes)
    assert not isinstance(pieces, str)
    borders = _piece_borders(pieces, begin, span)
    check_without_controllers("sensitivities of pieces", scenario)
    flow = Flow(system, used, events_of(scenario), scenario)
    first = start
    if first is None:
        first = flow.first(*initial_state(scenario, system), initial_angles(scenario, system))

    def piece(state: State, samples: np.ndarray, length: float) -> Sensitivities:
        own = dataclasses.replace(used, output_rate=0.5 / length, output_times=tuple(samples.tolist()))
        return _one_run(scenario, parameters, own, samples, length, state, method, processes)

    return _over_pieces(flow, first, borders, at, piece)


def _one_run(
    scenario: Scenario,
    parameters: tuple[Parameter, ...],
    used: RunSettings,
    at: np.ndarray,
    span: float,
    start: State | None,
    method: Method,
    processes: int,
) -> Sensitivities:
    """Return the derivatives of one run."""
    runs = FiniteDifferences(scenario, used, span, at, start, processes, 6 if method == "runs" else 2)
    found = runs.derivatives(parameters)
    if method == "equation":
        equation = ForwardSensitivity(scenario, parameters, used, start)
        found = _checked_by_runs(found, _by_equation(equation, runs, at, span, parameters), runs, parameters)
    slopes, doubts = (
        {name: np.stack([getattr(one, kind)[name] for one in found], axis=-1) for name in found[0].values}
        for kind in ("values", "doubts")
    )
    here = runs.here[list(slopes)]
    return Sensitivities(runs.run, parameters, dataset_of(here, slopes, doubts, parameters))


def _by_equation(
    equation: ForwardSensitivity,
    runs: FiniteDifferences,
    at: np.ndarray,
    span: float,
    parameters: tuple[Parameter, ...],
) -> list[VariableDerivatives]:
    """Return the derivatives over each parameter by the variational equation."""
    data = runs.run.data
    along = equation.run(at, span, maximum_times(data))
    # Near-infinite tangents belong to no states: overflow is expected.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        return named_derivatives(equation, along, runs.here, data, parameters)


def _checked_by_runs(
    runs: list[VariableDerivatives],
    equation: list[VariableDerivatives],
    differences: FiniteDifferences,
    parameters: tuple[Parameter, ...],
) -> list[VariableDerivatives]:
    """Return derivatives of the equation, or refuse them where runs contradict.

    The deviation of both adds to the error estimate. Where the motion is right and another number is not (the
    integral of a loss over an onset where it has no derivative, a contact's memory that its law does not
    use), that number is NaN.
    """
    held = []
    for one, ours, theirs in zip(parameters, equation, runs, strict=True):
        values, doubts, share = dict(ours.values), {}, _relative_uncertainty(theirs)
        for name, value in ours.values.items():
            size = differences.sizes[name] / one.scale
            size = max(size, float(np.nanmax(np.abs(theirs.values[name]), initial=0.0)))
            noise = np.fmax(theirs.doubts[name], share * np.abs(theirs.values[name]))
            off = np.abs(value - theirs.values[name]) - 2.0 * noise - ours.doubts[name]
            contradict = float(np.nanmax(off, initial=-math.inf)) > _APART * size
            if contradict and name in _MOTION:
                raise SensitivityError(
                    f"sensitivities: over {one.key} the equation and runs contradict about {name}, by "
                    f"{float(np.nanmax(off)) / size:.2g} of its size: what that key changes is not all "
                    "carried; take method = 'runs'"
                )
            if contradict:
                values[name] = np.where(off > _APART * size, math.nan, value)
            doubts[name] = np.fmax(ours.doubts[name], np.abs(values[name] - theirs.values[name]))
        held.append(VariableDerivatives(values, doubts))
    return held


def _relative_uncertainty(slopes: VariableDerivatives) -> float:
    """Return the relative error of the motion's largest derivative, at most 1.

    Later perturbations follow that derivative, and share its relative error, whatever a difference gives for
    each time by itself.
    """
    shares = [0.0]
    for name in _MOTION:
        if name in slopes.values and np.isfinite(sizes := np.abs(slopes.values[name]).reshape(-1)).any():
            most = int(np.nanargmax(sizes))
            if sizes[most] > 0.0:
                shares.append(float(slopes.doubts[name].reshape(-1)[most]) / float(sizes[most]))
    return min(max(shares), 1.0)


def _sampled(
    scenario: Scenario,
    times: ArrayLike | None,
    duration: float | None,
    settings: RunSettings | None,
    begin: float,
) -> tuple[RunSettings, np.ndarray, float]:
    """Return run settings, sample times (times,) [s] and span [s]."""
    used = settings or dataclasses.replace(
        settings_of(scenario), accuracy=None, method="dormand-prince-853", rtol=_RTOL
    )
    if times is None:
        span = scenario.duration if duration is None else duration
        count = int(np.floor(span * used.output_rate * (1.0 + 1e-12)))
        at = begin + np.arange(count + 1) / used.output_rate
        return dataclasses.replace(used, output_times=tuple(at.tolist())), at, span
    at = np.atleast_1d(np.asarray(times, dtype=float))
    if at.ndim != 1 or not len(at) or not np.isfinite(at).all() or not (np.diff(at) > 0.0).all():
        raise InvalidParameterError("sensitivities", "times", "finite and ascending [s]", times)
    if not at[0] >= begin:
        raise InvalidParameterError("sensitivities", "times", f"from {begin:g} s on", float(at[0]))
    span = float(at[-1]) - begin if duration is None else duration
    if not at[-1] <= begin + span * (1.0 + 1e-12):
        rule = f"within the run, which ends at {begin + span:g} s"
        raise InvalidParameterError("sensitivities", "times", rule, float(at[-1]))
    return dataclasses.replace(used, output_rate=0.5 / span, output_times=tuple(at.tolist())), at, span
