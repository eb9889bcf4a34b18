"""What compiled code asks outside: answered, refused, raised; and nothing of a run outlives it."""

import gc
import weakref

import numpy as np
import pytest

from antenna_pin import RunSettings, load_scenario
from antenna_pin.dynamics import Workspace
from antenna_pin.errors import FunctionError
from antenna_pin.integrate import METHODS
from antenna_pin.run.engine import Compiled, CompiledStepper
from antenna_pin.run.simulation.loop import Run
from antenna_pin.scenario.assemble import build_system, initial_state


def made(case="case1", *overrides):
    """A stepper of the antenna by Pinocchio's engine, in its first state."""
    scenario = load_scenario("bai2020", case=case, overrides=list(overrides))
    system = build_system(scenario)
    workspace, components = Workspace(system), 2 * system.manifold.nv + system.manifold.nx
    compiled = Compiled(workspace, "pinocchio")
    stepper = CompiledStepper(workspace, compiled, METHODS["rk4"], np.ones(components), 1.0)
    y = system.state(*initial_state(scenario, system))
    stepper.restart(0.0, y)
    return stepper, y


@pytest.mark.parametrize("error", [MemoryError(), KeyboardInterrupt(), FunctionError("f", "t", "a", "b")])
def test_what_is_raised_outside_is_raised_where_the_step_was_asked_for(error):
    """And once it is, the next step is what it would have been."""
    stepper, y = made()
    stepper.attempt(1e-4)
    expected = stepper.y.copy()
    asked, kept = [], int(stepper.numbers.outside.asked["acceleration"][0])

    def fail(t):
        asked.append(t)
        raise error

    stepper.answers.give("acceleration", fail)
    with pytest.raises(type(error)):
        stepper.attempt(1e-4)
    assert len(asked) == 1  # of the four stages: nothing is asked once something could not be answered
    stepper.numbers.outside.asked["acceleration"] = kept
    stepper.attempt(1e-4)
    assert (stepper.y == expected).all()


def test_a_step_by_pinocchio_is_the_compiled_trees_to_round_off():
    stepper, y = made()
    workspace = stepper.problem
    tree = CompiledStepper(
        workspace, Compiled(workspace, "compiled"), METHODS["rk4"], stepper.scales, stepper.rtol
    )
    for one in (stepper, tree):
        one.restart(0.0, y)
        one.attempt(1e-3)
    assert (stepper.y != tree.y).any()  # two algorithms
    # Round-off of accelerations of some 10 rad/s^2, over a step of 1 ms.
    assert stepper.y == pytest.approx(tree.y, abs=1e-14)


@pytest.mark.parametrize("geometry", ["coal", "closed-form"])
def test_a_runs_memory_is_free_when_the_run_is(geometry):
    """Functions that machine code calls hold what they look at, and nothing holds them but the run."""
    scenario = load_scenario("bai2020", case="case3", overrides=[f"clearance.elevation.geometry={geometry}"])
    system = build_system(scenario)
    run = Run(system, system.state(*initial_state(scenario, system)), 1e-4, RunSettings())
    run.advance()
    gone = weakref.ref(run.workspace), weakref.ref(run.stepper)
    del run
    gc.collect()
    assert [one() for one in gone] == [None, None]
