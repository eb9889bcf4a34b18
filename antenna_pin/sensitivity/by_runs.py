"""Derivatives of a result by differences of runs, each of which finds its own contacts and events."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.assemble import build_system, initial_angles, initial_state
from antenna_pin.base.differences import WEIGHTS
from antenna_pin.base.interruption import uninterrupted
from antenna_pin.base.settings import RunSettings
from antenna_pin.base.side_by_side import side_by_side
from antenna_pin.base.state import State
from antenna_pin.errors import AntennaPinError
from antenna_pin.scenario import Scenario, with_number
from antenna_pin.sensitivity.parameters import GrazeError, Parameter, SensitivityError
from antenna_pin.sensitivity.starts import begun_from, is_of_start
from antenna_pin.simulation import simulate
from antenna_pin.simulation.inputs import controllers_of, events_of
from antenna_pin.trajectory import Column, Trajectory, columns_of

__all__ = ["ByRuns", "Slopes", "numbers_at"]


# --- when two runs part: the first contact, event or change of mode that only one of them has ---

_INSTANTS = ("onset_time", "change_time", "event_time")


def first_unlike(ours: Mapping[str, Column], theirs: Mapping[str, Column]) -> float:
    """Return when contacts, changes or events of two runs begin to differ [s]; NaN if all begin alike.

    Args:
        ours: Variables of a run.
        theirs: Those of another.
    """
    found = [_first(*(_course(one, name) for one in (ours, theirs))) for name in _INSTANTS]
    earliest = min(found)
    return earliest if earliest < math.inf else math.nan


def _course(run: Mapping[str, Column], name: str) -> list[tuple[float, tuple[str, ...]]]:
    """Return instants of a kind in order, each with what it is of: all that is no measured number."""
    if name not in run:
        return []
    dim = run[name].dims[0]
    said = [one.values for one in run.values() if one.dims == (dim,) and one.dtype.kind != "f"]
    return [(float(time), tuple(str(each[k]) for each in said)) for k, time in enumerate(run[name].values)]


def _first(mine: list[tuple[float, tuple[str, ...]]], other: list[tuple[float, tuple[str, ...]]]) -> float:
    """Return when two courses begin to differ [s]; infinite where they do not."""
    for (here, what), (there, instead) in zip(mine, other, strict=False):
        if what != instead:
            return min(here, there)
    rest = (mine if len(mine) > len(other) else other)[min(len(mine), len(other)) :]
    return rest[0][0] if rest else math.inf


# --- whether the contacts and events of a neighbour are those of a run, and in which order it has them ---

# Onsets of several contacts that are one instant, as where both rims of a bore are met at once: which of them
# is noted first is a matter of round-off [s].
_AT_ONCE = 1e-9


def in_order_of(ours: Mapping[str, Column], theirs: Mapping[str, Column]) -> Mapping[str, Column]:
    """Return a neighbour's variables with contacts that begin at once in the order of a run's.

    Args:
        ours: The run's.
        theirs: The neighbour's.
    """
    count = len(theirs["onset_time"].values) if "onset_time" in theirs else -1
    if count < 0 or "onset_time" not in ours or len(ours["onset_time"].values) != count:
        return theirs
    order = np.empty(count, dtype=int)
    order[_by_contact(ours)] = _by_contact(theirs)
    if (np.diff(order) > 0).all():
        return theirs
    return {
        name: Column(one.dims, one.values.take(order, one.dims.index("episode")), one.attrs)
        if "episode" in one.dims
        else one
        for name, one in theirs.items()
    }


def _by_contact(run: Mapping[str, Column]) -> NDArray[np.int_]:
    """Return contacts in the order in which they begin, of those at once the first in number first."""
    onsets = run["onset_time"].values
    later = np.diff(onsets, prepend=onsets[:1]) > _AT_ONCE
    return np.lexsort((run["episode_contact"].values, np.cumsum(later)))


def check_alike(ours: Mapping[str, Column], theirs: Mapping[str, Column], what: str) -> None:
    """Refuse a neighbour in which other contacts begin, or other things happen.

    Args:
        ours: The variables of the run.
        theirs: Those of the neighbour, in its order.
        what: What is said of it.

    Raises:
        GrazeError: It is none that goes over into the run.
    """
    for name, here in ours.items():
        there = theirs.get(name)
        if "time" in here.dims or here.dtype.kind == "f" and there is not None and here.shape == there.shape:
            continue
        if there is None or here.shape != there.shape or not np.array_equal(here.values, there.values):
            time = first_unlike(ours, theirs)
            at = "" if np.isnan(time) else f", first at {time:.9g} s"
            raise GrazeError(
                f"sensitivities: {what}, other contacts begin or other events happen{at}: it has no "
                f"derivative there; take another value, or a span that ends before",
                time,
            )


Array = NDArray[np.float64]

# Steps of differences of each order, over a parameter's scale, the largest first; the first with which two
# orders agree so well counts, else the one with which they agree best. Where contacts come to rest by ever
# smaller blows only the finest leave their number as it is.
_STEPS = {6: (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8), 2: (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)}
_GOOD = {6: 1e-7, 2: 1e-3}
# How much finer each of them is than the one before.
_FINER = 10.0
# Numbers of how a run is computed, none of the motion.
_OF_THE_RUN = ("energy_error",)
# How many of its tolerances a run is off by, about.
_TOLERANCES = 10.0
# A force's largest value is located by its values alone: to the root of round-off, over how long it lasts.
# Weights of differences come to twice that.
_LOCATED = 3e-8
# Where a run has samples that are asked for: how near [ulp of the last].
_ULPS = 4.0


class Slopes(NamedTuple):
    """Derivatives over one parameter.

    Attributes:
        values: By variable.
        doubts: Likewise: what is between differences of two orders, and the runs' own error.
    """

    values: dict[str, Array]
    doubts: dict[str, Array]


class _Difference(NamedTuple):
    """A derivative of a variable by one step.

    Attributes:
        value: The derivative.
        doubt: Of it.
        worst: The largest doubt, over the derivative or the variable's own size over the scale.
        noise: What of that the runs' own error is, which goes with one over the step.
    """

    value: Array
    doubt: Array
    worst: float
    noise: float


def numbers_at(run: Trajectory, times: Array) -> xr.Dataset:
    """Return the numbers of a result that may have derivatives, at some of its times.

    Raises:
        SensitivityError: The run has no sample there.
    """
    names = [name for name, one in run.data.data_vars.items() if one.dtype.kind == "f"]
    data = run.data[[name for name in names if name not in _OF_THE_RUN]]
    if "time" not in data.sizes:
        return data
    return data.isel(time=_samples_at(run.data["time"].values, times)).assign_coords(time=times)


def _samples_at(had: Array, times: Array) -> NDArray[np.int_]:
    """Return which of a run's samples are at some times."""
    near = _ULPS * np.spacing(max(float(had[-1]), float(times.max(initial=0.0))))
    at = np.searchsorted(had, times + near, side="right") - 1
    lacking = np.abs(had[at] - times) > near
    if lacking.any():
        raise SensitivityError(f"sensitivities: the run has no sample at {times[lacking][0]:.9g} s")
    return np.asarray(at)


def _sizes(data: xr.Dataset) -> dict[str, float]:
    """Return how large the numbers of the unit of each variable are."""
    own = {
        str(name): float(np.nanmax(np.abs(one.values), initial=0.0)) for name, one in data.data_vars.items()
    }
    most: dict[str, float] = {}
    for name, size in own.items():
        unit = str(data[name].attrs.get("units", ""))
        most[unit] = max(most.get(unit, 0.0), size)
    return {name: most[str(data[name].attrs.get("units", ""))] for name in own}


def _longest(data: xr.Dataset) -> float:
    """Return how long the longest of a run's contacts lasts [s]."""
    if "onset_time" not in data:
        return 0.0
    until = np.fmin(data["release_time"].values, float(data.attrs["end_time"]))
    return float(np.nanmax(until - data["onset_time"].values, initial=0.0))


class ByRuns:
    """Differentiates what runs of a scenario give.

    Args:
        scenario: The scenario.
        settings: Of all runs.
        duration: Of all runs [s].
        times: At which samples are differentiated, (times,) [s].
        start: From where they go on; the scenario's start if None.
        processes: In how many processes runs are made.
        order: Of differences: 6, of six runs a parameter, or 2, of two.
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
        """Make the run itself."""
        self._order, self._first = order, 0
        self._scenario, self._settings, self._duration = scenario, settings, duration
        self._times, self._start, self._processes = times, start, processes
        self._system = build_system(scenario) if start is not None else None
        self.run = self._made(scenario, "the run", start)
        self._columns = columns_of(self.run)
        self.here = numbers_at(self.run, times)
        self._here = {str(name): one.values for name, one in self.here.data_vars.items()}
        #: How large numbers of a variable are, or of others of its unit: it may be next to zero itself.
        self.sizes = _sizes(self.here)
        #: How long the longest contact lasts that has a largest force [s].
        self._longest = _longest(self.run.data)

    def _made(self, scenario: Scenario, what: str, start: State | None) -> Trajectory:
        """Return a run: the run itself of its scenario, others, and those from a state, of a system.

        Raises:
            SensitivityError: It did not come to its end.
        """
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

    def over(self, parameters: Sequence[Parameter]) -> list[Slopes]:
        """Return the derivatives over each of some parameters.

        Raises:
            GrazeError: A contact or an event comes or goes with one.
            SensitivityError: A run did not come to its end, or the scenario refuses a neighbour's value.
        """
        return [self._over(one) for one in parameters]

    def _over(self, parameter: Parameter) -> Slopes:
        """Return derivatives by the steps that are best for each number, of as few steps as tell that.

        They begin with the largest one that left the last parameter's neighbours alike. Finer ones are made
        while a number that is not known well would be known better, to judge by the two before; coarser ones
        where what it is off by at the first is the runs' own error.
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
        for step in coarser:  # of which none has just been found to part neighbours
            if not any(self._poor(one) and one.worst < 2.0 * one.noise for one in best.values()):
                break
            try:
                better = self._take(best, self._differences(parameter, step), finer=False)
            except GrazeError:
                break
            if not better:
                break
            self._first -= 1
        return Slopes({k: one.value for k, one in best.items()}, {k: one.doubt for k, one in best.items()})

    def _poor(self, one: _Difference) -> bool:
        """Whether a number is not known well."""
        return one.worst > _GOOD[self._order]

    def _take(self, best: dict[str, _Difference], found: dict[str, _Difference], *, finer: bool) -> bool:
        """Keep of each number the difference that is least in doubt; return whether one was poor and is less.

        What parts two orders goes with a power of the step: what is more of it than that is noise.
        """
        less = _FINER ** (1 if self._order == 2 else 4)
        gained = False
        for name, one in found.items():
            here = best[name]
            if finer:
                found[name] = one = one._replace(noise=max(one.noise, one.worst - here.worst / less))
            if one.worst < here.worst:
                gained = gained or self._poor(here)
                best[name] = one
        return gained

    def _differences(self, parameter: Parameter, step: float) -> dict[str, _Difference]:
        """Return derivatives by variable, by runs of neighbours on both sides."""
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
            # What a run is off by grows on the way as what a parameter changes does.
            grown = float(np.nanmax(np.abs(best), initial=0.0)) * parameter.scale
            noise = _TOLERANCES * self._settings.rtol * max(self.sizes[name], grown) / h
            if name == "peak_time":
                noise += _LOCATED * self._longest / h
            doubt = np.abs(best - other) + noise
            # What changes a number by less than its own size over the scale is faint beside it.
            own = self.sizes[name] / parameter.scale
            size = max(float(np.nanmax(np.abs(best), initial=0.0)), own)
            worst = float(np.nanmax(doubt, initial=0.0)) / size if size > 0.0 else 0.0
            found[name] = _Difference(best, doubt, worst, noise / size if size > 0.0 else 0.0)
        return found

    def _neighbour(self, parameter: Parameter, value: float) -> dict[str, Array]:
        """Return the numbers of a neighbour's run, by variable.

        Raises:
            GrazeError: Other contacts begin in it, or other events happen.
        """
        what = f"with {parameter.key} = {value:.12g}"
        try:
            other = with_number(self._scenario, parameter.key, value)
        except AntennaPinError as error:
            raise SensitivityError(
                f"sensitivities: {parameter.key} must have room on both sides: {error}"
            ) from error
        start = self._start
        if start is not None and self._system is not None and is_of_start(parameter.key):
            start = begun_from(start, self._scenario, other, self._system)
        try:
            run = self._made(other, f"a run {what}", start)
        except SensitivityError:
            raise
        except AntennaPinError as error:  # of what is built, which only some values want more for
            raise SensitivityError(f"sensitivities: {what}, which is next to its value: {error}") from error
        there = in_order_of(self._columns, columns_of(run))
        check_alike(self._columns, there, what)
        at = _samples_at(there["time"].values, self._times) if "time" in there else slice(None)
        return {
            name: np.asarray(there[name].values[at] if "time" in there[name].dims else there[name].values)
            for name in self._here
        }
