"""Elements with modes: rigid stops and latches against closed forms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from single_loops import four_bar

from antenna_pin import RunSettings, Scenario, load_scenario, simulate
from antenna_pin.dynamics import System
from antenna_pin.elements import ConstantDrive, JointSpring, RigidLatch, RigidStop
from antenna_pin.errors import AntennaPinError, InvalidParameterError, ScenarioError
from antenna_pin.mechanism import Urdf, build_mechanism
from antenna_pin.run.simulation import Event, Set, Time
from antenna_pin.run.simulation.checkpoint import Checkpoint
from antenna_pin.run.simulation.loop import Run
from antenna_pin.studies.linear import modes
from tests.simulation.test_latches import BODIES

G = 9.81
TIGHT = RunSettings(rtol=1e-11, max_step=0.05, output_rate=50.0)


def _system(kind: str = "revolute", *, base="free", gravity=(0, 0, 0), text=BODIES, **more) -> System:
    urdf = Urdf.from_text(text.format(type=kind), "two.urdf")
    return System(build_mechanism(urdf, base, gravity), **more)


def _ball(stop: RigidStop, **more) -> System:
    """A body that falls along its joint: z points up."""
    text = BODIES.replace('rpy="0.3 0.2 0"', "")
    return _system(
        "prismatic", base="fixed", gravity=(0, 0, -G), text=text, elements={"stops": {"j": stop}}, **more
    )


def test_a_ball_bounces_when_it_should_and_comes_to_rest() -> None:
    """Bounces of a body on a floor: at t0 (1 + 2 e + 2 e^2 + ...); below the rest rate it rests."""
    e, height = 0.6, 1.0
    run = simulate(
        _ball(RigidStop(joint="j", lower=0.0, restitution=e, rest_rate=0.01)),
        q=[height],
        v=[0.0],
        duration=2.5,
        settings=TIGHT,
    )
    first = np.sqrt(2 * height / G)
    speed = first * G
    times = [first]
    while speed * e ** (len(times) - 1) > 0.01:
        times.append(times[-1] + 2 * first * e ** len(times))
    # Free fall is a polynomial, which the method integrates to round-off; so are the bounces' times.
    assert np.allclose(run.data.change_time, times, rtol=0.0, atol=1e-10)
    assert list(run.data.change.values[-1:]) == ["stop j: lower: rests"]
    assert abs(run.data.q.values[-1, 0]) < 1e-15
    assert abs(run.data.v.values[-1, 0]) < 1e-15
    # All the energy of the fall is lost: 2 kg.
    assert float(run.data.total_element_loss[0]) == pytest.approx(2.0 * G * height, rel=1e-10)
    assert np.abs(run.data.energy_error).max() < 1e-9
    # At rest the stop carries the weight.
    assert float(run.data.element_effort[-1, 0]) == pytest.approx(2.0 * G, rel=1e-12)


def test_a_stop_pushes_only() -> None:
    """A body at rest on its stop leaves when a drive has overcome the weight."""
    drive = ConstantDrive(joint="j", value=3.0 * G, on=False)
    run = simulate(
        _ball(RigidStop(joint="j", lower=0.0, restitution=0.5), drives={"d": drive}),
        q=[0.0],
        v=[0.0],
        duration=2.0,
        settings=TIGHT,
        events=[Event(name="up", when=Time(1.0), action=Set("drives.d.on", True))],
    )
    assert list(run.data.change.values) == ["stop j: lower: left"]
    assert float(run.data.change_time[0]) == 1.0
    # (3 - 2) g / 2 for a second.
    assert run.data.q.values[-1, 0] == pytest.approx(0.25 * G, rel=1e-10)


CHAIN = """<robot name="chain"><link name="base"><inertial><origin xyz="0.1 0 0.05"/><mass value="3"/>
<inertia ixx="0.4" iyy="0.5" izz="0.6" ixy="0.01" ixz="0" iyz="0"/></inertial></link>{links}</robot>"""
LINK = """<joint name="{name}" type="{type}"><parent link="{parent}"/><child link="{name}_body"/>
<origin xyz="0.4 0.1 0" rpy="0.3 0.2 0"/><axis xyz="0 0 1"/>
<limit lower="-9" upper="9" effort="1e9" velocity="1e9"/></joint><link name="{name}_body"><inertial>
<origin xyz="0.3 0.1 0"/><mass value="1.2"/>
<inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0" ixz="0.01" iyz="0"/></inertial></link>"""


def _chain(*kinds: str, base="free", gravity=(0, 0, 0), **more) -> System:
    parents = ["base", *(f"j{k}_body" for k in range(len(kinds)))]
    links = [LINK.format(name=f"j{k}", type=kind, parent=parents[k]) for k, kind in enumerate(kinds)]
    urdf = Urdf.from_text(CHAIN.format(links="".join(links)), "chain.urdf")
    return System(build_mechanism(urdf, base, gravity), **more)


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_several_stops_and_latches_keep_momentum_and_the_ledger(engine: str) -> None:
    """Bounces and locks of four joints on a free base: momentum to round-off, energy to the tolerance."""
    stops = {
        name: RigidStop(joint=name, lower=-0.5, upper=0.4, restitution=0.7) for name in ("j0", "j1", "j2")
    }
    latches = {
        "j3": RigidLatch(joint="j3", angle=0.3, greatest_rate=5.0),
        "j1": RigidLatch(joint="j1", angle=-0.2),
    }
    system = _chain(
        "revolute", "continuous", "prismatic", "revolute", elements={"stops": stops, "latches": latches}
    )
    v = np.array([0.1, 0.2, -0.1, 0.3, -0.2, 0.4, 0.9, 1.1, -0.6, 1.4])
    settings = RunSettings(rtol=1e-10, output_rate=100.0, engine=engine)
    run = simulate(system, v=v, duration=4.0, settings=settings)
    assert run.completed
    assert len(run.data.change) >= 5
    for name in ("linear", "angular"):
        momentum = run.data[f"{name}_momentum"].values
        assert np.abs(momentum - momentum[0]).max() <= 1e-9 * np.abs(momentum).max()
    assert np.abs(run.data.energy_error).max() <= 1e-8 * float(run.data.kinetic_energy[0])
    angles = run.data.motion_angle.values[:, :2]
    assert angles.max() <= 0.4 + 1e-9
    assert angles.min() >= -0.5 - 1e-9


def test_a_pendulum_settles_on_its_stop_and_hangs_there_for_an_hour() -> None:
    """Against an upper stop it comes to rest by chatter, and then stays to the last bit, by its weight."""
    stop = RigidStop(joint="j0", lower=-0.2, restitution=0.5, rest_rate=1e-4)
    system = _chain("revolute", base="fixed", gravity=(0, -9.81, 0), elements={"stops": {"j0": stop}})
    run = simulate(
        system, q=[0.6], v=[0.0], duration=3600.0, settings=RunSettings(output_rate=1.0, max_step=5.0)
    )
    assert run.completed
    assert list(run.data.change.values)[-1] == "stop j0: lower: rests"
    late = run.data.q.values[run.data.time.values > 20.0, 0]
    assert np.ptp(late) == 0.0
    assert abs(late[0] + 0.2) < 1e-14


def _loop(folder: Path, more: str) -> Scenario:
    loop = four_bar()
    (folder / "loop.urdf").write_text(loop.urdf)
    (folder / "scenario.toml").write_text(loop.scenario + more)
    return load_scenario(folder / "scenario.toml")


def test_a_closed_loop_bounces_as_one(tmp_path: Path) -> None:
    """The crank of a four-bar between stops: its rate is reversed, the loop closed."""
    stop = '[stops.crank]\nkind = "rigid"\njoint = "drive_pin"\nupper = "40 deg"\nlower = -0.1\n'
    run = simulate(_loop(tmp_path, f"{stop}restitution = 0.8\n"))
    assert run.completed
    assert str(run.data.change.values[0]) == "stop crank: upper: bounces"
    rates = run.data.change_rate_after.values / run.data.change_rate.values
    # Correct to the round-off of factors.
    assert np.allclose(rates, -0.8, rtol=0.0, atol=1e-12)
    # With one freedom all kinetic energy goes with the square of the rate.
    loss, impulse = run.data.change_loss.values, run.data.change_impulse.values
    assert np.allclose(loss, -0.5 * impulse * (run.data.change_rate + run.data.change_rate_after), rtol=1e-9)
    assert np.abs(run.data.energy_error).max() < 1e-9


def test_a_closed_loop_locks_as_one(tmp_path: Path) -> None:
    """Locked at one joint a loop of one freedom stands still, and all of its kinetic energy is lost."""
    run = simulate(_loop(tmp_path, '[latches.drive_pin]\nkind = "rigid"\nangle = "40 deg"\n'))
    assert run.completed
    after = run.data.time.values > float(run.data.change_time[0])
    assert np.abs(run.data.v.values[after]).max() < 1e-12
    assert np.abs(run.data.kinetic_energy.values[after]).max() < 1e-20
    assert np.abs(run.data.energy_error).max() < 1e-9


def test_bad_starts_and_tables_are_refused_in_a_line(tmp_path: Path) -> None:
    """A start beyond a stop, a stop that is none, a family that there is not."""
    with pytest.raises(ScenarioError, match=r"stops\.crank.*lower must be given, or upper, or both"):
        _loop(tmp_path, '[stops.crank]\nkind = "rigid"\njoint = "drive_pin"\nrestitution = 0.5\n')
    beyond = _loop(tmp_path, '[stops.drive_pin]\nkind = "rigid"\nlower = 0.2\nrestitution = 0.5\n')
    with pytest.raises(InvalidParameterError, match="position of drive_pin must be within its rigid stop"):
        simulate(beyond)
    with pytest.raises(AntennaPinError, match=r"\[?stop"):
        _loop(tmp_path, '[stop.drive_pin]\nkind = "rigid"\nlower = 0.2\n')


def test_small_motions_are_those_of_the_present_mode() -> None:
    """A latched joint is no freedom of the modes."""
    latch = RigidLatch(joint="j0", angle=0.0)
    springs = {"j1": JointSpring(joint="j1", stiffness=5.0)}
    more = {"base": "fixed", "springs": springs}
    held = _chain("revolute", "revolute", elements={"latches": {"j0": latch}}, **more)
    free = _chain("revolute", "revolute", **more)
    found = modes(held).frequency
    assert found == pytest.approx(modes(free, hold=["j0"]).frequency, rel=1e-9)
    assert len(found) == 1


def test_a_run_that_was_interrupted_goes_on_with_its_changes() -> None:
    """What a checkpoint holds is all: modes, what has happened, and the rest of the run bit for bit."""
    system = _ball(RigidStop(joint="j", lower=0.0, restitution=0.6, rest_rate=0.01))
    y = system.state([1.0], [0.0])
    whole, first = (Run(system, y, 2.5, TIGHT) for _ in range(2))
    whole.advance()
    first.advance(interrupted=lambda: len(first.actions.modes.changed) >= 4)
    kept = Checkpoint.of(first, {})
    second = Run(system, kept.start, 2.5, TIGHT, since=kept.begin)
    kept.give_to(second)
    second.advance()
    assert second.actions.modes.changed == whole.actions.modes.changed
    assert len(whole.actions.modes.changed) > len(first.actions.modes.changed)
    assert np.array_equal(second.here, whole.here)


def test_bounces_too_many_to_count_come_to_rest() -> None:
    """With a rest rate near round-off the series of bounces still ends, where the closed form says."""
    e, height = 0.5, 1.0
    run = simulate(
        _ball(RigidStop(joint="j", lower=0.0, restitution=e, rest_rate=1e-12)),
        q=[height],
        v=[0.0],
        duration=2.0,
        settings=TIGHT,
    )
    assert run.completed
    # t0 (1 + e) / (1 - e); the bounces that round-off leaves out last less than that of 1e-9 m/s.
    assert float(run.data.change_time[-1]) == pytest.approx(3.0 * np.sqrt(2.0 * height / G), abs=1e-9)
    assert run.data.q.values[:, 0].min() > -1e-9
    assert abs(run.data.q.values[-1, 0]) < 1e-15
