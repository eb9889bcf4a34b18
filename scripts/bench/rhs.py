#!/usr/bin/env python3
"""Cost of one right-hand side: the antenna with one clearance joint, over one bare ``pin.aba`` of its model.

A right-hand side is what an integrator asks for: forces of contacts and drives, forward dynamics, and the
rates of what is integrated along (impulses, work, losses). It is timed as a run's loop calls it, by the
engine ``pinocchio`` and by ``compiled``, in states of a real run of case 3, in free flight and with one and
two contacts, in turns with ``pin.aba`` called from Python in the same process. So are those of two closed
loops with play, over ``pin.aba`` of the tree they are cut open to: the platform on five legs (21 freedoms, 18
equations of closures and motions) and the slider-crank in the plane and in space. Times are processor times.
"""

from __future__ import annotations

import dataclasses
import sys
from typing import Any

import numpy as np
import pinocchio as pin
from bench_tools import CLOSED_FORM, Array, Report, interleaved, scenario
from numba import njit

from antenna_pin import System, Trajectory, build_system, load_scenario, simulate
from antenna_pin.base.settings import Engine
from antenna_pin.contact import CustomFriction, CustomNormal
from antenna_pin.dynamics import Workspace
from antenna_pin.run.engine import Compiled
from antenna_pin.run.engine.step_kernels import derivative
from antenna_pin.scenario.assemble import initial_state

LIMITS = {"closed-form": 2.0, "coal": 2.0}
CALLS = 50  # of the right-hand side in one call from Python
SPAN = 0.1  # [s] of case 3, where the states come from
# Loops: shipped example and case, joint with play, span of the states [s], limit [us].
LOOPS = {
    "4UPS-UPU": ("chen2021", "friction-010", "s2", 0.1, 60.0),
    "slider-crank": ("slider_crank", "friction", "pin", 4e-3, 15.0),
    "slider-crank in space": ("slider_crank", "3d-friction", "pin", 4e-3, 15.0),
}


def states_of_run(count: int) -> dict[int, list[tuple[Array, Array, Array]]]:
    """Return q, v and contact memory of up to ``count`` states of case 3 for each number of contacts."""
    return states_in(simulate(scenario("case3", CLOSED_FORM, "output.rate=10000"), duration=SPAN), count)


def states_in(run: Trajectory, count: int) -> dict[int, list[tuple[Array, Array, Array]]]:
    """Return q, v and contact memory of up to ``count`` states of a run for each number of contacts."""
    data = run.data
    touching = data["touching"].values
    found: dict[int, list[tuple[Array, Array, Array]]] = {}
    for contacts in np.unique(touching.sum(axis=1)):
        indices = np.flatnonzero(touching.sum(axis=1) == contacts)
        chosen = indices[np.linspace(0, len(indices) - 1, min(count, len(indices))).astype(int)]
        # Touching, approach speed [m/s], effective mass [kg].
        memories = [touching[i][:, None] * [1.0, 0.01, 1.0] for i in chosen]
        found[int(contacts)] = [
            (data["q"].values[i], data["v"].values[i], memory)
            for i, memory in zip(chosen, memories, strict=True)
        ]
    return found


@njit(nogil=True)
def called(count: int, t: float, y: Array, numbers: Any, rates: Array) -> None:
    """Evaluate the right-hand side so many times, as steps do."""
    for _ in range(count):
        derivative(t, y, numbers, rates, False)


def ratios(
    system: System,
    states: list[tuple[Array, Array, Array]],
    repeats: int,
    number: int,
    engine: Engine = "pinocchio",
) -> tuple[Array, Array, Array]:
    """Return times of the right-hand side over those of ``pin.aba``, the latter, the former's least [s]."""
    data = system.model.createData()
    over, bare, fastest = [], [], []
    for q, v, memory in states:
        y = system.state(q, v)
        rates = np.zeros(system.model.nv + system.manifold.nx)
        compiled = Compiled(Workspace(system, memory), engine)
        called(CALLS, 0.05, y, compiled.numbers, rates)
        compiled.answers.check()
        names: dict[str, Any] = {"y": y, "rates": rates, "numbers": compiled.numbers, "called": called}
        names |= {
            "aba": pin.aba,
            "model": system.model,
            "data": data,
            "q": q.copy(),
            "v": v.copy(),
            "tau": np.zeros(system.model.nv),
        }
        aba = "\n".join(["aba(model, data, q, v, tau)"] * CALLS)
        own = f"called({CALLS}, 0.05, y, numbers, rates)"
        found = interleaved({"rhs": (own, names), "aba": (aba, names)}, repeats, max(1, number // CALLS))
        times = {label: one / CALLS for label, one in found.items()}
        over.append(np.median(times["rhs"] / times["aba"]))
        bare.append(np.median(times["aba"]))
        fastest.append(times["rhs"].min())
    return np.array(over), np.array(bare), np.array(fastest)


def with_python_laws(system: System) -> System:
    """Return the same system with its laws behind Python functions, as a user's own would be."""
    (joint,) = system.clearances
    normal = CustomNormal(
        force=joint.radial.force,
        elastic_force=joint.radial.elastic_force,
        elastic_energy=joint.radial.elastic_energy,
    )
    friction = CustomFriction(coefficient=joint.friction.coefficient)
    slow = dataclasses.replace(joint, radial=normal, axial=normal, friction=friction)
    return System(system.mechanism, clearances=[slow], drives=system.drives)


def distributed_over_point(repeats: int, number: int) -> float:
    """Return the cost of the right-hand side with 16 loaded strips over that with point load.

    The pose is the worst one: parallel axes, all strips pressed 1 um into the bore, both contacts touching.
    """
    line = "clearance.elevation.normal={law='liu-foundation', replace=true}"
    times = []
    for load in ("point", "distributed"):
        asked = scenario(
            "case3",
            "clearance.elevation.geometry=closed-form",
            f"clearance.elevation.load={load}",
            line,
            "initial.joints.elevation.journal_position=[0.201e-3, 0, 0]",
        )
        system = build_system(asked)
        q, v = initial_state(asked, system)
        memory = np.array([[1.0, 1e-3, 1.0], [1.0, 1e-3, 1.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
        over, _, _ = ratios(system, [(q, v, memory)], repeats, number)
        times.append(float(np.median(over)))
    return times[1] / times[0]


def add_loops(report: Report, count: int, repeats: int, number: int) -> None:
    """Add the cost of closed loops."""
    for label, (model, case, joint, span, limit) in LOOPS.items():
        for backend in LIMITS:
            changes = [f"clearance.{joint}.geometry={backend}", f"output.rate={1000.0 / span}"]
            asked = load_scenario(model, case=case, overrides=changes)
            found = states_in(simulate(asked, duration=span), count)
            system = build_system(asked)
            for contacts, some in found.items():
                over, _, fastest = ratios(system, some, repeats, number)
                name = f"{label}, {backend}, {contacts} contact{'' if contacts == 1 else 's'}"
                report.add(name, 1e6 * np.median(fastest), "us", limit)
                report.add(f"{name}, over pin.aba", np.median(over))


def main() -> int:
    """Time both backends."""
    report = Report("rhs", __doc__ or "")
    arguments = report.parse()
    count, repeats, number = (2, 3, 200) if arguments.quick else (5, 15, 2000)
    states = states_of_run(count)
    bare = []
    systems = {
        backend: build_system(scenario("case3", f"clearance.elevation.geometry={backend}"))
        for backend in LIMITS
    }
    systems["laws in Python"] = with_python_laws(systems["closed-form"])
    engines: dict[str, Engine] = {"compiled": "compiled"}
    systems["compiled"] = systems["closed-form"]
    for label, system in systems.items():
        for contacts, some in states.items():
            over, aba, _ = ratios(system, some, repeats, number, engines.get(label, "pinocchio"))
            bare.append(aba)
            name = f"{label}, {contacts} contact{'' if contacts == 1 else 's'}, over pin.aba"
            report.add(name, np.median(over), limit=LIMITS.get(label))
    report.add(
        "distributed load, 16 strips, over point load", distributed_over_point(repeats, number), limit=1.5
    )
    report.add("pin.aba", 1e6 * np.median(np.concatenate(bare)), "us")
    add_loops(report, count, repeats, number)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
