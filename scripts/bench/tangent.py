#!/usr/bin/env python3
"""The derivative of a flow by the variational equation, beside differences of runs.

Of impacts of two free bodies, case 3 of the antenna, the slider-crank and the 4UPS-UPU, compiled: how
many coordinates there are; the time of both over that of a run of the same span at the same tolerance, 1e-12;
and by how much the variational equation differs from differences of second order of a small step, over the
largest number of the matrix. What is left is mostly theirs.

Then of one derivative of the rates, in contact, of case 3, the slider-crank and the 4UPS-UPU, in loops:
its time along one displacement, ten and all, over that of the rates themselves; put together from parts, and
by differences of the whole. From parts also along ten displacements of case 3 that each
have a number of the system and all of the state, as they are carried along a run, in contact and free.
"""

from __future__ import annotations

import functools
import math
import sys
import time
from collections.abc import Callable

import numpy as np
from bench_tools import Report
from sensitivity import KEYS

from antenna_pin import RunSettings, build_system, load_scenario
from antenna_pin.base.calculus import WEIGHTS
from antenna_pin.base.records import memory_records
from antenna_pin.dynamics import Workspace
from antenna_pin.integrate import method_named
from antenna_pin.run.engine import Slopes, Tangents
from antenna_pin.run.simulation.steps import scale_vector, stepper_of
from antenna_pin.scenario import with_number
from antenna_pin.studies.nonlinear import flow_of
from antenna_pin.studies.nonlinear.coordinates import Units
from antenna_pin.studies.nonlinear.perturbed_system import ParameterSlopes, PerturbedSystem
from antenna_pin.studies.sensitivity.parameters import parameters_of

COMPILED = {"integrator.engine": "compiled"}
# Model, case, joint with play, from when on [s], how long [s], step of differences.
PROBLEMS = {
    "impact_pair": ("impact_pair", "planar", "bore", 0.0, 1.9e-3, 1e-4),
    "bai2020 case3": ("bai2020", "case3", "elevation", 0.0, 0.02, 1e-6),
    "slider_crank": ("slider_crank", "planar", "pin", 1e-3, 2e-3, 1e-4),
    "chen2021": ("chen2021", "friction-005", "s2", 1.0, 0.05, 1e-6),
}


CALLS = 2000


def seconds(make: Callable[[], object]) -> float:
    """Return this thread's time of one call, the fastest of some rounds of them [s]."""
    make()
    fastest = math.inf
    for _ in range(5):
        began = time.thread_time()
        for _ in range(CALLS // 5):
            make()
        fastest = min(fastest, 5 * (time.thread_time() - began) / CALLS)
    return fastest


def of_rates(report: Report, name: str) -> None:
    """Measure one derivative of the rates, in the first contact of a problem."""
    model, case, joint, begin, *_ = PROBLEMS[name]
    closed = COMPILED | {f"clearance.{joint}.geometry": "closed-form"}
    flow, start = flow_of(load_scenario(model, case=case, overrides=closed))
    start = flow.after(start, begin) if begin else start
    while not memory_records(start.memory)["touching"].any():
        start = flow.after(start, 1e-3)
    system, settings = flow.system, RunSettings(engine="compiled")
    workspace, units = Workspace(system), np.concatenate(Units.of(system))
    workspace.memory[:] = memory_records(start.memory)
    stepper = stepper_of(
        workspace, method_named(settings.method), scale_vector(system, settings.scales), settings
    )
    y, count = np.ascontiguousarray(start.y), len(units)
    size = count + 2 * len(workspace.memory) + 1
    makers = {
        "parts": Tangents(system, stepper, units, WEIGHTS),
        "differences": Slopes(stepper, np.asarray(system.bristle_x), WEIGHTS),
    }
    rates = seconds(lambda: stepper.rates(start.time, y))
    for label, maker in makers.items():
        for k in (1, 10, count):
            ways = np.zeros((size, k))
            ways[:count] = np.diag(units)[:, count - k :]
            steps = np.full(k, 1e-4)
            taken = seconds(
                lambda maker=maker, ways=ways, steps=steps: maker.rates(start.time, y, ways, steps)
            )
            report.add(f"{name}, {label}: derivatives along {k}, over the rates", taken / rates)


def of_numbers(report: Report) -> None:
    """Measure one derivative of the rates along ten numbers of case 3, each with all of the state."""
    scenario = load_scenario(
        "bai2020", case="case3", overrides=COMPILED | {"clearance.elevation.geometry": "closed-form"}
    )
    parameters = parameters_of(scenario, KEYS, "bench")

    def built(one, s):
        return build_system(with_number(scenario, one.key, one.value + s * one.scale))

    flow, start = flow_of(scenario)
    builders = [functools.partial(built, one) for one in parameters]
    numbers = ParameterSlopes(flow.system, builders, [one.key for one in parameters])
    near = PerturbedSystem(flow.system, RunSettings(engine="compiled"), numbers)
    units = Units.of(near.system)
    tangents = near.tangents(units)
    assert tangents is not None and near.link_parameters(tangents, units)
    way, rate, bristles, *_, own, _, clock = near.parts
    ways = np.zeros((clock.stop, len(KEYS)))
    shares = np.random.default_rng(1).normal(size=(bristles.stop, len(KEYS)))
    ways[: bristles.stop] = 1e-3 * np.concatenate(units)[:, None] * shares
    ways[own] = np.eye(len(KEYS))
    steps = np.full(len(KEYS), 1e-4)
    for touching in (0, 1):
        while memory_records(start.memory)["touching"].sum() < touching:
            start = flow.after(start, 1e-3)
        near.workspace.memory[:] = memory_records(start.memory)
        y = np.ascontiguousarray(start.y)
        over = seconds(lambda y=y, time=start.time: near.rates(time, y))
        taken = seconds(lambda y=y, time=start.time: tangents.rates(time, y, ways, steps))
        report.add(f"parts: ten numbers, {touching} contacts, over the rates", taken / over)


def main() -> int:
    """Measure all of it."""
    report = Report("tangent", __doc__ or "")
    rounds = 1 if report.parse().quick else 3
    for name, (model, case, joint, begin, span, step) in PROBLEMS.items():
        closed = {f"clearance.{joint}.geometry": "closed-form"}
        flow, start = flow_of(load_scenario(model, case=case, overrides=COMPILED | closed))
        start = flow.after(start, begin) if begin else start
        makers = {
            "run": lambda flow=flow, start=start, span=span: flow.after(start, span),
            "equation": lambda flow=flow, start=start, span=span: flow.tangent(start, span),
            "differences of sixth order": lambda flow=flow, start=start, span=span: flow.tangent_by_runs(
                start, span
            ),
        }
        fastest = dict.fromkeys(makers, float("inf"))
        for _ in range(rounds + 1):
            for label, make in makers.items():
                began = time.perf_counter()
                make()
                fastest[label] = min(fastest[label], time.perf_counter() - began)
        ours = flow.tangent(start, span).matrix
        other = flow.tangent_by_runs(start, span, step=step).matrix
        report.add(f"{name}: coordinates", ours.shape[1])
        for label in list(makers)[1:]:
            report.add(f"{name}: {label}, over a run", fastest[label] / fastest["run"])
        report.add(f"{name}: apart", float(np.abs(ours - other).max() / np.abs(ours).max()))
    for name in ("bai2020 case3", "slider_crank", "chen2021"):
        of_rates(report, name)
    of_numbers(report)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
