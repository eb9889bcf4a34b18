#!/usr/bin/env python3
"""The derivative of a flow by the variational equation, beside differences of runs.

Of impacts of two free bodies, case 3 of the antenna, the slider-crank and the 4UPS-UPU, compiled: how
many coordinates there are; the time of both over that of a run of the same span at the same tolerance, 1e-12;
and by how much the variational equation differs from differences of second order of a small step, over the
largest number of the matrix. What is left is mostly theirs.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from bench_tools import Report

from antenna_pin import load_scenario
from antenna_pin.nonlinear import flow_of

COMPILED = {"integrator.engine": "compiled"}
# Model, case, joint with play, from when on [s], how long [s], step of differences.
PROBLEMS = {
    "impact_pair": ("impact_pair", "planar", "bore", 0.0, 1.9e-3, 1e-4),
    "bai2020 case3": ("bai2020", "case3", "elevation", 0.0, 0.02, 1e-6),
    "slider_crank": ("slider_crank", "planar", "pin", 1e-3, 2e-3, 1e-4),
    "chen2021": ("chen2021", "friction-005", "s2", 1.0, 0.05, 1e-6),
}


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
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
