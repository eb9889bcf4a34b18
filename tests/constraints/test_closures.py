"""Closures of every kind: their equations, forces and corrections, on a tree that is nowhere symmetric."""

import numpy as np
import pinocchio as pin
import pytest
from branches import closed
from displacements import along_one
from observed_once import observed_once

from antenna_pin import simulate
from antenna_pin.base.settings import RunSettings
from antenna_pin.dynamics import Workspace, mobility_of
from antenna_pin.dynamics.constraints import CLOSURES
from antenna_pin.elements import CallableMotion, PrescribedMotion
from antenna_pin.studies.nonlinear.vector_field import VectorField


def accelerations(system, y, t=0.3):
    """Generalized accelerations of a state, with the workspace that they were found in."""
    workspace, rates = Workspace(system), np.zeros(system.model.nv + system.manifold.nx)
    workspace.derivative(t, y, rates)
    return workspace, rates[: system.model.nv].copy()


@pytest.mark.parametrize("to", ["b3", "world"])
@pytest.mark.parametrize("kind", CLOSURES)
def test_accelerations_keep_a_loop_closed(kind, to):
    """After h v + h^2 a / 2 the residual is of third order: a wrong equation shows in the first or second."""
    for seed in range(3):
        system, y = closed(kind, seed, to=to)
        nq, nv = system.model.nq, system.model.nv
        workspace, a = accelerations(system, y)
        sizes = []
        for h in (2e-3, 1e-3):
            moved = y.copy()
            moved[:nq] = pin.integrate(system.model, y[:nq], h * y[nq : nq + nv] + 0.5 * h * h * a)
            found = workspace.constraints.residuals(0.3, moved, workspace.program)
            sizes.append(max(float(found.gap), float(found.turn)))
        assert sizes[0] > 1e-11  # it is seen
        # 8 but for terms of fourth order; 4 where an acceleration is wrong.
        assert sizes[0] / sizes[1] == pytest.approx(8.0, rel=0.25)


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("kind", CLOSURES)
def test_forces_of_closures_are_those_that_move_the_tree(kind, count):
    """As external forces on the two links they give Pinocchio's ABA the same accelerations.

    With a closure twice, half of its equations are redundant: each then carries half.
    """
    for seed, to in ((1, "b3"), (2, "world")):
        system, y = closed(kind, seed, to=to, count=count)
        model, data = system.model, system.model.createData()
        nq, nv = model.nq, model.nv
        workspace, a = accelerations(system, y)
        constraints = workspace.constraints
        assert constraints.solution.rank == CLOSURES[kind].rows
        found = observed_once(system, 0.3, y)
        wrenches = found.closure[0]
        # Mass matrix and bias are the tree's own there, Pinocchio's here: round-off apart.
        assert found.acceleration[0] == pytest.approx(a, rel=1e-11, abs=1e-11 * np.abs(a).max())
        assert wrenches == pytest.approx(np.array([wrenches[0]] * count), rel=1e-9, abs=1e-9)
        q, v = y[:nq], y[nq : nq + nv]
        pin.framesForwardKinematics(model, data, q)
        external = pin.StdVec_Force()
        for _ in range(model.njoints):
            external.append(pin.Force.Zero())
        for closure, (force, moment) in zip(system.closures.values(), wrenches, strict=True):
            place = {}
            for side in (closure.first, closure.second):
                own = pin.SE3(side.rotation, side.origin)
                frame = None if side.link == "world" else system.mechanism.frame(side.link)
                place[side.link] = own if frame is None else data.oMf[frame] * own
            first, second = place.values()
            on_second = pin.Force(first.rotation @ force, first.rotation @ moment)
            at = pin.SE3(np.eye(3), second.translation)
            for side, sign in ((closure.first, -1.0), (closure.second, 1.0)):
                if side.link != "world":
                    joint = model.frames[system.mechanism.frame(side.link)].parentJoint
                    wrench = data.oMi[joint].inverse() * at
                    external[joint] = external[joint] + wrench.act(pin.Force(sign * on_second.vector))
        expected = pin.aba(model, data, q, v, workspace.tau, external)
        # Round-off of forces that largely cancel, over masses of 1 to 20 kg.
        assert a == pytest.approx(expected, abs=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("to", ["b3", "world"])
@pytest.mark.parametrize("kind", CLOSURES)
def test_derivatives_of_the_rates_are_their_differences(kind, to):
    """Along a displacement that opens the loop too, whose equations are those of an open one."""
    motion = PrescribedMotion(joint="j5", amplitude=0.05, frequency=0.9)
    system, y = closed(kind, 6, to=to, drives={"slide": motion})
    for found, expected in along_one(VectorField(system, RunSettings(engine="compiled")), y, 7):
        assert found == pytest.approx(expected, abs=1e-8)  # of differences of sixth order


@pytest.mark.parametrize("kind", CLOSURES)
def test_forces_of_closures_do_no_work_and_keep_momentum(kind):
    system, y = closed(kind, 5)
    model, data = system.model, system.model.createData()
    nq, nv = model.nq, model.nv
    workspace, a = accelerations(system, y)
    q, v = y[:nq], y[nq : nq + nv]
    held_by = pin.rnea(model, data, q, v, a) - workspace.tau
    size = np.linalg.norm(held_by) * np.linalg.norm(v)
    assert np.linalg.norm(held_by) > 1.0
    assert abs(held_by @ v) < 1e-12 * size  # round-off
    pin.computeCentroidalMomentumTimeVariation(model, data, q, v, a)
    weight = pin.computeTotalMass(model) * model.gravity.linear
    assert data.dhg.linear == pytest.approx(weight, abs=1e-11 * np.abs(weight).max())  # round-off
    assert data.dhg.angular == pytest.approx(np.zeros(3), abs=1e-11 * np.abs(weight).max())


@pytest.mark.parametrize("kind", CLOSURES)
def test_corrections_close_and_leave_momentum(kind):
    """From 1e-5 off, to round-off; at their end positions the momentum is that of before."""
    system, y = closed(kind, 8)
    model, data = system.model, system.model.createData()
    nq, nv = model.nq, model.nv
    workspace, random = Workspace(system), np.random.default_rng(9)
    off = y.copy()
    workspace.retract(off, random.normal(scale=1e-5, size=nv))
    off[nq : nq + nv] += random.normal(scale=1e-5, size=nv)
    before, moved = off.copy(), off.copy()
    workspace.hold(0.0, moved, workspace.program)
    assert (moved[:nq] != before[:nq]).any()
    found = workspace.constraints.residuals(0.0, moved, workspace.program)
    assert max(found.gap, found.turn, found.speed, found.spin) < 2e-14  # round-off of 1 m and 1 m/s
    momentum = [
        pin.computeCentroidalMomentum(model, data, moved[:nq], state[nq : nq + nv]).vector.copy()
        for state in (before, moved)
    ]
    centre = [pin.centerOfMass(model, data, state[:nq]).copy() for state in (before, moved)]
    # The step of velocity changes none of it; that of position, of 1e-5, the mass centre in second order.
    assert momentum[1] == pytest.approx(momentum[0], abs=1e-12 * np.abs(momentum[0]).max())
    assert centre[1] == pytest.approx(centre[0], abs=1e-9)
    assert workspace.constraints.closed_at(0.0, moved, workspace.program)


def test_rank_counts_what_is_independent():
    """Of a universal closure between branches on a free hull, twice, and of a motion beside."""
    motion = {"motor": PrescribedMotion(joint="j3", rate=0.2)}
    system, y = closed("universal", 3, count=2, drives=motion)
    count = mobility_of(system, y)
    assert (count.freedoms, count.closed, count.closed_rank) == (6 + 3 + 6 + 2, 8, 4)
    assert (count.redundant, count.free, count.rank, count.left) == (4, 13, 5, 12)


def test_a_run_books_what_corrections_put_in():
    """Of coarse steps of Bogacki and Shampine, which leave the loop: it is closed after each all the same."""
    system, y = closed("revolute", 4, base="fixed")
    nq, nv = system.model.nq, system.model.nv
    settings = RunSettings(method="bogacki-shampine-32", rtol=1e-5)
    run = simulate(system, duration=0.5, q=y[:nq], v=y[nq : nq + nv], settings=settings)
    held = run.constraints
    assert max(held["position_residual"], held["angle_residual"]) < 1e-12
    assert max(held["velocity_residual"], held["rate_residual"]) < 1e-12
    error = float(run.data.energy_error[-1])
    assert abs(held["projection_energy"]) > 1e-9
    # What is off after a step, and brought back, is of the size of the step's own error.
    assert abs(error) < 1e3 * abs(held["projection_energy"])


def test_motions_work_enters_the_balance():
    """A driven arm under gravity: work of the drive is the energy stored."""
    motion = {"motor": PrescribedMotion(joint="j1", amplitude=0.4, frequency=2.0)}
    system, y = closed("spherical", 6, base="fixed", drives=motion)
    nq, nv = system.model.nq, system.model.nv
    run = simulate(system, duration=0.4, q=y[:nq], v=y[nq : nq + nv])
    work = float(np.abs(run.data.drive_gross_work[-1]).sum())
    assert work > 1.0
    # The default tolerance of 1e-8 a step.
    assert float(np.abs(run.data.energy_error).max()) < 1e-7 * work
    angle = run.data.motion_angle.sel(joint="j1").values
    assert angle == pytest.approx(0.4 * np.sin(4.0 * np.pi * run.data.time.values), abs=1e-13)  # held


def test_a_motion_from_functions_is_the_same_motion():
    """Position, rate and acceleration by Python functions: forces and works as by the compiled kind."""
    omega = 4.0 * np.pi
    given = CallableMotion(
        joint="j1",
        position=lambda t: 0.4 * np.sin(omega * t),
        velocity=lambda t: 0.4 * omega * np.cos(omega * t),
        acceleration=lambda t: -0.4 * omega**2 * np.sin(omega * t),
    )
    runs = []
    for motion in (PrescribedMotion(joint="j1", amplitude=0.4, frequency=2.0), given):
        system, y = closed("spherical", 6, base="fixed", drives={"motor": motion})
        nq, nv = system.model.nq, system.model.nv
        # Steps as long with both: functions do not say how long they may be.
        settings = RunSettings(max_step=0.01)
        runs.append(simulate(system, duration=0.1, q=y[:nq], v=y[nq : nq + nv], settings=settings))
    for name in ("q", "v", "drive_torque", "drive_work", "closure_force"):
        compiled, python = (one.data[name].values for one in runs)
        # Errors of the default tolerance, 1e-8, and round-off of the functions.
        assert python == pytest.approx(compiled, abs=1e-9 * np.abs(compiled).max())
