"""Deviation of a run's joints and base from the ideal run."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from antenna_pin.analysis._run import (
    RunLike,
    blocks,
    choose,
    data_of,
    floats,
    label_of,
    sample_times,
    samples_around,
    variable,
)
from antenna_pin.analysis.body_motion import base_motion, common_samples, motion_deviation
from antenna_pin.analysis.sampled import Mean, resampled, straight_line
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.errors import InvalidParameterError
from antenna_pin.trajectory import names_along

# --- growth of a deviation ----------------------------------------------------------------------------------
#
# What is fitted is the envelope :math:`E(t) = \max_{s \le t} |d(s)|`, which never falls, so that zero
# crossings of an oscillating deviation do not count. In its logarithm both laws are straight lines,
#
# .. math:: \ln E = \ln c + p \ln (t - t_0), \qquad \ln E = \ln c + \lambda (t - t_0),
#
# with :math:`t_0` the start of the run. They are fitted by least squares at 200 points evenly over the time
# of growth: from where E first passes a thousandth of its final value (less may be no more than two
# integrations differ by) to where it reaches that value. The rest of the run, where nothing grows, is left
# out.

_POINTS = 200
_LEAST_RECORDS = 8
_LEAST_GROWTH = 3.0
_LEAST_SHARE = 0.2
_LEAST_FIT = 0.9


@dataclass(frozen=True, slots=True, kw_only=True)
class Growth:
    """Fits to the envelope of a deviation; numbers are NaN where nothing is fitted."""

    kind: Literal["power", "exponential", "none"]  # law that fits better
    exponent: float  # p of the power of time [-]
    power_r2: float  # coefficient of determination of ln E for the power [-]
    rate: float  # lambda of the exponential [1/s]
    exponential_r2: float  # coefficient of determination of ln E for the exponential [-]
    start: float  # begin of the fit [s]
    end: float  # end of the fit [s]
    note: str = ""  # reason why neither law fits

    def __str__(self) -> str:
        """Return the better law in words."""
        if self.kind == "power":
            return f"t^{self.exponent:.3g} (R2 {self.power_r2:.3f})"
        if self.kind == "exponential":
            return f"exp({self.rate:.3g}/s t) (R2 {self.exponential_r2:.3f})"
        return self.note


@takes()
def growth_of(time: ArrayLike, deviation: ArrayLike) -> Growth:
    """Return fits of a power and an exponential to a growing deviation.

    The fit means nothing, and ``kind`` is "none", if the envelope rises in fewer than 8 samples (one or two
    jumps are not a law), by less than a factor of 3 (then it is level), for less than a fifth of the run
    (then one early event made it), or if neither straight line explains nine tenths of the variance of ln E.
    A rate is that of this run over this time, not a Lyapunov exponent: play bounds a deviation, or friction
    drives it, long before.

    Args:
        time: Sample times, not decreasing, (n,) [s].
        deviation: Samples, (n,).
    """
    values = np.asarray(deviation, dtype=float)
    return growths_of(np.asarray(time, dtype=float), lambda: [values[:, None]])[0]


def growths_of(time: Array, parts: Callable[[], Iterable[Array]]) -> list[Growth]:
    """Return :func:`growth_of` deviations that are too long for memory.

    ``parts`` returns the samples part by part, (m, k) of k deviations; it is called twice.
    """
    tops: list[_Top] = []
    begin = 0
    for part in parts():
        sizes = np.abs(part)
        if not tops:
            tops = [_Top() for _ in sizes.T]
        for top, size in zip(tops, sizes.T, strict=True):
            top.rise(size, begin)
        begin += len(sizes)
    envelopes = [_Envelope(time, top) for top in tops]
    begin = 0
    for part in parts() if time.size > 1 else ():
        sizes = np.abs(part)
        for envelope, size in zip(envelopes, sizes.T, strict=True):
            envelope.go_on(size, begin)
        begin += len(sizes)
    return [envelope.fitted() for envelope in envelopes]


class _Top:
    """Largest size, and its first place."""

    def __init__(self) -> None:
        self.size, self.place = 0.0, 0

    def rise(self, size: Array, begin: int) -> None:
        """Add samples, the first of which is number ``begin``; NaN remains."""
        if size.size and not size.max() <= self.size:
            self.place, self.size = begin + int(np.argmax(size)), float(size.max())


class _Envelope:
    """Points of an envelope for the fits, gathered part by part."""

    def __init__(self, time: Array, top: _Top) -> None:
        self._time, self._top = time, top
        self._so_far = 0.0
        self._first: int | None = None
        self._rises = 0
        self._points, self._places = np.zeros(0), np.zeros(0, dtype=int)
        self._values = np.zeros(0)
        self._at_first = 0.0

    def go_on(self, size: Array, begin: int) -> None:
        """Add samples, the first of which is number ``begin``."""
        if not self._top.size > 0.0 or not size.size:
            return
        all_of_it = np.maximum.accumulate(np.concatenate([[self._so_far], size]))
        self._so_far, envelope = float(all_of_it[-1]), all_of_it[1:]
        if self._first is None and self._so_far > 1e-3 * self._top.size:
            self._start(begin + int(np.argmax(envelope > 1e-3 * self._top.size)))
        if self._first is None:
            return
        if begin <= self._first < begin + size.size:
            self._at_first = float(envelope[self._first - begin])
        first, last = max(self._first + 1 - begin, 0), self._top.place + 1 - begin
        self._rises += int(np.count_nonzero(np.diff(all_of_it)[first : max(last, 0)]))
        here = (self._places >= begin) & (self._places < begin + size.size)
        self._values[here] = envelope[self._places[here] - begin]

    def _start(self, risen: int) -> None:
        time, last = self._time, self._top.place
        # Time zero has no logarithm, and a deviation there would be no growth.
        first = self._first = max(risen, int(np.argmax(time > time[0])))
        self._points = np.linspace(time[first] - time[0], time[last] - time[0], _POINTS)
        places = np.searchsorted(time - time[0], self._points, side="right") - 1
        self._places = np.clip(places, first, max(last, first))
        self._values = np.zeros(_POINTS)

    def fitted(self) -> Growth:
        """Return the fits."""
        t, first, last = self._time, self._first, self._top.place
        if t.size < 2 or not self._top.size > 0.0 or first is None:
            return _nothing("it does not deviate", t)
        if self._rises + 1 < _LEAST_RECORDS:
            return _nothing("it rises in a few jumps only", t)
        if self._top.size < _LEAST_GROWTH * self._at_first:
            return _nothing("it is level", t)
        if t[last] - t[first] < _LEAST_SHARE * (t[-1] - t[0]):
            return _nothing("it grows for less than a fifth of the run", t)
        logarithm = np.log(self._values)
        exponent, power = straight_line(np.log(self._points), logarithm)
        rate, exponential = straight_line(self._points, logarithm)
        better = max(power, exponential)
        poor = better < _LEAST_FIT
        return Growth(
            kind="none" if poor else "power" if power >= exponential else "exponential",
            exponent=exponent,
            power_r2=power,
            rate=rate,
            exponential_r2=exponential,
            start=float(t[first]),
            end=float(t[last]),
            note="neither a power nor an exponential fits" if poor else "",
        )


def _nothing(note: str, time: Array) -> Growth:
    nan = float("nan")
    start, end = (float(time[0]), float(time[-1])) if time.size else (nan, nan)
    fits = dict.fromkeys(("exponent", "power_r2", "rate", "exponential_r2"), nan)
    return Growth(kind="none", **fits, start=start, end=end, note=note)


# --- deviation from the ideal run ---------------------------------------------------------------------------

_Variable: TypeAlias = "tuple[tuple[str, ...], Array, dict[str, str]]"


# By dimension: quantity, what it is called, its variable, that of its derivative.
_JOINTS: dict[str, tuple[tuple[str, str, str, str | None], ...]] = {
    "joint": (
        ("angle", "angle", "motion_angle", "motion_rate"),
        ("rate", "rate", "motion_rate", "motion_acceleration"),
        ("acceleration", "acceleration", "motion_acceleration", None),
    ),
    "sliding_joint": (
        ("slide_position", "position", "slide_position", "slide_rate"),
        ("slide_rate", "rate", "slide_rate", "slide_acceleration"),
        ("slide_acceleration", "acceleration", "slide_acceleration", None),
    ),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class DeviationMeasures:
    """Measures of a deviation; of a vector, those of its length."""

    of: str  # joint and quantity, "elevation angle", or "base position"
    units: str  # of all but times and growth
    maximum: float  # largest size
    time_of_maximum: float  # [s]
    rms: float  # root mean square over time
    end: float  # value at the last sample, with its sign if it is a joint's
    growth: Growth  # how its envelope grows


@dataclass(frozen=True, slots=True, eq=False)
class Deviation:
    """A run less the ideal one."""

    # ``angle`` [rad], ``rate`` [rad/s], ``acceleration`` [rad/s^2] over time and joint; ``slide_position``
    # [m], ``slide_rate`` [m/s], ``slide_acceleration`` [m/s^2] over time and sliding joint; of a free base,
    # over time and axis in world axes, ``base_position`` [m], ``base_attitude`` (rotation vector from the
    # ideal to the run's attitude) [rad], ``base_velocity`` [m/s], ``base_angular_velocity`` [rad/s],
    # ``base_acceleration`` [m/s^2], ``base_angular_acceleration`` [rad/s^2]. At the run's samples within the
    # time that both runs cover
    data: xr.Dataset
    measures: tuple[DeviationMeasures, ...]  # one per joint and quantity, then per quantity of the base

    def __getitem__(self, of: str) -> DeviationMeasures:
        """Return the measures of "elevation angle" or "base position"."""
        known = [measures.of for measures in self.measures]
        return self.measures[known.index(choose("deviation", "quantity", of, known)[0])]


@takes()
def deviation(run: RunLike, ideal: RunLike, joint: str | None = None) -> Deviation:
    """Return the deviation of a run from the ideal one, at the run's samples.

    The ideal run is smooth and is interpolated: a cubic Hermite spline where the derivative is recorded
    (angle by rate, rate by acceleration, position by velocity), else a cubic spline. At 1 kHz its error is
    below 1e-12 of the amplitude for motion of a few hertz. The run itself is not interpolated. Runs of
    different lengths are compared while both last.

    Args:
        run: The run to judge; usually one with clearance.
        ideal: A run of the same mechanism without any contact.
        joint: Name of a joint; all joints that both runs have if left out.

    Raises:
        InvalidParameterError: If the ideal run has contacts, or the runs share less than two samples' time.
    """
    found = deviation_over_time(run, ideal, joint)
    return Deviation(found, _measures(found["time"].values, lambda: [found]))


@takes()
def deviation_measures(
    run: RunLike, ideal: RunLike, joint: str | None = None
) -> tuple[DeviationMeasures, ...]:
    """Return the ``measures`` of :func:`deviation`, for runs of any length.

    Long runs are examined part by part. Arguments and errors are those of :func:`deviation`.
    """
    pair = _Pair(data_of(run), data_of(ideal), joint)
    return _measures(pair.at, lambda: (pair.apart(part) for part in blocks(pair.data)))


@takes()
def deviation_over_time(run: RunLike, ideal: RunLike, joint: str | None = None) -> xr.Dataset:
    """Return the ``data`` of :func:`deviation` without its measures."""
    pair = _Pair(data_of(run), data_of(ideal), joint)
    return pair.apart(pair.data)


class _Pair:
    """Run and ideal run, with ``data`` and sample times ``at`` of the common span."""

    def __init__(self, data: xr.Dataset, reference: xr.Dataset, joint: str | None) -> None:
        common = common_samples(data, reference, "deviation")
        shared = {
            dim: [name for name in names_along(data, dim) if name in names_along(reference, dim)]
            for dim in _JOINTS
        }
        every = [name for names in shared.values() for name in names]
        chosen = choose("deviation", "joint", joint, every)
        self._based = "base_position" in data and "base_position" in reference
        if not chosen and not self._based:
            raise InvalidParameterError(
                "deviation",
                "ideal",
                "a run of the same mechanism",
                f"{label_of(reference)} with joints {', '.join(names_along(reference, 'joint')) or 'none'}",
            )
        self._joints = {dim: [name for name in names if name in chosen] for dim, names in shared.items()}
        self.data, self._reference = data.isel(time=common), reference
        self.at = sample_times(self.data, "deviation")

    def apart(self, part: xr.Dataset) -> xr.Dataset:
        """Return the deviation of a part of the run."""
        at = sample_times(part, "deviation")
        near = [
            self._variables(part.isel(time=some), at[some], smooth)
            for some, smooth in samples_around(self._reference, at)
        ]
        variables = {
            name: (dims, values if len(near) == 1 else np.concatenate([one[name][1] for one in near]), about)
            for name, (dims, values, about) in near[0].items()
        }
        coords: dict[str, Any] = {"time": ("time", at, {"units": "s", "long_name": "time"})}
        coords["joint"] = self._joints["joint"]
        if self._joints["sliding_joint"]:
            coords["sliding_joint"] = self._joints["sliding_joint"]
        if self._based:
            coords["axis"] = part.coords["axis"].values
        cases = (str(one.attrs.get("case", "")) for one in (part, self._reference))
        return xr.Dataset(variables, coords=coords, attrs=dict(zip(("case", "ideal"), cases, strict=True)))

    def _variables(self, data: xr.Dataset, at: Array, reference: xr.Dataset) -> dict[str, _Variable]:
        own = sample_times(reference, "deviation")
        variables: dict[str, _Variable] = {}
        for dim, names in self._joints.items():
            for quantity, words, name, derivative in _JOINTS[dim] if names else ():
                wanted = variable(data, name, "deviation")
                values = floats(wanted.sel({dim: names}))
                base_line = floats(variable(reference, name, "deviation").sel({dim: names}))
                slope = floats(reference[derivative].sel({dim: names})) if derivative in reference else None
                variables[quantity] = (
                    ("time", dim),
                    values - resampled(own, base_line, at, slope),
                    {"units": str(wanted.attrs.get("units", "")), "long_name": f"deviation of the {words}"},
                )
        if self._based:
            for name, one in motion_deviation(base_motion(data), base_motion(reference), "base").items():
                variables[f"base_{name}"] = (("time", "axis"), one.values, one.attrs)
        return variables


def _measures(time: Array, parts: Callable[[], Iterable[xr.Dataset]]) -> tuple[DeviationMeasures, ...]:
    """Return the measures of deviations.

    ``parts`` returns the deviations part by part; it is called three times.
    """
    units: dict[str, str] = {}
    sums: list[_Sums] = []
    for part in parts():
        columns = _columns(part)
        units = {of: unit for of, (unit, _) in columns.items()}
        sums = sums or [_Sums() for _ in columns]
        for one, (_, values) in zip(sums, columns.values(), strict=True):
            one.add(part["time"].values, values)
    growths = growths_of(
        time, lambda: (np.stack([values for _, values in _columns(part).values()], 1) for part in parts())
    )
    return tuple(
        DeviationMeasures(of=of, units=unit, growth=growth, **one.measures())
        for (of, unit), one, growth in zip(units.items(), sums, growths, strict=True)
    )


def _columns(part: xr.Dataset) -> dict[str, tuple[str, Array]]:
    """Return units and values over time, (m,), of each quantity."""
    found = {}
    for dim, quantities in _JOINTS.items():
        for k, name in enumerate(names_along(part, dim)):
            for quantity, words, *_ in quantities:
                one = part[quantity]
                found[f"{name} {words}"] = (str(one.attrs["units"]), np.asarray(one.values[:, k]))
    for key, one in part.data_vars.items():
        if str(key).startswith("base_"):
            found[str(key).replace("_", " ")] = (str(one.attrs["units"]), np.linalg.norm(one.values, axis=1))
    return found


class _Sums:
    """Largest size, root mean square and end of a deviation, gathered part by part."""

    def __init__(self) -> None:
        self.maximum, self.time_of_maximum, self.end = float("nan"), float("nan"), float("nan")
        self._mean = Mean()

    def measures(self) -> dict[str, float]:
        """Return the measures by name."""
        sums = {"maximum": self.maximum, "time_of_maximum": self.time_of_maximum, "end": self.end}
        return sums | {"rms": float(np.sqrt(self._mean.value))}

    def add(self, time: Array, values: Array) -> None:
        """Add samples."""
        size = np.abs(values)
        largest = int(np.argmax(np.nan_to_num(size)))
        if not size[largest] <= self.maximum:
            self.maximum, self.time_of_maximum = float(size[largest]), float(time[largest])
        self.end = float(values[-1])
        self._mean.add(time, np.square(values))
