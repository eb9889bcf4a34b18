#!/usr/bin/env python3
"""What it changes that a law takes the effective mass of each contact, at its onset and along its normal.

Case 3 of the antenna over 0.5 s with the law of Tsuji et al., whose damping needs the mass that an impact
sees. The law takes it from each contact; for comparison a run in which it is given one mass for all contacts,
that of an impact across the bearing's axis at its centre in the first pose. A free impact with the right mass
delivers a restitution known in closed form. The table gives the masses, and how far the restitution that the
impacts deliver is from it, of contacts that have no other at the same time.
"""

from __future__ import annotations

import sys

import numpy as np
import pinocchio as pin
from bench_tools import CLOSED_FORM, Report, scenario

from antenna_pin import Trajectory, build_system, simulate
from antenna_pin.analysis.law_studies import closed_form_restitution
from antenna_pin.contact import Tsuji
from antenna_pin.mechanism import frame_aligning_z
from antenna_pin.scenario.assemble import initial_state

SPAN = 0.5  # [s]
ASKED = 0.7
LAW = f"clearance.elevation.normal={{law='tsuji', restitution={ASKED}, replace=true}}"


def mass_at_centre() -> float:
    """Return the effective mass across the bearing's axis in the first pose, over all directions [kg]."""
    asked = scenario("case3")
    system = build_system(asked)
    q, _ = initial_state(asked, system)
    upper = np.triu(pin.computeMinverse(system.model, system.model.createData(), q))
    slot = system.mechanism.joint("elevation")
    inverse = (upper + np.triu(upper, 1).T)[slot.v, slot.v][:3, :3]
    axes = frame_aligning_z(slot.axis)[:, :2]
    return float(2.0 / np.trace(axes.T @ inverse @ axes))


def alone(run: Trajectory) -> np.ndarray:
    """Return which contacts of a run have no other at the same time."""
    onset, release = run.data["onset_time"].values, run.data["release_time"].values
    overlap = (onset[:, None] < release) & (onset < release[:, None])
    return np.asarray((overlap.sum(axis=1) == 1) & np.isfinite(release))


def restitution(run: Trajectory) -> np.ndarray:
    """Return the speed at release over the approach speed of each contact [-]."""
    data = run.data
    rows = []
    for release, contact in zip(data["release_time"].values, data["episode_contact"].values, strict=True):
        at = data["depth_rate"].sel(time=release, method="nearest").values if np.isfinite(release) else None
        rows.append(np.nan if at is None else -at[contact])
    return np.asarray(rows) / data["approach_speed"].values


def main() -> int:
    """Compare the two."""
    report = Report("effective_mass", __doc__ or "")
    span = 0.1 if report.parse().quick else SPAN
    fixed = mass_at_centre()
    report.add("mass at the centre, first pose", fixed, "kg")
    law = Tsuji(stiffness=1e11, restitution=ASKED, effective_mass=1.0)
    promised = closed_form_restitution(law, mass=1.0, speed=0.1)
    assert promised is not None
    report.add(f"restitution promised, {ASKED} asked", promised)
    for label, given in (("each contact's mass", ""), ("one mass for all", f", effective_mass={fixed!r}")):
        run = simulate(scenario("case3", CLOSED_FORM, LAW.replace("}", given + "}")), duration=span)
        if not run.completed:
            raise SystemExit(f"a run ended early: {run.message}")
        chosen = alone(run)
        off = np.abs(restitution(run)[chosen] - promised)
        if not given:
            masses = run.data["effective_mass"].values
            for name, value in (
                ("least", masses.min()),
                ("median", np.median(masses)),
                ("largest", masses.max()),
            ):
                report.add(f"mass at an onset, {name}", value, "kg")
        report.add(f"{label}, impacts alone", chosen.sum())
        report.add(f"{label}, restitution off, median", np.median(off))
        report.add(f"{label}, restitution off, largest", off.max())
        report.add(f"{label}, peak force", float(run.data["peak_force"].max()), "N")
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
