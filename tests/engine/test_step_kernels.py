"""Steps by single kernels: closures held (close), samples of a step (accept), implicit steps counted."""

import numpy as np
import pinocchio as pin
import pytest
from branches import closed
from plain_kernels import plain

from antenna_pin import RunSettings, System, Urdf, build_mechanism
from antenna_pin.dynamics import Workspace
from antenna_pin.dynamics.constraints.layout_kernels import found_in
from antenna_pin.dynamics.constraints.rows_kernels import write_rows
from antenna_pin.elements import CallableDrive, JointSpring
from antenna_pin.integrate import METHODS
from antenna_pin.run.engine import Compiled, CompiledStepper
from antenna_pin.run.engine.hold_kernels import close
from antenna_pin.run.simulation.loop import Run

CART = """<robot name="rail"><link name="rail"/>
<link name="cart"><inertial><mass value="2"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="slide" type="prismatic"><parent link="rail"/><child link="cart"/><axis xyz="1 0 0"/>
<limit lower="-9" upper="9" effort="9" velocity="9"/></joint></robot>"""


def cart(**more):
    return System(build_mechanism(Urdf.from_text(CART, "rail.urdf"), base="fixed"), **more)


@pytest.mark.parametrize("kind", ["spherical", "universal"])
def test_hold_closes_a_state_in_place_and_speed(kind):
    """``close`` takes a state a millimetre off, one row of several, back onto its closure; others stand."""
    system, y = closed(kind, 3)
    numbers, nq, rng = (
        Compiled(Workspace(system), "compiled").numbers,
        system.model.nq,
        np.random.default_rng(0),
    )
    off = y.copy()
    off[:nq] = pin.integrate(system.model, y[:nq], 1e-3 * rng.normal(size=system.model.nv))
    off[nq : nq + system.model.nv] += 1e-2 * rng.normal(size=system.model.nv)
    rows = np.array([y, off, y])

    def gaps():
        plain(write_rows)(0.0, rows[1], numbers.program, numbers.plan, numbers.held)
        found = plain(found_in)(numbers.plan, numbers.held)
        return np.array([found[name] for name in ("gap", "turn", "speed", "spin")])

    assert gaps().max() > 1e-4
    assert plain(close)(0.0, rows, 1, system.manifold.layout, numbers)
    # Round-off of places and speeds of some metres.
    assert gaps() == pytest.approx(0.0, abs=1e-12)
    assert abs(rows[1] - off).max() < 0.1 and (rows[[0, 2]] == y).all()


def test_chosen_output_times_are_sampled_in_the_step_that_they_are_in():
    """``accept`` of a stretch of steps: samples of a free oscillator at the rate, chosen and at the end."""
    stiffness, mass, times = 50.0, 2.0, (0.013, 0.05, 0.21, 0.25, 0.4, 0.499)  # [N/m], [kg], [s]
    system = cart(springs={"slide": JointSpring(joint="slide", stiffness=stiffness)})
    settings = RunSettings(
        engine="compiled", output_rate=4.0, output_times=times, max_step=0.05, rtol=1e-10
    )  # many steps to each sample, several samples to some steps
    run = Run(system, system.state([0.1], [0.3]), 0.5, settings)
    run.advance()
    t, states = np.array(run.samples.times), np.array(run.samples.states)
    assert t == pytest.approx([0.0, *times, 0.5], rel=1e-12)
    omega = np.sqrt(stiffness / mass)
    place = 0.1 * np.cos(omega * t) + 0.3 / omega * np.sin(omega * t)
    rate = 0.3 * np.cos(omega * t) - 0.1 * omega * np.sin(omega * t)
    assert states[:, :2] == pytest.approx(np.column_stack([place, rate]), abs=1e-10)


def test_evaluations_of_an_implicit_step_are_the_calls_of_a_drive_in_python():
    """``attempt_implicit`` counts how often forces are evaluated: once for each call of a torque."""
    calls = []

    def torque(t, angle, rate):
        calls.append(t)
        return -3.0 * angle**3 - 0.1 * rate

    system = cart(drives={"push": CallableDrive(joint="slide", torque=torque)})
    workspace, components = Workspace(system), 2 * system.manifold.nv + system.manifold.nx
    compiled = Compiled(workspace, "pinocchio")
    stepper = CompiledStepper(workspace, compiled, METHODS["radau5"], np.ones(components), 1e-8)
    stepper.restart(0.0, system.state([0.1], [0.3]))
    for h in (0.05, 0.2):
        calls.clear()
        before = stepper.evaluations
        stepper.attempt(h)
        assert stepper.evaluations - before == len(calls) > 5
