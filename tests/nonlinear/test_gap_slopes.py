"""Derivatives of what goes with where joints are in their play."""

import numpy as np
import pytest

from antenna_pin import load_scenario
from antenna_pin.run.simulation.inputs import settings_of
from antenna_pin.studies.nonlinear import flow_of
from antenna_pin.studies.nonlinear.vector_field import VectorField


@pytest.mark.parametrize("scale", [1.0, 1e-2, 1e-3])
def test_what_changes_on_a_finer_scale_than_the_play(scale):
    """As a flange's rate does with a tilt that is next to none: of hypot(x, y) it is x / hypot."""
    changes = {"clearance.bore.geometry": "closed-form"}
    scenario = load_scenario("impact_pair", case="planar", overrides=changes)
    flow, start = flow_of(scenario)
    field = VectorField(flow.system, settings_of(scenario), None)
    y = np.concatenate([start.q, start.v, np.zeros(flow.system.manifold.nx)])
    nq = flow.system.model.nq
    at = y[nq : nq + 2].copy()

    def function(_, state):
        return np.array([np.hypot(*(state[nq : nq + 2] - at + 1e-2 * scale * np.array([0.6, 0.8])))])

    ways = np.zeros((field.parts[-1].stop, 2))
    ways[field.parts[1]][:2] = np.eye(2)
    sixth, other = field.gaps.both_orders(function, 0.0, y, ways)
    # Round-off of velocities of 0.1 m/s over steps of a thousandth of the scale, or of 1e-5 m/s at most.
    assert sixth[0] == pytest.approx([0.6, 0.8], rel=0.0, abs=2e-9)
    assert np.abs(sixth - other).max() < 1e-8
