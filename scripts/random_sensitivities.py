#!/usr/bin/env python3
"""Sensitivities of random mechanisms: is the variational equation what differences of runs are?

The mechanisms are those of ``random_scenarios.py``: 2 to 8 links, of whose joints 1 to 3 have play, all laws,
gaps in closed form. Over a radial clearance, a mass and the rate that a joint starts with, the velocities at
the end are differentiated by the equation, with its jumps at every onset and release, and by differences of
sixth order of runs, each of which locates its own contacts. They must agree to ``--apart`` of the largest,
or within what the two of them say is in doubt; a graze is to be refused, with its instant, by both.

A line for each mechanism. Exit code 1 if any is apart. Told to stop (Ctrl-C) it sums up what it has;
``--first`` goes on from there.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from typing import Any

import numpy as np
from scenario_generator import draw_scenario

from antenna_pin import AntennaPinError, Scenario
from antenna_pin.sensitivity import GrazeError, Method, sensitivities


def keys_of(scenario: Scenario) -> dict[str, str | float | None]:
    """Return what is varied, with scales: a clearance, a mass, a rate at the start."""
    found: dict[str, str | float | None] = {}
    for joint, one in scenario.clearance.items():
        if getattr(one, "radial_clearance", None) is not None:
            found[f"clearance.{joint}.radial_clearance"] = None
            break
    for link, change in scenario.mechanism.links.items():
        if getattr(change, "mass", None) is not None:
            found[f"mechanism.links.{link}.mass"] = None
            break
    for joint, start in scenario.initial.joints.items():
        if getattr(start, "rate", None):
            found[f"initial.joints.{joint}.rate"] = None
            break
    return found


def compared(scenario: Scenario, duration: float) -> tuple[float, float, dict[str, Any]]:
    """Return by how much both are apart, and what is in doubt, over the largest; and what was varied."""
    keys = keys_of(scenario)
    ways = {}
    methods: tuple[Method, ...] = ("runs", "equation")
    for method in methods:
        found = sensitivities(scenario, keys, times=[duration], method=method)
        sizes = np.array([one.scale for one in found.parameters])
        ways[method] = found.derivative("v")[0] * sizes, found.doubt("v")[0] * sizes
    (runs, doubt), (equation, own) = ways["runs"], ways["equation"]
    largest = float(np.abs(runs).max())
    return float(np.abs(runs - equation).max()) / largest, float((doubt + own).max()) / largest, dict(keys)


def main() -> int:
    """Compare and tell."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--apart", type=float, default=1e-7)
    asked = parser.parse_args()
    verdicts: Counter[str] = Counter()
    worst = 0.0
    try:
        for number in range(asked.first, asked.first + asked.count):
            began = time.perf_counter()
            scenario = draw_scenario(asked.seed, number)
            plain = {f"clearance.{name}.geometry": "closed-form" for name in scenario.clearance}
            scenario = scenario.with_overrides(plain | {"integrator.engine": "compiled"})
            try:
                apart, doubt, keys = compared(scenario, scenario.duration)
            except GrazeError as error:
                verdict, said = "graze", str(error)
            except AntennaPinError as error:
                verdict, said = "refused", str(error)
            else:
                verdict = "agrees" if apart <= asked.apart else "in doubt" if apart <= doubt else "APART"
                worst = max(worst, apart if verdict == "agrees" else 0.0)
                said = f"{apart:.1e} apart, {doubt:.1e} in doubt, {len(keys)} keys"
            verdicts[verdict] += 1
            print(f"{number:4d} {verdict:9s} {time.perf_counter() - began:6.1f} s  {said}", flush=True)
    except KeyboardInterrupt:
        print("stopped")
    print(", ".join(f"{count} {verdict}" for verdict, count in sorted(verdicts.items())))
    print(f"largest of those that agree: {worst:.1e}")
    return 1 if verdicts["APART"] else 0


if __name__ == "__main__":
    sys.exit(main())
