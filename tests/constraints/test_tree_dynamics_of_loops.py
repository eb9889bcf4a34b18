"""Closed loops are solved with the compiled tree's own mass matrix: no Pinocchio."""

import numpy as np
import pytest

from antenna_pin import load_scenario
from antenna_pin.dynamics import Workspace
from antenna_pin.dynamics.constraints import loaded_kernels
from antenna_pin.mechanism import TreeDynamics
from antenna_pin.scenario.assemble import build_system, initial_state


@pytest.mark.parametrize(("model", "case"), [("slider_crank", "3d"), ("bai2020", "case1-constraint")])
def test_accelerations_under_constraints_are_those_with_pinocchios_matrix(model, case):
    scenario = load_scenario(model, case=case)
    system = build_system(scenario)
    y, nq, nv = system.state(*initial_state(scenario, system)), system.model.nq, system.model.nv
    workspace, expected = Workspace(system), np.zeros(nv + system.manifold.nx)
    workspace.derivative(0.01, y, expected)
    held, tree, found = workspace.constraints, TreeDynamics(system.mechanism), expected.copy()
    found[:nv] = 0.0
    mass, bias = tree.mass_and_bias(y[:nq], y[nq : nq + nv])
    loaded_kernels.accelerate(
        0.01, y, workspace.program, held.plan.words, held.work, workspace.tau, mass, bias, found
    )
    assert np.abs(expected[:nv]).max() > 0.0
    # Round-off of a solution of a dozen equations.
    assert found == pytest.approx(expected, abs=1e-11 * np.abs(expected[:nv]).max())
