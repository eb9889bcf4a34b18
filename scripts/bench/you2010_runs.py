"""Runs of the satellite of You, Pan and Zhao (2010) and the force through its joint 2."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from bench_tools import Array

from antenna_pin import Scenario, Trajectory, load_scenario, simulate
from antenna_pin.analysis import impacts, joint_loads

LAYOUTS = {"planar": "ideal", "gimbal": "gimbal-ideal"}  # case with play: its ideal joint
EXTERNAL = "clearance.joint2.normal.stiffness=8.676e9"  # [N/m^1.5], the radius as printed
PLAY = "clearance.joint2.radial_clearance"  # [m]
NO_FRICTION = "clearance.joint2.friction={replace = true, law = 'none'}"


def scenario(case: str, *overrides: str) -> Scenario:
    """Return a case with the gaps in closed form and some entries changed."""
    return load_scenario(
        "you2010", case=case, overrides=["clearance.joint2.geometry=closed-form", *overrides]
    )


@functools.cache
def run(case: str, *overrides: str, span: float = 5.0) -> Trajectory:
    """Return a finished run; the same one if asked again."""
    found = simulate(scenario(case, *overrides), duration=span)
    if not found.completed:
        raise SystemExit(f"{case}: {found.message}")
    return found


@dataclass(frozen=True, slots=True)
class Load:
    """Size of the force through joint 2 over time."""

    time: Array  # [s]
    force: Array  # [N]

    @classmethod
    def of(cls, trajectory: Trajectory) -> Load:
        """Return what a run's joint 2 carries: constraint or contact, by inverse dynamics."""
        loads = joint_loads(trajectory)["force"].sel(moving_joint="joint2").values
        return cls(trajectory.data["time"].values, np.linalg.norm(loads, axis=1))

    def largest(self, start: float, end: float) -> float:
        """Return the largest force between two times [N]."""
        return float(self.force[(self.time >= start) & (self.time <= end)].max())


def settled(trajectory: Trajectory) -> float:
    """Return when the journal touched the bearing for good [s]; the end if it never did."""
    table = impacts(trajectory)
    return float(table["onset"][-1]) if not bool(table["ended"][-1]) else float(trajectory.data["time"][-1])
