"""Latches in runs: when they capture, what they keep and lose, when they let go."""

import numpy as np
import pytest

from antenna_pin import RunSettings, simulate
from antenna_pin.dynamics import System
from antenna_pin.elements import ConstantDrive, EndStop, JointSpring, Latch, RigidLatch, RigidStop
from antenna_pin.mechanism import Urdf, build_mechanism
from antenna_pin.run.simulation import Event, Set, Time

TIGHT = RunSettings(rtol=1e-11, max_step=0.02, output_rate=50.0)
MASS = 2.0

BODIES = """<robot name="two"><link name="base"><inertial><origin xyz="0.1 0 0.05"/><mass value="3"/>
<inertia ixx="0.4" iyy="0.5" izz="0.6" ixy="0.01" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="{type}"><parent link="base"/><child link="arm"/><origin xyz="0.2 0 0" rpy="0.3 0.2 0"/>
<axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="1e9" velocity="1e9"/></joint>
<link name="arm"><inertial><origin xyz="0.3 0.1 0"/><mass value="2"/>
<inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0" ixz="0.01" iyz="0"/></inertial></link></robot>"""


def system(kind="prismatic", base="fixed", *, latches, stops=(), **more):
    """Two bodies on a joint; of mass 2 kg is what moves on a fixed base."""
    urdf = Urdf.from_text(BODIES.format(type=kind), "two.urdf")
    elements = {
        "stops": {f"s{k}": one for k, one in enumerate(stops)},
        "latches": {f"l{k}": one for k, one in enumerate(latches)},
    }
    return System(build_mechanism(urdf, base, (0.0, 0.0, 0.0)), elements=elements, **more)


def seen(run):
    """The changes by name, and when."""
    return [str(name) for name in run.data.change.values], run.data.change_time.values


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
@pytest.mark.parametrize("kind", ["revolute", "continuous", "prismatic"])
def test_a_lock_keeps_all_momentum_and_books_half_the_reduced_inertia(kind, engine):
    """On a turning, moving base; the reduced inertia by the inverse of the mass matrix."""
    import pinocchio as pin

    made = system(kind, "free", latches=[RigidLatch(joint="j", angle=0.4, width=0.01)])
    v = np.array([0.1, 0.2, -0.1, 0.3, -0.2, 0.4, 0.9])
    settings = RunSettings(rtol=1e-11, max_step=0.02, output_rate=50.0, engine=engine)
    run = simulate(made, v=v, duration=1.0, settings=settings)
    names, times = seen(run)
    assert names == ["latch l0: latched"]
    assert float(run.data.change_angle[0]) == pytest.approx(0.39, abs=1e-12)
    for name in ("linear_momentum", "angular_momentum"):
        moved = run.data[name].values - run.data[name].values[0]
        assert np.abs(moved).max() < 1e-12 * np.abs(run.data[name].values).max() + 1e-12
    at = int(np.searchsorted(run.data.time.values, times[0]))
    model = made.mechanism.model
    mass = pin.crba(model, model.createData(), run.data.q.values[at])
    mass = np.triu(mass) + np.triu(mass, 1).T
    reduced = 1.0 / np.linalg.inv(mass)[6, 6]
    rate = float(run.data.change_rate[0])
    assert float(run.data.change_loss[0]) == pytest.approx(0.5 * reduced * rate**2, rel=1e-11)
    assert float(run.data.change_impulse[0]) == pytest.approx(-reduced * rate, rel=1e-11)
    assert float(run.data.total_element_loss[0]) == pytest.approx(0.5 * reduced * rate**2, rel=1e-11)
    assert np.abs(run.data.energy_error).max() < 1e-10
    after = run.data["slide_position" if kind == "prismatic" else "motion_angle"].values[at + 1 :, 0]
    assert np.abs(after - 0.39).max() < 1e-9


def test_captured_after_so_many_rebounds():
    """Between stops at 0 and 1 m, each blow takes a fifth: too fast at 1, .8, .64 m/s, captured at .512."""
    stops = [RigidStop(joint="j", lower=0.0, upper=1.0, restitution=0.8)]
    latch = RigidLatch(joint="j", angle=0.5, greatest_rate=0.6)
    made = system(latches=[latch], stops=stops)
    run = simulate(made, q=[0.25], v=[1.0], duration=6.0, settings=TIGHT)
    names, times = seen(run)
    latched = [k for k, name in enumerate(names) if name == "latch l0: latched"]
    assert [name for name in names if "l0" in name] == ["latch l0: refused"] * 3 + ["latch l0: latched"]
    # 0.75 m at first, then 1 m between blows, half a metre to the latch.
    expected = 0.75 + 1.0 / 0.8 + 1.0 / 0.64 + 0.5 / 0.512
    assert times[latched[0]] == pytest.approx(expected, abs=1e-10)
    assert float(run.data.change_loss[latched[0]]) == pytest.approx(0.5 * MASS * 0.512**2, rel=1e-10)
    # What a body loses in three blows and the capture is all that it had.
    assert run.data.total_element_loss.values.sum() == pytest.approx(0.5 * MASS, rel=1e-10)


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
@pytest.mark.parametrize(
    ("holds", "more"),
    [
        (RigidLatch, {"greatest_rate": 0.5}),
        (RigidLatch, {"greatest_energy": 0.25}),
        (Latch, {"greatest_energy": 0.25, "stiffness": 1e3}),
    ],
)
def test_captured_where_its_rate_or_energy_falls_to_the_greatest(holds, more, engine):
    """By a damper, v = v0 exp(-c t / m), in the window's middle: refused with 0.49 J, captured at 0.25 J."""
    latch = holds(joint="j", angle=0.3, width=0.15, **more)
    made = system(latches=[latch], springs={"damper": JointSpring(joint="j", damping=4.0)})
    settings = RunSettings(rtol=1e-11, max_step=0.02, output_rate=50.0, engine=engine)
    run = simulate(made, q=[0.0], v=[1.0], duration=0.5, settings=settings)
    names, times = seen(run)
    assert names == ["latch l0: refused", "latch l0: latched"]
    assert times == pytest.approx([-0.5 * np.log(1.0 - 0.15 / 0.5), 0.5 * np.log(2.0)], abs=1e-9)
    assert float(run.data.change_angle[1]) == pytest.approx(0.25, abs=1e-9)
    # m v^2 / 2 with v = 1 - c x / m at 0.15 m; and that of the limit.
    if "greatest_energy" in more:
        assert run.data.change_energy.values == pytest.approx([0.7**2, 0.25], abs=1e-9)


@pytest.mark.parametrize(("share", "what"), [(0.999, "refused"), (1.001, "latched")])
@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_the_energy_is_that_of_the_reduced_inertia_on_a_free_base(kind, share, what):
    """What a lock took is what counts: a thousandth less is refused, and both are told the energy."""
    v = np.array([0.1, 0.2, -0.1, 0.3, -0.2, 0.4, 0.9])
    lock = {"joint": "j", "angle": 0.4, "width": 0.01}
    took = simulate(system(kind, "free", latches=[RigidLatch(**lock)]), v=v, duration=0.6, settings=TIGHT)
    energy = float(took.data.change_loss[0])
    latch = RigidLatch(**lock, greatest_energy=share * energy)
    run = simulate(system(kind, "free", latches=[latch]), v=v, duration=0.6, settings=TIGHT)
    assert seen(run)[0][0] == f"latch l0: {what}"
    assert float(run.data.change_energy[0]) == pytest.approx(energy, rel=1e-11)
    assert float(took.data.change_energy[0]) == pytest.approx(energy, rel=1e-11)


def test_a_start_that_moves_in_the_window_is_weighed():
    """One joule of 2 kg at 1 m/s: above the greatest energy it stays free, else it is held at once."""
    for greatest, held in ((0.9, False), (1.1, True)):
        latch = RigidLatch(joint="j", angle=0.0, width=0.5, greatest_energy=greatest)
        run = simulate(system(latches=[latch]), v=[1.0], duration=0.2, settings=TIGHT)
        assert float(run.data.v.values[-1, 0]) == pytest.approx(0.0 if held else 1.0, abs=1e-12)


def test_the_wrong_way_is_refused_until_it_turns():
    """Thrown down into the window of a latch that captures on the way up, a spring turns it: at rate zero."""
    spring = JointSpring(joint="j", stiffness=8.0)
    latch = Latch(joint="j", angle=-0.45, width=0.1, direction="up", stiffness=1e3)
    made = system(latches=[latch], springs={"spring": spring})
    run = simulate(made, q=[0.0], v=[-1.0], duration=0.85, settings=TIGHT)
    names, times = seen(run)
    assert names == ["latch l0: refused", "latch l0: latched"]
    # -sin(2 t) / 2 comes to -0.35 at first, to rest at pi / 4, at -0.5.
    assert times == pytest.approx([0.5 * np.arcsin(0.7), 0.25 * np.pi], abs=1e-9)
    assert float(run.data.change_angle[1]) == pytest.approx(-0.5, abs=1e-9)


def test_held_by_a_spring_it_swings_about_the_latched_angle_and_is_let_go_at_the_torque():
    """k e from the window's end: A cos(w t + phi); at first within the holding torque, then let go by it."""
    stiffness, rate = 800.0, 0.4
    omega = np.sqrt(stiffness / MASS)
    free = Latch(joint="j", angle=0.5, width=0.01, stiffness=stiffness)
    run = simulate(system(latches=[free]), q=[0.4], v=[rate], duration=1.0, settings=TIGHT)
    names, times = seen(run)
    assert names == ["latch l0: latched"]
    assert times[0] == pytest.approx(0.09 / rate, abs=1e-11)
    later = run.data.time.values - times[0]
    kept = later > 0.0
    swing = -0.01 * np.cos(omega * later) + rate / omega * np.sin(omega * later)
    assert run.data.slide_position.values[kept, 0] - 0.5 == pytest.approx(swing[kept], abs=1e-8)
    weak = Latch(joint="j", angle=0.5, width=0.01, stiffness=stiffness, holding_torque=12.0)
    run = simulate(system(latches=[weak]), q=[0.4], v=[rate], duration=1.0, settings=TIGHT)
    names, times = seen(run)
    assert names == ["latch l0: latched", "latch l0: let go"]
    # At 12 N the spring is at 15 mm, beyond the window: the joint is out of it, and stays so.
    assert float(run.data.change_angle[1]) == pytest.approx(0.515, abs=1e-10)
    left = np.sqrt(rate**2 + omega**2 * (0.01**2 - 0.015**2))
    assert float(run.data.change_rate[1]) == pytest.approx(left, rel=1e-8)


def test_a_rigid_latch_lets_go_at_its_torque_and_by_an_event():
    """A force that grows past the holding force lets go at once; an event lets go when it says."""
    latch = RigidLatch(joint="j", angle=0.0, holding_torque=5.0)
    drive = ConstantDrive(joint="j", value=4.0)
    made = system(latches=[latch], drives={"push": drive})
    settings = TIGHT
    run = simulate(
        made,
        q=[0.0],
        v=[0.0],
        duration=2.0,
        settings=settings,
        events=[Event(name="more", when=Time(1.0), action=Set("drives.push.value", 6.0))],
    )
    names, times = seen(run)
    assert names == ["latch l0: let go"]
    assert times[0] == 1.0
    assert run.summary()["latches"]["l0"]["held_at_end"] is False
    assert run.data.q.values[-1, 0] == pytest.approx(0.5 * 3.0, rel=1e-10)
    held = run.data.time.values < 1.0
    assert run.data.element_effort.values[held, 0] == pytest.approx(-4.0, rel=1e-12)
    run = simulate(
        made,
        q=[0.0],
        v=[0.0],
        duration=2.0,
        settings=settings,
        events=[Event(name="go", when=Time(1.0), action=Set("latches.l0.on", False))],
    )
    assert run.data.q.values[-1, 0] == pytest.approx(0.5 * 2.0, rel=1e-10)


def test_a_start_in_the_window_is_a_start_held():
    """At rest it stays; moving it is stopped by an impulse before anything is recorded, or booked."""
    latch = RigidLatch(joint="j", angle=0.1, width=0.05)
    for rate in (0.0, 0.5):
        run = simulate(system(latches=[latch]), q=[0.12], v=[rate], duration=0.2, settings=TIGHT)
        assert run.data.q.values[:, 0] == pytest.approx(0.12, abs=1e-12)
        assert np.abs(run.data.v.values).max() == 0.0
        assert np.abs(run.data.energy_error).max() < 1e-12


def test_the_deployment_spring_is_switched_off_at_capture():
    """Its energy then is the event's; without that the latch would carry its torque for ever."""
    spring = JointSpring(joint="j", stiffness=8.0, rest_angle=1.0)
    latch = RigidLatch(joint="j", angle=0.5, switches_off=("springs.deploy",))
    made = system(latches=[latch], springs={"deploy": spring})
    run = simulate(made, q=[0.0], v=[0.0], duration=1.5, settings=TIGHT)
    names, times = seen(run)
    assert names == ["latch l0: latched"]
    assert times[0] == pytest.approx(0.5 * np.arccos(0.5), abs=1e-9)
    assert abs(run.data.element_effort.values[-1, 0]) < 1e-12
    assert np.abs(run.data.energy_error).max() < 1e-9
    assert float(run.data.event_energy[0]) == pytest.approx(-0.5 * 8.0 * 0.25, rel=1e-9)


@pytest.mark.parametrize(
    ("latches", "stops", "said"),
    [
        (
            [
                RigidLatch(joint="j", angle=0.5, width=0.1),
                Latch(joint="j", angle=0.6, width=0.1, stiffness=9.0),
            ],
            [],
            r"latches\.l1: its window, 0\.5 to 0\.7, must be apart from that of latches\.l0, 0\.4 to 0\.6",
        ),
        (
            [RigidLatch(joint="j", angle=1.5, width=0.1)],
            [RigidStop(joint="j", upper=1.0, restitution=0.5)],
            r"latches\.l0: its window, 1\.4 to 1\.6, must be within the stop stops\.s0, -inf to 1",
        ),
        (
            [RigidLatch(joint="j", angle=0.5, switches_off=("springs.deploy",))],
            [],
            r"latches\.l0: element in switches_off 'springs\.deploy' is unknown",
        ),
    ],
)
def test_what_cannot_be_is_refused(latches, stops, said):
    with pytest.raises(Exception, match=said):
        system(latches=latches, stops=stops)


@pytest.mark.parametrize("damping", [0.0, 1.0, 30.0])
def test_a_latch_rattles_in_its_play_alike_by_both_engines(damping):
    """Flanks are touched and left at located instants, so that no step goes over a jump of the damper.

    On a turning base without other losses: what the flanks take and keep is the ledger, momentum stays, and
    what is left between the engines is round-off, grown by the touches.
    """
    latch = Latch(joint="j", angle=0.0, width=0.02, stiffness=500.0, damping=damping, play=2e-3)
    made = system("revolute", "free", latches=[latch])
    v = np.array([0.1, 0.2, -0.1, 0.3, -0.2, 0.4, 0.9])
    runs = [
        simulate(made, v=v, duration=1.0, settings=RunSettings(output_rate=200.0, engine=engine))
        for engine in ("compiled", "pinocchio")
    ]
    for run in runs:
        assert run.completed
        # What ledgers of random trees are held to at default tolerances: 1e-5 of the kinetic energy.
        assert np.abs(run.data.energy_error).max() < 1e-5 * float(run.data.kinetic_energy[0])
        moved = run.data.angular_momentum.values - run.data.angular_momentum.values[0]
        assert np.abs(moved).max() < 1e-10
    assert np.abs(runs[0].data.q.values - runs[1].data.q.values).max() < 1e-9


def test_a_flank_takes_half_a_swing_and_gives_what_its_damper_leaves():
    """From contact to where the sum would pull: the closed form of a damped swing from its middle on.

    With the flank massless, its spring and damper act until -k e - c e' is zero, e still above zero.
    """
    k, c, rate, play = 400.0, 6.0, 0.5, 0.02
    latch = Latch(joint="j", angle=0.0, width=0.1, stiffness=k, damping=c, play=play)
    made = system("prismatic", latches=[latch])
    run = simulate(made, q=[0.0], v=[rate], duration=0.35, settings=TIGHT)
    omega, decay = np.sqrt(k / MASS), c / (2 * MASS)
    damped = np.sqrt(omega**2 - decay**2)
    # e = (v / w_d) exp(-d t) sin(w_d t); it pushes until m e'' = 0.
    time = (np.pi - np.arctan2(2 * decay * damped, omega**2 - 2 * decay**2)) / damped
    times = np.linspace(0.0, 0.3, 300001)
    e = rate / damped * np.exp(-decay * times) * np.sin(damped * times)
    speed = rate * np.exp(-decay * times) * (np.cos(damped * times) - decay / damped * np.sin(damped * times))
    first = int(np.argmax(k * e + c * speed < 0.0))
    assert abs(time - times[first]) < 2e-6
    left = rate * np.exp(-decay * time) * (np.cos(damped * time) - decay / damped * np.sin(damped * time))
    # It goes free at that rate, to the other flank, a play away.
    gone = run.data.time.values
    way = run.data.slide_position.values[:, 0]
    free = (gone > 0.5 * play / rate + time) & (way > -0.5 * play)
    assert free.sum() > 3
    np.testing.assert_allclose(np.diff(way[free]) / np.diff(gone[free]), left, rtol=1e-9)
    assert float(run.data.total_element_loss[0]) >= 0.5 * MASS * (rate**2 - left**2) - 1e-12


@pytest.mark.parametrize(
    ("stop", "angle", "late"),
    [
        (RigidStop(joint="j", upper=0.3, restitution=0.5), 0.3, 0.0),
        # Pressed in as a spring of 2 kg and 800 N/m: 0.01 m beyond after asin(w 0.01 / v) / w, w = 20/s.
        (EndStop(joint="j", upper=0.3, stiffness=800.0, restitution=1.0), 0.31, np.arcsin(0.2) / 20.0),
    ],
)
def test_a_latch_stands_at_the_end_of_travel_or_where_the_joint_is_pressed_in(stop, angle, late):
    made = system(latches=[RigidLatch(joint="j", angle=angle)], stops=[stop])
    run = simulate(made, q=[0.0], v=[1.0], duration=0.5, settings=TIGHT)
    names, times = seen(run)
    assert times[names.index("latch l0: latched")] == pytest.approx(0.3 + late, abs=1e-9)
    assert run.data.q.values[-1, 0] == pytest.approx(angle, abs=1e-9)
