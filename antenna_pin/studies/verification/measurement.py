"""Loop gain of a sampled controller, and orders of a wheel's disturbance, measured in runs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

from antenna_pin.analysis import SpeedRecord, speed_records, wheel_orders
from antenna_pin.base.arguments import takes
from antenna_pin.base.interruption import uninterrupted
from antenna_pin.errors import AntennaPinError, InvalidParameterError, UnknownNameError
from antenna_pin.run.simulation import simulate
from antenna_pin.scenario import Scenario
from antenna_pin.studies.linear import LoopMargins, loop_margins
from antenna_pin.trajectory import Trajectory, names_along

# Turns that pass before a measurement, and those that it takes; samples of a turn.
_SETTLING_TURNS, _MEASURED_TURNS, _SAMPLES = 20, 20, 64


@takes(speeds="rad/s")
def measured_orders(
    scenario: Scenario,
    joint: str,
    speeds: Sequence[float | str],
    *,
    count: int = 6,
    harmonics: Sequence[float] | None = None,
) -> xr.Dataset:
    """Return the orders of a wheel by runs at several speeds (:func:`antenna_pin.analysis.wheel_orders`).

    Args:
        scenario: The scenario.
        joint: Joint about which the wheel turns.
        speeds: As of :func:`records_at_speeds`.
        count: Likewise.
        harmonics: Harmonics of the speed; searched for if left out.
    """
    return wheel_orders(records_at_speeds(scenario, joint, speeds, count=count), harmonics=harmonics)


@takes(speeds="rad/s")
def records_at_speeds(
    scenario: Scenario, joint: str, speeds: Sequence[float | str], *, count: int = 6
) -> list[SpeedRecord]:
    """Return the disturbance of a wheel in runs at several speeds.

    Each run begins with the wheel at its speed, which drives of the scenario have to hold, and lasts 40
    turns, of which the last 20 count.

    Args:
        scenario: The scenario.
        joint: Joint about which the wheel turns.
        speeds: Lowest and highest speed [rad/s], between which ``count`` are evenly spaced; or all of three
            and more.
        count: Number of speeds between two.

    Raises:
        InvalidParameterError: Speeds that are not positive, or do not rise.
    """
    values = np.array(speeds, dtype=float)
    if len(values) < 2 or values[0] <= 0.0 or not (np.diff(values) > 0.0).all():
        rule = "positive speeds that rise, two or more"
        raise InvalidParameterError("measured orders", "speeds", rule, said=str(list(speeds)))
    if len(values) == 2:
        values = np.linspace(values[0], values[1], count)
    records = []
    for speed in values:
        turn = 2.0 * math.pi / float(speed)
        rate = max(_SAMPLES / turn, scenario.output.rate or 0.0)
        changed = scenario.with_overrides(
            {
                f"initial.joints.{joint}.rate": float(speed),
                "duration": (_SETTLING_TURNS + _MEASURED_TURNS) * turn,
                "output.rate": rate,
            }
        )
        records += speed_records(uninterrupted(simulate(changed)), joint, after=_SETTLING_TURNS * turn)
    return records


# Periods that pass before a measurement, of the crossing of small motions too; and those that it takes.
_SETTLING, _MEASURED = 4, 4
# Frequencies of a margin over the crossing of small motions.
_AROUND = (0.6, 0.8, 1.0, 1.25, 1.6)
_NAME = "measured_loop"


class LoopPoint(NamedTuple):
    """Loop gain at one frequency, by the fundamental of a run's measurement.

    Attributes:
        frequency: Frequency of the reference [Hz].
        gain: Complex loop gain, measurement over error [-].
        distortion: Root mean square of the measurement's other harmonics over its fundamental [-].
    """

    frequency: float
    gain: complex
    distortion: float


@takes()
def measured_loop(
    scenario: Scenario,
    controller: str,
    frequencies: Sequence[float],
    amplitude: float | str,
    operating_point: float | str | None = None,
) -> list[LoopPoint]:
    """Return the loop gain of a PID loop about an operating point, measured in runs.

    References are sines. The fundamentals of measurement y and error r - y at the sampling times give
    L = Y / E, as a describing function does, but with all harmonics in the loop. It depends on the amplitude
    where the loop is not linear.

    Args:
        scenario: The scenario; its other references stay.
        controller: Name of a PID whose derivative acts on the error, or without derivative.
        frequencies: Frequencies of the references, below half of the sampling rate [Hz].
        amplitude: Amplitude of the references, in the measurement's unit.
        operating_point: Mean of the references, in that unit; the measurement at the start if left out.

    Raises:
        UnknownNameError: The controller is unknown.
        InvalidParameterError: The derivative acts on the measurement, or a frequency is too high.
    """
    table = scenario.controllers.get(controller)
    if table is None or table.kind != "pid":
        known = [name for name, one in scenario.controllers.items() if one.kind == "pid"]
        raise UnknownNameError("measured loop", "pid controller", controller, known)
    if table.kd and table.derivative != "error":
        rule = '"error" for a loop gain by measurement over error; loop_margins takes all of them'
        raise InvalidParameterError("measured loop", f"{controller}.derivative", rule, table.derivative)
    mean = _measured_at_start(scenario, controller) if operating_point is None else operating_point
    try:
        crossing = loop_margins(scenario, controller).bandwidth
    except AntennaPinError:  # without a linear loop
        crossing = math.nan
    settled = _SETTLING / crossing if crossing > 0.0 else 0.0
    return [_point(scenario, controller, float(one), amplitude, mean, settled) for one in frequencies]


def _measured_at_start(scenario: Scenario, controller: str) -> float:
    """Return the first measurement of a controller."""
    period = float(scenario.controllers[controller].period)
    run = uninterrupted(simulate(scenario.with_overrides({"duration": period})))
    return float(_signal(run, controller, "measured")[1][0])


def _point(
    scenario: Scenario,
    controller: str,
    frequency: float,
    amplitude: float | str,
    mean: float | str,
    settled: float,
) -> LoopPoint:
    period = float(scenario.controllers[controller].period)
    if not 0.0 < frequency < 0.5 / period:
        rule = f"above 0 and below half of the sampling rate, {0.5 / period:g} Hz"
        raise InvalidParameterError("measured loop", "frequencies", rule, frequency)
    settled = max(settled, _SETTLING / frequency)
    course = {"kind": "sine", "amplitude": amplitude, "frequency": frequency, "mean": mean}
    changed = scenario.with_overrides(
        {
            f"references.{_NAME}": course,
            f"controllers.{controller}.follows": _NAME,
            f"controllers.{controller}.feedforward_rate": 0.0,
            f"controllers.{controller}.feedforward_acceleration": 0.0,
            "duration": settled + _MEASURED / frequency,
        }
    )
    run = uninterrupted(simulate(changed))
    time, measured = _signal(run, controller, "measured")
    _, reference = _signal(run, controller, "reference")
    late = time >= settled
    turn = 2.0 * math.pi * frequency * time[late]
    base = np.stack([np.ones_like(turn), np.cos(turn), np.sin(turn)], axis=1)
    y, *_ = np.linalg.lstsq(base, measured[late], rcond=None)
    e, *_ = np.linalg.lstsq(base, (reference - measured)[late], rcond=None)
    left = measured[late] - base @ y
    size = math.hypot(y[1], y[2]) / math.sqrt(2.0)
    distortion = float(np.sqrt(np.mean(left**2)) / size) if size > 0.0 else math.nan
    return LoopPoint(frequency, complex(y[1], -y[2]) / complex(e[1], -e[2]), distortion)


def _signal(run: Trajectory, controller: str, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return sampling times and a signal of a controller there."""
    data = run.data
    which = names_along(data, "sampled").index(controller)
    mine = data["tick_controller"].values.astype(int) == which
    values = data["tick_signal"].sel(signal=f"{controller}.{name}").values
    return data["tick_time"].values[mine], np.asarray(values[mine], dtype=float)


@takes()
def measured_phase_margin(
    scenario: Scenario,
    controller: str,
    amplitude: float | str,
    operating_point: float | str | None = None,
) -> tuple[float, list[LoopPoint]]:
    """Return the phase margin of a loop measured in runs [rad], with its points.

    Five frequencies about the crossing of small motions; NaN where none of them has the gain 1 beside it.

    Args:
        scenario: The scenario.
        controller: Name of the controller.
        amplitude: Amplitude of the references.
        operating_point: Their mean; the measurement at the start if left out.
    """
    crossing = loop_margins(scenario, controller).bandwidth
    frequencies = [share * crossing for share in _AROUND]
    points = measured_loop(scenario, controller, frequencies, amplitude, operating_point)
    return margins_of_points(points).phase, points


@takes()
def measured_gain_margin(
    scenario: Scenario,
    controller: str,
    amplitude: float | str,
    operating_point: float | str | None = None,
) -> tuple[float, list[LoopPoint]]:
    """Return the gain margin of a loop measured in runs [-], with its points.

    Five frequencies from the crossing of small motions to beyond their -180 degrees, and one more where the
    phase passes that between them; NaN where it does not.

    Args:
        scenario: The scenario.
        controller: Name of the controller.
        amplitude: Amplitude of the references.
        operating_point: Their mean; the measurement at the start if left out.
    """
    frequencies = frequencies_around(loop_margins(scenario, controller), 5, 1.0)
    points = measured_loop(scenario, controller, frequencies, amplitude, operating_point)
    lag = margins_of_points(points).lag
    if math.isfinite(lag):
        points += measured_loop(scenario, controller, [lag], amplitude, operating_point)
        points.sort(key=lambda one: one.frequency)
    return margins_of_points(points).gain, points


class MeasuredMargins(NamedTuple):
    """Margins of a measured loop; NaN for a crossing beyond the measured frequencies.

    Attributes:
        phase: Phase margin [rad].
        gain: Gain margin [-].
        crossing: Frequency at which the gain falls through 1 [Hz].
        lag: Frequency at which the phase falls through -180 degrees [Hz].
    """

    phase: float
    gain: float
    crossing: float
    lag: float


@takes()
def margins_of_points(points: Sequence[LoopPoint]) -> MeasuredMargins:
    """Return gain and phase margin of measured points.

    Logarithms of gain and frequency, and phase, are taken as straight between them.

    Args:
        points: Of rising frequency, two or more.
    """
    gains = np.log(np.abs([one.gain for one in points]))
    # Of the phase over -180 degrees, from the first point on, which is within a turn of it.
    above = np.unwrap(np.angle([one.gain for one in points])) + math.pi
    above -= 2.0 * math.pi * math.floor(above[0] / (2.0 * math.pi))
    frequencies = np.log([one.frequency for one in points])

    def falls(values: np.ndarray) -> tuple[int, float] | None:
        found = np.flatnonzero((values[:-1] >= 0.0) & (values[1:] < 0.0))
        if not found.size:
            return None
        k = int(found[-1])
        return k, float(values[k] / (values[k] - values[k + 1]))

    def at(values: np.ndarray, where: tuple[int, float] | None) -> float:
        if where is None:
            return math.nan
        k, share = where
        return float(values[k] + share * (values[k + 1] - values[k]))

    crossing, lag = falls(gains), falls(above)
    return MeasuredMargins(
        phase=at(above, crossing),
        gain=math.exp(-at(gains, lag)),
        crossing=math.exp(at(frequencies, crossing)),
        lag=math.exp(at(frequencies, lag)),
    )


@takes()
def frequencies_around(margins: LoopMargins, count: int = 8, lowest: float = 0.5) -> list[float]:
    """Return frequencies about the crossing of a loop, to beyond its -180 degrees [Hz].

    Args:
        margins: Of small motions.
        count: Number of frequencies.
        lowest: The first over the crossing [-].
    """
    late = margins.frequency > margins.bandwidth
    above = np.unwrap(np.angle(margins.response[late])) + math.pi
    above -= 2.0 * math.pi * math.floor(above[0] / (2.0 * math.pi))
    passed = np.flatnonzero(above < 0.0)
    last = float(margins.frequency[late][passed[0]]) if passed.size else 2.0 * margins.bandwidth
    highest = min(1.2 * last, 0.9 * float(margins.frequency[-1]))
    return [float(one) for one in np.geomspace(lowest * margins.bandwidth, highest, count)]
