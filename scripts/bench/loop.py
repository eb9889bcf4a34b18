#!/usr/bin/env python3
"""What a run of the antenna takes beside its steps: case 3 over 1 s against bare steps.

The near-limit loop is compiled and does nothing but try steps of Dormand-Prince 5(4), stages and error, one
contact touching, as many as the compiled run of that method has tried: no dense output, search, peaks,
samples, episodes, energies, result. Of each run what its compiled loop takes is told beside the whole: the
rest is samples taken over, and the record. A run's own time begins with its first step: what it takes to make
its system and the system's numbers stands beside. The same steps with ``pin.aba``, called by address, and
that alone, are the floor of Pinocchio's engine. Times are processor times, taken in turns, so that what else
the machine does counts little; ratios are of medians. Runs are in closed form but for the default one, and
record at 1 kHz; with ``keep`` peaks of contacts only.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
from bench_tools import CLOSED_FORM, Report, scenario
from numba import njit
from run import bare_aba

import antenna_pin.compiled.intrinsics  # noqa: F401 - which tells Numba of calls by address
from antenna_pin import Scenario, build_system, simulate
from antenna_pin.compiled.calls import call_back
from antenna_pin.dynamics import Workspace
from antenna_pin.dynamics.by_pinocchio import machine_code_of
from antenna_pin.integrate import METHODS
from antenna_pin.run.engine import Compiled, CompiledStepper
from antenna_pin.run.engine.step_kernels import attempt
from antenna_pin.run.simulation import steps
from antenna_pin.run.simulation.steps import scale_vector
from antenna_pin.scenario.assemble import initial_state

SPAN = 1.0  # [s]
RTOL, STEP = 1e-4, 1e-6  # errors of a run at an accuracy of 1e-3; of the bare steps [s]
COMPILED = ("integrator.engine=compiled",)
ORDER_5 = "integrator.method=dormand-prince-54"
KEEP = ("output.form=lean", "output.keep=['peak_force']")
#: What runs are set beside it: changes, and the goal for time over the loop's.
RUNS = {
    "compiled, 5(4)": ((*COMPILED, ORDER_5), 2.0),
    "compiled, 5(4), keep": ((*COMPILED, ORDER_5, *KEEP), 1.5),
    "Pinocchio, 5(4)": ((ORDER_5,), 2.4),
    "Pinocchio, 5(4), keep": ((ORDER_5, *KEEP), None),
    "Pinocchio, 3(2)": (("integrator.method=bogacki-shampine-32",), None),
    "compiled, 3(2)": ((*COMPILED, "integrator.method=bogacki-shampine-32"), 2.0),
    "default (coal, Pinocchio, 8(5,3) at 1e-8)": ((), 10.0),
}


@njit(nogil=True)
def called(count: int, address: int, target: int) -> int:
    """Call a function by its address so many times; return the last status."""
    status = 0
    for _ in range(count):
        status = call_back(address, 0.0, target)
    return status


@njit(nogil=True)
def bare_steps(count: int, tableau: Any, layout: Any, work: Any, scales: Any, numbers: Any) -> float:
    """Try so many steps from the state in the work rows; return the sum of their errors."""
    total = 0.0
    for _ in range(count):
        total += attempt(0.0, STEP, tableau, layout, work, scales, RTOL, numbers)
    return total


def near_limit_of(asked: Scenario) -> Callable[[int], float]:
    """Return what tries so many steps, and gives the time that they take [s]."""
    system = build_system(asked)
    y = system.state(*initial_state(asked, system))
    memory = np.zeros((len(system.contact_names), 3))
    memory[0] = 1.0, 0.01, 1.0
    workspace, method = Workspace(system, memory), METHODS["dormand-prince-54"]
    scales = scale_vector(system, asked.integrator.build().scales)
    stepper = CompiledStepper(
        workspace, Compiled(workspace, asked.integrator.build().engine), method, scales, RTOL
    )
    stepper.restart(0.0, y)

    def run(count: int) -> float:
        began = time.perf_counter()
        bare_steps(
            count, stepper.tableau, stepper.manifold.layout, stepper.work, stepper.scales, stepper.numbers
        )
        return time.perf_counter() - began

    return run


def aba_by_address() -> Callable[[int], float]:
    """Return what makes the evaluations of so many steps by ``pin.aba`` alone, and gives their time [s]."""
    model = build_system(scenario("case3")).model
    y, effort, acceleration = np.zeros(model.nq + model.nv), np.ones(model.nv), np.zeros(model.nv)
    code = machine_code_of(model, y, effort, acceleration, np.zeros((model.nv, model.nv)), np.zeros(model.nv))
    if code is None:
        return lambda count: float("nan")
    evaluator, address, _ = code
    y[:], effort[:] = np.concatenate([pin.neutral(model), np.full(model.nv, 0.1)]), 1.0

    def run(count: int) -> float:
        began = time.perf_counter()
        called(count * METHODS["dormand-prince-54"].last, address, evaluator.address)
        return time.perf_counter() - began

    return run


class Timed:
    """Stands in for the compiled loop, and adds up what its calls take."""

    def __init__(self, loop: Any) -> None:
        """Take the loop's place."""
        self.loop, self.seconds = loop, 0.0

    def __call__(self, *arguments: Any) -> Any:
        """Call it."""
        began = time.perf_counter()
        reason = self.loop(*arguments)
        self.seconds += time.perf_counter() - began
        return reason

    def taken(self) -> float:
        """Return what the calls since the last time took [s]."""
        seconds, self.seconds = self.seconds, 0.0
        return seconds


def main() -> int:
    """Time all of them in turns."""
    time.perf_counter = time.process_time  # the clock of a run's wall time as well
    inside = steps.loop_kernels.go_on = Timed(steps.loop_kernels.go_on)
    report = Report("loop", __doc__ or "")
    repeats = 1 if report.parse().quick else 7
    limit = near_limit_of(scenario("case3", CLOSED_FORM, *COMPILED))
    floors = {
        "the same steps, with pin.aba": near_limit_of(scenario("case3", CLOSED_FORM)),
        "pin.aba of these, by address alone": aba_by_address(),
    }
    bare = bare_aba(build_system(scenario("case3")).model)
    cases = {
        name: scenario("case3")
        if not changes
        else scenario("case3", CLOSED_FORM, "integrator.rtol=1e-4", *changes)
        for name, (changes, _) in RUNS.items()
    }
    walls: dict[str, list[float]] = {name: [] for name in (*cases, *floors, "near limit", "aba")}
    loops: dict[str, list[float]] = {name: [] for name in cases}
    starts: dict[str, list[float]] = {name: [] for name in cases}
    counts = {}
    for _ in range(repeats + 1):
        for name, case in cases.items():
            inside.taken()
            began = time.process_time()
            run = simulate(case, duration=SPAN)
            starts[name].append(time.process_time() - began - run.counts.wall_seconds)
            loops[name].append(inside.taken())
            counts[name] = run.counts.evaluations
            walls[name].append(run.counts.wall_seconds)
        counts["near limit"] = counts["compiled, 5(4)"]
        steps_made = counts["near limit"] // METHODS["dormand-prince-54"].last
        walls["near limit"].append(limit(steps_made))
        for name, floor in floors.items():
            walls[name].append(floor(steps_made))
        walls["aba"].append(bare())
    medians = {name: float(np.median(taken[1:])) for name, taken in walls.items()}
    report.add("near-limit loop", 1e3 * medians["near limit"], "ms")
    report.add("near-limit loop, over evaluations x pin.aba", _over(medians, counts, "near limit"))
    for name in floors:
        report.add(f"{name}: over the near-limit loop", medians[name] / medians["near limit"])
    for name, (_, goal) in RUNS.items():
        report.add(f"{name}: over the near-limit loop", medians[name] / medians["near limit"], limit=goal)
        own = float(np.median(loops[name][1:]))
        report.add(f"{name}: its loop alone, over the near-limit loop", own / medians["near limit"])
        start = float(np.median(starts[name][1:]))
        report.add(f"{name}: before its first step, over the near-limit loop", start / medians["near limit"])
        report.add(f"{name}: evaluations", counts[name])
        report.add(f"{name}: over evaluations x pin.aba", _over(medians, counts, name))
    report.add("pin.aba", 1e6 * medians["aba"], "us")
    return report.finish()


def _over(medians: dict[str, float], counts: dict[str, int], name: str) -> float:
    return medians[name] / (counts[name] * medians["aba"])


if __name__ == "__main__":
    sys.exit(main())
