"""Attitude of a free base by wheels against the linear loop; on and off against limit cycles."""

import dataclasses
import math

import numpy as np
import pytest
from controlled_wheel import rig
from scipy.spatial.transform import Rotation, Slerp

from antenna_pin import RunSettings, System, Urdf, build_mechanism, simulate
from antenna_pin.elements import ConstantDrive, RestToRest, SCurve
from antenna_pin.elements.control import AttitudeFeedback, BangBang
from antenna_pin.elements.control.attitude import between_quaternions, product_of, quaternion_of, turned_back
from antenna_pin.errors import AntennaPinError

BUS, SPIN = 3.0, 0.01  # [kg m^2]
AXES = {"wheel_x": (1, 0, 0), "wheel_y": (0, 1, 0), "wheel_z": (0, 0, 1), "wheel_s": (1, 1, 1)}
_WHEEL = """
  <link name="{0}_link"><inertial><mass value="0.1"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="{0}" type="continuous">
    <parent link="bus"/><child link="{0}_link"/><axis xyz="{1} {2} {3}"/></joint>
"""


def satellite():
    wheels = "".join(_WHEEL.format(name, *axis) for name, axis in AXES.items())
    text = (
        '<robot name="sat"><link name="bus"><inertial><mass value="9"/>'
        f'<inertia ixx="3" iyy="3" izz="3" ixy="0" ixz="0" iyz="0"/></inertial></link>{wheels}</robot>'
    )
    mechanism = build_mechanism(Urdf.from_text(text, "sat.urdf"), base="free", gravity=(0.0, 0.0, 0.0))
    return System(mechanism, drives={name: ConstantDrive(joint=name, value=0.0) for name in AXES})


HOLD = AttitudeFeedback(
    acts_on=tuple(AXES), period=0.1, kp=(0.6, 0.6, 0.6), kd=(1.8, 1.8, 1.8), target=(0.2, -0.1, 0.3)
)


def held(controller, duration=30.0, v=None):
    return simulate(
        satellite(),
        duration=duration,
        v=v,
        controllers={"hold": controller},
        settings=RunSettings(output_rate=10.0),
    )


def test_the_base_comes_to_its_target_and_the_wheels_take_the_momentum():
    v = np.zeros(10)
    v[3:6] = 0.02, 0.01, -0.03
    run = held(HOLD, 40.0, v)
    error = run.data.tick_signal.sel(signal="hold.error").values
    # About a damping ratio of 0.65 at 0.45 rad/s: exp(-0.3 t) of an angle below 0.5 rad.
    assert error[-1] < 1e-4
    assert abs(run.data.base_angular_velocity.values[-1]).max() < 1e-4
    momentum = run.data.angular_momentum.values
    assert abs(momentum - momentum[0]).max() < 1e-12


def test_a_slew_is_followed_with_the_inertia_fed_forward():
    """What is left is what the hold makes of the acceleration, half a period late, J a'' h / 2 over kp.

    The acceleration of the slew changes by up to 60 / 12^3 a second of 1.2 rad: 3 * 0.042 * 0.05 / 0.6 = 0.01
    at most, which dies away by exp(-0.3 t) after the slew.
    Without it the lack is J a / kp, of 1.2 * 5.77 / 12^2 rad/s^2: over 0.2 rad.
    """
    slew = RestToRest(end=1.0, duration=12.0)
    axes = np.array([np.array(axis) / np.linalg.norm(axis) for axis in AXES.values()])
    inertia = (BUS + 4 * SPIN) * np.eye(3) - SPIN * axes.T @ axes
    own = dataclasses.replace(
        HOLD,
        target=(1.2, 0.0, 0.0),
        share=slew.over_time(),
        inertia=tuple(np.diag(inertia).tolist()),
    )
    run = held(own, 45.0)
    seen = run.data.tick_signal.sel(signal="hold.error").values
    assert seen.max() < 0.011 and seen[-1] < 1e-5
    without = held(dataclasses.replace(own, inertia=(0.0, 0.0, 0.0)), 15.0)
    assert without.data.tick_signal.sel(signal="hold.error").values.max() > 0.15


def test_a_slew_goes_about_the_one_axis_that_leads_there():
    """The target at each share is the interpolation of SciPy, its rate the derivative, in its own axes."""
    slew = SCurve(end=1.0, rate=0.1, acceleration=0.05, jerk=0.05)
    own = dataclasses.replace(HOLD, begin=(0.3, -0.5, 0.2), target=(0.4, 1.9, -0.7), share=slew.over_time())
    ends = Rotation.from_rotvec([own.begin, own.target])
    between = Slerp([0.0, 1.0], ends)
    for t in (0.0, 0.7, 4.0, 11.0, 30.0):
        share, rate, _ = slew.at(t)
        quaternion, turning, _ = own.aim(t)
        aim = Rotation.from_quat(quaternion)
        assert (aim.inv() * between(share)).magnitude() < 1e-14
        way = (ends[0].inv() * ends[1]).as_rotvec()
        assert turning == pytest.approx(rate * way, abs=1e-15)


def test_small_angles_are_the_linear_discrete_loop():
    """About an axis of inertia alone: by z = F z + G u with the bus and what the wheels carry of their own.

    The four wheels turn with the bus; each takes its own axis' share out, which leaves bus and wheels' other
    axes. For turns of 1e-6 rad the quaternion is the angle to 1e-12 of it.
    """
    axes = np.array([np.array(axis) / np.linalg.norm(axis) for axis in AXES.values()])
    inertia = (BUS + 4 * SPIN) * np.eye(3) - SPIN * axes.T @ axes
    small = dataclasses.replace(HOLD, target=(1e-6, 0.0, 0.0))
    run = held(small, 2.0)
    h = small.period
    angle, rate, target = np.zeros(3), np.zeros(3), np.array(small.target)
    for k in range(20):
        assert run.data.tick_signal.sel(signal="hold.error").values[k] == pytest.approx(
            np.linalg.norm(angle - target), rel=1e-8
        )
        torque = -0.6 * (angle - target) - 1.8 * rate
        gain = np.linalg.solve(inertia, torque)
        angle, rate = angle + h * rate + 0.5 * h * h * gain, rate + h * gain


def test_torques_are_shared_out_least_and_limited_alike():
    run = held(dataclasses.replace(HOLD, limit=0.02), 1.0)
    first = run.data.tick_signal.values[0]
    torque, wheels = first[1:4], first[5:]
    assert abs(wheels).max() == pytest.approx(0.02, rel=1e-14)
    axes = np.array([np.array(axis) / np.linalg.norm(axis) for axis in AXES.values()])
    assert np.cross(-axes.T @ wheels, torque) == pytest.approx(np.zeros(3), abs=1e-15)
    # Nothing of it turns the wheels against each other.
    assert np.linalg.pinv(axes.T) @ axes.T @ wheels == pytest.approx(wheels, abs=1e-15)


def test_it_turns_the_shorter_way():
    """From 3.5 rad about z on it is -2.78 rad."""
    turned = dataclasses.replace(HOLD, target=(0.0, 0.0, 3.5))
    run = held(turned, 0.5)
    assert run.data.base_angular_velocity.values[-1, 2] < 0.0
    assert run.data.tick_signal.values[0, 0] == pytest.approx(2.0 * math.pi - 3.5, rel=1e-12)


def test_needs_a_free_base():
    with pytest.raises(AntennaPinError, match="mechanism.base is fixed"):
        simulate(
            rig(),
            duration=1.0,
            controllers={"c": dataclasses.replace(HOLD, acts_on=("motor",), axes=(1, 0, 0))},
        )


# --- on and off -------------------------------------------------------------------------------------------

INERTIA, LEVEL = 2.0, 0.4  # [kg m^2], [N m]
RELAY = BangBang(acts_on="motor", period=1e-3, measures="angle joint", level=LEVEL)


def switched(controller, duration, rate=0.0, system=None):
    return simulate(
        system or rig(),
        duration=duration,
        v=[rate],
        controllers={"relay": controller},
        settings=RunSettings(output_rate=100.0),
    )


def test_limit_cycle_of_a_dead_band():
    """Between thrusts a wheel goes at its rate from one edge to the other; each thrust turns the rate round.

    With the line s = -(y + T y') and no hysteresis it comes on at y + T w = d and goes off where it is below
    again; a minimum on time t reverses it if w = M t / (2 I), and the cycle has the period
    2 (2 (d - T w) / w + t), up to the instants: each switch is late by up to a period.
    """
    on = 0.5
    rate = 0.5 * LEVEL * on / INERTIA
    edge, slope = 0.1, 0.2
    loop = dataclasses.replace(
        RELAY,
        measures_rate="rate joint",
        slope=slope,
        dead_band=edge,
        minimum_on=on,
        period=5e-3,
    )
    run = switched(loop, 20.0, rate)
    rates = np.abs(run.data.motion_rate.values[:, 0])
    # It reverses exactly: the thrust lasts a whole number of periods, and goes off as the line has passed.
    assert rates[-1] == pytest.approx(rate, rel=1e-9)
    commands = run.data.tick_signal.sel(signal="relay.command motor").values
    starts = run.data.tick_time.values[1:][(commands[1:] != 0.0) & (commands[:-1] == 0.0)]
    # Thrust begins at y = d - T w and ends there on the way back: half a cycle is the way between, and it.
    half = 2.0 * (edge - slope * rate) / rate + on
    assert np.diff(starts)[1:] == pytest.approx(half, abs=2.0 * loop.period)


def test_a_relay_with_hysteresis_and_a_delay_has_its_limit_cycle():
    """Of a double integrator with a rate that counts: the amplitude that the describing function also gives.

    The line s = -(y + T w) passes -h and h; switching there with u = -M sgn, on a cycle of half period P the
    rate swings by w = M P / (2 I), and the angle at a switch is zero by symmetry: T w = h, P = 2 I h / (M T).
    """
    h, slope = 0.02, 0.5
    loop = dataclasses.replace(RELAY, measures_rate="rate joint", slope=slope, hysteresis=h, period=1e-3)
    rate = h / slope
    half = 2.0 * INERTIA * h / (LEVEL * slope)
    run = switched(loop, 3.0, -rate)
    commands = run.data.tick_signal.sel(signal="relay.command motor").values
    switches = run.data.tick_time.values[1:][np.diff(commands) != 0.0]
    # Each switch is late by d, up to a period: then w (T - d) = h + T M d / I, and P grows by P d / T + 2 d.
    late = loop.period * (half / slope + 2.0)
    between = np.diff(switches)
    assert (between > half - loop.period).all()
    assert (between < half + late + loop.period).all()
    assert set(commands.tolist()) == {-LEVEL, LEVEL}


def test_two_commands_push_one_way_each():
    drives = {name: ConstantDrive(joint="joint", value=0.0) for name in ("up", "down")}
    system = System(rig().mechanism, drives=drives)
    loop = BangBang(
        positive=("up",),
        negative=("down",),
        period=0.01,
        measures="angle joint",
        dead_band=0.05,
        reference=0.2,
    )
    run = switched(loop, 1.0, system=system)
    up = run.data.tick_signal.sel(signal="relay.command up").values
    down = run.data.tick_signal.sel(signal="relay.command down").values
    assert set(up.tolist()) == {0.0, 1.0}
    assert ((up == 0.0) | (down == 0.0)).all()


def test_quaternions_are_the_rotations_of_scipy():
    """Products of turns that follow one another, the shorter turn between two, vectors in turned axes."""
    random = np.random.default_rng(3)
    for size in (0.0, 1e-9, 0.3, 2.0, 3.1):
        vectors = random.normal(size=(2, 3))
        vectors *= size / np.linalg.norm(vectors, axis=1)[:, None]
        first, second = (quaternion_of(one) for one in vectors)
        one, other = Rotation.from_rotvec(vectors)
        assert (one.inv() * Rotation.from_quat(first)).magnitude() < 1e-15
        assert ((one * other).inv() * Rotation.from_quat(product_of(first, second))).magnitude() < 1e-14
        between = between_quaternions(first, -second)
        assert between[3] >= 0.0
        assert ((one.inv() * other).inv() * Rotation.from_quat(between)).magnitude() < 1e-14
        vector = random.normal(size=3)
        assert turned_back(first, vector) == pytest.approx(one.inv().apply(vector), abs=1e-14)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"positive": ("motor",)}, "acts_on must be given, or positive and negative, and not both"),
        ({"slope": 1.0}, "slope must be above zero with measures_rate, and only then"),
        ({"dead_band": 0.1, "hysteresis": 0.2}, "hysteresis must be at most dead_band = 0.1"),
        ({"level": 0.0}, "level must be positive"),
        ({"measures": "angle"}, "a kind of measure and a joint"),
    ],
    ids=str,
)
def test_refusals(changes, said):
    with pytest.raises(AntennaPinError) as error:
        dataclasses.replace(RELAY, **changes)
    assert said in str(error.value)
