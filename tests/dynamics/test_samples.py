"""What is recorded at a sample is what the equations of motion give there, one state at a time."""

import numpy as np
import pytest

from antenna_pin import RunSettings, System, load_scenario, simulate
from antenna_pin.dynamics import Workspace, audit, observed
from antenna_pin.elements import CallableDrive
from antenna_pin.run.simulation.loop import Run
from antenna_pin.scenario.assemble import build_system, initial_state


@pytest.fixture(scope="module", params=["closed-form", "coal", "distributed"])
def run(request):
    changes = ["clearance.elevation.geometry=closed-form"]
    if request.param == "coal":
        changes = []
    elif request.param == "distributed":
        changes += ["clearance.elevation.load=distributed"]
    scenario = load_scenario("bai2020", case="case3", overrides=changes)
    system = build_system(scenario)
    run = Run(system, system.state(*initial_state(scenario, system)), 0.04, RunSettings())
    run.advance()
    return run


def test_samples_are_evaluated_as_single_states_are(run):
    """The compiled pass, and the calls of Python where coal is asked, against workspace and audit."""
    samples, system = run.samples, run.system
    times, states, memories = samples.times, samples.states, samples.memories
    found = observed(system, times, states, memories, samples.programs)
    workspace = Workspace(system)
    rates = np.zeros(system.model.nv + system.manifold.nx)
    touched = 0
    for i in range(0, len(times), 3):
        workspace.memory[:] = memories[i]
        workspace.measure(states[i])
        workspace.derivative(times[i], states[i], rates)
        scale = np.abs(rates[: system.model.nv]).max()
        # Pinocchio sums in another order when it evaluates many states in one call.
        assert found.acceleration[i] == pytest.approx(rates[: system.model.nv], rel=0.0, abs=1e-11 * scale)
        one = audit(workspace, states[i])
        assert found.energy[i] == pytest.approx(one.energy, rel=1e-15)  # another order of the sum
        for name in found.audit.dtype.names:
            assert np.array_equal(found.audit[name][i], getattr(one, name))
        # Of all contacts, those apart too: the very same arithmetic.
        for seen, row in zip(found.contact[i], workspace.table, strict=False):
            assert (seen["gap"], seen["depth_rate"]) == (row["gap"], row["rate"])
            assert np.array_equal(seen["contact_point"], row["point"])
        touched += one.contacts > 0.0
    assert touched > 3


def test_the_torque_of_a_drive_in_python_is_recorded_as_it_acted():
    """It sees time, angle and rate; the program itself holds no value for it."""
    built = build_system(load_scenario("bai2020", case="case1"))
    joint = "azimuth"

    def torque(t, angle, rate):
        return 0.3 * np.cos(7.0 * t) - 0.2 * angle - 0.1 * rate

    system = System(built.mechanism, drives={"own": CallableDrive(joint=joint, torque=torque)})
    data = simulate(system, duration=0.3, settings=RunSettings(output_rate=50.0)).data
    motion = (data[f"motion_{name}"].sel(joint=joint).values for name in ("angle", "rate"))
    expected = torque(data["time"].values, *motion)
    assert np.ptp(expected) > 0.1
    # The same function of the same numbers.
    assert data["drive_torque"].sel(drive="own").values == pytest.approx(expected, rel=1e-14, abs=1e-15)
