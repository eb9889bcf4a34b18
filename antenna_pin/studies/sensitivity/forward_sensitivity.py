"""Forward sensitivity of a result by the variational equation, along one run.

A force is largest where its rate F' is zero. In a perturbed run, whose rate there differs by dF', that is
later by ``-dF' / F''``; the largest force itself changes as at equal times. A force that is largest at an
event, such as the onset of another contact, moves with that event.

A largest value at a sample is that of a sample of the run's own: of an output time, which is fixed, or of the
time at which a contact's force is largest, with which it moves. An effort that is largest between samples
changes as at that time: its rate there is zero.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

from antenna_pin.base.arrays import Array
from antenna_pin.base.calculus import few
from antenna_pin.base.settings import RunSettings
from antenna_pin.base.state import State
from antenna_pin.dynamics import System
from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.run.simulation.inputs import check_without_controllers, events_of
from antenna_pin.run.simulation.variables import SIZES, TOTALS
from antenna_pin.scenario import Scenario, with_number
from antenna_pin.scenario.assemble import build_system, initial_angles, initial_state
from antenna_pin.studies.nonlinear import Flow
from antenna_pin.studies.nonlinear.chart import Chart, StatePerturbation
from antenna_pin.studies.nonlinear.coordinates import Lift
from antenna_pin.studies.nonlinear.perturbed_system import ParameterSlopes, PerturbedParameters
from antenna_pin.studies.nonlinear.variational import TangentPropagation
from antenna_pin.studies.sensitivity.finite_differences import VariableDerivatives
from antenna_pin.studies.sensitivity.parameters import (
    GrazeError,
    Parameter,
    SensitivityError,
    is_initial,
    shifted_start,
)
from antenna_pin.studies.sensitivity.state_series import StateSeries, TimeDerivatives
from antenna_pin.studies.sensitivity.tangent_run import ContactShift, TangentRecord

# --- tangents of a scenario over its parameters -------------------------------------------------------------

# Difference step of first states, in a parameter's scale.
_START = 1e-3


class ParameterTangents:
    """Parameters of a system, and the perturbations of a first state by them.

    Each of ``builds`` builds the system so many scales farther, ``(s) -> System``; names are for messages.
    """

    def __init__(
        self, system: System, builds: Sequence[Callable[[float], System]], names: Sequence[str]
    ) -> None:
        self._names, self.perturbation = names, StatePerturbation(system, len(builds))
        self.numbers = ParameterSlopes(system, builds, names)
        # A perturbed run begins with its own numbers of elements; their memory is perturbed separately.
        self.numbers.slopes["program"][:, self.perturbation.memory.words] = 0.0

    def of_start(self, here: State, there: Sequence[Callable[[float], State]]) -> Array:
        """Return the perturbations of a first state, (perturbation, n).

        Its functions ``there``, (s) -> State, are of the parameters and of others behind them.
        """
        parts, count = self.perturbation.parts, self.numbers.count
        ways = np.zeros((parts[-1].stop, len(there)))
        for k, one in enumerate(there):
            ways[:, k] = few(functools.partial(self._apart, k, here, one), _START)[0]
        ways[parts[-3], :count] = np.eye(count)
        return ways

    def _apart(self, k: int, here: State, there: Callable[[float], State], j: int) -> Array:
        """Return the perturbation of a first state, without that of the parameter itself."""
        found = self.perturbation.between(here, there(j * _START) if j else here)
        if found is None:
            name = (*self._names, "a start")[min(k, len(self._names))]
            raise GrazeError(
                f"sensitivities: with {name} changed by {j * _START:g} of its scale other contacts touch at "
                "the start, where there is no derivative; start apart, or deeper",
                here.time,
            )
        return found


class _PerturbedScenario(NamedTuple):
    """Scenario with one parameter perturbed, its system and first state."""

    scenario: Scenario
    system: System
    first: State


class ForwardSensitivity:
    """Derivatives of samples of a scenario's run over parameters, by the variational equation.

    Raises:
        InvalidParameterError: The scenario has controllers, or a parameter belongs to an event.
    """

    def __init__(
        self,
        scenario: Scenario,
        parameters: Sequence[Parameter],
        settings: RunSettings,
        start: State | None = None,
    ) -> None:
        check_without_controllers("sensitivities", scenario)
        self._scenario, self.parameters, self.settings = scenario, tuple(parameters), settings
        self._from = start
        self.at = functools.cache(self._neighbour)
        self._here = self.at(0, 0.0)
        system = self._here.system
        self.flow = Flow(system, settings, events_of(scenario), scenario)
        builds = [functools.partial(self._system, k) for k in range(len(self.parameters))]
        self._tangents = ParameterTangents(system, builds, [one.key for one in self.parameters])
        beside = PerturbedParameters(system, settings, self._tangents.numbers, self._system)
        scales = np.array([one.scale for one in self.parameters])
        #: Series of the result at its states, and at perturbed ones.
        self.state_series = StateSeries(
            beside, self._tangents.perturbation, settings, self._here.first, scales
        )

    def _neighbour(self, k: int, s: float) -> _PerturbedScenario:
        """Return the scenario with a parameter shifted by s scales."""
        one, scenario = self.parameters[k], self._scenario
        if s != 0.0:
            value = one.value + s * one.scale
            try:
                scenario = with_number(scenario, one.key, value)
            except AntennaPinError as error:
                said = f"sensitivities: {one.key} must have room on both sides: {error}"
                raise SensitivityError(said) from error
            if scenario.events != self._scenario.events:
                rule = "not an event's, which needs differences of runs (method = 'runs')"
                raise InvalidParameterError("sensitivities", "key", rule, said=one.key)
        system = build_system(scenario)
        if self._from is not None:
            first = self._from
            if s != 0.0 and is_initial(self.parameters[k].key):
                first = shifted_start(first, self._scenario, scenario, system)
            return _PerturbedScenario(scenario, system, first)
        flow = Flow(system, self.settings, events_of(scenario))
        first = flow.first(*initial_state(scenario, system), initial_angles(scenario, system))
        return _PerturbedScenario(scenario, system, first)

    def _system(self, k: int, s: float) -> System:
        return self.at(k, s).system

    def _start(self, lift: Lift) -> Array:
        """Return the perturbations of the first state in coordinates, (size, parameters)."""
        firsts = [functools.partial(self._first_state, k) for k in range(len(self.parameters))]
        return np.asarray(lift.down @ self._tangents.of_start(self._here.first, firsts))

    def _first_state(self, k: int, s: float) -> State:
        return self.at(k, s).first

    def run(self, times: Array, duration: float, moments: Array) -> TangentRecord:
        """Return the run with its tangents, recorded at times and depth maxima.

        Its samples are the run's first one and those at ``times`` (n,) and ``moments`` (m,), such as the
        largest forces of contacts, in order [s].

        Raises:
            GrazeError: A contact begins, or an event occurs, at zero rate.
        """
        first, flow = self._here.first, self.flow
        begin, end = first.reached, first.reached + duration
        span = end - first.time
        every = np.unique(np.concatenate([[begin, end], times, moments]))
        samples = every[(every >= begin) & (every <= end)].tolist()
        run = flow.logged_run(first, span)
        frame, numbers = Chart(flow.system, first).frame, self._tangents.numbers
        carrier = TangentPropagation(run, frame, self._start, numbers, samples)
        along = TangentRecord(run, carrier, numbers, begin, len(self.parameters))
        run.advance(observer=along)
        flow.check_ended(run, span, first)
        return along


# --- largest values -----------------------------------------------------------------------------------------

_Series = dict[str, tuple[Array, Array]]

# Tolerance of the time of one event [s]; relative round-off of equal times.
_SAME, _ONE = 1e-9, 1e-14
# Largest time error of a force's maximum, over the time scale of its curvature: there it is smooth.
_FOUND = 1e-3


class _Peaks(NamedTuple):
    """Shifts of force peaks in time and size, (episodes, parameters) each."""

    late: Array  # delay per scale [s]
    late_doubt: Array  # its error estimate [s]
    force: Array  # increase at that time [N]
    force_doubt: Array  # its error estimate [N]


def maximum_times(run: xr.Dataset) -> Array:
    """Return the times of force peaks and reported maxima of a result, (n,) [s]."""
    found = [run["peak_time"].values] if "peak_time" in run else []
    found += [_times(run, name).reshape(-1) for name in _maxima_names(run)]
    every = np.concatenate(found) if found else np.zeros(0)
    return np.unique(every[np.isfinite(every)])


def _force_peaks(
    along: TangentRecord, series: _Series, in_time: TimeDerivatives, run: xr.Dataset, scales: Array
) -> _Peaks:
    """Return the derivatives of force peaks; NaN where there is none."""
    displaced, times = along.samples, along.samples.chunk.times
    begin, end = float(times[0]), float(times[-1])
    count = len(run["peak_time"]) if "peak_time" in run else 0
    late, rest, force, off = np.full((4, count, len(scales)), math.nan)
    smooth: list[tuple[int, int, int, float]] = []
    for i in range(count):
        onset, release, when = (
            float(run[name].values[i]) for name in ("onset_time", "release_time", "peak_time")
        )
        if not when >= begin or float(run["peak_force"].values[i]) == 0.0:
            continue
        if abs(when - onset) < _SAME:  # what the force jumps to there is not looked at
            late[i], rest[i] = _event_delay(along, when, scales), 0.0
            continue
        long = (release if release < end else end) - max(onset, begin)
        smooth.append((i, _nearest(times, when), int(run["episode_contact"].values[i]), long))
    if not smooth:
        return _Peaks(late, rest, force, off)
    places, contacts = np.array([one[1] for one in smooth]), np.array([one[2] for one in smooth])
    bends = in_time.forces(places, contacts, np.array([one[3] for one in smooth]))
    for n, (i, at, c, _) in enumerate(smooth):
        own = bends.of(n)
        force[i], off[i] = (one[at, c] for one in series["normal_force"])
        most = displaced.doubts[at]
        if own.is_maximum(_FOUND):
            late[i], rest[i], correction = own.delay(most)
            late[i], rest[i] = late[i] / scales, rest[i] / scales
            force[i] += correction / scales
            off[i] += np.abs(correction) / scales
        elif min(times[at] - begin, end - times[at]) < _ONE * end:
            late[i] = rest[i] = 0.0  # where the run begins or ends
        else:
            late[i] = _event_delay(along, float(times[at]), scales)
            rest[i] = np.abs(late[i]) * most
            force[i] += own.rate[0] * late[i]
            off[i] += np.abs(own.rate[0]) * rest[i]
    return _Peaks(late, rest, force, off)


def _largest_values(
    along: TangentRecord,
    series: _Series,
    in_time: TimeDerivatives,
    run: xr.Dataset,
    peaks: _Peaks,
    at: tuple[Array, Array],
) -> _Series:
    """Return the derivatives of reported maxima and their error estimates, by name."""
    asked, scales = at
    times = along.samples.chunk.times
    found: _Series = {}
    for name in (one for one in _maxima_names(run) if SIZES[one] in series):
        tops = _times(run, name)
        slopes, doubts = np.full((2, *tops.shape, len(scales)), math.nan)
        for index in np.ndindex(tops.shape):
            when = float(tops[index])
            row, place = _nearest(run["time"].values, when), _nearest(times, when)
            column = _column(run, name, index)
            way = _direction(run[SIZES[name]].values[(row, *column)])
            slope, doubt = (one[(place, *column)].reshape(len(way), -1) for one in series[SIZES[name]])
            moves = _sample_delay(along, run, peaks, when, asked, scales)
            if moves is None:
                continue
            slopes[index], doubts[index] = way @ slope, np.abs(way) @ doubt
            if moves[0].any():
                rate, rest = in_time.series(place, moves[2])[SIZES[name]]
                per_second = float(way @ np.atleast_1d(rate[column]))
                slopes[index] += per_second * moves[0]
                doubts[index] += abs(per_second) * moves[1]
                doubts[index] += float(np.abs(way) @ np.atleast_1d(rest[column])) * np.abs(moves[0])
        found[name] = slopes, doubts
    return found


def _maxima_names(run: xr.Dataset) -> list[str]:
    """Return the names of a result's maxima over its samples, without energy error."""
    return [one for one in SIZES if one in run and SIZES[one] in run and one != "peak_energy_error"]


def _column(run: xr.Dataset, name: str, index: tuple[int, ...]) -> tuple[int, ...]:
    """Return the index of a maximum in its series: of drives only motions have one."""
    if name != "peak_effort":
        return index
    drives = run["drive"].values.tolist()
    return (drives.index(run["motion"].values[index[0]]),)


def _times(run: xr.Dataset, name: str) -> Array:
    """Return the time of each maximum of a result, in its shape [s]."""
    if f"time_of_{name}" in run:
        return np.asarray(run[f"time_of_{name}"].values)
    values = run[SIZES[name]].values
    sizes = np.linalg.norm(values, axis=-1) if run[SIZES[name]].dims[-1] == "axis" else np.abs(values)
    out = np.zeros(run[name].shape, dtype=int)
    for index in np.ndindex(out.shape):
        out[index] = int(np.argmax(sizes[(slice(None), *_column(run, name, index))]))
    return np.asarray(run["time"].values[out])


def _direction(value: Array) -> Array:
    """Return the unit direction of a number or vector, which projects changes onto its size."""
    if np.ndim(value) == 0:
        return np.array([math.copysign(1.0, value)])
    size = float(np.linalg.norm(value))
    return np.asarray(value / size) if size > 0.0 else np.full_like(value, math.nan)


def _nearest(times: Array, when: float) -> int:
    return int(np.argmin(np.abs(times - when)))


def _event_delay(along: TangentRecord, when: float, scales: Array) -> Array:
    """Return the delay of the event at a time; NaN without an event."""
    near = (one.late / scales for one in along.event_shifts if abs(one.time - when) < _SAME)
    return next(near, np.full(len(scales), math.nan))


def _sample_delay(
    along: TangentRecord, run: xr.Dataset, peaks: _Peaks, when: float, sample_times: Array, scales: Array
) -> tuple[Array, Array, float] | None:
    """Return a sample's delay, its error estimate and its event's duration, or None."""
    still, one = np.zeros(len(scales)), _ONE * when
    if (np.abs(sample_times - when) <= 4.0 * np.spacing(max(when, float(sample_times[-1])))).any():
        return still, still, 0.0
    if any(abs(passed.time - when) < _SAME for passed in along.event_shifts):
        return None  # a sample on one side of what jumps there
    for i in np.flatnonzero(np.abs(run["peak_time"].values - when) <= one) if "peak_time" in run else ():
        if not np.isfinite(peaks.late[i]).all():
            return None
        until = float(run["release_time"].values[i])
        end = float(along.samples.chunk.times[-1])
        return (
            peaks.late[i],
            peaks.late_doubt[i],
            (until if until < end else end) - float(run["onset_time"].values[i]),
        )
    return still, still, 0.0


# --- derivatives by name ------------------------------------------------------------------------------------

# Variables of element transitions, in the order of their derivatives.
_OF_CHANGES = (
    "change_angle",
    "change_rate",
    "change_rate_after",
    "change_loss",
    "change_impulse",
    "change_energy",
)


def named_derivatives(
    equation: ForwardSensitivity,
    along: TangentRecord,
    here: xr.Dataset,
    run: xr.Dataset,
    parameters: tuple[Parameter, ...],
) -> list[VariableDerivatives]:
    """Return derivatives over each parameter, by the result's names; NaN where unknown."""
    displaced, system = along.samples, equation.flow.system
    series, in_time = (
        equation.state_series.series(displaced),
        TimeDerivatives(equation.state_series, displaced),
    )
    times, scales = displaced.chunk.times, np.array([one.scale for one in parameters])
    most = displaced.doubts.max(axis=0, initial=0.0) if len(displaced.doubts) else np.zeros(len(parameters))
    found: dict[str, tuple[Array, Array]] = {}
    at = np.searchsorted(times, here["time"].values) if "time" in here.sizes else None
    for name, (value, doubt) in series.items():
        if name in here and at is not None:
            found[name] = value[at], doubt[at]
    for name, of in TOTALS.items():
        if name in here and of in series:
            found[name] = series[of][0][-1], series[of][1][-1]
    instants = _event_times(along, here, run, scales)
    instants |= _episodes(along, series, run, system, scales)
    instants |= _changes(along, run, scales)
    for name, value in instants.items():
        if name in here:
            found[name] = value, np.abs(value) * most
    peaks = _force_peaks(along, series, in_time, run, scales)
    if "peak_time" in here:
        found["peak_time"] = peaks.late, peaks.late_doubt
        found["peak_force"] = peaks.force, peaks.force_doubt
    if at is not None:
        found |= _largest_values(along, series, in_time, run, peaks, (here["time"].values, scales))
    return [
        VariableDerivatives(
            {name: v[..., k] for name, (v, _) in found.items()}, {n: d[..., k] for n, (_, d) in found.items()}
        )
        for k in range(len(parameters))
    ]


def _event_times(along: TangentRecord, here: xr.Dataset, run: xr.Dataset, scales: Array) -> dict[str, Array]:
    """Return the delays of onsets, releases and events, and the energy of events."""
    found = {}
    matched = _matched_contacts(along, run)
    for at, name in enumerate(("onset_time", "release_time")):
        if name in here:
            found[name] = np.full((len(run[name]), len(scales)), math.nan)
            for i, one in enumerate(matched):
                if one is not None and not math.isnan(float(run[name].values[i])):
                    found[name][i] = one.late[at] / scales
    if "event_time" in here:
        found |= _events(along, run, scales)
    return found


def _events(along: TangentRecord, run: xr.Dataset, scales: Array) -> dict[str, Array]:
    """Return delay and energy of events; simultaneous mode changes are one event."""
    count = len(run["event_time"])
    times, energies = np.full((2, count, len(scales)), math.nan)
    used: set[int] = set()
    for i, (name, time) in enumerate(
        zip(run["event"].values, run["event_time"].values.tolist(), strict=True)
    ):
        near = [k for k, one in enumerate(along.events) if abs(one.time - time) < _SAME]
        same = [k for k in near if along.events[k].name == name and k not in used]
        if not (same or near):
            continue
        k = (same or [k for k in near if k not in used] or near)[0]
        times[i] = along.events[k].late / scales
        # The first of simultaneous changes has all of their energy.
        energies[i] = 0.0 if k in used else along.events[k].energy / scales
        used.add(k)
    return {"event_time": times, "event_energy": energies}


def _matched_contacts(along: TangentRecord, run: xr.Dataset) -> list[ContactShift | None]:
    """Return the shifts of each contact of a result, matched in order."""
    contacts = run["episode_contact"].values.tolist() if "episode_contact" in run else []
    own = {c: [one for one in along.contacts if one.contact == c] for c in set(contacts)}
    alike = {c: len(own[c]) == contacts.count(c) for c in own}
    return [own[c].pop(0) if alike[c] else None for c in contacts]


def _episodes(
    along: TangentRecord,
    series: dict[str, tuple[Array, Array]],
    run: xr.Dataset,
    system: System,
    scales: Array,
) -> dict[str, Array]:
    """Return the derivatives of each contact's totals and peaks."""
    if "onset_time" not in run:
        return {}
    times = along.samples.chunk.times
    begin = float(times[0])
    matched = _matched_contacts(along, run)
    names = ("impulse", "dissipated", "approach_speed", "effective_mass", "peak_depth")
    found = {name: np.full((len(run["onset_time"]), len(scales)), math.nan) for name in names}
    for i, (onset, c, one) in enumerate(
        zip(run["onset_time"].values.tolist(), run["episode_contact"].values.tolist(), matched, strict=True)
    ):
        if one is None:
            continue
        end = float(run["release_time"].values[i])
        until = math.inf if math.isnan(end) else end
        books = (along.integrals if one.integrals[1] is None else one.integrals[1]) - one.integrals[0]
        found["impulse"][i] = books[system.impulse_x[c]] / scales
        found["dissipated"][i] = (books[system.lost_normal_x[c]] + books[system.lost_friction_x[c]]) / scales
        for name, logarithm in zip(("approach_speed", "effective_mass"), one.memory, strict=True):
            found[name][i] = float(run[name].values[i]) * logarithm / scales
        deepest = [
            time for contact, time in along.depth_maxima if contact == c and max(onset, begin) < time < until
        ]
        if deepest:
            places = [int(np.argmin(np.abs(times - time))) for time in deepest]
            depths = along.depths[places, c]
            found["peak_depth"][i] = series["depth"][0][places[int(np.argmax(depths))], c]
    return found


def _changes(along: TangentRecord, run: xr.Dataset, scales: Array) -> dict[str, Array]:
    """Return the derivatives of element transitions."""
    if "change_time" not in run:
        return {}
    count = len(run["change_time"])
    found = {name: np.full((count, len(scales)), math.nan) for name in ("change_time", *_OF_CHANGES)}
    used: set[int] = set()
    for i in range(count):
        time = float(run["change_time"].values[i])
        angle = float(run["change_angle"].values[i])
        for k, one in enumerate(along.transitions):
            if (
                k in used
                or abs(one.time - time) > _SAME
                or abs(one.angle - angle) > 1e-9 * (1.0 + abs(angle))
            ):
                continue
            used.add(k)
            found["change_time"][i] = one.late / scales
            for name, slope in zip(_OF_CHANGES, one.slopes, strict=True):
                found[name][i] = slope / scales
            break
    lacks = np.isnan(run["change_energy"].values)
    found["change_energy"][lacks] = math.nan  # of elements that do not weigh their joint
    return found
