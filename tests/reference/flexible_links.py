"""The reflector of the antenna, flexible in each of the ways there are, for tests."""

from __future__ import annotations

import pytest

ROCK = {
    "frequency": "15 Hz",
    "damping_ratio": 0.005,
    "mass": 2.0,
    "direction": [0, 1, 0],
    "place": [0.1, 0, 0.2],
}
TWIST = {"frequency": "25 Hz", "damping_ratio": 0.01, "inertia": 0.2, "direction": [0.2, 0.3, 1]}
MODES = {"flexible.reflector": {"kind": "modes", "modes": {"rock": ROCK, "twist": TWIST}}}
DISH = {
    "kind": "petals",
    "petals": 8,
    "mass": 6.0,
    "rim_radius": 0.486,
    "hub_radius": 0.1,
    "focal_length": 0.12,
    "vertex": [-0.2755, 0, 0],
    "frequency": "20 Hz",
    "damping_ratio": 0.005,
    "replaces": ["dish"],
}
PETALS = {"flexible.reflector": DISH}
# A screw of a mode, a bending mode of a panel to the side, and one that turns only.
DATA = {
    "flexible.reflector": {
        "kind": "modal-data",
        "frequency": [12.0, 17.0, 31.0],
        "participation": [0.6, 0.1, 0.2, 0.05, 0.2, -0.1, 0, 0, 1.0, 0.3, -0.2, 0, 0, 0, 0, 0.05, 0.1, 0.2],
        "damping_ratio": 0.005,
        "root_xyz": [-0.2, 0.1, 0.0],
        "root_rpy": [0.1, -0.4, 2.0],
    }
}
#: Nothing else of the antenna moves.
LOCKED = {
    "clearance.elevation": {"replace": True, "model": "ideal"},
    "mechanism.joints.azimuth.kind": "locked",
    "drives.azimuth.joint": "elevation",
}
KINDS = pytest.mark.parametrize("overrides", [MODES, PETALS, DATA], ids=["modes", "petals", "modal-data"])
