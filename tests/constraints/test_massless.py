"""Trees that are singular without their couplings: knuckles and followers without mass."""

import numpy as np
import pinocchio as pin
import pytest
from scipy.integrate import solve_ivp

from antenna_pin import RunSettings, System, Urdf, build_mechanism, simulate
from antenna_pin.dynamics.constraints import Coupling
from antenna_pin.elements import RigidStop
from antenna_pin.errors import MechanismError

MOMENTS = 'iyy="3e-6" izz="3e-6" ixy="0" ixz="0" iyz="0"'
TIP = f'<inertial><origin xyz="0.012 0 0"/><mass value="0.02"/><inertia ixx="1e-6" {MOMENTS}/></inertial>'
PALM = TIP.replace('"0.02"', '"0.3"').replace("e-6", "e-4")


def finger(mimic=1.0454, knuckle="", last=TIP, middle=""):
    """A finger of two knuckles and a tip; mid leads end, by the URDF if there is a multiplier."""
    said = f'<mimic joint="mid" multiplier="{mimic}"/>' if mimic else ""
    return Urdf.from_text(
        f"""<robot name="finger"><link name="palm">{PALM}</link>
<joint name="knuckle" type="continuous"><parent link="palm"/><child link="k"/><axis xyz="0 1 0"/></joint>
<link name="k">{knuckle}</link>
<joint name="mid" type="continuous"><parent link="k"/><child link="m"/><origin xyz="0.05 0 0"/>
<axis xyz="0 1 0"/></joint><link name="m">{middle}</link>
<joint name="end" type="continuous"><parent link="m"/><child link="tip"/><origin xyz="0.032 0 0"/>
<axis xyz="0 1 0"/>{said}</joint><link name="tip">{last}</link></robot>""",
        "finger.urdf",
    )


def reduced(system, ties, v, times):
    """Integrate in the coordinates that the couplings leave: N^T M N, by Pinocchio's matrices."""
    model = system.model
    data = model.createData()
    free = np.linalg.svd(ties)[2][len(ties) :].T
    nq = model.nq

    def rates(t, state):
        q, own = state[:nq], state[nq:]
        v = free @ own
        mass = np.triu(pin.crba(model, data, q))
        mass += np.triu(mass, 1).T
        bias = pin.nonLinearEffects(model, data, q, v)
        dq = (pin.integrate(model, q, 1e-6 * v) - pin.integrate(model, q, -1e-6 * v)) / 2e-6
        return np.concatenate([dq, -np.linalg.solve(free.T @ mass @ free, free.T @ bias)])

    start = np.concatenate([system.neutral()[:nq], free.T @ v])
    found = solve_ivp(rates, (0, times[-1]), start, "DOP853", times, rtol=1e-12, atol=1e-13)
    return found.y[:nq].T, (free @ found.y[nq:]).T


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
@pytest.mark.parametrize(
    ("urdf", "ties"),
    [
        (finger(), [[0.0, -1.0454, 1.0]]),
        (finger(mimic=-0.3), [[0.0, 0.3, 1.0]]),
        (finger(middle=TIP, last=""), [[0.0, -1.0454, 1.0]]),  # the follower moves nothing
        (finger(knuckle=TIP, last="", mimic=2.0, middle=TIP), [[0.0, -2.0, 1.0]]),
    ],
)
def test_a_finger_of_massless_knuckles_falls_from_straight(engine, urdf, ties):
    """As in the coordinates that its coupling leaves; the coupling's torque as dynamics ask."""
    system = System(build_mechanism(urdf, "fixed", (0.0, 0.0, -9.81)))
    v = np.zeros(3)
    if urdf.mimics["end"]["multiplier"] < 0.0:
        v = np.array([1.0, -2.0, 0.6])
    run = simulate(system, duration=0.1, v=v, settings=RunSettings(engine=engine, rtol=1e-10))
    assert run.completed
    data = run.data
    q, rate = reduced(system, np.array(ties), v, data.time.values)
    assert np.abs(data.v.values - rate).max() < 1e-7 * np.abs(rate).max()
    assert float(np.abs(data.energy_error.values).max()) < 1e-9 * float(data.kinetic_energy.max())
    model = system.model
    for i in range(len(data.time)):
        lacks = pin.rnea(model, model.createData(), data.q.values[i], data.v.values[i], data.a.values[i])
        torque = float(data.coupling_torque.values[i].squeeze())
        assert lacks == pytest.approx(torque * np.array(ties[0]), abs=1e-7 * max(1e-3, abs(torque)))


def test_a_coupling_of_a_scenarios_own_counts_too():
    mechanism = build_mechanism(
        finger(mimic=None, middle=TIP, last=""), "fixed", (0, 0, -9.81), regular=False
    )
    system = System(mechanism, couplings={"c": Coupling(follower="end", leader="mid", multiplier=1.0)})
    run = simulate(system, duration=0.02)
    assert run.completed
    with pytest.raises(MechanismError, match="joint 'end' can turn link 'tip' without any inertia"):
        System(mechanism, couplings={"c": Coupling(follower="mid", leader="knuckle", multiplier=1.0)})
    with pytest.raises(MechanismError, match="joint 'end' can turn link 'tip' without any inertia"):
        build_mechanism(finger(mimic=None, middle=TIP, last=""), "fixed")


def test_a_blow_at_a_massless_finger_keeps_its_energy():
    """An elastic stop at the leader, struck from the straight pose: a blow along what the coupling leaves."""
    system = System(
        build_mechanism(finger(), "free"),
        elements={"stops": {"mid": RigidStop(joint="mid", lower=-1.0, upper=0.2, restitution=1.0)}},
    )
    v = np.zeros(9)
    v[6:] = 0.3, 4.0, 1.0454 * 4.0
    for engine in ("compiled", "pinocchio"):
        run = simulate(system, duration=0.1, v=v, settings=RunSettings(engine=engine, rtol=1e-10))
        energy = run.data.kinetic_energy.values
        assert run.completed and float(run.data.motion_angle.sel(joint="mid").max()) < 0.2 + 1e-9
        assert float(run.data.motion_rate.sel(joint="mid")[-1]) < 0.0
        assert energy == pytest.approx(energy[0], rel=1e-9)
