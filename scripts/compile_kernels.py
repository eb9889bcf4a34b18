#!/usr/bin/env python3
"""Compile the kernels once, before several processes need them: Numba keeps them beside the sources.

Whoever comes first compiles, so two processes that start together compile the same twice. What is compiled is
what these runs call, which is nearly all that the tests call; what is kept from an earlier time is read.
"""

from __future__ import annotations

import time

from antenna_pin import build_system, load_scenario, simulate
from antenna_pin.mechanism import TreeDynamics

#: Case, overrides: closed form, coal (its Python path), the compiled engine, all that a closed loop needs.
RUNS = (
    ("bai2020", "case3", ("clearance.elevation.geometry=closed-form",)),
    ("bai2020", "case3", ()),
    ("bai2020", "case3", ("clearance.elevation.geometry=closed-form", "integrator.engine=compiled")),
    ("slider_crank", "planar", ("clearance.pin.geometry=closed-form",)),
)


def main() -> None:
    """Make the runs, and what they do not need yet."""
    began = time.perf_counter()
    for model, case, changes in RUNS:
        scenario = load_scenario(model, case=case, overrides=list(changes))
        simulate(scenario, duration=min(0.02, scenario.duration))
        TreeDynamics(build_system(scenario).mechanism)
        print(f"{time.perf_counter() - began:5.1f} s  {model} {case} {' '.join(changes)}", flush=True)


if __name__ == "__main__":
    main()
