#!/usr/bin/env python3
"""Sensitivities of random mechanisms: is the variational equation what differences of runs are?

The mechanisms are those of ``random_scenarios.py``: 2 to 8 links, of whose joints 1 to 3 have play, all laws,
gaps in closed form; with a stop, friction that holds or bends, a gear, a closure, a mode or a motion besides
(``random_additions.py``). Up to behind the third contact (``--contacts``) the velocities are differentiated
over a radial clearance, a rate that a joint starts with, a mass, and a number of what is besides: by the
equation, with its jumps at every onset, release and event, and by differences of sixth order of runs, each of
which locates its own. They are to agree to ``--apart`` of the largest, beyond what runs say of their own
doubt; a graze is to be refused, with its instant, by both.

A line for each mechanism, with both doubts. Exit code 1 if any is apart. Told to stop (Ctrl-C) it sums up
what it has; ``--first`` goes on from there.
"""

from __future__ import annotations

import argparse
import dataclasses
import sys
import time
import warnings
from collections import Counter
from typing import NamedTuple

import numpy as np
from random_additions import with_more
from scenario_generator import draw_scenario

from antenna_pin import AntennaPinError, Scenario, simulate
from antenna_pin.sensitivity import GrazeError
from antenna_pin.sensitivity.by_equation import ByEquation
from antenna_pin.sensitivity.by_runs import ByRuns
from antenna_pin.sensitivity.parameters import parameters_of
from antenna_pin.settings import RunSettings
from antenna_pin.simulation.from_scenario import settings_of


class Verdict(NamedTuple):
    """What a comparison said.

    Attributes:
        apart: By how much both differ, over the largest.
        runs: In how much doubt runs are, likewise.
        equation: Likewise the equation.
        contacts: How many contacts began.
        parameters: How many numbers were varied.
    """

    apart: float
    runs: float
    equation: float
    contacts: int
    parameters: int


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


def compared(scenario: Scenario, keys: dict[str, str | float | None], contacts: int) -> Verdict:
    """Return by how much both are apart, and what is in doubt, over the largest."""
    own = dataclasses.replace(settings_of(scenario), accuracy=None, method="dormand-prince-853")
    span = span_of(scenario, dataclasses.replace(own, rtol=1e-9), contacts)
    settings = dataclasses.replace(own, rtol=1e-12, output_rate=0.5 / span, output_times=(span,))
    at, parameters = np.array([span]), parameters_of(scenario, keys, "sensitivities")
    sizes = np.array([one.scale for one in parameters])
    runs = ByRuns(scenario, settings, span, at)
    found = runs.over(parameters)
    slopes, doubts = (
        np.stack([getattr(one, kind)["v"][0] for one in found], axis=-1) * sizes
        for kind in ("values", "doubts")
    )
    displaced = ByEquation(scenario, parameters, settings).carried(at, span, np.zeros(0)).displaced
    rates = slice(slopes.shape[0], 2 * slopes.shape[0])
    ours, largest = displaced.ways[-1][rates], float(np.abs(slopes).max())
    apart = np.abs(ours - slopes).max() / largest
    doubt = (displaced.doubts[-1] * np.linalg.norm(ours, axis=0)).max() / largest
    began = int((runs.run.data["onset_time"].values <= span).sum())
    return Verdict(float(apart), float(doubts.max() / largest), float(doubt), began, len(parameters))


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
    worst = 0.0
    try:
        for number in range(asked.first, asked.first + asked.count):
            began, more = time.perf_counter(), "plain"
            try:
                scenario, keys, more = drawn(asked.seed, number)
                found = compared(scenario, keys, asked.contacts)
            except GrazeError as error:
                verdict, said = "graze", str(error)
            except AntennaPinError as error:
                verdict, said = "refused", str(error)
            else:
                apart, noise, doubt, contacts, count = found
                verdict = "agrees" if apart <= asked.apart else "APART"
                if verdict == "APART" and apart <= asked.apart + 2.0 * noise:
                    verdict = "in noise"
                worst = max(worst, apart if verdict == "agrees" else 0.0)
                said = f"{apart:.1e} apart; doubt: runs {noise:.1e}, equation {doubt:.1e}"
                said += f"; {contacts} contacts, {count} keys"
            verdicts[verdict] += 1
            print(
                f"{number:4d} {verdict:8s} {time.perf_counter() - began:6.1f} s  {more}: {said}", flush=True
            )
    except KeyboardInterrupt:
        print("stopped")
    print(", ".join(f"{count} {verdict}" for verdict, count in sorted(verdicts.items())))
    print(f"largest of those that agree: {worst:.1e}")
    return 1 if verdicts["APART"] else 0


if __name__ == "__main__":
    sys.exit(main())
