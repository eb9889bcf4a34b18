"""Forces on links in runs: impulses, edges of pulses, closed forms, ledgers, parts of runs, a user's."""

import dataclasses
import functools
import math
from itertools import pairwise

import numpy as np
import pytest
from numba import njit
from scipy.integrate import quad
from scipy.spatial.transform import Rotation

from antenna_pin import RunSettings, System, Urdf, build_mechanism, load_scenario, simulate
from antenna_pin.analysis import joint_loads
from antenna_pin.dynamics import JointSpring
from antenna_pin.elements import (
    CallableElement,
    CallableForce,
    Chirp,
    Constant,
    OutsideForce,
    Sine,
    Sum,
    Thruster,
)
from antenna_pin.elements import Table as Points
from antenna_pin.errors import AntennaPinError
from antenna_pin.run.simulation import Event, Set, Time

TIGHT = RunSettings(rtol=1e-12, output_rate=50.0, engine="compiled")
ENGINES = ("compiled", "pinocchio")

HULL = """<robot name="craft">
  <link name="hull"><inertial><mass value="4"/>
    <inertia ixx="0.5" iyy="0.6" izz="0.7" ixy="0" ixz="0" iyz="0"/></inertial></link>{}
</robot>"""
ARM = """
  <joint name="hinge" type="continuous"><parent link="hull"/><child link="arm"/>
    <origin xyz="0.3 0 0.1" rpy="0.3 -0.4 0.5"/><axis xyz="0 0.6 0.8"/></joint>
  <link name="arm"><inertial><origin xyz="0.4 0 0"/><mass value="1.5"/>
    <inertia ixx="0.01" iyy="0.2" izz="0.21" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="mount" type="fixed"><parent link="arm"/><child link="tip"/>
    <origin xyz="0.8 0 0" rpy="0 0 1.5707963267948966"/></joint>
  <link name="tip"/>"""


def craft(parts="", base="free", springs=None, **forces):
    mechanism = build_mechanism(Urdf.from_text(HULL.format(parts), "craft.urdf"), base)
    return System(mechanism, springs=springs, elements={"forces": forces})


def moving(system, seed=3):
    rng = np.random.default_rng(seed)
    return 0.5 * rng.normal(size=system.model.nv)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_pulse_has_its_impulse_and_edges(engine):
    """Through the mass centre of a body at rest: m v = F T to round-off, whatever the tolerance, for no step
    crosses an edge and a constant acceleration is what every method has."""
    jet = Thruster(
        at=("hull", (0, 0, 0)), direction=(0, 0, 2), thrust=3.0, starts=(0.1, 0.3), durations=(0.05,)
    )
    loose = RunSettings(rtol=1e-3, engine=engine, output_rate=10.0)
    run = simulate(craft(jet=jet), duration=0.5, settings=loose)
    data = run.data
    np.testing.assert_allclose(data["total_impulse"].values, [[0, 0, 0.3]], rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(data["linear_momentum"].values[-1], [0, 0, 0.3], rtol=1e-12, atol=1e-15)
    # Way: two accelerations of F/m and what follows each.
    way = 3.0 / 4.0 * sum(0.05**2 / 2 + 0.05 * (0.5 - start - 0.05) for start in (0.1, 0.3))
    assert data["base_position"].values[-1, 2] == pytest.approx(way, rel=1e-12, abs=0.0)
    force = np.linalg.norm(data["applied_force"].values[:, 0], axis=1)
    time = data["time"].values
    on = ((time >= 0.1) & (time < 0.1 + 0.05)) | ((time >= 0.3) & (time < 0.3 + 0.05))
    # What holds from an instant on is what is kept there.
    assert np.array_equal(force, np.where(on, 3.0, 0.0))
    assert {0.1, 0.1 + 0.05, 0.3, 0.3 + 0.05} <= set(time.tolist())
    assert data["total_force_work"].item() == pytest.approx(0.3**2 / 8.0, rel=1e-12, abs=0.0)


def test_impulses_of_a_spinning_body():
    """A jet across the axis: what turns with the body, integrated; off the centre it spins the body up."""
    rate, lever, thrust = 1.7, 0.25, 2.0
    through = Thruster(
        at=("hull", (0, 0, 0)), direction=(1, 0, 0), thrust=thrust, starts=(0.2,), durations=(0.7,)
    )
    v = np.zeros(6)
    v[5] = rate
    run = simulate(craft(jet=through), duration=1.0, v=v, settings=TIGHT)
    a, b = rate * 0.2, rate * 0.9
    exact = thrust / rate * np.array([math.sin(b) - math.sin(a), math.cos(a) - math.cos(b), 0.0])
    # The run's tolerance over less than a turn.
    np.testing.assert_allclose(run.data["total_impulse"].values[0], exact, rtol=0, atol=1e-12)
    off = dataclasses.replace(through, at=("hull", (0.0, -lever, 0.0)))
    run = simulate(craft(jet=off), duration=1.0, v=v, settings=TIGHT)
    torque = thrust * lever
    grown = run.data["force_central_impulse"].values[-1, 0]
    np.testing.assert_allclose(grown, [0.0, 0.0, torque * 0.7], rtol=0, atol=1e-12)
    np.testing.assert_allclose(
        run.data["angular_momentum"].values[-1, 2], 0.7 * rate + torque * 0.7, rtol=1e-12
    )
    angle = [
        lambda t, w=wave: thrust * w(rate * t + 0.5 * torque / 0.7 * (t - 0.2) ** 2)
        for wave in (math.cos, math.sin)
    ]
    exact = [quad(wave, 0.2, 0.9, epsabs=1e-13, epsrel=1e-13)[0] for wave in angle]
    np.testing.assert_allclose(run.data["total_impulse"].values[0, :2], exact, rtol=0, atol=1e-11)
    # About the world's origin, the mass centre's way included: r x p + h.
    data = run.data
    moved = np.cross(data["base_position"].values[-1], data["linear_momentum"].values[-1])
    whole = moved + data["angular_momentum"].values[-1] - [0.0, 0.0, 0.7 * rate]
    np.testing.assert_allclose(data["total_angular_impulse"].values[0], whole, rtol=0, atol=1e-11)


FORCES = {
    "jet": Thruster(
        at=("tip", (0.0, 0.1, 0.0)), direction=(1, 2, 0), thrust=2.0, starts=(0.02, 0.15),
        durations=(0.1, 0.2),
    ),
    "lag": Thruster(
        at=("hull", (0.1, 0.0, 0.0)), direction=(0, 0, 1), thrust=1.0, starts=(0.0, 0.2),
        durations=(0.05, 0.1), rise_time=0.01, fall_time=0.02,
    ),
    "drag": OutsideForce(at=("arm", (0.5, 0.0, 0.0)), force=(-1.0, 0.2, 0.0), axes="world"),
    "swing": OutsideForce(at=("hull", (0, 0, 0)), torque=(0.1, 0.2, -0.3), frequency=3.0, phase=0.4),
    "table": OutsideForce(
        at=("tip", (0, 0, 0)), force=(0.0, 1.0, 0.5), torque=(0.3, 0.0, 0.0), time=(0.0, 0.1, 0.5),
        factors=(0.0, 1.0, -0.5),
    ),
}  # fmt: skip


@pytest.mark.parametrize("engine", ENGINES)
def test_momenta_less_impulses_and_energy_less_work_stay(engine):
    """Of an arm that turns freely on a hull, with forces on hull, arm, and a frame on the arm."""
    system = craft(ARM, **FORCES)
    run = simulate(system, duration=0.5, v=moving(system), settings=dataclasses.replace(TIGHT, engine=engine))
    kept = run.summary()["conservation"]
    # The run's tolerance, over a few radians.
    assert kept["energy_error_relative"] < 1e-11
    assert kept["linear_momentum_drift_relative"] < 1e-12
    assert kept["angular_momentum_drift_relative"] < 1e-12
    # And forces have brought in more than that by far.
    assert np.linalg.norm(run.data["total_impulse"].values.sum(axis=0)) > 0.1


def test_a_force_that_rises_with_a_time_constant():
    """The first order lag in closed form; a pulse's impulse is the same in the end."""
    jet = Thruster(
        at=("hull", (0, 0, 0)), direction=(1, 0, 0), thrust=2.0, starts=(0.1,), durations=(0.05,),
        rise_time=0.02, fall_time=0.02,
    )  # fmt: skip
    run = simulate(craft(jet=jet), duration=0.6, settings=TIGHT)
    t, end = run.data["time"].values, 0.1 + 0.05
    rising = 1.0 - np.exp(-(t - 0.1) / 0.02)
    top = 1.0 - math.exp(-0.05 / 0.02)
    level = np.where(t < 0.1, 0.0, np.where(t < end, rising, top * np.exp(-(t - end) / 0.02)))
    np.testing.assert_allclose(run.data["applied_force"].values[:, 0, 0], 2.0 * level, rtol=0, atol=1e-11)
    left = 2.0 * 0.02 * top * math.exp(-(0.6 - end) / 0.02)  # what still comes
    assert run.data["total_impulse"].values[0, 0] + left == pytest.approx(0.1, rel=1e-11, abs=0.0)


def test_a_pulse_may_begin_with_the_first_instant():
    jet = Thruster(at=("hull", (0, 0, 0)), direction=(1, 0, 0), thrust=2.0, starts=(0.0,), durations=(0.25,))
    run = simulate(craft(jet=jet), duration=0.5, settings=TIGHT)
    assert run.data["applied_force"].values[0, 0, 0] == 2.0
    assert run.data["total_impulse"].values[0, 0] == pytest.approx(0.5, rel=1e-14, abs=0.0)


def test_two_halves_are_the_whole_with_a_pulse_open():
    system, cut = craft(ARM, **FORCES), 0.2 + 1.0 / 64.0
    settings = dataclasses.replace(TIGHT, rtol=1e-8)
    whole = simulate(system, duration=0.5, v=moving(system), settings=settings)
    first = simulate(system, duration=cut, v=moving(system), settings=settings)
    assert ("forces.jet.firing", 1.0) in first.end.adjusted
    later = simulate(system, duration=0.5 - first.end.reached, start=first.end, settings=settings)
    assert whole.end == later.end


def test_events_switch_and_command():
    """A throttle that an event opens, and a force that another switches off."""
    jet = Thruster(at=("hull", (0, 0, 0)), direction=(1, 0, 0), thrust=4.0)
    push = OutsideForce(at=("hull", (0, 0, 0)), force=(0.0, 1.0, 0.0), axes="world")
    events = (
        Event(name="open", when=Time(0.1), action=Set("forces.jet.throttle", 0.25)),
        Event(name="shut", when=Time(0.3), action=Set("forces.jet.throttle", 0.0)),
        Event(name="off", when=Time(0.2), action=Set("forces.push.on", False)),
    )
    run = simulate(craft(jet=jet, push=push), duration=0.5, settings=TIGHT, events=events)
    np.testing.assert_allclose(
        run.data["total_impulse"].values, [[0.2, 0, 0], [0, 0.2, 0]], rtol=1e-12, atol=1e-15
    )


def test_loads_of_joints_know_of_forces():
    """What a hinge passes on under a force on its arm: the hull's own acceleration tells it."""
    system = craft(ARM, **FORCES)
    run = simulate(system, duration=0.3, v=moving(system), settings=TIGHT)
    loads = joint_loads(run)
    data, k = run.data, 9
    # The hull's mass centre is its origin: m a is its own forces and the reaction.
    twist, rates = data["v"].values[k, :6], data["a"].values[k, :6]
    axes = Rotation.from_quat(data["base_attitude"].values[k])
    accelerated = axes.apply(rates[:3] + np.cross(twist[3:], twist[:3]))
    on_hull = data["applied_force"].values[k, [1, 3]].sum(axis=0)
    passed = loads["force"].sel(moving_joint="hinge").values[k]
    np.testing.assert_allclose(4.0 * accelerated, on_hull - passed, rtol=0, atol=1e-11)


# --- functions of a user's ----------------------------------------------------------------------------------


def follow(t, pose, twist):
    """A wrench that hangs on all that it is asked."""
    found = np.zeros(6)
    for k in range(3):
        found[k] = math.cos(3.0 * t) * pose[k, 0] - 0.2 * twist[k]
        found[3 + k] = 0.1 * pose[k, 3] - 0.3 * twist[3 + k]
    return found


def tether(t, p, links, joints, states, whole):
    """A line that pulls and cannot push: stiffness p[0], damping p[1], length p[2]."""
    a, b = links[0], links[1]
    length = rate = 0.0
    for k in range(3):
        length += (b.place[k] - a.place[k]) ** 2
    length = math.sqrt(length)
    for k in range(3):
        rate += (b.place[k] - a.place[k]) * (b.velocity[k] - a.velocity[k]) / length
    whole.kink = length - p[2]
    if length > p[2]:
        pull = p[0] * (length - p[2]) + p[1] * rate
        whole.energy = 0.5 * p[0] * (length - p[2]) ** 2
        whole.loss = p[1] * rate**2
        for k in range(3):
            b.force[k] = -pull * (b.place[k] - a.place[k]) / length


def servo(t, p, links, joints, states, whole):
    """An integral controller that turns one joint by the angle of another body's spin."""
    states[0].rate = joints[0].angle - p[0] * links[0].spin[2]
    joints[0].torque = -p[1] * states[0].value - p[2] * joints[0].rate


@functools.cache
def users(compiled):
    made = njit if compiled else (lambda function: function)
    return {
        "follow": CallableForce(at=("tip", (0.1, 0.0, 0.0)), wrench=made(follow)),
        "tether": CallableElement(
            act=made(tether), links=(("hull", (0.0, 0.5, 0.0)), ("tip", (0.0, 0.1, 0.0))), internal=True,
            passive=True, has_kink=True, parameters={"stiffness": 400.0, "damping": 3.0, "length": 0.8},
        ),
        "servo": CallableElement(
            act=made(servo), links=(("hull", (0, 0, 0)),), joints=("hinge",), integrates=("error",),
            parameters={"share": 0.3, "integral": 5.0, "rate": 0.4},
        ),
    }  # fmt: skip


def test_elements_of_a_users_close_the_ledger():
    """Energy that a tether stores and loses, work of the rest, momenta less impulses; and slack and tight."""
    system = craft(ARM, **users(True))
    v = moving(system)
    v[6] = 2.5
    run = simulate(system, duration=1.0, v=v, settings=dataclasses.replace(TIGHT, rtol=1e-9))
    assert run.completed
    kept = run.summary()["conservation"]
    # The run's tolerance: a kink ends a step, so that none is lost there.
    assert kept["energy_error_relative"] < 1e-7
    assert kept["linear_momentum_drift_relative"] < 1e-9
    assert kept["angular_momentum_drift_relative"] < 1e-9
    data = run.data
    tight = data["force_energy"].sel(force="tether").values > 0.0
    assert 0 < tight.sum() < tight.size
    assert data["total_force_loss"].sel(force="tether") > 0.0
    # A tether is nobody's but theirs.
    assert np.abs(data["force_impulse"].sel(force="tether").values).max() == 0.0
    assert data["total_force_work"].sel(force="tether") == 0.0


def test_plain_and_compiled_functions_are_one():
    """The same text either way, to the last digits that another order of sums leaves."""
    ends = []
    for compiled in (True, False):
        system = craft(ARM, **users(compiled))
        used = RunSettings(rtol=1e-7, engine="pinocchio")
        ends.append(simulate(system, duration=0.1, v=moving(system), settings=used).end.y)
    np.testing.assert_allclose(ends[0], ends[1], rtol=0, atol=1e-12)


def spring_of_hinge(t, p, links, joints, states, whole):
    joints[0].torque = -p[0] * joints[0].angle
    whole.energy = 0.5 * p[0] * joints[0].angle ** 2


def test_an_element_at_a_joint_is_a_spring_there():
    """Against a spring at the joint: the same run, and the same energy stored."""
    own = CallableElement(act=njit(spring_of_hinge), joints=("hinge",), passive=True, parameters={"k": 7.0})
    one = craft(ARM, own=own)
    other = craft(ARM, springs={"own": JointSpring(joint="hinge", stiffness=7.0)})
    runs = [simulate(system, duration=0.5, v=moving(system), settings=TIGHT) for system in (one, other)]
    np.testing.assert_allclose(*(run.data["q"].values[-1] for run in runs), rtol=0, atol=1e-11)
    stored = runs[0].data["force_energy"].values[:, 0]
    np.testing.assert_allclose(stored[-1], runs[1].data["spring_energy"].values[-1], rtol=1e-10)


@pytest.mark.parametrize("compiled", [False, True], ids=["plain", "compiled"])
def test_a_function_without_an_answer_ends_the_run_by_its_name(compiled):
    def fails(t, pose, twist):
        if t > 0.1:
            raise ValueError("no wind beyond")
        return np.ones(6)

    force = CallableForce(at=("hull", (0, 0, 0)), wrench=njit(fails) if compiled else fails)
    run = simulate(craft(wind=force), duration=0.2, settings=RunSettings(engine="pinocchio"))
    assert run.outcome.name == "FUNCTION_FAILED"
    assert "force 'wind'" in run.message and "no wind beyond" in run.message


def test_a_function_that_answers_with_no_numbers_ends_the_run():
    def lost(t, pose, twist):
        return np.full(6, np.nan if t > 0.1 else 1.0)

    force = CallableForce(at=("hull", (0, 0, 0)), wrench=lost)
    run = simulate(craft(wind=force), duration=0.2, settings=RunSettings(engine="pinocchio"))
    assert run.outcome.name == "FUNCTION_FAILED" and "wrench of t = 0.1 s gave" in run.message


def test_a_function_with_a_memory_is_found():
    count = []

    def grows(t, pose, twist):
        count.append(t)
        return np.array([len(count), 0.0, 0.0, 0.0, 0.0, 0.0])

    force = CallableForce(at=("hull", (0, 0, 0)), wrench=grows)
    run = simulate(craft(wind=force), duration=0.2, settings=RunSettings(engine="pinocchio", rtol=1e-3))
    assert run.outcome.name == "FUNCTION_WITH_MEMORY"


def test_the_compiled_engine_refuses_a_plain_function():
    force = CallableForce(at=("hull", (0, 0, 0)), wrench=lambda t, pose, twist: np.zeros(6))
    with pytest.raises(
        AntennaPinError, match="force 'wind' is a function in Python; compile it with numba.njit"
    ):
        simulate(craft(wind=force), duration=0.2, settings=TIGHT)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_force_follows_a_reference(engine):
    """Through the mass centre of a body at rest: its momentum is the integral of the chirp, by quadrature."""
    chirp = Chirp(amplitude=2.0, first=1.0, last=9.0, duration=0.7, start=0.1, phase=0.4)
    course = Sum(parts=(Constant(value=0.5), chirp))
    push = OutsideForce(at=("hull", (0, 0, 0)), force=(0, 3.0, 0), axes="world", follows=course, value=-2.0)
    settings = dataclasses.replace(TIGHT, engine=engine)
    run = simulate(craft(push=push), duration=1.0, settings=settings)
    marks = (0.0, *course.instants, 1.0)
    exact = sum(quad(lambda t: course.at(t)[0], a, b, epsabs=1e-13)[0] for a, b in pairwise(marks))
    # The steps' tolerance of 1e-12 over some hundred of them.
    np.testing.assert_allclose(
        run.data["linear_momentum"].values[-1], [0, -6.0 * exact, 0], rtol=1e-10, atol=1e-12
    )
    assert "times 0.5\N{NO-BREAK SPACE}rad + a linear chirp" in push.words() or "chirp" in push.words()


@pytest.mark.parametrize(
    ("own", "reference"),
    [
        ({"frequency": 3.0, "phase": 0.3}, Sine(amplitude=1.0, frequency=3.0, phase=0.3)),
        (
            {"time": (0.0, 0.3, 0.6), "factors": (0.0, 2.0, 1.0), "interpolation": "cubic"},
            Points(time=(0.0, 0.3, 0.6), values=(0.0, 2.0, 1.0), interpolation="cubic"),
        ),
    ],
    ids=["sine", "table"],
)
def test_its_own_course_is_such_a_reference(own, reference):
    """Whichever way it is written, the motion is the same to the last bit."""
    push = {"at": ("tip", (0.1, 0, 0)), "force": (1.0, 2.0, 0), "torque": (0, 0.1, 0)}
    runs = [
        simulate(craft(ARM, push=OutsideForce(**push, **more)), duration=0.6, settings=TIGHT)
        for more in (own, {"follows": reference})
    ]
    np.testing.assert_array_equal(runs[0].data["q"].values, runs[1].data["q"].values)


def test_a_force_has_one_course():
    push = {"at": ("hull", (0, 0, 0)), "force": (1.0, 0, 0), "follows": Constant(value=1.0)}
    with pytest.raises(AntennaPinError, match="frequency must be omitted if follows is given: a force has"):
        OutsideForce(**push, frequency=1.0)
    with pytest.raises(AntennaPinError, match="time must be omitted if follows is given"):
        OutsideForce(**push, time=(0.0, 1.0), factors=(0.0, 1.0))
    short = OutsideForce(**push | {"follows": Points(time=(0.0, 1.0), values=(0.0, 1.0))})
    with pytest.raises(AntennaPinError, match="covers the run from 0 to 2 s"):
        simulate(craft(push=short), duration=2.0)


def test_a_torque_alone_needs_no_point():
    """It turns a link alike wherever it acts; a force does not, and is refused without its point."""
    at = {"link": "bar"}
    torque = {"kind": "force", "at": at, "torque": [0.0, 0.3, 0.0]}
    ends = []
    for place in (at, at | {"point": [0.1, 0.2, 0.3]}):
        overrides = {"forces.f": torque | {"at": place}}
        ends.append(simulate(load_scenario("pendulum", case="ideal", overrides=overrides), 0.2).data["q"])
    assert float(abs(ends[0] - ends[1]).max()) < 1e-12 and float(abs(ends[0][-1] - ends[0][0]).max()) > 1e-3
    with pytest.raises(AntennaPinError, match=r"forces\.f\.at\.point is missing"):
        load_scenario("pendulum", overrides={"forces.f": torque | {"force": [1.0, 0.0, 0.0]}})
