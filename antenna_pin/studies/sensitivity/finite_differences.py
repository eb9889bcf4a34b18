"""Derivatives of a result by finite differences of runs with contacts and events."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.base.arrays import Array
from antenna_pin.base.calculus import WEIGHTS
from antenna_pin.base.interruption import uninterrupted
from antenna_pin.base.settings import RunSettings
from antenna_pin.base.side_by_side import side_by_side
from antenna_pin.base.state import State
from antenna_pin.errors import AntennaPinError
from antenna_pin.run.simulation import simulate
from antenna_pin.run.simulation.inputs import controllers_of, events_of
from antenna_pin.scenario import Scenario, with_number
from antenna_pin.scenario.assemble import build_system, initial_angles, initial_state
from antenna_pin.studies.sensitivity.parameters import (
    GrazeError,
    Parameter,
    SensitivityError,
    is_initial,
    shifted_start,
)
from antenna_pin.trajectory import Column, Trajectory, columns_of

# --- first difference of two runs in contacts, events or mode changes ---------------------------------------

_INSTANTS = ("onset_time", "change_time", "event_time")


def _first_difference(ours: Mapping[str, Column], theirs: Mapping[str, Column]) -> float:
    """Return the first time at which events of two runs differ [s], or NaN."""
    found = [_first_mismatch(*(_event_sequence(one, name) for one in (ours, theirs))) for name in _INSTANTS]
    earliest = min(found)
    return earliest if earliest < math.inf else math.nan


def _event_sequence(run: Mapping[str, Column], name: str) -> list[tuple[float, tuple[str, ...]]]:
    """Return the events of a kind in order, with their labels."""
    if name not in run:
        return []
    dim = run[name].dims[0]
    said = [one.values for one in run.values() if one.dims == (dim,) and one.dtype.kind != "f"]
    return [(float(time), tuple(str(each[k]) for each in said)) for k, time in enumerate(run[name].values)]


def _first_mismatch(
    mine: list[tuple[float, tuple[str, ...]]], other: list[tuple[float, tuple[str, ...]]]
) -> float:
    """Return the time at which two sequences begin to differ [s]; infinite if never."""
    for (here, what), (there, instead) in zip(mine, other, strict=False):
        if what != instead:
            return min(here, there)
    rest = (mine if len(mine) > len(other) else other)[min(len(mine), len(other)) :]
    return rest[0][0] if rest else math.inf


# --- contacts and events of a perturbed run compared with the nominal run's ---------------------------------

# Time within which onsets are simultaneous, as at both rims of a bore, their order being round-off [s].
_AT_ONCE = 1e-9


def _in_order_of(ours: Mapping[str, Column], theirs: Mapping[str, Column]) -> Mapping[str, Column]:
    """Return a perturbed run's variables with simultaneous onsets in a run's order."""
    count = len(theirs["onset_time"].values) if "onset_time" in theirs else -1
    if count < 0 or "onset_time" not in ours or len(ours["onset_time"].values) != count:
        return theirs
    order = np.empty(count, dtype=int)
    order[_onset_order(ours)] = _onset_order(theirs)
    if (np.diff(order) > 0).all():
        return theirs
    return {
        name: Column(one.dims, one.values.take(order, one.dims.index("episode")), one.attrs)
        if "episode" in one.dims
        else one
        for name, one in theirs.items()
    }


def _onset_order(run: Mapping[str, Column]) -> NDArray[np.int_]:
    """Return contacts in order of onset, simultaneous ones in order of number."""
    onsets = run["onset_time"].values
    later = np.diff(onsets, prepend=onsets[:1]) > _AT_ONCE
    return np.lexsort((run["episode_contact"].values, np.cumsum(later)))


def _check_same_events(ours: Mapping[str, Column], theirs: Mapping[str, Column], what: str) -> None:
    """Refuse a perturbed run with other onsets or events."""
    for name, here in ours.items():
        there = theirs.get(name)
        if "time" in here.dims or here.dtype.kind == "f" and there is not None and here.shape == there.shape:
            continue
        if there is None or here.shape != there.shape or not np.array_equal(here.values, there.values):
            time = _first_difference(ours, theirs)
            at = "" if np.isnan(time) else f", first at {time:.9g} s"
            raise GrazeError(
                f"sensitivities: {what}, other contacts begin or other events occur{at}: there is no "
                f"derivative; choose another value, or a span that ends before",
                time,
            )


# Difference steps of each order over a parameter's scale, the largest first; the first at which two orders
# agree so well is used, else the best. Where contacts come to rest by ever smaller impacts only the finest
# leave their number unchanged.
_STEPS = {6: (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8), 2: (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)}
_GOOD = {6: 1e-7, 2: 1e-3}
# Ratio of consecutive steps.
_FINER = 10.0
# Variables of the computation, not of the motion.
_OF_THE_RUN = ("energy_error",)
# Approximate error of a run in its tolerances.
_TOLERANCES = 10.0
# A force's maximum is located by values alone: to the root of round-off over its duration, times the sum of
# difference weights.
_LOCATED = 3e-8
# Tolerance of requested sample times [ulp of the last].
_ULPS = 4.0


class VariableDerivatives(NamedTuple):
    """Derivatives over one parameter, by variable."""

    values: dict[str, Array]
    doubts: dict[str, Array]  # difference of two orders, and the runs' own error


class _Difference(NamedTuple):
    """Derivative of a variable by one step."""

    value: Array
    doubt: Array  # error estimate
    worst: float  # largest error estimate over the derivative, or over the variable's size per scale
    noise: float  # share of it by the runs' own error, in inverse proportion to the step


def _numbers_at(run: Trajectory, times: Array) -> xr.Dataset:
    """Return the differentiable numbers of a result, at some of its times."""
    names = [name for name, one in run.data.data_vars.items() if one.dtype.kind == "f"]
    data = run.data[[name for name in names if name not in _OF_THE_RUN]]
    if "time" not in data.sizes:
        return data
    return data.isel(time=_samples_at(run.data["time"].values, times)).assign_coords(time=times)


def _samples_at(had: Array, times: Array) -> NDArray[np.int_]:
    """Return the indices of a run's samples at some times."""
    near = _ULPS * np.spacing(max(float(had[-1]), float(times.max(initial=0.0))))
    at = np.searchsorted(had, times + near, side="right") - 1
    lacking = np.abs(had[at] - times) > near
    if lacking.any():
        raise SensitivityError(f"sensitivities: the run has no sample at {times[lacking][0]:.9g} s")
    return np.asarray(at)


def _sizes(data: xr.Dataset) -> dict[str, float]:
    """Return the largest size among variables of the same unit, by variable."""
    own = {
        str(name): float(np.nanmax(np.abs(one.values), initial=0.0)) for name, one in data.data_vars.items()
    }
    most: dict[str, float] = {}
    for name, size in own.items():
        unit = str(data[name].attrs.get("units", ""))
        most[unit] = max(most.get(unit, 0.0), size)
    return {name: most[str(data[name].attrs.get("units", ""))] for name in own}


def _longest(data: xr.Dataset) -> float:
    """Return the duration of a run's longest contact [s]."""
    if "onset_time" not in data:
        return 0.0
    until = np.fmin(data["release_time"].values, float(data.attrs["end_time"]))
    return float(np.nanmax(until - data["onset_time"].values, initial=0.0))


class FiniteDifferences:
    """Derivatives of a scenario's results by differences of runs.

    Of order 6 by six runs a parameter, of order 2 by two; runs begin at a given state, or at the scenario's
    start.
    """

    def __init__(
        self,
        scenario: Scenario,
        settings: RunSettings,
        duration: float,
        times: Array,
        start: State | None = None,
        processes: int = 1,
        order: int = 6,
    ) -> None:
        self._order, self._first = order, 0
        self._scenario, self._settings, self._duration = scenario, settings, duration
        self._times, self._start, self._processes = times, start, processes
        self._system = build_system(scenario) if start is not None else None
        self.run = self._completed_run(scenario, "the run", start)
        self._columns = columns_of(self.run)
        self.here = _numbers_at(self.run, times)
        self._here = {str(name): one.values for name, one in self.here.data_vars.items()}
        #: Size of each variable, or of others of its unit: it may be near zero itself.
        self.sizes = _sizes(self.here)
        #: Duration of the longest contact with a force maximum [s].
        self._longest = _longest(self.run.data)

    def _completed_run(self, scenario: Scenario, what: str, start: State | None) -> Trajectory:
        """Return a run of a scenario, from its start or from a state."""
        given: dict[str, Any] = {"settings": self._settings, "duration": self._duration}
        if start is None and scenario is self._scenario:
            run = simulate(scenario, **given)
        else:  # a scenario's own times of samples are none behind its duration
            system = build_system(scenario)
            if start is None:
                q, v = initial_state(scenario, system)
                first: dict[str, Any] = {"q": q, "v": v, "angles": initial_angles(scenario, system)}
            else:
                first = {"start": start}
            given |= {"events": events_of(scenario), "controllers": controllers_of(scenario)}
            run = simulate(system, **given, **first)
        if not uninterrupted(run).completed:
            raise SensitivityError(f"sensitivities: {what} has no whole result: {run.message}")
        return run

    def derivatives(self, parameters: Sequence[Parameter]) -> list[VariableDerivatives]:
        """Return the derivatives over each of some parameters.

        Raises:
            GrazeError: A contact or an event appears or vanishes with one.
            SensitivityError: A run did not complete, or the scenario refuses a perturbed run's value.
        """
        return [self._over(one) for one in parameters]

    def _over(self, parameter: Parameter) -> VariableDerivatives:
        """Return derivatives by the best step for each number, with few steps.

        The first step is the largest one with unchanged events of the last parameter's perturbed runs. Finer
        ones follow while they improve an inaccurate number, judging by the two before; coarser ones where the
        error of the first is the runs' own.
        """
        best: dict[str, _Difference] = {}
        steps, first = _STEPS[self._order], self._first
        unlike: GrazeError | None = None
        for k in range(first, len(steps)):
            try:
                found = self._differences(parameter, steps[k])
            except GrazeError as error:
                unlike = error
                continue
            if not best:
                self._first, best = k, found
            elif not self._take(best, found, finer=True):
                break
            if not any(self._poor(one) and _FINER * one.noise < one.worst for one in found.values()):
                break
        if not best:
            self._first = 0
            if first > 0:
                return self._over(parameter)
            assert unlike is not None
            raise unlike
        coarser = () if unlike is not None and self._first > first else reversed(steps[: self._first])
        for step in coarser:  # of which none has just been found to part perturbed runs
            if not any(self._poor(one) and one.worst < 2.0 * one.noise for one in best.values()):
                break
            try:
                better = self._take(best, self._differences(parameter, step), finer=False)
            except GrazeError:
                break
            if not better:
                break
            self._first -= 1
        return VariableDerivatives(
            {k: one.value for k, one in best.items()}, {k: one.doubt for k, one in best.items()}
        )

    def _poor(self, one: _Difference) -> bool:
        """Return whether a number is inaccurate."""
        return one.worst > _GOOD[self._order]

    def _take(
        self, best: dict[str, _Difference], differences: dict[str, _Difference], *, finer: bool
    ) -> bool:
        """Update the best differences; return whether an inaccurate one improved.

        The difference of two orders follows a power of the step: any excess over it is noise.
        """
        less = _FINER ** (1 if self._order == 2 else 4)
        gained = False
        for name, one in differences.items():
            here = best[name]
            if finer:
                differences[name] = one = one._replace(noise=max(one.noise, one.worst - here.worst / less))
            if one.worst < here.worst:
                gained = gained or self._poor(here)
                best[name] = one
        return gained

    def _differences(self, parameter: Parameter, step: float) -> dict[str, _Difference]:
        """Return derivatives by variable, by perturbed runs on both sides."""
        h, points = step * parameter.scale, (1, 2, 3) if self._order == 6 else (1,)
        values = [parameter.value + side * point * h for side in (1, -1) for point in points]
        work: Callable[[float], dict[str, Array]] = functools.partial(self._neighbour, parameter)
        made = list(side_by_side(work, values, self._processes))
        found = {}
        for name, here in self._here.items():
            sides = made[: len(points)], made[len(points) :]
            ahead, behind = (np.array([one[name] for one in side]) for side in sides)
            if self._order == 6:
                best, other = np.tensordot(WEIGHTS, ahead - behind, 1) / h
            else:  # on one side it is of first order
                best, other = 0.5 * (ahead - behind)[0] / h, (ahead[0] - here) / h
            # A run's error grows along it as a parameter's perturbation does.
            grown = float(np.nanmax(np.abs(best), initial=0.0)) * parameter.scale
            noise = _TOLERANCES * self._settings.rtol * max(self.sizes[name], grown) / h
            if name == "peak_time":
                noise += _LOCATED * self._longest / h
            doubt = np.abs(best - other) + noise
            # Changes smaller than the number's own size over the scale are negligible.
            own = self.sizes[name] / parameter.scale
            size = max(float(np.nanmax(np.abs(best), initial=0.0)), own)
            worst = float(np.nanmax(doubt, initial=0.0)) / size if size > 0.0 else 0.0
            found[name] = _Difference(best, doubt, worst, noise / size if size > 0.0 else 0.0)
        return found

    def _neighbour(self, parameter: Parameter, value: float) -> dict[str, Array]:
        """Return the numbers of a perturbed run, by variable."""
        what = f"with {parameter.key} = {value:.12g}"
        try:
            other = with_number(self._scenario, parameter.key, value)
        except AntennaPinError as error:
            raise SensitivityError(
                f"sensitivities: {parameter.key} must have room on both sides: {error}"
            ) from error
        start = self._start
        if start is not None and self._system is not None and is_initial(parameter.key):
            start = shifted_start(start, self._scenario, other, self._system)
        try:
            run = self._completed_run(other, f"a run {what}", start)
        except SensitivityError:
            raise
        except AntennaPinError as error:  # of what is built, which only some values want more for
            raise SensitivityError(f"sensitivities: {what}, which is next to its value: {error}") from error
        there = _in_order_of(self._columns, columns_of(run))
        _check_same_events(self._columns, there, what)
        at = _samples_at(there["time"].values, self._times) if "time" in there else slice(None)
        return {
            name: np.asarray(there[name].values[at] if "time" in there[name].dims else there[name].values)
            for name in self._here
        }
