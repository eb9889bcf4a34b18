"""Disturbance at the interface against the laws of motion."""

from pathlib import Path

import numpy as np
import pytest

from antenna_pin.analysis import interface_loads, quantity
from antenna_pin.run.simulation import simulate
from antenna_pin.scenario import load_scenario

PANEL = Path(__file__).parents[2] / "scripts" / "examples" / "panel" / "verified.toml"


def test_fixed_base_feels_what_moves_the_sled(sled):
    """The force along the rail is minus mass times acceleration, which drives give; the rest is zero."""
    run = simulate(load_scenario(sled("").parent / "sled.toml"))
    loads = interface_loads(run)
    pushed = 4.0 + 2.0 * np.sin(2.0 * np.pi * 0.2 * loads["time"].values)
    # Round-off of forces of some newtons.
    assert loads["force"].values[:, 0] == pytest.approx(-pushed, abs=1e-11)
    assert abs(loads["force"].values[:, 1:]).max() < 1e-12
    assert abs(loads["moment"].values).max() < 1e-11


def test_free_base_moves_as_the_interface_pushes_it():
    """Nothing else acts on the bus: its 60 kg times the acceleration of its mass centre are the force."""
    run = simulate(load_scenario(PANEL), duration=1.4)
    force = interface_loads(run)["force"].values
    # In its axes and in the world's the lengths are the same.
    sizes = np.linalg.norm(force, axis=1), 60.0 * quantity(run, "|body_acceleration[bus]|").values
    assert sizes[0] == pytest.approx(sizes[1], rel=1e-9, abs=1e-9 * sizes[1].max())
    assert sizes[0].max() > 50.0
