"""A run is the same bit for bit however it is interrupted: a property, over scenarios drawn at random.

What is drawn: mechanism, base, joints with play, normal and friction laws (those that remember an approach
speed or a bristle among them, and those of effective masses), loads, backends, drives, springs; or a shipped
mechanism with closed loops, motions that are given, flexible links; then method, engine, what is sampled,
events that change a drive, and at how many steps the run is killed or asked to stop. It goes on from the
checkpoint file each time.
"""

import importlib
from pathlib import Path

import numpy as np
import pytest
from interruptions import in_pieces, same

from antenna_pin import Trajectory, load_scenario, simulate
from antenna_pin.elements import Motion
from antenna_pin.run.simulation import Set, Time, checkpoint
from antenna_pin.run.simulation.events import Event
from antenna_pin.scenario.clearance import TouchingSpec

pytestmark = pytest.mark.filterwarnings("ignore::antenna_pin.run.simulation.CheckpointsWaitedWarning")

METHODS = ("rk4", "bogacki-shampine-32", "dormand-prince-54", "dormand-prince-853", "radau5")
#: Scenario, case, span [s], what is set besides.
SHIPPED = (
    ("slider_crank", "clearance-200um", 2e-3, ()),
    ("slider_crank", "ideal-constraint", 4e-3, ()),
    ("slider_crank", "3d-friction", 1e-3, ()),
    ("chen2021", "friction-010", 4e-3, ()),
    ("chen2021", "tanh", 4e-3, ()),
    ("bai2020", "flexible", 0.03, ()),
    ("bai2020", "petals", 0.03, ()),
    ("bai2020", "case1-constraint", 0.05, ()),
    ("you2010", "wings", 0.02, ()),
    ("you2010", "gimbal-3d", 0.02, ()),
    ("spherical_pendulum", "spatial", 0.02, ()),
    ("slider", "driven", 0.02, ()),
)


@pytest.fixture
def draw_scenario(monkeypatch):
    monkeypatch.syspath_prepend(str(Path(__file__).parents[2] / "scripts" / "check"))
    return importlib.import_module("scenario_generator").draw_scenario


def drawn(draw_scenario, number):
    """Return a scenario, its span [s], events, and the rest of the random numbers."""
    rng = np.random.default_rng([14, number])
    if number % 3 == 2:
        name, case, span, changes = SHIPPED[number // 3 % len(SHIPPED)]
        scenario = load_scenario(name, case=case, overrides=changes)
    else:
        scenario = draw_scenario(14, number)
        span = 0.2 * scenario.duration
    method = METHODS[int(rng.integers(len(METHODS)))]
    changes = {"integrator.method": method, "output.rate": 40.0 / span, "integrator.rtol": 1e-5}
    touching = [name for name, spec in scenario.clearance.items() if isinstance(spec, TouchingSpec)]
    if rng.random() < 0.7:
        changes |= {f"clearance.{name}.geometry": "closed-form" for name in touching}
        changes["integrator.engine"] = "compiled" if rng.random() < 0.6 else "pinocchio"
    if method == "rk4":
        changes["integrator.step"] = 1e-3 * span
    if rng.random() < 0.2:
        changes["output.form"] = "lean"
    scenario = scenario.with_overrides(changes)
    events = []
    # A prescribed motion holds all the time.
    drives = sorted(name for name, drive in scenario.drives.items() if not isinstance(drive.build(), Motion))
    if drives and rng.random() < 0.7:
        place = f"drives.{rng.choice(drives)}.on"
        times = np.sort(rng.uniform(0.0, span, 2)).tolist()
        events = [
            Event(name=f"switch {k}", when=Time(time), action=Set(place, k % 2 == 1))
            for k, time in enumerate(times)
        ]
    return scenario, span, events, rng


@pytest.mark.parametrize(
    "number", [*range(10), *(pytest.param(k, marks=pytest.mark.slow) for k in range(10, 240))]
)
def test_however_a_run_is_interrupted_it_ends_the_same(
    draw_scenario, number, tmp_path, small_parts, monkeypatch
):
    monkeypatch.setattr(checkpoint, "_TIMES", 0.0)  # many checkpoints, whatever they cost
    scenario, span, events, rng = drawn(draw_scenario, number)
    seen = []
    whole = simulate(scenario, duration=span, events=events, progress=seen.append)
    times = int(rng.integers(1, 8))
    looks = max(2, 2 * len(seen) // times)
    more = {"looks": looks, "checkpoint": 10.0 ** rng.uniform(-4.0, -1.5), "events": events}
    pieces = in_pieces(scenario, span, tmp_path / "run.nc", rng, times, **more)
    same(whole, pieces)
    same(Trajectory.load(tmp_path / "run.nc"), Trajectory.load(whole.save(tmp_path / "whole.nc")))
