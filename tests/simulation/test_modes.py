"""Elements with modes: rigid stops and latches against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from antenna_pin import RunSettings, simulate
from antenna_pin.dynamics import System
from antenna_pin.elements import ConstantDrive, RigidLatch, RigidStop
from antenna_pin.mechanism import Urdf, build_mechanism
from antenna_pin.simulation import Event, Set, Time

G = 9.81
TIGHT = RunSettings(rtol=1e-11, max_step=0.05, output_rate=50.0)

BODIES = """<robot name="two"><link name="base"><inertial><origin xyz="0.1 0 0.05"/><mass value="3"/>
<inertia ixx="0.4" iyy="0.5" izz="0.6" ixy="0.01" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="{type}"><parent link="base"/><child link="arm"/><origin xyz="0.2 0 0" rpy="0.3 0.2 0"/>
<axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="1e9" velocity="1e9"/></joint>
<link name="arm"><inertial><origin xyz="0.3 0.1 0"/><mass value="2"/>
<inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0" ixz="0.01" iyz="0"/></inertial></link></robot>"""


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
        _ball(RigidStop(joint="j", lower=0.0), drives={"d": drive}),
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


@pytest.mark.parametrize("kind", ["revolute", "continuous", "prismatic"])
def test_a_latch_keeps_all_momentum(kind: str) -> None:
    """Locked on a free base: momentum stays, and half of the reduced inertia times rate squared is lost."""
    system = _system(kind, elements={"latches": {"j": RigidLatch(joint="j", angle=0.4)}})
    v = np.array([0.1, 0.2, -0.1, 0.3, -0.2, 0.4, 0.9])
    run = simulate(system, v=v, duration=2.0, settings=TIGHT)
    assert list(run.data.change.values) == ["latch j: latched"]
    for name in ("linear", "angular"):
        momentum = run.data[f"{name}_momentum"].values
        assert np.abs(momentum - momentum[0]).max() <= 1e-10 * np.abs(momentum).max()
    after = run.data.time.values > float(run.data.change_time[0])
    rates = run.data.v.values[after, 6]
    assert np.abs(rates).max() < 1e-12
    rate, loss = float(run.data.change_rate[0]), float(run.data.change_loss[0])
    impulse = float(run.data.change_impulse[0])
    # An impulse that takes a rate to zero does its work at half of that rate.
    assert loss == pytest.approx(-0.5 * impulse * rate, rel=1e-10)
    assert np.abs(run.data.energy_error).max() < 1e-9


def test_two_halves_are_one() -> None:
    """A run that is cut between bounces, and while it rests, goes on bit for bit."""
    system = _ball(RigidStop(joint="j", lower=0.0, restitution=0.6, rest_rate=0.01))
    whole = simulate(system, q=[1.0], v=[0.0], duration=2.375, settings=TIGHT)
    first = simulate(system, q=[1.0], v=[0.0], duration=0.75, settings=TIGHT)
    second = simulate(system, start=first.end, duration=1.625, settings=TIGHT)
    assert np.array_equal(whole.data.q.values[-1], second.data.q.values[-1])
    assert np.array_equal(whole.data.change_time.values[-3:], second.data.change_time.values[-3:])
    assert whole.end == second.end
