#!/usr/bin/env python3
"""Dynamics of the tree in compiled code over Pinocchio's: case 3 of the antenna, chains of 2 to 64 hinges.

Each is timed in turns with ``pin.aba`` (``pin.crba`` and ``pin.nonLinearEffects``) called from Python: from
Python, and many times in a compiled loop (1000 for the antenna), as an engine that is compiled as a whole
calls it. What of a call of Pinocchio is the call itself shows in the time of one hinge. A cost that grows
linearly has the same least time per body for all chains, but for what the first cache does not hold.
"""

from __future__ import annotations

import sys
from typing import Any

import numba
import numpy as np
import pinocchio as pin
from bench_tools import CLOSED_FORM, Array, Report, interleaved, scenario

from antenna_pin import build_system
from antenna_pin.mechanism import PLACE, Mechanism, TreeDynamics, Urdf, build_mechanism
from antenna_pin.mechanism.dynamics_kernels import aba
from antenna_pin.mechanism.mass_kernels import mass_and_bias
from antenna_pin.mechanism.tree_kernels import bias_accelerations, place_bodies

LOOP = 3000  # bodies that a compiled loop goes over: short enough not to be interrupted
CHAINS = (2, 4, 8, 16, 32, 64)
CALLS = {
    "pin.aba": "pin_aba(model, data, q, v, tau)",
    "aba": "aba(y, nq, tree, gravity, tau, room, out)",
    "aba in a loop": "aba_loop(count, y, nq, tree, gravity, tau, room, out)",
}
MASS_CALLS = {
    "pin.crba, pin.nonLinearEffects": "pin_crba(model, data, q); pin_bias(model, data, q, v)",
    "mass_and_bias": "mass_loop(1, y, nq, tree, gravity, places, room, mass, bias)",
    "mass_and_bias in a loop": "mass_loop(count, y, nq, tree, gravity, places, room, mass, bias)",
}


@numba.njit(error_model="numpy")
def aba_loop(count: int, y: Any, nq: int, tree: Any, gravity: Any, tau: Any, room: Any, out: Any) -> None:
    """Call ``aba`` time after time, each with a result of the last, or it would be left out."""
    for _ in range(count):
        tau[0] += 1e-9 * out[0]
        aba(y, nq, tree, gravity, tau, room, out)


@numba.njit(error_model="numpy")
def mass_loop(
    count: int, y: Any, nq: int, tree: Any, gravity: Any, places: Any, room: Any, mass: Any, bias: Any
) -> None:
    """Call ``mass_and_bias`` and what places bodies time after time, each with a result of the last."""
    for _ in range(count):
        y[nq] += 1e-12 * bias[0]
        place_bodies(y, nq, tree, places)
        bias_accelerations(tree, places)
        mass_and_bias(tree, places, gravity, room, mass, bias)


def chain(count: int) -> Mechanism:
    """Return so many equal links on the ground, hinged about oblique axes."""
    body = (
        '<inertial><origin xyz="0.1 0.2 0.3"/><mass value="1.5"/>'
        '<inertia ixx="0.1" iyy="0.12" izz="0.08" ixy="0.01" ixz="0" iyz="0"/></inertial>'
    )
    text = '<link name="l0"/>'
    for number in range(1, count + 1):
        text += (
            f'<link name="l{number}">{body}</link><joint name="j{number}" type="revolute">'
            f'<parent link="l{number - 1}"/><child link="l{number}"/>'
            '<origin xyz="0.1 0 0.5" rpy="0.3 -0.5 1"/><axis xyz="1 2 -2"/>'
            '<limit lower="-3" upper="3" effort="1" velocity="1"/></joint>'
        )
    return build_mechanism(
        Urdf.from_text(f'<robot name="chain">{text}</robot>', "chain"), "fixed", (0.0, 0.0, -9.81)
    )


def times(mechanism: Mechanism, calls: dict[str, str], repeats: int, number: int) -> dict[str, Array]:
    """Return the times of calls at a random state [s], by name, one of each round."""
    dynamics, model, rng = TreeDynamics(mechanism), mechanism.model, np.random.default_rng(1)
    q, v = pin.integrate(model, pin.neutral(model), rng.normal(size=model.nv)), rng.normal(size=model.nv)
    loop = LOOP // len(dynamics.tree)
    names = {
        **globals(),
        **{"model": model, "data": model.createData(), "q": q, "v": v, "tau": rng.normal(size=model.nv)},
        **{"pin_aba": pin.aba, "pin_crba": pin.crba, "pin_bias": pin.nonLinearEffects, "count": loop},
        **{"y": np.concatenate([q, v]), "nq": model.nq, "tree": dynamics.tree, "gravity": dynamics.gravity},
        **{"room": dynamics.room(), "out": np.zeros(model.nv), "bias": np.zeros(model.nv)},
        **{"mass": np.zeros((model.nv, model.nv)), "places": np.zeros(len(dynamics.tree) + 1, PLACE)},
    }
    plain = {label: (call, names) for label, call in calls.items() if "count" not in call}
    loops = {label: (call, names) for label, call in calls.items() if "count" in call}
    found: dict[str, list[Array]] = {label: [] for label in calls}
    for _ in range(repeats):
        for label, one in interleaved(plain, 1, number).items():
            found[label].append(one)
        for label, one in interleaved(loops, 1, max(1, number // loop)).items():
            found[label].append(one / loop)
    return {label: np.concatenate(several) for label, several in found.items()}


def main() -> int:
    """Time the antenna and the chains."""
    report = Report("tree", __doc__ or "")
    repeats, number = (3, 200) if report.parse().quick else (25, 2000)
    antenna = build_system(scenario("case3", CLOSED_FORM)).mechanism
    for calls, limit in ((CALLS, 1.3), (MASS_CALLS, None)):
        found = times(antenna, calls, repeats, number)
        first, *others = found
        report.add(f"antenna, {first}", 1e6 * np.median(found[first]), "us")
        for label in others:
            report.add(f"antenna, {label}", 1e6 * np.median(found[label]), "us")
            report.add(f"antenna, {label}, over {first}", np.median(found[label] / found[first]), limit=limit)
    call = times(chain(1), CALLS, repeats, number)["pin.aba"]
    report.add("one hinge, pin.aba", 1e6 * np.median(call), "us")
    for count in CHAINS:
        found = times(chain(count), CALLS, repeats, number)
        looped, right = found["aba in a loop"], found["pin.aba"]
        report.add(f"chain of {count}, aba in a loop, per body", 1e9 * np.min(looped) / count, "ns")
        report.add(f"chain of {count}, aba in a loop, over pin.aba", np.median(looped / right), limit=1.3)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
