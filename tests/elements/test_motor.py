"""A motor with its circuit against closed forms: step response, limits, cogging, where its energy goes."""

import math

import numpy as np
import pytest
from controlled_wheel import HUB, WHEEL, rig
from scipy.linalg import expm

from antenna_pin import RunSettings, System, simulate
from antenna_pin.elements import JointSpring, Motor
from antenna_pin.elements.control import Pid
from antenna_pin.errors import AntennaPinError

K, R, N = 0.5, 2.0, 3.0  # [N m/A], [ohm], [-]
TIGHT = RunSettings(output_rate=100.0, rtol=1e-11)


def motor(**changes):
    given = {"joint": "joint", "value": 12.0, "torque_constant": K, "resistance": R, "ratio": N}
    return Motor(**given | changes)


def run_of(one, duration=0.5, base="fixed", settings=TIGHT, springs=None, **more):
    system = System(rig(base).mechanism, drives={"motor": one}, springs=springs or {})
    return simulate(system, duration=duration, settings=settings, **more)


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
@pytest.mark.parametrize("base", ["fixed", "free"])
@pytest.mark.parametrize("inductance", [0.0, 0.2])
def test_step_of_voltage(inductance, base, engine):
    """Current and speed by the matrix exponential; without an inductance speed alone."""
    settings = RunSettings(output_rate=100.0, rtol=1e-11, engine=engine)
    run = run_of(motor(inductance=inductance), base=base, settings=settings)
    inertia = WHEEL if base == "fixed" else HUB * WHEEL / (HUB + WHEEL)
    times = run.data.time.values
    if inductance:
        matrix = np.array([[-R / inductance, -K * N / inductance], [N * K / inertia, 0.0]])
        end = -np.linalg.solve(matrix, [12.0 / inductance, 0.0])
        rates = [float((end - expm(matrix * t) @ end)[1]) for t in times]
    else:
        rates = 12.0 / (K * N) * (1.0 - np.exp(-times * (N * K) ** 2 / (inertia * R)))
    # The tolerance, over the steps of half a second.
    assert run.data.motion_rate.values[:, 0] == pytest.approx(rates, abs=1e-10)


def test_where_the_energy_goes():
    """From the supply: heat, the field's energy L i^2 / 2 and work, the cogging's energy being stored."""
    run = run_of(motor(inductance=0.2, cogging=0.5, cycles=4, cogging_phase=0.3, current_limit=2.0))
    last = run.data.isel(time=-1)
    current, electric, heat, work, gross = (
        float(last[name][0])
        for name in ("motor_current", "motor_electric_energy", "motor_heat", "drive_work", "drive_gross_work")
    )
    assert electric == pytest.approx(heat + 0.5 * 0.2 * current**2 + work, rel=1e-9)
    assert abs(run.data.energy_error.values).max() < 1e-11 * gross
    assert 1.9 < abs(current) <= 2.0
    stored = run.data.spring_energy.values
    angle = run.data.motion_angle.values[:, 0]
    assert stored == pytest.approx(-0.5 / 4 * np.cos(4 * N * angle + 0.3), abs=1e-14)


def test_a_current_beyond_its_limit_is_not_driven():
    """Constant torque until the back-EMF leaves less than R i_max; then exponentially on."""
    limit = 2.0
    run = run_of(motor(current_limit=limit), duration=4.0)
    assert run.data.motor_current.values[0, 0] == pytest.approx(limit, rel=1e-14)
    torque = N * K * limit
    kink = (12.0 - R * limit) / (K * N)  # [rad/s]
    begin = kink * WHEEL / torque
    times = run.data.time.values
    tau = WHEEL * R / (N * K) ** 2
    after = kink + (12.0 / (K * N) - kink) * (1.0 - np.exp(-(times - begin) / tau))
    expected = np.where(times < begin, torque / WHEEL * times, after)
    assert run.data.motion_rate.values[:, 0] == pytest.approx(expected, abs=1e-9)


def test_commanded_current_is_limited_by_voltage():
    """Torque is constant up to the speed at which R i + K_e n w is all there is; it ends where K_e n w is."""
    run = run_of(motor(mode="current", value=3.0, voltage_limit=12.0), duration=8.0)
    torque = run.data.drive_torque.values[:, 0]
    rate = run.data.motion_rate.values[:, 0]
    free = (12.0 - R * 3.0) / (K * N)
    assert torque[rate < free - 1e-9] == pytest.approx(N * K * 3.0, rel=1e-12)
    assert torque == pytest.approx(N * K * np.minimum(3.0, (12.0 - K * N * rate) / R), rel=1e-9)


def test_cogging_holds_small_swings():
    """About its valley: the frequency of its slope, sqrt(T_c c n^2 / I)."""
    one = motor(value=0.0, torque_constant=1e-12, cogging=0.5, cycles=4)
    system = System(rig().mechanism, drives={"motor": one})
    run = simulate(system, duration=2.0, q=[math.cos(1e-5), math.sin(1e-5)], settings=TIGHT)
    omega = math.sqrt(0.5 * 4 * N**2 / WHEEL)
    # The swing stretches by (c n phi)^2 / 16 = 1e-9 of itself.
    assert run.data.motion_angle.values[:, 0] == pytest.approx(
        1e-5 * np.cos(omega * run.data.time.values), abs=1e-12
    )


def test_a_sampled_voltage_holds_a_spring():
    """State feedback by PID of a motor on a spring against matrix exponentials between instants, to 1e-9."""
    stiffness, inductance, period = 20.0, 0.1, 0.02
    one = motor(value=0.0, inductance=inductance)
    pid = Pid(acts_on="motor", period=period, kp=30.0, kd=1.0, reference=0.2, delay_periods=1.0)
    spring = {"coil": JointSpring(joint="joint", stiffness=stiffness, damping=0.3)}
    settings = RunSettings(output_rate=1.0 / period, rtol=1e-12)
    run = run_of(one, duration=40 * period, settings=settings, springs=spring, controllers={"loop": pid})
    matrix = np.array(
        [
            [0.0, 1.0, 0.0],
            [-stiffness / WHEEL, -0.3 / WHEEL, N * K / WHEEL],
            [0.0, -K * N / inductance, -R / inductance],
        ]
    )
    whole = expm(
        period * np.block([[matrix, np.array([[0.0], [0.0], [1.0 / inductance]])], [np.zeros((1, 4))]])
    )
    state, waiting, before, angles = np.zeros(3), 0.0, 0.0, []
    for _ in range(40):
        angles.append(state[0])
        command = 30.0 * (0.2 - state[0]) + 1.0 * (before - state[0]) / period
        before = state[0]
        state = whole[:3, :3] @ state + whole[:3, 3] * waiting
        waiting = command
    assert run.data.motion_angle.values[:40, 0] == pytest.approx(angles, abs=1e-9)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"ratio": 0.0}, "Motor: ratio must be other than zero, got 0.0"),
        ({"resistance": 0.0}, "Motor: resistance must be positive"),
        (
            {"mode": "current", "inductance": 0.1},
            "Motor: inductance must be zero where the current is commanded",
        ),
        ({"mode": "speed"}, "Motor: mode must be voltage or current, got 'speed'"),
        ({"voltage_limit": -1.0}, "Motor: voltage_limit must be positive"),
    ],
    ids=str,
)
def test_refusals(changes, said):
    with pytest.raises(AntennaPinError) as error:
        motor(**changes)
    assert said in str(error.value)
