"""Coordinates about a state: contacts that remember, and closures that hold."""

import numpy as np
import pytest

from antenna_pin import load_scenario
from antenna_pin.dynamics import Workspace
from antenna_pin.nonlinear import Chart, NotAlikeError, flow_of

COMPILED = {"integrator.engine": "compiled"}


@pytest.fixture(scope="module")
def lasting():
    """The flow of the pendulum, and a state in which its journal has come to lie in the bore."""
    closed = {"clearance.hinge.geometry": "closed-form"}
    flow, start = flow_of(load_scenario("pendulum", case="planar", overrides=COMPILED | closed))
    state = flow.after(start, 1.0)
    assert state.memory[0, 0] == 1.0
    return flow, start, state


def test_a_neighbour_stands_where_its_coordinates_say(lasting):
    """Also in the approach speed that its contact remembers: exactly, for the chart is its own inverse."""
    flow, start, state = lasting
    chart = Chart(flow.system, state)
    assert chart.names[-1].endswith("approach speed")
    z = 1e-3 * np.random.default_rng(0).standard_normal(chart.size)
    neighbour = chart.state(z)
    # To round-off of positions of millimetres in units of a clearance of 0.1 mm.
    assert chart.coordinates(neighbour) == pytest.approx(z, abs=1e-12)
    assert neighbour.memory[0, 1] == pytest.approx(state.memory[0, 1] * np.exp(z[-1]), rel=1e-14)
    with pytest.raises(NotAlikeError, match="contacts that touch must be those of the origin"):
        chart.coordinates(start)


def test_what_a_lasting_contact_remembers_is_neutral_and_acts(lasting):
    """It stays what it was, whatever moves; and it acts, for damping is by the depth's rate over it."""
    flow, _, state = lasting
    moved = Chart(flow.system, state).state(np.array([0.1, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0]))
    tangent = flow.tangent(moved, 1e-4, step=1e-4)
    own = np.zeros(7)
    own[-1] = 1.0
    assert tangent.matrix[-1] == pytest.approx(own, abs=1e-12)
    assert np.abs(tangent.matrix[:-1, -1]).max() > 1e-6


def test_neighbours_of_a_loop_are_on_it():
    """A slider-crank with play: closures hold in every neighbour, and coordinates agree to second order."""
    closed = {"clearance.pin.geometry": "closed-form"}
    flow, start = flow_of(load_scenario("slider_crank", case="planar", overrides=COMPILED | closed))
    chart, workspace = Chart(flow.system, start), Workspace(flow.system)
    assert chart.ways < flow.system.model.nv
    z = 1e-4 * np.random.default_rng(1).standard_normal(chart.size)
    neighbour = chart.state(z)
    workspace.prepare_motions(neighbour.time, neighbour.y)
    found = workspace.constraints.residuals(neighbour.time, neighbour.y, workspace.program)
    assert max(found.gap, found.turn, found.speed, found.spin) < 1e-9
    assert chart.coordinates(neighbour) == pytest.approx(z, abs=1e-6)
