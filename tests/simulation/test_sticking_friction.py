"""Dry friction that holds: closed forms of sticking and slipping, whatever the load and under it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from antenna_pin import RunSettings, build_system, load_scenario, simulate
from antenna_pin.dynamics import System
from antenna_pin.dynamics.constraints import Anchor, Closure
from antenna_pin.elements import JointSpring, PointSpring, PrescribedMotion, SineDrive, StickingFriction
from antenna_pin.elements import sticking_friction as kernels
from antenna_pin.errors import AntennaPinError, AssumedWarning
from antenna_pin.mechanism import Urdf, build_mechanism
from antenna_pin.studies.linear import modes
from antenna_pin.trajectory import Outcome, Trajectory

G = 9.81
TIGHT = RunSettings(rtol=1e-11, max_step=0.5, output_rate=50.0)
ONE = """<robot name="one"><link name="base"/><joint name="j" type="{type}"><parent link="base"/>
<child link="arm"/><axis xyz="{axis}"/><limit lower="-9" upper="9" effort="1e9" velocity="1e9"/></joint>
<link name="arm"><inertial><origin xyz="{centre}"/><mass value="2"/>
<inertia ixx="0.3" iyy="0.4" izz="0.5" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
TWO = """<robot name="two"><link name="base"><inertial><origin xyz="0.1 0 0.05"/><mass value="3"/>
<inertia ixx="0.4" iyy="0.5" izz="0.6" ixy="0.01" ixz="0" iyz="0"/></inertial></link>
<joint name="a" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
<limit lower="-9" upper="9" effort="1e9" velocity="1e9"/></joint>
<link name="arm"><inertial><origin xyz="0 0 -0.4"/><mass value="2"/>
<inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0" ixz="0.01" iyz="0"/></inertial></link>
<joint name="b" type="continuous"><parent link="arm"/><child link="hand"/><origin xyz="0 0 -0.8"/>
<axis xyz="0 1 0"/></joint><link name="hand"><inertial><origin xyz="0 0 -0.3"/><mass value="1"/>
<inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0" ixz="0.01" iyz="0"/></inertial></link></robot>"""
BELT = """<robot name="belt"><link name="ground"/>
<joint name="drum" type="prismatic"><parent link="ground"/><child link="belt"/><axis xyz="1 0 0"/>
<limit lower="-99" upper="99" effort="1e9" velocity="1e9"/></joint>
<link name="belt"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="prismatic"><parent link="belt"/><child link="block"/><axis xyz="1 0 0"/>
<limit lower="-99" upper="99" effort="1e9" velocity="1e9"/></joint>
<link name="block"><inertial><mass value="2"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
FOUR = """<robot name="four"><link name="g"/>
<link name="a"><inertial><origin xyz="0.25 0 0"/><mass value="1"/>{inertia}</inertial></link>
<link name="b"><inertial><origin xyz="0.5 0 0"/><mass value="1"/>{inertia}</inertial></link>
<link name="c"><inertial><origin xyz="0.25 0 0"/><mass value="1"/>{inertia}</inertial></link>
<joint name="ja" type="revolute"><parent link="g"/><child link="a"/><axis xyz="0 0 1"/>{limit}</joint>
<joint name="jb" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0.5 0 0"/><axis xyz="0 0 1"/>
{limit}</joint><joint name="jc" type="revolute"><parent link="g"/><child link="c"/><origin xyz="1 0 0"/>
<axis xyz="0 0 1"/>{limit}</joint></robot>"""
INERTIA = '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>'
LIMIT = '<limit lower="-9" upper="9" effort="1e9" velocity="1e9"/>'


def _one(kind: str, axis: str, friction: StickingFriction, centre: str = "0 0 0", **more) -> System:
    urdf = Urdf.from_text(ONE.format(type=kind, axis=axis, centre=centre), "one.urdf")
    return System(build_mechanism(urdf, "fixed", (0, 0, -G)), elements={"frictions": {"j": friction}}, **more)


def _two(base: str, gravity: float, drives=None, **frictions: StickingFriction) -> System:
    mechanism = build_mechanism(Urdf.from_text(TWO, "two.urdf"), base, (0, 0, -gravity))
    return System(mechanism, drives=drives or {}, elements={"frictions": frictions})


@pytest.mark.parametrize("engine", [pytest.param("pinocchio", marks=pytest.mark.slow), "compiled"])
@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_an_oscillator_decays_by_steps_and_stays_where_it_stops(kind: str, engine: str) -> None:
    """Amplitude falls by 2 T / k each half swing, until the spring no longer overcomes T."""
    k, level, at = 8.0, 0.3, 1.0
    spring, friction = JointSpring(joint="j", stiffness=k), StickingFriction(joint="j", coulomb=level)
    system = _one(kind, "0 1 0", friction, springs={"s": spring})
    settings = RunSettings(rtol=1e-11, output_rate=5.0, max_step=0.1, engine=engine)
    run = simulate(system, q=[at], v=[0.0], duration=3600.0, settings=settings)
    turns = []
    while abs(at) > level / k:
        at -= 2.0 * level / k * np.sign(at)
        at = -at
        turns.append(at)
    half = np.pi * np.sqrt((2.0 if kind == "prismatic" else 0.4) / k)
    times = half * np.arange(1, len(turns) + 1)
    # Of a dozen half swings at rtol = 1e-11.
    np.testing.assert_allclose(run.data.change_angle, turns, rtol=0, atol=1e-10)
    np.testing.assert_allclose(run.data.change_time, times, rtol=0, atol=1e-9)
    assert str(run.data.change.values[-1]) == "friction j: sticks"
    q = run.data.q.values[run.data.time.values > times[-1], 0]
    assert np.ptp(q) < 1e-13  # an hour: it does not creep
    assert float(run.data.total_element_loss[0]) == pytest.approx(0.5 * k * (1.0 - at**2), rel=1e-10)
    assert float(run.data.element_effort[-1, 0]) == pytest.approx(k * at, rel=1e-9)  # what holds it
    assert np.abs(run.data.energy_error).max() < 1e-9


def test_a_block_slides_by_its_weight_and_stops() -> None:
    friction = StickingFriction(joint="j", coefficient=0.3)
    run = simulate(_one("prismatic", "1 0 0", friction), q=[0.0], v=[2.0], duration=1.5, settings=TIGHT)
    assert float(run.data.change_time[0]) == pytest.approx(2.0 / (0.3 * G), rel=1e-13)
    assert run.data.q.values[-1, 0] == pytest.approx(4.0 / (0.6 * G), rel=1e-13)
    assert float(run.data.element_effort[0, 0]) == pytest.approx(-0.3 * 2.0 * G, rel=1e-13)
    assert float(run.data.total_element_loss[0]) == pytest.approx(4.0, rel=1e-12)


@pytest.mark.parametrize(("slope", "moves"), [(0.299, False), (0.301, True)])
def test_a_block_on_a_slope_slides_where_the_slope_is_above_its_coefficient(slope, moves) -> None:
    friction = StickingFriction(joint="j", coefficient=0.3)
    run = simulate(
        _one("prismatic", f"1 0 {-slope}", friction), q=[0.0], v=[0.0], duration=1.0, settings=TIGHT
    )
    size = np.hypot(1.0, slope)
    way = 0.5 * G * (slope - 0.3) / size if moves else 0.0
    assert run.data.q.values[-1, 0] == pytest.approx(way, rel=1e-9, abs=1e-14)


def test_a_shaft_slows_down_by_its_axial_load() -> None:
    friction = StickingFriction(joint="j", coefficient=0.3, axial_radius=0.1)
    run = simulate(_one("revolute", "0 0 1", friction), q=[0.0], v=[2.0], duration=2.5, settings=TIGHT)
    slowing = 0.3 * 0.1 * 2.0 * G / 0.5
    assert float(run.data.change_time[0]) == pytest.approx(2.0 / slowing, rel=1e-13)


def test_friction_that_makes_its_own_load() -> None:
    """A mass beside its guide tilts in it the more, the more it brakes: a (1 - mu e / arm) = mu g."""
    mu, beside, arm = 0.3, 0.2, 0.1
    friction = StickingFriction(joint="j", coefficient=mu, bending_arm=arm)
    system = _one("prismatic", "1 0 0", friction, f"0 0 {beside}")
    run = simulate(system, q=[0.0], v=[2.0], duration=1.5, settings=TIGHT)
    slowing = mu * G / (1.0 - mu * beside / arm)
    assert run.data.q.values[-1, 0] == pytest.approx(2.0 / slowing, rel=1e-12)


def test_a_guide_that_jams_ends_the_run() -> None:
    """Where mu e > arm no acceleration does it: Painleve's problem."""
    friction = StickingFriction(joint="j", coefficient=0.3, bending_arm=0.05)
    run = simulate(_one("prismatic", "1 0 0", friction, "0 0 0.2"), q=[0.0], v=[2.0], duration=1.0)
    assert run.outcome is Outcome.NOT_FINITE
    assert "friction 'j': under its own load it jams" in run.message


def test_a_pendulum_under_its_own_load() -> None:
    """Half a swing against an integration of its own, with friction in the load: mu r |F|."""
    length, mass, mu, radius = 0.4, 2.0, 0.4, 0.05
    inertia = 0.4 + mass * length**2

    def slowed(angle: float, rate: float) -> float:
        def lacks(torque: float) -> float:
            along = mass * (length * rate**2 + G * np.cos(angle))
            turning = (torque - mass * G * length * np.sin(angle)) / inertia
            across = mass * (length * turning + G * np.sin(angle))
            return torque - mu * radius * np.hypot(along, across)

        torque = brentq(lacks, -100.0, 100.0, xtol=1e-15, rtol=1e-15)
        return (torque - mass * G * length * np.sin(angle)) / inertia

    def at_rest(t, y):
        return y[1]

    at_rest.terminal, at_rest.direction = True, 1.0  # type: ignore[attr-defined]
    own = solve_ivp(
        lambda t, y: [y[1], slowed(*y)],
        (0.0, 3.0),
        [1.2, 0.0],
        method="DOP853",
        rtol=1e-12,
        atol=1e-13,
        events=at_rest,
    )
    friction = StickingFriction(joint="j", coefficient=mu, radius=radius)
    system = _one("revolute", "0 1 0", friction, f"0 0 {-length}")
    run = simulate(system, q=[1.2], v=[0.0], duration=1.5, settings=TIGHT)
    assert float(run.data.change_time[0]) == pytest.approx(own.t_events[0][-1], rel=1e-10)
    lost = mass * G * length * (np.cos(own.y_events[0][-1][0]) - np.cos(1.2))
    assert lost > 0.2
    i = np.searchsorted(run.data.time.values, float(run.data.change_time[0]))
    assert float(run.data.element_loss[i, 0]) == pytest.approx(lost, rel=1e-8)
    assert np.abs(run.data.energy_error).max() < 1e-8


def test_a_block_on_a_belt_sticks_and_slips() -> None:
    """The period of a relaxation oscillation: sticking 2 D / V, slipping (2 pi - 2 atan(D w / V)) / w."""
    stiffness, mass, low, high, speed = 50.0, 2.0, 3.0, 5.0, 0.2
    mechanism = build_mechanism(Urdf.from_text(BELT, "belt.urdf"), "fixed", (0, 0, 0))
    spring = PointSpring(
        first=("world", (-10.0, 0.0, 0.0)), second=("block", (0.0, 0.0, 0.0)), stiffness=stiffness,
        free_length=10.0,
    )  # fmt: skip
    system = System(
        mechanism,
        drives={"belt": PrescribedMotion(joint="drum", rate=speed)},
        springs={"spring": spring},
        elements={"frictions": {"j": StickingFriction(joint="j", coulomb=low, static=high)}},
    )
    settings = RunSettings(rtol=1e-11, max_step=0.05)
    run = simulate(system, v=[speed, 0.0], duration=12.0, settings=settings)
    times = run.data.change_time.values
    omega, off = np.sqrt(stiffness / mass), (high - low) / stiffness
    sticks, slips = 2.0 * off / speed, (2.0 * np.pi - 2.0 * np.arctan(off * omega / speed)) / omega
    assert [str(one) for one in run.data.change.values[:2]] == [
        "friction j: slips backward",
        "friction j: sticks",
    ]
    assert times[0] == pytest.approx(high / (stiffness * speed), rel=1e-10)
    np.testing.assert_allclose(times[1::2] - times[: len(times[1::2]) * 2 : 2], slips, rtol=1e-8)
    np.testing.assert_allclose(times[2::2] - times[1 : len(times[2::2]) * 2 : 2], sticks, rtol=1e-8)


def test_joints_that_stick_on_a_free_base_stay_and_keep_momentum() -> None:
    a = StickingFriction(joint="a", coulomb=0.4, coefficient=0.2, radius=0.03, bending_arm=0.1)
    b = StickingFriction(joint="b", coulomb=0.3, static=0.4, stribeck_rate=0.1)
    v = np.array([0.1, 0.2, -0.1, 0.3, -0.2, 0.4, 0.5, -2.0])
    for engine in ("pinocchio", "compiled"):
        settings = RunSettings(rtol=1e-11, max_step=0.5, output_rate=50.0, engine=engine)
        run = simulate(_two("free", 0.0, a=a, b=b), v=v, duration=5.0, settings=settings)
        assert list(run.data.element_mode.values[-1]) == [kernels.STUCK, kernels.STUCK]
        assert np.abs(run.data.v.values[-20:, 6:]).max() < 1e-12
        assert np.ptp(run.data.q.values[-20:, 7:], axis=0).max() < 1e-12
        for name in ("linear", "angular"):
            momentum = run.data[f"{name}_momentum"].values
            assert np.abs(momentum - momentum[0]).max() < 1e-9 * np.abs(momentum).max()
        assert np.abs(run.data.energy_error).max() < 1e-8


def test_a_joint_that_sticks_holds_while_all_else_moves() -> None:
    """On a base that turns freely, beside a driven joint: its load comes and goes, and it does not creep."""
    a = StickingFriction(joint="a", coulomb=2.0)
    drive = SineDrive(joint="b", amplitude=0.3, frequency=0.2)
    system = _two("free", 0.0, drives={"b": drive}, a=a)
    v = np.array([0.01, 0.02, -0.01, 0.03, -0.02, 0.04, 0.0, 0.0])
    settings = RunSettings(rtol=1e-12, max_step=0.5, output_rate=0.5, engine="compiled")
    run = simulate(system, v=v, duration=300.0, settings=settings)
    assert run.completed and run.data.sizes.get("change", 0) == 0
    held = run.data.q.values[:, 7]
    # Sixty periods: the row is closed at each step's end, to round-off.
    assert np.ptp(held) < 1e-13
    load = run.data.element_effort.values[:, 0]
    assert load.max() > 0.01 and load.min() < -0.01
    for name in ("linear", "angular"):
        momentum = run.data[f"{name}_momentum"].values
        assert np.abs(momentum - momentum[0]).max() < 1e-9 * float(run.data.momentum_scale.max())


def test_of_two_joints_that_stick_one_lets_go_when_its_hold_is_overcome() -> None:
    """A rising torque on the first joint: it lets go at T; the second, with little inertia beyond, stays."""
    a, b = StickingFriction(joint="a", coulomb=2.0), StickingFriction(joint="b", coulomb=50.0)
    drive = SineDrive(joint="a", amplitude=4.0, frequency=0.25)
    mechanism = build_mechanism(Urdf.from_text(TWO, "two.urdf"), "fixed", (0, 0, 0))
    system = System(mechanism, drives={"d": drive}, elements={"frictions": {"a": a, "b": b}})
    run = simulate(system, duration=1.0, settings=TIGHT)
    assert [str(one) for one in run.data.change.values] == ["friction a: slips forward"]
    assert float(run.data.change_time[0]) == pytest.approx(np.arcsin(0.5) / (2 * np.pi * 0.25), rel=1e-10)
    assert np.abs(run.data.v.values[:, 1]).max() < 1e-13


def test_numbers_of_modes_are_those_of_their_names() -> None:
    numbers = [
        getattr(kernels, name) for name in ("UNDECIDED", "FORWARD", "BACKWARD", "STUCK", "PUSHED", "PULLED")
    ]
    assert numbers == list(range(len(StickingFriction.modes)))


@pytest.mark.parametrize(
    ("kind", "given", "said"),
    [
        ("revolute", {"coulomb": 1.0, "static": 0.5}, "static must be at least coulomb = 1"),
        ("revolute", {"coefficient": 0.1}, "radius must be given"),
        ("prismatic", {"coefficient": 0.1, "radius": 0.1}, "radius must be left out: joint 'j' slides"),
        ("revolute", {"coulomb": 1.0, "radius": 0.1}, "radius must be left out without a coefficient"),
    ],
)
def test_what_cannot_be_is_refused(kind, given, said) -> None:
    with pytest.raises(AntennaPinError, match=said):
        _one(kind, "0 1 0", StickingFriction(joint="j", **given))


def _parallelogram() -> System:
    """A loop of one freedom with friction of 1 N m in three joints, and a torque of 4 N m sin."""
    urdf = Urdf.from_text(FOUR.format(inertia=INERTIA, limit=LIMIT), "four.urdf")
    ends = [
        Anchor(link=link, rotation=np.eye(3), origin=np.array([at, 0.0, 0.0]))
        for link, at in (("c", 0.5), ("b", 1.0))
    ]
    return System(
        build_mechanism(urdf, "fixed", (0, 0, 0)),
        closures={"k": Closure(kind="revolute", first=ends[0], second=ends[1])},
        drives={"d": SineDrive(joint="ja", amplitude=4.0, frequency=0.25)},
        elements={"frictions": {n: StickingFriction(joint=n, coulomb=1.0) for n in ("ja", "jb", "jc")}},
    )


def test_a_loop_with_more_sticking_joints_than_freedoms_holds_by_all_of_them() -> None:
    """All joints of a parallelogram turn alike: it lets go at three times the friction of one, both ways."""
    run = simulate(_parallelogram(), q=[1.2, -1.2, 1.2], v=[0.0] * 3, duration=2.9, settings=TIGHT)
    lets_go = np.arcsin(0.75) / (2.0 * np.pi * 0.25)
    times = run.data.change_time.values
    assert times[:3] == pytest.approx([lets_go] * 3, rel=1e-12)
    assert times[6:] == pytest.approx([2.0 + lets_go] * 3, rel=1e-12)
    assert len(set(times[3:6])) == 1  # they come to rest together
    before = run.data.time.values < lets_go
    assert np.abs(run.data.v.values[before]).max() < 1e-15
    assert np.abs(run.data.element_effort.values).max() <= 1.0 + 1e-9
    assert np.abs(run.data.energy_error).max() < 1e-9  # of steps at this rtol


def test_a_scenario_has_frictions(tmp_path) -> None:
    """The table of a scenario, its words, and small motions where its one joint sticks: none."""
    (tmp_path / "one.urdf").write_text(ONE.format(type="revolute", axis="0 1 0", centre="0 0 -0.4"))
    (tmp_path / "scenario.toml").write_text(
        'format = 1\nduration = "1 s"\ndefault_case = "all"\n[mechanism]\nurdf = "one.urdf"\nbase = "fixed"\n'
        '[frictions.j]\ncoulomb = "3 N*m"\ncoefficient = 0.1\nradius = "20 mm"\n[cases.all]\n'
    )
    scenario = load_scenario(tmp_path / "scenario.toml")
    run = simulate(scenario)
    assert str(run.data.element.values[0]) == "frictions.j"
    assert float(run.data.element_mode[-1, 0]) == kernels.STUCK
    with pytest.raises(AntennaPinError, match="something must be left free to move"):
        modes(scenario)
    slides = simulate(load_scenario(tmp_path / "scenario.toml", overrides=["frictions.j.coulomb=0.01"]))
    assert float(slides.data.total_element_loss[0]) == 0.0  # it hangs straight down, at rest


def test_the_friction_of_a_urdf_sticks_unless_it_is_to_be_smooth(tmp_path) -> None:
    """A smooth one creeps, at w_r L / sqrt(T^2 - L^2) under a load L, and what is assumed says so."""
    text = ONE.format(type="revolute", axis="0 1 0", centre="0 0 -0.4")
    text = text.replace("<limit", '<dynamics friction="3" damping="0.1"/><limit')
    (tmp_path / "one.urdf").write_text(text)
    (tmp_path / "scenario.toml").write_text(
        'format = 1\nduration = "1 s"\ndefault_case = "all"\n[mechanism]\nurdf = "one.urdf"\nbase = "fixed"\n'
        "gravity = [0, 0, -9.81]\n[initial.joints.j]\n"
        'angle = "10 deg"\n[cases.all]\n'
    )
    run = simulate(load_scenario(tmp_path / "scenario.toml"))
    # 2 kg at 0.4 m, 10 degrees off: 1.36 N m, which it holds.
    assert np.ptp(run.data.motion_angle.values) == 0.0
    held = float(run.data.element_effort.sel(element="frictions.j.dynamics")[-1])
    assert held == pytest.approx(2.0 * G * 0.4 * np.sin(np.radians(10.0)), rel=1e-12)
    assert run.assumed == ()
    smooth = load_scenario(tmp_path / "scenario.toml", overrides=["mechanism.joints.j.sticks=false"])
    with pytest.warns(
        AssumedWarning, match="under half that load it creeps at 0.577.mrad/s; .*sticks = true"
    ):
        crept = simulate(smooth)
    rate = 1e-3 * held / np.sqrt(3.0**2 - held**2)
    # Gravity falls by 1e-3 of itself on the way; 0.1 N m s/rad of damping takes 1e-5 of the rate.
    assert abs(float(crept.data.motion_rate[-1, 0])) == pytest.approx(rate, rel=5e-3)
    saved = Trajectory.load(crept.save(tmp_path / "crept.nc"))
    (line,) = saved.assumed
    assert line.startswith("j: its friction of 3") and " ".join(line.split()) in " ".join(repr(saved).split())
    both = ["mechanism.joints.j.regularisation_speed=0.1", "mechanism.joints.j.sticks=true"]
    with pytest.raises(AntennaPinError, match="must be left out of a joint whose friction sticks"):
        build_system(load_scenario(tmp_path / "scenario.toml", overrides=both))
