"""Several things at one instant: closed forms, names permuted, mirror images, at the start."""

from __future__ import annotations

import itertools

import numpy as np
import pinocchio as pin
import pytest

from antenna_pin import RunSettings, simulate
from antenna_pin.dynamics import Push, System, Workspace, push_apart
from antenna_pin.elements import (
    ConstantDrive,
    EndStop,
    JointSpring,
    Latch,
    RigidLatch,
    RigidStop,
    SineDrive,
    StickingFriction,
)
from antenna_pin.mechanism import Urdf, build_mechanism
from antenna_pin.run.simulation import Event, Set
from antenna_pin.run.simulation.events import Angle

QUICK = RunSettings(engine="compiled", max_step=0.05, output_rate=10.0)

WHEEL = """<link name="{name}"><inertial><mass value="2"/>
<inertia ixx="0.5" iyy="0.5" izz="0.5" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j_{name}" type="continuous"><parent link="base"/><child link="{name}"/>
<origin xyz="{x} 0 0"/><axis xyz="0 0 {way}"/></joint>"""
BASE = """<robot name="wheels"><link name="base"><inertial><mass value="20"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>{wheels}</robot>"""


def wheels(base: str, names: tuple[str, ...], ways: tuple[int, ...], **more) -> System:
    """Balanced wheels of 0.5 kg m^2 on a base of 1 kg m^2, along its x axis."""
    places = [0.2 * (2 * k - len(names) + 1) for k in range(len(names))]
    parts = [WHEEL.format(name=n, x=x, way=w) for n, x, w in zip(names, places, ways, strict=True)]
    urdf = Urdf.from_text(BASE.format(wheels="".join(parts)), "wheels.urdf")
    return System(build_mechanism(urdf, base, (0.0, 0.0, 0.0)), **more)


def run_of(made: System, angles, rates, duration=3.0, settings=QUICK, **more):
    """A run of wheels from these angles and rates."""
    free = made.model.nq - 2 * len(angles)
    q = np.zeros(made.model.nq)
    if free:
        q[6] = 1.0
    q[free:] = np.stack([np.cos(angles), np.sin(angles)], axis=1).reshape(-1)
    v = np.concatenate([np.zeros(made.model.nv - len(rates)), rates])
    return simulate(made, q=q, v=v, duration=duration, settings=settings, **more)


KINDS = {
    "rigid stop": ("stops", lambda j: RigidStop(joint=j, upper=0.0, restitution=0.5)),
    "soft stop": ("stops", lambda j: EndStop(joint=j, upper=0.0, stiffness=100.0, law="elastic")),
    "latch": ("latches", lambda j: Latch(joint=j, angle=0.0, stiffness=100.0, damping=1.0)),
    "rigid latch": ("latches", lambda j: RigidLatch(joint=j, angle=0.0)),
    "friction": ("frictions", lambda j: StickingFriction(joint=j, coulomb=0.25)),
}


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
@pytest.mark.parametrize("kind", KINDS)
def test_two_that_know_nothing_of_each_other_do_the_same_at_one_instant(kind: str, engine: str) -> None:
    """Two wheels on the ground meet their elements at 1 s (come to rest at 2 s): as one alone does."""
    family, element = KINDS[kind]
    settings = RunSettings(engine=engine, rtol=1e-12, max_step=0.02, output_rate=10.0)
    runs = []
    for names in (("a", "b"), ("b", "a"), ("a",)):
        elements = {family: {f"of_{n}": element(f"j_{n}") for n in names}}
        made = wheels("fixed", names, (1,) * len(names), elements=elements)
        runs.append(run_of(made, [-1.0] * len(names), [1.0] * len(names), settings=settings))
    both, turned, alone = runs
    for run in (both, turned):
        assert run.completed
        n = alone.data.change.size
        assert run.data.change.size == 2 * n
        # Steps and errors are those of two wheels, which are alike.
        assert np.abs(run.data.q.values[-1, :2] - run.data.q.values[-1, 2:]).max() <= 1e-12
        assert np.abs(run.data.q.values[-1, :2] - alone.data.q.values[-1]).max() <= 1e-9
        assert np.abs(run.data.v.values[-1] - alone.data.v.values[-1]).max() <= 1e-9
        for name in ("a", "b"):
            own = [one.split(": ", 1)[1] for one in run.data.change.values if f"of_{name}" in one]
            assert own == [one.split(": ", 1)[1] for one in alone.data.change.values]
        assert np.abs(run.data.energy_error).max() < 1e-9
    assert np.array_equal(both.data.q.values[-1], turned.data.q.values[-1])


@pytest.mark.parametrize("restitution", [1.0, 0.5, 0.0])
@pytest.mark.parametrize("names", [("left", "right"), ("right", "left")])
def test_mirror_images_stay_so_on_a_free_base(restitution: float, names: tuple[str, str]) -> None:
    """Two wheels, axes opposite, strike stops together: rates -e, the base at rest, energy e^2 / 2."""
    stops = {n: RigidStop(joint=f"j_{n}", upper=0.0, restitution=restitution) for n in names}
    made = wheels("free", names, (-1, 1), elements={"stops": stops})
    run = run_of(made, [-1.0, -1.0], [1.0, 1.0])
    assert np.abs(run.data.v.values[-1, 6:] + restitution).max() <= 1e-12
    assert np.abs(run.data.v.values[-1, :6]).max() <= 1e-12
    assert float(run.data.kinetic_energy[-1]) == pytest.approx(0.5 * restitution**2, abs=1e-12)
    assert run.data.change_loss.values == pytest.approx([0.25 * (1.0 - restitution**2)] * 2, abs=1e-12)


def newton_moreau(mass, rows, v, restitution):
    """Velocity after blows by enumeration of which rows push: the one set that keeps all the rules."""
    least = -restitution * (rows @ v)
    for size in range(len(rows) + 1):
        for some in map(list, itertools.combinations(range(len(rows)), size)):
            inverse = np.linalg.solve(mass, rows[some].T)
            sizes = np.linalg.solve(rows[some] @ inverse, (least - rows @ v)[some])
            after = v + inverse @ sizes
            if np.all(sizes >= 0.0) and np.all(rows @ after >= least - 1e-13):
                return after, dict(zip(some, sizes, strict=True))
    raise AssertionError("no set keeps the rules")


CHAIN = """<robot name="chain"><link name="base"><inertial><origin xyz="0.1 0 0.05"/><mass value="3"/>
<inertia ixx="0.4" iyy="0.5" izz="0.6" ixy="0.01" ixz="0" iyz="0"/></inertial></link>{links}</robot>"""
LINK = """<joint name="j{k}" type="continuous"><parent link="{parent}"/><child link="l{k}"/>
<origin xyz="0.3 0.1 0" rpy="0 0 {turn}"/><axis xyz="0 {tilt} 1"/></joint>
<link name="l{k}"><inertial><origin xyz="0.2 0 0.02"/><mass value="{mass}"/>
<inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial></link>"""


def chain(rng: np.random.Generator, count: int, base: str) -> System:
    """A random chain of links."""
    links = [
        LINK.format(
            k=k,
            parent=f"l{k - 1}" if k and rng.random() < 0.6 else "base",
            turn=rng.uniform(-2, 2),
            tilt=rng.uniform(-0.5, 0.5),
            mass=rng.uniform(0.5, 3),
        )
        for k in range(count)
    ]
    urdf = Urdf.from_text(CHAIN.format(links="".join(links)), "chain.urdf")
    return System(build_mechanism(urdf, base, (0.0, 0.0, 0.0)))


@pytest.mark.parametrize("base", ["free", "fixed"])
def test_blows_of_one_instant_obey_newtons_law_together_and_gain_no_energy(base: str) -> None:
    """Against enumeration; any restitutions; the loss is the sum of p (1 - e) |u| / 2; order is nothing."""
    rng = np.random.default_rng(47)
    pushing = 0
    for _ in range(60):
        count = int(rng.integers(2, 6))
        made = chain(rng, count, base)
        workspace, nq, nv = Workspace(made), made.model.nq, made.model.nv
        q = pin.randomConfiguration(made.model, -np.ones(nq), np.ones(nq))
        v = rng.normal(size=nv)
        y = made.state(q, v)
        slots = [made.mechanism.joint(f"j{k}").v.start for k in range(count)]
        pushes = [Push(s, -float(np.sign(v[s])), float(rng.uniform(0, 1))) for s in slots]
        found = push_apart(workspace, 0.0, y, pushes)
        rows = np.zeros((count, nv))
        for row, one in zip(rows, pushes, strict=True):
            row[one.at] = one.way
        mass = np.triu(pin.crba(made.model, made.model.createData(), q))
        mass = mass + np.triu(mass, 1).T
        back = np.array([one.restitution for one in pushes])
        after, sizes = newton_moreau(mass, rows, v, back)
        pushing += len(sizes) < count
        assert np.abs(found.velocity - after).max() <= 1e-11 * np.abs(v).max()
        taken = 0.5 * (v @ mass @ v - after @ mass @ after)
        law = 0.5 * float(np.sum(found.pushes * (1.0 - back) * -(rows @ v)))
        assert law >= 0.0
        assert taken == pytest.approx(law, rel=1e-9, abs=1e-12)
        order = rng.permutation(count)
        again = push_apart(workspace, 0.0, y, [pushes[k] for k in order])
        assert np.abs(again.velocity - found.velocity).max() <= 1e-12 * np.abs(v).max()
    assert pushing > 10  # of some the others' blows have taken the joint off its stop


def test_a_latch_holds_whose_window_ends_at_a_stop() -> None:
    """It refuses the joint on its way in and captures it as it comes back from the stop, slow enough."""
    drive = ConstantDrive(joint="j_a", value=0.03)
    for kind, more in ((Latch, {"stiffness": 1000.0, "damping": 1.0}), (RigidLatch, {})):
        latch = kind(joint="j_a", angle=-0.005, width=0.005, greatest_rate=0.2, **more)
        stop = RigidStop(joint="j_a", upper=0.0, restitution=0.5)
        elements = {"stops": {"s": stop}, "latches": {"l": latch}}
        made = wheels("fixed", ("a",), (1,), drives={"d": drive}, elements=elements)
        run = run_of(made, [-0.4], [0.05], duration=4.0)
        rate = np.sqrt(0.05**2 + 2.0 * 0.03 / 0.5 * 0.4)
        assert 0.5 * rate < 0.2 < rate
        names = list(run.data.change.values)[:3]
        assert names == ["latch l: refused", "stop s: upper: bounces", "latch l: latched"]
        assert float(run.data.change_time[1]) == float(run.data.change_time[2])
        assert "let go" not in " ".join(run.data.change.values)
        rest = -0.005 + 0.03 / 1000.0 if kind is Latch else 0.0
        assert float(np.arctan2(*run.data.q.values[-1, ::-1])) == pytest.approx(rest, abs=2e-3)
        if kind is RigidLatch:
            assert np.abs(run.data.v.values[-1]).max() < 1e-12


@pytest.mark.parametrize("rigid", [True, False])
def test_an_event_at_a_latchs_window_does_not_open_the_latch(rigid: bool) -> None:
    """Whoever reacts to a capture has an event at its very angle."""
    latch = (
        RigidLatch(joint="j_a", angle=0.0, width=0.01)
        if rigid
        else Latch(joint="j_a", angle=0.0, width=0.01, stiffness=4000.0, damping=4.0)
    )
    springs = {"extra": JointSpring(joint="j_a", stiffness=0.1, on=False)}
    made = wheels("fixed", ("a",), (1,), springs=springs, elements={"latches": {"l": latch}})
    event = Event(name="mark", when=Angle("j_a", -0.01), action=Set("springs.extra.on", True))
    run = run_of(made, [-0.5], [1.0], duration=1.5, events=[event])
    assert list(run.data.change.values) == ["latch l: latched"]
    assert list(run.data.event.values)[:2] == ["mark", "latch l: latched"]
    assert abs(float(np.arctan2(*run.data.q.values[-1, ::-1]))) < 0.02


@pytest.mark.parametrize("width", [0.0, 0.01])
def test_a_latch_whose_damper_gives_too_much_lets_go_and_captures_once_outside(width: float) -> None:
    """1 N m s/rad times 0.9 rad/s is more than 0.8 N m: the wheel goes on as if there were no latch."""
    latch = Latch(joint="j_a", angle=0.0, width=width, stiffness=200.0, damping=1.0, holding_torque=0.8)
    made = wheels("fixed", ("a",), (1,), elements={"latches": {"l": latch}})
    run = run_of(made, [-0.5], [0.9], duration=2.0)
    assert list(run.data.change.values) == ["latch l: latched", "latch l: let go"]
    assert float(np.arctan2(*run.data.q.values[-1, ::-1])) == pytest.approx(1.3, abs=1e-12)


def test_a_rigid_latch_at_a_point_that_is_overcome_lets_its_joint_go() -> None:
    """Held at 0 up to 0.3 N m by a growing sine: it lets go at asin(0.3 / 0.5) and is captured once back."""
    drive = SineDrive(joint="j_a", amplitude=0.5, frequency=0.25)
    latch = RigidLatch(joint="j_a", angle=0.0, holding_torque=0.3)
    made = wheels("fixed", ("a",), (1,), drives={"d": drive}, elements={"latches": {"l": latch}})
    run = run_of(made, [-0.1], [0.5], duration=1.5)
    assert list(run.data.change.values)[:2] == ["latch l: latched", "latch l: let go"]
    let_go = np.arcsin(0.6) / (0.5 * np.pi)
    assert float(run.data.change_time[1]) == pytest.approx(let_go, abs=1e-10)
    # Free from there on: phi'' = sin(w t) with w = pi / 2.
    w, t = 0.5 * np.pi, 1.5
    angle = (np.cos(w * let_go) / w) * (t - let_go) - (np.sin(w * t) - np.sin(w * let_go)) / w**2
    assert float(np.arctan2(*run.data.q.values[-1, ::-1])) == pytest.approx(angle, abs=1e-8)


SLIDE = """<robot name="m"><link name="ground"/><link name="mass"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="slide" type="prismatic"><parent link="ground"/><child link="mass"/><axis xyz="0 0 1"/>
<limit lower="-100" upper="100" effort="1e9" velocity="1e9"/></joint></robot>"""


@pytest.mark.parametrize("rtol", [1e-8, 1e-10, 1e-12])
def test_a_stop_that_is_unloaded_just_to_zero_goes_on(rtol: float) -> None:
    """Released at rest at twice the static depth: up to exactly 0 with rate 0, again and again."""
    settings = RunSettings(engine="compiled", rtol=rtol, output_rate=100.0)
    for force, stiffness in itertools.product((1.0, 5.0, 100.0), (1e3, 1e5)):
        made = System(
            build_mechanism(Urdf.from_text(SLIDE, "m.urdf"), "fixed", (0.0, 0.0, 0.0)),
            drives={"d": ConstantDrive(joint="slide", value=-force)},
            elements={"stops": {"s": EndStop(joint="slide", lower=0.0, stiffness=stiffness, law="elastic")}},
        )
        depth, periods = force / stiffness, 10
        duration = periods * 2.0 * np.pi / np.sqrt(stiffness)
        run = simulate(made, q=[-2.0 * depth], v=[0.0], duration=duration, settings=settings)
        assert run.completed, (force, stiffness)
        expected = -depth * (1.0 + np.cos(np.sqrt(stiffness) * run.data.time.values))
        # Phases drift by the tolerance, absolute in metres: over the depth, ten times a period.
        assert np.abs(run.data.q.values[:, 0] - expected).max() <= 1e3 * rtol * max(depth, 1.0)


def test_what_a_start_takes_is_told() -> None:
    """In a rigid latch all its energy, at a stop (1 - e^2) of it: in the list at 0 s, in the ledger."""
    for element, lost, after in (
        (RigidLatch(joint="j_a", angle=0.0, width=0.01), 0.04, 0.0),
        (RigidStop(joint="j_a", upper=0.0, restitution=0.5), 0.03, -0.2),
    ):
        family = "latches" if isinstance(element, RigidLatch) else "stops"
        made = wheels("fixed", ("a",), (1,), elements={family: {"e": element}})
        run = run_of(made, [0.0], [0.4], duration=0.5)
        assert run.data.change_time.values.tolist() == [0.0]
        assert float(run.data.change_loss[0]) == pytest.approx(lost, abs=1e-15)
        assert float(run.data.change_rate[0]) == 0.4
        assert float(run.data.change_rate_after[0]) == pytest.approx(after, abs=1e-15)
        assert float(run.data.change_impulse[0]) == pytest.approx(0.5 * (after - 0.4), abs=1e-15)
        assert float(run.data.total_element_loss[0]) == pytest.approx(lost, abs=1e-15)
        assert np.abs(run.data.energy_error).max() < 1e-15


@pytest.mark.parametrize("over", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("step", [0.02, 0.3])
def test_a_load_that_hardly_overcomes_what_holds_is_located(over: float, step: float) -> None:
    """A sine whose crest is above the grip by a millionth, in steps of up to three of its periods."""
    drive = SineDrive(joint="j_a", amplitude=0.3 * (1.0 + over), frequency=10.0)
    settings = RunSettings(engine="compiled", max_step=step, output_rate=10.0)
    exact = 0.1 * np.arcsin(1.0 / (1.0 + over)) / (2.0 * np.pi)
    for family, element, what in (
        ("frictions", StickingFriction(joint="j_a", coulomb=0.3), "slips forward"),
        ("latches", RigidLatch(joint="j_a", angle=0.0, width=0.1, holding_torque=0.3), "let go"),
    ):
        made = wheels("fixed", ("a",), (1,), drives={"d": drive}, elements={family: {"e": element}})
        run = run_of(made, [0.0], [0.0], duration=0.6, settings=settings)
        assert run.data.change.values[0].endswith(what)
        # The crest is flat: the grip's round-off over its slope there.
        assert float(run.data.change_time[0]) == pytest.approx(exact, abs=1e-9)
