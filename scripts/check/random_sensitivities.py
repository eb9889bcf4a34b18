#!/usr/bin/env python3
"""Sensitivities of random mechanisms: is the variational equation what differences of runs are?

The mechanisms are those of ``random_scenarios.py``: 2 to 8 links, of whose joints 1 to 3 have play, all laws,
gaps in closed form; with a stop, friction that holds or bends, a gear, a closure, a mode or a motion besides
(``random_additions.py``). Up to behind the third contact (``--contacts``) the velocities are differentiated
over a radial clearance, a rate that a joint starts with, a mass, and a number of what is besides: by the
equation, with its jumps at every onset, release and event, and by differences of sixth order of runs, each of
which locates its own. They are to agree to ``--apart`` of the largest. Steps of a run go over kinks of laws
and do not notice: where both are apart, runs are made anew by steps of at most a part of the span, and then
of a fourth of that, until what is left of the difference is theirs no more. A graze is to be refused, with
its instant.

A line for each mechanism, with how far it is apart, by how much finer steps have moved runs, and in how much
doubt the equation is. ``agrees``: to ``--apart``. ``says so``: not to that, but within the equation's own
doubt. ``unsettled``: runs still move by more than a third of what is between both. ``APART``: the equation is
off and does not say so; then the exit code is 1. Told to stop (Ctrl-C) it sums up
what it has; ``--first`` goes on from there.
"""

from __future__ import annotations

import argparse
import dataclasses
import math
import sys
import time
import warnings
from collections import Counter
from typing import NamedTuple

import numpy as np
from random_additions import with_more
from scenario_generator import draw_scenario

from antenna_pin import AntennaPinError, Scenario, simulate
from antenna_pin.base.settings import RunSettings
from antenna_pin.run.simulation.inputs import settings_of
from antenna_pin.studies.sensitivity import GrazeError
from antenna_pin.studies.sensitivity.finite_differences import FiniteDifferences
from antenna_pin.studies.sensitivity.forward_sensitivity import ForwardSensitivity
from antenna_pin.studies.sensitivity.parameters import parameters_of

# In how many steps at least the runs are made that the equation is held against.
_STEPS = (1, 2_000, 8_000)
# Part of what is between both that runs may move by yet, if that is to be the equation's.
_SETTLED = 1.0 / 3.0
# Samples a second that show a mode of the additions.
_SHOWS = 200.0


class Verdict(NamedTuple):
    """What a comparison said."""

    apart: float  # by how much both differ, over the largest
    moved: float  # by how much finer steps have moved runs, likewise; infinite where none were made
    equation: float  # in how much doubt the equation is, likewise
    contacts: int  # how many contacts began
    parameters: int  # how many numbers were varied

    def word(self, limit: float) -> str:
        """Return it in a word, if both may be apart by so much."""
        if self.apart <= limit:
            return "agrees"
        if self.apart <= self.equation:
            return "says so"
        return "APART" if self.moved <= _SETTLED * self.apart else "unsettled"


def drawn(seed: int, number: int) -> tuple[Scenario, dict[str, str | float | None], str]:
    """Return the scenario of a number, what is varied of it, and what it has besides play."""
    scenario = draw_scenario(seed, number)
    plain = {f"clearance.{name}.geometry": "closed-form" for name in scenario.clearance}
    scenario = scenario.with_overrides(plain | {"integrator.engine": "compiled"})
    scenario, more, own = with_more(scenario, seed, number)
    return scenario, keys_of(scenario) | dict.fromkeys(own), more


def keys_of(scenario: Scenario) -> dict[str, str | float | None]:
    """Return what is varied of every mechanism, with scales: a clearance, a rate at the start."""
    found: dict[str, str | float | None] = {}
    for joint, one in scenario.clearance.items():
        if getattr(one, "radial_clearance", None) is not None:
            found[f"clearance.{joint}.radial_clearance"] = None
            break
    for joint, start in scenario.initial.joints.items():
        rate = "velocity" if joint not in scenario.clearance else "rate"
        if getattr(start, rate, None) and not getattr(start, "guess", False):
            found[f"initial.joints.{joint}.{rate}"] = None
            break
    return found


def span_of(scenario: Scenario, settings: RunSettings, contacts: int) -> float:
    """Return the time up to which there are so many contacts, next to none of which has just changed [s]."""
    run = simulate(scenario, settings=settings)
    starts, ends = (run.data[name].values for name in ("onset_time", "release_time"))
    changes = np.sort(np.concatenate([starts, ends[np.isfinite(ends)], [scenario.duration]]))
    if len(starts) <= contacts:
        return scenario.duration
    # The middle of the widest time free of changes between that contact's onset and two later.
    last = np.sort(starts)[contacts - 1]
    among = changes[changes >= last][:5]
    widest = int(np.argmax(np.diff(among)))
    return float(0.5 * (among[widest] + among[widest + 1]))


def compared(scenario: Scenario, keys: dict[str, str | float | None], contacts: int, limit: float) -> Verdict:
    """Return by how much both are apart, and what is in doubt, over the largest."""
    own = dataclasses.replace(settings_of(scenario), accuracy=None, method="dormand-prince-853")
    span = span_of(scenario, dataclasses.replace(own, rtol=1e-9), contacts)
    rate = _SHOWS if scenario.flexible else 0.5 / span
    settings = dataclasses.replace(own, rtol=1e-12, output_rate=rate, output_times=(span,))
    at, parameters = np.array([span]), parameters_of(scenario, keys, "sensitivities")
    sizes = np.array([one.scale for one in parameters])
    displaced = ForwardSensitivity(scenario, parameters, settings).run(at, span, np.zeros(0)).samples
    apart, moved, before = math.inf, math.inf, None
    for steps in _STEPS:
        longest = min(settings.max_step, span / steps)
        runs = FiniteDifferences(scenario, dataclasses.replace(settings, max_step=longest), span, at)
        slopes = np.stack([one.values["v"][0] for one in runs.derivatives(parameters)], axis=-1) * sizes
        ours = displaced.perturbations[-1][slopes.shape[0] : 2 * slopes.shape[0]]
        largest = float(np.abs(slopes).max())
        apart = float(np.abs(ours - slopes).max()) / largest
        moved = math.inf if before is None else float(np.abs(slopes - before).max()) / largest
        before = slopes
        if apart <= limit:
            break
    doubt = float((displaced.doubts[-1] * np.linalg.norm(ours, axis=0)).max()) / largest
    began = int((runs.run.data["onset_time"].values <= span).sum())
    return Verdict(apart, moved, doubt, began, len(parameters))


def main() -> int:
    """Compare and tell."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--contacts", type=int, default=3)
    parser.add_argument("--apart", type=float, default=1e-7)
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    verdicts: Counter[str] = Counter()
    kinds: Counter[str] = Counter()
    worst = 0.0
    try:
        for number in range(asked.first, asked.first + asked.count):
            began, more = time.perf_counter(), "plain"
            try:
                scenario, keys, more = drawn(asked.seed, number)
                found = compared(scenario, keys, asked.contacts, asked.apart)
            except GrazeError as error:
                verdict, said = "graze", str(error)
            except AntennaPinError as error:
                verdict, said = "refused", str(error)
            else:
                verdict, kinds[more] = found.word(asked.apart), kinds[more] + 1
                worst = max(worst, found.apart if verdict == "agrees" else 0.0)
                said = f"{found.apart:.1e} apart; equation in doubt by {found.equation:.1e}"
                if math.isfinite(found.moved):
                    said += f", runs moved by {found.moved:.1e}"
                said += f"; {found.contacts} contacts, {found.parameters} keys"
            verdicts[verdict] += 1
            print(
                f"{number:4d} {verdict:8s} {time.perf_counter() - began:6.1f} s  {more}: {said}", flush=True
            )
    except KeyboardInterrupt:
        print("stopped")
    print(", ".join(f"{count} {verdict}" for verdict, count in sorted(verdicts.items())))
    print(f"largest of those that agree: {worst:.1e}")
    print("compared: " + ", ".join(f"{count} {kind}" for kind, count in sorted(kinds.items())))
    return 1 if verdicts["APART"] else 0


if __name__ == "__main__":
    sys.exit(main())
