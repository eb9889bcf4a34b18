#!/usr/bin/env python3
"""Compile the kernels once, on all cores, so that no run and no test waits for them.

They are stored beside the sources. Compiled is what these runs call or, but for ``--demo``, might call: all
that shipped scenarios, laws and elements need (``tests/compiled/test_compiled_once.py``). Of processes that
come to the same kernel one compiles it and the others wait; so each begins with runs that have little in
common with those of the others.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import sys
import time
import warnings
from collections.abc import Callable
from importlib.util import find_spec
from multiprocessing.sharedctypes import Synchronized
from pathlib import Path
from typing import Any

#: Of each process: model, case and overrides of one run after the other.
Job = tuple[str, str, tuple[str, ...]]
CLOSED = "clearance.{}.geometry=closed-form"
COMPILED = "integrator.engine=compiled"
JOBS: tuple[Job, ...] = (
    ("bai2020", "case3", (CLOSED.format("elevation"),)),
    ("chen2021", "ideal", (COMPILED,)),
    ("bai2020", "case3", ()),
    ("bai2020", "case3", (CLOSED.format("elevation"), COMPILED)),
    ("slider_crank", "planar", (CLOSED.format("pin"),)),
    ("bai2020", "case2-planar", ()),
    ("solar_array", "play", ()),
    ("reaction_wheel", "bearings", ()),
    ("bai2020", "case3", (CLOSED.format("elevation"), "integrator.method=radau5")),
    ("bai2020", "case3", (CLOSED.format("elevation"), "integrator.method=radau5", COMPILED)),
)
#: Of these also derivatives over a state, for orbits, exponents and sensitivities: of a tree, of a loop, and
#: over an onset.
DERIVATIVES: tuple[Job, ...] = (JOBS[0], JOBS[1], ("impact_pair", "planar", (CLOSED.format("bore"),)))
#: What ``antenna-pin demo`` runs.
DEMO: tuple[Job, ...] = (("bai2020", "case3", ()), ("bai2020", "case1", ()))
DURATION = 0.02  # [s]
SHIPPED = 1e-4  # of each shipped case [s]
MOMENT = 1.01e-3  # of derivatives [s]: the pair meets after 1 ms

_made: Any = None  # how many kernels the processes have compiled


def begin(made: Synchronized[int]) -> None:
    """Count what a process compiles."""
    global _made
    _made = made
    warnings.simplefilter("ignore")  # of runs that are this short


def count_one() -> None:
    """Count a kernel."""
    with _made.get_lock():
        _made.value += 1


def make(job: Job, derivatives: bool = False, more: bool = True) -> None:
    """Make the run of a job, and more that its system may need; or derivatives along a moment of it."""
    import numpy as np

    from antenna_pin import build_system, load_scenario, simulate
    from antenna_pin.compiled.compile_time import told_of_compiling
    from antenna_pin.compiled.slots import fill_all
    from antenna_pin.dynamics import Workspace
    from antenna_pin.mechanism import TreeDynamics
    from antenna_pin.scenario.assemble import initial_state

    model, case, changes = job
    with told_of_compiling(count_one):
        scenario = load_scenario(model, case=case, overrides=list(changes))
        if derivatives:
            from antenna_pin.studies.nonlinear import flow_of

            flow, start = flow_of(scenario)
            flow.tangent(start, MOMENT)
            fill_all()
            return
        simulate(scenario, duration=min(DURATION, scenario.duration))
        if not more:
            return
        system = build_system(scenario)
        TreeDynamics(system.mechanism)
        y = system.state(*initial_state(scenario, system))
        Workspace(system).derivative(0.0, y, np.zeros(system.model.nv + system.manifold.nx))
        fill_all(backwards=JOBS.index(job) % 2 == 1)


def run_shipped() -> None:
    """Run a moment of all shipped cases by both engines: what Python calls of kernels is theirs alone."""
    from antenna_pin import list_scenarios, load_scenario, simulate
    from antenna_pin.compiled.compile_time import told_of_compiling

    with told_of_compiling(count_one):
        for one in list_scenarios():
            for case, _ in one.cases:
                scenario = load_scenario(one.name, case=case)
                joints = [name for name, joint in scenario.clearance.items() if hasattr(joint, "geometry")]
                for changes in ([], [COMPILED, *map(CLOSED.format, joints)]):
                    simulate(scenario.with_overrides(changes), duration=min(SHIPPED, scenario.duration))


def call_alone() -> None:
    """Call the kernels that Python calls and no run above: a joint alone, bristles, modes, linear steps."""
    import numpy as np

    from antenna_pin import build_system, load_scenario
    from antenna_pin.base.records import POSE
    from antenna_pin.compiled.slots import fill_all
    from antenna_pin.contact import Dahl
    from antenna_pin.dynamics import Workspace
    from antenna_pin.dynamics.mode_kernels import grip_of, is_held, mode_of
    from antenna_pin.integrate.collocation import NODES, Propagator

    system = build_system(load_scenario("bai2020", case="case3"))
    workspace = Workspace(system)
    backend: Any = workspace._backends[0]
    backend.evaluator = None  # as where the shim is missing
    place = np.zeros(1, POSE)
    place["rotation"] = np.eye(3)
    backend.query(place, workspace.table, 0)
    (joint,) = system.clearances
    pose = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    joint.evaluate(pose, np.zeros(6))
    joint.stored_energy(pose)
    law = joint.normal_laws[0]
    law.elastic_force(1e-6)
    law.elastic_energy(1e-6)
    joint.geometry.scenario(pose[:3], np.eye(3))
    joint.geometry.contacts(pose[:3], np.eye(3))
    Dahl(coefficient_of_friction=0.1, bristle_stiffness=1e5).coefficient(0.1)
    for one in (grip_of, is_held, mode_of):
        one(-1, np.zeros(1), 0)
    Propagator(2).step(1.0, np.zeros((len(NODES), 2, 2)))
    fill_all()


def stamp_file() -> Path:
    """Return the file with the stamp of the kernels that this script has compiled last, beside them."""
    return (
        Path(str(getattr(find_spec("antenna_pin.compiled"), "origin", ""))).parent / "__pycache__/all.stamp"
    )


def show(text: str, last: bool = False) -> None:
    """Show a line in place of the one before, where there is somebody to see it."""
    if sys.stderr.isatty():
        print(f"\r\x1b[2K{text}", end="\n" if last else "", file=sys.stderr, flush=True)
    elif last:
        print(text, file=sys.stderr, flush=True)


def bar(share: float) -> str:
    """Return a bar, 30 letters long."""
    full = round(30 * share)
    return "[" + "#" * full + "." * (30 - full) + "]"


def wait(running: list[Any], said: Callable[[int], str]) -> None:
    """Show how far processes are until all are done; raises what one of them raised."""
    while not all(one.ready() for one in running):
        done = sum(one.ready() for one in running)
        show(said(done))
        time.sleep(0.2)
    for one in running:
        one.get()


def main() -> None:
    """Make all runs, on as many processes as there are cores."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument(
        "--all", action="store_true", help="also those of derivatives, and all that Python calls: for a wheel"
    )
    parser.add_argument("--demo", action="store_true", help="only those of the command demo")
    asked = parser.parse_args()
    jobs = DEMO if asked.demo else JOBS
    processes, more = asked.processes, DERIVATIVES if asked.all else ()
    began = time.perf_counter()
    context = multiprocessing.get_context("spawn")
    made: Any = context.Value("i", 0)

    def said(done: int) -> str:
        wall = time.perf_counter() - began
        return f"kernels {bar(done / count)} {made.value} compiled, {wall:.0f} s"

    count = len(jobs) + len(more) + asked.all + (not asked.demo)
    with context.Pool(min(processes, count), begin, (made,)) as pool:
        running = [pool.apply_async(make, (job, False, not asked.demo)) for job in jobs]
        running += [pool.apply_async(make, (job, True)) for job in more]
        running += [pool.apply_async(call_alone)] if asked.all else []
        running += [] if asked.demo else [pool.apply_async(run_shipped)]
        wait(running, said)
    if not asked.demo and not os.environ.get("NUMBA_CACHE_DIR"):
        from antenna_pin.compiled.jit import stamp_of

        stamp_file().write_text(stamp_of(""), encoding="utf-8")
    show(said(count), last=True)


if __name__ == "__main__":
    main()
