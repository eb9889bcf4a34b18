"""Forces on links of mechanisms of every make: in loops, behind joints with play, on flexible hubs."""

from pathlib import Path

import numpy as np
import pytest
from numba import njit

from antenna_pin import System, load_scenario, simulate
from antenna_pin.elements import CallableElement, OutsideForce, Thruster
from antenna_pin.run.simulation.inputs import settings_of
from antenna_pin.scenario.assemble import build_system, initial_state

EXAMPLES = Path(__file__).parents[2] / "scripts" / "examples"


def with_forces(system, **forces):
    """A system with forces beside what it has."""
    others = {table: system.families[table] for table in system.others}
    springs = {name: one for name, one in system.springs.items() if name not in system.elastic}
    return System(
        system.mechanism,
        clearances=system.clearances,
        drives=system.drives,
        springs=springs,
        held=system.held,
        closures={name: one for name, one in system.closures.items() if name not in system.held},
        elements={**others, "forces": forces},
        elastic=system.elastic,
    )


def run_of(scenario, duration, **forces):
    system = build_system(scenario)
    q, v = initial_state(scenario, system)
    return simulate(
        with_forces(system, **forces), duration=duration, q=q, v=v, settings=settings_of(scenario)
    )


def pulled(t, p, links, joints, states, whole):
    for k in range(3):
        links[1].force[k] = -p[0] * (links[1].place[k] - links[0].place[k])
        whole.energy += 0.5 * p[0] * (links[1].place[k] - links[0].place[k]) ** 2


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_ledgers_close_where_a_joint_has_play(engine):
    """The antenna with its elevation joint loose: a jet on the dish, drag on the base, through impacts."""
    scenario = load_scenario(
        "bai2020", case="case3", overrides=[f"integrator.engine={engine}", "integrator.rtol=1e-9",
                                            "clearance.elevation.geometry=closed-form"],
    )  # fmt: skip
    links = [link.name for link in build_system(scenario).mechanism.urdf.robot.links]
    jet = Thruster(
        at=(links[-1], (0.1, 0.0, 0.2)), direction=(1, 0, 0), thrust=5.0, starts=(0.01,), durations=(0.02,)
    )
    drag = OutsideForce(at=(links[0], (0.0, 0.1, 0.0)), force=(0.0, -2.0, 1.0), axes="world")
    run = run_of(scenario, 0.05, jet=jet, drag=drag)
    assert run.completed and len(run.data["onset_time"]) > 0
    kept = run.summary()["conservation"]
    # Those of the same run without forces are of this size.
    assert kept["energy_error_relative"] < 1e-6
    assert kept["linear_momentum_drift_relative"] < 1e-8
    assert kept["angular_momentum_drift_relative"] < 1e-8
    assert np.linalg.norm(run.data["total_impulse"].sel(force="jet")) == pytest.approx(5.0 * 0.02, rel=1e-2)


@pytest.mark.parametrize(
    "compiled", [pytest.param(False, marks=pytest.mark.slow, id="plain"), pytest.param(True, id="compiled")]
)
def test_the_ledger_closes_in_a_loop(compiled):
    """A slider-crank whose closure is corrected at every step, with a spring that a function makes.

    What corrections put in is booked with the spring's energy before and after, in Python as compiled.
    """
    engine = "compiled" if compiled else "pinocchio"
    scenario = load_scenario("slider_crank", case="ideal", overrides=[f"integrator.engine={engine}"])
    names = [link.name for link in build_system(scenario).mechanism.urdf.robot.links]
    spring = CallableElement(
        act=njit(pulled) if compiled else pulled,
        links=(("world", (0.2, 0.3, 0.1)), (names[-1], (0.05, 0.0, 0.0))),
        parameters={"k": 40.0},
        internal=True,
        passive=True,
    )
    push = OutsideForce(at=(names[-1], (0.0, 0.0, 0.0)), force=(3.0, 1.0, 2.0))
    run = run_of(scenario, 0.1, it=spring, push=push)
    assert run.completed
    data = run.data
    assert np.ptp(data["force_energy"].sel(force="it").values) > 1e-3
    assert abs(data["total_force_work"].sel(force="push").item()) > 1e-3
    # The run's tolerance; without what corrections put in it is larger.
    assert run.summary()["conservation"]["energy_error_relative"] < 1e-6


def test_ledgers_close_on_a_flexible_hub():
    """A panel that bends at its root, pushed at its hub and by a jet on the base."""
    scenario = load_scenario(
        EXAMPLES / "flexible_panel" / "scenario.toml", overrides=["integrator.rtol=1e-9"]
    )
    links = [link.name for link in build_system(scenario).mechanism.urdf.robot.links]
    push = OutsideForce(
        at=("panel", (0.0, 0.0, -0.3)), force=(2.0, 0.0, 0.0), torque=(0.0, 0.1, 0.0), frequency=7.0
    )
    jet = Thruster(
        at=(links[0], (0.1, 0, 0)), direction=(0, 0, 1), thrust=3.0, starts=(0.1,), durations=(0.1,)
    )
    run = run_of(scenario, 0.5, push=push, jet=jet)
    kept = run.summary()["conservation"]
    assert run.completed and kept["energy_error_relative"] < 1e-7
    assert kept["linear_momentum_drift_relative"] < 1e-8
    assert kept["angular_momentum_drift_relative"] < 1e-8
    # And it does swing under that.
    assert run.data["peak_deflection"].max() > 1e-4
