"""Records of a hinge with play: the fit of two probes and a force cell, and their noise."""

from __future__ import annotations

from pathlib import Path

import numpy as np

TRUTH = {"play": 1.0e-4, "stiffness": 1.0e10, "restitution": 0.8, "friction": 0.1}
TIMES = np.arange(1, 301) * 2e-4  # [s]
PLACE_NOISE, FORCE_NOISE = 0.5e-6, 5.0  # [m], [N]

FIT = """
title = "A hinge with play from two probes and a force cell"
scenario = "pendulum"
case = "planar"
[set]
duration = "0.061 s"
integrator.engine = "compiled"
clearance.hinge.geometry = "closed-form"
initial.joints.hinge.journal_velocity = ["150 mm/s", "0 m/s", "0 m/s"]
clearance.hinge.normal = { replace = true, law = "lankarani-nikravesh", stiffness = 1e10, restitution = 0.7 }
[set.clearance.hinge.friction]
replace = true
law = "tanh"
coefficient_of_friction = 0.1
transition_speed = "10 mm/s"
[parameters.play]
key = "clearance.hinge.radial_clearance"
start = "0.101 mm"
between = ["0.05 mm", "0.2 mm"]
[parameters.stiffness]
key = "clearance.hinge.normal.stiffness"
start = "1.05e10 N/m**1.5"
between = ["1e9 N/m**1.5", "1e11 N/m**1.5"]
scale = "log"
[parameters.restitution]
key = "clearance.hinge.normal.restitution"
start = 0.79
between = [0.3, 1.0]
[parameters.friction]
key = "clearance.hinge.friction.coefficient_of_friction"
start = 0.11
between = [0.0, 0.5]
[records.test]
file = "test.csv"
[records.test.columns.x]
of = "journal_position[hinge].x"
unit = "um"
sd = "0.5 um"
[records.test.columns.y]
of = "journal_position[hinge].y"
unit = "um"
sd = "0.5 um"
[records.test.columns.force]
of = "joint_force[hinge].x"
unit = "N"
sd = "5 N"
"""


def noise_of(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return a record's noise in units of its standard deviation: of places (n, 2), of the force (n,)."""
    noise = np.random.default_rng(seed)
    return noise.standard_normal((len(TIMES), 2)), noise.standard_normal(len(TIMES))


def write_record(path: Path, clean: tuple[np.ndarray, np.ndarray, np.ndarray], seed: int) -> None:
    """Write a record with its noise."""
    of_places, of_force = noise_of(seed)
    places = clean[0] + PLACE_NOISE * of_places
    force = clean[1][:, 0] + FORCE_NOISE * of_force
    rows = np.column_stack([TIMES, 1e6 * places, force])
    np.savetxt(path, rows, delimiter=",", header="time,x,y,force", comments="", fmt="%.9g")
