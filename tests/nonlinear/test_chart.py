"""Coordinates about a state: contacts that remember, and closures that hold."""

import math

import numpy as np
import pytest

from antenna_pin import load_scenario
from antenna_pin.dynamics import Workspace
from antenna_pin.studies.nonlinear import Chart, Flow, NotAlikeError, OutOfReachError, flow_of

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
    tangent = flow.tangent(moved, 1e-4)
    own = np.zeros(7)
    own[-1] = 1.0
    assert tangent.matrix[-1] == pytest.approx(own, abs=1e-12)
    assert np.abs(tangent.matrix[:-1, -1]).max() > 1e-6


def crank(case, **changes):
    """The flow of the slider-crank, and a state of it in motion, on no axis of anything."""
    closed = {"clearance.pin.geometry": "closed-form"}
    scenario = load_scenario("slider_crank", case=case, overrides=COMPILED | closed | changes)
    flow, start = flow_of(scenario)
    return flow, flow.after(start, 1e-3)


TORQUE = {"drives.crank": {"replace": True, "kind": "constant", "value": 5.0}}


@pytest.mark.parametrize(
    ("case", "changes", "freedoms"),
    [("planar", {}, 2), ("planar", TORQUE, 3), ("ideal", TORQUE, 1), ("ideal-constraint", TORQUE, 1)],
)
def test_neighbours_of_a_loop_are_on_it_and_where_they_are_asked_for(case, changes, freedoms):
    """Freedoms are those that closures and motions leave; random coordinates are met, small or moderate.

    Exactly, but for round-off: of places of 0.2 m in units of a clearance of 0.5 mm, and of a velocity of up
    to 700 rad/s in units of 0.01 m/s. On the closures by what a run itself corrects.
    """
    flow, state = crank(case, **changes)
    chart, workspace = Chart(flow.system, state), Workspace(flow.system)
    assert (chart.positions, chart.size) == (freedoms, 2 * freedoms)
    random = np.random.default_rng(1)
    for size in np.repeat([1e-9, 1e-6, 1e-3, 0.1, 0.5], 4):
        z = size * random.standard_normal(chart.size)
        neighbour = chart.state(z)
        workspace.prepare_motions(neighbour.time, neighbour.y)
        found = workspace.constraints.residuals(neighbour.time, neighbour.y, workspace.program)
        # A speed of 500 rad/s has a round-off of 1e-13.
        assert max(found.gap, found.turn) < 1e-14 and max(found.speed, found.spin) < 3e-13
        assert np.abs(chart.coordinates(neighbour) - z).max() < 1e-11


def test_a_direction_in_one_chart_is_one_in_another():
    """What closures leave has other axes in each state; the same neighbours are where it leads in both."""
    flow, state = crank("planar", **TORQUE)
    chart = Chart(flow.system, state)
    random = np.random.default_rng(3)
    largest = 0.0
    for _ in range(6):
        other = Chart(flow.system, chart.state(0.05 * random.standard_normal(chart.size)))
        way = random.standard_normal(chart.size)
        ahead, behind = (other.coordinates(chart.state(h * way)) for h in (1e-4, -1e-4))
        turned = other.transported(way, chart)
        # By what the loop's tangent turns over the 0.05 between the two.
        assert (ahead - behind) / 2e-4 == pytest.approx(turned, abs=0.05)
        largest = max(largest, float(np.abs(turned - way).max()))
    assert largest > 1.0


def test_where_a_loop_tears_there_is_no_neighbour():
    """A rod of 0.045 m on a crank of 0.05 m lets the crank turn by asin(0.9), or 1.12 rad, either way."""
    flow, state = crank("ideal", **TORQUE, **{"mechanism.joints.pin.origin_xyz": [0.045, 0.0, 0.0]})
    chart = Chart(flow.system, state)
    way = np.array([1.0, 0.0])
    turns = [math.atan2(*chart.state(z * way).q[1::-1]) for z in np.linspace(-3.6, 3.6, 37)]
    assert -math.asin(0.9) < min(turns) < -1.11 and 1.11 < max(turns) < math.asin(0.9)
    for z in (3.8, -3.8):
        with pytest.raises(OutOfReachError, match="so near that closures hold there; take a smaller step"):
            chart.state(z * way)


def test_turns_are_seen_down_to_round_off(pendulum):
    """Of a joint that turns without end, 1e-12 rad are 1e-12 rad."""
    flow = Flow(pendulum(9.0, 1.0, 0.0))
    chart = Chart(flow.system, flow.first(np.array([math.cos(0.3), math.sin(0.3)]), np.zeros(1)))
    for turn in (1e-12, 1e-9, 1e-7, 1e-3, 1.0):
        z = np.array([turn, 0.0])
        assert chart.coordinates(chart.state(z)) == pytest.approx(z, abs=3e-16)
