"""The variational equation and its saltation against differences of runs, and against closed forms."""

import dataclasses

import numpy as np
import pinocchio as pin
import pytest
from scipy.linalg import expm

from antenna_pin import load_scenario
from antenna_pin.integrate import NODES, Manifold, Propagator
from antenna_pin.run.simulation import Angle, Event, Jump, Set
from antenna_pin.studies.nonlinear import Chart, Flow, flow_of

COMPILED = {"integrator.engine": "compiled"}


def apart(flow, start, span):
    """By how much the two derivatives differ, over the largest number, and by how much each is in doubt."""
    ours, runs = flow.tangent(start, span), flow.tangent_by_runs(start, span)
    assert (ours.end.q == runs.end.q).all() or np.abs(ours.end.q - runs.end.q).max() < 1e-12
    size = np.abs(runs.matrix).max()
    return np.abs(ours.matrix - runs.matrix).max() / size, ours.doubt.max() / size


LAWS = {
    # What each shows; kinks, and where a derivative has no bounds, the steps of differences straddle.
    "its own approach speed": ("law = 'lankarani-nikravesh', restitution = 0.5", 1e-8),
    "a force that jumps": ("law = 'kelvin-voigt', stiffness = 1e7, damping = 100.0", 1e-8),
    "no bounds, own mass": ("law = 'tsuji', restitution = 0.7", 1e-6),
    "a kink": ("law = 'jankowski', restitution = 0.7", 1e-6),
    "no memory": ("law = 'marhefka-orin', slope = 0.5", 1e-8),
}


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("span", [1.05e-3, 1.9e-3], ids=["in contact", "behind it"])
def test_impacts_of_two_free_bodies(law, span):
    """Displacements go through onset, contact and release as neighbours do."""
    text, tolerance = LAWS[law]
    changes = ["integrator.engine=compiled", "clearance.bore.geometry=closed-form"]
    changes.append(f"clearance.bore.normal={{ {text}, replace = true }}")
    flow, start = flow_of(load_scenario("impact_pair", case="planar", overrides=changes))
    off, doubt = apart(flow, start, span)
    # Differences of runs at 1e-12 are known to some 1e-9 of the largest.
    assert off < tolerance and doubt < tolerance


FRICTION = {
    "lugre": "static = 0.3, dynamic = 0.2, stribeck_speed = 5e-3, bristle_stiffness = 1e5",
    "dahl": "coefficient_of_friction = 0.2, bristle_stiffness = 1e5",
    "tanh": "coefficient_of_friction = 0.2, transition_speed = 5e-3",
}


@pytest.mark.parametrize("friction", FRICTION)
def test_friction_with_and_without_bristles(friction):
    """A bar that slides in its bore: bristles are coordinates, and their rates have derivatives."""
    changes = ["integrator.engine=compiled", "clearance.hinge.geometry=closed-form"]
    changes.append(f"clearance.hinge.friction={{ law = '{friction}', {FRICTION[friction]}, replace = true }}")
    flow, start = flow_of(load_scenario("pendulum", case="planar", overrides=changes))
    state = flow.after(start, 0.5)
    assert state.memory[0, 0] == 1.0
    ours, off = flow.tangent(state, 2e-3).matrix, []
    for step in (1e-4, 1e-5):
        off.append(np.abs(flow.tangent_by_runs(state, 2e-3, step=step).matrix - ours).max())
    # Differences of runs are of second order in the step, beside a depth of some 1e-3 of a unit.
    assert off[1] < 2e-5 * np.abs(ours).max()
    assert off[0] / off[1] == pytest.approx(100.0, rel=0.05)


TORQUE = {"drives.crank": {"replace": True, "kind": "constant", "value": 5.0}}


@pytest.mark.parametrize(
    ("drive", "engine"),
    [
        pytest.param({}, "compiled", marks=pytest.mark.slow, id="motion"),
        pytest.param(TORQUE, "pinocchio", id="torque"),
    ],
)
def test_an_impact_in_a_closed_loop(drive, engine):
    """Coordinates are those that closures and motions leave, along axes that turn with the loop."""
    changes = {"integrator.engine": engine, "clearance.pin.geometry": "closed-form"} | drive
    flow, start = flow_of(load_scenario("slider_crank", case="planar", overrides=changes))
    # At 1e-12 the instant of the impact is known to 1e-13 s, and so are both derivatives to some 1e-7.
    flow = Flow(flow.system, dataclasses.replace(flow._settings, rtol=1e-13))
    start = flow.after(start, 1e-3)
    went = flow.traverse(start, 2e-3)
    assert went.onsets >= 1
    off, _ = apart(flow, start, 2e-3)
    assert off < 1e-7


def test_coal_is_closed_form():
    """Gaps that coal measures have the derivatives of those in closed form."""
    found = []
    for backend in ("coal", "closed-form"):
        changes = {"clearance.bore.geometry": backend}
        flow, start = flow_of(load_scenario("impact_pair", overrides=changes))
        found.append(flow.tangent(start, 1.3e-3).matrix)
    assert np.abs(found[0] - found[1]).max() < 1e-7 * np.abs(found[1]).max()


def stop(oscillator, **more):
    system = oscillator(1.0, 10.0, 0.3, 2.0, 0.7, **more)
    return system, lambda flow: flow.first(np.array([-0.2]), np.array([0.5]))


def test_events_that_turn_back_and_that_change_a_spring(oscillator, turned_back):
    """A jump at a place, and a spring that is another from a place on, whose force jumps there."""
    system, start_of = stop(oscillator)
    turn = turned_back(0.1, 0.7)
    harder = Event(name="harder", when=Angle("way", -0.1), action=Set("springs.coil.stiffness", 40.0))
    for events in ((turn,), (harder,), (turn, harder)):
        flow = Flow(system, events=events)
        start = start_of(flow)
        assert flow.traverse(start, 1.0).events >= 1
        ours, runs = flow.propagate(start, 1.0, Chart(system, start).frame)[0].tangents.matrix, None
        if harder in events:  # a state whose spring has changed has no chart: differences of plain numbers
            ahead, behind = (
                [
                    flow.after(flow.first(start.q + d[:1], start.v + d[1:]), 1.0)
                    for d in sign * 1e-5 * np.eye(2)
                ]
                for sign in (1, -1)
            )
            runs = np.column_stack(
                [np.concatenate([a.q - b.q, a.v - b.v]) / 2e-5 for a, b in zip(ahead, behind, strict=True)]
            )
        else:
            runs = flow.tangent_by_runs(start, 1.0).matrix
        # Second order in steps of 1e-5, with third derivatives of some ten.
        assert np.abs(ours - runs).max() < 1e-8 * np.abs(runs).max()


def test_a_jump_at_a_time_moves_no_instant(oscillator):
    """Then a displacement goes through the jump's own derivative alone: twice the speed, twice its change."""
    system, start_of = stop(oscillator)
    jump = Jump(lambda m: (m.q + 0.01 * m.v, 2.0 * m.v))
    late = Event(name="late", when=lambda m: m.time - 0.5, direction=1, action=jump)
    plain, struck = Flow(system), Flow(system, events=(late,))
    start = start_of(plain)
    half = plain.tangent(start, 0.5)
    own = np.array([[1.0, 0.01], [0.0, 2.0]])
    after = plain.first(half.end.q + 0.01 * half.end.v, 2.0 * half.end.v)
    after = dataclasses.replace(after, time=0.5, reached=0.5)
    expected = plain.tangent(after, 0.3).matrix @ own @ half.matrix
    # Each piece of a step is good to 1e-10.
    assert struck.tangent(start, 0.8).matrix == pytest.approx(expected, abs=1e-9)


def test_momentum_of_displacements():
    """In free flight and through impacts, what is conserved is so to first order too: linear momentum."""
    flow, start = flow_of(
        load_scenario("impact_pair", overrides=COMPILED | {"clearance.bore.geometry": "closed-form"})
    )
    assert flow.traverse(start, 1.9e-3).onsets == 1

    def gradient(state):
        """Of linear momentum in world axes over coordinates, by differences of momenta."""
        chart, h = Chart(flow.system, state), 1e-4

        def momentum(z):
            other = chart.state(z)
            data = flow.system.model.createData()
            pin.computeCentroidalMomentum(flow.system.model, data, other.q, other.v)
            return data.hg.linear.copy()

        ways = np.eye(chart.size)
        return np.column_stack([(momentum(h * way) - momentum(-h * way)) / (2.0 * h) for way in ways])

    tangent = flow.tangent(start, 1.9e-3)
    before, behind = gradient(start), gradient(tangent.end)
    # Momenta are of second order in displacements: their differences are exact, but for round-off over h.
    assert behind @ tangent.matrix == pytest.approx(before, abs=1e-8 * np.abs(before).max())


def test_the_bracket_of_ways_with_a_motion():
    """Neighbours q o exp(w) of a motion q' = q v move by w' = dv - [v, w] beside it, whatever the joints."""
    manifold = Manifold(("rigid", "plane", "rotation", "vector", "circle"))
    model = pin.Model()
    for k, joint in enumerate(
        (
            pin.JointModelFreeFlyer(),
            pin.JointModelPlanar(),
            pin.JointModelSpherical(),
            pin.JointModelPX(),
            pin.JointModelRUBZ(),
        )
    ):
        model.addJoint(0, joint, pin.SE3.Identity(), f"joint {k}")
    random = np.random.default_rng(0)
    q = pin.randomConfiguration(model, -np.ones(model.nq), np.ones(model.nq))
    v, dv, w = random.standard_normal((3, model.nv))

    def beside(t, s):
        one = pin.integrate(model, q, v * t)
        other = pin.integrate(model, pin.integrate(model, q, s * w), (v + s * dv) * t)
        return pin.difference(model, one, other)

    h = 1e-4
    turning = (beside(h, h) - beside(-h, h) - beside(h, -h) + beside(-h, -h)) / (4.0 * h**2)
    # Second order in both steps.
    assert dv - manifold.bracket(v, w[:, None])[:, 0] == pytest.approx(turning, abs=1e-6)


def test_the_order_of_collocation():
    """Order 8 at Gauss's four nodes, of an equation whose matrix turns with time."""

    def matrix(t):
        return np.array([[np.cos(t), 1.0 + t], [-2.0, np.sin(3.0 * t)]])

    def made(count):
        whole, propagator = np.eye(2), Propagator(2)
        for k in range(count):
            h = 2.0 / count
            step = propagator.step(h, np.array([matrix(h * (k + c)) for c in NODES]))
            whole = step.matrix @ whole
        return whole

    exact = made(128)
    off = [np.abs(made(count) - exact).max() for count in (6, 12)]
    assert np.log2(off[0] / off[1]) == pytest.approx(8.0, abs=0.2)
    # Liouville: the determinant is the exponential of the trace's integral.
    trace = np.sin(2.0) + (1.0 - np.cos(6.0)) / 3.0
    assert np.linalg.det(exact) == pytest.approx(np.exp(trace), rel=1e-13)


def test_what_is_integrated_beside_collocation():
    """Of ``b' = R w`` over a step with a matrix that is constant: R A^-1 (exp(A h) - 1), to order 8."""
    matrix, row = np.array([[-1.0, 3.0], [-2.0, 0.5]]), np.array([[1.0, -4.0]])

    def off(h):
        propagator = Propagator(2)
        propagator.step(h, np.array([matrix] * len(NODES)))
        found = propagator.integral(h, np.array([row] * len(NODES)))
        return np.abs(found - row @ np.linalg.solve(matrix, expm(h * matrix) - np.eye(2))).max()

    # One step: the next power of it. Both are far above round-off.
    assert off(0.4) > 1e-10
    assert np.log2(off(0.8) / off(0.4)) == pytest.approx(9.0, abs=0.5)
