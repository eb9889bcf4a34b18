#!/usr/bin/env python3
"""A run of the antenna against a loop that does next to nothing but evaluate.

Case 3 over 1 s, in closed form but for the default run. The near-limit loop is compiled, and makes the same
steps of Dormand-Prince 5(4) by the same derivative: stages, error, the simplest rule for the next step, and
at a change of contact a secant on the gap. It has no dense output, search, peaks, samples, episodes, energies
or result, and finds neither a contact that dips between two steps nor a graze. Times are taken in turns, so
that what slows the machine down slows all of them; ratios are of medians.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from bench_tools import CLOSED_FORM, Report, scenario
from numba import njit
from run import bare_aba

from antenna_pin import Scenario, build_system, simulate
from antenna_pin.assemble import initial_state
from antenna_pin.dynamics import Workspace
from antenna_pin.dynamics.trial_kernels import contacts_in
from antenna_pin.engine import Compiled, CompiledStepper
from antenna_pin.engine.step_kernels import attempt, derivative
from antenna_pin.integrate import METHODS
from antenna_pin.integrate.kernels import RATES, START, STATE, begin
from antenna_pin.simulation.scales import scale_vector

SPAN = 1.0  # [s]
RTOL = 1e-4  # of the near-limit loop: errors of a run at an accuracy of 1e-3
#: What runs are set beside it: changes, and the goal for time over the loop's.
RUNS = {
    "compiled, 5(4)": (("integrator.engine=compiled", "integrator.method=dormand-prince-54"), 1.8),
    "Pinocchio, 5(4)": (("integrator.method=dormand-prince-54",), 4.0),
    "Pinocchio, 3(2)": (("integrator.method=bogacki-shampine-32",), 4.0),
    "compiled, 3(2)": (("integrator.engine=compiled", "integrator.method=bogacki-shampine-32"), 1.8),
    "default (coal, Pinocchio, 8(5,3) at 1e-8)": ((), 30.0),
}


@njit(error_model="numpy", nogil=True)
def near_limit(
    end: float, tableau: Any, layout: Any, work: Any, scales: Any, rtol: float, numbers: Any
) -> tuple[int, int]:
    """Run from the state in the work rows up to a time [s]; return evaluations and changes of contact."""
    stages = tableau.weights.shape[0]
    last, rates = stages + STATE, numbers.rates.shape[1]
    t, h, asked, changes = 0.0, 1e-6, 0, 0
    while t < end:
        h = min(h, end - t)
        error = attempt(t, h, tableau, layout, work, scales, rtol, numbers)
        asked += tableau.last
        if not error <= 1.0:
            h *= max(0.2, 0.9 * error**-0.2) if error > 0.0 else 0.2
            continue
        wished = h * min(6.0, 0.9 * max(error, 1e-5) ** -0.2)
        contacts_in(work[last], numbers.program, numbers.pose, numbers.table)
        changed = -1
        for c in range(numbers.memory.shape[0]):
            apart = numbers.table[c].gap > 0.0
            if apart == (numbers.memory[c].touching != 0.0) and abs(numbers.table[c].gap) > 1e-14:
                changed = c
        if changed >= 0:
            for _ in range(5):
                gap, rate = numbers.table[changed].gap, numbers.table[changed].rate
                if abs(gap) < 1e-12 or rate == 0.0 or not 0.0 < h + gap / rate:
                    break
                h += gap / rate
                attempt(t, h, tableau, layout, work, scales, rtol, numbers)
                asked += tableau.last
                contacts_in(work[last], numbers.program, numbers.pose, numbers.table)
            memory = numbers.memory[changed]
            memory.touching = 1.0 - memory.touching
            memory.approach_speed = max(numbers.table[changed].rate, 1e-4)
            memory.effective_mass = 1.0
            derivative(t + h, work[last], numbers, work[stages + RATES, :rates], False)
            asked += 1
            changes += 1
        begin(stages, layout, work)
        t += h
        h = wished
    return asked, changes


def near_limit_of(asked: Scenario) -> Callable[[], tuple[int, int]]:
    """Return what makes the near-limit loop's run."""
    system = build_system(asked)
    y = system.state(*initial_state(asked, system))
    scales = scale_vector(system, asked.integrator.build().scales)

    def run() -> tuple[int, int]:
        workspace = Workspace(system)
        method = METHODS["dormand-prince-54"]
        stepper = CompiledStepper(workspace, Compiled(workspace, "compiled"), method, scales, RTOL)
        stepper.restart(0.0, y)
        assert stepper.work[stepper.method.stages + START][0] == y[0]
        tableau, layout, work = stepper.tableau, stepper.manifold.layout, stepper.work
        began = time.perf_counter()
        evaluations, changes = near_limit(SPAN, tableau, layout, work, stepper.scales, RTOL, stepper.numbers)
        run.wall = time.perf_counter() - began  # type: ignore[attr-defined]
        return evaluations, changes

    return run


def main() -> int:
    """Time all of them in turns."""
    report = Report("loop", __doc__ or "")
    repeats = 1 if report.parse().quick else 7
    limit = near_limit_of(scenario("case3", CLOSED_FORM, "integrator.engine=compiled"))
    bare = bare_aba(build_system(scenario("case3")).model)
    cases = {
        name: scenario("case3")
        if not changes
        else scenario("case3", CLOSED_FORM, "integrator.rtol=1e-4", *changes)
        for name, (changes, _) in RUNS.items()
    }
    walls: dict[str, list[float]] = {name: [] for name in (*cases, "near limit", "aba")}
    counts = {}
    for _ in range(repeats + 1):
        counts["near limit"] = limit()[0]
        walls["near limit"].append(limit.wall)  # type: ignore[attr-defined]
        walls["aba"].append(bare())
        for name, case in cases.items():
            run = simulate(case, duration=SPAN)
            counts[name] = run.counts.evaluations
            walls[name].append(run.counts.wall_seconds)
    medians = {name: float(np.median(taken[1:])) for name, taken in walls.items()}
    report.add("near-limit loop", 1e3 * medians["near limit"], "ms")
    report.add("near-limit loop, evaluations", counts["near limit"])
    report.add("near-limit loop, over evaluations x pin.aba", _over(medians, counts, "near limit"))
    for name, (_, goal) in RUNS.items():
        report.add(f"{name}: over the near-limit loop", medians[name] / medians["near limit"], limit=goal)
        report.add(f"{name}: evaluations", counts[name])
        report.add(f"{name}: over evaluations x pin.aba", _over(medians, counts, name))
    report.add("pin.aba", 1e6 * medians["aba"], "us")
    return report.finish()


def _over(medians: dict[str, float], counts: dict[str, int], name: str) -> float:
    return medians[name] / (counts[name] * medians["aba"])


if __name__ == "__main__":
    sys.exit(main())
