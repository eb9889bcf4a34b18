"""Runs with Pinocchio's and coal's machine code called by address are those by Python, to the last bit."""

import gc
import os
import signal
import threading
import weakref
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from antenna_pin import Outcome, build_system, load_scenario, simulate
from antenna_pin.dynamics import Workspace
from antenna_pin.dynamics.by_pinocchio import machine_code_of
from antenna_pin.errors import FunctionError
from antenna_pin.run.engine import Compiled
from antenna_pin.scenario.assemble import initial_state

#: Model, case, overrides and span [s]: a tree, loops in the plane and in space, round and flanged joints.
RUNS = [
    ("bai2020", "case3", (), 0.05),
    ("slider_crank", "friction", (), 2e-3),
    ("slider_crank", "3d-friction", (), 2e-3),
    ("chen2021", "friction-010", (), 2e-3),
    ("spherical_pendulum", None, (), 0.02),
    ("slider", None, ("clearance.slide.geometry=coal",), 0.02),
]


def numbers_of(run):
    """Return all numbers of a result, by name."""
    return {name: run.data[name].values.tobytes() for name in run.data if run.data[name].dtype.kind in "fiub"}


@pytest.mark.parametrize(("model", "case", "changes", "span"), RUNS, ids=lambda one: str(one))
def test_a_run_is_the_same_both_ways(model, case, changes, span, both_ways):
    scenario = load_scenario(model, case=case, overrides=list(changes))
    native, python = both_ways(lambda: simulate(scenario, duration=span))
    assert native.counts.evaluations == python.counts.evaluations
    expected = numbers_of(python)
    found = numbers_of(native)
    assert found.keys() == expected.keys()
    assert [name for name in expected if found[name] != expected[name]] == []


@pytest.mark.parametrize(("model", "case"), [("bai2020", "case3"), ("slider_crank", "friction")])
def test_nothing_of_a_default_run_is_called_in_python(model, case, shim):
    """Without it the interpreter's lock would be taken in each evaluation."""
    system = build_system(load_scenario(model, case=case))
    compiled = Compiled(Workspace(system), "pinocchio")
    assert not any(map(compiled.answers.asks, ("elements", "acceleration", "terms", "gaps", "forces")))


def test_runs_in_threads_are_those_on_their_own(shim):
    """Evaluators of machine code belong to one run each."""
    scenarios = [
        load_scenario("bai2020", case="case3", overrides=[f"clearance.elevation.normal.restitution={e}"])
        for e in (0.6, 0.7, 0.8, 0.9)
    ]

    def run(scenario):
        return numbers_of(simulate(scenario, duration=0.02))

    alone = list(map(run, scenarios))
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(run, scenarios)) == alone
    assert len({one["v"] for one in alone}) == len(alone)


def test_an_exception_of_coal_in_machine_code_ends_the_run_with_what_it_has(shim, monkeypatch):
    """At the first contact, since nothing is asked before."""
    scenario = load_scenario("bai2020", case="case3")
    whole = simulate(scenario, duration=0.05)
    monkeypatch.setattr(shim, "distances", shim.fail)
    run = simulate(scenario, duration=0.05)
    assert run.outcome is Outcome.FUNCTION_FAILED
    assert "asked to fail" in run.message
    end = run.data["time"].values[-1]
    assert 0.0 < end < 0.05
    begun = whole.data["touching"].values.any(axis=1)
    assert end <= whole.data["time"].values[begun][0]


def test_an_exception_of_pinocchio_in_machine_code_ends_the_run(shim, monkeypatch):
    def failing(*arguments):
        evaluator, *_ = machine_code_of(*arguments)
        return evaluator, shim.fail, shim.fail

    monkeypatch.setattr("antenna_pin.run.engine.compiled.machine_code_of", failing)
    for model, case in (("bai2020", "case3"), ("slider_crank", "friction")):
        with pytest.raises(FunctionError, match="Pinocchio .* asked to fail"):
            simulate(load_scenario(model, case=case), duration=1e-3)


def test_the_memory_of_a_run_in_machine_code_is_free_when_the_run_is(shim):
    system = build_system(load_scenario("bai2020", case="case3"))
    workspace = Workspace(system)
    compiled = Compiled(workspace, "pinocchio")
    (path,) = workspace.paths
    gone = weakref.ref(workspace), weakref.ref(path.queried.evaluator)
    del workspace, compiled, path
    gc.collect()
    assert [one() for one in gone] == [None, None]


def test_a_right_hand_side_in_python_is_the_same_both_ways(both_ways):
    """``Workspace.derivative`` and ``measure``, which readings and monitors use."""
    scenario = load_scenario("bai2020", case="case3")
    system = build_system(scenario)
    y = system.state(*initial_state(scenario, system))
    memory = np.array([[1.0, 0.01, 1.0], [0.0, 0.0, 0.0], [1.0, 0.01, 1.0], [0.0, 0.0, 0.0]])

    def rates():
        workspace, found = Workspace(system, memory), np.zeros(system.model.nv + system.manifold.nx)
        workspace.derivative(0.05, y, found)
        workspace.measure(y)
        return found.tobytes(), workspace.table.tobytes()

    native, python = both_ways(rates)
    assert native == python


def test_ctrl_c_while_machine_code_runs_ends_a_run_with_what_it_has(shim):
    """The signal comes within a batch of steps, most likely; progress is reported up to then."""
    reports = []
    threading.Timer(0.6, os.kill, (os.getpid(), signal.SIGINT)).start()
    run = simulate(load_scenario("bai2020", case="case3"), duration=1000.0, progress=reports.append)
    assert run.outcome is Outcome.INTERRUPTED
    assert 0.0 < reports[0].time < reports[-1].time <= run.data["time"].values[-1] < 1000.0
    assert len({one.wall for one in reports}) > 3
