"""What a run shows, and what a joint's shape allows: readers of trajectories and geometries."""

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
    "possible_scenarios",
    "scenario_of",
    "scenario_rows",
    "scenario_shares",
]
