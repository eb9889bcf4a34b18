"""A run in parts is the run in one, bit for bit; runs of one system do not see each other."""

import dataclasses
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from antenna_pin import RunSettings, Trajectory, load_scenario, simulate
from antenna_pin.base.state import State
from antenna_pin.contact import CustomNormal, Hertz
from antenna_pin.contact.onset import NO_APPROACH
from antenna_pin.dynamics import System, Workspace, acceleration, contact_memory
from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.run.simulation.loop import Run
from antenna_pin.scenario.assemble import build_system, initial_state

METHODS = ("rk4", "bogacki-shampine-32", "dormand-prince-54", "dormand-prince-853", "radau5")
LAWS = {
    "as shipped": (),
    "tsuji": ("clearance.elevation.normal={law='tsuji', restitution=0.8, replace=true}",),
    "bristles": (
        "clearance.elevation.friction={law='lugre', static=0.2, dynamic=0.1, stribeck_speed='1 mm/s',"
        " bristle_stiffness=1e5, replace=true}",
    ),
    "distributed": ("clearance.elevation.load=distributed",),
}


def antenna(*overrides, case="case3", geometry="closed-form"):
    return load_scenario(
        "bai2020", case=case, overrides=[f"clearance.elevation.geometry={geometry}", *overrides]
    )


def same(whole, later):
    """Whether the later part of a run, from its first sample on, is the end of the whole one, bit for bit."""
    begin = later.data["time"].values[0]
    expected = whole.data.sel(time=slice(begin, None))
    common = np.intersect1d(expected["time"].values, later.data["time"].values)
    # Peaks of contacts that end in the first part are samples of that.
    assert len(common) >= len(later.data["time"]) - 8 and len(common) > 10
    for name in ("q", "v", "a", "normal_force", "touching", "motion_angle"):
        a, b = (run[name].sel(time=common).values for run in (expected, later.data))
        assert np.array_equal(a, b), name
    ended = whole.data["release_time"].values > begin
    ended |= np.isnan(whole.data["release_time"].values)
    for name in ("onset_time", "release_time", "peak_force", "peak_depth", "impulse", "dissipated"):
        a, b = whole.data[name].values[ended], later.data[name].values
        assert np.array_equal(a, b, equal_nan=True), name
    assert whole.end == later.end


@pytest.mark.parametrize(
    ("changes", "geometry"),
    [(LAWS[law], geometry) for law in LAWS for geometry in ("closed-form", "coal")]
    + [((f"integrator.method={method}", "integrator.rtol=1e-6"), "closed-form") for method in METHODS],
)
def test_two_halves_are_the_whole(changes, geometry):
    asked = antenna(*changes, geometry=geometry)
    span = 0.06 if geometry == "closed-form" else 0.04
    whole = simulate(asked, duration=span)
    first = simulate(asked, duration=0.4 * span)
    later = simulate(asked, duration=span - first.end.reached, start=first.end)
    assert whole.completed and later.completed
    same(whole, later)


def test_a_law_in_python_goes_on_too():
    """Planar, with a Python function: another path through the loop."""
    hertz = Hertz(stiffness=1e10)
    law = CustomNormal(
        force=lambda depth, rate, speed: hertz.force(depth, 0.0, 1.0) * (1.0 + 0.2 * rate / speed),
        elastic_force=hertz.elastic_force,
        elastic_energy=hertz.elastic_energy,
    )
    made = build_system(load_scenario("impact_pair", case="planar"))
    joint = dataclasses.replace(made.clearances[0], radial=law, axial=None)
    system = System(made.mechanism, clearances=[joint])
    q, v = initial_state(load_scenario("impact_pair", case="planar"), made)
    settings = RunSettings(output_rate=1e4)
    whole = simulate(system, duration=0.01, q=q, v=v, settings=settings)
    # In the middle of the first contact.
    middle = 0.5 * float(whole.data["onset_time"][0] + whole.data["release_time"][0])
    first = simulate(system, duration=middle, q=q, v=v, settings=settings)
    same(whole, simulate(system, duration=0.01 - first.end.reached, start=first.end, settings=settings))


def test_interrupted_a_hundred_times_it_is_still_the_whole():
    """Between any two steps, in contact and out of it; the state sent through text each time."""
    asked = antenna()
    settings = RunSettings(output_rate=1000.0)
    system = build_system(asked)
    y = system.state(*initial_state(asked, system))
    whole = Run(system, y, 0.06, settings)
    whole.advance()
    rng, steps = np.random.default_rng(4), whole.steps.accepted
    stops = np.sort(rng.choice(np.arange(1, steps), size=100, replace=False))
    start, made = y, 0
    for stop in [*stops.tolist(), None]:
        run = Run(system, start, 0.06, settings, singly=True)
        run.advance(
            interrupted=lambda run=run, made=made, stop=stop: (
                stop is not None and run.steps.accepted + made >= stop
            )
        )
        made = stop if stop is not None else made
        start = State.from_json(run.state.to_json())
        assert start == run.state
    assert start == whole.state


def test_runs_of_one_system_do_not_see_each_other():
    """Step by step in turns, and in threads, they are what they are alone."""
    asked = antenna()
    system = build_system(asked)
    y = system.state(*initial_state(asked, system))
    other = y.copy()
    other[system.model.nq + system.model.nv - 4] += 0.01  # the journal starts with another twist

    def run(start):
        one = Run(system, start, 0.03, RunSettings())
        one.advance()
        return one.state

    alone = [run(y), run(other)]
    assert alone[0] != alone[1]
    in_turns = [Run(system, start, 0.03, RunSettings(), singly=True) for start in (y, other)]
    while any(one.stepper.t < 0.03 for one in in_turns):
        for one in in_turns:
            if one.stepper.t < 0.03:
                one._step()
    for one, expected in zip(in_turns, alone, strict=True):
        assert np.array_equal(one.state.y, expected.y) and np.array_equal(one.state.memory, expected.memory)
    with ThreadPoolExecutor(2) as pool:
        assert list(pool.map(run, (y, other))) == alone


def test_a_result_file_holds_where_its_run_can_go_on(tmp_path):
    asked = antenna()
    first = simulate(asked, duration=0.02)
    loaded = Trajectory.load(first.save(tmp_path / "first.nc"))
    assert loaded.end == first.end
    assert simulate(asked, duration=0.01, start=loaded.end).end == simulate(asked, duration=0.03).end


def test_the_ledger_of_a_part_is_its_own():
    asked = antenna("integrator.rtol=1e-10")
    first = simulate(asked, duration=0.03)
    later = simulate(asked, duration=0.03, start=first.end)
    assert later.data["time"].values[0] == 0.03
    assert later.data["drive_work"].values[0].tolist() == [0.0, 0.0]
    assert later.summary()["conservation"]["energy_error"] < 1e-9


def test_a_state_in_the_material_gets_its_memory_by_the_rule():
    """Without a memory contacts with a gap of zero or less touch; 20 um deep they have no approach speed."""
    asked = antenna("initial.joints.elevation.journal_position=[0.22e-3, 0, 0]")
    system = build_system(asked)
    q, v = initial_state(asked, system)
    pressed = acceleration(system, 0.0, q, v)
    untouched = acceleration(system, 0.0, q, v, np.zeros((4, 3)))
    assert np.abs(pressed - untouched).max() > 100.0
    memory = contact_memory(system, system.state(q, v))
    assert memory[:, 0].tolist() == [1.0, 1.0, 0.0, 0.0]
    assert (memory[:2, 1] == NO_APPROACH).all() and (memory[:2, 2] > 1.0).all()
    y, rates = system.state(q, v), np.zeros(system.model.nv + system.manifold.nx)
    Workspace(system, memory).derivative(0.0, y, rates)
    assert np.array_equal(rates[: system.model.nv], pressed)


@pytest.mark.parametrize("law", ["lankarani-nikravesh", "hu-guo"])
def test_a_start_in_the_material_presses_out_without_loss(law):
    """1 um deep at rest: all that the spring holds is motion at the release, whatever the restitution."""
    changes = [f"clearance.bore.normal.law={law}", "clearance.bore.normal.restitution=0.3"]
    place, rate = "initial.joints.bore.journal_position", "initial.joints.bore.journal_velocity"
    changes += ["clearance.bore.geometry=closed-form", "integrator.engine=compiled", f"{rate}=[0, 0, 0]"]
    deep = simulate(
        load_scenario("impact_pair", overrides=[*changes, f"{place}=[0.101e-3, 0, 0]"]), duration=1e-3
    ).data
    released = deep["release_time"].values
    assert np.isfinite(released[0])
    stored, moving = (deep[name].values for name in ("contact_energy", "kinetic_energy"))
    # The tolerance of the run.
    assert moving[-1] == pytest.approx(stored[0], rel=1e-7) and stored[0] > 0.0
    assert abs(float(deep["total_normal_loss"].values[0])) < 1e-9 * stored[0]


def test_refusals():
    asked = antenna()
    end = simulate(asked, duration=1e-3).end
    with pytest.raises(InvalidParameterError, match="simulate: q must be omitted if start is given"):
        simulate(asked, duration=1e-3, start=end, q=end.q)
    other = simulate(load_scenario("impact_pair"), duration=1e-3).end
    with pytest.raises(InvalidParameterError, match=r"start.q must be that of a run of this system, 15"):
        simulate(asked, duration=1e-3, start=other)
    with pytest.raises(AntennaPinError, match="state: must be one that a run wrote"):
        State.from_json("{}")
