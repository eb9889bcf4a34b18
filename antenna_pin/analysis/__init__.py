"""What a run shows, and what a joint's shape allows: readers of trajectories and geometries."""

from antenna_pin.analysis.bodies import body_poses, joint_loads, mechanism_of
from antenna_pin.analysis.scenarios import (
    SCENARIO_COLUMNS,
    JournalPose,
    ScenarioPair,
    TiltRange,
    possible_scenarios,
    scenario_of,
    scenario_rows,
)
from antenna_pin.analysis.shares import scenario_shares

__all__ = [
    "SCENARIO_COLUMNS",
    "JournalPose",
    "ScenarioPair",
    "TiltRange",
    "body_poses",
    "joint_loads",
    "mechanism_of",
    "possible_scenarios",
    "scenario_of",
    "scenario_rows",
    "scenario_shares",
]
