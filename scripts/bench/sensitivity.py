#!/usr/bin/env python3
"""Sensitivities of the antenna with play to ten of its numbers, over one run of the same span and tolerance.

By two runs a number (``quick-runs``) over 1 s, and by the variational equation, which is held against them,
up to before its first contact, 10 ms, over its first twelve, 50 ms, and over 1 s. Compiled, gaps in closed
form, order 8(5,3) at 1e-12. At 71 ms the journal comes to rest in its bearing by ever smaller blows, of which
a change of a number by a millionth makes more or fewer: differences are of steps as small as 1e-8 there.

Then what carrying takes without builds; and what of that nobody can go without: at each stage of the run's
own steps the rates and one derivative along each displacement, nothing halved, judged or looked at.
"""

from __future__ import annotations

import functools
import math
import sys
import time
from collections.abc import Callable

import numpy as np
from bench_tools import Report, scenario
from numpy.typing import NDArray

from antenna_pin import RunSettings, System, build_system, load_scenario, simulate
from antenna_pin.run.simulation.loop import Run
from antenna_pin.scenario import Scenario, with_number
from antenna_pin.studies.nonlinear import flow_of
from antenna_pin.studies.nonlinear.perturbed_system import ParameterSlopes
from antenna_pin.studies.nonlinear.vector_field import VectorField
from antenna_pin.studies.sensitivity import sensitivities
from antenna_pin.studies.sensitivity.forward_sensitivity import ForwardSensitivity
from antenna_pin.studies.sensitivity.parameters import Parameter, parameters_of

JOINT = "clearance.elevation"
KEYS: dict[str, str | float | None] = {
    f"{JOINT}.radial_clearance": None,
    f"{JOINT}.axial_clearance": None,
    f"{JOINT}.bearing_radius": None,
    f"{JOINT}.bearing_length": None,
    f"{JOINT}.normal.restitution": None,
    f"{JOINT}.friction.static_speed": None,
    "materials.steel.young": None,
    "materials.steel.poisson": None,
    "drives.elevation.amplitude": None,
    "drives.azimuth.amplitude": None,
}
BORE = ("clearance.bore.geometry=closed-form", "integrator.engine=compiled")
OF_THE_PAIR: dict[str, str | float | None] = {
    "clearance.bore.radial_clearance": None,
    "clearance.bore.normal.restitution": None,
    "materials.steel.young": None,
    "materials.steel.poisson": None,
}
TIGHT = RunSettings(engine="compiled", method="dormand-prince-853", rtol=1e-12)


def seconds(make: Callable[[], object]) -> float:
    """Return the processor's time of one call [s]: that of one process, whatever else goes on."""
    began = time.process_time()
    make()
    return time.process_time() - began


def carried_over(model: Scenario, keys: dict[str, str | float | None], span: float) -> float:
    """Return how long carrying displacements along a run takes, without builds, over the steps of the run."""
    made = ForwardSensitivity(model, parameters_of(model, keys, "bench"), TIGHT)
    flow, start = flow_of(model, TIGHT)
    end = np.array([span])
    flow.after(start, span)
    made.tangents(end, span, np.zeros(0))
    once = min(seconds(lambda: flow.after(start, span)) for _ in range(5))
    return min(seconds(lambda: made.tangents(end, span, np.zeros(0))) for _ in range(3)) / once


class Made:
    """Sees the steps of a run: when each begins [s], its size [s], the state and contact memory there."""

    def __init__(self, run: Run) -> None:
        """Begin at the run's start."""
        self.steps: list[tuple[float, float, NDArray[np.float64], NDArray[np.void]]] = []
        self._memory = run.workspace.memory.copy()

    def observe(self, run: Run) -> None:
        """Look at the steps that the run has made since it was shown last."""
        self.steps += [(one.time, one.size, one.y, self._memory) for one in run.steps.log]
        self._memory = run.workspace.memory.copy()

    end = observe


def displaced_by(model: Scenario, one: Parameter, s: float) -> System:
    """Return the system whose number is displaced by s of its scale."""
    return build_system(with_number(model, one.key, one.value + s * one.scale))


def at_best(model: Scenario, keys: dict[str, str | float | None], span: float) -> float:
    """Return how long rates and derivatives at the stages take, over the steps of the run."""
    parameters = parameters_of(model, keys, "bench")
    flow, start = flow_of(model, TIGHT)
    builders = [functools.partial(displaced_by, model, one) for one in parameters]
    field = VectorField(
        flow.system, TIGHT, ParameterSlopes(flow.system, builders, [one.key for one in parameters])
    )
    carrying, run = field.stage_propagation(), flow.logged_run(start, span)
    assert carrying is not None
    made = Made(run)
    run.advance(observer=made)
    # Each displacement has all of the state, and one number.
    state, own, count = slice(field.parts[2].stop), field.parts[-3], len(parameters)
    ways = np.zeros((field.displacement, count))
    ways[state] = (
        1e-3
        * np.concatenate(field.units)[:, None]
        * np.random.default_rng(1).normal(size=(field.parts[2].stop, count))
    )
    ways[own] = np.eye(count)
    nothing = np.zeros((field.displacement, 0))

    def carry() -> None:
        for begin, size, y, memory in made.steps:
            field.workspace.memory[:] = memory
            carrying.along((begin, size, y), ways, nothing, until=math.inf, since=-math.inf)

    carry()
    once = min(seconds(lambda: flow.after(start, span)) for _ in range(5))
    return min(seconds(carry) for _ in range(3)) / once


def main() -> int:
    """Measure both."""
    report = Report("sensitivity", __doc__ or "")
    quick = report.parse().quick
    antenna = scenario("case3", f"{JOINT}.geometry=closed-form", "integrator.engine=compiled")
    spans = [("quick-runs", 0.01 if quick else 1.0), ("equation", 2e-3 if quick else 0.01)]
    spans += [] if quick else [("equation", 0.05), ("equation", 1.0)]
    sensitivities(antenna, KEYS, times=[2e-3], method="equation")  # loads what is compiled
    for method, span in spans:

        def run(span: float = span) -> object:
            return simulate(antenna, duration=span, settings=TIGHT)

        def all_of_them(span: float = span, method: str = method) -> object:
            return sensitivities(antenna, KEYS, times=[span], method=method)  # type: ignore[arg-type]

        run()
        once = min(seconds(run) for _ in range(3))
        report.add(f"{method}: ten numbers, {span:g} s, over one run", seconds(all_of_them) / once)
    pair = load_scenario("impact_pair", case="planar", overrides=BORE)
    for name, model, keys, span in (
        ("antenna, ten numbers", antenna, KEYS, 4e-3 if quick else 0.05),
        ("impact pair, four numbers", pair, OF_THE_PAIR, 0.015),
    ):
        row = f"carrying along alone: {name}, {span:g} s, over the steps of one run"
        report.add(row, carried_over(model, keys, span))
        report.add(f"at best: {name}", at_best(model, keys, span))
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
