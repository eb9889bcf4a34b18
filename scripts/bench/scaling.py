#!/usr/bin/env python3
"""How the compiled engine's time grows with bodies and with joints with play.

Chains of 2 to 64 links on hinges swing under gravity; and a chain of 16 links of which 1 to 16 hinges have
play (planar, so that each adds a free body and one contact). Times are those of the loop per evaluation of
the derivative, over one ``pin.aba`` of the same chain called from Python and in microseconds: the fastest of
all rounds. The exponent is that of the number of bodies between the two longest chains: 1 is linear.
"""

from __future__ import annotations

import math
import sys
import timeit

import numpy as np
import pinocchio as pin
from bench_tools import Report

from antenna_pin import ClearanceJoint, RunSettings, System, Urdf, build_mechanism
from antenna_pin.contact import LankaraniNikravesh, Tanh
from antenna_pin.joints.geometry import PlanarClearance
from antenna_pin.run.simulation.loop import Run

LENGTHS = (2, 4, 8, 16, 32, 64)
WITH_PLAY = (1, 2, 4, 8, 16)
SETTINGS = RunSettings(engine="compiled", method="dormand-prince-54", rtol=1e-6)

LINK = """
<link name="link{0}"><inertial><origin xyz="0 0 -0.05"/><mass value="0.2"/>
<inertia ixx="2e-4" iyy="2e-4" izz="1e-5" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="hinge{0}" type="continuous"><parent link="{1}"/><child link="link{0}"/>
<origin xyz="0 0 {2}"/><axis xyz="0 1 0"/></joint>
"""


def chain(length: int, with_play: int = 0) -> System:
    """Return a chain of links, of which the first hinges have play."""
    links = "".join(
        LINK.format(k, f"link{k - 1}" if k else "world", -0.1 if k else 0.0) for k in range(length)
    )
    urdf = Urdf.from_text(f'<robot name="chain"><link name="world"/>{links}</robot>', "chain")
    names = [f"hinge{k}" for k in range(with_play)]
    mechanism = build_mechanism(
        urdf.variant(joints=dict.fromkeys(names, "planar")), base="fixed", gravity=(0.0, 0.0, -9.81)
    )
    law = LankaraniNikravesh(stiffness=1e8, restitution=0.7)
    joints = [
        ClearanceJoint(
            name=name,
            geometry=PlanarClearance(bearing_radius=5.05e-3, journal_radius=5e-3),
            radial=law,
            friction=Tanh(coefficient_of_friction=0.1, transition_speed=1e-2),
            backend="closed-form",
        )
        for name in names
    ]
    return System(mechanism, clearances=joints)


def per_evaluation(system: System, span: float, rounds: int) -> tuple[float, float]:
    """Return the loop's time per evaluation and that of one ``pin.aba`` [s], the least of all rounds."""
    model = system.model
    rng = np.random.default_rng(1)
    start = system.state(system.neutral(), np.zeros(model.nv))
    names = {"aba": pin.aba, "model": model, "data": model.createData(), "q": pin.neutral(model)}
    names |= {"v": rng.normal(size=model.nv), "tau": np.zeros(model.nv)}
    timer = timeit.Timer("aba(model, data, q, v, tau)", globals=names)
    ours = aba = math.inf
    for _ in range(rounds):
        run = Run(system, start, span, SETTINGS)
        taken = timeit.timeit(run.advance, number=1)
        ours = min(ours, taken / run.stepper.evaluations)
        aba = min(aba, timer.timeit(2000) / 2000)
    return ours, aba


def main() -> int:
    """Time the chains."""
    report = Report("scaling", __doc__ or "")
    quick = report.parse().quick
    rounds = 2 if quick else 7
    taken = []
    for length in LENGTHS[: 3 if quick else None]:
        ours, aba = per_evaluation(chain(length), 0.5 if quick else 2.0, rounds)
        taken.append(ours)
        report.add(f"{length} links, per evaluation", 1e6 * ours, "us")
        report.add(f"{length} links, per evaluation and link", 1e6 * ours / length, "us")
        report.add(f"{length} links, over pin.aba", ours / aba)
    exponent = math.log(taken[-1] / taken[-2]) / math.log(2.0)
    report.add("exponent of the number of links, at the end", exponent, limit=1.15)
    for count in WITH_PLAY[: 2 if quick else None]:
        ours, aba = per_evaluation(chain(16, count), 0.02 if quick else 0.1, rounds)
        report.add(f"16 links, {count} with play, per evaluation", 1e6 * ours, "us")
        report.add(f"16 links, {count} with play, over pin.aba", ours / aba)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
