#!/usr/bin/env python3
"""Accuracy of case 3: default settings against a far tighter tolerance, and what must be conserved.

Over 0.2 s (some 35 impacts) the motion angle, the summed radial impulse and the peak force of the default
run are compared with those of a run whose tolerance is 100,000 times tighter. Beyond about 0.5 s single
impacts are sensitive, so that only conservation is a measure; it is given over 0.2, 1 and 5 s at default and
at a tight tolerance. Momentum is relative to the largest summed momentum magnitude of the bodies other than
the base, the energy ledger to the gross work of the drives.
"""

from __future__ import annotations

import json
import sys

import numpy as np
from bench_tools import CLOSED_FORM, Report, scenario

from antenna_pin import Trajectory, simulate

REFERENCE = 1e-13
TIGHT = 1e-12
SPANS = (0.2, 1.0, 5.0)  # [s]
LIMITS = {"default": (1e-8, 1e-6), "tight": (1e-11, 1e-9)}  # momentum, energy


def run(span: float, *overrides: str) -> Trajectory:
    """Return a run of case 3 over a span [s]."""
    result = simulate(scenario("case3", *overrides), duration=span)
    if not result.completed:
        raise SystemExit(f"a run ended early: {result.message}")
    return result


def angle(result: Trajectory, times: np.ndarray) -> np.ndarray:
    """Return the elevation's motion angle at sampled times [rad]."""
    return np.asarray(result.data["motion_angle"].sel(joint="elevation", time=times).values)


def radial_impulse(result: Trajectory) -> float:
    """Return the normal impulse of all radial contacts [N s]."""
    return sum(c["impulse"] for name, c in result.summary()["contacts"].items() if ".radial" in name)


def peak_force(result: Trajectory) -> float:
    """Return the largest normal force of all contacts [N]."""
    return float(result.data["peak_force"].max())


def compare(report: Report, label: str, found: Trajectory, reference: Trajectory) -> None:
    """Add the deviations of a run from its reference."""
    times = np.arange(round(1000 * SPANS[0]) + 1) / 1000.0
    right = angle(reference, times)
    deviation = np.abs(angle(found, times) - right).max() / np.abs(right).max()
    report.add(f"{label}, motion angle", deviation, limit=1e-6)
    right_impulse, right_peak = radial_impulse(reference), peak_force(reference)
    report.add(f"{label}, radial impulse", abs(radial_impulse(found) / right_impulse - 1.0), limit=1e-5)
    report.add(f"{label}, peak force", abs(peak_force(found) / right_peak - 1.0), limit=1e-3)


def main() -> int:
    """Measure accuracy and conservation."""
    report = Report("accuracy", __doc__ or "")
    spans = SPANS[:1] if report.parse().quick else SPANS
    reference = run(SPANS[0], CLOSED_FORM, f"integrator.rtol={REFERENCE}")
    report.add("contact episodes in 0.2 s", reference.data.sizes["episode"])
    tight = f"integrator.rtol={TIGHT}"
    compare(report, "coal, 0.2 s", run(SPANS[0]), reference)
    compare(report, "closed form, 0.2 s", run(SPANS[0], CLOSED_FORM), reference)
    compare(report, "closed form at 1e-12, 0.2 s", run(SPANS[0], CLOSED_FORM, tight), reference)
    ends: dict[tuple[float, str], float] = {}
    for span in spans:
        for name, overrides in (("default", ()), ("tight", (tight,))):
            result = run(span, CLOSED_FORM, *overrides)
            kept = json.loads(result.data.attrs["conservation"])
            momentum, energy = LIMITS[name]
            label = f"{name}, {span:g} s"
            report.add(f"{label}, linear momentum", kept["linear_momentum_drift_relative"], limit=momentum)
            report.add(f"{label}, angular momentum", kept["angular_momentum_drift_relative"], limit=momentum)
            report.add(f"{label}, energy ledger", kept["energy_error_relative"], limit=energy)
            report.add(f"{label}, contact episodes", result.data.sizes["episode"])
            ends[span, name] = angle(result, np.array([span]))[0]
        scatter = abs(ends[span, "default"] - ends[span, "tight"])
        report.add(f"default less tight, {span:g} s, angle at the end", scatter, "rad")
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
