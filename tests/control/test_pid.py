"""Sampled PID controllers against the exact discrete solution: delays, limits, sensors."""

import dataclasses
import math

import numpy as np
import pytest
from controlled_wheel import HUB, KINDS, PERIOD, PLAIN, ROUND_OFF, WHEEL, run_of

from antenna_pin.elements.control import Sensor
from antenna_pin.errors import AntennaPinError


def held(pid, wished, last):
    """Return a command within its limits, that of its rate first."""
    if pid.slew is not None:
        wished = min(max(wished, last - pid.slew * PERIOD), last + pid.slew * PERIOD)
    wished = wished if pid.lower is None else max(wished, pid.lower)
    return wished if pid.upper is None else min(wished, pid.upper)


def exact(pid, inertia, count):
    """Angle at the instants, and commands, of a wheel that the controller's equations turn: by hand.

    Time goes on by half periods, so that a delay of a number of halves begins where one does.
    """
    angle = rate = integral = derivative = 0.0
    before = previous = None
    due, torque, last = {}, 0.0, 0.0
    angles, commands = [], []
    for half in range(2 * count):
        if half % 2 == 0:
            seen = angle
            step = pid.sensor.step
            if step:
                seen = step * math.floor(seen / step + 0.5)
            error = pid.reference - seen
            before, previous = (seen, error) if before is None else (before, previous)
            change = error - previous if pid.derivative == "error" else before - seen
            derivative = (pid.derivative_filter * derivative + pid.kd * change) / (
                pid.derivative_filter + PERIOD
            )
            rest = pid.kp * error + derivative
            grows = {
                "backward": pid.ki * PERIOD * error,
                "forward": pid.ki * PERIOD * error,
                "trapezoid": 0.5 * pid.ki * PERIOD * (error + previous) if half else 0.0,
            }[pid.integrator]

            wished = rest + integral + (0.0 if pid.integrator == "forward" else grows)
            command = held(pid, wished, last)
            if pid.anti_windup == "clamping" and (wished - command) * grows > 0.0:
                grows, wished = 0.0, rest + integral
                command = held(pid, wished, last)
            integral += grows
            if pid.anti_windup == "back-calculation":
                integral += PERIOD / pid.tracking_time * (command - wished)
            before, previous, last = seen, error, command
            angles.append(angle)
            commands.append(command)
            due[half + round(2 * (pid.delay_periods + pid.delay / PERIOD))] = command
        torque = due.get(half, torque)
        h = 0.5 * PERIOD
        angle += rate * h + 0.5 * torque / inertia * h * h
        rate += torque / inertia * h
    return np.array(angles), np.array(commands)


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("base", ["fixed", "free"])
def test_loop_is_the_exact_discrete_one(name, base):
    """On a free base the joint feels the inertia of both bodies in series."""
    pid = KINDS[name]
    inertia = WHEEL if base == "fixed" else HUB * WHEEL / (HUB + WHEEL)
    run = run_of(pid, base)
    angles, commands = exact(pid, inertia, 50)
    assert run.data.tick_time.values[:50] == pytest.approx(np.arange(50) * PERIOD, abs=1e-15)
    # A step of the sensor's may go the other way where the angle is at its edge but for round-off; here none.
    assert run.data.motion_angle.sel(joint="joint").values[:50] == pytest.approx(angles, abs=ROUND_OFF)
    signal = run.data.tick_signal.sel(signal="loop.command motor").values[:50]
    # Gains over the period are up to 1e3 times the angle's round-off.
    assert signal == pytest.approx(commands, abs=1e3 * ROUND_OFF)


@pytest.mark.parametrize("more", [{"rtol": 1e-3}, {"rtol": 1e-12}, {"method": "rk4", "step": 7e-4}], ids=str)
def test_instants_do_not_depend_on_steps(more):
    """With loose and tight tolerances and fixed steps that no period is a multiple of."""
    angles, _ = exact(KINDS["late by seconds"], WHEEL, 50)
    run = run_of(KINDS["late by seconds"], **more)
    assert run.data.motion_angle.sel(joint="joint").values[:50] == pytest.approx(angles, abs=ROUND_OFF)
    assert len(run.data.tick_time) == 51


def test_an_integral_that_is_held_comes_back_at_once():
    """Without anti-windup the wheel overshoots by far more."""
    over = {
        name: run_of(KINDS[name], duration=4.0).data.motion_angle.values.max() - PLAIN.reference
        for name in ("clamped", "back", "wound up")
    }
    assert over["clamped"] < 0.5 * over["wound up"]
    assert over["back"] < 0.5 * over["wound up"]


def test_saturated_instants_are_counted():
    run = run_of(KINDS["clamped"])
    held = run.data.tick_signal.sel(signal="loop.saturated").values
    commands = run.data.tick_signal.sel(signal="loop.command motor").values
    assert set(commands[held > 0.0].tolist()) <= {-1.0, 2.0}
    assert run.summary()["controllers"]["loop"] == {"ticks": 51.0, "saturated": held.sum()}


@pytest.mark.parametrize(
    ("sensor", "seen"),
    [
        (Sensor(resolution=0.1), [0.0, 0.1, 0.2, -0.1, -0.2]),
        (Sensor(resolution=0.1, rounding="floor"), [0.0, 0.0, 0.1, -0.1, -0.2]),
        (Sensor(resolution=0.1, rounding="truncate"), [0.0, 0.0, 0.1, 0.0, -0.1]),
        (Sensor(bias=0.5), [0.54, 0.55 + 0.0, 0.69, 0.45, 0.31]),
        (Sensor(counts=4, rounding="floor"), [0.0, 0.0, 0.0, -0.5 * math.pi, -0.5 * math.pi]),
        (Sensor(bits=2, rounding="floor"), [0.0, 0.0, 0.0, -0.5 * math.pi, -0.5 * math.pi]),
    ],
    ids=str,
)
def test_sensors_round(sensor, seen):
    given = [0.04, 0.0501, 0.19, -0.0501, -0.19]
    if sensor.bias:
        seen = [number + sensor.bias for number in given]
    assert [sensor.read(number, 0) for number in given] == pytest.approx(seen, abs=1e-15)


def test_a_step_that_is_no_number_any_more_is_refused():
    with pytest.raises(AntennaPinError, match=r"Sensor: resolution must be 0 for none, or 1e-100 or more"):
        Sensor(resolution=1e-320)


def test_halves_go_up():
    """Half a step is exact here, and goes up on both sides of zero."""
    sensor = Sensor(resolution=0.25)
    assert [sensor.read(x, 0) for x in (0.125, -0.125, 0.375, -0.375)] == [0.25, 0.0, 0.5, -0.25]


def test_noise_is_white_and_hangs_on_seed_and_instant_alone():
    sensor = Sensor(noise=2.0, seed=5)
    drawn = np.array([sensor.read(0.0, k) for k in range(4000)])
    assert drawn[1234] == Sensor(noise=2.0, seed=5).read(0.0, 1234)
    assert drawn[7] != Sensor(noise=2.0, seed=6).read(0.0, 7)
    assert drawn[7] != sensor.read(0.0, 7, 1)
    # Three standard deviations of mean, of deviation, and of the correlation of neighbours.
    assert abs(drawn.mean()) < 3.0 * 2.0 / math.sqrt(4000)
    assert abs(drawn.std() - 2.0) < 3.0 * 2.0 / math.sqrt(8000)
    assert abs((drawn[1:] * drawn[:-1]).mean() / 4.0) < 3.0 / math.sqrt(4000)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"kp": 0.0, "ki": 0.0, "kd": 0.0}, "Pid: kp must be other than zero, or ki or kd, got 0.0"),
        ({"period": 0.0}, "Pid: period must be positive and finite, got 0.0"),
        ({"lower": 2.0, "upper": 1.0}, "Pid: upper must be above lower = 2, got 1.0"),
        ({"tracking_time": 1.0}, 'Pid: tracking_time must be given where anti_windup is "back-calculation"'),
        ({"measures": "angel joint"}, "(or did you mean angle?), got 'angel joint'"),
        ({"measures": "base-rate"}, "a kind of measure and the axis x, y or z, got 'base-rate'"),
        ({"measures": "rate joint", "derivative": "rate"}, "whose rate no sensor has, got 'rate'"),
        ({"reference": math.nan}, "Pid: reference must be finite, got nan"),
    ],
    ids=str,
)
def test_refusals(changes, said):
    with pytest.raises(AntennaPinError) as error:
        dataclasses.replace(PLAIN, **changes)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"acts_on": "moter"}, "controller 'loop': actuator 'moter' is unknown; did you mean motor?"),
        ({"measures": "angle hinge"}, "controller 'loop': measures 'angle hinge': joint 'hinge' is unknown"),
        ({"measures": "base-rate x"}, "must be of a joint where mechanism.base is fixed, got 'base-rate x'"),
        ({"delay": 0.1, "delay_periods": 1.0}, "delay_periods must be omitted if delay is given"),
    ],
    ids=str,
)
def test_refusals_by_a_system(changes, said):
    with pytest.raises(AntennaPinError) as error:
        run_of(dataclasses.replace(PLAIN, **changes))
    assert said in str(error.value)
