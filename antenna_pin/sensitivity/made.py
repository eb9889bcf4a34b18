"""Sensitivities of a scenario's results to its numbers."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from antenna_pin.arguments import takes
from antenna_pin.errors import InvalidParameterError
from antenna_pin.scenario import Scenario
from antenna_pin.sensitivity.by_runs import ByRuns
from antenna_pin.sensitivity.found import Sensitivities, dataset_of
from antenna_pin.sensitivity.parameters import parameters_of
from antenna_pin.settings import RunSettings
from antenna_pin.simulation.from_scenario import settings_of
from antenna_pin.state import State

__all__ = ["sensitivities"]

# Of runs that are differentiated, where no settings are given.
_RTOL = 1e-12


@takes(duration="s")
def sensitivities(
    scenario: Scenario,
    keys: Sequence[str] | Mapping[str, float | str | None],
    times: ArrayLike | None = None,
    *,
    duration: float | str | None = None,
    settings: RunSettings | None = None,
    start: State | None = None,
    processes: int = 1,
) -> Sensitivities:
    """Return the derivatives of a scenario's results over some of its numbers.

    All numbers of the result have them: samples at given times, instants and peaks of contacts, impulses,
    losses, whatever the schema names. They are differences of sixth order of runs, each of which locates its
    own contacts and events; in doubt by what fourth order says otherwise and by the runs' own error.

    Args:
        scenario: The scenario.
        keys: Of its numbers, as in ``--set``; ``mechanism.gravity[2]`` for one of an array. A mapping gives
            each a scale, beside which changes are small, a number or text with a unit: the size of its value
            if None, and to be given where that is 0.
        times: At which samples are differentiated, ascending [s]; the scenario's output if left out.
        duration: Of the run [s]; the scenario's if left out, or up to the last of ``times``.
        settings: How to integrate; with the scenario's engine, order 8(5,3) and 1e-12 if left out.
        start: From where the run goes on, the ``end`` of another; the scenario's start if left out.
        processes: In how many processes runs are made side by side.

    Raises:
        GrazeError: A contact or an event comes or goes with the smallest change: there is no derivative.
        SensitivityError: A run does not come to its end, or a number has no neighbours.
        AntennaPinError: The input is not valid.
    """
    place = "sensitivities"
    assert not isinstance(duration, str)
    parameters = parameters_of(scenario, keys, place)
    begin = 0.0 if start is None else start.reached
    used, at, span = _sampled(scenario, times, duration, settings, begin)
    runs = ByRuns(scenario, used, span, at, start, processes)
    found = runs.over(parameters)
    names = [str(name) for name in runs.here.data_vars]
    slopes, doubts = (
        {name: np.stack([getattr(one, kind)[name] for one in found], axis=-1) for name in names}
        for kind in ("values", "doubts")
    )
    return Sensitivities(runs.run, parameters, dataset_of(runs.here, slopes, doubts, parameters))


def _sampled(
    scenario: Scenario,
    times: ArrayLike | None,
    duration: float | None,
    settings: RunSettings | None,
    begin: float,
) -> tuple[RunSettings, np.ndarray, float]:
    """Return how to integrate, the times of samples (times,) [s] and the span of the run [s]."""
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
