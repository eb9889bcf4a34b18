"""The antenna's joint in few words, and gaps and scenarios of many poses at once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numba import njit

from antenna_pin.base.records import CONTACT, POSE
from antenna_pin.joints.geometry import RevoluteClearance
from antenna_pin.joints.geometry.revolute_kernels import scenario_in


@pytest.fixture
def bai() -> Callable[..., RevoluteClearance]:
    """Bai and Zhao's joint, with changes."""

    def build(**changes: float) -> RevoluteClearance:
        return RevoluteClearance.from_clearances(
            **{
                "bearing_radius": 0.010,
                "radial_clearance": 2e-4,
                "bearing_length": 0.050,
                "axial_clearance": 2e-4,
                "bearing_outer_radius": 0.012,
                "flange_radius": 0.014,
                **changes,
            }
        )

    return build


@njit
def _look(shape: Any, grown: Any, poses: Any, table: Any, gaps: Any, scenarios: Any) -> None:
    for k in range(len(poses)):
        scenario_in(shape, poses[k : k + 1], table)
        for i in range(4):
            gaps[k, i] = table[i].gap
        scenarios[k] = scenario_in(grown, poses[k : k + 1], table)


@pytest.fixture(scope="session")
def look() -> Callable[..., tuple[np.ndarray, np.ndarray]]:
    """Gaps (n, 4) and scenarios (n, 2) of poses (n, 6); a gap below the tolerance counts as contact."""

    def at(
        shape: RevoluteClearance, poses: np.ndarray, tolerance: float = 0.0
    ) -> tuple[np.ndarray, np.ndarray]:
        grown = shape.dimensions()
        grown["journal_radius"] += tolerance
        grown["half_distance"] -= tolerance
        records = np.zeros(len(poses), POSE)
        records["centre"], records["axis"] = poses[:, :3], poses[:, 3:]
        records["sine"] = np.hypot(poses[:, 3], poses[:, 4])
        gaps = np.zeros((len(poses), 4))
        scenarios = np.zeros((len(poses), 2), dtype=np.int64)
        _look(shape.dimensions(), grown, records, np.zeros(5, CONTACT), gaps, scenarios)
        return gaps, scenarios

    return at
